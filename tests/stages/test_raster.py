# SPDX-License-Identifier: GPL-3.0-or-later
"""The rasteriser against tests/reference/raster.py, against formulas, and against itself cut up in other ways."""


import numpy as np
import pytest
from encre.pen import abi, library
from encre.pen.library import Frame, Mesh, load
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.raster import NOTHING, STEPS, draw
from views import crowded, jittered, looking, orthographic, perspective, pixels, rotation, same, soup

OUTPUTS = ("depth", "normal", "object", "material", "style", "attributes", "shading", "anchor", "tangent",
           "card")


def compare(meshes, view, projection, frame, size, start=0.1, end=0.0, channels=0):
    got = library.raster(meshes, view, projection, frame, size, start, end, channels, OUTPUTS)
    want = draw(meshes, view, projection, frame, size, start, end, channels)
    sure = ~want["unsure"]
    assert sure.mean() > 0.9
    for name in ("object", "material", "style"):
        np.testing.assert_array_equal(got[name][sure], want[name][sure], name)
    np.testing.assert_allclose(got["depth"], want["depth"], rtol=1e-6)
    np.testing.assert_allclose(got["normal"][sure], want["normal"][sure], atol=1e-6)
    np.testing.assert_allclose(got["shading"][sure], want["shading"][sure], atol=1e-5)
    place, span, growth = slice(0, 6), slice(6, 7), slice(7, 13)
    unit = np.maximum(want["anchor"][..., span], 1e-30)
    np.testing.assert_allclose(got["anchor"][sure][:, place], want["anchor"][sure][:, place], atol=1e-5)
    np.testing.assert_allclose(got["anchor"][..., span], want["anchor"][..., span], rtol=1e-5)
    np.testing.assert_allclose((got["anchor"] / unit)[sure][:, growth], (want["anchor"] / unit)[sure][:, growth],
                               rtol=2e-3, atol=1e-3)
    for name in (got, want):  # either way along it
        form = name["anchor"][sure][:, 13:].astype(float)
        name["bends"] = form[:, :, None] * form[:, None, :]
    np.testing.assert_allclose(got.pop("bends"), want["bends"], atol=1e-3)
    np.testing.assert_allclose(got["tangent"][sure], want["tangent"][sure], atol=1e-5)
    large = np.abs(want["card"]).max(-1, keepdims=True) + 1e-30
    np.testing.assert_allclose((got["card"] / large)[sure], (want["card"] / large)[sure], atol=1e-5)
    np.testing.assert_allclose(got["attributes"][sure], want["attributes"][sure], atol=1e-5)
    return got


def bordered(full, x, y, width, height):
    return {k: v[y:y + height, x:x + width] for k, v in full.items()}


# ---- against the reference ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1), (97, 53)])
@pytest.mark.parametrize("projection", [perspective, orthographic])
def test_soup(size, projection):
    rng = np.random.default_rng(size[0] + 7)
    meshes = [soup(rng, 60, object_index=3, material_index=5, style_index=2),
              Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32)),
              soup(rng, 80, 0.4, object_index=4, material=np.arange(80), style=np.arange(80) % 3, channels=5),
              soup(rng, 50, object_index=-7, channels=1)]
    meshes[3].attributes = None
    for mesh, scale in ((meshes[0], (-1.6, 1, 0.8)), (meshes[2], (1, 1, 1))):
        mesh.normals = rng.uniform(-1, 1, (len(mesh.points) // 3, 3, 3)).astype(np.float32)
        mesh.uv = rng.uniform(-1, 1, (*mesh.normals.shape[:2], 2)).astype(np.float32)
        mesh.uv[:9, 1] = mesh.uv[:9, 2]  # of no area
        mesh.normals[:9] = 0  # without a direction: as where there are none
        mesh.rest = (mesh.points.reshape(-1, 3, 3) * 3 + rng.uniform(-1, 1, mesh.normals.shape)).astype(np.float32)
        mesh.rest_normals = mesh.normals[::-1].copy()
        mesh.rest_normals[::4, 1] = 0
        mesh.model[:3, :3] *= scale
    meshes[2].seed = -5
    got = compare(meshes, looking(rng), projection(*size), Frame(*size), size, channels=4)
    if size == (97, 53):
        assert {0, 3, 4, -7} == set(np.unique(got["object"]))


def test_many_small_triangles_of_many_meshes():
    rng = np.random.default_rng(1)
    meshes = [soup(rng, int(n), 0.05, object_index=k + 1) for k, n in enumerate(rng.integers(0, 400, 20))]
    assert sum(len(m.points) for m in meshes) // 3 > 2048  # several chunks
    compare(meshes, looking(rng), perspective(120, 80, shift=(0.1, -0.2)), Frame(120, 80), (120, 80), channels=3)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 2, 8, STEPS, 2 * STEPS]), st.sampled_from([0, 3]), st.booleans())
