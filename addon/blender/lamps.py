# SPDX-License-Identifier: GPL-3.0-or-later
"""What drawn light needs of a scene: lamps as Cycles takes them, what they light, and what throws shadows."""

import contextlib
from dataclasses import dataclass, field, fields

import numpy as np

from ..pen.backdrop import Backdrops
from ..pen.irradiance import planes as planes_of
from ..pen.irradiance import polynomials
from ..pen.job import EVERY_SET, Bend, Lamp
from ..pen.scene import Scene
from . import cutouts, filters, pictures, receivers, skies, trees, versions, wanted, worlds

_KINDS = {"SUN": "sun", "POINT": "point", "SPOT": "spot", "SQUARE": "rectangle", "RECTANGLE": "rectangle",
          "DISK": "ellipse", "ELLIPSE": "ellipse"}
_THINGS = "MESH", "CURVE", "SURFACE", "FONT", "META"
_EVEN, _USUAL = 0.1, np.sqrt([0.5, 0.5]) * (-1, 1)  # a share of the light that has no way, and the way that it has then
_MOST_SETS, _MOST_BENDS = 64, 64
_SIDES = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], np.float64)
_SIDES /= np.linalg.norm(_SIDES, axis=1)[:, None]


@dataclass
class Kept:
    """What is kept of a scene from one Light to the next: trees of triangles that are still the same, and the pictures
    of its materials."""

    scene: Scene = field(default_factory=Scene)
    geometry: dict = field(default_factory=dict)  # (shape of triangles, how solid) -> number in the scene
    spots: dict = field(default_factory=dict)     # likewise -> receivers.Spots, where light is measured
    measured: tuple | None = None                 # what was measured last: (by what, receivers.Found)
    textures: dict = field(default_factory=dict)  # Cutout -> number in the scene
    colors: dict = field(default_factory=dict)    # of materials, texel by texel: colored.colors()
    told: set = field(default_factory=set)        # of the textures: those that the scene need not be told again
    numbered: int = 0                             # geometries so far
    placed: int = 0                               # instances in the scene
    lamps: int = 0
    images: pictures.Images = field(default_factory=pictures.Images)
    backdrops: Backdrops = field(default_factory=Backdrops)


_between = {}  # (scene, view layer) -> Kept, from one frame to the next


def between(engine, depsgraph):
    """The Kept of a view layer that its next frame gets, too; None: it is rendered once."""
    if not (engine.is_animation or wanted.series):
        return None
    kept = _between.setdefault((depsgraph.scene.name_full, depsgraph.view_layer.name), Kept())
    kept.told.clear()  # nobody says which images have changed
    kept.images.keep_files()
    return kept


def forget():
    """Frees what frames have kept for the next."""
    _between.clear()


