# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's lines between colours are as strong as these differ, as a share of Full Contrast or of what is near."""

import numpy as np
import pytest
from encre.pen.job import Frame
from encre.pen.library import load

HEIGHT, WIDTH, WALLS = 20, 240, (60, 100)
ALONE = {f"line_{kind}_strength": 0.0 for kind in ("outline", "inner", "crease", "material", "mark", "mirror")}
SCENE = ALONE | {"edge_threshold": 0.0, "contrast_threshold": 0.0, "length_unit": "PIXELS"}
LEVELS = [(0.1,), (0.4, 0.5, 0.0), (0.9, 1.5, 0.0)]


def encoded(x):
    return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055


def layers(greys, source):
    """Three greys side by side, between them two walls; of light, the levels of LEVELS instead of greys."""
    steps = np.zeros(WIDTH, np.float32)
    for wall in WALLS:
        steps[wall:] += 1
    grey = np.float32(greys)[steps.astype(int)]
    made = {"combined": 4, "color": 3, "albedo": 3, "diffuse": 3, "normal": 3, "depth": 1}
    made = {name: np.full((HEIGHT, WIDTH, channels), 0.5, np.float32) for name, channels in made.items()}
    made["normal"][...] = 0, 0, 1
    if source == "color":
        made["albedo"][...] = grey[None, :, None]
    elif source == "light":
        made["diffuse"][...] = steps[None, :, None]
    elif source == "soft light":  # a threshold every so many pixels, and no step
        at = [0, WALLS[0] - 0.5, WALLS[1] - 0.5, WIDTH]
        made["diffuse"][...] = np.interp(np.arange(WIDTH), at, [0.4, 0.5, 1.5, 1.6])[None, :, None]
    else:
        made["seen_color"], made["seen_normal"] = np.empty_like(made["albedo"]), made["normal"] * np.float32(-1)
        made["seen_color"][...] = grey[None, :, None]
    return made


def strengths(greys, source, **settings):
    weight = {"color": "line_color_strength", "light": "line_shadow_strength", "soft light": "line_shadow_strength",
              "seen": "line_mirror_strength"}[source]
    scene = {**SCENE, weight: 1.0, "shade_levels": LEVELS, **settings}
    edges = load().render(layers(greys, source), scene, outputs=["Encre Edges"], frame=Frame(WIDTH, HEIGHT))
    edges = edges.images["Encre Edges"][HEIGHT // 2, :, 0]
    return [edges[wall - 4:wall + 4].max() for wall in WALLS]


GREYS = tuple(level[0] for level in LEVELS)
FIRST, SECOND = (encoded(b) - encoded(a) for a, b in zip(GREYS, GREYS[1:], strict=False))
SOURCES = ["color", "light", "soft light", "seen"]


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("full", [1.0, 0.5])
def test_full_contrast(source, full):
    assert strengths(GREYS, source, contrast_full=full) == pytest.approx([min(1, FIRST / full), min(1, SECOND / full)],
                                                                         abs=2e-3)


@pytest.mark.parametrize("source", SOURCES)
def test_the_strongest_nearby_is_full(source):
    most = max(FIRST, SECOND)
    assert min(FIRST, SECOND) > 0.25
    near = strengths(GREYS, source, contrast_local=True, contrast_window=100.0)
    assert near == pytest.approx([FIRST / most, SECOND / most], abs=2e-3)
    assert strengths(GREYS, source, contrast_local=True, contrast_window=40.0) == pytest.approx([1, 1], abs=2e-3)


@pytest.mark.parametrize("source", ["color", "seen"])
def test_a_quarter_is_full_at_least(source):
    greys = 0.5, 0.55, 0.5
    difference = encoded(0.55) - encoded(0.5)
    assert strengths(greys, source, contrast_local=True) == pytest.approx([difference / 0.25] * 2, abs=2e-3)


def test_other_metrics_and_threads():
    layer = layers((0.0, 1.0, 0.5), "color")
    for metric in ("CIE76", "CIEDE2000", "CMC"):
        scene = {**SCENE, "line_color_strength": 1.0, "line_shadow_strength": 1.0, "contrast_metric": metric,
                 "contrast_local": True}
        got = [load().render(layer, scene, outputs=["Encre Edges", "Combined"], threads=threads, simd=simd).images
               for threads, simd in ((1, 1), (3, 0))]
        assert got[0]["Encre Edges"].max() == 1
        assert all(got[0][name].tobytes() == got[1][name].tobytes() for name in got[0])


def bricks(joint, wide, rows=120, columns=160, ground=0.5):
    """A wall, averaged over pixels: joints 2 pixels high and `wide` pixels wide, and a spot of their colour."""
    fine = 4
    y, x = (np.indices((rows * fine, columns * fine)) + 0.5) / fine
    row = np.floor(y / 15.3)
    where = (y % 15.3 < 2) | ((x + 23.1 * (row % 2)) % 46.2 < wide)
    where = np.where(y < 90, where, np.hypot(x - 80, y - 105) < 6)
    grey = np.where(where, joint, ground).reshape(rows, fine, columns, fine).mean((1, 3))
    made = {"combined": 4, "color": 3, "diffuse": 3, "normal": 3, "depth": 1}
    made = {name: np.full((rows, columns, channels), 0.5, np.float32) for name, channels in made.items()}
    made["normal"][...] = 0, 0, 1
    made["albedo"] = np.ascontiguousarray(np.repeat(grey[..., None], 3, 2), np.float32)
    return made


@pytest.mark.parametrize("high", [2.3, 2.6])
def test_a_joint_that_nothing_has_averaged_is_one_line(high):
    """Two pixels high here and three there, between bricks of two colours: it was a string of beads."""
    layers = bricks(0.2, 2, 40, 160)
    y, x = np.indices((40, 160))
    up = y - 0.06 * x - 12
    grey = np.where(up < 0, 0.5, np.where(up < high, 0.2, 0.56))
    layers["albedo"] = np.ascontiguousarray(np.repeat(grey[..., None], 3, 2), np.float32)
    ink = load().render(layers, SCENE | {"line_color_strength": 1.0},
                        outputs=["Encre Lines"]).images["Encre Lines"][..., 3]
    drawn = ink[:, 10:150] > 0.25
    assert (np.diff(drawn.astype(int), axis=0) > 0).sum(0).tolist() == [1] * 140


@pytest.mark.parametrize(("joint", "drawn"), [(0.4, True), (0.46, False)])
def test_joints_between_bricks_are_whole_or_not_there(joint, drawn):
    """Those that look wide have two sides, each half as strong as the one line of a narrow one."""
    full = encoded(0.5) - encoded(0.4)
    scene = SCENE | {"line_color_strength": 1.0, "contrast_full": 1.0, "edge_threshold": full * 1.2,
                     "line_thickness": 2.0}
    ink = load().render(bricks(joint, 8), scene, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]
    middle = ink[24:29]  # of a row of bricks, between joints
    sides = (middle[:, 4:-4].max(0) > 0.1)
    assert (np.diff(sides.astype(int)) > 0).sum() == 6 * drawn
    assert ink[95:].max() == 0
