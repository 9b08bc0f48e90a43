# SPDX-License-Identifier: GPL-3.0-or-later
"""How well tones stick to surfaces while a camera pans, zooms, a thing turns and a figure walks: figures, and sheets.

    python tests/helpers/sticks.py FOLDER

A ball, a box and a floor to the horizon, lit by formula; frames are drawn one by one, each from its own layers alone.
corr: correlation of a frame with the next one, brought back by the true motion of the surface; pop: share of the pixels
that still differ by more than a quarter after a blur of a pixel; ink: how much the share of ink varies over a motion.
By example has colour and no ink: its brush work is followed.
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


def mapped(points, corners):
    """UV (t, 3, 2) of a ball's triangles: U winds about it from pole to pole."""
    x, y, z = np.moveaxis(points[corners].astype(np.float64), 2, 0)
    around = np.arctan2(y, x) / (2 * np.pi)
    around += np.round(around[:, :1] - around)  # on one side of the seam
    up = np.arccos(np.clip(z, -1, 1)) / np.pi
    return np.stack([around, up - around], 2).astype(np.float32)


def scene(turn=0.0):
    """Meshes, numbered from 1; the first has a UV map."""
    points, corners, normals = ball()
    floor = np.array([(-400, -40, -1), (400, -40, -1), (400, 2000, -1), (-400, 2000, -1)], np.float32)
    return [Mesh(points, corners, object_index=1, normals=normals, rest_normals=normals, uv=mapped(points, corners),
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
                          outputs=("depth", "object", "shading", "anchor", "tangent", "card"))
    lit = np.maximum(maps["shading"] @ LIGHT.astype(np.float32), 0)[..., None] * np.float32(SUN)
    one = np.ones((height, width, 3), np.float32)
    layers = {"combined": np.concatenate([one * lit, one[..., :1]], 2), "color": one, "diffuse": one * lit,
              "depth": maps["depth"], "normal": maps["shading"], "object": maps["object"], "anchor": maps["anchor"],
              "tangent": maps["tangent"], "card": maps["card"]}
    return layers, maps


def inked(layers, view, values, image=None):
    """(H, W) ink of tones on these layers. image: what reads the images of settings."""
    off = dict.fromkeys(("use_lines", "use_shading", "use_smudging", "use_hatching"), False)
    return library.render(layers, {**off, "use_tones": True, **values}, camera=Camera(view[:3, :3].ravel()),
                          image=image, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]


def frame(meshes, view, projection, values, image=None):
    """(ink (H, W), the rasteriser's pictures)."""
    layers, maps = layers_of(meshes, view, projection)
    return inked(layers, view, values, image), maps


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
    "strokes toward the light": {**RAMP, **tone("HATCH", space="SURFACE", pitch=7.0, angle=0.0),
                                 "tone_strokes": "LIGHT"},
    "strokes along UV": {**RAMP, **tone("HATCH", space="SURFACE", pitch=7.0, angle=0.0), "tone_strokes": "UV"},
    "stipple": {**RAMP, **tone("STIPPLE", space="SURFACE", pitch=7.0)},
    "dots painted on": {**RAMP, **tone("DOTS", space="OBJECT", pitch=8.0)},
    "strokes painted on": {**RAMP, **tone("HATCH", space="OBJECT", pitch=8.0, angle=0.0)},
    "flat dots": {**RAMP, **tone("DOTS", space="FLAT", pitch=7.0)},
    "dots on the screen": {**RAMP, **tone("DOTS", pitch=7.0)},
}
PICTURES = {name: {**RAMP, **tone("IMAGE", space=space, pitch=90.0, image="tile")}
            for name, space in (("picture", "SURFACE"), ("picture painted on", "OBJECT"))}
EXAMPLE = {**dict.fromkeys(("use_lines", "use_shading", "use_smudging", "use_hatching"), False), "use_example": True}
MOTIONS = {"pan": [dict(pan=0.0115 * 5.3 * k / 2) for k in range(6)],
           "zoom": [dict(zoom=4 ** (k / 16)) for k in range(17)],
           "turn": [dict(turn=np.radians(2.5 * k)) for k in range(13)],
          "walk": [dict(walk=k) for k in range(13)]}


def posed(pan=0.0, zoom=1.0, turn=0.0, walk=None):
    if walk is None:
        return scene(turn), *eye(pan, zoom)
    import hands  # it imports this

    return hands.walker(walk / 24, 0.05 * walk - 0.3), *eye(zoom=1.6)