class Light:
    """The light of one view layer: made before Cycles frees the scene, drawn after it."""

    def __init__(self, depsgraph, clip, kept=None, shown=None, shadowed=False, planes=0.0):
        """clip: the camera's (start, end); kept: the Kept of the Light before this one, which must not be drawn any
        more; shown: as meshes.extract() takes it; shadowed: whether things keep the world's light from each other;
        planes: how much its sides are told apart."""
        self.kept, self.clip, self.unknown = kept or Kept(), clip, []
        self.scene = self.kept.scene
        self.sets, self.materials = _Sets(), {}
        self.used, self.placed, self.lamps = set(), 0, 0
        self.said = []  # all that the scene was told, by which two of them are compared
        self.instances = []  # (as Scene.instance() takes it, receivers.Spots where the camera sees it, who moves it)
        self.around, self.bends, self.exposure = skies.Around(), [], filters.exposure(depsgraph)
        world = filters.world(depsgraph)
        self.suns = np.zeros(3)  # their light, spread to all sides
        try:
            self.around = skies.light(world)
        except trees.Unknown as e:
            self.unknown.append(f"the world's node {e}")
        if planes > 0 and self.around.ambient is not None:
            self.around.ambient = planes_of(self.around.ambient, _level(depsgraph, self.around, shown), planes)
        self.world = None if self.around.ambient is None else self.around.ambient * self.exposure
        self.free = self.world  # of the world's light what nothing is in the way of
        if shadowed and self.world is not None:
            halves, self.free = _halves(self.world)
            for lamp in halves:
                self._add(lamp)
        for lamp in suns(self.around, world):
            lamp.color = lamp.color * self.exposure
            self.suns = self.suns + lamp.color / (4 * np.pi)
            self._add(lamp)
        for instance in depsgraph.object_instances:
            kind = instance.object.type
            if kind in ("LIGHT", "EMPTY") and instance.show_self and (
                    not shown or shown((instance.parent if instance.is_instance else instance.object).original)):
                (self._add_lamp if kind == "LIGHT" else self._add_bend)(instance)

    @property
    def dark(self):
        """Whether nothing of it can be drawn."""
        return not self.lamps and self.world is None

    @property
    def mean(self):
        """The colour (3,) of what shines on fog from all sides; of lamps that stand somewhere nothing counts."""
        return np.full(3, 0.5) if self.dark else self.suns + (0 if self.world is None else self.world[0])

    def _add_lamp(self, instance):
        obj = instance.object
        lamp = told(obj, np.array(instance.matrix_world, np.float64), self.unknown)
        if lamp is None:
            return
        lamp.light_set, lamp.shadow_set = self.sets.numbers(obj)
        lamp.color = lamp.color * self.exposure
        if lamp.kind == "sun":
            self.suns = self.suns + lamp.color / (4 * np.pi)
        self._add(lamp)

    def _add(self, lamp):
        self.scene.lamp(self.lamps, lamp)
        self.said.append([getattr(lamp, of.name) if of.name not in ("color", "model")
                          else np.asarray(getattr(lamp, of.name)).tobytes() for of in fields(lamp)])
        self.lamps += 1
        self.kept.lamps = max(self.kept.lamps, self.lamps)

    def _add_bend(self, instance):
        obj = instance.object
        if obj.empty_display_type != "SPHERE" or not obj.encre.bend_light > 0 or len(self.bends) == _MOST_BENDS:
            return
        model = np.array(instance.matrix_world, np.float64)
        model[:3, :3] *= obj.empty_display_size
        self.bends.append(Bend(model, obj.encre.bend_light, obj.encre.bend_fade))
        self.said.append((model.tobytes(), obj.encre.bend_light, obj.encre.bend_fade))

    def place(self, obj, blocks, triangles, matrix, seen, casts, movers=()):
        """An instance of triangles.Triangles. blocks: the materials of its slots; casts: whether it throws shadows;
        movers: the originals that may move or bend it."""
        solid, kept = self._solid(blocks), self.kept
        key = triangles.shape, solid
        self.used.add(key)
        if key not in kept.geometry:
            number, kept.numbered = kept.numbered, kept.numbered + 1
            self._geometry(number, triangles, solid)
            kept.geometry[key] = number
            kept.spots[key] = receivers.spots(triangles.points, triangles.corners)
        for cutout in solid:
            if isinstance(cutout, cutouts.Cutout) and cutout.uv_map in triangles.uvs:
                self._texture(cutout)
        number, light_sets, shadow_sets = kept.geometry[key], *self.sets.of(obj)
        matrix, shadow_sets = np.array(matrix, np.float64), shadow_sets if casts else 0
        self.scene.instance(self.placed, number, matrix, seen, light_sets, shadow_sets)
        self.said.append((number, matrix.tobytes(), seen, light_sets, shadow_sets))
        self.instances.append(((number, matrix, seen, light_sets, shadow_sets), kept.spots[key] if seen else None,
                               movers))
        self.placed += 1
        kept.placed = max(kept.placed, self.placed)

    def _solid(self, blocks):
        """How solid each slot's surfaces are: a Cutout, or whether they are."""
        return tuple(found if isinstance(found, cutouts.Cutout) else found >= 0.5
                     for found in map(self._cutout, blocks))

    def _cutout(self, material):
        if material not in self.materials:
            self.materials[material] = cutouts.of(material)
        return self.materials[material]

    def maps(self, blocks):
        """The names of the UV maps that place() reads of the triangles of an object with these materials."""
        return tuple(sorted({solid.uv_map for solid in self._solid(blocks) if isinstance(solid, cutouts.Cutout)}))

    def _geometry(self, number, triangles, solid):
        corners, normals, uvs, textures = triangles.corners, triangles.normals, None, None
        slot = (np.zeros(len(corners), np.intp) if triangles.material is None
                else np.clip(triangles.material, 0, len(solid) - 1))
        for k, cutout in enumerate(solid):
            there = triangles.uvs.get(cutout.uv_map) if isinstance(cutout, cutouts.Cutout) else None
            if there is None:
                continue
            if textures is None:
                uvs, textures = np.zeros((len(corners), 3, 2), np.float32), np.full(len(corners), -1, np.int32)
            uvs[slot == k] = cutout.placed(there[slot == k])
            textures[slot == k] = self._texture(cutout)
        if not all(solid):
            kept = np.array([bool(s) for s in solid])[slot]
            corners, normals, uvs, textures = (None if a is None else a[kept]
                                               for a in (corners, normals, uvs, textures))
        self.scene.geometry(number, triangles.points, corners, normals, uvs, textures)

    def _texture(self, cutout):
        """Its key in the scene."""
        kept = self.kept
        number = kept.textures.setdefault(cutout, len(kept.textures))
        if cutout not in kept.told:
            self.scene.texture(number, cutout.alpha(), cutout.extension, cutout.closest)
            kept.told.add(cutout)
        return number

    def tidy(self):
        """After all is placed: what the last Light had and this one has not is no longer kept."""
        kept = self.kept
        for number in range(self.placed, kept.placed):
            self.scene.instance(number, None)
        for number in range(self.lamps, kept.lamps):
            self.scene.lamp(number, None)
        for key in kept.geometry.keys() - self.used:
            self.scene.geometry(kept.geometry.pop(key), None)
            kept.spots.pop(key)
        kept.placed, kept.lamps = self.placed, self.lamps

    @contextlib.contextmanager
    def without(self, moved):
        """Meanwhile what moves, moved(movers), is not there."""
        gone = [k for k, (_, _, movers) in enumerate(self.instances) if moved(movers)]
        for k in gone:
            self.scene.instance(k, None)
        try:
            yield
        finally:
            for k in gone:
                self.scene.instance(k, *self.instances[k][0])

    def same(self, other):
        """Whether another Light of the same Kept would draw the same."""
        return self.said == other.said and np.array_equal(self.free, other.free)

    def work(self, depth, normal, view, projection, frame, clip, sharp=False, **more):
        """The Work that draws the layer `diffuse`; clip: as the Light was made with, of what looks at it now; sharp and
        more: as light_work() takes them."""
        return self.scene.light_work(depth, normal, view, projection, frame, *clip, self.free, self.bends, sharp,
                                     rims=not sharp, **more)

    def draw(self, depth, normal, view, projection, frame, threads, progress):
        """The layer `diffuse`."""
        return self.scene.light(depth, normal, view, projection, frame, *self.clip, self.free, threads,
                                progress=progress, bends=self.bends, rims=True)

    def open(self, depth, normal, view, projection, frame):
        """Likewise, as if nothing threw shadows."""
        return self.scene.light(depth, normal, view, projection, frame, *self.clip, self.free, bends=self.bends,
                                unshadowed=True)


