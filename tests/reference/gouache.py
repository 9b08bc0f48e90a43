# SPDX-License-Identifier: GPL-3.0-or-later
"""Gouache: opaque strokes that lie on things, large ones first, as large as the borders about them leave room for."""

import numpy as np

from .metric import clamp01, mix
from .stipple import COARSEST, DENSITY, FINEST, HELD, WIDEST, mixed, point
from .wash import Places

SPREAD, LEAST, ALONE, FITS = 1.8, 0.2, 0.75, (1, 2.4, 3, 9)
TOLD, CELL, SEEN, SURE, BY_BORDERS = 0.8, 0.04, 0.03, 0.2, 1.5
HALF, WIDE, STEP, ALIKE, BOLD = 0.5, 0.23, 0.03, 0.16, 0.25
ACROSS, ALONG = 64, 32
LMS = np.array([(0.4122214708, 0.5363325363, 0.0514459929), (0.2119034982, 0.6806995451, 0.1073969566),
                (0.0883024619, 0.2817188376, 0.6299787005)])
LAB = np.array([(0.2104542553, 0.7936177850, -0.0040720468), (1.9779984951, -2.4285922050, 0.4505937099),
                (0.0259040371, 0.7827717662, -0.8086757660)])
AXIS = np.array((0.148, 0.0986, 0.984))


def smooth(low, high, x):
    t = clamp01((x - low) / (high - low))
    return t * t * (3 - 2 * t)


def chance(name, k):
    return (mixed(int(name) * 0x9e3779b9 + k) >> np.uint64(8)) / 2**24


def hair(x, name, what):
    """Noise of one dimension."""
    whole = np.floor(x).astype(np.int64)
    seed = int(mixed(int(name) * 31 + what))

    def at(k):
        return (mixed((k * 0x9e3779b9 + seed) & 0xffffffff) >> np.uint64(8)) / 2**24

    t = x - whole
    return mix(at(whole), at(whole + 1), t * t * (3 - 2 * t))


