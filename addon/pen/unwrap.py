# SPDX-License-Identifier: GPL-3.0-or-later
"""How a texture lies on a mesh: the first fundamental form of its UV map, texel by texel. Knows no Blender."""

import io
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from . import library, plain
from .errors import EncreError
from .job import Frame, Mesh

MARGIN = 8  # texels about an island that get its form: lines reach over its border
_EDGE = 1e-4  # of the texture: what lies nearer to its border than that lies on it
_LONGEST = 1e18  # of a mesh: squares of its lengths are numbers of 32 bits
_FARTHEST = 1e6  # repetitions of the texture from its origin that a UV map may lie
_MOST_DRAWN = 1 << 35  # texels, for minutes
_MOST_TILES = 64  # repetitions of the texture that one triangle draws, each way


@dataclass
class Unwrapped:
    """Triangles with a UV map: points (n, 3), corners (t, 3) of each triangle, uv (t, 3, 2), v upwards."""

    points: np.ndarray
    corners: np.ndarray
    uv: np.ndarray


def join(meshes: Sequence[Unwrapped]) -> Unwrapped:
    """All triangles of several meshes as one."""
    starts = np.cumsum([0, *(len(m.points) for m in meshes)])
    return Unwrapped(np.concatenate([m.points for m in meshes]),
                     np.concatenate([m.corners + at for m, at in zip(meshes, starts, strict=False)]),
                     np.concatenate([m.uv for m in meshes]))


def read_obj(path: str | os.PathLike) -> Unwrapped:
    """The triangles of a Wavefront OBJ file; faces are cut into fans. Raises EncreError."""
    points, coordinates, corners, uv = [], [], [], []
    try:
        with plain.opened(path) as file:
            for line in io.TextIOWrapper(file, encoding="utf-8", errors="replace"):
                kind, *words = line.split() or [""]
                if kind == "v":
                    x, y, z = words[:3]
                    points.append([float(x), float(y), float(z)])
                elif kind == "vt":
                    coordinates.append([float(x) for x in (*words, "0")[:2]])
                elif kind == "f":
                    face = [_corner(word, len(points), len(coordinates)) for word in words]
                    for k in range(1, len(face) - 1):
                        three = face[0], face[k], face[k + 1]
                        corners.append([c[0] for c in three])
                        uv.append([coordinates[c[1]] for c in three])
    except OSError as error:
        raise EncreError(f"{path}: can't be read ({error.strerror}); check the path") from None
    except (ValueError, IndexError):
        raise EncreError(f"{path}: is not an OBJ file whose faces all have texture coordinates; "
                              "export it with its UV map") from None
    if not corners:
        raise EncreError(f"{path}: holds no faces; export a mesh with faces and a UV map")
    mesh = Unwrapped(np.array(points), np.array(corners), np.array(uv))
    if not (np.isfinite(mesh.uv).all() and (np.abs(mesh.points) < _LONGEST).all()):  # Blender's own have 32 bits
        raise EncreError(f"{path}: holds numbers that are not finite or too large; export it again")
    return mesh


def _corner(word, n_points, n_coordinates):
    """Indices of point and texture coordinate; negative ones count from the last. ValueError: there is none."""
    found = []
    for text, n in zip(word.split("/")[:2], (n_points, n_coordinates), strict=True):
        index = int(text)
        index = index - 1 if index > 0 else n + index
        if not 0 <= index < n:
            raise ValueError(word)
        found.append(index)
    return found


def tiles(mesh: Unwrapped) -> tuple[bool, ...]:
    """(sideways, upwards): whether the mesh goes on over the texture's border, beyond it or across a seam."""
    out = []
    for axis in (0, 1):
        u = mesh.uv[..., axis]
        beyond = u.min() < -_EDGE or u.max() > 1 + _EDGE
        low, high = (_edges_at(mesh, np.abs(u - border) < _EDGE) for border in (0, 1))
        out.append(bool(beyond or low & high))
    return tuple(out)


def _edges_at(mesh, there):
    """Pairs of points between which an edge runs whose ends are both `there` (t, 3)."""
    pairs = np.concatenate([np.sort(mesh.corners[there[:, k] & there[:, k - 1]][:, [k, k - 1]]) for k in range(3)])
    return {(a, b) for a, b in pairs.tolist() if a != b}


def form(mesh: Unwrapped, width: int, height: int, progress: Callable[[float], bool] | None = None) -> np.ndarray:
    """E, F, G (height, width, 3) of a texture on the mesh, row 0 at the top, in texels of mean size; 1, 0, 1 where the
    mesh has none. Raises EncreError where the UV map has no area, or lengths that can't be reckoned with."""
    if np.abs(mesh.uv).max(initial=0) > _FARTHEST:
        raise EncreError(f"the UV map reaches beyond {_FARTHEST:.0f} times the texture; unwrap the mesh again")
    size = np.array([width, -height])
    texels = mesh.uv * size  # y down
    across = (texels[:, 1:] - texels[:, :1]).transpose(0, 2, 1)  # columns: two sides, in texels
    sides = (mesh.points[mesh.corners[:, 1:]] - mesh.points[mesh.corners[:, :1]]).transpose(0, 2, 1)
    area = np.abs(np.linalg.det(across)) / 2
    good = area > 1e-12
    surface = np.linalg.norm(np.cross(sides[..., 0], sides[..., 1]), axis=1) / 2
    mean = surface[good].sum() / area[good].sum() if good.any() else 0
    if not mean > 0:
        raise EncreError("the mesh has no area in its UV map or none in space; unwrap it first")
    step = sides[good] @ np.linalg.inv(across[good])  # of the surface, per texel
    square = step.transpose(0, 2, 1) @ step / mean
    stretch = _root(square[:, 0, 0], square[:, 0, 1], square[:, 1, 1])
    corner = _smooth(mesh.corners[good], mesh.uv[good], stretch, area[good])
    drawn, there = _draw(texels[good] + (0, height), corner, width, height, progress)
    _spread(drawn, there)
    drawn[~there] = 1, 0, 1
    for rows in np.split(drawn, range(64, height, 64)):  # few at a time stay in the cache
        a, b, c = np.moveaxis(rows, 2, 0)
        rows[:] = np.stack([a * a + b * b, b * (a + c), b * b + c * c], 2)
    return drawn


