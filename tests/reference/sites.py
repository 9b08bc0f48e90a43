# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE, first half: where edges run, to a fraction of a pixel.

Two kinds of evidence. *Cracks* between neighbouring pixels, in layers that are exact at pixel centres (depth, indices)
or smooth (light); *ridges* and *bands* in layers that are averaged over the pixel (normal, colour, light), where the
mixture tells how far into the pixel an edge lies. Positions are (row, column), pixel centres at whole numbers."""

from dataclasses import dataclass, field

import numpy as np

from . import grid, metric, near
from .edges import SOURCES
from .metric import clamp01

FAMILIES = ("outline", "mark", "normal", "color", "light", "seen")  # older first
SEEN = len(SOURCES)  # the source that FINE alone knows
CLEAR = 1.5  # pixels that a younger family keeps from the older ones


@dataclass
class Sites:
    """Arrays of length n, in the order of their numbers."""
    at: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))  # (n, 2) row, column
    pixel: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), int))  # (n, 2) that holds it
    family: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    source: np.ndarray = field(default_factory=lambda: np.zeros(0, int))  # index into SOURCES, or SEEN
    strength: np.ndarray = field(default_factory=lambda: np.zeros(0))  # weighted
    step: np.ndarray = field(default_factory=lambda: np.zeros((0, 6)))  # a ridge's, down the columns and along the rows

    def __len__(self):
        return len(self.at)

    def take(self, where):
        return Sites(**{name: value[where] for name, value in vars(self).items()})

    def add(self, other):
        return Sites(**{name: np.concatenate([value, getattr(other, name)]) for name, value in vars(self).items()})


def sites(at, family, source, strength, shape, step=None):
    at = np.asarray(at, float).reshape(-1, 2)
    pixel = np.clip(grid.round_half_up(at), 0, np.array(shape) - 1)
    return Sites(at, pixel, np.full(len(at), FAMILIES.index(family)),
                 np.broadcast_to(source, len(at)).astype(int), np.broadcast_to(strength, len(at)).astype(float),
                 np.zeros((len(at), 6)) if step is None else step)


def clear_of(at, others, distance):
    """Which points keep that distance from all the others (both (n, 2))."""
    keep = np.ones(len(at), bool)
    keep[near.pairs(at, others, distance)[0]] = False
    return keep


def centred(offset):
    """An offset from a pixel's centre that shares tell, half corrected for a pixel filter narrower than a box.

    Shares of a box are linear in the offset. Those of a Blackman-Harris filter of 1.5 pixels are 0.13 sin(2π offset)
    too large along an axis and 0.05 along a diagonal; with this neither filter is far off."""
    return offset - 0.06 * np.sin(2 * np.pi * offset)


# Cracks: (rows, columns) arrays about the pair of a pixel p and the next one q of its row; columns by transposition


def turn(axis, image):
    """The image with `axis` 1 (along a row) last but for channels: axis 0 is transposed."""
    return image if axis else np.swapaxes(image, 0, 1)


def along(image, k):
    """The value k pixels further along each row; outside the frame the nearest pixel's."""
    return grid.read(image, 0, k)


def depth_crack(layers, axis):
    """J (h, w - 1), relative: what the straight continuation of each side misses at the other.

    0 on planes, quadratics and kinks and beside a jump, so that nothing need be thinned."""
    z, there = turn(axis, layers.depth), turn(axis, layers.there)
    if layers.orthographic:
        u = np.where(there, -np.where(there, z, 0) / layers.height, 0)
    else:
        u = np.where(there, 1 / np.where(there, z, 1), 0)
    before, after = grid.continued(u, 1)[1:-1, :-2], grid.continued(u, 1)[1:-1, 2:]
    four = [before[:, :-1], u[:, :-1], u[:, 1:], after[:, 1:]]
    if layers.orthographic:  # nothing there lies one frame height behind the farthest of the four
        none = ~there
        gone = [along(none, -1)[:, :-1], none[:, :-1], none[:, 1:], along(none, 1)[:, 1:]]
        behind = np.min([np.where(g, np.inf, v) for g, v in zip(gone, four, strict=True)], axis=0) - 1
        four = [np.where(g, np.where(np.isfinite(behind), behind, 0), v) for g, v in zip(gone, four, strict=True)]
    a, p, q, b = four
    left, right = q - 2 * p + a, p - 2 * q + b
    jump = np.maximum(0, np.maximum(np.minimum(left, -right), np.minimum(-left, right)))
    if layers.orthographic:
        return jump
    most = np.max(four, axis=0)
    return np.where(most > 0, jump / np.where(most > 0, most, 1), 0)


