# SPDX-License-Identifier: GPL-3.0-or-later
"""Spots: points of an endless set that hashes tell, drawn as discs where pixels of a surface hold them."""

from functools import lru_cache

import numpy as np
from scipy.spatial import cKDTree

from .metric import clamp01

COARSEST, FINEST, DENSITY = -26, 60, 0.5783
TRIED, ROUNDS, MARGIN, ONE = 5, 2, 5, 65536
HELD, GROWN, UNEVEN, WIDEST = 0.6, 0.8, 0.12, 24
SLANTED, THINNED, MORE, APART, APART_MOST, LINKS = 5, 0.3, 1.4, 0.7, 40, 24
BLOCK = 64
# the share of a level's new points by how near they are to an old one, in even steps
BORN = np.array([
    0, 0.00108, 0.00148, 0.00201, 0.00271, 0.00367, 0.00498, 0.00666, 0.00889, 0.01182, 0.01561, 0.02034, 0.02617,
    0.03325, 0.04195, 0.05254, 0.06516, 0.08028, 0.09807, 0.11937, 0.14428, 0.17347, 0.20739, 0.24673, 0.29242,
    0.34513, 0.40586, 0.47563, 0.55539, 0.64644, 0.75099, 0.86854, 1])
# the area of spots whose ink is 0, 1/32, .. 1, for a radius of 1.25 pixels and of 5
AREA = np.array([
    [0, 0.0424, 0.0848, 0.1271, 0.1695, 0.2119, 0.2542, 0.2965, 0.3386, 0.3810, 0.4235, 0.4662, 0.5091, 0.5524,
     0.5964, 0.6421, 0.6888, 0.7367, 0.7867, 0.8392, 0.8944, 0.9524, 1.0148, 1.0825, 1.1558, 1.2399, 1.3331, 1.4403,
     1.5688, 1.7319, 1.9570, 2.3363, 3.2],
    [0, 0.0422, 0.0846, 0.1273, 0.1697, 0.2118, 0.2539, 0.2963, 0.3385, 0.3809, 0.4232, 0.4656, 0.5084, 0.5504,
     0.5933, 0.6361, 0.6794, 0.7233, 0.7681, 0.8142, 0.8623, 0.9124, 0.9655, 1.0219, 1.0827, 1.1492, 1.2243, 1.3073,
     1.4068, 1.5294, 1.6906, 1.9516, 3.2]])


def whole(n):
    return np.asarray(n, np.uint64) & np.uint64(0xffffffff)


def mixed(n):
    n = whole(n)
    n = whole((n ^ n >> np.uint64(16)) * np.uint64(0x7feb352d))
    n = whole((n ^ n >> np.uint64(15)) * np.uint64(0x846ca68b))
    return n ^ n >> np.uint64(16)


def tried(level, x0, y0, wide, high):
    """(places in 65536ths of a cell from the first's corner, orders) of what is tried in cells."""
    first = mixed(level * 0x9e3779b9 + 0x51ed270b & 0xffffffff)
    row = mixed(first + whole(y0 % (1 << 32)) + np.arange(high, dtype=np.uint64))
    column = np.arange(wide * TRIED, dtype=np.uint64) + whole(x0 * TRIED % (1 << 32))
    h = mixed(row[:, None] + column)
    x = (h & np.uint64(0xffff)).astype(np.int64) + np.arange(wide * TRIED) // TRIED * ONE
    y = (h >> np.uint64(16)).astype(np.int64) + np.arange(high)[:, None] * ONE
    return np.stack([x.ravel(), y.ravel()], 1), mixed(h + np.uint64(0x632be5ab)).astype(np.int64).ravel()


def coarser(level, x0, y0, wide, high):
    """(births, places, names) of the points that the level above has in cells, as tried() has places."""
    if level == COARSEST:
        return np.zeros(0), np.zeros((0, 2), np.int64), np.zeros(0, np.int64)
    (left, right), (top, bottom) = ((int(np.floor(v / np.sqrt(2))) - 1, int(np.floor((v + n) / np.sqrt(2))) + 1)
                                    for v, n in ((x0, wide), (y0, high)))
    birth, at, name = points(level - 1, left, top, right - left, bottom - top)
    at = np.floor(((np.array((left, top)) + (at + 0.5) / ONE) * 1.4142135623730951 - (x0, y0)) * ONE).astype(np.int64)
    inside = ((at >= 0) & (at < np.array((wide, high)) * ONE)).all(1)
    return birth[inside], at[inside], name[inside]


