# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that a renderer can't tell apart from pixel to pixel, and such as pass through each other."""

from math import radians

import bpy
from mathutils import Matrix, Vector
from studio import cube, material, shoot, stage


def _bare(scene):
    """Nothing but the ground, and thin ink."""
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    scene.encre.line_thickness, scene.encre.use_shading, scene.encre.line_paper = 12, False, 0


def coincident(out):
    """Two boxes, turned, whose front faces lie in one plane, and the same without the second."""
    scene = stage(320, 180, 1)
    _bare(scene)
    turned = Matrix.Rotation(radians(25), 4, "Z")
    first = cube("First", (-0.4, 0, 0.1), 1.4, material("Blue", (0.2, 0.3, 0.8)))
    second = cube("Second", first.location + turned @ Vector((0.35, -0.25, 0.3)), 0.9, material("Red", (0.8, 0.2, 0.1)))
    first.rotation_euler = second.rotation_euler = (0, 0, radians(25))
    shoot(out, "both")
    second.location += turned @ Vector((0, 0.002, 0))
    shoot(out, "behind")
