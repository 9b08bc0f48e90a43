# SPDX-License-Identifier: GPL-3.0-or-later
"""The girl of the street corner alone in even light, and a camera that goes round her, a degree a frame."""

from math import radians

import bpy
from common import camera, light, settings, world
from figures import girl

FRAMES = 24


def build():
    girl((0, 0, 0), -10)
    world(sky=(0.9, 0.9, 0.9), fill=(0.5, 0.5, 0.5))
    light("SUN", "Sun", (-3, -4, 5), (0, 0, 0), (1.0, 0.95, 0.85), 2.0, angle=radians(0.5))
    eye = camera((0.3, -6.0, 1.5), (0.02, 0, 0.98), 75)
    pivot = bpy.data.objects.new("Pivot", None)
    scene = bpy.context.scene
    scene.collection.objects.link(pivot)
    eye.parent = pivot
    for frame in range(1, FRAMES + 1):
        pivot.rotation_euler.z = radians(frame - 1)
        pivot.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_start, scene.frame_end, scene.frame_current = 1, FRAMES, 1
    settings(size=(640, 360))


if __name__ == "__main__":
    build()
