# SPDX-License-Identifier: GPL-3.0-or-later
"""What gives way to a line beside it, in FINE: edges of meshes, lines by hand, light, and contours within a thing."""

import numpy as np

from .passes import CLOSE, COLUMN, JUNCTION, LIGHT, NUMBER, ROW, along_from, px


def _front(t, i, depth, number):
    """Of a contour: (the number of what it bounds, that of what is behind, way to the former along the axis, its
    depth); None where depths do not tell."""
    if t.family[i] != NUMBER["crack"] or t.axis[i] > COLUMN or number is None:
        return None
    at = np.array([t.site["row"][i], t.site["column"][i]])
    pixels = tuple(at), tuple(at + ((0, 1) if t.axis[i] == ROW else (1, 0)))
    one, two = (depth[p] for p in pixels)
    if one == two:
        return None
    near, far = pixels if one < two else pixels[::-1]
    return number[near], number[far], -1 if one < two else 1, depth[near]


def _begins(number, depth, at, step, reach):
    """Whether from a pixel behind two things one begins so few pixels along an axis, and is at least twice as thick."""
    def pixel(k):
        return tuple(np.clip(np.array(at) + k * np.array(step), 0, np.array(depth.shape) - 1))

    first = next((k for k in range(1, reach + 1) if number[pixel(k)] != number[at]), None)
    return (first is not None and depth[pixel(first)] < depth[at]
            and all(number[pixel(first + k)] == number[pixel(first)] for k in range(1, 2 * reach + 1)))


def _slit(t, i, front, depth, number, reach):
    """Whether an outline is a side of a slit between two things, neither of which is thin."""
    if front is None or front[0] == front[1]:
        return False
    row, back = t.axis[i] == ROW, front[2] < 0
    at = int(t.site["row"][i] + (not row and back)), int(t.site["column"][i] + (row and back))
    return any(all(_begins(number, depth, at, sign * np.array(axis), reach) for sign in (-1, 1))
               for axis in ((0, 1), (1, 0)))


def _far_side(t, i, j, way, fronts):
    """Whether two outlines are the sides of a slit and that of site i goes; unsure."""
    own, other = fronts[i], fronts[j]
    gap = t.at[j] - t.at[i]

    def side(k, front):
        return front[2] * (way[1] if t.axis[k] == ROW else -way[0])

    one, across, two = side(i, own), gap @ (way[1], -way[0]), side(j, other)
    unsure = min(abs(one), abs(across), abs(two)) < CLOSE
    if other[0] == other[1] or one * across >= 0 or one * two >= 0:
        return False, unsure
    if other[0] != own[0]:
        return other[0] < own[0], unsure
    before, doubt = _before(way, gap, 0)
    return before, unsure or doubt


def _before(way, gap, least=0.7):
    """Whether what lies `gap` off a line is left of it, or above; unsure."""
    (x, y), aside = way, gap @ (way[1], -way[0])
    aside = -aside if (y > 0 if abs(y) > abs(x) else x < 0) else aside
    return aside > least, abs(aside - least) < CLOSE or abs(abs(x) - abs(y)) < CLOSE


def _double(t, i, j, way, fronts):
    """Whether a contour within a thing is a double of another one of it; unsure."""
    own, other = fronts[i], fronts[j]
    if other is not None and own[0] != own[1]:
        return _far_side(t, i, j, way, fronts)
    if other is None or other[0] != own[0]:
        return False, False
    ahead = [(t.at[b] - t.at[a])[0 if t.axis[a] == ROW else 1] for a, b in ((i, j), (j, i))]
    faces, unsure = [f[2] * d > 0 for f, d in zip((own, other), ahead, strict=True)], min(map(abs, ahead)) < CLOSE
    if all(faces):
        return False, unsure
    if other[0] != other[1]:
        return True, unsure
    faint = t.site["eased"][i] > 0, t.site["eased"][j] > 0
    if faint[0] != faint[1]:
        return faint[0], unsure
    if faces[0] != faces[1]:
        return other[3] < own[3], unsure
    before, doubt = _before(way, t.at[j] - t.at[i])
    return before, unsure or doubt


