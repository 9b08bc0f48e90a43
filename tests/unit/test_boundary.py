# SPDX-License-Identifier: GPL-3.0-or-later
"""What a caller in C may get wrong is refused before anything runs; what is unusual but right is drawn."""

import ctypes

import drawn
import numpy as np
import pytest
from encre.blender import cameras
from encre.pen import abi
from encre.pen.errors import EncreError
from encre.pen.job import Frame, Mesh
from encre.pen.library import API_VERSION, load
from jobs import HEIGHT, KINDS, WIDTH, Job

IMAGES = [("render", "color"), ("render", "Combined"), ("raster", "depth"), ("raster", "anchor"), ("bake", "texture"),
          ("bake", "output")]


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_right_is_drawn(kind):
    Job(kind).run()


# ---- where images lie


@pytest.mark.parametrize("kind, name", IMAGES)
@pytest.mark.parametrize("rows", [4, -4, 100])
def test_rows_do_not_overlap(kind, name, rows):
    job = Job(kind)
    image = job.images[name]
    image.data, image.row_stride = job.memory(4000) + 2000, rows if rows < 100 else image.row_stride - 4
    job.refused(f"^{name}: rows of .* overlap")


@pytest.mark.parametrize("kind, name", IMAGES)
def test_addresses_are_those_of_floats(kind, name):
    job = Job(kind)
    job.images[name].data = job.memory(4000) + 2
    job.refused(f"^{name}: .*address")


@pytest.mark.parametrize("kind, name", IMAGES)
@pytest.mark.parametrize("stride", [2, -16, 1 << 60, -(1 << 63)])
@pytest.mark.parametrize("field", ["pixel_stride", "row_stride"])
def test_strides_are_those_of_floats(kind, name, stride, field):
    job = Job(kind)
    setattr(job.images[name], field, stride)
    job.refused(f"^{name}: (strides|rows) of")


def test_paper_is_an_image_too():
    job, offset = Job("render"), load().params["paper_image"].offset
    image = abi.image(np.full((4, 4), 0.5, np.float32))
    image.data = job.images["Combined"].data
    ctypes.memmove(ctypes.addressof(job.block) + offset, ctypes.byref(image), ctypes.sizeof(image))
    job.refused("^Combined: shares memory with paper_image")
    image.data = job.memory(100) + 1
    ctypes.memmove(ctypes.addressof(job.block) + offset, ctypes.byref(image), ctypes.sizeof(image))
    job.refused("^paper_image: .*address")


# ---- what is written


@pytest.mark.parametrize("kind, output, other", [
    ("render", "Combined", "color"), ("render", "Encre Edges", "depth"), ("render", "Encre Lines", "Combined"),
    ("raster", "object", "depth"), ("raster", "anchor", "normal"), ("bake", "output", "texture"),
    ("bake", "output", "form"),
])
@pytest.mark.parametrize("ahead", [0, 4, -4])
def test_outputs_lie_apart(kind, output, other, ahead):
    job = Job(kind)
    middle = job.memory(8000) + 4000
    job.images[output].data, job.images[other].data = middle, middle + ahead
    job.refused(f"^{output}: shares memory with {other};")


def test_outputs_lie_apart_from_everything_else():
    job = Job("render")
    job.images["Encre Lines"].data = job.job.params
    job.refused("^Encre Lines: shares memory with the parameters")
    job = Job("raster")
    job.images["normal"].data = job.mesh.points
    job.refused("^normal: shares memory with a mesh")
    job.images["normal"].data = ctypes.addressof(job.mesh)
    job.refused("^normal: shares memory with the meshes")
    job = Job("bake")
    job.images["output"].data = job.job.params
    job.refused("^output: shares memory with the parameters")


def test_something_is_drawn():
    for kind, words in (("render", "^outputs: none"), ("raster", "^raster: no output")):
        job = Job(kind)
        for image in (job.job.outputs if kind == "render" else job.images.values()):
            image.data = None
        job.refused(words)


def byte_sets(images):
    """The bytes of each image, one by one."""
    for image in images:
        y, x, c = np.mgrid[:image.height, :image.width, :4 * image.channels]
        pixel = image.pixel_stride or 4 * image.channels
        row = image.row_stride or pixel * image.width
        yield set((image.data + y * row + x * pixel + c).ravel().tolist())


