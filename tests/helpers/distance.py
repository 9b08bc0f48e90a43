# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of lines between colours where a texture is far away: a table for docs/compare.md.

    python tests/helpers/distance.py [FOLDER]      renders a chequered floor up to the horizon; a folder keeps the EXR

Every row of the frame sees the checks at one size. The table has, by the height of a check in pixels, how much of the
checks' contrast is left in the albedo layer and how much of the row is ink.
"""

import sys
import tempfile
from pathlib import Path

import blenders
import exr
import numpy as np

WIDTH, HEIGHT, CHECK, EYE = 960, 540, 0.25, 1.0  # metres: the side of a check, the camera's height
SCENE = f'''
import bpy
import numpy as np

scene = bpy.context.scene
texels = np.ones((128, 128, 4), np.float32)
texels[..., :3] = 0.85
texels[:64, :64, :3] = texels[64:, 64:, :3] = 0.2, 0.3, 0.5
image = bpy.data.images.new("Checks", 128, 128)
image.pixels.foreach_set(texels.ravel())
image.update()
material = bpy.data.materials.new("Checks")
material.use_nodes = True
tree = material.node_tree
tree.nodes.clear()
texture, matt, out = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexImage", "BsdfDiffuse", "OutputMaterial"))
texture.image = image
tree.links.new(texture.outputs[0], matt.inputs[0])
tree.links.new(matt.outputs[0], out.inputs[0])
mesh = bpy.data.meshes.new("Floor")
corners = [(-999, 0, 0), (999, 0, 0), (999, 999, 0), (-999, 999, 0)]
mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [c / {2 * CHECK} for corner in corners for c in corner[:2]])
mesh.materials.append(material)
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
eye = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
eye.location, eye.rotation_euler = (0, 0, {EYE}), (np.pi / 2, 0, 0.3)
eye.data.clip_end, eye.data.shift_y = 2000, -0.2
scene.camera = eye
for obj in bpy.data.objects.new("Floor", mesh), sun, eye:
    scene.collection.objects.link(obj)
scene.cycles.use_denoising = False
scene.view_settings.view_transform = "Standard"
'''


def rows(folder, samples):
    """For every row under the horizon: height of a check in pixels, contrast of the albedo's grey, share of ink."""
    (folder / "floor.py").write_text(SCENE)
    out = folder / f"floor{samples}.exr"
    blenders.encre("bpy", folder, "render", folder / "floor.py", "-o", out, "--preset", "inter_color", "--set",
                   "line_far_distance=0", "--size", f"{WIDTH}x{HEIGHT}", "--samples", samples)
    depth, albedo, ink = (exr.part(out, f"ViewLayer.{name}") for name in ("Depth", "DiffCol", "Encre Lines"))
    size = CHECK * EYE * WIDTH * 50 / 36 / depth[:, WIDTH // 2, 0] ** 2
    grey, level = albedo.mean(2), [np.mean([((c + 0.055) / 1.055) ** 2.4 for c in color])
                                   for color in ((0.85,) * 3, (0.2, 0.3, 0.5))]
    return size, 2 * grey.std(1) / (level[0] - level[1]), ink[..., 3].mean(1)


def main():
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        folder.mkdir(parents=True, exist_ok=True)
        print("| height of a check | " + " | ".join(f"contrast, {n} samples | ink" for n in (4, 16, 64)) + " |")
        print("|---|" + "---|" * 6)
        tables = [rows(folder, n) for n in (4, 16, 64)]
        for size in (32, 16, 8, 4, 2, 1, 0.5, 0.25):
            cells = []
            for sizes, contrast, ink in tables:
                near = (sizes > size / 1.15) & (sizes < size * 1.15)
                cells += [f"{contrast[near].mean():.2f}", f"{100 * ink[near].mean():.0f} %"]
            print(f"| {size:g} px | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
