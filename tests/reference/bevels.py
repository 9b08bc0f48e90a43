# SPDX-License-Identifier: GPL-3.0-or-later
"""Bends over several faces: from what the rasteriser drew without them, in float64."""

from types import SimpleNamespace as Bag

import numpy as np

SPREAD = 360
AHEAD = 16  # degrees by which a bend must bend more than an edge that is part of it
RATHER = np.array([0.31, 0.43, 0.85])  # where the line of a bend comes from as its faces part
ONE, TWO = 1.25, 1.75  # pixels across, from its middle: up to which edges are one line, and from which on two
BY = 1.25  # pixels from a pixel, that a line that goes by it may be away


def _degrees(n, m):
    half = np.linalg.norm(n - m) / 2
    return 2 * np.degrees(np.arctan2(half, np.sqrt(max(0, 1 - half * half))))


def _turn(maps, y, x, axis):
    """What the normal turns from a pixel to the next; -1 at an end of the surface."""
    p, q = (y, x), (y + axis, x + 1 - axis)
    n, m = (maps["normal"][at].astype(float) for at in (p, q))
    if maps["object"][p] != maps["object"][q] or not n.any() or not m.any():
        return -1.0
    if maps["creases"][p][2 * axis + 1] >= 180 or -16 < maps["marks"][p][axis] < 0:
        return -1.0
    return _degrees(n, m)


def _end(mark):
    """Where a surface ends on a way: at a contour of a mesh, if one is known there."""
    return -mark - 2 * min(np.floor(-mark / 2), 7) if -16 < mark < 0 else 0.5


def _place(place, own):
    """Where a way turns of which an edge at a place has a share: the others are on the longer side of it."""
    if not place > 0:
        return 0.5
    return own * place + (1 - own) * ((1 + place) / 2 if place < 0.5 else place / 2)


def _lane(maps, number, axis):
    """Where a row (axis 0) or a column turns: (place, degrees, bend of an edge there, way, whether some miss it)."""
    height, width = maps["object"].shape
    found = []
    for way in range((height if axis else width) - 1):
        y, x = (way, number) if axis else (number, way)
        turn = _turn(maps, y, x, axis)
        place, edge = maps["creases"][y, x, 2 * axis:2 * axis + 2].astype(float)
        if turn < 0:
            found.append((way + _end(float(maps["marks"][y, x, axis])), -1.0, 0.0, way))
        elif turn > 0:
            found.append((way + _place(place, min(abs(edge) / turn, 1)), turn, edge, way))
    ends = [e[0] for e in found if e[1] < 0]
    return [(*e, e[1] >= 0 and e[2] != 0 and any(abs(e[0] - end) < 1 for end in ends)) for e in found]


def _shape(edges):
    """(degrees, middle, width) of edges."""
    place, turn = np.array([(e[0], e[1]) for e in edges]).T
    middle = (place * turn).sum() / turn.sum()
    wide = np.sqrt(12 * max(0, (turn * (place - middle) ** 2).sum() / turn.sum()))
    return turn.sum(), middle, max(min(wide, place[-1] - place[0]), 0.25)


def _turns_back(edge, across, normal):
    change = normal(edge[3] + 1) - normal(edge[3])
    return change @ across < -np.sqrt(0.5) * np.linalg.norm(change) * np.linalg.norm(across)


def _beside(lane, i, way, reach, border, enough, guessed, back):
    """What goes on beside an edge, and without slivers, and also without what turns back, and the share of it that is
    seen; None: the surface ends before `enough` is seen, and `guessed`."""
    total, seen, cut = np.zeros(3), abs(border - lane[i][0]), True
    k = i + way
    while 0 <= k < len(lane) and abs(lane[k][0] - lane[i][0]) < reach:
        away = abs(lane[k][0] - lane[i][0])
        if lane[k][1] < 0:
            seen, cut = away, False
            break
        sure = not lane[k][4]
        total += lane[k][1] * min(1, 2 - 2 * away / reach) * np.array([1, sure, sure and not back(lane[k])])
        k += way
    if seen < enough:
        return (np.zeros(3), 0) if cut or seen >= guessed else None
    return total, min(1, seen / reach)


def _whole(own, other):
    """With what is not seen of a side, which goes on as what is, or twice as the other side."""
    (total, seen), (beyond, _) = own, other
    return total + max(total[1] * (1 / seen - 1) if seen else 0, 2 * (1 - seen) * beyond[1])


def _alone(before, after, turn):
    return np.clip((0.25 - min(before[0], after[0]) / turn) / 0.13, 0, 1)


