# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheet under the picture against its twin."""

import masks
import numpy as np
import pytest
from encre.pen.job import Frame
from randomly import random_layers
from reference import render as reference

OFF = {f"use_{stage}": False for stage in ("lines", "shading", "smudging", "hatching")}
SHEET = dict(OFF, use_relief=True, length_unit="PIXELS")


def draw(layers, scene, styles=(), **how):
    return masks.render(layers, scene, styles, outputs=("Combined",), **how).images["Combined"]


@pytest.mark.parametrize("scene", [
    SHEET, dict(SHEET, paper_relief=0.0, paper_under=1.0), dict(SHEET, paper_relief=3.0, paper_under=0.0),
    dict(SHEET, paper_scale=2.6, paper_seed=4, paper_under_color=(0.3, 0.6, 0.9)), dict(SHEET, paper_source="NONE"),
])
@pytest.mark.parametrize("size", [(89, 257), (1, 1), (1, 300), (40, 1)])
def test_as_the_twin_has_it(scene, size):
    layers = random_layers(*size)
    wanted = reference(layers, scene)["Combined"]
    np.testing.assert_allclose(draw(layers, scene), wanted, rtol=2e-5, atol=2e-5)


def test_by_style():
    layers = random_layers(60, 90)
    layers["style"] = (np.arange(90) > 40).astype(np.float32) * np.ones((60, 1), np.float32)
    styles = [dict(use_relief=True)]
    made, plain = draw(layers, OFF, styles), draw(layers, OFF)
    assert np.array_equal(made[:, :41], plain[:, :41]) and not np.array_equal(made[:, 41:], plain[:, 41:])


def white(alpha=1.0, size=(64, 64)):
    one = np.ones((*size, 3), np.float32)
    combined = np.concatenate([alpha * one, np.full((*size, 1), alpha, np.float32)], -1)
    return dict(combined=combined, color=one, diffuse=one, normal=one, depth=one[..., 0])


def test_grain_is_lit_from_the_upper_left_and_no_pixel_of_it_moves():
    sheet = dict(SHEET, paper_under=0.0, paper_relief=1.0)
    flat, part = draw(white(), sheet)[..., 0], draw(white(size=(30, 64)), sheet, frame=Frame(64, 64, 0, 20))[..., 0]
    assert 0.01 < flat.std() < 0.2 and abs(flat.mean() - 1) < 0.01
    assert np.array_equal(part, flat[20:50])


def test_what_is_transparent_shows_the_sheet():
    sheet = dict(SHEET, paper_relief=0.0, paper_under=1.0, paper_under_color=(0.5, 0.4, 0.3))
    np.testing.assert_allclose(draw(white(0.0), sheet)[0, 0], (0.5, 0.4, 0.3, 1), atol=1e-6)
    np.testing.assert_allclose(draw(white(), sheet)[0, 0], (0.5, 0.4, 0.3, 1), atol=1e-6)
