# SPDX-License-Identifier: GPL-3.0-or-later
"""What gives way to a line beside it, in FINE: edges of meshes, lines by hand, light, and contours within a thing."""

import numpy as np

from .passes import CLOSE, COLUMN, JUNCTION, NUMBER, ROW, along_from, px


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


def _before(way, gap):
    """Whether what lies `gap` off a line is left of it, or above; unsure."""
    (x, y), aside = way, gap @ (way[1], -way[0])
    aside = -aside if (y > 0 if abs(y) > abs(x) else x < 0) else aside
    return aside > 0.7, abs(aside - 0.7) < CLOSE or abs(abs(x) - abs(y)) < CLOSE


def _double(t, i, j, way, fronts):
    """Whether a contour within a thing is a double of another one of it; unsure."""
    own, other = fronts[i], fronts[j]
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


def give_way(t, scale, depth, number=None):
    """1 over the greatest radius of sites on edges of meshes, lines by hand, of light, and contours within a thing, 0
    where it is not bounded; which these are; unsure. number: of objects."""
    def way(i):
        ends = [*t.links[i], i][:2]
        out = (t.at[ends[1]] - t.at[ends[0]]) * (-1 if len(t.links[i]) == 1 else 1)
        return out / max(np.linalg.norm(out), 1e-12)

    def own(i):
        return {j for first in t.links[i] for j in along_from(t, i, first)}

    def even(i):
        """The mean along the line; of which sites."""
        arms = [along_from(t, i, j) for j in t.links[i]] if len(t.links[i]) == 2 else [[]]
        both = min(len(arm) for arm in arms)
        group = [i, *(j for arm in arms for j in arm[:both] if not meeting[j])]
        if t.family[i] == NUMBER["mark"]:  # all between two places where lines meet
            group = [i, *(j for arm in arms for j in arm if len(t.links[j]) <= 2)]
        if len(t.links[i]) > 2:  # the line that goes through with most room
            return sorted(room[t.links[i]])[-2], t.links[i]
        return float(np.mean(room[group])), group

    edge, light = np.isin(t.family, (NUMBER["mark"], NUMBER["crease"])), t.rank == 3
    fronts = [_front(t, i, depth, number) for i in range(len(t))]
    fold = np.array([f is not None and f[0] == f[1] and np.isfinite(depth[r, c])
                     for f, r, c in zip(fronts, t.site["row"], t.site["column"], strict=True)], bool)
    meeting = (t.family == NUMBER["crack"]) & (t.axis == JUNCTION)
    give = ~t.dropped & (edge | light | fold | meeting)
    wide = px(scale) * np.where(t.family == NUMBER["mark"], 3, np.where(t.rank == 0, 5, 4))
    closed = px(scale) * np.where(edge, 1.5, np.where(light, 0.5, 3))
    stays, doubt = np.ones(len(t)), set()
    ways = np.array([way(i) if len(t.links[i]) in (1, 2) else (0, 0) for i in range(len(t))]).reshape(-1, 2)
    lines = np.flatnonzero(~t.dropped & ways.any(1))
    for again in (False, True):  # what another gives way to may itself give way
        room = 1.0 * wide
        for i in lines:
            if not give[i] or meeting[i]:
                continue
            x, y = ways[i]
            gaps = t.at[lines] - t.at[i]
            near = (abs(gaps @ (x, y)) <= 1 + CLOSE) & (abs(gaps @ (y, -x)) < wide[i])
            for j, gap in zip(lines[near], gaps[near], strict=True):
                along, aside, level = abs(gap @ (x, y)), abs(gap @ (y, -x)), abs(ways[j] @ (x, y))
                hands, unsure = t.family[i] == t.family[j] == NUMBER["mark"], False
                if hands:
                    older, unsure = _before(ways[i], gap)
                elif fold[i]:
                    older, unsure = _double(t, i, j, ways[i], fronts)
                else:
                    older = t.family[j] < t.family[i] if edge[i] else t.rank[j] < 3
                if not (older or unsure) or (hands or fold[i]) and j in own(i):
                    continue
                if unsure or min(abs(along - 1), abs(level - (0.985 if hands else 0.95))) < CLOSE:
                    doubt.add(i)
                elif along <= 1 and level >= (0.985 if hands else 0.95):
                    turned = np.clip((level - 0.95) / 0.035, 0, 1) if edge[i] and not hands else 1
                    room[i] = min(room[i], wide[i] + (aside - wide[i]) * stays[j] * turned)
                    if j in doubt and fold[j]:
                        doubt.add(i)
        if not again:
            means = {i: even(i) for i in np.flatnonzero(fold & ~t.dropped)}
            for i, (mean, _) in means.items():
                stays[i] = np.clip((mean - closed[i]) / (wide[i] - closed[i]), 0, 1)
            doubt |= {i for i, (_, group) in means.items() if doubt & set(group)}
    unsure, bound = set(), np.zeros(len(t))
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
