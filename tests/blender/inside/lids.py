# SPDX-License-Identifier: GPL-3.0-or-later
"""The lids of a subdivided head, by Ink only, close up and from several sides."""

import os
import sys

import bpy
from encre.pen.presets import find
from mathutils import Vector
from studio import HERE, passes_on, register, shoot

sys.path.append(os.path.join(HERE, "..", "..", "helpers"))
import strangers  # noqa: E402 - found only now

VIEWS = ((0.45, -4.2, 0.5), 170, 2), ((1.6, -4.0, 0.9), 170, 2), ((-0.9, -4.2, -0.4), 150, 3)
EYE = Vector((0.35, -0.6, 0.24))


def lids(out):
    """Seen from three places with a lens, of as many subdivisions."""
    for k, (place, lens, levels) in enumerate(VIEWS):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        register()
        scene = bpy.context.scene
        scene.render.engine = "ENCRE"
        scene.render.resolution_x, scene.render.resolution_y = 640, 360
        strangers.head()
        bpy.data.objects["Suzanne"].modifiers[0].render_levels = levels
        passes_on(scene.view_layers[0])
        camera = scene.camera
        camera.location, camera.data.lens = place, lens
        camera.rotation_euler = (EYE - Vector(place)).to_track_quat("-Z", "Y").to_euler()
        for name, value in find("ink_only").values.items():
            if not isinstance(value, list):
                setattr(scene.encre, name, value)
        scene.encre.layer_source, scene.encre.line_shadow_strength = "ENCRE", 0
        shoot(out, f"view {k}")
