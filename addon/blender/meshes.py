# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated objects -> triangles with painted controls, marked edges  and numbers of objects."""

import functools
from dataclasses import dataclass, field

import numpy as np

from ..pen import colour, library, unwrap
from ..pen.errors import EncreError
from ..pen.job import EDGES, Mesh, edge_kinds
from . import attributes, properties, versions
from .attributes import get

MESHABLE = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


@dataclass
class Objects:
    """Triangles and marked edges of one view layer. Arrays are by the rasteriser's object number, one for each part
    of each instance; 0 is nothing."""

    meshes: list
    owners: np.ndarray   # the object index that Cycles writes for it
    numbers: np.ndarray  # what the layer `object` says
    indices: np.ndarray | None  # by Cycles' index: what the layer says where nothing was drawn; None: see strays()
    automatic: bool
    catchers: np.ndarray  # which show nothing but shadows
    clear: np.ndarray  # by number of material: which may let light through
    materials: list    # by their numbers, full names; None: of what has none
    things: np.ndarray # what programs of materials read of each: colour with alpha, random, pass index, place
    shown: list        # by the meshes: attributes (t, 3, channels) that programs of materials read, or None

    def solid(self):
        """The meshes without the triangles that may let light through; None if there are none of these."""
        if not self.clear.any():
            return None
        out = []
        for mesh in self.meshes:
            if mesh.kind != "triangles":
                continue
            if mesh.material is None:
                if not self.clear[mesh.material_index]:
                    out.append(Mesh(mesh.points, mesh.corners, object=mesh.object, object_index=mesh.object_index,
                                    model=mesh.model))
                continue
            kept = ~self.clear[mesh.material]
            out.append(Mesh(mesh.points, mesh.corners[kept], object_index=mesh.object_index, model=mesh.model,
                            object=None if mesh.object is None else mesh.object[kept]))
        return out

    def strays(self, index):
        """What the layer `object` says at pixels with Cycles' index, whose object the rasteriser did not draw."""
        if self.indices is not None:
            return self.indices[np.clip(index, 0, len(self.indices) - 1).astype(np.intp)]
        return -index if self.automatic else index  # negative: no automatic number is


# Triangles

class Kept:
    """Triangles from one extraction to the next."""

    def __init__(self):
        self._known = {}  # key -> (triangles, names of what they are made of)
        self._used = set()

    def drop(self, names):
        """Forgets what is made of any of these (type, name)."""
        self._known = {key: known for key, known in self._known.items() if not known[1] & names}

    def get(self, key, names, read):
        """The triangles of a key, made by read() where they are not there."""
        self._used.add(key)
        if key not in self._known:
            self._known[key] = read(), set()
        triangles, sources = self._known[key]
        sources |= names
        return triangles

    def tidy(self):
        """Forgets what was not asked for since the last time."""
        self._known = {key: known for key, known in self._known.items() if key in self._used}
        self._used = set()


def block_name(block):
    return type(block.original).__name__, block.original.name_full


def extract(depsgraph, automatic, line_numbers, light=None, kept=None, visible=None, looks=None):
    """The Objects that the camera can see. `line_numbers`: what overrides.pass_indices() gave, None if it was
    not called. `light`: a lamps.Light that takes them, and what only throws shadows. `kept`: a Kept; with it normals
    are read. `visible`: whether an original object is, None: all are. `looks`: the materials.Looks whose programs will
    read attributes, after the controls.
    """
    meshes, shown, owners, numbers, catchers, things = [], [], [0], [0], [False], [(0,) * 9]
    running, materials = {}, _Materials(depsgraph.scene_eval)
    smooth, kept = bool(light) or kept is not None, kept or Kept()
    first_free = 0 if line_numbers is None else len(line_numbers)
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type not in MESHABLE or not instance.show_self:
            continue
        top = instance.parent if instance.is_instance else obj
        if visible and not visible(top.original):
            continue
        seen = _in_camera(obj, depsgraph)
        if not seen and not (light and obj.visible_shadow):
            continue
        # Instances come as one passing object. An evaluated mesh has its modifiers in it, a curve or text has not.
        own = None if obj.type == "MESH" else obj.original.as_pointer()
        maps = light.maps(obj) if light else ()
        read = _read_by(obj, looks) if seen else frozenset()
        key = obj.data.as_pointer(), obj.data.name_full, own, obj.encre.separate_parts, maps, read
        names = {block_name(block) for block in (obj, top, obj.data)}
        triangles = kept.get(key, names, functools.partial(_triangles, obj, smooth, maps, read))
        if triangles is None:
            continue
        if light:
            light.place(obj, key, triangles, instance.matrix_world, seen)
        if not seen:
            continue
        number = len(owners)
        parts = range(first_free + number, first_free + number + triangles.n_parts)
        owners += [obj.pass_index] * len(parts)
        catchers += [obj.is_shadow_catcher] * len(parts)
        things += [_thing(instance, obj)] * len(parts) if looks else []
        numbers.append(_line_number(instance, obj, automatic, line_numbers, running, parts[0]))
        numbers += [own if automatic else -own for own in parts[1:]]  # negative: no pass index is
        mesh, read = _mesh(triangles, obj, materials, instance.matrix_world, number, looks)
        meshes.append(mesh)
        shown.append(read)
        if len(triangles.marked):
            meshes.append(Mesh(triangles.points, triangles.marked, kind="lines",
                                    model=np.array(instance.matrix_world, np.float64)))
            shown.append(None)
    kept.tidy()
    return Objects(meshes, np.array(owners, np.float32), np.array(numbers, np.float32),
                   line_numbers if automatic else None, automatic, np.array(catchers),
                   np.array([known[3] for known in materials.known.values()]), list(materials.known),
                   np.array(things, np.float32), shown)


