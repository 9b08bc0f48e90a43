# SPDX-License-Identifier: GPL-3.0-or-later
"""Convex solids that a ray meets by formula, and the curves on them where a contour can run.

A solid is what all its parts (half spaces, balls, tubes, cones) have in common. Curves are functions of s in 0…1
that give points (…, 3), exact to rounding. There may be too many of them: the scene keeps the stretches across
which something differs. An eye is (x, y, z, 1), or a direction towards it (x, y, z, 0)."""

from dataclasses import dataclass, field

import numpy as np


def unit(v):
    v = np.asarray(v, float)
    return v / np.linalg.norm(v)


def across(axis):
    """Two unit vectors that make a right-handed frame with a unit axis."""
    one = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]))
    return one, np.cross(axis, one)


def segment(a, b):
    a, b = np.asarray(a, float), np.asarray(b, float)
    return lambda s: a + (b - a) * np.asarray(s)[..., None]


def circle(centre, axis, radius):
    one, two = across(unit(axis))

    def at(s):
        turn = 2 * np.pi * np.asarray(s)[..., None]
        return centre + radius * (np.cos(turn) * one + np.sin(turn) * two)
    return at


def _between(a, b, c):
    """The interval of t where a t² + b t + c ≤ 0, for a > 0; empty is (inf, -inf)."""
    square = b * b - 4 * a * c
    root = np.sqrt(np.maximum(square, 0))
    miss = square < 0
    return np.where(miss, np.inf, (-b - root) / (2 * a)), np.where(miss, -np.inf, (-b + root) / (2 * a))


@dataclass
class HalfSpace:
    """n · p ≤ k."""
    n: np.ndarray
    k: float

    def interval(self, o, d):
        away, along = self.k - o @ self.n, d @ self.n
        with np.errstate(divide="ignore", invalid="ignore"):
            t = away / along
        enter = np.where(along < 0, t, np.where((along == 0) & (away < 0), np.inf, -np.inf))
        return enter, np.where(along > 0, t, np.inf)

    def normal(self, p):
        return np.broadcast_to(self.n, p.shape)

    def silhouettes(self, eye):
        return []

    def levels(self, light, k):
        return []

    def cut(self, plane, reach):
        """The curves in which this part meets a plane, within (centre, radius)."""
        along = np.cross(self.n, plane.n)
        if along @ along < 1e-9:
            return []
        centre, radius = reach
        system = np.array([self.n, plane.n, along])
        foot = np.linalg.solve(system, [self.k, plane.k, along @ centre])
        along = unit(along) * radius
        return [segment(foot - along, foot + along)]


@dataclass
class Ball:
    centre: np.ndarray
    radius: float

    def interval(self, o, d):
        o = o - self.centre
        return _between((d * d).sum(-1), 2 * (o * d).sum(-1), (o * o).sum(-1) - self.radius**2)

    def normal(self, p):
        return (p - self.centre) / self.radius

    def silhouettes(self, eye):
        if eye[3] == 0:
            return [circle(self.centre, eye[:3], self.radius)]
        way = eye[:3] - self.centre
        share = self.radius**2 / (way @ way)
        return [circle(self.centre + way * share, way, self.radius * np.sqrt(1 - share))]

    def levels(self, light, k):
        """Where normal · light = k, for a unit light."""
        if abs(k) >= 1:
            return []
        return [circle(self.centre + light * self.radius * k, light, self.radius * np.sqrt(1 - k * k))]

    def cut(self, plane, reach):
        return [circle(self.centre + plane.n * h, plane.n, np.sqrt(self.radius**2 - h * h))
                for h in [plane.k - plane.n @ self.centre] if abs(h) < self.radius]


