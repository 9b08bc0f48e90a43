# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting controls: each is a colour attribute `encre_<control>` that Vertex Paint edits, grey where neutral."""

import bpy
import numpy as np

from ...pen import colour, library
from .. import versions
from ..languages import n_
from .base import SidebarPanel


def attribute(mesh, control, create=True):
    """The mesh's colour attribute of a control; made neutral where it is missing."""
    found = mesh.color_attributes.get(control.attribute)
    if found is None and create:
        found = mesh.color_attributes.new(control.attribute, "BYTE_COLOR", "CORNER")
        grey = colour.decode_srgb(128 / 255)
        found.data.foreach_set("color", np.tile(np.float32((grey, grey, grey, 1)), len(found.data)))
    return found


def _choice():
    """The property of an operator that names a control."""
    return bpy.props.EnumProperty(name="Control", items=[
        (control.name, control.label, f"White: {control.white}. Black: {control.black}")
        for control in library.controls().values()])


class ENCRE_OT_paint(bpy.types.Operator):
    """Paint this control onto the mesh: white is most, black is least, grey leaves things as they are"""

    bl_idname = "encre.paint"
    bl_label = "Paint Control"
    bl_options = {"REGISTER", "UNDO"}

    control: _choice()

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def execute(self, context):
        obj = context.object
        if not obj.data.polygons:
            self.report({"ERROR"}, f"{obj.name}: the mesh has no faces to paint on; choose another object")
            return {"CANCELLED"}
        mode = obj.mode
        if mode == "EDIT":
            bpy.ops.object.mode_set(mode="OBJECT")
        found = attribute(obj.data, library.controls()[self.control])
        obj.data.color_attributes.active_color = found
        if mode != "VERTEX_PAINT":
            bpy.ops.object.mode_set(mode="VERTEX_PAINT")
        return {"FINISHED"}


class ENCRE_OT_paint_remove(bpy.types.Operator):
    """Remove the painted control from the mesh"""

    bl_idname = "encre.paint_remove"
    bl_label = "Remove Painted Control"
    bl_options = {"REGISTER", "UNDO"}

    control: _choice()

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH" and context.object.mode != "EDIT"

    def execute(self, context):
        control = library.controls()[self.control]
        found = attribute(context.object.data, control, create=False)
        if found is None:
            self.report({"WARNING"}, f"{control.attribute}: this mesh has no such attribute")
            return {"CANCELLED"}
        context.object.data.color_attributes.remove(found)
        return {"FINISHED"}


class ENCRE_OT_brush(bpy.types.Operator):
    """Set the brush to a value of the control: -1 least, 0 neutral, 1 most"""

    bl_idname = "encre.brush"
    bl_label = "Brush Value"
    bl_options = {"REGISTER", "UNDO"}

    value: bpy.props.FloatProperty(name="Value", min=-1, max=1, default=0)

    @classmethod
    def poll(cls, context):
        return context.mode == "PAINT_VERTEX" and context.tool_settings.vertex_paint.brush is not None

    def execute(self, context):
        encoded = (self.value + 1) / 2 if self.value else 128 / 255
        shade = colour.decode_srgb(encoded) if versions.LINEAR_BRUSH else encoded
        paint = context.tool_settings.vertex_paint
        unified = getattr(paint, "unified_paint_settings", None) or context.tool_settings.unified_paint_settings
        owner = unified if unified.use_unified_color else paint.brush
        owner.color = (shade, shade, shade)
        return {"FINISHED"}


class ENCRE_PT_paint(SidebarPanel, bpy.types.Panel):
    bl_label = "Encre Controls"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and ENCRE_OT_paint.poll(context)

    def draw(self, context):
        layout, mesh = self.layout, context.object.data
        active = mesh.color_attributes.active_color
        column = layout.column(align=True)
        for control in library.controls().values():
            row = column.row(align=True)
            there = attribute(mesh, control, create=False)
            row.operator("encre.paint", text=control.label, depress=there is not None and there == active,
                         icon="BRUSH_DATA" if there else "ADD").control = control.name
            if there:
                row.operator("encre.paint_remove", text="", icon="X").control = control.name
        row = layout.row(align=True)
        for text, value in ((n_("Least"), -1.0), (n_("Neutral"), 0.0), (n_("Most"), 1.0)):
            row.operator("encre.brush", text=text).value = value


register, unregister = bpy.utils.register_classes_factory(
    (ENCRE_OT_paint, ENCRE_OT_paint_remove, ENCRE_OT_brush, ENCRE_PT_paint))
