# SPDX-License-Identifier: GPL-3.0-or-later
"""How well what a hand draws sticks to things that move, and a figure that walks as a sheet of frames.

    python tests/helpers/hands.py FOLDER

Every frame is drawn from its own layers alone. A pen is drawn beside a plain one of the same width; what it has more or
less of, within 6 pixels of an edge, is compared with the next frame's where the surface has moved to. `ink` is how much
the ink of lines changes with the size of the picture.
"""

import sys
from pathlib import Path

import numpy as np
import sticks
from encre.pen import library
from encre.pen.job import Camera, Frame, Mesh

PLAIN = {"edge_detector": "FINE", "use_shading": False, "use_smudging": False, "use_hatching": False,
         "pen_1_softness": 0.0, "pen_1_steepness": 0.5, "pen_1_intensity": 2.0, "pen_1_grain": 0.0,
         "paper_source": "NONE",
         "line_color_strength": 0.0, "line_shadow_strength": 0.0, "line_thickness": 12.0}
PENS = {"brush": {"pen_1_pressure": 0.45, "pen_1_rough": 0.45},
        "pencil": {"pen_1_pressure": 0.2, "pen_1_pressure_length": 72.0, "pen_1_wobble": 1.3,
                   "pen_1_wobble_length": 80.0,
                   "pen_1_rough": 0.9, "pen_1_rough_length": 6.6, "pen_1_strokes": 2, "line_thickness": 6.0},
        "marker": {"pen_1_pressure": 0.07, "pen_1_dry": 0.75, "line_thickness": 15.0},
        "gaps": {"pen_1_gaps": 0.25},
        "dashes": {"pen_1_dash": 40.0, "pen_1_dash_space": 14.0, "line_thickness": 6.0},
        "strip": {"pen_1_strip": 1.0, "pen_1_strip_length": 120.0, "pen_1_strip_image": "chalk",
                  "line_thickness": 15.0}}
REACH = 6  # pixels


# ---- a figure ------------------------------------------------------------------------------------------------

def limb(start, bends, lengths, radii, rings=40, around=32):
    """(points, normals) of a tube in the plane of x and z: from `start` along pieces of these lengths, each turned by
    so many radians from straight down, that bend smoothly into each other; radii at the ends of the pieces."""
    ends = np.cumsum([0.0, *lengths])
    along = np.linspace(0, ends[-1], rings)
    soft = 0.12 * ends[-1]
    turn = bends[0] + sum((after - before) * (0.5 + 0.5 * np.tanh((along - end) / soft * 2))
                          for before, after, end in zip(bends, bends[1:], ends[1:-1], strict=False))
    way = np.stack([np.sin(turn), 0 * turn, -np.cos(turn)], -1)
    step = np.diff(along)[:, None] * (way[1:] + way[:-1]) / 2
    middle = np.concatenate([[start], start + np.cumsum(step, 0)])
    radius = np.interp(along, ends, radii)
    for _ in range(6):
        radius[1:-1] = (radius[:-2] + 2 * radius[1:-1] + radius[2:]) / 4
    round_ = np.minimum(along, ends[-1] - along) / radius.mean()
    radius *= np.sqrt(np.clip(1 - np.clip(1 - round_, 0, 0.98) ** 2, 0, 1))
    side = np.stack([way[:, 2], 0 * turn, -way[:, 0]], -1)
    angle = np.linspace(0, 2 * np.pi, around, False)
    out = side[:, None] * np.cos(angle)[:, None] + np.array((0, 1, 0)) * np.sin(angle)[:, None]
    normals = out - (np.gradient(radius, along)[:, None] * way)[:, None]
    return middle[:, None] + radius[:, None, None] * out, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def grid(rings, around):
    a = np.arange((rings - 1) * around)
    b = a // around * around + (a + 1) % around
    return np.concatenate([np.c_[a, b, a + around], np.c_[b, b + around, a + around]])


def figure(phase):
    """(points, normals, corners) of one who walks to the right, at a share of two steps; None: at rest."""
    swing = 0 if phase is None else np.sin(2 * np.pi * phase)
    lift = 0 if phase is None else np.cos(2 * np.pi * phase)
    bob = 0.0 if phase is None else 0.025 * np.cos(4 * np.pi * phase)
    parts, lean = [], 0 if phase is None else 0.06
    hip = np.array((0, 0, 0.95 + bob))
    for side in (-1, 1):
        knee = max(0.0, side * lift) * (0.9 if phase is not None else 0)
        thigh = 0.5 * side * swing + 0.2 * knee
        shin = thigh - knee
        parts.append(limb(hip + (0, 0.11 * side, 0), (thigh, shin, shin + 1.45), (0.44, 0.42, 0.19),
                          (0.115, 0.075, 0.05, 0.045)))
    top = hip + 0.52 * np.array((np.sin(lean), 0, np.cos(lean)))
    parts.append(limb(top + (0, 0, 0.06), (-lean, -lean, 0), (0.2, 0.36, 0.06), (0.05, 0.17, 0.15, 0.13)))
    for side in (-1, 1):
        upper = -0.55 * side * swing
        parts.append(limb(top + (0, 0.23 * side, 0), (upper, upper + 0.5 + 0.25 * side * swing), (0.3, 0.3),
                          (0.07, 0.05, 0.045)))
    parts.append(limb(top + (0.02, 0, 0.34), (0.1, 0, -0.1), (0.12, 0.1, 0.12), (0.07, 0.12, 0.13, 0.08)))
    faces, count = [], 0
    for points, _ in parts:
        faces.append(grid(*points.shape[:2]) + count)
        count += points.shape[0] * points.shape[1]
    flat = [np.concatenate([part[k].reshape(-1, 3) for part in parts]) for k in (0, 1)]
    return flat[0].astype(np.float32), flat[1].astype(np.float32), np.concatenate(faces).astype(np.int32)


