# SPDX-License-Identifier: GPL-3.0-or-later
"""Strands as whoever looks sees them: ribbons that turn to each way of sight, as Cycles'."""

from dataclasses import dataclass, replace

import numpy as np

from .job import EDGES, Mesh, edge_kinds

_ROUND = np.float32(1.5)  # how far normals lean out at a ribbon's rims: about a round strand's across most of it


@dataclass
class Ribbons:
    """Points (n, 3) in the middle of strands, the ways along these and radii (n,) there, and which points `begin` a
    piece, which the next one ends."""

    points: np.ndarray
    along: np.ndarray
    radius: np.ndarray
    begin: np.ndarray

    def turned(self, mesh: Mesh, view: np.ndarray, projection: np.ndarray) -> Mesh:
        """The mesh as it is seen through matrices, world -> camera and camera -> clip; all its triangles, of which it
        has others now, have the same numbers."""
        inverse = np.linalg.inv(view @ mesh.model)
        if projection[3, 3] == 1:  # orthographic
            ways = np.broadcast_to(-inverse[:3, 2].astype(np.float32), self.points.shape)
        else:
            ways = self.points - inverse[:3, 3].astype(np.float32)
        side = _unit(np.cross(self.along, ways))
        front = _unit(np.cross(self.along, side))
        rims = self.radius[:, None] * side
        points = np.stack([self.points - rims, self.points + rims], 1).reshape(-1, 3)
        normals = np.stack([front - _ROUND * side, front + _ROUND * side], 1).reshape(-1, 3)
        corners = self._corners()
        none = edge_kinds(np.full((1, 3), EDGES["none"])).repeat(len(corners))

        def each(values: np.ndarray | None) -> np.ndarray | None:
            return None if values is None else values[:1].repeat(len(corners), 0)

        return replace(mesh, points=points, corners=corners, normals=_unit(normals)[corners], edges=none,
                       material=each(mesh.material), style=each(mesh.style), attributes=each(mesh.attributes))

    def _corners(self) -> np.ndarray:
        """(t, 3): two triangles a piece, one where it comes to a point."""
        a = 2 * self.begin[:, None] + np.array([0, 1, 2], np.int32)
        b = 2 * self.begin[:, None] + np.array([1, 3, 2], np.int32)
        wide = self.radius > 0
        return np.concatenate([a[wide[self.begin]], b[wide[self.begin + 1]]]).astype(np.int32)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), np.float32(1e-30))
