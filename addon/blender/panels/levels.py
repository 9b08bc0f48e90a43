# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of light levels, with a strip of the tones they give."""

import bpy

from ...pen import library
from ...pen.params import MAX_LEVELS
from .. import properties


def draw_levels(layout, group, path):
    """The list of light levels and a strip of the tones they give; `path` leads from the scene to the group."""
    column = layout.column()
    column.use_property_split = False
    column.label(text=library.params()["shade_levels"].label)
    strip = column.row(align=True)
    if group.shade_levels:
        rest = strip
        ends = [level.threshold for level in group.shade_levels[1:]] + [group.shade_levels[-1].threshold + 0.3]
        start = 0.0
        for level, end in zip(group.shade_levels, ends, strict=True):
            share = (end - start) / max(ends[-1] - start, 1e-6)
            last = level == group.shade_levels[-1]
            part = rest if last else rest.split(factor=min(max(share, 0.05), 1.0), align=True)
            part.prop(level, "tone", text="")
            rest, start = part, end
    else:
        strip.label(text="The default levels", icon="INFO")
    row = column.row()
    row.template_list("ENCRE_UL_levels", "", group, "shade_levels", group, "active_level", rows=3)
    buttons = row.column(align=True)
    for operator, icon in (("encre.level_add", "ADD"), ("encre.level_remove", "REMOVE")):
        buttons.operator(operator, text="", icon=icon).path = path


class ENCRE_UL_levels(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active, index=0, _flag=0):
        row = layout.row(align=True)
        row.prop(item, "intensity", text="", emboss=False)
        if index:
            row.prop(item, "threshold", text="", emboss=False)
            row.prop(item, "transition", text="", emboss=False)
        row.prop(item, "color", text="")


def _levels_owner(context, path):
    scene = context.scene.encre
    return scene.styles[scene.active_style] if path == "style" else scene


class LevelOperator:
    bl_options = {"UNDO", "INTERNAL"}
    path: bpy.props.StringProperty(options={"HIDDEN"})

    def execute(self, context):
        group = _levels_owner(context, self.path)
        if not group.shade_levels:
            properties.set_value(group, "shade_levels", library.params()["shade_levels"].default)
        sentence = self.change(group)
        if sentence:
            self.report({"ERROR"}, sentence)
            return {"CANCELLED"}
        group.active_level = min(group.active_level, len(group.shade_levels) - 1)
        return {"FINISHED"}


class ENCRE_OT_level_add(LevelOperator, bpy.types.Operator):
    """Add a level above the brightest one"""

    bl_idname = "encre.level_add"
    bl_label = "Add Level"

    def change(self, group):
        if len(group.shade_levels) >= MAX_LEVELS:
            return f"shade_levels: there are {MAX_LEVELS} levels, the most there can be; remove one first"
        last = group.shade_levels[-1]
        threshold = last.threshold + max(0.2, 2 * last.transition)
        intensity = last.intensity + 0.2
        new = group.shade_levels.add()
        new.threshold, new.intensity = threshold, intensity
        group.active_level = len(group.shade_levels) - 1
        return None


class ENCRE_OT_level_remove(LevelOperator, bpy.types.Operator):
    """Remove the chosen level"""

    bl_idname = "encre.level_remove"
    bl_label = "Remove Level"

    def change(self, group):
        if len(group.shade_levels) == 1:
            return "shade_levels: this is the last level; switch Shading off instead"
        group.shade_levels.remove(group.active_level)
        return None


CLASSES = (ENCRE_UL_levels, ENCRE_OT_level_add, ENCRE_OT_level_remove)
