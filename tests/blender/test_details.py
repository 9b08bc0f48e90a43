# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on reads of a scene, what its panels show and what its operators do, without much rendering."""

import pytest


@pytest.fixture(scope="module")
def facts(render):
    return render("details").facts


def test_instances_of_a_line_group_have_one_number_and_others_each_its_own(facts):
    numbers = facts["numbers"][0]
    pair = {number for name, number in numbers if name in ("Inner pair", "Cube")}
    alone = [number for name, number in numbers if name == "Inner "]
    assert len(pair) == 1 and len(set(alone)) == len(alone) == 3 and not pair & set(alone)


def test_edges_are_told_by_an_attributes_name_to_be_no_lines(facts):
    """Beside the cuts through six faces, which two triangles have as well, one edge."""
    assert facts["never lines"] == [[14, 12, 12, 12]]


def test_the_library_has_the_scenes_threads(facts):
    assert len(facts["FIXED"][0]) == 2 and set(facts["FIXED"][0]) == {3}
    assert len(facts["AUTO"][0]) == 2 and set(facts["AUTO"][0]) == {0}


def test_what_has_no_effect_is_greyed_out(facts):
    for rule, detector, auto, enabled in facts["enabled"]:
        assert "!contrast_local" in rule
        assert enabled == (detector == "CONTRAST" and not auto)


def test_lines_in_pixels_that_run_together_are_said(facts):
    assert facts["blots"] == [None, *["Lines of 22 px run together"] * 2, None]


def test_every_property_tells_views_of_its_change(facts):
    assert facts["without update"] == [[]] and facts["properties"][0] > 150


def test_whatever_changes_the_scene_can_be_undone(facts):
    options = facts["options"][0]
    assert len(options) > 8
    assert [name for name, own in options.items() if "UNDO" not in own and name not in KEEPS] == []


KEEPS = {"ENCRE_OT_bake", "ENCRE_OT_preset_import", "ENCRE_OT_preset_export", "ENCRE_OT_preset_remove",  # only files
         "ENCRE_OT_settings_copy", "ENCRE_OT_redraw", "ENCRE_OT_give_up", "ENCRE_OT_control_show",  # what was rendered
         "ENCRE_OT_give_way", "ENCRE_OT_open_layers",
         "ENCRE_OT_study", "ENCRE_OT_study_run"}  # and what shows it
