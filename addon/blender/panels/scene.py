# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's own panel, with presets and the offer of a view transform."""

import bpy

from ...pen import library, presets
from ...pen.errors import EncreError
from .. import properties
from .base import EncrePanel


class ENCRE_OT_preset(bpy.types.Operator):
    bl_idname = "encre.preset"
    bl_label = "Apply Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.StringProperty(name="Preset", options={"HIDDEN"})

    @classmethod
    def description(cls, _context, properties_):
        preset = presets.find(properties_.preset)
        labels = [library.params()[id_].label for id_ in preset.values]
        return f"{preset.description}. Sets {', '.join(labels)}; leaves all other settings as they are"

    def execute(self, context):
        try:
            preset = presets.find(self.preset)
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for id_, value in preset.values.items():
            properties.set_value(context.scene.encre, id_, value)
        return {"FINISHED"}


class ENCRE_MT_presets(bpy.types.Menu):
    bl_idname = "ENCRE_MT_presets"
    bl_label = "Presets"

    def draw(self, _context):
        for preset in presets.presets():
            self.layout.operator("encre.preset", text=preset.name).preset = preset.id


class ENCRE_OT_standard_view(bpy.types.Operator):
    """Show colours as they are: other view transforms wash ink and flat colours out"""

    bl_idname = "encre.standard_view"
    bl_label = "Use Standard View Transform"
    bl_options = {"UNDO"}

    def execute(self, context):
        context.scene.view_settings.view_transform = "Standard"
        return {"FINISHED"}


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
            box.label(text=f"{transform} washes out ink", icon="INFO")
            box.operator("encre.standard_view")
        layout.menu("ENCRE_MT_presets")


CLASSES = (ENCRE_OT_preset, ENCRE_MT_presets, ENCRE_OT_standard_view, ENCRE_PT_encre)
