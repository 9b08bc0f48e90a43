# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks: by which settings one scene is drawn, of which several views may show different ones."""

import zlib

from ..pen import library, presets, settings
from . import properties, versions

SCENE, PLAIN = "SCENE", "PLAIN"


def own(scene, look, thickness=1.0, without=()):
    """The Settings by which a look draws a scene: SCENE, its own; PLAIN, with nothing drawn; else a preset by its name
    or file, as if it were applied. thickness: a factor of all lines' width; without: ids that are 0 everywhere.
    EncreError: there is no such preset, or the settings can't be used."""
    values, styles = properties.scene_values(scene), properties.styles(scene)
    if look == PLAIN:
        without = settings.switches()
    elif look != SCENE:
        values |= presets.find(look).values
    rows = library.params()
    for group in (values, *(changed for _, changed in styles)):
        group.update({id_: 0 for id_ in without if id_ in group})
        if thickness != 1 and "line_thickness" in group:
            group["line_thickness"] = min(thickness * group["line_thickness"], rows["line_thickness"].hard_max)
    return settings.Settings(values, styles, versions.working_space())


def named():
    """Encre's presets as items of an enum; their numbers, which files keep, are the same whichever others there are."""
    return [(preset.id, preset.name, preset.description, "NONE", zlib.crc32(preset.id.encode()) >> 1)
            for preset in presets.presets()]
