# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain picture and two looks of one moment, in three quadrants of a 3D view.

All three come of one reading of the scene and are shown at once, so that neither look is ahead of the other; layers are
drawn once, and for textures with lines in them only what these change.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...pen import colour, shown
from ...pen.around import Window
from ...pen.shown import Drawing
from .. import eye, fast, live, looks, pictures

FEWEST = 10   # pictures a second that are enough
_SMALLEST = 1 / 2  # of a quadrant's size, in flights


@dataclass(frozen=True)
class Look:
    """What one of the two is drawn by: as looks.own() takes it, or with lines between colors in the textures."""

    name: str           # how files of sessions name it
    of: str = looks.SCENE
    baked: bool = False

    def settings(self, scene, thickness):
        return looks.own(scene, self.of, thickness, ("line_color_strength",) if self.baked else ())


def named(name):
    """The Look of a word: dynamic, baked, plain, or a preset. EncreError: there is none."""
    word = name.strip()
    known = {"dynamic": Look("DYNAMIC"), "baked": Look("BAKED", baked=True), "plain": Look("PLAIN", looks.PLAIN)}
    if word.lower() in known:
        return known[word.lower()]
    from ...pen import presets

    return Look(presets.find(word).id.upper().replace(" ", "_").replace(",", "_"), word)


class _Both:
    """What is read and drawn for the settings of several looks at once. painted: the fast_scene.Scene whose textures
    have lines in them, if a look wants it."""

    def __init__(self, of):
        self.of, self.painted = of, None

    @cached_property
    def every(self):
        return [values for settings in self.of for values in settings.every]

    @cached_property
    def rastered(self):
        return tuple(dict.fromkeys(name for settings in self.of for name in settings.rastered))

    @cached_property
    def hidden(self):
        return max(settings.hidden for settings in self.of)

    @cached_property
    def flat(self):
        """Images are as they are where a look has them so: all looks are drawn from the same."""
        return tuple(min(most) for most in zip(*(settings.flat for settings in self.of), strict=True))

    @cached_property
    def sky_colors(self):
        return min(settings.sky_colors for settings in self.of)

    @cached_property
    def layers_key(self):
        return tuple(settings.layers_key for settings in self.of)

    def turns(self, frame):
        return frozenset().union(*(settings.turns(frame) for settings in self.of))

    def load(self, read):
        return {chosen: pixels for settings in self.of for chosen, pixels in settings.load(read).items()}

    def __getattr__(self, name):
        if not name.startswith("wants_") and name not in ("shadows_world", "planes", "facets"):
            raise AttributeError(name)
        return max(getattr(settings, name) for settings in self.of)


@dataclass(frozen=True)
class _Wish:
    """As pen.shown has it: which looks are shown, from left to right."""

    sides: tuple
    thickness: float
    filmed: int | None  # a picture of a film is drawn anew, though it may be what is shown
    show: str = "FINAL"


