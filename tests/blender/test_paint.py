# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls that are painted, filled, and made by nodes (blender/inside/painting.py and paint_window.py do it)."""

from pathlib import Path

import blenders
import numpy as np
import pytest

WINDOW = Path(__file__).parent / "inside" / "paint_window.py"


@pytest.fixture(scope="module")
def facts(render):
    return {name: found[0] if len(found) == 1 else found for name, found in render("painting").facts.items()}


def test_paint_makes_neutral_attributes_and_enters_vertex_paint(facts):
    assert facts["made"] == [[128], [128], "VERTEX_PAINT", "encre_thickness", "thickness"]
    assert facts["left"] == ["OBJECT", None]


def test_the_brush_adds_and_subtracts(facts):
    assert facts["first brush"] == ["ADD", np.float32(0.15)] and facts["kept strength"] == 0.75
    assert facts["other brush"] is None
    assert facts["brush"] == [[kind, kind, 0.25] for kind in ("ADD", "SUBTRACT", "NEUTRAL")]


def test_fill_and_reset_all_that_is_selected(facts):
    assert facts["filled"] == [[191], [191]] and facts["neutral"] == [128]
    assert facts["reset"] == [None, None] and facts["reset again"] == "{'CANCELLED'}"


def test_fill_where_it_is_selected_or_masked(facts):
    assert facts["edit"] == "EDIT" and facts["some"] == [8, 9, 10, 11]
    hatched, vertices, corners = facts["masked"]
    assert hatched == [16, 17, 18, 19] and vertices == [0] and corners == 3
    assert facts["nothing selected"] == "{'CANCELLED'}" and facts["not made"] is None
    assert facts["reset while painting"] == [[128], "VERTEX_PAINT"] and facts["points"] == 1


def test_what_can_not_be_painted_is_said(facts):
    assert "is not a color" in facts["numbers"] and facts["after"] == "OBJECT"
    assert "has no faces" in facts["bare"]
    said, made = facts["beside bare"]
    assert "has no faces" in said and made is None


# Geometry Nodes


@pytest.fixture(scope="module")
def nodes(render):
    return render("control_nodes")


def test_nodes_lie_one_above_another_and_over_paint(nodes):
    least, most, groups = fact(nodes, "stack")
    assert abs(least - 0.25) < 0.005 and abs(most - 0.25) < 0.005 and groups == 1
    assert abs(fact(nodes, "without paint") - 0.75) < 1e-5


def test_nodes_make_what_they_say(nodes):
    most, apart = fact(nodes, "near")
    assert most > 0.4 and apart < 0.01  # what is within 1/128 of 0 is 0
    assert fact(nodes, "edge-on") < 0.07 and fact(nodes, "new empty") == "EMPTY"  # 3.4 has normals of faces there
    low, middle, high = fact(nodes, "spread")
    assert low < -0.15 and abs(middle) < 0.15 and high > 0.15
    assert "no camera" in fact(nodes, "no camera")


def test_nodes_draw_what_the_same_values_by_hand_draw(nodes):
    made, hand, neither = (nodes.passes(name) for name in ("nodes", "hand", "neither"))
    for name in ("Combined", "Encre Lines"):
        assert np.abs(made[name] - hand[name]).max() < 0.01, name
    assert (np.abs(neither["Combined"] - hand["Combined"]).max(-1) > 0.1).sum() > 50


# Strokes


@pytest.fixture(scope="module")
def strokes(render):
    return render("strokes")


def test_strokes_become_curves_on_the_surface(strokes):
    kind, lines, points, hidden = fact(strokes, "marks")
    assert (kind, lines, hidden) == ("CURVE", 1, True) and 8 < points < 200  # five were drawn
    found, lift = fact(strokes, "lift")
    assert found and 0 < lift < 0.001
    if "note" in strokes.facts:  # 4.5 lets no script draw annotations
        assert all(abs(y + 0.5) < 0.001 and abs(x + 0.1) < 0.3 for x, y, _ in fact(strokes, "note"))
        assert fact(strokes, "cleared") == 0


@pytest.mark.parametrize("name", ("marked", "marked_quick"))
def test_strokes_are_inked_where_they_can_be_seen(strokes, name):
    bare, marked, behind = (strokes.passes(of)["Encre Lines"][..., 3] for of in ("bare", name, "behind"))
    new = (marked > 0.5) & (bare < 0.1)
    rows, columns = np.nonzero(new[:, 180:260])
    assert new.sum() > 150 and np.ptp(columns) > 30 and np.unique(columns).size > 0.95 * np.ptp(columns)
    assert np.ptp(rows) < 30 and new[:, :170].sum() == 0
    assert ((behind > 0.5) & (bare < 0.1)).sum() < 40  # of the outline, which has corners


# In a window


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paint_window")
    return blenders.window(WINDOW, "paint", folder, (720, 540), "--enable-event-simulate")


def fact(shot, name):
    return shot.facts[name][0]


@pytest.mark.slow
def test_nothing_fails_in_the_window(shot):
    assert fact(shot, "finished")
    assert "Traceback" not in shot.output and "rna_uiItem" not in shot.output, shot.output[-3000:]


@pytest.mark.slow
def test_each_operator_is_undone_in_one_step(shot):
    assert fact(shot, "undone") == [[255], None, [0], [255], None]
    assert fact(shot, "paint undone") == ["VERTEX_PAINT", [128], "OBJECT", None]


@pytest.mark.slow
def test_strokes_add_and_subtract(shot):
    (least, most), right = fact(shot, "raised")
    assert least == 128 and 155 <= most <= 160 and right == [128, 128]  # a quarter
    (least, _), right = fact(shot, "lowered")
    assert 90 <= least <= 97 and right == [128, 128]  # half of it less
    (least, most), _ = fact(shot, "wiped")
    assert fact(shot, "stroke undone") == [fact(shot, "lowered"), "VERTEX_PAINT"]
    assert least > fact(shot, "lowered")[0][0] + 20


@pytest.mark.slow
def test_strokes_are_mirrored(shot):
    left, right = fact(shot, "mirrored")
    assert left[1] > 200 and right == [128, 255]  # on the left it was lowered before


@pytest.mark.slow
def test_leaving_vertex_paint_clears_the_row(shot):
    assert fact(shot, "pressed") == "thickness" and fact(shot, "left") is None


@pytest.mark.slow
def test_the_heat_map_is_switched_by_the_row(shot):
    assert fact(shot, "heat map") == ["RENDERED", "CONTROL", "thickness", True]
    assert fact(shot, "no heat map") == ["RENDERED", "FINAL"]
