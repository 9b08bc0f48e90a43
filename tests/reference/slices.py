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
    width: float = 0.0
    trust: float = 0.0
    told: bool = False  # by the mesh alone


@dataclass
class Thing:
    """What slices in a row have in common."""
    slices: list
    steps: int
    ends: list
    held: int = 0  # ends at which something lies before it
    unsure: bool = False  # rounding decides which pixel a middle lies in

    @property
    def hits(self):
        return sum(s.hits for s in self.slices)

    @property
    def half(self):
        """Half the width along the axis: by contours, else by the areas, within what pixel centres allow."""
        if widths := [s.width for s in self.slices if s.width > 0]:
            return sum(widths) / len(widths) / 2
        low, high = max(s.low for s in self.slices), min(s.high for s in self.slices)
        seen = [s for s in self.slices if not s.told]
        half = 0.5 * sum(s.area for s in seen) / (len(seen) * max(s.peak for s in seen)) if seen else 0
        return (low + high) / 2 if low > high else min(max(half, low), high)

    @property
    def square(self):
        """Pixels across in one along the axis."""
        slope = (self.ends[1] - self.ends[0]) / self.steps if self.steps else 0
        return 1 / np.sqrt(1 + slope**2)


class Things:
    """Slices of one picture; cracks: (2, H, W), to the right and down; known, steps: likewise, of contours; meshes:
    whether the layer of creases is asked."""

    def __init__(self, layers, cracks, known, steps, meshes):
        self.layers, self.cracks, self.known, self.steps, self.meshes = layers, cracks, known, steps, meshes
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
        before, after = (max(0, -self._line(self.known[axis], axis, across)[k]) for k in (first - 1, last))
        told = before > 0 and after > 0
        s = self.between(axis, across, first - 2, last - first + 5)
        if s is None or s.hits != last - first + 1:
            s = self.raised(axis, across, first, last) if told else None
        if s is None:
            return None
        if told:  # the layer of marks says where its contours are
            s.width = last - first + 1 + after - before
            s.middle = first - 1 + before + s.width / 2
        return s

    def raised(self, axis, across, first, last):
        """The slice of what lies before one ground by however little, as a mesh tells both of its contours."""
        object_, near, steps = (self._line(a, axis, across) for a in (self.layers.object, self.near, self.steps[axis]))
        ground, own = object_[[first - 1, last + 1]], object_[[first, last]]
        if (ground != ground[0]).any() or (own != own[0]).any() or own[0] == ground[0]:
            return None
        before = near[first] + near[last] > near[first - 1] + near[last + 1]
        if not (before and steps[first - 1] > 0 and steps[last] > 0):
            return None
        return Slice(first, ground[0], hits=last - first + 1, trust=1.0, told=True)

    def told(self, axis, across, at):
        """What passes between the centres about a pixel and covers none, as the layer of marks says."""
        if not 0 <= across < (self.shape[1] if axis else self.shape[0]):
            return None
        places = self._line(self.layers.between[..., axis], axis, across)
        for first in (at, at - 1, at + 1, at - 2):
            if 0 <= first < len(places) - 1 and not np.isnan(place := places[first]):
                ground = self._line(self.layers.object, axis, across)[first]
                return Slice(first, ground, middle=first + place, high=min(place, 1 - place), trust=1.0, told=True)
        return None

    def about(self, axis, across, at):
        """The slice about a pixel, as narrow as it can be."""
        if (s := self.over(axis, across, at)) is not None or (s := self.told(axis, across, at)) is not None:
            return s
        s = self.between(axis, across, at - 2, 5)
        if s is not None and s.area <= 2.05 * s.peak:
            return s
        s, moved = self.between(axis, across, at - 3, 7), (at - 1, at + 1) if self.layers.marked else ()
        return next((s for s in (s, *(self.over(axis, across, to) for to in moved)) if s is not None), None)

    def covered(self, axis, across, at, ground):
        """Whether something else than the ground is at a pixel."""
        size, other = self.shape if axis else self.shape[::-1]
        return bool(0 <= at < size and 0 <= across < other
                    and self._line(self.layers.object, axis, across)[at] != ground)

    def along(self, axis, across, own):
        """The slices on both sides that are of the same thing: six if it covers a pixel's centre, else up to sixteen
        to find one that it covers."""
        thing = Thing([own], 0, [own.middle, own.middle])
        for end, way in enumerate((-1, 1)):
            middle, before, k = own.middle, 0, 0  # pixels of what lies before it, up to here
            while (k := k + 1) <= (6 if thing.hits else 16):
                thing.unsure |= halfway(middle)
                to, at = across + way * k, int(np.floor(middle + 0.5))
                s = self.about(axis, to, at)
                if s is None:
                    covered = own.told and self.covered(axis, to, at, own.ground)
                    before += covered
                    if not covered or before > 4:
                        break
                    continue
                if abs(s.middle - middle) > 1.5 * (1 + before) or abs(s.hits - own.hits) > 1:
                    break
                if not (s.told or own.told) and (not s.stands @ own.stands > 0.5 * s.area * own.area or
                                                 s.ground != own.ground):
                    break
                thing.slices.append(s)
                thing.steps += 1 + before
                middle, before = s.middle, 0
            thing.held += before > 0
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
        for y, x in np.argwhere((~np.isnan(self.layers.between)).any(-1)):
            found[y, x // 16] |= 2
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
        half = own.width / 2 if own.width > 0 else thing.half
        thin = min(own.trust, ramp(-2 * half * thing.square, -3.9, -3.3), ramp(thing.steps, 1, 3))
        told = self.known[axis][y, x] < 0
        share = was if told else mix(was, clamp01(own.middle + (-half if ahead else half) - at), thin)
        return share, thin, half * thing.square, own.middle - at - share, thing.unsure

    def _lies(self, axis, x, y):
        """The slice of a thing that covers no centre here, but lies in this pixel."""
        at = y if axis else x
        s = self.about(axis, x if axis else y, at)
        inside = s is not None and s.hits == 0 and abs(s.middle - at) < 0.5 + TIE and s.area <= 2.05 * s.peak
        return s if inside else None

    def is_face(self, axis, x, y):
        """Whether a mesh tells of an edge there: what stands out in the averages is a narrow face, and no wire."""
        across, at = (x, y) if axis else (y, x)
        edges = self._line(self.layers.creases[..., 2 * axis], axis, across)[:-1]
        return bool(self.meshes and self.layers.marked and (edges[max(0, at - 1):at + 2] > 0).any())

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
                both = row is not None and column is not None
                narrower = both and (column.area < row.area if row.told == column.told else row.told)
                axis = int(column is not None and (row is None or narrower))
                ways = [axis, 1 - axis] if both and (row.told or column.told) else [axis]
                for axis in ways:
                    own = column if axis else row
                    if not own.told and self.is_face(axis, x, y):
                        continue
                    thing = self.along(axis, x if axis else y, own)
                    unsure |= thing.unsure
                    told = sum(s.told for s in thing.slices)
                    if (thing.hits or thing.held == 2 or told >= 16) and thing.steps >= 3:
                        yield x, y, axis, own.middle, thing.half * thing.square, hits, unsure
                        break
