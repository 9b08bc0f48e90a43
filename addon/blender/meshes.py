# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects of a view layer -> meshes for the rasteriser, with numbers of objects, materials and styles."""

import functools
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..pen.job import Mesh
from . import attributes, filters, hair, mirrors, properties, trees, versions
from .patterns import hashed
from .triangles import MESHABLE, read_lines, read_triangles

_WORD = 2 ** 32


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
    holdouts: np.ndarray  # which are holes in the picture
    refined: np.ndarray  # whose faces Cycles divides further than they are here
    clear: np.ndarray  # by number of material: which may let light through
    blurred: np.ndarray  # likewise: which show nothing clearly, neither mirrored nor through them
    displaced: np.ndarray  # likewise: whose surfaces Cycles moves
    holes: np.ndarray  # likewise: which are holes in the picture
    names: list         # of objects
    materials: list    # by their numbers, full names; None: of what has none
    flat: list         # likewise, in how many flat colors at most its images are; 0: as they are
    things: np.ndarray # what programs of materials read of each: colour with alpha, random, pass index, place,
                       # and the turn and scale of its matrix, row by row
    shown: list        # by the meshes: attributes (t, 3, channels) that programs of materials read, or None
    ribbons: list      # likewise: the Ribbons that the camera sees of strands, or None
    thick: np.ndarray  # how thick they are in the world, at most; 0: they are no strands
    coords: list       # by the meshes: {UV map: (t, 3, 3)} that programs of materials read, or None

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

    def chained(self, told=None, cuts=None):
        """(meshes whose edges tell of lines, by number of an object whether all its lines are theirs: 1 those of
        shapes, 2 those of colors). What lets light through, what Cycles moves or divides further and hair is left to
        the picture, but for lines between colors of what images cut out; holes have none of their own, and hide
        others'. told: a colored.Told whose pictures are there; cuts: likewise, by which it is known what of things
        images cut, though no lines between colors are asked for."""
        whole, out, cut_out = ~self.holdouts & ~self.catchers, [], []
        colored = np.full(len(whole), told is not None) & whole
        odd, moved = self.clear | self.displaced, self.displaced | self.holes
        cut, clean = (told.cut & self.clear, told.clean) if told is not None else (~odd & odd,) * 2
        for mesh, strands, coords in zip(self.meshes, self.ribbons, self.coords, strict=True):
            if mesh.kind == "lines":
                out.append(mesh)
                continue
            material = mesh.material_index if mesh.material is None else mesh.material
            bad = odd[material] | self.refined[mesh.object_index]
            if cuts is not None and coords and np.any(self.clear[material]):
                bad = bad & (moved[material] | self.refined[mesh.object_index] | ~cuts.opaque(mesh, coords))
            numbers = mesh.object_index if mesh.object is None else np.unique(mesh.object)
            if told is not None and not np.all(told.known[material]):
                colored[numbers] = False
            if strands is not None or np.any(bad | self.holes[material]):
                whole[numbers] = False
            still = ~moved[material] & ~self.refined[mesh.object_index]
            if strands is not None or np.any(bad & ~(clean[material] & still) | self.holes[material]):
                colored[numbers] = False
            if strands is not None or self.catchers[mesh.object_index]:
                continue
            uv = told.laid(mesh, coords) if told is not None and coords else None
            if not np.all(bad):
                out.append(_part(mesh, uv, ~bad))
            cards = cut[material] & still & bad
            if uv is not None and np.any(cards):
                cut_out.append(replace(_part(mesh, uv, cards), open=True))
        return [*out, *cut_out], whole + 2 * colored

    def called(self):
        """{what the layer `object` says: name of the object}; of several that share a number the first."""
        return {int(number): name for number, name in zip(self.numbers[::-1], self.names[::-1], strict=True)}

    def strays(self, index):
        """What the layer `object` says at pixels with Cycles' index, whose object the rasteriser did not draw."""
        if self.indices is not None:
            return self.indices[np.clip(index, 0, len(self.indices) - 1).astype(np.intp)]
        return -index if self.automatic else index  # negative: no automatic number is


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


