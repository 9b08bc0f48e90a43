# SPDX-License-Identifier: GPL-3.0-or-later
"""Every pen and every tone in every space on a street, a figure close up and a plane to the horizon, as two sheets.

    python tests/helpers/sheets.py FOLDER

The scenes are drawn once, by Encre's own layers, and restyled from their files. Writes FOLDER/pens_sheet.jpg and
FOLDER/tones_sheet.jpg.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parents[2]
SIZE, PEN_CELL, TONE_CELL = (1920, 1080), (480, 300), (276, 190)
SCENES = {"street": (1150, 190), "dancer": (840, 300), "terrain": (782, 508)}  # and where a cell's corner lies
PENS = {
    "technical": dict(line_thickness=5, pen_1_taper=0),
    "brush": dict(line_thickness=12, pen_1_pressure=0.45, pen_1_wobble=0.9, pen_1_rough=0.45, pen_1_taper=40,
                  pen_1_pool=0.5),
    "pencil": dict(line_thickness=6, pen_1_pressure=0.2, pen_1_pressure_length=72, pen_1_wobble=1.1,
                   pen_1_wobble_length=80,
                   pen_1_rough=0.9, pen_1_rough_length=6.6, pen_1_strokes=2, ink_color="#444444"),
    "marker": dict(line_thickness=15, pen_1_pressure=0.07, pen_1_dry=0.75),
    "gaps": dict(line_thickness=8, pen_1_gaps=0.25),
    "dashes": dict(line_thickness=6, pen_1_dash=26, pen_1_dash_space=9),
    "overshoot": dict(line_thickness=6, pen_1_overshoot=30, pen_1_strokes=2, pen_1_wobble=1.2),
    "strip": dict(line_thickness=16, pen_1_strip=1, pen_1_strip_image=ROOT / "docs/pen_chalk.png",
                  pen_1_strip_length=250),
}
TONES = ("DOTS", "LINES", "CROSS", "HATCH", "STIPPLE", "IMAGE", "GRAIN", "SOLID")
SPACES = {"SCREEN": 9, "SURFACE": 9, "OBJECT": None, "FLAT": 9}
EXPOSURE = {"street": 1, "dancer": 0.45, "terrain": 1}
PITCH = {"street": 3, "dancer": 2, "terrain": 8}  # centimetres of what is painted on
LEVELS = "0.1; 0.5,0.2,0.05; 0.8,0.5,0.05; 1,0.75,0.05"


def encre(*words):
    subprocess.run([sys.executable, "-m", "encre", *map(str, words)], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def restyled(folder, scene, values, size):
    """(H, W) of a cell of this size (width, height), 1 is white."""
    out = folder / "cell.png"
    sets = [word for id_, value in values.items() for word in ("--set", f"{id_}={value}")]
    encre("composite", folder / f"{scene}.exr", "-o", out, "--preset", "ink_only", *sets)
    x, y = SCENES[scene]
    picture = oiio.ImageBuf(str(out)).get_pixels(oiio.FLOAT)[y:y + size[1], x:x + size[0], :3].mean(-1)
    picture[-1] = picture[:, -1] = 0.5
    return picture


def tone(kind, space, scene):
    pitch = SPACES[space] or PITCH[scene]
    pitch *= {"STIPPLE": 0.8, "IMAGE": 18}.get(kind, 1)
    own = {"": kind, "_space": space, "_pitch": pitch, "_angle": 0 if kind == "HATCH" else 35,
           "_image": ROOT / "docs/tones_tile.png"}
    values = {f"tone_{n}{what}": value for n in (1, 2, 3) for what, value in own.items()
              if what != "_image" or kind == "IMAGE"}
    return dict(values, use_tones="on", tone_4="NONE", shade_levels=LEVELS, line_shadow_strength=0, line_thickness=5,
                shade_exposure=EXPOSURE[scene])


def written(rows, path):
    picture = np.concatenate([np.concatenate(row, 1) for row in rows])
    image = oiio.ImageBuf(np.round(255 * np.clip(picture, 0, 1)).astype(np.uint8)[..., None])
    image.specmod().attribute("compression", "jpeg:60")
    if not image.write(str(path)):
        raise SystemExit(image.geterror())


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    for scene in SCENES:
        encre("render", ROOT / f"scenes/{scene}.py", "-o", folder / f"{scene}.exr", "--size", "{}x{}".format(*SIZE),
              "--preset", "ink_only", "--set", "layer_source=ENCRE", "--set", "save_rest=ON")
    written([[restyled(folder, scene, pen, PEN_CELL) for pen in list(PENS.values())[half:half + 4]]
             for half in (0, 4) for scene in SCENES], folder / "pens_sheet.jpg")
    written([[restyled(folder, scene, tone(kind, space, scene), TONE_CELL) for kind in TONES]
             for scene in SCENES for space in SPACES], folder / "tones_sheet.jpg")


if __name__ == "__main__":
    main()
