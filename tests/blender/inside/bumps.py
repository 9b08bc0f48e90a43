# SPDX-License-Identifier: GPL-3.0-or-later
"""Bumps, and patterns on a deformed thing, by Cycles and by Encre alone."""

import bpy
from quick import _new as new
from studio import link, shoot, stage


def bumps(out):
    """Bumps of noise and cells on balls, bricks on the ground, waves on a cube, by both; then cells by too long a
    height, and all without bumps."""
    scene = stage(240, 135, 64)
    other = link("Cells", bpy.data.objects["Ball"].data.copy(), (0.2, -1.5, 0))
    other.scale = (0.6, 0.6, 0.6)
    other.data.materials[0] = bpy.data.materials["Green"].copy()
    other.data.materials[0].name = "Cells"
    for name, kind, output, far, inputs in (("Red", "Wave", 1, 0.05, {"Scale": 1.5}),
                                            ("Green", "Noise", 0, 0.2, {"Scale": 4.0, "Detail": 1.0}),
                                            ("Cells", "Voronoi", 0, 0.1, {"Scale": 4.0}),
                                            ("Grey", "Brick", 1, 0.1, {"Scale": 0.5, "Mortar Smooth": 1.0,
                                                                      "Mortar Size": 0.2})):
        tree = bpy.data.materials[name].node_tree
        height, bump = new(tree, "Tex" + kind, **inputs), new(tree, "Bump", Strength=0.8, Distance=far)
        surface = new(tree, "BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1))
        tree.links.new(new(tree, "TexCoord").outputs["Object"], height.inputs["Vector"])
        tree.links.new(height.outputs[output], bump.inputs["Height"])
        tree.links.new(bump.outputs[0], surface.inputs["Normal"])
        tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    scene.cycles.max_bounces = 0
    scene.encre.save_layers = "ON"
    shoot(out, "cycles")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "encre")
    tree = bpy.data.materials["Cells"].node_tree  # a height that is too long to be looked at beside the pixel
    bump = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBump")
    for k in range(30):
        sum_ = new(tree, "Math")
        tree.links.new(bump.inputs["Height"].links[0].from_socket, sum_.inputs[0])
        wave = new(tree, "TexWave", Scale=1.0 + k)
        tree.links.new(wave.outputs[1], sum_.inputs[1])
        tree.links.new(sum_.outputs[0], bump.inputs["Height"])
    shoot(out, "long")
    for mat in bpy.data.materials:
        for bump in [node for node in mat.node_tree.nodes if node.bl_idname == "ShaderNodeBump"]:
            mat.node_tree.nodes.remove(bump)
    shoot(out, "flat")


def generated(out):
    """Noise by generated coordinates on a cube that modifiers make a ball, by both."""
    scene, cube = stage(120, 68, 16), bpy.data.objects["Cube"]
    cube.modifiers.new("Finer", "SUBSURF").render_levels = 3
    cast = cube.modifiers.new("Round", "CAST")
    cast.factor, cast.size, cast.use_radius_as_size = 1, 1, False
    tree = bpy.data.materials["Red"].node_tree
    noise, surface = new(tree, "TexNoise", Scale=4.0, Detail=0.0), new(tree, "BsdfDiffuse")
    tree.links.new(noise.outputs[0], surface.inputs["Color"])
    tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    scene.cycles.max_bounces, scene.encre.save_layers = 0, "ON"
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        shoot(out, source)
