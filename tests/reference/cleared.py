# SPDX-License-Identifier: GPL-3.0-or-later
"""What tones leave clear of fine things, and where a screen has no room."""

import numpy as np

from .metric import clamp01

LEAST, SURE, ALIKE, SAME_DEPTH = 0.3 * 255, 0.34 * 255, 0.08 * 255, 0.005
NARROW, WIDE, BESIDE = 0.7, 1.4, 2
ROOM, NO_ROOM, BESIDE_INK = range(3)


def _sure(contrast):
    return clamp01((contrast - LEAST) / (SURE - LEAST))


def _shifted(values, dy, dx):
    """Beyond the frame its outermost pixels go on."""
    y, x = (np.clip(np.arange(n) + d, 0, n - 1) for n, d in zip(values.shape, (dy, dx), strict=True))
    return values[y][:, x]


def _about(values, reach, best, axes=(0, 1)):
    for axis in axes:
        values = best([_shifted(values, *((k, 0) if axis == 0 else (0, k))) for k in range(-reach, reach + 1)], axis=0)
    return values


def _places(reach):
    return [(v, u) for v in range(-reach, reach + 1) for u in range(-reach, reach + 1)]


def _fine(value, reach, sign):
    """(By how much light things, for sign −1 dark ones, that are short along the row or the column differ from what
    they lie on; where squares are taken away)."""
    light = sign * value

    def opened(axes):
        return _about(_about(light, reach, np.min, axes), reach, np.max, axes)

    thin = light - np.minimum(opened((0,)), opened((1,)))
    fine = thin > LEAST
    for v, u in _places(1):
        fine &= ~((_shifted(light, v, u) - light > -ALIKE) & (_shifted(thin, v, u) < 0.5 * LEAST))
    return np.where(fine, thin, 0), light - opened((0, 1))


def kept(layers, params):
    """Shares of the tones, and of solid ink, that are left at each pixel."""
    size = params["tone_detail"]
    if not size > 0:
        return np.ones((2, *layers.depth.shape))
    reach = max(1, int(min(0.5 * size * params.pixels(layers.full_height), 32)))
    value = np.floor(255 * np.sqrt(clamp01(layers.albedo @ (0.2126, 0.7152, 0.0722))) + 0.5)
    inside = np.pad(np.ones(value.shape, bool), reach + 1)
    height, width = value.shape
    depth = np.where(layers.there, layers.depth, 1e30)
    thin, square = _fine(value, reach, 1)
    dark, _ = _fine(value, reach, -1)

    def there(v, u):
        own = inside[reach + 1 + v:, reach + 1 + u:][:height, :width]
        return own & layers.there & (np.abs(_shifted(depth, v, u) - depth) <= SAME_DEPTH * depth)

    lies = np.zeros(value.shape, bool)
    for v, u in _places(reach + 1):
        lies |= (value - _shifted(value, v, u) > LEAST) & there(v, u)
    most = _about(square, 1, np.max)
    clear = np.where(lies & (square > 0), _sure(_about(thin, reach + 2, np.max)) * _sure(most)
                     * clamp01(2 * square / np.maximum(most, 1) - 0.9), 0)
    found = []
    for far in (reach, 0.5 * reach):
        about = clear
        for v, u in _places(reach):
            contrast = np.minimum(_shifted(dark, v, u), value - _shifted(value, v, u))
            about = np.maximum(about, np.where((contrast > LEAST) & there(v, u),
                                               _sure(contrast) * clamp01(far + 0.5 - np.hypot(v, u)), 0))
        found.append(about)
    return np.floor(255 * (1 - np.stack(found)) + 0.5) / 255


def _near(sought, radius):
    """Whether any of what is sought is so near; `radius` by pixel."""
    most = int(radius.max())
    wide, found = np.pad(sought, most), np.zeros(sought.shape, bool)
    height, width = sought.shape
    for v, u in _places(most):
        found |= (v * v + u * u <= radius * radius) & wide[most + v:, most + u:][:height, :width]
    return found


def rooms(screens, solid, keep, radius):
    """What screens have at each pixel; `radius`: half of how wide they are at least."""
    apart = (solid > 0.5) | (keep < 0.5)
    screen = ~apart & (screens > 0.5)
    core = screen & ~_near(~screen, NARROW * radius)
    wide = core & ~_near(~screen, WIDE * radius)
    maybe = screen & _near(core, NARROW * radius)
    joined = maybe & wide
    while True:
        grown = joined.copy()
        for (to, of) in ((np.s_[1:], np.s_[:-1]), (np.s_[:-1], np.s_[1:])):
            grown[to] |= joined[of]
            grown[:, to] |= joined[:, of]
        grown &= maybe
        if (grown == joined).all():
            break
        joined = grown
    light = ~apart & ~screen
    return np.where(screen & ~joined, np.where(_near(light, BESIDE * radius), NO_ROOM, BESIDE_INK), ROOM)