def _root(e, f, g):
    """Square root of the forms, as matrices. It is a length and not its square that changes evenly over a triangle."""
    root = np.sqrt(np.maximum(e * g - f * f, 0))
    return np.stack([e + root, f, g + root], 1) / np.sqrt(np.maximum(e + g + 2 * root, 1e-30))[:, None]


def _smooth(corners, uv, stretch, area):
    """Each corner's mean stretch over the triangles that meet there in space and in the texture, (t, 3, 3)."""
    key = np.concatenate([corners.reshape(-1, 1), np.round(uv.reshape(-1, 2) / _EDGE).astype(np.int64)], 1)
    _, at = np.unique(key, axis=0, return_inverse=True)
    at = at.reshape(-1)
    weight = np.repeat(area, 3)
    total = np.bincount(at, weight)
    mean = [np.bincount(at, weight * np.repeat(stretch[:, k], 3)) / total for k in range(3)]
    return np.stack(mean, 1)[at].reshape(-1, 3, 3)


def _draw(texels, corner, width, height, progress):
    """The stretch over the texture and where there is any; what lies beyond its border is drawn where it repeats."""
    size = np.array([width, height])
    first = np.floor(texels.min(1) / size + _EDGE).astype(int)
    last = np.maximum(np.ceil(texels.max(1) / size - _EDGE).astype(int) - 1, first)
    last = np.minimum(last, first + _MOST_TILES - 1)
    pieces, values, drawn = [], [], 0.0
    for shift in _shifts(first, last):
        inside = np.flatnonzero(((first <= shift) & (shift <= last)).all(1))
        # The first that covers all hides what comes after it, which would be drawn in vain.
        all_of_it = _covers(texels[inside] - shift * size, width, height)
        covered = all_of_it.any()
        inside = inside[:all_of_it.argmax() + 1] if covered else inside
        piece = texels[inside] - shift * size
        drawn += np.prod(np.ptp(np.clip(piece, 0, size), axis=1), axis=1).sum()
        if drawn > _MOST_DRAWN:
            raise EncreError(f"the UV map lays triangles more than {drawn / (width * height):.0f} times over the whole "
                             "texture; unwrap the mesh again, or give a smaller texture")
        pieces.append(piece)
        values.append(corner[inside])
        if covered:
            break
    points = np.concatenate(pieces).reshape(-1, 2)
    mesh = Mesh(np.concatenate([points, np.full((len(points), 1), -1.0)], 1),
                     attributes=np.concatenate(values), object_index=1)
    flat = np.array([[2 / width, 0, 0, -1], [0, -2 / height, 0, 1], [0, 0, -1, 0], [0, 0, 0, 1]])
    images = library.raster([mesh], np.eye(4), flat, Frame(width, height), (width, height), 0.1, channels=3,
                         outputs=("object", "attributes"), progress=progress)
    return images["attributes"], images["object"] > 0


def _covers(triangles, width, height):
    """Which triangles (n, 3, 2) hold the centres of all texels."""
    corners = np.array([(0, 0), (width, 0), (0, height), (width, height)])
    side = np.roll(triangles, -1, 1) - triangles
    to = corners[:, None, None] - triangles  # (4, n, 3, 2)
    turn = side[..., 0] * to[..., 1] - side[..., 1] * to[..., 0]
    return ((turn >= 0).all((0, 2)) | (turn <= 0).all((0, 2))) & (turn != 0).any((0, 2))


def _shifts(first, last):
    """Every tile of the UV plane that some triangle may touch."""
    found: set[tuple[int, int]] = set()
    for (x0, y0), (x1, y1) in np.unique(np.concatenate([first, last], 1), axis=0).reshape(-1, 2, 2).tolist():
        found.update((x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1))
    return [np.array(shift) for shift in sorted(found)]


def _spread(values, there):
    """Grows the islands by MARGIN texels, each new one the mean of its neighbours; in place."""
    height, width = there.shape
    for _ in range(MARGIN):
        beside = np.zeros_like(there)
        beside[1:] |= there[:-1]
        beside[:-1] |= there[1:]
        beside[:, 1:] |= there[:, :-1]
        beside[:, :-1] |= there[:, 1:]
        y, x = np.nonzero(beside & ~there)
        total, count = np.zeros((len(y), 3)), np.zeros((len(y), 1))
        for dy, dx in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            near_y, near_x = np.clip(y + dy, 0, height - 1), np.clip(x + dx, 0, width - 1)
            known = there[near_y, near_x][:, None]
            total += np.where(known, values[near_y, near_x], 0)
            count += known
        values[y, x] = total / count
        there[y, x] = True


def is_obj(name: str) -> bool:
    return os.path.splitext(name)[1].lower() == ".obj"
