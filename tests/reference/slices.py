# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's thin things, up to three pixels wide: slices across them in the averaged layers, and what those in a row have
in common. Places are (across, along): an axis of 0 runs along a row of pixels, 1 along a column."""

from dataclasses import dataclass, field

import numpy as np

from .metric import clamp01, mix

TIE = 1e-4


def halfway(middle):
    """Whether it lies between two pixels as far as rounding goes."""
    return abs(middle % 1 - 0.5) < TIE


def ramp(x, low, high):
    return float(clamp01((x - low) / (high - low)))


@dataclass
class Slice:
    first: int
    ground: float
    area: float = 0.0
    peak: float = 0.0
    middle: float = 0.0
    low: float = 0.0
    high: float = np.inf
    stands: np.ndarray = field(default_factory=lambda: np.zeros(6))
    hits: int = 0
    trust: float = 0.0


@dataclass
class Thing:
    """What slices in a row have in common."""
    slices: list
    steps: int
    ends: list
    unsure: bool = False  # rounding decides which pixel a middle lies in

    @property
    def hits(self):
        return sum(s.hits for s in self.slices)

    @property
    def half(self):
        """Half the width along the axis: by the areas, within what pixel centres allow."""
        low, high = max(s.low for s in self.slices), min(s.high for s in self.slices)
        half = 0.5 * sum(s.area for s in self.slices) / (len(self.slices) * max(s.peak for s in self.slices))
        return (low + high) / 2 if low > high else min(max(half, low), high)

    @property
    def square(self):
        """Pixels across in one along the axis."""
        slope = (self.ends[1] - self.ends[0]) / self.steps if self.steps else 0
        return 1 / np.sqrt(1 + slope**2)


class Things:
    """Slices of one picture; cracks: (2, H, W), to the right and down."""

    def __init__(self, layers, cracks):
        self.layers, self.cracks = layers, cracks
        self.value = np.concatenate([clamp01(layers.albedo), layers.normal / 2], -1)
        z = layers.depth
        self.near = -np.minimum(z, 1e9) if layers.orthographic else 1 / z
        self.shape = z.shape

    def _line(self, image, axis, across):
        return image[:, across] if axis else image[across]

    def between(self, axis, across, first, count):
        """The slice of `count` pixels from `first` on; None where there is no stripe before one ground."""
        size, other = self.shape if axis else self.shape[::-1]
        if first < 0 or first + count > size or not 0 <= across < other:
            return None
        span = slice(first, first + count)
        near, value, object_ = (self._line(a, axis, across)[span] for a in (self.near, self.value, self.layers.object))
        if object_[0] != object_[-1]:
            return None
        s = Slice(first, object_[0])
        inner = np.arange(1, count - 1)
        rise = value[-1] - value[0]
        out = value[1:-1] - value[0] - rise * (inner / (count - 1))[:, None]
        s.stands = out.sum(0)
        s.area = float(np.linalg.norm(s.stands))
        own = out @ s.stands / s.area if s.area > 0 else np.zeros(len(inner))
        s.peak = max(0.0, own.max())
        s.middle = first + (own @ inner / s.area if s.area > 0 else 0)
        slope = np.linalg.norm(rise)
        if not s.area > 0:
            return None
        s.trust = min(ramp(s.peak, 0.05, 0.075), ramp(-s.area, -4.4 * s.peak, -3.8 * s.peak) if s.peak > 0 else 0,
                      ramp(min(0.0, own.min()), -0.2 * s.area, -0.1 * s.area),
                      ramp(s.peak, 1.2 * slope, 1.5 * slope) if slope > 0 else 1.0)
        if not s.trust > 0:
            return None
        behind = max(near[0], near[-1])
        least = 0.01 * (self.layers.height if self.layers.orthographic else near)
        hit = near - behind > least
        apart = np.abs(first + np.arange(count) - s.middle)
        s.low, s.high = apart[hit].max(initial=0), apart[~hit].min(initial=np.inf)
        s.hits = int(hit.sum())
        if s.hits:
            at = np.flatnonzero(hit)
            jump = abs(near[0] - near[-1])
            if at[-1] - at[0] + 1 != s.hits or s.hits > 4 or jump > 0.5 * (near[hit].max() - behind):
                return None
        return s if s.hits or (object_ == object_[0]).all() else None  # a centre is covered, however little that is

    def cracked(self, axis, across, at):
        return self._line(self.cracks[axis], axis, across)[at]

    def over(self, axis, across, at):
        """The slice about the pixels between two cracks, and two more on each side."""
        first = last = at
        size, other = self.shape if axis else self.shape[::-1]
        if not (0 <= at < size and 0 <= across < other):
            return None
        while first > 0 and last - first < 4 and not self.cracked(axis, across, first - 1):
            first -= 1
        while last + 1 < size and last - first < 4 and not self.cracked(axis, across, last):
            last += 1
        if last - first >= 4 or first == 0 or last + 1 == size:
            return None
        s = self.between(axis, across, first - 2, last - first + 5)
        return s if s is not None and s.hits == last - first + 1 else None

    def about(self, axis, across, at):
        """The slice about a pixel, as narrow as it can be."""
        if (s := self.over(axis, across, at)) is not None:
            return s
        s = self.between(axis, across, at - 2, 5)
        return s if s is not None and s.area <= 2.05 * s.peak else self.between(axis, across, at - 3, 7)

    def along(self, axis, across, own):
        """The slices on both sides that are of the same thing: six if it covers a pixel's centre, else up to sixteen
        to find one that it covers."""
        thing = Thing([own], 0, [own.middle, own.middle])
        for end, way in enumerate((-1, 1)):
            middle, k = own.middle, 0
            while (k := k + 1) <= (6 if thing.hits else 16):
                thing.unsure |= halfway(middle)
                to, at = across + way * k, int(np.floor(middle + 0.5))
                s = self.about(axis, to, at)
                if s is None or abs(s.middle - middle) > 1.5 or abs(s.hits - own.hits) > 1 or (
                        not s.stands @ own.stands > 0.5 * s.area * own.area or s.ground != own.ground):
                    break
                thing.slices.append(s)
                thing.steps += 1
                middle = s.middle
            thing.ends[end] = middle
        return thing

    def spans(self):
        """(H, spans of 16 pixels) where a thing covers a centre: 1 of another object, 2 of another depth."""
        height, width = self.shape
        found = np.zeros((height, (width - 1) // 16 + 1), int)
        right, down = self.cracks
        mixed = right | down
        mixed[:, 1:] |= right[:, :-1]
        mixed[1:] |= down[:-1]
        for y, x in np.argwhere(mixed):
            s = self.over(0, y, x) or self.over(1, x, y)
            if s is not None:
                found[y, x // 16] |= 2 if s.ground == self.layers.object[y, x] else 1
        return found

    def place(self, axis, x, y, was):
        """(share of the way to the next pixel, thin, half, inside, whether rounding decides) of a crack that lay at the
        share `was`; None if it bounds no thin thing."""
        z = self.layers.depth
        zp, zq = z[y, x], z[y + axis, x + 1 - axis]
        ahead = int(zq < zp)
        across, at = (x, y) if axis else (y, x)
        own = self.over(axis, across, at + ahead) if zp != zq else None
        if own is None:
            return None
        thing = self.along(axis, across, own)
        half = thing.half
        thin = min(own.trust, ramp(-2 * half * thing.square, -3.9, -3.3), ramp(thing.steps, 1, 3))
        share = mix(was, clamp01(own.middle + (-half if ahead else half) - at), thin)
        return share, thin, half * thing.square, own.middle - at - share, thing.unsure

    def _lies(self, axis, x, y):
        """The slice of a thing that covers no centre here, but lies in this pixel."""
        at = y if axis else x
        s = self.about(axis, x if axis else y, at)
        inside = s is not None and s.hits == 0 and abs(s.middle - at) < 0.5 + TIE and s.area <= 2.05 * s.peak
        return s if inside else None

    def pieces(self):
        """(x, y, axis, place along the axis, half, what it parts: 1 objects, 2 depths, whether rounding decides) of
        things between centres."""
        height, width = self.shape
        spans = self.spans()
        for y in range(height):
            near = np.bitwise_or.reduce(spans[max(0, y - 16):y + 17], 0)
            for x in range(width):
                hits = int(np.bitwise_or.reduce(near[max(0, x // 16 - 1):x // 16 + 2]))
                if not hits:
                    continue
                row, column = self._lies(0, x, y), self._lies(1, x, y)
                if row is None and column is None:
                    continue
                unsure = any(s is not None and halfway(s.middle) for s in (row, column))
                axis = int(column is not None and (row is None or column.area < row.area))
                own = column if axis else row
                thing = self.along(axis, x if axis else y, own)
                if thing.hits and thing.steps >= 3:
                    yield x, y, axis, own.middle, thing.half * thing.square, hits, unsure or thing.unsure
