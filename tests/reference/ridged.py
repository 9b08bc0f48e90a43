# SPDX-License-Identifier: GPL-3.0-or-later
"""Sites in averaged layers: steps and stripes, and where they can be seen in mirrors and through glass."""

import functools
from dataclasses import dataclass

import numpy as np

from . import grid
from .edges import SOURCES
from .metric import clamp01
from .passes import COLUMN, ROW
from .shade import exposed
from .view import SEEN, SURE, along, levels_apart, more, norm2, turn

PAD = 4


@dataclass
class Layer:
    """Of one family pair: what it looks for steps and bands in, what a pixel averages, and what makes an edge."""
    name: str
    source: int
    signal: np.ndarray  # (H, W, C)
    linear: np.ndarray
    floor: float
    band: float  # of stripes; infinite: it has none
    closed: np.ndarray  # (H, W) pixels that hold two surfaces

    @functools.cached_property
    def bent(self):
        """What stands out is looked for in, (H, W, C); where a pixel and its neighbours are open; (2, H, W): how far it
        is from the mean of those in the row, in the column."""
        image = np.sqrt(self.linear) if self.name == "seen_color" else self.linear
        known = ~self.closed
        known[[0, -1]] = known[:, [0, -1]] = False
        ways = [[grid.read(a, *d) for d in pair for a in (image, ~self.closed)]
                for pair in (((0, -1), (0, 1)), ((-1, 0), (1, 0)))]
        for _, one, _, two in ways:
            known &= one & two
        return image, known, np.array([np.linalg.norm((a + b) / 2 - image, axis=-1) for a, _, b, _ in ways])


def layers_of(view, mixed, through):
    layers, color = view.layers, clamp01(view.layers.albedo)
    if view.params["color_layer"] == "LIT":
        color = clamp01(layers.combined[..., :3])
    lit = exposed(layers, view.params)[..., None]
    floor = 0.35 * view.bend
    yield Layer("normal", SOURCES.index("normal"), layers.normal, layers.normal, floor, 1.2 * floor, mixed)
    yield Layer("color", SOURCES.index("color"), view.space(color), color, 0.01, 0.012, mixed)
    yield Layer("light", SOURCES.index("light"), lit, lit, 0.02, 0.1, mixed)
    if through is None:
        return
    closed, floor, seen = mixed | ~through, 0.6 * view.bend, clamp01(layers.seen_color)
    yield Layer("seen_normal", SEEN, layers.seen_normal, layers.seen_normal, floor, 1.2 * floor, closed)
    yield Layer("seen_color", SEEN, view.space(seen), seen, 0.01, 0.012, closed)
    if "seen_depth" in view.given:
        z = layers.seen_depth[..., None]
        u = np.where(z > 0, -z / layers.height if layers.orthographic else 1 / np.where(z > 0, z, 1),
                     -1e15 if layers.orthographic else 0)
        yield Layer("seen_depth", SEEN, u, u, 0.0, np.inf, closed)


class Reads:
    """Values at -3…3 along an axis, read outwards up to where a pixel holds two surfaces."""

    def __init__(self, signal, closed):
        self.value, self.open = {0: signal}, {0: ~closed}
        for way in (-1, 1):
            for k in (1, 2, 3):
                before = self.open[way * (k - 1)] if k > 1 else np.ones_like(closed)
                is_open = before & ~along(closed, way * k)
                self.open[way * k] = is_open
                self.value[way * k] = np.where(is_open[..., None], along(signal, way * k), self.value[way * (k - 1)])

    def __getitem__(self, k):
        return self.value[k]


def _padded(image):
    return np.pad(image, [(PAD, PAD), (PAD, PAD), *[(0, 0)] * (image.ndim - 2)], mode="edge")


def _sum3(image):
    return sum(grid.read(image, dy, dx) for dy, dx in grid.window(1))


def _inner(axis, image):
    return turn(axis, image)[PAD:-PAD, PAD:-PAD]


