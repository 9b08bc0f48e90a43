# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's bounds of lines where both contours of a thing are near each other: thin things, and tips."""

import numpy as np

from .metric import clamp01, mix
from .passes import CLOSE, NUMBER, ROW, along_from, px

WIDEST, SHARE, LEAST, TIP = 24.0, 0.25, 1.25, 0.75  # px, of the thing's width, px, px
AROUND, MEETINGS = 16, 4  # sites each way along a line, and beyond how many meetings of lines


def _ways(t, i):
    """Unit vectors up (left) and down (right) along the line, over at most six sites of the same axis; unsure."""
    ways, unsure, ahead = np.zeros((2, 2)), False, 1 if t.axis[i] == ROW else 0
    for j in t.links[i] if len(t.links[i]) <= 2 else ():
        first = t.at[j, ahead] - t.at[i, ahead]
        last = [k for k in (j, *along_from(t, i, j)[1:])[:6] if t.axis[k] == t.axis[i]]
        gap = t.at[last[-1]] - t.at[i] if last else np.zeros(2)
        length = np.hypot(*gap)
        unsure |= abs(length - 0.5) < CLOSE
        if length > 0.5:
            ways[int(first > 0)] = gap / length
    return ways, unsure


def _opposite(t, i, layers, cracks, reach):
    """(the contour at which the thing ends that the one at site i bounds; None: it is far, covered, or dropped; pixels
    to where another thing begins behind it, 0: not known)."""
    depth, axis, at = layers.depth, t.axis[i], np.array([t.site["row"][i], t.site["column"][i]])
    step = np.array((0, 1) if axis == ROW else (1, 0))
    one, other = depth[tuple(at)], depth[tuple(at + step)]
    if one == other:
        return None, 0
    way, thing = -1 if one < other else 1, None
    own = tuple(at if one < other else at + step)
    for k in range(1, reach + 1):
        there = at + way * k * step
        if (there < 0).any() or (there + step >= depth.shape).any():
            return None, 0
        if (*there, axis) in cracks:
            pair = tuple(there), tuple(there + step)
            inside, outside = pair if way > 0 else pair[::-1]
            far = k * int(layers.object[outside] != layers.object[own])
            if thing is None and depth[inside] < depth[outside]:
                j = cracks[(*there, axis)]
                return None if t.dropped[j] else j, far
            thing = depth[inside] if thing is None else thing
            if depth[outside] > thing:
                return None, far
    return None, 0


def _within(t, i, far, unit):
    """Of a thing whose other contour is covered or dropped, so many pixels wide along the axis; 0: not known."""
    ways, unsure = _ways(t, i)
    thin = _thin(t, i, unit)[0]
    aside = abs((ways[1] if ways[1].any() else ways[0])[1 if t.axis[i] == ROW else 0])
    return max(thin, crowd_of(far * aside, 0.0, unit) if far * aside > 0 else 0.0), 0.0, unsure or 0 < aside < 1e-6


def crowd_of(wide, sine, unit):
    """1 over half the width that the lines of a thing so wide may have, whose contours are at an angle of this sine."""
    least = np.maximum(mix(LEAST, TIP, clamp01((sine - 0.15) / 0.15)) * unit, 0.5)
    return 1 / np.maximum(SHARE * wide / np.maximum(1 - (wide / (WIDEST * unit)) ** 4, 1e-6), least)


def _thin(t, i, unit):
    """Where contours have no way of their own."""
    return t.site["thin"][i] * crowd_of(2.0 * t.site["half"][i], 0.0, unit), 0.0


def _round(t, i, j):
    """(how wide what a loop of at most 32 sites bounds is, by its length and area; how much that counts)."""
    loop = [i]
    while len(t.links[loop[-1]]) == 2 and len(loop) <= 32:
        one, other = t.links[loop[-1]]
        following = one if len(loop) == 1 or other == loop[-2] else other
        if following == i:
            break
        loop.append(following)
    else:
        return 0.0, 0.0
    if j not in loop or len(loop) > 32 or len(t.links[loop[-1]]) != 2:
        return 0.0, 0.0
    corners = t.at[loop]
    after = np.roll(corners, -1, 0)
    length = np.hypot(*(after - corners).T).sum()
    area = abs((corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]).sum()) / 2
    rest = length**2 / 16 - area
    wide = length / 4 + (0.524 * np.sqrt(-rest) if rest < 0 else -np.sqrt(rest))
    return wide, clamp01(2 - area / wide**2)


