# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines to Grease Pencil: what is made of a picture, seen through its camera."""

import bpy
import numpy as np
from mathutils import Vector
from studio import fact, shoot, stage


def _strokes(obj):
    """{layer: [(places in the world (n, 3), radii in it (n,), opacity (n,), material's name, closed)]}"""
    found = {}
    for layer in obj.data.layers:
        frame, mine = layer.frames[0], []
        shown = frame.drawing.strokes if hasattr(frame, "drawing") else frame.strokes
        for stroke in shown:
            points = list(stroke.points)
            if hasattr(frame, "drawing"):
                places, closed = [p.position for p in points], stroke.cyclic
                radii, opacity = [p.radius for p in points], [p.opacity for p in points]
            else:
                places, closed = [p.co for p in points], stroke.use_cyclic
                radii = [p.pressure * stroke.line_width / 2000 for p in points]
                opacity = [p.strength for p in points]
            mine.append(([obj.matrix_world @ Vector(place) for place in places], radii, opacity,
                         obj.data.materials[stroke.material_index].name, closed))
        found[layer.name if hasattr(layer, "name") else layer.info] = mine
    return found


def _reached(scene, found, size):
    """How far each pixel's centre lies outside of the strokes, as the camera sees them, in pixels."""
    width, height = size
    matrix = scene.camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=width, y=height)
    view = scene.camera.matrix_world.normalized().inverted()
    y, x = np.mgrid[:height, :width]
    least = np.full((height, width), 1e9)

    def place(point):
        at = matrix @ (view @ point).to_4d()
        return (at.x / at.w + 1) / 2 * width - 0.5, (1 - at.y / at.w) / 2 * height - 0.5, at.w

    for strokes in found.values():
        for points, radii, _, _, closed in strokes:
            at = [place(point) for point in points]
            wide = [r * matrix[1][1] * height / 2 / w for r, (_, _, w) in zip(radii, at, strict=True)]
            links = [(k, k + 1) for k in range(len(at) - 1)] or [(0, 0)]
            for a, b in [*links, *([(len(at) - 1, 0)] if closed else [])]:
                dx, dy = at[b][0] - at[a][0], at[b][1] - at[a][1]
                t = np.clip(((x - at[a][0]) * dx + (y - at[a][1]) * dy) / max(dx * dx + dy * dy, 1e-9), 0, 1)
                far = np.hypot(x - at[a][0] - t * dx, y - at[a][1] - t * dy) - (wide[a] + t * (wide[b] - wide[a]))
                np.minimum(least, far, out=least)
    return least


def grease(out):
    """A picture's lines and strokes, of Encre's layers and of Cycles', by a turned camera; then again, with one undo;
    then where there are none."""
    size = 240, 136
    scene = stage(*size, 1)
    scene.encre.line_thickness, scene.encre.layer_source = 24, "ENCRE"
    scene.encre.line_crease_ink, scene.encre.ink_by_kind = (0, 0, 1), True
    scene.camera.rotation_euler[1] = 0.2
    scene.camera.scale = (2, 2, 2)
    scene.camera.data.shift_x = 0.05
    for source in "ENCRE", "CYCLES":
        scene.encre.layer_source = source
        fact("failed", shoot(out, source))
        fact("result", list(bpy.ops.encre.lines_to_grease_pencil()))
        obj = bpy.context.view_layer.objects.active
        found = _strokes(obj)
        np.save(f"{out}/{source}.npy", _reached(scene, found, size))
        fact("layers", {name: len(strokes) for name, strokes in found.items()})
        fact("materials", {material.name: list(material.grease_pencil.color[:3]) for material in obj.data.materials})
        fact("named", {name: sorted({stroke[3] for stroke in strokes}) for name, strokes in found.items()})
        fact("type", [obj.type, obj.name, obj.select_get()])
        bpy.data.objects.remove(obj)
    scene.encre.layer_source = "ENCRE"
    messages = []
    for change in ({"use_lines": False}, {"line_thickness": 0.0}, {"edge_detector": "DOG"}):
        before = {name: getattr(scene.encre, name) for name in change}
        for values in (change, before):
            for name, value in values.items():
                setattr(scene.encre, name, value)
            if values is change:
                try:
                    messages.append(str(list(bpy.ops.encre.lines_to_grease_pencil())))
                except RuntimeError as error:
                    messages.append(str(error))
    scene.camera = None
    try:
        bpy.ops.encre.lines_to_grease_pencil()
    except RuntimeError as error:
        messages.append(str(error))
    fact("refused", messages)
    fact("left", sorted(obj.name for obj in bpy.data.objects))
