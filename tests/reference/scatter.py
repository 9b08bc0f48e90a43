# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes along the form, one by one: places on a lattice, shifted, and ink drawn from there; and whether a place is
beside the seam of two charts."""

import numpy as np

from .metric import clamp01, mix

LENGTH, JITTER, FULL, STRAY, STEPS = 5.0, 0.6, np.log(2), 0.1, 6
ROWS = 0.08  # sine of the angle up to which a stroke goes along a row of its lattice
HELD, DARKER, LEAST_ON = 0.6, 32, 0.25
MOST_AHEAD = 0.3
APART, LEAST_FACING = 4, 0.1
BESIDE = 0, 0.381966, 0.763932
TURNED = 0, np.radians(45), np.radians(-60)
AXES = np.array([(0.148, 0.0986, 0.984), (0.148, 0.984, 0.0986)])
RANKS = 3242174889, 2447445413
WORD = 0xffffffff


def stir(h, k):
    h = (h ^ k & WORD) * 2654435761 & WORD
    h = (h ^ h >> 15) * 2246822519 & WORD
    return h ^ h >> 13


def share(h):
    return (h >> 8) / 2**24


def area(cover):
    """Of marks that cover so much: from a lattice, though shifted, they cover each other less than thrown at random."""
    y = -np.log(max(1 - cover, 1 / 1024))
    return y / (1 + y * 0.21)


def covers(dark):
    """The share that each of the layers covers: each half of what is left, all alike in the dark."""
    if dark > 0.875:
        return [1 - np.cbrt(1 - dark)] * 3
    return [min(max(1 - min((1 - dark) * 2**k, 1), 0), 0.5) for k in range(3)]


def shown(cover):
    """(up to which rank marks are drawn, their size)."""
    x = area(cover) / FULL
    rank = 1.25 * min(x, 1) ** 0.75
    mean = 2 * rank * rank if rank < 0.25 else rank - 0.125 - 2 * max(rank - 1, 0) ** 2
    return rank, x / mean if mean > 0 else 0


def axes(anchor):
    """(H, W) each: along which axis the rest normal is longest, and next to that; of equal ones the first."""
    normal = np.abs(anchor[..., 3:6])
    first = np.argmax(normal, -1)
    return first, np.argmax(np.where(np.arange(3) == first[..., None], 0, normal), -1)


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-15)


def basis(right, down, normal):
    """Directions at right angles, the columns of matrices, the last along the normal."""
    normal = unit(normal)
    right = unit(right - (right * normal).sum(-1, keepdims=True) * normal)
    down = down - (down * normal).sum(-1, keepdims=True) * normal
    return np.stack([right, unit(down - (down * right).sum(-1, keepdims=True) * right), normal], -1)


def turns(layers, anchor):
    """By object, how it is turned from rest as the camera sees it, times any number: the mean of its pixels'."""
    y, x = np.mgrid[:anchor.shape[0], :anchor.shape[1]]
    seen = unit(layers.normal @ layers.view.T)
    own = ((x + layers.x) % APART == 0) & ((y + layers.y) % APART == 0) & (anchor[..., 6] > 0)
    own &= (seen[..., 2] >= LEAST_FACING) & (np.abs(anchor[..., 3:6]).max(-1) > 0)
    seen, anchor, objects = seen[own], anchor[own].astype(float), layers.object[own]
    right, down = np.tile([1.0, 0, 0], (len(seen), 1)), np.tile([0, -1.0, 0], (len(seen), 1))
    right[:, 2], down[:, 2] = -seen[:, 0] / seen[:, 2], seen[:, 1] / seen[:, 2]
    turned = basis(right, down, seen) @ np.swapaxes(basis(anchor[:, 7:10], anchor[:, 10:13], anchor[:, 3:6]), 1, 2)
    return {k: (turned * seen[:, 2:, None])[objects == k].sum(0) for k in np.unique(objects)}


class Seams:
    """Where the axis along which the rest normal is longest is about to be another."""

    def __init__(self, anchor):
        self.anchor = anchor

    def normal(self, x, y):
        height, width = self.anchor.shape[:2]
        return self.anchor[min(max(y, 0), height - 1), min(max(x, 0), width - 1), 3:6]

    def near(self, x, y):
        _, second, first = np.sort(np.abs(self.normal(x, y)))
        return first - second <= MOST_AHEAD

    def turns(self, x, y):
        """Along the row and the column each, on the side where the normal turns less: (by how much, by how much its
        parts grow to the next pixel)."""
        here = self.normal(x, y)
        sides = [[(side, self.normal(x + side * (1 - axis), y + side * axis)) for side in (-1, 1)] for axis in (0, 1)]
        found = [[(np.abs(there - here).max(), side * (np.abs(there) - np.abs(here))) for side, there in beside]
                 for beside in sides]
        return [min((1, np.zeros(3)), *beside, key=lambda turn: turn[0]) for beside in found]

    def grown(self, x, y):
        """The area that strokes have, by pixels."""
        if not self.near(x, y):
            return 1
        _, second, first = np.sort(np.abs(self.normal(x, y)))
        away = (first - second) / max(2 * sum(turn for turn, _ in self.turns(x, y)), 1e-6)
        return clamp01(away) * (1 + clamp01((3 - away) / 2) / 3)

    def before(self, first, axis, x, y, way):
        """Whether a spot's place so far from a pixel lies where the normal is longest along an axis. first: of the
        two that may be."""
        part = np.abs(self.normal(x, y)) + sum(to * grows for to, (_, grows) in zip(way, self.turns(x, y), strict=True))
        lead = part[axis] - np.delete(part, axis).max()
        return lead > 0 or (lead == 0 and first)


