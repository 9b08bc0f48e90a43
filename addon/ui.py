# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: one per stage, drawn from the parameter table; the scene's presets and styles; objects and materials."""

import bpy

from . import core, presets, properties

ENGINE = "ENCRE"


class EncrePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


# ---- rows of parameters ------------------------------------------------------------------------------------------


def enabled(group, rule):
    """Whether a parameter's `enabled_if` holds for the values of a group; parameters that it lacks count as on."""

    def term(text):
        if text.startswith("!"):
            return not term(text[1:])
        id_, _, items = text.partition("=")
        value = getattr(group, id_, True)
        return value in items.split("|") if items else bool(value)

    return all(term(t) for t in rule.split("&")) if rule else True


def draw_levels(layout, group, path):
    """The list of light levels and a strip of the tones they give; `path` leads from the scene to the group."""
    column = layout.column()
    column.use_property_split = False
    column.label(text=core.params()["shade_levels"].label)
    strip = column.row(align=True)
    if group.shade_levels:
        rest = strip
        ends = [level.threshold for level in group.shade_levels[1:]] + [group.shade_levels[-1].threshold + 0.3]
        start = 0.0
        for level, end in zip(group.shade_levels, ends, strict=True):
            share = (end - start) / max(ends[-1] - start, 1e-6)
            last = level == group.shade_levels[-1]
            part = rest if last else rest.split(factor=min(max(share, 0.05), 1.0), align=True)
            part.prop(level, "tone", text="")
            rest, start = part, end
    else:
        strip.label(text="The default levels", icon="INFO")
    row = column.row()
    row.template_list("ENCRE_UL_levels", "", group, "shade_levels", group, "active_level", rows=3)
    buttons = row.column(align=True)
    for operator, icon in (("encre.level_add", "ADD"), ("encre.level_remove", "REMOVE")):
        buttons.operator(operator, text="", icon=icon).path = path


class ENCRE_UL_levels(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active, index=0, _flag=0):
        row = layout.row(align=True)
        row.prop(item, "intensity", text="", emboss=False)
        if index:
            row.prop(item, "threshold", text="", emboss=False)
            row.prop(item, "transition", text="", emboss=False)
        row.prop(item, "color", text="")


def _levels_owner(context, path):
    scene = context.scene.encre
    return scene.styles[scene.active_style] if path == "style" else scene


class LevelOperator:
    bl_options = {"UNDO", "INTERNAL"}
    path: bpy.props.StringProperty(options={"HIDDEN"})

    def execute(self, context):
        group = _levels_owner(context, self.path)
        if not group.shade_levels:
            properties.set_value(group, "shade_levels", core.params()["shade_levels"].default)
        sentence = self.change(group)
        if sentence:
            self.report({"ERROR"}, sentence)
            return {"CANCELLED"}
        group.active_level = min(group.active_level, len(group.shade_levels) - 1)
        return {"FINISHED"}


class ENCRE_OT_level_add(LevelOperator, bpy.types.Operator):
    """Add a level above the brightest one"""

    bl_idname = "encre.level_add"
    bl_label = "Add Level"

    def change(self, group):
        if len(group.shade_levels) >= core.MAX_LEVELS:
            return f"shade_levels: there are {core.MAX_LEVELS} levels, the most there can be; remove one first"
        last = group.shade_levels[-1]
        threshold = last.threshold + max(0.2, 2 * last.transition)
        intensity = last.intensity + 0.2
        new = group.shade_levels.add()
        new.threshold, new.intensity = threshold, intensity
        group.active_level = len(group.shade_levels) - 1
        return None


class ENCRE_OT_level_remove(LevelOperator, bpy.types.Operator):
    """Remove the chosen level"""

    bl_idname = "encre.level_remove"
    bl_label = "Remove Level"

    def change(self, group):
        if len(group.shade_levels) == 1:
            return "shade_levels: this is the last level; switch Shading off instead"
        group.shade_levels.remove(group.active_level)
        return None


def draw_params(layout, group, params, path):
    layout.use_property_split = True
    layout.use_property_decorate = path != "style"
    for p in params:
        row = layout.column()
        row.active = enabled(group, p.enabled_if)
        if p.type == "levels":
            draw_levels(row, group, path)
        elif p.type == "image":
            row.template_ID(group, p.id, open="image.open", text=p.label)
        else:
            row.prop(group, p.id)


