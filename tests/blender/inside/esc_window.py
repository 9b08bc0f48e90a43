# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `esc_window.py -- esc FOLDER` stops renders by Esc: once, twice, as they grow."""

import os
import sys
import time

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import keys  # noqa: E402
import studio  # noqa: E402
import window  # noqa: E402


def waiting(seconds):
    start = time.time()
    while time.time() < start + seconds:
        yield


def build():
    studio.register()
    scene = bpy.context.scene
    bpy.context.preferences.view.render_display_type = "AREA"
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 160, 90, 100000
    scene.cycles.use_adaptive_sampling, scene.encre.samples = False, 0
    scene.render.image_settings.file_format = "PNG"
    scene.encre.line_thickness, scene.encre.ink_early, scene.encre.hatch_amount = 40, False, 0.7
    scene.encre.light_source = "DRAWN"
    keys.point(300, 300)


def grown():
    """A list that is filled as the picture is inked anew while it grows. From before the render begins: what it is
    shown by is taken when its first sample is done."""
    from encre.blender import frame

    show, shown = frame.Frames._show, []
    frame.Frames._show = lambda self, ink: shown.append(ink) or show(self, ink)
    return shown


def stopped(name, twice=False, grows=False):
    """Again with more time where Esc came before the first sample, of which nobody tells: nothing is drawn then."""
    for seconds in (1, 4, 16, 64):
        if (yield from tried(name, seconds, twice, grows)):
            return


def tried(name, seconds, twice, grows):
    """F12, Esc while Cycles renders, and again while the stages run, which are slow then. Whether they ran."""
    from encre.blender import early, frame

    early._EVERY, early._SHARE = 0.1, 1.0
    real, asked = frame.library.draw, []

    def draw(*args, progress=None, **more):
        def slow(fraction):
            asked.append(fraction)
            time.sleep(0.2 if twice else 0)
            return progress(fraction)
        return real(*args, progress=slow, **more)

    frame.library.draw = draw
    bpy.context.scene.encre.ink_early = grows
    shown = [None]
    if grows:
        whole, shown = frame.Frames._show, grown()
    yield from waiting(0.3)
    keys.press("F12")
    while not bpy.app.is_job_running("RENDER"):
        yield
    if not grows:
        yield from waiting(seconds)
    while not shown:
        yield
    keys.press("Escape")
    if twice:
        while not asked and bpy.app.is_job_running("RENDER"):
            yield
        yield from waiting(0.8)
        keys.press("Escape")
    while bpy.app.is_job_running("RENDER"):
        yield
    yield from waiting(0.3)
    frame.library.draw = real
    if grows:
        frame.Frames._show = whole
    if not asked:
        return False
    studio.fact(name, len(asked))
    bpy.data.images["Render Result"].save_render(os.path.join(window.FOLDER, f"{name}.png"))
    return True


def steps():
    build()
    yield from stopped("once")
    yield from stopped("twice", twice=True)
    yield from stopped("growing", grows=True)


if __name__ == "__main__":
    window.start(steps())
