# SPDX-License-Identifier: GPL-3.0-or-later
"""Styles: what some surfaces change of the scene's settings."""

import bpy

from ...pen import library, slots
from .. import pens, properties
from ..languages import CONTEXT, iface_, n_
from . import settings
from .base import EncrePanel
from .rows import draw_params


class ENCRE_UL_styles(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active, index=0, _flag=0):
        layout.prop(item, "name", text="", emboss=False, icon="BRUSH_DATA")


def _users(context, to):
    """What a new style is for."""
    if to == "material":
        return [context.material]
    return context.selected_objects if context.object in context.selected_objects else [context.object]


class ENCRE_OT_style_add(bpy.types.Operator):
    """Add a style that objects and materials can use; it changes nothing yet"""

    bl_idname = "encre.style_add"
    bl_label = "Add Style"
    bl_options = {"UNDO"}

    to: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # "", "object" or "material"

    @classmethod
    def description(cls, _context, properties):
        return {"object": n_("Add a style and give it to the selected objects"),
                "material": n_("Add a style and give it to the material")}.get(properties.to, cls.__doc__)

    def execute(self, context):
        scene, owner = context.scene.encre, self.to and getattr(context, self.to)
        style = scene.styles.add()
        style.name = owner.name if owner else "Style"
        scene.active_style = len(scene.styles) - 1
        for block in _users(context, self.to) if owner else ():
            if block.library is None:
                block.encre.style = style.name
        return {"FINISHED"}


class ENCRE_OT_style_remove(bpy.types.Operator):
    """Remove the chosen style; what uses it takes the scene's settings"""

    bl_idname = "encre.style_remove"
    bl_label = "Remove Style"
    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context):
        return bool(context.scene.encre.styles)

    def execute(self, context):
        scene = context.scene.encre
        scene.styles.remove(scene.active_style)
        scene.active_style = max(0, min(scene.active_style, len(scene.styles) - 1))
        return {"FINISHED"}


_offered = []  # Blender wants the texts that it shows to be kept


def _label(scene, p, of=""):
    """What a row is called where all are beside each other: of which pen, or else which stage, it is."""
    pen = slots.of(p.id)
    of = pens.name(scene, pen) if pen and pen.kind == "pen" else iface_(of, CONTEXT) if of else ""
    return f"{of}: {iface_(p.label, CONTEXT)}" if of else iface_(p.label, CONTEXT)


def _surface_params(_self, context):
    _offered[:] = [(p.id, _label((context or bpy.context).scene.encre, p, stage.label), p.help)
                   for stage in library.stages() for p in stage.params if p.scope == "surface"]
    return _offered


def _meant(context, name):
    """The style of this name; "": the one that is chosen in the list."""
    return context.scene.encre.styles[name] if name else settings.active_style(context.scene)


class ENCRE_OT_style_store(bpy.types.Operator):
    """Let this style have its own value of a setting"""

    bl_idname = "encre.style_store"
    bl_label = "Change Setting"
    bl_options = {"UNDO"}
    bl_property = "param"

    param: bpy.props.EnumProperty(name="Setting", items=_surface_params)
    style: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return bool(context.scene.encre.styles)

    def invoke(self, context, _event):
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        value = properties.scene_values(context.scene)[self.param]
        properties.set_value(_meant(context, self.style), self.param, value)
        return {"FINISHED"}


class ENCRE_OT_style_forget(bpy.types.Operator):
    """Take the scene's value again"""

    bl_idname = "encre.style_forget"
    bl_label = "Use the Scene's Setting"
    bl_options = {"UNDO", "INTERNAL"}

    param: bpy.props.StringProperty()
    style: bpy.props.StringProperty(options={"SKIP_SAVE"})

    def execute(self, context):
        properties.unset_value(_meant(context, self.style), self.param)
        return {"FINISHED"}


def draw_style(layout, scene, style):
    """What a style changes, and a way to change more."""
    for p in library.params().values():
        if p.scope == "surface" and properties.stores(style, p):
            row = layout.row()
            draw_params(row.column(), style, (p,), "style", lambda p: _label(scene, p))
            forget = row.operator("encre.style_forget", text="", icon="X", emboss=False)
            forget.param, forget.style = p.id, style.name
    layout.operator("encre.style_store", icon="ADD").style = style.name


class ENCRE_PT_styles(EncrePanel, bpy.types.Panel):
    bl_label = "Styles"
    bl_idname = "ENCRE_PT_styles"
    bl_parent_id = "ENCRE_PT_encre"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, scene = self.layout, context.scene.encre
        row = layout.row()
        row.template_list("ENCRE_UL_styles", "", scene, "styles", scene, "active_style", rows=3)
        buttons = row.column(align=True)
        buttons.operator("encre.style_add", text="", icon="ADD")
        buttons.operator("encre.style_remove", text="", icon="REMOVE")
        style = settings.active_style(context.scene)
        if style is None:
            return
        buttons.separator()
        buttons.menu("ENCRE_MT_style_settings", text="", icon="DOWNARROW_HLT")
        draw_style(layout, scene, style)


CLASSES = (ENCRE_UL_styles, ENCRE_OT_style_add, ENCRE_OT_style_remove, ENCRE_OT_style_store, ENCRE_OT_style_forget,
           ENCRE_PT_styles)