@dataclass
class Cone:
    """All points within `radius + slope·h` of the axis, where that is not negative; h is along it from `centre`.

    A tube if slope is 0. `near`…`far` is the stretch of h that its curves are drawn on."""
    centre: np.ndarray
    axis: np.ndarray
    radius: float
    slope: float
    near: float
    far: float

    def interval(self, o, d):
        o = o - self.centre
        h, dh = o @ self.axis, d @ self.axis
        r, dr = self.radius + self.slope * h, self.slope * dh
        a = (d * d).sum(-1) - dh * dh - dr * dr
        b = 2 * ((o * d).sum(-1) - h * dh - r * dr)
        c = (o * o).sum(-1) - h * h - r * r
        flip = a < 0  # such a ray leaves one nappe and enters the other: its inside is not between the roots
        first, last = _between(np.where(a == 0, 1e-300, np.abs(a)), np.where(flip, -b, b), np.where(flip, -c, c))
        up = dr > 0
        with np.errstate(invalid="ignore"):
            inside = r + dr * np.where(np.isfinite(first + last), (first + last) / 2, 0) >= 0
        enter = np.where(flip, np.where(up, last, -np.inf), np.where(inside, first, np.inf))
        leave = np.where(flip, np.where(up, np.inf, first), np.where(inside, last, -np.inf))
        return enter, leave

    def normal(self, p):
        p = p - self.centre
        out = p - (p @ self.axis)[..., None] * self.axis
        n = out / np.linalg.norm(out, axis=-1, keepdims=True) - self.slope * self.axis
        return n / np.hypot(1, self.slope)

    def _generators(self, v, k):
        """The straight lines on which out · v = k, `out` being the unit vector away from the axis."""
        flat = v - (v @ self.axis) * self.axis
        length = np.linalg.norm(flat)
        if length == 0 or abs(k) >= length:
            return []
        one = flat / length
        two, angle = np.cross(self.axis, one), np.arccos(k / length)
        outs = [np.cos(angle) * one + sign * np.sin(angle) * two for sign in (-1, 1)]
        return [segment(self.on(out, self.near), self.on(out, self.far)) for out in outs]

    def on(self, out, h):
        h = np.asarray(h)[..., None]
        return self.centre + self.axis * h + out * (self.radius + self.slope * h)

    def silhouettes(self, eye):
        if eye[3] == 0:
            return self._generators(eye[:3], self.slope * (eye[:3] @ self.axis))
        way = eye[:3] - self.centre
        return self._generators(way, self.radius + self.slope * (way @ self.axis))

    def levels(self, light, k):
        return self._generators(light, k * np.hypot(1, self.slope) + self.slope * (light @ self.axis))

    def ring(self, h):
        return circle(self.centre + self.axis * h, self.axis, self.radius + self.slope * h)

    def cut(self, plane, reach):
        one, two = across(self.axis)

        def at(s):
            turn = 2 * np.pi * np.asarray(s)[..., None]
            out = np.cos(turn) * one + np.sin(turn) * two
            foot = self.centre + out * self.radius
            rise = self.axis + out * self.slope
            return foot + rise * ((plane.k - foot @ plane.n) / (rise @ plane.n))[..., None]
        return [at] if abs(plane.n @ self.axis) > 1e-3 else []


@dataclass
class Patch:
    """Another colour where inside(p) is true on one part of a solid; `curves` are its rim."""
    part: int
    inside: object
    color: np.ndarray
    curves: list


@dataclass
class Solid:
    parts: list
    edges: list  # curves that are on it whoever looks
    reach: tuple | None  # (centre, radius) of a ball about it; None: no end
    color: np.ndarray = field(default_factory=lambda: np.array([0.5, 0.5, 0.5]))
    patches: list = field(default_factory=list)
    index: int = 0

    def hit(self, o, d):
        """Where rays from o along d enter: t (inf: they do not), and through which part."""
        part = np.zeros(d.shape[:-1], np.int8)
        enter, leave = self.parts[0].interval(o, d)
        for k, one in enumerate(self.parts[1:], 1):
            t, end = one.interval(o, d)
            part = np.where(t > enter, np.int8(k), part)
            enter, leave = np.maximum(enter, t), np.minimum(leave, end)
        return np.where((enter < leave) & (enter > 1e-9), enter, np.inf), part

    def normal(self, p, part):
        n = np.zeros(p.shape)
        for k, one in enumerate(self.parts):
            on = part == k
            if on.any():
                n[on] = one.normal(p[on])
        return n

    def albedo(self, p, part):
        color = np.broadcast_to(self.color, p.shape).copy()
        for patch in self.patches:
            color[(part == patch.part) & patch.inside(p)] = patch.color
        return color

    def curves(self, eye):
        return self.edges + [c for part in self.parts for c in part.silhouettes(eye)]


# Solids


def ground(height):
    """Everything below y = height, to the horizon."""
    return Solid([HalfSpace(np.array([0.0, 1, 0]), height)], [], None)


def ball(centre, radius):
    centre = np.asarray(centre, float)
    return Solid([Ball(centre, radius)], [], (centre, radius))


