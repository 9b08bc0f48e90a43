# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own Line Art, whatever Grease Pencil this Blender has."""

import bpy
import numpy as np

# 4.3 made Grease Pencil anew: other data blocks, modifiers like those of meshes, drawings with attributes.
NEW_PENCIL = "LINEART" in bpy.types.Modifier.bl_rna.properties["type"].enum_items


def line_art(scene):
    """A new Grease Pencil object with Line Art of the whole scene; None: this Blender has none."""
    blocks = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)  # both names in 4.3 to 4.5
    pencil = blocks.new("Line Art")
    layer = pencil.layers.new("Lines")
    layer.frames.new(scene.frame_current)
    ink = bpy.data.materials.new("Line Art")
    if not ink.grease_pencil:
        bpy.data.materials.create_gpencil_data(ink)
    pencil.materials.append(ink)
    obj = bpy.data.objects.new("Line Art", pencil)
    scene.collection.objects.link(obj)
    try:
        modifier = (obj.modifiers.new("Line Art", "LINEART") if NEW_PENCIL
                    else obj.grease_pencil_modifiers.new("Line Art", "GP_LINEART"))
    except (AttributeError, TypeError):
        bpy.data.objects.remove(obj)
        return None
    modifier.source_type, modifier.target_material = "SCENE", ink
    modifier.target_layer = layer.name if NEW_PENCIL else layer.info
    return obj


def strokes(obj):
    """The strokes of an evaluated Grease Pencil object, each its points (n, 3) in world space."""
    world = np.array(obj.matrix_world)
    found = []
    for layer in obj.data.layers:
        for frame in layer.frames:
            for stroke in frame.drawing.strokes if NEW_PENCIL else frame.strokes:
                points = np.array([point.position if NEW_PENCIL else point.co for point in stroke.points])
                found.append(points @ world[:3, :3].T + world[:3, 3])
    return [points for points in found if len(points) > 1]
