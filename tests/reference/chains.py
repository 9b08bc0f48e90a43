# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's passes over chains of sites, which run from where not exactly two links meet: doubles, spurs, what is too
short. As in passes.py."""

import numpy as np

from .passes import CLOSE, COLOR, COLUMN, LIGHT, NUMBER, ROW, SEEN


def chains(t):
    """Lists of sites; a closed one, from its least site, ends with that again."""
    used, found = set(), []
    for closed in (False, True):
        for i, links in enumerate(t.links):
            for j in links:
                if (len(links) == 2) != closed or (i, j) in used or (closed and i in used):
                    continue
                run = t.walk(i, j)
                used |= {*zip(run, run[1:]), *zip(run[1:], run)}  # noqa: B905
                used |= set(run) if closed else set(run[1:-1])
                found.append(run)
    return found


def _turns(t, run):
    """Variance of the sines of half the angles by which a chain turns, pixel by pixel."""
    anchor, way, sines = t.at[run[0]], None, []
    for i in run:
        step = t.at[i] - anchor
        length = np.hypot(*step)
        if length < 1:
            continue
        step = step / length
        if way is not None:
            half = np.sqrt(max(0, (1 - step @ way) / 2))
            sines.append(-half if way[0] * step[1] - way[1] * step[0] < 0 else half)
        way, anchor = step, t.at[i]
    return float(np.var(sines)) if len(sines) > 1 else 0.0


def _way(t, i):
    """The way of the line at a site; None where several meet."""
    links = t.links[i]
    if len(links) not in (1, 2):
        return None
    return t.at[links[1] if len(links) == 2 else i] - t.at[links[0]]


def beside(t, shape):
    """Which sites are dropped with their chain, because it runs along another, wiggles, or is a speck of light or in a
    mirror; unsure."""
    runs = chains(t)
    chain_of = {i: k for k, run in enumerate(runs) for i in run if len(t.links[i]) <= 2}
    gone, unsure, doubt = set(), set(), [0.0]

    def along(i):
        way = _way(t, i)
        if way is None:
            return False
        for j, d in t.within(i, 3.5):
            other = _way(t, j)
            if t.dropped[j] or j in gone or t.rank[j] >= t.rank[i] or other is None or (
                    j in chain_of and chain_of[j] == chain_of.get(i)):
                continue
            cosine = abs(way @ other) - 0.85 * np.hypot(*way) * np.hypot(*other)
            doubt[0] += abs(d - 3.5) < CLOSE or abs(cosine) < CLOSE
            if d <= 3.5 and cosine >= 0:
                return True
        return False

    def weight(k):
        run = runs[k]
        its = [t.rank[i] for i in run if len(t.links[i]) <= 2]
        return min([*its, SEEN + 1]), -sum(t.apart(i, j) for i, j in zip(run, run[1:])), run[0], run[1]  # noqa: B905

    weights = sorted((weight(k), k) for k in range(len(runs)))
    marked = {}
    for rank in range(1, SEEN + 1):
        # what an older rank dropped is gone for the next, but not what the same one drops
        left = [i for i in np.flatnonzero(~t.dropped & (t.rank == rank)) if i not in gone]
        marked |= {i: along(i) for i in left}
        for (its, length, *_), k in weights:
            if its != rank:
                continue
            run, length = runs[k], -length
            doubt[0] = 0
            flags = [marked.get(i, False) for i in run]
            of_all = sum(t.apart(i, j) * (a + b) / 2
                         for i, j, a, b in zip(run, run[1:], flags, flags[1:]))  # noqa: B905
            closed = run[0] == run[-1] and len(t.links[run[0]]) == 2
            loose = sum(t.is_end(i) and not t.at_border(i, shape) for i in (run[0], run[-1]))
            whole = max(length, 1e-9)
            members = [i for i in run if len(t.links[i]) <= 2]
            margins = [-1 if rank == LIGHT or not loose else of_all / whole - 0.5,
                       _turns(t, run) - (0.3 if rank == LIGHT else 0.12)]
            if rank >= LIGHT and (loose == 2 or closed):
                least = 6 if rank == LIGHT else 9
                margins.append((least - length) / least)
            if min(abs(m) for m in margins) < 1e-4 or doubt[0]:
                unsure |= set(run)
            if max(margins) > 0:
                gone |= set(members)
    return gone, unsure


def spurs(t, shape):
    """Sites of what branches off a line and ends within 2 pixels, of a contour .75; unsure."""
    gone, unsure = set(), set()
    dropped = t.dropped.copy()
    for i in range(len(t)):
        if dropped[i] or len(t.links[i]) != 1 or t.at_border(i, shape):
            continue
        longest = 2 if t.rank[i] else 0.75
        run, length = [i, t.links[i][0]], 0.0
        length = t.apart(*run)
        while length < longest and (ahead := t.next(run[-2], run[-1])) is not None:
            length += t.apart(run[-1], ahead)
            run.append(ahead)
        if abs(length - longest) < CLOSE:
            unsure |= set(run)
        if len(t.links[run[-1]]) > 2 and length < longest:
            gone |= set(run[:-1])
            dropped[run[:-1]] = True
    return gone, unsure


def short(t, least, shape, numbers):
    """Sites that hang together, begin and end in the open and are in all shorter than `least`, by site, at one of their
    ends; outlines, between `numbers` of things, are none; cracks by themselves likewise; and of what goes round a
    colour, some of it weak, and is shorter than twice that at a weak one, or round light and four times, or round a
    colour and 6.5 pixels; unsure; and of all which share of the width is left: less than 1 where they go round a colour
    in less than 9.5 pixels."""
    gone, unsure, share = set(), set(), np.ones(len(t))
    row, column = t.site["row"], t.site["column"]
    beyond = ((row + (t.site["axis"] != ROW)).clip(0, shape[0] - 1),
              (column + (t.site["axis"] != COLUMN)).clip(0, shape[1] - 1))
    bounds = True if numbers is None else numbers[row, column] != numbers[beyond]
    meant = (t.rank == 0) & bounds

    def free(i):
        return i not in gone and t.is_end(i) and not t.at_border(i, shape)

    for i in range(len(t)):
        lone = t.family[i] == NUMBER["crack"] and not (meant[i] or t.links[i] or t.dropped[i])
        if lone and least[i] > 0 and not t.at_border(i, shape):
            gone.add(i)
        if not free(i):
            continue
        piece, length = [i], 0.0
        for k in piece:
            piece += [j for j in t.links[k] if j not in piece]
            length += sum(t.apart(k, j) for j in t.links[k]) / 2
            if length > least[i] + 1:
                break
        if meant[piece].any() or any(len(t.links[k]) == 1 and not free(k) for k in piece):
            continue
        if abs(length - least[i]) < CLOSE * len(piece):
            unsure |= set(piece)
        if length < least[i]:
            gone |= set(piece)
    for run in chains(t):
        rank = t.rank[run[0]]
        if run[0] != run[-1] or any(len(t.links[i]) != 2 for i in run) or rank not in (COLOR, LIGHT) or (
                t.rank[run] != rank).any():
            continue
        length = sum(t.apart(i, j) for i, j in zip(run, run[1:]))  # noqa: B905
        weak, times = [i for i in run[1:] if t.site["weak"][i] or rank == LIGHT], 2 if rank == COLOR else 4
        if any(abs(length - times * least[i]) < CLOSE * len(run) for i in weak):
            unsure |= set(run)
        left = (length - 6.5) / 3 if rank == COLOR else 1
        if abs(left) < CLOSE * len(run):
            unsure |= set(run)
        if left <= 0 or any(length < times * least[i] for i in weak):
            gone |= set(run)
        share[run] = min(left, 1)
    return gone, unsure, share
