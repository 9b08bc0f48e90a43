# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender calls at certain times, while the add-on is enabled."""

import bpy


def pair(*told):
    """(register, unregister) of (name in bpy.app.handlers, function)."""
    def register():
        for name, handler in told:
            getattr(bpy.app.handlers, name).append(handler)

    def unregister():
        for name, handler in told:
            getattr(bpy.app.handlers, name).remove(handler)

    return register, unregister
