# SPDX-License-Identifier: GPL-3.0-or-later
"""How well tones stick to surfaces while a camera pans, zooms and a thing turns: figures, and sheets of pictures.

    python tests/helpers/sticks.py FOLDER

A ball, a box and a floor to the horizon, lit by formula; frames are drawn one by one, each from its own layers alone.
corr: correlation of a frame with the next one, brought back by the true motion of the surface; pop: share of the pixels
that still differ by more than a quarter after a blur of a pixel; ink: how much the share of ink varies over a motion.
"""

import sys
from pathlib import Path

import numpy as np
from encre.pen import library
from encre.pen.job import Camera, Frame, Mesh

SIZE = 640, 360
LIGHT = np.array((-0.45, -0.6, 0.66))
SUN = 1.15  # its strength


def ball(rings=48, radius=1.0):
    """Points and triangles of a sphere, and its normals at the corners."""
    up, around = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings, False),
                             indexing="ij")
    points = np.stack([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)], -1).reshape(-1, 3)
    n = 2 * rings
    a = np.arange(rings * n)
    b = a // n * n + (a + 1) % n
    corners = np.concatenate([np.c_[a, a + n, b + n], np.c_[a, b + n, b]])
    return (radius * points).astype(np.float32), corners.astype(np.int32), points[corners].astype(np.float32)


def box(half=0.9):
    points = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32) * half
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))], np.int32)


def turned(angle, place):
    out = np.eye(4)
    out[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    out[:3, 3] = place
    return out


def scene(turn=0.0):
    """Meshes, numbered from 1."""
    points, corners, normals = ball()
    floor = np.array([(-400, -40, -1), (400, -40, -1), (400, 2000, -1), (-400, 2000, -1)], np.float32)
    return [Mesh(points, corners, object_index=1, normals=normals, rest_normals=normals,
                 model=turned(turn, (-0.8, 0, 0))),
            Mesh(*box(), object_index=2, model=turned(turn + 0.5, (1.2, 0.4, -0.1))),
            Mesh(floor, np.array([[0, 1, 2], [0, 2, 3]], np.int32), object_index=3)]


def eye(pan=0.0, zoom=1.0, pitch=0.12):
    """(world -> camera, camera -> clip) of a camera that looks along y."""
    c, s = np.cos(pitch), np.sin(pitch)
    view = np.eye(4)
    view[:3, :3] = np.array([(1, 0, 0), (0, s, c), (0, -c, s)])
    view[:3, 3] = -view[:3, :3] @ np.array((pan, -7.0, 0.7))
    width, height = SIZE
    near, far, lens = 0.1, 5000.0, 2.0 * zoom
    projection = np.array([[lens, 0, 0, 0], [0, lens * width / height, 0, 0],
                           [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)], [0, 0, -1, 0]])
    return view, projection


def layers_of(meshes, view, projection, size=SIZE):
    """(layers of white things in the light, the rasteriser's pictures)."""
    width, height = size
    maps = library.raster(meshes, view, projection, Frame(width, height), size, 0.1,
                          outputs=("depth", "object", "shading", "anchor"))
    lit = np.maximum(maps["shading"] @ LIGHT.astype(np.float32), 0)[..., None] * np.float32(SUN)
    one = np.ones((height, width, 3), np.float32)
    layers = {"combined": np.concatenate([one * lit, one[..., :1]], 2), "color": one, "diffuse": one * lit,
              "depth": maps["depth"], "normal": maps["shading"], "object": maps["object"], "anchor": maps["anchor"]}
    return layers, maps