class Quadrants(live.View):
    """A live.View of a stage (stage.py), which says where the camera is and what is shown."""

    stage = None  # the one that goes on; a view keeps its own, as pictures may be on their way when it is over

    def __init__(self, engine, threads):
        super().__init__(engine, threads)
        self.stage = type(self).stage
        self.thickness = None
        self.painted = {}  # thickness -> fast_scene.Scene whose textures have lines in them
        self.film = self.filmed = None  # the picture of a flight that was drawn beforehand, and its textures

    # What is seen

    def draw(self, context, depsgraph):
        film = self.stage.film_picture()
        if film is None:
            super().draw(context, depsgraph)
            self.stage.drawn(self)
            return
        if film is not self.film:
            self.film, self.filmed = film, self._upload([linear(pane) for pane in film])
            self.stage.took(1.0)
        _show(self.filmed, context.region, self._order())

    def _eye(self, context, depsgraph):
        region, scene = context.region, depsgraph.scene
        width, height = max(region.width // 2, 4), max(region.height // 2, 4)
        self.region = region
        camera = scene.camera.evaluated_get(depsgraph)
        view, projection = self.stage.eye(width, height, depsgraph)
        clip = camera.data.clip_start, camera.data.clip_end
        if self.thickness != self.stage.session.thickness:
            self.stale, self.thickness = True, self.stage.session.thickness
        return eye.Eye(view, projection, clip, (width, height), Window(0, 0, width, height), (-1, -1, 1, 1), True,
                       scene.frame_current), camera

    def _wish(self, _settings):
        return _Wish(self.stage.session.sides, self.stage.session.thickness, self.stage.filmed)

    def _quick(self):
        if self.stage.filming:
            return self.scale
        return max(super()._quick(), _SMALLEST * self.scale if self.stage.flies else 0)

    def hurries(self):
        """Whether a picture is on its way that is not given up when the camera moves."""
        return self.picture is not None and not self.picture.ended and self.picture.scale <= self._quick()

    def _order(self):
        """Numbers of the panes: upper left, lower left, lower right; 0 is the plain one."""
        names = [look.name for look in self.stage.looks]
        return [0, *(1 + names.index(name) for name in self.stage.session.sides)]

    def _take(self, picture):
        image = picture.image
        super()._take(picture)
        if image is not None:
            self.stage.took(picture.scale / self.scale)
            self.stage.pictured(image, self.what.now == self._now() and self.what.scale == self.scale)

    def _upload(self, image):
        return [super(Quadrants, self)._upload(pane) for pane in image]

    def _show(self):
        _show(self.texture, self.region, self._order())

    # What is drawn

    def _settings(self, scene):
        return _Both([look.settings(scene, self.stage.session.thickness) for look in self.stage.looks])

    def _read(self, context, depsgraph, camera):
        super()._read(context, depsgraph, camera)
        if self.scene is None or self.settings is None:
            return
        if self.painted.get("scene") is not self.scene:
            self.painted = {"scene": self.scene}
        thickness = self.stage.session.thickness
        if any(look.baked for look in self.stage.looks) and thickness not in self.painted:
            others = self.stage.textures(thickness)
            self.painted[thickness] = fast.repainted(self.scene, depsgraph,
                                                     pictures.Instead(self.kept.images, others))
        self.settings.painted = self.painted.get(thickness)

    def _key(self):
        return *super()._key(), self.wish.thickness

    def _drawn(self, scene, where, frame, size, settings, sharp):
        """(layers of each look, Camera)."""
        def steps(scene):
            return scene.steps(where.view, where.projection, frame, size, settings, where.clip, sharp)

        done = []
        layers, camera = yield from _noting(steps(scene), done)
        other = None
        if settings.painted:  # not this view's, which may be others by now
            other, _ = yield from _again(steps(settings.painted), done)
        return [other if look.baked else layers for look in self.stage.looks], camera, layers["combined"]

    def _image(self, known, frame, settings, pictures, _wish):
        of_looks, camera, plain = known.drawn
        panes = [plain]
        for layers, own in zip(of_looks, settings.of, strict=True):
            panes.append((yield from shown.picture(Drawing(layers, camera, frame, own, pictures), shown.Wish())))
        return panes


def _show(textures, region, order):
    from .. import screen

    width, height = max(region.width // 2, 4), max(region.height // 2, 4)
    places = ((0, region.height - height), (0, 0), (region.width - width, 0))
    for pane, (x, y) in zip(order, places, strict=True):
        screen.show(textures[pane], (2 * x / region.width - 1, 2 * y / region.height - 1,
                                     2 * (x + width) / region.width - 1, 2 * (y + height) / region.height - 1))


_SHARED = ("raster", "light")  # kinds of works whose pictures no texture's colors change


def _noting(steps, done):
    """Steps as they are; `done` gets what works of shared kinds drew, before others change it."""
    results = None
    while True:
        try:
            works = steps.send(results)
        except StopIteration as end:
            return end.value
        results = yield works
        done += [_kept(work) for work in works if work.kind in _SHARED]


def _again(steps, done):
    """Steps that draw the same with other colors of textures: works of shared kinds get what was drawn before."""
    results, done = None, iter(done)
    while True:
        try:
            works = steps.send(results)
        except StopIteration as end:
            return end.value
        results = []
        for work in works:  # one by one: light may read what a material has drawn
            if work.kind not in _SHARED or not _filled(work, next(done, None)):
                yield [work]
            results.append(work.result())
        if not works:
            yield []


def _arrays(work):
    """{name: array} of all that a work fills."""
    drawn = work.result()
    if work.kind == "raster":
        return {name: array for name, array in drawn.items() if array.size}
    _, _, _, shine, specular, *_ = work.keep
    return {"diffuse": drawn, **({} if shine is None or specular is None else {"specular": specular})}


def _kept(work):
    shine = work.keep[3] if work.kind == "light" else None
    return work.kind, {name: array.copy() for name, array in _arrays(work).items()}, \
        None if shine is None else shine.copy()


def _filled(work, kept):
    """Whether it could be filled."""
    if kept is None or kept[0] != work.kind:
        return False
    arrays = _arrays(work)
    if arrays.keys() != kept[1].keys() or any(array.shape != kept[1][name].shape for name, array in arrays.items()):
        return False
    if work.kind == "light" and kept[2] is not None and not np.array_equal(kept[2], work.keep[3]):
        return False  # a texture tints highlights
    for name, array in arrays.items():
        array[...] = kept[1][name]
    return True


# ---- pictures that are kept --------------------------------------------------------------------------------------


@np.errstate(invalid="ignore")
def encoded(pane):
    """A picture, scene-linear, as bytes of sRGB (height, width, 3)."""
    color = np.clip(np.nan_to_num(pane[..., :3] + (1 - pane[..., 3:])), 0, 1)
    return (colour.encode_srgb(color) * 255 + 0.5).astype(np.uint8)


_LINEAR = np.array([colour.decode_srgb(value / 255) for value in range(256)], np.float32)


def linear(pane):
    """encoded() back: float32 (height, width, 4)."""
    out = np.ones((*pane.shape[:2], 4), np.float32)
    out[..., :3] = _LINEAR[pane]
    return out
