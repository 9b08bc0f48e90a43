# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of shapes that chains of mesh edges tell: what of them FINE draws, and what pixels draw no more."""

import numpy as np
import pytest
from encre.pen import abi
from encre.pen.errors import EncreError
from encre.pen.job import Frame
from known import FAR, SIZE, drawn, flat, line


def across(y=30.0, x0=10.0, x1=86.0):
    return [(x0, y), (x1, y)]


def test_the_angle_of_a_crease_is_exact():
    ink = [drawn(flat(), line(across(), "crease", bend=bend)).sum() for bend in (29.5, 30.5, 32, 34, 60)]
    assert ink[0] == 0
    assert ink[1] >= 0.5 * ink[4]
    assert ink[1] < ink[2] < ink[3] == ink[4]


def test_a_smooth_edge_has_its_own_angle_and_goes_on_from_a_sharper_one():
    alone = drawn(flat(), line(across(), "crease smooth", bend=55))
    assert not alone.any()
    both = line([(10, 30), (40, 30), (86, 30)], "crease smooth")
    both["bend"] = 90, 90, 55  # of the ways to each point
    on = drawn(flat(), both)
    assert on[28:33, 50:80].any(0).all()
    both["bend"] = 90, 90, 49
    assert not drawn(flat(), both)[28:33, 50:80].any()


@pytest.mark.parametrize("gap, share", [(0.1, 0), (0.3125, 0.5), (0.5, 1), (FAR, 1)])
def test_a_fold_comes_in_by_how_far_it_lies_before_what_is_behind(gap, share):
    whole = drawn(flat(), line(across(), "contour", side=1)).sum()
    assert drawn(flat(), line(across(), "contour", side=1, gap=gap)).sum() == pytest.approx(share * whole, rel=0.02)


def step(left=1, right=2):
    """A thing before another one; its contour lies at x = 47.5."""
    layers = flat()
    layers["depth"][:, 48:] = 9
    layers["object"][:, :48], layers["object"][:, 48:] = left, right
    return layers


def test_pixels_draw_no_shapes_of_what_comes_as_chains():
    assert drawn(step()).any()
    nothing = line(across(), "crease", bend=1)
    assert not drawn(step(), nothing).any()
    np.testing.assert_array_equal(drawn(step(), nothing, chained=(1, 0, 0)), drawn(step()))


@pytest.mark.parametrize("chained, draws", [((1, 0, 1), True), ((1, 1, 0), False)])
def test_between_a_chained_thing_and_another_the_nearer_one_tells(chained, draws):
    assert drawn(step(), line(across(), "crease", bend=1), chained).any() == draws


def test_a_contour_lies_where_its_edge_does():
    contour = line([(47.3, -40), (47.3, 100)], "contour", side=1, behind=2)
    t = drawn(step(), contour)
    at = (t * np.arange(SIZE[1])).sum(1) / t.sum(1)
    np.testing.assert_allclose(at, 47.3, atol=0.01)
    np.testing.assert_allclose(t.sum(1), 2, atol=0.02)


def test_of_two_creases_that_lie_close_one_stays():
    one = drawn(flat(), line(across(), "crease")).sum()
    for apart, share in ((1.2, 1), (2.3, 1), (3.7, 2)):
        two = [line(across(), "crease"), line(across(30 + apart), "crease", run=1)]
        assert drawn(flat(), two).sum() == pytest.approx(share * one, rel=0.03)


def test_a_crease_gives_way_to_an_outline_and_outlines_do_not():
    outline = line(across(), "contour", side=1, behind=2)
    one = drawn(flat(), outline).sum()
    assert drawn(flat(), [outline, line(across(31.2), "crease", run=1)]).sum() == pytest.approx(one, rel=0.03)
    other = line(across(31.5), "contour", run=1, side=1, behind=3, object=2, mesh=2)
    both = flat()
    both["object"][31:] = 2
    one, two = (drawn(both, given, line_thickness=1.0).sum() for given in (outline, [outline, other]))
    assert two > 1.5 * one


def test_what_gives_way_makes_others_give_way_as_much_less():
    three = [line(across(30 + 3 * k), "crease", run=k, depth=5 + 0.01 * k) for k in range(3)]
    t = drawn(flat(), three, line_thickness=1.0)
    np.testing.assert_allclose(t[30:39:3, 30:60], np.array([[1], [1 / 2], [3 / 4]]) + np.zeros((1, 30)), atol=0.01)