def _bound(t, i, j, unit):
    """(1 / half the width, how much it tapers, unsure) where contours i and j are of one thing."""
    wide, part = _round(t, i, j)
    crowd, tapers, unsure = _between(t, i, j, unit)
    if not part:
        return crowd, tapers, unsure
    crowd = max(_thin(t, i, unit)[0], mix(crowd, crowd_of(wide, 0.0, unit), part))
    return crowd, mix(tapers, 0, part), unsure and part < 1


def _between(t, i, j, unit):
    """Likewise, by their ways."""
    (own, doubt), (other, more) = _ways(t, i), _ways(t, j)
    dots, gap = (own * other).sum(1), t.at[j] - t.at[i]
    first = int(dots[1] > dots[0])
    narrower = _aslant(own, other)
    found = [_beside(own[k], other[k], dots[k], gap / narrower, unit) or _thin(t, i, unit) for k in (first, 1 - first)]
    doubt |= any(abs(ways[0] @ ways[1] + 0.3) < CLOSE for ways in (own, other))
    tie = abs(dots[1] - dots[0]) < 1e-5 and not np.allclose(*found, atol=1e-4)
    return *found[0], doubt or more or tie or abs(dots[first] - 0.5) < 1e-5


def _aslant(own, other):
    """Of what is round: how much narrower it is between two points that lie aslant; 1 where a contour has a corner."""
    if own[0] @ own[1] > -0.3 or other[0] @ other[1] > -0.3:
        return 1.0
    one, two = ((ways[1] - ways[0]) / np.hypot(*(ways[1] - ways[0])) for ways in (own, other))
    return max(np.hypot(*(one + two)) / 2, 0.5)


def _beside(a, b, dot, gap, unit):
    beside = clamp01((dot - 0.5) / 0.3)
    if not beside > 0:
        return None
    way, sine = a + b, abs(a[0] * b[1] - a[1] * b[0])
    wide = abs(gap[0] * way[1] - gap[1] * way[0]) / np.hypot(*way)
    return beside * crowd_of(wide, sine, unit), clamp01((sine - 0.05) / 0.1)


def _beyond(t, i, j, sites, meetings):
    """The next sites of a line from i over j; where it meets others, also of these."""
    arm = along_from(t, i, j, sites)
    last, before = arm[-1], (i, *arm)[-2]
    if len(t.links[last]) > 2 and meetings and len(arm) < sites:
        return arm + [k for to in t.links[last] if to != before
                      for k in _beyond(t, last, to, sites - len(arm), meetings - 1)]
    return arm


def slender(t, layers, unit):
    """1 over the greatest radius of each site of a shape, 0 where it is not bounded; how much what it is of tapers;
    unsure. unit: pixels of a px."""
    found, doubt, result = np.zeros((len(t), 2)), set(), np.zeros((len(t), 2))
    contour = (t.family == NUMBER["crack"]) & (t.axis <= 1)
    cracks = {(t.site["row"][i], t.site["column"][i], t.axis[i]): i for i in np.flatnonzero(contour)}
    for i in np.flatnonzero(~t.dropped & (t.rank == 0)):
        j, far = _opposite(t, i, layers, cracks, int(WIDEST * unit)) if contour[i] else (None, 0)
        *found[i], unsure = _within(t, i, far, unit) if j is None else _bound(t, i, j, unit)
        doubt |= {i} if unsure else set()
    unsure = set()
    for i in np.flatnonzero(~t.dropped & (t.rank == 0)):  # at the tip itself there is nothing opposite
        arms = [_beyond(t, i, j, int(AROUND * px(unit)), MEETINGS) for j in t.links[i]]
        most = np.sort([found[arm].max(0) for arm in arms], axis=0)
        both = most[-2 if len(arms) > 1 else -1] if arms else np.zeros(2)  # where lines meet it goes on in two
        result[i] = np.maximum(found[i], both)
        if doubt & {i, *(k for arm in arms for k in arm)}:
            unsure.add(i)
    return *result.T, unsure
