# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of round forms with few faces: curves within `line_smooth` px of their edges; all else stays."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import EDGES, Frame, Mesh, edge_kinds
from known import END, KIND, drawn, flat, line
from views import perspective

SIDES, MIDDLE = 12, 48.0
SIZE = 96, 96


def ring(sides=SIDES, radius=36.0, kind="contour round", **more):
    turns = 2 * np.pi * np.arange(sides + 1) / sides
    made = line(MIDDLE + radius * np.stack([np.cos(turns), np.sin(turns)], 1), kind, side=1, behind=0, **more)
    made["end"][[0, -1]] = END["loop"]
    return made


def radii(ink):
    """How far from the middle the ink lies in each of 120 directions."""
    y, x = np.mgrid[:SIZE[0], :SIZE[1]] - MIDDLE
    sector = np.floor((np.arctan2(y, x) + np.pi) / (2 * np.pi) * 120).astype(int) % 120
    total, far = (np.bincount(sector.ravel(), (ink * w).ravel(), 120) for w in (1, np.hypot(x, y)))
    return far / total


def of(lines, smooth, **more):
    layers = flat(SIZE)
    return drawn(layers, lines, line_smooth=smooth, **more)


def test_a_polygon_becomes_a_circle():
    sagitta = 36 * (1 - np.cos(np.pi / SIDES))
    edges, curve = (radii(of(ring(), smooth)) for smooth in (0.0, 2.0))
    assert np.ptp(edges) > 0.7 * sagitta
    assert np.ptp(curve) < 0.35 * sagitta, "of which a circle has half, by pixels"


@pytest.mark.parametrize("most", [0.2, 0.4])
def test_it_leaves_the_edges_by_no_more_than_asked(most):
    edges, curve = (radii(of(ring(), smooth)) for smooth in (0.0, most))
    off = np.abs(curve - edges)
    assert 0.6 * most < off.max() < most + 0.1


@pytest.mark.parametrize("lines", [ring(kind="contour"), ring(4), line([(20, 20), (60, 60)], "contour round", side=1)])
def test_what_is_flat_has_corners_or_is_straight_stays(lines):
    was, now = of(lines, 0.0), of(lines, 4.0)
    np.testing.assert_allclose(now, was, atol=0.02)
    assert was.any()


def test_a_line_that_ends_at_a_moved_one_follows_it():
    """A crease that ends in a corner which the curve cuts off reaches the curve and no farther."""
    crease = line([(MIDDLE, MIDDLE), (MIDDLE + 36, MIDDLE)], "crease", run=1)
    t = of([ring(6), crease], 4.0, line_thickest=1.0, line_thickness=1.0)
    row = t[int(MIDDLE)]
    last = np.flatnonzero(row > 0.3)[-1]
    assert row[50:last + 1].all() and MIDDLE + 30 < last < MIDDLE + 35


def test_any_number_of_threads_draws_the_same():
    one, three = (of([ring(), ring(8, 20.0, run=1)], 2.0, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one, three)


def test_a_rim_is_round_where_the_side_is_shaded_smoothly():
    """A cylinder's caps are flat and their rims sharp edges; those of a prism that is flat all over stay."""
    k, n = np.arange(8), 8
    turns = 2 * np.pi * k / n
    points = np.concatenate([np.stack([np.cos(turns), np.full(n, y), np.sin(turns)], 1) for y in (-1, 1)])
    side = np.concatenate([np.c_[k, n + k, n + (k + 1) % n], np.c_[k, n + (k + 1) % n, (k + 1) % n]])
    caps = np.array([(n, n + i + 1, n + i) for i in range(1, n - 1)] + [(0, i, i + 1) for i in range(1, n - 1)])
    for smooth in (False, True):
        kinds = np.zeros((len(side) + len(caps), 3), np.uint8)
        if smooth:  # what lies in the side; its edges along the rims are sharp
            kinds[:n, 0] = kinds[n:2 * n, 1] = EDGES["smooth"]
            kinds[:n, 2] = kinds[n:2 * n, 0] = EDGES["none"]
        mesh = Mesh(points.astype(np.float32), np.concatenate([side, caps]).astype(np.int32), object_index=1,
                    edges=edge_kinds(kinds))
        view = np.eye(4)
        view[:3, :3] = [(1, 0, 0), (0, 0.8, 0.6), (0, -0.6, 0.8)]
        view[2, 3] = -6
        found = library.chains([mesh], view, perspective(96, 96, 1.6), Frame(96, 96), (96, 96), 0.1)
        rim = found[(found["kind"] & KIND["smooth"] == 0) & (found["bend"] > 80)]
        assert len(rim) > 8 and ((rim["kind"] & KIND["round"] > 0) == smooth).all()


@pytest.mark.parametrize("smooth", [2.0, 4.0])
def test_rectangles_stay_wherever_knots_lie(smooth):
    rng = np.random.default_rng(1)
    for _ in range(25):
        turn, half = rng.uniform(0, np.pi), rng.uniform(14, 30, 2)
        x, y = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]).T * half[:, None]
        place = np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], 1)
        made = line(MIDDLE + rng.uniform(-1, 1, 2) + place, "border round", side=1, behind=0)
        made["end"][[0, -1]] = END["loop"]
        np.testing.assert_allclose(of(made, smooth), of(made, 0.0), atol=0.12)


def test_a_curve_changes_little_as_it_grows_by_less_than_a_knot():
    """A post with a foot and a head, of few sides."""
    left = [(20, 88), (20, 82), (22.5, 79), (25, 20), (24, 15), (26, 8), (24, 2)]
    profile = [*left, (36, 0), *((72 - x, y) for x, y in left[::-1])]
    places = []
    for k in range(12):
        t = of(line((1 + 0.0015 * k) * np.array(profile) + (12, 4), "contour round", side=1, behind=0), 2.0)
        left, right = t[20:80, :48], t[20:80, 48:]
        places.append([(half * np.arange(48)).sum(1) / half.sum(1) for half in (left, right)])
    assert np.abs(np.diff(places, axis=0)).max() < 0.35
