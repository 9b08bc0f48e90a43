# SPDX-License-Identifier: GPL-3.0-or-later
"""Where what the boundary allows ends: the last number that is right is taken, the first beyond it refused."""

import ctypes

import numpy as np
import pytest
from encre.pen import abi
from encre.pen.errors import EncreError
from encre.pen.library import load
from encre.pen.scene import Scene
from jobs import HEIGHT, KINDS, WIDTH, Job, told

NAMES = [(kind, name) for kind in KINDS for name in Job(kind).images]
OUTPUTS = {"render": list(load().outputs), "raster": list(KINDS["raster"]), "bake": ["output"], "light": ["diffuse"],
           "material": list(abi.MATERIAL_OUTPUTS)}
REQUIRED = {"render": {"combined", "color", "diffuse", "depth", "normal"}, "raster": set(), "bake": {"texture"},
            "light": {"depth", "diffuse"}, "material": set(abi.MATERIAL_INPUTS)}
MOST_CHANNELS, MOST_TEXELS = 24, 32768
NAN, INF = float("nan"), float("inf")


# ---- images


@pytest.mark.parametrize("kind, name", NAMES)
def test_an_image_has_its_channels_its_size_and_its_place(kind, name):
    for change in (-1, 1):
        job = Job(kind)
        job.images[name].channels += change
        if name not in ("texture", "attributes"):
            job.refused(f"^{name}: has . channels|^{name}: has 1. channels")
    for field, size in (("width", WIDTH), ("height", HEIGHT)):
        for wrong in (0, size - 1):
            job = Job(kind)
            setattr(job.images[name], field, wrong)
            job.refused(": is ")
    job = Job(kind)
    job.images[name].data += 2
    job.refused(f"^{name}: .*address")


@pytest.mark.parametrize("kind, name", NAMES)
def test_which_images_may_be_missing(kind, name):
    job = Job(kind)
    job.images[name].data = None
    if name in REQUIRED[kind]:
        job.refused(f"^{name}: ")
    else:
        job.run()


@pytest.mark.parametrize("kind", KINDS)
def test_every_output_lies_apart_from_every_other_image(kind):
    for output in OUTPUTS[kind]:
        for other in Job(kind).images:
            if other != output:
                job = Job(kind)
                job.images[output].data = job.images[other].data
                job.refused(f"^({output}: shares memory with {other}|{other}: shares memory with {output});")


def test_how_many_channels_there_may_be():
    for kind, least in (("raster", 0), ("material", 1)):
        for channels in (least - 1, least, MOST_CHANNELS, MOST_CHANNELS + 1):
            job = Job(kind)
            job.give("attributes", max(channels, 1))
            job.images["attributes"].channels = channels
            if channels == 0 and kind == "raster":
                job.images["attributes"].data = None
            if kind == "raster":
                job.job.n_channels = channels
            if least <= channels <= MOST_CHANNELS:
                job.run()
            else:
                job.refused("^attributes: -?[0-9]+ channels; give ")
    for channels in (2, 3, 4, 5):
        job = Job("bake")
        job.give("texture", channels)
        job.give("output", channels)
        if channels in (3, 4):
            job.run()
        else:
            job.refused("^texture: has . channels; give 3 or 4")


@pytest.mark.parametrize("width, height", [(MOST_TEXELS, 1), (1, MOST_TEXELS), (MOST_TEXELS + 1, 1),
                                           (1, MOST_TEXELS + 1)])
def test_how_large_a_texture_may_be(width, height):
    job = Job("bake")
    for image in job.images.values():
        image.data, image.width, image.height = job.memory(4 * width * height * image.channels), width, height
        image.pixel_stride = image.row_stride = 0
    scene, alpha = Scene(), np.zeros((height, width), np.uint8)
    if max(width, height) <= MOST_TEXELS:
        job.run()
        scene.texture(0, alpha)
    else:
        job.refused("^texture: is .* texels; give 1 to 32768 each way")
        with pytest.raises(EncreError, match="^texture 0: .* texels; give 1 to 32768"):
            scene.texture(0, alpha)


@pytest.mark.parametrize("stride, right", [(1 << 45, True), ((1 << 45) + 4, False), (12, True), (8, False)])
def test_how_far_pixels_may_lie_apart(stride, right):
    job = Job("bake")
    for image in job.images.values():
        image.width, image.pixel_stride, image.row_stride = 1, 12, 12
    job.images["texture"].pixel_stride = stride
    if right:
        job.run()
    else:
        job.refused("^texture: strides of ")
    job = Job("bake")
    for image in job.images.values():
        image.height = 1
    for stride, right in ((1 << 45, True), (-(1 << 45), True), ((1 << 45) + 4, False), (-(1 << 45) - 4, False)):
        job.images["texture"].row_stride = stride
        if right:
            job.run()
        else:
            job.refused("^texture: strides of ")