def place_crack(layers, axis):
    """t (h, w - 1), 0 at p … 1 at q: what share of p and q the surface behind p has, by what lies one pixel off."""
    v = np.concatenate([turn(axis, layers.albedo), turn(axis, layers.normal) / 2], -1)
    p, q, a, b = v[:, :-1], v[:, 1:], along(v, -1)[:, :-1], along(v, 1)[:, 1:]
    a2, b2 = along(v, -2)[:, :-1], along(v, 2)[:, 1:]
    weight = 1 / (0.02**2 + (a - a2) ** 2 + (b2 - b) ** 2)
    seen = (weight * (a - b) ** 2).sum(-1)
    safe = np.where(seen > 0, seen, 1)
    share = sum(clamp01((weight * (x - b) * (a - b)).sum(-1) / safe) for x in (p, q))
    t = centred(clamp01(share - 0.5))
    return (seen * t + 2) / (seen + 4)  # pulled to the middle where there is nothing to see


def outlines(layers, params, weights):
    """Per axis: (weighted strength, source, t), each (h, w - 1) along rows, 0 where there is no crack."""
    for axis in (1, 0):
        n = turn(axis, layers.depth).shape[1]

        def differs(image, axis=axis):
            image = turn(axis, image)
            return (image[:, 1:] != image[:, :-1]).astype(float)

        gone = differs(layers.there)
        strengths = {
            "object": np.maximum(differs(layers.object), gone), "material": differs(layers.material),
            "depth": np.where(gone > 0, 0, clamp01((depth_crack(layers, axis) - 0.003) / 0.007)),
        }
        known = turn(axis, layers.marks[..., 1 - axis])[:, :-1]
        told = (known < 0) | ((known > 0) & (gone + strengths["depth"] == 0))  # a contour, or a line without a jump
        t = np.where(told, clamp01(np.abs(known)), place_crack(layers, axis))
        side = (t >= 0.5).astype(int)

        def own(image, axis=axis, side=side, n=n):
            image = turn(axis, image)
            return np.where(side == 0, image[:, :n - 1], image[:, 1:])

        weighted = np.array([own(weights[name]) * strengths[name] for name in strengths])
        best = weighted.argmax(0)
        yield weighted.max(0), np.array([SOURCES.index(name) for name in strengths])[best], t


def weave(cracks, shape, threshold, family):
    """Sites and links of cracks: the two crossings on the sides of a 2×2 block of pixel centres are linked;
    with three or four, each to their mean. `cracks`: (strength, source, t) along rows, then along columns."""
    number = []
    at, strengths, sources = [], [], []
    for axis, (strength, source, t) in zip((1, 0), cracks, strict=True):
        on = (strength >= threshold) & (strength > 0)
        row, column = np.nonzero(on)
        place = np.stack([row, column + t[on]], 1)
        at.append(place if axis else place[:, ::-1])
        strengths.append(strength[on])
        sources.append(source[on])
        index = np.full(on.shape, -1)
        index[on] = np.arange(len(row)) + (len(at[0]) if len(at) > 1 else 0)
        number.append(index if axis else index.T)
    found = sites(np.concatenate(at), family, np.concatenate(sources), np.concatenate(strengths), shape)
    rows, columns = number  # (h, w - 1) between columns, (h - 1, w) between rows
    sides = np.stack([rows[:-1], rows[1:], columns[:, :-1], columns[:, 1:]], -1).reshape(-1, 4)
    count = (sides >= 0).sum(1)
    links = [np.sort(sides[count == 2], axis=1)[:, 2:]]
    middles = []
    for block in sides[count > 2]:
        members = block[block >= 0]
        middles.append(members)
        hub = len(found) + len(middles) - 1
        links.append(np.stack([members, np.full(len(members), hub)], 1))
    if middles:
        first = np.array([m[np.argmax(found.strength[m])] for m in middles])
        hubs = sites([found.at[m].mean(0) for m in middles], family, found.source[first], found.strength[first], shape)
        found = found.add(hubs)
    return found, np.concatenate(links).astype(int)