def _part(mesh, uv, kept):
    """What chains take of a mesh, of the triangles that are kept."""
    kept = slice(None) if np.all(kept) else kept
    return Mesh(mesh.points, mesh.corners[kept], model=mesh.model, object_index=mesh.object_index,
                material_index=mesh.material_index, crease_offset=mesh.crease_offset,
                **{name: None if of is None else of[kept] for name, of in (
                    ("object", mesh.object), ("material", mesh.material), ("edges", mesh.edges), ("uv", uv))})


def block_name(block):
    return type(block.original).__name__, block.original.name_full


def extract(depsgraph, automatic, line_numbers, light=None, kept=None, visible=None, looks=None,
            anchored=False, unwrapped=False, laid=None, flat=(), facets=0.0):
    """The Objects that the camera can see. `line_numbers`: what overrides.pass_indices() gave, None if it was
    not called. `light`: a lamps.Light that takes them, and what only throws shadows. `kept`: a Kept; with it normals
    are read. `visible`: whether an original object is, None: all are. `looks`: the materials.Looks whose programs will
    read attributes, after the controls; with them there is hair. `anchored`: whether to tell where surfaces rest;
    `unwrapped`: which way their UV maps lie; `laid`: {full name of a material: UV map that is to be told}; `flat`: by
    number of style, Objects.flat; (): 0. `facets`: below how many degrees facets have normals of one smooth surface.
    """
    meshes, shown, ribbons, coords, owners, numbers, called = [], [], [], [], [0], [0], [""]
    things = [(0,) * (18 + 4 * len(looks.pool.asked if looks else ()))]
    catchers, holdouts, refined = [False], [False], [False]
    running, materials = {}, _Materials(depsgraph.scene_eval, flat)
    far = filters.culled(depsgraph)
    override, surfaces, grows = (of(depsgraph) for of in (filters.override, filters.surfaces, filters.hair))
    smooth, kept = bool(light) or kept is not None, kept or Kept()
    first_free = 0 if line_numbers is None else len(line_numbers)
    for block in depsgraph.ids:
        # What passes for a curve is a copy of it: properties that are made there, as by the first who reads them, leak.
        if isinstance(block, bpy.types.Object):
            block.encre  # noqa: B018
    for instance in depsgraph.object_instances:
        obj = instance.object
        meshable = surfaces and obj.type in MESHABLE and instance.show_self
        grown = hair.of(instance, depsgraph.mode == "RENDER") if looks and grows else ()
        if not meshable and not grown:
            continue
        top = instance.parent if instance.is_instance else obj
        if visible and not visible(top.original):
            continue
        seen = not far(obj, instance.matrix_world) and all(thing.visible_camera for thing in (obj, top)) \
            and not top.original.indirect_only_get(view_layer=depsgraph.view_layer)
        casts = obj.visible_shadow and top.visible_shadow and not far(obj, instance.matrix_world)
        if not seen and not (light and casts):
            continue
        # Instances come as one passing object. An evaluated mesh has its modifiers in it, a curve or text has not.
        own = None if obj.type == "MESH" else obj.original.as_pointer()
        blocks = filters.materials(obj, override)
        maps = light.maps(blocks) if light else ()
        read = _read_by(blocks, looks, laid) if seen else frozenset()
        names = {block_name(block) for block in (obj, top, obj.data)}
        if obj.encre.mark and seen and meshable:
            lines = kept.get(("lines", obj.data.as_pointer(), own), names, functools.partial(read_lines, obj))
            if lines is not None:
                meshes.append(Mesh(*lines, kind="lines", model=np.array(instance.matrix_world, np.float64)))
                shown.append(None)
                ribbons.append(None)
                coords.append(None)
                continue
        made = []
        if meshable:
            key = (obj.data.as_pointer(), obj.data.name_full, own, obj.encre.separate_parts, maps, read, anchored,
                   unwrapped, facets)
            made.append((key, kept.get(key, names, functools.partial(read_triangles, obj, smooth, maps, read, anchored,
                                                                     unwrapped, facets))))
        made += [(key, kept.get(key, names | set(map(block_name, those)), make)) for key, those, make in grown]
        made = [(key, triangles) for key, triangles in made if triangles is not None]
        if light:
            for _, triangles in made:
                light.place(obj, blocks, triangles, instance.matrix_world, seen, casts, (top.original, obj.original))
        if not seen or not made:
            continue
        number = len(owners)
        parts = range(first_free + number, first_free + number + made[0][1].n_parts)
        owners += [obj.pass_index] * len(parts)
        called += [obj.name] * len(parts)
        catchers += [obj.is_shadow_catcher or top.is_shadow_catcher] * len(parts)
        holdouts += [top.original.holdout_get(view_layer=depsgraph.view_layer)] * len(parts)
        refined += [not looks and versions.divides(obj, depsgraph)] * len(parts)
        if looks:
            things += [(*_thing(instance, obj), *(number for kind, name in looks.pool.asked for number in
                                                  _asked(kind, name, instance, obj, depsgraph)))] * len(parts)
        numbers.append(_line_number(instance, obj, automatic, line_numbers, running, parts[0]))
        numbers += [own if automatic else -own for own in parts[1:]]  # negative: no pass index is
        for _, triangles in made:  # hair has the number of what it grows on, as in Cycles
            mesh, read = _mesh(triangles, obj, blocks, materials, instance.matrix_world, number, looks,
                               _copy_seed(instance, obj))
            meshes.append(mesh)
            shown.append(read)
            ribbons.append(triangles.ribbons)
            coords.append({name: at for (kind, name), at in triangles.sources.items() if kind == "uv"})
            if len(triangles.marked):
                meshes.append(Mesh(triangles.points, triangles.marked, kind="lines", object_index=number,
                                   model=np.array(instance.matrix_world, np.float64)))
                shown.append(None)
                ribbons.append(None)
                coords.append(None)
    kept.tidy()
    thick = [0] * len(owners)
    for mesh, strands in zip(meshes, ribbons, strict=True):
        if strands:  # behind all others, so that hair changes no number of theirs
            for known in owners, numbers, called, catchers, holdouts, refined, *([things] if looks else []):
                known.append(known[mesh.object_index])
            mesh.object_index = len(thick)
            thick.append(2 * strands.radius.max() * np.linalg.norm(mesh.model[:3, :3], axis=0).max())
    return Objects(meshes, np.array(owners, np.float32), np.array(numbers, np.float32),
                   line_numbers if automatic else None, automatic, np.array(catchers), np.array(holdouts),
                   np.array(refined), *(np.array([known[k] for known in materials.known.values()])
                                        for k in (3, 4, 5, 6)), called, *map(list, zip(*materials.known, strict=True)),
                   np.array(things, np.float32), shown, ribbons, np.array(thick, np.float32), coords)


