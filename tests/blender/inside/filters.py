# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer leaves out or has instead, by Cycles and by Encre alone."""

import bpy
from quick import _cut, _leaf, _matt, _new, _square
from studio import both, cube, material, plane, stage, world


def _scene():
    scene = stage(96, 54, 4)
    scene.encre.light_denoise = "NONE"  # as it is rendered
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BOX", 0.01, 0
    scene.encre.save_layers, scene.encre.light_source = "ON", "DRAWN"
    return scene


def _earth(tree):
    color = _new(tree, "RGB").outputs[0]
    color.default_value = 0.7, 0.5, 0.3, 1
    return color


def clay_and_own(out):
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
    both(scene, out, "own")
    scene.view_layers[0].material_override = clay
    both(scene, out, "clay")


def filtered(out):
    """Under a lamp and a world, with a thing that glows, one that shines and one of hair: all; without the world, as it
    is and with no lamp, with a film of three tenths, without hair, without surfaces."""
    scene, layer = _scene(), bpy.context.view_layer
    world(scene, (0.3, 0.4, 0.6))
    glow = bpy.data.materials["Red"].node_tree
    lamp = _new(glow, "Emission", Color=(0.6, 0.3, 0.1, 1))
    glow.links.new(lamp.outputs[0], glow.nodes["Material Output"].inputs["Surface"])
    shine = bpy.data.materials["Green"].node_tree
    surface = _new(shine, "BsdfGlossy", Color=(0.8, 0.7, 0.6, 1), Roughness=0.4)
    shine.links.new(surface.outputs[0], shine.nodes["Material Output"].inputs["Surface"])
    fur = cube("Fur", (0, -1, 0), 0.5, material("Brown", (0.5, 0.3, 0.2)))
    settings = fur.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.hair_length, settings.radius_scale = "HAIR", 60, 0.4, 0.1
    layer.use_pass_emit = layer.use_pass_glossy_direct = layer.use_pass_glossy_color = True
    both(scene, out, "all")
    scene.cycles.film_exposure = 0.3
    both(scene, out, "exposed")
    scene.cycles.film_exposure = 1
    for name in ("use_sky", "use_strand", "use_solid"):
        setattr(layer, name, False)
        both(scene, out, name)
        setattr(layer, name, True)
    if hasattr(layer, "world_override"):
        world(scene, (0.6, 0.2, 0.1))
        layer.world_override, scene.world = scene.world, None
        both(scene, out, "world_override")
