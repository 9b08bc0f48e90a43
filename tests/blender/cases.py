# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: `cases.py -- CASE FOLDER` renders what one test looks at, and prints facts as lines `FACT {json}`.

Reads the same in every Blender from 3.4 on. Pictures are saved as multilayer EXR, so that tests see what users get.
"""

import importlib.util
import json
import os
import sys
import time
from math import cos, radians, sin
from pathlib import Path

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
# ENCRE_PACKAGE names another build of the package to test.
PACKAGE = os.environ.get("ENCRE_PACKAGE") or os.path.join(HERE, "..", "..", "addon")
WIDTH, HEIGHT = 160, 90


def fact(name, value):
    os.write(1, f"\nFACT {json.dumps([name, value])}\n".encode())


def register():
    spec = importlib.util.spec_from_file_location("encre_runner", os.path.join(PACKAGE, "runner.py"))
    runner = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(runner)
    return runner.register()


# Scene

def material(name, color, emit=False):
    mat = bpy.data.materials.new(name)
    mat.use_nodes = True
    if emit:
        tree = mat.node_tree
        node = tree.nodes.new("ShaderNodeEmission")
        node.inputs["Color"].default_value = (*color, 1)
        tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs[0])
    else:
        mat.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return mat


def link(name, data, at=(0, 0, 0), mat=None, collection=None):
    obj = bpy.data.objects.new(name, data)
    obj.location = at
    if mat:
        obj.data.materials.append(mat)
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def cube(name, at=(0, 0, 0), size=1.0, mat=None, collection=None):
    s = size / 2
    verts = [(x, y, z) for z in (-s, s) for x, y in ((-s, -s), (s, -s), (s, s), (-s, s))]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(verts, [], faces)
    return link(name, mesh, at, mat, collection)


def sphere(name, at=(0, 0, 0), mat=None, collection=None):
    import bmesh

    mesh = bpy.data.meshes.new(name)
    ball = bmesh.new()
    bmesh.ops.create_uvsphere(ball, u_segments=32, v_segments=16, radius=0.7)
    ball.to_mesh(mesh)
    ball.free()
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    return link(name, mesh, at, mat, collection)


def plane(name, mat=None, size=20.0, z=-0.51):
    mesh = bpy.data.meshes.new(name)
    s = size / 2
    mesh.from_pydata([(-s, -s, z), (s, -s, z), (s, s, z), (-s, s, z)], [], [(0, 1, 2, 3)])
    return link(name, mesh, mat=mat)


def stage(width=WIDTH, height=HEIGHT, samples=2, engine="ENCRE", ground=True):
    """A red cube, a green ball and a ground under one sun, on a factory-empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.cycles.samples = samples
    scene.cycles.seed = 1
    scene.cycles.use_denoising = False
    scene.encre.line_thickness = 60  # for 1080 lines: 5 pixels here
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    cam = link("Camera", bpy.data.cameras.new("Camera"), (0, -6, 1.5))
    cam.rotation_euler = (radians(80), 0, 0)
    scene.camera = cam
    sun = link("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler = (radians(40), radians(20), 0)
    sun.data.energy = 3
    cube("Cube", (-0.9, 0, 0), 1.0, material("Red", (0.8, 0.1, 0.1)))
    sphere("Ball", (0.9, 0.3, 0.2), material("Green", (0.1, 0.7, 0.2)))
    if ground:
        plane("Ground", material("Grey", (0.6, 0.6, 0.6)))
    return scene


def exr(scene, path):
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    scene.render.filepath = path


def shoot(out, name):
    """Renders the current frame to FOLDER/NAME.exr; returns the error's text, or None."""
    scene = bpy.context.scene
    exr(scene, os.path.join(out, f"{name}.exr"))
    try:
        bpy.ops.render.render(write_still=True)
    except RuntimeError as error:
        return str(error)
    return None


def set_all(scene, on):
    for switch in ("use_lines", "use_shading", "use_smudging", "use_hatching"):
        setattr(scene.encre, switch, on)


# Cases

def picture(out):
    scene = stage()
    scene.view_layers[0].use_pass_object_index = True
    bpy.data.objects["Cube"].pass_index = 7
    shoot(out, "picture")
    fact("pass_index", [o.pass_index for o in scene.objects])


def cycles(out):
    """The same scene by Cycles alone and by Encre with all switches off, factory denoiser and all."""
    scene = stage(engine="CYCLES")
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


def factory(out):
    """The factory scene with everything off, as it is where Blender was just installed."""
    bpy.ops.wm.read_factory_settings()
    register()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.cycles.samples = 2
    import _cycles

    if not getattr(_cycles, "with_openimagedenoise", True):
        scene.cycles.use_denoising = False  # Cycles alone would refuse
    for name, engine in (("cycles", "CYCLES"), ("off", "ENCRE")):
        scene.render.engine = engine
        set_all(scene, False)
        shoot(out, name)


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

    scene.cycles.use_denoising = getattr(_cycles, "with_openimagedenoise", True)
    scene.camera.data.dof.use_dof = True
    scene.camera.data.dof.focus_distance = 2
    scene.frame_start, scene.frame_end = 1, 2
    bpy.data.objects["Cube"].pass_index = 7
    scene.view_layers[0].use_pass_object_index = True
    for frame, on in ((1, True), (2, False)):
        set_all(scene, on)
        for switch in ("use_lines", "use_shading", "use_smudging", "use_hatching"):
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
    fact("kept", [scene.render.use_motion_blur, scene.camera.data.dof.use_dof])


def cameras(out):
    """How the rasteriser's object and depth compare with Cycles', camera by camera."""
    import numpy as np

    scene = stage(200, 106, 1)
    scene.encre.light_denoise = "NONE"
    for k in range(12):
        cube(f"Box{k}", ((k % 4) * 1.1 - 1.7, 1.5 + k // 4, (k % 3) * 0.5), 0.5).rotation_euler = (k, 0.3 * k, 1)
    from encre import core, frame, layers

    drawn, real, raster = {}, layers.rasterised, core.raster  # looked at as they pass by

    def spy_raster(meshes, view, projection, place, size, start, end, channels, outputs, threads, progress):
        maps = raster(meshes, view, projection, place, size, start, end, channels, (*outputs, "depth"), threads)
        drawn["depth"] = maps["depth"]
        return maps

    def spy(index, maps, owners, numbers, strays):
        drawn["index"], drawn["own"] = index, owners[maps["object"].astype(int)]
        return real(index, maps, owners, numbers, strays)

    frame.layers.rasterised, frame.core.raster = spy, spy_raster
    assemble = layers.assemble

    def spy_assemble(passes, *args, **more):
        drawn["z"] = passes["Depth"][..., 0]
        return assemble(passes, *args, **more)

    frame.layers.assemble = spy_assemble
    render, cam = scene.render, scene.camera.data

    def compare(name):
        bpy.ops.render.render()
        same = drawn["index"] == drawn["own"]
        there = same & (drawn["index"] > 0)
        off = np.abs(drawn["z"] - drawn["depth"])[there] / drawn["depth"][there]
        fact(name, [int(same.size), int((~same).sum()), float(np.percentile(off, 99)), int(there.sum())])

    compare("plain")
    cam.shift_x, cam.shift_y = 0.13, -0.07
    compare("shift")
    cam.shift_x = cam.shift_y = 0
    for fit in ("HORIZONTAL", "VERTICAL"):
        cam.sensor_fit, cam.sensor_height = fit, 31
        compare(f"fit {fit}")
    render.resolution_x, render.resolution_y = 106, 200
    compare("upright VERTICAL")
    cam.sensor_fit = "AUTO"
    compare("upright AUTO")
    render.resolution_x, render.resolution_y = 200, 106
    cam.type, cam.ortho_scale = "ORTHO", 6
    compare("orthographic")
    cam.shift_x, cam.shift_y = -0.1, 0.1
    compare("orthographic shift")
    cam.type, cam.shift_x, cam.shift_y = "PERSP", 0, 0
    render.pixel_aspect_x = 1.5
    compare("wide pixels")
    render.pixel_aspect_x, render.pixel_aspect_y = 1, 2
    compare("tall pixels")
    cam.type = "ORTHO"
    compare("tall pixels orthographic")
    cam.type, render.pixel_aspect_y = "PERSP", 1
    render.resolution_percentage = 73
    compare("percentage")
    render.use_border, render.use_crop_to_border = True, True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.21, 0.83, 0.17, 0.91
    compare("percentage border")
    render.resolution_percentage, render.use_border = 100, False
    render.resolution_x, render.resolution_y = 201, 107
    scene.camera.scale = (2, 2, 2)
    compare("odd size, scaled camera")
    scene.camera.scale, cam.clip_start, cam.clip_end = (1, 1, 1), 5.8, 8
    compare("clipped")


def kinds(out):
    """How the rasteriser's objects compare with Cycles', for all that has faces and every kind of instance."""
    scene = stage(200, 106, 1)
    scene.encre.light_denoise = "NONE"
    from encre import frame, layers

    real = layers.rasterised
    seen = {}

    def spy(index, maps, owners, numbers, strays):
        instance = maps["object"].astype(int)
        seen["mismatch"] = int((owners[instance] != index).sum())
        passes = real(index, maps, owners, numbers, strays)
        seen["numbers"] = len(set(passes["Encre Index"][..., 0].ravel().tolist()))
        return passes

    frame.layers.rasterised = spy

    def compare(name):
        bpy.ops.render.render()
        fact(name, [seen["mismatch"], seen["numbers"]])

    small = cube("Small", (0, 0, -5), 0.3)
    ground = bpy.data.objects["Ground"]
    ground.modifiers.new("Particles", "PARTICLE_SYSTEM")
    particles = ground.particle_systems[0].settings
    particles.type, particles.count, particles.hair_length = "HAIR", 200, 1
    particles.render_type, particles.instance_object, particles.particle_size = "OBJECT", small, 1
    compare("particles")
    ground.modifiers.clear()

    group = bpy.data.collections.new("Words")
    for k, word in enumerate(("ink", "line")):
        text = bpy.data.curves.new(word, "FONT")
        text.body = word
        link(word, text, (0, 0, 0.7 * k), collection=group).rotation_euler = (radians(90), 0, 0)
    for k in range(2):
        empty = link(f"Words{k}", None, (1.6 * k - 1.8, -1, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", group
    compare("instanced texts")
    for k in range(2):
        bpy.data.objects.remove(bpy.data.objects[f"Words{k}"])

    nodes = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    if hasattr(nodes, "interface"):
        nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        nodes.outputs.new("NodeSocketGeometry", "Geometry")
    end, grid, spread, source = (nodes.nodes.new(kind) for kind in (
        "NodeGroupOutput", "GeometryNodeMeshGrid", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo"))
    for k, value in enumerate((4, 4, 4, 4)):
        grid.inputs[k].default_value = value
    source.inputs["Object"].default_value = small
    nodes.links.new(grid.outputs[0], spread.inputs["Points"])
    nodes.links.new(source.outputs["Geometry"], spread.inputs["Instance"])
    nodes.links.new(spread.outputs[0], end.inputs[0])
    host = cube("Host", (0, 1, 0.3))
    host.modifiers.new("Nodes", "NODES").node_group = nodes
    for name, whole in (("nodes: geometry", False), ("nodes: objects", True)):
        source.inputs["As Instance"].default_value = whole
        compare(name)
    realize = nodes.nodes.new("GeometryNodeRealizeInstances")
    nodes.links.new(spread.outputs[0], realize.inputs[0])
    nodes.links.new(realize.outputs[0], end.inputs[0])
    compare("nodes: realized")
    bpy.data.objects.remove(host)

    path = bpy.data.curves.new("Path", "CURVE")
    path.dimensions, path.bevel_depth = "3D", 0.1
    path.splines.new("BEZIER").bezier_points.add(1)
    path.splines[0].bezier_points[1].co = (1, 0, 1)
    link("Path", path, (0, -1, 0))
    balls = bpy.data.metaballs.new("Meta")
    balls.elements.new()
    link("Meta", balls, (0.5, 2, 1.2))
    heptagon = bpy.data.meshes.new("Heptagon")
    heptagon.from_pydata([(cos(k * 0.9), 0, sin(k * 0.9)) for k in range(7)], [], [tuple(range(7))])
    link("Heptagon", heptagon, (1.5, -1, 0.5))
    bpy.data.objects["Cube"].modifiers.new("Smooth", "SUBSURF").render_levels = 3
    compare("curve, metaball, heptagon, subdivision")
    bpy.data.objects["Ball"].visible_camera = False
    aside = bpy.data.collections.new("Aside")
    scene.collection.children.link(aside)
    aside.objects.link(bpy.data.objects["Cube"])
    scene.collection.objects.unlink(bpy.data.objects["Cube"])
    scene.view_layers[0].layer_collection.children["Aside"].indirect_only = True
    compare("not for the camera")


def stereo(out):
    scene = stage()
    scene.render.use_multiview = True
    scene.render.views_format = "STEREO_3D"
    scene.camera.data.stereo.interocular_distance = 0.5
    scene.camera.data.stereo.convergence_distance = 6
    from encre import frame, layers

    real = layers.rasterised

    def spy(index, maps, owners, numbers, strays):
        fact("mismatch", float((owners[maps["object"].astype(int)] != index).mean()))
        return real(index, maps, owners, numbers, strays)

    frame.layers.rasterised = spy
    fact("error", shoot(out, "stereo"))


def numbers(out):
    """Object indices: automatic, line groups, instances, the user's, and materials that read them."""
    scene = stage()
    more = bpy.data.collections.new("Instanced")
    cube("Inner", (0, 2, 0.2), 0.4, collection=more)
    for k in range(2):
        empty = link(f"Copy{k}", None, (k * 0.8 - 0.4, 0, 0.4))
        empty.instance_type, empty.instance_collection = "COLLECTION", more
    scene.view_layers[0].use_pass_object_index = True
    bpy.data.objects["Cube"].pass_index = 7
    shoot(out, "automatic")
    for name in ("Cube", "Ball"):
        bpy.data.objects[name].encre.line_group = "pair"
    shoot(out, "group")
    scene.encre.object_index = "PASS"
    shoot(out, "pass")
    scene.encre.object_index = "AUTO"
    tree = bpy.data.materials["Red"].node_tree
    info, emission = tree.nodes.new("ShaderNodeObjectInfo"), tree.nodes.new("ShaderNodeEmission")
    tree.links.new(info.outputs["Object Index"], emission.inputs["Strength"])
    tree.links.new(emission.outputs[0], tree.nodes["Material Output"].inputs[0])
    shoot(out, "reads")


def by_hand(out):
    """Marked edges, with a modifier, and in part behind a box; faces marked as a part; a mesh of two pieces."""
    import bmesh

    scene = stage(ground=False)
    scene.encre.edge_detector, scene.encre.line_paper, scene.encre.line_softness = "FINE", 0, 0
    scene.camera.location, scene.camera.rotation_euler = (0, -6, 0), (radians(90), 0, 0)
    red, ball = bpy.data.objects["Cube"], bpy.data.objects["Ball"]
    red.location, ball.location = (-1, -1.5, 0.6), (1.85, 0, 0)
    # Three quads side by side, mirrored: of the mark between the second and the third there are two.
    columns = (0.0, 0.3, 0.8, 1.2)
    mesh = bpy.data.meshes.new("Board")
    mesh.from_pydata([(x, 0.5, z) for x in columns for z in (-1.2, 1.2)], [],
                     [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(3)])
    board = link("Board", mesh, mat=bpy.data.materials["Red"])
    board.modifiers.new("Mirror", "MIRROR")
    bpy.context.view_layer.objects.active = board
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(mesh)
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    for edge in edited.edges:
        edge.select_set({vertex.index for vertex in edge.verts} == {4, 5})
    bmesh.update_edit_mesh(mesh)
    bpy.ops.mesh.mark_freestyle_edge()
    bpy.ops.object.mode_set(mode="OBJECT")
    shoot(out, "marked")
    scene.encre.width_mark = 0.3
    shoot(out, "thin")

    def mark(pick, **options):
        bpy.context.view_layer.objects.active = ball
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.context.tool_settings.mesh_select_mode = (False, False, True)
        edited = bmesh.from_edit_mesh(ball.data)
        for face in edited.faces:
            face.select_set(pick(face.calc_center_median()))
        bmesh.update_edit_mesh(ball.data)
        result = list(bpy.ops.encre.mark_part(**options))
        bpy.ops.object.mode_set(mode="OBJECT")
        fact("mark", result)

    mark(lambda at: at.z > 0.3)
    mark(lambda at: at.z < -0.3)
    fact("parts", sorted({item.value for item in ball.data.attributes["encre_part"].data}))
    shoot(out, "parts")
    mark(lambda at: False)
    numbers = [item.value for item in ball.data.attributes["encre_part"].data]
    ball.data.attributes["encre_part"].data[0].value = 2 ** 31 - 1
    mark(lambda at: at.x > 0.3)
    fact("next", max({item.value for item in ball.data.attributes["encre_part"].data} - {2 ** 31 - 1}))
    for item, number in zip(ball.data.attributes["encre_part"].data, numbers, strict=True):
        item.value = number
    scene.encre.object_index = "PASS"
    shoot(out, "parts-pass")
    scene.encre.object_index = "AUTO"
    mark(lambda at: True, clear=True)
    shoot(out, "whole")
    ball.data.attributes.remove(ball.data.attributes["encre_part"])
    half = ball.data.attributes.new("encre_part", "FLOAT", "FACE")
    for k, item in enumerate(half.data):
        item.value = 0.5 * (ball.data.polygons[k].center.x > 0)
    shoot(out, "attribute")
    try:
        mark(lambda at: True)
    except RuntimeError as error:
        bpy.ops.object.mode_set(mode="OBJECT")
        fact("refused", str(error))
    ball.data.attributes.remove(ball.data.attributes["encre_part"])  # Edit Mode made it anew
    joined = bmesh.new()
    joined.from_mesh(ball.data)
    for vertex in joined.verts:
        vertex.co.x += 0.05
    joined.from_mesh(ball.data)
    joined.to_mesh(ball.data)
    joined.free()
    shoot(out, "pieces")
    ball.encre.separate_parts = True
    shoot(out, "separate")


def leaves(out):
    """A plane whose material clips most of it away, and hair: what the rasteriser can't know."""
    scene = stage(ground=False)
    leaf = material("Leaf", (0.2, 0.6, 0.1))
    tree = leaf.node_tree
    checker, mix, clear = (tree.nodes.new(f"ShaderNode{n}") for n in ("TexChecker", "MixShader", "BsdfTransparent"))
    checker.inputs["Scale"].default_value = 3
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], checker.inputs["Vector"])
    tree.links.new(checker.outputs["Fac"], mix.inputs[0])
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes["Principled BSDF"].outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs[0])
    mesh = bpy.data.meshes.new("Leaf")
    mesh.from_pydata([(-0.8, -1, -1), (2, -1, -1), (2, -1, 2), (-0.8, -1, 2)], [], [(0, 1, 2, 3)])
    card = link("Leaf", mesh, mat=leaf)
    card.encre.thickness = 0.5
    bpy.data.objects["Cube"].encre.thickness = -0.5
    scene.cycles.samples = 1
    shoot(out, "leaves")


def controls(out):
    """Painted controls of every kind and domain on one row of squares, and objects' and materials' own."""
    scene = stage(ground=False)
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    scene.camera.location, scene.camera.rotation_euler = (0, -10, 0), (radians(90), 0, 0)
    kinds = [("BYTE_COLOR", "CORNER", (1, 1, 1, 1)), ("FLOAT_COLOR", "POINT", (0.2140411, 0.2140411, 0.2140411, 1)),
             ("BYTE_COLOR", "CORNER", (0, 0, 0, 1)), ("FLOAT", "FACE", 0.25), ("FLOAT", "POINT", -0.5),
             ("FLOAT", "CORNER", 3.0)]
    for k, (kind, domain, value) in enumerate(kinds):
        mesh = bpy.data.meshes.new(f"Square{k}")
        x = k - 2.5
        corners = [(x - 0.45, 0, -0.45), (x + 0.45, 0, -0.45), (x + 0.45, 0, 0.45), (x - 0.45, 0, 0.45)]
        mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
        attribute = mesh.attributes.new("encre_thickness", kind, domain)
        for item in attribute.data:
            if kind == "FLOAT":
                item.value = value
            else:
                item.color = value
        square = link(f"Square{k}", mesh, mat=material(f"M{k}", (0.5, 0.5, 0.5)))
        square.encre.hatching = 0.5
        square.data.materials[0].encre.hatching = 0.125 * k
    shoot(out, "controls")


def denoised(out):
    """A noisy lamp, with the light denoised and not; the user's own denoiser is on."""
    scene = stage(samples=4)
    bpy.data.lights["Sun"].angle = 3.0
    scene.world = bpy.data.worlds.new("World")
    scene.cycles.use_denoising = True
    scene.encre.use_lines = scene.encre.use_hatching = False
    shoot(out, "denoised")
    fact("kept", scene.cycles.use_denoising)
    scene.encre.light_denoise = "NONE"
    scene.cycles.use_denoising = False
    shoot(out, "noisy")
    from encre import denoise

    fact("available", denoise.available())


def direct(out):
    scene = stage()
    scene.encre.light_denoise = "NONE"
    scene.world = bpy.data.worlds.new("World")
    scene.encre.shade_light = "DIRECT"
    shoot(out, "direct")


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
    for mode in ("AUTO", "ON", "OFF"):
        scene.encre.save_layers = mode
        shoot(out, mode.lower())


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
    scene.camera = None
    fact("no camera", shoot(out, "no-camera"))
    scene.camera = cam
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


def fails(out):
    """Something goes wrong after Cycles: no file either."""
    stage()
    from encre import core, frame

    def fail(*_args, **_more):
        raise core.EncreError("the denoiser failed; switch it off")

    frame.core.render = fail
    fact("late", shoot(out, "late"))

    def exhaust(*_args, **_more):
        raise MemoryError

    frame.core.render = exhaust
    fact("memory", shoot(out, "memory"))


def without_library(out):
    """ENCRE_PACKAGE is a package without its library."""
    bpy.ops.wm.read_factory_settings()
    register()
    bpy.context.scene.render.engine = "ENCRE"
    fact("missing", shoot(out, "missing"))


def no_library(out):
    stage()
    from encre import core

    core.library.cache_clear()
    there = core.LIBRARY
    core.LIBRARY = "missing.so"
    fact("missing", shoot(out, "missing"))
    core.library.cache_clear()
    core.LIBRARY, core.API_VERSION = there, 99
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
    fact("error", shoot(out, "freestyle"))


def bake(out):
    scene = stage(samples=1)
    box = bpy.data.objects["Cube"]
    box.data.uv_layers.new(name="UV")
    tree = box.data.materials[0].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Bake", 16, 16)
    tree.nodes.active = node
    box.select_set(True)
    bpy.context.view_layer.objects.active = box
    shoot(out, "before")
    camera, scene.camera = scene.camera, None  # baking needs none
    try:
        bpy.ops.object.bake(type="DIFFUSE", pass_filter={"COLOR"})
        fact("baked", max(node.image.pixels[:]))
    except RuntimeError as error:
        fact("baked", str(error))
    scene.camera = camera
    fact("error", shoot(out, "after"))


def cancelled(out):
    """A break that comes while the stages run."""
    stage()
    from encre import frame

    real, times = frame.core.render, {}
    frame.Frames._go_on = lambda *_: not times  # Blender finds its own test_break before the class's

    def slow(*args, progress=None, **more):
        times["start"] = time.perf_counter()
        try:
            return real(*args, progress=progress, **more)
        finally:
            times["end"] = time.perf_counter()

    frame.core.render = slow
    fact("error", shoot(out, "cancelled"))
    fact("seconds", times["end"] - times["start"])


def interrupted(out):
    """A real interrupt, which Blender's program takes as a cancelled render."""
    import subprocess

    scene = stage(samples=4000)
    scene.cycles.use_adaptive_sampling = False
    subprocess.Popen(["sh", "-c", f"sleep 2; kill -INT {os.getpid()}"])
    from encre import engine

    finish = engine.EncreEngine.render_frame_finish

    def timed(self):
        start = time.perf_counter()
        finish(self)
        fact("finish", time.perf_counter() - start)

    engine.EncreEngine.render_frame_finish = timed
    fact("error", shoot(out, "interrupted"))


# Supersampling

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
    from encre import frame, layers

    assemble, seen = layers.assemble, []

    def spy(passes, *args, **more):
        seen.append({name: np.array(picture) for name, picture in passes.items()})
        return assemble(passes, *args, **more)

    frame.layers.assemble = spy
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
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = 32768, False
    render.resolution_x, render.resolution_y = 40, 21
    compare("edges")


def supersampled(out):
    """What is saved with two view layers, a border, both eyes; what the next render finds; how wide lines are."""
    scene = stage()
    scene.view_layers[0].use_pass_object_index = scene.view_layers[0].use_pass_mist = True
    scene.world = bpy.data.worlds.new("World")
    bpy.data.objects["Cube"].pass_index = 7
    scene.view_layers.new("Second")
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
    scene.encre.line_softness, scene.encre.line_gain, scene.encre.line_intensity = 0, 0.5, 2
    scene.encre.line_paper = 0
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.01
    scene.camera.location, scene.camera.rotation_euler = (-0.9, -6, 0), (radians(90), 0, 0)
    from encre import frame

    draw = frame.core.render

    def spy(images, *args, **more):
        result = draw(images, *args, **more)
        seen.append(result.images["Encre Lines"][..., 3])
        return result

    frame.core.render = spy
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
    from encre import frame, supersample

    made, freed, subframes, stopped = [], [], [], []
    frame.Frames._go_on = lambda *_: not stopped  # Blender finds its own test_break before the class's
    create, free, take = _cycles.create, _cycles.free, supersample.Gathered.take
    _cycles.create = lambda *args: made.append(1) or create(*args)
    _cycles.free = lambda *args: freed.append(1) or free(*args)

    def stop(self, name, picture, column, row):
        take(self, name, picture, column, row)
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


# Baking

def striped(name, red, floating=False, at=None):
    """A material whose colour is an image, half white, half of a red that is given."""
    import numpy as np

    image = bpy.data.images.new(name, 64, 32, float_buffer=floating, alpha=True)
    pixels = np.ones((32, 64, 4), np.float32)
    pixels[:, 24:40, :3] = red, 0.2, 0.2
    image.pixels.foreach_set(pixels.reshape(-1))
    if at:
        image.filepath_raw, image.file_format = at, "PNG"
        image.save()
    mat = material(name, (1, 1, 1))
    node = mat.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    mat.node_tree.links.new(node.outputs[0], mat.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return mat, node


def bake_lines(out):
    import numpy as np

    stage()
    scene = bpy.context.scene
    scene.encre.line_thickness = 6
    path = os.path.join(out, "One lines.png")  # what a careless name for the baked image would be
    (one, first), (two, second) = striped("One", 0.4, at=path), striped("Two", 0.8, floating=True)
    normal, bump = striped("Normal", 0.1)
    bump.image.colorspace_settings.name = "Non-Color"
    scale, scaled = striped("Scaled", 0.6)
    mapping = scale.node_tree.nodes.new("ShaderNodeMapping")
    scale.node_tree.links.new(mapping.outputs[0], scaled.inputs["Vector"])
    nodes = first, second, bump, scaled
    bpy.ops.mesh.primitive_uv_sphere_add()
    ball = bpy.context.object
    for mat in (one, two, normal, scale):
        ball.data.materials.append(mat)
    bare = plane("Bare", one)
    bare.select_set(True)
    before = Path(path).read_bytes()

    def show(name):
        fact(name, [[n.image.name, n.image.packed_file is not None, n.image.is_float] for n in nodes])

    def red(image):
        pixels = np.empty(64 * 32 * 4, np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(32, 64, 4)[16, :, 0].astype(float).round(4).tolist()

    fact("images", [n.image.name for n in nodes])
    fact("plain", list(bpy.ops.encre.bake()))
    show("packed")
    fact("red", [red(first.image), red(second.image)])
    fact("again", list(bpy.ops.encre.bake()))
    fact("not twice", red(first.image))
    fact("source", first.image["encre_source"].name)
    bare.select_set(False)
    fact("uniform", list(bpy.ops.encre.bake(uniform=True, where="FOLDER", directory=out)))
    show("stored")
    fact("files", sorted(os.listdir(out)))
    fact("original kept", Path(path).read_bytes() == before)
    fact("fit", list(bpy.ops.encre.fit_contrast()))
    fact("contrast", scene.encre.contrast_max)
    scene.encre.contrast_metric = "CMC"  # only just set, as a script does
    bpy.ops.encre.fit_contrast()
    fact("contrast, CMC", scene.encre.contrast_max)

    def refused(**options):
        try:
            return list(bpy.ops.encre.bake(**options))
        except RuntimeError as error:
            return str(error)

    fact("refused", refused(where="FOLDER", directory=os.path.join(path, "below")))
    bpy.ops.object.select_all(action="DESELECT")
    bpy.data.objects["Cube"].select_set(True)
    fact("refused", refused())
    fact("refused", refused(where="FOLDER", directory=""))
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(out, "library.blend"), copy=True)
    with bpy.data.libraries.load(os.path.join(out, "library.blend"), link=True) as (_, loaded):
        loaded.materials = [one.name]
    bpy.data.objects["Cube"].data.materials[0] = loaded.materials[0]
    fact("linked", refused())


if __name__ == "__main__":
    case, folder = sys.argv[sys.argv.index("--") + 1:]
    status = 1
    try:
        globals()[case](folder)
        status = 0
    finally:
        sys.stdout.flush()
        if status:
            import traceback

            traceback.print_exc()
        os._exit(status)
