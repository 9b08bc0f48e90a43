# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of equal light made calm: light is averaged along them, never across (line integral convolution along the
least eigenvector of the smoothed structure tensor: Kyprianidis and Kang 2011). What noise has left at a wide penumbra
lets its levels end in stairs, which no mean over an area takes away without moving them.

A way goes from pixel to pixel as light turns, and ends where it turns no way more than another, or at an outline or a
fold. Pairs of places on both sides count as they do for even().
"""

from collections.abc import Callable

import numpy as np

_PACES = 6        # pixels: as far as a way goes to both sides
_ONE_WAY = 0.5    # of the structure tensor's eigenvalues, how much of their sum they differ by
_FLAT = 1 / 16     # of what light may be off by: where its slope is less nothing tells its way, and it is not asked
REACH = _PACES + 4  # with what tells the way and its light


def calm(light: np.ndarray, most: np.ndarray, whole: np.ndarray, slope: tuple[np.ndarray, ...],
         mean: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """light (height, width), averaged where `most`, by which it may be off, is above 0. whole: whether what lies about
    a pixel is of one surface; slope: of light, down and to the right; mean: of the window about each pixel."""
    down, right, clear = _ways(slope, mean)
    clear &= whole
    most = np.where(mean(slope[0] ** 2 + slope[1] ** 2) > (most * np.float32(_FLAT)) ** 2, most, 0)
    places = np.nonzero(clear & (most > 0))
    own = light[places]
    one, two = (_walk(light, down, right, clear, places, side) for side in (1, -1))
    total, weights = np.zeros_like(own), np.ones_like(own)
    for pace, ((a, there), (b, too)) in enumerate(zip(one, two, strict=True), 1):
        off = (a + b) * np.float32(0.5) - own
        share = np.divide(off, most[places], out=np.ones_like(off), where=there & too)
        alike = np.maximum(1 - share * share, 0)
        alike *= np.float32(2 * (1 - (pace / (_PACES + 1)) ** 2)) * alike
        total += alike * off
        weights += alike
    out = light.copy()
    out[places] += total / weights
    return out


def _ways(slope, mean):
    """The way (down, right) along which light stays as it is, of length 1, and whether there is one."""
    down, right = slope
    a, b, c = mean(down * down), mean(down * right), mean(right * right)
    half = (a - c) * np.float32(0.5)
    root = np.sqrt(half * half + b * b)
    up, across = np.where(half > 0, half + root, b), np.where(half > 0, b, root - half)
    length = np.sqrt(up * up + across * across)
    clear = (length > 0) & (2 * root > np.float32(_ONE_WAY) * (a + c))
    return *(np.divide(part, length, out=np.zeros_like(a), where=clear) for part in (-across, up)), clear


def _walk(light, down, right, clear, places, side):
    """At each pace: light there, and whether the way has come so far."""
    height, width = light.shape
    rows, columns = places
    y, x = np.zeros(len(rows), np.float32), np.zeros(len(rows), np.float32)
    way = side * down[places], side * right[places]
    there = np.ones(len(rows), bool)
    for _ in range(_PACES):
        y, x = y + way[0], x + way[1]
        top, left = np.floor(y), np.floor(x)
        at = [np.clip(rows + (top + k).astype(np.intp), 0, height - 1) * width for k in (0, 1)]
        beside = [np.clip(columns + (left + k).astype(np.intp), 0, width - 1) for k in (0, 1)]
        low, high = (light.take(at[k] + beside[0]) * (1 - (x - left)) + light.take(at[k] + beside[1]) * (x - left)
                     for k in (0, 1))
        nearest = np.where(y - top < 0.5, *at) + np.where(x - left < 0.5, *beside)
        there = there & clear.take(nearest)
        yield low + (high - low) * (y - top), there
        new = down.take(nearest), right.take(nearest)
        turned = np.where(new[0] * way[0] + new[1] * way[1] < 0, np.float32(-1), np.float32(1))
        way = turned * new[0], turned * new[1]
