# SPDX-License-Identifier: GPL-3.0-or-later
"""Ink and lines of pictures at a quarter, half and twice their size, with every preset in relative units: writes the
tables of docs/sizes.md.

    python tests/helpers/sizes.py [FOLDER SCENE.py ...]      scenes are rendered into FOLDER with fast layers, or taken
                                                             from there; tables of others stay as they are

A test compares the page with what is found of pictures that need no Blender.
"""

import functools
import subprocess
import sys
from pathlib import Path

import numpy as np

TESTS = Path(__file__).parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "helpers")]
import crowds  # noqa: E402 - found only now
import exr  # noqa: E402
import pages  # noqa: E402
from encre.cli import composite  # noqa: E402
from encre.pen import library, presets  # noqa: E402
from encre.pen.job import Camera  # noqa: E402
from judge import scenes  # noqa: E402

SIZES = 25, 50, 100, 200  # per cent
BOXES = {25: 68, 50: 135, 100: 270, 200: 540}  # lines of the frame
CROWD = {25: 270, 50: 540, 100: 1080, 200: 2160}
WIDE, TALL = 1280, 720  # pixels, at 100 %, of what is rendered
NEAR = 2  # pixels, at 100 %, within which a line is the same
MOST = {25: 15, 50: 5, 200: 5}  # per cent by which ink may change
PAGE = TESTS.parent / "docs" / "sizes.md"


def preset(name):
    """The values that a preset's own file has."""
    found = presets.find(name)
    return {id_: found.values[id_] for id_ in found.listed}


def relative():
    return [found.id for found in presets.presets() if found.values["length_unit"] == "RELATIVE"]


@functools.cache
def boxes():
    """{per cent: (layers, frame)} of a scene of the judge, and its camera."""
    by_size = {size: scenes.NAMED["boxes"](size=(lines, lines * 4 // 3)) for size, lines in BOXES.items()}
    camera = by_size[100].camera_settings
    return ({size: (scene.layers("blackman"), None) for size, scene in by_size.items()},
            Camera(tuple(camera["view"]), camera["orthographic"], camera["height"], distance=6.0))


@functools.cache
def crowd():
    """Likewise of crowded lines."""
    return {size: crowds.crowded(lines) for size, lines in CROWD.items()}, crowds.CAMERA


def darkness(layers, camera=None, frame=None, **values):
    drawn = library.render(layers, values, camera=camera, frame=frame, outputs=["Encre Lines"])
    return drawn.images["Encre Lines"][..., 3]


def inked(pictures, name):
    """What lines cover by per cent, each as large as that of 100 %."""
    by_size, camera = pictures
    values = dict(preset(name), use_example=False)  # which paints no lines
    ink = {size: darkness(layers, camera, frame, **values) for size, (layers, frame) in by_size.items()}
    return {size: sized(a, ink[100].shape) for size, a in ink.items()}


def rendered(folder, scene):
    """{preset: what inked() tells} of a script."""
    frames, out = {size: folder / f"{scene.stem}_{size}.exr" for size in SIZES}, {}
    for size, frame in frames.items():
        subprocess.run([sys.executable, "-m", "encre", "render", scene, "-o", frame, "--preset", "ink_only", "--resume",
                        "--size", f"{WIDE * size // 100}x{TALL * size // 100}", "--set", "layer_source=ENCRE",
                        "--set", "save_layers=ON", "--set", "save_rest=ON"], check=True)
    for name in relative():
        ink = {}
        for size, frame in frames.items():
            drawn = folder / "drawn.exr"
            composite.composite(str(frame), str(drawn), dict(presets.find(name).values, use_example=False))
            ink[size] = exr.part(drawn, "ViewLayer.Encre Lines")[..., 3]
        out[name] = {size: sized(a, ink[100].shape) for size, a in ink.items()}
    return out


def sized(a, shape):
    """Means of pixels, or pixels again and again."""
    for axis, n in enumerate(shape):
        if a.shape[axis] > n:
            a = a.reshape(*a.shape[:axis], n, -1, *a.shape[axis + 1:]).mean(axis + 1)
        else:
            a = np.take(a, np.arange(n) * a.shape[axis] // n, axis)
    return a


def alone(a, b):
    """Share of the ink of a that has none of b near."""
    around, h, w = np.pad(b, NEAR), *b.shape
    ways = [(dy, dx) for dy in range(-NEAR, NEAR + 1) for dx in range(-NEAR, NEAR + 1) if dy**2 + dx**2 <= NEAR**2]
    most = np.max([around[NEAR + dy:NEAR + dy + h, NEAR + dx:NEAR + dx + w] for dy, dx in ways], 0)
    return a[most < 0.03 * b.max()].sum() / a.sum()


def changes(ink):
    """{per cent: (how much more ink, the share of the lines of 100 % that is lost, the share there that is new)}, all
    in per cent."""
    return {size: tuple(100 * share for share in (
        ink[size].mean() / ink[100].mean() - 1, alone(ink[100], ink[size]), alone(ink[size], ink[100])))
        for size in SIZES if size != 100}


def cells(ink):
    """{per cent: a cell of the page}; what is beyond MOST is bold."""
    out = {}
    for size, (more, lost, new) in changes(ink).items():
        mark = "**" if abs(more) > MOST[size] else ""
        out[size] = f"{mark}{more:+.1f}{mark} ({lost:.1f}, {new:.1f})"
    return out


def table(title, by_preset):
    """Rows of Markdown, the first of which names the scene."""
    head = [f"| {title} | " + " | ".join(f"{size} %" for size in MOST) + " |", "|---|" + "---|" * len(MOST)]
    return head + [f"| {presets.find(name).name} | " + " | ".join(cells(ink).values()) + " |"
                   for name, ink in by_preset.items()]


def said(title):
    """{preset's name: {"25 %": (more, lost, new), ...}} of one of the page's tables."""
    text = PAGE.read_text(encoding="utf-8")
    rows = pages.table(text[text.index(f"| {title} |"):])
    return {name: {head: tuple(float(word.strip("*(),")) for word in cell.split())
                   for head, cell in row.items() if head != title} for name, row in rows.items()}


def main():
    names = relative()
    found = {title: {name: inked(pictures(), name) for name in names} for title, pictures in COMPUTED.items()}
    folder, *scripts = [Path(word) for word in sys.argv[1:]] or [None]
    for script in scripts:
        folder.mkdir(parents=True, exist_ok=True)
        found[script.stem] = rendered(folder, script)
    text = PAGE.read_text(encoding="utf-8")
    for title, by_preset in found.items():
        text = pages.replaced(text, table(title, by_preset))
    PAGE.write_text(text, encoding="utf-8")


COMPUTED = {"boxes": boxes, "crowd": crowd}

if __name__ == "__main__":
    main()