def _smooth(t, creases):
    """Which sites are on edges of forms that are shaded smoothly, where they are on edges; creases: the layer."""
    if creases is None:
        return np.zeros(len(t), bool)
    height, width = creases.shape[:2]

    def smooth(axis, row, column):
        every = [(a, row + k * (a == ROW), column + k * (a != ROW)) for a in (ROW, COLUMN) for k in range(2)]
        ways = every if axis > COLUMN else [(axis, row, column)]
        there = [creases[y, x, 2 * a:2 * a + 2] for a, y, x in ways
                 if y + (a != ROW) < height and x + (a == ROW) < width]
        bends = [bend for place, bend in there if place > 0]
        return bool(bends) and max(bends) < 0

    return np.array([smooth(*where) for where in zip(t.axis, t.site["row"], t.site["column"], strict=True)], bool)


def give_way(t, scale, depth, number=None, creases=None):
    """1 over the greatest radius of sites on edges of meshes, lines by hand, of light, and contours within a thing, 0
    where it is not bounded; which these are; unsure. number: of objects; creases: the layer."""
    def way(i):
        ends = [*t.links[i], i][:2]
        out = (t.at[ends[1]] - t.at[ends[0]]) * (-1 if len(t.links[i]) == 1 else 1)
        return out / max(np.linalg.norm(out), 1e-12)

    def own(i):
        return {i, *(j for first in t.links[i] for j in along_from(t, i, first))}

    def even(i):
        """The mean along the line; of which sites."""
        arms = [along_from(t, i, j) for j in t.links[i]] if len(t.links[i]) == 2 else [[]]
        both = min(len(arm) for arm in arms)
        group = [i, *(j for arm in arms for j in arm[:both] if not meeting[j])]
        if of_side(i):
            group = [i] * bool(side[i])
            for k in range(max(len(arm) for arm in arms)):
                if k >= both and group:
                    break
                group += [arm[k] for arm in arms if k < len(arm) and side[arm[k]]]
            if not group:
                return wide[i], [i]
        if t.family[i] == NUMBER["mark"]:  # all between two places where lines meet
            group = [i, *(j for arm in arms for j in arm if len(t.links[j]) <= 2)]
        if len(t.links[i]) > 2:  # the line that goes through with most room
            return sorted(room[t.links[i]])[-2], t.links[i]
        return float(np.mean(room[group])), group

    def of_side(i):
        return side[i] or (len(t.links[i]) == 2 and all(any(side[k] for k in along_from(t, i, j, 5))
                                                        for j in t.links[i]))

    def goes_on(i):
        return 1 + sum(len([k for k in along_from(t, i, j, 6) if len(t.links[k]) == 2]) for j in t.links[i]) >= 6

    edge, light = np.isin(t.family, (NUMBER["mark"], NUMBER["crease"])), t.rank == LIGHT
    fronts = [_front(t, i, depth, number) for i in range(len(t))]
    fold = np.array([f is not None and f[0] == f[1] and np.isfinite(depth[r, c])
                     for f, r, c in zip(fronts, t.site["row"], t.site["column"], strict=True)], bool)
    reach = int(3.5 * px(scale)) + 1
    slit = np.array([not fold[i] and len(t.links[i]) == 2 and goes_on(i) and
                     _slit(t, i, fronts[i], depth, number, reach) for i in range(len(t))], bool)
    meeting = (t.family == NUMBER["crack"]) & (t.axis == JUNCTION)
    give = ~t.dropped & (edge | light | fold | meeting | slit)
    smooth = (t.family == NUMBER["crease"]) & _smooth(t, creases)
    wide = px(scale) * np.where(t.family == NUMBER["mark"], 3, np.where((t.rank == 0) | smooth, 5, 4))
    closed = px(scale) * np.where(edge & ~smooth, 1.5, np.where(light, 0.5, 3))
    turns = fold & (creases is not None)
    stays, doubt = np.ones(len(t)), set()
    ways = np.array([way(i) if len(t.links[i]) in (1, 2) else (0, 0) for i in range(len(t))]).reshape(-1, 2)
    lines = np.flatnonzero(~t.dropped & ways.any(1))
    side = slit & ~t.dropped & ways.any(1)
    for again in (False, True):  # what another gives way to may itself give way
        room = 1.0 * wide
        for i in lines:
            if not give[i] or meeting[i]:
                continue
            x, y = ways[i]
            gaps = t.at[lines] - t.at[i]
            near = (abs(gaps @ (x, y)) <= 1 + CLOSE) & (abs(gaps @ (y, -x)) < (6 * px(scale) if light[i] else wide[i]))
            for j, gap in zip(lines[near], gaps[near], strict=True):
                along, aside, level = abs(gap @ (x, y)), abs(gap @ (y, -x)), abs(ways[j] @ (x, y))
                most, hands, unsure = 0.5 if slit[i] else 1, t.family[i] == t.family[j] == NUMBER["mark"], False
                if hands:
                    older, unsure = _before(ways[i], gap)
                elif fold[i] or slit[i]:
                    older, unsure = _double(t, i, j, ways[i], fronts)
                else:
                    older = t.family[j] < t.family[i] if edge[i] else t.rank[j] < LIGHT
                if not (older or unsure) or (hands or fold[i] or slit[i]) and j in own(i):
                    continue
                if unsure or min(abs(along - most), abs(level - (0.985 if hands else 0.95))) < CLOSE:
                    doubt.add(i)
                elif along <= most and level >= (0.985 if hands else 0.95):
                    turned = np.clip((level - 0.95) / 0.035, 0, 1) if edge[i] and not hands else 1
                    more = 1.5 * px(scale) if slit[i] else 0
                    if light[i] and (turns[j] or smooth[j]):  # the fold once more
                        aside = max(0, 0.5 * px(scale) + (aside - 3 * px(scale)) * 3.5 / 3)
                    room[i] = min(room[i], wide[i] + (aside + more - wide[i]) * stays[j] * turned)
                    if j in doubt and (fold[j] or slit[j]):
                        doubt.add(i)
        if not again:
            means = {i: even(i) for i in np.flatnonzero((fold | slit) & ~t.dropped)}
            for i, (mean, _) in means.items():
                stays[i] = np.clip((mean - closed[i]) / (wide[i] - closed[i]), 0, 1)
            doubt |= {i for i, (_, group) in means.items() if doubt & set(group)}
    unsure, bound = set(), np.zeros(len(t))
    give |= np.array([not t.dropped[i] and of_side(i) for i in range(len(t))], bool)
    for i in np.flatnonzero(give):
        mean, group = even(i)
        if doubt & set(group):
            unsure.add(i)
        bound[i] = max(0, 1 - mean / wide[i]) / (0.25 * max(mean - closed[i], 1e-6))
    return bound, give, unsure


