# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of objects and materials."""

from itertools import groupby

import bpy

from .. import properties
from .base import EncrePanel
from .styles import draw_style


def draw_block(layout, block, owner, scene):
    layout.use_property_split = True
    shape = getattr(block, "empty_display_type", "") if getattr(block, "type", "") == "EMPTY" else ""
    settings = [own for own in properties.own_settings(owner) if own.of == shape or not own.of]
    for kind, rows in groupby(settings, lambda own: own.kind):
        column = layout.column(align=True)
        if kind == "control":
            column.label(text="Offsets")
        for own in rows:
            if kind == "style":
                column.label(text=own.label)
                row = column.row(align=True)
                row.prop_search(block.encre, own.id, scene.encre, "styles", text="")
                row.operator("encre.style_add", text="", icon="ADD").to = owner
                if style := scene.encre.styles.get(block.encre.style):
                    draw_style(layout.box(), scene.encre, style)
            else:
                # Beside a number there is room for a dozen letters, at the width that Blender begins with.
                column.use_property_split = kind == "text"
                column.prop(block.encre, own.id)
        if kind == "share" and scene.encre.light_source != "DRAWN" and scene.encre.layer_source != "ENCRE":
            column.label(text="Bends drawn light: set Light to Drawn", icon="INFO")


class _BlockPanel(EncrePanel):
    bl_label = "Encre"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and getattr(context, cls.bl_context) is not None

    def draw(self, context):
        draw_block(self.layout, getattr(context, self.bl_context), self.bl_context, context.scene)


class ENCRE_PT_object(_BlockPanel, bpy.types.Panel):
    bl_context = "object"


class ENCRE_PT_material(_BlockPanel, bpy.types.Panel):
    bl_context = "material"


CLASSES = (ENCRE_PT_object, ENCRE_PT_material)
