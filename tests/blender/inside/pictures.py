# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole pictures: what they hold, their view layers, borders and eyes, and what comes after the render."""

import os

import bpy
from studio import HEIGHT, WIDTH, exr, fact, passes_on, register, set_all, shoot, stage


def picture(out):
    scene = stage()
    scene.view_layers[0].use_pass_object_index = True
    bpy.data.objects["Cube"].pass_index = 7
    from encre.blender import known

    read, real = [], known.versions.read_pass
    known.versions.read_pass = lambda one, *size: read.append(one.name) or real(one, *size)
    shoot(out, "picture")
    known.versions.read_pass = real
    fact("read", read)
    fact("pass_index", [o.pass_index for o in scene.objects])
    fact("aovs", len(scene.view_layers[0].aovs))


def drawn_once(out):
    """Lines alone into a file of one picture, with the passes that are rendered for that, and with all."""
    import hashlib

    from encre.blender import known, wanted

    scene = stage()
    set_all(scene, False)
    scene.encre.use_lines = True
    passes_on(scene.view_layers[0], False)
    rendered, begin = [], known.Passes.__init__
    known.Passes.__init__ = lambda self, there, *rest: rendered.extend(there) or begin(self, there, *rest)
    for name in ("once", "all"):
        exr(scene, os.path.join(out, f"{name}.exr"))
        if hasattr(scene.render.image_settings, "media_type"):
            scene.render.image_settings.media_type = "IMAGE"
        scene.render.image_settings.file_format = "OPEN_EXR"
        rendered.clear()
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        fact(name, [sorted(rendered), hashlib.sha256(str(picture.pixels[:]).encode()).hexdigest()])
        wanted._drawn_once = lambda *_: False
    known.Passes.__init__ = begin


def spy_on_work():
    """A list that grows by a name at each call of what computes pictures."""
    from encre.blender import frame

    done = []
    def spied(name, real):
        return lambda *args, **more: done.append(name) or real(*args, **more)

    for module, name in ((frame.meshes, "extract"), (frame.library, "raster"), (frame.library, "draw"),
                         (frame.layers, "assemble"), (frame.denoise, "denoise")):
        setattr(module, name, spied(name, getattr(module, name)))
    return done


def cycles(out):
    """The same scene by Cycles alone and by Encre with all switches off, factory denoiser and all."""
    scene = stage(engine="CYCLES")
    passes_on(scene.view_layers[0], False)
    done = spy_on_work()
    import _cycles

    denoiser = getattr(_cycles, "with_openimagedenoise", True)
    for name, engine in (("cycles", "CYCLES"), ("off", "ENCRE")):
        scene.render.engine = engine
        scene.render.use_motion_blur = True
        scene.camera.data.dof.use_dof = True
        scene.camera.data.dof.focus_distance = 2
        scene.cycles.use_denoising = denoiser
        set_all(scene, False)
        shoot(out, name)
    fact("denoiser", bool(denoiser))
    fact("done", list(done))
    passes_on(scene.view_layers[0])
    shoot(out, "asked")
    passes_on(scene.view_layers[0], False)
    scene.encre.save_layers = "ON"
    shoot(out, "kept")


def factory(out):
    """The factory scene with everything off, as it is where Blender was just installed."""
    bpy.ops.wm.read_factory_settings()
    register()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.cycles.samples = 2
    done = spy_on_work()
    import _cycles

    if not getattr(_cycles, "with_openimagedenoise", True):
        scene.cycles.use_denoising = False  # Cycles alone would refuse
    for name, engine in (("cycles", "CYCLES"), ("off", "ENCRE")):
        scene.render.engine = engine
        set_all(scene, False)
        shoot(out, name)
    fact("done", done)


def view_layers(out):
    scene = stage(ground=False)
    a, b = (bpy.data.collections.new(n) for n in "AB")
    for collection, name in ((a, "Cube"), (b, "Ball")):
        scene.collection.children.link(collection)
        collection.objects.link(bpy.data.objects[name])
        scene.collection.objects.unlink(bpy.data.objects[name])
    first = scene.view_layers[0]
    first.name = "First"
    second = scene.view_layers.new("Second")
    passes_on(second)
    first.layer_collection.children["B"].exclude = True
    second.layer_collection.children["A"].exclude = True
    shoot(out, "both")
    for layer in (first, second):
        first.use, second.use = layer is first, layer is second
        shoot(out, layer.name.lower())


