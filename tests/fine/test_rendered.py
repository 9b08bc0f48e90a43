# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines on pictures that Cycles rendered with 16 samples, judged against the contours of the meshes in them.

Of the promises those that one picture can keep: place, widths, evenness, once, whole, nothing else. The light's
boundaries are off: where a lamp's shadow falls does not follow from the meshes alone."""

import functools
import json
from dataclasses import replace

import blenders
import exr
import numpy as np
import pytest
from encre.cli import composite
from judge import fresh, kinds, measure, meshes, scenes, thin, unseen, verdict
from judge.camera import look

pytestmark = pytest.mark.slow

SIZE = 270, 480
PARAMS = verdict.PARAMS | {"line_shadow_strength": 0.0}
SCENE = '''
import bpy, json
from mathutils import Matrix
from pathlib import Path
told = json.loads(Path(__file__).with_suffix(".json").read_text())
scene = bpy.context.scene
for name, (points, faces, color, smooth) in told["meshes"].items():
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = *color, 1
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(material)
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))
sun = bpy.data.lights.new("Sun", "SUN")
sun.energy = 3
sun = bpy.data.objects.new("Sun", sun)
sun.rotation_euler = -0.9, 0.5, 0
data = bpy.data.cameras.new("Camera")
data.sensor_fit, data.sensor_height, data.lens = "VERTICAL", 24, 24 * told["focal"]
if told["height"]:
    data.type, data.ortho_scale = "ORTHO", told["height"]
camera = bpy.data.objects.new("Camera", data)
camera.matrix_world = Matrix([*zip(*told["view"], told["eye"], strict=True), (0, 0, 0, 1)])
for obj in sun, camera:
    scene.collection.objects.link(obj)
scene.camera = camera
scene.cycles.samples, scene.cycles.use_denoising = 16, False
scene.render.resolution_y, scene.render.resolution_x = told["size"]
scene.view_settings.view_transform = "Standard"
'''
CAMERAS = {
    "above": look([0.6, 2.3, 6.0], [0.1, 0.5, 0]),
    "low, rolled": look([-2.6, 0.7, 5.2], [0.1, 0.6, 0], roll=0.11),
    "parallel": look([2.6, 3.1, 6.0], [0.1, 0.5, 0], height=4.4),
}


@pytest.fixture(scope="module", params=[
    pytest.param(name, marks=() if name == "low, rolled" else pytest.mark.long) for name in CAMERAS])
def scene(request):
    """A ball and a box that hides part of it, on a plane that ends."""
    floor = meshes.quad([(-4, 0, 3), (4, 0, 3), (4, 0, -4), (-4, 0, -4)], color=(0.5, 0.5, 0.45))
    block = meshes.box((1.6, 1.2, 1.1), (-0.75, 0.6, 0.3), scenes.turned(0.5), color=(0.7, 0.3, 0.25))
    ball = meshes.sphere(0.9, (0.75, 0.9, -0.6), color=(0.3, 0.45, 0.6))
    return meshes.MeshScene(CAMERAS[request.param], [floor, block, ball], SIZE)


def rendered(scene, folder, *more, smooth=False):
    """draw(detector, thickness): T of lines drawn on one and the same render of a judge's scene."""
    camera, frame = scene.camera, folder / "frame.exr"
    told = {"meshes": {f"Mesh {k}": (m.points.tolist(), [list(map(int, face)) for face in m.faces],
                                     [float(c) for c in m.color], len(m.faces) > 6 and smooth)
                       for k, m in enumerate(scene.solids)},
            "eye": camera.eye.tolist(), "view": camera.view.tolist(), "focal": camera.focal, "height": camera.height,
            "size": scene.size}
    (folder / "scene.json").write_text(json.dumps(told))
    (folder / "scene.py").write_text(SCENE)
    blenders.encre("bpy", folder, "render", folder / "scene.py", "-o", frame, *more)

    @functools.cache
    def draw(detector, thickness):
        out = folder / f"{detector}{thickness}.exr"
        composite.composite(str(frame), str(out), PARAMS | {"edge_detector": detector, "line_thickness": thickness})
        return exr.part(out, "ViewLayer.Encre Lines")[..., 3]
    return draw


@pytest.fixture(scope="module")
def draw(scene, tmp_path_factory):
    return rendered(scene, tmp_path_factory.mktemp("rendered"), smooth=True)


def judged(draw, truth, detector="FINE", widest=None):
    """{promise: value}"""
    found = verdict.lines(draw(detector, 1.0), truth)
    return found | {f"width {asked}": measure.width(draw(detector, float(asked)), truth, asked, widest)
                    for asked in (1, 2, 4, 8)}


def broken(found):
    return {promise: value for promise, value in found.items() if not verdict.kept(promise, value)}


def test_fine_keeps_its_promises(scene, draw):
    truth = scene.truth
    assert truth.required("outline").sum() > 5000 and truth.required("crease").sum() > 500
    assert measure.place(draw("FINE", 1.0), truth)["count"] > 500
    assert broken(judged(draw, truth)) == {}


@pytest.mark.parametrize("dx, dy", [(0.4, 0), (0, -0.4)])
def test_contours_a_little_elsewhere_are_noticed(scene, draw, dx, dy):
    truth = scene.truth
    moved = replace(truth, x=truth.x + dx, y=truth.y + dy)
    assert "place p95" in broken(judged(draw, moved))


def test_a_contour_too_many_or_too_few_is_noticed(scene, draw):
    truth, t = scene.truth, draw("FINE", 1.0)
    crease = truth.required("crease")
    assert "stray" in broken(verdict.lines(t, truth.take(~crease)))
    without = np.where(measure.ideal(truth, 5, "crease") > 0, 0, t)
    assert {"whole crease"} <= broken(verdict.lines(without, truth)).keys()


def test_dog_breaks_them(scene, draw):
    found = broken(judged(draw, scene.truth, "DOG"))
    assert {"place p95", "width 1", "evenness"} <= found.keys()


MESHES = kinds.MESHES | unseen.MESHES | fresh.MESHES
CUT_OUT = {"leaves", "branch"}  # by alpha: no plain meshes
ONE_PLANE = {"coincident", "keyboard"}  # of faces in one plane Cycles shows one, and meshes tell of another


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(MESHES.keys() - ONE_PLANE - CUT_OUT))
def test_by_cycles_no_scene_of_meshes_breaks_more_than_by_fast(name, tmp_path):
    scene = MESHES[name]()
    widest = functools.partial(thin.widest, scene)
    fast, cycles = (broken(judged(rendered(scene, tmp_path, "--set", f"layer_source={source}"), scene.truth,
                                  widest=widest)) for source in ("ENCRE", "CYCLES"))
    assert cycles == pytest.approx(fast, abs=2e-3)
