# SPDX-License-Identifier: GPL-3.0-or-later
"""The setting `supersample`: the larger picture, what is saved of it, how wide lines are, a break half-way."""

import os
from math import radians

import bpy
from studio import cube, exr, fact, link, passes_on, set_all, shoot, stage


def larger(out):
    """The layers of `supersample` n and those of a render at n times the resolution, camera by camera."""
    import numpy as np

    scene = stage(100, 53, 9)
    scene.encre.light_denoise = "NONE"
    # What Cycles in background reads only once: modifiers, texts, instances.
    bpy.data.objects["Ball"].modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    boxes = cube("Boxes", (-1, 2, 1), 0.5)
    boxes.modifiers.new("Array", "ARRAY").count = 3
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "ink", 0.05
    words = bpy.data.collections.new("Words")
    link("Text", text, collection=words).rotation_euler = (radians(90), 0, 0)
    empty = link("Instance", None, (0, -1, 0.2))
    empty.instance_type, empty.instance_collection = "COLLECTION", words
    from encre.blender import frame
    from encre.pen import layers

    assemble, rasterised, seen = layers.assemble, frame.overlay.rasterised, []

    def spy_index(index, *args):
        seen.append({"IndexOB": np.array(index)[..., None]})
        return rasterised(index, *args)

    def spy(passes, *args, **more):
        seen[-1].update((name, np.array(picture)) for name, picture in passes.items())
        return assemble(passes, *args, **more)

    frame.overlay.rasterised, frame.layers.assemble = spy_index, spy
    render, cam = scene.render, scene.camera.data

    def compare(name, n=2):
        """[size, pixels with another index, largest relative difference of depth, and of Combined]"""
        samples = scene.cycles.samples
        scene.encre.supersample = n
        bpy.ops.render.render()
        scene.encre.supersample = 1
        scene.cycles.samples, render.resolution_percentage = samples // n ** 2, 100 * n
        bpy.ops.render.render()
        scene.cycles.samples, render.resolution_percentage = samples, 100
        ours, real = seen[-2:]
        near = np.abs(ours["Depth"] - real["Depth"]) / np.minimum(ours["Depth"], real["Depth"])
        size = [n * render.resolution_y, n * render.resolution_x]
        fact(name, [list(real["Depth"].shape[:2]) == list(ours["Depth"].shape[:2]) == size,
                    int((ours["IndexOB"] != real["IndexOB"]).sum()), float(near.max()),
                    float(np.abs(ours["Combined"] - real["Combined"]).max())])

    compare("plain")
    compare("3", 3)
    cam.shift_x, cam.shift_y = 0.13, -0.07
    for fit in ("HORIZONTAL", "VERTICAL"):
        cam.sensor_fit = fit
        compare(f"shift {fit}")
    cam.sensor_fit, render.pixel_aspect_y = "AUTO", 2.5
    compare("tall pixels")
    cam.type, cam.ortho_scale = "ORTHO", 5
    compare("tall pixels orthographic")
    render.pixel_aspect_y, render.pixel_aspect_x = 1, 1.5
    compare("wide pixels orthographic")
    cam.type, render.pixel_aspect_x = "PERSP", 1
    scene.cycles.use_auto_tile, scene.cycles.tile_size = True, 64
    compare("tiles")
    render.use_persistent_data = True
    compare("persistent")
    render.use_persistent_data = False
    for mat in bpy.data.materials:
        mat.node_tree.nodes.clear()
        glow, end = (mat.node_tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "OutputMaterial"))
        glow.inputs["Color"].default_value = {"Red": (1, 0.1, 0.1, 1), "Green": (0, 0.7, 0.2, 1)}.get(
            mat.name, (0.3, 0.3, 0.3, 1))
        mat.node_tree.links.new(glow.outputs[0], end.inputs[0])
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = 16384, False
    render.resolution_x, render.resolution_y = 20, 11
    compare("edges")


