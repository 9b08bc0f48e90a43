# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer leaves out or has instead, by Cycles and by Encre alone."""

import bpy
from quick import _cut, _leaf, _matt, _new, _square
from studio import cube, fact, material, plane, shoot, stage


def _both(scene, out, name):
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        fact("failed", shoot(out, f"{name} {source}"))


def _scene():
    scene = stage(96, 54, 4)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BOX", 0.01, 0
    scene.encre.save_layers, scene.encre.light_source = "ON", "DRAWN"
    return scene


def _earth(tree):
    color = _new(tree, "RGB").outputs[0]
    color.default_value = 0.7, 0.5, 0.3, 1
    return color


def overridden(out):
    """A cube of two materials, a ball, what has no material, and a card out of which its own material cuts a disc: all
    of the one material that the view layer has, which has a style."""
    scene = _scene()
    two = bpy.data.objects["Cube"]
    two.data.materials.append(material("Blue", (0.1, 0.2, 0.8)))
    for polygon in two.data.polygons[:3]:
        polygon.material_index = 1
    bpy.data.objects["Ground"].data.materials.clear()
    cube("Bare", (-0.2, -1.2, -0.3), 0.4)
    card = plane("Card", _cut(_matt("Leaf", _leaf)), 0.8, 0.0)
    card.location, card.rotation_euler = (0, 0.5, 0.6), (1.2, 0.2, 0.3)
    _square(card)
    scene.encre.styles.add().name = "Of clay"
    clay = _matt("Clay", _earth)
    clay.encre.style = "Of clay"
    _both(scene, out, "own")
    scene.view_layers[0].material_override = clay
    _both(scene, out, "clay")