def rungs(t, depth, number):
    """1 over the greatest radius of sites on short folds, by that of what these meet; which sites may be such."""
    fronts = [_front(t, i, depth, number) for i in range(len(t))]
    fold = np.array([f is not None and f[0] == f[1] and np.isfinite(depth[r, c])
                     for f, r, c in zip(fronts, t.site["row"], t.site["column"], strict=True)], bool)
    may = ~t.dropped & (fold | (t.family == NUMBER["crack"]) & (t.axis == JUNCTION))
    bound = np.zeros(len(t))
    for i in np.flatnonzero(may):
        if len(t.links[i]) != 2:
            continue
        arms = [[i, *along_from(t, i, j, 8)] for j in t.links[i]]
        if all(len(t.links[arm[-1]]) > 2 for arm in arms) and sum(map(len, arms)) - 4 <= 6:
            bound[i] = max(min(t.site["crowd"][j] for j in t.links[arm[-1]] if j != arm[-2]) for arm in arms)
    return bound, may


def evened(t, depth, number, most=20):
    """What every site lacks of its width, in 255ths, evened; where another mean may come out."""
    def fold(i):
        front = None if t.dropped[i] else _front(t, i, depth, number)
        return front is not None and front[0] == front[1] and np.isfinite(depth[t.site["row"][i], t.site["column"][i]])

    left, unsure = t.site["eased"].astype(float), set()
    for i in filter(fold, range(len(t))):
        group = [i]
        for first in t.links[i] if len(t.links[i]) <= 2 else ():
            before, at = i, first
            for _ in range(most):
                across = np.abs(t.at[at] - t.at[i]).min()
                if abs(across - 1) < CLOSE:
                    unsure.add(i)
                if not fold(at) or across >= 1:
                    break
                group.append(at)
                before, at = at, t.next(before, at)
                if at is None or at == i:
                    break
        left[i] = t.site["eased"][group].mean()
    return left, unsure
