# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting controls on meshes with Vertex Paint: a row a control."""

import bpy

from ...pen import library
from ...pen.errors import EncreError
from .. import ENGINE, control_nodes, painting
from ..languages import n_
from .base import SidebarPanel


def _choice():
    """The property of an operator that names a control."""
    return bpy.props.EnumProperty(name="Control", items=[
        (control.name, control.label, f"White: {control.white}. Black: {control.black}")
        for control in library.controls().values()])


def _objects(context):
    """The meshes' objects that are meant, one for each mesh: those in Edit Mode, the one in Vertex Paint, or the active
    one and the selected ones."""
    if context.mode == "EDIT_MESH":
        return list(context.objects_in_mode_unique_data)
    found = {}
    for obj in (context.object, *(context.selected_objects if context.mode == "OBJECT" else ())):
        if obj and obj.type == "MESH":
            found.setdefault(obj.data.name_full, obj)
    return list(found.values())


def painted(context):
    """The control that is being painted, None: none is."""
    if context.mode != "PAINT_VERTEX":
        return None
    active = context.object.data.color_attributes.active_color
    return next((c for c in library.controls().values() if active and active.name == c.attribute), None)


class _PaintOperator:
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    @property
    def chosen(self):
        return library.controls()[self.control]

    def execute(self, context):
        """Works outside of Edit Mode, as its meshes' attributes can't be written there, and goes back to it."""
        mode, objects = context.mode, _objects(context)
        if mode == "EDIT_MESH":
            bpy.ops.object.mode_set(mode="OBJECT")
        try:
            return self.work(context, mode, objects)
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            if mode == "EDIT_MESH" and context.mode == "OBJECT":
                bpy.ops.object.mode_set(mode="EDIT")


class ENCRE_OT_paint(_PaintOperator, bpy.types.Operator):
    """Paint this control: white is most, black least, gray leaves things as they are. Press again to stop"""

    bl_idname = "encre.paint"
    bl_label = "Paint Control"

    control: _choice()

    def work(self, context, mode, objects):
        if painted(context) == self.chosen:
            bpy.ops.object.mode_set(mode="OBJECT")
            return {"FINISHED"}
        for obj in objects:  # before one is made, as what is refused can't be undone
            painting.check(obj.data, self.chosen)
        for obj in objects:
            obj.data.color_attributes.active_color = painting.new(obj.data, self.chosen)
        if mode != "PAINT_VERTEX":
            bpy.ops.object.mode_set(mode="VERTEX_PAINT")
        if painting.brush_kind() is None:
            painting.set_brush("ADD", painting.STRENGTH)
        return {"FINISHED"}


class ENCRE_OT_control_fill(_PaintOperator, bpy.types.Operator):
    """Fill with one value: the whole mesh, in Edit Mode what is selected, in Vertex Paint what the mask lets through"""

    bl_idname = "encre.control_fill"
    bl_label = "Fill Control"

    control: _choice()
    value: bpy.props.FloatProperty(name="Value", description="-1 is least, 0 leaves things as they are, 1 is most",
                                   min=-1, max=1, default=1, subtype="FACTOR")

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def work(self, _context, mode, objects):
        if not sum(painting.fill(obj, self.chosen, self.value, mode == "EDIT_MESH") for obj in objects):
            self.report({"WARNING"}, "Nothing is selected; select what to fill")
            return {"CANCELLED"}
        return {"FINISHED"}


class ENCRE_OT_control_reset(_PaintOperator, bpy.types.Operator):
    """Take this control's paint off the selected meshes. If it is being painted, it becomes neutral"""

    bl_idname = "encre.control_reset"
    bl_label = "Reset Control"

    control: _choice()

    def work(self, context, mode, objects):
        control = self.chosen
        if mode == "PAINT_VERTEX" and painted(context) == control:
            painting.fill(context.object, control, 0.0, False)
        elif not sum(painting.remove(obj.data, control) for obj in objects):
            self.report({"WARNING"}, f"{control.label}: nothing is painted on these meshes")
            return {"CANCELLED"}
        return {"FINISHED"}


class ENCRE_OT_control_show(bpy.types.Operator):
    """Show this control in the rendered view: red where it is most, blue where least. Press again for the picture"""

    bl_idname = "encre.control_show"
    bl_label = "Show Control"
    bl_options = {"INTERNAL"}

    control: _choice()

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE and context.space_data is not None and context.space_data.type == "VIEW_3D"

    def execute(self, context):
        shading = context.space_data.shading
        if shows(context, self.control):
            shading.encre.show = "FINAL"
            return {"FINISHED"}
        shading.encre.show, shading.encre.control, shading.encre.source = "CONTROL", self.control, "ENCRE"
        shading.type = "RENDERED"
        return {"FINISHED"}


def shows(context, name):
    """Whether the 3D view shows a control."""
    shading = context.space_data.shading
    return (shading.type == "RENDERED" and (shading.encre.source, shading.encre.show) == ("ENCRE", "CONTROL")
            and shading.encre.control == name)