def test_an_outline_among_many_creases_stays_whole():
    """Of a tire whose facets bend enough the outline was as thin as they."""
    creases = [line(across(30 + 0.9 * k), "crease", run=10 + k, depth=5 + 0.01 * k) for k in range(-6, 7) if k]
    outline = line(across(30), "contour", side=1, behind=2)
    alone, among = (drawn(flat(), given, line_thickness=1.0)[30, 30:60].min()
                    for given in (outline, [outline, *creases]))
    assert among > 0.98 * alone > 0.5
    few, many = (drawn(flat(), creases[:n], line_thickness=1.0, crease_angle=30.0).sum() / n for n in (1, 12))
    assert many < 0.7 * few


def dents(span, aside=0.5):
    """A fold of a dense mesh: edges of 1.5 pixels that go to and fro."""
    at = np.arange(0, span + 0.1, 1.0)
    return [(40 - span / 2 + x, 30 + aside * (k % 2 * 2 - 1)) for k, x in enumerate(at)]


def test_short_folds_of_smooth_forms_are_dropped_by_what_they_span_and_come_by_degrees():
    """Of a scan's rough stone dots were left, each longer along its edges than a line must be."""
    def share(span, kind="contour smooth", **values):
        given = line(dents(span), kind, side=1, gap=4)
        return drawn(flat(), given, **values).sum() / drawn(flat(), given, line_shortest=0.0).sum()
    assert share(10) == 0 and share(20) == 1
    assert 0.3 < share(15) < 0.7
    assert share(10, line_shortest=4.0) == 1
    ring = [(40 + 2.5 * np.cos(t), 30 + 2.5 * np.sin(t)) for t in np.linspace(0, 2 * np.pi, 12)]
    ring[-1] = ring[0]
    for kind, ink in (("contour smooth", False), ("contour", True)):  # a rivet is none of a rough surface
        assert drawn(flat(), line(ring, kind, side=1, gap=4)).any() == ink
    eye = line([(40 + 2.6 * (x - 40), 30 + 1.5 * (y - 30)) for x, y in ring], "contour smooth", side=1, gap=4)
    assert drawn(flat(), eye).sum() > 0.6 * drawn(flat(), eye, line_shortest=0.0).sum() > 20
    assert share(13) < 0.3


def test_an_outline_among_many_folds_stays_whole_and_these_vanish():
    folds = [line(across(30 + 0.9 * k), "contour smooth", run=10 + k, side=(-1)**k, gap=4, depth=5 + 0.01 * k)
             for k in range(1, 13)]
    outline = line(across(30), "contour smooth", side=1, behind=2)
    alone, among = (drawn(flat(), given, line_thickness=1.0)[30, 30:60].min() for given in (outline, [outline, *folds]))
    assert among > 0.95 * alone > 0.5
    few, many = (drawn(flat(), folds[:n], line_thickness=1.0).sum() / n for n in (1, 12))
    assert many < 0.15 * few


def test_what_is_left_of_creases_and_spans_next_to_nothing_is_not_drawn():
    short = line([(30, 30), (32, 30)], "crease")
    assert not drawn(flat(), short, line_shortest=0.0).any()
    assert drawn(flat(), line([(30, 30), (34, 30)], "crease"), line_shortest=0.0).any()
    assert drawn(flat(), line([(30, 30), (32, 30)], "mark"), line_shortest=0.0).any()


@pytest.mark.parametrize("layers", [step(3, 2), flat(depth=4.0) | {"object": flat(number=3)["object"]}])
def test_where_the_layers_show_something_else_they_speak(layers):
    contour = line([(47.5, -40), (47.5, 100)], "contour", side=1, behind=2)
    np.testing.assert_array_equal(drawn(layers, contour, chained=(1, 1, 1, 0)), drawn(layers))


def test_a_rare_pixel_that_differs_hides_nothing():
    layers = step()
    layers["object"][20:26] = 3
    contour = line([(47.5, -40), (47.5, 100)], "contour", side=1, behind=2)
    t = drawn(layers, contour, chained=(1, 1, 1, 0))
    assert t[:, 46:50].any(1).all()


