# SPDX-License-Identifier: GPL-3.0-or-later
"""Ink over a picture that is still rendered: in a window, one sample is rendered ahead, whose depth, index and normals
are as good as the last one's. What is drawn of it is shown until the render is done: all where its light is clean,
else its lines, over Cycles' picture while that grows. Every few seconds it is drawn anew from the samples so far, by
the library's own threads, on which the denoiser works, too (denoise.py); the window waits for what Python does alone.

Parts of a render put together are not the render (adaptive sampling, denoisers, Cryptomatte): so the first sample is
thrown away, and what is saved is what it would be without. The scene is read twice, for which data must be persistent:
subframes.py. While it renders Cycles shows other engines nothing but Combined, and writes all passes only for previews
of materials. It asks whether it renders one each time it shows its picture, so it is told so for that once.
"""

import time
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..pen import denoise
from ..pen.backdrop import Once
from ..pen.background import Background, Course
from ..pen.errors import EncreError
from . import drawing, overrides, versions
from .known import Passes
from .overrides import changed

LEAST = 33  # samples: one of them is 3 % of the work
_EVERY = 3.0    # seconds between pictures of a render that grows, at least
_SHARE = 0.05   # of its time that Blender's main thread may work for them
_BEHIND = 0.4   # of the time in which they may be drawn beside it
_TICK = 0.1     # seconds between two looks at one that is drawn

_shown = {}  # "early" and its "texture": the one that was drawn last; freed on the main thread only


@dataclass
class Early:
    """What is shown: scene-linear premultiplied colours (height, width, 4), row 0 at the bottom, and whether they are
    the whole picture."""

    picture: np.ndarray
    whole: bool


def wanted(scene):
    """Whether a scene's stills are to be inked as they grow."""
    return (not bpy.app.background and scene.encre.ink_early and overrides.samples(scene) >= LEAST
            and not scene.render.use_multiview)


def possible(engine, scene):
    """Whether the picture that an engine renders can be inked as it grows; scene: evaluated."""
    return not engine.is_animation and wanted(scene) and engine.path_resolve("render").use_persistent_data


def sample(engine, cycles, depsgraph):
    """Has `cycles` (cycles.engine) render one sample into the engine's result."""
    user = depsgraph.scene_eval.cycles
    view_layer = depsgraph.view_layer_eval
    fewer = [(view_layer, "samples", 1)] if view_layer.samples else []
    with changed((user, "samples", 1), (user, "use_adaptive_sampling", False), (user, "use_denoising", False), *fewer):
        cycles.reset(engine, bpy.data, depsgraph)
        cycles.render(engine, depsgraph)
        cycles.render_frame_finish(engine)
    cycles.reset(engine, bpy.data, depsgraph)


def output(layer):
    """Name of the picture of a view layer's first sample that is shown: all of it where shade is cut into levels and
    the light has no noise, or loses it; else the lines alone, over Cycles' picture. None: there is neither."""
    settings = layer.settings
    if settings.shaded and (layer.light or (settings.denoises and denoise.available(versions.home()))):
        return "Combined"
    return "Encre Lines" if settings.any("use_lines") else None


def picture(result, layer, draw):
    """The picture output() of a view layer whose first sample is in the result; draw: Frames._draw."""
    mine, found = _of(layer), {}
    draw(mine, 0, _passes(result, layer), found.__setitem__)
    return _early(found[mine.early], mine.early)


def _early(drawn, name):
    return Early(np.ascontiguousarray(drawn[::-1], np.float32), name == "Combined")


def _of(layer):
    """A view layer of which only output() is drawn."""
    name = output(layer)
    views = {view: (eye, dict(maps), *rest) for view, (eye, maps, *rest) in layer.views.items()}
    return replace(layer, views=views, kept=None, keeps=False, user_indices=None, samples=1, early=name,
                   light=layer.light if name == "Combined" else None)


def _passes(result, layer):
    there = {one.name: one for one in result.layers[layer.name].passes}
    return Passes(there, (result.resolution_x, result.resolution_y), layer.settings.wants_seen)


class _Light:
    """Drawn light that is the same whatever samples there are."""

    def __init__(self, light):
        self.light, self.found = light, None

    def draw(self, *where):
        if self.found is None:
            self.found = self.light.draw(*where)
        return self.found


class Growth:
    """The pictures of a view layer that Cycles renders in an engine."""

    def __init__(self, engine, layer, show):
        """show(Early): called when one is drawn."""
        self.engine, self.layer, self.show, self.behind = engine, layer, show, Background(layer.threads)
        if layer.light:
            self.layer = replace(self.layer, light=_Light(layer.light))
        if layer.sky:
            self.layer = replace(self.layer, sky=Once(layer.sky))
        self.next = time.monotonic() + _EVERY / 2
        self.asked = self.ended = False
        self.course, self.begun, self.worked = None, 0.0, 0.0  # of the picture that is drawn; seconds
        self.name, self.before = output(layer), self._few(_passes(engine.get_result(), layer))

    @staticmethod
    def _few(passes):
        """What tells whether there are new samples."""
        return passes["Combined"][::8, ::8].copy()

    def seen(self):
        """An image editor shows what Cycles has rendered: on the main thread."""
        now = time.monotonic()
        if self.ended or self.course or now < self.next:
            return
        if not self.asked:
            self.engine.is_preview = self.asked = True
            return
        self.begun, worked = now, time.thread_time()
        passes = _passes(self.engine.get_result(), self.layer)
        few = self._few(passes)
        if np.array_equal(few, self.before):
            return  # they have not been written yet
        self.engine.is_preview = self.asked = False
        self.before = few
        self.course = Course(self.behind, drawing.steps(_of(self.layer), dict(passes), [self.name]))
        self.worked = time.thread_time() - worked
        bpy.app.timers.register(self._look, first_interval=0)

    def _look(self):
        worked = time.thread_time()
        try:
            if self.ended:  # but what the library still works at must stay
                return _TICK if self.behind.poll() is None else None
            more = self.course.go_on()
        except EncreError:
            self.ended = True
            return None
        self.worked += time.thread_time() - worked
        if more:
            return _TICK
        drawn, self.course = self.course.value[self.name], None
        took = time.monotonic() - self.begun
        self.next = self.begun + max(_EVERY, self.worked / _SHARE, took / _BEHIND)
        self.show(_early(drawn, self.name))
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "IMAGE_EDITOR":
                    area.tag_redraw()
        return None

    def end(self):
        """The render is done, or stopped."""
        self.ended = True
        self.engine.is_preview = False
        self.behind.cancel()


def draw(early):
    """Draws an Early over the render in an image editor, whose pixels Blender has made the units; it shows what is
    drawn there by the scene's view transform."""
    import gpu
    from gpu_extras.presets import draw_texture_2d

    height, width, _ = early.picture.shape
    if _shown.get("early") is not early:
        pixels = gpu.types.Buffer("FLOAT", early.picture.size, early.picture.reshape(-1))
        _shown.update(early=early, texture=gpu.types.GPUTexture((width, height), format="RGBA16F", data=pixels))
        if not bpy.app.timers.is_registered(_free):
            bpy.app.timers.register(_free, first_interval=1)
    gpu.state.blend_set("NONE" if early.whole else "ALPHA_PREMULT")
    draw_texture_2d(_shown["texture"], (0, 0), width, height)
    gpu.state.blend_set("NONE")


def _free():
    if bpy.app.is_job_running("RENDER"):
        return 1.0
    _shown.clear()
    return None
