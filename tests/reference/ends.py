# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's loose ends: one round of leading each on to a corner, to another line or to its own continuation."""

from dataclasses import dataclass, field

import numpy as np

from . import metric
from .metric import clamp01
from .passes import BANDS, CLOSE, COLOR, FORM, LIGHT

WHOLE = slice(None)


class Picture:
    """What a layer shows at a place, as an edge of a rank is looked for: values, and how far apart they must be."""

    def __init__(self, layers, params):
        lit = params["color_layer"] == "LIT"
        color = metric.encode(clamp01(layers.combined[..., :3] if lit else layers.albedo))
        self.of = [(layers.normal, 0.12, WHOLE), (layers.normal, 0.12, WHOLE), (color, 0.02, WHOLE),
                   (layers.normal, 0.12, WHOLE), (layers.diffuse, 0.05, WHOLE)]
        self.linear = [layers.normal, layers.normal, layers.combined[..., :3] if lit else layers.albedo, layers.normal,
                       layers.diffuse]
        self.seen = layers.seen_color, layers.seen_normal

    def look(self, rank, at):
        """(values, values of a second layer), between pixels."""
        if rank <= LIGHT:
            value = bilinear(self.linear[rank], at)
            return (metric.encode(clamp01(value)) if rank == COLOR else value), np.zeros(3)
        return metric.encode(clamp01(bilinear(self.seen[0], at))), bilinear(self.seen[1], at)

    def margin(self, rank, one, two):
        """0 or more: they differ."""
        (a, c), (b, d) = self.look(rank, one), self.look(rank, two)
        least = (0.12, 0.12, 0.02, 0.12, 0.05, 0.02)[rank]
        return max(np.linalg.norm(a - b) - least, np.linalg.norm(c - d) - 0.2)

    def agrees(self, rank, a, b):
        """Whether at a quarter, half and three quarters of the way what lies 1.5 pixels to either side differs, of
        shapes and creases a pixel; of light by anything."""
        if rank == FORM:
            return 1.0
        side = _beside(a, b) / (1.5 if rank < COLOR else 1)
        ways = [(p + side, p - side) for p in (a + (b - a) * k / 4 for k in (1, 2, 3))]
        if rank == LIGHT:
            return min(np.linalg.norm(self.look(rank, p)[0] - self.look(rank, q)[0]) for p, q in ways) - 0.002
        return min(self.margin(rank, p, q) for p, q in ways)

    def wedge(self, rank, a, b, corner):
        """Whether what two lines enclose that would meet at the corner differs from what lies outside of either."""
        inside, margins = (a + b + corner) / 3, []
        for p, other in ((a, b), (b, a)):
            if np.hypot(*(corner - p)) <= 1e-6:
                return -1.0
            side = _beside(p, corner)
            outside = (p + corner) / 2 + side * (-1 if side @ (other - p) > 0 else 1)
            margins.append(self.margin(rank, inside, outside))
        return min(margins)


    def corner(self, a, b, corner):
        """0 or more: sides of a colour meet in the corner, for halfway to it from between the ends half of what the
        wedge is wide there, at most half a pixel, shows what lies within."""
        middle, way = (a + b) / 2, corner - (a + b) / 2
        aside = 1.5 * way / np.hypot(*way)
        inside, outside, between = (bilinear(self.linear[COLOR], middle + off) for off in (-aside, aside, way / 2))
        least = min(np.hypot(*(b - a)), 2) / 4 * (inside - outside) @ (inside - outside)
        return (between - outside) @ (inside - outside) - least


def bilinear(image, at):
    height, width = image.shape[:2]
    x, y = np.clip(at[0], 0, width - 1), np.clip(at[1], 0, height - 1)
    x0, y0 = int(x), int(y)
    x1, y1 = min(x0 + 1, width - 1), min(y0 + 1, height - 1)
    top = metric.mix(image[y0, x0], image[y0, x1], x - x0)
    return metric.mix(top, metric.mix(image[y1, x0], image[y1, x1], x - x0), y - y0)


def _beside(a, b):
    """1.5 pixels at right angles to the way from a to b."""
    way = b - a
    return 1.5 * np.array([-way[1], way[0]]) / np.hypot(*way)


@dataclass
class End:
    site: int
    way: np.ndarray  # unit, ahead
    over: float      # pixels over which it is taken
    aims: list = field(default_factory=list)  # (cost, site), the cheapest first
    taken: bool = False


def _direction(t, i):
    """From the first site of its chain that is 3 pixels away, or the last, and how far that is."""
    before, at = i, t.links[i][0]
    while t.apart(i, at) < 3 and (ahead := t.next(before, at)) is not None:
        before, at = at, ahead
    way = t.at[i] - t.at[at]
    length = np.hypot(*way)
    return way / length if length > 0 else way, length


def _own(t, i):
    """It and the next eight sites of its chain."""
    own = [i, t.links[i][0]]
    while len(own) < 9 and (ahead := t.next(own[-2], own[-1])) is not None:
        own.append(ahead)
    return own


def _aims(t, end, picture, doubt):
    i, found, own = end.site, [], _own(t, end.site)
    for j, d in t.within(i, 6):
        older = t.rank[j] <= t.rank[i] or (t.rank[i], t.rank[j]) == (0, 1)
        if t.dropped[j] or not older or d == 0 or j in own:
            continue
        cosine = (t.at[j] - t.at[i]) @ end.way / d
        stripe = t.family[j] in BANDS and t.family[i] == t.family[j] + 1
        margin = cosine - (0.94 if d > 3 else 0.5 if stripe else 0.7)
        if d > 3 and margin > -CLOSE:
            margin = min(margin, picture.agrees(t.rank[i], t.at[i], t.at[j]), 6 - d)
        if abs(margin) < CLOSE or abs(d - 3) < CLOSE:
            doubt.add(i)
        if margin >= 0:
            found.append((d / cosine**4, j))
    end.aims = sorted(found)[:2]


