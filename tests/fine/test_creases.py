# SPDX-License-Identifier: GPL-3.0-or-later
"""Creases of meshes: which edges that bend are lines, and what normals show besides."""

import chained
import numpy as np
import pytest
from encre.pen import abi, library, presets
from encre.pen.job import EDGES, Camera, Chains, Frame, Mesh, edge_kinds
from views import pixels


def fold(degrees, depth=30.0, **more):
    """Two squares that meet along a line down the middle of 40 x 30 pixels, bent by that much."""
    x = np.cos(np.radians(degrees))
    points = [(4, 4, 0), (20.3, 4, 0), (20.3, 26, 0), (4, 26, 0),
              (20.3 + 16 * x, 4, -16 * np.sin(np.radians(degrees))),
              (20.3 + 16 * x, 26, -16 * np.sin(np.radians(degrees)))]
    return Mesh(np.float32(points) - np.float32((0, 0, depth)),
                np.int32([(0, 1, 2), (0, 2, 3), (1, 4, 5), (1, 5, 2)]), **more)


def picture(mesh, **values):
    """The lines of meshes under pixels(40, 30), with normals that show nothing."""
    meshes = mesh if isinstance(mesh, list) else [mesh]
    layers = chained.layers(meshes, *pixels(40, 30), Frame(40, 30), (40, 30))
    scene = dict(edge_detector="FINE", line_thickness=3.0, length_unit="PIXELS", pen_1_softness=0.0, pen_1_grain=0.0,
                 pen_1_steepness=0.5, pen_1_intensity=2.0, line_crease_width=1.0)
    camera = Camera(orthographic=True, height=30.0)
    drawn = library.render(layers, {**scene, **values}, camera=camera, outputs=("Encre Lines",))
    return drawn.images["Encre Lines"][..., 3]


@pytest.mark.parametrize("angle", [12.0, 20.0, 60.0])
def test_half_a_degree_decides(angle):
    below, above = (picture(fold(angle + off), crease_angle=angle) for off in (-0.5, 0.5))
    assert not below[8:22, 16:25].any()
    assert (above[8:22, 16:25].sum(1) > 1).all(), "from end to end"
    np.testing.assert_allclose(picture(fold(angle + 4.1), crease_angle=angle)[8:22, 16:25].sum(1), 3, atol=0.15)


def test_an_edge_that_bends_more_and_more_does_not_pop():
    """As an elbow's does: the line comes as about half of what it grows to in 4 degrees, evenly."""
    inks = np.array([picture(fold(32 + off), crease_angle=32.0)[8:22, 16:25].sum()
                     for off in (-0.1, *np.arange(0.1, 4.5, 0.2))])
    steps = np.diff(inks) / inks[-1]
    assert inks[0] == 0 and steps[0] < 0.55
    assert steps[1:].min() > -0.01 and steps[1:].max() < 0.08


def test_meshes_or_normals():
    assert not picture(fold(60), crease_source="LAYERS")[8:22, 16:25].any(), "the normals show none"
    smooth = edge_kinds(np.full((4, 3), EDGES["smooth"]))
    assert not picture(fold(50, edges=smooth))[8:22, 16:25].any()
    assert picture(fold(50, edges=smooth), crease_angle_smooth=40.0)[8:22, 16:25].any()
    assert picture(fold(50), line_crease_strength=0.0)[8:22, 16:25].any() == np.False_


def test_technical_drawings_have_corners_of_smooth_boxes_and_no_scraps_of_cloth():
    """Where the triangles of a cloth happened to bend by more than 60 degrees it looked torn."""
    smooth = edge_kinds(np.full((4, 3), EDGES["smooth"]))
    angle = presets.find("technical_drawing").values["crease_angle_smooth"]
    assert angle < 90 and not picture(fold(75, edges=smooth), crease_angle_smooth=angle)[8:22, 18:22].any()
    assert picture(fold(75, edges=smooth))[8:22, 18:22].any()


def two_folds(above, below):
    """As fold(), shaded smoothly: the upper half of the line bends by the one, the lower half by the other."""
    points = [(4, y, 0) for y in (4, 15, 26)] + [(20.3, y, 0) for y in (4, 15, 26)]
    for degrees, y in ((above, 4), (below, 26)):
        points.append((20.3 + 16 * np.cos(np.radians(degrees)), y, -16 * np.sin(np.radians(degrees))))
    faces = [(0, 3, 4), (0, 4, 1), (1, 4, 5), (1, 5, 2), (3, 6, 4), (4, 6, 7), (4, 7, 5)]
    return Mesh(np.float32(points) - np.float32((0, 0, 30)), np.int32(faces),
                edges=edge_kinds(np.full((7, 3), EDGES["smooth"])))