class Drawing:
    """What a tone's strokes are drawn on. chart: (axis of the rest normal that tells it, two fields of value, right and
    down) on which their places lie, unturned."""

    def __init__(self, layers, bounds, angle, anchor, chart, dark, lattice, crisp=False,
                 light=None, by_uv=False, flat=False, scale=1.0):
        self.layers, self.angle, self.anchor, self.dark = layers, angle, anchor, dark
        self.light, self.by_uv = light, by_uv  # the direction toward it, if strokes go there; whether along U
        self.rolled = {} if light is None or anchor is None or flat else turns(layers, anchor)
        self.bounds = bounds  # pixels between which marks are a unit apart
        self.chart, self.lattice, self.crisp, self.scale = chart, lattice, crisp, scale
        self.ink = np.zeros(dark.shape)
        self.byte = np.floor(255 * clamp01(dark) + 0.5).astype(int)
        tables = [shown(covers(k / 255)[layer]) for k in range(256) for layer in range(3)]
        self.tables = np.array(tables).reshape(256, 3, 2)

    def one_surface(self, x0, y0, x1, y1):
        """Whether the surface goes on from a pixel to its neighbour."""
        height, width = self.dark.shape
        if x1 >= width or y1 >= height or self.layers.object[y0, x0] != self.layers.object[y1, x1]:
            return False
        a = None if self.layers.anchor is None else self.layers.anchor[y0, x0]
        if a is not None and a[6] > 0 and self.layers.anchor[y1, x1, 6] > 0:
            apart = self.layers.anchor[y1, x1, :3] - a[:3]
            return apart @ apart <= 16 * (a[7:10] @ a[7:10] + a[10:13] @ a[10:13])
        near, far = self.layers.depth[y0, x0], self.layers.depth[y1, x1]
        return abs(far - near) <= 0.05 * near

    def gets_to(self, x0, y0, x1, y1):
        """First along the row, then along the column."""
        row = all(self.ends(x, y0)[0] for x in range(min(x0, x1), max(x0, x1)))
        return row and all(self.ends(x1, y)[1] for y in range(min(y0, y1), max(y0, y1)))

    def ends(self, x, y):
        if not self.byte[y, x]:  # nobody has looked
            return True, True
        return self.one_surface(x, y, x + 1, y), self.one_surface(x, y, x, y + 1)

    def way(self, layer, x, y):
        """Direction of a stroke on the screen, kept as one of 256 places on half of the square |x| + |y| = 1."""
        right, down = self.exact_way(layer, x, y)
        along = (right if down >= 0 else -right) / (abs(right) + abs(down)) if abs(right) + abs(down) > 1e-30 else 1.0
        along = 1 - int(128.5 - 128 * along) % 256 / 128
        return np.array((along, 1 - abs(along))) / np.hypot(along, 1 - abs(along))

    def exact_way(self, layer, x, y):
        turn = self.angle + TURNED[layer]
        if self.light is not None and self.byte[y, x]:
            view = self.layers.view
            light, normal = view @ self.light, view @ self.layers.normal[y, x]
            far = np.hypot(light[0], light[1])
            across = np.array((light[1], -light[0], 0)) / far if far > 1e-3 else np.array((1.0, 0, 0))
            along = np.cross(across, normal)  # cuts by planes that hold the light and the eye
            along = along if along @ along > 1e-12 else light
            turned = self.rolled.get(self.layers.object[y, x])
            if turned is not None and self.anchor[y, x, 6] > 0:
                return self.held(x, y, turned.T @ light, along, turn)
            on = np.cos(turn) * along + np.sin(turn) * np.cross(normal, along)
            return np.array((on[0], -on[1]))
        if self.anchor is None:
            return np.array((np.cos(turn), -np.sin(turn)))
        if not self.byte[y, x]:
            return np.array((1.0, 0.0))
        a = self.anchor[y, x].astype(float)
        normal, right, down, form = a[3:6], a[7:10], a[10:13], a[13:]
        axis = AXES[int(abs(AXES[0] @ normal) > 0.95)]
        along = np.cross(axis, normal)
        along /= max(np.linalg.norm(along), 1e-6)
        across = np.cross(normal, along)
        # angles doubled, as ways have no sign
        own = (form @ along + 1j * (form @ across)) ** 2 + 0.25 * (1 - min(np.linalg.norm(form), 1)) ** 2
        u, half = self.layers.tangent[y, x], np.angle(own) / 2
        if self.by_uv and (u @ along) ** 2 + (u @ across) ** 2 > 1e-6:
            half = np.angle(u @ along + 1j * (u @ across))
        on = np.exp(1j * (half + turn))
        on = on.real * along + on.imag * across
        found = np.linalg.lstsq(np.stack([right, down], 1), on, rcond=None)[0]
        return found / max(np.linalg.norm(found), 1e-30)

    def plane(self, x, y):
        """How far the surface is a plane, by how its normal at rest changes up to six steps off."""
        own, size = self.anchor[y, x, 3:6], self.dark.shape
        step = max(int(np.floor(8 * self.scale + 0.5)), 2)

        def change(dy, dx):
            found = [2.0]
            for sign in -1, 1:
                most = []
                for ny, nx in ((y + sign * k * step * dy, x + sign * k * step * dx) for k in (1, 3, 6)):
                    if not (0 <= ny < size[0] and 0 <= nx < size[1]
                            and self.layers.object[ny, nx] == self.layers.object[y, x]):
                        break
                    most.append(np.linalg.norm(self.anchor[ny, nx, 3:6] - own))
                found += [max(most)] if most else []
            return min(found)

        return clamp01((0.012 - change(1, 0) - change(0, 1)) / 0.008)

    def held(self, x, y, light, along, turn):
        """Toward the light as at rest, let go by degrees, on planes along them. light: that one; along: toward it now,
        seen."""
        a = self.anchor[y, x].astype(float)
        right, down = a[7:10], a[10:13]
        along = unit(along[0] * right - along[1] * down)
        side = np.cross(a[3:6], along)
        falls = light @ along + 1j * (light @ side)
        slips = 1 + 1j * falls.real * falls.imag / max(light @ light, 1e-30)
        level = np.cross(AXES[int(abs(AXES[0] @ a[3:6]) > 0.95)], a[3:6])
        level = level @ along + 1j * (level @ side)
        way = np.sqrt(mix((slips / abs(slips)) ** 2, (level / max(abs(level), 1e-15)) ** 2, self.plane(x, y)))
        way = np.exp(1j * turn) * way
        return np.linalg.lstsq(np.stack([right, down], 1), way.real * along + way.imag * side, rcond=None)[0]

    def half(self, layer, rank, size, x, y):
        """size: of the pitch, in pixels."""
        last, large = self.tables[self.byte[y, x], layer]
        drawn = clamp01((last - rank) * 4) * large
        return 0.75 * FULL / LENGTH * size * drawn

    def between(self, p, q, x, y):
        """Ink between two places (x, y, half width) over what is of the object at a pixel."""
        p, q = np.array(p), np.array(q)
        rows, columns = np.mgrid[:self.dark.shape[0], :self.dark.shape[1]] + 0.5
        way = (q - p)[:2]
        square = way @ way
        at = ((columns - p[0]) * way[0] + (rows - p[1]) * way[1]) / (square if square > 0 else 1)
        t = np.clip(at, 0, 1)
        distance = np.hypot(columns - p[0] - t * way[0], rows - p[1] - t * way[1])
        half = mix(p[2], q[2], t)
        cover = np.where((at >= 0) & (at < 1), np.minimum(clamp01(half + 0.5 - distance), 2 * half), 0)
        if self.crisp:
            cover = (half >= distance) & (at >= 0) & (at < 1)
        cover = np.where(self.layers.object == self.layers.object[y, x], cover, 0)
        self.ink = 1 - (1 - self.ink) * (1 - cover)

    def within(self, place):
        """The pixel of the frame that is nearest to a place: the last stands for what lies beyond."""
        return [min(max(int(np.floor(v)), 0), size - 1) for v, size in zip(place, self.dark.shape[::-1], strict=True)]

    def part(self, place, step, x, y):
        """How much of a step stays on its surface: eighths, found by halving."""
        part, on = 1, 0
        for half in (0.5, 0.25, 0.125, 0):
            if self.gets_to(x, y, *self.within(place + part * step)):
                on = part
                if part == 1:
                    break
                part += half
            else:
                part -= half
        return on

    def trace(self, layer, rank, size, reach, turn, sign, step, place, x, y):
        found, last = [], None
        place, part = np.array(place), 1
        while len(found) < STEPS + 2:
            way = self.way(layer, x, y)
            way = way + turn * np.array((-way[1], way[0]))
            if last is not None and abs(way @ last) <= LEAST_ON:
                break
            last = way * (sign if last is None else -1 if way @ last < 0 else 1)
            part = self.part(place, step * last, x, y)
            if part == 0:
                break
            place = place + part * step * last
            x, y = self.within(place)
            gone = step * (len(found) + part)  # of a stroke without length even the first step is its end
            over = gone >= reach
            half = 0 if over or not self.byte[y, x] else self.half(layer, rank, size, x, y) * (1 - (gone / reach)**2)
            found.append([*place, half])
            if part < 1 or over or not self.byte[y, x] or (np.floor(place) != (x, y)).any():
                break
        return found

    def mark(self, layer, axis, x, y, whole, way, fields):
        """(name, far, what draws it) of the mark whose place is in pixel (x, y)."""
        h = stir(0x9e3779b9, 3 * axis + layer)
        odds, weight = [], 1.0
        for k in range(2):
            n, exponent = int(whole[k]), -(int(np.log2(fields["scale"][k])) + 127)
            weight *= fields["grown"][k] if n & 1 else 1
            while n and n % 2 == 0:
                n, exponent = n // 2, exponent + 1
            odds.append(n)
            h = stir(h, exponent if n else 0)
        rank = share(h + odds[0] * RANKS[0] + odds[1] * RANKS[1] & WORD)
        h = stir(stir(h, odds[0]), odds[1])
        return h, int(256 * (way @ way) + 0.5), lambda: self.put(layer, x, y, h, rank, weight, way, fields)

    def put(self, layer, x, y, h, rank, weight, way, fields):
        weight *= 1 if self.anchor is None else Seams(self.anchor).grown(x, y)
        along = self.way(layer, x, y)
        for k in range(2):
            h = stir(h, 1)
            step, row = fields["step"][k], fields["step"][1 - k]
            off = abs(along[0] * row[1] - along[1] * row[0]) / max(np.linalg.norm(row), 1e-6)
            shift = mix(JITTER, 1, clamp01(2 - off / ROWS))
            way = way + (share(h) - 0.5) * shift * fields["pitch"][k] / max(np.linalg.norm(step), 1e-6) * step
        h = stir(h, 2)
        turn = (share(h) - 0.5) * STRAY
        h = stir(h, 3)
        pitch = np.sqrt(fields["pitch"][0] * fields["pitch"][1])
        size = np.sqrt(weight) * pitch
        place = x + 0.5 + way[0], y + 0.5 + way[1]
        px, py = self.within(place)
        if not self.gets_to(x, y, px, py):
            return
        half = self.half(layer, rank, size, px, py)
        reach = 0.5 * LENGTH * min(size * (0.7 + 0.6 * share(h)), 1.3 * pitch)
        step = max(4, reach / STEPS)
        forth, back = (self.trace(layer, rank, size, reach, turn, sign, step, place, px, py) for sign in (1, -1))
        places = [*back[::-1], [*place, half], *forth]
        for order in (range(1, len(places)), range(len(places) - 2, -1, -1)):
            for k in order:
                before = k - 1 if order.step > 0 else k + 1
                places[k][2] = min(places[k][2], places[before][2] + 0.25 * step)
        for p, q in zip(places, places[1:], strict=False):
            if p[2] > 0.02 or q[2] > 0.02:
                self.between(p, q, px, py)

    def draw(self, own):
        """own: pixels that hold the places of marks."""
        axes_, chart = self.chart
        lattices = [self.lattice([(u + BESIDE[layer], *g) for u, *g in chart], *self.bounds) for layer in range(3)]
        held = {}
        for y, x in zip(*np.nonzero(own & (self.byte > 0)), strict=True):
            for layer, (at, scale, grown, step, flat, pitch) in enumerate(lattices):
                if flat[y, x] or self.tables[min(self.byte[y, x] + DARKER, 255), layer, 0] <= 0:
                    continue
                axis = 0 if axes_ is None else axes_[y, x]
                steps = [s[:, y, x] for s in step]
                whole = [np.floor(2 * u[y, x] + 0.5) for u in at]
                way = sum(0.5 * (n - 2 * u[y, x]) * s for n, u, s in zip(whole, at, steps, strict=True))
                if (np.abs(way) <= HELD).all():
                    held[y, x, layer] = self.mark(layer, int(axis), x, y, whole, way, {
                        "scale": [s[y, x] for s in scale], "step": steps, "grown": [g[y, x] for g in grown],
                        "pitch": [p[y, x] for p in pitch]})
        for (y, x, layer), (name, far, draw) in held.items():
            beside = [(y + v, x + u, layer) for v in (-1, 0, 1) for u in (-1, 0, 1)]
            if min((held[at][1], at[:2]) for at in beside if held.get(at, (None,))[0] == name) == (far, (y, x)):
                draw()
        return self.ink
