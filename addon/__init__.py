# SPDX-License-Identifier: GPL-3.0-or-later
"""Encre, a comic-book render engine. Blender's modules are imported only where Blender calls."""

import sys

bl_info = {
    "name": "Encre",
    "description": "Comic-book rendering: inked lines, flat tinted light, smudged colour, pencil hatching",
    "blender": (3, 4, 0),
    "location": "Render properties > Render Engine",
    "category": "Render",
}


_registered = []


def _modules():
    """What registers with Blender, in this order."""
    from .blender import engine
    from .pen import library
    from .pen.errors import EncreError

    try:
        library.load()
    except EncreError as error:
        print(f"encre: {error}", file=sys.stderr)
        return (engine,)  # it says so to whoever renders
    from .blender import bake, escape, migration, panels, properties, subframes

    return properties, migration, engine, escape, subframes, panels, bake


def register():
    for module in _modules():
        module.register()
        _registered.append(module)


def unregister():
    while _registered:
        _registered.pop().unregister()