def way(one, other):
    """(the column and row left and above of where the surface of `one` is in the other frame, how far from there, where
    it is seen there, but for what stands still about one who walks). one, other: (meshes, view, projection, maps of
    what is seen)."""
    meshes, view, projection, second = other
    height, width = second["depth"].shape
    for mesh, moved in zip(one[0], meshes, strict=True):
        mesh.attributes = (moved.points @ moved.model[:3, :3].T + moved.model[:3, 3]).astype(np.float32)[mesh.corners]
    world = library.raster(*one[:3], Frame(width, height), (width, height), 0.1, channels=3,
                           outputs=("attributes",))["attributes"].astype(np.float64)
    number, close = one[3]["object"].astype(int), 0.05
    if len(meshes) == 2:  # an arm is as near as what it passes
        number, close = np.where(number == 1, 1, 0), 0.005
    camera = world @ view[:3, :3].T + view[:3, 3]
    depth = np.where(number > 0, -camera[..., 2], 1)
    x = (camera[..., 0] * projection[0, 0] / depth + 1) / 2 * width - 0.5
    y = (1 - camera[..., 1] * projection[1, 1] / depth) / 2 * height - 0.5
    seen = (number > 0) & (x > 2) & (y > 2) & (x < width - 3) & (y < height - 3)
    x, y = np.where(seen, x, 2), np.where(seen, y, 2)
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - i, y - j
    for b in (0, 1):
        for a in (0, 1):
            seen &= (second["object"][j + b, i + a] == number)
            seen &= np.abs(second["depth"][j + b, i + a] - depth) < close * depth
    return i, j, u, v, seen


def taken(ink, i, j, u, v):
    return (ink[j, i] * (1 - u) + ink[j, i + 1] * u) * (1 - v) + (ink[j + 1, i] * (1 - u) + ink[j + 1, i + 1] * u) * v


def back(one, other, ink):
    """(the other frame's ink where the surface of `one` is in it, where it is seen there)."""
    *place, seen = way(one, other)
    return taken(ink, *place), seen


def blurred(picture):
    out = picture
    for axis in (0, 1):
        out = (np.roll(out, 1, axis) + 2 * out + np.roll(out, -1, axis)) / 4
    return out


def followed_each(screens, poses, image=None):
    """{name: (corr, pop, how much ink varies)} of several tones {name: values} over a motion that is drawn once."""
    found, before = {name: ([], [], []) for name in screens}, None
    for pose in poses:
        meshes, view, projection = posed(**pose)
        layers, maps = layers_of(meshes, view, projection)
        inks, here = {name: inked(layers, view, values, image) for name, values in screens.items()}, (
            meshes, view, projection, maps)
        own = maps["object"] == 1
        lit = np.maximum(maps["shading"] @ LIGHT.astype(np.float32), 0) * SUN
        asked = (0.95 - 0.9 * np.clip(lit, 0, 1))[own].mean()
        if before:
            *place, seen = way(before[1], here)
            near = seen & (before[1][3]["depth"] < 40)
        for name, (corrs, pops, shares) in found.items():
            shares.append(inks[name][own].mean() / asked)
            if before:
                ink, moved = before[0][name], taken(inks[name], *place)
                corrs.append(np.corrcoef(ink[near], moved[near])[0, 1])
                pops.append((np.abs(blurred(np.where(near, ink - moved, 0)))[near] > 0.25).mean())
        before = inks, here
    return {name: (np.mean(corrs), np.mean(pops), np.std(shares) / np.mean(shares))
            for name, (corrs, pops, shares) in found.items()}


def followed(values, poses, image=None):
    """(corr, pop, how much ink varies) over a motion."""
    return followed_each({"": values}, poses, image)[""]


def painted(values, poses, image):
    """(corr, pop) of the brush work that by example paints on white things in even light."""
    frames = []
    for pose in poses:
        meshes, view, projection = posed(**pose)
        layers, maps = layers_of(meshes, view, projection)
        layers["diffuse"] = np.full_like(layers["diffuse"], 0.6)
        drawn = library.render(layers, values, camera=Camera(view[:3, :3].ravel()), image=image).images["Combined"]
        bright = coarse = drawn[..., :3].mean(-1)
        for _ in range(60):
            coarse = blurred(coarse)
        frames.append((bright - coarse, (meshes, view, projection, maps)))
    found, pops = [], []
    for (one, here), (after, there) in zip(frames, frames[1:], strict=False):
        moved, seen = back(here, there, after)
        near = seen & (here[3]["depth"] < 40)
        found.append(np.corrcoef(one[near], moved[near])[0, 1])
        pops.append((np.abs(blurred(np.where(near, one - moved, 0)))[near] > 0.25).mean())
    return np.mean(found), np.mean(pops)


