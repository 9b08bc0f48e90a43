# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: Cycles' own with Encre chosen, and of lines into textures."""

import os
from pathlib import Path

import bpy
from studio import fact, material, plane, shoot, stage


def bake(out):
    scene = stage(samples=1)
    box = bpy.data.objects["Cube"]
    box.data.uv_layers.new(name="UV")
    tree = box.data.materials[0].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Bake", 16, 16)
    tree.nodes.active = node
    box.select_set(True)
    bpy.context.view_layer.objects.active = box
    shoot(out, "before")
    camera, scene.camera = scene.camera, None  # baking needs none
    try:
        bpy.ops.object.bake(type="DIFFUSE", pass_filter={"COLOR"})
        fact("baked", max(node.image.pixels[:]))
    except RuntimeError as error:
        fact("baked", str(error))
    scene.camera = camera
    fact("error", shoot(out, "after"))


def striped(name, red, floating=False, at=None):
    """A material whose colour is an image, half white, half of a red that is given."""
    import numpy as np

    image = bpy.data.images.new(name, 64, 32, float_buffer=floating, alpha=True)
    pixels = np.ones((32, 64, 4), np.float32)
    pixels[:, 24:40, :3] = red, 0.2, 0.2
    image.pixels.foreach_set(pixels.reshape(-1))
    if at:
        image.filepath_raw, image.file_format = at, "PNG"
        image.save()
    mat = material(name, (1, 1, 1))
    node = mat.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    mat.node_tree.links.new(node.outputs[0], mat.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return mat, node


def bake_lines(out):
    import numpy as np

    stage()
    scene = bpy.context.scene
    scene.encre.line_thickness = 6
    path = os.path.join(out, "One lines.png")  # what a careless name for the baked image would be
    (one, first), (two, second) = striped("One", 0.4, at=path), striped("Two", 0.8, floating=True)
    normal, bump = striped("Normal", 0.1)
    bump.image.colorspace_settings.name = "Non-Color"
    scale, scaled = striped("Scaled", 0.6)
    mapping = scale.node_tree.nodes.new("ShaderNodeMapping")
    scale.node_tree.links.new(mapping.outputs[0], scaled.inputs["Vector"])
    nodes = first, second, bump, scaled
    bpy.ops.mesh.primitive_uv_sphere_add()
    ball = bpy.context.object
    for mat in (one, two, normal, scale):
        ball.data.materials.append(mat)
    bare = plane("Bare", one)
    bare.select_set(True)
    before = Path(path).read_bytes()

    def show(name):
        fact(name, [[n.image.name, n.image.packed_file is not None, n.image.is_float] for n in nodes])

    def red(image):
        pixels = np.empty(64 * 32 * 4, np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(32, 64, 4)[16, :, 0].astype(float).round(4).tolist()

    fact("images", [n.image.name for n in nodes])
    fact("plain", list(bpy.ops.encre.bake()))
    show("packed")
    fact("red", [red(first.image), red(second.image)])
    fact("again", list(bpy.ops.encre.bake()))
    fact("not twice", red(first.image))
    fact("source", first.image["encre_source"].name)
    bare.select_set(False)
    fact("uniform", list(bpy.ops.encre.bake(uniform=True, where="FOLDER", directory=out)))
    show("stored")
    fact("files", sorted(os.listdir(out)))
    fact("original kept", Path(path).read_bytes() == before)
    fact("fit", list(bpy.ops.encre.fit_contrast()))
    fact("contrast", scene.encre.contrast_full)
    scene.encre.contrast_metric = "CMC"  # only just set, as a script does
    bpy.ops.encre.fit_contrast()
    fact("contrast, CMC", scene.encre.contrast_full)

    def refused(**options):
        try:
            return list(bpy.ops.encre.bake(**options))
        except RuntimeError as error:
            return str(error)

    fact("refused", refused(where="FOLDER", directory=os.path.join(path, "below")))
    bpy.ops.object.select_all(action="DESELECT")
    bpy.data.objects["Cube"].select_set(True)
    fact("refused", refused())
    fact("refused", refused(where="FOLDER", directory=""))
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(out, "library.blend"), copy=True)
    with bpy.data.libraries.load(os.path.join(out, "library.blend"), link=True) as (_, loaded):
        loaded.materials = [one.name]
    bpy.data.objects["Cube"].data.materials[0] = loaded.materials[0]
    fact("linked", refused())
