# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of a picture without a renderer: a scene is read once, then drawn from any side by the library alone."""

import dataclasses

import bpy
import numpy as np

from ..pen import background, library, overlay
from ..pen.job import Camera
from ..pen.sky import Sky, directions
from . import cameras, lamps, materials, meshes, pictures, subject, trees, worlds

_SHOWS = 0.5         # alpha from which on a surface is there, as Blender's threshold is
_MOST_BEHIND = 8     # surfaces that are looked through, one after the other
_NUMBERS = ("depth", "object", "material", "style", "shading", "normal", "anchor")


class Kept:
    """What need not be read again for the next Scene: meshes, and trees of triangles for the light.

    Of a new Scene and an older one that share it only the new one may be drawn.
    """

    def __init__(self):
        self.meshes, self.light, self.images = meshes.Kept(), lamps.Kept(), pictures.Images()

    def update(self, depsgraph):
        """Forgets what has another shape since the last evaluation. (An engine that has just been made is told of
        nothing: it begins with a Kept of its own.)"""
        self.meshes.drop({meshes.block_name(update.id) for update in depsgraph.updates if update.is_updated_geometry})
        self.images.drop({meshes.block_name(update.id) for update in depsgraph.updates})


def read(depsgraph, settings, clip, kept=None, camera=None, visible=None):
    """The Scene of an evaluated depsgraph. On the main thread alone.

    clip: (start, end) of what looks at it; kept: a Kept; camera: the evaluated one whose focus tells what the picture
    is about, None: only the scene's size does; visible: whether an original object is, None: all are.
    """
    kept, scene = kept or Kept(), depsgraph.scene_eval
    light = lamps.Light(depsgraph, clip, kept.light, visible)
    blocks = [block for block in depsgraph.ids if isinstance(block, bpy.types.Material)]
    looks = materials.read(blocks, kept.images)
    objects = meshes.extract(depsgraph, settings.every[0]["object_index"] == "AUTO", None, light, kept.meshes, visible,
                             looks, settings.wants_anchor)
    first = _join_attributes(objects)
    light.tidy()
    notes = []
    if light.unknown:
        notes.append(f"drawn light leaves out {', '.join(light.unknown)}: only Cycles can read it")
    if light.dark:
        notes.append("no lamp and no world that can be drawn: a lamp shines from the camera")
    unknown = [f"{name} ({looks.unknown[name]})" for name in objects.materials if name in looks.unknown]
    if unknown:
        notes.append(f"in their viewport colour, as only Cycles can show them: {', '.join(unknown)}")
    try:
        sky = worlds.sky(scene.world)
    except trees.Unknown as e:
        sky = Sky(np.array(scene.world.color))
        notes.append(f"the world in its viewport colour, as only Cycles can show its node {e}")
    made = looks.programs(objects.materials, objects.things, first)
    return Scene(objects, light, made, sky, scene.render.film_transparent, subject.read(depsgraph, camera), clip,
                 notes, first > 0)


def _join_attributes(objects):
    """Puts behind the controls of each mesh what programs of materials read; the first channel of these."""
    first = len(library.controls()) if any(mesh.attributes is not None for mesh in objects.meshes) else 0
    for mesh, shown in zip(objects.meshes, objects.shown, strict=True):
        if shown is None or not first:
            mesh.attributes = mesh.attributes if shown is None else shown
            continue
        painted = mesh.attributes
        mesh.attributes = np.zeros((len(shown), 3, first + shown.shape[2]), np.float32)
        mesh.attributes[..., first:] = shown
        if painted is not None:
            mesh.attributes[..., :first] = painted
    return first


def _same(one, other):
    if one is other or type(one) is not type(other):
        return one is other
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(_same, one, other))
    if dataclasses.is_dataclass(one):
        return all(_same(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one))
    return one == other


