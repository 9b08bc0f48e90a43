# SPDX-License-Identifier: GPL-3.0-or-later
"""The living room in every Blender: how much is in it, that its textures are crisp, and where the camera flies."""

import importlib
import json
from pathlib import Path

import blenders
import exr
import numpy as np
import pytest
from encre.pen import library

pytestmark = pytest.mark.slow

ROOM = Path(__file__).parents[2] / "scenes" / "living_room.py"

# Builds the room and writes down what is in it.
SCRIPT = f'''
import json, sys
sys.path.insert(0, {str(ROOM.parent)!r})
import bpy
import numpy as np
import living_room

living_room.build()
objects, images = {{}}, {{}}
for obj in bpy.context.scene.objects:
    for slot in obj.material_slots:
        for node in slot.material.node_tree.nodes:
            if node.type == "TEX_IMAGE":
                objects[obj.name] = len(obj.data.vertices)
                images[node.image.name] = node.image
facts = {{"objects": objects, "images": {{}}}}
for name, image in images.items():
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    grid = np.round(pixels.reshape(height, width, 4)[..., :3] * 255).astype(np.int64) @ [65536, 256, 1]
    same = (grid[1:] == grid[:-1])[:, 1:] & (grid[:, 1:] == grid[:, :-1])[1:]
    facts["images"][name] = len(np.unique(grid)), float(same.mean()), bool(image.packed_file), width, height
scene = bpy.context.scene
facts["frames"] = scene.frame_start, scene.frame_end, scene.render.fps
path = []
for frame in range(1, 481, 6):
    scene.frame_set(frame)
    path.append([list(row) for row in scene.camera.matrix_world])
facts["path"] = path
scene.frame_set(1)
with open("FACTS", "w") as file:
    json.dump(facts, file)
'''


@pytest.fixture(params=blenders.params(), scope="module")
def room(request, tmp_path_factory):
    """What is in it; it was rendered as well."""
    folder = tmp_path_factory.mktemp("room")
    (folder / "room.py").write_text(SCRIPT.replace("FACTS", str(folder / "facts.json")))
    blenders.encre(request.param, folder, "render", folder / "room.py", "-o", folder / "room.exr", "--size", "160x90",
                   "--samples", "1")
    picture = exr.part(folder / "room.exr", "ViewLayer.Combined")
    lines = exr.part(folder / "room.exr", "ViewLayer.Encre Lines")
    assert picture[..., :3].std() > 0.1 and 0.02 < lines[..., 3].mean() < 0.6
    return json.loads((folder / "facts.json").read_text())


def test_many_objects_many_textures(room):
    assert len(room["objects"]) >= 26 and len(room["images"]) >= 26
    assert len(set(room["objects"].values())) >= 15  # of varied shape


def test_textures_are_areas_of_one_color(room):
    """Few colours, mostly like their neighbours, nothing between: no texel is a mixture of two areas."""
    for name, (colors, same, packed, width, height) in room["images"].items():
        assert colors <= 16 and same > 0.75 and packed and min(width, height) >= 256, name


def test_flight(room):
    """Twenty seconds, without a jump or a jerk, and always inside the room."""
    assert room["frames"] == [1, 480, 24]
    places = np.array(room["path"])
    at, ahead = places[:, :3, 3], -places[:, :3, 2]
    steps = np.diff(at, axis=0)
    assert np.linalg.norm(steps, axis=1).max() < 0.25 and np.linalg.norm(np.diff(steps, axis=0), axis=1).max() < 0.06
    assert (ahead[1:] * ahead[:-1]).sum(1).min() > np.cos(np.radians(8))
    assert (np.abs(at[:, 0]) < 2.6).all() and (at[:, 1] < 1.9).all() and (np.abs(at[:, 2] - 1.4) < 1).all()
    assert np.linalg.norm(steps, axis=1).sum() > 6


@pytest.mark.parametrize("name", ["rug", "ship", "world_map", "chessboard", "clock"])
def test_baked_textures_do_not_depend_on_threads(monkeypatch, name):
    monkeypatch.syspath_prepend(ROOM.parent)
    texture = np.ascontiguousarray(getattr(importlib.import_module("pictures"), name)(), np.float32)
    one = library.bake(texture, {"line_thickness": 6.0}, threads=1).texture
    assert (one < texture).any(2).mean() > 0.02
    for threads in 2, 5:
        assert np.array_equal(library.bake(texture, {"line_thickness": 6.0}, threads=threads).texture, one)
