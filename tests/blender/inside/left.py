# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: draws a scene of what passes for meshes a few times by both kinds of layers, and ends as users do:
Blender tells then what nobody has freed."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from studio import plane, stage  # noqa: E402

scene = stage(32, 18)
bpy.ops.object.text_add()
bpy.ops.curve.primitive_bezier_circle_add(location=(1, 0, 1))
bpy.context.object.data.bevel_depth = 0.1
bpy.ops.object.metaball_add(location=(-1, 0, 1))
on = plane("On", z=2.0)
on.instance_type = "VERTS"
bpy.data.objects["Ball"].parent = on
for source in ("ENCRE", "CYCLES"):
    scene.encre.layer_source = source
    for _ in range(2):
        bpy.ops.render.render()
print("drawn")
