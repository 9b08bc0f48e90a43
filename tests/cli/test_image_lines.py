# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines between the colors of an image, whoever renders the layers: as exact, kept by files, drawn again from them."""

import exr
import numpy as np
import pytest
from cube import ALL, encre, script, works
from encre.cli import multilayer
from encre.pen import abi, metadata

COLOR, SIZE = 1 << abi.CHAIN_KINDS.index("color"), 24

# A disc of 0.35 of the image's side, all over what the camera sees, which is 1.8 times as wide.
DISC = f"""
import math
image = bpy.data.images.new("Disc", {SIZE}, {SIZE})
pixels = []
for y in range({SIZE}):
    for x in range({SIZE}):
        inside = sum(math.hypot(x + (i + 0.5) / 8 - {SIZE} / 2, y + (k + 0.5) / 8 - {SIZE} / 2) < 0.35 * {SIZE}
                     for i in range(8) for k in range(8)) / 64
        pixels += [0.9 - 0.7 * inside, 0.8 - 0.7 * inside, 0.3, 1]
image.pixels = pixels
bpy.data.objects.remove(bpy.data.objects["Cube"])
sheet = bpy.data.meshes.new("Sheet")
sheet.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
sheet.uv_layers.new().data.foreach_set("uv", (0, 0, 1, 0, 1, 1, 0, 1))
sheet.materials.append(bpy.data.materials.new("Disc"))
scene.collection.objects.link(bpy.data.objects.new("Sheet", sheet))
sheet.materials[0].use_nodes = True
tree = sheet.materials[0].node_tree
surface, texture = tree.nodes["Principled BSDF"], tree.nodes.new("ShaderNodeTexImage")
texture.image = image
tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
camera.type, camera.ortho_scale = "ORTHO", 3.6
bpy.data.objects["Camera"].location = 0, 0, 4
bpy.data.objects["Camera"].rotation_euler = 0, 0, 0
"""
# What a renderer alone can read mixes another color in.
MIXED = DISC + """
mix, odd = tree.nodes.new("ShaderNodeMixRGB"), tree.nodes.new("ShaderNodeAmbientOcclusion")
tree.links.new(texture.outputs["Color"], mix.inputs[1])
tree.links.new(odd.outputs["Color"], mix.inputs[2])
tree.links.new(mix.outputs["Color"], surface.inputs["Base Color"])
"""


def rendered(tmp_path, scene, *options):
    """(file, the points of color chains in it)."""
    path = tmp_path / f"{len(list(tmp_path.iterdir()))}.exr"
    works(encre("render", script(tmp_path, scene), "-o", path, ALL, "--passes=all", "--preset=inter_color",
                "--set=line_thickness=24", "--size=320x180", "--samples=1", *options))
    with multilayer.Exr(path) as opened:
        (chains,) = metadata.read(opened.metadata).chains.values()
    return path, chains.points[chains.points["kind"] & COLOR > 0]


@pytest.mark.parametrize("by", ["--full", "--fast"])
def test_images_tell_of_lines_whoever_renders(tmp_path, by):
    path, points = rendered(tmp_path, DISC, by)
    texel = 320 / 3.6 * 2 / SIZE
    away = np.hypot(points["x"] - 159.5, points["y"] - 89.5) / texel - 0.35 * SIZE
    assert len(points) > 20 and np.abs(away).max() < 0.12
    works(encre("composite", path, "-o", tmp_path / "again.exr"))
    picture, lines = (exr.part(path, f"ViewLayer.{name}") for name in ("Combined", "Encre Lines"))
    assert np.abs(exr.picture(tmp_path / "again.exr") - picture).max() <= 1e-5
    t = np.linspace(0, 2 * np.pi, 400)
    x, y = (np.round(middle + 0.35 * SIZE * texel * way(t)).astype(int)
            for middle, way in ((159.5, np.cos), (89.5, np.sin)))
    assert (np.max([lines[y + i, x + k, 3] for i in (-1, 0, 1) for k in (-1, 0, 1)], 0) > 0.5).mean() >= 0.99


def test_of_what_cannot_be_read_a_renderer_shows_more_than_images_tell(tmp_path):
    assert not len(rendered(tmp_path, MIXED, "--full")[1])
