# SPDX-License-Identifier: GPL-3.0-or-later
"""Stipple: spots lie in no rows, rings or columns, and are the same on any number of threads, whatever is kept."""

import numpy as np
import pytest
from encre.pen import library
from toned import ALONE, flat

SIZE = 320, 320


def pressed(by, scale=0.01, turn=0.3):
    """The anchor of a plane that is seen so many times shorter along one way."""
    y, x = np.mgrid[:SIZE[0], :SIZE[1]]
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    grows = turned @ np.diag((1, by)) @ turned.T * scale / np.sqrt(by)
    anchor = np.zeros((*SIZE, 16), np.float32)
    anchor[..., :2] = x[..., None] * grows[:, 0] + y[..., None] * grows[:, 1]
    anchor[..., 5], anchor[..., 6], anchor[..., 7:9], anchor[..., 10:12] = 1, scale, grows[:, 0], grows[:, 1]
    return anchor


def spectrum(ink):
    """(The highest peak over the mean of its ring, how much waves of 17 pixels and more have of the mean)."""
    window = np.hanning(ink.shape[0])[:, None] * np.hanning(ink.shape[1])
    power = np.abs(np.fft.fft2((ink - ink.mean()) * window)) ** 2
    f = np.hypot(*np.meshgrid(*[np.fft.fftfreq(n) for n in ink.shape], indexing="ij"))
    rings = [power[(f >= low) & (f < low + 0.02)] for low in np.arange(0.03, 0.45, 0.02)]
    slow = power[(f > 0.01) & (f < 0.06)].mean() / power[f < 0.45].mean()
    return max(ring.max() / ring.mean() for ring in rings), slow


@pytest.mark.parametrize("by", [1, 3])
def test_spots_lie_in_no_rows_and_evenly(by):
    """Random noise has peaks of 11 and 1.1 of long waves; spots shifted from a lattice had 36, and 1.5."""
    found = [spectrum(flat(0.3, SIZE, pressed(by, scale), tone_1="STIPPLE", tone_1_space="SURFACE", tone_1_pitch=8.0))
             for scale in (0.01, 0.008, 0.0066, 0.0052)]
    peaks, slow = np.array(found).T
    assert peaks.mean() < 12.5 and peaks.max() < 14 and slow.max() < 0.9, found


def test_spots_are_the_same_on_any_threads_and_from_a_kept_set():
    one = np.ones((*SIZE, 3), np.float32)
    layers = dict(combined=np.ones((*SIZE, 4), np.float32), color=one, diffuse=one, depth=5 * one[..., :1],
                  normal=one * np.float32((0, 0, 1)), anchor=pressed(2))
    scene = dict(ALONE, shade_levels=[(0.6,)], tone_1="STIPPLE", tone_1_space="SURFACE", tone_1_pitch=8.0)
    drawn = []
    for how in (dict(threads=1), dict(threads=3), dict(simd=0), dict(threads=1)):
        if len(drawn) != 3:
            library.load().forget()
        drawn.append(library.render(layers, scene, outputs=["Encre Tones"], **how).images["Encre Tones"].tobytes())
    assert len(set(drawn)) == 1


def test_spots_grow_from_nothing_as_they_come_nearer():
    """By a thirtieth of the way: none of their pixels gets much darker at once than what moves with them."""
    size = 200, 200
    y, x = np.mgrid[:size[0], :size[1]] - 100.0
    ink = []
    for scale in (0.01, 0.01 / 1.005):
        anchor = np.zeros((*size, 16), np.float32)
        anchor[..., 0], anchor[..., 1], anchor[..., 5] = x * scale, y * scale, 1
        anchor[..., 6] = anchor[..., 7] = anchor[..., 11] = scale
        ink.append(flat(0.3, size, anchor, tone_1="STIPPLE", tone_1_space="SURFACE", tone_1_pitch=8.0)[80:120, 80:120])
    spread = sum(np.roll(ink[1] - ink[0], (j, i), (0, 1)) for j in (-1, 0, 1) for i in (-1, 0, 1)) / 9
    assert np.abs(spread).max() < 0.15 and ink[0].std() > 0.2
