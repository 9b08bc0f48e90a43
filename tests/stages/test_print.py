# SPDX-License-Identifier: GPL-3.0-or-later
"""Print against tests/reference/, by the light that dots give back, and cut up in other ways."""

import masks
import numpy as np
import pytest
from encre.pen import presets
from encre.pen.job import Frame
from randomly import random_layers
from reference import render as reference

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, length_unit="PIXELS")
PRINT = dict(OFF, use_print=True)
WHITE = dict(print_paper=(1.0, 1.0, 1.0), print_least=0.0)


def draw(layers, scene, styles=(), **how):
    return masks.render(layers, scene, styles, **how).images["Combined"]


def flat(*color, size=240):
    """A wall of one color."""
    ones = np.ones((size, size, 1), np.float32)
    rgb = ones * np.float32(color)
    return dict(combined=np.concatenate([rgb, ones], -1), color=rgb, diffuse=ones * np.ones(3, np.float32), depth=ones,
                normal=ones * np.float32((0, 0, 1)))


@pytest.mark.parametrize("size", [(59, 97), (1, 1), (1, 40), (40, 1)])
@pytest.mark.parametrize("scene", [
    dict(),
    dict(print_pitch=0.5, print_black=1.0, print_least=0.0, print_paper=(1.0, 0.5, 0.2)),
    dict(print_inks="TWO", print_pitch=23.0, print_least=0.3),
    dict(print_inks="TWO", print_dark=(0.5, 0.1, 0.0), print_light=(0.2, 0.9, 1.0), length_unit="RELATIVE"),
])
def test_agrees_with_the_reference(scene, size):
    layers = random_layers(*size)
    styles = [dict(use_print=False), dict(print_pitch=4.0, print_black=0.2, print_inks="FOUR")]
    place = dict(width=900, height=700, x=411, y=333)
    want = reference(layers, dict(PRINT, **scene), styles, frame=place)
    sure = ~want["unsure"]
    assert sure.mean() > 0.95
    got = draw(layers, dict(PRINT, **scene), styles, frame=Frame(**place))
    np.testing.assert_allclose(got[sure], want["Combined"][sure], atol=1e-3)


@pytest.mark.parametrize("gray", [0.9, 0.7, 0.5, 0.3, 0.15])
def test_dots_give_back_as_much_light_as_the_color_has(gray):
    """One ink alone is exact; four over each other are, on an average over all places."""
    got = draw(flat(gray, gray, gray), dict(PRINT, **WHITE, print_black=0.0, print_pitch=8.0))
    assert abs(got[..., :3].mean((0, 1)) - gray).max() < 0.03
    yellow = draw(flat(1.0, 0.98, gray), dict(PRINT, **WHITE, print_pitch=8.0))[..., 2]
    assert abs(yellow.mean() - gray) < 0.015


def test_a_color_of_light_keeps_its_hue():
    got = draw(flat(0.8, 0.3, 0.1), dict(PRINT, **WHITE, print_pitch=6.0))[..., :3].mean((0, 1))
    assert got[0] > 1.8 * got[1] > 1.8 * 1.5 * got[2]


def test_two_inks_are_paper_where_it_is_light_and_both_where_it_is_dark():
    paper, dark, light = np.float32([(1.0, 0.9, 0.8), (0.1, 0.1, 0.4), (1.0, 0.5, 0.3)])
    two = dict(PRINT, print_inks="TWO", print_paper=paper, print_dark=dark, print_light=light)
    for gray, ink in ((0.9, paper), (0.001, paper * dark * light)):
        got = draw(flat(gray, gray, gray), two)[..., :3]
        np.testing.assert_allclose(got, np.broadcast_to(ink, got.shape), atol=1e-6)


def test_what_is_clear_stays_clear():
    layers = flat(0.4, 0.2, 0.1)
    layers["combined"][:, :100] = 0
    got = draw(layers, PRINT)
    assert (got[:, :100] == 0).all() and (got[:, 100:, 3] == 1).all()


def test_brightness_without_bounds_stays_finite():
    layers = random_layers(40, 64)
    layers["combined"][::3, ::5, :3] = 1e38
    layers["combined"][1::3, ::5, :3] = -1e38
    assert np.isfinite(draw(layers, PRINT)).all()


def test_parts_of_a_frame_are_as_in_the_whole():
    layers = random_layers(60, 90)
    whole = draw(layers, PRINT)
    part = {name: np.ascontiguousarray(a[20:50, 30:80]) for name, a in layers.items()}
    got = draw(part, PRINT, frame=Frame(width=90, height=60, x=30, y=20))
    np.testing.assert_array_equal(got, whole[20:50, 30:80])


def test_print_is_even_on_a_small_picture():
    """At 540 rows its dots, and what they make of gray together, were grain as large as a face's features."""
    values = presets.find("Print").values | OFF | dict(length_unit="RELATIVE", use_print=True)
    light = draw(flat(0.35, 0.35, 0.33), values, frame=Frame(240, 540, 0, 0))[..., :3]
    # three pixels of a picture held at arm's length are one
    seen = sum(np.roll(light, (y, x), (0, 1)) for y in (-1, 0, 1) for x in (-1, 0, 1))[8:-8, 8:-8] / 9
    assert seen.std((0, 1)).max() < 0.07 and abs(seen.mean() - light.mean()) < 0.01