def test_corners_on_and_beside_pixel_centres(seed, parts, reach, off):
    """Corners a few 1/parts of a pixel from centres: edges through centres, and decided by the sub-pixel grid."""
    rng = np.random.default_rng(seed)
    n = 12
    points = rng.integers(0, 12, (3 * n, 3)) + 0.5 + rng.integers(-reach, reach + 1, (3 * n, 3)) / parts
    points += off * rng.integers(-1, 2, (3 * n, 3)) / 2**20
    points[:, 2] = -np.repeat(rng.permutation(n) + 1, 3)  # flat, all at different depths
    mesh = Mesh(points.astype(np.float32), material=np.arange(n) + 1, object_index=1)
    compare([mesh], *pixels(16, 16), Frame(16, 16), (16, 16), start=0.5)  # powers of two: no rounding before the grid's


@pytest.mark.parametrize("projection", [perspective, orthographic])
def test_clipped_at_both_ends(projection):
    rng = np.random.default_rng(5)
    mesh = soup(rng, 60, 4.0, material=np.arange(60) + 1)
    got = compare([mesh], looking(rng), projection(64, 48), Frame(64, 48), (64, 48), 5.0, 6.5, 3)
    there = got["depth"] < NOTHING
    assert 0.1 < there.mean() < 0.9
    assert got["depth"].min() >= 5 - 1e-5 and got["depth"][there].max() <= 6.5 + 1e-5


def test_slivers_keep_to_their_corners():
    """Snapping lets each cover a row of centres that it just misses: nothing is extrapolated to there."""
    rows = np.arange(8) + 0.5
    depths = np.where(rows < 4, 2.0, 90.0), np.where(rows < 4, 90.0, 2.0)
    points = np.array([[[0.5, y + 1e-4, -a], [30.5, y + 1e-4, -a], [16.5, y + 3e-4, -b]]
                       for y, a, b in zip(rows, *depths, strict=True)])
    attributes = np.zeros((8, 3, 1), np.float32)
    attributes[:, 2] = 1
    mesh = Mesh(points.reshape(-1, 3).astype(np.float32), None, attributes, object_index=1)
    got = compare([mesh], *pixels(32, 8), Frame(32, 8), (32, 8), channels=1)
    there = got["object"] == 1
    assert there[:, 1:30].all()
    np.testing.assert_array_equal(got["depth"][there], np.broadcast_to(depths[0][:, None], there.shape)[there])
    assert not got["attributes"].any()


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("corners", [[(0, 1, 2), (0, 2, 3)], [(1, 2, 3), (1, 3, 0)]])
def test_a_pixel_centre_on_an_edge_belongs_to_what_lies_right_of_it_or_below(corners, turned):
    """Rectangles that begin and end at centres, one beside and below the other, cover each pixel once."""
    points, faces, cuts = [], [], (0.5, 1.5, 4.5, 5.5, 9.5)
    for y0, y1 in zip(cuts, cuts[1:], strict=False):
        for x0, x1 in zip(cuts, cuts[1:], strict=False):
            first = len(points)
            points += [(x0, y0, -2), (x1, y0, -2), (x1, y1, -2), (x0, y1, -2)]
            faces += [tuple(first + k for k in (c[::-1] if turned else c)) for c in corners]
    places = np.digitize(np.arange(11) + 0.5, cuts) - 1
    inside = (places >= 0) & (places < 4)
    wanted = np.where(inside[:, None] & inside, 1 + 4 * places[:, None] + places, 0)
    points, faces = np.array(points, np.float32), np.array(faces, np.int32)
    meshes = [Mesh(points, faces[2 * k:2 * k + 2], object_index=k + 1) for k in range(16)]
    for order in (meshes, meshes[::-1]):
        got = library.raster(order, *pixels(11, 11), Frame(11, 11), (11, 11), 0.1)["object"]
        assert np.array_equal(got, wanted), got


@pytest.mark.parametrize("size", [(1, 1), (9, 1), (1, 9), (2, 17)])
def test_what_covers_a_small_frame_covers_all_of_it(size):
    width, height = size
    points = np.float32([(-5, -5, -2), (99, -5, -2), (-5, 99, -2)])
    got = library.raster([Mesh(points, object_index=1)], *pixels(*size), Frame(*size), size, 0.1)
    assert got["object"].shape == (height, width) and (got["object"] == 1).all()


