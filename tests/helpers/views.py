# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras and meshes by chance, for tests of the rasteriser."""

import numpy as np
from encre.pen.job import Mesh


def joined(*meshes):
    """One mesh of all their pieces."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    return Mesh(np.concatenate([mesh.points for mesh in meshes]),
                np.concatenate([mesh.corners + start for mesh, start in zip(meshes, starts, strict=False)]))


def pixels(width, height):
    """An orthographic camera under which points are (column, row, -depth) in pixels of the frame."""
    projection = np.diag([2 / width, -2 / height, -1e-3, 1.0])
    projection[0, 3], projection[1, 3] = -1, 1
    return np.eye(4), projection


def perspective(width, height, lens=1.2, shift=(0.0, 0.0), start=0.1, end=100.0):
    return np.array([[lens, 0, shift[0], 0], [0, lens * width / height, shift[1], 0],
                     [0, 0, -(end + start) / (end - start), -2 * end * start / (end - start)], [0, 0, -1, 0]])


def orthographic(width, height, scale=0.3):
    return np.diag([scale, scale * width / height, -0.01, 1.0])


def rotation(rng):
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def looking(rng, place=(0, 0, 6.0)):
    """World -> camera for a camera near `place`, turned a little about its own axis."""
    view = np.eye(4)
    a = rng.uniform(-0.5, 0.5)
    view[:2, :2] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
    view[:3, 3] = view[:3, :3] @ -(np.array(place) + rng.uniform(-0.2, 0.2, 3))
    return view


def soup(rng, n, size=1.0, spread=2.5, channels=3, **more):
    """A mesh of n unconnected triangles."""
    points = rng.uniform(-spread, spread, (n, 1, 3)) + rng.uniform(-size, size, (n, 3, 3))
    model = np.eye(4)
    model[:3, :3] = rotation(rng) * rng.uniform(0.5, 1.5, 3)
    return Mesh(points.reshape(-1, 3).astype(np.float32), None, rng.uniform(-1, 1, (n, 3, channels)).astype(np.float32),
                model=model, **more)


def crumpled(rng, n=9, **numbers):
    """A ball whose points are out of place, with a hole, a face on its edge and one without area."""
    around, up = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.linspace(0.3, np.pi, n // 2))
    points = np.stack([np.cos(around) * np.sin(up), np.cos(up), np.sin(around) * np.sin(up)], -1).reshape(-1, 3)
    a = np.arange(len(points) - n)
    b = a // n * n + (a + 1) % n
    corners = np.concatenate([np.c_[a, b, b + n], np.c_[b + n, a + n, a], [[0, 1, len(points) - 1], [3, 3, n]]])
    flip = rng.random(len(corners)) < 0.3  # no sense in which they go round is needed
    corners[flip] = corners[flip][:, ::-1]
    points = points * rng.uniform(0.7, 1.8, (len(points), 1)) + rng.uniform(-1, 1, 3)
    return Mesh(points.astype(np.float32), corners.astype(np.int32),
                **{name: rng.integers(1, count, len(corners)) for name, count in numbers.items()})


def crowded(rng):
    """Meshes of triangles by chance before a large one that passes below the camera."""
    return [soup(rng, 150, 0.7, object_index=1, material=np.arange(150)), soup(rng, 900, 0.1, object_index=2),
            Mesh(np.array([[-50, -2, 9], [50, -2, 9], [0, -2, -200]], np.float32), object_index=3)]


def same(a, b):
    """The same pixels in all pictures of two rasters."""
    assert a.keys() == b.keys()
    for name in a:
        assert a[name].tobytes() == np.ascontiguousarray(b[name]).tobytes(), name


def jittered(rng, nx, ny, width, height, jitter, grid=None):
    """Points and triangles of a sheet over a frame of width x height and a margin around it."""
    x, y = np.meshgrid(np.linspace(-0.3, 1.3, nx + 1) * width, np.linspace(-0.3, 1.3, ny + 1) * height)
    x = x + rng.uniform(-jitter, jitter, x.shape) * width / nx
    y = y + rng.uniform(-jitter, jitter, y.shape) * height / ny
    points = np.stack([x, y, np.full_like(x, -2)], -1).reshape(-1, 3)
    if grid:
        points[:, :2] = np.floor(points[:, :2] * grid) / grid
    a = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    b, c, d = a + 1, a + nx + 2, a + nx + 1
    flip = (rng.random(len(a)) < 0.5)[:, None, None]
    one, other = np.array([[a, b, c], [a, c, d]]), np.array([[a, b, d], [b, c, d]])
    triangles = np.where(flip, one.transpose(2, 0, 1), other.transpose(2, 0, 1)).reshape(-1, 3)
    turned = rng.random(len(triangles)) < 0.5
    triangles[turned] = triangles[turned][:, ::-1]
    return points.astype(np.float32), triangles.astype(np.int32)
