# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that a renderer can't tell apart from pixel to pixel, and such as pass through each other."""

import itertools
import os
from math import radians

import bpy
import numpy as np
from encre.blender import pictures
from mathutils import Matrix, Vector
from studio import both, cube, fact, link, material, shoot, stage


def _bare(scene):
    """Nothing but the ground, and thin ink."""
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    scene.encre.line_thickness, scene.encre.use_shading, scene.encre.pen_1_grain = 18, False, 0


def coincident(out):
    """Two boxes, turned, whose front faces lie in one plane, and the same without the second."""
    scene = stage(320, 180, 1)
    _bare(scene)
    turned = Matrix.Rotation(radians(25), 4, "Z")
    first = cube("First", (-0.4, 0, 0.1), 1.4, material("Blue", (0.2, 0.3, 0.8)))
    second = cube("Second", first.location + turned @ Vector((0.35, -0.25, 0.3)), 0.9, material("Red", (0.8, 0.2, 0.1)))
    first.rotation_euler = second.rotation_euler = (0, 0, radians(25))
    shoot(out, "both")
    second.location += turned @ Vector((0, 0.002, 0))
    shoot(out, "behind")


def pieces(out):
    """One mesh of a slab and a board that passes through its top at 8 degrees; then with both as parts, and apart."""
    scene = stage(320, 180, 1)
    _bare(scene)
    mesh = bpy.data.meshes.new("Both")
    board = bpy.data.meshes.new("Board")
    for data, height, angle in ((mesh, 0, 0), (board, 0.05, 8)):
        turn = Matrix.Translation((0, 0, height)) @ Matrix.Rotation(radians(angle), 4, "X")
        corners = [turn @ Vector((x, y, z)) for z in (-0.2, 0.2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        data.from_pydata([c * (1 if data is mesh else 0.8) for c in corners], [], faces)
    import bmesh

    both = bmesh.new()
    both.from_mesh(mesh)
    both.from_mesh(board)
    both.to_mesh(mesh)
    both.free()
    obj = link("Both", mesh, (0, 0, 0.3), material("Clay", (0.7, 0.6, 0.5)))
    scene.camera.location, scene.camera.rotation_euler = (0, -4.5, 3), (radians(60), 0, 0)
    shoot(out, "pieces")
    obj.encre.separate_parts = True
    shoot(out, "parts")


def cards(out):
    """A card of two colors, one above the other, with a hole in its middle, before a wall of two, side by side; by
    Cycles and by Encre alone. A texel is 10 pixels of the card."""
    scene = stage(320, 180, 4, ground=False)
    _bare(scene)
    for light in [obj for obj in scene.objects if obj.type == "LIGHT"]:
        light.data.energy *= 0.5
    y, x = np.mgrid[:16, :16] + 0.5
    scene.encre.line_color_strength, scene.encre.contrast_full = 1, 0.2
    for name, across, depth, size in (("Card", y, 0, 160), ("Wall", x, 1, 320)):
        texels = np.where(across[..., None] < 8, [0.1, 0.15, 0.6, 1], [0.85, 0.8, 0.3, 1]).astype(np.float32)
        mat = material(name, (1, 1, 1))
        image = bpy.data.images.new(name, 16, 16, alpha=True)
        node, surface = mat.node_tree.nodes.new("ShaderNodeTexImage"), mat.node_tree.nodes["Principled BSDF"]
        if name == "Card":
            texels[np.hypot(x - 8, y - 8) < 4] = 0.9, 0.1, 0.9, 0
            mat.node_tree.links.new(node.outputs["Alpha"], surface.inputs["Alpha"])
        image.pixels.foreach_set(texels.ravel())
        image.update()
        node.image = image
        mat.node_tree.links.new(node.outputs["Color"], surface.inputs["Base Color"])
        half = size / 200
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(-half, depth, -half), (half, depth, -half), (half, depth, half), (-half, depth, half)], [],
                         [(0, 1, 2, 3)])
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
        link(name, mesh, (0, 0, 0), mat)
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3.2
    camera.location, camera.rotation_euler = (0, -5, 0), (radians(90), 0, 0)
    both(scene, out, "cards")


