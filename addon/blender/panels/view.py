# SPDX-License-Identifier: GPL-3.0-or-later
"""What rendered 3D views show: below the other shading in the pop-over of their header."""

import bpy

from .. import ENGINE
from ..languages import CONTEXT


class ENCRE_PT_view(bpy.types.Panel):
    bl_label = "Encre"
    bl_idname = "ENCRE_PT_view"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_parent_id = "VIEW3D_PT_shading"
    bl_translation_context = CONTEXT

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE and context.space_data.shading.type == "RENDERED"

    def draw(self, context):
        layout, view = self.layout, context.space_data.shading.encre
        layout.row().prop(view, "source", expand=True)
        column = layout.column()
        column.active = view.source == "ENCRE"
        column.prop(view, "look")
        column.prop(view, "show", text="")
        if view.show == "CONTROL":
            column.prop(view, "control", text="")
        column.prop(context.scene.encre, "viewport_scale")


CLASSES = (ENCRE_PT_view,)
