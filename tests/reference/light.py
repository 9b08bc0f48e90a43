# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light on what a camera sees: every ray against every triangle, every lamp at thousands of points."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Hole:
    """Where a triangle is solid: by the corners' uvs (3, 2) in a picture of alpha, 0 to 255, as Scene.texture() has it.
    """

    uvs: np.ndarray
    alpha: np.ndarray
    extension: str = "REPEAT"
    closest: bool = False

    def solid(self, u, v):
        with np.errstate(all="ignore"):
            place = self.uvs[0] + u[:, None] * (self.uvs[1] - self.uvs[0]) + v[:, None] * (self.uvs[2] - self.uvs[0])
        height, width = self.alpha.shape
        x, y = (np.nan_to_num(place, nan=0, posinf=0, neginf=0) * (width, height)).T
        if self.closest:
            return self.texel(np.floor(x), np.floor(y)) >= 128
        left, low = np.floor(x - 0.5), np.floor(y - 0.5)
        total = sum((1 - abs(x - 0.5 - column)) * (1 - abs(y - 0.5 - row)) * self.texel(column, row)
                    for row in (low, low + 1) for column in (left, left + 1))
        return total >= 127.5

    def texel(self, x, y):
        height, width = self.alpha.shape
        x, y = x.astype(int), y.astype(int)
        within = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        if self.extension == "REPEAT":
            return self.alpha[y % height, x % width].astype(float)
        found = self.alpha[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)].astype(float)
        return np.where(within, found, 0) if self.extension == "CLIP" else found


class World:
    """Triangles in world space, (n, 3, 3), normals at their corners, and what belongs to each."""

    def __init__(self):
        self.points, self.normals, self.owner = np.empty((0, 3, 3)), np.empty((0, 3, 3)), np.empty(0, int)
        self.seen, self.casts = np.empty(0, bool), np.empty(0, bool)
        self.smooth, self.turned = np.empty(0, bool), np.empty(0)
        self.holes = {}  # number of a triangle -> Hole
        self.sets = []  # of the owners: (bits of the lamps that light it, of those in whose light it throws shadows)

    def add(self, points, corners, model=None, normals=None, seen=True, casts=True, sets=(~0, ~0)):
        model = np.eye(4) if model is None else model
        triangles = (np.asarray(points, float) @ model[:3, :3].T + model[:3, 3])[corners]
        flat = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        side, smooth = np.sign(np.linalg.det(model[:3, :3])), normals is not None
        self.sets.append(sets)
        normals = np.repeat(flat[:, None], 3, 1) * side if normals is None else normals @ np.linalg.inv(model[:3, :3])
        n = len(triangles)
        self.points, self.normals = np.concatenate([self.points, triangles]), np.concatenate([self.normals, normals])
        self.owner = np.append(self.owner, np.full(n, self.owner.max(initial=-1) + 1))
        self.seen, self.casts = np.append(self.seen, np.full(n, seen)), np.append(self.casts, np.full(n, casts))
        self.smooth, self.turned = np.append(self.smooth, np.full(n, smooth)), np.append(self.turned, np.full(n, side))

    def lit_by(self, light_set):
        return np.array([own[0] >> light_set & 1 for own in self.sets], bool)[self.owner]

    def throws(self, shadow_set):
        return self.casts & np.array([own[1] >> shadow_set & 1 for own in self.sets], bool)[self.owner]

    def meet(self, origin, way, which, least=1e-6):
        """(distance in units of `way`, inf for none; u; v), (rays, triangles), of rays (n, 3)."""
        a, e, f = self.points[which, 0], *(self.points[which, k] - self.points[which, 0] for k in (1, 2))
        # The triple products of Moeller and Trumbore, of which each is linear in the ray: products of matrices.
        across = np.cross(origin, way)
        with np.errstate(all="ignore"):
            det = -way @ np.cross(e, f).T
            u = (across @ f.T - way @ np.cross(f, a).T) / det
            v = (way @ np.cross(e, a).T - across @ e.T) / det
            t = (origin @ np.cross(e, f).T - (np.cross(e, f) * a).sum(1)) / det
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > least)
        return np.where(hit, t, np.inf), u, v

    def blocked(self, origin, way, far, but):
        """Whether something is in the way of rays (n, 3), triangle number `but` aside."""
        which = np.flatnonzero(self.casts & (np.arange(len(self.owner)) != but))
        t = self.meet(origin, way, which)[0]
        return ((t > 1e-5) & (t < far)).any(1)


