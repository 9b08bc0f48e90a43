# SPDX-License-Identifier: GPL-3.0-or-later
"""Bends over several faces: one line where they are narrow on the screen, none on what is round."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import EDGES, Camera, Frame, Mesh, edge_kinds
from encre.pen.overlay import bends
from reference.bevels import SPREAD, spread
from views import pixels

FRAME, SIZE = Frame(960, 540, 400, 200), (64, 48)  # windows are as wide as in a frame of 540 lines


def turned(points, degrees):
    """About the middle of what is drawn."""
    a = np.radians(degrees)
    way = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    return (points @ way.T + (432.2, 224.1, -60)).astype(np.float32)


def bevel(segments, width, degrees=20.0, bend=90.0, kind="flat"):
    """Two faces 50 long that meet under `bend`, rounded off over so many pixels of the picture by so many faces."""
    if segments == 0:
        turns = np.array([bend])
    else:
        turns = np.full(segments + 1, bend / segments)
        turns[[0, -1]] /= 2
    heading = np.radians(np.concatenate([[0], np.cumsum(turns)]) - bend / 2)
    chord = np.concatenate([[30], np.ones(max(segments, 1) if segments else 0), [30]])
    if segments:
        chord[1:-1] = width / np.cos(heading[1:-1]).sum()
    return folded(heading, chord, degrees, kind)


def folded(heading, chord, degrees=0.0, kind="flat"):
    """A strip of faces, each with its heading and its length."""
    at = np.concatenate([[(0, 0)], np.cumsum(chord[:, None] * np.stack([np.cos(heading), -np.sin(heading)], 1), 0)])
    at -= (at[len(at) // 2] + at[(len(at) - 1) // 2]) / 2
    points = np.concatenate([np.c_[at[:, 0], np.full(len(at), y), at[:, 1]] for y in (-60, 60)])
    k = np.arange(len(at) - 1)
    corners = np.concatenate([np.c_[k, k + 1, k + 1 + len(at)], np.c_[k, k + 1 + len(at), k + len(at)]])
    kinds = edge_kinds(np.full((len(corners), 3), EDGES[kind]))
    return Mesh(turned(points, degrees), corners.astype(np.int32), edges=kinds)


def wheel(sides, radius, around=0.0, kind="flat", degrees=25.0):
    """A cylinder that lies across the picture, of so many sides; half of it is seen."""
    a = np.arange(sides + 1) * 2 * np.pi / sides + around
    points = np.concatenate([np.c_[radius * np.cos(a), np.full(len(a), y), radius * np.sin(a)] for y in (-60, 60)])
    k = np.arange(sides)
    corners = np.concatenate([np.c_[k, k + 1, k + 2 + sides], np.c_[k, k + 2 + sides, k + 1 + sides]])
    kinds = edge_kinds(np.full((len(corners), 3), EDGES[kind]))
    return Mesh(turned(points, degrees), corners.astype(np.int32), edges=kinds)


def ball(rings, radius):
    around, up = np.meshgrid(np.arange(2 * rings) * np.pi / rings, np.linspace(0, np.pi, rings + 1))
    points = radius * np.stack([np.cos(around) * np.sin(up), np.cos(up), np.sin(around) * np.sin(up)], -1)
    n = 2 * rings
    a = np.arange(n * rings)
    b = a // n * n + (a + 1) % n
    corners = np.concatenate([np.c_[a, b, b + n], np.c_[b + n, a + n, a]])
    return Mesh(turned(points.reshape(-1, 3), 25), corners.astype(np.int32))


def drawn(mesh, camera=None, **how):
    return library.raster([mesh], *(camera or pixels(960, 540)), FRAME, SIZE, 0.1, outputs=(
        "depth", "normal", "object", "marks", "creases"), **how)


def picture(mesh, **values):
    """The lines of a mesh, with normals that show nothing."""
    maps = drawn(mesh)
    creases = np.concatenate([maps["creases"], bends(maps["normal"])[..., None]], 2)
    grey = np.full((*SIZE[::-1], 3), 0.5, np.float32)
    layers = dict(combined=np.dstack([grey, np.ones(SIZE[::-1], np.float32)]), color=grey, diffuse=grey,
                  depth=maps["depth"], normal=np.zeros_like(grey), object=maps["object"], marks=maps["marks"],
                  creases=creases)
    scene = dict(edge_detector="FINE", line_thickness=3.0, length_unit="PIXELS", pen_1_softness=0.0, pen_1_grain=0.0,
                 pen_1_steepness=0.5, pen_1_intensity=2.0, line_crease_width=1.0, line_inner_strength=0.0,
                 line_outline_strength=0.0)
    camera = Camera(orthographic=True, height=540.0)
    out = library.render(layers, {**scene, **values}, camera=camera, frame=FRAME, outputs=("Encre Lines",))
    return out.images["Encre Lines"][..., 3]


def widths(mesh, **values):
    """How much ink rows have, across the line; and how far its middle is from where it should be, in pixels."""
    t = picture(mesh, **values)[10:-10]
    return t.sum(1), (t * np.arange(SIZE[0])).sum(1) / np.maximum(t.sum(1), 1e-6)


@pytest.mark.parametrize("segments", [2, 3, 4, 6, 10, 24])
@pytest.mark.parametrize("width", [1.0, 2.0, 3.5, 4.5])
def test_a_narrow_bevel_is_one_line(segments, width):
    for degrees in (0, 12, 27):
        amount, middle = widths(bevel(segments, width, degrees))
        slope = np.tan(np.radians(degrees))
        np.testing.assert_allclose(amount * np.cos(np.radians(degrees)), 3, atol=0.5)
        rows = np.arange(10, SIZE[1] - 10)
        want = 432.2 - 400 - 0.5 - slope * (rows + 200.5 - 224.1)
        assert np.abs(middle - want).max() < 0.6 + 0.1 * width, (degrees, np.abs(middle - want).max())


@pytest.mark.parametrize("degrees", [0, 90])
@pytest.mark.parametrize("sliver", [0.1, 0.6])
@pytest.mark.parametrize("beyond", [1.7, 2.1])
def test_it_is_straight_beside_an_outline_that_pixels_cut_to_steps(degrees, sliver, beyond):
    """A chair's seat: two bevels, of which the lower ends in a face narrower than a pixel that few rows see."""
    heading = np.radians(np.cumsum([-78, 22.5, 45, 22.5, 22.5, 45]))
    mesh = folded(heading, np.array([30, 1.86, 2.74, 3.36, beyond, sliver]) / np.cos(heading), degrees + 8)
    axis, creases = degrees // 90, drawn(mesh)["creases"]
    y, x = np.nonzero(np.abs(creases[..., 2 * axis + 1]) > SPREAD)
    at, along = (y, x) if axis else (x, y)
    place = at + creases[y, x, 2 * axis]
    assert len(np.unique(along)) == len(along) > 40
    assert np.abs(place - np.polyval(np.polyfit(along, place, 1), along)).max() < 0.1


