# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's passes over sites, each on what the one before has left: who owns a place, what hangs together, how evenly.

Sites are rows of a table; links are lists of neighbours by site. Every function gives what should be found, and of
which answers float32 may give another: where two numbers are closer than rounding, one of which had to be larger."""

import math

import numpy as np

FAMILIES = ("crack", "thin", "normal_band", "normal", "color_band", "color", "valley",
            "light_band", "light_step", "light", "seen_normal_band", "seen_normal", "seen_color_band", "seen_color",
            "seen_depth")  # older first
CRACKS = {"crack", "light"}
ROW, COLUMN, JUNCTION = 0, 1, 2
SITE = np.dtype([*((name, np.float32) for name in ("x", "y", "strength", "thin", "half", "inside", "crowd", "tapers")),
                 *((name, np.int32) for name in ("column", "row", "near_x", "near_y", "family", "axis", "source",
                                                 "dropped", "crumb", "held", "weak", "eased")),
                 ("step", np.int32, 3)])
CLOSE = 1e-5  # pixels: lengths that differ by less may come out either way
NUMBER = {name: k for k, name in enumerate(FAMILIES)}
RANK = np.array([0, 0, 1, 1, 2, 2, 3, 4, 4, 4, 5, 5, 5, 5, 5])
COLOR, FORM, LIGHT, SEEN = 2, 3, 4, 5
BANDS = [k for k, name in enumerate(FAMILIES) if name.endswith("band")]


class Table:
    """Sites as float64 columns, and their links."""

    def __init__(self, site, link=()):
        self.site = site
        self.at = np.stack([site["x"], site["y"]], -1).astype(float)
        self.family, self.dropped, self.axis = site["family"], site["dropped"] > 0, site["axis"]
        self.step, self.rank = site["step"].astype(float), RANK[site["family"]]
        self.links = [[] for _ in site]
        for i, j in link:
            self.links[i].append(int(j))

    def __len__(self):
        return len(self.site)

    def within(self, i, reach):
        """Sites at most `reach` from site i, without it, and their distances; by number."""
        d = np.hypot(*(self.at - self.at[i]).T)
        near = np.flatnonzero(d <= reach + CLOSE)
        return [(int(j), d[j]) for j in near if j != i]

    def is_end(self, i):
        return not self.dropped[i] and len(self.links[i]) == 1

    def at_border(self, i, shape):
        x, y = self.at[i]
        return x < 2 or y < 2 or x > shape[1] - 3 or y > shape[0] - 3

    def next(self, before, i):
        """The next site of a chain, coming from `before`; None at its end."""
        if len(self.links[i]) != 2:
            return None
        a, b = self.links[i]
        return b if a == before else a

    def walk(self, first, second):
        """The sites of a chain from `first` on, round to it again if it is closed."""
        run = [first, second]
        while run[-1] != first and (ahead := self.next(run[-2], run[-1])) is not None:
            run.append(ahead)
        return run

    def apart(self, i, j):
        return math.dist(self.at[i], self.at[j])


# What a family may keep: what is clear of the older ones by 1.5 pixels, a step by 2 of a band in the same layer, a
# crossing of a threshold of light by 2 across a band


def owned(t, family):
    """(which sites of a family are not, whether rounding may say otherwise); `dropped` of the older ones is known."""
    gone, unsure = set(), False
    old = (t.family < family) & ~t.dropped
    clear = np.where((t.family == family - 1) & np.isin(t.family, BANDS), 2.0, 1.5)
    for i in np.flatnonzero(t.family == family):
        turns = (FAMILIES[family] == "light") & (t.family == NUMBER["light_step"]) & (t.axis != t.axis[i])
        margin = np.where(turns, 0.75, clear) - np.hypot(*(t.at - t.at[i]).T)
        if FAMILIES[family] == "light":
            along, across = np.abs(t.at - t.at[i]).T[::1 if t.axis[i] == COLUMN else -1]
            stripe = (t.family == NUMBER["light_band"]) & (t.axis == t.axis[i])
            margin = np.where(stripe, np.maximum(margin, np.minimum(1 - along, 2 - across)), margin)
        margin = margin[old]
        gone |= {int(i)} if (margin > 0).any() else set()
        unsure |= abs(margin.max(initial=-1)) < CLOSE
    return gone, unsure


# Links: cracks join the two that cut a square of four pixel centres, ridges what is within 1.6 pixels and goes its way


def _kin(t, i, j):
    """Steps of a colour may be 2 pixels apart where one is in a row and the other in a column."""
    along = t.axis[i] == t.axis[j] and t.step[i] @ t.step[j] < 0
    reach = 2 if t.family[i] == NUMBER["color"] and t.axis[i] != t.axis[j] else 1.6
    return t.family[i] == t.family[j] and not t.dropped[j] and not along and t.apart(i, j) <= reach


def close_sites(t, i):
    return [j for j, _ in t.within(i, 2) if _kin(t, i, j)]


def weak(t, family):
    """(which weak sites of colours, of normals, of stripes of light, what is seen hang together with
    no other, which with one that is not weak, or a step with a stripe of its layer within 3 pixels)."""
    if FAMILIES[family] not in ("color_band", "color", "normal", "valley", "light_band", "seen_normal", "seen_color",
                                "seen_depth"):
        return set(), set()
    own = {int(i) for i in np.flatnonzero((t.family == family) & ~t.dropped)}
    strong = {i for i in own if not t.site["weak"][i]}
    stripe = family - 1 if family - 1 in BANDS else None
    kept = strong | {i for i in own - strong
                     if any(t.family[j] == stripe and not t.dropped[j] and d <= 3 for j, d in t.within(i, 3))}
    growing = list(kept)
    while growing:
        new = set(close_sites(t, growing.pop())) - kept
        kept |= new
        growing += new
    return own - kept, kept - strong


def _hanging(t, i, most):
    """How many sites hang together with one and itself, at most so many."""
    found = [i]
    for j in found:
        found += [k for k in close_sites(t, j) if k not in found]
        if len(found) >= most:
            return most
    return len(found)


def crumbs(t, family):
    """Which sites are too few that hang together, to be a line."""
    few = FAMILIES[family].startswith(("seen", "valley")) or family in BANDS
    least = 9 if FAMILIES[family] == "seen_depth" else 4 if few else 3
    own = np.flatnonzero((t.family == family) & ~t.dropped) if family > NUMBER["thin"] else []
    return {int(i) for i in own if _hanging(t, i, least) < least}


def passage(layers, row, column):
    """Of a square of four pixels with cracks between all: 1 if the first and the last show one thing, which goes on
    between the others; 2 for the other two; 0 for neither. Of two such things the one that fewer of the 4x4 about them
    show, else the nearer. A wire that shows on no more than four of these has no two sides."""
    square = slice(row, row + 2), slice(column, column + 2)
    (a, b), (c, d) = layers.object[square]
    if {a, d} & {b, c} or (a != d and b != c):
        return 0
    about = layers.object[max(0, row - 1):row + 3, max(0, column - 1):column + 3]
    one, two = ((about == own).sum() if own == other else np.inf for own, other in ((a, d), (b, c)))
    z = layers.depth[square]
    own, other = min(z[0, 0], z[1, 1]), min(z[0, 1], z[1, 0])
    if one == two and own == other:
        return 0
    first = own < other if one == two else one < two
    ahead = 0 if own == other else other - own if first else own - other
    wire = ahead > 0.01 * (layers.height if layers.orthographic else min(own, other))
    return 0 if min(one, two) <= 4 and wire else 1 if first else 2


def crack_links(t, layers):
    """Pairs (i, j), each once: a square's two cracks, or each of three or four and their junction; where a thing goes
    on aslant, the two round each pixel beside it."""
    number = {(t.family[i], t.site["row"][i], t.site["column"][i], t.axis[i]): i for i in range(len(t))
              if not t.dropped[i] and FAMILIES[t.family[i]] in CRACKS}
    pairs, single = set(), set()
    squares = {(f, r - (a == ROW and k), c - (a == COLUMN and k)) for f, r, c, a in number for k in (0, 1)
               if a != JUNCTION} | {key[:3] for key in number if key[3] == JUNCTION}
    marked = {(s["row"], s["column"], s["axis"]) for s in t.site[t.family == NUMBER["crack"]]}
    for f, r, c in squares:
        keys = (r, c, ROW), (r + 1, c, ROW), (r, c, COLUMN), (r, c + 1, COLUMN)
        sides = [number.get((f, *key)) for key in keys]
        way = passage(layers, r, c) if f == NUMBER["crack"] and marked.issuperset(keys) else 0
        if way:
            pairs |= {tuple(sorted((sides[i], sides[j]))) for i, j in (((0, 3), (1, 2)) if way == 1 else
                                                                       ((0, 2), (1, 3)))
                      if sides[i] is not None and sides[j] is not None}
            continue
        sides = [i for i in sides if i is not None]
        hub = number.get((f, r, c, JUNCTION))
        if len(sides) == 2:
            pairs.add(tuple(sorted(sides)))
        elif len(sides) > 2 and hub is not None:
            pairs |= {tuple(sorted((hub, i))) for i in sides}
        if hub is not None and len(sides) < 3:
            single.add(hub)
    return pairs, single


def ridge_links(t):
    """(pairs, unsure pairs): close sites, but for those that two shorter links join."""
    near = {i: close_sites(t, i) for i in range(len(t)) if not t.dropped[i] and FAMILIES[t.family[i]] not in CRACKS}
    pairs, unsure = set(), set()

    def order(i, j):
        return np.float32(t.apart(i, j) ** 2), min(i, j), max(i, j)

    for i, own in near.items():
        for j in own:
            if j < i:
                continue
            detours = [k for k in own if k != j and k in near[j]]
            margins = [t.apart(i, j) - max(t.apart(i, k), t.apart(k, j)) for k in detours]
            margins += [t.apart(i, j) - reach for reach in (1.6, 2)]
            if any(0 < abs(m) < CLOSE for m in margins):
                unsure.add((i, j))
            if not any(order(i, k) < order(i, j) and order(k, j) < order(i, j) for k in detours):
                pairs.add((i, j))
    return pairs, unsure


# Ties of thin sites: to a crack at most 1.8 pixels away, and to one on the other side


def ties(t):
    pairs, unsure = [], set()
    for i in np.flatnonzero((t.family == NUMBER["thin"]) & ~t.dropped):
        other = t.links[i][0] if len(t.links[i]) == 1 else None
        for _ in range(2 - len(t.links[i])):
            found = []
            for j, d in t.within(i, 1.8):
                if t.dropped[j] or t.family[j] != NUMBER["crack"]:
                    continue
                margin = 1.8 - d
                if other is not None:
                    to, away = t.at[j] - t.at[i], t.at[other] - t.at[i]
                    margin = min(margin, -0.3 * np.hypot(*to) * np.hypot(*away) - to @ away)
                if abs(margin) < CLOSE:
                    unsure.add(int(i))
                if margin >= 0:
                    found.append((d, j))
            if not found:
                break
            found.sort()
            if len(found) > 1 and 0 < found[1][0] - found[0][0] < CLOSE:
                unsure.add(int(i))
            other = found[0][1]
            pairs.append((int(i), int(other)))
    return pairs, unsure


def hits(t, i):
    """Where the thing covers a pixel centre again on both sides of a thin site: [(links to it, site, pixels)], nearest
    first."""
    found = []
    for first in t.links[i]:
        before, at, links, along = i, first, 1, t.apart(i, first)
        while at is not None and at != i and t.family[at] == NUMBER["thin"] and not t.dropped[at]:
            before, at = at, t.next(before, at)
            links, along = links + 1, along + (t.apart(before, at) if at is not None else 0)
        if at is not None and at != i and not t.dropped[at]:
            found.append((links, at, along))
    return sorted(found[:2])


def told_by(t):
    """By site, which one tells what the line is of."""
    own = np.arange(len(t))
    for i in np.flatnonzero(t.family == NUMBER["thin"]):
        own[i] = next((at for _, at, _ in hits(t, i)), i)
    return own


# Evenness: twice, half of what a site lies beside the line between its neighbours, if that is at most 0.3 pixels


def smooth(t):
    at, unsure = t.at.copy(), set()
    for _ in range(2):
        moved = at.copy()
        for i, links in enumerate(t.links):
            if t.dropped[i] or len(links) != 2 or FAMILIES[t.family[i]] in ("light_step", "light"):
                continue
            a, b = at[links[0]], at[links[1]]
            way = b - a
            square = max(way @ way, 0.01)
            off = ((at[i] - a)[0] * way[1] - (at[i] - a)[1] * way[0]) / square
            beside = abs(off) * np.sqrt(way @ way)
            if abs(beside - 0.3) < CLOSE:
                unsure.add(i)
            if beside <= 0.3:
                moved[i] = at[i] + 0.5 * off * np.array([-way[1], way[0]])
        at = moved
    return at, unsure


# Room between lines of colours


def px(scale, least=1.0):
    """Pixels in a px of room, of a frame with so many."""
    return min(max(scale, least), 8.0)


def _lean(t, i, axis):
    """Pixels to the other side for each along an axis, straight across the line of a site, up to 45 degrees."""
    if len(t.links[i]) not in (1, 2):
        return 0.0
    first, last = t.links[i][0], t.links[i][1] if len(t.links[i]) == 2 else i
    way = t.at[last] - t.at[first]
    if way[axis] == 0:
        return 0.0
    return -way[axis] / way[1 - axis] if abs(way[1 - axis]) > abs(way[axis]) else -np.sign(
        way[axis]) * (-1 if way[1 - axis] < 0 else 1)


def crowd(t, shape, scale, turns):
    """1 over the greatest radius of each site, 0 where it is not bounded; unsure. turns: by row, column and axis, at
    which share of the pixels about colours turn back, and whether that is sure."""
    found = [_crowd(t, shape, scale, rank, turns if rank == COLOR else lambda *_: (0, False))
             for rank in (COLOR, LIGHT)]
    return found[0][0] + found[1][0], found[0][1] | found[1][1]


def _crowd(t, shape, scale, rank, turns):
    """Of the sites of a rank."""
    reach, spread, gone = px(scale, 0.6) * np.array([10.0, 20.0, 2.5])
    counts = [i for i in range(len(t)) if t.rank[i] == rank and (not t.dropped[i] or t.site["crumb"][i])]
    near, doubt = {}, set()
    for i in counts:
        ahead_axis = 1 if t.axis[i] == COLUMN else 0
        lean, gap = _lean(t, i, ahead_axis), t.at[counts] - t.at[i]
        aside = np.abs(gap[:, 1 - ahead_axis])
        ahead = (gap[:, ahead_axis] + lean * gap[:, 1 - ahead_axis]) / np.hypot(1, lean)
        back = (t.axis[counts] == t.axis[i]) & (t.step[counts] @ t.step[i] < 0)
        least, most = np.where(back, 1, 1.75), np.where(back, 4, 1.5)
        off = np.abs([np.abs(ahead) - least, aside - most])
        doubt |= {i} if ((off > 0) & (off < CLOSE)).any() else set()
        there = (np.abs(ahead) > least) & (aside <= most)
        room = max(np.abs(ahead[there & side]).min(initial=reach) for side in (ahead > 0, ahead <= 0))
        stripe = FAMILIES[t.family[i]] in ("color_band", "light_band")
        near[i] = 1 / (room / (2 - room / reach) if stripe else room)
        back, open_ = turns(*(int(t.site[name][i]) for name in ("row", "column", "axis")))
        near[i] = max(near[i], min(max((back - 0.25) / 0.2, 0.0), 1.0))
        doubt |= {i} if open_ else set()
    cells = {}
    for i in counts:  # of 4 pixels each way
        pixel = np.clip(np.floor(t.at[i] + 0.5), 0, (shape[1] - 1, shape[0] - 1)).astype(int) // 4
        cells.setdefault(tuple(pixel), []).append(i)
    places = 4 * np.array([*cells], float).reshape(-1, 2) + 1.5
    sums = np.array([[sum(near[j] for j in members), len(members)] for members in cells.values()]).reshape(-1, 2)
    bound = np.zeros(len(t))
    for i in counts:
        if t.dropped[i]:
            continue
        total, weights = np.prod(np.maximum(0, 1 - np.abs(places - t.at[i]) / spread), 1) @ sums
        mean = weights / total
        bound[i] = (1 - mean / reach) / (0.25 * (mean - gone if mean > gone else 1e-6))
    return bound, doubt


def along_from(t, i, j, most=12):
    """So many sites of a line from i by way of j; once round at most."""
    out, before = [], i
    while len(out) < most and j != i:
        out.append(j)
        if len(t.links[j]) != 2:
            break
        one, two = t.links[j]
        before, j = j, two if one == before else one
    return out
