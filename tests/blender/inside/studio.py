# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene that the cases render, and how they tell what they find. The same in every Blender from 3.4 on."""

import importlib.util
import json
import os
from math import radians

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
# ENCRE_PACKAGE names another build of the package to test.
PACKAGE = os.environ.get("ENCRE_PACKAGE") or os.path.join(HERE, "..", "..", "..", "addon")
WIDTH, HEIGHT = 160, 90


def fact(name, value):
    os.write(1, f"\nFACT {json.dumps([name, value])}\n".encode())


def register():
    spec = importlib.util.spec_from_file_location("encre_inside", os.path.join(PACKAGE, "cli", "inside.py"))
    inside = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(inside)
    return inside.register()


def material(name, color):
    mat = bpy.data.materials.new(name)
    mat.use_nodes = True
    mat.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return mat


def link(name, data, at=(0, 0, 0), mat=None, collection=None):
    obj = bpy.data.objects.new(name, data)
    obj.location = at
    if mat:
        obj.data.materials.append(mat)
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def cube(name, at=(0, 0, 0), size=1.0, mat=None, collection=None):
    s = size / 2
    verts = [(x, y, z) for z in (-s, s) for x, y in ((-s, -s), (s, -s), (s, s), (-s, s))]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(verts, [], faces)
    return link(name, mesh, at, mat, collection)


def sphere(name, at=(0, 0, 0), mat=None, collection=None):
    import bmesh

    mesh = bpy.data.meshes.new(name)
    ball = bmesh.new()
    bmesh.ops.create_uvsphere(ball, u_segments=32, v_segments=16, radius=0.7)
    ball.to_mesh(mesh)
    ball.free()
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    return link(name, mesh, at, mat, collection)


def plane(name, mat=None, size=20.0, z=-0.51):
    mesh = bpy.data.meshes.new(name)
    s = size / 2
    mesh.from_pydata([(-s, -s, z), (s, -s, z), (s, s, z), (-s, s, z)], [], [(0, 1, 2, 3)])
    return link(name, mesh, mat=mat)


def stage(width=WIDTH, height=HEIGHT, samples=2, engine="ENCRE", ground=True):
    """A red cube, a green ball and a ground under one sun, on a factory-empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.cycles.samples = samples
    scene.encre.samples = 0  # Cycles' number counts
    scene.cycles.seed = 1
    scene.cycles.use_denoising = False
    passes_on(scene.view_layers[0])
    scene.encre.line_thickness = 60  # for 1080 lines: 5 pixels here
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    cam = link("Camera", bpy.data.cameras.new("Camera"), (0, -6, 1.5))
    cam.rotation_euler = (radians(80), 0, 0)
    scene.camera = cam
    sun = link("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler = (radians(40), radians(20), 0)
    sun.data.energy = 3
    cube("Cube", (-0.9, 0, 0), 1.0, material("Red", (0.8, 0.1, 0.1)))
    sphere("Ball", (0.9, 0.3, 0.2), material("Green", (0.1, 0.7, 0.2)))
    if ground:
        plane("Ground", material("Grey", (0.6, 0.6, 0.6)))
    return scene


def passes_on(view_layer, on=True):
    """Switches all passes of ours on or off, where Encre is there."""
    if hasattr(view_layer, "encre"):
        from encre.blender import properties

        for switch in properties.PASSES:
            setattr(view_layer.encre, switch, on)


def world(scene, color):
    """The same colour from everywhere: from Blender 5.0 on all worlds have nodes, beside which their own counts for
    nothing."""
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = color
    if scene.world.node_tree:
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1)


def multilayer(settings):
    """Lets a file hold passes."""
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"


def exr(scene, path):
    multilayer(scene.render.image_settings)
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = path


def shoot(out, name):
    """Renders the current frame to FOLDER/NAME.exr; returns the error's text, or None."""
    scene = bpy.context.scene
    exr(scene, os.path.join(out, f"{name}.exr"))
    try:
        bpy.ops.render.render(write_still=True)
    except RuntimeError as error:
        return str(error)
    return None


def set_all(scene, on):
    from encre.pen import settings

    for switch in settings.switches():
        setattr(scene.encre, switch, on)


def both(scene, out, name):
    """Shoots a scene by Cycles and by Encre alone."""
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        fact("failed", shoot(out, f"{name} {source}"))
