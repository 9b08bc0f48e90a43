# SPDX-License-Identifier: GPL-3.0-or-later
"""The tone of a picture that is laid side by side."""

import numpy as np

from .metric import clamp01, mix


def scrambled(n):
    n = (n ^ n >> 16) * 0x7feb352d & 0xffffffff
    n = (n ^ n >> 15) * 0x846ca68b & 0xffffffff
    return n ^ n >> 16


def thresholds(image, pitch):
    """The darkness (H, W) from which on each texel of a tile is inked: its rank among all."""
    image = np.asarray(image, np.float64)
    image = np.clip(np.nan_to_num(image[..., None] if image.ndim == 2 else image, nan=0.0), 0, 1)
    grey = image[..., :3] @ (0.2126, 0.7152, 0.0722) if image.shape[2] > 2 else image[..., 0]
    height, width = grey.shape
    shrink = 1
    while (shrink + 1 <= width / pitch or max(grey.shape) // shrink > 1024) and shrink < min(grey.shape):
        shrink += 1
    height, width = height // shrink, width // shrink
    grey = grey[:height * shrink, :width * shrink].reshape(height, shrink, width, shrink).mean((1, 3))
    level = np.floor(grey.ravel() * 65535 + 0.5)
    order = np.sort(level)
    below = np.searchsorted(order, level)
    same = np.searchsorted(order, level, "right") - below
    n = scrambled(np.arange(level.size))  # those of one level in any order, by a hash
    within = (n >> 8) / 2**24
    return ((below + within * same) / level.size).reshape(height, width)


def pictured(tile, points, dark, crisp):
    """Ink of a tile of thresholds, by the lattice on which it is laid: what a pixel covers of inked texels."""
    at, _, grown, step, flat, _ = points
    height, width = tile.shape

    pieces = [np.floor(np.clip(a * 12, -1e9, 1e9)).astype(np.int64) & 0xffffffff for a in at]
    n = scrambled(scrambled(pieces[0]) ^ pieces[1])
    first, second = (clamp01((g * (4 - g) / 3 - 0.3 * (n & 0xffff) / 65536) / 0.7) for g in grown)
    both = np.minimum(first, second)
    shares = {(0, 0): 1 - np.maximum(first, second), (1, 0): first - both, (0, 1): second - both, (1, 1): both}

    def texels(place, n, size):
        u = (place - np.floor(place)) * n - 0.5
        first, s = np.floor(u).astype(int), u - np.floor(u)
        s = (s >= 0.5).astype(float) if crisp else clamp01((s - 0.5) * np.maximum(size / n, 1) + 0.5)
        return first % n, (first + 1) % n, s

    def inked(row, column):
        return (tile[row, column] < dark).astype(float)

    ink = np.zeros(dark.shape)
    for (i, j), share in shares.items():
        u, v = 1 + i, (1 + j) * width / height
        left, right, s = texels(at[0] * u, width, np.hypot(*step[0]) / u)
        above, below, t = texels(at[1] * v, height, np.hypot(*step[1]) / v)
        ink += share * mix(mix(inked(above, left), inked(above, right), s),
                           mix(inked(below, left), inked(below, right), s), t)
    return np.where(flat, dark, ink)