# ---- numbers


@pytest.mark.parametrize("kind", ["raster", "light", "material"])
def test_matrices_are_finite_to_their_last_number(kind):
    for matrix, k in (("view", 0), ("view", 15), ("projection", 0), ("projection", 15)):
        job = Job(kind)
        getattr(job.job, matrix)[k] = INF
        job.refused("^camera: ")
    for name, wrong in (("clip_start", INF), ("clip_start", NAN), ("clip_end", NAN)):
        if kind != "material":
            job = Job(kind)
            setattr(job.job, name, wrong)
            job.refused("^camera: ")
    for k in (0, 26) if kind == "light" else ():
        job = Job(kind)
        job.job.world[k] = NAN
        job.refused("^world: ")
    job = Job(kind)
    if kind != "material":
        job.job.clip_end = INF
    job.run()


def test_a_view_turns_to_a_thousandth():
    for k in range(3):
        for length, right in ((0.9e-3, True), (1.1e-3, False), (-0.9e-3, True), (-1.1e-3, False)):
            job = Job("render")
            job.job.camera.view[4 * k] = np.sqrt(1 + length)
            if right:
                job.run()
            else:
                job.refused("^camera: view is no rotation")


def test_an_orthographic_camera_has_a_height():
    for height, right in ((0, False), (1e-6, True), (3e38, True), (INF, False), (NAN, False), (-1, False)):
        job = Job("render")
        job.job.camera.orthographic, job.job.camera.height = 1, height
        if right:
            job.run()
        else:
            job.refused("^camera: an orthographic height of ")


def test_how_many_styles_there_may_be():
    for count, right in ((0, False), (1, True), (256, True), (257, False)):
        job = Job("render")
        size = len(job.block)
        at = job.memory(257 * size)
        for k in range(257):
            ctypes.memmove(at + k * size, job.block, size)
        job.job.params, job.job.n_styles = at, count
        if right:
            job.run()
        else:
            job.refused("^params: ")


def test_how_many_threads_there_may_be():
    library = load()
    for threads in (0, 1024):
        library.lib.encre_destroy(library.context(threads))
    for threads in (-1, 1025):
        with pytest.raises(EncreError, match=f"^threads: {threads} .*; "):
            library.context(threads)


# ---- meshes


@pytest.mark.parametrize("field, wrong", [
    ("kind", -1), ("kind", 2), ("n_primitives", -1), ("n_points", -1), ("n_points", 2), ("n_channels", -1),
    ("n_channels", MOST_CHANNELS + 1), ("points", None), ("corners", None)])
def test_a_mesh_is_whole(field, wrong):
    job = Job("raster")
    setattr(job.mesh, field, wrong)
    if field == "corners":
        job.mesh.n_points = 2
    job.refused("^mesh 0: ")
    if field == "kind":
        job.mesh.kind, job.mesh.n_primitives = 1, 1
        job.run()


def test_there_may_be_no_mesh():
    job = Job("raster")
    job.job.n_meshes, job.job.meshes = 0, None
    job.run()
    assert (job.keep[1] > 1e9).all() and not job.keep[3].any()  # depth and object, after the mesh
    for count, meshes in ((1, None), (-1, ctypes.pointer(job.mesh))):
        job.job.n_meshes, job.job.meshes = count, meshes
        job.refused(f"^meshes: {count} of them are not there;")


PARTS = dict(points=9, corners=3, attributes=9, material=1, style=1, object=1, normals=9, rest=9, rest_normals=9)


@pytest.mark.parametrize("kind", [0, 1])
@pytest.mark.parametrize("name, channels", [*((name, 3) for name in PARTS), ("attributes", 1)])
def test_outputs_lie_apart_from_all_of_a_mesh(name, channels, kind):
    """From its first number to its last, and no farther, of the last mesh too."""
    job = Job("raster")
    meshes = (abi.Mesh * 2)(job.mesh, job.mesh)
    job.job.meshes, job.job.n_meshes = meshes, 2
    meshes[1].kind, meshes[1].n_channels = kind, channels
    number = PARTS[name] if channels == 3 else 3
    number = number if name == "points" or not kind else {9: 6, 3: 2}.get(number, 1)
    setattr(meshes[1], name, job.memory(40))
    if name == "points":
        ctypes.memmove(meshes[1].points, job.mesh.points, 36)
    if name == "corners":
        (ctypes.c_int32 * 3).from_address(meshes[1].corners)[:] = 0, 1, 2
    for image in job.images.values():
        image.data = None
    depth, memory = job.images["depth"], getattr(meshes[1], name)
    depth.width = depth.height = depth.channels = 1
    depth.pixel_stride = depth.row_stride = 0
    job.job.frame = abi.Frame(1, 1, 0, 0)
    for at in (0, number - 1):
        depth.data = memory + 4 * at
        job.refused("^depth: shares memory with a mesh;")
    depth.data = memory + 4 * number
    job.run()
    depth.data = job.memory(4)
    setattr(meshes[1], name, memory + 2)
    job.refused("^mesh 1: .*address")


