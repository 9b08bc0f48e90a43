# SPDX-License-Identifier: GPL-3.0-or-later
"""One thing of each shader and of each kind of object, and a ball under worlds that light it from all sides."""

import bpy
import numpy as np
from studio import cube, fact, link, plane, shoot, sphere, stage


def _surface(name, make):
    """A material whose surface is what make(tree) gives."""
    mat = bpy.data.materials.new(name)
    mat.use_nodes = True
    tree = mat.node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    tree.links.new(make(tree), tree.nodes["Material Output"].inputs["Surface"])
    return mat


def _shader(tree, kind, color, **inputs):
    node = tree.nodes.new("ShaderNode" + kind)
    node.inputs["Color"].default_value = (*color, 1)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    return node.outputs[0]


def _mixed(tree, kind, first, second, share=None):
    node = tree.nodes.new("ShaderNode" + kind)
    shaders = [socket for socket in node.inputs if socket.type == "SHADER"]
    for shader, socket in zip((first, second), shaders, strict=True):
        tree.links.new(shader, socket)
    if share is not None:
        node.inputs[0].default_value = share
    return node.outputs[0]


RED, BLUE = (0.7, 0.1, 0.2), (0.1, 0.3, 0.8)
SHADERS = {
    "Diffuse": lambda tree: _shader(tree, "BsdfDiffuse", RED),
    "Toon": lambda tree: _shader(tree, "BsdfToon", BLUE),
    "Emission": lambda tree: _shader(tree, "Emission", RED, Strength=0.7),
    "Mix": lambda tree: _mixed(tree, "MixShader", _shader(tree, "BsdfDiffuse", RED),
                               _shader(tree, "BsdfDiffuse", BLUE), 0.3),
    "Add": lambda tree: _mixed(tree, "AddShader", _shader(tree, "BsdfDiffuse", BLUE),
                               _shader(tree, "Emission", RED, Strength=0.4)),
    "Mixed glow": lambda tree: _mixed(tree, "MixShader", _shader(tree, "Emission", BLUE, Strength=1.5),
                                      _shader(tree, "BsdfToon", RED), 0.6),
}


def _matt(name, color):
    return _surface(name, lambda tree: _shader(tree, "BsdfDiffuse", color))


def _even(scene):
    """Without bounced light, seen through a filter as narrow as a pixel's centre."""
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BOX", 0.01, 0
    scene.encre.save_layers, scene.encre.light_source = "ON", "DRAWN"
    scene.view_layers[0].use_pass_emit = True


def _by_both(scene, out):
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        shoot(out, source.lower())


def shaders(out):
    """A cube of each, from the left to the right."""
    scene = stage(samples=4, ground=False)
    scene.encre.light_denoise = "NONE"  # as it is rendered
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    for k, (name, make) in enumerate(SHADERS.items()):
        cube(name, (k - 2.5, 0, 0), 0.8, _surface(name, make))
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 6.5
    _even(scene)
    _by_both(scene, out)
    fact("names", list(SHADERS))


def kinds_of_things(out):
    """A bevelled curve, a metaball, a text, a surface and an instance on a mesh's faces, none of the same colour."""
    scene = stage(240, 120, 4, ground=False)
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.12
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(1)
    for point, z in zip(spline.bezier_points, (-0.7, 0.7), strict=True):
        point.co, point.handle_left, point.handle_right = (0, 0, z), (-0.6, 0, z), (0.6, 0, z)
    balls = bpy.data.metaballs.new("Balls")
    for x in (-0.25, 0.25):
        element = balls.elements.new()
        element.co, element.radius = (x, 0, 0), 0.7
    balls.resolution = balls.render_resolution = 0.1
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.size, text.extrude = "S", 1.6, 0.1
    bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=0.5)
    ball = bpy.context.object
    ball.data.materials.append(_matt("Ball", (0.9, 0.8, 0.1)))
    ball.location = (1.2, 0, 0)
    for k, (name, data) in enumerate((("Curve", curve), ("Balls", balls), ("Text", text))):
        color = np.roll((0.8, 0.2, 0.1), k)
        obj = link(name, data, (k * 1.2 - 2.4, 0, 0), _matt(name, color))
        if name == "Text":
            obj.location, obj.rotation_euler = (-0.4, 0, -0.5), (np.pi / 2, 0, 0)
    seats = plane("Seats", _matt("Seats", (0.3, 0.3, 0.3)), 1.2, 0.0)
    seats.location, seats.rotation_euler, seats.instance_type = (2.4, 0, 0), (1.2, 0, 0.2), "FACES"
    cube("Seated", (0, 0, 0.3), 0.4, _matt("Seated", (0.5, 0.1, 0.7))).parent = seats
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 6.5
    _even(scene)
    _by_both(scene, out)


def worlds(out):
    """A ball that nothing lights but the world: of one colour, of a picture that is turned, of a share of both."""
    scene = stage(96, 64, 256, ground=False)
    for name in ("Cube", "Ball", "Sun"):
        bpy.data.objects.remove(bpy.data.objects[name])
    sphere("Ball", (0, 0, 0), _matt("White", (0.8, 0.8, 0.8)))
    scene.camera.location, scene.camera.rotation_euler = (0, -4, 0), (np.pi / 2, 0, 0)
    _even(scene)
    scene.view_layers[0].use_pass_diffuse_direct = True
    image = bpy.data.images.new("Sky", 64, 32, float_buffer=True)
    pixels = np.ones((32, 64, 4), np.float32)
    rows, columns = np.mgrid[:32, :64]
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = rows / 31, columns > 40, np.abs(columns - 20) < 6
    image.pixels.foreach_set(pixels.ravel())
    world = scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    tree = world.node_tree
    ground = tree.nodes["Background"]
    ground.inputs["Color"].default_value, ground.inputs["Strength"].default_value = (0.5, 0.7, 1.0, 1), 0.8
    shoot(out, "color")
    sky, turn, where = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexEnvironment", "Mapping", "TexCoord"))
    sky.image, turn.inputs["Rotation"].default_value = image, (0, 0, 0.9)
    tree.links.new(where.outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs[0], sky.inputs["Vector"])
    shown = tree.nodes.new("ShaderNodeBackground")
    tree.links.new(sky.outputs["Color"], shown.inputs["Color"])
    end = tree.nodes["World Output"].inputs["Surface"]
    tree.links.new(shown.outputs[0], end)
    shoot(out, "picture")
    tree.links.new(_mixed(tree, "MixShader", ground.outputs[0], shown.outputs[0], 0.6), end)
    shoot(out, "share")
