# SPDX-License-Identifier: GPL-3.0-or-later
"""Encre, a comic-book render engine. Blender's modules are imported only where Blender calls."""

bl_info = {
    "name": "Encre",
    "description": "Comic-book rendering: inked lines, flat tinted light, smudged colour, pencil hatching",
    "blender": (3, 4, 0),
    "location": "Render properties > Render Engine",
    "category": "Render",
}


def _modules():
    """What registers with Blender, in this order."""
    from . import engine, paint, properties, ui

    return properties, engine, ui, paint


def register():
    for module in _modules():
        module.register()


def unregister():
    for module in reversed(_modules()):
        module.unregister()
