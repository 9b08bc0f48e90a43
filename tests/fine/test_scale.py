# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture in relative units has the same ink at every size, and no line is drawn in stairs."""

import functools
import json
from pathlib import Path

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Camera
from judge import scenes

PRESETS = Path(library.__file__).parents[1] / "presets"
SIZES = {25: 68, 50: 135, 100: 270, 200: 540}  # lines of the frame by per cent


def preset(name):
    return json.loads((PRESETS / f"{name}.json").read_text())["values"]


def relative():
    return sorted(path.stem for path in PRESETS.glob("*.json") if preset(path.stem)["length_unit"] == "RELATIVE")


@functools.cache
def pictures(name):
    """The layers of a scene by per cent, and its camera."""
    by_size = {size: scenes.NAMED[name](size=(lines, lines * 4 // 3)) for size, lines in SIZES.items()}
    camera = by_size[100].camera_settings
    return ({size: scene.layers("blackman") for size, scene in by_size.items()},
            Camera(tuple(camera["view"]), camera["orthographic"], camera["height"], distance=6.0))


def darkness(layers, camera=None, **values):
    return library.render(layers, values, camera=camera, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]


@pytest.mark.parametrize("name", relative())
def test_ink_is_the_same_at_every_size(name):
    by_size, camera = pictures("boxes")
    values = dict(preset(name), use_example=False)  # which paints no lines
    ink = {size: darkness(layers, camera, **values).mean() for size, layers in by_size.items()}
    change = {size: abs(ink[size] / ink[100] - 1) for size in ink}
    assert ink[100] > 0.005
    assert change[50] < 0.05 and change[200] < 0.05 and change[25] < 0.15, change


def slanted(rows=60, columns=200):
    """Two flat objects side by side, whose border leans by one pixel in eight."""
    y, x = np.mgrid[:rows, :columns].astype(np.float64)
    off = x - columns / 2 - y / 8
    share = np.clip(off + 0.5, 0, 1)[..., None]
    flat = np.ones((rows, columns, 3))
    layers = dict(combined=np.ones((rows, columns, 4)), color=share * (0.3, 0.2, 0.1) + (1 - share) * (0.6, 0.7, 0.9),
                  diffuse=flat, depth=flat[..., :1] * 4, normal=flat * (0, 0, 1), object=(off[..., None] > 0) + 1)
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


@pytest.mark.parametrize("width", [0.3, 0.8, 1.5, 3.0, 6.0])
@pytest.mark.parametrize("height", [1.0, 0.8])
def test_the_pencil_draws_no_stairs(width, height):
    """Along a border that crosses the rows at all places, each row has as much ink, and passes evenly into paper.

    Of the pencil's ramp, from coverage 0.5 to 0.75 of paper of full height, the middle lies at the line's half width
    times 1 - 0.9 * 0.625; on lower paper closer to the middle of the line, and what is less high is less dark."""
    values = dict(preset("water_memory"), length_unit="PIXELS", line_thickness=width, use_shading=False,
                  use_smudging=False, use_hatching=False, paper_source="IMAGE", paper_image="sheet")
    image = np.full((2, 2, 1), height, np.float32)
    shown = library.render(slanted(), values, image=lambda _: image, outputs=["Encre Lines"])
    t = shown.images["Encre Lines"][5:-5, :, 3]
    rough = 1 + values["line_paper"] * (height - 1)
    rise = min(0.25, rough - 0.5)
    want = width * (1 - 0.9 * (0.5 + rise / 2) / rough) * min(1, 4 * (rough - 0.5)) * np.sqrt(1 + 1 / 64)
    assert t.sum(1) == pytest.approx(want, rel=0.06)
    steps = np.abs(np.diff(t, axis=1)).max(1)
    assert steps.max() < 1.05 * min(1.0, max(want, 0.1))
    if width >= 1.5:
        between = ((t > 0.02) & (t < 0.98)).sum() / (t > 0.02).sum()
        assert between > 0.45 if width > 3 else between > 0.6
