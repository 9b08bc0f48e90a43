# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's own panel, with presets and the offer of a view transform."""

import bpy

from ...pen.settings import crowded, pixels_wide
from .. import memory, properties
from ..languages import iface_
from . import presets
from .base import EncrePanel


class ENCRE_OT_standard_view(bpy.types.Operator):
    """Show colours as they are: other view transforms wash ink and flat colours out"""

    bl_idname = "encre.standard_view"
    bl_label = "Use Standard View Transform"
    bl_options = {"UNDO"}

    def execute(self, context):
        context.scene.view_settings.view_transform = "Standard"
        return {"FINISHED"}


def blots(scene):
    """That lines in pixels are too wide for the frame, in a few words; None: they are not."""
    width = pixels_wide(properties.scene_values(scene))
    if crowded(width, scene.render.resolution_y * scene.render.resolution_percentage // 100):
        return iface_("Lines of {} px run together").format(f"{width:g}")
    return None


class ENCRE_PT_encre(EncrePanel, bpy.types.Panel):
    bl_label = "Encre"
    bl_idname = "ENCRE_PT_encre"
    # Blender puts panels without a header above all others: under the engine's own row, not below Cycles' panels. An
    # order below 0 counts as 0.
    bl_options = {"HIDE_HEADER"}

    def draw(self, context):
        layout = self.layout
        transform = context.scene.view_settings.view_transform
        if transform != "Standard":
            box = layout.box()
            box.label(text=iface_("{} washes out ink").format(iface_(transform)), icon="INFO", translate=False)
            box.operator("encre.standard_view")
        row, preset = layout.row(align=True), presets.current(context.scene)
        if preset:
            row.popover("ENCRE_PT_presets", text=preset.name, translate=False, icon="PRESET")
        else:
            row.popover("ENCRE_PT_presets", icon="PRESET")
        row.menu("ENCRE_MT_scene_settings", text="", icon="DOWNARROW_HLT")
        if words := blots(context.scene):
            layout.label(text=words, icon="INFO", translate=False)
        layout.prop(context.scene.encre, "ink_early")
        row = layout.row(align=True)
        row.prop(context.scene.encre, "keep_layers")
        if held := memory.size(context.scene):
            row.label(text=f"{held / 1e6:.0f} MB", translate=False)
            row.prop(context.scene.encre, "auto_redraw", text="", icon="AUTO")
            row.operator("encre.redraw", text="", icon="FILE_REFRESH")
        row.operator("encre.open_layers", text="", icon="FILE_FOLDER")


CLASSES = (ENCRE_OT_standard_view, ENCRE_PT_encre)