def _barred(t, i, corner):
    """More than 0: a line that is no younger crosses the way from an end to a corner, 1.5 pixels from both."""
    way = corner - t.at[i]
    length = np.hypot(*way)
    if length <= 3:
        return length - 3
    off = t.at - t.at[i]
    along, aside = off @ way / length, np.abs(off[:, 0] * way[1] - off[:, 1] * way[0]) / length
    margin = np.min([along - 1.5, length - 1.5 - along, 0.75 - aside], axis=0)
    return margin[~t.dropped & (t.rank <= t.rank[i])].max()


def _join(t, a, b, picture, doubt):
    """(cost, corner or None) of joining two ends; None if they don't belong together."""
    i, j = a.site, b.site
    low, high = sorted((t.rank[i], t.rank[j]))
    gap = t.at[j] - t.at[i]
    length = np.hypot(*gap)
    form = (low, high) == (0, FORM)
    if (low != high and high > 1 and not form) or not 0 < length <= 8:
        return None
    straight = min(a.way @ gap, -(b.way @ gap)) / length - 0.94
    if abs(straight) < CLOSE or abs(length - 3) < CLOSE:
        doubt.update((i, j))
    if straight >= 0:
        agrees = 1.0 if length <= 3 or form else picture.agrees(t.rank[i], t.at[i], t.at[j])
        if abs(agrees) < CLOSE:
            doubt.update((i, j))
        return (length / 2, None) if agrees >= 0 else None
    if form:
        return None
    sine = a.way[0] * b.way[1] - a.way[1] * b.way[0]
    meet = -1.0
    if abs(sine) >= 1e-9:
        u = (gap[0] * b.way[1] - gap[1] * b.way[0]) / sine
        v = (gap[0] * a.way[1] - gap[1] * a.way[0]) / sine
        cost, corner = max(u, v), t.at[i] + u * a.way
        meet = min(abs(sine) - 0.25, min(u, v) + 0.5, 10 - cost)
    if low == high == COLOR and length <= 3:  # what is small and round turns faster than its ends tell
        shown = min(meet, picture.corner(t.at[i], t.at[j], corner) if meet >= -CLOSE else -1.0)
        if abs(shown) < CLOSE:
            doubt.update((i, j))
        if shown < 0:
            agrees = picture.agrees(COLOR, t.at[i], t.at[j])
            around = _around(t, i, j)
            if abs(agrees) < CLOSE or abs(around - np.pi / 2 * length) < CLOSE:
                doubt.update((i, j))
            return (length / 2, None) if agrees >= 0 and around > np.pi / 2 * length else None
    if meet < -CLOSE:
        return None
    plain = min(4 - cost, abs(sine) - 0.34)
    told = min(a.over, b.over) - 1.5
    margin = min(max(plain, plain if plain > CLOSE else min(told, picture.wedge(high, t.at[i], t.at[j], corner))),
                 meet, -_barred(t, i, corner), -_barred(t, j, corner))
    if abs(margin) < 10 * CLOSE:
        doubt.update((i, j))
    return (cost, corner) if margin >= 0 else None


def _around(t, i, j):
    """How long the way from one end to another is along their chain; infinite: they are of two."""
    run = t.walk(i, t.links[i][0])
    return sum(t.apart(*pair) for pair in zip(run, run[1:])) if run[-1] == j else np.inf  # noqa: B905


def lead_on(t, layers, params):
    """(links (i, j), corners [(i, j, place)], unsure sites): ends are joined two by two, the cheapest first, unless
    one of them should rather go to something else; then each goes on to what lies ahead of it."""
    picture, doubt = Picture(layers, params), set()
    ends = {i: End(i, *_direction(t, i)) for i in range(len(t)) if t.is_end(i)}
    for end in ends.values():
        _aims(t, end, picture, doubt)
    pairs = []
    for i, a in ends.items():
        for j in ends:
            if j > i and np.abs(t.at[j] - t.at[i]).max() <= 8 and (found := _join(t, a, ends[j], picture, doubt)):
                pairs.append((found[0], i, j, found[1]))
    links, corners = [], []
    for cost, i, j, corner in sorted(pairs, key=lambda pair: pair[:3]):
        a, b = ends[i], ends[j]
        rather = [end.aims[0][0] for end, other in ((a, j), (b, i)) if end.aims and end.aims[0][1] != other]
        if any(abs(aim - cost + 0.25) < 10 * CLOSE for aim in rather):
            doubt.update((i, j))
        if a.taken or b.taken or any(aim < cost - 0.25 for aim in rather):
            continue
        a.taken = b.taken = True
        if corner is None:
            links.append((i, j))
        else:
            corners.append((i, j, corner))
    for i, end in ends.items():
        if end.taken or not end.aims:
            continue
        if len(end.aims) > 1 and end.aims[1][0] - end.aims[0][0] < 10 * CLOSE:
            doubt.add(i)
        to = end.aims[0][1]
        other = ends.get(to)
        if other is None or to > i or other.taken or not other.aims or other.aims[0][1] != i:
            links.append((i, to))
    return links, corners, doubt
