# SPDX-License-Identifier: GPL-3.0-or-later
"""Crumbs of ink and light, which become what is around them."""

import numpy as np

from .specks import _about, _island

CONTRAST, BEHIND, BEFORE, BRIGHTEST, LONGEST = 0.22, 0.001, 0.005, 4, 4
OTHER, LIGHT, INK = range(3)


def _features(layers, rows, columns, around, kind):
    colors = np.cbrt(np.clip(layers.albedo, 0, 1))
    own, beside = colors[rows, columns], np.array([colors[at] for at in around])
    if kind == INK:
        return (beside.max(0) - own.min(0)).max() > CONTRAST
    ground = np.mean([layers.depth[at] for at in around])
    far = layers.depth[rows, columns].mean() - ground
    return (own.max(0) - beside.min(0)).max() > CONTRAST and -BEFORE * ground <= far <= BEHIND * ground


def settled(layers, light, kinds, ends, size, spotted):
    """(light, spotted) without crumbs; kinds: by pixel, of the above; ends: the light with which what is no ink
    begins."""
    light, kinds, spotted = light.copy(), kinds.copy(), None if spotted is None else spotted.copy()
    for kind in (LIGHT, INK):
        left = kinds == kind
        same = left.copy()
        for start in map(tuple, np.argwhere(left)):
            if not left[start]:
                continue
            island, cut = _island(same, start, layers)
            rows, columns = np.array(island).T
            left[rows, columns] = False
            around = [at for y, x in island for at in _about(same, y, x) if not same[at]]
            far = max(np.ptp(rows), np.ptp(columns)) + 1
            if cut or not around or len(island) > size**2 or far > LONGEST * size:
                continue
            known = layers.there[rows, columns].all() and all(kinds[at] != OTHER for at in around)
            if not known or _features(layers, rows, columns, around, kind):
                continue
            mean = np.mean([np.clip(light[at], -1, BRIGHTEST) for at in around])
            kinds[rows, columns] = LIGHT + INK - kind
            light[rows, columns] = -1 if kind == LIGHT else np.maximum(mean, ends[rows, columns])
            if spotted is not None:
                spotted[rows, columns] = kind == LIGHT
    return light, spotted