@pytest.mark.parametrize(("below", "goes_on"), [(25.5, True), (28.0, True), (24.5, False)])
def test_a_smooth_edge_goes_on_beside_one_that_bends_enough(below, goes_on):
    ink = picture(two_folds(35, below), crease_angle_smooth=30.0)[:, 16:25].sum(1)
    np.testing.assert_allclose(ink[7:13], 3, atol=0.45)
    np.testing.assert_allclose(ink[18:23], 0.55 * 3 * goes_on, atol=0.25)
    assert not picture(two_folds(below, below), crease_angle_smooth=30.0)[8:22,
                                                                          16:25].any(), "beside nothing it is none"


def leaving(angle, left, bend=50.0):
    """A sheet with a fold that leaves the upper corner of its left outline by so many degrees."""
    aside = np.tan(np.radians(angle)) * 22
    down = -22 * np.sin(np.radians(angle)) * np.tan(np.radians(bend))
    points = [(left, 4, 0), (left, 26, down), (left + aside, 26, 0), (36, 26, 0), (36, 4, 0)]
    return Mesh(np.float32(points) - np.float32((0, 0, 30)), np.int32([(0, 1, 2), (0, 2, 3), (0, 3, 4)]))


@pytest.mark.parametrize("angle", [13, 15])
def test_a_fold_that_leaves_an_outline_at_an_angle_has_no_gap(angle):
    """Beside the outline it would thin out, were it along it."""
    for left in np.arange(10, 11, 0.2):
        t = picture(leaving(angle, left), line_thickness=1.0)
        rows = np.arange(12, 22)
        fold = left + np.tan(np.radians(angle)) * (rows + 0.5 - 4) - 0.5
        ink = np.take_along_axis(t[rows], np.rint(fold).astype(int)[:, None] + (-1, 0, 1), 1).sum(1)
        assert ink[fold > left + 1.2].min() > 0.45


def bumped(noise, rows=70, columns=90):
    """Layers of a wall on which a bump map has a groove that winds, of two slopes of 25 degrees, and noise."""
    fine = 4
    y, x = (np.indices((rows * fine, columns * fine)) + 0.5) / fine
    slope = np.where(x > 45 + y / 9 + 4 * np.sin(y / 11), 1.0, -1.0) * np.tan(np.radians(25))
    normal = np.stack([slope, 0 * slope, np.ones_like(slope)], -1) / np.sqrt(1 + slope**2)[..., None]
    normal = normal.reshape(rows, fine, columns, fine, 3).mean((1, 3))
    normal += noise * np.random.default_rng(1).standard_normal(normal.shape)
    flat = np.ones((rows, columns, 3))
    layers = dict(combined=np.ones((rows, columns, 4)), color=flat, diffuse=flat, depth=5 * flat[..., 0], normal=normal,
                  object=flat[..., 0])
    nothing = Chains(np.zeros(0, abi.CHAIN_POINT), np.ones(2, np.uint8))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()} | {"chains": nothing}


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_bumps_are_whole_lines_where_they_are_asked_for(noise):
    """Each row has the groove's, where it is, and nothing else."""
    def ink(weight):
        scene = dict(crease_bumps=weight, line_thickness=3.0, line_crease_width=1.0, length_unit="PIXELS",
                     pen_1_softness=0.0)
        return library.render(bumped(noise), scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3]
    drawn, rows = ink(1.0)[3:-3], np.arange(3, 67) + 0.5
    middle = 45 + rows / 9 + 4 * np.sin(rows / 11)
    columns = np.arange(drawn.shape[1]) + 0.5
    assert (drawn.sum(1) > 1).all()
    assert np.abs((drawn * columns).sum(1) / drawn.sum(1) - middle).max() < 0.4
    assert not drawn[np.abs(columns - middle[:, None]) > 4].any()
    assert not ink(0.0).any()


def ribbon(width, slant):
    """A strip so many pixels wide between two faces, from which both bend away by 40 degrees, aslant."""
    far = 12 - width / 2
    points = [(20.3 + a * np.cos(slant) - v * np.sin(slant), 15.2 + a * np.sin(slant) + v * np.cos(slant), z - 30)
              for a, z in ((-12, -0.84 * far), (-width / 2, 0), (width / 2, 0), (12, -0.84 * far)) for v in (-12, 12)]
    return Mesh(np.float32(points), np.int32([f for k in (0, 2, 4) for f in ((k, k + 1, k + 3), (k, k + 3, k + 2))]))


@pytest.mark.parametrize("slant", [-1.2, -0.79, -np.pi / 4, -0.4, 0.0, np.pi / 4, 1.2])
def test_of_two_edges_that_bend_alike_one_stays_whichever_way_they_go(slant):
    """As of a chamfer. Rows gave way to the one and columns to the other: at 45 degrees nothing stayed."""
    ink = picture(ribbon(1.4, slant), line_thickness=1.0)[9:22, 14:27].sum()
    assert ink * max(np.cos(slant), abs(np.sin(slant))) == pytest.approx(13, rel=0.2)


