# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines drawn by hand: where the rasteriser says that they pass, and what FINE makes of that."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.library import Frame, Mesh
from judge import verdict
from reference.marks import marks, place_of, steps_of, told
from views import crumpled, joined, looking, orthographic, perspective, pixels, rotation, soup

PEN = dict(verdict.PARAMS, edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_thickness=1.0)


def lines(rng, n, size=1.5, spread=2.0):
    """n lines that hang together, three by three, by their points."""
    points = rng.uniform(-spread, spread, (n, 1, 3)) + rng.uniform(-size, size, (n, 3, 3))
    corners = np.arange(3 * n).reshape(n, 3)[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    model = np.eye(4)
    model[:3, :3] = rotation(rng) * 0.8
    return Mesh(points.reshape(-1, 3).astype(np.float32), corners.astype(np.int32), model=model, kind="lines")


def passing(meshes, view, projection, frame, size=None, start=0.1, **how):
    size = size or (frame.width, frame.height)
    return library.raster(meshes, view, projection, frame, size, start, outputs=("depth", "marks"), **how)["marks"]


# ---- the rasteriser ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("projection", [perspective, orthographic])
@pytest.mark.parametrize("surfaces", [0, 25])
def test_where_lines_pass_and_are_seen(projection, surfaces):
    rng = np.random.default_rng(3 + surfaces)
    drawn = [lines(rng, 12), lines(rng, 12)]
    meshes = [soup(rng, surfaces, object_index=1)] if surfaces else []
    camera = looking(rng), projection(67, 45)
    got = passing([drawn[0], *meshes, drawn[1]], *camera, Frame(67, 45))
    want, unsure = marks(drawn, meshes, *camera, Frame(67, 45), (67, 45), 0.1)
    assert unsure.mean() < 0.01
    assert (want > 0).sum() > 100 and ((want < 0).sum() > 100) == bool(meshes)
    np.testing.assert_allclose(got[~unsure], want[~unsure], atol=1e-5)


@pytest.mark.parametrize("projection", [perspective, orthographic])
def test_lines_are_cut_where_the_camera_begins_to_see(projection):
    rng = np.random.default_rng(6)
    mesh, camera = lines(rng, 16, 0.6), (looking(rng), projection(67, 45))
    ends = mesh.points[mesh.corners].astype(float)
    far = -(np.concatenate([ends, np.ones((*ends.shape[:2], 1))], -1) @ (camera[0] @ mesh.model).T)[..., 2]
    start = far.mean()
    beyond = np.flatnonzero((far > start).any(1))
    for k, end in np.argwhere(far < start):
        share = (start - far[k, end]) / (far[k, 1 - end] - far[k, end])
        ends[k, end] += share * (ends[k, 1 - end] - ends[k, end])
    numbers = np.arange(2 * len(beyond), dtype=np.int32).reshape(-1, 2)
    cut = Mesh(ends[beyond].reshape(-1, 3).astype(np.float32), numbers, model=mesh.model, kind="lines")
    got = passing([mesh], *camera, Frame(67, 45), start=start)
    want, unsure = marks([cut], [], *camera, Frame(67, 45), (67, 45), 0.1)
    assert (far < start).any(1)[beyond].sum() > 5 and (want > 0).sum() > 30
    assert (np.abs(got - want)[~unsure] > 1e-3).sum() <= 2  # at the very end of a line


@pytest.mark.parametrize("projection", [perspective, orthographic])
@pytest.mark.parametrize("seed", range(3))
def test_where_contours_pass_and_are_seen(projection, seed):
    rng = np.random.default_rng(seed)
    meshes = [crumpled(rng, object=3, material=2), crumpled(rng), crumpled(rng, 5, material=4)]
    camera = looking(rng), projection(67, 45)
    got = passing(meshes, *camera, Frame(67, 45))
    want, unsure = marks([], meshes, *camera, Frame(67, 45), (67, 45), 0.1)
    assert unsure.mean() < 0.01 and (want < 0).sum() > 150
    np.testing.assert_allclose(got[~unsure], want[~unsure], atol=1e-5)


@pytest.mark.parametrize("projection", [perspective, orthographic])
def test_every_way_out_of_a_ball_is_told_exactly(projection):
    """A ball before a wall, and a smaller one before its middle."""
    around, up = np.meshgrid(np.arange(96) * np.pi / 48, np.linspace(0.02, np.pi - 0.02, 48))
    points = np.stack([np.cos(around) * np.sin(up), np.cos(up), np.sin(around) * np.sin(up)], -1).reshape(-1, 3)
    a = np.arange(len(points) - 96)
    b = a // 96 * 96 + (a + 1) % 96
    corners = np.concatenate([np.c_[a, b, b + 96], np.c_[a, b + 96, a + 96]]).astype(np.int32)
    ball = Mesh(points.astype(np.float32), corners, object_index=1)
    small = Mesh((0.4 * points + (0, 0, 1.5)).astype(np.float32), corners, object_index=2)
    wall = Mesh(np.array([[-9, -9, -2], [9, -9, -2], [0, 20, -2]], np.float32), None, object_index=3)
    view, p, frame = np.eye(4), projection(160, 120), Frame(160, 120)
    view[2, 3] = -5
    found = library.raster([wall, ball, small], view, p, frame, (160, 120), 0.1, outputs=("object", "marks"))
    index, got = found["object"].reshape(120, 160), found["marks"]
    for z, radius, before in ((0, 1, 1 * 3), (1.5, 0.4, 2 * 1)):
        far = 5 - z
        size = 80 * p[0, 0] * (radius / np.sqrt(far**2 - radius**2) if p[3, 2] else radius)
        for axis, (one, two) in enumerate(((index[:, :-1], index[:, 1:]), (index[:-1], index[1:]))):
            y, x = np.nonzero(np.minimum(one, two) * np.maximum(one, two) == before)
            share = place_of(got[y, x, axis])
            assert len(share) > 30 and (share > 0).all()
            assert (steps_of(got[y, x, axis]) == 7).all()  # what lies behind it is far away
            away = np.hypot(x + 0.5 - 80 + share * (axis == 0), y + 0.5 - 60 + share * (axis == 1)) - size
            assert away.min() > -0.08 and away.max() < 0.01  # the ball has corners


def test_a_line_on_its_surface_is_seen_at_any_angle_and_not_through_another():
    """The edges of a floor up to the horizon, before and below a second floor."""
    x = np.linspace(-40, 40, 33)
    ends = np.array([[(a, -1, 5), (a, -1, -90)] for a in x] + [[(-40, -1, z), (40, -1, z)] for z in -x - 50])
    corners = np.arange(2 * len(ends), dtype=np.int32).reshape(-1, 2)
    grid = Mesh(ends.reshape(-1, 3).astype(np.float32), corners, kind="lines")
    floor = np.array([[-40, -1, 5], [40, -1, 5], [40, -1, -90], [-40, -1, -90]], np.float32)
    two = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    camera, frame = (np.eye(4), perspective(160, 90)), Frame(160, 90)
    alone = passing([grid], *camera, frame)
    assert (alone > 0).sum() > 1500
    for shift, seen in ((0, True), (-0.05, True), (0.05, False)):
        got = passing([grid, Mesh(floor + np.float32([0, shift, 0]), two, object_index=1)], *camera, frame)
        if seen:
            np.testing.assert_array_equal(np.maximum(got, 0), alone)  # without the contours of the floor
        else:
            assert not (got[70:] > 0).any()  # where the second floor lies more than a pixel above


@pytest.mark.parametrize("seed", range(4))
def test_lines_through_centres_are_whole(seed):
    """Each square of four centres that a straight line goes through is entered once and left once."""
    rng = np.random.default_rng(seed)
    for _ in range(60):
        way, at = rng.integers(-4, 5, 2), rng.integers(3, 9, 2) + 0.5
        if not way.any():
            continue
        points = np.array([[*(at - 9 * way), -1], [*(at + 9 * way), -1]]) + rng.choice([0, 0, 1e-9, 0.1])
        mesh = Mesh(points.astype(np.float32), np.array([[0, 1]], np.int32), kind="lines")
        on = passing([mesh], *pixels(12, 12), Frame(12, 12)) > 0
        right, down = on[:, :-1, 0].astype(int), on[:-1, :, 1].astype(int)
        sides = right[:-1] + right[1:] + down[:, :-1] + down[:, 1:]
        assert set(np.unique(sides)) <= {0, 2}, (way, at)
        assert not on[:, -1, 0].any() and not on[-1, :, 1].any()


def test_the_same_however_the_work_is_cut_up():
    rng = np.random.default_rng(5)
    meshes = [crumpled(rng), lines(rng, 40, 3.0), soup(rng, 60, object_index=1), lines(rng, 200, 0.4),
              lines(rng, 5, 90.0)]
    view, p, frame = looking(rng), perspective(131, 77), Frame(131, 77)
    full = passing(meshes, view, p, frame, threads=1)
    assert (full > 0).sum() > 500
    for threads in (2, 3, 8):
        assert passing(meshes, view, p, frame, threads=threads).tobytes() == full.tobytes()
    for _ in range(12):
        x, y = int(rng.integers(0, 131)), int(rng.integers(0, 77))
        w, h = int(rng.integers(1, 132 - x)), int(rng.integers(1, 78 - y))
        part, want = passing(meshes, view, p, Frame(131, 77, x, y), (w, h)), full[y:y + h, x:x + w].copy()
        want[:, -1, 0] = want[-1, :, 1] = 0  # the ways out of the border
        np.testing.assert_array_equal(part, want)
    others = ("depth", "object", "normal")
    plain = library.raster([meshes[0], meshes[2]], view, p, frame, (131, 77), 0.1, outputs=others)
    mixed = library.raster(meshes, view, p, frame, (131, 77), 0.1, outputs=(*others, "marks"))
    assert all(np.array_equal(plain[name], mixed[name]) for name in others)  # no surface notices lines


@pytest.mark.parametrize("turn", [0.0, 0.03, 0.4, 0.8, 1.3])
@pytest.mark.parametrize("wide", [0.1, 0.4, 0.9])
def test_what_passes_between_centres_is_told(turn, wide):
    """A rod thinner than a pixel, of three sides, covers a centre in every row or column, or is told between two."""
    frame, p = Frame(61, 53), orthographic(61, 53)
    pixel = 2 / (abs(p[0, 0]) * 61)
    angle, along = np.arange(3) * 2.1 + 0.3, np.array((np.cos(turn), np.sin(turn), 0))
    ring = np.stack([-np.sin(turn) * np.cos(angle), np.cos(turn) * np.cos(angle), np.sin(angle)], -1) * wide * pixel / 2
    points = np.concatenate([ring - 99 * pixel * along, ring + 99 * pixel * along]) + (0.011, 0.017, -5)
    sides = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5), (0, 2, 1), (3, 4, 5)]
    mesh = Mesh(points.astype(np.float32), np.array(sides, np.int32))
    wall = Mesh(np.float32([(-99, -99, -9), (99, -99, -9), (0, 199, -9)]), np.array([(0, 1, 2)], np.int32))
    maps = library.raster([wall, mesh], np.eye(4), p, frame, (61, 53), 0.1, outputs=("depth", "marks"))
    down = turn < 0.8  # ways down cross it
    told = (maps["marks"] <= -18)[..., int(down)] | (maps["depth"] < 7)
    assert told.any(0 if down else 1)[1:-1].all()
    place = -18 - maps["marks"][..., int(down)]
    y, x = np.mgrid[:53, :61].astype(float)
    y, x = (y + place, x) if down else (y, x + place)
    middle = ((x - 30 - 0.011 / pixel) * np.sin(turn) + (y - 26 + 0.017 / pixel) * np.cos(turn))[place >= 0]
    assert place.max() < 1 and np.abs(middle).max(initial=0) < 0.5


