# SPDX-License-Identifier: GPL-3.0-or-later
"""Pens and tones in lists: their names, and what is copied between them (blender/inside/slotted.py)."""

import pytest

OWN = ["Pen", "Pen 2", "Pen 3"]


def one(facts):
    return {name: values[0] for name, values in facts.items()}


@pytest.fixture(scope="module")
def pens(render):
    return one(render("pens").facts)


def test_pens_have_names_and_files_keep_them(pens):
    assert pens["first"] == [OWN, "PEN", False]
    assert pens["opened"] == pens["evaluated"] == [["Pen", "Sketch", "Pen 3"], "PEN_2", True]
    assert pens["unnamed"] == OWN


def test_no_two_pens_are_called_alike_or_at_length(pens):
    long, numbered = ("Very" * 30)[:63], ("Very" * 30)[:59] + ".001"
    assert pens["unique"] == [
        ["Pen", "Pen.001", "Pen 3"], ["Pen", "Pen.001", "Pen.002"], ["Pen.003", "Pen.001", "Pen.002"],
        ["Pen.003", long, "Pen.002"], ["Pen.003", long, numbered], ["Pen", long, numbered], ["Pen", "Pen 2", numbered],
        OWN]


def test_kinds_of_line_offer_pens_by_name_under_their_old_identifiers_and_numbers(pens):
    assert [[id_, name, number] for id_, name, _, number in pens["offered"]] == [
        ["PEN", "Pen", 0], ["PEN_2", "Sketch", 1], ["PEN_3", "Pen 3", 2]]
    assert pens["values"] == ["PEN_2", [["Style", {"line_pen_mark": "PEN_3"}]]]
    assert pens["reset"] is False


def test_presets_name_the_pens_that_they_set(render):
    facts = one(render("pens_in_presets").facts)
    assert facts["brush"] == ["Brush", "Mine", "Pen 3"]
    assert facts["file"] == {"pen": "Brush", "pen_2": "Mine"}
    assert facts["ink only"] == ["Pen", "Other", "Dots"], "Encre's own presets leave the second pen as it is"
    assert facts["named"] == facts["swapped"] == facts["pasted"] == ["Brush", "Mine", "Pen 3"]
    assert facts["each other's"] == facts["pasted again"] == ["Pen 2", "Pen", "Pen 3"]


def test_a_slot_takes_all_that_another_has(render):
    facts = one(render("slots").facts)
    assert facts["pen"] == [0.25, 3, 1], "the first pen is as wide as itself"
    assert facts["first pen"] == [0.125, 7, 60], "and has no width beside that of lines"
    assert facts["tone"] == ["IMAGE", 150, True]
    assert "pen_4: unknown pen or tone; did you mean" in facts["unknown"] and "Traceback" not in facts["unknown"]
