# SPDX-License-Identifier: GPL-3.0-or-later
"""Which blacks are spotted where only small ones on something light are."""

import numpy as np

from .cleared import _labels, _links, _shifted

LIGHT, DARK, BLACK, BLACKEST = range(4)
DARK_BELOW, PUPIL, NEARER, DARK_WIDEST, LONGEST, HOLLOW = 0.16, 0.25, 0.02, 2.5, 4, 0.08
BESIDE = (0, 1), (0, -1), (1, 0), (-1, 0)


def _away(inside):
    """Thirds of a pixel to where shapes end, by steps of 3 along rows and columns and 4 across."""
    away = np.where(inside, 65531, 0)
    while True:
        around, before = np.pad(away, 1, constant_values=65531), away
        for v in (-1, 0, 1):
            for u in (-1, 0, 1):
                there = around[1 + v:, 1 + u:][:away.shape[0], :away.shape[1]]
                away = np.minimum(away, there + (4 if v and u else 3 * (v != u)))
        away = np.where(inside, np.minimum(away, 65531), 0)
        if (away == before).all():
            return away


def _shapes(inside, depth):
    """(distance from the end, width, how far it goes from side to side or top to bottom, whether most of the outline is
    the shape's own) of the shape at each pixel."""
    labels, away = _labels(_links(lambda one, other: inside[one] & inside[other])), _away(inside)
    wide = np.zeros(labels.size)
    np.maximum.at(wide, labels.flat, away.flat)
    far = np.zeros(labels.size)
    for at in np.indices(labels.shape):
        first, last = np.full(labels.size, labels.size), np.zeros(labels.size)
        np.minimum.at(first, labels.flat, at.flat)
        np.maximum.at(last, labels.flat, at.flat)
        far = np.maximum(far, last - first + 1)
    ends, cut = np.zeros((2, labels.size))
    for v, u in BESIDE:
        end = inside & ~_shifted(inside, v, u)
        nearer = np.float32(_shifted(depth, v, u)) < np.float32(depth) * np.float32(1 - np.float32(NEARER))
        beyond = inside & (np.pad(np.ones(inside.shape, int), 1)[1 + v:, 1 + u:][
            :inside.shape[0], :inside.shape[1]] == 0)
        ends += np.bincount(labels.flat, (end | beyond).flat, labels.size)
        cut += np.bincount(labels.flat, (end & nearer | beyond).flat, labels.size)
    return away, (wide * 2 / 3)[labels], far[labels], (4 * cut < ends)[labels]


def spotted(layers, params, looking):
    """looking: of a style, how light colors look."""
    widest = params["tone_black_widest"] * params.pixels(layers.full_height)
    if not widest > 0:
        return np.ones(layers.depth.shape, bool)
    kind, depth = np.zeros(layers.depth.shape, int), np.where(layers.there, layers.depth, np.inf)
    for number, table in enumerate(params.tables):
        own, black = looking(table.__getitem__, layers.color), table["tone_black"] if table["use_tones"] else 0
        kind = np.where(layers.style == number, np.select([own < PUPIL * black, own < black], [BLACKEST, BLACK], DARK),
                        kind)
    dark = layers.albedo @ np.array([0.2126, 0.7152, 0.0722]) < DARK_BELOW
    kind = np.where(dark & layers.there, kind, LIGHT)
    _, wide, _, whole = _shapes(kind != LIGHT, depth)
    on_light, found = (wide <= DARK_WIDEST * widest) & whole, np.zeros(kind.shape, bool)
    for least in (BLACK, BLACKEST):
        away, wide, far, whole = _shapes(kind >= least, depth)
        over = (np.maximum(wide, far / LONGEST) / widest - 1) / HOLLOW
        rim = np.where(over <= 0, np.inf, 1.5 * widest * (1 - over))
        found |= (kind >= least) & on_light & whole & (away <= rim)
    return found

