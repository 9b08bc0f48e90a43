# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings as a whole, of a scene or a style: copied, pasted, and reset row by row."""

from dataclasses import dataclass

import bpy

from ...pen import library, slots
from .. import ENGINE, pens, properties
from ..languages import tip_
from . import presets


@dataclass
class _Copied:
    """What was copied: values that are set, by id, and, of a scene, its styles' by name."""

    values: dict
    styles: dict | None
    pens: dict  # a scene's names of pens


_copied = None


def active_style(scene):
    """The style that the list shows, None if there is none."""
    styles = scene.encre.styles
    return styles[min(scene.encre.active_style, len(styles) - 1)] if styles else None


def _basis(preset, p):
    """What a parameter is reset to: the value of the preset that the scene had last, or the default."""
    return preset.values.get(p.id, p.default) if preset else p.default


class _SettingsOperator:
    bl_options = {"REGISTER", "UNDO"}

    path: bpy.props.EnumProperty(name="Of", options={"HIDDEN"}, items=[
        ("scene", "Scene", "The scene's settings"), ("style", "Style", "The chosen style's")])

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def group(self, context):
        """The group whose settings are meant, None if there is no style."""
        return active_style(context.scene) if self.path == "style" else context.scene.encre


class ENCRE_OT_settings_copy(_SettingsOperator, bpy.types.Operator):
    """Copy all settings, to paste them into another scene or style"""

    bl_idname = "encre.settings_copy"
    bl_label = "Copy Settings"
    bl_options = {"INTERNAL"}

    def execute(self, context):
        global _copied
        group = self.group(context)
        if group is None:
            return {"CANCELLED"}
        _copied = _Copied(properties.stored(group), None, {})
        if self.path == "scene":
            _copied.pens = pens.names(group)
            _copied.styles = {style.name: properties.stored(style) for style in group.styles}
        return {"FINISHED"}


class ENCRE_OT_settings_paste(_SettingsOperator, bpy.types.Operator):
    """Paste what was copied: a scene also gets the styles, a style only what differs from its scene"""

    bl_idname = "encre.settings_paste"
    bl_label = "Paste Settings"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and _copied is not None

    def execute(self, context):
        group, missing = self.group(context), []
        if group is None:
            return {"CANCELLED"}
        if self.path == "style":
            wanted = _copied.values
            if _copied.styles is not None:
                wanted = {p.id: _copied.values.get(p.id, p.default) for p in library.params().values()
                          if p.scope == "surface"}
                wanted = {id_: value for id_, value in wanted.items()
                          if not properties.has(context.scene.encre, library.params()[id_], value)}
            missing += properties.replace(group, wanted)
        elif _copied.styles is None:  # what a style changes, and nothing else
            missing += properties.set_values(group, _copied.values)
        else:
            missing += properties.replace(group, _copied.values)
            pens.rename_all(group, {pen.id: _copied.pens.get(pen.id, "") for pen in slots.pens()})
            for name, values in _copied.styles.items():
                style = group.styles.get(name) or group.styles.add()
                style.name = name
                missing += properties.replace(style, values)
        for image in missing:
            self.report({"WARNING"}, f"{image}: this image is not here; choose another")
        return {"FINISHED"}


class ENCRE_OT_reset(_SettingsOperator, bpy.types.Operator):
    bl_idname = "encre.reset"
    bl_label = "Reset Setting"

    param: bpy.props.StringProperty(name="Setting", options={"HIDDEN"})

    @classmethod
    def description(cls, context, properties_):
        preset = presets.current(context.scene)
        if preset is None:
            return tip_("Reset to the default value")
        return tip_("Reset to the value of the look {}").format(preset.name)

    def execute(self, context):
        params, preset = library.params(), presets.current(context.scene)
        for p in (params[self.param],) if self.param else params.values():
            value = _basis(preset, p)
            if value == p.default:
                properties.unset_value(context.scene.encre, p.id)
            else:
                properties.set_value(context.scene.encre, p.id, value)
        return {"FINISHED"}


def draw_reset(layout, group, p, preset):
    """The button that resets a row of the scene's to a preset or, with None, to the default, where it differs."""
    if not properties.has(group, p, _basis(preset, p)):
        layout.operator("encre.reset", text="", icon="LOOP_BACK", emboss=False).param = p.id


class _SettingsMenu:
    bl_label = "Settings"
    path = "scene"

    def draw(self, _context):
        layout = self.layout
        layout.operator("encre.settings_copy", icon="COPYDOWN").path = self.path
        layout.operator("encre.settings_paste", icon="PASTEDOWN").path = self.path
        if self.path == "scene":
            layout.separator()
            layout.operator("encre.reset", text="Reset All", icon="LOOP_BACK").param = ""


class ENCRE_MT_scene_settings(_SettingsMenu, bpy.types.Menu):
    """Copy, paste and reset the settings of the scene"""

    bl_idname = "ENCRE_MT_scene_settings"


class ENCRE_MT_style_settings(_SettingsMenu, bpy.types.Menu):
    """Copy and paste the settings of the style"""

    bl_idname = "ENCRE_MT_style_settings"
    path = "style"


CLASSES = (ENCRE_OT_settings_copy, ENCRE_OT_settings_paste, ENCRE_OT_reset, ENCRE_MT_scene_settings,
           ENCRE_MT_style_settings)