def test_interleaved_outputs_are_told_from_overlapping_ones():
    """Two pictures of one buffer, at random places, of equal strides: refused just where they have a byte in common."""
    rng, found = np.random.default_rng(3), {True: 0, False: 0}
    for _ in range(400):
        job = Job("bake")
        texture, output = job.images["texture"], job.images["output"]
        width, height = rng.integers(1, 5, 2).tolist()
        pixel = int(4 * rng.integers(3, 10))
        row = int(pixel * width + 4 * rng.integers(0, 30))
        if rng.random() < 0.3:
            row, pixel = pixel, int(pixel * height + 4 * rng.integers(0, 30))
        base = job.memory(16000) + 8000
        job.job.form.data = None
        for image in (texture, output):
            back = rng.random() < 0.3
            image.width, image.height, image.channels, image.pixel_stride = width, height, 3, pixel
            image.row_stride = -row if back else row
            image.data = base + int(4 * rng.integers(-60, 60)) + (row * (height - 1) if back else 0)
        one, two = byte_sets((texture, output))
        found[bool(one & two)] += 1
        if one & two:
            job.refused("^output: shares memory with texture")
        else:
            job.run()
    assert min(found.values()) > 50


# ---- legal all the same


def test_inputs_of_all_kinds_are_read_alike():
    """Bottom-up, padded, column by column, channels of one buffer, shared memory: the same picture."""
    layers = drawn.scene(31, 17, noise=0.02)
    layers["albedo"] = layers["color"]
    want = load().render(layers).images["Combined"]
    wide = np.full((17, 31, 64), np.nan, np.float32)
    beside, at = {}, 0
    for name, a in layers.items():
        a = a.reshape(17, 31, -1)
        beside[name] = wide[..., at:at + a.shape[2]]
        beside[name][...] = a
        at += a.shape[2]
    padded = {name: np.pad(a, ((0, 3), (0, 5), *[(0, 0)] * (a.ndim - 2)))[:17, :31] for name, a in layers.items()}
    columns = {name: np.ascontiguousarray(np.swapaxes(a, 0, 1)).swapaxes(0, 1) for name, a in layers.items()}
    upside = {name: np.ascontiguousarray(a[::-1])[::-1] for name, a in layers.items()}
    for other in (beside, padded, columns, upside, {**layers, "albedo": layers["color"]}):
        assert np.array_equal(load().render(other).images["Combined"], want)
    one = {name: np.broadcast_to(a[:1], a.shape) for name, a in layers.items()}
    copied = {name: a.copy() for name, a in one.items()}
    assert np.array_equal(load().render(one).images["Combined"], load().render(copied).images["Combined"])


def test_columns_are_read_as_rows_are():
    job = Job("render")
    job.run()
    want = job.keep[len(job.lib.layers)].copy()
    turned = np.full((WIDTH, HEIGHT, 4), 7, np.float32)
    image = job.images["Combined"]
    image.data, image.pixel_stride, image.row_stride = turned.ctypes.data, turned.strides[0], turned.strides[1]
    job.run()
    assert np.array_equal(turned.swapaxes(0, 1), want)


# ---- frame, camera, parameters


@pytest.mark.parametrize("kind", ["render", "raster"])
@pytest.mark.parametrize("frame, words", [
    ((2_000_000_000, 8, 0, 0), "^frame: is 2000000000 x 8"), ((12, 65537, 0, 0), "^frame: is 12 x 65537"),
    ((0, 8, 0, 0), "^frame: is 0 x 8"), ((12, 8, 1, 0), "^frame: .* do not lie"), ((12, 8, 0, -1), "^frame: .* do not"),
])
def test_frames_have_an_end(kind, frame, words):
    job = Job(kind)
    job.job.frame = abi.Frame(*frame)
    job.refused(words)


@pytest.mark.parametrize("view", [[0] * 9, [2, 0, 0, 0, 1, 0, 0, 0, 1], [1, 0, 0, 0.1, 1, 0, 0, 0, 1],
                                  [1, 0, 0, 0, float("nan"), 0, 0, 0, 1], [1, 0, 0, 0, 1, 0, 0, 0, 2],
                                  [3e38] * 9])
def test_views_are_rotations(view):
    job = Job("render")
    job.job.camera.view[:] = view
    job.refused("^camera: view is no rotation")


