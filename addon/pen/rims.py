# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light at the rims of things. What a thing shows at its rim is seen by pixels whose centres it just covers, and
where it turns away the light changes most: a sliver far narrower than a pixel, of which one centre in five hits a part.
Cut into levels that is a row of single pixels in another tone than all about them. There no pixel is brighter, or
darker, than all of the same thing about it: it comes down, or up, to the nearest of those."""

import numpy as np

_STEPS = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if y or x]


def hold(light: np.ndarray, thing: np.ndarray) -> np.ndarray:
    """Changes light (height, width, 3) in place, and returns it. thing: (height, width, 1), numbers of objects, 0 for
    none. What lies at the frame's border, and what is one pixel of its thing alone, stays."""
    number = thing[..., 0]
    right, down = number[1:-1, 1:] != number[1:-1, :-1], number[1:, 1:-1] != number[:-1, 1:-1]
    rim = right[:, 1:] | right[:, :-1]
    rim |= down[1:]
    rim |= down[:-1]
    flat, every, width = number.reshape(-1), light.reshape(-1, light.shape[2]), number.shape[1]
    row, column = np.divmod(np.flatnonzero(rim), max(1, rim.shape[1]))
    at = (row + 1) * width + column + 1
    at = at[flat[at] > 0]
    value = _level(every, at)
    low, high = np.full(at.size, np.inf, np.float32), np.full(at.size, -np.inf, np.float32)
    for y, x in _STEPS:
        beside = at + y * width + x
        level, same = _level(every, beside), flat[beside] == flat[at]
        np.minimum(low, level, out=low, where=same)
        np.maximum(high, level, out=high, where=same)
        alone = ~((low <= value) & (value <= high))  # few are: the rest is not looked at again
        at, value, low, high = at[alone], value[alone], low[alone], high[alone]
    held = np.clip(value, low, high)
    changed = (low <= high) & (value > 0)
    every[at[changed]] *= (held[changed] / value[changed])[:, None]
    return light


def _level(every, at):
    red, green, blue = every.take(at, axis=0).T
    return np.maximum(np.maximum(red, green), blue)