@pytest.mark.parametrize("order", [1, -1])
def test_a_face_along_an_axis_is_no_end_of_the_surface(order):
    """Its normal has two zeros, where that of nothing has three; whichever axis it is, the bend is the same."""
    heading, chord = np.radians([0, 22, 44, 66, 88]), np.array([30, 0.8, 1, 1.5, 200])
    mesh, (view, projection) = folded(order * heading[::order], chord[::order]), pixels(960, 540)
    points, kinds = mesh.points, []
    for axis in range(3):
        way = np.roll(np.eye(3), axis, 0)  # what looks along z looks along another
        mesh.points, view = (points @ way).astype(np.float32), view.copy()
        view[:3, :3] = way
        maps = drawn(mesh, (view, projection))
        assert (np.sort(maps["normal"].reshape(-1, 3), 1) == (0, 0, 1)).all(1).any()
        kinds.append(maps["creases"])
    assert (np.abs(kinds[0][..., [1, 3]]) > SPREAD).any((1, 2))[10:-10].all()
    np.testing.assert_array_equal(kinds[1], kinds[0])
    np.testing.assert_array_equal(kinds[2], kinds[0])


@pytest.mark.parametrize("degrees", [14, 31])
def test_it_fades_evenly_as_it_comes_near(degrees):
    rows = [widths(bevel(8, width, degrees))[0] for width in np.arange(4, 13, 0.5)]
    ink = np.array([row.mean() for row in rows]) * np.cos(np.radians(degrees))
    assert ink[0] > 2.7 and max(ink[-4:]) == 0
    assert np.diff(ink).min() > -1.6 and np.diff(ink).max() < 0.1, "not at once, nor to and fro"
    assert sum(0.2 < i < 2.6 for i in ink) >= 3
    assert max(row.std() / row.mean() for row in rows if row.mean() > 0.8) < 0.2, "all of it"