def step_margins(layer):
    """(2, H, W): how surely a pixel's step is the greatest of the five that go its way, along the steeper axis."""
    signal, closed = _padded(layer.signal), _padded(layer.closed)
    margin, steep = [], []
    for axis in (ROW, COLUMN):
        v, shut = turn(axis, signal), turn(axis, closed)
        r = Reads(v, shut)
        way = r[1] - r[-1]
        own = norm2(way)
        m = np.where(r.open[1] & r.open[-1] & ~shut, more(own, layer.floor**2), -1)
        for k in (-2, -1, 1, 2):
            other = r[k + 1] - r[k - 1]
            against = -(other * way).sum(-1) / np.maximum(np.sqrt(norm2(other) * own), 1e-12)
            m = np.minimum(m, np.maximum(against, more(own, norm2(other))))
        margin.append(_inner(axis, m))
        ahead, back = (np.where(along(shut, k)[..., None], v, along(v, k)) for k in (1, -1))
        square = np.where(shut, 0, norm2(ahead - back))
        steep.append(_inner(axis, turn(axis, _sum3(turn(axis, square)))))
    preferred = more(steep[0], steep[1])
    tie = (steep[0] == steep[1]) * SURE  # along rows, surely
    return np.array([np.minimum(margin[0], preferred + tie), np.minimum(margin[1], -preferred)])


FAINT_BANDS = "color", "light"  # stripes that may go on a little wider


def band_margins(layer):
    """(2, H, W): how surely a pixel lies farthest of three from the line between the two beyond them, or amid them."""
    signal, closed = _padded(layer.signal), _padded(layer.closed)
    margin, bulge = [], []
    for axis in (ROW, COLUMN):
        v, shut = turn(axis, signal), turn(axis, closed)
        r = Reads(v, shut)
        raw = {k: along(v, k) for k in range(-2, 3)}
        e = raw[-1] + raw[0] + raw[1] - 1.5 * (raw[-2] + raw[2])
        dot = {k: ((raw[k] - (raw[-2] * (2 - k) + raw[2] * (2 + k)) / 4) * e).sum(-1) for k in (-1, 0, 1)}
        square = np.maximum(norm2(e), 1e-30)
        wide = (square > 2.05 * dot[0]) & (layer.name in FAINT_BANDS)
        flat = np.where(wide, 0.2 - abs(dot[1] - dot[-1]) / square, -1)
        m = np.maximum(np.minimum(more(dot[0], dot[-1]), more(dot[0], dot[1])), flat)
        m = np.where(r.open[2] & r.open[-2] & ~shut, m, -1)
        margin.append(_inner(axis, m))
        bulge.append(_inner(axis, turn(axis, _sum3(turn(axis, np.sqrt(norm2(e)))))))
    preferred = more(bulge[0], bulge[1])
    tie = (bulge[0] == bulge[1]) * SURE
    return np.array([np.minimum(margin[0], preferred + tie), np.minimum(margin[1], -preferred)])


def _read(layer, image, row, column, axis, reach=2):
    """Values (2·reach + 1, C) along the axis, held where a pixel is closed, and how far they go on both sides."""
    image, shut = turn(axis, image), turn(axis, layer.closed)
    i, k = (column, row) if axis else (row, column)
    at, far = [k] * (2 * reach + 1), []
    for way in (-1, 1):
        held = 0
        while held < reach and not shut[i, np.clip(k + way * (held + 1), 0, shut.shape[1] - 1)]:
            held += 1
        far.append(held)
        for n in range(1, reach + 1):
            at[reach + way * n] = np.clip(k + way * min(n, held), 0, shut.shape[1] - 1)
    return image[i, at], far


def _share(value, first, second):
    square = norm2(first - second)
    return float(clamp01((value - second) @ (first - second) / square)) if square > 0 else 0.5


def _put(row, column, axis, offset):
    offset = float(np.clip(offset, -1, 1))
    return (column, row + offset) if axis else (column + offset, row)


def _ground(value, way):
    """Where what lies beyond a side of a stripe begins and ends, in pixels from its middle; its ground is at ±2."""
    middle = len(value) // 2
    base = (value[middle - 2] + value[middle + 2]) / 2
    along = value[middle] - base
    t = (value[middle::way] - base) @ along - along @ along / 2
    over = np.flatnonzero((t[1:] < 0) != (t[:-1] < 0))[:2]
    return [float(k + t[k] / (t[k] - t[k + 1])) for k in over] + [np.inf] * (2 - len(over))


def _among_alike(layer, row, column, axis):
    """Positive where what lies on both sides of a stripe is less than 1.5 times as wide as itself."""
    value, _ = _read(layer, layer.linear, row, column, axis, 6)
    one, other = _ground(value, -1), _ground(value, 1)
    width = one[0] + other[0]
    if not np.isfinite([*one, *other]).all():
        return -1.0
    return min(more(1.5 * width, ground[1] - ground[0]) for ground in (one, other))


