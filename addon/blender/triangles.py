# SPDX-License-Identifier: GPL-3.0-or-later
"""One evaluated object -> its triangles, with all that lies on them: slots of materials, painted controls, parts, kinds
of creases, marked edges, normals, UV maps."""

import functools
import hashlib
from dataclasses import dataclass, field

import numpy as np

from ..pen import colour, library, unwrap
from ..pen.errors import EncreError
from ..pen.job import EDGES, edge_kinds
from ..pen.ribbons import Ribbons
from . import attributes, versions
from .attributes import get

MESHABLE = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


@dataclass
class Triangles:
    points: np.ndarray
    corners: np.ndarray
    material: np.ndarray | None  # slot of each triangle, None: all 0
    painted: np.ndarray | None   # (triangles, 3, controls)
    part: np.ndarray | None      # part of each triangle, 0 to n_parts - 1; None: there is one
    n_parts: int
    marked: np.ndarray           # (edges, 2) points of the edges that are marked by hand
    edges: np.ndarray | None     # (triangles,) as Mesh.edges
    normals: np.ndarray | None   # (triangles, 3, 3) at the corners; None: flat, or nobody asks
    uvs: dict                    # name of a UV map that light asks for -> (triangles, 3, 2) at the corners
    sources: dict                # what programs of materials read -> (triangles, 3, 3) at the corners; absent: 0
    rest: np.ndarray | None      # (triangles, 3, 3) rest positions at the corners; None: the points, or nobody asks
    rest_normals: np.ndarray | None  # likewise; None: flat
    uv: np.ndarray | None        # (triangles, 3, 2) at the corners, of the map that renders use; None: nobody asks
    ribbons: Ribbons | None = None  # of strands: what the camera sees instead
    shown: dict = field(default_factory=dict)  # what attributes.by_slot() made of them, by the layouts

    @functools.cached_property
    def shape(self):
        """What is equal, but for chance, of those on which light falls alike."""
        digest = hashlib.blake2b(digest_size=16)
        parts = {name: getattr(self, name) for name in ("points", "corners", "normals", "material")}
        for name, array in (parts | self.uvs).items():
            digest.update(repr((name, None if array is None else array.shape)).encode())
            if array is not None:
                digest.update(np.ascontiguousarray(array))
        return digest.digest()


def read_triangles(obj, light, maps, sources, anchored, unwrapped, facets):
    """The triangles of an evaluated object, None if it has none. light: whether light is to fall on them; maps: the UV
    maps that are read, "" = the one that renders use; sources: what programs of materials read; anchored: whether to
    tell where they rest; unwrapped: which way their UV map lies; facets: below how many degrees they have normals of
    one smooth surface."""
    try:
        mesh = obj.to_mesh()
    except RuntimeError:  # no geometry
        return None
    if mesh is None:
        return None
    try:
        bent = anchored and _may_be_bent(obj)
        return (_of_mesh(mesh, obj.encre.separate_parts, light, maps, sources, anchored, unwrapped, bent, facets)
                if len(mesh.polygons) else None)
    finally:
        obj.to_mesh_clear()


def read_lines(obj):
    """(points, edges (n, 2)) of an evaluated object that has edges and no faces, None of any other."""
    try:
        mesh = obj.to_mesh()
    except RuntimeError:  # no geometry
        return None
    try:
        if mesh is None or len(mesh.polygons) or not len(mesh.edges):
            return None
        return get(mesh.vertices, "co", np.float32, 3), get(mesh.edges, "vertices", np.int32, 2)
    finally:
        obj.to_mesh_clear()


def _may_be_bent(obj):
    """Whether the evaluated mesh of an object may have another shape than at rest."""
    keys = getattr(obj.original.data, "shape_keys", None)  # of meshes that metaballs, curves and texts became: none
    return obj.type == "MESH" and bool(obj.modifiers or keys or obj.parent_type in ("ARMATURE", "LATTICE"))


