# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that lie along FINE's lines: where a site is in one, and what it leaves of the ink."""

from dataclasses import dataclass, replace

import numpy as np

from .example import scramble
from .metric import clamp01, mix
from .turns import beat


def pyramid(image):
    """Ink of a picture, and of those of half its size, down to one texel."""
    image = np.clip(np.nan_to_num(image, nan=0.0), 0, 1).astype(float)
    image = image[..., None] if image.ndim == 2 else image
    grey = image[..., :3] @ (0.2126, 0.7152, 0.0722) if image.shape[2] > 2 else image[..., 0]
    levels = [(1 - grey) * (image[..., 3] if image.shape[2] > 3 else 1)]
    while levels[-1].size > 1:
        ink = levels[-1]
        for axis in (0, 1):
            n = max(ink.shape[axis] // 2, 1)
            first = ink.take(2 * np.arange(n), axis)
            ink = (first + ink.take(np.minimum(2 * np.arange(n) + 1, ink.shape[axis] - 1), axis)) / 2
        levels.append(ink)
    return levels


def _texel(ink, u, v):
    high, wide = ink.shape
    x, y = (u % 1) * wide - 0.5, v * high - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    rows = np.maximum(top, 0), np.minimum(top + 1, high - 1)
    above, below = (mix(ink[row, left % wide], ink[row, (left + 1) % wide], x - left) for row in rows)
    return mix(above, below, y - top)


def _ink(levels, texels, u, v):
    """texels: of the first level to a pixel, by pixel."""
    number = np.clip(np.ceil(np.log2(np.maximum(texels, 1e-9))) - 1, 0, len(levels) - 1).astype(int)
    rest = np.where(number + 1 < len(levels), clamp01(texels / 2.0**number - 1), 0)
    out = np.zeros(u.shape)
    for k in np.unique(number):
        at = number == k
        out[at] = mix(_texel(levels[k], u[at], v[at]),
                      _texel(levels[min(k + 1, len(levels) - 1)], u[at], v[at]), rest[at])
    return out


@dataclass
class End:
    levels: list | None = None  # None: its pen has none
    left: float = 1.0
    at: float = 0.0
    born: float = 0.0
    length: float = 0.0
    octave: float = 0.0

    def finer(self):
        return replace(self, at=2 * self.at % 1, born=0.0, length=self.length / 2, octave=self.octave + 1)


def ends(t, hand, pictures):
    """By site, where it lies in the picture along its line; pictures: by pen and style number."""
    out = []
    for i in range(len(t)):
        pen = {"PEN_1": "pen_1", "PEN_2": "pen_2", "PEN_3": "pen_3"}[hand.whose[i]]
        levels = pictures.get((pen, int(hand.style[i])))
        amount = hand.at("strip")[i]
        if t.dropped[i] or not hand.drawn[i] or not amount > 0 or levels is None:
            out.append(End())
            continue
        length = np.sqrt(0.5) * hand.at("strip_length")[i] * hand.scale
        found = beat(t, hand, i, length)
        if not found:
            out.append(End(levels, 1 - amount))
            continue
        at, number, octave, times = found
        born = clamp01((times - 1 - 0.15 - 0.7 * (scramble(int(number) & 0xffffffff) >> 8) / 2**24) * 8 + 0.5)
        out.append(End(levels, 1 - amount, at, float(born), times * length, octave))
    return out


def _agreed(a, b):
    if a.length > 0 and b.length > 0:
        if a.octave + 1 == b.octave:
            a = a.finer()
        elif b.octave + 1 == a.octave:
            b = b.finer()
    return a, b, (b.at - a.at + 0.5) % 1 - 0.5


def _rate(a, b):
    if not (a.length > 0 and b.length > 0):
        return 0.0
    a, b, way = _agreed(a, b)
    return 0.0 if a.octave != b.octave else np.sign(way) / max((a.length + b.length) / 2, 1)


def left(one, two, beyond, way, link, px, py, s, half, across):
    """(what is left of the ink at (px, py) from the first end, where that may be otherwise); way: from the site before
    the link to the one after, whose ends are `beyond`."""
    length = np.hypot(*way)
    unit = way / length if length > 1e-6 else np.zeros(2)
    a, b, turn = _agreed(one, two)
    known, far = a.length > 0 and b.length > 0, unit @ link
    rate = _rate(*beyond) if length > 1e-6 else 0.0
    whole = max(a.length if a.length > 0 else b.length, 1)
    off = abs(turn) * whole - 3 * abs(far) - 1
    jumps = not known or a.octave != b.octave or off > 0
    doubt = np.full(px.shape, bool(known and abs(off) < 1e-3) or abs(abs(turn) - 0.5) < 1e-4)
    at = [a.at, b.at if jumps else a.at + turn]
    born = [a.born, b.born]
    if not known:
        other = a if a.length > 0 else b
        at, born = [other.at] * 2, [other.born] * 2
    along = unit[0] * px + unit[1] * py
    first, second = at[0] + rate * along, at[1] + rate * (along - far)
    share = (s > 0.5) if jumps else s
    if jumps:
        doubt |= abs(s - 0.5) < 1e-3
    u, born = mix(first, second, share), mix(born[0], born[1], share)
    levels = a.levels if a.levels is not None else b.levels
    texels, high = levels[0].shape[1] / whole, levels[0].shape[0] / np.maximum(2 * half, 1)
    ink = mix(_ink(levels, np.maximum(texels, high), u, across),
              _ink(levels, np.maximum(2 * texels, high), 2 * u, across), born)
    return mix(mix(a.left if a.levels is not None else 1, b.left if b.levels is not None else 1, s), 1, ink), doubt