def _fade(maps, out, number, axis, narrow):
    """What edges of smooth forms bend, in `out`, where the form turns on both sides of them."""
    height, width = maps["object"].shape
    size, lane = height if axis else width, _lane(maps, number, axis)
    for i, (_, turn, edge, way, _) in enumerate(lane):
        if turn < 0 or edge > -20:
            continue
        sides = [_beside(lane, i, step, narrow, border, 1, 1, lambda _: False)
                 for step, border in ((-1, 0), (1, size - 1))]
        if sides == [None, None]:
            continue
        sides = [side or (np.zeros(3), 0) for side in sides]
        at = out[(way, number) if axis else (number, way)][2 * axis:2 * axis + 2]
        at[1] *= _alone(_whole(*sides), _whole(*sides[::-1]), -edge)
        at[:] = at if abs(at[1]) >= 1 else 0


def _own(edge, edges, slant):
    """How far an edge of a bend is a line by itself."""
    turn, middle, _ = _shape(edges)
    share = abs(edge[2]) / turn
    if not 0.36 < share <= 0.6:
        return float(share > 0.6)
    return float(np.clip((slant * abs(edge[0] - middle) - ONE) / (TWO - ONE), 0, 1))


def _is_chamfer(edges):
    least = min(abs(edges[0][2]), abs(edges[-1][2]))
    return least > 0.36 * _shape(edges)[0] and least >= 20


def _slant(n, m, aside):
    """Pixels across a bend for each along the lane, and whether it is a ridge; seen from afar along z."""
    line = np.cross(n, m)
    return abs(line @ aside) / (np.hypot(*line[:2]) or 1), line @ aside > 0


def _run(lane, i, j, narrow, size, normal, aside):
    """What the edges from i to j are as a bend: (how clear, degrees, slant), or None."""
    edges = lane[i:j + 1]
    turn, middle, wide = _shape(edges)
    places = [e[0] for e in edges]
    slant, ridge = _slant(normal(lane[i][3]), normal(lane[j][3] + 1), aside)
    if max(np.diff(places), default=0) > max(0.55 * (places[-1] - places[0]), 1.25 * narrow) and not _is_chamfer(edges):
        return None
    reach = max(1.6 * wide, narrow)
    across = normal(lane[j][3] + 1) - normal(lane[i][3])
    guessed = 1 if wide <= 0.8 * narrow else np.inf
    sides = [_beside(lane, k, way, reach, border, max(2, wide / 2), guessed, lambda e: _turns_back(e, across, normal))
             for k, way, border in ((i, -1, 0), (j, 1, size - 1))]
    if None in sides or sides[0][1] + sides[1][1] < 1:
        return None
    before, after = _whole(*sides), _whole(*sides[::-1])
    alone = _alone(before, after, turn)
    bends = alone * (turn - (before[1] + after[1]) / 2)
    counts = 2 if ridge else 1  # a ridge outdoes the valley beside it
    clear = alone * (turn - max(before[counts], after[counts])) / (1 + (wide / (3 * narrow)) ** 2)
    own = any(_own(e, edges, slant) == 1 for e in edges)
    straight = _degrees(normal(lane[i][3]), normal(lane[j][3] + 1)) >= 0.8 * bends
    return (clear, bends, slant) if bends >= 20 and clear > 0 and not own and straight else None


def _bends(maps, number, axis, narrow, aside):
    """The bend of each pixel of a lane, if there is one. aside: the way on the screen across the
    lane along which faces meet that are a ridge."""
    height, width = maps["object"].shape
    size, lane = height if axis else width, _lane(maps, number, axis)

    def normal(k):
        return maps["normal"][(k, number) if axis else (number, k)].astype(float)

    best = [(0.0,)] * len(lane)
    for i in range(len(lane)):
        for j in range(i, len(lane)):
            if lane[j][1] < 0 or lane[j][0] - lane[i][0] > max(4 * narrow, 5):
                break
            if sum(e[1] for e in lane[i:j + 1]) >= 20:
                found = _run(lane, i, j, narrow, size, normal, aside)
                for k in range(i, j + 1):
                    if found and found[0] > best[k][0]:
                        best[k] = *found, i, j
    out = [None] * size
    for i, run in enumerate(best):
        if len(run) == 1 or run[3] != i or any(best[k] != run for k in range(i, run[4] + 1)):
            continue
        end = run[4]
        edges, (first, last) = lane[i:end + 1], (lane[i][3], lane[end][3] + 1)
        reach, near, far = 0.5 * _shape(edges)[2], i, end
        across = normal(last) - normal(first)
        while (near > 0 and lane[near - 1][1] >= 0 and not lane[near - 1][4] and lane[i][0] - lane[near - 1][0] < reach
               and not _turns_back(lane[near - 1], across, normal)):
            near -= 1
        while (far + 1 < len(lane) and lane[far + 1][1] >= 0 and not lane[far + 1][4]
               and lane[far + 1][0] - lane[end][0] < reach and not _turns_back(lane[far + 1], across, normal)):
            far += 1
        _, middle, wide = _shape(lane[near:far + 1])
        ahead = (normal(first) - normal(last)) @ RATHER > 0
        kept, second = edges[0 if ahead else -1], edges[-1 if ahead else 0]
        shift, own = (_own(e, edges, run[2]) for e in (kept, second))
        line = middle + shift * (kept[0] - middle)
        most = run[1] + shift * (min(abs(kept[2]) + np.clip(abs(kept[2]) - 20, 0, AHEAD), run[1]) - run[1])
        across = np.trunc(63 * across)
        for k in range(size):
            off = k - line
            if (abs(off) <= 2.6 or first <= k <= last) and not (out[k] and abs(out[k].off) <= abs(off)):
                out[k] = Bag(off=off, wide=wide, most=most, across=across, first=first, last=last, axis=axis,
                             smooth=not any(e[2] > 0 for e in edges), chamfer=_is_chamfer(edges), own=own, line=line,
                             second=second[0])
    return out


