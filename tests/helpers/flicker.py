# SPDX-License-Identifier: GPL-3.0-or-later
"""How much the width of lines on flat prints flickers during the living room's flight: a table for docs/compare.md.

    python tests/helpers/flicker.py FOLDER      renders 24 frames into FOLDER, or takes those that are there; needs bpy

Contours that lie still on rug, walls and pictures are followed from frame to frame. Across each, the ink is summed to
a width in pixels; what is left of that width after a parabola in time (the camera comes nearer) is flicker.
"""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from encre.cli import tools
from encre.pen import colour
from mathutils import Vector

compare = tools.load("compare", "compare")
SCENES = Path(__file__).parents[2] / "scenes"
FIRST, COUNT, WIDTH, HEIGHT, SAMPLES = 140, 24, 384, 216, 2
ALONG, ACROSS = 6, 14   # texels: a contour is straight and alone for so far
STEP = 0.25             # pixels between samples across a line
MARGIN = 2.0            # pixels on each side of a line that must be free of others


def render(folder, name, *options):
    """{frame: (plain, baked, dynamic)}, linear light."""
    last = FIRST + COUNT - 1
    if not (folder / f"{name}{last:04}.png").exists():
        command = [sys.executable, "-m", "encre", "compare", str(SCENES / "living_room.py"), "-o",
                   str(folder / f"{name}####.png"), "--quadrants", "--seed", "0", "-s", str(FIRST), "-e", str(last),
                   "--size", f"{WIDTH}x{HEIGHT}", "--samples", str(SAMPLES), *options]
        subprocess.run(command, check=True)
    found = {}
    for frame in range(FIRST, last + 1):
        picture = colour.decode_srgb(compare.read(folder / f"{name}{frame:04}.png"))
        top, low = picture[:HEIGHT], picture[HEIGHT:]
        found[frame] = top[:, :WIDTH], low[:, :WIDTH], low[:, WIDTH:]
    return found


def contours(image):
    """(u, v, du, dv) of straight contours between texels: the place, and the step of a texel across."""
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    grid = np.round(pixels.reshape(height, width, 4)[..., :3] * 255).astype(int) @ [65536, 256, 1]
    found = []
    for axis in (0, 1):
        turned = grid.T if axis else grid
        here = np.ones(turned.shape, bool)
        for k in range(1, ACROSS):
            here &= (np.roll(turned, k, 1) == turned) & (np.roll(turned, -k - 1, 1) == np.roll(turned, -1, 1))
        here &= turned != np.roll(turned, -1, 1)
        for k in range(-ALONG, ALONG + 1):
            for side in (0, -1):
                here &= np.roll(np.roll(turned, side, 1), k, 0) == np.roll(turned, side, 1)
        y, x = np.nonzero(here)
        u, v = (x + 1) / turned.shape[1], (y + 0.5) / turned.shape[0]
        step = np.full(len(u), 1 / turned.shape[1])
        found.append(np.stack([v, u, 0 * u, step] if axis else [u, v, step, 0 * u], 1))
    return np.concatenate(found)


def marks(scene, count=4000):
    """Points on contours and, for each, the points ACROSS texels to both sides of it, in world space."""
    rng, found = np.random.default_rng(0), []
    for obj in scene.objects:
        if obj.type != "MESH" or len(obj.data.polygons) != 1:
            continue
        node = next((n for n in obj.data.materials[0].node_tree.nodes if n.type == "TEX_IMAGE"), None)
        if not node:
            continue
        lines = contours(node.image)
        corners = np.array([obj.matrix_world @ obj.data.vertices[k].co for k in obj.data.polygons[0].vertices])
        uv = np.array([corner.uv for corner in obj.data.uv_layers[0].data])
        axes = np.linalg.solve([uv[1] - uv[0], uv[3] - uv[0]], [corners[1] - corners[0], corners[3] - corners[0]])
        tiles = np.floor(uv.max(0) - 1e-6).astype(int) + 1
        for line in lines[rng.permutation(len(lines))[:count]]:
            place = line[:2] + rng.integers(0, np.maximum(tiles, 1))
            at = corners[0] + (place - uv[0]) @ axes
            off = ACROSS * line[2:] @ axes
            found.append((at, at + off, at - off))
    found = np.array(found)
    return found[rng.permutation(len(found))[:count]]


