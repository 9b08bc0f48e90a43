# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of triangles cover each pixel once: no holes between neighbours, and none that both have."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.library import Frame, Mesh
from views import jittered, perspective, pixels


def times_covered(points, triangles, view, projection, width, height, start=0.1):
    """How many of the triangles cover each pixel: each is drawn alone."""
    count = np.zeros((height, width), int)
    for t in triangles:
        mesh = Mesh(points, t[None], object_index=1)
        count += library.raster([mesh], view, projection, Frame(width, height), (width, height), start,
                             outputs=("object",), threads=1)["object"] == 1
    return count


@pytest.mark.parametrize("seed, grid", [(0, None), (1, 1), (2, 2), (3, 64)])
def test_a_sheet_covers_each_pixel_once(seed, grid):
    rng = np.random.default_rng(seed)
    points, triangles = jittered(rng, 7, 6, 41, 33, 0.3, grid)
    points[:, :2] += 0.5 if grid else 0
    np.testing.assert_array_equal(times_covered(points, triangles, *pixels(41, 33), 41, 33), 1)


def test_a_fan_of_slivers_covers_each_pixel_once():
    angles = np.linspace(0, 2 * np.pi, 182)[:-1]
    points = np.r_[[[20.5, 16.5, -2]], np.c_[20.5 + 99 * np.cos(angles), 16.5 + 99 * np.sin(angles), 0 * angles - 2]]
    triangles = np.stack([0 * angles, np.arange(181) + 1, np.roll(np.arange(181) + 1, -1)], 1).astype(np.int32)
    np.testing.assert_array_equal(times_covered(points.astype(np.float32), triangles, *pixels(41, 33), 41, 33), 1)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("reach", [20.0, 1e4, 1e7])
def test_a_floor_through_the_camera_covers_each_pixel_below_the_horizon_once(seed, reach):
    """Clipped at clip_start and at the guard: cut edges of neighbours coincide."""
    rng = np.random.default_rng(seed)
    points, triangles = jittered(rng, 6, 6, 1, 1, 0.3)
    floor = np.c_[(points[:, 0] - 0.5) * reach, np.full(len(points), -1.0), (points[:, 1] - 0.45) * reach]
    angle = 0.3
    view = np.eye(4)
    view[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    count = times_covered(floor.astype(np.float32), triangles, view, perspective(48, 36), 48, 36)
    assert count.max() == 1
    y = np.nonzero(count.all(1))[0]
    assert len(y) > 8 and y[-1] == 35 and (np.diff(y) == 1).all()  # down to the frame's end without a hole
