# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: Encre's own and the user's, applied, saved, shared and deleted."""

from pathlib import Path

import bpy

from ...pen import library, presets
from ...pen.errors import EncreError
from .. import ENGINE, pens, properties, thumbnails, versions
from ..languages import CONTEXT, iface_, tip_


def folder():
    """Where the user's presets are."""
    return Path(versions.user_folder(__package__)) / "presets"


def current(scene):
    """The preset that the scene had last; None: none, or it is gone."""
    try:
        return presets.find(scene.encre.preset, folder()) if scene.encre.preset else None
    except EncreError:
        return None


def _every():
    """(all presets, sentences about the user's files that can't be used)"""
    mine, wrong = presets.users(folder())
    return (*presets.presets(), *mine), wrong


class _PresetOperator:
    """Does something that can fail with a sentence."""

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def execute(self, context):
        try:
            said = self.do(context)
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if said:
            self.report({"INFO"}, said)
        return {"FINISHED"}


class ENCRE_OT_preset(_PresetOperator, bpy.types.Operator):
    bl_idname = "encre.preset"
    bl_label = "Apply Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.StringProperty(name="Preset", options={"HIDDEN"})

    @classmethod
    def poll(cls, _context):
        return True  # scripts may choose the engine later

    @classmethod
    def description(cls, _context, properties_):
        try:
            preset = presets.find(properties_.preset, folder())
        except EncreError as error:
            return str(error)
        labels = [iface_(library.params()[id_].label, CONTEXT) for id_ in preset.listed]
        listed = ", ".join(labels[:40]) + (", ..." if len(labels) > 40 else "")
        sets = tip_("Sets {}; takes back what other presets set, and leaves all else as it is").format(listed)
        return f"{tip_(preset.description)}. {sets}"

    def do(self, context):
        preset = presets.find(self.preset, folder())
        for id_, value in preset.values.items():
            properties.set_value(context.scene.encre, id_, value)
        pens.rename_all(context.scene.encre, {pen: iface_(name, CONTEXT) if preset.own and name else name
                                              for pen, name in preset.pens.items()})
        context.scene.encre.preset = preset.id


class ENCRE_OT_preset_save(_PresetOperator, bpy.types.Operator):
    """Save how the scene looks, without images and the panel Layers, with the last render as the picture"""

    bl_idname = "encre.preset_save"
    bl_label = "Save Preset"
    bl_options = {"UNDO"}

    name: bpy.props.StringProperty(name="Name", description="One of yours with this name is overwritten")
    description: bpy.props.StringProperty(name="Description", description="What it looks like, in a sentence")

    def invoke(self, context, _event):
        now = current(context.scene)
        if now and not now.own:
            self.name, self.description = now.name, now.description
        return context.window_manager.invoke_props_dialog(self)

    def do(self, context):
        path = folder() / presets.file_name(self.name)
        values = presets.of(properties.scene_values(context.scene))
        presets.write(path, self.name.strip(), self.description.strip(), values, pens.names(context.scene.encre))
        path.with_suffix(".png").unlink(missing_ok=True)
        thumbnails.save(context.scene, path.with_suffix(".png"))
        context.scene.encre.preset = path.stem


class ENCRE_OT_preset_remove(_PresetOperator, bpy.types.Operator):
    """Delete this preset and its picture"""

    bl_idname = "encre.preset_remove"
    bl_label = "Delete Preset"
    bl_options = {"INTERNAL"}

    preset: bpy.props.StringProperty(options={"HIDDEN"})

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def do(self, _context):
        presets.remove(presets.find(self.preset, folder()))


class _FileOperator(_PresetOperator):
    """Asks for a file."""

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})

    def invoke(self, context, _event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}


class ENCRE_OT_preset_import(_FileOperator, bpy.types.Operator):
    """Add a preset from a file, with the picture beside it, to yours"""

    bl_idname = "encre.preset_import"
    bl_label = "Import Preset"
    bl_options = {"INTERNAL"}

    def do(self, _context):
        preset = presets.read(Path(self.filepath))
        path = folder() / presets.file_name(preset.name)
        if path.exists():
            raise EncreError(f"{preset.name} is one of your presets already; delete that first")
        presets.copy(preset, path)
        return f"{preset.name} is one of your presets now"


class ENCRE_OT_preset_export(_FileOperator, bpy.types.Operator):
    """Write this preset to a file, and its picture beside it, for others"""

    bl_idname = "encre.preset_export"
    bl_label = "Export Preset"
    bl_options = {"INTERNAL"}

    preset: bpy.props.StringProperty(options={"HIDDEN"})
    check_existing: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, event):
        self.filepath = self.preset + ".json"
        return super().invoke(context, event)

    def do(self, _context):
        path = Path(self.filepath)
        presets.copy(presets.find(self.preset, folder()), path.with_suffix(".json"))


class ENCRE_PT_presets(bpy.types.Panel):
    """Looks to begin with: each sets some settings and leaves the others as they are"""

    bl_label = "Presets"
    bl_idname = "ENCRE_PT_presets"
    bl_space_type = "PROPERTIES"
    bl_region_type = "HEADER"  # no place of its own: a pop-over
    bl_ui_units_x = 28

    def draw(self, _context):
        layout = self.layout
        every, wrong = _every()
        grid = layout.grid_flow(row_major=True, columns=5, even_columns=True)
        for preset in every:
            column = grid.column(align=True)
            column.template_icon(thumbnails.icon(preset.picture), scale=5.0)
            row = column.row(align=True)
            row.operator("encre.preset", text=preset.name, translate=False).preset = preset.id
            if not preset.own:
                row.operator("encre.preset_export", text="", icon="EXPORT").preset = preset.id
                row.operator("encre.preset_remove", text="", icon="X").preset = preset.id
        for sentence in wrong:
            layout.label(text=sentence, icon="ERROR", translate=False)
        row = layout.row()
        row.operator("encre.preset_save", icon="ADD")
        row.operator("encre.preset_import", icon="IMPORT")


CLASSES = (ENCRE_OT_preset, ENCRE_OT_preset_save, ENCRE_OT_preset_remove, ENCRE_OT_preset_import,
           ENCRE_OT_preset_export, ENCRE_PT_presets)
