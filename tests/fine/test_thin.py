# SPDX-License-Identifier: GPL-3.0-or-later
"""Rods from a third of a pixel to two and a half, which depth and index hit at pixel centres only: their two lines are
whole, keep their width, and move as the rod moves."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Camera
from judge import verdict

PEN = dict(verdict.PARAMS, edge_detector="FINE", edge_color=0.0, edge_light=0.0, line_thickness=2.0)
BORDER = 8


def rod(width, slant, moved, wall=np.inf, size=(48, 64), samples=8):
    """Layers of a rod before a wall, and the distance of each pixel from its middle."""
    way = np.array([np.cos(slant), np.sin(slant)])
    y, x = np.mgrid[:size[0], :size[1]].astype(np.float64)
    off = (x - 31.3) * way[0] + (y - 23.6) * way[1] - moved
    part = (np.arange(samples) + 0.5) / samples - 0.5
    share = np.mean([np.abs(off + dx * way[0] + dy * way[1]) < width / 2 for dx in part for dy in part], 0)[..., None]
    hit = np.abs(off) < width / 2
    flat = np.ones((*size, 3))
    layers = dict(combined=np.ones((*size, 4)), color=share * (0.3, 0.2, 0.1) + (1 - share) * (0.6, 0.7, 0.9),
                  diffuse=flat, depth=np.where(hit, 4.0, wall), object=np.where(hit, 2.0, 1.0),
                  normal=share * (0, 0, 1.0) + (1 - share) * ((0, 0, 0) if wall == np.inf else (0, 1, 0)))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, off


def ink(layers, camera=None, **how):
    return library.render(layers, PEN, camera=camera or Camera(), outputs=["Encre Lines"], **how).images[
        "Encre Lines"][..., 3].astype(float)


def inner(image):
    return image[..., BORDER:-BORDER, BORDER:-BORDER]


def flicker(frames):
    return np.sqrt(np.mean(inner(np.diff(frames, axis=0)) ** 2))


@pytest.mark.parametrize("wall", [np.inf, 9.0])
@pytest.mark.parametrize("slant", [0, 5, 15, 30, 45, 75])
@pytest.mark.parametrize("width", [0.4, 0.7, 1.0, 1.5, 2.0, 2.5])
def test_a_rod_is_whole_and_keeps_its_width(width, slant, wall):
    slant = np.radians(slant)
    drawn, ideal = [], []
    for step in range(9):
        layers, off = rod(width, slant, step / 8, wall)
        drawn.append(ink(layers))
        ideal.append(np.clip(width / 2 + 1.5 - np.abs(off), 0, 1))  # what two lines of 2 pixels cover
        assert inner(drawn[-1])[np.abs(inner(off)) < 0.5].min() > 0.95, step
    across = inner(np.array(drawn)).sum(2 if slant < 0.8 else 1) * max(np.cos(slant), np.sin(slant))
    assert across.min() > (width + 1.5 if width >= 1 else 1.9)
    assert across.max() < max(width, 1) + 2.51  # what is narrower than a pixel may look as wide as one
    assert flicker(drawn) < flicker(ideal) * (1.6 if width >= 1 else 3.0)


def test_a_rod_under_an_orthographic_camera():
    for width in (0.7, 1.5):
        layers, off = rod(width, 0.3, 0.2, 9.0)
        t = ink(layers, Camera(orthographic=True, height=10.0))
        assert inner(t)[np.abs(inner(off)) < 0.5].min() > 0.95


def test_a_wider_rod_has_paper_between_its_lines():
    layers, off = rod(4.0, 0.3, 0.2)
    t = ink(layers)
    assert inner(t)[np.abs(inner(off)) < 0.2].max() < 0.1
    assert inner(t)[np.abs(np.abs(inner(off)) - 2) < 0.3].min() > 0.9


def test_a_rod_ends_where_it_ends():
    layers, off = rod(1.0, 0.3, 0.2)
    empty, _ = rod(0.0, 0.3, 0.2)
    for name, a in layers.items():
        a[24:] = empty[name][24:]
    t = ink(layers)
    assert t[:23][np.abs(off[:23]) < 0.5].min() > 0.95
    assert t[26:].max() == 0


def test_threads_and_instructions_change_nothing():
    layers, _ = rod(0.7, 0.3, 0.2)
    one = ink(layers, threads=1)
    for how in (dict(threads=3), dict(threads=1, simd=0)):
        assert np.array_equal(one, ink(layers, **how))