def test_lines_that_snapping_makes_surfaces_face_the_camera():
    rng = np.random.default_rng(8)
    start = rng.integers(0, 7, (4000, 2)) + 0.5 + np.c_[np.zeros(4000), rng.integers(-20, 21, 4000) / (2 * STEPS)]
    step = np.c_[rng.integers(1, 4, 4000), rng.integers(-9, 10, 4000) / (2 * STEPS)]
    points = start[:, None] + step[:, None] * np.array([0, 1, 3])[:, None]
    points = np.concatenate([points, np.full((4000, 3, 1), -2)], -1).astype(np.float32).reshape(-1, 3)
    got = library.raster([Mesh(points, object_index=1)], *pixels(16, 16), Frame(16, 16), (16, 16), 0.1)
    there = got["object"] == 1
    assert there.sum() > 20 and (got["normal"][there] == (0, 0, 1)).all()


def test_without_a_near_limit_the_eye_is_one():
    rng = np.random.default_rng(6)
    mesh = soup(rng, 40, 0.6, 0.6, object_index=1)
    view, p, frame = np.eye(4), perspective(60, 40), Frame(60, 40)
    near, none = (library.raster([mesh], view, p, frame, (60, 40), start, start)["depth"] for start in (1e-7, -9.0))
    assert near.min() < 0.1 and (near < NOTHING).mean() > 0.5
    np.testing.assert_allclose(none, near, rtol=1e-6)


def test_triangles_that_reach_very_far():
    far = np.array([[-1e35, -1e35, -2], [1e35, -1e35, -2], [0, 1e35, -2]], np.float32)
    for camera in (pixels(12, 9), (np.eye(4), perspective(12, 9))):
        got = library.raster([Mesh(far, object_index=1)], *camera, Frame(12, 9), (12, 9), 0.1)
        assert (got["object"] == 1).all() and (got["depth"] == 2).all()


def test_triangles_smaller_than_pixels():
    """What they show of a corner is told by areas that are less than 1."""
    rng = np.random.default_rng(3)
    points, triangles = jittered(rng, 24, 18, 8, 6, 0.3)
    compare([Mesh(points, triangles, object_index=1, normals=rng.uniform(-1, 1, (len(triangles), 3, 3)).astype("f"),
                  attributes=rng.uniform(-1, 1, (len(triangles), 3, 2)).astype("f"))], *pixels(8, 6), Frame(8, 6),
            (8, 6), channels=2)


# ---- against formulas --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("projection", [perspective, orthographic])
def test_a_plane_is_where_its_equation_says(projection):
    """However the plane is cut up: depth, normal and place, given as an attribute, on each line of sight."""
    rng = np.random.default_rng(3)
    width, height = 80, 60
    points, triangles = jittered(rng, 5, 4, 2, 2, 0.2)
    points = (points - (1, 1, 0)) * (8, 8, 0)
    model = np.eye(4)
    tilt = 1.2
    model[1:3, 1:3] = [[np.cos(tilt), np.sin(tilt)], [-np.sin(tilt), np.cos(tilt)]]
    model[:3, 3] = 0.3, -0.5, 0.2
    world = points @ model[:3, :3].T + model[:3, 3]
    view = looking(rng)
    p = projection(width, height)
    mesh = Mesh(points.astype(np.float32), triangles, world[triangles].astype(np.float32), model=model, object_index=1)
    got = library.raster([mesh], view, p, Frame(width, height), (width, height), 0.1, 0, 3)
    there = got["object"] == 1
    assert there.mean() > 0.5
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    inverse = np.linalg.inv(p @ view)
    a, b = (np.stack([x, y, np.full_like(x, z), np.ones_like(x)], -1) @ inverse.T for z in (-1, 1))
    a, b = a[..., :3] / a[..., 3:], b[..., :3] / b[..., 3:]
    normal = model[:3, 2]
    t = ((model[:3, 3] - a) @ normal / ((b - a) @ normal))[..., None]
    hit = a + t * (b - a)
    depth = -(hit @ view[2, :3] + view[2, 3])
    np.testing.assert_allclose(got["depth"][there], depth[there], rtol=3e-7)
    np.testing.assert_allclose(got["attributes"][there], hit[there], atol=2e-5)
    towards = normal * np.sign(normal @ (a[0, 0] - hit[0, 0]))
    np.testing.assert_allclose(got["normal"][there], np.broadcast_to(towards, hit.shape)[there], atol=1e-6)
    assert not got["normal"][~there].any() and not got["attributes"][~there].any()
    assert (got["depth"][~there] == np.float32(1e10)).all()


