# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies around a part of a frame, and how far what is drawn reaches."""

from pathlib import Path

import numpy as np
import pytest
from encre.pen import library
from encre.pen.around import CELL, Window, pieces
from encre.pen.job import Frame
from encre.pen.settings import Settings
from noise import textures


@pytest.mark.parametrize("inner", [(40, 30, 50, 20), (0, 0, 20, 60), (99, 0, 1, 1), (3, 70, 97, 5), (0, 0, 100, 75)])
@pytest.mark.parametrize("reach", [0, 1, 13, 500])
def test_pieces_cover_what_is_around(inner, reach):
    inner, count = Window(*inner), np.zeros((75, 100), int)
    outer = inner.grown(reach, 100, 75)
    for x, y, width, height in [*pieces(inner, outer), inner]:
        assert 0 < width <= inner.width and 0 < height <= inner.height
        count[y:y + height, x:x + width] += 1
    top, left = (max(0, start - reach) for start in (inner.y, inner.x))
    if reach:
        top, left = top - top % CELL, left - left % CELL
    wanted = np.zeros_like(count)
    wanted[top:inner.y + inner.height + reach, left:inner.x + inner.width + reach] = 1
    assert np.array_equal(count, wanted)


def test_cells_of_a_part_are_those_of_the_frame():
    """Lines between colours thin out by what their cells hold: by other ones in a part that begins elsewhere."""
    assert f"enum {{ CELL = {CELL} }};" in (Path(__file__).parents[2] / "csrc" / "fine" / "fine.h").read_text()
    layers, scene = textures(160, 120), {"edge_detector": "FINE", "line_color_strength": 1.0, "length_unit": "PIXELS"}
    layers["color"] = layers["albedo"] = np.ascontiguousarray(layers["color"][::8, ::8].repeat(8, 0).repeat(8, 1))
    whole = library.render(layers, scene, outputs=["Encre Lines"]).images["Encre Lines"]
    differ = []
    for x in range(1, CELL + 1):
        part = {name: np.ascontiguousarray(layer[:, x:]) for name, layer in layers.items()}
        drawn = library.render(part, scene, frame=Frame(160, 120, x, 0), outputs=["Encre Lines"])
        differ.append(np.abs(drawn.images["Encre Lines"] - whole[:, x:])[:, 60:].max())
    assert min(differ[:-1]) > 1e-3 and differ[-1] < 1e-5
    assert Window(61, 50, 30, 20).grown(13, 160, 120)[:2] == (48, 36)


def test_reach_follows_the_settings():
    off = {"use_lines": False, "use_shading": False, "use_smudging": False, "use_hatching": False}
    assert Settings(off).reach(1080) == 0
    thin, wide = ({**off, "use_lines": True, "line_thickness": t} for t in (1, 20))
    assert Settings(wide).reach(1080) - Settings(thin).reach(1080) == 59  # painted nine times as thick, 128 at most
    assert Settings(wide).reach(2160) > Settings(wide).reach(1080)
    assert Settings({**wide, "length_unit": "PIXELS"}).reach(2160) == Settings(wide).reach(1080)
    assert Settings(thin, [("Bold", {"line_thickness": 20})]).reach(1080) == Settings(wide).reach(1080)
    assert Settings({**thin, "use_smudging": True, "smudge_range": 100}).reach(1080) > 200
    for kind in ("color", "shadow", "mirror"):  # whether a line is too short tells all of it, of what is drawn
        off = {**thin, f"line_{kind}_strength": 0.0}
        short = {**off, f"line_{kind}_shortest": 200.0}
        assert Settings(short).reach(1080) == Settings(off).reach(1080)
        assert Settings({**short, f"line_{kind}_strength": 1.0}).reach(1080) - Settings(off).reach(1080) == 200