class Painting:
    def __init__(self, layers, params, surface, on):
        self.layers, self.params, self.on, self.picture = layers, params, on, surface.copy()
        self.scale = params.pixels(layers.full_height)
        self.size = max(params["gouache_size"] * self.scale, 2)
        self.least = LEAST * self.size
        self.near = 1 / layers.depth
        own = np.where(self.near[..., None] > 0, clamp01(layers.color), 0)
        more = clamp01(layers.combined[..., :3] - own * layers.diffuse)
        self.paint = np.where(on[..., None], np.sqrt(own + more), np.inf)
        self.light = np.sqrt(clamp01(clamp01(surface[..., :3]) @ (0.2126, 0.7152, 0.0722)))
        self.anchor = self.rest()
        self.room = self.rooms()

    def rest(self):
        """The layer anchor, of all pixels."""
        layers, (rows, columns) = self.layers, self.near.shape
        y, x = np.mgrid[layers.y:layers.y + rows, layers.x:layers.x + columns] + 0.5
        flat, none = np.zeros((rows, columns, 16)), np.zeros_like(x)
        flat[..., :3], flat[..., 4], flat[..., 6:8], flat[..., 12] = np.stack([x, none, -y], -1), -1, 1, -1
        given = np.zeros_like(flat) if layers.anchor is None else layers.anchor
        rest = np.where(given[..., 6:7] > 0, given, flat)
        if layers.orthographic or not layers.height > 0:
            return np.where((self.near > 0)[..., None], rest, flat)
        per = layers.height / layers.full_height
        own = np.stack([(x - layers.full_width / 2) * per, (layers.full_height / 2 - y) * per, none - 1], -1)
        far = np.linalg.norm(own, axis=-1, keepdims=True)
        way, (right, up, _) = own @ layers.view / far, layers.view
        sky = np.zeros_like(flat)
        sky[..., :3] = sky[..., 3:6] = way
        sky[..., 6:7] = per / far
        for first, grows in ((7, right), (10, -up)):
            sky[..., first:first + 3] = (grows - (way @ grows)[..., None] * way) * per / far
        return np.where((self.near > 0)[..., None], rest, sky)

    def rooms(self):
        layers, (rows, columns), cell = self.layers, self.near.shape, max(int(CELL * self.size), 1)
        roots = np.sqrt(clamp01(self.picture[..., :3]))
        sure = np.zeros((rows, columns))
        for axis in (0, 1):
            def next_(a, axis=axis):
                return np.concatenate([np.delete(a, 0, axis), np.take(a, [-1], axis)], axis)

            by = np.abs(roots - next_(roots)).max(-1)
            deep = np.abs(self.near - next_(self.near)) > STEP * np.maximum(self.near, next_(self.near))
            parted = deep | (layers.object != next_(layers.object))
            sure = np.maximum(sure, np.where(parted, 1, clamp01((by - SEEN) / (SURE - SEEN))))
        left, top = layers.x % cell, layers.y % cell
        cells = np.zeros(((top + rows - 1) // cell + 1, (left + columns - 1) // cell + 1))
        np.add.at(cells, np.ix_((np.arange(rows) + top) // cell, (np.arange(columns) + left) // cell), sure)
        reach = max(int(TOLD * self.size / cell + 0.5), 1)
        tent = reach - np.abs(np.arange(1 - reach, reach))
        for axis in (0, 1):
            cells = np.apply_along_axis(lambda a: np.convolve(a, tent)[reach - 1:][:len(a)], axis, cells)
        borders = cells / (reach**3 * cell)
        room = reach * cell / (1 + BY_BORDERS * borders**2)

        def looked_up(at, n):
            at = np.clip((at + 0.5) / cell - 0.5, 0, n - 1)
            low = at.astype(int)
            return low, np.minimum(low + 1, n - 1), at - low

        (v, below, down), (u, right, along) = (looked_up(np.arange(n) + off, many) for n, off, many in (
            (rows, top, cells.shape[0]), (columns, left, cells.shape[1])))
        return mix(mix(room[np.ix_(v, u)], room[np.ix_(v, right)], along),
                   mix(room[np.ix_(below, u)], room[np.ix_(below, right)], along), down[:, None])

    def seeds(self):
        """(row, column, way, birth, length, name)."""
        for y, x in zip(*np.nonzero(self.on), strict=True):
            a, room = self.anchor[y, x], self.room[y, x]
            axis = int(np.argmax(np.abs(a[3:6] * (1, 0.97, 1.03))))
            one, two = (k for k in range(3) if k != axis)
            grows = np.array([[a[7 + one], a[10 + one]], [a[7 + two], a[10 + two]]])
            area = abs(np.linalg.det(grows))
            if not area**2 > 1e-6 * np.prod((grows**2).sum(1)):
                continue
            least = min(max(FITS[0] * room, self.least), ALONE * self.size)
            density = (SPREAD / least) ** 2 / area
            level = max(int(np.ceil(np.log2(density / DENSITY))), COARSEST)
            cells = 2.0 ** ((level + 1) / 2)
            at, reach = a[[one, two]] * cells, HELD * np.abs(grows).sum(1) * cells
            if level > FINEST or np.abs(at).max() >= 2**30 or 2 * reach.max() >= WIDEST:
                continue
            inverse = np.linalg.inv(grows * cells)
            low, high = np.floor(at - reach).astype(int), np.floor(at + reach).astype(int)
            for v in range(low[1], high[1] + 1):
                for u in range(low[0], high[0] + 1):
                    born, place, name = point(level, u, v)
                    if not born < density:
                        continue
                    way, own = inverse @ (place - at), SPREAD / np.sqrt(born * area)
                    length = min(own, self.size)
                    length *= smooth(1, FITS[1] / FITS[0], own / least) * (
                        1 - smooth(FITS[2], FITS[3], length / max(room, self.least / FITS[1])))
                    if np.abs(way).max() <= HELD and length > 0.1 * self.least:
                        yield y, x, way, born, length, name

    def inside(self, y, x):
        rows, columns = self.near.shape
        for k, left in enumerate((0.3, 0.6, 0.85), 1):
            for dy, dx in np.ndindex(3, 3):
                v, u = np.clip(y + k * (dy - 1), 0, rows - 1), np.clip(x + k * (dx - 1), 0, columns - 1)
                near = self.near[y, x], self.near[v, u]
                if (self.layers.object[v, u] != self.layers.object[y, x]
                        or abs(near[0] - near[1]) > STEP * max(near)):
                    return left
        return 1

    def way(self, y, x, name, turn):
        a = self.anchor[y, x]
        normal, right, down, form = a[3:6], a[7:10], a[10:13], a[13:]
        along = np.cross(AXIS[[0, 2, 1]] if abs(normal @ AXIS) > 0.95 else AXIS, normal)
        along /= max(np.linalg.norm(along), 1e-6)
        across = np.cross(normal, along)
        p, q = form @ along, form @ across
        twice = (p + 1j * q) ** 2 + 0.25 * (1 - min(np.hypot(p, q), 1)) ** 2
        half = np.angle(twice) / 2 + (np.pi if twice.real < 0 and twice.imag < 0 else 0)
        half += (0.35 + 0.5 * turn) * (1 - 0.6 * min(form @ form, 1)) + 0.35 * (chance(name, 4) - 0.5)
        on = np.cos(half) * along + np.sin(half) * across
        seen = np.array([(down @ down) * (right @ on) - (right @ down) * (down @ on),
                         (right @ right) * (down @ on) - (right @ down) * (right @ on)])
        return seen / np.linalg.norm(seen)

    def color(self, y, x, name):
        *rgb, alpha = self.picture[y, x]
        lab = LAB @ np.cbrt(LMS @ np.clip(np.divide(rgb, max(alpha, 1e-6)) if alpha > 0 else np.zeros(3), 0, 16))
        strays = np.array([chance(name, k) - 0.5 for k in (1, 2, 3)])
        lab += self.of("gouache_variety", y, x) * strays * (0.036 * (0.4 + lab[0]), 0.010, 0.017)
        lab[0] = max(lab[0], 0)
        return np.maximum(np.linalg.inv(LMS) @ (np.linalg.inv(LAB) @ lab) ** 3, 0)

    def of(self, name, y, x):
        return self.params.at(name, self.layers.style[y, x])

    def slope(self, y, x, axis):
        line = self.near[:, x] if axis == 0 else self.near[y]
        at = y if axis == 0 else x
        on, back = line[min(at + 1, len(line) - 1)] - line[at], line[at] - line[max(at - 1, 0)]
        return on if abs(on) < abs(back) else back

    def strokes(self):
        places = Places(self.layers)
        places.at, places.pixel = self.anchor[..., :3], self.anchor[..., 6]
        places.key = self.layers.object.astype(np.int64).astype(np.uint32)
        turns = places.noise(4 * self.size, 71)[0]
        found = sorted(enumerate(self.seeds()), key=lambda seed: (seed[1][3], seed[0]))
        return [(y, x, way, length * self.inside(y, x), name, self.way(y, x, name, turns[y, x]),
                 self.color(y, x, name)) for _, (y, x, way, _, length, name) in found]

    def draw(self, y, x, way, length, name, along, color):
        half = HALF * length * (0.85 + 0.3 * chance(name, 5))
        wide = WIDE * length * (0.85 + 0.3 * chance(name, 6))
        rows, columns = self.near.shape
        dy = np.arange(rows)[:, None] + 0.5 - (y + 0.5 + way[1])
        dx = np.arange(columns) + 0.5 - (x + 0.5 + way[0])
        on = dx * along[0] + dy * along[1]
        side = dy * along[0] - dx * along[1] - 0.25 * (chance(name, 7) - 0.5) / half * on**2
        across = (clamp01(0.5 * side / wide + 0.5) * (ACROSS - 1) + 0.5).astype(int)
        place = 2 * (np.arange(ACROSS) + 0.5) / ACROSS - 1
        t = place * wide / max(self.scale, 0.25)
        thick, thin = hair(0.27 * t + 40, name, 11), hair(0.6 * t + 5, name, 19)
        ridge = smooth(0.62, 0.95, np.abs(place)) * np.sign(place) * np.sqrt(0.5) * (along[1] - along[0])
        body = self.of("gouache_body", y, x)
        tone = 1 + body * (0.13 * (thick - 0.5) + 0.06 * (thin - 0.5) + 0.07 * ridge)
        end, begin = 0.78 + 0.22 * hair(0.45 * t + 9, name, 5), 0.91 + 0.09 * hair(0.4 * t + 3, name, 7)
        dry = 0.85 * smooth(0.5, 0.75, thick)[across] * clamp01((0.5 * on / half + 0.5) * 1.6 - 0.8)
        part = (clamp01(0.5 * on / half + 0.5) * (ALONG - 1) + 0.5).astype(int)
        steps = 0.075 * (2 * (np.arange(ALONG) + 0.5) / ALONG - 1) * half / max(self.scale, 0.25)
        edges = 0.9 + 0.1 * hair(steps, name, 2)
        ends = half * np.where(on > 0, end[across], begin[across]) - np.abs(on)
        cover = clamp01(np.minimum(0.7 * ends, 0.9 * (wide * edges[part] - np.abs(side))) + 0.5) * (1 - dry)
        slopes = self.slope(y, x, 1), self.slope(y, x, 0)
        off = np.abs(self.near - (self.near[y, x] + slopes[0] * dx + slopes[1] * dy))
        keep = off <= STEP * self.near[y, x] + 1.5 * np.abs(slopes).sum()
        keep &= ((self.near > 0) == (self.near[y, x] > 0)) & (self.layers.object == self.layers.object[y, x])
        cover *= keep * clamp01(2 - 2 / ALIKE * np.abs(self.paint - self.paint[y, x]).max(-1))
        strays = (1.8 if chance(name, 8) < BOLD else 1) * ALIKE * (self.light[y, x] + 0.1)
        cover *= clamp01(2 - 2 / strays * np.abs(self.light - self.light[y, x]))
        over = color * (tone[across] * self.picture[..., 3])[..., None]
        self.picture[..., :3] = mix(self.picture[..., :3], over, cover[..., None])


def paint(layers, params, surface):
    on = np.broadcast_to(params.at("use_gouache", layers.style), layers.depth.shape).astype(bool)
    if not on.any():
        return surface
    painting = Painting(layers, params, surface, on)
    for stroke in painting.strokes():
        painting.draw(*stroke)
    return painting.picture
