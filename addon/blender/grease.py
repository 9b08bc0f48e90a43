# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines to Grease Pencil: the strokes of the picture as an object that can be edited, in a plane before the camera.

It is drawn once more for that, from the layers in memory where they are there, else by a render.
"""

import bpy
import numpy as np
from mathutils import Matrix

from ..pen import library, plane
from ..pen.errors import EncreError
from . import memory, properties, redraw, versions, wanted

_BEFORE = 2  # times as far as the camera's clip start lies the plane, at least


def _material(name, ink):
    """A material of strokes of this name and ink; one that is there already serves again."""
    known = bpy.data.materials.get(name)
    if known and known.grease_pencil and np.allclose(known.grease_pencil.color[:3], ink, atol=1e-3):
        return known
    made = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(made)
    made.grease_pencil.color = (*ink, 1)
    return made


def _object(told, scene):
    """(the object of Grease Pencil of some wanted.Strokes, how many there are)."""
    eye = np.linalg.inv(told.view)
    distance = max(_BEFORE * scene.camera.data.clip_start, 1.0)
    lines = plane.strokes(told.points, told.projection, told.frame, distance)
    inks = plane.inks(lines)
    names, labels = list(library.load().lines), list(library.load().lines.values())
    data, draw = versions.new_strokes("Lines", scene.frame_current)
    slots = {}
    for kind in reversed(range(len(names))):  # outlines over all others
        mine = [line for line in lines if line.kind == kind]
        if not mine:
            continue
        numbers = []
        for line in mine:
            thing = told.called.get(line.object, "") or "Lines"
            key = thing, inks[kind, line.object]
            if key not in slots:
                slots[key] = len(slots)
                data.materials.append(_material(f"{thing} Ink", key[1]))
            numbers.append(slots[key])
        draw(labels[kind], mine, numbers)
    made = bpy.data.objects.new("Lines", data)
    made.matrix_world = Matrix(eye.tolist())
    made.show_in_front = True
    return made, len(lines)


class ENCRE_OT_lines_to_grease_pencil(bpy.types.Operator):
    """Turn the lines of this frame into Grease Pencil strokes that you can edit, in front of the camera"""

    bl_idname = "encre.lines_to_grease_pencil"
    bl_label = "Lines to Grease Pencil"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.scene.render.engine == "ENCRE" and not bpy.app.is_job_running("RENDER")

    def execute(self, context):
        scene = context.scene
        try:
            told = drawn(scene)
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        count = 0
        for one in context.view_layer.objects:
            one.select_set(False)
        for each in told:
            made, lines = _object(each, scene)
            count += lines
            scene.collection.objects.link(made)
            made.select_set(True)
            context.view_layer.objects.active = made
        self.report({"INFO"}, f"{count} strokes")
        return {"FINISHED"}


def drawn(scene):
    """The wanted.Strokes of the picture of a scene's frame. EncreError: it has none, or can't be drawn."""
    from .engine import pass_names

    settings = properties.settings(scene)
    if not scene.camera:
        raise EncreError("the scene has no camera: add one and make it the scene's")
    if not settings.any("use_lines"):
        raise EncreError("Lines: they are off; switch them on")
    if settings.every[0]["edge_detector"] != "FINE":
        raise EncreError("Detector: only Fine draws lines as strokes; choose it in Detectors of the Theses")
    kept = not memory.refusal(scene, pass_names)
    if kept and any(layer.opened for layer in memory.picture(scene).layers.values()):
        raise EncreError("the picture in memory comes from a file; render this frame first")
    if not kept and not settings.fast and not bpy.app.background:
        raise EncreError("the picture is not in memory; render it first (F12)")
    wanted.strokes = []
    try:
        redraw.at_once(kept)
        told = [one for one in wanted.strokes if len(one.points)]
    except RuntimeError as error:  # what the engine reports
        raise EncreError(str(error).removeprefix("Error: ").strip()) from None
    finally:
        wanted.strokes = None
    if not told:
        raise EncreError("no line was drawn in this frame; switch kinds of line on in the panel Lines")
    return told


def _in_menu(menu, context):
    if context.scene.render.engine == "ENCRE":
        menu.layout.separator()
        menu.layout.operator(ENCRE_OT_lines_to_grease_pencil.bl_idname, icon="GREASEPENCIL")


def register():
    bpy.utils.register_class(ENCRE_OT_lines_to_grease_pencil)
    bpy.types.TOPBAR_MT_render.append(_in_menu)


def unregister():
    bpy.types.TOPBAR_MT_render.remove(_in_menu)
    bpy.utils.unregister_class(ENCRE_OT_lines_to_grease_pencil)
