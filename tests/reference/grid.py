# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows about a pixel, and what they read outside the frame."""

import numpy as np


def positions(shape):
    """Row and column of every pixel of an (H, W) frame."""
    return np.indices(shape)


def read(image, dy, dx):
    """The value dy rows down and dx columns right of each pixel; outside, the nearest pixel's."""
    height, width = image.shape[:2]
    rows = np.clip(np.arange(height) + dy, 0, height - 1)
    columns = np.clip(np.arange(width) + dx, 0, width - 1)
    return image[rows][:, columns]


def window(radius):
    """The offsets of a square window, row by row."""
    span = range(-radius, radius + 1)
    return [(dy, dx) for dy in span for dx in span]


def most(image, radius):
    """The largest value in the window about each pixel (rows, then columns)."""
    down = np.max([read(image, k, 0) for k in range(-radius, radius + 1)], axis=0)
    return np.max([read(down, 0, k) for k in range(-radius, radius + 1)], axis=0)


def continued(image, radius):
    """(H + 2 radius, W + 2 radius): the image carried on linearly, u(-k) = 2 u(0) - u(min(k, n - 1))."""
    for axis in (0, 1):
        u = np.moveaxis(image, axis, 0)
        n = len(u)
        before = [2 * u[0] - u[min(k, n - 1)] for k in range(radius, 0, -1)]
        after = [2 * u[-1] - u[max(n - 1 - k, 0)] for k in range(1, radius + 1)]
        image = np.moveaxis(np.array([*before, *u, *after]), 0, axis)
    return image


def nearest(mask):
    """Row and column of the Euclidean-nearest pixel of `mask`, and the distance (inf where there is none).

    Ties go to the least row, then the least column."""
    y, x = positions(mask.shape)
    best = np.full(mask.shape, np.iinfo(np.int64).max)
    row, column = np.zeros_like(y), np.zeros_like(x)
    for ey, ex in np.argwhere(mask):
        squared = (y - ey) ** 2 + (x - ex) ** 2
        closer = squared < best
        best[closer], row[closer], column[closer] = squared[closer], ey, ex
    return row, column, np.where(best == np.iinfo(np.int64).max, np.inf, np.sqrt(best.astype(float)))


def round_half_up(x):
    return np.floor(x + 0.5).astype(int)


def rounds_doubtfully(x, tolerance):
    """Where an error of `tolerance` could round x to another number."""
    return np.abs(x + 0.5 - np.round(x + 0.5)) < tolerance
