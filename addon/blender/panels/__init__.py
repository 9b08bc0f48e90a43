# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and their operators, a file for each group of panels.

In: the properties of scene, object and material (properties.py), the library's table of parameters and its stages. Out:
what Blender's user sees in the properties editor, the sidebar and the menus. A panel computes nothing.

front is what an artist turns first; stages has the closed panels below it, where each row of the table has a place,
with rows, which grays them out by enabled_if; so a new parameter needs nothing here. kinds is the table of kinds of
line, lists shows pens and tones, layers what stays in memory, styles, blocks (objects, materials) and passes have the
rest of the properties, presets and settings what is done with many at once, paint, marks and pin the tools of the
sidebar and of Edit Mode, levels the list of light levels, meter how bright full light is, papers how
pencil lies on a sheet, view what the 3D view shows,
cycles Cycles' own panels, shown for Encre too.

To add: a panel to the file of its group, after base.EncrePanel and in its CLASSES; a group as a file, named below.
"""

import bpy

from .. import languages, thumbnails
from . import (
    blocks,
    cycles,
    front,
    levels,
    lists,
    marks,
    meter,
    paint,
    passes,
    pin,
    presets,
    settings,
    stages,
    styles,
    view,
)

_registered = []


def register():
    for cls in (*levels.CLASSES, *lists.CLASSES, *meter.CLASSES, *presets.CLASSES, *settings.CLASSES, *front.CLASSES,
                *stages.classes(), *styles.CLASSES, *blocks.CLASSES, *passes.CLASSES, *view.CLASSES):
        bpy.utils.register_class(cls)
        _registered.append(cls)
    for module in (languages, thumbnails, cycles, paint, marks, pin):
        module.register()


def unregister():
    for module in (pin, marks, paint, cycles, thumbnails, languages):
        module.unregister()
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