def touched(cracks, threshold, shape):
    """The pixels on either side of a crack: they may hold two surfaces."""
    mixed = np.zeros(shape, bool)
    for axis, (strength, _, _) in zip((1, 0), cracks, strict=True):
        on = (strength >= threshold) & (strength > 0)
        both = np.zeros(turn(axis, mixed).shape, bool)
        both[:, :-1] |= on
        both[:, 1:] |= on
        mixed |= turn(axis, both)
    return mixed


# Ridges and bands


class Reads:
    """Values v(-2)…v(2) along rows (axis 1) or columns; a read stops before mixed pixels."""

    def __init__(self, image, mixed, axis):
        v, mixed = turn(axis, image), turn(axis, mixed)
        self.values, self.open = {0: v}, {0: ~mixed}
        for way in (-1, 1):
            stop = along(mixed, way)
            self.values[way] = np.where(stop[..., None], v, along(v, way))
            stop2 = stop | along(mixed, 2 * way)
            self.values[2 * way] = np.where(stop2[..., None], self.values[way], along(v, 2 * way))
            self.open[way], self.open[2 * way] = ~stop, ~stop2
        self.axis = axis

    def __getitem__(self, k):
        return self.values[k]

    def all_open(self):
        return np.all(list(self.open.values()), axis=0)

    def bend(self):
        """v(1) − v(−1) less what the slopes to either side explain.

        A side that can't be read has the other's slope; where neither can a step is not told from a slope: 0."""
        slope = {way: way * (self[2 * way] - self[way]) for way in (-1, 1)}
        known = {way: (self.open[way] & self.open[2 * way])[..., None] for way in (-1, 1)}
        bend = self[1] - self[-1]
        for way in (-1, 1):
            bend = bend - np.where(self.open[way][..., None], np.where(known[way], slope[way], slope[-way]), 0)
        return np.where(known[-1] | known[1], bend, 0)


def _norm(v):
    return np.sqrt((v**2).sum(-1))


def _sum3(image):
    return sum(grid.read(image, dy, dx) for dy, dx in grid.window(1))


def ridges(signal, linear, mixed, floor):
    """Steps: (at (n, 2), J (n,), before (n, C), after (n, C), directed step (n, 6)).

    signal: (H, W, C), in which a step is looked for; linear: what the pixel averages, which tells the place. Before and
    after are its values 2 pixels off, or 1 where an edge that steps back comes next: the two edges of a thin face."""
    reads = [Reads(signal, mixed, axis) for axis in (1, 0)]
    steps = [np.where(turn(axis, mixed), 0, _norm(r[1] - r[-1])) for axis, r in zip((1, 0), reads, strict=True)]
    prefer = [_sum3(s**2) for s in steps]
    across = prefer[0] >= prefer[1].T
    found = []
    for axis, r, step in zip((1, 0), reads, steps, strict=True):
        own = turn(axis, across if axis else ~across)
        jump, way = _norm(r.bend()), r[1] - r[-1]
        on = own & (jump > np.where(r.all_open(), 0.4, 0.6) * step) & (jump > floor) & (step > 0)
        for k in (-2, -1, 1, 2):
            stronger = (step > along(step, k)) if k < 0 else (step >= along(step, k))
            on &= stronger | ((way * along(way, k)).sum(-1) < -0.5 * step * along(step, k))
        x = Reads(linear, mixed, axis)
        far = {side: (side * (r[2 * side] - r[side]) * way).sum(-1) >= 0 for side in (-1, 1)}
        a, b = (np.where(far[side][on][:, None], x[2 * side][on], x[side][on]) for side in (-1, 1))
        ends = [np.where(far[side][on][:, None], r[2 * side][on], r[side][on]) for side in (-1, 1)]
        square = ((a - b) ** 2).sum(-1)
        share = sum(clamp01(((x[k][on] - b) * (a - b)).sum(-1) / np.where(square > 0, square, 1)) for k in (-1, 0, 1))
        place = np.argwhere(on) + np.stack([0 * share, np.clip(centred(share - 1.5), -1, 1)], 1)
        found.append((place if axis else place[:, ::-1], jump[on], *ends, directed(ends[1] - ends[0], axis)))
    return [np.concatenate(part) for part in zip(*found, strict=True)]


