# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that things receive, at places that are fixed on them: whatever the camera sees, in whatever order they
come. What moves or bends has none, so that a shot keeps its light while figures act.

Both sides of a surface count, each by how open it is: the inside of a wall or a shoe is dark, and nobody looks
there."""

from dataclasses import dataclass

import numpy as np

from ..pen import irradiance

_EACH = 64     # places on a geometry, at most
_ALL = 1200    # on all things
_THINGS = 600  # that count: the largest
_REACH = 4     # sizes of the scene within which things count in full
_OPEN = 0.25   # of the scene's size: how long the ways are that tell how open a side is
_WAYS = 12
_FLOATS = 1e-3  # of the scene's size: how far from a surface its rays begin


@dataclass
class Spots:
    """Places on a geometry in its own space (n, 3), with normals by area, and the whole area."""

    places: np.ndarray
    normals: np.ndarray
    area: float


@dataclass
class Found:
    """Diffuse light: `shade`, what a tenth of the surfaces have less than, or half of them where their strongest lamp
    does not come, if that is less; `open`, what half of them have where it does not come: shade that lies open, where
    `shade` may be what no side but those that nobody sees has; `full`, what all but a fiftieth have less than; sky:
    whether the strongest lamp of most, if they have one, is a sun of the world's."""

    shade: float
    open: float
    full: float
    sky: bool


def _spread(n, dimensions):
    """(n, dimensions) of numbers from 0 to 1, the first k of which are spread evenly for every k: additive recurrences
    by powers of the number that is the root of x^(d+1) = x + 1."""
    root = 2.0
    for _ in range(32):
        root = (1 + root) ** (1 / (dimensions + 1))
    steps = root ** -np.arange(1, dimensions + 1)
    return (0.5 + np.outer(np.arange(1, n + 1), steps)) % 1


def spots(points, corners):
    """The Spots of triangles; None: they have no area."""
    a, b, c = (points[corners[:, k]].astype(np.float64) for k in range(3))
    across = np.cross(b - a, c - a)
    area = np.linalg.norm(across, axis=1) / 2
    area = np.where(np.isfinite(area), area, 0)
    whole = float(area.sum())
    if not whole > 0:
        return None
    of, one, two = _spread(_EACH, 3).T
    k = np.minimum(np.searchsorted(np.cumsum(area), of * whole), len(area) - 1)
    u, v = 1 - np.sqrt(one), np.sqrt(one) * two
    places = a[k] + u[:, None] * (b - a)[k] + v[:, None] * (c - a)[k]
    return Spots(places, across[k], whole)


def _ways():
    """(_WAYS, 3) of length 1, spread evenly."""
    up, turn = _spread(_WAYS, 2).T
    z, turn = 2 * up - 1, 2 * np.pi * turn
    level = np.sqrt(1 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], 1)


