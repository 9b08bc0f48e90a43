# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of facets as of one smooth surface."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.errors import EncreError


def column(sides, split):
    """(points, corners) of an upright column of two triangles a side; split: each has points of its own."""
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(turn), np.sin(turn)], 1)
    points = np.concatenate([np.insert(ring, 2, height, 1) for height in (0, 1)]).astype(np.float32)
    k, after = np.arange(sides), (np.arange(sides) + 1) % sides
    corners = np.stack([k, after, after + sides, k, after + sides, k + sides], 1).reshape(-1, 3).astype(np.int32)
    return (points[corners].reshape(-1, 3), np.arange(corners.size, dtype=np.int32).reshape(-1, 3)) if split \
        else (points, corners)


def flat(points, corners):
    across = np.cross(*(points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2)))
    return np.repeat((across / np.linalg.norm(across, axis=1, keepdims=True))[:, None], 3, 1)


def smooth(points, corners, angle, normals=None):
    return library.load().smooth(points, corners, normals, angle)


@pytest.mark.parametrize("split", [False, True])
def test_a_column_of_twelve_sides_is_round_from_thirty_degrees_on(split):
    points, corners = column(12, split)
    np.testing.assert_allclose(smooth(points, corners, 31), points[corners] * (1, 1, 0), atol=1e-6)
    np.testing.assert_allclose(smooth(points, corners, 29), flat(points, corners), atol=1e-6)


def test_what_is_shaded_flat_by_its_normals_is_a_facet_and_what_is_turned_is_not():
    points, corners = column(12, True)
    once = smooth(points, corners, 31)
    np.testing.assert_array_equal(smooth(points, corners, 31, flat(points, corners)), once)
    np.testing.assert_array_equal(smooth(points, corners, 31, once), once)
    up = np.broadcast_to(np.float32([0, 0, 1]), once.shape)  # leaves are lit so
    np.testing.assert_array_equal(smooth(points, corners, 31, up), up)
    bent = flat(points, corners) + (0, 0, 0.1)  # by bones, since they were told
    np.testing.assert_allclose(smooth(points, corners, 31, bent / np.linalg.norm(bent, axis=2, keepdims=True)), once,
                               atol=1e-6)


def test_a_board_stays_a_plane_beside_its_bevel():
    square = np.float32([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    points = np.concatenate([np.insert(square, 2, 0, 1), np.insert(1.05 * square, 2, -0.02, 1)])  # 22 degrees
    corners = np.int32([(0, 1, 2), (0, 2, 3), *((k, k + 4, (k + 1) % 4 + 4) for k in range(4)),
                        *((k, (k + 1) % 4 + 4, (k + 1) % 4) for k in range(4))])
    told = smooth(points, corners, 35)
    np.testing.assert_allclose(told[:2], np.broadcast_to([0, 0, 1], (2, 3, 3)), atol=0.02)
    assert (told[2:6, 1, 2] < 0.97).all(), "and its bevel turns to the side"


def test_edges_of_three_faces_and_faces_that_look_apart_stay():
    points = np.float32([(0, 0, 0), (0, 1, 0), (1, 0, 0.1), (-1, 0, 0.1), (-1, 0, -0.1)])
    fan = np.int32([(0, 2, 1), (0, 1, 3), (0, 1, 4)])
    np.testing.assert_allclose(smooth(points, fan, 90), flat(points, fan), atol=1e-6)
    against = np.int32([(0, 1, 2), (0, 1, 3)])
    np.testing.assert_allclose(smooth(points, against, 180), flat(points, against), atol=1e-6)


def test_triangles_without_an_area_have_normals_too():
    points = np.float32([(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    np.testing.assert_array_equal(smooth(points, np.int32([(0, 1, 2)]), 30), [[(0, 0, 1)] * 3])
    assert smooth(points, np.zeros((0, 3), np.int32), 30).shape == (0, 3, 3)


def test_what_is_wrong_is_refused():
    points, corners = column(4, False)
    for angle in -1, 181, np.nan:
        with pytest.raises(EncreError, match="angle: .*give radians from 0 to pi"):
            smooth(points, corners, angle)
    with pytest.raises(EncreError, match="corner at point 8 of 8"):
        smooth(points, corners + 1, 30)
