# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre compare`: what stands where, and that both techniques draw the same width where nothing foreshortens it."""

import subprocess
import sys

import blenders
import numpy as np
import OpenImageIO as oiio
import pytest
from encre import compare, core, images

# Planes that face the camera at two distances, with stripes that differ in green and blue and are alike in red.
SCENE = '''
import bpy
import numpy as np

scene = bpy.context.scene
WIDTH, DISTANCES = 0.6, (2.0, 4.0)
texels = np.ones((256, 1024, 4), np.float32)
texels[..., :3] = 0.8
texels[:, 256:768, 1:3] = 0.25
image = bpy.data.images.new("Stripes", 1024, 256)
image.pixels.foreach_set(texels.ravel())
image.update()
material = bpy.data.materials.new("Stripes")
material.use_nodes = True
tree = material.node_tree
tree.nodes.clear()
texture, shine, out = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexImage", "Emission", "OutputMaterial"))
texture.image = image
tree.links.new(texture.outputs[0], shine.inputs[0])
tree.links.new(shine.outputs[0], out.inputs[0])
for distance, side in zip(DISTANCES, (-1, 1)):
    w, h = WIDTH * distance / 2, 0.6 * distance
    x = side * distance * 0.4
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata([(x - w, -h, -distance), (x + w, -h, -distance), (x + w, h, -distance), (x - w, h, -distance)],
                     [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    u, v = w / WIDTH, 4 * h / WIDTH  # the far plane shows more of the same cloth
    layer.data.foreach_set("uv", [-u, -v, u, -v, u, v, -u, v])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Plane", mesh))
camera = bpy.data.cameras.new("Camera")
scene.camera = bpy.data.objects.new("Camera", camera)
scene.collection.objects.link(scene.camera)
scene.cycles.samples, scene.cycles.use_denoising = 16, False
scene.render.resolution_x, scene.render.resolution_y = 480, 270
scene.view_settings.view_transform = "Standard"
'''
FLAT = ("--preset", "inter_color", "--set", "line_thickness=24", "--set", "line_depth_distance=4")


@pytest.fixture
def stripes(tmp_path):
    (tmp_path / "stripes.py").write_text(SCENE)
    return tmp_path / "stripes.py"


def encre(*args):
    return subprocess.run([sys.executable, "-m", "encre", *map(str, args)], capture_output=True, text=True, timeout=300)


def widths(picture, plain):
    """Ink in pixels across every line, from the red that both colours have alike, by the middle rows."""
    rows = slice(100, 170)
    linear = [images.decode_srgb(p[rows, :, 0]).mean(0) for p in (picture, plain)]
    ink = np.clip(1 - linear[0] / np.maximum(linear[1], 1e-3), 0, 1) * (linear[1] > 0.3)
    starts = np.flatnonzero((ink[1:] > 0.02) & (ink[:-1] <= 0.02)) + 1
    return [run[:np.argmax(np.append(run, 0) <= 0.02)].sum() for run in (ink[k:] for k in starts)]


@pytest.mark.parametrize("detector", [item.id for item in core.params()["edge_detector"].items if item.id != "DOG"])
def test_equally_wide_where_nothing_foreshortens(stripes, tmp_path, detector):
    done = encre("compare", stripes, "-o", tmp_path / "out.png", *FLAT, "--quadrants", "--seed", "0",
                 "--set", f"edge_detector={detector}", "--set", "edge_object=0")
    assert done.returncode == 0, done.stderr
    picture = compare.read(tmp_path / "out.png")
    assert picture.shape == (540, 960, 3)
    plain, baked, dynamic = picture[:270, :480], picture[270:, :480], picture[270:, 480:]
    # The lines of stripes, without those of the planes' sides.
    baked, dynamic = (np.array([w for w in widths(q, plain)]) for q in (baked, dynamic))
    print(baked, dynamic)