# ---- scenes


def put(kind, value):
    scene = Scene()
    scene._set(getattr(scene._library.lib, "encre_scene_" + kind), 7, value)


def refused(kind, value, words):
    with pytest.raises(EncreError, match=f"^{kind} 7: {words}") as error:
        put(kind, value)
    told(error)


def geometry(**changes):
    memory = np.zeros(40, np.float32)
    value = abi.Geometry(3, 1, *[memory.ctypes.data] * 5)
    value.keep = memory
    for name, change in changes.items():
        setattr(value, name, getattr(value, name) + change if change in (1, 2, -9) and "n_" not in name else change)
    return value


@pytest.mark.parametrize("field", ["points", "corners", "normals", "uvs", "textures"])
def test_a_geometry_is_whole(field):
    put("geometry", geometry())
    refused("geometry", geometry(**{field: 2}), "one of its arrays begins at an address")
    if field == "normals":
        put("geometry", geometry(normals=None))
    else:
        refused("geometry", geometry(**{field: None}), "has ")
    for wrong in (dict(n_points=-1), dict(n_triangles=-1), dict(n_triangles=(2**31 - 1) // 16 + 1)):
        refused("geometry", geometry(**wrong), ".* triangles of ")


@pytest.mark.parametrize("corner, right", [(0, True), (2, True), (3, False), (-1, False)])
def test_corners_are_points(corner, right):
    value, corners = geometry(), np.zeros(3, np.int32)
    corners[2] = corner
    value.corners = corners.ctypes.data
    if right:
        put("geometry", value)
    else:
        refused("geometry", value, "triangle 0 has a corner at point ")


def test_how_a_texture_goes_on():
    alpha = np.zeros(4, np.uint8)
    for extension, closest, right in ((0, 0, True), (2, 1, True), (-1, 0, False), (3, 0, False), (0, -1, False),
                                      (0, 2, False)):
        value = abi.Texture(2, 2, extension, closest, alpha.ctypes.data)
        if right:
            put("texture", value)
        else:
            refused("texture", value, "extension is ")
    refused("texture", abi.Texture(2, 2, 0, 0, None), "has no alpha")
    refused("texture", abi.Texture(0, 2, 0, 0, alpha.ctypes.data), "0 x 2 texels")
    refused("texture", abi.Texture(2, 0, 0, 0, alpha.ctypes.data), "2 x 0 texels")


def lamp(kind=1, **changes):
    value = abi.Lamp(kind, 1, 0, 0, (1, 1, 1), 1, 1, 1, 0.5, 1)
    value.model[:] = np.eye(4).ravel()
    for name, change in changes.items():
        setattr(value, name, change)
    return value


@pytest.mark.parametrize("name, least, most, beyond", [
    ("width", 0, 3e38, INF), ("height", 0, 3e38, INF), ("spot_angle", 0, 3.1416, 3.1417), ("spot_blend", 0, 1, 1.001),
    ("spread", 0, 3.1416, 3.1417), ("light_set", 0, 63, 64), ("shadow_set", 0, 63, 64), ("shadows", 0, 1, 2),
    ("flat", 0, 1, 2), ("type", 0, 4, 5)])
def test_how_far_numbers_of_lamps_go(name, least, most, beyond):
    for value in (least, most):
        put("lamp", lamp(**{name: value}))
    for value in (-1, beyond) if isinstance(beyond, int) else (-0.001, beyond, NAN):
        refused("lamp", lamp(**{name: value}), f"{name} ")


def test_lamps_have_a_place_and_a_colour():
    put("lamp", lamp(0, width=3.1416))
    refused("lamp", lamp(0, width=3.1417), "width is ")
    for k in range(3):
        value = lamp()
        value.color[k] = NAN
        refused("lamp", value, "its color is not finite")
    for k in (0, 15):
        value = lamp()
        value.model[k] = INF
        refused("lamp", value, "its model is not finite")


def test_instances_are_seen_or_not():
    for camera in (-1, 2):
        refused("instance", abi.Instance(0, camera=camera), "camera is ")
