# SPDX-License-Identifier: GPL-3.0-or-later
"""Suggestive contours: valleys of how bright a smooth form is in the light of a lamp at the eye; how wide they are."""

import numpy as np

from .metric import clamp01
from .params import shortest
from .passes import COLOR, COLUMN, LIGHT, NUMBER, ROW, SEEN, px
from .view import SUGGESTIVE, SURE, turn

FLANK = 1.5  # of the blur's deviation


def _sigma(view):
    return float(np.clip(view.params["suggestive_size"] * view.params.pixels(view.layers.full_height), 1.5, 64))


def _cut(view, cracks):
    """(H, W), twice: pixels beside a crack; and that may be."""
    masks = np.zeros((2, *view.shape), bool)
    for (family, row, column, axis), site in cracks.items():
        far = row + (axis == COLUMN), column + (axis == ROW)
        if family == "crack" and axis in (ROW, COLUMN) and site.margin > -SURE and far[0] < view.shape[0] and (
                far[1] < view.shape[1]):
            for mask in masks[0 if site.margin > SURE and not site.doubtful else 1:]:
                mask[row, column] = mask[far] = True
    return masks


def _fitted(value, sigma):
    """The middle of lines that are fitted along the last axis; up to the first pixel of which nothing is known."""
    reach = int(2.5 * sigma) + 1
    padded = np.pad(value, [(0, 0), (reach, reach)], constant_values=np.nan)
    sums = np.zeros((5, *value.shape))
    for way in (-1, 1):
        known = ~np.isnan(value)
        for k in range(way > 0, reach + 1):  # the middle once
            v = padded[:, reach + way * k:][:, :value.shape[1]]
            known = known & ~np.isnan(v)
            v, x = np.where(known, v, 0), way * k
            sums += np.exp(-0.5 * (k / sigma)**2) * np.array([known, x * known, x * x * known, v, x * v])
    ones, first, second, total, tilted = sums
    spread = ones * second - first**2
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(spread > 0, (second * total - first * tilted) / spread, np.nan)


def _at(image, x, y):
    """Of the pixel that holds a place, beyond the border of the nearest."""
    (height, width), row, column = image.shape, int(np.floor(y + 0.5)), int(np.floor(x + 0.5))
    return image[min(max(row, 0), height - 1), min(max(column, 0), width - 1)]


def _between(image, x, y):
    left, top = int(np.floor(x)), int(np.floor(y))
    right, down = x - left, y - top
    return ((1 - down) * ((1 - right) * _at(image, left, top) + right * _at(image, left + 1, top)) +
            down * ((1 - right) * _at(image, left, top + 1) + right * _at(image, left + 1, top + 1)))


def _rise(soft, x, y, floor, way, sigma):
    """(how far light rises on one side, 0 where it can't be followed so far; whole pixels to where it can't)."""
    room = 0
    while room < 1.5 * FLANK * sigma and not np.isnan(_at(soft, x + (room + 1) * way[0], y + (room + 1) * way[1])):
        room += 1
    if room <= FLANK * sigma:
        return 0.0, room
    px, py = x + FLANK * sigma * way[0], y + FLANK * sigma * way[1]
    light = _between(soft, px, py)
    return (_at(soft, px, py) if np.isnan(light) else light) - floor, room


def _down_and_up(light, x, y, way, sigma):
    """(from one side down to the least and up to the other, how much more it goes in steps of a pixel)."""
    steps = range(-int(FLANK * sigma), int(FLANK * sigma) + 1)
    along = np.array([_between(light, x + k * way[0], y + k * way[1]) for k in steps])
    once = along[0] + along[-1] - 2 * along.min()
    return once, np.abs(np.diff(along)).sum() - once


def _weigh(light, soft, x, y, floor, way, sigma):
    """(S, the share of its width that the room beside it leaves)."""
    rises, rooms = zip(*(_rise(soft, x, y, floor, side * way, sigma) for side in (-1, 1)), strict=True)
    share = clamp01((min(rooms) - FLANK * sigma) / (0.5 * FLANK * sigma))
    if min(rises) <= 0:
        return 0.0, float(share)
    across, rough = _down_and_up(light, x, y, way, sigma)
    rough += _down_and_up(light, x, y, np.array([-way[1], way[0]]), sigma)[1]
    strength = clamp01(min(rises) / 0.08) * (clamp01((0.25 - rough / across) / 0.2) if across > 0 else 0.0)
    return float(strength), float(share)


