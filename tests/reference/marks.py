# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lines pass between pixel centres, one crossing after the other, in float64."""

import numpy as np

from . import raster


def _corners(mesh, corner, view, projection, frame):
    """Corners of a primitive on the screen, (n, 4) as raster.on_screen() has them."""
    world = np.asarray(mesh.points, np.float32).astype(float)[corner] @ mesh.model[:3, :3].T + mesh.model[:3, 3]
    camera = world @ view[:3, :3].T + view[:3, 3]
    return raster.on_screen(np.c_[camera, np.ones(len(camera))] @ projection.T, camera, frame)


def _plane(screen, x, y):
    """Depth of a triangle's plane at a place on the screen."""
    system = np.stack([screen[:, 0] - x * screen[:, 2], screen[:, 1] - y * screen[:, 2], np.ones(3)])
    return np.linalg.solve(system, [0.0, 0.0, 1.0]) @ screen[:, 3]


def _behind(screen, x, y, z, pixel):
    """By how much more than allowed a line lies behind a triangle."""
    nearest, farthest = screen[:, 3].min(), screen[:, 3].max()
    h = 1e-4
    slope = sum(abs(_plane(screen, x + a, y + b) - _plane(screen, x - a, y - b)) / (2 * h) for a, b in ((h, 0), (0, h)))
    return z - np.clip(_plane(screen, x, y), nearest, farthest) - 0.5 * (min(slope, farthest - nearest) + pixel)


def crossings(screen):
    """(column, row, axis, share, x, y, z) of a line, pixel centres at whole numbers; axis 0: to the right."""
    at = screen[:, :2] / screen[:, 2:3] - 0.5
    for axis in (0, 1):
        across, along = 1 - axis, axis  # rows are crossed between two columns
        a, b = at[:, across]
        for line in range(int(np.floor(min(a, b))) + 1, int(np.floor(max(a, b))) + 1):
            t = (line - a) / (b - a)
            x, y = at[0] + t * (at[1] - at[0])
            z = ((screen[:, 3] / screen[:, 2]) @ (1 - t, t)) / ((1 / screen[:, 2]) @ (1 - t, t))
            place = (x, y)[along]
            cell = int(np.floor(place))
            yield (line if axis else cell), (cell if axis else line), axis, place - cell, x, y, z


def marks(lines, meshes, view, projection, frame, size, clip_start):
    """The output `marks`, and where it is not sure: lines within rounding of a centre, or of where they are hidden.

    lines: (mesh of kind lines or seams), all of whose points lie beyond clip_start.
    """
    width, height = size
    front = raster.draw(meshes, view, projection, frame, size, clip_start)["front"]
    out, unsure = np.zeros((height, width, 2)), np.zeros((height, width, 2), bool)
    scale = 2 / (abs(projection[1, 1]) * frame.height)
    for mesh in lines:
        for corner in mesh.corners:
            screen = _corners(mesh, corner, view, projection, frame)
            for column, row, axis, share, x, y, z in crossings(screen):
                p, q = (row - frame.y, column - frame.x), (row - frame.y + axis, column - frame.x + 1 - axis)
                if min(*p) < 0 or q[0] >= height or q[1] >= width:
                    continue
                pixel = scale * (z if projection[3, 2] else 1)
                behind = []
                for number, t in (front[p], front[q]):
                    own = meshes[number] if number >= 0 else None
                    corners = None if own is None else (
                        np.arange(len(own.points)).reshape(-1, 3) if own.corners is None else own.corners)[t]
                    behind.append(-np.inf if own is None else _behind(
                        _corners(own, corners, view, projection, frame), x + 0.5, y + 0.5, z, pixel))
                unsure[(*p, axis)] |= min(share, 1 - share) < 1e-6 or abs(min(behind)) < 1e-4 * z
                seam, there = mesh.kind == "seams", out[(*p, axis)]
                if min(behind) <= 0 and not (there > 0 or (seam and there < 0)):
                    out[(*p, axis)] = (-1 if seam else 1) * max(share, 1 / 1024)
    return out, unsure