def test_mirrored_and_rounded_views_are_drawn():
    job = Job("render")
    for view in ([-1, 0, 0, 0, 1, 0, 0, 0, 1], [0.8, 0.6, 0, -0.6, 0.8, 1e-5, 0, 0, 1.00001]):
        job.job.camera.view[:] = view
        job.run()


def test_leaning_cameras_have_a_view():
    """Blender's camera matrix has axes that lean where a parent is scaled unevenly."""
    rng, job = np.random.default_rng(0), Job("render")
    turn = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    for shear in (0.0, 0.01, 0.5):
        view = np.eye(4)
        view[:3, :3] = np.linalg.qr(turn[:3, :3])[0] @ (np.eye(3) + shear * np.eye(3, k=1))
        job.job.camera.view[:] = cameras.rotation(view).ravel()
        job.run()
        assert shear or np.array_equal(cameras.rotation(view), view[:3, :3])


@pytest.mark.parametrize("flag", [7, -1])
def test_flags_are_0_or_1(flag):
    job = Job("render")
    job.job.camera.orthographic = flag
    job.refused(f"^camera: orthographic is {flag};")
    for name in ("linear", "wrap_x", "wrap_y"):
        job = Job("bake")
        setattr(job.job, name, flag)
        job.refused(f"^{name}: is {flag};")


@pytest.mark.parametrize("distance", [-1, np.inf, np.nan])
def test_the_camera_s_distance_is_finite(distance):
    job = Job("render")
    job.job.camera.distance = distance
    job.refused("^camera: a distance of ")


def test_parameters_are_there():
    job = Job("render")
    job.job.params = None
    job.refused("^params: 0 styles; give 1 to ")


@pytest.mark.parametrize("style, words", [(0, "^line_thickness: -5 is out of range"), (1, "^style 1: line_thickness"),
                                          (2, "^style 2: line_thickness")])
def test_parameters_of_every_style_are_checked(style, words):
    every = load().complete({}, [{}, {}])
    every[style]["line_thickness"] = -5.0
    with pytest.raises(EncreError, match=words):
        load().draw(drawn.scene(WIDTH, HEIGHT), every)


def test_parameters_are_aligned():
    for kind in ("render", "bake"):
        job = Job(kind)
        at = job.memory(2 * len(job.block)) + 4
        ctypes.memmove(at, job.block, len(job.block))
        job.job.params = at
        job.refused("^params: .*address")


@pytest.mark.parametrize("field", ["points", "corners"])
def test_meshes_are_aligned(field):
    job = Job("raster")
    setattr(job.mesh, field, getattr(job.mesh, field) + 2)
    job.refused("^mesh 0: .*address")


# ---- distances of 16 bits


def lone_edge(width, height, x, y):
    layers = drawn.scene(width, height, n=0)
    layers["object"] = np.zeros((height, width), np.float32)
    layers["object"][y, x] = 1
    return layers


def test_a_border_of_a_high_frame():
    """Its lines may be wider than 16 bits hold, the way to an edge in it can't be longer. Where it has no edge there is
    none."""
    wide = dict(edge_detector="SOBEL", line_search="NEAREST", line_thickness=4096.0, line_thickest=4096.0)
    empty = {name: np.zeros_like(a) for name, a in lone_edge(8, 8, 3, 3).items()}
    for layers in (drawn.scene(8, 8), lone_edge(8, 8, 3, 3), empty):
        got = [load().render(layers, wide, frame=Frame(30720, height, 9, 9)).images["Combined"]
               for height in (17270, 17280)]
        assert np.array_equal(*got)
    assert not got[0].any()


@pytest.mark.parametrize("search, reach, far", [
    (search, reach, far) for search in ("NEAREST", "EXACT") for reach in (4096.0, 100.0) for far in (39999, 20000)])
def test_long_ways_to_an_edge(search, reach, far):
    """In a picture of 40000 pixels, lines that go on for all of it: EXACT draws them, NEAREST says that it can't."""
    scene = dict(edge_detector="SOBEL", line_search=search, line_thickness=reach, line_thickest=reach,
                 pen_1_softness=0.0, pen_1_grain=0.0, line_outline_width=1.0)
    layers = lone_edge(40000, 1, far, 0)
    frame = Frame(40000, 17280)
    if search == "NEAREST" and reach == 4096:
        with pytest.raises(EncreError, match="line_thickest.*smudge_range.*; give less"):
            load().render(layers, scene, frame=frame)
        return
    ink = load().render(layers, scene, outputs=["Encre Lines"], frame=frame).images["Encre Lines"][0, :, 3]
    inked = np.flatnonzero(ink)
    assert inked.size and far - inked[0] == pytest.approx(min(8 * reach, far), abs=2)


