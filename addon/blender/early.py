# SPDX-License-Identifier: GPL-3.0-or-later
"""Ink over a picture that is still rendered: in a window, one sample is rendered ahead, whose depth, index and normals
are as good as the last one's. What is drawn of it is shown until the render is done: all where its light is clean,
else its lines, over Cycles' picture while that grows.

Cycles shows other engines nothing but Combined before its end, and parts of a render put together are not the render
(adaptive sampling, denoisers, Cryptomatte): so the sample is thrown away, and what is saved is what it would be
without. The scene is read twice, for which data must be persistent: subframes.py.
"""

from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..pen import denoise
from . import versions
from .known import Passes
from .overrides import changed

LEAST = 33  # samples: one of them is 3 % of the work
_shown = {}  # "early" and its "texture": the one that was drawn last; freed on the main thread only


@dataclass
class Early:
    """What is shown: scene-linear premultiplied colours (height, width, 4), row 0 at the bottom, and whether they are
    the whole picture."""

    picture: np.ndarray
    whole: bool


def wanted(scene):
    """Whether a scene's stills are to be inked as they grow."""
    return (not bpy.app.background and scene.encre.ink_early and scene.cycles.samples >= LEAST
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
    there, found, name = {one.name: one for one in result.layers[layer.name].passes}, {}, output(layer)
    passes = Passes(there, (result.resolution_x, result.resolution_y), layer.settings.wants_seen)
    views = {view: (eye, dict(maps), *rest) for view, (eye, maps, *rest) in layer.views.items()}
    draw(replace(layer, views=views, kept=None, keeps=False, user_indices=None, samples=1, early=name,
                 light=layer.light if name == "Combined" else None), 0, passes, found.__setitem__)
    return Early(np.ascontiguousarray(found[name][::-1], np.float32), name == "Combined")


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
