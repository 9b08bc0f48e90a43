# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of objects and materials."""

import bpy

from ...pen import library
from .base import EncrePanel


def draw_block(layout, block, scene):
    layout.use_property_split = True
    layout.prop_search(block.encre, "style", scene.encre, "styles")
    column = layout.column(align=True)
    for name in library.controls():
        column.prop(block.encre, name)


class ENCRE_PT_object(EncrePanel, bpy.types.Panel):
    bl_label = "Encre"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object is not None

    def draw(self, context):
        draw_block(self.layout, context.object, context.scene)
        self.layout.prop(context.object.encre, "line_group")
        self.layout.prop(context.object.encre, "separate_parts")


class ENCRE_PT_material(EncrePanel, bpy.types.Panel):
    bl_label = "Encre"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.material is not None

    def draw(self, context):
        draw_block(self.layout, context.material, context.scene)


CLASSES = (ENCRE_PT_object, ENCRE_PT_material)
