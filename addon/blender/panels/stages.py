# SPDX-License-Identifier: GPL-3.0-or-later
"""One panel per stage, drawn from the parameter table; rows of pens and tones are in lists (lists.py)."""

import functools

import bpy

from ...pen import library, slots
from ..languages import n_
from . import lists, meter
from .base import EncrePanel
from .rows import draw_params

# Stages that have a list, and the panel below it of the rows that are no slot's.
_LISTS = {"pen": (lists.draw_pens, n_("Ink by Light")), "tones": (lists.draw_tones, n_("All Tones"))}


def _panel(id_, parent, label, help_, draw, more=None):
    members = {"bl_label": label, "bl_idname": f"ENCRE_PT_{id_}", "bl_options": {"DEFAULT_CLOSED"},
               "bl_parent_id": f"ENCRE_PT_{parent}", "draw": draw, "__doc__": help_, **(more or {})}
    return type(f"ENCRE_PT_{id_}", (EncrePanel, bpy.types.Panel), members)


def _stage_panels(stage):
    """The panel classes of one stage; the stage's switch is the panel's check box."""
    switch = stage.switch
    rest = tuple(p for p in stage.params if p is not switch and not slots.of(p.id))

    def draw_rest(self, context):
        draw_params(self.layout, context.scene.encre, rest, "scene")
        if stage.id == "rim":
            self.layout.prop(context.scene.encre, "rim_lamp")
        if stage.id == "shade":
            meter.draw(self.layout, context.scene)

    def draw_list(self, context):
        _LISTS[stage.id][0](self.layout, context.scene.encre)

    def draw_header(self, context):
        self.layout.prop(context.scene.encre, switch.id, text="")

    header = {"draw_header": draw_header} if switch else {}
    if stage.id not in _LISTS:
        return [_panel(stage.id, "encre", stage.label, stage.help, draw_rest, header)] if rest else []
    return [_panel(stage.id, "encre", stage.label, stage.help, draw_list, header),
            _panel(f"{stage.id}_rest", stage.id, _LISTS[stage.id][1], stage.help, draw_rest)]


@functools.cache
def classes():
    """The panel classes of all stages, in the order in which they are shown."""
    return [panel for stage in library.stages() for panel in _stage_panels(stage)]
