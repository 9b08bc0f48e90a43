# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes by formula: the layers a renderer would give, and where their contours truly are."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from reference import metric

from .camera import Camera
from .shapes import circle, meet, parted

THRESHOLDS = (0.5, 0.9)  # of the default shade_levels
GREYS = metric.encode(np.array([0.5, 0.7, 1.1]))
NOTHING = 1e10
STEP = 0.125  # pixels between two points of a contour
CREASE = 20  # degrees of a bend that must be inked
OUTLINE = 0.02  # step of depth, relative, that must be inked
STUB = 6.0  # pixels: a line is not asked for where so little of it would be drawn
ENDS = 2.0  # pixels to where it may end, at most
SIDE = 0.004  # pixels: how far to either side of a contour its two sides are looked at
_GRID = 8  # samples a pixel and axis


@dataclass
class Light:
    """A sun with hard shadows on whatever casts none itself, and a soft round pool on flat parts."""
    way: np.ndarray  # unit, towards the sun
    sun: float = 0.8
    ambient: float = 0.3
    pool: tuple | None = None  # (centre, strength, radius)
    tint: tuple = (1.0, 0.95, 0.85)


@dataclass
class Truth:
    """Dense points of all contours, `STEP` pixels apart: arrays of length N, and what differs across each point.

    Coordinates are those of pixel centres: pixel (row, column) lies at x = column, y = row."""
    x: np.ndarray
    y: np.ndarray
    nx: np.ndarray  # unit normal of the contour in the frame
    ny: np.ndarray
    curve: np.ndarray  # points of one curve lie one after another
    depth: np.ndarray  # relative step of depth, inf where one side is nothing
    index: np.ndarray  # another object
    angle: np.ndarray  # degrees between the normals
    color: np.ndarray  # contrast of the encoded albedos (Herring 2016, eq. 3.1)
    light: np.ndarray  # contrast of the two light levels' greys
    narrow: np.ndarray  # may be left out: a crease beside a face less than 3 pixels wide, crowded colours
    size: tuple  # rows, columns
    clear: dict = field(init=False, default_factory=dict)  # what was found of these points
    faint: np.ndarray | None = field(init=False, default=None)  # (n, 2): x, y of more that may be inked

    def take(self, where):
        arrays = {k: v[where] for k, v in vars(self).items() if k not in ("size", "clear", "faint")}
        return Truth(size=self.size, **arrays)

    def visible(self):
        """The points across which anything differs."""
        return self.take((self.depth > 0.005) | self.index | (self.angle > 3) | (self.color > 0.01) | (self.light > 0))

    def one_index(self):
        """The contours that are left when all objects have one index."""
        return replace(self, index=np.isinf(self.depth)).visible()

    @property
    def outline(self):
        return (self.depth >= OUTLINE) | self.index

    def required(self, kind):
        """Mask of the points that must be inked; `kind` is outline, crease, color, light, or all."""
        crease = (self.angle >= CREASE) & ~self.narrow & ~self.outline
        color = (self.color >= 0.12) & ~self.narrow & ~self.outline & ~(self.angle >= 8)
        light = (self.light > 0.05) & ~self.outline & ~(self.angle >= 8) & ~(self.color >= 0.05)
        masks = {"outline": self.outline, "crease": crease, "color": color, "light": light}
        return np.any(list(masks.values()), axis=0) if kind == "all" else masks[kind]


def _measured(seen):
    """(…, 8): normal, albedo, light, coverage."""
    alpha = (seen["solid"] > 0)[..., None]
    return np.concatenate([seen["normal"], seen["albedo"], seen["light"][..., None], alpha], -1)


def _place(filter, share):
    """Where in the pixel a filter has gathered that share (0…1) of its weight: even shares sample it evenly."""
    if filter == "box":
        return share - 0.5
    at = np.linspace(0, 2 * np.pi, 1001)  # Blackman-Harris, integrated
    below = 0.35875 * at - 0.48829 * np.sin(at) + 0.14128 / 2 * np.sin(2 * at) - 0.01168 / 3 * np.sin(3 * at)
    return np.interp(share, below / below[-1], 1.5 * (at / (2 * np.pi) - 0.5))


