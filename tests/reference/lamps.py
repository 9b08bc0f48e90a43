# SPDX-License-Identifier: GPL-3.0-or-later
"""At which points lamps are asked, and what light each of them gives: for shadows.py."""

import functools
from dataclasses import dataclass

import numpy as np


def dot(a, b):
    return np.einsum("...k,...k", a, b)


def unit(a):
    return a / np.sqrt(dot(a, a) + 1e-30)[..., None]


# ---- the points of a lamp


@dataclass
class Asked:
    """Points (n, 2) of the unit square, of the unit disc, and in the 2 x 2 pixels about a pixel's centre."""

    square: np.ndarray
    disc: np.ndarray
    place: np.ndarray

    def __getitem__(self, which):
        return Asked(self.square[which], self.disc[which], self.place[which])


def sobol(n):
    """The first n points of Sobol's sequence in four dimensions, by its polynomials (Joe and Kuo 2008)."""
    out = np.zeros((n, 4), np.uint64)
    for axis, (inner, first) in enumerate((((), ()), ((), (1,)), ((1,), (1, 3)), ((0, 1), (1, 3, 1)))):
        m, degree = list(first) or [1], len(first)
        while len(m) < (n - 1).bit_length():
            new = m[-degree] << degree ^ m[-degree] if degree else 1
            for k, factor in enumerate(inner, 1):
                new ^= factor * m[-k] << k
            m.append(new)
        for k, value in enumerate(m):
            out[np.arange(n) >> k & 1 == 1, axis] ^= np.uint64(value << 31 - k)
    return out / 2 ** 32


def disc(square):
    x, y = (2 * square - 1).T
    wide = abs(x) > abs(y)
    r = np.where(wide, x, y)
    with np.errstate(all="ignore"):
        turn = np.where(wide, np.pi / 4 * y / x, np.pi / 2 - np.pi / 4 * x / np.where(y == 0, 1, y))
    return np.stack([r * np.cos(turn), r * np.sin(turn)], 1)


@functools.cache
def asked(n):
    """n points."""
    at = sobol(n) + 0.5 / n
    return Asked(at[:, :2], disc(at[:, :2]), 2 * at[:, 2:] - 1)


@functools.cache
def dealt(side, each):
    """Which points those pixels ask, (side, side, each), by row and column."""
    number = np.zeros((side, side), int)
    for y, x in np.ndindex(side, side):
        number[y, x] = sum((x >> k & 1) << 2 * k | (y >> k & 1) << 2 * k + 1 for k in range(3))
    return asked(side * side * each), number[..., None] * each + np.arange(each)


def one(square=(0.5, 0.5), disc=(0, 0)):
    return Asked(np.array([square]), np.array([disc]), np.zeros((1, 2)))


# ---- what one point of a lamp gives


class Lit:
    """A lamp; all ways (n, 3) are to its points, `endless` if they have no length."""

    def __init__(self, lamp):
        self.lamp = lamp
        axes, self.at = lamp.model[:3, :3], lamp.model[:3, 3]
        self.scale = np.linalg.norm(axes, axis=0)
        self.x, self.y, self.way = unit(axes[:, 0]), unit(axes[:, 1]), -unit(axes[:, 2])
        self.area, self.endless = lamp.kind in ("rectangle", "ellipse"), lamp.kind == "sun"
        self.u, self.v = axes[:, 0] * lamp.width, axes[:, 1] * lamp.height
        self.soft = lamp.width > 0 or self.area and lamp.height > 0

    def across(self, w):
        a = np.where(abs(dot(self.x, w))[:, None] > 0.9, self.y, self.x)
        u = unit(a - w * dot(a, w)[:, None])
        return u, np.cross(w, u)

    def __call__(self, at, normal, q):
        """(light, ways) for places (n, 3), of points (n) or (1)."""
        falls = self.sun if self.endless else self.area_light if self.area else self.ball
        with np.errstate(all="ignore"):
            value, way = falls(at, normal, q)
            if self.lamp.kind == "spot":
                own = unit(np.stack([dot(way, self.x), dot(way, self.y), -dot(way, self.way)], -1) / self.scale)
                edge = np.cos(self.lamp.spot_angle / 2)
                t = np.clip((own[:, 2] - edge) / max((1 - edge) * self.lamp.spot_blend, 1e-6), 0, 1)
                value = value * t * t * (3 - 2 * t)
        return np.where(np.isfinite(value), np.maximum(value, 0), 0), way

    def mean(self, at, normal, value):
        """The mean over all points, exact where a sun, or a ball, is above the horizon as a whole; else as given."""
        if not self.soft:
            return value
        if self.endless:
            slope = -dot(self.way, normal)
            return np.where(slope > np.sin(self.lamp.width / 2), slope / np.pi, value)
        if self.lamp.kind != "point" or self.lamp.flat:
            return value
        to = self.at - at
        far, slope = np.linalg.norm(to, axis=1), dot(to, normal)
        with np.errstate(all="ignore"):
            known = slope / (4 * np.pi ** 2 * far ** 3)
        return np.where((slope > self.lamp.width) & (far > self.lamp.width), known, value)

    def cap(self, q, open_):
        """(z, x, y) of directions that are even over a cone; open: 1 less the cosine of half its angle."""
        part = dot(q.disc, q.disc) * open_
        k = np.sqrt(open_ * (2 - part))
        return 1 - part, k * q.disc[:, 0], k * q.disc[:, 1]

    def sun(self, at, normal, q):
        open_ = 1 - np.cos(self.lamp.width / 2)
        u, v = self.across(self.way[None])
        z, x, y = (a[:, None] for a in self.cap(q, open_))
        way = np.broadcast_to(-z * self.way + x * u + y * v, at.shape)
        return 2 / (2 - open_) * dot(normal, way) / np.pi, way

    def area_light(self, at, normal, q):
        a = q.square - 0.5 if self.lamp.kind == "rectangle" else q.disc / 2
        way = self.at - at + a[:, :1] * self.u + a[:, 1:] * self.v
        length = np.linalg.norm(way, axis=1)
        front = -dot(way, self.way) / length
        value = front * np.maximum(dot(normal, way), 0) / length ** 3 / np.pi ** 2
        if self.lamp.spread < np.pi - 1e-4:
            half = self.lamp.spread / 2
            value = value * np.maximum(np.tan(half) - np.tan(np.arccos(front)), 0) / (np.tan(half) - half)
        return np.where(front > 0, value, 0), way

    def ball(self, at, normal, q):
        to, radius, share = self.at - at, self.lamp.width, 1 / (4 * np.pi ** 2)
        far = np.linalg.norm(to, axis=1)
        w = to / far[:, None]
        hard = share * dot(normal, w) / far ** 2, to
        if not radius:
            return hard
        u, v = self.across(w)
        if self.lamp.flat:
            way = to + radius * (q.disc[:, :1] * u + q.disc[:, 1:] * v)
            length = np.linalg.norm(way, axis=1)
            soft = share * dot(way, w) * dot(normal, way) / length ** 4
        else:
            sine = radius ** 2 / far ** 2
            open_ = 1 - np.sqrt(1 - sine)
            z, x, y = self.cap(q, open_)
            way = z[:, None] * w + x[:, None] * u + y[:, None] * v
            soft = share / radius ** 2 * 2 * open_ * dot(normal, way)
            way = way * (far * z - np.sqrt(np.maximum(radius ** 2 - far ** 2 * (1 - z * z), 0)))[:, None]
        within = far <= radius
        return np.where(within, hard[0], soft), np.where(within[:, None], to, way)
