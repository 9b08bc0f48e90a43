# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines drawn by hand."""

import chained
import numpy as np
import pytest
from encre.pen import library
from encre.pen.library import Frame, Mesh
from judge import verdict
from views import pixels

PEN = dict(verdict.PARAMS, edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_thickness=1.0)


def wall(height=60, width=80, ends=((9.3, 11.7), (70.2, 41.4))):
    """Layers of a bare wall with lines on it, ends (x, y) two by two in pixels, centres at whole numbers."""
    points = np.c_[np.array(ends) + 0.5, np.full(len(ends), -4.0)].astype(np.float32)
    mesh = Mesh(points, np.arange(len(ends), dtype=np.int32).reshape(-1, 2), kind="lines")
    flat = np.ones((height, width, 1), np.float32)
    told = chained.lines([mesh], *pixels(width, height), Frame(width, height), (width, height))
    return dict(combined=flat.repeat(4, 2), color=flat.repeat(3, 2) / 2, diffuse=flat.repeat(3, 2), depth=4 * flat,
                normal=flat * np.float32([0, 0, 1]), object=0 * flat, chains=told)


def ink(layers, styles=(), **scene):
    made = library.render(layers, {**PEN, **scene}, styles, outputs=("Encre Lines", "Encre Edges")).images
    return made["Encre Lines"][..., 3].astype(float)


def off_the_line(t, a, b):
    """How far the ink's centre lies beside the line from a to b, by steps of a pixel along it, without the ends; and
    the amounts of ink."""
    way = np.subtract(b, a) / np.hypot(*np.subtract(b, a))
    y, x = np.nonzero(t)
    along, beside = (x - a[0]) * way[0] + (y - a[1]) * way[1], (y - a[1]) * way[0] - (x - a[0]) * way[1]
    step = np.floor(along).astype(int)
    inside = (step > 3) & (step < np.hypot(*np.subtract(b, a)) - 4)
    ink = np.bincount(step[inside], t[y, x][inside])[4:]
    return np.bincount(step[inside], (t[y, x] * beside)[inside])[4:] / ink, ink


@pytest.mark.parametrize("b", [(70.2, 41.4), (70.2, 11.7), (21.3, 55.1), (69.3, 12.9)])
def test_a_mark_is_drawn_where_it_lies_and_as_wide_as_asked(b):
    a = (9.3, 11.7)
    layers = wall(ends=(a, b))
    for thickness in (1.0, 3.0):
        off, amount = off_the_line(ink(layers, line_thickness=thickness), a, b)
        nine = np.ones(9) / 9  # a step alone sees how pixels meet the line
        assert np.abs(np.convolve(off, nine, "valid")).max() < 0.08
        assert np.mean(amount) == pytest.approx(thickness, rel=0.03)
        assert np.convolve(amount, nine, "valid").min() > 0.9 * thickness


def test_weight_width_and_style():
    layers = wall()
    full = ink(layers)
    assert ink(layers, line_mark_strength=0.0).max() == 0
    assert ink(layers, line_mark_strength=0.2).max() == 0 and PEN["edge_threshold"] > 0.2
    assert ink(layers, line_mark_width=2.0).sum() == pytest.approx(2 * full.sum(), rel=0.05)
    layers["style"] = np.zeros((60, 80, 1), np.float32)
    layers["style"][:, 40:] = 1
    half = ink(layers, ({"line_mark_strength": 0.0},))
    assert np.array_equal(half[:, :37], full[:, :37]) and not half[:, 43:].any()
    assert 0.5 < ink(layers, ({"line_mark_width": 3.0},))[:, 43:].sum() / full[:, 43:].sum() / 3 < 1.5


def test_lines_that_cross_or_meet_hang_together():
    across = ((10.2, 12.1), (68.8, 44.9), (12.3, 45.2), (66.1, 9.8))
    t = ink(wall(ends=across), line_thickness=2.0)
    one, two = (ink(wall(ends=ends), line_thickness=2.0) for ends in (across[:2], across[2:]))
    assert np.abs(t - np.maximum(one, two)).max() < 0.35  # they are joined by what lies between their crossings
    corner = ((10.2, 40.1), (40.6, 12.3), (40.6, 12.3), (69.4, 38.2))
    t = ink(wall(ends=corner), line_thickness=2.0)
    assert t[11:14, 39:43].max() == 1 and t[:10].max() == 0
    assert np.abs(off_the_line(t[:, :39], *corner[:2])[0]).max() < 0.3


@pytest.mark.parametrize("rise", [0.0, 0.05, 0.31, 0.6, -0.4])
@pytest.mark.parametrize("down", [False, True])
def test_of_two_marks_side_by_side_one_gives_way(rise, down):
    """The left, or upper, one is drawn whole, and no rungs lie between both."""
    def drawn(*gaps):
        ends = [(x, 30.3 + rise * (x - 40) + gap * np.hypot(1, rise)) for gap in gaps for x in (4.2, 75.4)]
        return ink(wall(80, 80, ends=[end[::-1] for end in ends] if down else ends), line_thickness=3.0)[10:70, 10:70]
    alone = drawn(0)
    assert drawn(0, 4.5).sum() == pytest.approx(2 * alone.sum(), rel=0.03)
    for gap in (0.5, 0.7, 1.0, 1.3):
        assert 0.95 < drawn(0, gap).sum() / alone.sum() < 1.2
    assert np.abs(drawn(0, 1.3) - alone).max() < 0.2


def test_a_mark_on_a_crease_is_one_line():
    a, b = (40.3, -3.0), (37.1, 63.0)
    layers = wall(ends=(a, b))
    y, x = np.mgrid[:60, :80]
    left = x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    marked = ink(layers, line_mark_width=2.0)[10:50].sum()
    layers["normal"][left] = 0.6, 0, 0.8
    assert ink(layers, line_mark_width=2.0)[10:50].sum() == pytest.approx(marked, rel=0.02)  # the crease is the mark's