@pytest.mark.parametrize("size", [1e-30, 1e6, 3e38, np.nan, np.inf])
def test_any_length_gives_clean_places(size):
    rng = np.random.default_rng(6)
    mesh, ball = lines(rng, 30), crumpled(rng)
    with np.errstate(invalid="ignore", over="ignore"):
        mesh.points[::2] *= np.float32(size)
        ball.points[::5] *= np.float32(size)
    mesh.points[7] = mesh.points[6]
    for p in (perspective(33, 17), orthographic(33, 17)):
        got = passing([mesh, soup(rng, 5), ball], looking(rng), p, Frame(33, 17))
        between = (got <= -16) & (got >= -19) & (-got % 2 >= 1 / 1024)
        got = np.where(between, 0, got)
        place = np.where(got < 0, place_of(got), got)
        assert ((got == 0) | ((place >= 1 / 1024) & (place <= 1))).all() and (steps_of(got) <= 7).all()


def test_a_pole_with_a_point_for_each_meridian_has_no_contours():
    """As of turned shapes whose poles were never merged: beside each quad lies one that has no area."""
    turns = np.arange(24) * 2 * np.pi / 24
    rim = np.stack([np.cos(turns), np.sin(turns), 0 * turns - 3.2], 1)
    k = np.arange(24)
    right = (k + 1) % 24
    corners = np.concatenate([np.stack([k, right, 24 + k], 1), np.stack([right, 24 + right, 24 + k], 1)])
    mesh = Mesh(np.concatenate([rim, [[0, 0, -3]] * 24]).astype(np.float32), corners.astype(np.int32), object_index=1)
    got = passing([mesh], np.eye(4), perspective(67, 45), Frame(67, 45))
    want, _ = marks([], [mesh], np.eye(4), perspective(67, 45), Frame(67, 45), (67, 45), 0.1)
    np.testing.assert_allclose(got, want, atol=1e-5)
    assert (got < 0).any() and not got[16:29, 24:43].any(), "only its rim is one"