def _valley(view, light, soft, row, column, sigma):
    """(axis, site) at a pixel, or None."""
    (a, b, c), (d, e, f), (g, h, i) = nine = [[_at(soft, column + k, row + j) for k in (-1, 0, 1)] for j in (-1, 0, 1)]
    if np.isnan(nine).any():
        return None
    slope = np.array([f - d, h - b]) / 2
    mixed = (i + a - c - g) / 4
    second = np.array([[d + f - 2 * e, mixed], [mixed, b + h - 2 * e]])
    bends, ways = np.linalg.eigh(second)
    bend, way = bends[1], ways[:, 1]
    least = bend * (FLANK * sigma)**2 - 0.005
    turned = 2e-7 / max(bend - bends[0], 1e-9)  # what rounding may turn it by, and move it and its flanks, in pixels
    loose = (2e-7 + turned * np.hypot(*slope)) / max(bend, 1e-9)
    far = loose + FLANK * sigma * turned
    if least < -1e-5:
        return None
    axis = ROW if abs(way[0]) >= abs(way[1]) else COLUMN
    offset = -slope @ way / (bend * way[axis])
    if abs(offset) > 0.5 + loose:
        return None
    floor = e + slope[axis] * offset + 0.5 * second[axis, axis] * offset**2
    x, y = column + (axis == ROW) * offset, row + (axis == COLUMN) * offset
    strength, share = _weigh(light, soft, x, y, floor, way, sigma)
    site = view.weigh((x, y), "valley", column, row, axis, {SUGGESTIVE: strength})
    half = view.threshold / 2
    if half > 0:
        share *= clamp01((site.strength - half) / (3 * half))
    site.eased = 255 * (1 - share)
    site.weak, again = site.margin < 0, site.margin
    site.margin = (site.strength - half) / max(1, half) if half > 0 else site.strength or -1.0
    site.doubtful |= bool(abs(again) < SURE or abs(least) < 1e-5 or abs(abs(offset) - 0.5) < loose or
                          abs(abs(way[0]) - abs(way[1])) < 2 * turned or turned > 0.01)
    # what a little to the side is much more, or less, rounding may tell otherwise
    strengths, shares = zip(*[_weigh(light, soft, x + p * far, y + q * far, floor, way, sigma)
                              for p in (-2, 2) for q in (-2, 2)], strict=True)
    spread = np.ptp([strength, *strengths]) * view.weights[SUGGESTIVE].max()
    site.doubtful |= bool(spread > 0.01 or np.ptp(shares) > 0.1)
    site.loose = max(1.0, loose / 1e-5, spread / 5e-5)
    return axis, site


def valleys(view, cracks):
    """{(family, row, column, axis): Place} of all that may be."""
    if not view.weights[SUGGESTIVE].any():
        return {}
    sigma, light = _sigma(view), view.layers.normal @ view.layers.view[2]
    found, cuts = [], _cut(view, cracks)
    for cut in cuts if (cuts[0] != cuts[1]).any() else cuts[:1]:
        soft = _fitted(np.where(cut, np.nan, light), sigma)
        soft = turn(COLUMN, _fitted(turn(COLUMN, soft), sigma))
        own = {}
        for row, column in np.argwhere(~np.isnan(soft)):
            site = _valley(view, light, soft, row, column, sigma)
            if site is not None:
                axis, place = site
                own["valley", int(row), int(column), axis] = place
        found.append(own)
    sure, may = found[0], found[-1]
    for key in {*sure, *may} if may is not sure else ():
        one, other = sure.get(key), may.get(key)
        if one is None or other is None or one != other:
            sure.setdefault(key, other).doubtful = True
    return sure


# Once all is linked: each that hangs together is as wide as it is clear and long


def ease(t, view, scale):
    """(shares of the width that sites of forms, light, colours and what is seen have left, else 1; by how much each is
    eased before, 0 .. 255, that of forms evened along each line but for its ends)."""
    params, style = view.params, view.layers.style
    threshold, share = params["edge_threshold"], np.ones(len(t))
    painted = np.array([view.layers.controls["color_edge"][view.pixel(*at)] > 0 for at in t.at], bool)
    q = t.site["strength"].astype(float) / threshold if threshold > 0 else np.full(len(t), np.inf)
    kinds = {"suggestive": (t.family == NUMBER["valley"], clamp01(q - 1)), "light": (t.rank == LIGHT, np.ones(len(t))),
             "color": (t.rank == COLOR, np.where(painted, 100, np.clip(2 * q - 1, 0, 100))),
             "seen": (t.rank == SEEN, np.ones(len(t)))}
    known, eased = set(), t.site["eased"].astype(float)
    for name, (lines, clear) in kinds.items():
        lines = lines & ~t.dropped
        least = params.at(shortest(name), style[t.site["near_y"], t.site["near_x"]]) * scale
        for first in np.flatnonzero(lines):
            if first in known:
                continue
            run = [int(first)]
            for i in run:
                run += [j for j in set(t.links[i]) if lines[j] and j not in run]
            known |= set(run)
            ways = {tuple(sorted((i, j))) for i in run for j in t.links[i] if lines[j]}
            length = sum(t.apart(i, j) * (clear[i] + clear[j]) / 2 for i, j in ways)
            if name == "suggestive":
                inner = {i: [j for j in t.links[i] if lines[j]] for i in run if len(t.links[i]) > 1}
                for _ in range(int(64 * scale**2)):
                    eased[list(inner)] = [(2 * eased[i] + eased[on].sum()) / (2 + len(on)) for i, on in inner.items()]
                eased[run] = np.floor(eased[run] + 0.5)
            for i in run:
                long_ = length / least[i] if least[i] > 0 else 1.0
                share[i] = min(clear[run].max() if name == "suggestive" else 1, clamp01(2 * long_ - 1))
        if name == "color":
            share = _evened(t, share, np.flatnonzero(lines & (least > 0)), px(scale, 0.6) * 20)
    return share, eased


def _evened(t, share, sites, spread):
    """Shares of these sites, of each the mean about it: of the centres of cells, by weights that fall to 0."""
    pixel = np.floor(t.at[sites] + 0.5).clip(0) // 4 * 4 + 1.5
    found = share.copy()
    for i in sites:
        weight = np.maximum(0, 1 - np.abs(pixel - t.at[i]) / spread).prod(1)
        found[i] = weight @ share[sites] / weight.sum()
    return found
