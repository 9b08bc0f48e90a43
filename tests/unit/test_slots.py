# SPDX-License-Identifier: GPL-3.0-or-later
"""Which rows of the table are whose: pens and tones as slots."""

import json

import pytest
from encre.pen import library, presets, slots
from encre.pen.errors import EncreError
from encre.pen.params import PENS, TONES


def test_pens_are_alike():
    first, *others = slots.pens()
    assert [pen.id for pen in (first, *others)] == list(PENS.values())
    for pen in (first, *others):
        assert list(pen.rows) == list(first.rows)
        assert {p.id for p in pen.rows.values()} == {p.id for p in library.params().values() if p.stage == pen.id}


def test_tones_are_alike():
    for n, tone in enumerate(slots.tones(), 1):
        assert tone.id == TONES[n - 1] and [tone.row_label(p) for p in tone.rows.values()] == [
            "Tone", "Image", "Spacing", "Angle", "Space", "Gradient", "Color"]


def test_rows_know_their_slot():
    assert slots.of("pen_2_wobble").id == "pen_2" and slots.of("tone_3").id == slots.of("tone_3_pitch").id == "tone_3"
    assert slots.of("line_thickness") is slots.of("ink_on_dark") is slots.of("tone_darkness") is None


@pytest.mark.parametrize("pens, words", [
    ({"pen_1": 3}, "name 3 is no text"), (["Brush"], "no object of names"), ({"pen_2": None}, "None is no text"),
    ({"pen_9": "Brush"}, "pen_9: unknown pen"), ({"pen_1": "Very" * 16}, "'VeryVery.*longer than 63 letters"),
    ({"pen_1": "Brush", "pen_3": " Brush "}, "two of its pens are called 'Brush'"),
    ({"pen_1": "a\0b"}, "letters that can't be shown"), ({"pen_1": "\ud800"}, "letters that can't be shown")])
def test_presets_names_of_pens_are_checked(tmp_path, pens, words):
    path = tmp_path / "x.json"
    path.write_text(json.dumps({"name": "X", "description": "", "pens": pens, "values": {"pen_1_wobble": 1}}))
    with pytest.raises(EncreError, match=words):
        presets.read(path)


def test_a_preset_names_only_the_pens_that_it_sets(tmp_path):
    path = tmp_path / "x.json"
    presets.write(path, "X", "", {"pen_1_wobble": 1}, {"pen_1": "Nib", "pen_2": "Other"})
    assert presets.read(path).pens == {"pen_1": "Nib"}
    presets.write(path, "X", "", {"ink_color": (0, 0, 0)}, {"pen_1": "Nib"})
    assert presets.read(path).pens == {}