def points(level, x0, y0, wide, high):
    """(births, places, names) of the points in cells, as tried() has places."""
    about = level, x0 - MARGIN - 3, y0 - MARGIN - 3, wide + 2 * MARGIN + 6, high + 2 * MARGIN + 6
    old_birth, old, old_name = coarser(*about)
    at, order = tried(*about)
    far, root = np.full(len(at), np.inf), np.sqrt(2) * ONE
    if len(old):
        far = cKDTree(old).query(at)[0]
        at, order, far = at[far > root], order[far > root], far[far > root]
    pairs = cKDTree(at).query_pairs(root, output_type="ndarray")
    lower, upper = np.where(order[pairs[:, :1]] < order[pairs[:, 1:]], pairs, pairs[:, ::-1]).T
    alive, new = np.ones(len(at), bool), np.zeros(len(at), bool)
    for _ in range(ROUNDS):
        waits = np.zeros(len(at), bool)
        waits[upper[alive[lower]]] = True
        taken = alive & ~waits
        new |= taken
        alive &= ~taken
        alive[upper[taken[lower]]] = False
        both = alive[lower] & alive[upper]
        lower, upper = lower[both], upper[both]
    at, order, far = at[new], order[new], far[new]
    steps = 32 * clamp01((2.24 - far / ONE) / (2.24 - np.sqrt(2)))
    late = 0.5 + 0.5 * np.interp(steps, np.arange(33), BORN) if level > COARSEST else ((order >> 8) + 0.5) / 2**24
    birth, at = np.concatenate([DENSITY * 2.0**level * late, old_birth]), np.concatenate([at, old]) - (MARGIN + 3) * ONE
    inside = ((at >= 0) & (at < np.array((wide, high)) * ONE)).all(1)
    return birth[inside], at[inside], np.concatenate([order & 0xffff, old_name])[inside]


