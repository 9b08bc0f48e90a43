# SPDX-License-Identifier: GPL-3.0-or-later
"""What lines cost by Encre, Freestyle, Line Art and Blender's compositor on one scene, for docs/speed.md.

    python tests/helpers/bench_blender.py [--size WxH] [--rounds N] [--scene NAME]

Each renders the scene by Cycles at one sample, without a denoiser; its own part is what that takes longer than Cycles
alone, in processor seconds of all threads, the least of all rounds in turns. Needs bpy.
"""

import argparse
import contextlib
import importlib
import os
import sys
import tempfile
import time
from pathlib import Path

import bench
import bpy
from encre.cli import inside, tools

ROOT = Path(__file__).parents[2]
PLAIN = "Cycles alone"
# Lines of the shapes alone, not of what mirrors show, as the others draw them.
LINES = dict(layer_source="CYCLES", light_source="CYCLES", use_shading=False, use_smudging=False, use_hatching=False,
             save_layers="OFF", line_color_strength=0.0, line_shadow_strength=0.0, line_mirror_strength=0.0)


@contextlib.contextmanager
def encre(scene, detector):
    before = scene.render.engine
    scene.render.engine = "ENCRE"
    for key, value in LINES.items():
        setattr(scene.encre, key, value)
    scene.encre.edge_detector = detector
    yield
    scene.render.engine = before


def math(tree, operation, a, b=None):
    node = tree.nodes.new("CompositorNodeMath")
    node.operation = operation
    for socket, value in zip(node.inputs, (a, b), strict=False):
        if isinstance(value, (int, float)):
            socket.default_value = value
        elif value is not None:
            tree.links.new(value, socket)
    return node.outputs[0]


def filtered(tree, kind, image):
    node = tree.nodes.new("CompositorNodeFilter")
    node.filter_type = kind
    tree.links.new(image, node.inputs["Image"])
    return node.outputs[0]


@contextlib.contextmanager
def compositor(scene):
    """Edges as artists make them of passes: Sobel's filter over 1/z, normals and numbers of objects, a threshold, lines
    grown to their width and blurred, multiplied over the picture."""
    layer = bpy.context.view_layer
    scene.use_nodes = layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = True
    for number, thing in enumerate(scene.objects, 1):
        thing.pass_index = number
    tree = scene.node_tree
    tree.nodes.clear()
    passes, out = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeComposite")
    near = math(tree, "DIVIDE", 1.0, passes.outputs["Depth"])
    bend = filtered(tree, "SOBEL", passes.outputs["Normal"])
    jump = math(tree, "MULTIPLY", filtered(tree, "LAPLACE", near), 60.0)
    change = filtered(tree, "SOBEL", passes.outputs["IndexOB"])
    strength = math(tree, "MAXIMUM", math(tree, "MAXIMUM", jump, bend), change)
    grown = tree.nodes.new("CompositorNodeDilateErode")
    wide = scene.render.resolution_y / 1080
    grown.distance = round(wide)
    tree.links.new(math(tree, "GREATER_THAN", strength, 0.5), grown.inputs[0])
    soft = tree.nodes.new("CompositorNodeBlur")
    soft.size_x = soft.size_y = round(2 * wide)
    tree.links.new(grown.outputs[0], soft.inputs[0])
    over = tree.nodes.new("CompositorNodeMixRGB")
    over.blend_type = "MULTIPLY"
    over.inputs[0].default_value = 1
    tree.links.new(passes.outputs["Image"], over.inputs[1])
    tree.links.new(math(tree, "SUBTRACT", 1.0, soft.outputs[0]), over.inputs[2])
    tree.links.new(over.outputs[0], out.inputs[0])
    yield
    tree.nodes.clear()
    scene.use_nodes = layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = False


def shoot(scene, context, path):
    """Processor seconds of setting up and rendering."""
    scene.render.filepath = str(path)
    start = time.process_time()
    with context(scene):
        bpy.ops.render.render(write_still=True)
        taken = time.process_time() - start
    return taken


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--scene", default="street")
    parser.add_argument("--keep", type=Path, help="a folder for the pictures")
    args = parser.parse_args()
    sys.path.insert(0, str(ROOT / "scenes"))
    inside.register()
    techniques = tools.load("compare", "techniques")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    importlib.import_module(args.scene).build()
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.image_settings.file_format = "PNG"
    scene.render.resolution_x, scene.render.resolution_y = map(int, args.size.split("x"))
    scene.render.resolution_percentage = 100
    kinds = {PLAIN: techniques.plain, "Encre, FINE": lambda s: encre(s, "FINE"),
             "Encre, DOG": lambda s: encre(s, "DOG"), "Blender's compositor": compositor,
             "Freestyle": techniques.freestyle, "Line Art": techniques.line_art}
    best, folder = {}, args.keep or Path(tempfile.mkdtemp())
    shoot(scene, techniques.plain, folder / "first.png")
    for _ in range(args.rounds):
        for name, context in kinds.items():
            try:
                taken = shoot(scene, context, folder / f"{name}.png")
            except techniques.Missing as reason:
                print(reason)
                continue
            best[name] = min(best.get(name, 1e9), taken)
    own = best["Encre, FINE"] - best[PLAIN]
    print(f"{args.scene}, {args.size}, one sample; processor seconds: all, own part, beside FINE's")
    found = {}
    for name, taken in best.items():
        part = taken - best[PLAIN]
        found[name] = [round(taken, 3), round(part, 3), round(part / own, 2)]
        print(f"{name:24}{taken:8.2f}{part:8.2f}{part / own:8.2f}", flush=True)
    bench.add("blender", {"scene": args.scene, "size": args.size, "rows": found})
    sys.stdout.flush()
    os._exit(0)  # Blender may hang where it ends


if __name__ == "__main__":
    main()
