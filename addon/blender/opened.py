# SPDX-License-Identifier: GPL-3.0-or-later
"""A rendered file's layers in memory, as if its frame had just been rendered (memory.py): settings are then seen at
once (instant.py) and drawn anew (redraw.py)."""

import bpy
import numpy as np

from ..pen import denoise, layers, metadata, saved, slim, stored
from ..pen.around import Window
from ..pen.errors import EncreError
from ..pen.exr import Exr
from ..pen.job import Camera, Frame
from ..pen.settings import Settings
from . import ENGINE, cameras, fast_frame, instant, memory, properties, redraw, versions

# What another program renders has no ink yet, and nothing tells it from what the image editor saves.
_INKED = ("no picture without ink, as files that the image editor saves: what is inked in it is inked again; render to "
          "a multilayer file with Save Layers")


def load(scene, path):
    """Keeps a file's layers of a scene's frame. Sentences about what is drawn otherwise, as the file lacks what that
    needs. EncreError: it can't be used."""
    file = Exr(path)
    said, found = metadata.read(file.texts), stored.view_layers(file.channels, file.views)
    if scene.render.use_multiview or len(file.views) > 1:
        raise EncreError(f"{path}: stereo pictures, and files for scenes with stereo, can't be opened here; "
                         "use encre composite")
    width, height, own = cameras.border(scene.render)
    whole = file.window[:2]
    x, y, *rendered = said.border or (0, 0, *whole)
    if tuple(rendered) != (own.width, own.height) or (said.border and (x, y) != (own.x, own.y)):
        raise EncreError(f"{path}: shows {rendered[0]} x {rendered[1]} pixels, and the scene renders {own.width} x "
                         f"{own.height}; give both the same size and border")
    settings = Settings(said.scene, said.styles, versions.working_space())
    asked = properties.settings(scene)
    names = [layer.name for layer in scene.view_layers if layer.name in found]
    if not names and len(scene.view_layers) == 1:
        names = [next((name for name in found if name != "Composite"), None)]
    kept, lacks = {}, {}
    for name in names:
        view, passes = next(iter(found[name].items()))
        if {"Combined", "Encre Source"} & passes.keys():
            rows = np.s_[y:y + own.height, x:x + own.width]
            layer = scene.view_layers[name].name if name in scene.view_layers else scene.view_layers[0].name
            kept[layer] = _layer(file, layer, passes, settings, said, rows, own, (width, height),
                                 said.chains.get((name, view)))
            if "Encre Source" not in passes:
                lacks[_INKED] = None
            lacks.update(dict.fromkeys(saved.missing(passes, asked)))
            if old := saved.tells_no_lines(passes, (name, view) in said.chains, asked):
                lacks[old] = None
    if not kept:
        raise EncreError(f"{path}: holds no view layer of this scene that can be drawn again; render it "
                         "with Save Layers")
    memory.forget()
    for layer in kept.values():
        memory.begin(scene, layer)
    memory.picture(scene).values = None  # what the file shows was drawn by other settings, perhaps
    return list(lacks)


def _layer(file, name, passes, settings, said, rows, own, size, lines):
    names = stored.wanted(passes, file.path, bool(said.camera))
    pictures = file.read([full for channels in names.values() for full in channels])
    shown = {one: stored.opaque(np.stack([pictures[full][rows] for full in channels], -1), one)
             for one, channels in names.items()}
    slim.unpack(shown, said.camera)
    clean = None
    if "Encre Diffuse" not in shown and settings.denoises and denoise.available(versions.home()):
        def clean(picture, albedo, normal, *surface):
            return denoise.denoise(picture, albedo, normal, home=versions.home(), scale=settings.light_scale,
                                   surface=surface)
    made, _ = layers.assemble(dict(shown), settings, saved.unpack(shown), clean)
    if lines is not None:
        made["chains"] = lines
    width, height = size
    frame = said.frame or Frame(width, height, own.x, own.y)
    frame = Frame(frame.width, frame.height, own.x, own.y)
    place = fast_frame.Place(said.camera or Camera(), frame, frame, Window(own.x, own.y, own.width, own.height),
                             np.s_[:, :], 1)
    before = fast_frame.Kept(name, settings, {"": place})
    plain = {versions.pass_name(one): picture for one, picture in shown.items() if one in layers.CYCLES}
    plain["Combined"] = made["combined"]
    layer = memory.Layer(before, denoised=False, opened=True)
    layer.views[""] = memory.View(made, plain, plain)
    return layer


class ENCRE_OT_open_layers(bpy.types.Operator):
    """Open the layers of a rendered multilayer EXR, so that changes are drawn without another render"""

    bl_idname = "encre.open_layers"
    bl_label = "Open Layers"
    bl_options = {"REGISTER"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    filter_glob: bpy.props.StringProperty(default="*.exr", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return context.scene.encre.keep_layers and not bpy.app.is_job_running("RENDER")

    def invoke(self, context, _event):
        space = context.space_data
        image = space.image if space and space.type == "IMAGE_EDITOR" else None
        if image and image.filepath.lower().endswith(".exr"):
            self.filepath = image.filepath_from_user(image_user=space.image_user)
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        from .engine import pass_names

        try:
            lacks = load(context.scene, bpy.path.abspath(self.filepath))
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if why := memory.refusal(context.scene, pass_names):
            self.report({"ERROR"}, why)
            return {"CANCELLED"}
        if lacks:
            self.report({"WARNING"}, f"{self.filepath} has {'; '.join(lacks)}")
        space, result = context.space_data, instant.result()
        if space and space.type == "IMAGE_EDITOR" and result:
            space.image = result
        redraw.start(context.window, any(instant.editors()))
        return {"FINISHED"}


def _in_menu(self, context):
    if context.scene.render.engine == ENGINE and context.space_data.image:
        self.layout.operator("encre.open_layers", icon="RENDER_RESULT")


def register():
    bpy.utils.register_class(ENCRE_OT_open_layers)
    bpy.types.IMAGE_MT_image.append(_in_menu)


def unregister():
    bpy.types.IMAGE_MT_image.remove(_in_menu)
    bpy.utils.unregister_class(ENCRE_OT_open_layers)