def border(out):
    scene = stage(320, 240, 1)
    scene.encre.light_denoise = "NONE"
    shoot(out, "full")
    scene.render.use_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.11, 0.93
    scene.render.border_min_y, scene.render.border_max_y = 0.05, 0.87
    shoot(out, "border")
    scene.render.use_crop_to_border = True
    shoot(out, "crop")
    for denoiser in "NONE", "OIDN":
        scene.encre.light_denoise = denoiser
        for name, ends in (("left", (0, 0.47)), ("right", (0.47, 1)), ("frame", (0, 1))):
            scene.render.border_min_x, scene.render.border_max_x = ends
            scene.render.border_min_y, scene.render.border_max_y = 0, 1
            shoot(out, f"{name}-{denoiser}")
    fact("kept", scene.render.use_persistent_data)


def percentage(out):
    scene = stage()
    shoot(out, "whole")
    scene.render.resolution_x, scene.render.resolution_y = 2 * WIDTH, 2 * HEIGHT
    scene.render.resolution_percentage = 50
    shoot(out, "half")


def film(out):
    scene = stage(ground=False)
    scene.render.film_transparent = True
    shoot(out, "film")


def tiles(out):
    scene = stage()
    shoot(out, "whole")
    scene.cycles.use_auto_tile = True
    scene.cycles.tile_size = 64
    shoot(out, "tiles")


def animation(out):
    """Three frames, the lines off in the second by a keyframe, the cube moving; then with persistent data."""
    scene = stage()
    scene.frame_start, scene.frame_end = 1, 3
    box = bpy.data.objects["Cube"]
    for frame, on, x in ((1, True, -0.9), (2, False, -0.6), (3, True, -0.3)):
        scene.encre.use_lines = on
        scene.encre.keyframe_insert("use_lines", frame=frame)
        box.location.x = x
        box.keyframe_insert("location", frame=frame)
    scene.camera.data.dof.use_dof = True
    for name in ("once", "persistent"):
        scene.render.use_persistent_data = name == "persistent"
        exr(scene, os.path.join(out, f"{name}-"))
        bpy.ops.render.render(animation=True)
    scene.frame_set(2)
    shoot(out, "second")


def switches_animated(out):
    """Everything on, then off: what was overridden in the first frame is not in the second."""
    scene = stage()
    import _cycles
    from encre.pen import settings

    scene.cycles.use_denoising = getattr(_cycles, "with_openimagedenoise", True)
    scene.camera.data.dof.use_dof = True
    scene.camera.data.dof.focus_distance = 2
    scene.frame_start, scene.frame_end = 1, 2
    bpy.data.objects["Cube"].pass_index = 7
    scene.view_layers[0].use_pass_object_index = True
    for frame, on in ((1, True), (2, False)):
        set_all(scene, on)
        for switch in settings.switches():
            scene.encre.keyframe_insert(switch, frame=frame)
    for name in ("once", "persistent"):
        scene.render.use_persistent_data = name == "persistent"
        exr(scene, os.path.join(out, f"{name}-"))
        bpy.ops.render.render(animation=True)
    scene.render.use_persistent_data = False
    scene.render.engine = "CYCLES"
    scene.frame_set(2)
    shoot(out, "cycles")


def blur(out):
    scene = stage()
    shoot(out, "sharp")
    scene.render.use_motion_blur = True
    scene.camera.data.dof.use_dof = True
    scene.camera.data.dof.aperture_fstop = 0.1
    box = bpy.data.objects["Cube"]
    box.keyframe_insert("location", frame=1)
    bpy.context.scene.frame_set(1)
    shoot(out, "blurred")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "fast")
    fact("kept", [scene.render.use_motion_blur, scene.camera.data.dof.use_dof])


def memory(out):
    """What Python holds of a frame, bytes a pixel: while Cycles renders, and at most while it is drawn."""
    import tracemalloc

    scene = stage(960, 540, 1)
    from encre.blender import frame

    scene.cycles.use_denoising = False
    exr(scene, os.path.join(out, "memory.exr"))
    pixels = 960 * 540
    passes_on(scene.view_layers[0], False)
    scene.render.resolution_percentage = 5
    bpy.ops.render.render()  # what Python itself loads is there now
    scene.render.resolution_percentage = 100
    real = frame.Frames.after

    def spy(self):
        fact("held", tracemalloc.get_traced_memory()[0] / pixels)
        tracemalloc.reset_peak()
        real(self)
        held, peak = tracemalloc.get_traced_memory()
        fact("peak", peak / pixels)
        fact("left", held / pixels)

    frame.Frames.after = spy
    tracemalloc.start()
    bpy.ops.render.render()
    scene.objects["Cube"].encre.thickness = 0.5
    bpy.ops.render.render()
    tracemalloc.stop()