class Surfaces:
    """Sides of the places of still things: places (n, 3) a little above them, normals (n, 3), weights (n,)."""

    def __init__(self, scene, receivers, size):
        """scene: the pen.scene.Scene that throws shadows; receivers: (Spots, matrix) pairs."""
        places, normals, weights = [], [], []
        middles = np.array([(matrix @ np.append(of.places.mean(0), 1))[:3] for of, matrix in receivers])
        areas = np.array([of.area * abs(np.linalg.det(matrix[:3, :3])) ** (2 / 3) for of, matrix in receivers])
        middle, reach = np.median(middles, 0), _REACH * size
        counts = np.sqrt(np.minimum(areas, reach ** 2)) / (
            1 + (np.linalg.norm(middles - middle, axis=1) / reach) ** 4)
        largest = np.lexsort((*middles.T, -counts))[:_THINGS]
        share = counts[largest] / max(counts[largest].sum(), 1e-300)
        for k, each in zip(largest, np.clip(np.ceil(_ALL * share), 1, _EACH).astype(int), strict=True):
            of, matrix = receivers[k]
            try:
                turn = np.linalg.inv(matrix[:3, :3]).T
            except np.linalg.LinAlgError:
                continue
            own = of.places[:each] @ matrix[:3, :3].T + matrix[:3, 3]
            ways = of.normals[:each] @ turn.T
            places.append(own)
            normals.append(ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-300))
            near = 1 / (1 + (np.linalg.norm(own - middle, axis=1) / reach) ** 4)
            weights.append(near * counts[k] / each)
        self.places, self.normals = np.zeros((0, 3)), np.zeros((0, 3))
        self.weights = np.zeros(0)
        if not places:
            return
        place, normal, weight = np.concatenate(places), np.concatenate(normals), np.concatenate(weights)
        self.normals = np.concatenate([normal, -normal])
        self.places = np.concatenate([place, place]) + _FLOATS * size * self.normals
        self.weights = np.concatenate([weight, weight])
        # Of what reaches out of the scene, as a ground does, the side counts that looks at it.
        away = np.linalg.norm(self.places - middle, axis=1) > reach
        self.weights[away & (np.sum(self.normals * (middle - self.places), 1) < 0)] = 0
        self.open = self._openness(scene, size)
        self.weights = self.weights * self.open ** 2

    def _openness(self, scene, size):
        free, count = np.zeros(len(self.places)), np.zeros(len(self.places))
        for way in _ways():
            up = self.normals @ way
            for side in (1, -1):
                there = side * up > 0.1
                free[there] += scene.reached(self.places[there],
                                             np.broadcast_to(side * _OPEN * size * way, (there.sum(), 3)))
                count += there
        return free / np.maximum(count, 1)

    def received(self, scene, told, falls, ambient):
        """The Found. told: (shadow set, Lamp, whether it is the world's) of each lamp; falls: what its light is at
        places that face it, a function of both; ambient: (9, 3) from all sides, or None."""
        n = len(self.places)
        around = np.zeros((n, 3)) if ambient is None else np.maximum(irradiance.polynomials(self.normals) @ ambient, 0)
        lit, strongest, most, sky = around.copy(), np.zeros((n, 3)), np.zeros(n), np.zeros(n, bool)
        for shadow_set, lamp, world in told:
            facing, way = self._toward(lamp)
            comes = facing * falls(lamp, self.places)
            there = comes > 0
            if lamp.shadows:
                comes[there] *= scene.reached(self.places[there], way[there], shadow_set)
            color = comes[:, None] * np.asarray(lamp.color) / max(float(np.max(lamp.color)), 1e-300)
            lit += color
            more = comes > most
            strongest[more], most[more], sky[more] = color[more], comes[more], world
        whole = np.max(lit, 1)
        dark, half = _share(whole, self.weights, 0.1), _share(np.max(lit - strongest, 1), self.weights, 0.5)
        of_world = any(world for _, _, world in told) and self.weights @ sky >= 0.5 * (self.weights @ (most > 0))
        return Found(min(dark, half), half, _share(whole, self.weights, 0.98), bool(of_world))

    def _toward(self, lamp):
        """(cosines at which a lamp's light falls (n,), ways to it (n, 3))."""
        if lamp.kind == "sun":
            toward = lamp.model[:3, 2] / max(np.linalg.norm(lamp.model[:3, 2]), 1e-300)
            return np.maximum(self.normals @ toward, 0), np.broadcast_to(1e6 * toward, self.normals.shape)
        way = lamp.model[:3, 3] - self.places
        far = np.maximum(np.linalg.norm(way, axis=1), 1e-300)
        return np.maximum(np.sum(self.normals * way, 1) / far, 0), 0.999 * way


def _share(values, weights, share):
    """The value below which this share of the weight lies."""
    order = np.argsort(values, kind="stable")
    sums = np.cumsum(weights[order])
    return float(values[order][min(np.searchsorted(sums, share * sums[-1]), len(order) - 1)])
