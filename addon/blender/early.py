# SPDX-License-Identifier: GPL-3.0-or-later
"""Ink over a picture that is still rendered: in a window, one sample is rendered ahead, whose depth, index and normals
are as good as the last one's, and its lines lie over Cycles' picture while that grows.

Cycles shows other engines nothing but Combined before its end, and parts of a render put together are not the render
(adaptive sampling, denoisers, Cryptomatte): so the sample is thrown away, and what is saved is what it would be
without. The scene is read twice, for which data must be persistent: subframes.py.
"""

from dataclasses import replace

import bpy
import numpy as np

from .known import Passes
from .overrides import changed

LEAST = 33  # samples: one of them is 3 % of the work
_shown = {}  # "texture": the one that was drawn last; freed on the main thread only


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


def lines(result, layer, draw):
    """The lines of a view layer whose first sample is in the result, for_display(); draw: Frames._draw."""
    there, found = {one.name: one for one in result.layers[layer.name].passes}, {}
    passes = Passes(there, (result.resolution_x, result.resolution_y), layer.settings.wants_seen)
    views = {name: (eye, dict(maps), *rest) for name, (eye, maps, *rest) in layer.views.items()}
    draw(replace(layer, views=views, kept=None, keeps=False, light=None, user_indices=None, hasty=True), 0, passes,
         found.__setitem__)
    return for_display(found["Encre Lines"])


def for_display(lines):
    """Ink as the display shows it, of scene-linear premultiplied colours (height, width, 4); row 0 at the bottom."""
    alpha = lines[..., 3:]
    color = np.clip(lines[..., :3] / np.maximum(alpha, np.float32(1e-6)), 0, 1)
    color = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055)
    return np.ascontiguousarray(np.concatenate([color * alpha, alpha], 2)[::-1], np.float32)


def draw(ink):
    """Draws what for_display() gave over the render in an image editor, whose pixels Blender has made the units."""
    import gpu
    from gpu_extras.presets import draw_texture_2d

    height, width, _ = ink.shape
    if _shown.get("ink") is not ink:
        pixels = gpu.types.Buffer("FLOAT", ink.size, ink.reshape(-1))
        _shown.update(ink=ink, texture=gpu.types.GPUTexture((width, height), format="RGBA16F", data=pixels))
        if not bpy.app.timers.is_registered(_free):
            bpy.app.timers.register(_free, first_interval=1)
    gpu.state.blend_set("ALPHA_PREMULT")
    draw_texture_2d(_shown["texture"], (0, 0), width, height)
    gpu.state.blend_set("NONE")


def _free():
    if bpy.app.is_job_running("RENDER"):
        return 1.0
    _shown.clear()
    return None
