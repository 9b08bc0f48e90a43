# SPDX-License-Identifier: GPL-3.0-or-later
"""Who chooses Encre in a window for a scene begins with a look whose pictures take seconds.

The table's defaults are a thesis's, whose light Cycles takes minutes for, and files and scripts count on them; so a
scene whose settings somebody has touched keeps what it has. What a file says of its version is no touch: opening and
saving write it into every scene.
"""

import bpy
from bpy.app.handlers import persistent

from ..pen import presets
from . import ENGINE, handlers, looks

_LOOK = "cel"
_owner = object()


def _chosen():
    for window in bpy.context.window_manager.windows:
        scene = window.scene
        if scene.render.engine == ENGINE and scene.library is None and set(scene.encre.keys()) <= {"version"}:
            looks.apply(scene.encre, presets.find(_LOOK))


@persistent
def _listen(*_):
    """Again for each file: Blender forgets who listens when it opens one."""
    bpy.msgbus.clear_by_owner(_owner)
    bpy.msgbus.subscribe_rna(key=(bpy.types.RenderSettings, "engine"), owner=_owner, args=(), notify=_chosen)


_hear, _hear_no_more = handlers.pair(("load_post", _listen))


def register():
    _hear()
    _listen()


def unregister():
    _hear_no_more()
    bpy.msgbus.clear_by_owner(_owner)