def _of_mesh(mesh, separate, light, maps, sources, anchored, unwrapped, bent, facets):
    position = mesh.attributes.get("position")
    points = (get(position.data, "vector", np.float32, 3) if position
              else get(mesh.vertices, "co", np.float32, 3))
    corner_vertex = mesh.attributes.get(".corner_vert")  # many times faster than the loops, where it is there
    vertex = (get(corner_vertex.data, "value", np.int32) if corner_vertex
              else get(mesh.loops, "vertex_index", np.int32))
    loops, face = _triangulate(mesh, points, vertex)
    material = mesh.attributes.get("material_index")
    if material is not None and material.domain == "FACE" and len(material.data):
        material = get(material.data, "value", np.int32)[face]
        material = material if material.any() else None
    else:
        material = None
    corners = vertex[loops]
    part, n_parts = _parts(mesh, corners, face, separate)
    marked = versions.marked_edges(mesh)
    normals = versions.corner_normals(mesh) if light or anchored else None
    normals = None if normals is None else normals[loops]
    rest = _rest(mesh, points, loops, corners, bent) if anchored else None
    rest_normals = normals if rest is None else _smooth(mesh, rest, corners, face)
    if light and facets > 0 and (mesh.has_custom_normals or not get(mesh.polygons, "use_smooth", bool).all()):
        normals = library.load().smooth(points, corners, normals, facets)
    uvs = _uvs(mesh, "") if unwrapped else None
    return Triangles(points, corners, material, _painted(mesh, loops, corners, face), part, n_parts,
                      np.empty((0, 2), np.int32) if marked is None or not marked.any()
                      else get(mesh.edges, "vertices", np.int32, 2)[marked], _edges(mesh, loops, face),
                      normals if light else None,
                      {name: uvs[loops] for name in maps if (uvs := _uvs(mesh, name)) is not None},
                      attributes.read(mesh, sources, points, loops, corners, face), rest,
                      rest_normals if anchored else None, None if uvs is None else uvs[loops])


# Rest

ANCHOR = "encre_anchor"  # a vector attribute of points or corners: where the surface rests


def _rest(mesh, points, loops, corners, bent):
    """Rest positions at the triangles' corners, (t, 3, 3); None: the surface is at rest."""
    pinned = mesh.attributes.get(ANCHOR)
    if pinned is not None and pinned.data_type == "FLOAT_VECTOR" and pinned.domain in ("POINT", "CORNER"):
        return get(pinned.data, "vector", np.float32, 3)[corners if pinned.domain == "POINT" else loops]
    if not bent:
        return None
    # What textures by generated coordinates stick to: modifiers that deform, and shape keys, have not moved it. For
    # the viewport Blender does not keep it, and gives the position as it is.
    rest = get(mesh.vertices, "undeformed_co", np.float32, 3)
    return None if np.array_equal(rest, points) else rest[corners]


def _smooth(mesh, rest, corners, face):
    """Normals of the resting surface, (t, 3, 3) at the corners: means of the faces about a point that are shaded
    smoothly; 0 at flat ones. None: all are."""
    smooth = get(mesh.polygons, "use_smooth", bool)[face]
    if not smooth.any():
        return None
    across = np.cross(rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]) * smooth[:, None]
    count, spread = len(mesh.vertices), np.repeat(across, 3, 0)
    sums = np.stack([np.bincount(corners.reshape(-1), spread[:, c], count) for c in range(3)], 1)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return ((sums / np.maximum(length, 1e-30))[corners] * smooth[:, None, None]).astype(np.float32)


def _uvs(mesh, name):
    """By corners (n, 2), of the UV map of this name, "" = the one that renders use; None: it is not there."""
    layer = mesh.uv_layers.get(name) if name else next((u for u in mesh.uv_layers if u.active_render), None)
    return layer and get(layer.data, "uv", np.float32, 2)


def _triangulate(mesh, points, vertex):
    """(corners of each triangle (t, 3), face of each (t,)), as Blender, and so Cycles, cuts the faces."""
    start, total = get(mesh.polygons, "loop_start", np.int32), get(mesh.polygons, "loop_total", np.int32)
    if total.max() > 4:
        mesh.calc_loop_triangles()
        return (get(mesh.loop_triangles, "loops", np.int32, 3),
                get(mesh.loop_triangles, "polygon_index", np.int32))
    faces = np.arange(len(total), dtype=np.int32)
    triangle, quad = faces[total == 3], faces[total == 4]
    four = start[quad][:, None] + np.arange(4, dtype=np.int32)
    a, b, c, d = points[vertex[four]].transpose(1, 0, 2)
    # A quad folded about its first diagonal, or concave there, is cut along the second.
    flip = np.einsum("ij,ij->i", np.cross(b - a, c - a), np.cross(d - a, c - a)) > 0
    cut = np.where(flip[:, None], [[0, 1, 3, 1, 2, 3]], [[0, 1, 2, 0, 2, 3]])
    halves = np.take_along_axis(four, cut, 1).reshape(-1, 3)
    loops = np.concatenate([start[triangle][:, None] + np.arange(3, dtype=np.int32), halves])
    return loops, np.concatenate([triangle, np.repeat(quad, 2)])


# Creases

NO_LINE = "encre_no_line"  # a boolean attribute of edges: never a crease


