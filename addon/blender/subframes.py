# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of n times the frame's size, out of n x n renders by Cycles of the frame's own size; and of what lies around a
border.

A RenderEngine's result has the frame's size, and Cycles, which copies its pixels into one, takes its resolution from
a copy of the settings that crashes Blender when it is set (3.4 to 5.0: the copy belongs to no scene). So each render,
a sub-frame, sees every n-th column and row of the large picture: the camera's shift moves it by a part of a pixel, the
pixel filter is n times narrower, and interleaved the sub-frames are what a render at n times the resolution gives.

Nor can a result be larger than the border. But Cycles takes the border's place from that copy, which may be set, and
renders any part of the frame that is no larger, the same to the bit as in the whole frame; it comes to lie in the
result's lower left corner. The border itself comes last and stays there.

Cycles frees the depsgraph once it has read it, and in background or with a locked interface the evaluated meshes too,
unless data are persistent. Blender copies that switch at the start of a render, after render_init, where settings
may be altered: it is on from there to the end of a render that needs it.
"""

import bpy
from bpy.app.handlers import persistent

from ..pen.errors import Cancelled, EncreError
from . import ENGINE, cameras, early, handlers, threads
from .overrides import changed

_SEED_STEP = 1013904223  # far from the seeds of the next frames, which are often the frame's number
_switched = set()  # names of the scenes whose data are persistent for this render only


@persistent
def _begin(*_):
    for scene in bpy.data.scenes:  # a compositor's or sequencer's others get no render_init
        wanted = scene.render.engine == ENGINE and hasattr(scene, "encre") and (
            scene.encre.supersample > 1 or scene.render.use_border or early.wanted(scene))
        if wanted and not scene.render.use_persistent_data:
            threads.put(scene.render, "use_persistent_data", True)
            _switched.add(scene.name)


@persistent
def _end(*_):
    while _switched:
        if scene := bpy.data.scenes.get(_switched.pop()):
            threads.put(scene.render, "use_persistent_data", False)  # frees the data as well


register, unregister = handlers.pair(("render_init", _begin), ("render_complete", _end), ("render_cancel", _end))


def possible(engine):
    """Whether a view layer can be rendered more than once."""
    return _settings(engine).use_persistent_data


def _settings(engine):
    return engine.path_resolve("render")  # the class's own method hides the property


def _placed(engine, window, width, height):
    """What to set so that Cycles renders a window of the frame; it cuts decimals off."""
    settings, (x, y, columns, rows) = _settings(engine), window
    bottom = height - y - rows
    ends = (x + 0.5) / width, (x + columns + 0.5) / width, (bottom + 0.5) / height, (bottom + rows + 0.5) / height
    names = "border_min_x", "border_max_x", "border_min_y", "border_max_y"
    return [(settings, name, min(1.0, end)) for name, end in zip(names, ends, strict=True)]


def render(engine, cycles, depsgraph, camera, factor, windows, take, keep_on):
    """Has `cycles` (cycles.engine) render the sub-frames of each window of the frame, of which the last is what the
    result is for; take(window, column, row) is called after each, with its passes in the engine's result, unless
    keep_on() is False: Cancelled. The evaluated scene is then as it was."""
    if not possible(engine):
        raise EncreError("supersample: it was 1 when the render began and a keyframe or driver has changed it; "
                              "switch Persistent Data on, or render those frames by themselves")
    scene, user, view_layer = depsgraph.scene_eval, depsgraph.scene_eval.cycles, depsgraph.view_layer_eval
    rays = factor ** 2
    narrow = [(user, "filter_width", (1.5 if user.pixel_filter_type == "BOX" else user.filter_width) / factor)]
    if user.pixel_filter_type == "BOX":  # Cycles' box can't be narrower than a pixel
        narrow.append((user, "pixel_filter_type", "BLACKMAN_HARRIS"))
    fewer = [(user, "samples", max(1, user.samples // rays)), (user, "time_limit", user.time_limit / rays)]
    if view_layer.samples:
        fewer.append((view_layer, "samples", max(1, view_layer.samples // rays)))
    pixel_x, pixel_y = _pixel(scene.render, camera.data)
    width, height, own = cameras.border(scene.render)
    count = len(windows) * rays
    with changed(*((*narrow, *fewer) if rays > 1 else ())):
        for number in range(count):
            window, ray = windows[number // rays], number % rays
            row, column = divmod(ray, factor)
            right, down = ((k + 0.5) / factor - 0.5 for k in (column, row))
            engine.update_stats("Encre", f"part {number + 1} of {count}")
            with changed((user, "seed", (user.seed + ray * _SEED_STEP) % 2 ** 31),
                         (camera.data, "shift_x", camera.data.shift_x + right * pixel_x),
                         (camera.data, "shift_y", camera.data.shift_y - down * pixel_y),
                         *(_placed(engine, window, width, height) if window != own else ())):
                if number or window != own:  # for which it was reset
                    cycles.reset(engine, bpy.data, depsgraph)
                cycles.render(engine, depsgraph)
                cycles.render_frame_finish(engine)  # a tiled picture is on the disk until now
            if not keep_on():
                raise Cancelled("rendering was cancelled")
            take(window, column, row)


def _pixel(settings, camera):
    """How far the camera's shift moves the picture by a pixel, to the right and up."""
    width, height, _ = cameras.border(settings)
    wide, high = width * settings.pixel_aspect_x, height * settings.pixel_aspect_y
    unit = {"HORIZONTAL": wide, "VERTICAL": high, "AUTO": max(wide, high)}[camera.sensor_fit]
    return settings.pixel_aspect_x / unit, settings.pixel_aspect_y / unit