def _read_by(blocks, looks, laid):
    """What is read of a mesh: by materials, or of where their images lie on it."""
    if not looks:
        return frozenset(("uv", laid[name]) for name in _names(blocks) if name in laid) if laid else frozenset()
    return frozenset(source for name in _names(blocks) for source in looks.sources[name])


def _thing(instance, obj):
    matrix = instance.matrix_world
    return (*obj.color, _random_id(instance) / 0xffffffff, obj.original.pass_index, *matrix.translation,
            *(x for row in matrix.to_3x3() for x in row))


def _asked(kind, name, instance, obj, depsgraph):
    """Four numbers that an Attribute node asks of a thing, of what has placed it, or of the view layer: 0 where there
    is no such property."""
    if kind == "VIEW_LAYER":
        owners = depsgraph.view_layer_eval, depsgraph.scene_eval
    elif kind == "INSTANCER" and instance.is_instance:
        owners = instance.parent, instance.parent.data, obj, obj.data
    else:
        owners = obj, obj.data
    for owner in filter(None, owners):
        value = owner.get(name)
        if value is None:
            try:
                value = owner.path_resolve(name)
            except ValueError:
                continue
        try:
            return (*(float(x) for x in value), 0.0, 0.0, 0.0)[:3] + (float(value[3]) if len(value) > 3 else 1.0,) \
                if hasattr(value, "__len__") else (float(value),) * 3 + (1.0,)
        except (TypeError, ValueError):  # a text, or another block
            continue
    return (0.0,) * 4


