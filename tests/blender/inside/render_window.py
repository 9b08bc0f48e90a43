# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `render_window.py -- render FOLDER` presses F12 and Esc as a user does.

Needs --enable-event-simulate.
"""

import _thread
import os
import sys
import time

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402
import window  # noqa: E402

_LONG = 4  # seconds that a picture takes of which it is seen how it grows


def build():
    studio.register()
    bpy.context.preferences.view.render_display_type = "AREA"
    scene = bpy.context.scene
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 160, 90, 1
    scene.encre.samples, scene.encre.hatch_amount = 0, 0.7  # pencil that is dark enough to be counted
    scene.render.image_settings.file_format = "PNG"
    scene.encre.auto_redraw = False  # F12 does nothing while a redraw runs


def rendering(begin=lambda: window.press("F12")):
    """Until the render that F12 starts has ended, which a small one may have before the next look."""
    ended = []
    bpy.app.handlers.render_complete.append(lambda *_: ended.append(1))
    begin()
    while not ended or bpy.app.is_job_running("RENDER"):
        yield
    bpy.app.handlers.render_complete.pop()
    yield


def picture(name):
    bpy.data.images["Render Result"].save_render(os.path.join(window.FOLDER, f"{name}.png"))


def paper():
    """A paper image is read, and then one that is lost."""
    from encre.blender import images

    settings, main, read = bpy.context.scene.encre, _thread.get_ident(), images._read

    def spy(*args):
        studio.fact("paper on main thread", _thread.get_ident() == main)
        return read(*args)

    images._read = spy
    image = bpy.data.images.new("Paper", 8, 8)
    image.pixels = [1.0] * 256
    image.filepath_raw, image.file_format = os.path.join(window.FOLDER, "sheet.png"), "PNG"
    image.save()
    settings.paper_image, settings.paper_source = image, "IMAGE"
    yield from rendering()
    picture("paper")
    images._read = read  # and what grows has this paper, too


def grease_pencil():
    """A green stroke before the cube, on Encre's own layers and on Cycles', and when these are drawn anew. Not where
    Blender has another Grease Pencil."""
    if bpy.app.version >= (4, 3):
        return
    scene, data = bpy.context.scene, bpy.data.grease_pencils.new("Stroke")
    stroke = data.layers.new("Layer").frames.new(scene.frame_current).strokes.new()
    stroke.display_mode, stroke.line_width = "3DSPACE", 200
    stroke.points.add(2)
    for point, x in zip(stroke.points, (-2, 2), strict=True):
        point.co, point.pressure, point.strength = (x, -1.5, 0.5), 1, 1
    green = bpy.data.materials.new("Green")
    bpy.data.materials.create_gpencil_data(green)
    green.grease_pencil.color = (0, 1, 0, 1)
    data.materials.append(green)
    studio.link("Stroke", data)
    scene.cycles.use_denoising = False  # for which Cycles alone stops where there is no denoiser
    for source in "ENCRE", "CYCLES":
        scene.encre.layer_source = source
        yield from rendering()
        picture(f"stroke {source}")
    yield from rendering(lambda: bpy.ops.encre.redraw("INVOKE_DEFAULT"))
    picture("stroke again")
    bpy.data.objects.remove(bpy.data.objects["Stroke"])


def with_denoiser():
    """This Blender gets the denoiser of another, if the test has named one."""
    from encre.pen import denoise

    denoise._candidates = lambda _home: [os.environ["ENCRE_OIDN"]]
    denoise._library.cache_clear()


def seen_growing(drawn, shown, least=0):
    """F12, until the picture was drawn three times as it grows, and of further samples so many times at least: again
    where it was done before."""
    ended = []
    bpy.app.handlers.render_complete.append(lambda *_: ended.append(1))
    while True:
        for told in drawn, shown, ended:
            told.clear()
        window.press("F12")
        while not ended and (drawn.count(bpy.context.scene.encre.ink_early) < 3 or len(shown) < least):
            yield
        if not ended:
            break
        yield
    bpy.app.handlers.render_complete.pop()


def long_enough():
    """Samples that a machine of many cores, too, is not done with before the picture is drawn three times."""
    while True:
        begun = time.monotonic()
        yield from rendering()
        if time.monotonic() > begun + _LONG:
            return
        bpy.context.scene.cycles.samples *= 2


def growing():
    """The picture as it grows, inked and not, and when it is done; Cycles draws it while it renders."""
    import cycles.engine
    from encre.blender import early, frame

    scene, draw, drawn = bpy.context.scene, cycles.engine.draw, []
    early._EVERY, early._SHARE, show, shown = 0.1, 1.0, frame.Frames._show, []
    frame.Frames._show = lambda self, ink: shown.append(ink.picture) or show(self, ink)
    scene.encre.auto_redraw = False  # else a redraw of the changed settings may begin together with F12
    cycles.engine.draw = lambda engine, *args: drawn.append(engine.frames.ink is not None) or draw(engine, *args)
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 320, 180, 200
    scene.cycles.use_denoising, scene.encre.line_thickness, scene.encre.ink_color = False, 40, (0, 1, 0)
    scene.view_settings.view_transform = "Standard"  # from 4.0 on that of a new file makes green pale
    yield from long_enough()
    for name in ("early", "late", "shaded", *(["cleaned"] if "ENCRE_OIDN" in os.environ else [])):
        scene.encre.ink_early = name != "late"
        if name == "shaded":
            scene.encre.light_source, scene.encre.ink_color = "DRAWN", (0.2, 0.2, 0.2)
            scene.view_settings.view_transform = "Filmic"
        if name == "cleaned":
            scene.encre.light_source = "CYCLES"
            with_denoiser()
        yield from seen_growing(drawn, shown, name == "cleaned")
        window.screenshot(f"{name}-growing")
        studio.fact("still growing", bpy.app.is_job_running("RENDER"))
        while bpy.app.is_job_running("RENDER"):
            yield
        yield
        yield
        studio.fact(f"{name} shown", [len(shown), len({picture.tobytes() for picture in shown})])
        window.screenshot(f"{name}-done")
        picture(name)
    cycles.engine.draw = draw
    studio.fact("persistent", scene.render.use_persistent_data)


if __name__ == "__main__":
    window.start(window.each(build, paper, grease_pencil, growing))
