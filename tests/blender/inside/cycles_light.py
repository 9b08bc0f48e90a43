# SPDX-License-Identifier: GPL-3.0-or-later
"""Light as Cycles renders it: its noise, mirrors, shadow catchers, direct light."""

from math import radians

import bpy
from mathutils import Vector
from studio import cube, fact, link, material, plane, shoot, sphere, stage, world


def denoised(out):
    """A noisy lamp, with the light denoised and not; the user's own denoiser is on."""
    scene = stage(samples=4)
    bpy.data.lights["Sun"].angle = 3.0
    scene.collection.objects.link(bpy.data.objects.new("Empty", None))  # Blender 3.4 has no slots of it to ask for
    scene.world = bpy.data.worlds.new("World")
    scene.cycles.use_denoising = True
    scene.encre.use_lines = scene.encre.use_hatching = False
    shoot(out, "denoised")
    fact("kept", scene.cycles.use_denoising)
    scene.encre.light_denoise = "NONE"
    scene.cycles.use_denoising = False
    shoot(out, "noisy")
    from encre.blender import versions
    from encre.pen import denoise

    fact("available", denoise.available(versions.home()))


def stripes(out):
    """Lines along the light's noise in the same view: the frame's own, and as the middle of a larger one."""
    scene = stage(160, 90, 2, ground=False)
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    wall = plane("Wall", material("Wall", (0.6, 0.6, 0.6)), z=0)
    scene.camera.location, scene.camera.rotation_euler = (0, 0, 5), (0, 0, 0)
    bpy.data.objects["Sun"].data.angle = 3
    bpy.data.objects["Sun"].data.energy = 1.76
    wall.rotation_euler = 0, 0, 0.3
    scene.world = bpy.data.worlds.new("World")
    scene.encre.use_smudging = scene.encre.use_hatching = False
    scene.encre.line_shadow_strength, scene.encre.length_unit, scene.encre.line_thickness = 1, "PIXELS", 2
    for level in ((0.2, 0, 0), (1, 0.5, 0.001)):  # just below the light that there is everywhere
        row = scene.encre.shade_levels.add()
        row.intensity, row.threshold, row.transition = level
    shoot(out, "small")
    scene.render.resolution_x, scene.render.resolution_y = 320, 270
    scene.camera.data.sensor_width *= 2
    shoot(out, "large")


def catcher(out):
    """A ground that only catches shadows, and none at all; the ground's shape is in no pass."""
    scene = stage(samples=1)
    scene.encre.use_shading = scene.encre.use_smudging = scene.encre.use_hatching = False
    scene.render.film_transparent = True
    ground = bpy.data.objects["Ground"]
    ground.scale, ground.is_shadow_catcher = (0.2, 0.2, 1), True
    shoot(out, "caught")
    ground.hide_render = True
    shoot(out, "without")


def reflections(out):
    """A mirror behind the cube and the ball; Blender 5.2 can switch off that passes see into it."""
    scene = stage(samples=8)
    plane("Mirror", mirror(), z=0)
    bpy.data.objects["Mirror"].rotation_euler = radians(-90), 0, radians(15)
    bpy.data.objects["Mirror"].location.y = 2.5
    settings = scene.view_layers[0].cycles
    shoot(out, "on")
    if hasattr(settings, "denoising_pass_follow_reflections"):
        settings.denoising_pass_follow_reflections = False
        shoot(out, "off")
        fact("kept", settings.denoising_pass_follow_reflections)


def mirror():
    found = material("Mirror", (1, 1, 1))
    inputs = found.node_tree.nodes["Principled BSDF"].inputs
    inputs["Metallic"].default_value, inputs["Roughness"].default_value = 1, 0
    return found


def direct(out):
    scene = stage()
    scene.encre.light_denoise = "NONE"
    scene.world = bpy.data.worlds.new("World")
    scene.encre.shade_light = "DIRECT"
    shoot(out, "direct")


def shadow(out):
    """A hard shadow, as Cycles renders it and as it is drawn."""
    scene = stage(320, 170, 16)
    scene.encre.shade_light = "DIRECT"
    shoot(out, "rendered")
    scene.encre.light_source = "DRAWN"
    shoot(out, "drawn")


def soft_level(out):
    """A floor in the soft shadow of slats, a board and a ball, under a lamp a metre wide and some light from all sides:
    as Cycles renders it, denoised and evened out, and denoised alone."""
    from encre.pen import samples

    scene = stage(320, 180, 16)
    for name in ("Cube", "Ball", "Sun"):
        bpy.data.objects.remove(bpy.data.objects[name])
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy, lamp.shadow_soft_size = 400, 0.5
    link("Lamp", lamp, (0, 0, 3))
    grey = material("Light grey", (0.6, 0.6, 0.6))
    for k in range(3):
        slat = cube("Slat", (k - 1.2, 0.3 * k, 1.6), 1, grey)
        slat.scale, slat.rotation_euler = (0.35, 2.5, 0.05), (0, 0, 0.3)
    cube("Board", (-2, 0, 1.5), 4, grey).scale = 1, 1, 0.02
    sphere("Ball", (0.5, 0.2, 1.4), grey)
    for obj in scene.objects:
        obj.visible_camera = obj.name == "Ground"
    world(scene, (0.3, 0.3, 0.3))
    scene.camera.location = 0.3, -2.6, 1.6
    scene.camera.rotation_euler = (Vector((0, 2.6, -2.1))).to_track_quat("-Z", "Y").to_euler()
    shoot(out, "evened")
    work = samples.even_work
    samples.even_work = lambda light, *given: work(light.copy(), *given)
    shoot(out, "denoised")
