# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of a picture without a renderer: a scene is read once, then drawn from any side by the library alone."""

import dataclasses

import bpy
import numpy as np

from ..pen import background, library, overlay
from ..pen.job import Camera
from ..pen.sky import Sky
from . import cameras, lamps, materials, meshes, subject, worlds


class Kept:
    """What need not be read again for the next Scene: meshes, and trees of triangles for the light.

    Of a new Scene and an older one that share it only the new one may be drawn.
    """

    def __init__(self):
        self.meshes, self.light = meshes.Kept(), lamps.Kept()

    def update(self, depsgraph):
        """Forgets what has another shape since the last evaluation. (An engine that has just been made is told of
        nothing: it begins with a Kept of its own.)"""
        self.meshes.drop({meshes.block_name(update.id) for update in depsgraph.updates if update.is_updated_geometry})


def read(depsgraph, settings, clip, kept=None, camera=None, shown=None):
    """The Scene of an evaluated depsgraph. On the main thread alone.

    clip: (start, end) of what looks at it; kept: a Kept; camera: the evaluated one whose focus tells what the picture
    is about, None: only the scene's size does; shown: whether an original object is, None: all are.
    """
    kept, scene = kept or Kept(), depsgraph.scene_eval
    light = lamps.Light(depsgraph, clip, kept.light, shown)
    objects = meshes.extract(depsgraph, settings.every[0]["object_index"] == "AUTO", None, light, kept.meshes, shown)
    light.tidy()
    notes = []
    if light.unknown:
        notes.append(f"drawn light leaves out {', '.join(light.unknown)}: only Cycles can read it")
    if light.dark:
        notes.append("no lamp and no world that can be drawn: a lamp shines from the camera")
    looks, unknown = _looks(depsgraph, objects.materials)
    if unknown:
        notes.append(f"in their viewport colour, as only Cycles can show them: {', '.join(unknown)}")
    try:
        sky = worlds.sky(scene.world)
    except worlds.Unknown as e:
        sky = Sky(np.array(scene.world.color))
        notes.append(f"the world in its viewport colour, as only Cycles can show its node {e}")
    return Scene(objects, light, looks, sky, scene.render.film_transparent, subject.read(depsgraph, camera), clip,
                 notes)


def _looks(depsgraph, names):
    """((n, 3, 3) colours, gloss and emission by number of material, ["material (node)"] that can't be shown)."""
    blocks = {block.name_full: block for block in depsgraph.ids if isinstance(block, bpy.types.Material)}
    looks, unknown = [], []
    for name in names:
        found, node = materials.look(blocks.get(name))
        looks.append((found.color, found.gloss, found.emission))
        if node:
            unknown.append(f"{name} ({node})")
    return np.array(looks, np.float32), unknown


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

    def __init__(self, objects, light, looks, sky, transparent, about, clip, notes):
        self.objects, self.light, self.looks, self.sky, self.clip = objects, light, looks, sky, clip
        self.transparent, self.subject = transparent, about
        self.notes = notes  # sentences about what is missing

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
        painted = any(mesh.attributes is not None for mesh in objects.meshes)
        channels = len(library.controls()) if painted else 0
        raster = library.load().raster_work(objects.meshes, view, projection, frame, size, *clip, channels,
                                            [*wanted, "attributes"] if painted else wanted)
        yield []
        maps = raster.result()  # its arrays, which light reads
        works = [raster]
        if not self.light.dark:
            works.append(self.light.work(maps["depth"][..., None], maps["shading"], view, projection, frame, clip))
        _, *diffuse = yield works
        instance, material = (maps[name].astype(np.int32) for name in ("object", "material"))
        there = instance > 0
        layers = {"normal": maps["shading"], "marks": maps["marks"]}
        layers |= {name: maps[name][..., None] for name in ("depth", "material", "style")}
        layers["object"], layers["index"] = (of[instance][..., None] for of in (objects.numbers, objects.owners))
        if painted:
            layers["controls"] = maps["attributes"]
        yield []
        if settings.wants_edges:
            layers["creases"] = np.concatenate([maps["creases"], overlay.bends(maps["normal"])[..., None]], 2)
            yield []
        looks = self.looks[material]
        looks[~there] = 0
        yield []
        layers |= {name: np.ascontiguousarray(looks[:, :, k]) for k, name in enumerate(("color", "gloss", "emission"))}
        layers["albedo"] = np.minimum(looks.sum(2), np.float32(1))
        yield []
        layers["diffuse"] = diffuse[0] if diffuse else self._from_camera(layers["normal"], view)
        layers["combined"] = combined = np.empty((*there.shape, 4), np.float32)
        # What is reflected, or shows through glass, is not known: as bright as the light that falls there.
        combined[..., :3] = (layers["color"] + layers["gloss"]) * layers["diffuse"] + layers["emission"]
        combined[..., 3] = 1
        yield []
        layers["diffuse"] *= layers["color"].any(2, keepdims=True)  # as a renderer has it
        self._background(layers, ~there, view, projection, frame)
        if objects.catchers.any():
            caught = objects.catchers[instance]
            overlay.hide(layers, caught)
            self._background(layers, caught, view, projection, frame)
        return layers

    def _from_camera(self, normal, view):
        towards = np.einsum("yxc,c->yx", normal, view[2, :3].astype(np.float32))
        return np.maximum(towards, 0)[..., None].repeat(3, 2)

    def same(self, other):
        """Whether another Scene looks the same from everywhere."""
        return all(_same(getattr(self, name), getattr(other, name)) for name in
                   ("looks", "sky", "transparent", "subject", "objects")) and self.light.same(other.light)

    def _background(self, layers, where, view, projection, frame):
        combined = layers["combined"]
        if self.transparent:
            combined[where] = 0
        else:
            pixels = np.flatnonzero(where)
            combined.reshape(-1, 4)[pixels, :3] = self.sky.seen(view, projection, frame, pixels, where.shape[1])
            combined.reshape(-1, 4)[pixels, 3] = 1
