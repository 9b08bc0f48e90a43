# SPDX-License-Identifier: GPL-3.0-or-later
"""The hand that draws FINE's lines: noise, what it does to width, place and ink; kinds of lines and their inks."""

import numpy as np

from . import grid
from .edges import SOURCES
from .ends import bilinear
from .metric import clamp01, mix, value
from .params import KINDS
from .passes import COLUMN, CRACKS, FAMILIES, NUMBER, ROW, hits, told_by
from .shade import exposed
from .turns import onward

WIDTHS = {"outline": "object", "contact": "object", "inner": "depth", "crease": "normal", "intersection": "normal"}
PRESSURE, ACROSS, DOWN, ROUGH, GAPS, FLOW, BRISTLE = range(7)
FARTHER = BRISTLE + 8
STREAKS, STREAK = 6, 33.0  # of dry bristles: how many and how long


def hashed(x, y, z, seed):
    """-1…1 from integers."""
    mask = np.uint64(0xffffffff)

    def word(k):
        return np.asarray(k).astype(np.int64).astype(np.uint64) & mask

    h = (word(seed) + np.uint64(0x2545f491)) * np.uint64(0x9e3779b1) & mask
    for k, factor, shift in ((x, 0x85ebca6b, 13), (y, 0xc2b2ae35, 16), (z, 0x27d4eb2f, 15)):
        h = (h ^ word(k)) * np.uint64(factor) & mask
        h ^= h >> np.uint64(shift)
    h = h * np.uint64(0x165667b1) & mask
    h ^= h >> np.uint64(13)
    return (h >> np.uint64(8)).astype(float) / 2**23 - 1


def lattice(p, seed):
    """Value noise at the points p (n, 3)."""
    low = np.floor(p)
    t = p - low
    w = t**3 * (t * (t * 6 - 15) + 10)
    out = 0.0
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(np.array(corner) == 1, w, 1 - w), axis=-1)
        out = out + weight * hashed(*np.moveaxis(low + corner, -1, 0), seed)
    return out


def solid(p, wavelength, seed):
    """Noise of unit variance at the points p (n, 3): two octaves, chosen by the wavelength (n,)."""
    rate = 1 / wavelength
    octave = np.floor(np.log2(rate))
    part = rate / 2**octave - 1
    turn = part * (1.3466 - 0.3466 * part) * np.pi / 2  # log2(1 + part), about
    first, second = (lattice(p * (2.0**k)[:, None] + 17.3 * k[:, None], seed) for k in (octave, octave + 1))
    return (np.cos(turn) * first + np.sin(turn) * second) * 2.4972


def _spot(layers, t, i):
    """The anchor of the surface in front at a site, the mean of those of the four pixels about it that show it, each
    continued to there; about a crack, of those that it parts."""
    height, width = layers.depth.shape
    found, (x, y) = [], t.at[i]
    left, top = np.floor(x), np.floor(y)
    if FAMILIES[t.family[i]] in CRACKS:
        left = left if t.axis[i] == COLUMN else t.site["column"][i]
        top = top if t.axis[i] == ROW else t.site["row"][i]
    x, y = clamp01(x - left), clamp01(y - top)
    if layers.anchor is None:
        return None
    for dy, dx in np.ndindex(2, 2):
        at = min(max(int(top) + dy, 0), height - 1), min(max(int(left) + dx, 0), width - 1)
        weight = 1e-3 + (1 - abs(x - dx)) * (1 - abs(y - dy))
        if layers.anchor[at][6] > 0 and np.isfinite(layers.depth[at]):
            anchor = layers.anchor[at].astype(float)
            more = (x - dx) * anchor[7:10] + (y - dy) * anchor[10:13]
            far = np.linalg.norm(more)
            anchor[:3] += more * min(1, 6 * anchor[6] / far if far else 1)
            found.append((layers.depth[at], layers.object[at], weight, anchor))
    if not found:
        return None
    front = min(found, key=lambda each: each[0])[0]
    found = [each for each in found if each[0] <= 1.02 * front]
    number = max(each[1] for each in found)
    shown = [each for each in found if each[1] == number]
    return np.average([each[3] for each in shown], axis=0, weights=[each[2] for each in shown])


