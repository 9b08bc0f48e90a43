# SPDX-License-Identifier: GPL-3.0-or-later
"""Which points lie within a distance of which."""

import numpy as np


def pairs(a, b, radius):
    """Indices (i, j) of all points a[i], b[j], (n, 2) and (m, 2), at most `radius` apart; by i, then j."""
    a, b = np.asarray(a, float).reshape(-1, 2), np.asarray(b, float).reshape(-1, 2)
    if not len(a) or not len(b):
        return np.zeros(0, int), np.zeros(0, int)
    low = np.minimum(a.min(0), b.min(0)) - 2 * radius
    cell_a, cell_b = (np.floor((p - low) / radius).astype(np.int64) for p in (a, b))
    width = max(cell_a[:, 1].max(), cell_b[:, 1].max()) + 2
    key = cell_b[:, 0] * width + cell_b[:, 1]
    order = np.argsort(key, kind="stable")
    key = key[order]
    found = []
    for dy in (-1, 0, 1):  # three cells of a row lie one after another
        row = (cell_a[:, 0] + dy) * width + cell_a[:, 1]
        first, last = np.searchsorted(key, row - 1, "left"), np.searchsorted(key, row + 1, "right")
        count = last - first
        i = np.repeat(np.arange(len(a)), count)
        j = order[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)]
        close = ((a[i] - b[j]) ** 2).sum(1) <= radius * radius
        found.append((i[close], j[close]))
    i, j = (np.concatenate(part) for part in zip(*found, strict=True))
    order = np.lexsort((j, i))
    return i[order], j[order]
