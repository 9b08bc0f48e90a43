# SPDX-License-Identifier: GPL-3.0-or-later
"""One panel per stage, drawn from the parameter table."""

import functools

import bpy

from ...pen import library
from ...pen.params import TONES, terms
from . import presets, settings
from .base import EncrePanel
from .levels import draw_levels


def enabled(group, rule):
    """Whether a parameter's `enabled_if` holds for the values of a group; parameters that it lacks count as on."""
    return all(terms(rule, lambda id_: getattr(group, id_, True)).values())


def _empty(group, id_):
    """Whether a setting is of what is not there: a level's tone that there is no level for, or how one looks that is
    none or the same as before."""
    levels = len(group.shade_levels) or len(library.params()["shade_levels"].default)
    return any((id_ == tone and n > levels) or (
        id_.startswith(f"{tone}_") and (n > levels or getattr(group, tone, "") in ("NONE", "SAME")))
        for n, tone in enumerate(TONES, 1))


def draw_params(layout, group, params, path):
    layout.use_property_split = True
    layout.use_property_decorate = path != "style"
    preset = presets.current(group.id_data)
    for p in params:
        if path == "scene" and _empty(group, p.id):
            continue
        line = layout.row(align=True)
        row = line.column()
        row.active = enabled(group, p.enabled_if)
        if p.type == "levels":
            draw_levels(row, group, path)
        elif p.type == "image":
            row.template_ID(group, p.id, open="image.open", text=p.label)
        else:
            row.prop(group, p.id)
        if path == "scene":
            settings.draw_reset(line, group, p, preset)


def stage_panel(stage):
    """The panel class of one stage; the stage's switch is the panel's check box."""
    switch = stage.switch
    rest = tuple(p for p in stage.params if p is not switch)
    first = stage.id.rpartition("_")[0]  # pen_2 is one more pen, and lies in the panel of the first
    parent = first if any(first == other.id for other in library.stages()) else "encre"

    def draw(self, context):
        draw_params(self.layout, context.scene.encre, rest, "scene")
        if stage.id == "rim":
            self.layout.prop(context.scene.encre, "rim_lamp")

    def draw_header(self, context):
        self.layout.prop(context.scene.encre, switch.id, text="")

    members = {"bl_label": stage.label, "bl_idname": f"ENCRE_PT_{stage.id}", "bl_options": {"DEFAULT_CLOSED"},
               "bl_parent_id": f"ENCRE_PT_{parent}", "draw": draw, "__doc__": stage.help}
    if switch:
        members["draw_header"] = draw_header
    return type(f"ENCRE_PT_{stage.id}", (EncrePanel, bpy.types.Panel), members)


@functools.cache
def classes():
    """A panel class for each stage, in the order in which they are shown."""
    return [stage_panel(stage) for stage in library.stages()]
