# SPDX-License-Identifier: GPL-3.0-or-later
"""How far away what the picture is about stands: by the focus, else by the scene's size, and the same in all frames."""

import json
import subprocess
import sys

import pytest

SCRIPT = '''
import json, os
import bpy
import numpy as np
import encre
from encre.blender import subject

encre.register()
bpy.ops.wm.read_factory_settings(use_empty=True)
scene, facts = bpy.context.scene, {}

def cube(place, size=1.0):
    bpy.ops.mesh.primitive_cube_add(size=size, location=place)
    return bpy.context.object

def distance(lens=50.0):
    camera.lens = lens
    graph = bpy.context.evaluated_depsgraph_get()
    there = scene.camera.evaluated_get(graph)
    view = np.array(there.matrix_world.inverted())
    projection = np.array(there.calc_matrix_camera(graph, x=160, y=90))
    return subject.distance(graph, there, view, projection)

camera = bpy.data.cameras.new("Camera")
scene.camera = bpy.data.objects.new("Camera", camera)
scene.collection.objects.link(scene.camera)
scene.camera.location = 0, 0, 20
facts["nothing"] = distance()
for x in (-6, -3, 0, 3, 6):
    cube((x, 0, 0))
facts["plain"] = distance()
cube((0, 0, -5000), 10000)
facts["ground"] = distance()
flies = cube((50, 0, 0))
flies.keyframe_insert("location", frame=1)
flies.location = -900, 4, 4
flies.keyframe_insert("location", frame=10)
child = cube((1, 0, 0))
child.parent = flies
facts["frames"] = [(scene.frame_set(frame), distance())[1] for frame in (1, 5, 10)]
facts["long lens"] = distance(100.0) / distance()
camera.dof.focus_distance = 7
facts["no focus"] = distance() != 7
camera.dof.use_dof = True
facts["focus"] = distance()
camera.dof.focus_object = bpy.data.objects["Cube.001"]
facts["focus object"] = distance(100.0)
camera.dof.focus_object.location.z = 30  # behind the camera
facts["behind"] = distance()
for obj in scene.objects:
    if obj.type == "MESH":
        obj.constraints.new("COPY_SCALE")
camera.dof.focus_object = None
camera.dof.use_dof = False
facts["all move"] = distance()
print("FACT", json.dumps(facts), flush=True)
os._exit(0)  # bpy's own end may crash
'''


def test_the_distance_of_what_the_picture_is_about():
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=120)
    line = next((line for line in done.stdout.splitlines() if line.startswith("FACT ")), None)
    assert line, done.stderr
    facts = json.loads(line[5:])
    assert facts["nothing"] == 0
    assert facts["plain"] == pytest.approx(0.5 * 3.2 * ((3 + 3**0.5 / 2) * 3**0.5 / 2)**0.5 * 100 / (36 * 9 / 16))
    assert facts["ground"] == pytest.approx(facts["plain"]), "ground to the horizon doesn't count"
    assert facts["frames"] == pytest.approx([facts["plain"]] * 3), "nor what moves"
    assert facts["long lens"] == pytest.approx(2)
    assert facts["no focus"] and facts["focus"] == 7 and facts["focus object"] == pytest.approx(20)
    assert facts["behind"] > 0
    assert facts["all move"] == pytest.approx(0.5 * 3.2 * 3**0.5 / 2 * 100 / (36 * 9 / 16))
