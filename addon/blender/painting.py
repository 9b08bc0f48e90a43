# SPDX-License-Identifier: GPL-3.0-or-later
"""What is painted on meshes: each control is an attribute `encre_<control>`, as a color gray where it is neutral."""

import bpy
import numpy as np

from ..pen import colour
from ..pen.errors import EncreError
from . import versions
from .attributes import get

_COLORS = ("FLOAT_COLOR", "BYTE_COLOR")
_GREY = 128 / 255  # 8-bit mid grey is exactly neutral
STRENGTH = 0.15    # that a brush begins with: two strokes make lines twice as thick
BRUSHES = {"ADD": "ADD", "SUBTRACT": "SUB", "NEUTRAL": "MIX"}  # kind: how the brush blends mid grey


def attribute(mesh, control):
    """The mesh's colour attribute of a control, None where it has none."""
    return mesh.color_attributes.get(control.attribute)


def check(mesh, control):
    """EncreError: a control can't be painted on the mesh."""
    if mesh.library:
        raise EncreError(f"{mesh.name}: the mesh is linked and can't be painted; make it local, or set the object's "
                         "own value")
    if not mesh.polygons:
        raise EncreError(f"{mesh.name}: the mesh has no faces to paint on; choose another object")
    if attribute(mesh, control) is None and control.attribute in mesh.attributes:
        raise EncreError(f"{mesh.name}: its attribute {control.attribute} is not a color and can't be painted; remove "
                         "it under Object Data, Attributes")


def new(mesh, control):
    """The mesh's colour attribute of a control; made, and neutral, where it is missing. EncreError: it can't be."""
    check(mesh, control)
    found = attribute(mesh, control)
    if found is None:
        found = mesh.color_attributes.new(control.attribute, "BYTE_COLOR", "CORNER")
        _write(found, slice(None), 0.0)
    return found


def fill(obj, control, value, selected):
    """Gives a control of a mesh one value: everywhere, or where it is selected or the mask of Vertex Paint lets it. The
    mesh is not in Edit Mode. Returns how many points or corners got it. EncreError: it can't be."""
    mesh = obj.data
    where = _where(mesh, selected)
    if where is not None and not where.any():
        return 0
    found = new(mesh, control)
    if where is None:
        where = np.ones(len(found.data), bool)
    elif found.domain == "POINT":
        vertices = np.zeros(len(mesh.vertices), bool)
        vertices[get(mesh.loops, "vertex_index", np.int32)[where]] = True
        where = vertices
    _write(found, where, value)
    mesh.update_tag()
    return int(where.sum())


def remove(mesh, control):
    """Takes a control off a mesh. Whether it was there."""
    found = mesh.attributes.get(control.attribute)
    if found is None or mesh.library:
        return False
    mesh.attributes.remove(found)
    mesh.update_tag()
    return True


def _where(mesh, selected):
    """Which corners, (corners,) of bool; None: all. selected: by faces, or by vertices where no face is."""
    if not (selected or mesh.use_paint_mask or mesh.use_paint_mask_vertex):
        return None
    faces = get(mesh.polygons, "select", bool)
    if mesh.use_paint_mask_vertex or (selected and not faces.any()):
        return get(mesh.vertices, "select", bool)[get(mesh.loops, "vertex_index", np.int32)]
    return np.repeat(faces, get(mesh.polygons, "loop_total", np.int32))  # corners are in the order of the faces


def _write(found, where, value):
    grey = colour.decode_srgb((value + 1) / 2 if value else _GREY)
    values = get(found.data, "color", np.float32, 4)
    values[where] = grey, grey, grey, 1
    found.data.foreach_set("color", values.ravel())


# The brush of Vertex Paint

def _owners():
    """(who has its colour, who its strength, the brush); the brush is None where Blender has none."""
    settings = bpy.context.tool_settings
    paint = settings.vertex_paint
    brush = paint and paint.brush
    unified = getattr(paint, "unified_paint_settings", None) or settings.unified_paint_settings
    return unified if unified.use_unified_color else brush, unified if unified.use_unified_strength else brush, brush


def strength_owner():
    """What has the strength of the brush, None without a brush."""
    _, owner, brush = _owners()
    return brush and owner


def brush_kind():
    """The key of BRUSHES that the brush is now, None: something else."""
    color, _, brush = _owners()
    if brush is None or not np.allclose(color.color, _brush_grey(), atol=1e-3):
        return None
    return next((kind for kind, blend in BRUSHES.items() if brush.blend == blend), None)


def set_brush(kind, strength=None):
    """What a stroke does to a control: at full strength ADD and SUBTRACT change it by 1, NEUTRAL wipes it. In Vertex
    Paint only; a brush is made where there is none."""
    if _owners()[2] is None:
        _make_brush()
    color, owner, brush = _owners()
    brush.blend = BRUSHES[kind]
    color.color = (_brush_grey(),) * 3  # bytes are blended as they are encoded: half of white is a step of 1
    if strength is not None:
        owner.strength = strength


def _make_brush():
    """Builds from 4.3 on that come without Blender's assets, as Debian's do, have no brush at all."""
    made = bpy.data.brushes.new("Encre", mode="VERTEX_PAINT")
    if "asset_activate" in dir(bpy.ops.brush):  # brushes are assets, and one that is none does not last
        made.asset_mark()
        bpy.ops.brush.asset_activate(asset_library_type="LOCAL", relative_asset_identifier=f"Brush/{made.name}")
    else:
        bpy.context.tool_settings.vertex_paint.brush = made


def _brush_grey():
    return colour.decode_srgb(_GREY) if versions.LINEAR_BRUSH else _GREY
