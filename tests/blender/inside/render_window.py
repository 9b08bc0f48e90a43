# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `render_window.py -- render FOLDER` presses F12 and Esc as a user does.

Needs --enable-event-simulate.
"""

import _thread
import os
import sys

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402
import window  # noqa: E402


def press(key):
    for value in ("PRESS", "RELEASE"):
        window.window().event_simulate(type=key, value=value)


def build():
    studio.register()
    bpy.context.preferences.view.render_display_type = "AREA"
    scene = bpy.context.scene
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 160, 90, 1
    scene.render.image_settings.file_format = "PNG"
    scene.encre.auto_redraw = False  # F12 does nothing while a redraw runs


def rendering():
    """Until the render that F12 starts has ended."""
    press("F12")
    while not bpy.app.is_job_running("RENDER"):
        yield
    while bpy.app.is_job_running("RENDER"):
        yield
    yield


def picture(name):
    bpy.data.images["Render Result"].save_render(os.path.join(window.FOLDER, f"{name}.png"))


def paper():
    """A paper image is read, and then one that is lost."""
    from encre.blender import papers

    settings, main, read = bpy.context.scene.encre, _thread.get_ident(), papers._read

    def spy(*args):
        studio.fact("paper on main thread", _thread.get_ident() == main)
        return read(*args)

    papers._read = spy
    image = bpy.data.images.new("Paper", 8, 8)
    image.pixels = [1.0] * 256
    image.filepath_raw, image.file_format = os.path.join(window.FOLDER, "paper.png"), "PNG"
    image.save()
    settings.paper_image, settings.paper_source = image, "IMAGE"
    yield from rendering()
    picture("paper")
    papers._read = read
    settings.paper_source = "PROCEDURAL"


def progress():
    """Cycles' picture is drawn while it renders."""
    import cycles.engine

    scene, draw, drawn = bpy.context.scene, cycles.engine.draw, []

    def spy(*args):
        drawn.append(bpy.app.is_job_running("RENDER"))
        draw(*args)

    cycles.engine.draw = spy
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = 300, False
    yield from rendering()
    cycles.engine.draw = draw
    scene.cycles.samples = 1
    studio.fact("drawn", [len(drawn), all(drawn)])


def growing():
    """The picture as it grows, inked and not, and when it is done."""
    import cycles.engine

    scene, draw, drawn = bpy.context.scene, cycles.engine.draw, []
    scene.encre.auto_redraw = False  # else a redraw of the changed settings may begin together with F12
    cycles.engine.draw = lambda engine, *args: drawn.append(engine.frames.ink is not None) or draw(engine, *args)
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 320, 180, 100
    scene.cycles.use_denoising, scene.encre.line_thickness, scene.encre.line_color = False, 40, (0, 1, 0)
    for name in ("early", "late", "shaded"):
        scene.encre.ink_early = name != "late"
        if name == "shaded":
            scene.encre.light_source, scene.encre.line_color = "DRAWN", (0.2, 0.2, 0.2)
            scene.view_settings.view_transform, scene.cycles.samples = "Filmic", 300
        drawn.clear()
        press("F12")
        while drawn.count(scene.encre.ink_early) < 3:
            yield
        window.screenshot(f"{name}-growing")
        studio.fact("still growing", bpy.app.is_job_running("RENDER"))
        while bpy.app.is_job_running("RENDER"):
            yield
        yield
        yield
        window.screenshot(f"{name}-done")
        picture(name)
    cycles.engine.draw = draw
    studio.fact("persistent", scene.render.use_persistent_data)


if __name__ == "__main__":
    window.start(window.each(build, paper, progress, growing))
