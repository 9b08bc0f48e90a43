# SPDX-License-Identifier: GPL-3.0-or-later
"""Borders of light that give way to an older line beside them, in FINE."""

import numpy as np

from .passes import CLOSE, LIGHT, along_from, px


def give_way(t, scale):
    """1 over the greatest radius of sites of light, 0 where it is not bounded; which these are; unsure."""
    def way(i):
        ends = [*t.links[i], i][:2]
        out = (t.at[ends[1]] - t.at[ends[0]]) * (-1 if len(t.links[i]) == 1 else 1)
        return out / max(np.linalg.norm(out), 1e-12)

    def even(i):
        """The mean along the line, as far both ways as it goes; of which sites."""
        if len(t.links[i]) > 2:  # the line that goes through with most room
            return sorted(room[t.links[i]])[-2], t.links[i]
        arms = [along_from(t, i, j) for j in t.links[i]] if len(t.links[i]) == 2 else [[]]
        both = min(len(arm) for arm in arms)
        group = [i, *(j for arm in arms for j in arm[:both])]
        return float(np.mean(room[group])), group

    light, wide, closed = ~t.dropped & (t.rank == LIGHT), 4 * px(scale), 0.5 * px(scale)
    ways = np.array([way(i) if len(t.links[i]) in (1, 2) else (0, 0) for i in range(len(t))]).reshape(-1, 2)
    lines, doubt, room = np.flatnonzero(~t.dropped & ways.any(1)), set(), np.full(len(t), wide)
    for i in lines[light[lines]]:
        x, y = ways[i]
        for j in lines[t.rank[lines] < LIGHT]:
            gap, level = t.at[j] - t.at[i], abs(ways[j] @ (x, y))
            along, aside = abs(gap @ (x, y)), abs(gap @ (y, -x))
            if along > 1 + CLOSE or aside >= wide:
                continue
            if min(abs(along - 1), abs(level - 0.95)) < CLOSE:
                doubt.add(i)
            elif along <= 1 and level >= 0.95:
                room[i] = min(room[i], aside)
    unsure, bound = set(), np.zeros(len(t))
    for i in np.flatnonzero(light):
        mean, group = even(i)
        if doubt & set(group):
            unsure.add(i)
        bound[i] = max(0, 1 - mean / wide) / (0.25 * max(mean - closed, 1e-6))
    return bound, light, unsure
