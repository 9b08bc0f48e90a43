# SPDX-License-Identifier: GPL-3.0-or-later
"""Encre, a comic-book render engine. Blender's modules are imported only where Blender calls."""

import os
import sys

bl_info = {
    "name": "Encre",
    "description": "Comic-book rendering: inked lines, flat tinted light, smudged color, pencil hatching",
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
    from .blender import (
        bake,
        chosen,
        escape,
        grease,
        migration,
        opened,
        panels,
        properties,
        redraw,
        study,
        subframes,
        threads,
    )

    return (threads, properties, migration, engine, chosen, escape, redraw, opened, subframes, panels, bake, grease,
            study)


def _elsewhere():
    """The folder of another Encre that is registered; None: there is none. Two would take each other's classes away."""
    import bpy

    engine = bpy.types.RenderEngine.bl_rna_get_subclass_py("ENCRE")
    name = engine.__module__.removesuffix(".engine").removesuffix(".blender") if engine else __name__
    return None if name == __name__ else os.path.dirname(getattr(sys.modules.get(name), "__file__", name))


def register():
    from .pen.errors import EncreError

    if _registered:  # by `encre render`, whose scene enables it
        return
    if folder := _elsewhere():
        raise EncreError(f"Encre is enabled already, from {folder}: disable that one in Preferences, Add-ons, then "
                         f"enable this, {os.path.dirname(__file__)}")
    for module in _modules():
        module.register()
        _registered.append(module)


def unregister():
    while _registered:
        _registered.pop().unregister()