def _between(layers, t, hits):
    """Of a thin thing that covers no pixel centre, between the places where it covers some again."""
    spots = [_spot(layers, t, at) for _, at, _ in hits]
    if len(hits) < 2 or spots[0] is None:
        return spots[0]
    share = hits[0][2] / (hits[0][2] + hits[1][2])
    return mix(spots[0], spots[1], share)


def colored(site):
    return np.isin(site["source"], [SOURCES.index("color"), SOURCES.index("material")])


class Hand:
    """What one stroke of the pen does to sites; arrays by site."""

    def __init__(self, t, layers, params, stroke):
        site = t.site
        self.style = layers.style[site["near_y"], site["near_x"]]
        self.colored = colored(site)
        self.params, self.stroke = params, stroke
        self.scale = params.pixels(layers.full_height)
        x, y = ((t.at[:, k] + corner + 0.5) / self.scale for k, corner in ((0, layers.x), (1, layers.y)))
        self.p = np.stack([x, y, 0 * x], -1)
        self.unit = np.ones(len(t))
        for i in range(len(t)):
            between = hits(t, i) if t.family[i] == NUMBER["thin"] else []
            if (spot := _between(layers, t, between) if between else _spot(layers, t, i)) is not None:
                self.p[i], self.unit[i] = spot[:3], spot[6] * self.scale
        named = np.array([params.at(f"line_{kind}_pen", self.style) for kind in KINDS])
        self.whose = named[kinds(t, layers), np.arange(len(t))]
        self.drawn = stroke < self.at("strokes")
        hold = self.at("hold")
        turn = layers.number // np.where(hold > 0, hold, 1)
        self.again = np.where(hold > 0, (turn * 0x9e3779b1) % 2**32 | 1, 0)

    def at(self, name):
        """Of each site's pen."""
        own = self.params.at("pen_1_" + name, self.style)
        for pen in ("pen_2", "pen_3"):
            own = np.where(self.whose == pen.upper(), self.params.at(f"{pen}_{name}", self.style), own)
        return own

    def noise(self, length, what):
        """Of wavelength `length` px; the numbers of seeds differ by style."""
        out = np.zeros(len(self.unit))
        for seed, again in set(zip(self.at("seed").tolist(), self.again.tolist(), strict=True)):
            own = (self.at("seed") == seed) & (self.again == again)
            number = ((int(seed) * 4 + self.stroke) * 16 + what) & 0xffffffff
            out[own] = solid(self.p[own], (self.unit * length)[own], number)
            if again:
                anew = solid(self.p[own], (self.unit * length)[own], number ^ again)
                turn = self.at("boil")[own] * np.pi / 2
                out[own] = np.cos(turn) * out[own] + np.sin(turn) * anew
        return out

    def farther(self):
        """Pixels that a stroke goes on beyond a corner, were there room."""
        far = self.at("overshoot")
        share = np.where(self.colored, self.at("overshoot_color"), 1)
        return share * far * self.scale * np.maximum(0, 1 + self.noise(np.maximum(far, 1e-9), FARTHER) / 2)

    def pressure(self):
        noise = self.noise(self.at("pressure_length"), PRESSURE)
        return np.where(self.at("pressure") > 0, np.clip(1 + self.at("pressure") * noise, 0.12, 3), 1)

    def fray(self, radius):
        return np.minimum(self.at("rough") * self.scale * clamp01(self.at("rough_length") * self.scale - 1),
                          0.08 * radius)

    def radius(self, radius, frayed):
        """Half the widths with frayed rims, each to its share, and what gaps leave of them."""
        rough = frayed * self.fray(radius) * self.noise(self.at("rough_length"), ROUGH)
        gaps = self.at("gaps")
        x = 2 * gaps - 1
        left = clamp01(4 * (self.noise(self.at("gaps_length"), GAPS) - x * (1.15 + 0.75 * x**4)) + 0.5)
        left = np.where(gaps > 0, np.where(gaps < 1, left, 0), 1)
        return np.maximum(radius + rough, 0), left

    def stray(self):
        length = self.at("wobble_length")
        far = self.at("wobble") * self.scale
        return np.stack([far * self.noise(length, ACROSS), far * self.noise(length, DOWN)], -1)

    def bristles(self):
        """(number of bristles, 0 where none is dry; what each gives (n, 8))."""
        dry = self.at("dry")
        length = np.full_like(dry, STREAK)
        flow = 1 + 0.6 * self.noise(6 * length, FLOW)
        ink = [clamp01(2.5 * (0.6 * self.noise(length, BRISTLE + k) + 1.15 - dry * flow)) for k in range(8)]
        return np.where(dry > 0, STREAKS, 0), np.floor(255 * np.stack(ink, -1) + 0.5) / 255


