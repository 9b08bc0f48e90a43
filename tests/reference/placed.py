# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's sites as they are found, before any owns its place: where a layer changes, to a fraction of a pixel."""

import numpy as np

from . import forms, metric
from .edges import SOURCES
from .metric import clamp01
from .passes import COLUMN, JUNCTION, ROW, passage
from .ridged import ridges, through
from .shade import metered, painted
from .slices import Things
from .view import SEEN, SURE, Place, along, level_of, levels_apart, turn

# Cracks


def _jump(view, axis):
    """(H, W - 1): what each side's straight continuation misses at the other, relative to the nearest."""
    layers = view.layers
    z, there = turn(axis, layers.depth), turn(axis, layers.there)
    safe = np.where(there, z, 1)
    u = np.where(there, -safe / layers.height, -np.inf) if layers.orthographic else np.where(there, 1 / safe, 0)
    found = np.zeros((u.shape[0], u.shape[1] - 1))
    if u.shape[1] < 4:
        return found
    four = np.stack([u[:, k:u.shape[1] - 3 + k] for k in range(4)])
    if layers.orthographic:  # nothing there lies a frame's height behind the farthest
        behind = np.where(np.isfinite(four), four, np.inf).min(0) - 1
        four = np.maximum(four, np.where(np.isfinite(behind), behind, 0))
    a, p, q, b = four
    left, right = q - 2 * p + a, p - 2 * q + b
    jump = np.maximum(0, np.maximum(np.minimum(left, -right), np.minimum(-left, right)))
    if not layers.orthographic:
        most = four.max(0)
        jump = np.where(most > 0, jump / np.where(most > 0, most, 1), 0)
    found[:, 1:-1] = jump
    return found


def _crossing(layers, axis):
    """(H, W - 1): the share of p's surface in p and q tells how far it reaches, where there is something to see; and
    how much of each other's both hold."""
    v = np.concatenate([turn(axis, clamp01(layers.albedo)), turn(axis, layers.normal) / 2], -1)
    p, q, a, b = v[:, :-1], v[:, 1:], along(v, -1)[:, :-1], along(v, 1)[:, 1:]
    a2, b2 = along(v, -2)[:, :-1], along(v, 2)[:, 1:]
    weight = 1 / (0.02**2 + (a - a2) ** 2 + (b2 - b) ** 2)
    seen = (weight * (a - b) ** 2).sum(-1)
    safe = np.where(seen > 0, seen, 1)
    first, second = (clamp01((weight * (x - b) * (a - b)).sum(-1) / safe) for x in (p, q))
    t = clamp01(first + second - 0.5)
    t = t - 0.06 * np.sin(2 * np.pi * t)
    known = seen > 0
    return (seen * t + 2) / (seen + 4), known * seen * (1 - first + second) / (seen + 4)


def _contact(view, axis, place, mixed):
    """(H, W - 1): the place where two surfaces touch, each followed from its own side by its depths; else `place`."""
    layers = view.layers
    number = turn(axis, layers.object)
    if "object" not in view.given or number.shape[1] < 4:
        return place
    z, there = turn(axis, layers.depth), turn(axis, layers.there)
    safe = np.where(there, z, 1)
    u = np.where(there, -safe / layers.height, -np.inf) if layers.orthographic else np.where(there, 1 / safe, 0)
    found, end = place.copy(), place.shape[1]
    for i, k in np.argwhere(number[:, 1:] != number[:, :-1]):
        if k < 1 or k + 2 > end or number[i, k - 1] != number[i, k] or number[i, k + 2] != number[i, k + 1]:
            continue
        a, p, q, b = u[i, k - 1:k + 3]
        if not np.isfinite(u[i, k - 1:k + 3]).all():
            continue
        at_p, at_q = p - 2 * q + b, q - 2 * p + a  # how far each lies before the other's plane
        bent_p = at_p - (q - 2 * b + u[i, k + 3] if k + 3 <= end and number[i, k + 3] == number[i, k + 1] else 0)
        bent_q = at_q - (p - 2 * a + u[i, k - 2] if k >= 2 and number[i, k - 2] == number[i, k] else 0)
        if not (np.isfinite(bent_p + bent_q) and at_p + at_q and bent_p + bent_q):
            continue
        straight, bent = at_p / (at_p + at_q), bent_p / (bent_p + bent_q)
        trust = clamp01((abs(bent_p + bent_q) / np.abs((a, p, q, b)).max() - 2e-5) / 2e-5)
        trust *= clamp01(2 - abs(straight - bent) / 0.125) * clamp01(2 - max(-bent, bent - 1, 0) / 0.05)
        bent = clamp01(bent)
        trust *= 1 - clamp01((mixed[i, k] - 0.05) / 0.1) * clamp01((abs(bent - place[i, k]) - 0.15) / 0.1)
        found[i, k] += trust * (bent - place[i, k])
    return found