def turns(layer, row, column, axis):
    """(the share of the pixels up to 8 away at which colours turn back, by .3 of what changes within 2 pixels on both
    sides; whether rounding may tell otherwise)."""
    value, far = _read(layer, layer.linear, row, column, axis, 8)
    least = 0.09 * norm2(value[6:11] - value[8]).max()
    step = np.diff(value, axis=0)
    dot, square = (step[1:] * step[:-1]).sum(-1), norm2(step)
    back = np.minimum(-dot, np.minimum(square[1:], square[:-1]) - least)
    size = np.maximum(square[1:], square[:-1])
    return float((back > 0).sum() / (sum(far) + 1)), bool((np.abs(back) < SURE * size).any())


def _width(v, e):
    """How wide a stripe that stands out by e is, by seven values: the outer two of five may be a part of it."""
    v = v @ e / np.linalg.norm(e)
    base = [min(v[near], v[far]) if v[near] < v[inner] else v[near] for inner, near, far in ((2, 1, 0), (4, 5, 6))]
    ground = np.interp(np.arange(7), (0, 6), base)
    return (v - ground)[1:6].sum() / (v - ground)[3]


def band_site(view, layer, row, column, axis):
    """A stripe so narrow that its two boundaries are one line; None if it is none at all."""
    seven, far = _read(layer, layer.signal, row, column, axis, 3)
    v = seven[1:6]
    if min(far) < 2:
        return None
    base, e = (v[0] + v[4]) / 2, v[1:4].sum(0) - 1.5 * (v[0] + v[4])
    area = np.linalg.norm(e)
    if not area > 0:
        return None
    c = np.array([(v[k] - (v[0] * (4 - k) + v[4] * k) / 4) @ e / area for k in (1, 2, 3)])
    faint = layer.name in FAINT_BANDS
    weak = faint and area > 2.05 * c[1]
    peak = min(more(c[1], c[0]), more(c[1], c[2]))
    if weak:
        peak = max(peak, 0.2 - abs(c[2] - c[0]) / area)
    margin = min(more(area, layer.band), peak, more((3.1 if weak else 2.05) * c[1], area),
                 (c[0] + 0.1 * area) / area, (c[2] + 0.1 * area) / area,
                 more(c[1], 1.5 * np.linalg.norm(v[4] - v[0])))
    if layer.name.endswith("color"):
        margin = min(margin, -_among_alike(layer, row, column, axis))
    width = _width(seven, e) if faint and margin >= -SURE else 0
    if layer.name == "light" or weak:
        margin = min(margin, more(2.25 if layer.name == "light" else 3.1, width))
    if margin < -SURE:
        return None
    family = layer.name + "_band"
    place = _put(row, column, axis, (c[2] - c[0]) / area)
    doubtful = faint and min(abs(more(area, 2.05 * c[1])), abs(more(width, 2.05))) < SURE
    weak |= layer.name == "light" and width > 2.05
    apart = 0.0
    if layer.name.endswith("normal"):
        strength = float(clamp01((area - layer.floor) / (0.37 * view.bend)))
    elif layer.name == "light":
        table = view.params.tables[view.layers.style[view.near(*place, column, row, family, axis)]]
        rise = 1 if e[0] > 0 else -1
        near = max(v[0, 0], v[4, 0]) if rise > 0 else min(v[0, 0], v[4, 0])
        far = near + 2 * e[0]
        doubtful |= _on_threshold(table["shade_levels"], near, far)
        strength = view.contrast(levels_apart(view, table["shade_levels"], near, far))
    else:
        px = 1 / view.params.pixels(view.layers.full_height)
        gain = max(px, 0.667) if px < 1 else max(1, min(px, 2 * c[1] / area))
        strength = view.contrast(view.difference(base + gain * e, base))
        apart = view.painted(base + gain * e, base)
    clear, unclear = clarity(layer, row, column, axis)
    site = view.weigh(place, family, column, row, axis, {layer.source: strength * clear}, apart=apart)
    if faint:
        weak |= _is_weak(view, site)
    site.weak = weak
    site.doubtful |= doubtful or unclear
    site.margin = min(site.margin, margin)
    return site


def _is_weak(view, site):
    """Whether it is an edge only beside one; it needs half as much then."""
    weak = site.margin < 0
    site.doubtful |= abs(site.margin) < SURE
    site.margin = site.strength - view.threshold / 2 if view.threshold > 0 else site.strength or -1.0
    return weak


def _on_threshold(steps, *values):
    return any(abs(x - step[1]) < SURE * max(1, abs(x)) for x in values for step in steps[1:])


