# SPDX-License-Identifier: GPL-3.0-or-later
"""Bends over several faces: one line where they are narrow on the screen, none on what is round."""

import chained
import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import EDGES, Camera, Frame, Mesh, edge_kinds
from known import KIND
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


def has_bevel(mesh):
    return (library.chains([mesh], *pixels(960, 540), FRAME, SIZE, 0.1)["kind"] & KIND["bevel"]).any()


def picture(mesh, **values):
    """The lines of a mesh, with normals that show nothing."""
    layers = chained.layers([mesh], *pixels(960, 540), FRAME, SIZE)
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
@pytest.mark.parametrize("width", [0.5, 1.0, 2.0, 3.5, 4.5])
def test_a_narrow_bevel_is_one_line(segments, width):
    for degrees in (0, 12, 27):
        amount, middle = widths(bevel(segments, width, degrees))
        slope = np.tan(np.radians(degrees))
        np.testing.assert_allclose(amount * np.cos(np.radians(degrees)), 3, atol=0.5)
        rows = np.arange(10, SIZE[1] - 10)
        want = 432.2 - 400 - 0.5 - slope * (rows + 200.5 - 224.1)
        assert np.abs(middle - want).max() < 0.3 + 0.6 * width / segments, (degrees, np.abs(middle - want).max())


@pytest.mark.parametrize("degrees", [14, 31])
def test_it_fades_evenly_as_it_comes_near(degrees):
    rows = [widths(bevel(8, width, degrees))[0] for width in np.arange(4, 13, 0.5)]
    ink = np.array([row.mean() for row in rows]) * np.cos(np.radians(degrees))
    assert ink[0] > 2.7 and max(ink[-2:]) == 0
    assert np.diff(ink).min() > -0.6 and np.diff(ink).max() < 0.1, "not at once, nor to and fro"
    assert max(row.std() / row.mean() for row in rows if row.mean() > 0.8) < 0.05, "all of it"


@pytest.mark.parametrize("width", [6.0, 8.0])
def test_it_fades_by_the_frame_not_by_pixels(width):
    """The same picture at twice the size."""
    small = widths(bevel(4, width, 20))[0].mean()
    mesh = bevel(4, 2 * width, 20)
    points = library.chains([mesh], *pixels(1920, 1080), Frame(1920, 1080, 400, 200), SIZE, 0.1)
    fade = points["fade"][(points["kind"] & KIND["bevel"]) > 0]
    assert fade.max() == pytest.approx((9 - width) / 4, abs=0.01) and 0 < small < 3


def test_a_bevel_whose_edges_are_creases_does_not_lose_them():
    """Two edges of 45 degrees, and three of which the middle one bends as much: they fade to what they are alone."""
    for width in np.arange(3.0, 13, 0.5):
        for segments, lines in ((1, 2), (2, 1)):
            ink = widths(bevel(segments, width, 14))[0] * np.cos(np.radians(14))
            assert ink.min() > (2.9 if lines == 1 or width < 4 else 5.8), (segments, width)


def test_what_is_round_has_no_line():
    for kind in ("flat", "smooth"):
        for sides in (16, 24, 32, 64):
            for degrees, radius in ((25, 3), (25, 13), (90.25, 7)):
                assert not has_bevel(wheel(sides, radius, 0.07, kind, degrees)), (kind, sides, radius)
    for rings in (12, 16):
        assert not has_bevel(ball(rings, 8))


@pytest.mark.parametrize("degrees", [3, 20, 45, 88])
def test_a_chamfer_goes_from_one_line_to_two_by_degrees(degrees):
    """They flipped where its edges were 3.1 pixels apart along a row, which is 2.2 across a diagonal."""
    apart, (high, wide) = np.arange(2.4, 3.7, 0.05), SIZE[::-1]
    y, x = np.mgrid[:high, :wide] + 0.5
    inner = np.abs((y - 24.1) * np.cos(np.radians(degrees)) - (x - 32.2) * np.sin(np.radians(degrees))) < 10
    ink = np.array([picture(bevel(1, w, degrees), line_thickness=1.0)[inner].sum() / 20 for w in apart])
    np.testing.assert_allclose(ink[[0, -1]], (1, 2), atol=0.2)
    assert np.diff(ink).max() < 0.15 and np.diff(ink).min() > -0.1
    assert 2.9 < apart[np.argmax(ink > 1.5)] < 3.5, "whichever way it runs"