# Lamps

def suns(around, world):
    """The Lamps that a world's suns are; around: its skies.Around."""
    matt = not getattr(getattr(world, "cycles_visibility", None), "glossy", True)
    for sun in around.suns:
        yield Lamp("sun", sun.color, width=sun.width, matt=matt, model=_facing(sun.direction))


def _level(depsgraph, around, shown):
    """The way on the level (2,), of length 1, from which most light comes: to where most things stand. Where it comes
    evenly, from the upper left of the world's plan, as draftsmen have it."""
    places, told_ = [], []
    for instance in depsgraph.object_instances:
        obj = instance.object
        if not instance.show_self or shown and not shown(
                (instance.parent if instance.is_instance else obj).original):
            continue
        matrix = np.array(instance.matrix_world, np.float64)
        if obj.type == "LIGHT":
            told_.append(told(obj, matrix))
        elif obj.type in _THINGS:
            places.append(matrix[:3, 3])
    middle = np.median(places, 0) if places else np.zeros(3)
    way, whole = around.ambient[1:3].mean(1), float(np.abs(around.ambient[0]).mean())
    for lamp in [*suns(around, None), *(lamp for lamp in told_ if lamp is not None)]:
        strength, toward = float(np.mean(lamp.color)) / np.pi, lamp.model[:3, 2]
        if lamp.kind != "sun":
            toward = lamp.model[:3, 3] - middle
            strength /= 4 * np.pi * max(float(toward @ toward), 1e-6)
        way = way + strength * toward[:2] / max(np.linalg.norm(toward), 1e-300)
        whole += strength
    way = way / max(whole, 1e-300)
    way = way + max(_EVEN - np.linalg.norm(way), 0) * _USUAL
    return way / np.linalg.norm(way) if np.linalg.norm(way) > 1e-6 else _USUAL