@pytest.mark.parametrize("turn", [3, 40, 93, 170])
def test_a_tip_of_several_points_has_contours_on_both_sides(turn):
    """As of a leaf whose last row of points was scaled to one place: one triangle of each last quad has no area."""
    across = np.array([[-0.3, 0], [0, 0], [0.3, 0]])
    flat = np.concatenate([across, across * 0.6 + (0, 0.5), across * 0 + (0, 1)]) * 0.9
    points = np.c_[flat, np.full(9, -3.0) + 0.2 * np.abs(flat[:, 0])]
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    points[:, :2] = points[:, :2] @ [(c, -s), (s, c)] + (0.013, 0.007)
    quads = [(a, a + 1, a + 4, a + 3) for a in (0, 1, 3, 4)]
    corners = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    mesh = Mesh(points.astype(np.float32), np.array(corners, np.int32), object_index=1)
    got = passing([mesh], np.eye(4), perspective(101, 91), Frame(101, 91))
    want, _ = marks([], [mesh], np.eye(4), perspective(101, 91), Frame(101, 91), (101, 91), 0.1)
    np.testing.assert_allclose(got, want, atol=1e-5)
    whole = Mesh(points[:7].astype(np.float32), np.minimum(corners, 6).astype(np.int32), object_index=1)
    other = passing([whole], np.eye(4), perspective(101, 91), Frame(101, 91))
    assert ((got < 0) == (other < 0)).all() and np.abs(place_of(got) - place_of(other)).max() < 1e-4


