# SPDX-License-Identifier: GPL-3.0-or-later
"""Print: the picture parted into a few inks, each a screen of dots, one over the other on paper."""

import functools

import numpy as np

from .metric import clamp01, mix

STEPS = 32
FOUR = np.array([(0.02, 0.40, 0.78), (0.80, 0.03, 0.25), (1.00, 0.84, 0.03), (0.02, 0.02, 0.025)])
ANGLES = {"FOUR": (15, 75, 0, 45), "TWO": (45, 75)}
LUMINANCE = np.array((0.2126, 0.7152, 0.0722))


def _wave(u):
    """1 at whole numbers, -1 half-way, of two parabolas; and how fast it changes."""
    far = np.abs(u - np.round(u))
    near = np.where(far < 0.25, far, 0.5 - far)
    return np.where(far < 0.25, 1 - 16 * near**2, 16 * near**2 - 1), 32 * near


@functools.cache
def _levels():
    """Of half the sum of two waves: above which level so many shares of the paper lie."""
    wave = _wave((np.arange(20000) + 0.5) / 20000)[0]

    def above(level):
        rest = 2 * level - wave  # the other wave must be above this
        return np.mean(np.where(rest >= 0, 0.5 * np.sqrt(np.maximum(1 - rest, 0)),
                                1 - 0.5 * np.sqrt(np.maximum(1 + rest, 0))))

    def found(share):
        low, high = -1.0, 1.0
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (low, middle) if above(middle) < share else (middle, high)
        return low

    return np.array([1.0, *(found(k / STEPS) for k in range(1, STEPS)), -1.0])


def _passes(share, own):
    return np.maximum(1 - share * (1 - own), 1e-3)


def _parted(light, black):
    """Shares (4, …) of the paper for cyan, magenta, yellow and black."""
    key = black * (1 - light.max(-1)) ** 2
    left = [np.minimum(light[..., c] / _passes(key, FOUR[3, c]), 1) for c in range(3)]
    share = [1 - part for part in left]
    for _ in range(2):
        for c in range(3):
            d, e = (c + 1) % 3, (c + 2) % 3
            rest = left[c] / (_passes(share[d], FOUR[d, c]) * _passes(share[e], FOUR[e, c]))
            share[c] = clamp01((1 - rest) / max(1 - FOUR[c, c], 0.01))
    return [*share, key]


def _one(layers, table, pixels, surface):
    """By one table of parameters: the picture, and where rounding decides. pixels: in one unit of length."""
    rows, columns = layers.depth.shape
    pitch = max(table["print_pitch"] * pixels, 2)
    alpha = surface[..., 3:]
    light = clamp01(surface[..., :3] / np.where(alpha > 0, np.maximum(alpha, 1e-6), np.inf))
    if table["print_inks"] == "FOUR":
        own, shares = FOUR, _parted(light, table["print_black"])
    else:
        seen = np.sqrt(light @ LUMINANCE)
        own = np.clip([table["print_dark"], table["print_light"]], 0, 1)
        shares = [clamp01((0.55 - seen) * 2), clamp01((0.9 - seen) * 2.5)]
    y, x = np.mgrid[layers.y:layers.y + rows, layers.x:layers.x + columns] + 0.5
    back, doubtful, least = np.ones((rows, columns, 3)) * table["print_paper"], np.zeros((rows, columns), bool), \
        table["print_least"]
    for ink, share, angle in zip(own, shares, ANGLES[table["print_inks"]], strict=False):
        turn = np.radians(angle)
        (one, rise), (other, fall) = (_wave(a / pitch) for a in (
            x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)))
        steep = np.maximum(0.5 * np.hypot(rise, fall), 1) / pitch
        at = clamp01(share) * STEPS
        k = np.minimum(at.astype(int), STEPS - 1)
        level = mix(_levels()[k], _levels()[k + 1], at - k)
        cover = clamp01(0.5 + ((one + other) / 2 - level) / steep)
        cover = np.where(share <= least, 0, np.where(share >= 1 - least, 1, cover))
        for step in (least, 1 - least):
            doubtful |= (np.abs(share - step) < 1e-5) & (share != step)
        back = back * (1 - cover[..., None] * (1 - ink))
    return np.concatenate([back * alpha, alpha], -1), doubtful


def fill(layers, params, surface):
    """The surface (H, W, 4) as it is printed; and where float32 may be on the other side of a least dot."""
    out, doubtful = surface, np.zeros(layers.depth.shape, bool)
    for k, table in enumerate(params.tables):
        own = (layers.style == k) & bool(table["use_print"])
        if own.any():
            printed, unsure = _one(layers, table, params.pixels(layers.full_height), surface)
            out, doubtful = np.where(own[..., None], printed, out), doubtful | (own & unsure)
    return out, doubtful
