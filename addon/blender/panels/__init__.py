# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and their operators, a file for each group of panels."""

import bpy

from . import blocks, cycles, levels, marks, paint, scene, stages, styles

_registered = []


def register():
    for cls in (*levels.CLASSES, *scene.CLASSES, *stages.classes(), *styles.CLASSES, *blocks.CLASSES):
        bpy.utils.register_class(cls)
        _registered.append(cls)
    for module in (cycles, paint, marks):
        module.register()


def unregister():
    for module in (marks, paint, cycles):
        module.unregister()
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