def prism(outline, length, centre, turn):
    """A convex outline (n, 2), counter-clockwise, in the x and y of the rotation `turn` (columns are its axes),
    drawn out to ±length/2 along its z. A box, a roof, a column of n sides."""
    outline, centre = np.asarray(outline, float), np.asarray(centre, float)

    def place(x, y, z):
        return centre + turn @ np.array([x, y, z])
    n = len(outline)
    ends = [[place(x, y, z) for x, y in outline] for z in (-length / 2, length / 2)]
    parts = []
    for k in range(n):
        dx, dy = outline[(k + 1) % n] - outline[k]
        normal = turn @ unit([dy, -dx, 0])
        parts.append(HalfSpace(normal, normal @ ends[0][k]))
    parts += [HalfSpace(sign * turn[:, 2], sign * turn[:, 2] @ end[0]) for sign, end in zip((-1, 1), ends, strict=True)]
    edges = [segment(end[k], end[(k + 1) % n]) for end in ends for k in range(n)]
    edges += [segment(ends[0][k], ends[1][k]) for k in range(n)]
    corners = np.array(ends).reshape(-1, 3)
    return Solid(parts, edges, (centre, np.linalg.norm(corners - centre, axis=1).max()))


def box(size, centre, turn):
    x, y, z = np.asarray(size, float) / 2
    return prism([(-x, -y), (x, -y), (x, y), (-x, y)], 2 * z, centre, turn)


def cone(foot, axis, bottom, top, height):
    """A cut-off cone, a cylinder (top = bottom) or one with a tip (top = 0), from its foot along the unit axis."""
    foot, axis = np.asarray(foot, float), unit(axis)
    side = Cone(foot, axis, bottom, (top - bottom) / height, 0.0, height)
    parts = [side, HalfSpace(-axis, -axis @ foot), HalfSpace(axis, axis @ foot + height)]
    rings = [side.ring(0.0)] + ([side.ring(height)] if top > 0 else [])
    return Solid(parts, rings, (foot + axis * height / 2, np.hypot(height / 2, max(bottom, top))))


# Patches


def cap(solid, direction, k, color):
    """On a ball: where its normal · direction > k."""
    part, direction = solid.parts[0], unit(direction)
    solid.patches.append(Patch(0, lambda p: part.normal(p) @ direction > k, color, part.levels(direction, k)))


def disc(solid, part, centre, radius, color):
    """On a flat part: a round spot."""
    inside = lambda p: ((p - centre) ** 2).sum(-1) < radius**2  # noqa: E731
    solid.patches.append(Patch(part, inside, color, [circle(centre, solid.parts[part].n, radius)]))


def polygon(solid, part, corners, color):
    """On a flat part: a convex polygon with corners in order, either way round."""
    corners = np.asarray(corners, float)
    sides = np.roll(corners, -1, 0) - corners
    inward = np.cross(solid.parts[part].n, sides)
    inward *= np.sign(inward[0] @ (corners.mean(0) - corners[0]))

    def inside(p):
        return np.all([(p - c) @ n > 0 for c, n in zip(corners, inward, strict=True)], axis=0)
    solid.patches.append(Patch(part, inside, color, [
        segment(a, b) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]))


def band(solid, low, high, color):
    """On a cone's side: between two heights along its axis."""
    side = solid.parts[0]

    def inside(p):
        h = (p - side.centre) @ side.axis
        return (h > low) & (h < high)
    solid.patches.append(Patch(0, inside, color, [side.ring(low), side.ring(high)]))


def parted(one, two):
    """Whether a plane of one of two polyhedra has all of the other before it; touching edges are its own."""
    for a, b in (one, two), (two, one):
        if all(isinstance(part, HalfSpace) for part in b.parts):
            corners = np.array([curve(end) for curve in b.edges for end in (0.0, 1.0)])
            if any((corners @ part.n >= part.k - 1e-9).all() for part in a.parts if isinstance(part, HalfSpace)):
                return True
    return False


def meet(one, two):
    """Curves in which two solids cut into each other; ball with ball and with flat parts, cone with flat parts."""
    reach = one.reach or two.reach
    curves = []
    for a in one.parts:
        for b in two.parts:
            if isinstance(b, HalfSpace):
                curves += a.cut(b, reach)
            elif isinstance(a, HalfSpace):
                curves += b.cut(a, reach)
            elif isinstance(a, Ball) and isinstance(b, Ball):
                way = b.centre - a.centre
                h = (way @ way + a.radius**2 - b.radius**2) / (2 * np.linalg.norm(way))
                curves += a.cut(HalfSpace(unit(way), unit(way) @ a.centre + h), reach)
    return curves
