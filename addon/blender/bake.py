# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on image textures: bake inter-color lines into them, fit the contrast of lines to them."""

import contextlib
import os
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..pen import library, unwrap
from ..pen.errors import EncreError
from . import ENGINE, pictures, properties, triangles, versions
from .panels.base import SidebarPanel

SOURCE = "encre_source"  # on a baked image: the image that it was made from, which so has a user


@dataclass
class Task:
    """An image and what shows it."""

    image: bpy.types.Image
    nodes: list = field(default_factory=list)
    objects: list = field(default_factory=list)


def tasks(objects):
    """The colour textures in the materials of the objects, each once and in order, as they were before any baking."""
    found = {}
    for obj in objects:
        for slot in obj.material_slots:
            for node in _image_nodes(slot.material.node_tree if slot.material else None, set()):
                image = node.image.get(SOURCE) or node.image
                task = found.setdefault(image.name_full, Task(image))
                task.nodes += [] if node in task.nodes else [node]
                task.objects += [] if obj in task.objects else [obj]
    return list(found.values())


def _image_nodes(tree, seen):
    if tree is None or tree in seen:
        return
    seen.add(tree)
    for node in tree.nodes:
        if node.type == "GROUP":
            yield from _image_nodes(node.node_tree, seen)
        elif node.type == "TEX_IMAGE" and node.image and node.image.source in {"FILE", "GENERATED"} \
                and not node.image.colorspace_settings.is_data:
            yield node


def read(image):
    """The pixels (H, W, 3 or 4) as stored, row 0 at the top. Raises EncreError."""
    pixels = pictures.values(image)
    if pixels is None:
        raise EncreError(f"{image.name}: has no pixels; find its missing file first")
    return (pixels if image.channels > 2 else pictures.colors(pixels))[::-1]


def settings(context):
    """The parameters of the scene that baking reads."""
    context.scene.update_tag()  # what a script has just set is not yet in the evaluated scene
    values = properties.scene_values(context.evaluated_depsgraph_get().scene_eval)
    return {id_: v for id_, v in values.items() if id_ == "line_thickness" or id_.startswith("contrast_")}


def _uv_map(nodes):
    """Name of the UV map by which the nodes read their image, "" for the active one; None: none, or several."""
    names = set()
    for node in nodes:
        links = node.inputs["Vector"].links
        source = links[0].from_node if links else None
        if source is None or (source.type == "TEX_COORD" and links[0].from_socket.name == "UV"):
            names.add("")
        else:
            names.add(source.uv_map if source.type == "UVMAP" else None)
    return names.pop() if len(names) == 1 else None


def _mesh(task, depsgraph):
    """The surface on which the image lies, unwrapped. Raises EncreError where it has no UV map of its own."""
    name = _uv_map(task.nodes)
    if name is None:
        raise EncreError(f"{task.image.name}: is not laid on by a UV map alone; apply its mapping to the UV map")
    return unwrap.join([triangles.unwrapped(obj, depsgraph, name) for obj in task.objects])


def _tiles(task, mesh):
    if any(node.extension != "REPEAT" for node in task.nodes):
        return False, False
    return unwrap.tiles(mesh) if mesh else (True, True)


def draw(task, values, uniform, depsgraph, progress):
    """The pixels of the image with lines in them. Raises EncreError."""
    if any(node.id_data.library for node in task.nodes):
        raise EncreError(f"{task.image.name}: is shown by a linked material; make that local first")
    try:
        mesh = _mesh(task, depsgraph)
    except EncreError:
        if uniform:
            raise
        mesh = None
    pixels = read(task.image)
    form = unwrap.form(mesh, pixels.shape[1], pixels.shape[0]) if uniform else None
    return library.bake(pixels, values, form, task.image.is_float, _tiles(task, mesh), progress=progress).texture


def store(image, pixels, folder):
    """A new image with these pixels, packed into the .blend, or saved in a folder under a name that is free."""
    height, width, channels = pixels.shape
    stem = f"{os.path.splitext(image.name)[0]} lines"
    new = bpy.data.images.new(stem, width, height, alpha=channels == 4, float_buffer=image.is_float)
    try:
        new.colorspace_settings.name = image.colorspace_settings.name
        new.alpha_mode = image.alpha_mode
        full = np.ones((height, width, 4), np.float32)
        full[..., :channels] = pixels[::-1]
        new.pixels.foreach_set(full.reshape(-1))
        new[SOURCE] = image
        if folder is None:
            new.pack()
            return new
        ending, new.file_format = (".exr", "OPEN_EXR") if image.is_float else (".png", "PNG")
        name = bpy.path.clean_name(stem)
        path = os.path.join(folder, name + ending)
        number = 1
        while os.path.exists(path):
            path, number = os.path.join(folder, f"{name}.{number:03}{ending}"), number + 1
        new.filepath_raw = path
        new.save()
        return new
    except (RuntimeError, OSError) as error:
        bpy.data.images.remove(new)
        reason = str(error).strip().removeprefix("Error: ").rstrip(".")
        raise EncreError(f"{image.name}: can't be stored ({reason}); choose another folder") from None