def unit(a):
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


def surfaces(world, view, projection, width, height):
    """For each pixel's centre: (triangle, -1 for none; place; normal; depth), of the nearest that is seen."""
    inverse = np.linalg.inv(projection @ view)
    y, x = np.mgrid[:height, :width] + 0.5
    ndc = np.stack([2 * x / width - 1, 1 - 2 * y / height], -1).reshape(-1, 2)
    ends = []
    for z in (-1, 0):
        p = np.concatenate([ndc, np.full((len(ndc), 1), z), np.ones((len(ndc), 1))], 1) @ inverse.T
        ends.append(p[:, :3] / p[:, 3:])
    which = np.flatnonzero(world.seen)
    t, u, v = world.meet(ends[0], ends[1] - ends[0], which)
    best, rows = t.argmin(1), np.arange(len(t))
    found = np.isfinite(t[rows, best])
    triangle = np.where(found, which[best], -1)
    at = ends[0] + np.where(found, t[rows, best], 0)[:, None] * (ends[1] - ends[0])
    u, v = u[rows, best], v[rows, best]
    corner = world.normals[triangle]
    normal = unit(corner[:, 0] * (1 - u - v)[:, None] + corner[:, 1] * u[:, None] + corner[:, 2] * v[:, None])
    flat = np.cross(world.points[triangle, 1] - world.points[triangle, 0],
                    world.points[triangle, 2] - world.points[triangle, 0])
    flat *= np.sign((flat * corner.sum(1)).sum(-1))[:, None]
    away = (flat * (ends[1] - ends[0])).sum(-1) > 0
    normal[away] *= -1
    depth = np.where(found, -(at @ view[2, :3] + view[2, 3]), 1e10)
    return triangle, at, normal, depth.reshape(height, width)


def _grid(n):
    k = (np.arange(n) + 0.5) / n
    return np.stack(np.meshgrid(k, k), -1).reshape(-1, 2)


def _disc(n):
    """Evenly over the unit disc, by radius and angle."""
    g = _grid(n)
    r, a = np.sqrt(g[:, 0]), 2 * np.pi * g[:, 1]
    return np.stack([r * np.cos(a), r * np.sin(a)], 1)


def _across(w):
    u = unit(np.cross(w, [1.0, 0, 0] if abs(w[0]) < 0.9 else [0, 1.0, 0]))
    return u, np.cross(w, u)