def across_at(way, px, py, half):
    """(how far (px, py) from the first end of a link lies from one rim to the other, whether that may be turned)."""
    length = np.hypot(*way)
    if length <= 1e-6:
        across = np.zeros_like(px)
    else:
        across = np.where(half > 0, (way[0] * py - way[1] * px) / (length * np.where(half > 0, half, 1)), 0)
    turn = way[0] + 0.41421356 * way[1]
    if turn < 0:
        across = -across
    return clamp01(0.5 + 0.5 * across), np.full(px.shape, abs(turn) < 1e-4)


def left_by(way, px, py, s, half, numbers, inks):
    """(what bristles leave of the ink at (px, py) from the first end of a link, whether another may be there)."""
    across, doubtful = across_at(way, px, py, half)
    left = []
    for n, ink in zip(numbers, inks, strict=True):
        n = int(n)
        if not n:
            left.append(np.ones(px.shape))
            continue
        left.append(ink[np.minimum((across * n).astype(int), n - 1)])
        between = np.round(across * n)
        doubtful |= (between > 0) & (between < n) & (np.abs(across * n - between) < 1e-3)
    return mix(left[0], left[1], s), doubtful


def kinds(t, layers):
    """Which of KINDS the line of each site is, by its strongest source and what lies on both sides of it."""
    names = ("object", "material", "depth", "normal", "color", "light", "mark", "seen")
    height, width = layers.depth.shape
    out = np.empty(len(t), int)
    for i, site in enumerate(t.site[told_by(t)]):
        name = names[site["source"]]
        if name in ("object", "depth"):
            name = _shape(layers, site, height, width, name)
        elif name == "normal":
            name = "crease"
        out[i] = KINDS.index({"light": "shadow", "seen": "mirror"}.get(name, name))
    outline, shapes = KINDS.index("outline"), out.copy()
    for i, told in enumerate(told_by(t)):
        if shapes[i] == KINDS.index("contact"):
            sides = sum(_meets(t, shapes, told, link, outline) for link in t.links[told])
            out[i] = outline if sides > 1 else shapes[i]
    return out


def _meets(t, shapes, i, at, outline, most=24):
    """Whether the line that leaves site i by a link is an outline within so many links."""
    before = i
    for _ in range(most):
        if at is None or t.dropped[at]:
            return False
        if shapes[at] == outline and t.family[at] != NUMBER["thin"]:
            return True
        before, at = at, _straight_on(t, before, at)
    return False


def _straight_on(t, before, at):
    """The next site of a line: where it meets others, the one most straight on."""
    if len(t.links[at]) == 2:
        return t.next(before, at)
    way, ahead = t.at[at] - t.at[before], {}
    for one in t.links[at]:
        if one != before and not t.dropped[one]:
            step = t.at[one] - t.at[at]
            ahead[one] = way @ step / np.sqrt(step @ step + 1e-12)
    best = max(ahead, key=ahead.get, default=None)
    return best if best is not None and ahead[best] > 0 else None