def _crossing(steps, v, low, high, place):
    """Where the light of five pixels crosses the middle of the thresholds between two of them, nearest to the third,
    right for hard edges about their half, whose middle is at `place`."""
    def at(level):
        passed = [k for k in range(4) if (v[k] > level) != (v[k + 1] > level)]
        return min((k - 2 + (level - v[k]) / (v[k + 1] - v[k]) for k in passed), key=abs, default=None)

    over = [step[1] for step in steps[1:] if min(v[low], v[high]) <= step[1] < max(v[low], v[high])]
    threshold = (over[0] + over[-1]) / 2 if over else np.nan
    found, half, step = at(threshold), at((v[0] + v[4]) / 2), v[4] - v[0]
    if found is None or half is None or not step:
        return place if found is None else found
    slopes = (abs(v[1] - v[0]) + abs(v[4] - v[3])) / abs(step)
    near = clamp01(1 - 8 * abs((threshold - v[0]) / step - 0.5))
    return found + float(clamp01(1 - 4 * slopes) * near) * (place - half)


def _outdone(layer, row, column, axis):
    """On which sides of a step of normals one within two pixels goes back and is greater; whether that is close."""
    v, far = _read(layer, layer.signal, row, column, axis, 3)
    step = v[2:] - v[:-2]  # from two pixels before to two after
    own, found, doubtful = norm2(step[2]), [False, False], False
    for side, way in enumerate((-1, 1)):
        for other in (step[2 + way * k] for k in range(1, far[side])):
            dot, gain = other @ step[2], more(norm2(other), own)
            found[side] |= bool(dot < 0 and gain > 0)
            doubtful |= bool(min(-dot / max(own, 1e-30), gain) > -SURE and (abs(dot) < SURE * own or abs(gain) < SURE))
    return found, doubtful


def step_site(view, layer, row, column, axis):
    (linear, far), (v, _) = _read(layer, layer.linear, row, column, axis), _read(layer, layer.signal, row, column, axis)
    inner = norm2(linear[1] - linear[3]) > norm2(linear[0] - linear[4])
    low, high = (1, 3) if inner else (0, 4)
    doubtful = abs(more(norm2(linear[1] - linear[3]), norm2(linear[0] - linear[4]))) < SURE and \
        not np.allclose(linear[[1, 3]], linear[[0, 4]], atol=1e-6)
    share = sum(_share(linear[k], linear[low], linear[high]) for k in (1, 2, 3)) - 1.5
    offset = share - 0.06 * np.sin(2 * np.pi * share)
    place = _put(row, column, axis, offset)
    way = v[3] - v[1]
    if layer.name.endswith("normal"):  # what goes back lies past another edge
        back, unsure = _outdone(layer, row, column, axis)
        far = [min(k, 1) if gone else k for k, gone in zip(far, back, strict=True)]
        doubtful |= unsure
    # the slope up to the last pixel goes on at least as steeply
    before = v[2] - v[1] if far[0] < 2 else v[1] - v[0]
    after = v[3] - v[2] if far[1] < 2 else v[4] - v[3]
    bend, step = np.linalg.norm(way - before - after), np.linalg.norm(way)
    if (far[0] < 2) != (far[1] < 2):  # but not so much faster than on the other side
        toward = -share if far[0] < 2 else share
        doubtful |= abs(toward - 0.47) < SURE
        if toward < 0.47:
            bend = max(bend, step - 2.5 * np.linalg.norm(v[4] - v[3] if far[0] < 2 else v[1] - v[0]))
    margin = min(more(bend, 0.4 * step), more(bend, layer.floor) if layer.floor else 1.0)
    if margin < -SURE:
        return None
    apart = 0.0
    if layer.name.endswith("normal"):
        strength = float(clamp01((bend - layer.floor) / (0.37 * view.bend)))
    elif layer.name == "seen_depth":
        a, p, _, q, b = v[:, 0]
        left, right = q - 3 * p + 2 * a, p - 3 * q + 2 * b
        jump = max(0.0, min(left, -right), min(-left, right))
        if not view.layers.orthographic:
            jump = jump / v.max() if v.max() > 0 else 0.0
        if jump < 0.1 - SURE:
            return None
        strength = float(clamp01((jump - 0.1) / 0.03))
    elif layer.name == "light":
        style = view.layers.style[view.near(*place, column, row, "light_step", axis)]
        table = view.params.tables[style]
        doubtful |= _on_threshold(table["shade_levels"], *v[:, 0])
        place = _put(row, column, axis, _crossing(table["shade_levels"], v[:, 0], low, high, share))
        strength = view.contrast(levels_apart(view, table["shade_levels"], v[low, 0], v[high, 0]))
    else:
        strength = view.contrast(view.difference(v[low], v[high]))
        apart = view.painted(v[low], v[high])
    family = "light_step" if layer.name == "light" else layer.name
    clear, unclear = clarity(layer, row, column, axis)
    site = view.weigh(place, family, column, row, axis, {layer.source: strength * clear},
                      style if layer.name == "light" else None, apart=apart)
    if layer.name in ("normal", "color") or layer.name.startswith("seen"):
        site.weak = _is_weak(view, site)
    site.step = tuple((127 * way / max(1.001 * step, 1e-30)).astype(int)) + (0,) * (3 - len(way))
    site.doubtful |= bool(doubtful) or unclear
    site.margin = min(site.margin, margin)
    return site