def supersampled(out):
    """What is saved with two view layers, a border, both eyes; what the next render finds; how wide lines are."""
    scene = stage()
    scene.view_layers[0].use_pass_object_index = scene.view_layers[0].use_pass_mist = True
    scene.world = bpy.data.worlds.new("World")
    bpy.data.objects["Cube"].pass_index = 7
    passes_on(scene.view_layers.new("Second"))
    shoot(out, "one")
    scene.encre.supersample = 2
    shoot(out, "two")
    scene.view_layers.remove(scene.view_layers[1])
    scene.encre.light_denoise = "NONE"
    shoot(out, "full")
    scene.render.use_border = scene.render.use_crop_to_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.11, 0.93
    scene.render.border_min_y, scene.render.border_max_y = 0.05, 0.87
    shoot(out, "crop")
    scene.render.use_crop_to_border = False
    shoot(out, "border")
    scene.render.use_border = False
    scene.frame_start, scene.frame_end = 1, 2
    exr(scene, os.path.join(out, "frame-"))
    bpy.ops.render.render(animation=True)
    set_all(scene, False)
    shoot(out, "off")
    scene.encre.supersample = 1
    scene.render.engine = "CYCLES"
    shoot(out, "cycles")
    scene.render.engine = "ENCRE"
    set_all(scene, True)
    fact("persistent", scene.render.use_persistent_data)
    for value, frame in ((1, 1), (2, 2)):
        scene.encre.supersample = value
        scene.encre.keyframe_insert("supersample", frame=frame)
    scene.frame_set(1)
    exr(scene, os.path.join(out, "keyed-"))
    try:
        fact("keyed", [*bpy.ops.render.render(animation=True)])
    except RuntimeError as error:
        fact("keyed", str(error))
    scene.animation_data_clear()
    scene.encre.supersample = 2
    scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 0.5
    fact("error", shoot(out, "stereo"))


def supersampled_widths(out):
    """The ink of a square's outline by supersample and unit of length, in pixels of the frame."""
    import numpy as np

    scene = stage(160, 160, 16, ground=False)
    bpy.data.objects.remove(bpy.data.objects["Ball"])
    scene.encre.use_shading = scene.encre.use_smudging = scene.encre.use_hatching = False
    scene.encre.pen_1_softness, scene.encre.pen_1_steepness, scene.encre.pen_1_intensity = 0, 0.5, 2
    scene.encre.pen_1_grain = 0
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.01
    scene.camera.location, scene.camera.rotation_euler = (-0.9, -6, 0), (radians(90), 0, 0)
    from encre.blender import frame

    draw = frame.library.draw

    def spy(images, *args, **more):
        result = draw(images, *args, **more)
        seen.append(result.images["Encre Lines"][..., 3])
        return result

    frame.library.draw = spy
    for unit, thickness in (("PIXELS", 4), ("RELATIVE", 27)):
        scene.encre.length_unit, scene.encre.line_thickness = unit, thickness
        for n in (1, 2, 3, 4):
            seen = []
            scene.encre.supersample = n
            bpy.ops.render.render()
            fact(unit, float(np.sum(seen[0])) / n ** 2)


def supersampled_cancelled(out):
    """A break after the second sub-frame: how many there were, and what is left switched on."""
    import _cycles

    scene = stage()
    scene.encre.supersample = 3
    scene.camera.data.shift_x = 0.25
    from encre.blender import frame
    from encre.pen import supersample

    made, freed, subframes, stopped = [], [], [], []
    frame.Frames._go_on = lambda *_: not stopped  # Blender finds its own test_break before the class's
    create, free, take = _cycles.create, _cycles.free, supersample.Gathered.take
    _cycles.create = lambda *args: made.append(1) or create(*args)
    _cycles.free = lambda *args: freed.append(1) or free(*args)

    def stop(self, name, picture, column, row, *more):
        take(self, name, picture, column, row, *more)
        subframes.append((column, row))
        if (column, row) == (1, 0):
            stopped.append(True)

    supersample.Gathered.take = stop
    fact("error", shoot(out, "cancelled"))
    stopped.clear()
    fact("subframes", len(set(subframes)))
    fact("persistent", scene.render.use_persistent_data)
    supersample.Gathered.take = take
    fact("error", shoot(out, "again"))
    fact("sessions", [len(made), len(freed)])


def noise(out):
    """A floor under a large lamp, by as many samples at once and in sub-frames."""
    scene = stage(48, 32, 16)
    for name in ("Cube", "Ball", "Sun"):
        bpy.data.objects.remove(bpy.data.objects[name])
    lamp = link("Lamp", bpy.data.lights.new("Lamp", "AREA"), (0, 0, 2))
    lamp.data.energy, lamp.data.size = 300, 4
    scene.camera.rotation_euler = (radians(60), 0, 0)
    scene.encre.light_denoise = "NONE"
    scene.view_layers[0].use_pass_diffuse_direct = True
    for name, factor in (("one", 1), ("two", 2)):
        scene.encre.supersample = factor
        shoot(out, name)
