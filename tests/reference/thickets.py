# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lines would cover more of the picture than they may: they get thinner, and the lesser are left out."""

import numpy as np

from .hand import solid
from .metric import clamp01, mix
from .passes import FAMILIES, NUMBER, told_by

PLANES = 64
SEED = 0x6d617373


class Grid:
    """Of nodes, so many px apart, on which ink is weighed, by how much lines matter."""

    def __init__(self, t, unit, shape, node):
        self.t, self.step = t, max(node * unit, 2)
        self.shape = [int(side / self.step) + 2 for side in shape]
        where = np.maximum(t.at + 0.5, 0) / self.step
        x, y = np.minimum(np.floor(where).astype(int), np.array(self.shape[::-1]) - 2).T
        u, v = clamp01(where - np.stack([x, y], -1)).T
        self.corners = [(y, x, (1 - u) * (1 - v)), (y, x + 1, u * (1 - v)), (y + 1, x, (1 - u) * v),
                        (y + 1, x + 1, u * v)]
        self.shown = np.outer(*(self._shown(nodes, side) for nodes, side in zip(self.shape, shape, strict=True)))

    def _shown(self, nodes, side):
        """Of what is about a node, which share lies in the frame."""
        on = (np.arange(side) + 0.5) / self.step
        found = np.zeros(nodes)
        low = np.minimum(on.astype(int), nodes - 2)
        np.add.at(found, low, (1 - clamp01(on - low)) / self.step)
        np.add.at(found, low + 1, clamp01(on - low) / self.step)
        return _blurred(_blurred(found, 0), 0)

    def weigh(self, half, place, planes, lines=1):
        """Shares of what matters at least as much as each plane, of lines that lie at a place among them; a plane of
        nothing is the last. So many lines lie on each other at each site."""
        t = self.t
        length = lengths(t, half)
        # each of a thing's lines that are one covers half of it, and one along its middle all
        whole = 2 * (t.site["half"] + half) / np.where(t.family == NUMBER["thin"], 1, 2)
        wide = mix(2 * half / lines, whole, filled_by(t, half))
        ink = np.where(t.dropped | (half <= 0), 0, wide * length / self.step**2)
        share = np.zeros((planes + 1, *self.shape))
        low = place.astype(int)
        for plane, part in ((low, 1 - place + low), (low + 1, place - low)):
            for row, column, weight in self.corners:
                np.add.at(share, (plane, row, column), weight * part * ink)
        for axis in (1, 2, 1, 2):
            share = _blurred(share, axis)
        return np.cumsum((share / np.maximum(self.shown, 1e-6))[::-1], 0)[::-1]

    def at(self, share, plane):
        return sum(weight * share[plane, row, column] for row, column, weight in self.corners)


def lengths(t, half):
    return np.array([sum(t.apart(i, j) / 2 for j in t.links[i] if not t.dropped[j]) if t.links[i] else 2 * half[i]
                     for i in range(len(t))])


def _blurred(share, axis):
    wide = np.pad(share, [(1, 1) if axis == k else (0, 0) for k in range(share.ndim)])
    return (np.delete(wide, (-2, -1), axis) + 2 * share + np.delete(wide, (0, 1), axis)) / 4


def filled_by(t, radius):
    """How much a thing not much wider than its lines lets no paper between them: they are one, from its middle. At a
    tip they go so far there that the middle has the ink of both."""
    half = t.site["half"]
    one = clamp01(1 - 2 * (half - radius))
    spread = np.where(half > 0, clamp01((0.5 + radius - half) / np.where(half > 0, 2 * half, 1)), one)
    return t.site["thin"] * mix(one, spread, t.site["tapers"])


def pressed(t, hand, layers, half, most):
    """How much of a hand's pressure is left: less where lines are many, none where they cover what they may."""
    grid, first = Grid(t, hand.scale, layers.depth.shape, 40), np.zeros(len(t), int)
    crowd = 1 / np.maximum(t.site["crowd"], 1e-12)
    share = grid.at(grid.weigh(np.minimum(crowd, half), first, 1), first)
    return np.where(most < 1, clamp01(2 - 2 * share / most), 1)


