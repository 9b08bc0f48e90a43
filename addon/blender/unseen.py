# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences about what a scene has that only a renderer can show."""

import bpy
import numpy as np

from . import trees, versions

_THINGS = {"POINTCLOUD": "a point cloud", "VOLUME": "a volume"}
BEHIND = "what is behind it"  # of what light goes through
_CURE = "choose Full for Render to see them"
# Inputs of shaders, and of a material's output.
_TURNED = ("Normal", "Coat Normal", "Clearcoat Normal")
_OUTPUTS = {"Displacement": "its displacement", "Volume": "its volume"}


def of_materials(looks, names):
    """Of the materials whose full names are given, those of the materials.Looks that show more in Cycles."""
    lost = [f"{name} ({', '.join(looks.lost[name])})" for name in names if looks.lost.get(name)]
    return [f"materials that show more in Cycles: {', '.join(lost)}; {_CURE}"] if lost else []


def by_cycles(depsgraph):
    """What Cycles draws otherwise than whoever made it for EEVEE meant it, of evaluated materials."""
    found = [block.name for block in depsgraph.ids if isinstance(block, bpy.types.Material)
             and any(node.bl_idname == "ShaderNodeShaderToRGB" for node in trees.nodes_of(block))]
    return [f"Cycles knows no Shader to RGB, and draws without it: {', '.join(found)}; choose Fast for Render to see "
            "them as in EEVEE"] if found else []


_FAR = 1 / 4  # of a pixel: by so much places that Blender can hold may be apart


def far_away(view, projection, distance, height):
    """Where the camera is so far from the origin that single precision is coarse in the picture of something at this
    distance. view, projection: as cameras.views() gives them; height: of the frame, in pixels."""
    eye = np.abs(view[:3, :3].T @ view[:3, 3]).max()
    wide = 1.0 if projection[3, 3] == 1 else distance
    step = eye * 2.0 ** -23 * projection[1, 1] * height / 2
    if wide <= 0 or step <= _FAR * wide:
        return []
    return [f"the camera is more than {10 ** int(np.log10(eye)):,} units from the origin, where Blender's numbers are "
            "coarse beside a pixel: lines and surfaces may break; move the scene to the origin"]


def of_things(depsgraph, visible=None):
    """Of what the camera would see; visible: as meshes.extract() takes it."""
    found, divided = {}, {}  # in the order in which they come, each once; of a tree there may be 100,000
    for instance in depsgraph.object_instances:
        obj = instance.object
        top = instance.parent if instance.is_instance else obj
        if not obj.visible_camera or visible and not visible(top.original):
            continue
        if obj.type in _THINGS and instance.show_self:
            found[f"{obj.name} ({_THINGS[obj.type]})"] = None
        elif (name := obj.name) not in divided:
            divided[name] = versions.divides(obj, depsgraph)
    coarse = [name for name, divides in divided.items() if divides]
    said = [f"not shown, as only Cycles can show it: {', '.join(found)}; {_CURE}"] if found else []
    return said + ([f"drawn with the faces of their coarse mesh: {', '.join(coarse)}; switch off Adaptive Subdivision "
                    "of their modifiers, or choose Full for Render"] if coarse else [])


def turned(node):
    """[(input, its source)] of what a shader is told of its surface's normal."""
    return [(socket, source) for socket in node.inputs
            if socket.name in _TURNED and (source := trees.source_of(socket))]


def of_output(node):
    """What is linked to a material's output beside its surface."""
    return [words for name, words in _OUTPUTS.items() if trees.source_of(node.inputs[name])]