def _shape(layers, site, height, width, source):
    x, y, dx, dy = site["column"], site["row"], site["axis"] != 1, site["axis"] != 0

    def read(layer, k):
        return layer[np.clip(y + k * int(dy), 0, height - 1), np.clip(x + k * int(dx), 0, width - 1)]

    if source == "depth" and read(layers.object, 0) == read(layers.object, 1):
        return "inner"
    z = np.array([read(layers.depth, k) for k in (-1, 0, 1, 2)])
    if not np.isfinite(z[1:3]).all():
        return "outline"
    u = np.where(np.isfinite(z), -z / layers.height, -1e30) if layers.orthographic else 1 / z
    for beyond, side in ((0, 1), (3, 2)):  # one pixel wide: no slope is known
        if read(layers.object, beyond - 1) != read(layers.object, side - 1):
            u[beyond] = u[side]
    before, after = u[2] - 2 * u[1] + u[0], u[1] - 2 * u[2] + u[3]
    far = max(0, min(before, -after), min(-before, after)) / (1 if layers.orthographic else max(u[1:3]))
    return "outline" if far >= 0.0065 else "contact"


HAIR = 0.4  # pixels that the second ink is wider than


def inks(t, layers, params, ink, half, picture):
    """Each site's ink (n, 3), and the factor on its width `half`: `ink` is what it is without light, dark and kinds;
    `picture` lies under the lines."""
    site = t.site
    owner = site["near_y"], site["near_x"]
    style = layers.style[owner]
    own = np.array([np.array([params.at(f"line_{name}_ink", style)[i] for name in KINDS])[k]
                    for i, k in enumerate(kinds(t, layers))]).reshape(-1, 3)
    tint = params.at("ink_tint", style)[:, None]
    tinted = mix(own, params.at("ink_tint_value", style)[:, None] * layers.color[owner], tint)
    ink = np.where(params.at("ink_by_kind", style)[:, None], tinted, ink)
    lit = clamp01(exposed(layers, params)[owner])
    ink = mix(ink, params.at("ink_light_color", style), (params.at("ink_in_light", style) * lit)[:, None])
    share = params.at("ink_on_dark", style)
    unit = params.pixels(layers.full_height)
    even, second = _second(t, _dark(t, layers, params, half, picture), half, unit)
    spared = np.minimum(half, 0.25 * (1 - site["thin"]) / np.maximum(site["crowd"], 1e-12))
    bare = clamp01(1.5 * _evened(t, _bare(t, layers, params, half, picture), half, unit, site["crowd"] > 0, {}))
    spared = mix(half, spared, bare * (1 - even) * share)
    wide = second * np.maximum(params.at("ink_dark_width", style), np.minimum(1, 0.5 / np.maximum(spared, 1e-12)))
    pixel = grid.round_half_up(t.at[:, ::-1]).clip(0, np.array(layers.depth.shape) - 1)
    painted = layers.controls["color_edge"][tuple(pixel.T)]
    wide = wide * np.where(colored(site), mix(params.at("ink_dark_colors", style), 1, clamp01(painted)), 1)
    wide = wide * clamp01((2 * spared * wide - HAIR) / (1 - HAIR))
    factor = np.where(second > 0, mix(1, wide, share), 1) * spared / np.maximum(half, 1e-12)
    return mix(ink, params.at("ink_dark_color", style), (share * np.minimum(1, 8 * second))[:, None]), factor


def _dark(t, layers, params, half, picture):
    """How far it is dark about each site."""
    v, dark = clamp01(value(picture[..., :3])), np.zeros(len(t))
    for i in np.flatnonzero(~t.dropped):
        style = layers.style[t.site[i]["near_y"], t.site[i]["near_x"]]
        threshold = params.at("ink_dark_threshold", style)
        if not (threshold > 0 and params.at("ink_on_dark", style) > 0 and params.at("use_lines", style) > 0):
            continue
        dark[i] = 1
        for turn in np.arange(8) * np.pi / 4:
            way = np.array((np.cos(turn), np.sin(turn))).round(3)
            dark[i] = min(dark[i], _dark_along(v, t.at[i], way, half[i] + 2, threshold, dark[i]))
    return dark


