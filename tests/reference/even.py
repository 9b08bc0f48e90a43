# SPDX-License-Identifier: GPL-3.0-or-later
"""Denoised light evened out, one pixel after the other, in float64."""

import math

import numpy as np

AHEAD = {(0, 1): 2, (1, 0): 2, (1, 1): 1, (1, -1): 1}  # down, right: weight beside that of the pixel, 2
PASSES = {16: 1.5, 8: 1.5, 4: 2, 2: 3, 1: 3}  # pixels: standard deviations
STEPS = 8, 4, 2, 1


def even(light, rendered, normal, depth, number):
    """What csrc/samples/even.c makes of these; light, rendered, normal: (H, W, 3), depth, number: (H, W)."""
    own = Picture(light.max(2), normal, depth, number)
    noise = spread(Picture(rendered.max(2), normal, depth, number))
    most = {p: noise[p] - own.light[p] / 3000 for p in noise}
    given = Picture(rendered.max(2), normal, depth, number).light
    rest = {p: (given[p] - own.light[p]) ** 2 for p in noise}
    taken = {p: 2 * math.sqrt(mean(own, rest, p)) - own.light[p] / 3000 for p in noise}
    for step, times in PASSES.items():
        own.light = {p: smoothed(own, p, step, times * most[p]) for p in most}
    for step in STEPS:
        own.light = {p: levelled(own, p, step, most[p]) for p in most}
    kept = bordered(Picture(light.max(2), normal, depth, number), taken)
    own.light = {p: v + kept[p][1] * (kept[p][0] - v) for p, v in calmed(own, taken).items()}
    factor = np.array([own.light[p] / max(light[p].max(), 1e-30) for p in np.ndindex(depth.shape)]).reshape(depth.shape)
    return light * factor[..., None]


class Picture:
    def __init__(self, light, normal, depth, number):
        self.shape, self.number, self.normal = depth.shape, number, normal
        self.light = {p: float(light[p]) for p in np.ndindex(self.shape)}
        self.near = {p: 1 / depth[p] if 0 < depth[p] < 1e9 else 0.0 for p in np.ndindex(self.shape)}

    def at(self, p, ahead, step):
        return tuple(min(max(i + step * k, 0), n - 1) for i, k, n in zip(p, ahead, self.shape, strict=True))

    def pair(self, p, ahead, step):
        """Two pixels on either side of p, and whether both show its surface."""
        one, two = self.at(p, ahead, step), self.at(p, ahead, -step)
        bend = abs(self.near[one] + self.near[two] - 2 * self.near[p])
        same = self.number[one] == self.number[p] == self.number[two]
        turn = np.linalg.norm(self.normal[one] + self.normal[two] - 2 * self.normal[p])
        return one, two, same and turn < 0.2 and bend < 0.003 * max(1, step / 2) * self.near[p]


def smoothed(picture, p, step, most):
    own, total, weights = picture.light[p], 0.0, 2.0
    for ahead, weight in AHEAD.items():
        one, two, same = picture.pair(p, ahead, step)
        off = (picture.light[one] + picture.light[two]) / 2 - own
        if same and abs(off) < most:
            weight *= (1 - (off / most) ** 2) ** 2
            total, weights = total + weight * off, weights + weight
    return own + total / weights


def levelled(picture, p, step, most):
    own, about = picture.light[p], []
    for ahead in AHEAD:
        one, two, same = picture.pair(p, ahead, step)
        about += [picture.light[one], picture.light[two]] if same else []
    if len(about) < 6:
        return own
    near = min(max(own, min(about)), max(about))
    return near if abs(near - own) < most else own


def mean(picture, values, p):
    return sum(values[picture.at(p, (y, x), 1)] for y in range(-2, 3) for x in range(-2, 3)) / 25


def slopes_of(picture):
    """(light's slope, down and to the right, and whether what lies about is of one surface), by pixel."""
    slopes, whole = {}, {}
    for p in picture.light:
        pairs = {ahead: picture.pair(p, ahead, 1) for ahead in AHEAD}
        whole[p] = all(same for _, _, same in pairs.values())
        slopes[p] = [(picture.light[one] - picture.light[two]) / 2 if same else 0.0
                     for one, two, same in (pairs[1, 0], pairs[0, 1])]
    return slopes, whole


def way_of(a, b, c):
    """Along which light stays as it is, by the means of products of its slopes; None: no way more than another."""
    values, vectors = np.linalg.eigh([[a, b], [b, c]])
    return vectors[:, 0] if values[1] - values[0] > 0.5 * (a + c) else None


PRODUCTS = (0, 0), (0, 1), (1, 1)


