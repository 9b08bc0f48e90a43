# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: Encre's own and the user's, applied, saved, shared and deleted."""

from pathlib import Path

import bpy

from ...pen import presets
from ...pen.errors import EncreError
from .. import ENGINE, looks, pens, properties, thumbnails
from ..languages import tip_
from ..looks import current, every, folder


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
    bl_label = "Apply Look"
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
        return f"{tip_(preset.description)}. " + tip_("Sets all that a look is made of: lines, shade, tones, paint and "
                                                      "paper. Your own changes to these are lost")

    def do(self, context):
        looks.apply(context.scene.encre, presets.find(self.preset, folder()))


class ENCRE_OT_look_step(bpy.types.Operator):
    bl_idname = "encre.look_step"
    bl_label = "Next Look"
    bl_options = {"REGISTER", "UNDO"}

    step: bpy.props.IntProperty(default=1, options={"HIDDEN"})

    @classmethod
    def description(cls, _context, properties_):
        return tip_("The look after this one") if properties_.step > 0 else tip_("The look before this one")

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def execute(self, context):
        found = every()[0]
        ids = [preset.id for preset in found]
        now = context.scene.encre.preset
        at = ids.index(now) + self.step if now in ids else 0
        looks.apply(context.scene.encre, found[at % len(found)])
        return {"FINISHED"}


class ENCRE_OT_preset_save(_PresetOperator, bpy.types.Operator):
    """Save how the scene looks, with the last render as its picture, without images and Layers and Quality"""

    bl_idname = "encre.preset_save"
    bl_label = "Save Look"
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
    """Delete this look and its picture"""

    bl_idname = "encre.preset_remove"
    bl_label = "Delete Look"
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
    """Add a look from a file, with the picture beside it, to yours"""

    bl_idname = "encre.preset_import"
    bl_label = "Import Look"
    bl_options = {"INTERNAL"}

    def do(self, _context):
        preset = presets.read(Path(self.filepath))
        path = folder() / presets.file_name(preset.name)
        if path.exists():
            raise EncreError(f"{preset.name} is one of your looks already; delete that first")
        presets.copy(preset, path)
        return f"{preset.name} is one of your looks now"


class ENCRE_OT_preset_export(_FileOperator, bpy.types.Operator):
    """Write this look to a file, and its picture beside it, for others"""

    bl_idname = "encre.preset_export"
    bl_label = "Export Look"
    bl_options = {"INTERNAL"}

    preset: bpy.props.StringProperty(options={"HIDDEN"})
    check_existing: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, event):
        self.filepath = self.preset + ".json"
        return super().invoke(context, event)

    def do(self, _context):
        path = Path(self.filepath)
        presets.copy(presets.find(self.preset, folder()), path.with_suffix(".json"))


class ENCRE_MT_looks(bpy.types.Menu):
    """Save this look, import one from a file, export or delete your own"""

    bl_label = "Looks"

    def draw(self, context):
        layout, (found, wrong) = self.layout, every()
        layout.operator("encre.preset_save", icon="ADD")
        layout.operator("encre.preset_import", icon="IMPORT")
        preset = current(context.scene)
        if preset and not preset.own:
            layout.operator("encre.preset_export", icon="EXPORT").preset = preset.id
            layout.operator("encre.preset_remove", icon="X").preset = preset.id
        layout.separator()
        for each in found:
            layout.operator("encre.preset", text=each.name, translate=False).preset = each.id
        for sentence in wrong:
            layout.label(text=sentence, icon="ERROR", translate=False)


CLASSES = (ENCRE_OT_preset, ENCRE_OT_preset_save, ENCRE_OT_preset_remove, ENCRE_OT_preset_import,
           ENCRE_OT_preset_export, ENCRE_OT_look_step, ENCRE_MT_looks)