class ENCRE_OT_brush(bpy.types.Operator):
    """Choose what the brush does to the control"""

    bl_idname = "encre.brush"
    bl_label = "Brush"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(name="Brush", items=[
        ("ADD", "Add", "Raise the control, at full strength by 1"),
        ("SUBTRACT", "Subtract", "Lower the control, at full strength by 1"),
        ("NEUTRAL", "Neutral", "Wipe the control towards what leaves things as they are")])
    strength: bpy.props.FloatProperty(name="Strength", description="Strength of the brush", min=0, max=1,
                                      default=painting.STRENGTH, subtype="FACTOR", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return context.mode == "PAINT_VERTEX" and painting.strength_owner() is not None

    def execute(self, _context):
        painting.set_brush(self.kind, self.strength if self.properties.is_property_set("strength") else None)
        return {"FINISHED"}


class ENCRE_OT_control_nodes(bpy.types.Operator):
    """Add a modifier of Geometry Nodes that makes this control, over what is painted and what others before it make"""

    bl_idname = "encre.control_nodes"
    bl_label = "Add Encre Control"
    bl_options = {"REGISTER", "UNDO"}

    control: _choice()
    by: bpy.props.EnumProperty(name="By", items=[
        ("NOISE", "Noise", "Spots of more and less"),
        ("NEARNESS", "Nearness", "Most at the other selected object, or at a new empty at the 3D cursor"),
        ("EDGE_ON", "Edge-on", "Most where the surface turns away from the camera"),
        ("VALUE", "Value", "The same everywhere")])
    amount: bpy.props.FloatProperty(name="Amount", description="The control where it is most", min=-1, max=1, default=1,
                                    subtype="FACTOR")

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and ENCRE_OT_paint.poll(context)

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        obj, name = context.object, {"EDGE_ON": "Edge-on"}.get(self.by, self.by.title())
        if obj.library:
            self.report({"ERROR"}, f"{obj.name}: the object is linked and takes no modifiers; override it first")
            return {"CANCELLED"}
        values = {"Attribute": library.controls()[self.control].attribute, name: self.amount}
        if self.by == "NEARNESS":
            others = [other for other in context.selected_objects if other != obj]
            values["Object"] = others[0] if others else _empty(context)
            # lengths of nodes are the mesh's, whatever the object's scale is
            values["Reach"] = max(max(axis) - min(axis) for axis in zip(*obj.bound_box, strict=True)) / 2 or 1.0
        if self.by == "EDGE_ON":
            if not context.scene.camera:
                self.report({"ERROR"}, "The scene has no camera; add one, or choose another way")
                return {"CANCELLED"}
            values["Camera"] = context.scene.camera
        control_nodes.add(obj, values)
        return {"FINISHED"}


def _empty(context):
    made = bpy.data.objects.new(control_nodes.NAME, None)
    made.location, made.empty_display_size = context.scene.cursor.location, 0.2
    context.collection.objects.link(made)
    return made


class ENCRE_PT_paint(SidebarPanel, bpy.types.Panel):
    bl_label = "Encre Controls"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and ENCRE_OT_paint.poll(context)

    def draw(self, context):
        layout, obj = self.layout, context.object
        column, now = layout.column(align=True), painted(context)
        for control in library.controls().values():
            _row(column, context, control, control == now)
        if context.mode == "PAINT_VERTEX":
            _brush(layout, obj.data)
        else:
            layout.operator("encre.control_nodes", icon="GEOMETRY_NODES")


def _row(column, context, control, pressed):
    mesh, split = context.object.data, column.split(factor=0.65, align=True)
    there = control.attribute in mesh.attributes
    split.operator("encre.paint", text=control.label, depress=pressed,
                   icon="BRUSH_DATA" if there else "ADD").control = control.name
    row = split.row(align=True)
    row.operator("encre.control_fill", text="", icon="SNAP_FACE").control = control.name
    row.operator("encre.control_show", text="", icon="HIDE_OFF",
                 depress=shows(context, control.name)).control = control.name
    last = row.row(align=True)
    last.enabled = there
    last.operator("encre.control_reset", text="", icon="X").control = control.name


def _brush(layout, mesh):
    column, kind = layout.column(align=True), painting.brush_kind()
    row = column.row(align=True)
    for own, text in (("ADD", n_("Add")), ("SUBTRACT", n_("Subtract")), ("NEUTRAL", n_("Neutral"))):
        row.operator("encre.brush", text=text, depress=kind == own).kind = own
    if owner := painting.strength_owner():
        column.prop(owner, "strength", slider=True)
    row = layout.row(heading="Mirror", align=True)
    for axis in "xyz":
        row.prop(mesh, f"use_mirror_{axis}", text=axis.upper(), toggle=True)


def _menu(self, context):
    if ENCRE_PT_paint.poll(context):
        self.layout.separator()
        self.layout.operator("wm.call_panel", text="Encre Controls").name = "ENCRE_PT_paint"
        self.layout.operator("encre.control_nodes")


_register, _unregister = bpy.utils.register_classes_factory(
    (ENCRE_OT_paint, ENCRE_OT_control_fill, ENCRE_OT_control_reset, ENCRE_OT_control_show, ENCRE_OT_brush,
     ENCRE_OT_control_nodes, ENCRE_PT_paint))
_MENUS = "VIEW3D_MT_object", "VIEW3D_MT_paint_vertex"


def register():
    _register()
    for name in _MENUS:
        getattr(bpy.types, name).append(_menu)


def unregister():
    for name in _MENUS:
        getattr(bpy.types, name).remove(_menu)
    _unregister()