def calmed(picture, most):
    """Light averaged along curves of equal light, 6 pixels to both sides."""
    slopes, whole = slopes_of(picture)
    ways, steep, out = {}, {}, {}
    for p in picture.light:
        a, b, c = (mean(picture, {q: s[i] * s[j] for q, s in slopes.items()}, p) for i, j in PRODUCTS)
        if whole[p] and (way := way_of(a, b, c)) is not None:
            ways[p] = way
        steep[p] = a + c > (most[p] / 16) ** 2
    for p, own in picture.light.items():
        total, weights = 0.0, 1.0
        asked = p in ways and steep[p] and most[p] > 0
        for weight, off, _ in pairs_along(picture, ways, p, most[p], 6, 1) if asked else ():
            total, weights = total + weight * off, weights + weight
        out[p] = own + total / weights
    return out


def pairs_along(picture, ways, p, most, paces, pixels):
    """(weight, by how much their mean is off, share of the way) of pairs of places on both sides."""
    walks = [walk(picture, ways, p, side, paces, pixels) for side in (1, -1)]
    for pace, (one, two) in enumerate(zip(*walks, strict=False), 1):
        off = (one + two) / 2 - picture.light[p]
        yield 2 * (1 - (pace / (paces + 1)) ** 2) * max(0, 1 - (off / most) ** 2) ** 2, off, pace / paces


def about(picture, values, whole, apart):
    """Means over what is of one surface, of windows of five by five places, the ones of the others' means."""
    share = {p: float(whole[p]) for p in values}
    values = {p: v if whole[p] else 0.0 for p, v in values.items()}
    for step in apart:
        values, share = ({p: sum(v[picture.at(p, (y, x), step)] for y in range(-2, 3) for x in range(-2, 3)) / 25
                          for p in v} for v in (values, share))
    return {p: v / share[p] if share[p] > 0 else 0.0 for p, v in values.items()}


def bordered(picture, most):
    """By pixel (light at the middle of a parabola along the border of a shadow, 24 pixels to both sides; how surely
    there is one)."""
    slopes, whole = slopes_of(picture)
    down, right = (about(picture, {p: s[k] for p, s in slopes.items()}, whole, (1, 2)) for k in (0, 1))
    square = about(picture, {p: s[0] ** 2 + s[1] ** 2 for p, s in slopes.items()}, whole, (1, 2))
    tensor = [about(picture, {p: s[i] * s[j] for p, s in slopes.items()}, whole, (1, 2, 4)) for i, j in PRODUCTS]
    ways = {p: way for p in picture.light if whole[p] and (way := way_of(*(t[p] for t in tensor))) is not None}
    out = {p: (own, 0.0) for p, own in picture.light.items()}
    for p in ways:
        steady = down[p] ** 2 + right[p] ** 2
        least = math.sqrt(max(square[p] - steady, 0) + (most[p] / 12) ** 2)
        sure = min(max(math.sqrt(steady) / least - 1, 0), 1) if most[p] > 0 else 0
        if not sure:
            continue
        rows = [(1.0, 0.0, 0.0), *pairs_along(picture, ways, p, most[p], 8, 3)]
        weight, off, far = np.array(rows).T
        terms = np.stack([np.ones_like(far), far**2]) * np.sqrt(weight)
        known = np.linalg.det(terms @ terms.T) > 1e-6 * weight.sum() ** 2
        bulge = np.linalg.lstsq(terms.T, off * np.sqrt(weight), rcond=None)[0][0] if known else 0.0
        out[p] = picture.light[p] + bulge, sure
    return out


def walk(picture, ways, p, side, paces, pixels):
    """Light at each pace from p, as far as there is a way."""
    def nearest(place):
        return picture.at(tuple(np.floor(place + 0.5).astype(int)), (0, 0), 1)

    place, way = np.array(p, float), side * ways[p]
    for _ in range(paces):
        middle = nearest(place + pixels / 2 * way)
        if middle not in ways:
            return
        way = ways[middle] * (-1 if ways[middle] @ way < 0 else 1)
        place = place + pixels * way
        if nearest(place) not in ways:
            return
        corner = np.floor(place)
        share = place - corner
        corners = {(y, x): picture.at(tuple(corner.astype(int)), (y, x), 1) for y in (0, 1) for x in (0, 1)}
        yield sum(picture.light[q] * np.prod(np.where(k, share, 1 - share)) for k, q in corners.items())


def spread(picture):
    """By pixel, the standard deviation of the light: least of the 5 x 5 windows 5 pixels around."""
    squares = {}
    for p in picture.light:
        rest, whole = 4 * picture.light[p], True
        for ahead, weight in AHEAD.items():
            one, two, same = picture.pair(p, ahead, 1)
            rest += (picture.light[one] + picture.light[two]) * (-2 if weight == 2 else 1)
            whole &= same
        squares[p] = rest * rest / 36 if whole else None
    window = {}
    for p in squares:
        known = [squares[picture.at(p, (y, x), 1)] for y in range(-2, 3) for x in range(-2, 3)]
        known = [square for square in known if square is not None]
        window[p] = sum(known) / len(known) if len(known) > 5 else math.inf
    least = {p: min(window[picture.at(picture.at(p, (y, 0), 5), (0, x), 5)] for y in (-1, 0, 1) for x in (-1, 0, 1))
             for p in window}
    return {p: math.sqrt(v) if v < math.inf else 0.0 for p, v in least.items()}