class Scene:
    """What is drawn from: nothing of it is Blender's, so that it stays whatever becomes of the depsgraph."""

    def __init__(self, objects, light, made, sky, transparent, about, clip, notes, painted):
        self.objects, self.light, self.materials, self.sky, self.clip = objects, light, made, sky, clip
        self.transparent, self.subject = transparent, about
        self.notes = notes  # sentences about what is missing
        self.painted = painted  # whether the first attributes are controls

    def camera(self, view, projection):
        orthographic = projection[3, 3] == 1
        return Camera(cameras.rotation(view).ravel(), orthographic, 2 / projection[1, 1] if orthographic else 1,
                      0 if orthographic else self.subject.distance(view, projection))

    def layers(self, view, projection, frame, size, settings, threads=0, go_on=None):
        """({layer: picture}, Camera), as library.draw() takes them.

        view, projection: world -> camera and camera -> clip, 4 x 4; frame: the full frame in pixels and the place of
        the picture, of `size` (width, height), in it. Each layer is an array of its own. Cancelled: go_on(fraction)
        was False.
        """
        return background.run(self.steps(view, projection, frame, size, settings), threads, go_on)

    def steps(self, view, projection, frame, size, settings, clip=None):
        """The steps (pen/background.py) to what layers() gives; clip: of what looks at the scene, if not as it was
        read."""
        layers = yield from self._pictures(view, projection, frame, size, settings, clip or self.clip)
        for name in ("gloss", "emission", "index"):
            layers.pop(name)
        return layers, self.camera(view, projection)

    def pictures(self, view, projection, frame, size, settings, threads=0, go_on=None):
        """What layers() gives, and `gloss` and `emission`, colours that are not matt, and `index`, objects' pass
        indices."""
        return background.run(self._pictures(view, projection, frame, size, settings, self.clip), threads, go_on)

    def _pictures(self, view, projection, frame, size, settings, clip):
        objects = self.objects
        wanted = ["depth", "object", "material", "style", "marks", "shading"]
        if settings.wants_edges:
            wanted += ["normal", "creases"]
        if settings.wants_anchor:
            wanted.append("anchor")
        maps, looks, diffuse, through = yield from self._front(view, projection, frame, size, wanted, clip)
        instance = maps["object"].astype(np.int32)
        there = instance > 0
        layers = {"normal": maps["shading"], "marks": maps["marks"]}
        layers |= {name: maps[name][..., None] for name in ("depth", "material", "style")}
        if "anchor" in maps:
            layers["anchor"] = maps["anchor"]
        layers["object"], layers["index"] = (of[instance][..., None] for of in (objects.numbers, objects.owners))
        if self.painted:
            layers["controls"] = np.ascontiguousarray(maps["attributes"][..., :len(library.controls())])
        yield []
        if settings.wants_edges:
            layers["creases"] = np.concatenate([maps["creases"], overlay.bends(maps["normal"])[..., None]], 2)
            layers["creases"][through, 4] = -1  # no mesh tells of them
            yield []
        layers |= {name: looks[name] for name in ("color", "gloss", "emission")}
        layers["albedo"] = np.minimum(sum(looks[name] for name in ("color", "gloss", "emission")), np.float32(1))
        yield []
        layers["diffuse"] = self._from_camera(layers["normal"], view) if diffuse is None else diffuse
        layers["combined"] = combined = np.empty((*there.shape, 4), np.float32)
        combined[..., :3] = layers["color"] * layers["diffuse"] + layers["emission"]
        self._gloss(layers, looks["surface"][..., 1], view, projection, frame)
        combined[..., 3] = 1
        yield []
        layers["diffuse"] *= layers["color"].any(2, keepdims=True)  # as a renderer has it
        self._background(layers, ~there, view, projection, frame)
        if objects.catchers.any():
            caught = objects.catchers[instance]
            overlay.hide(layers, caught)
            self._background(layers, caught, view, projection, frame)
        return layers

    def _front(self, view, projection, frame, size, wanted, clip):
        """(rasterised pictures, looks, light or None) of what is in front and shows more than what lies behind it, and
        where something is seen through (height, width)."""
        objects, clear = self.objects, self.objects.clear.any()
        channels = max((mesh.attributes.shape[2] for mesh in objects.meshes if mesh.attributes is not None), default=0)

        def works(wanted, beyond=None):
            raster = library.load().raster_work(objects.meshes, view, projection, frame, size, *clip, channels,
                                                [*wanted, "attributes"] if channels else wanted, beyond)
            maps = raster.result()  # its arrays, which the others read
            return maps, [raster, library.load().material_work(
                self.materials, {**maps, "normal": maps["shading"]}, view, projection, frame)]

        def light(maps):
            if self.light.dark:
                return []
            return [self.light.work(maps["depth"][..., None], maps["shading"], view, projection, frame, clip)]

        maps, first = works(wanted)
        yield []
        _, looks, *diffuse = yield [*first, *([] if clear else light(maps))]
        open_ = objects.clear[maps["material"].astype(np.int32)] & (looks["surface"][..., 0] < _SHOWS)
        changed = open_.copy()
        if open_.any():
            yield from self._behind(maps, looks, open_, works)
            pixels = np.flatnonzero(changed)
            for name in ("marks", "creases"):  # there the rasteriser's lines are those of what is in front
                if name in maps:
                    overlay.without(maps[name], pixels)
        if clear:
            alpha = np.maximum(looks["surface"][..., :1], np.float32(_SHOWS))
            for name in ("color", "gloss", "emission"):
                np.divide(looks[name], alpha, out=looks[name])
            diffuse = yield light(maps)
        return maps, looks, diffuse[0] if diffuse else None, changed

    def _behind(self, maps, looks, open_, works):
        """Changes the pictures where `open_`: to what lies behind, until it shows."""
        objects, behind = self.objects, maps["depth"].copy()
        numbers = [name for name in _NUMBERS if name in maps]
        for _ in range(_MOST_BEHIND):
            behind[~open_] = 1e10
            more, those = works(numbers, behind)
            _, their = yield those
            for name in numbers:
                maps[name][open_] = more[name][open_]
            if "attributes" in maps:
                maps["attributes"][open_] = more["attributes"][open_]
            for name, picture in their.items():
                looks[name][open_] = picture[open_]
            behind = maps["depth"].copy()
            open_ &= objects.clear[maps["material"].astype(np.int32)] & (looks["surface"][..., 0] < _SHOWS)
            if not open_.any():
                break
        for name in numbers:  # of the rest there is nothing left to be seen
            maps[name][open_] = 1e10 if name == "depth" else 0
        for picture in looks.values():
            picture[open_] = 0

    def _from_camera(self, normal, view):
        towards = np.einsum("yxc,c->yx", normal, view[2, :3].astype(np.float32))
        return np.maximum(towards, 0)[..., None].repeat(3, 2)

    def same(self, other):
        """Whether another Scene looks the same from everywhere."""
        return all(_same(getattr(self, name), getattr(other, name)) for name in
                   ("materials", "sky", "transparent", "subject", "objects")) and self.light.same(other.light)

    def _gloss(self, layers, roughness, view, projection, frame):
        """Adds what is reflected: of things it is not known, so smooth surfaces reflect the sky, and rough ones are as
        bright as the light that falls there."""
        shape = roughness.shape
        pixels = np.flatnonzero(layers["gloss"].any(2))
        if not pixels.size:
            return
        gloss, light, normal, combined = (layers[name].reshape(-1, layers[name].shape[2]) for name in
                                          ("gloss", "diffuse", "normal", "combined"))
        rays = directions(view, projection, frame, pixels, shape[1])
        across = normal[pixels]
        mirrored = rays - 2 * np.einsum("nc,nc->n", rays, across)[:, None] * across
        rough = roughness.reshape(-1)[pixels, None]
        sky = self.sky.towards(mirrored)
        reflected = gloss[pixels] * (sky + rough * (light[pixels] - sky))
        combined[pixels, :3] += reflected
        layers["specular"] = np.zeros((*shape, 3), np.float32)
        layers["specular"].reshape(-1, 3)[pixels] = reflected

    def _background(self, layers, where, view, projection, frame):
        combined = layers["combined"]
        if self.transparent:
            combined[where] = 0
        else:
            pixels = np.flatnonzero(where)
            combined.reshape(-1, 4)[pixels, :3] = self.sky.seen(view, projection, frame, pixels, where.shape[1])
            combined.reshape(-1, 4)[pixels, 3] = 1