def fades(out):
    """A board before a box that lets 70 % of the light through, evenly at random; one that is cut into squares; and
    the box without boards."""
    scene = stage(320, 180, 8)
    _bare(scene)
    cube("Box", (0, 1.5, 0.2), 1.4, material("Red", (0.8, 0.2, 0.1)))
    boards = []
    for name, x in (("Fade", -0.9), ("Cut", 0.9)):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(-0.8, 0, -0.4), (0.8, 0, -0.4), (0.8, 0, 1), (-0.8, 0, 1)], [], [(0, 1, 2, 3)])
        boards.append(link(name, mesh, (x, -1, 0), material(name, (0.2, 0.3, 0.8))))
    nodes = boards[1].data.materials[0].node_tree
    boards[0].data.materials[0].node_tree.nodes["Principled BSDF"].inputs["Alpha"].default_value = 0.3
    squares = nodes.nodes.new("ShaderNodeTexChecker")
    squares.inputs["Scale"].default_value = 6
    nodes.links.new(squares.outputs["Fac"], nodes.nodes["Principled BSDF"].inputs["Alpha"])
    scene.view_layers[0].use_pass_object_index = True
    for k, board in enumerate(boards):
        board.pass_index = k + 1
    shoot(out, "boards")
    for board in boards:
        board.hide_render = True
    shoot(out, "bare")


def _waves(method):
    """A material of a flat sheet from which a roof rises that winds: moved by Cycles, or shaded as if it were."""
    clay = material("Clay", (0.7, 0.6, 0.5))
    (clay if hasattr(clay, "displacement_method") else clay.cycles).displacement_method = method
    tree, end = clay.node_tree, clay.node_tree.nodes["Material Output"]

    def math(operation, *inputs):
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, inputs, strict=False):
            if isinstance(value, float):
                socket.default_value = value
            else:
                tree.links.new(value, socket)
        return node.outputs[0]

    place, moved = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("SeparateXYZ", "Displacement"))
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], place.inputs[0])
    winds = math("MULTIPLY", math("SINE", math("MULTIPLY", place.outputs[0], 2.0)), 0.15)
    far = math("ABSOLUTE", math("SUBTRACT", place.outputs[1], winds))
    high = math("MAXIMUM", math("SUBTRACT", 0.35, far), 0.0)
    moved.inputs["Midlevel"].default_value, moved.inputs["Scale"].default_value = 0, 1
    tree.links.new(high, moved.inputs["Height"])
    tree.links.new(moved.outputs[0], end.inputs["Displacement"])
    return clay


def displaced(out):
    """A sheet with a roof on it by a material's displacement, seen from above, with creases of both sources; then as a
    bump, without and with a weight of these."""
    for method, source, weight in (("DISPLACEMENT", "AUTO", 0), ("DISPLACEMENT", "LAYERS", 0), ("BUMP", "AUTO", 0),
                                   ("BUMP", "AUTO", 1)):
        scene = stage(320, 180, 16, ground=False)
        _bare(scene)
        mesh, n, rows = bpy.data.meshes.new("Sheet"), 200, 400
        x, y = np.meshgrid(np.linspace(-1.5, 1.5, n), np.linspace(-1.5, 1.5, rows))
        points = np.stack([x, y, 0 * x], 2).reshape(-1, 3)
        first = (np.arange(rows - 1)[:, None] * n + np.arange(n - 1)).reshape(-1, 1)
        mesh.from_pydata(points.tolist(), [], (first + (0, 1, n + 1, n)).tolist())
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        link("Sheet", mesh, (0, 0, 0), _waves(method))
        scene.camera.location = 0, -2.5, 4
        scene.camera.rotation_euler = Vector((0, 2.5, -4)).to_track_quat("-Z", "Y").to_euler()
        scene.encre.crease_source, scene.encre.crease_bumps = source, weight
        shoot(out, f"{method} {source} {weight}")
    _unlike(out)


