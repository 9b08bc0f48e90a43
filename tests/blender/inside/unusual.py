# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that are unfinished or larger than usual, by Cycles and by Encre alone, and things that are nowhere."""

import bpy
import numpy as np
from quick import _new as new
from studio import both, cube, fact, material, shoot, stage


def _small():
    scene = stage(96, 54, 4)
    scene.cycles.max_bounces, scene.encre.save_layers = 0, "ON"
    return scene


def _colour(name, output):
    """Has a material show an output."""
    tree = bpy.data.materials[name].node_tree
    surface = new(tree, "BsdfDiffuse")
    tree.links.new(output, surface.inputs["Color"])
    tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return surface


def no_map(out):
    """A picture on things without UV maps; then on one whose only map has another name."""
    scene, image = _small(), bpy.data.images.new("Picture", 4, 4)
    pixels = np.ones((4, 4, 4), np.float32)
    pixels[..., :3] = np.random.default_rng(1).random((4, 4, 3))
    image.pixels.foreach_set(pixels.ravel())
    for name in ("Red", "Grey"):
        tree = bpy.data.materials[name].node_tree
        texture = new(tree, "TexImage")
        texture.image, texture.extension = image, "EXTEND"
        _colour(name, texture.outputs["Color"])
    both(scene, out, "none")
    named = new(tree, "UVMap")
    named.uv_map = "Map"
    tree.links.new(named.outputs[0], texture.inputs["Vector"])
    for name in ("Ball", "Ground"):
        bpy.data.objects[name].data.uv_layers.new(name="Map" if name == "Ball" else "Other")
    both(scene, out, "other")


def rings(out):
    """Nodes in rings: of sums, of bumps, and reroutes."""
    scene = _small()
    tree = bpy.data.materials["Red"].node_tree
    one, other = new(tree, "Math"), new(tree, "Math")
    tree.links.new(one.outputs[0], other.inputs[0])
    tree.links.new(other.outputs[0], one.inputs[0])
    _colour("Red", other.outputs[0])
    tree = bpy.data.materials["Green"].node_tree
    one, other = new(tree, "Bump"), new(tree, "Bump")
    tree.links.new(one.outputs[0], other.inputs["Normal"])
    tree.links.new(other.outputs[0], one.inputs["Normal"])
    value = new(tree, "RGB")
    tree.links.new(one.outputs[0], _colour("Green", value.outputs[0]).inputs["Normal"])
    tree = bpy.data.materials["Grey"].node_tree
    one, other = (tree.nodes.new("NodeReroute") for _ in range(2))
    tree.links.new(one.outputs[0], other.inputs[0])
    tree.links.new(other.outputs[0], one.inputs[0])
    _colour("Grey", other.outputs[0])
    both(scene, out, "rings")


def _row(tree, n, operation="SINE"):
    output = new(tree, "TexNoise").outputs[0]
    for _ in range(n):
        sine = new(tree, "Math")
        sine.operation = operation
        tree.links.new(output, sine.inputs[0])
        output = sine.outputs[0]
    return output


def long_rows(out):
    """So many nodes in a row that there is no room for them: of a colour, of a bump's height, and of alpha."""
    scene = _small()
    bpy.data.materials["Red"].diffuse_color = (0.25, 0.5, 0.75, 1)
    _colour("Red", _row(bpy.data.materials["Red"].node_tree, 400))
    tree = bpy.data.materials["Green"].node_tree
    bump, value = new(tree, "Bump"), new(tree, "RGB")
    value.outputs[0].default_value = (0.5, 0.25, 0.125, 1)
    tree.links.new(_row(tree, 400), bump.inputs["Height"])
    tree.links.new(bump.outputs[0], _colour("Green", value.outputs[0]).inputs["Normal"])
    tree = bpy.data.materials["Grey"].node_tree
    tree.links.new(_row(tree, 600, "MULTIPLY"), tree.nodes["Principled BSDF"].inputs["Alpha"])
    scene.encre.layer_source = "ENCRE"
    fact("failed", shoot(out, "long"))


def nowhere(out):
    """A thing whose scale is no number, and a vertex at infinity, far outside of the picture."""
    scene = _small()
    scene.encre.layer_source = "ENCRE"
    fact("failed", shoot(out, "without"))
    lost = cube("Lost", (0, 0, -50))
    for name in "vertex", "scale":
        if name == "scale":
            lost.scale.y = float("nan")
        else:
            lost.data.vertices[0].co = float("inf"), float("nan"), 0
            lost.data.update()
        fact("failed", shoot(out, name))


def _hole(box, share):
    """A share of the box is the shader Holdout."""
    made = material("Hole", (0.2, 0.6, 0.3))
    tree = made.node_tree
    mix, hole = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeHoldout")
    mix.inputs[0].default_value = share
    tree.links.new(tree.nodes["Principled BSDF"].outputs[0], mix.inputs[1])
    tree.links.new(hole.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL").inputs[0])
    box.data.materials.append(made)


def holes(out):
    """A ball that is held out, one whose collection is, and a box whose material is, by Cycles and by Encre."""
    scene = _small()
    _hole(cube("Shaded", (0.9, -0.5, 0.4), 0.4), 1.0)
    _hole(cube("Half", (0.9, -0.5, -0.4), 0.4), 0.25)
    own = bpy.data.collections.new("Held")
    scene.collection.children.link(own)
    cube("Other", (-0.9, -0.5, 0.4), 0.4, collection=own)
    layer = bpy.context.view_layer.layer_collection
    layer.children["Held"].holdout = bpy.data.objects["Ball"].is_holdout = True
    both(scene, out, "holes")
