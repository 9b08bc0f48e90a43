# SPDX-License-Identifier: GPL-3.0-or-later
"""The rasteriser, given what is bad, odd or nothing."""

import ctypes

import numpy as np
import pytest
from encre.pen import abi, library
from encre.pen.errors import Cancelled, EncreError
from encre.pen.library import Frame, Mesh, load
from hypothesis import given, settings
from hypothesis import strategies as st
from views import crowded, looking, orthographic, perspective, pixels, same, soup


def test_nothing_to_draw():
    for meshes in ([], [Mesh(np.zeros((0, 3), np.float32))]):
        got = library.raster(meshes, np.eye(4), perspective(5, 4), Frame(5, 4), (5, 4), 0.1, 0, 2)
        assert (got["depth"] == np.float32(1e10)).all()
        assert not any(got[name].any() for name in got.keys() - {"depth"})


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_primitives_that_are_not_finite_are_dropped(bad):
    rng = np.random.default_rng(14)
    mesh = soup(rng, 40, object_index=1)
    broken = Mesh(mesh.points.copy(), None, mesh.attributes, model=mesh.model, object_index=1)
    broken.points[::9, 1] = bad  # a corner of every third triangle
    whole = Mesh(mesh.points.reshape(40, 9)[np.arange(40) % 3 != 0].reshape(-1, 3), None,
                 mesh.attributes[np.arange(40) % 3 != 0], model=mesh.model, object_index=1)
    view, p = looking(rng), perspective(60, 40)
    same(*(library.raster([m], view, p, Frame(60, 40), (60, 40), 0.1, 0, 3) for m in (broken, whole)))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-30, 1e-3, 1e6, 1e20, 3e38]), st.booleans())
def test_any_size_of_triangle_gives_clean_pixels(seed, size, flat):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (60, 3)) * size * (1, 1, 0 if flat else 1) + rng.choice([0, 0, size], (60, 1))
    points[rng.random(60) < 0.2] = points[0]  # degenerate ones too
    attributes = rng.uniform(-1, 1, (20, 3, 2)).astype(np.float32)
    mesh = Mesh(np.clip(points, -3e38, 3e38).astype(np.float32), None, attributes, object_index=1)
    view = np.eye(4)
    view[2, 3] = -0.5 * size if size < 1e6 else -1
    for p in (perspective(33, 17), orthographic(33, 17)):
        got = library.raster([mesh], view, p, Frame(33, 17), (33, 17), 1e-3 * min(size, 1), 0, 2)
        there = got["object"] == 1
        assert all(np.isfinite(a).all() for a in got.values())
        assert (np.abs(got["attributes"]) <= 1).all()
        np.testing.assert_allclose(np.linalg.norm(got["normal"][there], axis=-1), 1, atol=1e-6)


FLT_MAX = float(np.finfo(np.float32).max)


@pytest.mark.parametrize("start", [-1e38, -1e300])
def test_depths_are_floats(start):
    """What lies farther behind the eye than a float can tell is not drawn, nor is its depth infinite."""
    points = np.array([[-1, -1, 1], [1, -1, 1], [0, 1, 1]], np.float32)
    flat = np.diag([1.0, 1.0, -0.01, 1.0])
    for far in (1e37, 3e38, 1e39, 1e50):
        model = np.diag([1.0, 1.0, far, 1.0])
        depth = library.raster([Mesh(points, model=model, object_index=1)], np.eye(4), flat, Frame(8, 8), (8, 8),
                               start)["depth"]
        assert np.isfinite(depth).all()
        assert (depth.min() == np.float32(max(-far, -FLT_MAX))) == (far <= min(-start, FLT_MAX))


def drawn(mesh=None, view=None, projection=None, frame=None, size=(8, 8), start=0.1):
    points = np.array([[-1, -1, -2], [1, -1, -2], [0, 1, -2]], np.float32)
    view = np.eye(4) if view is None else view
    projection = perspective(8, 8) if projection is None else projection
    return library.raster([mesh or Mesh(points)], view, projection, frame or Frame(8, 8), size, start)


@pytest.mark.parametrize("wrong, words", [
    (dict(mesh=Mesh(np.zeros((3, 3)), np.array([[0, 1, 3]]))), "mesh 0: primitive 0 has a corner at point 3 of 3"),
    (dict(mesh=Mesh(np.zeros((3, 3)), np.array([[4, 1, 2]]))), "mesh 0: primitive 0 has a corner at point 4 of 3"),
    (dict(mesh=Mesh(np.zeros((3, 3)), np.array([[0, 1, 2], [2, -1, 0]]))), "primitive 1 has a corner at point -1"),
    (dict(view=np.full((4, 4), np.nan)), "camera: "),
    (dict(projection=np.full((4, 4), np.inf)), "camera: "),
    (dict(start=np.nan), "camera: "),
    (dict(frame=Frame(0, 8)), "frame: is 0 x 8"),
    (dict(frame=Frame(65537, 8)), "frame: is 65537 x 8"),
    (dict(frame=Frame(8, 8, 1, 0)), "frame: 8 x 8 pixels at 1, 0 do not lie in a frame of 8 x 8"),
    (dict(frame=Frame(8, 8, 0, -1)), "frame: 8 x 8 pixels at 0, -1"),
])
def test_wrong_input_is_named(wrong, words):
    with pytest.raises(EncreError, match=words) as e:
        drawn(**wrong)
    assert ";" in str(e.value) and "\n" not in str(e.value)


@pytest.mark.parametrize("field, value, words", [
    ("kind", 7, "kind 7 is not known"), ("n_primitives", -1, "-1 primitives"), ("points", None, "no points"),
    ("n_channels", 25, "25 attribute channels"), ("n_points", 2, "take more points than its 2"),
])
def test_wrong_meshes_are_named(field, value, words):
    lib, job, mesh = load(), abi.RasterJob(), abi.Mesh()
    keep = abi.fill_mesh(mesh, Mesh(np.zeros((3, 3), np.float32)))
    setattr(mesh, field, value)
    job.meshes, job.n_meshes, job.frame = ctypes.pointer(mesh), 1, abi.Frame(4, 4, 0, 0)
    depth = np.zeros((4, 4), np.float32)
    job.depth = abi.image(depth)
    with pytest.raises(EncreError, match="mesh 0: .*" + words):
        lib._call(lib.lib.encre_raster, job, 1, 1, None)
    del keep


def test_the_largest_frame_is_drawn():
    width = height = 65536
    square = np.array([[0, 0, -1], [width, 0, -1], [width, height, -1], [0, height, -1]], np.float32)
    mesh = Mesh(square, np.array([[0, 1, 2], [0, 2, 3]], np.int32), object_index=1)
    for x, y in ((0, 0), (width - 9, height - 9), (width // 2, height // 2)):
        got = library.raster([mesh], *pixels(width, height), Frame(width, height, x, y), (9, 9), 0.1)
        assert (got["object"] == 1).all() and (got["depth"] == 1).all()


def test_progress_grows_and_cancels_at_every_band():
    rng = np.random.default_rng(15)
    meshes, view, p = crowded(rng), looking(rng), perspective(40, 100)

    def run(stop):
        seen = []

        def progress(fraction):
            seen.append(fraction)
            return len(seen) < stop

        library.raster(meshes, view, p, Frame(40, 100), (40, 100), 0.1, threads=1, progress=progress)
        return seen

    seen = run(10**9)
    assert seen == sorted(seen) and seen[0] > 0 and seen[-1] == 1 and len(seen) >= 7
    for stop in range(1, len(seen) + 1):
        with pytest.raises(Cancelled):
            run(stop)