@pytest.mark.parametrize("detector", ["FINE", "DOG"])
@pytest.mark.parametrize("painted, values", [
    (1, dict(line_thickness=12)),
    (1, dict(line_thickness=8, line_far_distance=8.0, line_far_unit="SCENE")),
    (0, dict(line_thickness=4, line_outline_width=8.0, line_far_distance=16.0, line_far_unit="SCENE")),
    (0, dict(line_thickness=20, line_far_distance=16.0, line_far_unit="SCENE", line_far_thickest=8.0)),
    (1, dict(line_thickness=6, ink_in_shade=-1.0)),
    (0, dict(line_thickness=10, pen_1_pressure=1.0, pen_1_rough=4.0, pen_1_wobble=6.0)),
])
def test_a_part_with_what_it_depends_on_is_drawn_as_the_whole(detector, painted, values):
    """One edge; parts of the frame that begin the nearer to it the farther its line reaches."""
    height, width, edge = 120, 360, 100
    flat = np.ones((height, width, 3), np.float32)
    layers = dict(combined=np.ones((height, width, 4), np.float32), color=flat, diffuse=flat,
                  depth=np.full((height, width), 2, np.float32), normal=flat * (0, 0, 1),
                  object=np.where(np.arange(width) < edge, 2, 1) * flat[..., 0],
                  controls=np.zeros((height, width, len(library.controls())), np.float32))
    layers["controls"][..., :2] = painted, 1  # thickness, intensity
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    off = dict.fromkeys(("use_shading", "use_smudging", "use_hatching"), False)
    scene = {**off, "edge_detector": detector, "length_unit": "PIXELS", **values}
    reach = Settings(scene).reach(height)
    whole = library.render(layers, scene, frame=Frame(width, height)).images["Combined"]
    inked = np.flatnonzero((whole[..., 0] < 0.99).any(0))
    assert inked[-1] >= edge + 4
    for first in range(edge + 1, edge + 150, 4):
        left = max(0, first - reach)
        part = library.render({name: a[:, left:] for name, a in layers.items()}, scene,
                              frame=Frame(width, height, left, 0)).images["Combined"]
        np.testing.assert_array_equal(part[:, first - left:], whole[:, first:], err_msg=str(first))


@pytest.mark.parametrize("scale", [1, 2.5, 5])
def test_a_part_has_lines_that_thin_out_in_a_crowd_as_in_the_whole(scale):
    """Stripes of 2.7 px beside wider ones: how close all are decides how wide each line is."""
    rng = np.random.default_rng(3)
    height, width = 60, 560
    edges = scale * np.cumsum(np.append(rng.uniform(2.55, 2.9, 22), rng.uniform(3.5, 5, 300)))
    flat = np.ones((height, width, 3), np.float32)
    odd = np.searchsorted(edges, np.arange(width)) % 2
    layers = dict(combined=np.ones((height, width, 4), np.float32), diffuse=flat, depth=2 * flat[..., 0],
                  color=np.where(odd[:, None], np.float32([0.2, 0.3, 0.5]), np.float32([0.7, 0.6, 0.4])) * flat,
                  normal=flat * np.float32([0, 0, 1]), object=flat[..., 0])
    off = dict.fromkeys(("use_shading", "use_smudging", "use_hatching"), False)
    scene = {**off, "line_color_strength": 5.0, "line_thickness": 2.0, "line_thickest": 2.0, "length_unit": "MM",
             "page_height": height / scale}
    reach = Settings(scene).reach(height)
    whole = library.render(layers, scene, frame=Frame(width, height)).images["Combined"]
    assert (whole < 0.9).mean() > 0.05
    for first in range(int(40 * scale), int(80 * scale), 7):
        left = first - reach
        part = library.render({name: np.ascontiguousarray(a[:, left:]) for name, a in layers.items()}, scene,
                              frame=Frame(width, height, left, 0)).images["Combined"]
        assert np.abs(part[5:-5, reach:] - whole[5:-5, first:]).max() < 0.03, first
