# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines by hand: in Edit Mode faces that are a part of their own, and Blender's own marks of edges; strokes that were
drawn on surfaces."""

import itertools

import bmesh
import bpy

from .. import ENGINE, strokes
from ..languages import n_
from ..triangles import PART
from .base import SidebarPanel


def _wrong(mesh):
    """A sentence about what is wrong with the mesh, or None."""
    there = mesh.attributes.get(PART)
    if there is not None and (there.domain, there.data_type) != ("FACE", "INT"):
        return f"{mesh.name}: its attribute {PART} holds no whole numbers of faces; remove it, or edit it by hand"
    return None


def _number(mesh, clear):
    """Gives the selected faces of a mesh in Edit Mode the next free number of a part, or 0. Returns how many."""
    edited = bmesh.from_edit_mesh(mesh)
    selected = [face for face in edited.faces if face.select]
    if selected:
        layer = edited.faces.layers.int.get(PART) or edited.faces.layers.int.new(PART)
        selected = [face for face in edited.faces if face.select]  # a new layer invalidates the faces
        used = {face[layer] for face in edited.faces}
        number = 0 if clear else next(number for number in itertools.count(1) if number not in used)
        for face in selected:
            face[layer] = number
        bmesh.update_edit_mesh(mesh, loop_triangles=False, destructive=False)
    return len(selected)


class ENCRE_OT_mark_part(bpy.types.Operator):
    """Make the selected faces a part with lines around it, as if they were an object of their own"""

    bl_idname = "encre.mark_part"
    bl_label = "Mark Line Part"
    bl_options = {"REGISTER", "UNDO"}

    clear: bpy.props.BoolProperty(name="Clear", description="Let the faces belong to the rest of the mesh again")

    @classmethod
    def poll(cls, context):
        return context.mode == "EDIT_MESH"

    def execute(self, context):
        edited = [obj.data for obj in context.objects_in_mode_unique_data]
        if wrong := next(filter(None, map(_wrong, edited)), None):
            self.report({"ERROR"}, wrong)
            return {"CANCELLED"}
        if not sum(_number(mesh, self.clear) for mesh in edited):
            self.report({"WARNING"}, "No face is selected; select those of the part")
            return {"CANCELLED"}
        return {"FINISHED"}


class ENCRE_OT_strokes_to_marks(bpy.types.Operator):
    """Draw the strokes of this Grease Pencil object, or else all annotations, as lines by hand on the surfaces below"""

    bl_idname = "encre.strokes_to_marks"
    bl_label = "Strokes to Line Marks"
    bl_options = {"REGISTER", "UNDO"}

    reach: bpy.props.FloatProperty(
        name="Reach", description="How far strokes may be from the nearest surface. Strokes farther away land on the "
        "surface that is seen behind them", min=0, default=0.05, subtype="DISTANCE")
    keep: bpy.props.BoolProperty(
        name="Keep Strokes", description="Keep annotations, and keep Grease Pencil objects visible")

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and bool(_pencil(context) or strokes.annotated(context.scene))

    def execute(self, context):
        pencil, scene = _pencil(context), context.scene
        found = (strokes.of_object(pencil, scene.frame_current) if pencil
                 else strokes.of_annotations(scene, scene.frame_current))
        lines = strokes.project(found, strokes.surfaces(context), self.reach, _eye(context))
        if not lines:
            self.report({"WARNING"}, "No stroke lies on a mesh; draw with the placement Surface, or raise Reach")
            return {"CANCELLED"}
        for body, those in lines.items():
            strokes.write(body, those, context.collection)
        if pencil and not self.keep:
            pencil.hide_render = True
            pencil.hide_set(True)
        elif not self.keep:
            for layer in strokes.annotated(scene):
                for frame in list(layer.frames):
                    layer.frames.remove(frame)
        return {"FINISHED"}


def _pencil(context):
    obj = context.object
    return obj if obj and obj.type in ("GPENCIL", "GREASEPENCIL") and obj.visible_get() else None


def _eye(context):
    """A point of the world -> where the 3D view, or the scene's camera, sees it from; None without both."""
    seen = getattr(context, "region_data", None)
    if seen:
        place = seen.view_matrix.inverted()
        if seen.is_perspective:
            return lambda point: place.translation
        return lambda point: point + place.col[2].xyz.normalized() * 1000
    camera = context.scene.camera
    return camera and (lambda point: camera.matrix_world.translation)


def _row(layout, operator, text):
    row = layout.row(align=True)
    row.operator(operator, text=text).clear = False
    row.operator(operator, text="", icon="X").clear = True


class ENCRE_PT_marks(SidebarPanel, bpy.types.Panel):
    bl_label = "Encre Lines"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and ENCRE_OT_mark_part.poll(context)

    def draw(self, context):
        column = self.layout.column()
        if bpy.app.build_options.freestyle:
            _row(column, "mesh.mark_freestyle_edge", n_("Mark Edges"))
        _row(column, "encre.mark_part", n_("Mark Part"))
        column.prop(context.object.encre, "separate_parts")


class ENCRE_PT_strokes(SidebarPanel, bpy.types.Panel):
    bl_label = "Encre Lines"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and ENCRE_OT_strokes_to_marks.poll(context)

    def draw(self, context):
        self.layout.operator("encre.strokes_to_marks", icon="OUTLINER_OB_GREASEPENCIL")


def _object_menu(self, context):
    if context.engine == ENGINE and ENCRE_OT_strokes_to_marks.poll(context):
        self.layout.operator("encre.strokes_to_marks")


def _menu(self, context):
    if context.engine == ENGINE:
        self.layout.separator()
        for text, clear in ((n_("Mark Line Part"), False), (n_("Clear Line Part"), True)):
            self.layout.operator("encre.mark_part", text=text).clear = clear


_register, _unregister = bpy.utils.register_classes_factory((
    ENCRE_OT_mark_part, ENCRE_OT_strokes_to_marks, ENCRE_PT_marks, ENCRE_PT_strokes))


def register():
    _register()
    bpy.types.VIEW3D_MT_edit_mesh_faces.append(_menu)
    bpy.types.VIEW3D_MT_object.append(_object_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(_object_menu)
    bpy.types.VIEW3D_MT_edit_mesh_faces.remove(_menu)
    _unregister()
