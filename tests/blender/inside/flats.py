# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that show one image, some in flat colors and some as it is."""

import bpy
import numpy as np
from encre.blender import fast, meshes, mirrors, pictures, properties
from encre.pen import library
from studio import fact
from swatches import add, empty, lay, look, made


def _image():
    """A red spot with painted shade and grain on blue."""
    y, x = np.mgrid[:128, :128] / 127
    spot = (np.hypot(x - 0.5, y - 0.5) < 0.3)[..., None]
    color = np.where(spot, (0.8, 0.2, 0.15), (0.15, 0.3, 0.7)) * (1 - 0.3 * x)[..., None]
    color += np.random.default_rng(0).normal(0, 0.01, color.shape)
    image = bpy.data.images.new("Spot", 128, 128)
    image.pixels.foreach_set(np.dstack([color, np.ones((128, 128))]).clip(0, 1).astype(np.float32).ravel())
    image.update()
    return image


def _read(kept):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = bpy.context.scene.camera.evaluated_get(depsgraph)
    settings = properties.settings(depsgraph.scene_eval)
    return fast.read(depsgraph, settings, (camera.data.clip_start, camera.data.clip_end), kept, camera)


def _colors(texture):
    """How many colors a picture's first level has, but for what few texels have."""
    counts = np.unique(texture.texels[:texture.width * texture.height, :3], axis=0, return_counts=True)[1]
    return int((counts > 99).sum())


def flat_images(out):
    """Facts by how many flat colors the scene and the style of the second of three squares ask for: colors of the image
    by square, of what colors look into and what roughness does; how many materials there are; whether reading again
    makes no picture again. And whether a view has to draw what it reads of the same scene, and after the image has
    slid."""
    scene = empty()
    image = _image()

    def textured(tree, output):
        node, shader = add(tree, "TexImage", image=image), add(tree, "BsdfPrincipled")
        tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
        tree.links.new(node.outputs["Color"], shader.inputs["Roughness"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])

    block = made("Spotted", textured)
    lay([block] * 3)
    look()
    squares = [obj for obj in scene.objects if obj.type == "MESH"]
    scene.encre.layer_source = "ENCRE"
    scene.encre.styles.add().name = "Own"
    squares[1].encre.style = "Own"
    kept, texture = fast.Kept(), library.load().operations["texture"][0]
    for number, own in ((0, None), (8, None), (8, 0), (0, 8), (8, 3)):
        scene.encre.flat_colors = number
        style = scene.encre.styles["Own"]
        if own is not None:
            properties.set_value(style, "flat_colors", own)
        pictures.turn()
        read = _read(kept)
        by_square = []
        for mesh in read.objects.meshes:
            program = read.materials.programs[mesh.material_index]
            shown = sorted({int(row[10]) for row in program.operations if row[0] == texture})
            by_square.append([_colors(read.materials.textures[k]) for k in shown])
        again = _read(kept)
        same = all(a.texels is b.texels for a, b in zip(read.materials.textures, again.materials.textures, strict=True))
        fact(f"{number} {own}", [by_square, len(read.objects.materials), same])
    fresh = _read(fast.Kept())
    alike = _read(fast.Kept()).same(fresh)
    squares[0].data.uv_layers.active.data[0].uv.x += 0.1
    squares[0].data.update()
    fact("same", [alike, _read(fast.Kept()).same(fresh)])
    fact("by Cycles", len(meshes.extract(bpy.context.evaluated_depsgraph_get(), True, None).materials))


def image_roughness(out):
    """Whether materials blur whose roughness an image says: none of it smooth, a tenth, green alone rough, with a
    number multiplied, and a clear coat over what is rough."""
    def told(values, separate=False, factor=None, coat=0.0):
        image = bpy.data.images.new("Rough", 10, 10)
        image.colorspace_settings.name = "Non-Color"
        image.pixels.foreach_set(np.dstack([values, np.ones((10, 10))]).astype(np.float32).ravel())
        block = bpy.data.materials.new("Told")
        block.use_nodes = True
        tree = block.node_tree
        shader, node = tree.nodes["Principled BSDF"], tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        made = node.outputs["Color"]
        if separate:
            kind = "SeparateColor" if hasattr(bpy.types, "ShaderNodeSeparateColor") else "SeparateRGB"
            parts = tree.nodes.new("ShaderNode" + kind)
            tree.links.new(made, parts.inputs[0])
            made = parts.outputs[1]
        if factor is not None:
            math = tree.nodes.new("ShaderNodeMath")
            tree.links.new(made, math.inputs[0])
            made = math.outputs[0]
        tree.links.new(made, shader.inputs["Roughness"])
        name = "Coat Weight" if "Coat Weight" in shader.inputs else "Clearcoat"
        shader.inputs[name].default_value = coat
        return mirrors.blurs(block)

    rough = np.full((10, 10, 3), 0.5)
    part, green = rough.copy(), np.zeros((10, 10, 3))
    part[0], green[..., 1] = 0.02, 0.4
    fact("blurs", [told(rough), told(part), told(green, separate=True), told(rough, factor=0.5), told(rough, coat=1.0)])
