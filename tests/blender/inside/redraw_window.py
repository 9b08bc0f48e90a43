# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `redraw_window.py -- render FOLDER` changes settings after F12, which are drawn anew
without Cycles, and renders each of them by F12 too.

Needs --enable-event-simulate.
"""

import os
import sys
import time

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402
import window  # noqa: E402
from render_window import picture  # noqa: E402

rendered, ended = [], []


def spy(real, name):
    return lambda *args: rendered.append(name) or real(*args)


def count():
    import _cycles

    for name in ("create", "reset", "render"):
        setattr(_cycles, name, spy(getattr(_cycles, name), name))


def build():
    window.quiet()
    bpy.context.preferences.view.render_display_type = "AREA"
    studio.register()
    count()
    for handlers in (bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel):
        handlers.append(lambda *_: ended.append(1))
    scene = bpy.context.scene
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 160, 90, 4
    scene.cycles.seed = 1
    scene.render.image_settings.file_format = "PNG"
    scene.encre.line_thickness = 20


def rendering():
    """Until the render that F12 starts has ended; redraws that are under way end before."""
    from encre.blender import redraw

    while bpy.app.timers.is_registered(redraw._look) or bpy.app.is_job_running("RENDER"):
        yield
    ended.clear()
    window.press("F12")
    while not ended or bpy.app.is_job_running("RENDER"):
        yield
    yield


def redrawn():
    """Until the redraw that a change starts has ended; False if none begins."""
    bpy.context.scene.update_tag()
    start, before = time.time(), len(rendered)
    ended.clear()
    while not ended:
        if time.time() > start + 30:
            return False
        yield
    while bpy.app.is_job_running("RENDER"):
        yield
    yield
    studio.fact("by Cycles", rendered[before:])
    return True


CHANGES = {
    "thick": {"line_thickness": 50},
    "red": {"ink_color": (0.6, 0, 0), "use_hatching": False},
    "flat": {"shade_exposure": 0.3, "use_smudging": False},
    "off": {"use_lines": False, "use_shading": False, "use_smudging": False},
}


def settings():
    """Each change is drawn from memory, then rendered, and all is set back."""
    scene = bpy.context.scene
    scene.cycles.use_denoising = False
    yield from rendering()
    picture("before")
    for name, change in CHANGES.items():
        before = {id_: getattr(scene.encre, id_) for id_ in change}
        before = {id_: tuple(value) if id_.endswith("color") else value for id_, value in before.items()}
        for id_, value in change.items():
            setattr(scene.encre, id_, value)
        started = time.time()
        studio.fact("redrawn", (yield from redrawn()))
        studio.fact("seconds", time.time() - started)
        picture(f"{name}-again")
        yield from rendering()
        picture(f"{name}-fresh")
        for id_, value in before.items():
            setattr(scene.encre, id_, value)
        if name != "off":  # without lines their layers are not rendered
            yield from redrawn()
            picture(f"{name}-back")


def pressed():
    """The button, where changes draw nothing by themselves."""
    scene = bpy.context.scene
    scene.encre.auto_redraw = False
    yield from rendering()
    scene.encre.line_thickness, before = 50, len(rendered)
    scene.update_tag()
    for _ in range(20):
        yield
    picture("left alone")
    ended.clear()
    with window.override("IMAGE_EDITOR"):
        bpy.ops.encre.redraw("INVOKE_DEFAULT")
    while not ended or bpy.app.is_job_running("RENDER"):
        yield
    yield
    picture("pressed")
    studio.fact("pressed", rendered[before:])
    scene.encre.line_thickness, scene.encre.auto_redraw = 20, True


def composited():
    """Nodes that put a pass of Cycles' and one of Encre's over what the picture's opposite is."""
    scene = bpy.context.scene
    layer, scene.use_nodes = scene.view_layers[0], True
    layer.use_pass_normal = layer.encre.use_pass_lines = True
    tree = scene.node_tree
    source, end = (next(node for node in tree.nodes if node.type == kind) for kind in ("R_LAYERS", "COMPOSITE"))
    opposite = tree.nodes.new("CompositorNodeInvert")
    tree.links.new(source.outputs["Image"], opposite.inputs["Color"])
    last = opposite.outputs[0]
    for name in ("Normal", "Encre Lines"):
        mix = tree.nodes.new("CompositorNodeMixRGB")
        mix.blend_type = "ADD"
        tree.links.new(last, mix.inputs[1])
        tree.links.new(source.outputs[name], mix.inputs[2])
        last = mix.outputs[0]
    tree.links.new(last, end.inputs["Image"])
    yield from rendering()
    picture("nodes-before")
    scene.encre.line_thickness, scene.encre.ink_color = 50, (0.6, 0, 0)
    studio.fact("redrawn for nodes", (yield from redrawn()))
    picture("nodes-again")
    yield from rendering()
    picture("nodes-fresh")
    scene.encre.line_thickness, scene.encre.ink_color, scene.use_nodes = 20, (0, 0, 0), False
    layer.use_pass_normal = layer.encre.use_pass_lines = False