def test_colours_keep_clear_of_what_is_older_and_are_led_on_to_it():
    layers = flat()
    layers["color"] = layers["albedo"] = np.where(np.arange(SIZE[1])[None, :, None] < 48, 1, 0.2) * np.ones(
        (*SIZE, 3), np.float32)
    layers["color"] = layers["albedo"] = np.ascontiguousarray(layers["albedo"], np.float32)
    both = dict(line_color_strength=3.0, line_color_width=1.0)
    beside = drawn(layers, line([(48.5, -40), (48.5, 100)], "crease"), **both)
    assert beside.sum() == pytest.approx(drawn(flat(), line([(48.5, -40), (48.5, 100)], "crease")).sum(), rel=0.01)
    crossed = drawn(layers, line([(-40, 30.4), (140, 30.4)], "crease"), **both)
    assert crossed[:, 46:50].max(1).min() > 0.5  # the colour's line goes up to the crease on both sides


def star():
    rng = np.random.default_rng(4)
    return [line([(48, 30), *(48 + 45 * np.array([[np.cos(a), np.sin(a)]]))], "crease", run=k, depth=5 + 0.001 * k)
            for k, a in enumerate(rng.uniform(0, 2 * np.pi, 40))]


def test_crowds_get_thinner_and_are_the_same_on_any_number_of_threads():
    t = drawn(flat(), star())
    assert t.any()
    np.testing.assert_array_equal(drawn(flat(), star(), threads=3), t)


def test_a_part_of_a_frame_has_the_lines_of_the_whole():
    size, margin = (200, 300), 84
    chains = [*star(), line([(40, 20), (180, 120.3), (280, 60)], "crease", run=60)]
    whole = drawn(flat(size), chains)
    part = drawn(flat((100 + margin, 100 + 2 * margin)), chains, frame=Frame(300, 200, 100 - margin, 0))
    np.testing.assert_allclose(part[:100, margin:-margin], whole[:100, 100:200], atol=1e-4)


def test_without_chains_nothing_changes():
    none = np.zeros(0, abi.CHAIN_POINT)
    np.testing.assert_array_equal(drawn(step(), none, chained=()), drawn(step()))


@pytest.mark.parametrize("name, value", [("x", np.nan), ("y", 1e7), ("depth", np.inf), ("along", np.nan)])
def test_points_that_are_at_no_place_are_refused(name, value):
    points = line(across(), "crease")
    points[name][1] = value
    with pytest.raises(EncreError, match="chains: point 1 is at no place; give what encre_chains"):
        drawn(flat(), points)


def test_runs_that_do_not_follow_each_other_are_refused():
    with pytest.raises(EncreError, match="chains: run 0 follows run 1; give runs one after the other"):
        drawn(flat(), [line(across(), "crease", run=1), line(across(40), "crease")])


def test_what_has_no_chains_covers_those_behind_it():
    """A leaf that alpha cuts out, of a width over which the layers do not speak against the line."""
    layers = flat()
    layers["object"][25:35, 44:52], layers["depth"][25:35, 44:52] = 3, 2
    covered = drawn(layers, line(across(), "crease"), chained=(1, 1, 1, 0))
    assert covered[28:33, 15:40].any(0).all() and covered[28:33, 56:80].any(0).all()
    assert not covered[28:33, 46:50].any()
    assert drawn(layers, line(across(), "crease"), chained=(1, 1, 1, 1))[28:33, 46:50].any()


def test_a_hand_wobbles_evenly_before_what_is_far_behind_on_the_same_thing():
    """As on the frame of a car's window, through which its inside shows: the line lies on the frame alone."""
    layers = step(1, 1)
    y, x = np.mgrid[:SIZE[0], :SIZE[1]].astype(np.float32)
    anchor = np.zeros((*SIZE, 16), np.float32)
    for where, pixel, aside in ((x < 48, 0.01, 0), (x >= 48, 0.018, 100)):
        anchor[where, 0], anchor[where, 1], anchor[where, 2] = (x * pixel)[where] + aside, (y * pixel)[where], aside
        anchor[where, 6], anchor[where, 7], anchor[where, 11] = pixel, pixel, pixel
    layers["anchor"] = anchor
    ink = drawn(layers, line([(47.2, 5), (47.9, 30), (47.3, 55)], "contour", side=1), pen_1_wobble=6.0)[8:52]
    middle = (ink * x[8:52]).sum(1) / ink.sum(1)
    assert np.abs(np.diff(middle)).max() > 0.02, "it wobbles"
    assert np.abs(np.diff(middle, 2)).max() < 0.2
