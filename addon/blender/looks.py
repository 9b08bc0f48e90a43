# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks: by which settings one scene is drawn, of which several views may show different ones; presets as a scene has
them, Encre's own and the user's."""

import zlib
from pathlib import Path

from ..pen import library, presets, settings
from ..pen.errors import EncreError
from . import pens, properties, versions
from .languages import CONTEXT, iface_

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


def folder():
    """Where the user's presets are."""
    return Path(versions.user_folder(__package__)) / "presets"


def every():
    """(all presets, sentences about the user's files that can't be used)"""
    mine, wrong = presets.users(folder())
    return (*presets.presets(), *mine), wrong


def current(scene):
    """The preset that the scene had last; None: none, or it is gone."""
    try:
        return presets.find(scene.encre.preset, folder()) if scene.encre.preset else None
    except EncreError:
        return None


def apply(group, preset):
    """Sets all that a preset says; `group` are a scene's settings."""
    for id_, value in preset.values.items():
        if not properties.has(group, library.params()[id_], value):
            properties.set_value(group, id_, value)
    pens.rename_all(group, {pen: iface_(name, CONTEXT) if preset.own and name else name
                            for pen, name in preset.pens.items()})
    group.preset = preset.id
