# SPDX-License-Identifier: GPL-3.0-or-later
"""How lines turn and bend, where strokes go on beyond corners, and where dashes part, on the sites of FINE."""

import itertools

import numpy as np

from .metric import clamp01, mix

ARM, LEAST_ARM, CORNER, PASSING, STEPS, MOST_SLANT = 6.0, 2.0, 0.18, 0.7, 8, 12.0


def _walk(t, i, first, reach):
    """(sites on the way, how far along the line each is reached, the way to the end and its length)."""
    sites, along, way, length, before, at = [], [], np.zeros(2), 0.0, i, first
    while at is not None and at != i and not t.dropped[at] and length < reach:
        step = t.apart(before, at)
        share = min(1, (reach - length) / step) if step else 1
        way = mix(t.at[before], t.at[at], share) - t.at[i]
        length += share * step
        sites.append(at)
        along.append(length)
        before, at = at, t.next(before, at)
    return sites, along, way, length


def _arm(t, i, first, reach=ARM):
    """(the way of a line's arm, None where it is too short to tell; whether it is long; the site at its end)."""
    sites, _, way, length = _walk(t, i, first, reach)
    told = np.hypot(*way) > LEAST_ARM / 2
    return (way / np.hypot(*way) if told else None), told and length >= LEAST_ARM, (sites or [i])[-1]


def turned(t, reach=ARM):
    """1 less the cosine of the angle by which the line turns at each site."""
    out = np.zeros(len(t))
    for i in range(len(t)):
        if not t.dropped[i] and len(t.links[i]) == 2:
            (a, whole, _), (b, other, _) = (_arm(t, i, first, reach) for first in t.links[i])
            if whole and other:
                out[i] = 1 + a @ b
    return out


def onward(t, before, at):
    """The next site of a line: where several meet, of the one that goes most straight on, seen from both sides."""
    def straight_on(before, at):
        way, turns = _arm(t, at, before)[0], {}
        for one in t.links[at]:
            other = _arm(t, at, one)[0]
            if one != before and way is not None and other is not None and 1 + way @ other < 1:
                turns[one] = 1 + way @ other
        return min(turns, key=turns.get, default=None)

    if len(t.links[at]) == 2:
        return t.next(before, at)
    after = straight_on(before, at)
    return after if after is not None and straight_on(after, at) == before else None


def bends(t, unit):
    """k/(k + 1) of the curvature k in units of 1/60 px, of the mean ways over 28 px on each side. Corners end lines,
    beyond ends these go straight on, and where they meet there is none."""
    reach, side = max(12 * unit, ARM), max(28 * unit, 12)
    turn, corner, out = turned(t, reach), np.zeros(len(t)), np.zeros(len(t))
    for i in np.flatnonzero(turn > 0.1):
        bent = 0
        for first in t.links[i]:
            sites, along, _, _ = _walk(t, i, first, reach)
            farther = [turn[at] for at, far in zip(sites, along, strict=True) if far > reach / 2]
            bent = max(bent, min(farther, default=2))
        corner[i] = clamp01((turn[i] - 0.1) / 0.15) * clamp01((0.9 - bent / turn[i]) / 0.2)

    def flank(i, first):
        way, share, far, runs, before, at = np.zeros(2), 0.0, 0.0, 1 - corner[i], i, first
        while at is not None and at != i and not t.dropped[at] and far < side and runs > 0:
            step = t.apart(before, at)
            part = (far + step / 2) / side
            weight = max(0, part * (1 - part)) * runs
            way = way + weight * (t.at[at] - t.at[before])
            share += 6 * weight * step / side
            far += step
            runs = min(runs, 1 - corner[at])
            before, at = at, onward(t, before, at)
        return way, share

    for i in range(len(t)):
        if t.dropped[i] or len(t.links[i]) != 2:
            continue
        (a, one), (b, other) = (flank(i, first) for first in t.links[i])
        along = np.hypot(*a) * np.hypot(*b) - a @ b
        k = 120 * unit * abs(a[0] * b[1] - a[1] * b[0]) * one * other
        out[i] = k / (k + side * max(0, along)) if k > 0 else 0
    return out