def read_once(out):
    """How often a frame reads all settings of the user's scene and of the evaluated one."""
    scene = stage(8, 8, 1)
    scene.encre.styles.add()
    scene.cycles.use_denoising = False  # as it is switched off Blender asks for the passes once more
    from encre.blender import properties

    real, read = properties.scene_values, []

    def spy(scene):
        read.append(scene.is_evaluated)
        return real(scene)

    properties.scene_values = spy
    shoot(out, "read")
    fact("evaluated", read)


def stereo(out):
    scene = stage()
    scene.render.use_multiview = True
    scene.render.views_format = "STEREO_3D"
    scene.camera.data.stereo.interocular_distance = 0.5
    scene.camera.data.stereo.convergence_distance = 6
    from encre.blender import frame

    real = frame.overlay.rasterised

    def spy(index, maps, owners, *more):
        fact("mismatch", float((owners[maps["object"].astype(int)] != index).mean()))
        return real(index, maps, owners, *more)

    frame.overlay.rasterised = spy
    fact("error", shoot(out, "stereo"))


def styled(out):
    """Two styles: the cube's object names one, the ball's material the other."""
    scene = stage()
    bare = scene.encre.styles.add()
    bare.name, bare.use_lines = "Bare", False
    flat = scene.encre.styles.add()
    flat.name, flat.use_shading = "Flat", False
    bpy.data.objects["Cube"].encre.style = "Bare"
    bpy.data.materials["Red"].encre.style = "Flat"
    bpy.data.materials["Green"].encre.style = "Flat"
    shoot(out, "styled")


def compositor(out):
    """The compositor shows the light's pass, doubled, in place of the picture; another output takes the picture."""
    scene = stage()
    shoot(out, "plain")
    if hasattr(scene, "compositing_node_group"):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Tree", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        end = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        end = tree.nodes.new("CompositorNodeComposite")
    source = tree.nodes.new("CompositorNodeRLayers")
    for name in ("Combined", "Light"):
        socket = source.outputs["Image" if name == "Combined" else "Encre Light"]
        tree.links.new(socket, end.inputs[0])
        shoot(out, f"composite-{name.lower()}")


def saved(out):
    scene = stage()
    for mode in ("AUTO", "ON", "OFF", "SLIM"):
        scene.encre.save_layers = mode
        shoot(out, mode.lower())
    scene.view_layers[0].use_pass_diffuse_direct = True
    shoot(out, "asked")


def untouched(out):
    """What the user's file holds before and after."""
    scene = stage()
    scene.render.use_motion_blur = scene.camera.data.dof.use_dof = True
    scene.cycles.use_denoising = True
    scene.view_settings.view_transform = "Standard"
    image = bpy.data.images.new("Paper", 8, 8)
    image.filepath_raw = os.path.join(out, "paper.png")
    image.file_format = "PNG"
    image.save()
    scene.encre.paper_image, scene.encre.paper_source = image, "IMAGE"
    exr(scene, os.path.join(out, "untouched.exr"))

    def look(block):
        found = {}
        for prop in block.bl_rna.properties:
            if prop.type in {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}:
                value = getattr(block, prop.identifier)
                found[prop.identifier] = list(value) if getattr(prop, "is_array", False) else value
        return found

    def snapshot():
        blocks = [scene.render, scene.cycles, scene.encre, scene.view_settings, scene.camera.data.dof,
                  scene.view_layers[0], *scene.objects]
        found = {f"{block!r} {k}": repr(v) for block in blocks for k, v in look(block).items()}
        for kind in ("images", "objects", "meshes", "scenes", "node_groups", "materials"):
            found[kind] = sorted(block.name for block in getattr(bpy.data, kind) if block.name != "Render Result")
        return found

    bpy.context.view_layer.update()
    before = snapshot()
    bpy.ops.render.render(write_still=True)
    after = snapshot()
    fact("changed", sorted(k for k in before.keys() | after.keys() if before.get(k) != after.get(k)))


def added(out):
    """ENCRE_PACKAGE is a package with the stage `negative`, a painted control for it, and a setting `nickname`."""
    scene = stage(64, 36)
    set_all(scene, False)
    scene.encre.save_layers = "ON"
    cube, ball = bpy.data.objects["Cube"], bpy.data.objects["Ball"]
    for item in cube.data.attributes.new("encre_negative", "FLOAT", "POINT").data:
        item.value = -0.75
    ball.encre.negative, ball.encre.nickname = -0.5, "Dice"
    fact("nickname", ball.encre.nickname)
    panel = getattr(bpy.types, "ENCRE_PT_negative", None)
    fact("panel", panel is not None)
    fact("header", hasattr(panel, "draw_header"))
    shoot(out, "off")
    scene.encre.use_negative = True
    fact("error", shoot(out, "on"))
    scene.render.engine = "CYCLES"
    shoot(out, "cycles")
