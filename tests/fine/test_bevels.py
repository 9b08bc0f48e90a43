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


def wheel(sides, radius, around=0.0, kind="flat"):
    """A cylinder that lies across the picture, of so many sides; half of it is seen."""
    a = np.arange(sides + 1) * 2 * np.pi / sides + around
    points = np.concatenate([np.c_[radius * np.cos(a), np.full(len(a), y), radius * np.sin(a)] for y in (-60, 60)])
    k = np.arange(sides)
    corners = np.concatenate([np.c_[k, k + 1, k + 2 + sides], np.c_[k, k + 2 + sides, k + 1 + sides]])
    return Mesh(turned(points, 25), corners.astype(np.int32), edges=edge_kinds(np.full((len(corners), 3), EDGES[kind])))


def ball(rings, radius):
    around, up = np.meshgrid(np.arange(2 * rings) * np.pi / rings, np.linspace(0, np.pi, rings + 1))
    points = radius * np.stack([np.cos(around) * np.sin(up), np.cos(up), np.sin(around) * np.sin(up)], -1)
    n = 2 * rings
    a = np.arange(n * rings)
    b = a // n * n + (a + 1) % n
    corners = np.concatenate([np.c_[a, b, b + n], np.c_[b + n, a + n, a]])
    return Mesh(turned(points.reshape(-1, 3), 25), corners.astype(np.int32))


def drawn(mesh, **how):
    return library.raster([mesh], *pixels(960, 540), FRAME, SIZE, 0.1, outputs=(
        "depth", "normal", "object", "marks", "creases"), **how)


def picture(mesh, **values):
    """The lines of a mesh, with normals that show nothing."""
    maps = drawn(mesh)
    creases = np.concatenate([maps["creases"], bends(maps["normal"])[..., None]], 2)
    grey = np.full((*SIZE[::-1], 3), 0.5, np.float32)
    layers = dict(combined=np.dstack([grey, np.ones(SIZE[::-1], np.float32)]), color=grey, diffuse=grey,
                  depth=maps["depth"], normal=np.zeros_like(grey), object=maps["object"], marks=maps["marks"],
                  creases=creases)
    scene = dict(edge_detector="FINE", line_thickness=3.0, length_unit="PIXELS", line_softness=0.0, line_paper=0.0,
                 line_gain=0.5, line_intensity=2.0, width_normal=1.0, edge_depth=0.0, edge_object=0.0)
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


def test_it_fades_as_it_comes_near():
    ink = [widths(bevel(8, width, 12))[0].mean() for width in np.arange(4, 13, 0.5)]
    assert ink[0] > 2.7 and max(ink[-4:]) == 0
    assert max(-np.diff(ink)) < 1.6, "not at once"
    assert sum(0.2 < i < 2.6 for i in ink) >= 2


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


def test_smooth_ones_need_the_angle_of_smooth_edges():
    assert widths(bevel(4, 3, bend=50, kind="smooth"))[0].max() == 0
    assert widths(bevel(4, 3, bend=50, kind="smooth"), crease_smooth=40.0)[0].min() > 1
    assert widths(bevel(4, 3, bend=50))[0].min() > 1
    assert widths(bevel(4, 3, bend=90, kind="smooth"))[0].min() > 2


def test_a_sharp_edge_stays_what_it_is():
    maps = drawn(bevel(0, 0))
    alone = library.raster([bevel(0, 0)], *pixels(960, 540), FRAME, SIZE, 0.1, outputs=("creases",))
    np.testing.assert_array_equal(maps["creases"], alone["creases"])


def test_the_two_edges_of_a_chamfer_are_one_line_where_they_are_close():
    near, apart = (picture(bevel(1, width, 8), line_thickness=1.0)[24] > 0.3 for width in (2.5, 9))
    assert np.diff(np.flatnonzero(near)).max(initial=1) == 1 and near.sum() <= 2
    assert np.diff(np.flatnonzero(apart)).max() > 5


@pytest.mark.parametrize("seed", [0, 1, 2, *(pytest.param(k, marks=pytest.mark.long) for k in (3, 4, 5))])
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
    assert (np.abs(got["creases"] - want) > 0.02).any(2).mean() < 0.003


@pytest.mark.parametrize("left", [411, 429])
def test_what_goes_on_beyond_the_border_is_guessed_from_the_other_side(left):
    """A bend in what is round, a few pixels from the border."""
    turns = np.r_[np.full(12, 3.0), 26, 26, np.full(12, 3.0)]
    heading = np.radians(np.r_[0, np.cumsum(turns)] - turns.sum() / 2)
    mesh, frame = folded(heading, np.r_[30, np.full(25, 1.6), 30]), Frame(960, 540, left, 214)
    got, without = (library.raster([mesh], *pixels(960, 540), frame, (24, 5), 0.1, outputs=("marks", "creases", *more))
                    for more in (("object", "normal"), ()))
    want = spread({**got, "creases": without["creases"]}, 540)
    assert (np.abs(want[..., [1, 3]]) > SPREAD).sum() == 5
    np.testing.assert_allclose(got["creases"], want, atol=0.02)


@pytest.mark.parametrize("threads", [1, 3])
def test_borders_and_threads_give_the_same_bytes(threads):
    whole = drawn(bevel(5, 4.5), threads=2)["creases"]
    part = library.raster([bevel(5, 4.5)], *pixels(960, 540), Frame(960, 540, 410, 207), (40, 36), 0.1, threads=threads,
                          outputs=("depth", "normal", "object", "marks", "creases"))["creases"]
    assert (np.abs(whole[..., [1, 3]]) > SPREAD).any()
    np.testing.assert_array_equal(part[10:-10, 10:-10], whole[17:33, 20:40])
