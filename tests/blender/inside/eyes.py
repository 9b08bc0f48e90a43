# SPDX-License-Identifier: GPL-3.0-or-later
"""What line work fills: a doll's head whose face is an image, and button eyes of their own mesh."""

import math

import bpy
import numpy as np
from studio import cube, fact, material, shoot, stage

LOOKS = "ink_only", "brush_ink", "pencil"


def _face():
    """An eye with a pupil in a brown iris, a brow above it, and a dark scarf as wide as the image."""
    y, x = np.mgrid[:256, :256] / 128 - 1
    away = np.hypot(x, y)
    color = np.full((256, 256, 4), 0.93, np.float32)
    color[away < 0.3] = 0.27, 0.13, 0.06, 1
    color[away < 0.13] = 0.02, 0.02, 0.02, 1
    color[(np.abs(y - 0.6) < 0.06) & (np.abs(x) < 0.5)] = 0.05, 0.04, 0.04, 1
    color[y < -0.6] = 0.04, 0.04, 0.05, 1
    image = bpy.data.images.new("Face", 256, 256)
    image.pixels.foreach_set(color.ravel())
    image.update()
    return image


def small_blacks(out):
    """Each look of lines, the image's face seen from the front: 60 pixels high in a frame of 90."""
    scene = stage(ground=False)
    for obj in list(scene.collection.objects):
        if obj.type == "MESH":
            bpy.data.objects.remove(obj)
    skin = material("Skin", (1, 1, 1))
    node = skin.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = _face()
    skin.node_tree.links.new(node.outputs[0], skin.node_tree.nodes["Principled BSDF"].inputs[0])
    mesh = bpy.data.meshes.new("Face")
    mesh.from_pydata([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], [], [(0, 1, 2, 3)])
    mesh.uv_layers.new().data.foreach_set("uv", (0, 0, 1, 0, 1, 1, 0, 1))
    mesh.materials.append(skin)
    scene.collection.objects.link(bpy.data.objects.new("Face", mesh))
    cube("Board", (1.9, 0.5, 0), 1.5, material("Pine", (0.7, 0.6, 0.5)))
    cube("Button", (1.9, -0.3, 0), 0.24, material("Horn", (0.01, 0.01, 0.01)))
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 16 / 3
    camera.location, camera.rotation_euler = (0, -10, 0), (math.pi / 2, 0, 0)
    scene.encre.layer_source = "ENCRE"
    for look in LOOKS:
        bpy.ops.encre.preset(preset=look)
        fact("failed", shoot(out, look))