def test_objects_by_triangle():
    rng = np.random.default_rng(7)
    mesh = soup(rng, 40, object=np.arange(40) + 1, material=np.arange(40) + 1)
    got = library.raster([mesh], looking(rng), perspective(60, 40), Frame(60, 40), (60, 40), 0.1)
    assert got["object"].max() > 9 and np.array_equal(got["object"], got["material"])


# ---- FINE --------------------------------------------------------------------------------------------------------


def wall(height=60, width=80, ends=((9.3, 11.7), (70.2, 41.4)), contour=False):
    """Layers of a bare wall with lines on it, ends (x, y) two by two in pixels, centres at whole numbers; `contour`:
    as if they were contours."""
    points = np.c_[np.array(ends) + 0.5, np.full(len(ends), -4.0)].astype(np.float32)
    mesh = Mesh(points, np.arange(len(ends), dtype=np.int32).reshape(-1, 2), kind="lines")
    flat = np.ones((height, width, 1), np.float32)
    marks = passing([mesh], *pixels(width, height), Frame(width, height))
    return dict(combined=flat.repeat(4, 2), color=flat.repeat(3, 2) / 2, diffuse=flat.repeat(3, 2), depth=4 * flat,
                normal=flat * np.float32([0, 0, 1]), object=0 * flat, marks=-marks if contour else marks)


def ink(layers, styles=(), **scene):
    made = library.render(layers, {**PEN, **scene}, styles, outputs=("Encre Lines", "Encre Edges")).images
    return made["Encre Lines"][..., 3].astype(float)


def off_the_line(t, a, b):
    """How far the ink's centre lies beside the line from a to b, by steps of a pixel along it, without the ends; and
    the amounts of ink."""
    way = np.subtract(b, a) / np.hypot(*np.subtract(b, a))
    y, x = np.nonzero(t)
    along, beside = (x - a[0]) * way[0] + (y - a[1]) * way[1], (y - a[1]) * way[0] - (x - a[0]) * way[1]
    step = np.floor(along).astype(int)
    inside = (step > 3) & (step < np.hypot(*np.subtract(b, a)) - 4)
    ink = np.bincount(step[inside], t[y, x][inside])[4:]
    return np.bincount(step[inside], (t[y, x] * beside)[inside])[4:] / ink, ink


