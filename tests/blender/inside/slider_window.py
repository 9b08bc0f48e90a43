# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `slider_window.py -- slider FOLDER` changes settings and what depends on them, and
tells how often the rendered 3D view reads the scene for it."""

import os
import shutil
import sys

import bpy
import numpy as np

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import keys  # noqa: E402
import studio  # noqa: E402
import window  # noqa: E402
from watch import rest, space, uploaded, views  # noqa: E402
from watch import spy as spy_uploads  # noqa: E402

READS = []


def build():
    """The stage, and copies of a cube by a collection; the view from the camera."""
    scene = studio.stage(320, 180)
    from encre.blender import fast

    read = fast.read
    fast.read = lambda *args, **named: READS.append(1) or read(*args, **named)
    bricks = bpy.data.collections.new("Bricks")
    studio.cube("Brick", size=0.3, collection=bricks)
    studio.link("Copies", None, (0, -1, 0)).instance_type = "COLLECTION"
    bpy.data.objects["Copies"].instance_collection = bricks
    own = bpy.data.collections.new("Ball's")
    own.objects.link(bpy.data.objects["Ball"])
    scene.collection.children.link(own)
    scene.collection.objects.unlink(bpy.data.objects["Ball"])
    scene.encre.layer_source = "ENCRE"
    scene.world = bpy.data.worlds.new("Sky")
    space().overlay.show_overlays = False
    spy_uploads()
    space().shading.type, space().region_3d.view_perspective = "RENDERED", "CAMERA"
    yield from rest()
    studio.fact("at first", len(READS))


def changed(name, *values):
    """Sets values in one evaluation. FACT name: how often the scene was read for it, whether the picture is another,
    whether a view that reads all anew finds the scene as it is shown, how often it reads it then, and whether
    its picture is the same."""
    yield from rest()
    view, count, before = views()[0], len(READS), uploaded[-1][1]
    for block, attribute, value in values:
        block(attribute, value) if callable(block) else setattr(block, attribute, value)
    yield from rest()
    reads, number, shown = len(READS) - count, view.read_number, uploaded[-1][1]
    view.stale = view.changed = True
    view.layers.clear()
    view.kept.images = type(view.kept.images)()
    view.texture = None
    view.redraw()
    yield from rest()
    studio.fact(name, [reads, not np.array_equal(shown, before), view.read_number == number,
                       len(READS) - count - reads, np.array_equal(uploaded[-1][1], shown)])


def hide(obj, hidden):
    bpy.data.objects[obj].hide_set(hidden)


def settings():
    encre = bpy.context.scene.encre
    yield from changed("slider", (encre, "line_thickness", 20))
    yield from changed("colour", (encre, "ink_color", (0.5, 0, 0)))
    yield from changed("angle of creases", (encre, "crease_angle", 2 * encre.crease_angle))
    yield from changed("angle that none has", (encre, "crease_angle", 1.6 * encre.crease_angle))
    yield from changed("what rests", (encre, "pen_1_wobble", 0.5))
    flat = {f"tone_{n}_space": "FLAT" for n in (1, 2)}
    yield from changed("tones", (encre, "use_tones", True), (encre, "tone_1", "DOTS"), (encre, "tone_2", "DOTS"))
    yield from changed("flat tones", *((encre, name, value) for name, value in flat.items()))
    yield from changed("no tones", (encre, "use_tones", False))
    yield from changed("flat tones at once", (encre, "use_tones", True))
    encre.use_tones = False
    yield from changed("style", (encre, "use_smudging", True), (lambda *_: encre.styles.add(), "", None))
    view = space().shading.encre
    yield from changed("look of a view", (view, "look", "pencil"))
    yield from changed("plain look", (view, "look", "PLAIN"))
    view.look = "SCENE"
    bpy.data.objects["Ball"].encre.style = "Quiet"
    encre.styles[0].line_thickness = 0
    yield from changed("name of a style", (encre.styles[0], "name", "Quiet"))


def beside():
    """What scripts change in one evaluation with a setting."""
    scene, balls = bpy.context.scene, bpy.context.view_layer.layer_collection.children["Ball's"]
    encre, layer, clay = scene.encre, bpy.context.view_layer, studio.material("Clay", (0.7, 0.5, 0.3))
    yield from changed("hidden", (encre, "line_thickness", 21), (hide, "Ball", True))
    yield from changed("there again", (encre, "line_thickness", 20), (hide, "Ball", False))
    yield from changed("world", (encre, "line_thickness", 21), (scene, "world", bpy.data.worlds.new("Night")))
    yield from changed("film", (encre, "line_thickness", 20), (scene.render, "film_transparent", True))
    yield from changed("moved", (encre, "line_thickness", 21), (bpy.data.objects["Cube"], "location", (-1, 0, 0)))
    yield from changed("indirect only", (encre, "line_thickness", 20), (balls, "indirect_only", True))
    yield from changed("direct", (encre, "line_thickness", 21), (balls, "indirect_only", False))
    yield from changed("excluded", (encre, "line_thickness", 20), (balls, "exclude", True))
    balls.exclude = False
    yield from changed("override", (encre, "line_thickness", 21), (layer, "material_override", clay))
    layer.material_override = None
    yield from changed("exposure", (encre, "line_thickness", 20), (scene.cycles, "film_exposure", 0.5))
    yield from changed("no surfaces", (encre, "line_thickness", 21), (layer, "use_solid", False))
    layer.use_solid = True
    yield from changed("hidden alone", (hide, "Ball", True))


def driven():
    """What follows a setting by a driver, a copy of it too, and by a handler of Python's."""
    encre = bpy.context.scene.encre
    for name in ("Cube", "Copies"):
        driver = bpy.data.objects[name].driver_add("location", 2).driver
        target = driver.variables.new().targets[0]
        target.id_type, target.id, target.data_path = "SCENE", bpy.context.scene, "encre.line_thickest"
        driver.expression = "var / 100"
    yield from changed("driver", (encre, "line_thickest", 60))
    vertex = bpy.data.objects["Cube"].data.vertices[6].co

    def follow(scene, _depsgraph):
        if abs(vertex.z - scene.encre.line_thickest / 50) > 1e-3:
            vertex.z = scene.encre.line_thickest / 50
            bpy.data.objects["Cube"].data.update()

    bpy.app.handlers.depsgraph_update_post.append(follow)
    yield from changed("handler", (encre, "line_thickest", 30))
    bpy.app.handlers.depsgraph_update_post.remove(follow)


