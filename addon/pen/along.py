# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of equal light made calm: light is averaged along them, never across (line integral convolution along the
least eigenvector of the smoothed structure tensor: Kyprianidis and Kang 2011). What noise has left at a wide penumbra
lets its levels end in stairs, which no mean over an area takes away without moving them.

Means of far pairs move a level where light bends across them, as in the border of a soft shadow. There the noise that
is left is taken from along a longer way: what light is at its middle tells a parabola through it, so that neither a way
that turns off the level a little, nor a level that curves, moves it (Savitzky and Golay 1964).

A way goes from pixel to pixel as light turns, and ends where it turns no way more than another, or at an outline or a
fold. Pairs of places on both sides count as they do for even().
"""

from collections.abc import Callable

import numpy as np

_SHORT, _LONG = (6, 1), (8, 3)  # of a way to both sides: paces, pixels of a pace
_ONE_WAY = 0.5    # of the structure tensor's eigenvalues, how much of their sum they differ by
_FLAT = 1 / 16     # of what light may be off by: where its slope is less nothing tells its way, and it is not asked
_ABOUT, _WIDE = (1, 2), (1, 2, 4)  # pixels between the places of means that tell a border, and its way
_SLOPES = 1 / 12  # of what light may be off by: a border is where it changes by more from one pixel to the next
REACH = _SHORT[0] + 4  # with what tells the way and its light
REACH_FAR = _LONG[0] * _LONG[1] + 2 + 2 * sum(_WIDE)


def calm(light: np.ndarray, most: np.ndarray, whole: np.ndarray, slope: tuple[np.ndarray, ...],
         mean: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """light (height, width), averaged where `most`, by which it may be off, is above 0. whole: whether what lies about
    a pixel is of one surface; slope: of light, down and to the right; mean: of the window about each pixel."""
    down, right, clear = _ways(slope, mean)
    clear &= whole
    most = np.where(mean(slope[0] ** 2 + slope[1] ** 2) > (most * np.float32(_FLAT)) ** 2, most, 0)
    places = np.nonzero(clear & (most > 0))
    out = light.copy()
    total, weights = _sums(light, most, (down, right, clear), places, *_SHORT)
    out[places] += total[0] / weights[0]
    return out


def border(light: np.ndarray, most: np.ndarray, whole: np.ndarray, slope: tuple[np.ndarray, ...],
           mean: Callable[[np.ndarray, int], np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """light as calm() has it, averaged along long ways where it is the border of a shadow, and how surely it is one:
    where light changes by more than noise, or its own turning to and fro, lets it. mean: with so many pixels between
    its places."""
    down, right, square = _about([*slope, slope[0] ** 2 + slope[1] ** 2], whole, mean, _ABOUT)
    steady = down * down + right * right
    least = np.sqrt(np.maximum(square - steady, 0) + (np.float32(_SLOPES) * most) ** 2)
    ratio = np.divide(np.sqrt(steady), least, out=np.zeros_like(light), where=(least > 0) & whole & (most > 0))
    *ways, clear = _ways(slope, lambda picture: _about([picture], whole, mean, _WIDE)[0])
    sure = np.where(clear, np.clip(ratio - 1, 0, 1), 0)
    places = np.nonzero(sure > 0)
    (one, two), (w0, w2, w4) = _sums(light, most, (*ways, clear & whole), places, *_LONG)
    whole_fit = w0 * w4 - w2 * w2
    out = light.copy()
    out[places] += np.divide(one * w4 - two * w2, whole_fit, out=np.zeros_like(one), where=whole_fit > 1e-6 * w0 * w0)
    return out, sure


def _about(pictures, whole, mean, steps):
    """Their means about each pixel, over what is of one surface."""
    pictures = [np.where(whole, picture, 0) for picture in pictures] + [whole.astype(np.float32)]
    for step in steps:
        pictures = [mean(picture, step) for picture in pictures]
    *pictures, share = pictures
    return [np.divide(picture, share, out=np.zeros_like(picture), where=share > 0) for picture in pictures]


def _sums(light, most, ways, places, paces, pixels):
    """Of pairs on both sides of `places`: sums of weight by how far they are off, without and with the square of the
    way to them, its whole being 1, and of weight by powers 0, 2, 4 of that way."""
    own, limit = light[places], most[places]
    down, right, clear = ways
    one, two = (_walk(light, down, right, clear, places, side, paces, pixels) for side in (1, -1))
    total, weights = [np.zeros_like(own) for _ in range(2)], [np.ones_like(own), np.zeros_like(own), np.zeros_like(own)]
    for pace, ((a, there), (b, too)) in enumerate(zip(one, two, strict=True), 1):
        off = (a + b) * np.float32(0.5) - own
        share = np.divide(off, limit, out=np.ones_like(off), where=there & too)
        alike = np.maximum(1 - share * share, 0)
        alike *= np.float32(2 * (1 - (pace / (paces + 1)) ** 2)) * alike
        for k, weight in enumerate(weights):
            by = alike * np.float32((pace / paces) ** (2 * k))
            weight += by
            if k < len(total):
                total[k] += by * off
    return total, weights


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


def _walk(light, down, right, clear, places, side, paces, pixels):
    """At each pace: light there, and whether the way has come so far. A pace goes as the way does at its middle, which
    stays on a round curve."""
    height, width = light.shape
    rows, columns = places
    y, x = np.zeros(len(rows), np.float32), np.zeros(len(rows), np.float32)
    way = side * pixels * down[places], side * pixels * right[places]
    there, half = np.ones(len(rows), bool), np.float32(0.5)

    def at(down_by, right_by):
        return (np.clip(rows + down_by.astype(np.intp), 0, height - 1) * width
                + np.clip(columns + right_by.astype(np.intp), 0, width - 1))

    for _ in range(paces):
        within = (y + way[0] * half, x + way[1] * half)
        nearest = at(*(np.floor(part + np.float32(0.5)) for part in within))
        there = there & clear.take(nearest)
        new = down.take(nearest), right.take(nearest)
        turned = np.where(new[0] * way[0] + new[1] * way[1] < 0, np.float32(-pixels), np.float32(pixels))
        way = turned * new[0], turned * new[1]
        y, x = y + way[0], x + way[1]
        top, left = np.floor(y), np.floor(x)
        low, high = (light.take(at(top + k, left)) * (1 - (x - left)) + light.take(at(top + k, left + 1)) * (x - left)
                     for k in (0, 1))
        there = there & clear.take(at(*(np.floor(part + np.float32(0.5)) for part in (y, x))))
        yield low + (high - low) * (y - top), there