@pytest.mark.parametrize("b", [(70.2, 41.4), (70.2, 11.7), (21.3, 55.1), (69.3, 12.9)])
def test_a_mark_is_drawn_where_it_lies_and_as_wide_as_asked(b):
    a = (9.3, 11.7)
    layers = wall(ends=(a, b))
    for thickness in (1.0, 3.0):
        off, amount = off_the_line(ink(layers, line_thickness=thickness), a, b)
        nine = np.ones(9) / 9  # a step alone sees how pixels meet the line
        assert np.abs(np.convolve(off, nine, "valid")).max() < 0.08
        assert np.mean(amount) == pytest.approx(thickness, rel=0.03)
        assert np.convolve(amount, nine, "valid").min() > 0.9 * thickness


def test_weight_width_and_style():
    layers = wall()
    full = ink(layers)
    assert ink(layers, line_mark_strength=0.0).max() == 0
    assert ink(layers, line_mark_strength=0.2).max() == 0 and PEN["edge_threshold"] > 0.2
    assert ink(layers, line_mark_width=2.0).sum() == pytest.approx(2 * full.sum(), rel=0.05)
    layers["style"] = np.zeros((60, 80, 1), np.float32)
    layers["style"][:, 40:] = 1
    half = ink(layers, ({"line_mark_strength": 0.0},))
    assert np.array_equal(half[:, :37], full[:, :37]) and not half[:, 43:].any()
    assert 0.5 < ink(layers, ({"line_mark_width": 3.0},))[:, 43:].sum() / full[:, 43:].sum() / 3 < 1.5


def test_lines_that_cross_or_meet_hang_together():
    across = ((10.2, 12.1), (68.8, 44.9), (12.3, 45.2), (66.1, 9.8))
    t = ink(wall(ends=across), line_thickness=2.0)
    one, two = (ink(wall(ends=ends), line_thickness=2.0) for ends in (across[:2], across[2:]))
    assert np.abs(t - np.maximum(one, two)).max() < 0.35  # they are joined by what lies between their crossings
    corner = ((10.2, 40.1), (40.6, 12.3), (40.6, 12.3), (69.4, 38.2))
    t = ink(wall(ends=corner), line_thickness=2.0)
    assert t[11:14, 39:43].max() == 1 and t[:10].max() == 0
    assert np.abs(off_the_line(t[:, :39], *corner[:2])[0]).max() < 0.3


@pytest.mark.parametrize("rise", [0.0, 0.05, 0.31, 0.6, -0.4])
@pytest.mark.parametrize("down", [False, True])
def test_of_two_marks_side_by_side_one_gives_way(rise, down):
    """The left, or upper, one is drawn whole, and no rungs lie between both."""
    def drawn(*gaps):
        ends = [(x, 30.3 + rise * (x - 40) + gap * np.hypot(1, rise)) for gap in gaps for x in (4.2, 75.4)]
        return ink(wall(80, 80, ends=[end[::-1] for end in ends] if down else ends), line_thickness=3.0)[10:70, 10:70]
    alone = drawn(0)
    assert drawn(0, 4.5).sum() == pytest.approx(2 * alone.sum(), rel=0.03)
    for gap in (0.5, 0.7, 1.0, 1.3):
        assert 0.95 < drawn(0, gap).sum() / alone.sum() < 1.2
    assert np.abs(drawn(0, 1.3) - alone).max() < 0.2


def test_a_mark_on_a_contour_or_a_crease_is_one_line():
    a, b = (40.3, -3.0), (37.1, 63.0)
    layers = wall(ends=(a, b))
    y, x = np.mgrid[:60, :80]
    left = x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    marked = ink(layers, line_mark_width=2.0)[10:50].sum()
    layers["normal"][left] = 0.6, 0, 0.8
    assert ink(layers, line_mark_width=2.0)[10:50].sum() == pytest.approx(marked, rel=0.02)  # the crease is the mark's
    layers["depth"][left] = 3
    contour = ink({**layers, "marks": 0 * layers["marks"]})
    assert np.abs(ink(layers, line_mark_width=2.0) - contour).max() < 0.05  # the contour's line it is


