# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered 3D view: fast layers -> stages -> a texture, while Blender's main thread goes on.

Blender makes an engine for each region in Rendered mode, and drops it with the mode; each has one View. view_update
only tells it what has changed. view_draw reads what is new of the scene, begins a picture, and draws the last one that
is finished; it never waits. The library draws in the background; a timer looks whether it has done a step of a
picture, gives it the next, and asks for a redraw when there is a picture.

While something moves pictures are as small as they must be to be there in time, and none of those is given up, or a
moving view would show none; shadows have hard edges then. At rest a whole one follows, which ends at once when
something moves again.
"""

import contextlib
import itertools
import time
import traceback
import weakref
from dataclasses import dataclass

import bpy

from ..pen import library, shown
from ..pen.background import Background
from ..pen.errors import Cancelled, EncreError
from ..pen.shown import Drawing, Wish
from . import eye, fast, images, looks, pictures, unread

_BUDGET = 1 / 15  # seconds that a picture may take while something moves
_SMALLER = (1, 1 / 2, 1 / 4)
_SLICE = 0.004    # seconds that the main thread may work at a time
_TICK = 0.002

_numbers = itertools.count(1)  # of layers
others = {}  # 3D space, as a pointer -> the class of View that draws there
_views = weakref.WeakSet()  # that have a picture on its way


def _tick():
    for view in list(_views):
        if not view.tick():
            _views.discard(view)
    return _TICK if len(_views) else None


@dataclass
class _Now:
    """What a picture shows; equal ones are the same picture, up to its size."""

    scene: int     # numbers of what was read, which grow
    settings: int
    eye: tuple
    turns: frozenset  # of pens that draw anew while an animation runs
    wish: Wish


class _Picture:
    """A picture on its way: steps that yield lists of works, or [] to take breath, and return it."""

    def __init__(self, behind, now, where, scale, steps):
        self.behind, self.now, self.where, self.scale, self.steps = behind, now, where, scale, steps
        self.waits = self.cancelled = self.ended = False
        self.image = self.failure = None

    def go_on(self):
        """Does what can be done now, for no longer than a slice. Whether it has ended."""
        until, results = time.perf_counter() + _SLICE, None
        try:
            while not self.ended:
                if self.waits:
                    results = self.behind.poll()
                    if results is None:
                        return False
                    self.waits = False
                if self.cancelled:
                    break
                works, results = self.steps.send(results), None
                if works:
                    self.behind.start(works)
                    self.waits = True
                elif time.perf_counter() > until:
                    return False
        except StopIteration as end:
            self.image = end.value
        except Cancelled:
            pass
        except Exception as error:
            self.failure = sentence(error)
        self.ended, self.steps = True, None  # steps hold the view
        return True

    def cancel(self):
        self.cancelled = True
        self.behind.cancel()


@dataclass
class _Layers:
    """Layers of a size that were drawn last, for pictures of which only settings differ."""

    key: tuple    # of what they are
    drawn: tuple  # (layers, camera)
    same: int     # number of theirs


class View:
    """One region's picture."""

    def __init__(self, engine, threads):
        self.engine = weakref.ref(engine)
        self.kept, self.stale = fast.Kept(), True  # stale: something has changed since it was read
        self.changed, self.beside = True, None     # whether that is more than settings; unread.beside() as it was read
        self.scene = self.settings = self.failure = None
        self.images, self.turn = {}, None  # that the settings read; pictures.turn() as it was looked at
        self.own = looks.SCENE             # the look that it has
        self.failed = None              # the _Now that could not be drawn
        self.read_number = self.settings_number = 0
        self.look = self.wish = self.scale = None
        self.behind = Background(threads)
        self.picture = self.texture = self.what = None  # what: the _Picture that the texture shows
        self.layers = {}                # (scale, whether shadows have hard edges) -> _Layers
        self.costs = {}                 # (scale, whether layers are drawn) -> seconds of the last such picture

    # By Blender's hooks

    def update(self, depsgraph):
        """Notes what has changed. It is read when it is drawn: there may be several changes until then."""
        self.kept.update(depsgraph)
        self.stale, self.changed = True, self.changed or not unread.settings_alone(depsgraph)
        self.redraw()  # a change by a script brings none

    def draw(self, context, depsgraph):
        from . import screen

        try:
            self._step(context, depsgraph)
            failure = self.failure
        except Exception as error:
            failure = sentence(error)
        if self.texture:
            self._show()
        lines = [(failure, (1, 0.25, 0.2))] if failure else self._legend()
        screen.say(context.region, lines, context.preferences.system.ui_scale, grounded=bool(failure))

    def tick(self):
        """Goes on with the picture. Whether there is one that has not ended."""
        picture = self.picture
        if picture and self.engine() is None:
            picture.cancel()
        if not picture or not picture.go_on():
            return bool(picture)
        if picture.cancelled and not self.stale:
            self._begin()
            return bool(self.picture)
        self.redraw()
        return False

    def redraw(self):
        with contextlib.suppress(ReferenceError, AttributeError):  # Blender has taken the engine away
            self.engine().tag_redraw()

    # What it does

    def _step(self, context, depsgraph):
        """Takes a picture that is finished, reads what is new, begins the next picture."""
        picture, before = self.picture, self.look and self.look.through_camera
        self.look, camera = self._eye(context, depsgraph)
        settings, own = context.space_data.shading.encre, self.own
        self.wish, self.own = self._wish(settings), settings.look
        self.scale = depsgraph.scene_eval.encre.viewport_scale / 100
        if picture and picture.go_on():
            self._take(picture)
        if self.look is None:
            self.texture = None
            return
        before, self.turn = (before, self.turn), pictures.turn()
        if before != (self.look.through_camera, self.turn):  # a camera's focus counts
            self.stale = self.changed = True
        self.stale = self.stale or own != self.own
        if self.picture and self.picture.scale > self._quick() and (self.stale or self.picture.now != self._now()):
            self.picture.cancel()
        if self.picture:
            _wake(self)
            return
        if self.stale:
            self._read(context, depsgraph, camera)
        self._begin()

    def _eye(self, context, depsgraph):
        return eye.look(context, depsgraph)

    def _wish(self, settings):
        return Wish(settings.show, settings.control)

    def _show(self):
        from . import screen

        screen.show(self.texture, self.what.where.place)

    def _upload(self, image):
        from . import screen

        return screen.upload(image)

    def _take(self, picture):
        self.picture = None
        if picture.image is not None:
            self.texture, self.what, picture.image = self._upload(picture.image), picture, None
            self.failure = None
        elif picture.failure:
            self.failure, self.failed = picture.failure, picture.now

    def _read(self, context, depsgraph, camera):
        """Reads the scene and the settings. No picture may be on its way, as the light's trees are shared."""
        self.stale, self.failed = False, None
        space, layer, scene = context.space_data, context.view_layer, depsgraph.scene_eval
        try:
            settings = self._settings(scene)
            read_images, read = images.load(settings), self.scene
            beside = unread.beside(context, depsgraph, settings, camera)
            if self.changed or beside != self.beside:
                self.changed = True  # until it is read
                read = fast.read(depsgraph, settings, self.look.clip, self.kept, camera,
                                 lambda obj: obj.visible_get(view_layer=layer, viewport=space))
        except Exception as error:
            self.settings, self.failure = None, sentence(error)
            return
        if self.settings is None or settings.every != self.settings.every or \
                not images.same(read_images, self.images):
            self.settings_number += 1
        if self.scene is not read and (self.scene is None or not self.scene.same(read)):
            self.read_number += 1
            self.layers.clear()
        self.settings, self.images, self.scene, self.failure = settings, read_images, read, None
        self.changed, self.beside = False, beside

    def _settings(self, scene):
        return looks.own(scene, self.own)

    def _now(self):
        turns = self.settings.turns(self.look.number) if self.settings else frozenset()
        return _Now(self.read_number, self.settings_number, self.look.key, turns, self.wish)

    def _quick(self):
        """The scale of pictures while something moves."""
        return next((self.scale * part for part in _SMALLER if self._cost(self.scale * part) <= _BUDGET),
                    self.scale * _SMALLER[-1])

    def _cost(self, scale):
        """About how long a picture of this scale takes, in seconds."""
        whole = self._layers(scale) is None
        known = {of: seconds for (of, drawn), seconds in self.costs.items() if drawn == whole}
        if not known:
            return 3 * _BUDGET * (scale / self.scale) ** 2
        near = min(known, key=lambda other: abs(other - scale))
        return known[near] * (scale / near) ** 2

    def _key(self):
        """Equal for layers that are the same at the same scale."""
        return self.read_number, self.look.key, self.settings.layers_key

    def _layers(self, scale):
        """The _Layers of this scale now, if those that were drawn last are still right."""
        known = self.layers.get((scale, scale < self.scale))
        return known if known and self.settings and known.key == self._key() else None

    def _begin(self):
        """Begins the next picture, if what is shown is not what there is to show."""
        self.picture = None
        if not self.settings or self.look is None:
            return
        now = self._now()
        fresh = self.texture and self.what.now == now
        if now == self.failed or (fresh and self.what.scale == self.scale):
            return
        scale = self.scale if fresh else self._quick()
        self.picture = _Picture(self.behind, now, self.look, scale, self._steps(scale))
        _wake(self)

    def _steps(self, scale):
        """The steps to the picture; what is known now may be other when they run."""
        return self._draw(scale, self._key(), self._layers(scale), self.look, self.wish, self.scene, self.settings,
                          self.images)

    def _draw(self, scale, key, known, where, wish, scene, settings, pictures):
        begun, (frame, size), whole = time.perf_counter(), where.frame(scale), known is None
        sharp = scale < self.scale
        if whole:
            drawn = yield from self._drawn(scene, where, frame, size, settings, sharp)
            self.layers = {of: kept for of, kept in self.layers.items() if kept.key == key}
            known = self.layers[scale, sharp] = _Layers(key, drawn, next(_numbers))
        image = yield from self._image(known, frame, settings, pictures, wish)
        self.costs[scale, whole] = time.perf_counter() - begun
        return image

    def _drawn(self, scene, where, frame, size, settings, sharp):
        return scene.steps(where.view, where.projection, frame, size, settings, where.clip, sharp)

    def _image(self, known, frame, settings, pictures, wish):
        return shown.picture(Drawing(*known.drawn, frame, settings, pictures, known.same), wish)

    def _legend(self):
        if not (self.settings and self.what and self.what.now.wish.show == "EDGES"):
            return []
        labels = {weight: library.params()[weight].label for weight in shown.drawing_sources(self.settings)}
        return [(labels[weight], color) for weight, color in shown.SOURCES if weight in labels]


