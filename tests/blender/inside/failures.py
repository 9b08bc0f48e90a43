# SPDX-License-Identifier: GPL-3.0-or-later
"""What can't be rendered, what goes wrong half-way, and what is left afterwards."""

import os
import time

import bpy
from studio import fact, register, set_all, shoot, stage


def sessions(out):
    """How many of Cycles' sessions, with all their memory, are made and freed: by renders, and by one refused."""
    import _cycles

    scene, made, freed = stage(), [], []
    create, free = _cycles.create, _cycles.free
    _cycles.create = lambda *args: made.append(1) or create(*args)
    _cycles.free = lambda *args: freed.append(1) or free(*args)
    for name in "first", "second":
        shoot(out, name)
    scene.camera.data.type = "PANO"
    shoot(out, "refused")
    fact("made", len(made))
    fact("freed", len(freed))


def refused(out):
    """What can't be rendered: the sentences, and that no file appears."""
    scene = stage()
    cam = scene.camera
    cam.data.type = "PANO"
    fact("panoramic", shoot(out, "panoramic"))
    set_all(scene, False)
    fact("panoramic off", shoot(out, "panoramic-off"))
    set_all(scene, True)
    cam.data.type = "PERSP"
    cam.scale = 0, 1, 1
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        fact("flat camera", shoot(out, "flat-camera"))
    scene.encre.layer_source = "CYCLES"
    cam.scale = 1, 1, 1
    scene.camera = None
    fact("no camera", shoot(out, "no-camera"))
    scene.camera = cam
    layer = scene.view_layers[0]
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        for letters in (12, 13):  # of three bytes each
            layer.name = "\u80cc" * letters
            fact("long name", shoot(out, f"{source} {letters}"))
    scene.encre.layer_source, layer.name = "CYCLES", "ViewLayer"
    level = scene.encre.shade_levels
    for threshold in (None, 0.5, 0.51):
        row = level.add()
        if threshold:
            row.threshold, row.transition = threshold, 0.2
    fact("levels", shoot(out, "levels"))
    level.clear()
    scene.encre.paper_source = "IMAGE"
    fact("no paper", shoot(out, "no-paper"))
    image = bpy.data.images.new("Lost", 4, 4)
    image.source, image.filepath = "FILE", os.path.join(out, "lost.png")
    scene.encre.paper_image = image
    fact("lost paper", shoot(out, "lost-paper"))


def papers(out):
    """A paper image that is missing and not read, and one that is read but can't be used."""
    scene = stage()
    image = bpy.data.images.new("Lost", 4, 4)
    image.source, image.filepath = "FILE", os.path.join(out, "lost.png")
    scene.encre.paper_image = image
    fact("unused", shoot(out, "procedural"))
    scene.encre.paper_source = "IMAGE"
    scene.encre.use_hatching, scene.encre.pen_1_grain = False, 0
    fact("unused", shoot(out, "image"))
    scene.encre.use_hatching = True
    import _cycles

    render, rendered = _cycles.render, []
    _cycles.render = lambda *args: rendered.append(1) or render(*args)
    fact("missing", shoot(out, "missing"))
    scene.encre.paper_image = bpy.data.images.new("Long", 65537, 1)
    fact("too long", shoot(out, "long"))
    fact("rendered", len(rendered))


def fails(out):
    """Something goes wrong after Cycles: no file either."""
    stage()
    from encre.blender import frame

    def fail(*_args, **_more):
        raise frame.EncreError("the denoiser failed; switch it off")

    frame.library.draw = fail
    fact("late", shoot(out, "late"))

    def exhaust(*_args, **_more):
        raise MemoryError

    frame.library.draw = exhaust
    fact("memory", shoot(out, "memory"))


def stopped(out):
    """Drawing says that it was cancelled, though Blender did not ask for it."""
    stage()
    from encre.blender import frame
    from encre.pen.errors import Cancelled

    def stop(*_args, **_more):
        raise Cancelled("rendering was cancelled")

    frame.library.draw = stop
    fact("error", shoot(out, "stopped"))


def broken(out):
    """Something fails that nobody foresaw, before Cycles renders and after it."""
    stage()
    from encre.blender import frame

    def fail(*_args, **_more):
        raise RuntimeError("boom")

    rasterise, frame.library.raster = frame.library.raster, fail
    fact("before", shoot(out, "before"))
    frame.library.raster, frame.library.draw = rasterise, fail
    fact("after", shoot(out, "after"))


def without_library(out):
    """ENCRE_PACKAGE is a package without its library."""
    bpy.ops.wm.read_factory_settings()
    register()
    bpy.context.scene.render.engine = "ENCRE"
    fact("missing", shoot(out, "missing"))


def no_library(out):
    stage()
    from encre.pen import installed, library

    library.load.cache_clear()
    there = installed.LIBRARY
    installed.LIBRARY = "missing.so"
    fact("missing", shoot(out, "missing"))
    library.load.cache_clear()
    installed.LIBRARY, library.API_VERSION = there, 99
    fact("version", shoot(out, "version"))


def nonfinite(out):
    stage()
    mesh = bpy.data.objects["Cube"].data
    attribute = mesh.attributes.new("encre_intensity", "FLOAT", "POINT")
    for item in attribute.data:
        item.value = float("nan")
    fact("error", shoot(out, "nonfinite"))


def freestyle(out):
    scene = stage()
    scene.render.use_freestyle = True
    sets = scene.view_layers[0].freestyle_settings.linesets
    for strokes in list(sets) or [sets.new("Set")]:
        strokes.linestyle = strokes.linestyle or bpy.data.linestyles.new("Style")
    from encre.blender import frame

    real, drawn = frame.library.draw, []
    frame.library.draw = lambda *args, **more: drawn.append(1) or real(*args, **more)
    fact("error", shoot(out, "freestyle"))
    scene.name = "FRS1_Scene"  # as Freestyle calls its own
    fact("error", shoot(out, "named"))
    fact("drawn", len(drawn))


def cancelled(out):
    """A break that comes while the stages run."""
    stage()
    from encre.blender import frame

    real, times = frame.library.draw, {}
    frame.Frames._go_on = lambda *_: not times  # Blender finds its own test_break before the class's

    def slow(*args, progress=None, **more):
        times["start"] = time.perf_counter()
        try:
            return real(*args, progress=progress, **more)
        finally:
            times["end"] = time.perf_counter()

    frame.library.draw = slow
    fact("error", shoot(out, "cancelled"))
    fact("seconds", times["end"] - times["start"])


def interrupted(out):
    """A real interrupt, which Blender's program takes as a cancelled render."""
    import subprocess

    scene = stage(samples=4000)
    scene.cycles.use_adaptive_sampling = False
    subprocess.Popen(["sh", "-c", f"sleep 2; kill -INT {os.getpid()}"])
    from encre.blender import engine

    finish = engine.EncreEngine.render_frame_finish

    def timed(self):
        start = time.perf_counter()
        finish(self)
        fact("finish", time.perf_counter() - start)

    engine.EncreEngine.render_frame_finish = timed
    fact("error", shoot(out, "interrupted"))