def _unlike(out):
    """A cube that Cycles makes a ball, and one that is nothing but a hole."""
    scene = stage(160, 90, 4, ground=False)
    _bare(scene)
    scene.cycles.feature_set, scene.encre.line_shadow_strength = "EXPERIMENTAL", 0
    hole = material("Hole", (1, 1, 1))
    tree = hole.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeHoldout").outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    cube("Hole", (1.0, 0, 0), 1.0, hole)
    round_ = cube("Round", (-1.0, 0, 0), 1.5, material("Round", (0.8, 0.8, 0.8)))
    divided = round_.modifiers.new("Divided", "SUBSURF")
    divided.levels = divided.render_levels = 1
    owner = divided if hasattr(divided, "use_adaptive_subdivision") else round_.cycles
    owner.use_adaptive_subdivision = True
    shoot(out, "unlike")


def smoke(out):
    """A box of smoke beside a small cube, whose own box the smoke is not in."""
    scene = stage(samples=4, ground=False)
    bpy.data.objects.remove(bpy.data.objects["Ball"])
    scene.cycles.use_denoising = True
    box = cube("Smoke", (0.9, 0, 0.3), 1.6, material("Smoke", (1, 1, 1)))
    nodes = box.active_material.node_tree
    nodes.nodes.remove(nodes.nodes["Principled BSDF"])
    scatter = nodes.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = 0.8
    nodes.links.new(scatter.outputs[0], nodes.nodes["Material Output"].inputs["Volume"])
    shoot(out, "clean")
    from encre.blender import versions, volumes
    from encre.pen import denoise

    fact("denoiser", denoise.available(versions.home()))
    volumes.corners = lambda _depsgraph: ()
    shoot(out, "noisy")


def wide(out):
    """Red ink in files of two working spaces, where this Blender has them."""
    if not hasattr(bpy.data, "colorspace"):
        return
    for space in ("Linear Rec.709", "ACEScg"):
        scene = stage(samples=1)
        scene.encre.ink_color, scene.encre.line_thickness = (0.6, 0.02, 0), 120
        bpy.ops.wm.set_working_color_space(working_space=space)
        scene.view_settings.view_transform, scene.render.dither_intensity = "Standard", 0
        shoot(out, space)
        from encre.blender import versions

        for owner, name, value in versions.as_png(scene.render.image_settings):
            setattr(owner, name, value)
        scene.render.filepath = os.path.join(out, f"{space}.png")
        bpy.ops.render.render(write_still=True)


def pictures_of_files(out):
    """Of an image: whether its picture is still there for the next frame, and its first value, as it is, painted,
    saved, written anew by another long ago and just now, and in the file."""
    image = bpy.data.images.new("Sheet", 4, 4)
    image.filepath_raw, image.file_format = f"{out}-sheet.png", "PNG"
    image.save()
    image.source = "FILE"
    known, kept, values, ages = pictures.Images(), [], [], itertools.count(1)

    def age():
        os.utime(image.filepath_raw, (next(ages), 0))

    def look():
        pictures.turn()
        known.keep_files()
        kept.append(bool(known._known))
        values.append(float(known.get(image, "repeat").texels[0, 0]) / 255)

    def paint(grey):
        image.pixels.foreach_set(np.full(4 * 4 * 4, grey, np.float32))
        image.update()

    age()
    look()
    look()
    paint(1)
    look()
    image.save()
    age()
    look()
    look()
    other = image.copy()
    other.pixels.foreach_set(np.full(4 * 4 * 4, 0, np.float32))
    other.save()
    age()
    image.reload()
    look()
    look()
    other.save()
    look()
    look()
    image.pack()
    look()
    look()
    fact("kept", kept)
    fact("values", values)