def stage_panel(stage):
    """The panel class of one stage; a stage's `use_…` switch is the panel's check box."""
    switch = next((p for p in stage.params if p.id.startswith("use_")), None)
    rest = tuple(p for p in stage.params if p is not switch)

    def draw(self, context):
        draw_params(self.layout, context.scene.encre, rest, "scene")

    def draw_header(self, context):
        self.layout.prop(context.scene.encre, switch.id, text="")

    members = {"bl_label": stage.label, "bl_idname": f"ENCRE_PT_{stage.id}", "bl_options": {"DEFAULT_CLOSED"},
               "bl_parent_id": "ENCRE_PT_encre", "draw": draw, "__doc__": stage.help}
    if switch:
        members["draw_header"] = draw_header
    return type(f"ENCRE_PT_{stage.id}", (EncrePanel, bpy.types.Panel), members)


# ---- the scene ---------------------------------------------------------------------------------------------------


class ENCRE_OT_preset(bpy.types.Operator):
    bl_idname = "encre.preset"
    bl_label = "Apply Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.StringProperty(name="Preset", options={"HIDDEN"})

    @classmethod
    def description(cls, _context, properties_):
        preset = presets.find(properties_.preset)
        labels = [core.params()[id_].label for id_ in preset.values]
        return f"{preset.description}. Sets {', '.join(labels)}; leaves all other settings as they are"

    def execute(self, context):
        try:
            preset = presets.find(self.preset)
        except core.EncreError as error:
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
    bl_order = -1  # above Cycles' own panels

    def draw(self, context):
        layout = self.layout
        layout.menu("ENCRE_MT_presets")
        transform = context.scene.view_settings.view_transform
        if transform != "Standard":
            box = layout.box()
            box.label(text=f"{transform} washes ink and flat colours out", icon="INFO")
            box.operator("encre.standard_view")


class ENCRE_UL_styles(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active, index=0, _flag=0):
        layout.prop(item, "name", text="", emboss=False, icon="BRUSH_DATA")


class ENCRE_OT_style_add(bpy.types.Operator):
    """Add a style that objects and materials can use; it changes nothing yet"""

    bl_idname = "encre.style_add"
    bl_label = "Add Style"
    bl_options = {"UNDO"}

    def execute(self, context):
        scene = context.scene.encre
        names = {s.name for s in scene.styles}
        name = next(n for n in ("Style", *(f"Style.{k:03}" for k in range(1, 1000))) if n not in names)
        scene.styles.add().name = name
        scene.active_style = len(scene.styles) - 1
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


def _surface_params(_self=None, _context=None):
    return [(p.id, f"{stage.label}: {p.label}", p.help) for stage in core.stages() for p in stage.params
            if p.scope == "surface"]


class ENCRE_OT_style_store(bpy.types.Operator):
    """Let this style have its own value of a setting"""

    bl_idname = "encre.style_store"
    bl_label = "Change Setting"
    bl_options = {"UNDO"}
    bl_property = "param"

    param: bpy.props.EnumProperty(name="Setting", items=_surface_params())

    def invoke(self, context, _event):
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        scene = context.scene.encre
        value = properties.scene_values(context.scene)[self.param]
        properties.set_value(scene.styles[scene.active_style], self.param, value)
        return {"FINISHED"}


class ENCRE_OT_style_forget(bpy.types.Operator):
    """Take the scene's value again"""

    bl_idname = "encre.style_forget"
    bl_label = "Use the Scene's Setting"
    bl_options = {"UNDO", "INTERNAL"}

    param: bpy.props.StringProperty()

    def execute(self, context):
        scene = context.scene.encre
        style = scene.styles[scene.active_style]
        if self.param == "shade_levels":
            style.shade_levels.clear()
        style.property_unset(self.param)
        return {"FINISHED"}


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
        if not scene.styles:
            return
        style = scene.styles[min(scene.active_style, len(scene.styles) - 1)]
        for p in core.params().values():
            if p.scope == "surface" and properties.stores(style, p):
                row = layout.row()
                draw_params(row.column(), style, (p,), "style")
                row.operator("encre.style_forget", text="", icon="X", emboss=False).param = p.id
        layout.operator("encre.style_store", icon="ADD")


# ---- objects and materials ---------------------------------------------------------------------------------------


def draw_block(layout, block, scene):
    layout.use_property_split = True
    layout.prop_search(block.encre, "style", scene.encre, "styles")
    column = layout.column(align=True)
    for name in core.CONTROLS:
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


_registered = []


def register():
    classes = [ENCRE_UL_levels, ENCRE_OT_level_add, ENCRE_OT_level_remove, ENCRE_OT_preset, ENCRE_MT_presets,
               ENCRE_OT_standard_view, ENCRE_UL_styles, ENCRE_OT_style_add, ENCRE_OT_style_remove, ENCRE_OT_style_store,
               ENCRE_OT_style_forget, ENCRE_PT_encre, *map(stage_panel, core.stages()), ENCRE_PT_styles,
               ENCRE_PT_object, ENCRE_PT_material]
    for cls in classes:
        bpy.utils.register_class(cls)
        _registered.append(cls)


def unregister():
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
