# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of polygon meshes, for pictures that Blender renders: their contours, from vertices and camera alone."""

from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from .scene import Light, Scene
from .shapes import segment, unit

SHARP = 20.0  # degrees: faces that meet at less are one surface


@dataclass
class Mesh:
    """A closed mesh, or an open one seen from one side only; faces are flat, convex, counter-clockwise from outside."""
    points: np.ndarray  # (n, 3)
    faces: list  # of lists of their points' numbers
    color: tuple = (0.5, 0.5, 0.5)
    piece: list = ()  # of each face the number of the piece that it is of
    strips: list = ()  # of bevels: the two faces beside one, and the list of its own
    index: int = field(default=0, init=False)  # the scene's

    def __post_init__(self):
        self.piece = list(self.piece) or [0] * len(self.faces)

    @cached_property
    def triangles(self):
        return np.array([(face[0], b, c) for face in self.faces for b, c in pairwise(face[1:])], np.int32)

    @cached_property
    def normals(self):
        corners = [self.points[face[:3]] for face in self.faces]
        return np.array([unit(np.cross(b - a, c - b)) for a, b, c in corners])

    @cached_property
    def edges(self):
        """{(point, point): [face, …]}"""
        edges = defaultdict(list)
        for k, face in enumerate(self.faces):
            for a, b in pairwise([*face, face[0]]):
                edges[min(a, b), max(a, b)].append(k)
        return edges

    @cached_property
    def parts(self):
        """Of each face the number of the smooth surface that it belongs to."""
        part = np.arange(len(self.faces))
        while True:
            before = part.copy()
            for faces in self.edges.values():
                if len(faces) == 2 and self._bend(*faces) < SHARP:
                    part[faces] = part[faces].min()
            if (part == before).all():
                return np.unique(part, return_inverse=True)[1]

    def _bend(self, one, two):
        return np.degrees(np.arccos(np.clip(self.normals[one] @ self.normals[two], -1, 1)))

    def facing(self, eye):
        """Which faces look at a homogeneous eye."""
        first = self.points[[face[0] for face in self.faces]]
        return (self.normals * (eye[:3] - first * eye[3])).sum(1) > 0

    def curves(self, eye):
        """The edges across which the outline, or a crease, may run."""
        front = self.facing(eye)
        return [segment(*self.points[list(ends)]) for ends, faces in self.edges.items()
                if front[faces].any() and (len(faces) < 2 or not front[faces].all() or self._bend(*faces) >= SHARP)]


class MeshScene(Scene):
    """Meshes that do not cut into each other, all before the camera."""

    def __init__(self, camera, meshes, size):
        super().__init__(camera, meshes, Light(unit([0, 1, 0]), sun=0.0), size)

    def trace(self, x, y):
        """As Scene.trace(), without light: each front face drawn over the places that its box on the frame holds."""
        shape = np.shape(x)
        x, y = (np.broadcast_to(np.asarray(v, float), shape).ravel() for v in (x, y))
        order = np.argsort(y, kind="stable")
        x, y = x[order], y[order]
        near, which, face = np.zeros(x.size), np.zeros(x.size, np.int8), np.zeros(x.size, int)
        for solid in self.solids:
            px, py, pz = self.camera.project(solid.points, self.size)
            for k in np.flatnonzero(solid.facing(self.camera.homogeneous)):
                corners = solid.faces[k]
                cx, cy = px[corners], py[corners]
                some = slice(*np.searchsorted(y, (cy.min(), cy.max())))
                spot = some.start + np.flatnonzero((x[some] >= cx.min()) & (x[some] <= cx.max()))
                inside = np.ones(spot.size, bool)
                for a, b in pairwise([*range(len(corners)), 0]):  # counter-clockwise, but rows run downwards
                    inside &= (cx[b] - cx[a]) * (y[spot] - cy[a]) <= (cy[b] - cy[a]) * (x[spot] - cx[a])
                spot = spot[inside]
                # nearness, 1/depth (parallel: −depth), is a plane over the frame
                value = -pz[corners] if self.camera.height else 1 / pz[corners]
                plane = np.linalg.lstsq(np.stack([cx, cy, np.ones(len(cx))], 1), value, rcond=None)[0]
                value = plane[0] * x[spot] + plane[1] * y[spot] + plane[2]
                front = (which[spot] == 0) | (value > near[spot] + 1e-9 * np.abs(near[spot]))  # the first of equals
                spot = spot[front]
                near[spot], which[spot], face[spot] = value[front], solid.index, k
        normal, albedo, part = np.zeros((x.size, 3)), np.zeros((x.size, 3)), np.zeros(x.size, np.int8)
        for solid in self.solids:
            spot = np.flatnonzero(which == solid.index)
            normal[spot], albedo[spot], part[spot] = solid.normals[face[spot]], solid.color, solid.parts[face[spot]]
        with np.errstate(divide="ignore"):
            depth = np.where(which > 0, -near if self.camera.height else 1 / near, np.inf)
        seen = {"depth": depth, "solid": which, "part": part, "normal": normal, "albedo": albedo,
                "light": np.zeros(x.size)}
        for name, a in seen.items():
            back = np.empty_like(a)
            back[order] = a
            seen[name] = back.reshape(*shape, *a.shape[1:])
        return seen

    def _curves(self):
        return [curve for solid in self.solids for curve in solid.curves(self.camera.homogeneous)]


# Meshes


def quad(corners, **more):
    return Mesh(np.asarray(corners, float), [[0, 1, 2, 3]], **more)


def box(size, centre, turn, **more):
    x, y, z = np.asarray(size, float) / 2
    corners = np.array([(i, j, k) for i in (-x, x) for j in (-y, y) for k in (-z, z)])
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh(np.asarray(centre, float) + corners @ turn.T, faces, **more)


def sphere(radius, centre, around=128, **more):
    """Rings of quads, triangles at the poles, the axis upright."""
    rings = around // 2
    turn, tilt = np.arange(around) * 2 * np.pi / around, np.arange(1, rings) * np.pi / rings
    turn, tilt = np.meshgrid(turn, tilt)
    points = np.stack([np.sin(tilt) * np.sin(turn), np.cos(tilt), np.sin(tilt) * np.cos(turn)], -1).reshape(-1, 3)
    last = len(points)
    faces = []
    for k in range(around):
        right = (k + 1) % around
        faces += [[around * j + k, around * (j + 1) + k, around * (j + 1) + right, around * j + right]
                  for j in range(rings - 2)]
        low = around * (rings - 2)
        faces += [[last, k, right], [last + 1, low + right, low + k]]
    points = np.concatenate([points, [[0, 1, 0], [0, -1, 0]]])
    return Mesh(np.asarray(centre, float) + radius * points, faces, **more)