def cracks(view):
    """{(family, row, column, axis): Place} of depth and indices, all that may be."""
    layers, found = view.layers, {}
    for axis in (ROW, COLUMN):
        height = _jump(view, axis)
        jump = clamp01((height - 0.003) / 0.007)
        cross = _contact(view, axis, *_crossing(layers, axis))
        there, object_, material = (turn(axis, a) for a in (layers.there, layers.object, layers.material))
        beside = np.zeros(jump.shape, bool)  # a side's slope would be read off another object
        beside[:, 1:-1] = (object_[:, :-3] != object_[:, 1:-2]) | (object_[:, 2:-1] != object_[:, 3:])
        ledge = beside & (object_[:, 1:] == object_[:, :-1])
        jump = np.where(ledge, clamp01((height - 0.013) / 0.007), jump)
        gone = there[:, 1:] != there[:, :-1]
        strengths = {"object": gone | (object_[:, 1:] != object_[:, :-1]),
                     "material": material[:, 1:] != material[:, :-1], "depth": jump}
        for i, k in np.argwhere(np.any([*strengths.values()], axis=0)):
            row, column = (k, i) if axis else (i, k)
            place = (column, row + cross[i, k]) if axis else (column + cross[i, k], row)
            strong = {SOURCES.index(name): float(s[i, k]) for name, s in strengths.items()}
            found["crack", row, column, axis] = view.weigh(place, "crack", column, row, axis, strong)
    return found


def on(found):
    return {key: site for key, site in found.items() if site.margin >= 0}


def crack_masks(view, found):
    """(2, H, W): cracks to the right and down."""
    marks = np.zeros((2, *view.shape), bool)
    for (family, row, column, axis), site in found.items():
        if family == "crack" and axis != JUNCTION and site.margin >= 0:
            marks[axis, row, column] = True
    return marks


def junctions(found, family, shape, layers=None):
    """Of the cracks on three or four sides of a square: their mean, with the strongest's strength. layers: where a
    thing goes on aslant there is none."""
    here = on(found)
    for row in range(shape[0] - 1):
        for column in range(shape[1] - 1):
            keys = [(family, row, column, ROW), (family, row + 1, column, ROW), (family, row, column, COLUMN),
                    (family, row, column + 1, COLUMN)]
            sides = [here[key] for key in keys if key in here]
            if len(sides) > 2 and not (layers and len(sides) == 4 and passage(layers, row, column)):
                first = max(sides, key=lambda s: s.strength)
                x, y = np.mean([(s.x, s.y) for s in sides], axis=0)
                strengths = sorted((s.strength for s in sides if s.source != first.source), reverse=True)
                close = bool(strengths) and abs(first.strength - strengths[0]) < 1e-4
                found[family, row, column, JUNCTION] = Place(
                    x, y, first.strength, first.source, float(all(s.margin for s in sides)), eased=first.eased,
                    doubtful=close)


def thin(view, found):
    """Places the cracks of thin things again, and finds what of them lies between pixel centres."""
    things = Things(view.layers, crack_masks(view, found))
    for (_, row, column, axis), site in on(found).items():
        placed = things.place(axis, column, row, site.y - row if axis else site.x - column)
        if placed:
            share, *site.thin, unsure = placed
            site.doubtful |= unsure
            site.x, site.y = (column, row + share) if axis else (column + share, row)
    for x, y, axis, at, half, hits, unsure in things.pieces():
        place = (x, at) if axis else (at, y)
        site = view.weigh(place, "thin", x, y, axis, {SOURCES.index("object"): float(bool(hits & 1)),
                                                      SOURCES.index("depth"): float(bool(hits & 2))})
        site.thin, site.doubtful = (1.0, half, 0.0), unsure
        found["thin", y, x, axis] = site


# Light: where it crosses a threshold between two pixels


