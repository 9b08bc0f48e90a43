# SPDX-License-Identifier: GPL-3.0-or-later
"""Pens and tones in lists: their names, and what is copied between them (blender/inside/slotted.py)."""

import pytest

OWN = ["Pen 1", "Pen 2", "Pen 3"]


def one(facts):
    return {name: values[0] for name, values in facts.items()}


@pytest.fixture(scope="module")
def pens(render):
    return one(render("pens").facts)


def test_pens_have_names_and_files_keep_them(pens):
    assert pens["first"] == [OWN, "PEN_1", False]
    assert pens["opened"] == pens["evaluated"] == [["Pen 1", "Sketch", "Pen 3"], "PEN_2", True]
    assert pens["unnamed"] == OWN


def test_no_two_pens_are_called_alike_or_at_length(pens):
    long, numbered = ("Very" * 30)[:63], ("Very" * 30)[:59] + ".001"
    assert pens["unique"] == [
        ["Pen 1", "Pen 1.001", "Pen 3"], ["Pen 1", "Pen 1.001", "Pen 1.002"], ["Pen 1.003", "Pen 1.001", "Pen 1.002"],
        ["Pen 1.003", long, "Pen 1.002"], ["Pen 1.003", long, numbered], ["Pen 1", long, numbered], ["Pen 1", "Pen 2",
                                                                                                     numbered],
        OWN]


def test_kinds_of_line_offer_pens_by_name_under_their_old_identifiers_and_numbers(pens):
    assert [[id_, name, number] for id_, name, _, number in pens["offered"]] == [
        ["PEN_1", "Pen 1", 0], ["PEN_2", "Sketch", 1], ["PEN_3", "Pen 3", 2]]
    assert pens["values"] == ["PEN_2", [["Style", {"line_mark_pen": "PEN_3"}]]]
    assert pens["reset"] is False


def test_presets_name_the_pens_that_they_set(render):
    facts = one(render("pens_in_presets").facts)
    assert facts["brush"] == ["Brush", "Pen 2", "Pen 3"]
    assert facts["file"] == {"pen_1": "Brush", "pen_2": "Mine"}
    assert facts["ink only"] == ["Pen 1", "Pen 2", "Dots"], "one of Encre's own sets all pens"
    assert facts["named"] == facts["swapped"] == facts["pasted"] == ["Brush", "Mine", "Pen 3"]
    assert facts["each other's"] == facts["pasted again"] == ["Pen 2", "Pen 1", "Pen 3"]


def test_a_slot_takes_all_that_another_has(render):
    facts = one(render("slots").facts)
    assert facts["pen_1"] == [0.25, 3, 1], "the first pen is as wide as itself"
    assert facts["first pen"] == [0.125, 7, 60], "and lines keep their thickness"
    assert facts["tone"] == ["IMAGE", 150, True]
    assert "pen_4: unknown pen or tone; did you mean" in facts["unknown"] and "Traceback" not in facts["unknown"]


@pytest.fixture(scope="module")
def front(render):
    return render("front").facts


def test_a_look_sets_the_front_and_all_that_it_is_about(front):
    (pencil, manga, water) = front["look"]
    assert [look[:4] for look in (pencil, manga, water)] == [
        ["pencil", "pencil", "ENCRE", False], ["manga", "manga", "ENCRE", False],
        ["water_memory", "water_memory", "CYCLES", False]], "the rim light of before is gone"
    assert manga[4] == [0.5, 0.3, 0.5, "5", 0.0, "DOTS", "ALL", "COLD_PRESS"]
    assert water[4][:4] == [0.5, 0.0, 1.0, "3"] and water[4][5] == "PENCIL"
    names = ["outlines", "contacts", "inner", "creases", "intersections", "folds", "materials", "colors", "shadows",
             "mirrors", "marks"]
    shadows = names.index("shadows")
    assert not pencil[5][shadows] and not manga[5][shadows]
    assert all(manga[5][names.index(n)] for n in ("inner", "folds"))


def test_the_front_sets_what_it_shows_and_goes_back(front):
    assert all(was != now for _, was, now in front["toggled"]) and len(front["toggled"]) == 12
    assert all(abs(share - now) < 0.02 for _, share, now in front["share"])
    assert front["changed by going there and back"] == [[]]
    assert [[count, len(levels)] for count, levels in front["steps"]] == [["1", 1], ["2", 2], ["3", 3], ["4", 4]]
    assert [level[0] for level in front["steps"][3][1]] == sorted(level[0] for level in front["steps"][3][1])
    assert front["edge"][0][0] == pytest.approx(0.5) and front["edge"][0][1][1:] == [0.075] * 3
    assert [set_ for set_, *_ in front["fill"]] == [now for _, now, *_ in front["fill"]]
    assert front["dots"] == [["DOTS", 0.5]], "dots are seen at once"
    assert all(set_ == now for set_, now, *_ in front["side"])