def _united(column, row, narrow):
    """What a column and a row say of a pixel, across the line."""
    out, wide = row or column, (row or column).wide
    if row and column:
        same = min(row.most, column.most) > 0.85 * max(row.most, column.most)
        out = (row if 1.001 * row.wide < column.wide else column) if same else max(column, row, key=lambda b: b.most)
        dot = row.across @ column.across
        parallel = 2 * dot * dot > (row.across @ row.across) * (column.across @ column.across)
        wide = (row.wide ** -2 + column.wide ** -2) ** -0.5 if same and parallel else out.wide
    most = out.most / (1 if out.chamfer else 1 + (0.15 if out.smooth else 0.5) * max(0, wide / narrow - 1))
    return Bag(**{**vars(out), "off": out.off * wide / out.wide, "wide": wide, "most": most})


def _even(bends, y, x, narrow):
    """How much it bends along the line that goes by a pixel, less if that is short."""
    bend = bends[y, x]
    found = [bend.most]
    for way in (-1, 1):
        at = y, x
        for _ in range(int(1.5 * narrow) + 3):
            beside = [(at[0] + aside, at[1] + way) if bend.axis else (at[0] + way, at[1] + aside)
                      for aside in (-1, 0, 1)]
            good = [p for p in beside if p in bends and abs(bends[p].off) <= BY and
                    2 * abs(bend.across @ bends[p].across) > bend.across @ bend.across]
            if not good:
                break
            at = min(good, key=lambda p: abs(bends[p].off))
            found.append(bends[at].most)
    return np.mean(found) * np.clip(len(found) / max(bend.wide / 2, 2) - 1, 0, 1)


def spread(maps, frame_height):
    """The output `creases` with bends over several faces, as views.pixels() sees them; maps: object, normal, marks, and
    creases without them."""
    height, width = maps["object"].shape
    narrow = float(np.clip(frame_height * 2.5 / 540, 1, 12))
    columns = [_bends(maps, x, 1, narrow, np.array([-1, 0, 0])) for x in range(width)]
    bends = {}
    for y in range(height):
        row = _bends(maps, y, 0, narrow, np.array([0, 1, 0]))
        bends |= {(y, x): _united(columns[x][y], row[x], narrow) for x in range(width) if columns[x][y] or row[x]}
    most = {at: _even(bends, *at, narrow) for at, bend in bends.items() if abs(bend.off) <= BY}

    out = maps["creases"].astype(float)
    for axis in range(2):
        for number in range(width if axis else height):
            _fade(maps, out, number, axis, narrow)
    for y, x, axis in np.ndindex(height, width, 2):
        way, p, q = out[y, x, 2 * axis:2 * axis + 2], (y, x), (y + axis, x + 1 - axis)
        own = abs(way[1]) + AHEAD if way[1] else 0
        bend = min(most.get(p, 0), most.get(q, 0))
        if bend > abs(way[1]):
            dot = bends[p].across @ bends[q].across
            one, two = bends[p].off, bends[q].off if dot > 0 else -bends[q].off
            if dot and one != two and (one <= 0) != (two <= 0):
                way[:] = max(abs(one) / (abs(one) + abs(two)), 1 / 1024), bend + SPREAD
                way[1] *= -1 if bends[p].smooth and bends[q].smooth else 1
                continue
        if way[0] > 0 and abs(way[1]) < 180:
            place = (y, x + way[0]) if axis == 0 else (y + way[0], x)
            left = min([_own_part(bends[at], at, place) for at, degrees in most.items() if degrees > own] or [1])
            bend = left * abs(way[1])
            if left < 1:
                way[:] = (way[0], np.copysign(bend + SPREAD, way[1])) if bend >= 1 else 0
    return out


def _own_part(bend, at, place):
    """How far an edge there is a line by itself; 1: it is no part of the bend."""
    along, aside = (place[0], place[1] - at[1]) if bend.axis else (place[1], place[0] - at[0])
    if abs(bend.off) > 0.75 or abs(aside) > 0.5 or not bend.first <= along <= bend.last:
        return 1
    return bend.own if abs(along - bend.second) < abs(along - bend.line) else 0
