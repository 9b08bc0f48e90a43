# SPDX-License-Identifier: GPL-3.0-or-later
"""What parts a figure from its ground: gaps in lines behind outlines, a halo around these, heavier outer contours."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Chains
from known import LOOK, drawn, flat, line

EDGE = 47.5
THIN = dict(line_thickness=1.0, line_shortest=0.0)


def figure(behind=9.0):
    """A figure on the left before a wall on the right."""
    layers = flat()
    layers["depth"][:, 48:] = behind
    layers["object"][:, 48:] = 2
    return layers


def outline(gap=100.0, **more):
    return line([(EDGE, -40), (EDGE, 140)], "contour", side=1, behind=2, gap=gap, **more)


def rail(y=30.0, object=2, depth=9.0, x=(EDGE, 90.0)):
    return line([(x[0], y), (x[1], y)], "crease", run=1, object=object, depth=depth)


def left_of_rail(t, y=30):
    """Where the rail begins."""
    return np.flatnonzero(t[y, 50:] > 0.5)[0] + 50


@pytest.mark.parametrize("away", [4.0, 9.0, 20.0])
def test_a_line_ends_before_the_outline_that_it_passes_behind(away):
    t = drawn(figure(), [outline(), rail()], line_gap=away, **THIN)
    assert left_of_rail(t) - EDGE == pytest.approx(away, abs=1.2)
    assert t[30, 60 + int(away) - 9:88].all() and (t[5:90, 47:49].sum(1) > 0.9).all()


def test_without_a_gap_it_runs_into_it():
    t = drawn(figure(), [outline(), rail()], **THIN)
    assert t[30, 49:88].all()


def test_lines_of_the_figure_run_into_its_outline():
    own = rail(object=1, depth=5.0, x=(10.0, EDGE))
    t = drawn(figure(), [outline(), own], line_gap=9.0, **THIN)
    assert t[30, 12:47].all()


def test_what_hardly_lies_before_what_is_behind_keeps_nothing_away():
    starts = [left_of_rail(drawn(figure(5.01), [outline(gap), rail(depth=5.01)], line_gap=9.0, **THIN))
              for gap in (0.1, 3.0, 100.0)]
    assert starts[0] <= 51 < starts[1] < starts[2]


def test_lines_of_pixels_end_there_too():
    """A step between colors on the wall, which no mesh tells of."""
    layers = figure()
    for name in ("color", "albedo"):
        layers[name] = layers[name].copy()
        layers[name][30:, 48:] = 0.2
    whole, cut = (drawn(layers, outline(), line_color_strength=1.0, line_gap=away, **THIN) for away in (0.0, 9.0))
    at = whole[28:32].sum(0) > 0.3
    assert at[52:90].all()
    on = cut[28:32].sum(0) > 0.3
    assert not on[50:55].any() and on[59:90].all()


def images(layers, chains, **values):
    told = Chains(chains, np.array([1, 1, 1, 1]))
    return library.render(layers, LOOK | values, chains=told,
                          outputs=["Combined", "Encre Surface", "Encre Lines"]).images


def test_a_halo_covers_what_lies_behind_and_nothing_of_the_figure():
    layers = figure()
    layers["combined"][..., :3] = 0.3
    plain, halo = (images(layers, outline(), line_halo=wide, line_halo_color=(1.0, 0.5, 0.0)) for wide in (0.0, 8.0))
    row = halo["Encre Surface"][40]
    np.testing.assert_allclose(row[48:55, :3], [[1, 0.5, 0]] * 7, atol=1e-6)
    np.testing.assert_allclose(row[57:, :3], 0.3, atol=1e-6)
    np.testing.assert_array_equal(row[:48], plain["Encre Surface"][40][:48])
    np.testing.assert_array_equal(halo["Encre Lines"], plain["Encre Lines"])


def test_a_halo_keeps_lines_away():
    t = drawn(figure(), [outline(), rail()], line_halo=9.0, **THIN)
    assert left_of_rail(t) - EDGE == pytest.approx(9, abs=1.2)


@pytest.mark.parametrize("gap, share", [(10.0, 1), (60.0, 1.5), (1e9, 2)])
def test_an_outer_contour_is_as_much_wider_as_asked_and_others_are_not(gap, share):
    t = drawn(figure(), outline(gap), line_outer_width=2.0, line_contact_width=1.0)
    np.testing.assert_allclose(t[20:60].sum(1), 2 * share, atol=0.03)
    fold = line([(EDGE, -40), (EDGE, 140)], "contour", side=1, behind=1, gap=gap)
    layers = flat()
    assert drawn(layers, fold, line_outer_width=2.0)[20:60].sum(1) == pytest.approx(np.full(40, 2.0), abs=0.03)


def test_any_number_of_threads_draws_the_same():
    one, three = (drawn(figure(), [outline(), rail()], line_gap=5.0, line_halo=9.0, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one, three)
