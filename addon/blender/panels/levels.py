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
    for operator, icon in (("encre.level_add", "ADD"), ("encre.level_remove", "REMOVE"),
                           ("encre.level_ramp", "IPO_CONSTANT")):
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
            return f"Levels: there can be no more than {MAX_LEVELS}; remove one first"
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
            return "Levels: this is the last one; switch Shade and Light off instead"
        group.shade_levels.remove(group.active_level)
        return None


_WIDE, _SOFT, _APART = 1.5, 0.025, 1e-3  # light that a ramp shows; a new level's transition; between two thresholds


def fill_ramp(ramp, levels, wide):
    """Makes a color ramp the levels, of light up to `wide`: a stop where each begins, in its own tone."""
    ramp.color_mode, ramp.interpolation = "RGB", "CONSTANT"
    while len(ramp.elements) > 1:
        ramp.elements.remove(ramp.elements[-1])
    for k, (intensity, threshold, _, *color) in enumerate(levels):
        stop = ramp.elements.new(threshold / wide) if k else ramp.elements[0]
        stop.position = threshold / wide if k else 0
        stop.color = *(intensity * c for c in color or (1, 1, 1)), 1


def read_ramp(ramp, before, wide):
    """The levels of a ramp. before: its levels, of which each of the same number keeps its transition."""
    found = []
    for k, stop in enumerate(ramp.elements):
        intensity = max(stop.color[:3])
        color = tuple(c / intensity for c in stop.color[:3]) if intensity > 0 else (1, 1, 1)
        threshold = max(stop.position * wide, found[-1][1] + _APART) if k else 0.0
        soft = (before[k][2] if 0 < k < len(before) else _SOFT) if k else 0.0
        if k > 1:  # transitions must not overlap
            room = threshold - found[-1][1]
            soft = min(soft, room)
            found[-1] = (*found[-1][:2], min(found[-1][2], room), *found[-1][3:])
        found.append((intensity, threshold, soft, *color))
    return found


class ENCRE_OT_level_ramp(LevelOperator, bpy.types.Operator):
    """Draw the levels as a ramp: from dark on the left to bright light on the right, a stop where each begins"""

    bl_idname = "encre.level_ramp"
    bl_label = "Levels as a Ramp"
    held: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def _levels(self, group):
        return [(*level, 1.0, 1.0, 1.0) if len(level) == 3 else level for level in (
            (*level, 0.0, 0.0)[:3] if len(level) < 3 else tuple(level) for level in properties.levels(group))]

    def _wide(self, group):
        return max(_WIDE, 1.1 * self._levels(group)[-1][1])

    def invoke(self, context, _event):
        group = _levels_owner(context, self.path)
        holder = bpy.data.textures.new("Encre Levels", "BLEND")  # which alone has a ramp that scripts can make
        holder.use_color_ramp, self.held = True, holder.name
        fill_ramp(holder.color_ramp, self._levels(group), self._wide(group))
        return context.window_manager.invoke_props_dialog(self, width=460)

    def draw(self, _context):
        holder = bpy.data.textures.get(self.held)
        if holder:
            self.layout.template_color_ramp(holder, "color_ramp", expand=True)

    def change(self, group):
        holder = bpy.data.textures.get(self.held)
        if not holder:
            return "Levels: the ramp is gone; open it again"
        levels = read_ramp(holder.color_ramp, self._levels(group), self._wide(group))
        self.cancel(None)
        if len(levels) > MAX_LEVELS:
            return f"Levels: the ramp has {len(levels)} stops; give at most {MAX_LEVELS}"
        properties.set_value(group, "shade_levels", levels)
        return None

    def cancel(self, _context):
        holder = bpy.data.textures.get(self.held)
        if holder:
            bpy.data.textures.remove(holder)


CLASSES = (ENCRE_UL_levels, ENCRE_OT_level_add, ENCRE_OT_level_remove, ENCRE_OT_level_ramp)
