# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc in a window: what Cycles has rendered so far is drawn, unless Esc is pressed once more.

Cycles leaves its samples in all passes when it is stopped, and Blender shows what is written there afterwards. Its own
flag of the break stays set, so a second Esc is heard by an operator in each window.
"""

import bpy

from . import threads
from .listener import Listener

_hearing = None  # the Esc that is under way


class Esc:
    """While a picture is drawn after a break."""

    def __init__(self):
        self.again = False  # whether it was pressed once more

    def __enter__(self):
        global _hearing
        _hearing = self
        bpy.app.timers.register(self._listen)  # operators begin on the main thread
        return self

    def __exit__(self, *_):
        global _hearing
        _hearing = None
        if bpy.app.timers.is_registered(self._listen):
            bpy.app.timers.unregister(self._listen)

    def _listen(self):
        threads.may_write(_hear)


def _hear():
    for window in bpy.context.window_manager.windows:
        with threads.in_window(window):
            bpy.ops.encre.give_up("INVOKE_DEFAULT")


class ENCRE_OT_give_up(Listener, bpy.types.Operator):
    """Leave the picture as it was rendered"""

    bl_idname = "encre.give_up"
    bl_label = "Give Up Drawing"
    bl_options = {"INTERNAL"}

    def hears(self, _context, event):
        if _hearing and event.type == "ESC" and event.value == "PRESS" and not event.is_repeat:
            _hearing.again = True
        return False

    def over(self):
        return not _hearing or _hearing.again


def register():
    bpy.utils.register_class(ENCRE_OT_give_up)


def unregister():
    bpy.utils.unregister_class(ENCRE_OT_give_up)