def walker(phase, on=0.0):
    """The figure, so far on, before a floor."""
    points, normals, corners = figure(phase)
    rest, rest_normals, _ = figure(None)
    floor = np.array([(-400, -40, -1), (400, -40, -1), (400, 2000, -1), (-400, 2000, -1)], np.float32)
    model = np.eye(4)
    model[:3, 3] = on, -3.3, -1
    return [Mesh(points, corners, object_index=1, normals=normals[corners], rest=rest[corners],
                 rest_normals=rest_normals[corners], model=model),
            Mesh(floor, np.array([[0, 1, 2], [0, 2, 3]], np.int32), object_index=2)]


def chalk(width=480, height=60, seed=3):
    """(height, width) of a strip: streaks that come and go along it, again and again."""
    rng = np.random.default_rng(seed)
    along, waves = np.arange(width) / width, np.arange(1, 30)
    turns = 2 * np.pi * (waves[:, None] * along + rng.random((height // 3, len(waves), 1)))
    streaks = np.repeat((np.sin(turns) / np.sqrt(waves)[:, None]).sum(1), 3, 0)
    rim = np.abs(np.linspace(-1, 1, height))[:, None] ** 2
    return 1 / (1 + np.exp(6 + 2.4 * streaks / streaks.std() - 8 * (1 - rim)))


# ---- figures -------------------------------------------------------------------------------------------------

def drawn(layers, view, values, number=0):
    """(ink (H, W), where edges are)."""
    height, width = layers["depth"].shape[:2]
    images = library.render(layers, {**PLAIN, **values}, camera=Camera(view[:3, :3].ravel()),
                            frame=Frame(width, height, number=number), outputs=["Encre Lines", "Encre Edges"],
                            image=lambda _: 1 - chalk()).images
    return images["Encre Lines"][..., 3], images["Encre Edges"][..., 0] > 0


def blurred(picture):
    for _ in range(REACH // 2):
        picture = sticks.blurred(picture)
    return picture


def places(meshes, after, view, projection, size):
    """Where what each pixel shows lies in the picture after, in pixels, by what lies in front within two pixels."""
    width, height = size
    for mesh, moved in zip(meshes, after, strict=True):
        mesh.attributes = (moved.points @ moved.model[:3, :3].T + moved.model[:3, 3]).astype(np.float32)[mesh.corners]
    maps = library.raster(meshes, *after[0].eye, Frame(width, height), size, 0.1, channels=3,
                          outputs=("depth", "attributes"))
    x, y = on_screen(maps["attributes"], view, projection, size)
    depth = np.where(maps["depth"] > 0, maps["depth"], np.inf)
    dx, dy = x - np.arange(width), y - np.arange(height)[:, None]
    best, found = depth.copy(), [dx.copy(), dy.copy()]
    for v in range(-2, 3):
        for u in range(-2, 3):
            near = np.roll(depth, (v, u), (0, 1))
            wins = near < best
            best[wins] = near[wins]
            for k, own in enumerate((dx, dy)):
                found[k][wins] = np.roll(own, (v, u), (0, 1))[wins]
    return np.arange(width) + found[0], np.arange(height)[:, None] + found[1], np.isfinite(best)


def on_screen(world, view, projection, size):
    camera = world @ view[:3, :3].T + view[:3, 3]
    depth = np.maximum(-camera[..., 2], 1e-3)
    return ((camera[..., 0] * projection[0, 0] / depth + 1) / 2 * size[0] - 0.5,
            (1 - camera[..., 1] * projection[1, 1] / depth) / 2 * size[1] - 0.5)


def sampled(picture, x, y):
    i, j = (np.clip(np.floor(k).astype(int), 0, n - 2) for k, n in ((x, picture.shape[1]), (y, picture.shape[0])))
    u, v = np.clip(x - i, 0, 1), np.clip(y - j, 0, 1)
    return ((picture[j, i] * (1 - u) + picture[j, i + 1] * u) * (1 - v)
            + (picture[j + 1, i] * (1 - u) + picture[j + 1, i + 1] * u) * v)


def followed_each(pens, poses):
    """{name: what a pen does, from each frame to the next: (its correlation, the least of any two, the share of places
    by lines where there is more or less by a quarter)} of several pens {name: values} over a motion that is drawn once.
    """
    found, frames = {name: ([], []) for name in pens}, []
    for meshes, view, projection in poses:
        layers, _ = sticks.layers_of(meshes, view, projection)
        usual, now = {}, {}
        for name, values in pens.items():
            plain = {k: v for k, v in values.items() if not k.startswith("pen_")}
            key = repr(plain)
            if key not in usual:
                usual[key] = blurred(drawn(layers, view, plain)[0])
            ink, edges = drawn(layers, view, values)
            now[name] = blurred(ink) / np.maximum(usual[key], 0.02), usual[key], edges
        frames = [*frames[-1:], (now, (meshes, view, projection))]
        if len(frames) == 1:
            continue
        (before, first), (after, second) = frames
        for mesh in second[0]:
            mesh.eye = first[1:]
        x, y, known = places(first[0], second[0], *second[1:], sticks.SIZE)
        inside = known & (x > 8) & (y > 8) & (x < sticks.SIZE[0] - 9) & (y < sticks.SIZE[1] - 9)
        inside[:8] = inside[-8:] = inside[:, :8] = inside[:, -8:] = False
        for name, (corrs, pops) in found.items():
            one, two = before[name], after[name]
            own = one[2] & inside & (one[1] > 0.05)
            own &= sampled(two[1], x, y) > 0.7 * one[1]
            here, there = one[0][own], sampled(two[0], x, y)[own]
            corrs.append(np.corrcoef(here, there)[0, 1])
            pops.append((np.abs(here - there) > 0.25).mean())
    return {name: (np.mean(corrs), np.min(corrs), np.mean(pops)) for name, (corrs, pops) in found.items()}


def followed(values, poses):
    """What one pen does over a motion."""
    return followed_each({"": values}, poses)[""]


def motions():
    return {name: [sticks.posed(**pose) for pose in poses] for name, poses in sticks.MOTIONS.items()}


def sizes(values, heights=(540, 360, 180)):
    """Ink of lines, as a share of the picture, by the picture's height, to that at 720."""
    shares = []
    for height in (720, *heights):
        size = height * 16 // 9, height
        layers, _ = sticks.layers_of(sticks.scene(), *sticks.eye(), size)
        shares.append(drawn(layers, sticks.eye()[0], values)[0].mean())
    return [share / shares[0] for share in shares[1:]]


# ---- a sheet -------------------------------------------------------------------------------------------------

CLIP = {"use_tones": True, "line_thickness": 10.0, "pen_1_taper": 30.0, "pen_1_pressure": 0.4, "pen_1_wobble": 0.9,
        "pen_1_rough": 0.4, "shade_levels": [(0.3,), (0.75, 0.5, 0.04), (1.0, 0.8, 0.04)],
        "tone_1": "LINES", "tone_1_space": "SURFACE", "tone_1_pitch": 16.0, "tone_1_angle": 0.0,
        "tone_2": "DOTS", "tone_2_space": "SURFACE", "tone_2_pitch": 16.0, "tone_3": "NONE"}

STROKES = {**CLIP, **{f"tone_{n}{what}": value for n in (1, 2)
                      for what, value in {"": "HATCH", "_space": "SURFACE", "_pitch": 12.0, "_angle": 0.0}.items()}}


def clip(k, values=CLIP, size=(480, 270)):
    """Frame k of 48: (H, W), 1 is white."""
    on, (view, projection) = 0.05 * k - 1.2, sticks.eye(pan=0.04 * k - 0.96, zoom=0.95, pitch=0.21)
    layers, maps = sticks.layers_of(walker(k / 24, on), view, projection, size)
    floor = maps["object"] != 1
    layers["diffuse"][floor] = 1
    layers["combined"][floor] = 1
    images = library.render(layers, {**PLAIN, **values}, camera=Camera(view[:3, :3].ravel()),
                            frame=Frame(*size, number=k), outputs=["Encre Lines", "Encre Tones"]).images
    return (1 - images["Encre Lines"][..., 3]) * (1 - images["Encre Tones"][..., 3])


def written(picture, path):
    import OpenImageIO as oiio

    image = oiio.ImageBuf(np.round(255 * np.clip(picture, 0, 1)).astype(np.uint8)[..., None])
    image.specmod().attribute("compression", "jpeg:65")
    if not image.write(str(path)):
        raise SystemExit(image.geterror())


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    runs = motions()
    print("| correlation, the least, pops | " + " | ".join(runs) + " | ink at 540, 360, 180 lines |")
    found = [followed_each(PENS, poses) for poses in runs.values()]
    for name, values in PENS.items():
        cells = [each[name] for each in found]
        print(f"| {name} | " + " | ".join(f"{a:.3f}, {b:.2f}, {100 * c:.1f} %" for a, b, c in cells) + " | "
              + ", ".join(f"{100 * (share - 1):+.0f} %" for share in sizes(values)) + " |")
    for name, values in (("walk", CLIP), ("walk_strokes", STROKES)):
        frames = [clip(k, values)[5:, 155 + 5 * k // 4:295 + 5 * k // 4] for k in range(48)]
        rows = [np.concatenate(frames[row:row + 8], 1) for row in range(0, 48, 8)]
        written(np.concatenate(rows), folder / f"{name}.jpg")


if __name__ == "__main__":
    main()