def directed(step, axis):
    """(n, 6): a step of up to 3 channels along a column, then along a row."""
    wide = np.zeros((len(step), 6))
    wide[:, 3 * axis:3 * axis + step.shape[1]] = step
    return wide


def bands(signal, mixed, floor):
    """Slivers of less than 2 pixels: (at, A (n,), base (n, C), peak (n, C), no step), A = width times contrast."""
    parts = []
    for axis in (1, 0):
        r = Reads(signal, mixed, axis)
        d = {k: r[k] - (r[-2] * (2 - k) + r[2] * (2 + k)) / 4 for k in (-1, 0, 1)}
        e = d[-1] + d[0] + d[1]
        area = _norm(e)
        safe = np.where(area > 0, area, 1)
        parts.append((r, {k: (d[k] * e).sum(-1) / safe for k in d}, e, area))
    prefer = [_sum3(turn(axis, part[3])) for axis, part in zip((1, 0), parts, strict=True)]
    across = prefer[0] >= prefer[1]
    found = []
    for axis, (r, c, e, area) in zip((1, 0), parts, strict=True):
        on = turn(axis, across if axis else ~across) & r.all_open() & (area > floor)
        on &= (c[0] > c[-1]) & (c[0] >= c[1]) & (area <= 2.05 * c[0])
        on &= (np.minimum(c[-1], c[1]) > -0.1 * area) & (c[0] > 1.5 * _norm(r[2] - r[-2]))
        offset = (c[1][on] - c[-1][on]) / area[on]
        place = np.argwhere(on) + np.stack([0 * offset, offset], 1)
        base = (r[-2][on] + r[2][on]) / 2
        found.append((place if axis else place[:, ::-1], area[on], base, base + e[on], np.zeros((len(place), 6))))
    return [np.concatenate(part) for part in zip(*found, strict=True)]


# Light: cracks where the light crosses a threshold


def evened(x, noise=0.035):
    """Light (H, W) without its noise: three passes of a 3×3 mean, 1, 2 and 4 pixels apart, of what is alike."""
    for apart in (1, 2, 4):
        sharp = 1 / (noise * np.maximum(x, 0.02)) ** 2
        total, weights = np.zeros_like(x), np.full_like(x, 4)
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                off = grid.read(x, apart * dy, apart * dx) - x
                weight = (2 - abs(dy * dx)) * clamp01(1 - off**2 * sharp) ** 2 * (dy != 0 or dx != 0)
                total, weights = total + weight * off, weights + weight
        x = x + total / weights
    return x


def level_of(x, steps):
    """Which level the light x is on, the thresholds being hard."""
    return np.searchsorted([step[1] for step in steps[1:]], x, side="left")


def grey_of(level, steps):
    grey = metric.encode(np.array([step[0] for step in steps]))[level]
    return np.repeat(np.asarray(grey)[..., None], 3, -1)


def light_cracks(x, steps):
    """(first level, last level, t), each (h, w - 1) along rows; halfway between the first and last threshold."""
    p, q = x[:, :-1], x[:, 1:]
    one, two = level_of(p, steps), level_of(q, steps)
    thresholds = np.array([step[1] for step in steps[1:]] or [0.0])
    low, high = np.minimum(one, two), np.maximum(one, two)
    middle = (thresholds[np.minimum(low, len(thresholds) - 1)] + thresholds[np.maximum(high - 1, 0)]) / 2
    gap = np.where(p == q, 1, q - p)
    return one, two, clamp01((middle - p) / gap)