def undrawn():
    """What layers in memory can't show is not drawn, and F12 after a redraw renders."""
    from encre.blender import memory
    from encre.blender.engine import pass_names

    scene = bpy.context.scene
    yield from rendering()
    studio.fact("bytes", memory.size(scene) / (160 * 90))
    for owner, name, value in ((scene, "frame_current", 2), (scene.render, "resolution_x", 170),
                               (scene.encre, "supersample", 2), (scene.encre, "object_index", "PASS"),
                               (scene.view_layers[0], "use_pass_mist", True)):
        before = getattr(owner, name)
        setattr(owner, name, value)
        studio.fact("refused", memory.refusal(scene, pass_names))
        setattr(owner, name, before)
    scene.encre.styles.add()
    studio.fact("refused", memory.refusal(scene, pass_names))
    scene.encre.styles.remove(0)
    studio.fact("possible", memory.refusal(scene, pass_names))
    scene.encre.keep_layers = False
    studio.fact("refused", memory.refusal(scene, pass_names))
    studio.fact("left", memory.size(scene))


def border():
    """A border, whose surroundings are rendered too, and layers of twice the size."""
    scene = bpy.context.scene
    scene.render.use_border, scene.render.border_min_x, scene.render.border_max_y = True, 0.3, 0.8
    for name, factor in ("border", 1), ("super", 2):
        scene.encre.supersample = factor
        yield from rendering()
        scene.encre.ink_color = (0.6, 0, 0)
        studio.fact("redrawn", (yield from redrawn()))
        picture(f"{name}-again")
        yield from rendering()
        picture(f"{name}-fresh")
        scene.encre.ink_color = (0, 0, 0)
    scene.render.use_border, scene.encre.supersample = False, 1


def quick():
    """Layers that Encre has drawn itself: nothing is read again. As many bytes as are kept for a pixel."""
    from encre.blender import fast, memory

    scene, reads, read = bpy.context.scene, [], fast.read
    scene.encre.layer_source = "ENCRE"
    fast.read = lambda *args, **named: reads.append(1) or read(*args, **named)
    for name, change in ("quick", {"ink_color": (0.6, 0, 0), "shade_exposure": 0.3}), ("quick_off", CHANGES["off"]):
        yield from rendering()
        picture(f"{name}-before")
        reads.clear()
        before = {id_: getattr(scene.encre, id_) for id_ in change}
        for id_, value in change.items():
            setattr(scene.encre, id_, value)
        studio.fact("quickly redrawn", [(yield from redrawn()), len(reads)])
        picture(f"{name}-again")
        yield from rendering()
        picture(f"{name}-fresh")
        for id_, value in before.items():
            setattr(scene.encre, id_, (0, 0, 0) if id_ == "ink_color" else value)
    studio.fact("quick bytes", memory.size(scene) / (160 * 90))
    scene.encre.layer_source = "CYCLES"
    fast.read = read