@pytest.mark.parametrize("turn", [3, 40, 86])
@pytest.mark.parametrize("period", [6.3, 8.4])
def test_of_edges_too_close_to_be_told_apart_one_is_a_line(turn, period):
    """Folds of a cloth, each of several edges that bend enough, two pixels apart; they met in knots and ladders."""
    strips = np.arange(18)
    heading = np.radians(60 * np.cos(2 * np.pi * strips / period + 0.4))
    t = picture(folded(heading, np.full(18, 2.0), turn), crease_angle=20.0, line_thickness=1.0)
    ink = t.sum(0)[14:-14] if turn > 45 else t.sum(1)[8:-8]
    assert np.ptp(ink) < 0.6
    if turn != 40:
        assert ink.mean() == pytest.approx(2 * 18 / period, abs=0.9), "a line for each fold"


@pytest.mark.parametrize("width", [2.5, 3.1, 3.4])
def test_a_line_has_no_gaps_where_an_edge_of_its_bevel_goes_by(width):
    """Seen from below, where the bevel's last faces are narrow."""
    heading, chord = np.radians([-8, 7, 37, 67, 82]), np.array([30, width, width, width, 9])
    assert widths(folded(heading, chord, 1.3), crease_angle=32.0)[0].min() > 0.5


def test_smooth_ones_need_the_angle_of_smooth_edges():
    assert widths(bevel(4, 3, bend=50, kind="smooth"))[0].max() == 0
    assert widths(bevel(4, 3, bend=50, kind="smooth"), crease_angle_smooth=40.0)[0].min() > 1
    assert widths(bevel(4, 3, bend=50))[0].min() > 1
    assert widths(bevel(4, 3, bend=90, kind="smooth"))[0].min() > 2


def rounded(half, radius, segments):
    """A box whose edges are rounded off, with quads at its corners, seen from one of them. segments: even."""
    turn = np.tan(np.linspace(0, np.pi / 4, segments // 2 + 1))
    rows = [(-1, -t) for t in turn[::-1]] + [(1, t) for t in turn]
    places, faces = {}, []
    for axis in range(3):
        for side in (-1, 1):
            grid = []
            for one in rows:
                for other in rows:
                    core, way = np.zeros((2, 3))
                    core[[axis, axis - 2, axis - 1]] = side, one[0], other[0]
                    way[[axis, axis - 2, axis - 1]] = side, one[1], other[1]
                    at = (half - radius) * core + radius * way / np.linalg.norm(way)
                    grid.append(places.setdefault(tuple(np.round(at, 5)), len(places)))
            n = len(rows)
            for i in range(n - 1):
                for j in range(n - 1):
                    a, b, c, d = (grid[n * u + v] for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
                    faces += [(a, b, c), (a, c, d)] if side > 0 else [(a, c, b), (a, d, c)]
    x, y, z = np.array(list(places)).T
    x, y, z = (x - z) / np.sqrt(2), (x + z - 2 * y) / np.sqrt(6), (x + y + z) / np.sqrt(3)
    points = np.stack([x, -y, z], 1) + (432.2, 224.1, -60)
    return Mesh(points.astype(np.float32), np.array(faces, np.int32))


@pytest.mark.parametrize("segments", [2, 4, 6])
def test_lines_of_bevels_meet_in_a_corner_as_one_piece(segments):
    """They ended where the patch of faces at the corner begins, or ran around it."""
    radius = 3.0 if segments > 2 else 5.0
    points = library.chains([rounded(18.0, radius, segments)], *pixels(960, 540), FRAME, SIZE, 0.1)
    bevels = points[(points["kind"] & KIND["bevel"]) > 0]
    near = np.hypot(bevels["x"] - 431.7, bevels["y"] - 223.6)
    assert near.min() < 1.0
    t = picture(rounded(18.0, radius, segments), line_thickness=1.0)
    y, x = np.mgrid[:SIZE[1], :SIZE[0]]
    far = np.hypot(x - 31.7, y - 23.6)
    for low in (2, 4, 6, 8):
        ring = t[(far >= low) & (far < low + 1)].sum()
        assert 1.5 < ring < 4.5, (low, ring, "three lines and no more")