def _read_by(obj, looks):
    """What the materials of an object read of its mesh."""
    if not looks:
        return frozenset()
    return frozenset(source for name in _slots(obj) for source in looks.sources[name])


def _thing(instance, obj):
    return (*obj.color, instance.random_id / 0xffffffff, obj.original.pass_index, *instance.matrix_world.translation)


def _in_camera(obj, depsgraph):
    if not obj.visible_camera:
        return False
    return not obj.original.indirect_only_get(view_layer=depsgraph.view_layer)


def _line_number(instance, obj, automatic, line_numbers, running, own):
    """What the layer `object` says for an instance; `own`: a number that nothing else has."""
    if not automatic:
        return obj.pass_index
    group = obj.encre.line_group
    if instance.is_instance and not group:
        return own
    if line_numbers is not None:
        return line_numbers[obj.pass_index]
    return running.setdefault((bool(group), group or obj.name_full), own)


@dataclass
class _Triangles:
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
    shown: dict = field(default_factory=dict)  # what attributes.by_slot() made of them, by the layouts

    def same_shape(self, other):
        """Whether light falls on others as it does on these."""
        return (self.uvs.keys() == other.uvs.keys()
                and all(np.array_equal(uvs, other.uvs[name]) for name, uvs in self.uvs.items())
                and all(np.array_equal(getattr(self, name), getattr(other, name))
                        for name in ("points", "corners", "normals", "material")))


def _triangles(obj, light, maps, sources):
    """The triangles of an evaluated object, None if it has none. light: whether light is to fall on them; maps: the UV
    maps that are read, "" = the one that renders use; sources: what programs of materials read."""
    try:
        mesh = obj.to_mesh()
    except RuntimeError:  # no geometry
        return None
    if mesh is None:
        return None
    try:
        return _read(mesh, obj.encre.separate_parts, light, maps, sources) if len(mesh.polygons) else None
    finally:
        obj.to_mesh_clear()


def _read(mesh, separate, light, maps, sources):
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
    normals = versions.corner_normals(mesh) if light else None
    return _Triangles(points, corners, material, _painted(mesh, loops, corners, face), part, n_parts,
                      np.empty((0, 2), np.int32) if marked is None or not marked.any()
                      else get(mesh.edges, "vertices", np.int32, 2)[marked], _edges(mesh, loops, face),
                      None if normals is None else normals[loops],
                      {name: uvs[loops] for name in maps if (uvs := _uvs(mesh, name)) is not None},
                      attributes.read(mesh, sources, points, loops, corners, face))


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


class _Materials:
    """Numbers, styles and controls of materials; each material is asked once."""

    def __init__(self, scene):
        self.scene, self.known = scene, {None: (0, 0, np.float32(properties.controls(None)), False)}

    def __call__(self, material):
        key = material and material.name_full
        if key not in self.known:
            self.known[key] = (len(self.known), properties.style_number(material, self.scene),
                               np.array(properties.controls(material), np.float32), _lets_through(material))
        return self.known[key]


def _lets_through(material):
    """Whether light may pass through the surfaces of a material: whether any of its nodes is transparent."""
    trees, known = [material.node_tree if material.use_nodes else None], set()
    while trees:
        tree = trees.pop()
        if tree is None or tree.name_full in known:
            continue
        known.add(tree.name_full)
        for node in tree.nodes:
            alpha = node.inputs.get("Alpha") if node.bl_idname == "ShaderNodeBsdfPrincipled" else None
            if node.bl_idname == "ShaderNodeBsdfTransparent" or (
                    alpha and (alpha.is_linked or alpha.default_value < 1)):
                return True
            trees.append(getattr(node, "node_tree", None))
    return False


def _slots(obj):
    """Full names of the materials of an object's slots."""
    return [slot.material and slot.material.name_full for slot in obj.material_slots] or [None]


def _mesh(triangles, obj, materials, matrix, number, looks):
    """(the Mesh, its attributes for the programs of its materials)."""
    slots = [materials(slot.material) for slot in obj.material_slots] or [materials(None)]
    own_style = properties.style_number(obj, materials.scene)
    controls = np.array([slot[2] for slot in slots]) + np.array(properties.controls(obj), np.float32)
    mesh = Mesh(triangles.points, triangles.corners, object_index=number,
                     model=np.array(matrix, np.float64), material_index=slots[0][0],
                     style_index=own_style or slots[0][1], edges=triangles.edges,
                     crease_offset=obj.encre.crease_offset, normals=triangles.normals)
    if triangles.part is not None:
        mesh.object = number + triangles.part
    slot = np.zeros(len(triangles.corners), np.intp)
    if triangles.material is not None and len(slots) > 1:
        slot = np.clip(triangles.material, 0, len(slots) - 1)  # as Cycles does
        mesh.material = np.array([s[0] for s in slots], np.int32)[slot]
        mesh.style = np.array([own_style or s[1] for s in slots], np.int32)[slot]
    if controls.any():
        added = controls[slot][:, None]
        mesh.attributes = added.repeat(3, 1) if triangles.painted is None else triangles.painted + added
    else:
        mesh.attributes = triangles.painted
    if looks:
        layouts = [tuple(looks.sources[name]) for name in _slots(obj)]
        shown = triangles.shown.get(layouts := tuple(layouts))
        if shown is None and any(layouts) and triangles.sources:
            shown = triangles.shown[layouts] = attributes.by_slot(triangles.sources, slot, layouts)
        return mesh, shown
    return mesh, None
