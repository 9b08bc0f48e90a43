# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences about what a scene has that only a renderer can show."""

from . import trees

_THINGS = {"POINTCLOUD": "a point cloud", "VOLUME": "a volume"}
BEHIND = "what is behind it"  # of what light goes through
_CURE = "choose Cycles for Layers to see them"
# Inputs of shaders, and of a material's output.
_TURNED = ("Normal", "Coat Normal", "Clearcoat Normal")
_OUTPUTS = {"Displacement": "its displacement", "Volume": "its volume"}


def of_materials(looks, names):
    """Of the materials whose full names are given, those of the materials.Looks that show more in Cycles."""
    lost = [f"{name} ({', '.join(looks.lost[name])})" for name in names if looks.lost.get(name)]
    return [f"materials that show more in Cycles: {', '.join(lost)}; {_CURE}"] if lost else []


def of_things(depsgraph, visible=None):
    """Of what the camera would see; visible: as meshes.extract() takes it."""
    found = {}  # in the order in which they come, each once
    for instance in depsgraph.object_instances:
        obj = instance.object
        top = instance.parent if instance.is_instance else obj
        if not obj.visible_camera or visible and not visible(top.original):
            continue
        if obj.type in _THINGS and instance.show_self:
            found[f"{obj.name} ({_THINGS[obj.type]})"] = None
    return [f"not shown, as only Cycles can show it: {', '.join(found)}; {_CURE}"] if found else []


def turned(node):
    """[(input, its source)] of what a shader is told of its surface's normal."""
    return [(socket, source) for socket in node.inputs
            if socket.name in _TURNED and (source := trees.source_of(socket))]


def of_output(node):
    """What is linked to a material's output beside its surface."""
    return [words for name, words in _OUTPUTS.items() if trees.source_of(node.inputs[name])]