def rays(lamp, at, n):
    """(ways, where they end in units of themselves, light each brings to what faces it), for one place, of a lamp of
    colour 1; n * n of them."""
    model = np.asarray(lamp.model, float)
    axes, place = model[:3, :3], model[:3, 3]
    z = -unit(axes[:, 2])
    if lamp.kind == "sun":
        u, v = _across(z)
        low = np.cos(lamp.width / 2)
        g = _grid(n)
        c, a = low + (1 - low) * g[:, 0], 2 * np.pi * g[:, 1]
        s = np.sqrt(1 - c * c)
        ways = -c[:, None] * z + (s * np.cos(a))[:, None] * u + (s * np.sin(a))[:, None] * v
        return ways, np.inf, np.full(len(g), 2 / (1 + low) / np.pi / len(g))
    if lamp.kind in ("rectangle", "ellipse"):
        q = _grid(n) - 0.5 if lamp.kind == "rectangle" else _disc(n) / 2
        target = place + q[:, :1] * axes[:, 0] * lamp.width + q[:, 1:] * axes[:, 1] * lamp.height
        way = target - at
        far = np.linalg.norm(way, axis=1)
        front = np.maximum(-(way @ z) / far, 0)
        light = front / far ** 2 / np.pi ** 2 / len(q)
        if lamp.spread < np.pi - 1e-6:
            half = np.tan(lamp.spread / 2)
            with np.errstate(all="ignore"):
                light *= np.where(front > 0, np.maximum(half - np.tan(np.arccos(front)), 0), 0)
            light /= half - lamp.spread / 2
        return way, 0.99999, light
    to = place - at
    if lamp.width == 0:
        way = to[None]
        light = np.array([1 / (4 * np.pi ** 2) / (to @ to)])
    elif lamp.flat:
        u, v = _across(unit(to))
        q = _disc(n) * lamp.width
        way = to + q[:, :1] * u + q[:, 1:] * v
        far = np.linalg.norm(way, axis=1)
        light = way @ unit(to) / far / far ** 2 / (4 * np.pi ** 2) / len(q)
    else:  # points of the whole sphere's surface, of which those count that face the place
        g = _grid(n + n // 2)
        c, a = 2 * g[:, 0] - 1, 2 * np.pi * g[:, 1]
        s = np.sqrt(1 - c * c)
        normal = np.stack([s * np.cos(a), s * np.sin(a), c], 1)
        way = to + lamp.width * normal
        far = np.linalg.norm(way, axis=1)
        front = np.maximum(-(way * normal).sum(1) / far, 0)
        light = 4 * front / far ** 2 / (4 * np.pi ** 2) / len(g)
    if lamp.kind == "spot":
        scale = np.linalg.norm(axes, axis=0)
        own = unit(way @ (axes / scale) / scale)
        low = np.cos(lamp.spot_angle / 2)
        share = np.clip((own[:, 2] - low) / max((1 - low) * lamp.spot_blend, 1e-6), 0, 1)
        light = light * share * share * (3 - 2 * share)
    return way, 0.99999, light


def _share(bend, own):
    """How far an ellipsoid bends the light at places (..., 3) of its ball."""
    deep = 1 - np.linalg.norm(own, axis=-1)
    return bend.amount * np.where(deep > 0, np.clip(deep / bend.fade, 0, 1) if bend.fade else 1.0, 0.0)[..., None]


def bent(bends, at, normal):
    """Normals (n, 3) as ellipsoids bend them."""
    for bend in bends:
        inverse = np.linalg.inv(bend.model)
        own = at @ inverse[:3, :3].T + inverse[:3, 3]
        share = _share(bend, own)
        normal = unit(normal * (1 - share) + unit(own @ inverse[:3, :3]) * share)
    return normal


def leaves(bends, at, ways):
    """After which share of its way (n, 3) each ray begins, from one place or from places (n, 3): where it leaves the
    ellipsoids that hold the place, as far as these bend its normal."""
    most = np.zeros(len(ways))
    for bend in bends:
        inverse = np.linalg.inv(bend.model)
        own, to = at @ inverse[:3, :3].T + inverse[:3, 3], ways @ inverse[:3, :3].T
        a, b, c = (to * to).sum(-1), (to * own).sum(-1), (own * own).sum(-1) - 1
        whole = (np.sqrt(np.maximum(b * b - a * c, 0)) - b) / a
        most = np.maximum(most, _share(bend, own)[..., 0] * np.where(c < 0, whole, 0))
    return most


def draw(world, lamp, view, projection, width, height, n=12, bends=()):
    """(light (height, width), light without shadows, triangle of each pixel, depth) of one lamp of colour 1."""
    triangle, at, normal, depth = surfaces(world, view, projection, width, height)
    normal = bent(bends, at, normal)
    light, plain = np.zeros(len(at)), np.zeros(len(at))
    for i in np.flatnonzero(triangle >= 0):
        way, far, value = rays(lamp, at[i], n)
        value = value * np.maximum(unit(way) @ normal[i], 0)
        plain[i] = value.sum()
        used = np.flatnonzero(value > 0)
        if lamp.shadows and len(used):
            ways, start = way[used], np.repeat(at[i][None], len(used), 0)
            if bends:
                part = np.minimum(leaves(bends, at[i], ways), 0.999 if np.isfinite(far) else np.inf)[:, None]
                start, ways = start + part * ways, ways * (1 - part if np.isfinite(far) else 1)
            value[used[world.blocked(start, ways, far, triangle[i])]] = 0
        light[i] = value.sum()
    return (light.reshape(height, width), plain.reshape(height, width), triangle.reshape(height, width), depth)