@pytest.mark.parametrize("kind", ["flat", "smooth"])
def test_what_is_round_has_no_line(kind):
    for radius in (3, 5, 8, 13, 24, 60):
        for sides in (16, 24, 32, 64):
            for around in (0, 0.07):
                maps = drawn(wheel(sides, radius, around, kind))
                inner = np.abs(maps["creases"][8:-8, 8:-8, [1, 3]])
                assert (inner % SPREAD).max() < 32, (radius, sides)
        for rings in (12, 16):
            assert not picture(ball(rings, radius))[2:-2, 2:-2].any(), (radius, rings)


@pytest.mark.parametrize("sides, radius", [(24, 3.5), (24, 7), (36, 6)])
def test_nor_has_a_nearly_level_rod(sides, radius):
    """Faces beside its outlines are narrower than a pixel: rows see other ones, or two edges as one."""
    for degrees in (90, 90.25, 90.75):
        for around in (0, 0.05, 0.1):
            creases = drawn(wheel(sides, radius, around, degrees=degrees))["creases"]
            assert (np.abs(creases[4:-4, 4:-4, [1, 3]]) % SPREAD).max() < 32, (degrees, around)


def test_smooth_ones_need_the_angle_of_smooth_edges():
    assert widths(bevel(4, 3, bend=50, kind="smooth"))[0].max() == 0
    assert widths(bevel(4, 3, bend=50, kind="smooth"), crease_angle_smooth=40.0)[0].min() > 1
    assert widths(bevel(4, 3, bend=50))[0].min() > 1
    assert widths(bevel(4, 3, bend=90, kind="smooth"))[0].min() > 2


def ripple(size, kind):
    """Cloth whose folds go up and down by three edges each, so many pixels from edge to edge."""
    heading = np.radians(np.tile([-75, -25, 25, 75, 25, -25], 4))
    return folded(heading, size / np.cos(heading), 20, kind)


@pytest.mark.parametrize("size", [0.5, 0.7])
def test_smooth_cloth_that_folds_everywhere_has_no_line(size):
    assert not picture(ripple(size, "smooth"), crease_angle_smooth=40.0)[8:-8].any()
    assert picture(ripple(12, "smooth"), crease_angle_smooth=40.0)[8:-8].any(), "by itself each is one"


def test_a_sharp_edge_stays_what_it_is():
    maps = drawn(bevel(0, 0))
    alone = library.raster([bevel(0, 0)], *pixels(960, 540), FRAME, SIZE, 0.1, outputs=("creases",))
    np.testing.assert_array_equal(maps["creases"], alone["creases"])


def test_the_two_edges_of_a_chamfer_are_one_line_where_they_are_close():
    near, apart = (picture(bevel(1, width, 8), line_thickness=1.0)[24] > 0.3 for width in (2.5, 9))
    assert np.diff(np.flatnonzero(near)).max(initial=1) == 1 and near.sum() <= 2
    assert np.diff(np.flatnonzero(apart)).max() > 5


