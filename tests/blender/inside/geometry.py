# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rasteriser draws beside Cycles: cameras, instances, indices, marks, painted controls."""

from math import cos, radians, sin

import bpy
from studio import cube, fact, link, material, shoot, stage


def cameras(out):
    """How the rasteriser's object and depth compare with Cycles', camera by camera."""
    import numpy as np

    scene = stage(200, 106, 1)
    scene.encre.light_denoise = "NONE"
    for k in range(12):
        cube(f"Box{k}", ((k % 4) * 1.1 - 1.7, 1.5 + k // 4, (k % 3) * 0.5), 0.5).rotation_euler = (k, 0.3 * k, 1)
    from encre.blender import frame
    from encre.pen import layers, library

    drawn, real, raster = {}, frame.overlay.rasterised, library.raster  # looked at as they pass by

    def spy_raster(meshes, view, projection, place, size, start, end, channels, outputs, threads, progress):
        maps = raster(meshes, view, projection, place, size, start, end, channels, (*outputs, "depth"), threads)
        drawn["depth"] = maps["depth"]
        return maps

    def spy(index, maps, owners, *more):
        drawn["index"], drawn["own"] = index, owners[maps["object"].astype(int)]
        return real(index, maps, owners, *more)

    frame.overlay.rasterised, frame.library.raster = spy, spy_raster
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
    from encre.blender import frame

    real = frame.overlay.rasterised
    seen = {}

    def spy(index, maps, owners, *more):
        instance = maps["object"].astype(int)
        seen["mismatch"] = int((owners[instance] != index).sum())
        made = real(index, maps, owners, *more)
        seen["numbers"] = len(set(made["object"].ravel().tolist()))
        return made

    frame.overlay.rasterised = spy

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
    scene.encre.edge_detector, scene.encre.pen_1_grain, scene.encre.pen_1_softness = "FINE", 0, 0
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
    scene.encre.line_mark_width = 0.3
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