def roof(aside, ends=(8, 22)):
    """A sheet whose only edge runs down so many pixels beside its left outline and ends in the open."""
    points = [(10.2, 3, 0), (36, 3, 0), (36, 27, 0), (10.2, 27, 0), *((10.2 + aside, y, 2) for y in ends)]
    faces = np.int32([(0, 4, 5), (0, 5, 3), (1, 2, 5), (1, 5, 4), (0, 1, 4), (3, 5, 2)])
    kinds = np.full((6, 3), EDGES["none"])
    kinds[0, 1] = kinds[3, 1] = EDGES["flat"]
    return Mesh(np.float32(points) - np.float32((0, 0, 30)), faces, edges=edge_kinds(kinds))


@pytest.mark.parametrize("aside", [2.8, 3.3])
def test_an_edge_beside_an_outline_that_has_room_is_drawn(aside):
    """What gives way to the outline thins out; it was dropped, as what the layers find beside one, if it was loose."""
    ink = picture(roof(aside), line_thickness=1.0)[10:20, int(11.5 + aside / 2):20].sum(1)
    np.testing.assert_allclose(ink, 1, atol=0.2)


def bolt(radius, shift):
    """A column of six sides from above, moved aside and down."""
    turn = np.arange(6) * np.pi / 3 + 0.2
    ring = np.stack([radius * np.cos(turn), 0.6 * radius * np.sin(turn)], 1) + (19.8 + shift, 13.6 + 0.73 * shift)
    points = [(x, y + dy, 0.8 * y + z - 40) for dy, z in ((0, 0), (0.6 * radius, -0.8 * radius)) for x, y in ring]
    sides = [f for k in range(6) for m in [(k + 1) % 6] for f in ((k, 6 + k, 6 + m), (k, 6 + m, m))]
    return Mesh(np.float32(points), np.int32([*((0, k, k + 1) for k in range(1, 5)), *sides]))


def button(side):
    """A square that stands out of a wall, towards the eye."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    rings = (side / 2, 0), (side / 2 + 0.05, -2), (13, -2)
    points = [(20.2 + r * x, 15.1 + r * y, z - 30) for r, z in rings for x, y in corners]
    sides = [f for a in (0, 4) for k in range(4) for m in [(k + 1) % 4]
             for f in ((a + k, a + m, a + 4 + m), (a + k, a + 4 + m, a + 4 + k))]
    return Mesh(np.float32(points), np.int32([(0, 1, 2), (0, 2, 3), *sides]))


def test_a_small_thing_is_thin_beside_others():
    """What another one has of edges close by is no part of it."""
    far = bolt(9, 0)
    far.points = far.points + np.float32((-12.3, 0.4, 0.2))
    far.object_index = 2
    inside = [picture(mesh, line_thickness=1.0)[11:17, 18:22].sum() for mesh in (bolt(4, 0), [bolt(4, 0), far])]
    assert inside[1] < 1.1 * inside[0]


@pytest.mark.parametrize("side", [6, 9])
def test_a_small_thing_that_edges_alone_show_is_whole(side):
    ink = picture(button(side), line_thickness=1.0)[8:23, 13:28].sum()
    assert ink == pytest.approx(4 * side, rel=0.1)


def fading_fold(first, last, seed, rows=70, columns=200):
    """Layers of a wall that no mesh tells of, with a fold of so many degrees at its left, and at its right; noise of
    1 %."""
    fine = 4
    y, x = (np.indices((rows * fine, columns * fine)) + 0.5) / fine
    bend = np.radians(np.interp(x, (10, columns - 10), (first, last)))
    slope = np.where(y > 35 + x / 19 + 3 * np.sin(x / 13), 1, -1) * np.tan(bend / 2)
    normal = np.stack([0 * slope, slope, np.ones_like(slope)], -1) / np.sqrt(1 + slope**2)[..., None]
    normal = normal.reshape(rows, fine, columns, fine, 3).mean((1, 3))
    normal += 0.01 * np.random.default_rng(seed).standard_normal(normal.shape)
    white = np.ones((rows, columns, 3))
    layers = dict(combined=np.ones((rows, columns, 4)), color=white, diffuse=white, depth=5 * white[..., 0],
                  normal=normal, object=white[..., 0])
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


@pytest.mark.parametrize("seed", range(3))
def test_weak_parts_of_a_ridge_live_with_strong_ones(seed):
    """Lines of LAYERS along folds: none, or whole, or one that ends once; between, no dashes as short as noise is."""
    scene = dict(crease_source="LAYERS", crease_angle=32.0, line_thickness=3.0, line_crease_width=1.0,
                 length_unit="PIXELS",
                 pen_1_softness=0.0, pen_1_grain=0.0)

    def lengths(first, last):
        layers = fading_fold(first, last, seed)
        drawn = library.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3]
        on = np.concatenate([[0], (drawn.max(0)[5:-5] > 0.25).astype(int), [0]])
        return np.diff(np.flatnonzero(np.diff(on)))[::2]

    assert len(lengths(13, 13)) == 0
    assert lengths(18, 18).tolist() == [190]
    fading = lengths(40, 10)
    assert len(fading) == 1 and 100 < fading[0] < 185
    for angle in (14, 14.5, 15):
        assert (lengths(angle, angle)[1:-1] >= 12).all()
