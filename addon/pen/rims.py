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
    rim = np.zeros(number.shape, bool)
    for apart, one, other in ((number[:, 1:] != number[:, :-1], rim[:, 1:], rim[:, :-1]),
                              (number[1:] != number[:-1], rim[1:], rim[:-1])):
        one |= apart
        other |= apart
    rim[[0, -1]] = rim[:, [0, -1]] = False
    rim &= number > 0
    at = np.flatnonzero(rim)
    flat, every = number.reshape(-1), light.reshape(-1, light.shape[2])
    own, level = flat[at], every.max(1)
    low, high = np.full(at.size, np.inf, np.float32), np.full(at.size, -np.inf, np.float32)
    for y, x in _STEPS:
        beside = at + y * number.shape[1] + x
        value, same = level[beside], flat[beside] == own
        np.minimum(low, value, out=low, where=same)
        np.maximum(high, value, out=high, where=same)
    value = level[at]
    held = np.clip(value, low, high)
    changed = (low <= high) & (held != value) & (value > 0)
    every[at[changed]] *= (held[changed] / value[changed])[:, None]
    return light
