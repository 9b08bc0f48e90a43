# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns by formula: a card for each, by Cycles and by Encre."""

import itertools

import bpy
from studio import fact, plane, shoot, stage

_WIDE = 6  # cards in a row
_METRICS = "EUCLIDEAN", "MANHATTAN", "CHEBYCHEV"


def _cells():
    """(settings, inputs, output) of Voronoi textures."""
    kinds = itertools.product(("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE"), _METRICS, ("2D", "3D"))
    for k, (feature, metric, wide) in enumerate(kinds):
        if feature == "DISTANCE_TO_EDGE" and metric != "EUCLIDEAN":
            continue
        settings = {"feature": feature, "distance": metric, "voronoi_dimensions": wide}
        inputs = {"Scale": 1.3, "Randomness": (1.0, 0.6, 0.9)[k % 3], "Smoothness": 0.8}
        yield settings, inputs, "Distance"
        if feature != "DISTANCE_TO_EDGE":
            yield settings, inputs, ("Color", "Position")[k // 2 % 2]
    yield {"feature": "SMOOTH_F1"}, {"Smoothness": 0.0}, "Distance"
    for feature, metric in (("F1", "EUCLIDEAN"), ("F2", "MANHATTAN"), ("DISTANCE_TO_EDGE", "EUCLIDEAN")):
        yield {"feature": feature, "distance": metric, "normalize": True}, {"Scale": 2.0, "Randomness": 0.5}, "Distance"


def _material(settings, inputs, output):
    """Half of what it gives and a half more, so that it is a colour."""
    mat = bpy.data.materials.new("Pattern")
    mat.use_nodes = True
    tree = mat.node_tree
    where, texture, half, more, surface = (tree.nodes.new(f"ShaderNode{kind}") for kind in (
        "TexCoord", "TexVoronoi", "VectorMath", "VectorMath", "BsdfDiffuse"))
    for name, value in settings.items():
        if hasattr(texture, name):
            setattr(texture, name, value)
    for name, value in inputs.items():
        if name in texture.inputs:
            texture.inputs[name].default_value = value
    half.operation, half.inputs[1].default_value = "MULTIPLY", (0.2, 0.2, 0.2)
    more.inputs[1].default_value = (0.5, 0.5, 0.5)
    for out, into in ((where.outputs["Object"], texture.inputs["Vector"]), (texture.outputs[output], half.inputs[0]),
                      (half.outputs[0], more.inputs[0]), (more.outputs[0], surface.inputs["Color"]),
                      (surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])):
        tree.links.new(out, into)
    return mat


def cells(out):
    made = [*_cells()]
    high = -(-len(made) // _WIDE)
    scene = stage(40 * _WIDE, 40 * high, 1, ground=False)
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    for k, one in enumerate(made):
        card = plane("Card", _material(*one), 4.6, 0.3)
        card.location = 5 * (k % _WIDE - (_WIDE - 1) / 2), 5 * ((high - 1) / 2 - k // _WIDE), 0
        card.rotation_euler = 0.4, 0.3, 0.2
    fact("cells", [[*settings.values(), *inputs.values(), output] for settings, inputs, output in made])
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 5.0 * max(_WIDE, high)
    camera.location, camera.rotation_euler = (0, 0, 20), (0, 0, 0)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BOX", 0.01, 0
    scene.encre.save_layers = "ON"
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        shoot(out, source)