def frame(meshes, view, projection, values):
    """(ink (H, W), the rasteriser's pictures)."""
    layers, maps = layers_of(meshes, view, projection)
    off = dict.fromkeys(("use_lines", "use_shading", "use_smudging", "use_hatching"), False)
    ink = library.render(layers, {**off, "use_tones": True, **values}, camera=Camera(view[:3, :3].ravel()),
                         outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
    return ink, maps




def tone(kind, **look):
    """Values that fill all levels alike: look(pitch=8) is tone_1_pitch and so on."""
    return {f"tone_{n}{id_}": value for n in range(1, 5)
            for id_, value in {"": kind, **{f"_{name}": value for name, value in look.items()}}.items()}


# From the darkest to the brightest without a step: ink that grows.
RAMP = {"shade_levels": [(0.05,), (0.95, 0.5, 1.0)], "length_unit": "PIXELS"}
SCREENS = {
    "dots": {**RAMP, **tone("DOTS", space="SURFACE", pitch=7.0)},
    "lines": {**RAMP, **tone("LINES", space="SURFACE", pitch=7.0, angle=0.0)},
    "cross-lines": {**RAMP, **tone("CROSS", space="SURFACE", pitch=7.0, angle=0.0)},
    "hatching": {**RAMP, **tone("HATCH", space="SURFACE", pitch=7.0, angle=0.0)},
    "stipple": {**RAMP, **tone("STIPPLE", space="SURFACE", pitch=7.0)},
    "dots on the screen": {**RAMP, **tone("DOTS", pitch=7.0)},
}
MOTIONS = {"pan": [dict(pan=0.0115 * 5.3 * k / 2) for k in range(6)],
           "zoom": [dict(zoom=4 ** (k / 16)) for k in range(17)],
           "turn": [dict(turn=np.radians(2.5 * k)) for k in range(13)]}


def posed(pan=0.0, zoom=1.0, turn=0.0):
    return scene(turn), *eye(pan, zoom)


def back(one, other, second, ink):
    """(the other frame's ink where the surface of `one` is in it, where it is seen there). one, other: (meshes, view,
    projection, maps of what is seen)."""
    meshes, view, projection, maps = other
    height, width = maps["depth"].shape
    rest, number = one["anchor"][..., :3].astype(np.float64), one["object"].astype(int)
    world = np.zeros_like(rest)
    for mesh in meshes:
        own = number == mesh.object_index
        world[own] = rest[own] @ mesh.model[:3, :3].T + mesh.model[:3, 3]
    camera = world @ view[:3, :3].T + view[:3, 3]
    depth = np.where(number > 0, -camera[..., 2], 1)
    x = (camera[..., 0] * projection[0, 0] / depth + 1) / 2 * width - 0.5
    y = (1 - camera[..., 1] * projection[1, 1] / depth) / 2 * height - 0.5
    seen = (number > 0) & (x > 2) & (y > 2) & (x < width - 3) & (y < height - 3)
    x, y = np.where(seen, x, 2), np.where(seen, y, 2)
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - i, y - j
    moved = (ink[j, i] * (1 - u) + ink[j, i + 1] * u) * (1 - v) + (ink[j + 1, i] * (1 - u) + ink[j + 1, i + 1] * u) * v
    for b in (0, 1):
        for a in (0, 1):
            seen &= (second["object"][j + b, i + a] == number)
            seen &= np.abs(second["depth"][j + b, i + a] - depth) < 0.05 * depth
    return moved, seen


def blurred(picture):
    out = picture
    for axis in (0, 1):
        out = (np.roll(out, 1, axis) + 2 * out + np.roll(out, -1, axis)) / 4
    return out


def followed(values, poses):
    """(corr, pop, how much ink varies) over a motion."""
    frames = []
    for pose in poses:
        meshes, view, projection = posed(**pose)
        ink, maps = frame(meshes, view, projection, values)
        frames.append((ink, (meshes, view, projection, maps)))
    found, pops, shares = [], [], []
    for (ink, one), (after, other) in zip(frames, frames[1:], strict=False):
        moved, seen = back(one[3], other, other[3], after)
        near = seen & (one[3]["depth"] < 40) & (ink.size > 0)
        found.append(np.corrcoef(ink[near], moved[near])[0, 1])
        pops.append((np.abs(blurred(np.where(near, ink - moved, 0)))[near] > 0.25).mean())
    for ink, (_, _, _, maps) in frames:
        own = maps["object"] == 1
        lit = np.maximum(maps["shading"] @ LIGHT.astype(np.float32), 0) * SUN
        asked = 0.95 - 0.9 * np.clip(lit, 0, 1)
        shares.append(ink[own].mean() / asked[own].mean())
    return np.mean(found), np.mean(pops), np.std(shares) / np.mean(shares)


def main():
    import OpenImageIO as oiio

    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    print("| | " + " | ".join(f"{motion}: corr, pop, ink" for motion in MOTIONS) + " |")
    for name, values in SCREENS.items():
        cells = [followed(values, poses) for poses in MOTIONS.values()]
        print(f"| {name} | " + " | ".join(f"{a:.3f}, {100 * b:.2f} %, {100 * c:.1f} %" for a, b, c in cells) + " |")
        for label, pose in (("near", {}), ("zoom", dict(zoom=2.52))):
            ink, _ = frame(*posed(**pose), values)
            grey = np.round(255 * (1 - ink)).astype(np.uint8)[..., None]
            oiio.ImageBuf(grey).write(str(folder / f"{name.replace(' ', '-')}-{label}.png"))


if __name__ == "__main__":
    main()