@dataclass
class Scene:
    camera: Camera
    solids: list
    light: Light
    size: tuple = (300, 400)  # rows, columns
    spots = ()  # groups of equal ones: (their places in pixels, their radius)

    def __post_init__(self):
        self._averages = {}  # by filter
        for k, solid in enumerate(self.solids, 1):
            solid.index = k

    def _crossings(self):
        curves = []
        for k, one in enumerate(self.solids):
            for two in self.solids[:k]:
                ends = [solid.reach for solid in (one, two) if solid.reach]
                apart = len(ends) == 2 and np.linalg.norm(ends[0][0] - ends[1][0]) > ends[0][1] + ends[1][1]
                curves += [] if apart or (len(ends) == 2 and parted(one, two)) else meet(one, two)
        return curves

    # Layers

    def trace(self, x, y):
        """What is seen at places of the frame: depth (inf: nothing), solid (0), part, normal, albedo, light."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        shape = x.shape
        x, y = x.ravel(), y.ravel()
        depth, which, part = np.full(x.shape, np.inf), np.zeros(x.shape, np.int8), np.zeros(x.shape, np.int8)
        o, d = self.camera.rays(x, y, self.size)
        for solid in self.solids:
            spot = self._near(solid, x, y)
            t, face = solid.hit(o[spot], d[spot])
            t = np.where(t > 1e9, np.inf, t)
            front = t < depth[spot]
            spot = spot[front]
            depth[spot], which[spot], part[spot] = t[front], solid.index, face[front]
        normal, albedo, light = np.zeros((x.size, 3)), np.zeros((x.size, 3)), np.zeros(x.size)
        for solid in self.solids:
            spot = np.flatnonzero(which == solid.index)
            p, face = o[spot] + d[spot] * depth[spot, None], part[spot]
            normal[spot], albedo[spot] = solid.normal(p, face), solid.albedo(p, face)
            light[spot] = self._light(solid, p, face, normal[spot])
        return {"depth": depth.reshape(shape), "solid": which.reshape(shape), "part": part.reshape(shape),
                "normal": normal.reshape(*shape, 3), "albedo": albedo.reshape(*shape, 3),
                "light": light.reshape(shape)}

    def _near(self, solid, x, y):
        """The places that may see a solid."""
        if solid.reach is None:
            return np.arange(x.size)
        (centre, radius), camera = solid.reach, self.camera
        cx, cy, z = camera.project(centre, self.size)
        if camera.height:
            reach = radius * self.size[0] / camera.height
        elif z <= 2 * radius:
            return np.arange(x.size)
        else:
            reach = 1.3 * radius * self.size[0] * camera.focal / (z - radius)
        return np.flatnonzero((np.abs(x - cx) <= reach + 1) & (np.abs(y - cy) <= reach + 1))

    def _light(self, solid, p, part, normal):
        light = self.light
        facing = np.maximum(normal @ light.way, 0)
        if solid.reach is None:
            for other in self.solids:
                if other.reach is None:
                    continue
                centre, radius = other.reach
                off = p - centre
                spot = np.flatnonzero((off**2).sum(-1) - (off @ light.way) ** 2 < radius**2)
                t, _ = other.hit(p[spot], np.broadcast_to(light.way, (spot.size, 3)))
                facing[spot[np.isfinite(t)]] = 0
        value = light.ambient + light.sun * facing
        if light.pool:
            centre, strength, radius = light.pool
            glow = strength * np.exp(-((p - centre) ** 2).sum(-1) / radius**2)
            value = value + np.where(np.isin(part, self._flat(solid)), glow, 0)
        return value

    @staticmethod
    def _flat(solid):
        return [k for k, part in enumerate(solid.parts) if hasattr(part, "n")]

    def layers(self, filter="box", noise=0.0, seed=0, one_index=False):
        """The layers, float32 (rows, columns, channels): depth and index exact at the pixel centres; normal, colour and
        light averaged by a "box" of one pixel or by "blackman" (Blackman-Harris, 1.5 pixels wide), 64 samples a pixel,
        or of one at its "centre".

        noise: 1 is 3 % of white noise in the light and 1 % in normal and colour. one_index: all is one object."""
        h, w = self.size
        centre, soft = self._centres, self._average(filter)
        there = np.isfinite(centre["depth"])
        normal, albedo, light, alpha = soft[..., :3], soft[..., 3:6], soft[..., 6:7], soft[..., 7:]
        g = np.random.default_rng(seed).standard_normal((3, h, w, 3)) * noise * (alpha > 0)
        diffuse = light * self.light.tint * (1 + 0.03 * g[0])
        normal, albedo = normal + 0.01 * g[1], np.clip(albedo * (1 + 0.01 * g[2]), 0, 1)
        index = there.astype(float) if one_index else centre["solid"]
        layers = {"combined": np.concatenate([albedo * diffuse, alpha], -1), "color": albedo, "albedo": albedo,
                  "diffuse": diffuse, "depth": np.where(there, centre["depth"], NOTHING)[..., None], "normal": normal,
                  "object": index[..., None]}
        return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}

    @cached_property
    def _centres(self):
        y, x = np.mgrid[0.0:self.size[0], 0.0:self.size[1]]
        return self.trace(x, y)

    def _average(self, filter):
        """(rows, columns, 8): averages where a contour is within 2 pixels; else the centre will do.

        One jittered sample in each of 8×8 cells of the filter's weight, each pixel with its own."""
        if filter in self._averages:
            return self._averages[filter]
        soft = self._averages[filter] = _measured(self._centres)
        if filter == "centre":
            return soft
        truth, (h, w) = self.truth, self.size
        busy = np.zeros(self.size, bool)
        for dy in range(-2, 3):
            for dx in range(-2, 3):
                busy[np.clip(np.rint(truth.y + dy).astype(int), 0, h - 1),
                     np.clip(np.rint(truth.x + dx).astype(int), 0, w - 1)] = True
        cell_y, cell_x = np.indices((_GRID, _GRID)).reshape(2, -1)
        rng = np.random.default_rng(1)
        spots = np.argwhere(busy)
        for spot in np.array_split(spots, len(spots) // 4096 + 1):
            jitter = rng.random((2, len(spot), _GRID**2))
            dy, dx = (_place(filter, (cell + j) / _GRID) for cell, j in zip((cell_y, cell_x), jitter, strict=True))
            samples = _measured(self.trace(spot[:, 1:] + dx, spot[:, :1] + dy))
            soft[spot[:, 0], spot[:, 1]] = samples.mean(1)
        soft.flags.writeable = False
        return soft

    @property
    def camera_settings(self):
        """The camera as `encre.camera` tells it."""
        return {"orthographic": self.camera.height > 0, "height": self.camera.height or 1.0,
                "view": self.camera.view.ravel().tolist()}

    # Truth

    def _curves(self):
        curves = self._crossings()
        for solid in self.solids:
            curves += solid.curves(self.camera.homogeneous)
            curves += [c for patch in solid.patches for c in patch.curves]
            for threshold in THRESHOLDS if self.light.sun else ():
                for part in solid.parts:
                    curves += part.levels(self.light.way, (threshold - self.light.ambient) / self.light.sun)
            for threshold in THRESHOLDS:
                curves += self._pools(solid, threshold)
            if solid.reach is None:
                curves += self._ground(solid)
        return curves

    def _ground(self, ground):
        plane, eye = ground.parts[0], self.camera.eye
        far = np.array([eye[0], plane.k, eye[2]])
        curves = []
        if not self.camera.height:
            def horizon(s):
                turn = 2 * np.pi * np.asarray(s)
                return far + 1e8 * np.stack([np.cos(turn), 0 * turn, np.sin(turn)], -1)
            curves.append(horizon)
        way = self.light.way

        def shadow(curve):
            def at(s):
                p = curve(s)
                return p + way * ((plane.k - p @ plane.n) / (way @ plane.n))[..., None]
            return at
        sun = np.append(way, 0.0)
        return curves + [shadow(c) for solid in self.solids if solid.reach for c in solid.curves(sun)]

    def _pools(self, solid, threshold):
        if not self.light.pool:
            return []
        centre, strength, radius = self.light.pool
        curves = []
        for k in self._flat(solid):
            part = solid.parts[k]
            plane_distance = part.k - part.n @ centre
            facing = max(0.0, part.n @ self.light.way)
            for base in {self.light.ambient, self.light.ambient + self.light.sun * facing}:
                share = (threshold - base) / strength
                square = -radius**2 * np.log(share) - plane_distance**2 if 0 < share < 1 else -1
                if square > 0:
                    curves.append(circle(centre + part.n * plane_distance, part.n, np.sqrt(square)))
        return curves

    def _points(self, curve):
        """x, y and the unit normal in the frame, `STEP` apart, of what lies in the frame."""
        h, w = self.size
        s = np.linspace(0, 1, 4097)
        x, y, z = self.camera.project(curve(s), self.size)
        inside = (z > 0.05) & (x > -9) & (x < w + 8) & (y > -9) & (y < h + 8)
        step = np.where(inside[1:] & inside[:-1], np.hypot(np.diff(x), np.diff(y)), 0)
        length = np.append(0, np.cumsum(step))
        if not length[-1] > 0:
            return np.zeros((4, 0))
        n = max(2, int(np.ceil(length[-1] / STEP)))
        rising = np.append(True, np.diff(length) > 0)
        s = np.interp((np.arange(n) + 0.5) / n * length[-1], length[rising], s[rising])
        x, y, z = self.camera.project(curve(s), self.size)
        ax, ay, _ = self.camera.project(curve(np.maximum(s - 1e-6, 0)), self.size)
        bx, by, _ = self.camera.project(curve(np.minimum(s + 1e-6, 1)), self.size)
        tx, ty = bx - ax, by - ay
        length = np.hypot(tx, ty)
        ok = (z > 0.05) & (x > -0.5) & (x < w - 0.5) & (y > -0.5) & (y < h - 0.5) & (length > 0)
        return np.array([x, y, -ty / np.where(length, length, 1), tx / np.where(length, length, 1)])[:, ok]

    @cached_property
    def truth(self):
        """The contours; see Truth."""
        found = [self._points(curve) for curve in self._curves()]
        number = np.concatenate([np.full(p.shape[1], k) for k, p in enumerate(found)])
        x, y, nx, ny = np.concatenate(found, axis=1)
        one, two = (self.trace(x + side * nx, y + side * ny) for side in (-SIDE, SIDE))
        none = [~np.isfinite(s["depth"]) for s in (one, two)]
        a, b = (np.where(n, 1.0, s["depth"]) for n, s in zip(none, (one, two), strict=True))
        scale = self.camera.height or np.minimum(a, b)
        depth = np.where(none[0] & none[1], 0.0, np.where(none[0] | none[1], np.inf, np.abs(a - b) / scale))
        index = one["solid"] != two["solid"]
        dot = (one["normal"] * two["normal"]).sum(-1)
        angle = np.where(none[0] | none[1], 0, np.degrees(np.arccos(np.clip(dot, -1, 1))))
        color = metric.rgb(metric.encode(one["albedo"]), metric.encode(two["albedo"]))
        levels = [np.searchsorted(THRESHOLDS, s["light"]) for s in (one, two)]
        light = np.abs(GREYS[levels[0]] - GREYS[levels[1]])
        crease, narrow = (angle >= CREASE) & (depth < OUTLINE), np.zeros(x.shape, bool)
        faces = [s["solid"][crease].astype(np.int32) * 64 + s["part"][crease] for s in (one, two)]
        narrow[crease] = self._narrow(x[crease], y[crease], nx[crease], ny[crease], faces)
        narrow |= _stubs(x, y, number, crease, narrow)
        truth = Truth(x, y, nx, ny, number, depth, index, angle, color, light, narrow, self.size)
        return truth.visible()

    def _narrow(self, x, y, nx, ny, faces):
        """Whether one of the faces beside the point has no disc of 3 pixels within 3 pixels of it, or is a strip there:
        less than 3 pixels across, as it is 1.5 pixels on, however wide it is where the strip ends."""
        if not x.size:
            return False
        h, w = self.size
        fine = 3  # places a pixel and axis
        about = np.zeros((h + 6, w + 6), bool)  # what is asked below, by pixels
        about[np.floor(y + 3).astype(int), np.floor(x + 3).astype(int)] = True
        for axis in (0, 1):
            about = np.any([np.roll(about, shift, axis) for shift in range(-7, 8)], axis=0)
        rows, columns = np.nonzero(about.repeat(fine, 0).repeat(fine, 1))
        seen = self.trace(columns / fine - 3, rows / fine - 3)
        label = np.full(((h + 6) * fine, (w + 6) * fine), -1, np.int32)
        label[rows, columns] = seen["solid"].astype(np.int32) * 64 + seen["part"]
        r = int(1.5 * fine)
        span = np.arange(-r, r + 1)
        whole = np.ones(label.shape, bool)
        for dy in span:
            for dx in span:
                if dx * dx + dy * dy <= (1.5 * fine) ** 2:
                    whole &= np.roll(label, (dy, dx), (0, 1)) == label
        reach = int(4.5 * fine)
        ring = [(dy, dx) for dy in range(-reach, reach + 1) for dx in range(-reach, reach + 1)
                if dy * dy + dx * dx <= (4.5 * fine) ** 2]
        narrow = np.zeros(x.shape, bool)
        for face in faces:
            wide = np.zeros(x.shape, bool)
            iy, ix = (np.round(v * fine).astype(int) + 3 * fine for v in (y, x))
            todo = np.arange(x.size)
            for dy, dx in ring:
                at = np.clip(iy[todo] + dy, 0, label.shape[0] - 1), np.clip(ix[todo] + dx, 0, label.shape[1] - 1)
                hit = whole[at] & (label[at] == face[todo])
                wide[todo[hit]] = True
                todo = todo[~hit]
            narrow |= ~wide
            narrow |= _strip(label, face, x * fine + 3 * fine, y * fine + 3 * fine, nx * fine, ny * fine)
        return narrow


def _stubs(x, y, number, crease, narrow):
    """Ends of creases that may be left out all but for less than STUB pixels, of which the other end is a corner; and
    the ENDS of others, beside what may be left out."""
    kind = np.where(crease, 1 + narrow, 0)
    turns = (np.diff(kind) != 0) | (np.diff(number) != 0) | (np.hypot(np.diff(x), np.diff(y)) > 4 * STEP)
    run = np.append(0, np.cumsum(turns))
    first = np.flatnonzero(np.append(True, turns))
    length, of, curve = np.bincount(run) * STEP, kind[first], number[first]
    stub, place = np.zeros(x.size, bool), (np.arange(x.size) - first[run]) * STEP
    for side, beyond in (-1, place), (1, length[run] - place):
        beside = np.clip(np.arange(of.size) + side, 0, of.size - 1)
        goes_on = (of == 1) & (of[beside] == 2) & (curve[beside] == curve)
        stub |= goes_on[run] & (beyond <= ENDS)
        stub |= (goes_on & (length < STUB) & (length[beside] > length))[run]
    return stub


def _strip(label, face, x, y, nx, ny):
    """Where a face is a strip, on a grid of labels; (nx, ny): three times a pixel's length, across."""
    span = np.arange(0.25, 3, 0.25)

    def across(along):
        found = np.zeros(x.size)
        for side in (1, -1):
            h, w = label.shape
            column = np.rint(x[:, None] - along * ny[:, None] + side * nx[:, None] * span).astype(int).clip(0, w - 1)
            row = np.rint(y[:, None] + along * nx[:, None] + side * ny[:, None] * span).astype(int).clip(0, h - 1)
            inside = label[row, column] == face[:, None]
            found = np.maximum(found, inside[:, :2].any(1) * inside.sum(1) * 0.25)
        return found
    own, one, two = (across(along) for along in (0, -1.5, 1.5))
    return (own < 2.75) & (np.abs(one - two) < 1.5) & (np.minimum(one, two) > 0) & (np.maximum(one, two) < 2.75)
