# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `bake_window.py -- bake FOLDER` bakes as a user does: dialog, Esc, undo.

Needs --enable-event-simulate.
"""

import os
import sys
import time

import bpy
import numpy as np

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402
import window  # noqa: E402

IMAGES, SIDE = 6, 512  # enough that Esc comes before the end


def node(k):
    return bpy.data.materials[f"Material {k}"].node_tree.nodes["Image Texture"]


def shown():
    return [node(k).image.name for k in range(IMAGES)]


def build():
    """The default cube with a material for each of several images."""
    studio.register()
    bpy.context.scene.render.engine = "ENCRE"
    cube = bpy.data.objects["Cube"]
    cube.data.materials.clear()
    for k in range(IMAGES):
        image = bpy.data.images.new(f"Image {k}", SIDE, SIDE)
        pixels = np.ones((SIDE, SIDE, 4), np.float32)
        pixels[:SIDE // 2, :, 0] = k / IMAGES
        image.pixels.foreach_set(pixels.reshape(-1))
        material = bpy.data.materials.new(f"Material {k}")
        material.use_nodes = True
        material.node_tree.nodes.new("ShaderNodeTexImage").image = image
        cube.data.materials.append(material)
    cube.select_set(True)
    bpy.ops.ed.undo_push(message="Built")


def dialog():
    with window.override("VIEW_3D"):
        bpy.ops.encre.bake("INVOKE_DEFAULT")


def running():
    return any(image.name.endswith("lines") for image in bpy.data.images)


def accept():
    """The dialog, and Return until the lines are baked: a window that is not drawn yet does not hear it."""
    dialog()
    yield
    window.screenshot("dialog")
    while not running():
        window.press("RET")
        yield from until(running, 3)


def until(done, seconds):
    """Waits for done(), for so long at most."""
    end = time.monotonic() + seconds
    while not done() and time.monotonic() < end:
        yield


def bake():
    yield from accept()
    yield from until(lambda: shown()[-1].endswith("lines"), 100)
    studio.fact("baked", shown())
    yield
    with window.override("VIEW_3D"):
        bpy.ops.ed.undo()
    yield
    studio.fact("undone", shown())


def cancel():
    yield from accept()
    window.press("ESC")
    yield from until(lambda: not running(), 60)
    studio.fact("cancelled", shown())
    studio.fact("left over", running())


if __name__ == "__main__":
    window.start(window.each(build, cancel, bake))
