# SPDX-License-Identifier: GPL-3.0-or-later
"""Files keep their look: what an older version did where the user had chosen nothing.

Blender stores only values that were touched, so a default that changes would change old files. Each scene carries the
version of its settings, written when it is saved; when a file is opened, values that an older version had as defaults
are set where nothing is. Ids are for ever. To change a default: add a version and what it was before.
"""

import bpy
from bpy.app.handlers import persistent

from . import ENGINE, properties

# version: {id: the default before it}
BEFORE = {1: {"crease_source": "LAYERS"}, 2: {"line_depth_unit": "SCENE", "crease_angle": 20.0}}
PASSES = 2  # up to this version every view layer had all passes
VERSION = max(BEFORE)


def migrate(scene):
    """Gives a scene from a file the defaults that its settings had when it was saved."""
    settings = scene.encre
    if scene.render.engine == ENGINE or settings.keys():  # else nobody has looked at them yet
        for version in range(settings.version + 1, VERSION + 1):
            for id_, value in BEFORE[version].items():
                if not settings.is_property_set(id_):
                    setattr(settings, id_, value)
        if settings.version < PASSES:
            for layer in scene.view_layers:
                for switch in properties.PASSES:
                    setattr(layer.encre, switch, True)
    settings.version = VERSION


@persistent
def _opened(path, *_):
    if bpy.data.filepath:  # not the startup file, which is as new as the program
        for scene in bpy.data.scenes:
            migrate(scene)


@persistent
def _saving(*_):
    for scene in bpy.data.scenes:
        if not scene.library:
            scene.encre.version = VERSION


_HANDLERS = (("load_post", _opened), ("save_pre", _saving))


def register():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