def dragged():
    """A setting that changes with each step of the window: what is seen until it rests, and then."""
    from encre.blender import instant, memory

    scene, space = bpy.context.scene, next(instant.editors())
    scene.encre.keep_layers = True
    for name, source in ("drag", "CYCLES"), ("quick_drag", "ENCRE"):
        scene.encre.layer_source = source
        yield from rendering()
        seen, before = [], len(rendered)

        def look(seen=seen, name=name):
            if space.image.type != "RENDER_RESULT":
                seen.append(hash(tuple(space.image.pixels)))
                space.image.save_render(os.path.join(window.FOLDER, f"{name}-seen.png"))

        for width in range(20, 60, 2):
            scene.encre.line_thickness = width
            yield
            look()
        while memory.picture(scene).values != memory.values(scene) or space.image.type != "RENDER_RESULT":
            yield
            look()
        picture(f"{name}-drawn")
        studio.fact(name, [len(set(seen)), rendered[before:], len(bpy.data.images)])
        scene.encre.line_thickness = 20
        yield from redrawn()
    scene.encre.layer_source = "CYCLES"
    yield from rendering()


def gives_way():
    """F12 while a redraw runs, which is slow: the picture is rendered."""
    from encre.blender import drawing

    scene, real, begun = bpy.context.scene, drawing.library.draw, []

    def draw(*args, progress=None, **more):
        begun.append(1)
        if len(begun) == 1:
            end = time.time() + 5
            while progress(0) and time.time() < end:
                time.sleep(0.02)
        return real(*args, progress=progress, **more)

    drawing.library.draw = draw
    scene.encre.line_thickness, before = 50, len(rendered)
    scene.update_tag()
    while not begun:
        yield
    window.press("F12")
    while len(begun) < 2 or bpy.app.is_job_running("RENDER"):
        yield
    drawing.library.draw = real
    studio.fact("given way", rendered[before:].count("render"))
    picture("way")
    scene.encre.line_thickness = 20
    yield from redrawn()


def opened():
    """Layers that a file holds are drawn with other settings as those of a render are."""
    from encre.blender import memory
    from encre.blender import opened as ours

    scene, space = bpy.context.scene, window.area("IMAGE_EDITOR").spaces.active
    for name, source in ("file", "CYCLES"), ("quick_file", "ENCRE"):
        scene.encre.layer_source = source
        studio.exr(scene, os.path.join(window.FOLDER, f"{name}-"))
        yield from rendering()
        path = os.path.join(window.FOLDER, f"{name}-.exr")
        bpy.data.images["Render Result"].save_render(path)
        scene.render.image_settings.file_format = "PNG"
        scene.encre.line_thickness = 50
        yield from rendering()
        picture(f"{name}-fresh")
        memory.forget()
        space.image = bpy.data.images.load(path)
        before = len(rendered)
        ended.clear()
        with window.override("IMAGE_EDITOR"):
            bpy.ops.encre.open_layers("INVOKE_DEFAULT")
        while not ended or bpy.app.is_job_running("RENDER"):
            yield
        yield
        picture(f"{name}-again")
        scene.encre.line_thickness = 20
        studio.fact(name, [(yield from redrawn()), rendered[before:], space.image.type])
        picture(f"{name}-thin")
        scene.render.resolution_x = 170
        try:
            bpy.ops.encre.open_layers(filepath=path)
        except RuntimeError as error:
            studio.fact("not opened", str(error))
        scene.render.resolution_x = 160
        scene.encre.pen_1_pressure = 0.5
        studio.fact("lacks", [ours.load(scene, path), (yield from redrawn())])
        picture(f"{name}-hand")
        scene.encre.pen_1_pressure = 0
        yield from redrawn()
    scene.encre.layer_source = "CYCLES"


def given_up():
    """A redraw that is stopped leaves what was drawn before."""
    from encre.blender import frame

    scene = bpy.context.scene
    scene.encre.keep_layers = True
    yield from rendering()
    picture("whole")
    scene.encre.line_thickness = 50
    real = frame.Frames._go_on
    frame.Frames._go_on = lambda self, _fraction=0: False
    yield from redrawn()
    frame.Frames._go_on = real
    picture("stopped")


def steps():
    build()
    yield
    yield from settings()
    yield from border()
    yield from quick()
    yield from pressed()
    yield from composited()
    yield from undrawn()
    yield from dragged()
    yield from gives_way()
    yield from opened()
    yield from given_up()


if __name__ == "__main__":
    window.start(steps())