def test_back_faces_and_mirrored_models_face_the_camera():
    points = np.array([[-1, -1, 0], [1, -1, 0.4], [0, 1, 0]], np.float32)
    results = []
    for corners in ([[0, 1, 2]], [[0, 2, 1]]):
        for mirror in (1, -1):
            model = np.diag([mirror, 1, 1, 1.0])
            mesh = Mesh(points * (mirror, 1, 1), np.array(corners, np.int32), model=model, object_index=1)
            for p in (perspective, orthographic):
                view = np.eye(4)
                view[2, 3] = -3
                results.append(library.raster([mesh], view, p(30, 30), Frame(30, 30), (30, 30), 0.1))
    for r in results:
        there = r["object"] == 1
        assert there.sum() > 30 and (r["normal"][there][:, 2] > 0.9).all()
        np.testing.assert_allclose(np.linalg.norm(r["normal"][there], axis=1), 1, atol=1e-6)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("side", [-4.0, 4.0])
def test_a_surface_faces_the_camera_wherever_that_stands(axis, side):
    """A triangle at the origin, of which a camera sees the one face from here and the other one from there."""
    place, normal = np.array([0, 0, 5.0]), np.array([0, 0, 0.5])
    place[axis], normal[axis] = side, 1
    points = np.linalg.svd(normal[None])[2][1:]
    view = np.eye(4)
    view[:3, 3] = -place
    mesh = Mesh(np.float32([points[0], points[1], -points[0] - points[1]]), np.int32([[0, 1, 2]]), object_index=1)
    projection = perspective(160, 160, shift=tuple(-1.2 * place[:2] / 5))
    got = library.raster([mesh], view, projection, Frame(160, 160), (160, 160), 0.1)
    there = got["object"] == 1
    assert there.sum() > 20 and (got["normal"][there] @ place > 0).all()


def test_equal_depths_go_to_the_earlier_mesh_and_primitive():
    rng = np.random.default_rng(9)
    one = soup(rng, 30, object_index=1, material=np.arange(30))
    twice = Mesh(np.concatenate([one.points, one.points]), material=np.arange(60), model=one.model, object_index=2)
    view, p, frame = looking(rng), perspective(90, 60), Frame(90, 60)
    first = library.raster([one, twice], view, p, frame, (90, 60), 0.1)
    there = first["depth"] < NOTHING
    assert (first["object"][there] == 1).all()
    second = library.raster([twice, one], view, p, frame, (90, 60), 0.1)
    assert (second["object"][there] == 2).all() and second["material"].max() < 30
    np.testing.assert_array_equal(first["depth"], second["depth"])


def tile(points, plane, order, **numbers):
    """A convex polygon of places in a plane (origin, two directions), cut up from its corner `order` on."""
    points = np.roll(np.array(points, float), -order, 0)
    fan = [(0, k, k + 1) for k in range(1, len(points) - 1)]
    return Mesh((plane[0] + points @ np.array(plane[1:])).astype(np.float32), np.array(fan, np.int32), **numbers)


@pytest.mark.parametrize("projection", [perspective, orthographic])
@pytest.mark.parametrize("seed", range(4))
def test_of_surfaces_that_coincide_the_earlier_is_drawn_and_the_other_told(projection, seed):
    """Against each drawn alone. Every plane is tilted, and its polygons are cut up in their own ways, so that their
    depths differ by rounding."""
    rng = np.random.default_rng(seed)
    plane = rng.uniform(-0.3, 0.3, 3), *rotation(rng)[:2] * rng.uniform(0.5, 2)
    ring = np.linspace(0, 2 * np.pi, 8)[:-1, None]
    shapes = [np.hstack([np.cos(ring), np.sin(ring)]) * size + rng.uniform(-0.4, 0.4, 2) for size in (1.1, 0.8, 0.9)]
    meshes = [tile(shape, plane, 2 * k, object_index=k + 1) for k, shape in enumerate(shapes)]
    camera = looking(rng), projection(97, 61), Frame(97, 61), (97, 61), 0.1
    alone = np.array([draw([mesh], *camera)["depth"] < NOTHING for mesh in meshes])
    both = alone.sum(0) > 1
    assert both.sum() > 60
    for order in ((0, 1, 2), (2, 0, 1)):
        got = library.raster([meshes[k] for k in order], *camera, outputs=("depth", "object", "coincident"))
        first = np.select([alone[k] for k in order], [k + 1 for k in order])
        np.testing.assert_array_equal(got["object"], first)
        assert ((got["coincident"] > 0) == both).all()
        other = got["coincident"][both].astype(int) - 1
        assert (other + 1 != first[both]).all() and alone[:, both][other, np.arange(both.sum())].all()


