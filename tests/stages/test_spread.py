# SPDX-License-Identifier: GPL-3.0-or-later
"""Where dots that stick to surfaces lie: as evenly on any slant as on a wall."""

import numpy as np
import pytest
from toned import flat

PITCH, SIZE = 16.0, 256


def seen_at(tilt, turn, scale):
    """The anchor of a plane, turned in itself and then away by so many degrees, its far end up."""
    y, x = np.mgrid[:SIZE, :SIZE]
    c, s = np.cos(turn), np.sin(turn)
    anchor = np.zeros((SIZE, SIZE, 16), np.float32)
    right = np.array((c, s, 0)) * 0.01 * scale
    down = np.array((-s, c, 0)) * 0.01 * scale / np.cos(np.radians(tilt))
    anchor[..., :3] = x[..., None] * right + y[..., None] * down
    anchor[..., 3:7] = 0, 0, 1, 0.01 * scale
    anchor[..., 7:10], anchor[..., 10:13] = right, down
    return anchor


def views(tilt, count):
    rng = np.random.default_rng(tilt)
    return [seen_at(tilt, rng.uniform(0, 2 * np.pi), 2 ** rng.uniform(0, 1)) for _ in range(count)]


def dots_on(anchor, dark=0.2):
    return flat(dark, (SIZE, SIZE), anchor, tone_1="DOTS", tone_1_space="SURFACE", tone_1_pitch=PITCH)


def blurred(ink, pitches):
    y, x = (np.fft.fftfreq(n) for n in ink.shape)
    fade = np.exp(-2 * (np.pi * pitches * PITCH) ** 2 * (y[:, None] ** 2 + x[None] ** 2))
    return np.fft.ifft2(np.fft.fft2(ink) * fade).real


def middles(ink):
    """Where dots are of at least two fifths of the largest's ink."""
    soft = blurred(ink, 0.15)
    about = np.max([np.roll(soft, (j, i), (0, 1)) for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j], 0)
    return np.argwhere((soft > about) & (soft > 0.4 * soft.max()))


@pytest.mark.parametrize("tilt", [0, 30, 60, 75, 85, 88])
def test_dots_are_spread_evenly_at_any_slant(tilt):
    """No beads on strings: none is near the next, no place far from all, and where the eye blurs them they are grey."""
    near, far, rough = [], [], []
    for anchor in views(tilt, 12):
        ink = dots_on(anchor)
        dots = middles(ink)
        inner = dots[((dots > 2 * PITCH) & (dots < SIZE - 2 * PITCH)).all(1)]
        apart = np.hypot(*np.moveaxis(inner[:, None] - dots[None], 2, 0))
        near.append(np.sort(apart, 1)[:, 1] / PITCH)
        places = np.random.default_rng(0).uniform(2 * PITCH, SIZE - 2 * PITCH, (400, 2))
        far.append(np.hypot(*np.moveaxis(places[:, None] - dots[None], 2, 0)).min(1).max() / PITCH)
        grey = blurred(ink, 0.35)[32:-32, 32:-32]
        rough.append(grey.std() / grey.mean())
    near = np.percentile(np.concatenate(near), 5)
    assert near > 0.6 and max(far) < 1 and max(rough) < 0.22, (near, max(far), max(rough))