def room(view, light, steps, k, site, axis, row, column):
    """Pixels from a place where light crosses threshold k to the line of a stronger one, at most 4."""
    def contrast(j):
        return view.difference(*(view.space(np.full(3, clamp01(steps[i][0]))) for i in (j - 1, j)))

    def at(x, y):
        """NaN beyond what the crack's first pixel shows, and beyond the picture."""
        height, width = light.shape
        if not (-0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5):
            return np.nan
        x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
        left, top = int(x), int(y)
        part = np.ix_([top, min(top + 1, height - 1)], [left, min(left + 1, width - 1)])
        if not view.layers.there[part].all() or (view.layers.object[part] != view.layers.object[row, column]).any():
            return np.nan
        a, b = x - left, y - top
        return np.array([1 - b, b]) @ light[part] @ np.array([1 - a, a])

    wide = np.pad(light, 1, mode="edge")[row:row + 4, column:column + 4]  # from a pixel before the first
    rise = light[row + axis, column + 1 - axis] - light[row, column]
    pair = wide[:, :3].T if axis else wide[:3]
    across = (pair[2, 1:3].sum() - pair[0, 1:3].sum()) / 4
    way = np.array([across, rise] if axis else [rise, across])
    slope, found = np.hypot(*way), 4.0
    for j in range(1, len(steps)):
        step = steps[j][1] - steps[k][1]
        if j == k or abs(step) >= 8 * slope or contrast(j) < contrast(k) or (contrast(j) == contrast(k) and j > k):
            continue
        sign = -1 if step < 0 else 1
        before = -sign * step
        for far in np.arange(0.5, found + 0.5, 0.5):
            after = sign * (at(*(np.array([site.x, site.y]) + sign * far * way / slope)) - steps[j][1])
            if np.isnan(after):
                break
            if after >= 0:
                found = min(found, far - 0.5 * after / max(after - before, 1e-20))
                break
            before = after
    return found


def light(view, cracked):
    """Crossings of light, but where a crack runs."""
    found, lit = {}, metered(view.layers, metric.value(view.layers.diffuse))
    style = view.layers.style
    steps = [table["shade_levels"] for table in view.params.tables]
    exposure = [table["shade_exposure"] for table in view.params.tables]
    paint = painted(view.layers)
    own = np.array([[level_of(lit[p] * exposure[style[p]] + paint[p], steps[style[p]])
                     for p in zip([y] * lit.shape[1], range(lit.shape[1]), strict=True)] for y in range(lit.shape[0])])
    gap = min(step[1] for table in steps for step in table[1:]) if any(len(t) > 1 for t in steps) else 1
    for axis in (ROW, COLUMN):
        level, light_, more = turn(axis, own), turn(axis, lit), turn(axis, paint)
        for i, k in np.argwhere(level[:, 1:] != level[:, :-1]):
            row, column = (k, i) if axis else (i, k)
            if not (view.layers.there[row, column] or view.layers.there[row + axis, column + 1 - axis]):
                continue
            near = view.near(*((column, row + 0.5) if axis else (column + 0.5, row)), column, row, "light", axis)
            s = style[near]
            one, two = (light_[i, at] * exposure[s] + more[i, at] for at in (k, k + 1))
            low, high = sorted((level_of(one, steps[s]), level_of(two, steps[s])))
            if low == high or cracked[axis, row, column]:
                continue
            threshold = (steps[s][low + 1][1] + steps[s][high][1]) / 2
            t = float(clamp01((threshold - one) / (two - one)))
            place = (column, row + t) if axis else (column + t, row)
            site = view.weigh(place, "light", column, row, axis,
                              {SOURCES.index("light"): view.contrast(levels_apart(view, steps[s], one, two))}, s)
            if high == low + 1:
                light = lit * exposure[s] + paint
                thinner = (4 - room(view, light, steps[s], high, site, axis, row, column)) / 2.5
                if abs(thinner - 1) < 0.01:
                    site.margin = 0.0
                elif thinner > 1:
                    continue
                site.eased = 255 * min(thinner, 1)
            every = [abs(x - step[1]) for x in (one, two) for step in steps[s][1:]]
            if min(every) < SURE * max(1, gap):
                site.margin = 0.0
            found["light", row, column, axis] = site
    return found


# All


def find(view):
    """{(family, row, column, axis): Place} of everything that may be a site."""
    found = cracks(view)
    cracked = crack_masks(view, found)
    light_ = light(view, cracked) if view.weights[SOURCES.index("light")].any() else {}
    thin(view, found)
    junctions(found, "crack", view.shape, view.layers)
    found |= forms.valleys(view, found)
    junctions(light_, "light", view.shape)
    mixed = cracked[ROW] | cracked[COLUMN]
    mixed[:, 1:] |= cracked[ROW][:, :-1]
    mixed[1:] |= cracked[COLUMN][:-1]
    seen = unsure = None
    if {"seen_color", "seen_normal"} <= view.given and view.weights[SEEN].any():
        seen, unsure = through(view)
    found |= light_ | ridges(view, mixed, seen)
    return found, {"through": seen, "through_unsure": unsure, "mixed": mixed}