def ridges(view, mixed, through):
    found = {}
    for layer in layers_of(view, mixed, through):
        if not (layer.source == SOURCES.index("color") and "controls" in view.given) and \
                not view.weights[layer.source].any():
            continue
        kinds = [(step_margins(layer), step_site, "light_step" if layer.name == "light" else layer.name)]
        if np.isfinite(layer.band):
            kinds.append((band_margins(layer), band_site, layer.name + "_band"))
        for margins, place, family in kinds:
            for axis, row, column in np.argwhere(margins > -SURE):
                if layer.name == "light" and not view.layers.there[row, column]:
                    continue
                site = place(view, layer, row, column, axis)
                if site is not None:
                    site.margin = min(site.margin, margins[axis, row, column])
                    found[family, row, column, axis] = site
    return found


# Mirrors


def through(view):
    """(H, W) where normals differ by .1, or depths by 2 % over all of a 3×3; grown by 5×5. And where float32 may say
    otherwise."""
    layers = view.layers
    turned = layers.normal @ layers.view.T
    apart = np.linalg.norm(layers.seen_normal - turned, axis=-1) - 0.1
    length = norm2(turned)
    share = clamp01((layers.seen_normal * turned).sum(-1) / np.where(length > 0, length, 1))
    rest = np.linalg.norm(layers.seen_normal - share[..., None] * turned, axis=-1) - 0.1
    tint = np.linalg.norm(clamp01(layers.seen_color) - clamp01(layers.albedo), axis=-1) - 0.1
    own = (rest < 0) & (tint < 0)  # a lamp, or black in part
    unit = layers.height if layers.orthographic else np.where(layers.there, layers.depth, 1)
    gap = np.abs(layers.seen_depth - np.where(layers.there, layers.depth, 0)) - 0.02 * unit
    other = layers.there & (layers.seen_depth > 0) & (gap > 0) & ~(own & (apart > 0))
    begin = (layers.there & ~own & (apart > 0)) | np.all([grid.read(other, *d) for d in grid.window(1)], axis=0)
    unsure = np.min([np.abs(m) for m in (apart, rest, tint, gap / unit)], axis=0) < SURE
    return grid.most(begin, 2) > 0, grid.most(unsure, 3) > 0


def clarity(layer, row, column, axis):
    """(how clearly, whether rounding may tell otherwise) a line stands out of its surroundings.

    0 where in the 9×9 about it 55 % of the pixels (of depths, half) differ by 6 % of its step from the mean of their
    neighbours in the row and from that in the column, or 80 % from that across the line; 1 where 15 % fewer do."""
    if layer.source != SEEN:
        return 1.0, False
    image, known, bent = layer.bent
    dy, dx = (1, 0) if axis else (0, 1)
    ways = [((row + a * dy, column + a * dx), (row + b * dy, column + b * dx))
            for a, b in ((-1, 0), (-1, 1), (0, 1))]
    height, width = known.shape
    inside = [way for way in ways if all(0 <= y < height and 0 <= x < width and not layer.closed[y, x] for y, x in way)]
    size = max([np.linalg.norm(image[a] - image[b]) for a, b in inside], default=0.0)
    box = np.s_[max(row - 4, 0):row + 5, max(column - 4, 0):column + 5]
    off = bent[(slice(None), *box)][:, known[box]] - 0.06 * size
    if not off.size:
        return 1.0, False
    stirred, rippled = (off > 0).all(0).mean(), (off[axis] > 0).mean()
    most = 0.5 if layer.name == "seen_depth" else 0.55
    value = clamp01((most - stirred) / 0.15) * clamp01((0.8 - rippled) / 0.15)
    return float(value), size > 1e-4 and bool((np.abs(off) < 1e-6 + SURE * size).any())