@pytest.mark.parametrize("gap, angle", [(1e-4, 0), (0, 0.01)])
def test_surfaces_that_are_apart_do_not_coincide(gap, angle):
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    turned = np.array([(np.cos(angle), 0, np.sin(angle)), (0, 1, 0)])
    meshes = [tile(square, ((0, 0, 0), (1, 0, 0), (0, 1, 0)), 0, object_index=1),
              tile(square, ((0, 0, gap), *turned), 1, object_index=2)]
    view = np.eye(4)
    view[2, 3] = -5
    for order in (meshes, meshes[::-1]):
        got = library.raster(order, view, perspective(97, 61), Frame(97, 61), (97, 61), 0.1,
                             outputs=("object", "coincident"))
        there = got["object"] > 0
        assert there.sum() > 400 and not got["coincident"].any()
        assert (got["object"][there] == 2).mean() == (1.0 if gap else pytest.approx(0.5, abs=0.03))


def test_constant_attributes_stay_exact():
    rng = np.random.default_rng(2)
    mesh = soup(rng, 40, channels=2, object_index=1)
    mesh.attributes[:] = np.float32(0.7), np.float32(-1 / 3)
    got = library.raster([mesh], looking(rng), perspective(60, 60), Frame(60, 60), (60, 60), 0.1, 0, 3)
    there = got["object"] == 1
    assert (got["attributes"][there] == np.array([0.7, -1 / 3, 0], np.float32)).all()


# ---- the same pixels however the work is cut up ------------------------------------------------------------------


@pytest.mark.parametrize("projection", [perspective, orthographic])
def test_a_border_is_the_same_pixels(projection):
    rng = np.random.default_rng(11)
    meshes, view, p, frame = crowded(rng), looking(rng), projection(131, 77), Frame(131, 77)
    full = library.raster(meshes, view, p, frame, (131, 77), 0.1, 0, 3)
    for _ in range(12):
        x, y = int(rng.integers(0, 131)), int(rng.integers(0, 77))
        w, h = int(rng.integers(1, 132 - x)), int(rng.integers(1, 78 - y))
        same(library.raster(meshes, view, p, Frame(131, 77, x, y), (w, h), 0.1, 0, 3), bordered(full, x, y, w, h))


def test_threads_do_not_matter():
    rng = np.random.default_rng(12)
    meshes, view, p = crowded(rng), looking(rng), perspective(200, 150)
    runs = [library.raster(meshes, view, p, Frame(200, 150), (200, 150), 0.1, 0, 3, threads=n) for n in (1, 2, 3, 8)]
    for r in runs[1:]:
        same(runs[0], r)


def test_strides_and_absent_outputs():
    rng = np.random.default_rng(13)
    meshes, view, p, frame = crowded(rng), looking(rng), perspective(50, 40), Frame(50, 40)
    full = library.raster(meshes, view, p, frame, (50, 40), 0.1, 0, 3, OUTPUTS)
    for name in OUTPUTS:
        same(library.raster(meshes, view, p, frame, (50, 40), 0.1, 0, 3, outputs=(name,)), {name: full[name]})
    lib, job = load(), abi.RasterJob()
    array = (abi.Mesh * len(meshes))()
    keep = [abi.fill_mesh(m, mesh) for m, mesh in zip(array, meshes, strict=True)]
    job.meshes, job.n_meshes, job.n_channels = array, len(meshes), 3
    job.view[:], job.projection[:], job.clip_start = view.ravel(), p.ravel(), 0.1
    job.frame = abi.Frame(50, 40, 0, 0)
    images = {}
    for name in OUTPUTS:
        channels = full[name].shape[2] if full[name].ndim == 3 else 1
        images[name] = np.full((42, 54, channels + 2), -5, np.float32)
        setattr(job, name, abi.image(images[name][-2:0:-1, 2:-2, 1:-1]))  # bottom-up, padded all round
    lib._call(lib.lib.encre_raster, job, 2, 1, None)
    del keep
    for name, a in images.items():
        inner = a[-2:0:-1, 2:-2, 1:-1].copy()
        np.testing.assert_array_equal(inner.reshape(full[name].shape), full[name])
        a[-2:0:-1, 2:-2, 1:-1] = -5
        assert (a == -5).all(), name