@pytest.mark.parametrize("degrees", [3, 20, 45, 88])
def test_a_chamfer_goes_from_one_line_to_two_by_degrees(degrees):
    """They flipped where its edges were 3.1 pixels apart along a row, which is 2.2 across a diagonal."""
    apart, (high, wide) = np.arange(2.4, 3.7, 0.05), SIZE[::-1]
    y, x = np.mgrid[:high, :wide] + 0.5
    inner = np.abs((y - 24.1) * np.cos(np.radians(degrees)) - (x - 32.2) * np.sin(np.radians(degrees))) < 10
    ink = np.array([picture(bevel(1, w, degrees), line_thickness=1.0)[inner].sum() / 20 for w in apart])
    np.testing.assert_allclose(ink[[0, -1]], (1, 2), atol=0.2)
    assert np.diff(ink).max() < 0.4 and np.diff(ink).min() > -0.1
    assert 2.9 < apart[np.argmax(ink > 1.5)] < 3.5, "whichever way it runs"


@pytest.mark.parametrize("turn", [3, 40, 86])
@pytest.mark.parametrize("period", [6.3, 8.4])
def test_of_edges_too_close_to_be_told_apart_one_is_a_line(turn, period):
    """Folds of a cloth, each of several edges that bend enough, two pixels apart; they met in knots and ladders."""
    strips = np.arange(18)
    heading = np.radians(60 * np.cos(2 * np.pi * strips / period + 0.4))
    t = picture(folded(heading, np.full(18, 2.0), turn), crease_angle=20.0, line_thickness=1.0)
    ink = t.sum(0)[14:-14] if turn > 45 else t.sum(1)[8:-8]
    assert np.ptp(ink) < 0.5
    if turn != 40:
        assert ink.mean() == pytest.approx(2 * 18 / period, abs=0.5), "a line for each fold"


@pytest.mark.parametrize("width", [2.5, 3.1, 3.4])
def test_a_line_has_no_gaps_where_an_edge_of_its_bevel_goes_by(width):
    """Seen from below, where the bevel's last faces are narrow: one of its edges, which is no line, comes into the
    same pixels where the line goes from one column to the next."""
    heading, chord = np.radians([-8, 7, 37, 67, 82]), np.array([30, width, width, width, 9])
    assert widths(folded(heading, chord, 1.3), crease_angle=32.0)[0].min() > 0.5


def spire(rng, middle):
    """A few faces that meet at a point, where what rows and columns cross has any angle to each other."""
    n = int(rng.integers(3, 9))
    around = np.sort(rng.uniform(0, 2 * np.pi, n)) + 0.2 * np.arange(n)
    ring = np.c_[30 * np.cos(around), 30 * np.sin(around), rng.uniform(-30, -8, n)]
    k = np.arange(n)
    corners = np.c_[np.zeros(n), 1 + k, 1 + (k + 1) % n].astype(np.int32)
    points = np.r_[[(0, 0, 0)], ring] + (*middle, -60)
    return Mesh(points.astype(np.float32), corners, edges=edge_kinds(np.full((n, 3), EDGES["flat"])), object_index=3)


def folds(rng, high):
    """One or two strips of faces that turn a little everywhere and more in their middle, under any angle."""
    meshes, narrow = [], max(1, high / 216)
    for k in range(int(rng.integers(1, 3))):
        n, m = int(rng.integers(4, 12)), int(rng.integers(1, 7))
        turns = rng.uniform(0, rng.choice([0, 1, 4]), 2 * n + m)
        turns[n:n + m] = rng.uniform(0.3, 1, m)
        turns[n:n + m] *= rng.uniform(25, 100) / turns[n:n + m].sum()
        chord = rng.uniform(1, 3, len(turns) - 1)
        if m > 1:
            chord[n:n + m - 1] = narrow * rng.uniform(0.2, 3.5) * rng.dirichlet(np.full(m - 1, 2.0))
        heading = np.radians(np.r_[0, np.cumsum(turns)] - turns.sum() / 2)
        mesh = folded(heading, np.r_[30, chord, 30], rng.choice([0, 90, rng.uniform(0, 180)]),
                      rng.choice(["flat", "smooth"]))
        mesh.model = mesh.model.copy()
        mesh.model[:3, 3] = rng.uniform(-4, 4), high / 2 - 224.1 + rng.uniform(-4, 4), -20 * k
        mesh.object_index = k + 1
        rng.shuffle(mesh.corners)
        meshes.append(mesh)
    return meshes if rng.random() < 0.7 else [spire(rng, (432 + rng.uniform(-3, 3), high / 2 + rng.uniform(-3, 3)))]