def discard(new):
    """Takes back what store() made."""
    path = None if new.packed_file else new.filepath_raw
    bpy.data.images.remove(new)
    if path:
        with contextlib.suppress(OSError):
            os.remove(path)


class ENCRE_OT_bake(bpy.types.Operator):
    """Draw lines into the image textures of the selected objects, where their colors meet. The images are kept"""

    bl_idname = "encre.bake"
    bl_label = "Bake Inter-Color Lines"
    bl_options = {"REGISTER", "UNDO"}

    uniform: bpy.props.BoolProperty(name="Uniform Width", description=(
        "Draw lines that have the same width everywhere on the surface, however the UV map stretches"))
    where: bpy.props.EnumProperty(name="Keep", items=[
        ("PACK", "In the File", "Pack the new images into the .blend file"),
        ("FOLDER", "In a Folder", "Save the new images as files")])
    directory: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//textures/",
                                         options=versions.BLEND_RELATIVE)

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and bool(context.selected_objects)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "uniform")
        layout.prop(self, "where")
        row = layout.row()
        row.active = self.where == "FOLDER"
        row.prop(self, "directory")

    def invoke(self, context, _event):
        self.in_window = True
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        try:
            self.begin(context)
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.window_manager.progress_begin(0, len(self.tasks))
        if getattr(self, "in_window", False):
            self.timer = context.window_manager.event_timer_add(0.01, window=context.window)
            context.window_manager.modal_handler_add(self)
            return {"RUNNING_MODAL"}
        self.timer = None
        while len(self.done) < len(self.tasks):
            self.step(context)
        return self.finish(context)

    def modal(self, context, event):
        if event.type == "ESC":
            for new in filter(None, self.done):
                discard(new)
            self.end(context)
            self.report({"INFO"}, "Baking was cancelled; nothing has changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        self.step(context)
        return self.finish(context) if len(self.done) == len(self.tasks) else {"RUNNING_MODAL"}

    def begin(self, context):
        self.folder = None
        if self.where == "FOLDER":
            if not self.directory:
                raise EncreError("there is no folder to save the images in; name one, or keep them in the file")
            if self.directory.startswith("//") and not bpy.data.filepath:
                raise EncreError(f"{self.directory}: is a folder beside the .blend file; save that first")
            self.folder = bpy.path.abspath(self.directory)
            try:
                os.makedirs(self.folder, exist_ok=True)
            except OSError as error:
                raise EncreError(f"{self.folder}: can't be made ({error.strerror}); "
                                       "choose another folder") from None
        self.tasks, self.done, self.values = tasks(context.selected_objects), [], settings(context)
        if not self.tasks:
            raise EncreError("no selected object shows a color image; give a material an image texture")

    def step(self, context):
        """Bakes the next image. One that can't be is left as it is."""
        wm, task, number = context.window_manager, self.tasks[len(self.done)], len(self.done)
        new = None
        try:
            pixels = draw(task, self.values, self.uniform, context.evaluated_depsgraph_get(),
                          lambda fraction: wm.progress_update(number + fraction))
            new = store(task.image, pixels, self.folder)
        except EncreError as error:
            self.report({"WARNING"}, str(error))
        self.done.append(new)

    def finish(self, context):
        for task, new in zip(self.tasks, self.done, strict=True):
            for node in task.nodes if new else ():
                node.image = new
        self.end(context)
        count = sum(new is not None for new in self.done)
        if not count:
            return {"CANCELLED"}
        self.report({"INFO"}, f"Lines are drawn into {count} new image{'s' * (count > 1)}")
        return {"FINISHED"}

    def end(self, context):
        context.window_manager.progress_end()
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)


class ENCRE_OT_fit_contrast(bpy.types.Operator):
    """Let the strongest contrast in the scene's image textures give a line of full width"""

    bl_idname = "encre.fit_contrast"
    bl_label = "Fit Contrast to Textures"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        values, greatest, name = settings(context), 0.0, ""
        for task in tasks(context.scene.objects):
            try:
                found = library.bake(read(task.image), values, linear=task.image.is_float,
                                  wrap=_tiles(task, None), draw=False).greatest
            except EncreError as error:
                self.report({"WARNING"}, str(error))
                continue
            if found > greatest:
                greatest, name = found, task.image.name
        if not greatest:
            self.report({"ERROR"}, "The scene shows no image with different colors; give a material an image texture")
            return {"CANCELLED"}
        context.scene.encre.contrast_full = greatest
        self.report({"INFO"}, f"Full Contrast is {greatest:.3f}, the strongest contrast in {name}")
        return {"FINISHED"}


class ENCRE_PT_textures(SidebarPanel, bpy.types.Panel):
    bl_label = "Inter-Color Lines"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context):
        draw_menu(self, _context)
        self.layout.operator("encre.fit_contrast")


def draw_menu(self, context):
    if context.engine == ENGINE:
        self.layout.operator("encre.bake")


_register, _unregister = bpy.utils.register_classes_factory((ENCRE_OT_bake, ENCRE_OT_fit_contrast, ENCRE_PT_textures))


def register():
    _register()
    bpy.types.VIEW3D_MT_object.append(draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(draw_menu)
    _unregister()
