# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps of every kind, and things on a plane for them to shine on."""

import functools

import numpy as np
from encre.pen import library
from encre.pen.job import EVERY_SET, Frame, Lamp, Mesh
from encre.pen.scene import Scene
from reference import light as reference

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE_CORNERS = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))], np.int32)
PLANE = np.array([[-30, -30, 0], [30, -30, 0], [30, 30, 0], [-30, 30, 0]], np.float32)
PLANE_CORNERS = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def look(eye, at, scale=(1, 1, 1)):
    """The matrix of something that stands at `eye` and looks along its -z."""
    eye = np.array(eye, float)
    z = reference.unit(eye - at)
    x = reference.unit(np.cross((0, 0, 1), z))
    model = np.eye(4)
    model[:3, :3] = np.stack([x, np.cross(z, x), z], 1) * scale
    model[:3, 3] = eye
    return model


def moved(x, y, z, size=1.0):
    model = np.diag([size, size, size, 1.0])
    model[:3, 3] = x, y, z
    return model


def perspective(width, height, near=0.1, far=200.0, lens=2.6):
    return np.array([[lens, 0, 0, 0], [0, lens * width / height, 0, 0],
                     [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)], [0, 0, -1, 0]])


def ball(n=5):
    """(points, corners, normals) of a unit ball of facets that is shaded smoothly."""
    turn, rise = np.meshgrid(np.arange(2 * n) * np.pi / n, np.arange(n + 1) * np.pi / n)
    points = np.stack([np.sin(rise) * np.cos(turn), np.sin(rise) * np.sin(turn), np.cos(rise)], -1).reshape(-1, 3)
    k = np.arange(2 * n)
    corners = []
    for row in range(n):
        a, b = row * 2 * n + k, row * 2 * n + (k + 1) % (2 * n)
        corners += [np.stack([a, a + 2 * n, b + 2 * n], 1), np.stack([a, b + 2 * n, b], 1)]
    corners = np.concatenate(corners).astype(np.int32)
    area = np.linalg.norm(np.cross(points[corners[:, 1]] - points[corners[:, 0]],
                                   points[corners[:, 2]] - points[corners[:, 0]]), axis=1)
    corners = corners[area > 1e-9]
    return points.astype(np.float32), corners, points[corners].astype(np.float32)


class Stage:
    """Things on a plane, as the library has them, as the reference has them, and seen by a camera."""

    def __init__(self, width, height, eye=(6, -8, 5), smooth=False, at=(0.2, 0, 0.6)):
        self.width, self.height = width, height
        self.view, self.projection = np.linalg.inv(look(eye, at)), perspective(width, height)
        self.world, self.meshes, self.sets, self.holes, self._given = reference.World(), [], {}, {}, []
        self.add(PLANE, PLANE_CORNERS, np.eye(4))
        self.add(CUBE, CUBE_CORNERS, moved(0, 0, 1.001))
        if smooth:
            points, corners, normals = ball()
            self.add(points, corners, moved(2.6, -0.6, 0.8, 0.8), normals)

    def add(self, points, corners, model, normals=None, seen=True):
        key = len(self.meshes)
        self.world.add(points, corners, model, normals, seen)
        self.meshes.append(Mesh(points, corners, model=model, object_index=key + 1))
        self._given.append((key, points, corners, normals, model, seen))
        if "scene" in self.__dict__:
            self._give(self.scene)

    @functools.cached_property
    def scene(self):
        """Things as the library has them, from the first look on."""
        scene = Scene()
        self._give(scene)
        return scene

    def _give(self, scene):
        for key, points, corners, normals, model, seen in self._given:
            uvs, textures, picture = self.holes.get(key, (None, None, None))
            if picture:
                scene.texture(*picture)
            scene.geometry(key, points, corners, normals, uvs, textures)
            scene.instance(key, key, model, seen, *(k & EVERY_SET for k in self.sets.get(key, (~0, ~0))))
        self._given = []

    def depth(self, frame=None, size=None):
        size = size or (self.width, self.height)
        return library.raster(self.meshes, self.view, self.projection, frame or Frame(self.width, self.height), size,
                              0.1, outputs=("depth",))["depth"]

    def objects(self):
        """Number of what each pixel shows: 1 is the plane, 2 the cube."""
        size = self.width, self.height
        return library.raster(self.meshes, self.view, self.projection, Frame(*size), size, 0.1,
                              outputs=("object",))["object"]

    def light(self, *lamps, depth=None, frame=None, normal=None, **options):
        for k, lamp in enumerate(lamps):
            self.scene.lamp(k, lamp)
        depth = self.depth(frame) if depth is None else depth
        return self.scene.light(depth, normal, self.view, self.projection, frame or Frame(self.width, self.height),
                                0.1, **options)


def ways(x=3.0, y=1.2, z=5.0, **scale):
    return look((x, y, z), (0, 0, 0.3), **scale)


LAMPS = {
    "sun": Lamp("sun", model=ways()),
    "wide sun": Lamp("sun", width=0.3, model=ways()),
    "point": Lamp("point", model=ways()),
    "ball": Lamp("point", width=0.7, model=ways()),
    "disc": Lamp("point", width=0.7, flat=True, model=ways()),
    "spot": Lamp("spot", spot_angle=0.7, spot_blend=0.4, model=ways()),
    "soft spot": Lamp("spot", width=0.4, spot_angle=0.8, spot_blend=0.2, model=ways()),
    "scaled spot": Lamp("spot", width=0.2, spot_angle=0.8, spot_blend=0.5, model=ways(scale=(1.5, 0.6, 1.2))),
    "rectangle": Lamp("rectangle", width=1.0, height=2.0, model=ways()),
    "ellipse": Lamp("ellipse", width=1.5, height=0.8, model=ways(scale=(1.0, 1.6, 1.0))),
    "grid": Lamp("rectangle", width=1.0, height=1.0, spread=1.2, model=ways()),
}