def animated():
    encre, scene = bpy.context.scene.encre, bpy.context.scene
    bpy.data.objects["Copies"].driver_remove("location", 2)
    for frame in (1, 10):
        encre.line_thickness = 4 * frame
        encre.keyframe_insert("line_thickness", frame=frame)
        bpy.data.objects["Copies"].location.x = frame / 10
        bpy.data.objects["Copies"].keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    yield from changed("frame", (lambda _name, frame: scene.frame_set(frame), "", 8))


def drawn_anew():
    """Frames of a scene in which nothing moves, without pens that draw anew, and with one that does on twos."""
    encre, scene = bpy.context.scene.encre, bpy.context.scene
    for owner in (scene, bpy.data.objects["Copies"]):
        owner.animation_data_clear()

    def shown(_name, frame):
        scene.frame_set(frame)

    encre.pen_1_wobble = 6
    yield from changed("still", (shown, "", 9))
    encre.pen_1_hold = 2
    yield from changed("still on twos", (shown, "", 8))
    yield from changed("still, held", (shown, "", 9))
    yield from changed("still, drawn anew", (shown, "", 10))


def pictures():
    """What scripts do to images of a material and of the world."""
    material, world = bpy.data.materials["Red"].node_tree, bpy.context.scene.world
    path, other, third = (os.path.join(window.FOLDER, f"{name}.png") for name in ("one", "other", "third"))

    def file(path, value):
        image = bpy.data.images.new("Saved", 4, 4)
        image.pixels = [value, 0.5, 0.1, 1] * 16
        image.filepath_raw, image.file_format = path, "PNG"
        image.save()
        bpy.data.images.remove(image)

    def reload(path, source):
        shutil.copy(source, path)  # to make an image here would tell of a change
        image.reload()

    def pixels(_name, value):
        image.pixels = [0.1, value, 0.9, 1] * 16
        image.update()
        image.update_tag()

    for mesh in bpy.data.meshes:
        if not mesh.uv_layers:
            mesh.uv_layers.new()
    file(path, 0.1)
    file(other, 0.5)
    file(third, 0.9)
    image = bpy.data.images.load(path)
    look = material.nodes.new("ShaderNodeTexImage")
    look.image = image
    material.links.new(look.outputs[0], material.nodes["Principled BSDF"].inputs[0])
    yield from changed("image", (look, "mute", False))
    yield from changed("image loaded anew", (reload, path, third))
    yield from changed("image of another file", (image, "filepath", other))
    yield from changed("image's pixels", (pixels, "", 0.3))
    yield from changed("image's pixels again", (pixels, "", 0.8))
    material.nodes.remove(look)
    file(path, 0.1)
    image = bpy.data.images.load(path, check_existing=False)
    world.use_nodes = True
    look = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    look.image = image
    world.node_tree.links.new(look.outputs[0], world.node_tree.nodes["Background"].inputs[0])
    bpy.context.scene.render.film_transparent = False
    yield from changed("sky", (look, "mute", False))
    yield from changed("sky loaded anew", (reload, path, third))
    yield from changed("sky of another file", (image, "filepath", other))
    yield from changed("sky's pixels", (pixels, "", 0.3))


