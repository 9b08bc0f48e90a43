# SPDX-License-Identifier: GPL-3.0-or-later
"""Bends over several faces: from what the rasteriser drew without them, in float64."""

import functools
from itertools import takewhile

import numpy as np

SPREAD = 360


def _degrees(n, m):
    half = np.linalg.norm(n - m) / 2
    return 2 * np.degrees(np.arctan2(half, np.sqrt(max(0, 1 - half * half))))


def _turn(maps, y, x, axis):
    """What the normal turns from a pixel to the next; -1 at an end of the surface, None beyond the images."""
    height, width = maps["object"].shape
    p, q = (y, x), (y + axis, x + 1 - axis)
    if min(y, x) < 0 or q[0] >= height or q[1] >= width:
        return None
    n, m = (maps["normal"][at].astype(float) for at in (p, q))
    if maps["object"][p] != maps["object"][q] or not n.any() or not m.any():
        return -1.0
    if maps["creases"][p][2 * axis + 1] >= 180 or maps["marks"][p][axis] < 0:
        return -1.0
    return _degrees(n, m)


def _sum(turns):
    return None if None in turns else -1.0 if -1.0 in turns else sum(turns)


def _bend(maps, turn_at, y, x, axis, most):
    """The clearest bend along an axis whose middle passes a pixel: (clear, off, bend, first, count, smooth)."""
    def at(k):
        return (y + k, x) if axis else (y, x + k)

    turn = {k: turn_at(*at(k), axis) for k in range(-2 * most, 2 * most)}
    if sum(max(turn[k] or 0, 0) for k in range(-most, most)) < 20:
        return None
    edge = {k: maps["creases"][at(k)][2 * axis:2 * axis + 2].astype(float) if turn[k] is not None else (0, 0)
            for k in turn}
    place = {k: k + (edge[k][0] if edge[k][0] > 0 and turn[k] > 0 else 0.5) for k in turn}
    best = None
    for count in range(2, most + 1):
        for first in range(-count, 1):
            ways = range(first, first + count)
            every, before, after = (_sum([turn[k] for k in part]) for part in (
                ways, range(first - count, first), range(first + count, first + 2 * count)))
            if every is None or every < 20 or -1.0 in (before, after):
                continue
            if before is None and after is None:
                continue
            sides = 2 * after if before is None else before, 2 * before if after is None else after
            bend, clear = every - sum(sides) / 2, every - max(sides)
            more = count // 2
            around = [*takewhile(lambda k: turn[k] not in (None, -1), range(first - 1, first - 1 - more, -1)), *ways,
                      *takewhile(lambda k: turn[k] not in (None, -1), range(first + count, first + count + more))]
            middle = sum(turn[k] * place[k] for k in around) / sum(turn[k] for k in around)
            own = [abs(edge[k][1]) > (0.36 if abs(place[k] - middle) > 1.6 else 0.6) * every
                   for k in ways if turn[k] > 0]
            if min(sides) <= 0.25 * every and bend >= 20 and abs(middle) <= 1.25 and not any(own) and (
                    clear > max(0, best[0] + 1e-9 if best else 0)):
                smooth = not any(edge[k][1] > 0 and turn[k] > 0 for k in ways)
                best = clear, -middle, bend, first, count, smooth
    return best


def spread(maps, frame_height):
    """The output `creases` with bends over several faces; maps: object, normal, marks, and creases without them."""
    height, width = maps["object"].shape
    most = int(np.clip(int(frame_height * 10 / 1080 + 0.5), 2, 24))
    turn = functools.cache(functools.partial(_turn, maps))
    bends = {}
    for y, x in np.ndindex(height, width):
        for axis in (0, 1):
            found = _bend(maps, turn, y, x, axis, most)
            if not found or (y, x) in bends and found[0] <= bends[y, x][0]:
                continue
            ends = [maps["normal"][(y + k, x) if axis else (y, x + k)].astype(float)
                    for k in (found[3], found[3] + found[4])]
            if _degrees(*ends) >= 0.8 * found[2]:
                bends[y, x] = *found, axis, ends[1] - ends[0]

    out = maps["creases"].astype(float)
    for y, x, axis in np.ndindex(height, width, 2):
        way = out[y, x, 2 * axis:2 * axis + 2]
        p, q = bends.get((y, x)), bends.get((y + axis, x + 1 - axis))
        if p and q and min(p[2], q[2]) > abs(way[1]):
            one, two = p[1], q[1] if np.trunc(63 * p[7]) @ np.trunc(63 * q[7]) > 0 else -q[1]
            if (one <= 0) != (two <= 0):
                way[:] = max(abs(one) / (abs(one) + abs(two)), 1 / 1024), min(p[2], q[2]) + SPREAD
                way[1] *= -1 if p[5] and q[5] else 1
                continue
        if way[0] > 0 and abs(way[1]) < 180 and _is_part(bends, way, y, x, axis, most):
            way[:] = 0
    return out


def _is_part(bends, way, y, x, axis, most):
    place = (y, x + way[0]) if axis == 0 else (y + way[0], x)
    for j in range(int(place[0]) - most, int(place[0]) + most + 1):
        for i in range(int(place[1]) - most, int(place[1]) + most + 1):
            bend = bends.get((j, i))
            if not bend or bend[2] <= abs(way[1]) or abs(bend[1]) > 0.75:
                continue
            along, aside = place[1] - i, place[0] - j
            if bend[6]:
                along, aside = aside, along
            if abs(aside) <= 0.5 and bend[3] <= along <= bend[3] + bend[4]:
                return True
    return False