def thinned(t, hand, layers, half, most, fewer):
    """Half the widths where lines cover at most such a share of what is about them, and how much of each is left."""
    unit, thin = hand.scale, half
    crowd = 1 / np.maximum(t.site["crowd"], 1e-12)
    first = np.zeros(len(t), int)
    outer = np.array([_outer(layers, t.site[told], unit) for told in told_by(t)])
    outer = _joined(t, np.array([_along(t, outer, i, 6) for i in range(len(t))]), False)
    plane = outer.astype(int)

    def on_nodes(node, half, lines):
        grid, used = Grid(t, unit, layers.depth.shape, node), np.where(crowd < half, crowd, half)
        shares = grid.weigh(used, outer, 2, lines)  # an outer contour counts others of these only
        share = mix(grid.at(shares, plane), grid.at(shares, np.minimum(plane + 1, 2)), outer - plane)
        least = np.minimum(used, fewer * max(0.8 * unit, 0.6))
        here = np.maximum(most, used / grid.step)  # a line by itself stays as it is
        bound = (share > here) & (most < 1)
        return np.where(bound, np.maximum(used * here / np.maximum(share, 1e-12), least), half)

    lines = _doubled(t, np.where(crowd < half, crowd, half), np.minimum(2 * on_nodes(12, half, 1), max(unit, 1)))
    for node in (12, 7):  # and closer by
        thin = on_nodes(node, thin, lines)
    if not ((fewer > 0) & (most < 1)).any():
        return thin, np.ones(len(t))
    matters = np.minimum(_matters(t, hand, layers), 1) * (PLANES - 1)
    plane = matters.astype(int)
    used, grid = np.where(crowd < thin, crowd, thin), Grid(t, unit, layers.depth.shape, 20)
    shares = grid.weigh(used, matters, PLANES)
    share = grid.at(shares, first)
    more = mix(grid.at(shares, plane), grid.at(shares, plane + 1), matters - plane)
    may = mix(share, most**2 / np.maximum(share, 1e-12), fewer)
    bound = (share > most) & (most < 1) & (fewer > 0)
    left = np.where(bound, clamp01(2 - more / np.maximum(may, 1e-30)), 1.0)
    mean = np.array([_along(t, left, i, 10) for i in range(len(t))])
    return thin, _joined(t, clamp01(0.5 + 3 * (mean - 0.5)), True)


def _outer(layers, site, unit):
    """How much a line between pixels is an outer contour: what lies behind is 24 to 96 px behind, at its pixels or a
    pixel farther aside, each side continued straight."""
    if site["source"] not in (0, 2):  # told by numbers, by depths
        return 0.0
    shape, far = layers.depth.shape, 0
    way = np.array((site["axis"] != 0, site["axis"] != 1), int)
    for step in (1, 3):
        y, x = (np.array((site["row"], site["column"]))[:, None] + way[:, None] *
                (step * np.arange(-1, 3) - (step == 3)))
        at = np.clip(y, 0, shape[0] - 1), np.clip(x, 0, shape[1] - 1)
        z, number = layers.depth[at], layers.object[at]
        u = np.where(np.isfinite(z), -z / layers.height, -1e30) if layers.orthographic else 1 / z
        for beyond, side in ((0, 1), (3, 2)):
            if number[beyond] != number[side]:
                u[beyond] = u[side]
        near = 1 if layers.orthographic else max(u[1:3])
        before, after = u[2] - 2 * u[1] + u[0], u[1] - 2 * u[2] + u[3]
        if near > 0:
            far = max(far, min(before, -after) / near, min(-before, after) / near)
    px = unit / layers.full_height
    if not layers.orthographic:
        px *= layers.height if layers.height > 0 else 0.5
        far = far / (1 - far) if far < 1 else np.inf
    return clamp01((far / px - 24) / 72)


