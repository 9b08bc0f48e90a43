# SPDX-License-Identifier: GPL-3.0-or-later
"""Where U grows along a surface, as normal maps are made for: after Mikkelsen, Simulation of Wrinkled Surfaces
Revisited (2008), whose code (MikkTSpace) renderers and bakers share."""

import numpy as np


def tangents(points: np.ndarray, normals: np.ndarray, uv: np.ndarray, vertex: np.ndarray) -> tuple:
    """(unit tangents (t, 3, 3), whether the UV map is mirrored (t,)) of triangles; points, normals (t, 3, 3), uv
    (t, 3, 2) at their corners, vertex (t, 3): equal where they are joined. 0 where the map has no size."""
    d1, d2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    (s1, t1), (s2, t2) = (uv[:, k].T - uv[:, 0].T for k in (1, 2))
    area = s1 * t2 - s2 * t1
    along = _unit((d1 * t2[:, None] - d2 * t1[:, None]) * np.sign(area)[:, None])
    each = _unit(_flat(along[:, None], normals)) * _angles(points, normals)[..., None]
    group = _groups(vertex, normals, uv, area < 0)
    sums = np.stack([np.bincount(group, each[..., c].ravel()) for c in range(3)], 1)
    return _unit(sums)[group].reshape(points.shape).astype(np.float32), area < 0


def _groups(vertex, normals, uv, mirrored):
    """(3 t,): equal for corners that share a tangent: of one vertex, one normal, one place in the map, on one side."""
    told = np.empty((*vertex.shape, 7), np.int64)
    told[..., 0], told[..., 6] = vertex, mirrored[:, None]
    for k, values in ((1, normals), (4, uv)):
        told[..., k:k + values.shape[2]] = (values.astype(np.float32) + np.float32(0)).view(np.int32)
    odd = np.random.default_rng(0).integers(1, 2 ** 62, 7) * 2 + 1
    return np.unique((told.reshape(-1, 7) * odd).sum(1), return_inverse=True)[1]


def _angles(points, normals):
    """(t, 3) at the corners, seen along their normals."""
    ways = [_unit(_flat(np.roll(points, -k, 1) - points, normals)) for k in (1, 2)]
    return np.arccos(np.clip(np.einsum("tkc,tkc->tk", *ways), -1, 1))


def _flat(ways, normals):
    return ways - normals * np.einsum("tkc,tkc->tk", *np.broadcast_arrays(ways, normals))[..., None]


def _unit(ways):
    return ways / np.maximum(np.linalg.norm(ways, axis=-1, keepdims=True), 1e-30)