def _is_corner(t, i, turn):
    if not turn[i] > CORNER:
        return False
    for first in t.links[i]:
        sites, along, _, _ = _walk(t, i, first, ARM)
        if any(turn[at] > turn[i] or (turn[at] == turn[i] and at < i) for at in sites):
            return False
        farther = [turn[at] for at, far in zip(sites, along, strict=True) if far > ARM / 2]
        if min(farther, default=2) > PASSING * turn[i]:
            return False
    return True


def _room(t, i, first, turn):
    """The length of the line up to its corner before."""
    sites, along, _, length = _walk(t, i, first, np.inf)
    return next((far for at, far in zip(sites, along, strict=True) if _is_corner(t, at, turn)), length)


def spurs(t, turn):
    """[(site, the last site of its arm, way, length of the stroke)] where a stroke ends and others go on."""
    out = []
    for i in range(len(t)):
        links = t.links[i]
        if t.dropped[i] or not 2 <= len(links) <= 4 or (len(links) == 2 and not _is_corner(t, i, turn)):
            continue
        arms = [_arm(t, i, first) for first in links]
        for k, (way, whole, last) in enumerate(arms):
            if whole and all(j == k or other is None or 1 + way @ other > CORNER
                             for j, (other, _, _) in enumerate(arms)):
                out.append((i, last, -way, _room(t, i, links[k], turn)))
    return out


def _on(t, p, unit, i, first, scale):
    on, before, at = [], i, first
    while len(on) < STEPS and at is not None and at != i and not t.dropped[at]:
        most = MOST_SLANT * unit[before] / scale * max(1, t.apart(before, at))
        if np.hypot(np.hypot(*(p[at] - p[before])[:2]), (p[at] - p[before])[2]) > most or t.family[at] != t.family[i]:
            break
        on.append(at)
        before, at = at, t.next(before, at)
    return on


WAYS = [np.array(w[::-1]) / np.sqrt(np.square(w).sum())
        for w in itertools.product((-1, 0, 1), repeat=3) if w > (0, 0, 0)]


def beat(t, hand, i, length):
    """Where a site lies between the places along the thing that part its line, whole numbers of a power of two of them,
    once to twice `length` pixels apart: (how far from one to the next, which, the power's exponent, how many `length`
    it is from one to the next); None where nothing tells."""
    links = t.links[i]
    if t.dropped[i] or not 1 <= len(links) <= 2:
        return None
    sides = [_on(t, hand.p, hand.unit, i, first, hand.scale) for first in links] + [[]]
    on = [*sides[0][::-1], i, *sides[1]]
    middle = len(sides[0])
    each = min(middle, len(on) - 1 - middle)
    best = None
    for way in WAYS:
        along = hand.p[on] @ way
        net = abs(along[-1] - along[0])
        score = net - 2 * (np.abs(np.diff(along)).sum() - net)
        if best is None or score > best[0]:
            best = score, net, along[middle - each:middle + each + 1].mean()
    if best[1] <= 0:
        return None
    rate = t.apart(on[0], on[-1]) / (length * best[1])
    octave = np.floor(np.log2(rate))
    place = best[2] * 2.0**octave
    return place % 1, np.floor(place), octave, rate / 2.0**octave


def dashed(t, hand, radius):
    """Half the widths of dashed lines: parted at those places and, as far as the next power is near, halfway between.
    """
    out = radius.copy()
    for i in range(len(t)):
        dash = hand.at("dash")[i]
        length = (dash + hand.at("dash_space")[i]) * hand.scale
        found = beat(t, hand, i, length) if dash > 0 else None
        if not found:
            continue
        part, _, _, times = found
        space = 0.5 * min(hand.at("dash_space")[i] * hand.scale + 2 * radius[i], length - 1)
        born = (times - 1) * space
        half = clamp01(abs(part - 0.5) * times * length - born + 0.5)
        out[i] *= clamp01(min(part, 1 - part) * times * length - space + 0.5) * mix(1, half, min(1, born))
    return out
