# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `beside_window.py -- beside FOLDER` begins renders by hand about when a redraw
begins or ends: by F12 at any time, also where no timer helps, and by the menu; and where Python may write nothing.

ENCRE_PRESSES says how often F12 is pressed.
"""

import _thread
import contextlib
import os
import random
import sys
import time

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import keys  # noqa: E402
import studio  # noqa: E402
import window  # noqa: E402

PRESSES = int(os.environ.get("ENCRE_PRESSES", 4))
begun = []  # whether each render that began is a redraw


def build():
    studio.register()
    from encre.blender import redraw

    bpy.context.preferences.view.render_display_type = "NONE"
    bpy.app.handlers.render_init.append(lambda *_: begun.append(redraw._drawing))
    scene = bpy.context.scene
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 320, 180, 1
    scene.cycles.use_denoising = False
    keys.point(300, 300)


def busy():
    from encre.blender import redraw

    return bpy.app.timers.is_registered(redraw._look) or bpy.app.is_job_running("RENDER")


def first():
    """The picture that is redrawn, in an image editor."""
    keys.press("F12")
    while not begun or busy():
        yield
    area = window.area("VIEW_3D")
    area.type = "IMAGE_EDITOR"
    yield
    area.spaces.active.image = bpy.data.images["Render Result"]


def rendered():
    """Waits for the user's render until it has ended. Whether it has come."""
    end = time.time() + 30
    while False not in begun and time.time() < end:
        yield
    while bpy.app.is_job_running("RENDER"):
        yield
    yield
    return False in begun


def change(width):
    bpy.context.scene.encre.line_thickness = width
    begun.clear()


def later(seconds):
    time.sleep(seconds)
    keys.press("F12")


def press():
    """A setting changes, F12 is pressed at any time from then on: is a picture rendered?"""
    chance, redraws = random.Random(1), 0
    for number in range(PRESSES):
        while busy():
            yield
        change(20 + number % 7)
        wait = chance.uniform(0.1, 0.7)
        _thread.start_new_thread(later, (wait,))
        if not (yield from rendered()):
            studio.fact("lost", wait)
        redraws += True in begun
    studio.fact("redraws", redraws)


def slowly(then):
    """A redraw that takes long, then(), and whether a render has come that was begun by hand."""
    from encre.blender import drawing

    real = drawing.library.draw

    def slow(*args, progress=None, **more):
        end = time.time() + 60
        while begun == [True] and progress(0) and time.time() < end:
            time.sleep(0.02)
        return real(*args, progress=progress, **more)

    drawing.library.draw = slow
    while busy():
        yield
    change(30 + len(begun))
    while not begun:
        yield
    yield from then()
    come = yield from rendered()
    drawing.library.draw = real
    return come


def menu():
    """Render Image of the menu: the redraw ends, and none begins while that is open."""
    keys.point(200, 300)
    yield
    with window.override("IMAGE_EDITOR"):
        bpy.ops.wm.call_menu(name="TOPBAR_MT_render")
    end = time.time() + 30
    while bpy.app.is_job_running("RENDER") and time.time() < end:
        yield
    bpy.context.scene.encre.line_thickness = 40
    end = time.time() + 0.4
    while time.time() < end:
        yield
    studio.fact("beside the menu", bpy.app.is_job_running("RENDER"))
    keys.press("Return")


def without_timer():
    """F12 where Python may begin nothing from a timer."""
    from encre.blender import redraw

    keys.press("F12")
    while redraw._next is None and False not in begun:
        yield
    with contextlib.suppress(ValueError):
        bpy.app.timers.unregister(redraw._look)


def slow_ones():
    studio.fact("by menu", (yield from slowly(menu)))
    studio.fact("without a timer", (yield from slowly(without_timer)))


class SlowPanel(bpy.types.Panel):
    bl_space_type, bl_region_type, bl_context, bl_label = "PROPERTIES", "WINDOW", "render", "Slow"
    seen = set()  # what has come so far

    def draw(self, _context):
        if "render" in self.seen:
            self.seen.add("drawing")
            wait_for("engine", self.seen)
            self.seen.add("drawn")


def wait_for(what, seen):
    end = time.time() + 30
    while what not in seen and time.time() < end:
        time.sleep(0.01)


def stuck():
    """A render whose engine begins while a panel is drawn leaves Python where it may write nothing: is a setting drawn
    that changes then, and F12?"""
    from encre.blender import frame

    begin, seen = frame.Frames.begin, SlowPanel.seen

    def begins(self, depsgraph):
        seen.add("engine")
        wait_for("drawn", seen)
        time.sleep(0.2)  # it is left a little later
        begin(self, depsgraph)

    def waits(*_):
        seen.add("render")
        wait_for("drawing", seen)

    frame.Frames.begin = begins
    bpy.utils.register_class(SlowPanel)
    bpy.app.handlers.render_init.append(waits)
    while busy():
        yield
    begun.clear()
    keys.press("F12")
    while "render" not in seen:
        yield
    area = window.area("PROPERTIES")
    area.spaces.active.context = "RENDER"
    area.tag_redraw()
    yield from rendered()
    frame.Frames.begin = begin
    bpy.app.handlers.render_init.remove(waits)
    bpy.utils.unregister_class(SlowPanel)
    said = []
    bpy.app.timers.register(lambda: said.append(may_write()))
    while not said:
        yield
    studio.fact("may write", said[0])
    change(50)
    end = time.time() + 30
    while True not in begun and time.time() < end:
        yield
    while busy():
        yield
    studio.fact("redrawn", True in begun)
    begun.clear()
    keys.press("F12")
    studio.fact("rendered", (yield from rendered()))


def may_write():
    scene = bpy.context.scene
    try:
        scene.frame_step = scene.frame_step
        return True
    except AttributeError:
        return False


if __name__ == "__main__":
    window.start(window.each(build, first, press, slow_ones, stuck))
