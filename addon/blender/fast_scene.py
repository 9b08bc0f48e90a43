# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that fast.read() has read, drawn from any side by the library alone."""

import dataclasses

import numpy as np

from ..pen import abi, background, chains, library, overlay
from ..pen.irradiance import polynomials
from ..pen.job import Camera
from ..pen.sky import directions
from . import cameras, colored, mirrors

_SHOWS = 0.5         # alpha from which on a surface is there, as Blender's threshold is
_MOST_BEHIND = 8     # surfaces that are looked through, one after the other
_NUMBERS = ("depth", "object", "material", "style", "shading", "normal", "anchor", "tangent", "card")


def _same(one, other):
    if one is other or type(one) is not type(other):
        return one is other
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_same(value, other[key]) for key, value in one.items())
    if dataclasses.is_dataclass(one):
        return all(_same(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one))
    return one == other


def _any(color):
    """Whether any of three channels is not 0; any() over a last axis as short takes ten times as long."""
    red, green, blue = np.moveaxis(color, 2, 0)
    return (red != 0) | (green != 0) | (blue != 0)


def _facing(normal, looks):
    """Normals (height, width, 3) with those of normal maps."""
    if "turned" not in looks:
        return normal
    return np.where(_any(looks["turned"])[..., None], looks["turned"], normal)