def _doubled(t, half, wide):
    """How many lines lie on each other at each site: those as wide count as one within no pixel, as none from its
    `wide` on, and where they cross; but not the other side of a thing."""
    count, length = np.ones(len(t)), lengths(t, half)
    way = np.array([t.at[links[0]] - t.at[links[1] if len(links) > 1 else i] if len(links) in (1, 2) else (0, 0)
                    for i, links in enumerate(t.links)])
    far = np.hypot(*way.T)
    there = (far > 0) & ~t.dropped & (half > 0)
    way = np.where(there[:, None], way / np.maximum(far, 1e-12)[:, None], 0)
    middle = t.site["inside"][:, None] * np.stack([t.axis == 0, t.axis != 0], -1)
    for i in np.flatnonzero(there & (wide > 0)):
        off = t.at - t.at[i]
        on = 1 - np.abs(off @ way[i]) / 2
        beside = 1 - np.abs(off[:, 0] * way[i, 1] - off[:, 1] * way[i, 0]) / wide[i]
        near = there & (on > 0) & (beside > 0) & (middle @ middle[i] >= 0)
        share = np.where(near, on * beside * (way @ way[i])**2 * length * np.minimum(half / half[i], 1), 0)
        own = share[i]
        for at in t.links[i]:
            before = i
            for _ in range(8):
                if at is None or at == i:
                    break
                own, before, at = own + share[at], at, t.next(before, at)
        count[i] = max(share.sum() / own, 1) if own > 0 else 1
    return count


def _matters(t, hand, layers):
    own = 0.5 * np.array([_stands_out(layers, site) for site in t.site])
    own = own + 0.5 * clamp01(0.5 + 0.5 * solid(hand.p, hand.unit * 24, SEED))
    return _joined(t, np.array([_along(t, own, i, 6) for i in range(len(t))]), False)


def _stands_out(layers, site):
    family = FAMILIES[site["family"]]
    if family not in ("crack", "thin"):
        return 0.0
    height, width = layers.depth.shape
    row, aside = site["axis"] != 1, np.arange(-2, 3)
    y = np.clip(site["row"] + (0 if row else aside), 0, height - 1)
    x = np.clip(site["column"] + (aside if row else 0), 0, width - 1)
    depth, number = layers.depth[y, x], layers.object[y, x]
    jump = 1.0 if np.isinf(depth).any() else clamp01(1 - depth.min() / depth.max()) if depth.max() > 0 else 0
    return (jump + (number != number[0]).any()) / 2


def _along(t, values, i, most):
    """The mean along the line, fewer than so many sites each way, by weights that fall to 0; straight on where it
    meets others."""
    total, weights = values[i], 1.0
    for first in t.links[i] if len(t.links[i]) <= 2 else ():
        trail, at = [i] * 3, first
        for step in range(1, most):
            if at is None or at == i:
                break
            total, weights = total + (1 - step / most) * values[at], weights + 1 - step / most
            trail, at = [at, *trail[:2]], _ahead(t, trail, at)
    return total / weights


def _ahead(t, trail, at):
    if len(t.links[at]) <= 2:
        return t.next(trail[0], at)
    way, best, most = t.at[at] - t.at[trail[2]], None, 0.8
    for one in t.links[at]:
        beyond = t.next(at, one)
        step = t.at[one if beyond is None else beyond] - t.at[at]
        lengths = np.sqrt((step @ step) * (way @ way))
        if one != trail[0] and lengths > 0 and way @ step / lengths > most:
            best, most = one, way @ step / lengths
    return best


def _joined(t, values, none):
    """Where lines meet, as much as that which has most."""
    out = np.where(t.dropped, 0.0, values)
    for i in range(len(t)):
        if len(t.links[i]) > 2 and not t.dropped[i]:
            out[i] = max(0 if none else out[i], *(values[j] if len(t.links[j]) <= 2 else 0 for j in t.links[i]))
    return out