@lru_cache(400)
def block(level, x, y):
    """By cell (birth, place in cells, name)."""
    birth, at, name = points(level, x * BLOCK, y * BLOCK, BLOCK, BLOCK)
    corner = np.array((x, y)) * BLOCK
    return {tuple(corner + cell // ONE): (b, corner + (cell + 0.5) / ONE, n)
            for b, cell, n in zip(birth, at, name, strict=True)}


def point(level, x, y):
    return block(level, x // BLOCK, y // BLOCK).get((x, y), (np.inf, None, None))


def radius(dark, apart):
    return apart * (0.336 + 0.252 * dark)


def wanted(dark, r):
    """Spots to a pixel."""
    small = clamp01((1 / r - 0.2) / 0.6)
    area = [np.interp(32 * dark, np.arange(33), table) for table in AREA]
    return (small * area[0] + (1 - small) * area[1]) / (np.pi * r * r)


class Spots:
    """charts: (axis, fields) as of strokes (scatter.py), of both axes along which the rest normal is longest. bounds:
    pixels between which spots lie a unit apart."""

    def __init__(self, layers, charts, dark, bounds, unit, seams, crisp):
        self.layers, self.charts, self.bounds, self.unit, self.crisp = layers, charts, bounds, unit, crisp
        self.seams = seams
        self.byte = np.floor(255 * clamp01(dark) + 0.5).astype(int)
        self.ink = np.zeros(dark.shape)

    def held(self, chart, x, y):
        """(way, radius, name, birth, how far it's thinned, by those how near) of the points of a chart in a pixel."""
        (u, a, b), (v, c, d) = ([float(field[y, x]) for field in axis] for axis in chart)
        area, sides = abs(a * d - b * c), (a * a + b * b) * (c * c + d * d)
        if not area**2 > 1e-6 * sides:
            return
        dark, apart = self.byte[y, x] / 255, float(np.clip(self.unit / np.sqrt(area), *self.bounds))
        r = radius(dark, apart)
        seen = np.linalg.svd(np.array([[a, b], [c, d]]), compute_uv=False)
        slant = min(seen[0] / seen[1], SLANTED)
        thinned = clamp01((slant - 1) / THINNED)
        too_many = (1 + 0.36 * thinned * (1.3 - 0.3 * thinned) + 0.12 * clamp01(4 * (slant - 1.3))
                    + 0.085 * max(slant - 2, 0))
        to_pixel = wanted(dark, r) / too_many
        density = to_pixel * (1 + MORE * (slant - 1)) / area
        level = max(int(np.ceil(np.log2(density / DENSITY))), COARSEST)
        cells = 2.0 ** ((level + 1) / 2)
        if level > FINEST or max(abs(u), abs(v)) * cells >= 2**30:
            return
        reach = [HELD * (abs(p) + abs(q)) * cells for p, q in ((a, b), (c, d))]
        if max(reach) >= WIDEST / 2:
            return
        inverse = np.linalg.inv(np.array([[a, b], [c, d]]) * cells)
        ranges = [range(int(np.floor(at * cells - far)), int(np.floor(at * cells + far)) + 1)
                  for at, far in zip((u, v), reach, strict=True)]
        for cy in ranges[1]:
            for cx in ranges[0]:
                birth, at, name = point(level, cx, cy)
                if not birth < density:
                    continue
                way = inverse @ (at[0] - u * cells, at[1] - v * cells)
                if np.abs(way).max() <= HELD:
                    grown = clamp01((density / birth - 1) / GROWN)
                    hand = 1 + UNEVEN * (name / 2**15 - 1)
                    yield (way, r * np.sqrt(grown) * hand, name, birth, thinned,
                           min(APART / np.sqrt(to_pixel), APART_MOST))

    def disc(self, x, y, r, held_by):
        rows, columns = np.mgrid[:self.byte.shape[0], :self.byte.shape[1]] + 0.5
        true = np.sqrt(max(r * r - 1 / 12, 0)) if r > 0.57735 else np.cbrt(3 * r * r) - 0.5
        distance = np.hypot(columns - x, rows - y)
        cover = r >= distance if self.crisp else clamp01(true + 0.5 - distance)
        cover = np.where(self.layers.object == self.layers.object[held_by], cover, 0)
        self.ink = 1 - (1 - self.ink) * (1 - cover)

    def draw(self, own):
        held = {}
        for y, x in zip(*np.nonzero(own & (self.byte > 0)), strict=True):
            near = self.seams is not None and self.seams.near(x, y)
            for k, (axes, chart) in enumerate(self.charts[:2 if near else 1]):
                for way, *spot in self.held(chart, x, y):
                    if not near or self.seams.before(k == 0, axes[y, x], x, y, way):
                        held.setdefault((y, x), []).append((int(256 * (way @ way) + 0.5), way, *spot))
        left = []
        for (y, x), spots in held.items():
            for off, way, r, name, *rest in spots:
                same = [(other[0], (y + v, x + u)) for v in (-1, 0, 1) for u in (-1, 0, 1)
                        for other in held.get((y + v, x + u), ()) if other[3] == name]
                if min(same) == (off, (y, x)):
                    left.append(((y, x), np.array((x + 0.5 + way[0], y + 0.5 + way[1])), r, *rest))
        weight, objects = np.ones(len(left)), np.array([self.layers.object[spot[0]] for spot in left])
        pixels, at = np.array([spot[0] for spot in left]), np.array([spot[1] for spot in left])
        births = np.array([spot[3] for spot in left])
        for i in np.argsort(births, kind="stable"):
            *_, thinned, within = left[i]
            if thinned > 0:
                away = np.hypot(*(at - at[i]).T) / within
                before = (births < births[i]) | ((births == births[i]) & (np.arange(len(left)) < i))
                takes = (away < 1) & before & (objects == objects[i])
                takes &= (np.abs(pixels - pixels[i]) <= int(within) + 1).all(1)
                takes = np.nonzero(takes)[0][:LINKS]
                lets = np.prod(1 - weight[takes] * (1 - np.maximum(away[takes] - 0.8, 0) / 0.2))
                weight[i] = 1 + (lets - 1) * thinned
        for (pixel, (x, y), r, *_), area in zip(left, weight, strict=True):
            if r * area > 0:
                self.disc(x, y, r * np.sqrt(area), pixel)
        return self.ink