class Scene:
    """What is drawn from: nothing of it is Blender's, so that it stays whatever becomes of the depsgraph."""

    def __init__(self, objects, light, made, sky, backdrop, transparent, about, clip, notes, painted, channels, through,
                 shines, turned, holes, lit, told, first, looked, fogs=()):
        self.objects, self.light, self.materials, self.sky, self.clip = objects, light, made, sky, clip
        self.backdrop = backdrop  # the sky where nothing is in front of it
        self.transparent, self.subject = transparent, about
        self.notes = notes  # sentences about what is missing
        self.painted = painted  # whether the first attributes are controls
        self.channels = channels  # of attributes; those that a mesh has not are 0
        self.through = through  # by number of material: whether light goes through it
        self.shines = shines and light.lamps > 0  # whether lamps make highlights on anything
        self.turned = turned  # whether a normal map turns anything
        self.fogs = fogs  # volumes.Fogs, through which things are seen
        self.told, self.first, self.looked = told, first, looked
        self.lit = lit  # number of a material that reads the light on it -> the first of three attributes
        self._looks = [name for name in abi.MATERIAL_OUTPUTS
                       if {"shine": self.shines, "turned": turned, "holdout": holes}.get(name, True)]

    def camera(self, view, projection):
        orthographic = projection[3, 3] == 1
        return Camera(cameras.rotation(view).ravel(), orthographic, 2 / projection[1, 1],
                      0 if orthographic else self.subject.distance(view, projection), self.subject.light,
                      self.subject.shade)

    def layers(self, view, projection, frame, size, settings, threads=0, go_on=None):
        """({layer: picture}, Camera), as library.draw() takes them.

        view, projection: world -> camera and camera -> clip, 4 x 4; frame: the full frame in pixels and the place of
        the picture, of `size` (width, height), in it. Each layer is an array of its own. Cancelled: go_on(fraction)
        was False.
        """
        return background.run(self.steps(view, projection, frame, size, settings), threads, go_on)

    def steps(self, view, projection, frame, size, settings, clip=None, sharp=False):
        """The steps (pen/background.py) to what layers() gives; clip: of what looks at the scene, if not as it was
        read; sharp: whether shadows are those of lamps without a size, which are drawn in less time."""
        layers = yield from self._pictures(view, projection, frame, size, settings, clip or self.clip, sharp)
        for name in ("emission", "index"):
            layers.pop(name)
        return layers, self.camera(view, projection)

    def pictures(self, view, projection, frame, size, settings, threads=0, go_on=None):
        """What layers() gives, and `gloss` and `emission`, colours that are not matt, and `index`, objects' pass
        indices."""
        return background.run(self._pictures(view, projection, frame, size, settings, self.clip), threads, go_on)

    def _pictures(self, view, projection, frame, size, settings, clip, sharp=False):
        objects = self.objects
        wanted = ["depth", "object", "material", "style", "shading", *settings.rastered]
        lines = None
        if settings.wants_edges:
            wanted_colors = settings.wants_color_lines or self.painted
            told = self.told if wanted_colors or objects.clear.any() else None
            shown = told and (yield from colored.colors(told, settings.every, self.looked, self.materials, self.first))
            told, shown, cuts = (told, shown, told) if wanted_colors else (None, None, told)
            known, whole = objects.chained(told, cuts)
            (lines,) = yield [library.load().chains_work(known, view, projection, frame, size, *(clip or self.clip),
                                                         most_before=settings.hidden, colors=shown)]
        lit = np.zeros((*size[::-1], 3), np.float32) if self.shines else None
        maps, looks, diffuse = yield from self._front(view, projection, frame, size, wanted, clip, sharp, lit)
        instance = maps["object"].astype(np.intp)
        there = instance > 0
        layers = {"normal": maps["shading"]}
        layers |= {name: maps[name][..., None] for name in ("depth", "material", "style")}
        layers |= {name: maps[name] for name in ("anchor", "tangent", "card") if name in maps}
        layers["object"], layers["index"] = (of.take(instance, mode="clip")[..., None] for of in
                                               (objects.numbers, objects.owners))
        if lines is not None:
            layers["chains"] = chains.told(lines, objects.numbers, whole)
        if self.painted:
            layers["controls"] = np.ascontiguousarray(maps["attributes"][..., :len(library.controls())])
        yield []
        light = self._from_camera(_facing(layers["normal"], looks), view) if diffuse is None else diffuse
        yield from self._by_light(maps, looks, light, view, projection, frame)
        layers |= {name: looks[name] for name in ("color", "gloss", "emission")}
        if self.light.exposure != 1:
            layers["emission"] = layers["emission"] * np.float32(self.light.exposure)
        if self.fogs:
            clear, fog = self._fog(maps["depth"], view, projection, frame)
            for name in ("color", "gloss"):
                layers[name] = layers[name] * clear
            layers["emission"] = np.where(there[..., None], layers["emission"] * clear + fog, layers["emission"])
        mirrors = layers["gloss"]
        if lit is not None:
            layers["highlights"], layers["gloss"] = lit, np.maximum(mirrors, looks["shine"][..., :3])
            layers["gloss"] += looks["shine"][..., 4:5]
        layers["albedo"] = albedo = layers["color"] + layers["gloss"]
        glows = layers["emission"].any()
        if glows:
            albedo += layers["emission"]
        np.minimum(albedo, np.float32(1), out=albedo)
        yield []
        normal = _facing(layers["normal"], looks)
        layers["diffuse"] = light
        layers["combined"] = combined = np.empty((*there.shape, 4), np.float32)
        np.multiply(layers["color"], layers["diffuse"], out=combined[..., :3])
        if glows:
            combined[..., :3] += layers["emission"]
        shown = yield from self._mirrored(layers, maps, looks, view, projection, frame, size, clip,
                                          sharp)
        if not settings.wants_seen:  # nor do files have it then
            for name in ("seen_color", "seen_depth", "seen_normal"):
                layers.pop(name, None)
        self._gloss(layers, normal, mirrors, looks["surface"][..., 1], view, projection, frame, shown)
        if lit is not None:
            layers["specular"] = layers["specular"] + lit if "specular" in layers else lit.copy()
            combined[..., :3] += lit
        combined[..., 3] = 1
        yield []
        caught = objects.catchers[instance] if objects.catchers.any() else np.zeros(1, bool)
        if caught.any():
            shade = yield from self._caught(maps, looks, light, view, projection, frame, clip, sharp)
        fallen = layers["diffuse"][caught] if caught.any() else None
        layers["diffuse"] *= _any(layers["color"])[..., None]  # as a renderer has it
        self._background(layers, ~there, view, projection, frame)
        if self.fogs and not self.transparent:
            combined[~there, :3] = combined[~there, :3] * clear[~there] + fog[~there]
        if caught.any():
            layers["diffuse"][caught] = fallen
            overlay.hide(layers, caught, caught & (shade.mean(-1) < overlay.SHADED))
            self._background(layers, caught, view, projection, frame)
            if self.transparent:
                combined[caught, 3] = np.maximum(combined[caught, 3], 1 - shade[caught].mean(1))
            else:
                combined[caught, :3] *= shade[caught]
        if objects.holdouts.any() or "holdout" in looks:
            holes = objects.holdouts[instance].astype(np.float32)
            if "holdout" in looks:
                np.maximum(holes, np.minimum(looks["holdout"][..., 0], 1), out=holes)
            overlay.hide(layers, holes >= _SHOWS)
            combined *= 1 - holes[..., None]
        return layers

    def _front(self, view, projection, frame, size, wanted, clip, sharp, lit):
        """(rasterised pictures, looks, light or None) of what is in front and shows more than what lies behind it. lit:
        gets the lamps' highlights, None: there are none."""
        objects, clear = self.objects, self.objects.clear.any()

        works = self._works_of(view, projection, frame, size, clip)

        def light(depth, looks):
            if self.light.dark:
                return []
            return [self.light.work(depth[..., None], maps["shading"], view, projection, frame, clip, sharp,
                                    shine=looks.get("shine"), specular=lit, turned=looks.get("turned"))]

        maps, first = works(wanted)
        yield []
        later = clear or objects.thick.any()
        _, looks, *diffuse = yield [*first, *([] if later else light(maps["depth"], first[1].result()))]
        open_ = objects.clear[maps["material"].astype(np.int32)] & (looks["surface"][..., 0] < _SHOWS)
        glow = None
        if open_.any():
            glow = looks["emission"] * open_[..., None]  # it adds to what is behind
            yield from self._behind(maps, looks, open_, works, glow)
        if clear:
            alpha = np.maximum(looks["surface"][..., :1], np.float32(_SHOWS))
            for name in ("color", "gloss", "emission", *({"shine", "holdout"} & looks.keys())):
                if name == "shine":
                    looks[name][..., (0, 1, 2, 4)] /= alpha
                else:
                    np.divide(looks[name], alpha, out=looks[name])
            if glow is not None:
                looks["emission"] += glow
        if later:
            depth = yield from self._lit_depth(maps, view, projection, frame, size, clip)
            diffuse = yield light(depth, looks)
        return maps, looks, diffuse[0] if diffuse else None

    def _works_of(self, view, projection, frame, size, clip):
        """A function of what is wanted, and beyond what: (pictures that the rasteriser fills, the works that do and
        tell what materials look like)."""
        channels = self.channels
        meshes = [mesh if ribbons is None else ribbons.turned(mesh, view, projection)
                  for mesh, ribbons in zip(self.objects.meshes, self.objects.ribbons, strict=True)]

        def works(wanted, beyond=None):
            raster = library.load().raster_work(meshes, view, projection, frame, size, *clip, channels,
                                                [*wanted, "attributes"] if channels else wanted, beyond)
            maps = raster.result()  # its arrays, which the others read
            return maps, [raster, library.load().material_work(
                self.materials, {**maps, "normal": maps["shading"]}, view, projection, frame,
                self._looks)]

        return works

    def _caught(self, maps, looks, light, view, projection, frame, clip, sharp):
        """The steps to the share of the light (height, width, 3) that shadows leave."""
        if self.light.dark:
            return np.ones_like(light)
        (whole,) = yield [self.light.work(maps["depth"][..., None], maps["shading"], view, projection, frame, clip,
                                          sharp, turned=looks.get("turned"), unshadowed=True)]
        share = np.divide(light, whole, out=np.ones_like(light), where=whole > 0)
        return np.minimum(share, 1, out=share)

    def _lit_depth(self, maps, view, projection, frame, size, clip):
        """The steps to where light falls (height, width): on strands as they are to lamps, tubes."""
        tubes = [mesh for mesh, ribbons in zip(self.objects.meshes, self.objects.ribbons, strict=True) if ribbons]
        if not tubes:
            return maps["depth"]
        (round_,) = yield [library.load().raster_work(tubes, view, projection, frame, size, *clip, 0,
                                                      ["depth", "object"])]
        depth, number = maps["depth"], maps["object"]
        near = np.abs(round_["depth"] - depth) < 1.5 * self.objects.thick[number.astype(np.intp)]
        return np.where(near & (round_["object"] == number), round_["depth"], depth)

    def _behind(self, maps, looks, open_, works, glow=None):
        """Changes the pictures where `open_`: to what lies behind, until it shows. glow: gets the light of all that is
        looked through."""
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
            if glow is not None:
                glow += looks["emission"] * open_[..., None]
        for name in numbers:  # of the rest there is nothing left to be seen
            maps[name][open_] = 1e10 if name == "depth" else 0
        for picture in looks.values():
            picture[open_] = 0

    def _by_light(self, maps, looks, light, view, projection, frame):
        """The steps that change the looks of what is as the light on it has it."""
        if not self.lit:
            return
        number = maps["material"].astype(np.int32)
        where = np.isin(number, list(self.lit)) & (maps["object"] > 0)
        if not where.any():
            return
        for material, first in self.lit.items():
            here = number == material
            maps["attributes"][here, first:first + 3] = light[here] / np.float32(self.light.exposure or 1)
        (found,) = yield [library.load().material_work(
            self.materials, {**maps, "normal": maps["shading"]}, view, projection, frame,
            ["color", "gloss", "emission", "surface"])]
        alpha = np.maximum(found["surface"][..., :1], np.float32(_SHOWS))
        for name in ("color", "gloss", "emission"):
            looks[name][where] = (found[name] / alpha)[where]

    def _mirrored(self, layers, maps, looks, view, projection, frame, size, clip, sharp):
        """(where flat mirrors are, what they show there); the layers get what is seen in them."""
        found = mirrors.find(maps, looks, self.through, view, projection, frame)
        where, shown = np.zeros(maps["depth"].shape, bool), None
        for mirror in found:
            behind, beyond = view @ mirror.turn, np.where(mirror.where, maps["depth"], np.float32(1e10))
            works = self._works_of(behind, projection, frame, size, clip)
            theirs, first = works(["depth", "object", "material", "shading"], beyond)
            _, look = yield first
            open_ = self.objects.clear[theirs["material"].astype(np.int32)] & (look["surface"][..., 0] < _SHOWS)
            if open_.any():
                yield from self._behind(theirs, look, open_, works)
            light = self._from_camera(theirs["shading"], behind)
            if not self.light.dark:
                depth = yield from self._lit_depth(theirs, behind, projection, frame, size, clip)
                (light,) = yield [self.light.work(depth[..., None], theirs["shading"], behind, projection, frame, clip,
                                                  sharp, turned=look.get("turned"))]
            yield from self._by_light(theirs, look, light, behind, projection, frame)
            if shown is None:
                shown = np.zeros_like(layers["color"])
                layers["seen_color"], layers["seen_depth"] = layers["color"].copy(), layers["depth"].copy()
                layers["seen_normal"] = layers["normal"].copy()
            picture = (look["color"] + look["gloss"]) * light + look["emission"] * np.float32(self.light.exposure)
            pixels = np.flatnonzero(mirror.where & (theirs["object"] == 0))
            picture.reshape(-1, 3)[pixels] = self.sky.seen(behind, projection, frame, pixels, size[0])
            for name, new in (("seen_color", look["color"]), ("seen_depth", theirs["depth"][..., None]),
                              ("seen_normal", theirs["shading"])):
                layers[name][mirror.where] = new[mirror.where]
            shown[mirror.where] = picture[mirror.where]
            where |= mirror.where
        if shown is not None:
            layers["seen_normal"] = layers["seen_normal"] @ view[:3, :3].T.astype(np.float32)
            layers["seen_depth"][layers["seen_depth"] >= 1e9] = 0
        return where, shown

    def _fog(self, depth, view, projection, frame):
        """(the share of light that comes through what is foggy before each pixel, the light that comes from it)."""
        pixels = np.arange(depth.size)
        rays = directions(view, projection, frame, pixels, depth.shape[1])
        eye, ahead = -view[:3, :3].T @ view[:3, 3], -(rays @ view[2, :3])
        if projection[3, 3] == 1:  # each pixel has an eye of its own
            row, column = np.divmod(pixels, depth.shape[1])
            right = (2 * (column + frame.x + 0.5) / frame.width - 1 - projection[0, 3]) / projection[0, 0]
            up = (1 - 2 * (row + frame.y + 0.5) / frame.height - projection[1, 3]) / projection[1, 1]
            eye = eye + np.stack([right, up], 1) @ view[:2, :3]
        depths = np.minimum(depth.reshape(-1), 1e10) / np.maximum(ahead, 1e-6)
        clear, fog = np.ones((depth.size, 1)), np.zeros((depth.size, 3))
        for one in self.fogs:
            through = np.exp(-one.density * one.length(eye, rays, depths))[:, None]
            clear, fog = clear * through, fog * through + (1 - through) * one.color
        return (np.float32(a.reshape(*depth.shape, -1)) for a in (clear, fog))

    def _from_camera(self, normal, view):
        towards = np.einsum("yxc,c->yx", normal, view[2, :3].astype(np.float32))
        return np.maximum(towards, 0)[..., None].repeat(3, 2)

    def same(self, other):
        """Whether another Scene looks the same from everywhere."""
        return all(_same(getattr(self, name), getattr(other, name)) for name in
                   ("materials", "sky", "backdrop", "transparent", "subject", "objects", "fogs")
                   ) and self.light.same(other.light)

    def _gloss(self, layers, normal, mirrors, roughness, view, projection, frame, flat):
        """Adds what is reflected: of things it is known in flat mirrors alone, so other smooth surfaces reflect the
        sky, and rough ones are as bright as the light that falls there."""
        shape = roughness.shape
        pixels = np.flatnonzero(_any(mirrors))
        if not pixels.size:
            return
        light, combined = (layers[name].reshape(-1, layers[name].shape[2]) for name in ("diffuse", "combined"))
        rays = directions(view, projection, frame, pixels, shape[1])
        across = normal.reshape(-1, 3)[pixels]
        mirrored = rays - 2 * np.einsum("nc,nc->n", rays, across)[:, None] * across
        rough = roughness.reshape(-1)[pixels, None]
        sky, (where, shown) = self.sky.towards(mirrored), flat
        blurred = light[pixels]
        if self.shines:
            world = self.light.world
            blurred = 0 if world is None else np.maximum(polynomials(mirrored) @ world, 0).astype(np.float32)
        if shown is not None:
            flat = where.reshape(-1)[pixels]
            sky[flat] = shown.reshape(-1, 3)[pixels[flat]]
        reflected = mirrors.reshape(-1, 3)[pixels] * (sky + rough * (blurred - sky))
        combined[pixels, :3] += reflected
        layers["specular"] = np.zeros((*shape, 3), np.float32)
        layers["specular"].reshape(-1, 3)[pixels] = reflected

    def _background(self, layers, where, view, projection, frame):
        combined, glow = layers["combined"], layers["emission"]
        if self.transparent:
            combined[where] = 0
        else:
            if self.backdrop.even:
                # A pixel is copied as a whole: four channels one by one take three times as long.
                one = np.array((*self.backdrop.color, 1), np.float32).view(np.complex128)
                np.copyto(combined.view(np.complex128)[..., 0], one[0], where=where)
            else:
                pixels = np.flatnonzero(where)
                seen = self.backdrop.seen(view, projection, frame, pixels, where.shape[1])
                combined.reshape(-1, 4)[pixels, :3] = seen
                np.copyto(combined[..., 3], 1, where=where)
        if self.objects.clear.any():  # light that is looked through
            combined[where, :3] += glow[where]