@pytest.mark.parametrize("what", ["object", "depth", "nothing"])
def test_a_contour_is_where_it_is_told(what):
    a, b = (40.3, -3.0), (37.1, 63.0)
    layers = wall(ends=(a, b), contour=True)
    assert not ink(layers).any()
    y, x = np.mgrid[:60, :80]
    left = x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    layers["object" if what == "object" else "depth"][left] = 1e10 if what == "nothing" else 1
    t = ink(layers)
    centre = (t * x).sum(1) / t.sum(1)
    exact = a[0] + (np.arange(60) - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    assert np.abs(centre - exact)[3:-3].max() < 0.06
    del layers["marks"]
    blind = ink(layers)
    assert np.abs((blind * x).sum(1) / blind.sum(1) - exact)[3:-3].max() > 0.2  # nothing else shows where


# ---- contours within a body ----------------------------------------------------------------------------------------


def body(ends, steps, meshes=True):
    """A wall that is all one surface, before which contours come, `steps` (H, W, 2) or one number before what is behind
    them."""
    layers = wall(ends=ends, contour=True)
    layers["marks"] = np.where(layers["marks"] < 0, layers["marks"] - 2 * np.float32(steps), 0).astype(np.float32)
    return layers | ({"creases": np.zeros((60, 80, 5), np.float32)} if meshes else {})


LONG = ((9.3, 11.7), (70.2, 41.4))


def test_a_contour_that_hardly_comes_before_its_own_body_is_a_line():
    t = ink(body(LONG, 3))
    off, amount = off_the_line(t, *LONG)
    nine = np.ones(9) / 9
    assert np.abs(np.convolve(off, nine, "valid")).max() < 0.1 and np.convolve(amount, nine, "valid").min() > 0.9
    assert not ink(body(LONG, 3), line_inner_strength=0.0).any() and not ink(body(LONG, 3),
                                                                             crease_source="LAYERS").any()
    assert not ink(body(LONG, 3, meshes=False)).any()  # the layers are asked, in which nothing is


def test_a_contour_fades_into_its_body_and_no_short_one_is_only_faint():
    x = np.arange(80)[None, :, None]
    sure, faint = ink(body(LONG, 3)), ink(body(LONG, np.where(x < 40, 3, 1)))
    assert np.array_equal(sure[:, :35], faint[:, :35])
    assert 0.3 < faint[:, 45:].sum() / sure[:, 45:].sum() < 0.7
    assert 0.6 < ink(body(LONG, 2)).sum() / sure.sum() < 0.9
    short = (30.2, 20.1), (42.1, 26.3)
    assert not ink(body(short, 2), line_shortest=0.0).any() and ink(body(short, 3), line_shortest=0.0).any()


def test_a_place_of_a_contour_alone_is_no_line():
    layers = body(LONG, 3)
    layers["marks"][:] = 0
    layers["marks"][30, 40, 0] = -8.5
    assert not ink(layers).any() and ink(layers, line_shortest=0.0).any()


def test_ripples_make_no_specks():
    speck = ((30.2, 20.1), (36.8, 24.3))
    layers = body(speck, 4)
    assert not ink(layers, line_shortest=9.0).any() and ink(layers, line_shortest=4.0).any()
    layers["object"][:, 33:] = 1  # what has an outline in it is no ripple
    assert ink(layers, line_shortest=9.0)[:, 31:35].any()


@pytest.mark.parametrize("below, seen", [(-0.6, True), (0.6, False)])
@pytest.mark.parametrize("one_mesh", [False, True])
def test_the_rim_of_a_piece_under_another_is_no_contour(below, seen, one_mesh):
    """Both lie aslant, so that from pixel to pixel depth changes by more than what parts them."""
    x, y = (v.ravel() for v in np.meshgrid((4, 12, 20.3), (2, 8, 22, 28)))
    corners = [(k, k + 1, k + 4, k, k + 4, k + 3) for k in (0, 1, 3, 4, 6, 7)]
    rim = Mesh(np.stack([x, y, 20 - x - 29.7 - below], 1).astype(np.float32), np.int32(corners).reshape(-1, 3))
    over = np.float32([(-50, -50, 70), (90, -50, -70), (20, 120, 0)]) - np.float32((0, 0, 29.7))
    meshes = [rim, Mesh(over, np.int32([(0, 1, 2)]))]
    got = library.raster([joined(*meshes)] if one_mesh else meshes, *pixels(40, 30), Frame(40, 30), (40, 30), 0.1,
                         outputs=("depth", "marks"))["marks"]
    assert told(got[10:20, 18:22, 0]).any() == seen