def _random_id(instance):
    """32 bits that a thing keeps from frame to frame. Of what is no instance Blender tells none."""
    if instance.is_instance:
        return instance.random_id % _WORD  # Blender tells it with a sign
    return _named(instance.object.name)


@functools.lru_cache(65536)  # asked of each object at every redraw
def _named(text):
    """The 32 bits of a name, as Cycles makes them."""
    name = 0
    for byte in text.encode():
        name = (name * 37 + byte) % _WORD
    return hashed(name, 0)


def _copy_seed(instance, obj):
    """What is drawn by noise on the thing would be the same on all copies of it. 0 for what is there once: it rests in
    its own coordinates."""
    data = obj.original.data
    shared = instance.is_instance or data.users - data.use_fake_user > 1
    return (_random_id(instance) | 1) - 0x80000000 if shared else 0


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


# Materials

class _Materials:
    """Numbers, styles and controls of materials; each material is asked once. One whose images are flat on some things
    only has two numbers."""

    def __init__(self, scene, flat):
        self.scene, self.flat = scene, flat
        self.known = {(None, 0): (0, 0, np.float32(properties.controls(None)), *[False] * 4)}

    def __call__(self, material, style):
        """style: that of the thing, 0: it has none."""
        own = properties.style_number(material, self.scene)
        key = (material.name_full, self.flat[style or own] if self.flat else 0) if material else (None, 0)
        if key not in self.known:
            self.known[key] = (len(self.known), own,
                               np.array(properties.controls(material), np.float32), _lets_through(material),
                               mirrors.blurs(material), _displaces(material), _is_hole(material))
        return self.known[key]


def _lets_through(material):
    """Whether light may pass through the surfaces of a material: whether any of its nodes is transparent."""
    for node in trees.nodes_of(material):
        kind = node.bl_idname.removeprefix("ShaderNode")
        alpha = node.inputs.get("Alpha") if kind == "BsdfPrincipled" else None
        if kind in ("BsdfTransparent", "BsdfRayPortal", "EeveeSpecular") or (
                alpha and (alpha.is_linked or alpha.default_value < 1)):
            return True
        if kind == "OutputMaterial" and trees.fills_only(node):
            return True
    return False


def _displaces(material):
    """Whether Cycles moves the surfaces of a material, and does not only shade them as if it did."""
    method = material.displacement_method if hasattr(material, "displacement_method") else (
        material.cycles.displacement_method)  # before 4.1
    return method != "BUMP" and any(
        node.bl_idname == "ShaderNodeOutputMaterial" and trees.source_of(node.inputs["Displacement"])
        for node in trees.nodes_of(material))


def _is_hole(material):
    """Whether nothing but a hole is where a material's surfaces are."""
    return any(node.bl_idname == "ShaderNodeOutputMaterial" and (source := trees.source_of(node.inputs["Surface"]))
               and source[0].bl_idname == "ShaderNodeHoldout" for node in trees.nodes_of(material))


def _names(blocks):
    return [block and block.name_full for block in blocks]


def _mesh(triangles, obj, blocks, materials, matrix, number, looks, seed):
    """(the Mesh, its attributes for the programs of its materials). blocks: the materials of its slots."""
    own_style = properties.style_number(obj, materials.scene)
    slots = [materials(block, own_style) for block in blocks]
    controls = np.array([slot[2] for slot in slots]) + np.array(properties.controls(obj), np.float32)
    mesh = Mesh(triangles.points, triangles.corners, object_index=number,
                     model=np.array(matrix, np.float64), material_index=slots[0][0],
                     style_index=own_style or slots[0][1], edges=triangles.edges,
                     crease_offset=obj.encre.crease_offset, seed=seed, normals=triangles.normals,
                     rest=triangles.rest, rest_normals=triangles.rest_normals, uv=triangles.uv)
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
        layouts = [tuple(looks.sources[name]) for name in _names(blocks)]
        shown = triangles.shown.get(layouts := tuple(layouts))
        if shown is None and any(layouts) and triangles.sources:
            shown = triangles.shown[layouts] = attributes.by_slot(triangles.sources, slot, layouts)
        return mesh, shown
    return mesh, None
