# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns in pictures of the world: what is small and bright enough to throw shadows becomes a lamp, and leaves the
picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .colour import LUMINANCE

_WIDE = 512    # columns of a picture that is searched: a sun of half a degree is one of them
_CELL = 8      # of these, side by side, whose mean tells the brightest place: no single texel is one
_MOST = 4
_LEAST = 0.15  # of all light that falls on what faces it: what gives less throws no shadow that is seen
_CONTRAST = 4.0  # times as bright as the sky around it, at least: a bright horizon is none
_RADII = (4.0, 10.0, 25.0)  # degrees within which all of it lies
_AROUND = 1.6  # times that: the sky around it
_ROUNDS = 3


@dataclass
class Sun:
    """direction (3,): where it is seen, of length 1; color (3,): W/m2 that fall on what faces it; width: the angle that
    it fills, radians."""

    direction: np.ndarray
    color: np.ndarray
    width: float

    def __mul__(self, factor: float) -> Sun:
        return Sun(self.direction, self.color * factor, self.width)


def ways(height: int, width: int) -> np.ndarray:
    """(height, width, 3) of length 1: what texels of an equirectangular picture show, row 0 at the top, whose middle is
    seen towards +x and its upper edge towards +z."""
    rise = np.pi * (0.5 - (np.arange(height) + 0.5) / height)[:, None]
    turn = np.pi - 2 * np.pi * (np.arange(width) + 0.5) / width
    level = np.cos(rise)
    return np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(rise) + 0 * turn], -1)


def angles(height: int, width: int) -> np.ndarray:
    """(height, 1): the solid angle of each texel of a row, steradians."""
    edges = np.sin(np.pi * (0.5 - np.arange(height + 1) / height))
    return ((edges[:-1] - edges[1:]) * 2 * np.pi / width)[:, None]


def shrunk(picture: np.ndarray, rows: int) -> np.ndarray:
    """Averages of blocks, so that about so many rows are left; what does not fill a block goes."""
    step = max(1, len(picture) // rows)
    high, wide = len(picture) // step, picture.shape[1] // step
    return picture[:high * step, :wide * step].reshape(high, step, wide, step, -1).mean((1, 3))


def parted(picture: np.ndarray) -> tuple[np.ndarray, list[Sun]]:
    """(what is left of it, the brightest first) of an equirectangular picture (height, width, 3), which is smaller
    where that has more than 512 columns."""
    left = np.nan_to_num(shrunk(picture[..., :3].astype(np.float64), _WIDE // 2), posinf=0, neginf=0)
    height, width = left.shape[:2]
    found: list[Sun] = []
    if height < _CELL or width < _CELL:
        return left, found
    way, angle = ways(height, width), angles(height, width)
    while len(found) < _MOST:
        sun, within, around = _brightest(left, way, angle)
        if sun is None:
            break
        found.append(sun)
        left[within] = np.minimum(left[within], around)
    return left, found


def _brightest(picture, way, angle):
    """(Sun, where it is, the sky's color around it); None: nothing there is one."""
    bright = np.maximum(picture @ LUMINANCE, 0)
    none = None, None, None
    cells = shrunk(bright[..., None], len(bright) // _CELL)[..., 0]
    if not cells.max() > 0:
        return none
    step = len(bright) // len(cells)
    row, column = (step * k for k in np.unravel_index(np.argmax(cells), cells.shape))
    cell = bright[row:row + step, column:column + step]
    y, x = np.unravel_index(np.argmax(cell), cell.shape)
    best = [_within(picture, way, angle, way[row + y, column + x], radius) for radius in _RADII]
    most = max(one[0] for one in best)
    energy, within, around, middle, more = next(one for one in best if one[0] >= 0.8 * most)
    falls = float(np.sum(bright * angle * np.maximum(way @ middle, 0)))
    if not energy > _LEAST * falls:
        return none
    weight, size = more @ LUMINANCE, np.broadcast_to(angle, within.shape)[within]
    fills = energy ** 2 / float(np.sum(weight ** 2 / size))  # of one that is as bright all over
    if not energy > _CONTRAST * fills * float(around @ LUMINANCE):
        return none
    width = 2 * math.acos(1 - min(fills / (2 * math.pi), 1.0))
    return Sun(middle, more.sum(0), width), within, around


def _within(picture, way, angle, middle, radius):
    """(light, where, the color around, its middle, colors times solid angles above that) of what is brighter than the
    sky around it, within degrees of a place and then of its own middle."""
    for _ in range(_ROUNDS):
        apart = way @ middle
        within = apart > math.cos(math.radians(radius))
        ring = ~within & (apart > math.cos(math.radians(_AROUND * radius)))
        share = angle * ring
        around = np.einsum("yx,yxc->c", share, picture) / max(share.sum(), 1e-30)
        more = np.maximum(picture[within] - around, 0) * np.broadcast_to(angle, within.shape)[within][:, None]
        weight = more @ LUMINANCE
        moved = weight @ way[within]
        if not np.linalg.norm(moved) > 0:
            break
        middle = moved / np.linalg.norm(moved)
    return float(weight.sum()), within, around, middle, more