def layers():
    """What layers are kept for: lines in a mirror, which they have only where these are asked for, and a view at rest
    of the size of pictures while something moves, whose shadows have hard edges."""
    from encre.blender import live

    encre, budget = bpy.context.scene.encre, live._BUDGET
    silver = studio.material("Silver", (0.9, 0.9, 0.9))
    for name, value in ("Metallic", 1), ("Roughness", 0):
        silver.node_tree.nodes["Principled BSDF"].inputs[name].default_value = value
    mirror = studio.cube("Mirror", (0, 2, 0), 4, silver)
    encre.edge_detector, encre.line_mirror_strength = "FINE", 0
    yield from changed("lines in mirrors", (encre, "line_mirror_strength", 1))
    bpy.data.objects.remove(mirror)
    for lamp in bpy.data.lights:
        lamp.angle = 0.3
    live._BUDGET = 1e-5
    yield from changed("smaller while it moves", (encre, "line_thickness", 24))
    yield from changed("smaller at rest", (encre, "viewport_scale", 25))
    live._BUDGET, encre.viewport_scale = budget, 100


def study():
    """The operator takes the window, whose view is a rendered one, and gives it back."""
    from encre.blender.study import quadrants

    def until(true):
        for _ in range(900):
            if true():
                return
            yield
        raise AssertionError("the study waits")

    camera = bpy.context.scene.camera
    for frame in (1, 10):
        camera.location.x = frame / 10
        camera.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = 10
    folder = os.path.join(window.FOLDER, "answers")
    with window.override("VIEW_3D"):
        bpy.ops.encre.study(directory=folder, left="plain", right="pencil")
    yield from until(lambda: quadrants.Quadrants.stage and quadrants.Quadrants.stage.now != "READY")
    stage = quadrants.Quadrants.stage
    studio.fact("study", [sorted(stage.session.sides), len(bpy.context.window_manager.windows[0].screen.areas)])
    keys.point(300, 300)
    for _ in range(2):
        keys.press("Escape")
        yield
    yield from until(lambda: quadrants.Quadrants.stage is None)
    yield from rest()
    studio.fact("after it", [type(views()[0]).__name__, space().shading.type, os.listdir(folder)])


if __name__ == "__main__":
    window.start(window.each(build, settings, beside, driven, animated, drawn_anew, pictures, layers, study),
                 persistent=True)
