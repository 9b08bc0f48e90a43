# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that the scenes share, most of them flat: one colour, matt, without texture; and how their nodes are made.

As in common.py, every function makes one thing that Blender 3.4 and every later one understand alike.
"""

from math import pi

import bpy


def nodes_of(block):
    """The node tree of a material or world, emptied. Later Blenders give every block one unasked."""
    if not block.node_tree:
        block.use_nodes = True
    block.node_tree.nodes.clear()
    return block.node_tree


def node(tree, kind, **values):
    """A shader node with the given inputs; underscores stand for the blanks in their names."""
    new = tree.nodes.new("ShaderNode" + kind)
    for key, value in values.items():
        new.inputs[key.replace("_", " ")].default_value = (*value, 1) if isinstance(value, tuple) else value
    return new


def wire(tree, *pairs):
    """Links outputs to inputs; a bare node stands for its first one."""
    for out, into in pairs:
        tree.links.new(getattr(out, "outputs", [out])[0], getattr(into, "inputs", [into])[0])


def flat(name, color, mirror=0):
    """Matt colour, with a share `mirror` of it replaced by a reflection."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*color, 1)
    tree = nodes_of(material)
    diffuse, out = node(tree, "BsdfDiffuse", Color=color), node(tree, "OutputMaterial")
    if not mirror:
        wire(tree, (diffuse, out))
        return material
    glossy, mix = node(tree, "BsdfGlossy", Roughness=0.02), node(tree, "MixShader")
    mix.inputs[0].default_value = mirror
    wire(tree, (diffuse, mix.inputs[1]), (glossy, mix.inputs[2]), (mix, out))
    return material


def rippled(name, color, mirror, height, length, lean=0):
    """Water: a mirror whose normal sways along y by up to `height`, so that lights draw out into dashes.

    `lean` turns all of it towards −y, to bring into the picture what shines high above: a draughtsman does not
    work out where a lamp's reflection falls either. The mesh stays a flat shape with a clean outline.
    """
    material = flat(name, color, mirror)
    tree = material.node_tree
    glossy = next(n for n in tree.nodes if n.type == "BSDF_GLOSSY")
    where, normal = node(tree, "TexCoord"), node(tree, "CombineXYZ", Z=1.0)
    wave = node(tree, "TexWave", Scale=pi / (10 * length), Distortion=4.0, Detail=0.0)
    wave.bands_direction = "Y"
    sway = node(tree, "MapRange", To_Min=-lean - height, To_Max=height - lean)
    wire(tree, (where.outputs["Object"], wave), (wave.outputs[1], sway), (sway, normal.inputs["Y"]),
         (normal, glossy.inputs["Normal"]))
    return material


def leaf(name, color, width=0.62, round_as=None):
    """Matt colour that a leaf's outline cuts out of a card; `width` is the leaf's, 1 the card's.

    With `round_as` (the middle of a crown, in the object's own space) all leaves are lit as a ball would be there:
    what a draughtsman sees in a tree is its masses, not every leaf's own shade.
    """
    material = flat(name, color)
    tree = material.node_tree
    diffuse, out = (next(n for n in tree.nodes if n.type == kind) for kind in ("BSDF_DIFFUSE", "OUTPUT_MATERIAL"))
    where, xyz, mix = node(tree, "TexCoord"), node(tree, "SeparateXYZ"), node(tree, "MixShader")
    wire(tree, (where.outputs["UV"], xyz), (node(tree, "BsdfTransparent"), mix.inputs[1]), (diffuse, mix.inputs[2]))
    # Half the width at height v is ½·width·sin(πv); inside is where |u − ½| is less.
    half = calc(tree, "MULTIPLY", calc(tree, "SINE", calc(tree, "MULTIPLY", xyz.outputs["Y"], pi)), width / 2)
    side = calc(tree, "ABSOLUTE", calc(tree, "SUBTRACT", xyz.outputs["X"], 0.5))
    wire(tree, (calc(tree, "LESS_THAN", side, half), mix.inputs[0]), (mix, out))
    if round_as:
        outward, unit = node(tree, "VectorMath"), node(tree, "VectorMath")
        outward.operation, unit.operation, outward.inputs[1].default_value = "SUBTRACT", "NORMALIZE", round_as
        wire(tree, (where.outputs["Object"], outward), (outward, unit), (unit, diffuse.inputs["Normal"]))
    return material


def calc(tree, operation, a, b=0.0):
    """A sum of numbers and other nodes' outputs."""
    new = node(tree, "Math")
    new.operation = operation
    for value, into in ((a, new.inputs[0]), (b, new.inputs[1])):
        if isinstance(value, (int, float)):
            into.default_value = value
        else:
            wire(tree, (value, into))
    return new


def mirror(name, color=(0.9, 0.9, 0.9), roughness=0.0):
    """Polished metal, or brushed: nothing but what it reflects."""
    material = bpy.data.materials.new(name)
    tree = nodes_of(material)
    wire(tree, (node(tree, "BsdfGlossy", Color=color, Roughness=roughness), node(tree, "OutputMaterial")))
    return material


def glass(name, color=(1.0, 1.0, 1.0), ior=1.45):
    material = bpy.data.materials.new(name)
    tree = nodes_of(material)
    wire(tree, (node(tree, "BsdfGlass", Color=color, Roughness=0.0, IOR=ior), node(tree, "OutputMaterial")))
    return material


def bricks(name, color, other, mortar, size):
    """Paving in two matt colours; `size` is a stone's length, its width and the joint's width."""
    material = flat(name, color)
    tree = material.node_tree
    diffuse = next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE")
    where = node(tree, "TexCoord")
    brick = node(tree, "TexBrick", Color1=color, Color2=other, Mortar=mortar, Scale=1.0, Mortar_Smooth=0.0,
                 Bias=-0.4, Brick_Width=size[0], Row_Height=size[1], Mortar_Size=size[2])
    wire(tree, (where.outputs["Object"], brick), (brick, diffuse))
    return material


def glow(name, color):
    """A colour that shines by itself."""
    material = bpy.data.materials.new(name)
    tree = nodes_of(material)
    wire(tree, (node(tree, "Emission", Color=color), node(tree, "OutputMaterial")))
    return material