def _facing(side):
    """(4, 4) of what shines from this side; any turn about it does."""
    first = np.cross(np.eye(3)[np.argmin(np.abs(side))], side)
    first = first / np.linalg.norm(first)
    model = np.eye(4)
    model[:3, :3] = np.column_stack([first, np.cross(side, first), side])
    return model


def _halves(world):
    """(the Lamps that give most of the light from all sides, (9, 3), each half of the sky; what is left of that
    light). Each half is as bright all over; they part the sky where it changes most. Exact for one color; of other
    skies as much is left as that in the open all is as it was."""
    axis = world[1:4].sum(1)
    axis = axis / np.linalg.norm(axis) if np.linalg.norm(axis) > 1e-3 * np.abs(world[0]).sum() else np.eye(3)[2]
    falls = [np.maximum(polynomials(side) @ world, 0) for side in (axis, -axis)]
    whole = np.zeros((9, 3))
    whole[0], whole[1:4] = (falls[0] + falls[1]) / 2, axis[:, None] * (falls[0] - falls[1]) / 2
    all_, halves = polynomials(_SIDES) @ world, polynomials(_SIDES) @ whole
    share = np.clip(np.min(np.where(halves > 1e-9, all_ / np.maximum(halves, 1e-9), 1), 0), 0, 1)
    lamps = [Lamp("sun", np.pi * share * fall, width=np.pi, matt=True, model=_facing(side))
             for side, fall in zip((axis, -axis), falls, strict=True)]
    rest = world - share * whole
    return lamps, rest if np.abs(rest).max() > 1e-6 * np.abs(world).max() else None


def told(obj, matrix, unknown=None):
    """The Lamp that an object is; None: it lights no surface, or has nodes that can't be told or a strength that is no
    number in single precision, which go to `unknown`."""
    if not obj.visible_diffuse or (obj.data.type == "AREA" and obj.data.cycles.is_portal):
        return None
    try:
        lamp = _lamp(obj.data, matrix)
        lamp.matt = not obj.visible_glossy
        if np.abs(lamp.color).max() <= np.finfo(np.float32).max:
            return lamp
        if unknown is not None:
            unknown.append(f"lamp {obj.name}, whose strength is not finite")
        return None
    except trees.Unknown as e:
        if unknown is not None:
            unknown.append(f"the node {e} of lamp {obj.name}")
        return None


