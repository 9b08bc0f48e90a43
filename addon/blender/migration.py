# SPDX-License-Identifier: GPL-3.0-or-later
"""Files keep their look: what an older version did where the user had chosen nothing.

Blender stores only values that were touched, so a default that changes would change old files. Each scene carries the
version of its settings, written when it is saved; when a file is opened, values that an older version had as defaults
(pen/settings.py) are set where nothing is.
"""

import bpy
from bpy.app.handlers import persistent

from ..pen.settings import VERSION, since
from . import ENGINE, handlers, properties

PASSES = 2   # up to this version every view layer had all passes
SAMPLES = 3  # up to this version Cycles' own number of samples was the only one


def migrate(scene):
    """Gives a scene from a file the defaults that its settings had when it was saved."""
    settings = scene.encre
    if scene.render.engine == ENGINE or settings.keys():  # else nobody has looked at them yet
        for id_, value in since(settings.version).items():
            if not settings.is_property_set(id_):
                setattr(settings, id_, value)
        if settings.version <= SAMPLES and not settings.is_property_set("samples"):
            settings.samples = 0
        if settings.version < PASSES:
            for layer in scene.view_layers:
                for switch in properties.PASSES:
                    setattr(layer.encre, switch, True)
    for style in settings.styles:
        style.called = style.called or style.name
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
    # Blender 5 stores an override of settings only setting by setting where the linked original has any; reading one
    # gives it them, and the override of all, which can't be read again, is not stored.
    for block in (*bpy.data.objects, *bpy.data.materials):
        if block.override_library and block.override_library.reference:
            _ = block.override_library.reference.encre.style


register, unregister = handlers.pair(("load_post", _opened), ("save_pre", _saving))