def _wake(view):
    _views.add(view)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0)


def sentence(error):
    """What is said of an error in the view."""
    if isinstance(error, EncreError):
        return str(error)
    traceback.print_exc()
    return (f"Encre failed at this view ({type(error).__name__}: {error}), which is its own fault: report it with the "
            "lines that Blender printed")


# Hooks of the engine

def _ours(engine, context):
    """Whether Encre draws this view, and not Cycles."""
    return context.space_data.shading.encre.source == "ENCRE"


def _kind(context):
    return others.get(context.space_data.as_pointer(), View)


def view_update(engine, cycles, context, depsgraph):
    """cycles: what gives the module cycles.engine, or raises EncreError."""
    if not _ours(engine, context):
        engine.live = None
        _cycles_update(engine, cycles(), context, depsgraph)
        return
    if engine.session:
        cycles().free(engine)
        engine.session = None
    kind = _kind(context)
    if type(engine.live) is not kind:
        render = depsgraph.scene_eval.render
        engine.live = kind(engine, render.threads if render.threads_mode == "FIXED" else 0)
    engine.live.update(depsgraph)


def view_draw(engine, cycles, context, depsgraph):
    if type(engine.live) is not (_kind(context) if _ours(engine, context) else type(None)):  # another since the last
        view_update(engine, cycles, context, depsgraph)
    if engine.live:
        engine.live.draw(context, depsgraph)
    else:
        cycles().view_draw(engine, depsgraph, context.region, context.space_data, context.region_data)


def _cycles_update(engine, cycles, context, depsgraph):
    data = context.blend_data
    if not engine.session:
        # As with Cycles, to choose the rendered view starts it, whether or not it was paused before.
        context.scene.cycles.preview_pause = depsgraph.scene_eval.cycles.preview_pause = False
        cycles.create(engine, data, context.region, context.space_data, context.region_data)
    cycles.reset(engine, data, depsgraph)
    cycles.sync(engine, depsgraph, data)
