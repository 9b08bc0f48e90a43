# SPDX-License-Identifier: GPL-3.0-or-later
"""Small closed things of another colour: rings without horns, which fade as they shrink; corners stay."""

import numpy as np
import pages
import pytest
from judge import kinds, verdict
from judge.camera import look
from judge.scenes import turned
from judge.shapes import box, disc, polygon


def drawn(paint, places):
    """Ink of a dark thing painted at each of the places on a wall, 60 pixels a unit; and where they are."""
    wall = box((9, 7, 0.2), (0, 0, -0.1), turned(0))
    wall.color, front = np.array([0.8, 0.78, 0.7]), max(range(6), key=lambda part: wall.parts[part].n[2])
    for at in places:
        paint(wall, front, at)
    scene = kinds.Crowded(look([0, 0, 6], [0, 0, 0]), [wall], kinds.FLAT)
    t = pages.drawer("FINE")(scene.layers("blackman"), scene.camera_settings, **verdict.PARAMS)
    return t, np.stack(scene.camera.project(places, scene.size)[:2], 1)


def places():
    rng = np.random.default_rng(11)
    return np.array([(0.6 * i - 2.4 + rng.uniform(-0.01, 0.01), 0.6 * j - 1.2 + rng.uniform(-0.01, 0.01), 0)
                     for i in range(9) for j in range(5)])


@pytest.mark.slow
def test_spots_fade_as_they_shrink():
    ink = []
    for radius in np.arange(1, 2.6, 0.25):
        t, _ = drawn(lambda wall, part, at, r=radius: disc(wall, part, at, r / 60, np.array([0.05, 0.05, 0.06])),
                     places())
        ink.append(t.sum() / len(places()))
    assert ink[0] < 0.5 and ink[-1] > 13, "gone at one end, a ring at the other"
    assert np.diff(ink).min() >= 0 and np.diff(ink).max() < 6, "by degrees"


def test_small_squares_keep_their_corners():
    half = 3.5 / 60
    t, at = drawn(lambda wall, part, at: polygon(
        wall, part, [at + half * np.array(c) for c in ((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))],
        np.array([0.05, 0.05, 0.06])), places())
    near = [t[int(np.rint(y + dy)), int(np.rint(x + dx))] for x, y in at for dx in (-3.2, 3.2) for dy in (-3.2, 3.2)]
    assert np.mean(np.array(near) > 0.25) > 0.95
