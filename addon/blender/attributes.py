# SPDX-License-Identifier: GPL-3.0-or-later
"""What programs of materials read of meshes: coordinates and attributes, at the corners of triangles."""

import numpy as np

from ..pen.tangents import tangents
from . import versions


def get(collection, name, dtype, width=1):
    """A property of all items, (n,) or (n, width)."""
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def read(mesh, wanted, points, loops, corners, face):
    """{(kind, name): (t, 3, 3)} of those wanted that the mesh has."""
    found = {}
    for kind, name in wanted:
        if kind == "object":
            found[kind, name] = points[corners]
        elif kind == "generated":
            found[kind, name] = _generated(mesh)[corners]
        elif kind == "facing":
            found[kind, name] = _facing(points[corners])
        elif kind == "tangent":
            if (values := _tangents(mesh, name, points, loops, corners, face)) is not None:
                found[kind, name] = values
        elif kind == "uv":
            if (values := _uv(mesh, name, loops, corners, face)) is not None:
                found[kind, name] = np.broadcast_to(values, (len(loops), 3, 3))
        elif kind != "light":  # which comes later
            values = _attribute(mesh, name, loops, corners, face)
            if values is not None:
                if kind == "fac" and mesh.attributes[name].data_type == "FLOAT2":
                    values = values * np.float32(1.5)  # the mean of two
                found[kind, name] = np.broadcast_to(_KINDS[kind](values), (len(loops), 3, 3))
            elif kind == "opaque":
                found[kind, name] = np.ones((len(loops), 3, 3), np.float32)
    return found


# What programs read of an attribute (..., 4): a colour or vector, how opaque it is (where there is none: 0 or 1), and
# what it is as a number.
_KINDS = {"color": lambda values: values[..., :3], "alpha": lambda values: values[..., 3:],
          "opaque": lambda values: values[..., 3:], "fac": lambda values: values[..., :3].mean(-1, keepdims=True)}


def _facing(places):
    """(t, 3, 3): the normal of each triangle, of unit length, in its own space."""
    across = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return (across / np.where(length > 0, length, 1)).astype(np.float32)[:, None].repeat(3, 1)


def _uv(mesh, name, loops, corners, face):
    """A map that is named may be any attribute, as nodes leave them."""
    layer = mesh.uv_layers.get(name) if name else next((u for u in mesh.uv_layers if u.active_render), None)
    if layer:
        return _three(get(layer.data, "uv", np.float32, 2))[loops]
    values = _attribute(mesh, name, loops, corners, face) if name else None
    return None if values is None else values[..., :3]


MIRRORED = 4  # how long tangents are where the UV map is mirrored


def _tangents(mesh, name, points, loops, corners, face):
    """(t, 3, 3): where U grows, as normal maps are made for."""
    layer = mesh.uv_layers.get(name) if name else next((u for u in mesh.uv_layers if u.active_render), None)
    if layer is None:
        return None
    if get(mesh.polygons, "loop_total", np.int32).max() > 4:  # of such a mesh Blender knows none
        normals = versions.corner_normals(mesh)
        normals = (get(mesh.polygons, "normal", np.float32, 3)[face][:, None].repeat(3, 1) if normals is None
                   else normals[loops])
        along, mirrored = tangents(points[corners], normals, get(layer.data, "uv", np.float32, 2)[loops], corners)
        mirrored = mirrored[:, None]
    else:
        mesh.calc_tangents(uvmap=layer.name)
        along = get(mesh.loops, "tangent", np.float32, 3)[loops]
        mirrored = get(mesh.loops, "bitangent_sign", np.float32)[loops] < 0
    return along * np.where(mirrored, np.float32(MIRRORED), np.float32(1))[..., None]


def _attribute(mesh, name, loops, corners, face):
    """(t, 3 or 1, 4) of an attribute, None: there is none that programs can read."""
    layer = mesh.attributes.get(name) if name else mesh.color_attributes.active_color
    values = None if layer is None or not len(layer.data) else _values(layer)
    if values is None:
        return None
    if layer.domain == "EDGE":
        values, domain = _of_edges(mesh, values), "POINT"
    else:
        domain = layer.domain
    where = {"POINT": corners, "CORNER": loops, "FACE": face[:, None]}.get(domain)
    return None if where is None else values[where]


def _of_edges(mesh, values):
    """What points have of their edges: the mean."""
    ends = get(mesh.edges, "vertices", np.int32, 2).reshape(-1)
    count = np.bincount(ends, minlength=len(mesh.vertices))
    sums = np.stack([np.bincount(ends, np.repeat(values[:, c], 2), len(mesh.vertices)) for c in range(4)], 1)
    return (sums / np.maximum(count, 1)[:, None]).astype(np.float32)


def _three(values):
    """(n, 3) of (n, 1 to 4) values."""
    out = np.zeros((len(values), 3), np.float32)
    out[:, :values.shape[1]] = values[:, :3]
    return out


def _values(attribute):
    """(n, 4) of an attribute, None if programs can't read it. Byte colours come linear; numbers are grey, and what has
    no alpha is opaque."""
    kind = attribute.data_type
    if kind in ("FLOAT_COLOR", "BYTE_COLOR"):
        return get(attribute.data, "color", np.float32, 4)
    out = np.ones((len(attribute.data), 4), np.float32)
    numbers = {"FLOAT": np.float32, "INT": np.int32, "INT8": np.int32, "BOOLEAN": bool}
    if kind in numbers:
        out[:, :3] = get(attribute.data, "value", numbers[kind])[:, None]
    elif kind == "QUATERNION":
        return get(attribute.data, "value", np.float32, 4)
    elif kind in ("FLOAT_VECTOR", "FLOAT2"):
        out[:, :3] = _three(get(attribute.data, "vector", np.float32, 3 if kind == "FLOAT_VECTOR" else 2))
    else:
        return None
    return out


def _generated(mesh):
    """0 to 1 across the texture space of the mesh, of where its points are before modifiers deform it, as far as
    Blender keeps that: in renders."""
    points = get(mesh.vertices, "undeformed_co", np.float32, 3)
    size, middle = (np.array(value, np.float32) for value in (mesh.texspace_size, mesh.texspace_location))
    return (points - middle) / np.where(size != 0, 2 * size, 1) + np.float32(0.5)


def by_slot(sources, slot, layouts):
    """(t, 3, channels) of what read() gave: of each triangle in the order in which its slot's program reads it."""
    if len(layouts) == 1:
        zero = np.zeros((len(slot), 3, 3), np.float32)
        return np.concatenate([sources.get(source, zero) for source in layouts[0]], 2)
    out = np.zeros((len(slot), 3, 3 * max(map(len, layouts))), np.float32)
    for k, layout in enumerate(layouts):
        here = np.flatnonzero(slot == k)
        for n, source in enumerate(layout):
            if len(here) and source in sources:
                out[here, :, 3 * n:3 * n + 3] = sources[source][here]
    return out