@pytest.mark.parametrize("function", ["render", "raster", "bake", "light", "material", "even", "average"])
def test_no_job_and_no_context_are_refused(function):
    lib = load().lib
    call, context = getattr(lib, f"encre_{function}"), lib.encre_create(API_VERSION)
    assert call(context, None) == 1 and b"NULL; give" in lib.encre_error(context)
    assert call(None, None) == 1
    lib.encre_destroy(context)


def test_without_a_context_nothing_goes_on():
    lib = load().lib
    assert lib.encre_start(None, None, 0) == lib.encre_poll(None, None) == lib.encre_wait(None) == 1
    assert lib.encre_set_threads(None, 1) == lib.encre_set_simd(None, 1) == 1
    lib.encre_cancel(None)


def test_a_check_of_nothing_finds_fault():
    lib, block = load().lib, ctypes.create_string_buffer(load().lib.encre_params_size())
    lib.encre_params_init(block)
    text = ctypes.create_string_buffer(200)
    assert lib.encre_params_check(block, text, 200) is None
    for block_, text_, size in ((None, text, 200), (block, None, 200), (block, text, 0)):
        assert b"NULL; give" in lib.encre_params_check(block_, text_, size)


TRIANGLE = np.array([(-1, -1, 0), (1, -1, 0), (0, 1, 0)], np.float32)


def raster(mesh=None, **how):
    how = {"outputs": ("depth",), "into": {}, "channels": 0, **how}
    return load().raster_work([mesh or Mesh(TRIANGLE)], np.eye(4), np.eye(4), Frame(8, 6), (8, 6), 0.1, **how)


def test_arrays_of_a_mesh_have_all_their_axes():
    for wrong in ((1, 3), (1, 3, 3, 1), (2, 3, 3), (1, 2, 3)):
        with pytest.raises(EncreError, match="^mesh: attributes: the array has shape"):
            raster(Mesh(TRIANGLE, attributes=np.zeros(wrong)), channels=3)


def fixed(a):
    a.flags.writeable = False
    return a


@pytest.mark.parametrize("wrong", [
    fixed(np.zeros((6, 8), np.float32)), np.broadcast_to(np.float32(0), (6, 8)), np.zeros((6, 8)),
    np.zeros((6, 9), np.float32), np.zeros((6, 16), np.float64)[:, ::2], np.zeros((6, 8), object)],
    ids=["fixed", "spread", "doubles", "larger", "strided doubles", "objects"])
def test_what_is_filled_is_as_c_writes_it(wrong):
    with pytest.raises(EncreError, match="^depth: the array can't be filled; give "):
        raster(into={"depth": wrong})


def test_pixels_may_lie_apart_where_they_are_filled():
    wide = np.full((6, 8, 3), 7, np.float32)
    load().run(raster(into={"depth": wide[..., 1]}), 1, 1)
    assert (wide[..., ::2] == 7).all() and (wide[..., 1] == load().run(raster(), 1, 1)["depth"]).all()


def test_outputs_of_the_rasteriser_have_names():
    with pytest.raises(EncreError, match="^raster: foo: unknown output"):
        raster(outputs=("depth", "foo"))


def test_numbers_are_not_cut_to_what_c_counts_by():
    with pytest.raises(EncreError, match=r"^frame: width: 1099511627776 is more than can be counted"):
        load().raster_work([Mesh(TRIANGLE)], np.eye(4), np.eye(4), Frame(2 ** 40, 6), (8, 6), 0.1)
    with pytest.raises(EncreError, match="^mesh: object_index: -4294967295 is more"):
        raster(Mesh(TRIANGLE, object_index=1 - 2 ** 32))
    with pytest.raises(EncreError, match="^threads: 1099511627776 is more"):
        load().run(raster(), 2 ** 40, 1)
    for corners in ([[0, 1, 2 ** 32 + 2]], [[0, 1, 1.7]], [[0, 1, np.nan]]):
        with np.errstate(invalid="ignore"), pytest.raises(EncreError, match="^mesh: corners: a number in it is not"):
            raster(Mesh(TRIANGLE, np.array(corners)))
    raster(Mesh(TRIANGLE, np.array([[0.0, 1, 2]])))  # whole, of whatever type
