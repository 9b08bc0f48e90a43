# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns that stick to surfaces, kept where they are: the rest position as an attribute."""

import bpy
import numpy as np

from ..attributes import get
from ..triangles import ANCHOR
from .base import SidebarPanel


def _rest(mesh):
    """Positions of a mesh's points without modifiers and shape keys, (n, 3)."""
    keys = mesh.shape_keys
    return get(keys.reference_key.data if keys else mesh.vertices, "co", np.float32, 3)


def _wrong(mesh):
    """A sentence about what is wrong with the mesh, or None."""
    if mesh.library:
        return f"{mesh.name}: is linked from another file; pin its pattern there"
    there = mesh.attributes.get(ANCHOR)
    if there is not None and (there.domain, there.data_type) != ("POINT", "FLOAT_VECTOR"):
        return f"{mesh.name}: its attribute {ANCHOR} holds no vectors of points; remove it, or edit it by hand"
    return None


class ENCRE_OT_pin_pattern(bpy.types.Operator):
    """Remember the mesh at rest: dots and hatching stick to it however it bends, in the 3D view, too"""

    bl_idname = "encre.pin_pattern"
    bl_label = "Pin Pattern"
    bl_options = {"REGISTER", "UNDO"}

    clear: bpy.props.BoolProperty(
        name="Clear", description="Forget that again: dots and hatching stick to the mesh as it is")

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and any(obj.type == "MESH" for obj in context.selected_objects)

    def execute(self, context):
        meshes = {obj.data for obj in context.selected_objects if obj.type == "MESH"}
        if wrong := next(filter(None, map(_wrong, meshes)), None):
            self.report({"ERROR"}, wrong)
            return {"CANCELLED"}
        for mesh in meshes:
            there = mesh.attributes.get(ANCHOR)
            if self.clear:
                if there is not None:
                    mesh.attributes.remove(there)
            else:
                there = there or mesh.attributes.new(ANCHOR, "FLOAT_VECTOR", "POINT")
                there.data.foreach_set("vector", _rest(mesh).reshape(-1))
            mesh.update_tag()
        return {"FINISHED"}


class ENCRE_PT_pin(SidebarPanel, bpy.types.Panel):
    bl_label = "Encre Pattern"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and ENCRE_OT_pin_pattern.poll(context)

    def draw(self, context):
        row = self.layout.row(align=True)
        row.operator("encre.pin_pattern", icon="PINNED")
        mesh = context.object.data if context.object and context.object.type == "MESH" else None
        if mesh and mesh.attributes.get(ANCHOR):
            row.operator("encre.pin_pattern", text="", icon="X").clear = True


register, unregister = bpy.utils.register_classes_factory((ENCRE_OT_pin_pattern, ENCRE_PT_pin))