def on_screen(scene, point):
    x, y, z = world_to_camera_view(scene, scene.camera, Vector(point))
    return np.array([x * WIDTH - 0.5, (1 - y) * HEIGHT - 0.5]), z


def visible(scene, depsgraph, point):
    eye = scene.camera.matrix_world.translation
    ray = Vector(point) - eye
    hit, where, *_ = scene.ray_cast(depsgraph, eye, ray.normalized())
    return hit and (where - Vector(point)).length < 0.02


def sample(picture, at):
    x, y = at.T
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = x - x0, y - y0
    return (picture[y0, x0] * (1 - fx) * (1 - fy) + picture[y0, x0 + 1] * fx * (1 - fy)
            + picture[y0 + 1, x0] * (1 - fx) * fy + picture[y0 + 1, x0 + 1] * fx * fy)


def profiles(scene, points):
    """{frame: [samples (n, 2) across the line, or None where it is not to be seen]}."""
    found = {}
    for frame in range(FIRST, FIRST + COUNT):
        scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found[frame] = []
        for at, one, other in points:
            (p, z), (a, _), (b, _) = (on_screen(scene, q) for q in (at, one, other))
            reach = min(np.linalg.norm(a - p), np.linalg.norm(b - p))
            inside = 20 < p[0] < WIDTH - 20 and 20 < p[1] < HEIGHT - 20
            if z <= 0 or not inside or reach < MARGIN + 1 or not visible(scene, depsgraph, at):
                found[frame].append(None)
                continue
            normal = (a - b) / np.linalg.norm(a - b)
            reach = min(reach, 12.0)
            found[frame].append(p + np.arange(-reach, reach + 1e-6, STEP)[:, None] * normal)
    return found


def widths(pictures, which, across):
    """(point, frame), NaN where a point is not to be seen."""
    table = []
    for frame, places in across.items():
        plain, picture = pictures[frame][0].sum(2), pictures[frame][which].sum(2)
        ink = np.clip(1 - picture / np.maximum(plain, 0.02), -1, 1)
        table.append([np.nan if p is None else sample(ink, p).sum() * STEP for p in places])
    return np.array(table).T


def flicker(table):
    """Of each point: deviation of its width from a parabola in time, as a share of its mean width."""
    t = np.arange(table.shape[1])
    fit = np.polynomial.polynomial.polyfit(t, table.T, 2)
    rest = table - np.polynomial.polynomial.polyval(t, fit)
    return np.sqrt((rest ** 2).mean(1)) / table.mean(1)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    plain_levels, mips = render(folder, "finest"), render(folder, "mips", "--mips")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    sys.path.insert(0, str(SCENES))
    import living_room
    living_room.build()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    points = marks(scene)
    across = profiles(scene, points)
    tables = {"dynamic": widths(plain_levels, 2, across), "baked": widths(plain_levels, 1, across),
              "baked, mip levels": widths(mips, 1, across)}
    whole = np.all([np.isfinite(t).all(1) & (t.mean(1) > 0.3) for t in tables.values()], 0)
    print(f"{whole.sum()} contours, {COUNT} frames from {FIRST}, {WIDTH} x {HEIGHT}, {SAMPLES} samples\n")
    print("| lines | width, median | flicker, median | flicker, 90 % below |\n|---|---|---|---|")
    for name, table in tables.items():
        f = flicker(table[whole])
        print(f"| {name} | {np.median(table[whole]):.2f} px | {100 * np.median(f):.1f} % | "
              f"{100 * np.quantile(f, 0.9):.1f} % |")


if __name__ == "__main__":
    main()
