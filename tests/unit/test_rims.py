# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light at the rims of things, where one sample a pixel sees slivers."""

import numpy as np
import pytest
from encre.pen import rims

SIZE = 60, 80


def ball(slope):
    """(light, numbers) of a round thing before another, darker just at its rim."""
    y, x = np.indices(SIZE)
    inside = 1 - np.hypot(x - 40.3, y - 30.2) / 21.7  # 0 at the rim
    light = np.where(inside > 0, 1 - slope * np.clip(0.02 - inside, 0, None), 0.9)
    tint = np.array((1.0, 0.8, 0.5))
    return (light[..., None] * tint).astype(np.float32), np.where(inside > 0, 2.0, 1.0).astype(np.float32)[..., None]


def singles(light, number):
    """How many pixels are in another tone than all about them, of thirty cuts."""
    found = 0
    for threshold in np.linspace(0.4, 0.99, 30):
        tone, alone = light.max(2) > threshold, True
        for y, x in rims._STEPS:
            alone &= np.roll(tone, (y, x), (0, 1)) != tone
        found += alone[1:-1, 1:-1].sum()
    return found


@pytest.mark.parametrize("slope", [12, 20])
def test_rims_leave_no_single_pixels_in_tones(slope):
    light, number = ball(slope)
    before = light.copy()
    assert singles(light, number) > 20
    assert rims.hold(light, number) is light
    assert singles(light, number) == 0
    changed = (light != before).any(2)
    assert 0 < changed.sum() < 100
    np.testing.assert_allclose(light[changed] / light[changed].max(1, keepdims=True), [(1, 0.8, 0.5)] * changed.sum(),
                               rtol=1e-6)


def held(value, number):
    light = np.repeat(np.float32(value)[..., None], 3, 2)
    return rims.hold(light, np.float32(number)[..., None])[..., 0]


def test_what_is_several_pixels_stays():
    """A streak along a rim, a pixel within a thing, a thing of one pixel, and what is at the frame's border."""
    light, number = np.full((9, 9), 0.5), np.ones((9, 9))
    number[:, 5:] = 2
    light[2:4, 5] = light[6, 2] = light[0, 4] = 1
    light[5, 7], number[5, 7] = 0.9, 3
    np.testing.assert_array_equal(held(light, number), np.float32(light))
    light[3, 5] = 0.5
    assert held(light, number)[2, 5] == 0.5, "a single one does not"


def test_what_shows_nothing_stays():
    light, number = np.full((5, 5), 0.5), np.zeros((5, 5))
    number[:, :2], light[2, 2] = 1, 0.7
    np.testing.assert_array_equal(held(light, number), np.float32(light))
