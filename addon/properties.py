# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings as Blender properties, made from the library's parameter table."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import core


class EncreLevel(bpy.types.PropertyGroup):
    intensity: FloatProperty(name="Intensity", default=1, min=0)
    threshold: FloatProperty(name="Threshold", default=0.5, min=0)
    transition: FloatProperty(name="Transition", default=0.025, min=0)
    color: FloatVectorProperty(name="Color", subtype="COLOR", default=(1, 1, 1), min=0)


def _property(param):
    text = {"name": param.label, "description": param.help}
    limits = {"soft_min": param.soft_min, "soft_max": param.soft_max}
    for side, limit in (("min", param.hard_min), ("max", param.hard_max)):
        if limit is not None:
            limits[side] = limit
    if param.type == "bool":
        return BoolProperty(default=param.default, **text)
    if param.type == "int":
        return IntProperty(default=param.default, **{k: int(v) for k, v in limits.items()}, **text)
    if param.type == "float":
        return FloatProperty(default=param.default, **limits, **text)
    if param.type == "enum":
        items = [(i.id, i.label, i.help, i.number) for i in param.items]
        return EnumProperty(items=items, default=param.default, **text)
    if param.type == "color":
        return FloatVectorProperty(subtype="COLOR", default=param.default, min=0, **text)
    if param.type == "image":
        return StringProperty(subtype="FILE_PATH", **text)
    return CollectionProperty(type=EncreLevel, **text)


class EncreControls(bpy.types.PropertyGroup):
    """What an object or a material adds to the painted controls."""

    __annotations__ = {name: FloatProperty(name=name.replace("_", " ").title(), min=-1, max=1)
                       for name in core.CONTROLS}
    __annotations__["line_group"] = StringProperty(
        name="Line Group", description="Objects of one group have no outline between them")


def _value(settings, param):
    value = getattr(settings, param.id)
    if param.type == "color":
        return tuple(value)
    if param.type == "image":
        return bpy.path.abspath(value) if value else None
    if param.type == "levels":
        levels = [(v.intensity, v.threshold, v.transition, *v.color) for v in value]
        return [levels[0][:1], *levels[1:]] if levels else param.default
    return value


def scene_values(scene):
    """{id: value} of the scene's parameters."""
    return core.check({name: _value(scene.encre, param) for name, param in core.params().items()})


def styles(scene):
    """(name, what it changes) of each style, in the order of their numbers."""
    return []


def style_number(block, scene):
    """The number of the style that an object or a material names, 0 for the scene's."""
    return 0


def controls(block):
    """The six control values of an object or a material."""
    return tuple(getattr(block.encre, name) for name in core.CONTROLS)


_classes = []


def register():
    settings = type("EncreScene", (bpy.types.PropertyGroup,), {
        "__annotations__": {name: _property(param) for name, param in core.params().items()}})
    _classes[:] = EncreLevel, settings, EncreControls
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.Scene.encre = PointerProperty(type=settings)
    bpy.types.Object.encre = PointerProperty(type=EncreControls)
    bpy.types.Material.encre = PointerProperty(type=EncreControls)


def unregister():
    for owner in (bpy.types.Scene, bpy.types.Object, bpy.types.Material):
        del owner.encre
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
