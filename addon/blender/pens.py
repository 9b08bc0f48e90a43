# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists call their pens. A name is the scene's, beside the settings: nothing that is drawn depends on it."""

import itertools

import bpy

from ..pen import slots
from .languages import CONTEXT, OURS, iface_


def _own(pen):
    """What a pen is called as long as nobody has named it."""
    return iface_(pen.label, CONTEXT)


def names(settings):
    """{pen: its name} of the pens that have one; `settings` are a scene's."""
    return {pen.id: name for pen in slots.pens() if (name := getattr(settings, f"{pen.id}_name"))}


def name(settings, pen):
    """What a pen is called in a scene."""
    return getattr(settings, f"{pen.id}_name") or _own(pen)


def rename(settings, pen, new):
    """Calls a pen so; by an empty name, or its own, as nobody had named it. A name that another pen has gets a number,
    as Blender's data have."""
    rename_all(settings, {pen.id: new})


def rename_all(settings, new):
    """Likewise for {pen: name}; what these pens were called before is free."""
    taken = {name(settings, pen) for pen in slots.pens() if pen.id not in new}
    for id_, called in new.items():
        own = _own(slots.find(id_))
        called = free(called.strip()[:slots.LONGEST_NAME].rstrip() or own, taken)
        taken.add(called)
        setattr(settings, f"{id_}_name", "" if called == own else called)


def free(called, taken):
    """The name, or, as Blender's data have, one with a number that is not taken."""
    if called not in taken:
        return called
    stem, _, digits = called.rpartition(".")
    stem = stem if stem and digits.isdecimal() else called
    numbered = (f"{stem[:slots.LONGEST_NAME - 4]}.{k:03}" for k in itertools.count(1))
    return next(text for text in numbered if text not in taken)


def definitions(update):
    """{id: bpy.props definition} of what a scene has of pens' names: as they are kept, and as they are shown."""
    found = {}
    for pen in slots.pens():
        found[f"{pen.id}_name"] = bpy.props.StringProperty(options={"HIDDEN"}, update=update)
        found[f"{pen.id}_called"] = _shown(pen)
    return found


def _shown(pen):
    def read(settings):
        return name(settings, pen)

    def write(settings, new):
        rename(settings, pen, new)

    return bpy.props.StringProperty(name="Name", description="What this pen is called in the table of kinds of line",
                                    get=read, set=write, **OURS)


def items(p):
    """What gives the items of a kind of line's pen their names."""
    kept = {}  # Blender wants the texts that it shows to be kept

    def called(self, _context):
        settings = self.id_data.encre  # a style's pens are its scene's
        now = tuple(name(settings, pen) for pen in slots.pens())
        if now not in kept:
            kept[now] = [(x.id, text, x.help, x.number) for x, text in zip(p.items, now, strict=True)]
        return kept[now]

    return called
