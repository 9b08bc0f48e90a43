# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre compare`: baked and dynamic lines of one frame side by side, as the subjects of Herring's study saw them."""

import os
import random

import numpy as np
from encre.cli import child, images, render
from encre.pen import library

TITLES = {"plain": "Plain", "baked": "Baked lines", "dynamic": "Dynamic lines", "freestyle": "Freestyle",
          "line_art": "Line Art"}
SAID = {"plain": "no lines", "baked": "between colours drawn into the textures; silhouettes in the frame",
        "dynamic": "all drawn in the frame", "freestyle": "Blender's own, silhouettes and creases",
        "line_art": "Blender's own, silhouettes and creases"}
SETTINGS = ("edge_detector", "line_thickness", "line_far_distance", "line_far_unit", "contrast_metric",
            "contrast_threshold", "contrast_full", "contrast_local")
BESIDE = ("", "_crops", "_blender")  # what stands before the ending of a frame's pictures; only the first: quadrants
PAPER = 0.96  # grey of the caption
CROPS = 3     # details that are shown, each a quarter of the frame each way


def compare(scene, out, *, seed=0, quadrants_only=False, say=print, **options):
    """Renders `scene` by each technique and writes the comparison `out` (.png) of every frame.

    seed: which of baked and dynamic stands on the left; options: those of render.compare(). Beside OUT.png come
    OUT_crops.png and OUT_blender.png, unless only the quadrants are wanted. Raises EncreError, RenderError.
    """
    order = ["baked", "dynamic"]
    random.Random(seed).shuffle(order)

    def take(event):
        for made in event["pictures"].values():
            if not images.whole(made["path"]):  # Blender does not notice a full disk
                raise child.RenderError(images.unwritable(event["path"], "the disk may be full"))
        pictures = {name: read(made["path"]) for name, made in event["pictures"].items()}
        seconds = {name: made["seconds"] for name, made in event["pictures"].items()}
        drawn = [quadrants(pictures, order, caption(scene, event, order, seconds))]
        if not quadrants_only:
            drawn.append(crops(pictures, ["plain", *order]))
            own = [name for name in ("freestyle", "line_art") if name in pictures]
            if own:
                drawn.append(row(pictures, [*own, "dynamic"], seconds))
        stem, ending = os.path.splitext(event["path"])
        write({f"{stem}{more}{ending}": picture for more, picture in zip(BESIDE, drawn, strict=False)})
        times = ", ".join(f"{TITLES[name].lower()} {spent:.1f} s" for name, spent in seconds.items())
        say("note", f"{event['path']}: {times}, baking once {event['baking']:.1f} s")

    techniques = ["plain", "baked", "dynamic"] + ([] if quadrants_only else ["freestyle", "line_art"])
    render.compare(scene, out, take, techniques=techniques, beside=BESIDE[:1] if quadrants_only else BESIDE, say=say,
                   **options)


def read(path):
    """A rendered PNG as (H, W, 3), sRGB from 0 to 1, over white where it is transparent."""
    pixels = images.read_texture(path, 65536).pixels
    color, alpha = pixels[..., :3], pixels[..., 3:]
    return color * alpha + (1 - alpha) if alpha.size else color


def write(pictures):
    images.write_textures({path: images.Texture(picture.astype(np.float32), "uint8", False, False)
                           for path, picture in pictures.items()})


def caption(scene, event, order, seconds):
    """What the caption panel says, [(size, words)]; sizes are shares of its height."""
    where = {"plain": "Upper left", order[0]: "Lower left", order[1]: "Lower right"}
    lines = [(0.075, os.path.basename(scene)),
             (0.04, f"frame {event['frame']}, {event['samples']} samples, Blender {event['blender']}"), (0.03, "")]
    for name, place in where.items():
        once = f", and {event['baking']:.1f} s once for baking" if name == "baked" else ""
        lines += [(0.055, f"{place}: {TITLES[name].lower()}"), (0.04, SAID[name]),
                  (0.04, f"{seconds[name]:.1f} s a frame{once}"), (0.025, "")]
    rows = library.params()
    settings = [f"{rows[id_].label} {shown(event['values'][id_])}" for id_ in SETTINGS]
    return lines + [(0.035, ", ".join(settings[:3])), (0.035, ", ".join(settings[3:]))]


def shown(value):
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else (
        f"{value:.3g}" if isinstance(value, float) else str(value))


def panel(height, width, words):
    y, lines = 0.06 * height, []
    for size, text in words:
        y += 1.3 * size * height
        # A letter is about half as wide as it is high.
        fit = min(size * height, 0.92 * width / (0.52 * max(len(text), 1)))
        lines.append((0.04 * width, y, max(fit, 5), text))
    return images.draw_text(np.full((height, width, 3), PAPER, np.float32), lines)


def quadrants(pictures, order, words):
    """Plain and the caption above, the two techniques below."""
    height, width, _ = pictures["plain"].shape
    top = np.concatenate([pictures["plain"], panel(height, width, words)], 1)
    picture = np.concatenate([top, np.concatenate([pictures[name] for name in order], 1)])
    picture[height - 1:height + 1] = picture[:, width - 1:width + 1] = 0
    return picture


def row(pictures, names, seconds):
    """Pictures side by side, each with its name and time below."""
    height, width, _ = pictures[names[0]].shape
    return np.concatenate([np.concatenate([pictures[name], strip(width, max(height // 12, 16),
                                           f"{TITLES[name]}, {seconds[name]:.1f} s")]) for name in names], 1)


def strip(width, height, words):
    return images.draw_text(np.full((height, width, 3), PAPER, np.float32),
                            [(0.3 * height, 0.72 * height, 0.55 * height, words)])


def crops(pictures, names):
    """The details in which baked and dynamic differ most: a row for each, a column for each name, twice as large."""
    height, width, _ = pictures["plain"].shape
    h, w = max(height // 4, 1), max(width // 4, 1)
    rows = [np.concatenate([strip(2 * w, max(h // 6, 16), TITLES[name]) for name in names], 1)]
    for y, x in places(np.abs(pictures["baked"] - pictures["dynamic"]).sum(2), h, w):
        cut = [pictures[name][y:y + h, x:x + w].repeat(2, 0).repeat(2, 1) for name in names]
        rows.append(np.concatenate(cut, 1))
    return np.concatenate(rows)


def places(difference, h, w):
    """(row, column) of CROPS windows h x w that hold most of the difference and do not overlap."""
    total = np.pad(difference, ((1, 0), (1, 0))).cumsum(0, dtype=np.float64).cumsum(1)
    held = total[h:, w:] - total[:-h, w:] - total[h:, :-w] + total[:-h, :-w]
    found = []
    for _ in range(CROPS):
        y, x = np.unravel_index(held.argmax(), held.shape)
        if held[y, x] < 0:
            break
        found.append((int(y), int(x)))
        held[max(y - h + 1, 0):y + h, max(x - w + 1, 0):x + w] = -1
    return found