@pytest.mark.parametrize("seed", range(36))
def test_folds_by_chance_are_what_the_reference_makes_of_them(seed):
    rng, high, size = np.random.default_rng(seed), (100, 540, 1300)[seed % 3], ((28, 20), (20, 28))[seed % 2]
    frame = Frame(960, high, 432 - size[0] // 2, high // 2 - size[1] // 2)
    meshes = folds(rng, high)
    got, without = (library.raster(meshes, *pixels(960, high), frame, size, 0.1, outputs=("marks", "creases", *more))
                    for more in (("object", "normal"), ()))
    want = spread({**got, "creases": without["creases"]}, high)
    np.testing.assert_allclose(got["creases"], want, atol=1e-3)


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.long) for k in range(1, 6))])
def test_against_the_reference(seed):
    rng = np.random.default_rng(seed)
    meshes = [bevel(int(rng.integers(1, 9)), rng.uniform(1, 8), rng.uniform(0, 90), rng.uniform(50, 110),
                    rng.choice(["flat", "smooth"])), ball(6, rng.uniform(8, 14))]
    meshes[1].model = meshes[1].model.copy()
    meshes[1].model[:3, 3] = rng.uniform(-25, 25), rng.uniform(-18, 18), 60
    rng.shuffle(meshes[1].corners)
    got = library.raster(meshes, *pixels(960, 540), FRAME, SIZE, 0.1, outputs=("object", "normal", "marks", "creases"))
    without = library.raster(meshes, *pixels(960, 540), FRAME, SIZE, 0.1, outputs=("marks", "creases"))
    want = spread({**got, "creases": without["creases"]}, 540)
    assert (np.abs(want[..., [1, 3]]) > SPREAD).sum() > 10
    assert (np.abs(got["creases"] - want) > 1e-3).any(2).mean() < 0.001


@pytest.mark.parametrize("degrees", [0, pytest.param(90, marks=pytest.mark.slow)])
def test_at_every_distance_from_a_border(degrees):
    """A bend in what is round: what goes on beyond the border is guessed from the other side."""
    turns = np.r_[np.full(12, 3.0), 26, 26, np.full(12, 3.0)]
    heading = np.radians(np.r_[0, np.cumsum(turns)] - turns.sum() / 2)
    mesh, found = folded(heading, np.r_[30, np.full(25, 1.6), 30], degrees), 0
    for left in range(408, 433):
        frame, size = Frame(960, 540, left, 214), (24, 4)
        if degrees:
            frame, size = Frame(960, 540, 430, left - 208), (4, 24)
        got, without = (library.raster([mesh], *pixels(960, 540), frame, size, 0.1, outputs=("marks", "creases", *more))
                        for more in (("object", "normal"), ()))
        want = spread({**got, "creases": without["creases"]}, 540)
        found += (np.abs(want[..., [1, 3]]) > SPREAD).sum()
        np.testing.assert_allclose(got["creases"], want, atol=1e-3)
    assert found == 4 * 21


@pytest.mark.parametrize("threads", [1, 3])
def test_borders_and_threads_give_the_same_bytes(threads):
    whole = drawn(bevel(5, 4.5), threads=2)["creases"]
    part = library.raster([bevel(5, 4.5)], *pixels(960, 540), Frame(960, 540, 410, 207), (40, 36), 0.1, threads=threads,
                          outputs=("depth", "normal", "object", "marks", "creases"))["creases"]
    assert (np.abs(whole[..., [1, 3]]) > SPREAD).any()
    np.testing.assert_array_equal(part[10:-10, 10:-10], whole[17:33, 20:40])