def _edges(mesh, loops, face):
    """What creases along the triangles' edges are taken for, (t,) as Mesh.edges; None: all between flat faces."""
    start, total = (get(mesh.polygons, name, np.int32)[face][:, None] for name in ("loop_start", "loop_total"))
    smooth = get(mesh.polygons, "use_smooth", bool)[face][:, None]
    never = mesh.attributes.get(NO_LINE)
    never = None if never is None or (never.domain, never.data_type) != ("EDGE", "BOOLEAN") else never
    if total.max() == 3 and not smooth.any() and never is None:
        return None
    inner = np.roll(loops, -1, 1) - start != (loops - start + 1) % total  # cuts through a face
    corner_edge = mesh.attributes.get(".corner_edge")  # as fast as .corner_vert
    edge = (get(corner_edge.data, "value", np.int32) if corner_edge
            else get(mesh.loops, "edge_index", np.int32))[loops]
    kinds = np.where(smooth & ~versions.sharp_edges(mesh)[edge], EDGES["smooth"], EDGES["flat"])
    if never is not None:
        inner |= get(never.data, "value", bool)[edge]
    kinds[inner] = EDGES["none"]
    return edge_kinds(kinds)


# Parts

PART = "encre_part"
_NUMBERS = {"INT": np.int32, "INT8": np.int32, "BOOLEAN": bool, "FLOAT": np.float32}


def _parts(mesh, corners, face, separate):
    """(part of each triangle (t,), or None, number of parts): faces with another encre_part, or, with `separate`, not
    joined by any face, are of another part. The lowest number, and the first point, are part 0."""
    attribute = mesh.attributes.get(PART)
    numbered = attribute is not None and attribute.domain == "FACE" and attribute.data_type in _NUMBERS
    if not numbered and not separate:
        return None, 1
    number = get(attribute.data, "value", _NUMBERS[attribute.data_type])[face] if numbered else np.zeros(len(corners))
    piece = islands(len(mesh.vertices), corners)[corners[:, 0]] if separate else np.zeros(len(corners), np.intp)
    found, part = np.unique(np.stack([number, piece], 1), axis=0, return_inverse=True)
    return (part.reshape(-1).astype(np.int32), len(found)) if len(found) > 1 else (None, 1)


def islands(count, corners):
    """The least of the points that each of `count` points hangs together with by triangles (t, 3)."""
    root = np.arange(count)
    while True:
        own = root[corners]
        least = own.min(1)
        if (own == least[:, None]).all():
            return root
        for k in range(3):  # the root of a point, too, hangs together with the least of its triangle
            np.minimum.at(root, own[:, k], least)
        while (root[root] != root).any():
            root = root[root]


# UV maps

def unwrapped(obj, depsgraph, uv_map=""):
    """The triangles of an object in world space with the UV map of this name, or else the one that renders use.

    Raises EncreError for what has no faces or no UV map.
    """
    evaluated = obj.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh() if evaluated.type in MESHABLE else None
    try:
        if not mesh or not len(mesh.polygons):
            raise EncreError(f"{obj.name}: is not a mesh with faces; choose another object")
        layer = mesh.uv_layers.get(uv_map) or next((u for u in mesh.uv_layers if u.active_render), None)
        if not layer:
            raise EncreError(f"{obj.name}: has no UV map; unwrap it first")
        points = get(mesh.vertices, "co", np.float32, 3)
        vertex = get(mesh.loops, "vertex_index", np.int32)
        loops, _ = _triangulate(mesh, points, vertex)
        world = np.array(evaluated.matrix_world, np.float64)
        return unwrap.Unwrapped(points @ world[:3, :3].T + world[:3, 3], vertex[loops],
                                get(layer.data, "uv", np.float32, 2)[loops].astype(np.float64))
    finally:
        evaluated.to_mesh_clear()


# Painted controls

def _painted(mesh, loops, corners, face):
    """Control values at the triangles' corners, (t, 3, controls); None if nothing is painted."""
    painted, controls = None, library.controls().values()
    for channel, control in enumerate(controls):
        attribute = mesh.attributes.get(control.attribute)
        if attribute is None or not len(attribute.data):
            continue
        if attribute.data_type in ("FLOAT_COLOR", "BYTE_COLOR"):
            values = colour.control_values(get(attribute.data, "color", np.float32, 4))
        elif attribute.data_type == "FLOAT":
            values = get(attribute.data, "value", np.float32)
        else:
            continue
        where = {"POINT": corners, "CORNER": loops, "FACE": face[:, None]}.get(attribute.domain)
        if where is None:
            continue
        if painted is None:
            painted = np.zeros((len(loops), 3, len(controls)), np.float32)
        painted[..., channel] = values[where]
    return painted