def _lamp(data, matrix):
    color = np.array(data.color, np.float64) * data.energy * 2.0 ** getattr(data, "exposure", 0.0)
    if getattr(data, "use_temperature", False):
        color *= np.array(data.temperature_color)
    color *= _emission(data)
    kind = _KINDS[data.shape if data.type == "AREA" else data.type]
    if kind == "spot" and not versions.SPOTS_SCALE:
        matrix[:3, :3] /= np.linalg.norm(matrix[:3, :3], axis=0)
    lamp = Lamp(kind, model=matrix, shadows=bool(versions.casts_shadows(data)))
    if kind == "sun":
        lamp.width = min(data.angle, np.pi)
    elif kind in ("point", "spot"):
        lamp.width, lamp.flat = data.shadow_soft_size, getattr(data, "use_soft_falloff", True)
    else:
        lamp.width = data.size
        lamp.height = data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size
        lamp.spread = data.spread
        color *= versions.AREA_LIGHT
    if kind == "spot":
        lamp.spot_angle, lamp.spot_blend = data.spot_size, data.spot_blend
    lamp.color = color * (1 if getattr(data, "normalize", True) else _whole(lamp))
    return lamp


def _whole(lamp):
    """What a lamp radiates whose colour is that of its surface."""
    if lamp.kind == "sun":
        return np.pi * np.sin(lamp.width / 2) ** 2 if lamp.width else 1
    if lamp.kind in ("point", "spot"):
        return 4 * np.pi * lamp.width ** 2 if lamp.width else 1
    sides = np.linalg.norm(lamp.model[:3, :2], axis=0)
    area = lamp.width * lamp.height * sides[0] * sides[1]
    return area * (np.pi / 4 if lamp.kind == "ellipse" else 1)


def _emission(data):
    """The colour (3,) by which a lamp's nodes multiply its own."""
    tree = data.node_tree if data.use_nodes else None
    out = tree and tree.get_output_node("CYCLES")
    if not out:
        return np.ones(3)
    source = trees.source_of(out.inputs["Surface"])
    if source is None or trees.is_nothing(source[0]):
        return np.zeros(3)
    node = source[0]
    if source[1].type != "SHADER":
        return worlds.color(out.inputs["Surface"])
    if node.bl_idname != "ShaderNodeEmission":
        raise trees.Unknown(node.name)
    return worlds.color(node.inputs["Color"]) * worlds.value(node.inputs["Strength"])


# Light linking

@dataclass
class _Members:
    """Which objects are in a lamp's collection: of those included, if any are, without those excluded."""

    included: set
    excluded: set

    def __contains__(self, name):
        return name not in self.excluded and (not self.included or name in self.included)


class _Sets:
    """Numbers of the sets of objects that lamps are linked to; number 0 are all."""

    def __init__(self):
        self.collections = [None]
        self.members = [None]

    def numbers(self, obj):
        """(light_set, shadow_set) of a lamp."""
        linking = versions.light_linking(obj)
        if linking is None:
            return 0, 0
        return self._number(linking.receiver_collection), self._number(linking.blocker_collection)

    def _number(self, collection):
        if collection is None:
            return 0
        collection = collection.original
        if collection not in self.collections and len(self.collections) < _MOST_SETS:
            self.collections.append(collection)
            self.members.append(_members(collection))
        return self.collections.index(collection) if collection in self.collections else 0

    def of(self, obj):
        """(light_sets, shadow_sets) of what is lit: the same, as sets of receivers and blockers are numbered as one."""
        if len(self.members) == 1:
            return EVERY_SET, EVERY_SET
        name = obj.original.name_full
        sets = 1 | sum(1 << k for k, members in enumerate(self.members) if members and name in members)
        return sets, sets


def _members(collection):
    found = _Members(set(), set())
    for obj, item in zip(collection.objects, collection.collection_objects, strict=True):
        _side(found, item).add(obj.name_full)
    for child, item in zip(collection.children, collection.collection_children, strict=True):
        _side(found, item).update(obj.name_full for obj in child.all_objects)
    return found


def _side(found, item):
    return found.included if item.light_linking.link_state == "INCLUDE" else found.excluded