def flat_ink(kind, light):
    """(H, W) ink on the screen of what is lit so (H, W)."""
    one = np.ones((*light.shape, 3), np.float32)
    lit = one * np.float32(light)[..., None]
    layers = {"combined": np.concatenate([lit, one[..., :1]], 2), "color": one, "diffuse": lit,
              "depth": 5 * one[..., :1], "normal": one}
    off = dict.fromkeys(("use_lines", "use_shading", "use_smudging", "use_hatching"), False)
    return library.render(layers, {**off, "use_tones": True, **RAMP, **tone(kind, pitch=7.0)},
                          outputs=["Encre Tones"]).images["Encre Tones"][..., 3]


def ramp(kind, size):
    """(H, W) ink from 5 to 95 % on the screen."""
    return flat_ink(kind, np.broadcast_to(np.linspace(1, 0, size[0]), size[::-1]))


def strokes():
    """(H, W) ink of strokes and of spots: on things, and below in eight steps from 5 to 95 %."""
    parts = []
    for name, kind in (("hatching", "HATCH"), ("stipple", "STIPPLE")):
        steps = [np.pad(flat_ink(kind, np.full((112, SIZE[0] // 8 - 4), light)), 2) for light in np.linspace(1, 0, 8)]
        parts.append(np.concatenate([frame(*posed(), SCREENS[name])[0], np.concatenate(steps, 1)]))
    return np.concatenate(parts, 1)


def sheet():
    """(H, W) ink of every tone: in each space, and as a ramp."""
    rows = []
    for kind in ("DOTS", "LINES", "CROSS", "HATCH", "STIPPLE"):
        cells = [frame(*posed(), {**RAMP, **tone(kind, space=space, pitch=7.0)})[0][70:310, 130:570]
                 for space in ("SCREEN", "SURFACE", "OBJECT")]
        rows.append(np.concatenate([np.pad(cell, 4) for cell in (*cells, ramp(kind, (240, 240)))], 1))
    return np.concatenate(rows)


def printed():
    """(H, W) ink or none of 3 cm by 2 of a page at 600 dots an inch: dots and lines, 60 to the inch."""
    size, parts = (2400, 1350), []
    layers, _ = layers_of(*posed(), size)
    off = dict.fromkeys(("use_lines", "use_shading", "use_smudging", "use_hatching"), False)
    for kind in ("DOTS", "LINES"):
        values = {**off, **RAMP, **tone(kind, pitch=60.0), "use_tones": True, "tone_crisp": True,
                  "tone_pitch_unit": "LPI", "length_unit": "MM", "page_height": 1350 / 600 * 25.4}
        ink = library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
        parts.append(ink[480:952, 760:1114])
    return np.concatenate(parts, 1)


def cells_of(values, image=None):
    """A row's figures, motion by motion."""
    return [f"{a:.3f}, {100 * b:.2f} %, {100 * c:.1f} %"
            for a, b, c in (followed(values, poses, image) for poses in MOTIONS.values())]


def main():
    import OpenImageIO as oiio
    from encre.cli.images import read_chosen
    sys.path.insert(0, str(Path(__file__).parents[1]))  # the twins, by which pictures are tiled
    from toned import tile

    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    for name, ink in (("tones", sheet()), ("tones_strokes", strokes()), ("tones_print", printed())):
        oiio.ImageBuf(np.round(255 * (1 - ink)).astype(np.uint8)[..., None]).write(str(folder / f"{name}.png"))
    print("| | " + " | ".join(f"{motion}: corr, pop, ink" for motion in MOTIONS) + " |")
    for name, values in SCREENS.items():
        print(f"| {name} | " + " | ".join(cells_of(values)) + " |", flush=True)
        for label, pose in (("near", {}), ("zoom", dict(zoom=2.52))):
            ink, _ = frame(*posed(**pose), values)
            grey = np.round(255 * (1 - ink)).astype(np.uint8)[..., None]
            oiio.ImageBuf(grey).write(str(folder / f"{name.replace(' ', '-')}-{label}.png"))
    for name, values in PICTURES.items():
        print(f"| {name} | " + " | ".join(cells_of(values, lambda _: tile(90, 90))) + " |", flush=True)
    cells = [painted(EXAMPLE, poses, read_chosen) for poses in MOTIONS.values()]
    print("| by example | " + " | ".join(f"{a:.3f}, {100 * b:.2f} %" for a, b in cells) + " |")


if __name__ == "__main__":
    main()