def _dark_along(v, place, way, rim, threshold, least):
    """0 where light begins within half of what `rim` is from a place, a half where there, 1 where half as far again or
    farther; told by steps of a pixel as far as it may be less than `least`."""
    on, before, step, light = 0.0, 0.0, 0.0, 1.5 * threshold
    while True:
        own = bilinear(v, place + rim * (on + 0.5) * way)
        if own >= light:
            after = bilinear(v, place + (rim * (on + 0.5) + 1) * way)
            half = max(light, 0.5 * max(own, after))
            if own >= half:
                return max(0, min(least, on - (step * (own - half) / (own - before) if step else 0)))
            return min(least, on + (half - own) / (after - own) / rim)
        least = min(least, 1 - clamp01(2 * own / threshold - 2) * (1 - on))
        if on >= least:
            return least
        before, step = own, min(1 / rim, least - on)
        on += step


def _bare(t, layers, params, half, picture):
    """Where a thin thing is light and what is beyond the rim, along the axis, black; NaN where that is not told."""
    out, v, (height, width) = np.full(len(t), np.nan), value(picture[..., :3]), layers.depth.shape
    for i in range(len(t)):
        site = t.site[i]
        threshold = params.at("ink_dark_threshold", layers.style[site["near_y"], site["near_x"]])
        if t.dropped[i] or site["crowd"] <= 0 or t.family[i] != NUMBER["crack"] or site["axis"] > 1 or threshold <= 0:
            continue
        step = np.array((1, 0) if site["axis"] == 0 else (0, 1))
        one = np.array((site["column"], site["row"]))
        ahead = layers.depth[tuple((one + step)[::-1])] < layers.depth[tuple(one[::-1])]
        x, y = np.floor(t.at[i] + (-1 if ahead else 1) * (1.42 * half[i] + 2) * step + 0.5).astype(int)
        beyond = max(0, v[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)])
        own = max(0, v[tuple((one + ahead * step)[::-1])])
        out[i] = clamp01(3 - 2 * beyond / threshold) * clamp01(own / threshold - 1.7)
    return out


def _along(t, i, step, after):
    """(site, how far on) each way from i, by steps up to a sum of 1; after: what onward() has said."""
    for first in t.links[i]:
        before, at, far = i, first, 0.0
        while at is not None and at != i and not t.dropped[at]:
            far += step(before, at)
            if far >= 1:
                break
            yield at, far
            if (before, at) not in after:
                after[before, at] = onward(t, before, at)
            before, at = at, after[before, at]


def _evened(t, values, half, unit, sites, after):
    """The mean of what is told along each line, over two widths of it each way, at some of the sites."""
    even = np.zeros(len(t))
    for i in np.flatnonzero(sites & ~t.dropped) if (values > 0).any() else ():
        reach = max(4 * half[i], 2 * unit)
        near = [(i, 0.0), *_along(t, i, lambda a, b, reach=reach: t.apart(a, b) / reach, after)]
        near = [(values[k], 1 - far) for k, far in near if not np.isnan(values[k])]
        even[i] = np.average([v for v, _ in near], weights=[w for _, w in near]) if near else 0
    return even


def _second(t, dark, half, unit):
    """How dark it is along each line, and how far that has swollen since it took the second ink: what is dark is evened
    over two widths of it each way, and no line gets wider than its full width over four."""
    full, after = np.maximum(8 * half, 6 * unit), {}
    even = np.where(dark > 0, clamp01(2 * _evened(t, dark, half, unit, dark > 0, after) - 1), 0)
    swollen = even.copy()
    for i in np.flatnonzero(~t.dropped) if even.any() else ():
        for at, far in _along(t, i, lambda a, b: 2 * t.apart(a, b) / (full[a] + full[b]), after):
            swollen[at] = min(swollen[at], even[i] + far)
    return even, swollen
