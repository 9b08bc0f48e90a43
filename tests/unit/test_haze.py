# SPDX-License-Identifier: GPL-3.0-or-later
"""What is behind haze, of which only some samples of a pixel tell."""

import numpy as np
from encre.pen import haze


def scene(samples):
    """(what is there, passes of a renderer some samples of which come through, index, depth): two boards of one colour
    each that meet at a right angle, before nothing."""
    rng = np.random.default_rng(samples)
    number = np.zeros((40, 60), int)
    number[5:35, 5:30], number[5:35, 30:55] = 1, 2
    normal = np.float32([(0, 0, 0), (0, -1, 0), (1, 0, 0)])[number]
    color = np.float32([(0, 0, 0), (0.8, 0.2, 0.1), (0.3, 0.3, 0.6)])[number]
    depth = np.where(number > 0, np.float32(4), np.float32(1e10))
    hits = rng.random((samples, *number.shape)) < 0.6
    share = hits.mean(0, dtype=np.float32)[..., None]
    index, seen = np.where(hits[0], number, 0), np.where(hits[0], depth, np.float32(1e10))
    passes = {"Normal": share * normal, "DiffCol": share * color,
              "DiffDir": (share > 0) * (number > 0)[..., None] * np.float32(0.5)}
    known = haze.Haze(number, depth, normal, np.s_[:, :])
    return known, color, {name: np.float32(picture) for name, picture in passes.items()}, index, seen


def test_index_depth_colour_and_light_are_those_without_haze():
    for samples in (2, 16):
        known, color, passes, index, depth = scene(samples)
        assert (index != known.object).mean() > 0.2
        found, far = haze.settled(index, depth, known, np.arange(3))
        np.testing.assert_array_equal(found, known.object)
        np.testing.assert_array_equal(far, known.depth)
        before = {name: picture.copy() for name, picture in passes.items()}
        given = dict(passes)
        haze.cleared(given, known)
        there = known.object > 0
        np.testing.assert_allclose(given["Normal"][there], known.normal[there], atol=1e-6)
        np.testing.assert_allclose(given["DiffCol"][there], color[there], atol=1e-6)
        np.testing.assert_allclose(given["DiffDir"][there], 0.5)
        for name, picture in passes.items():
            np.testing.assert_array_equal(picture, before[name])  # others may read it


def test_outside_and_without_haze_nothing_changes():
    known, _, passes, index, depth = scene(4)
    nowhere = haze.Haze(known.object, known.depth, known.normal, np.s_[:5, :5])
    found, far = haze.settled(index, depth, nowhere, np.arange(3))
    assert (found == index).all() and (far == depth).all()
    given = dict(passes)
    haze.cleared(given, nowhere)
    assert all(given[name] is passes[name] for name in passes)
