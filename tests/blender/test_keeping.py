# SPDX-License-Identifier: GPL-3.0-or-later
"""What is set in Blender is kept: in overrides of what is linked, in presets, in copies."""

from pathlib import Path

import blenders
import pytest

EVERY = [pytest.param(name, marks={"bpy": (), "blender": pytest.mark.slow}.get(name, pytest.mark.long))
         for name in blenders.commands()]
OURS = list((Path(__file__).parents[2] / "addon" / "presets").glob("*.json"))


@pytest.fixture(params=EVERY, scope="module")
def blender(request):
    return request.param


def test_overrides_of_linked_objects_and_materials_are_kept(render):
    facts = render("overridden").facts
    controls = {"thickness", "intensity", "color_edge", "smudge_range", "smudge_falloff", "hatching"}
    for owner, wanted in (("object", {"style", "line_group", "separate_parts", "crease_offset"} | controls),
                          ("material", {"style"} | controls)):
        [settings] = facts[owner]
        assert settings.keys() >= wanted
        assert {name: kept for name, (given, kept) in settings.items() if kept != given} == {}


@pytest.fixture(scope="module")
def presets(blender, tmp_path_factory):
    folder = tmp_path_factory.mktemp("presets")
    shot = blenders.run(blender, "presets", folder, {"BLENDER_USER_CONFIG": str(folder / "config")})
    assert shot.facts["folder"] == [str(folder / "config" / "encre" / "presets")]
    return shot.facts


def theirs(listed):
    return [[id_, picture] for id_, own, picture in listed[0][0] if not own]


def test_a_look_is_saved_with_a_picture_and_applied(presets):
    assert presets["save"] == [[["FINISHED"], "my_look"]] * 2
    assert theirs(presets["without a render"]) == [["my_look", False]]
    assert theirs(presets["saved"]) == [["my_look", True]]
    assert all(picture for _, own, picture in presets["saved"][0][0] if own)
    [file] = presets["file"]
    assert (file["name"], file["description"]) == ("My Look", "As I like it")
    assert file["values"]["line_thickness"] == 7.3 and file["values"]["ink_color"] == [0.1, 0.2, 0.3]
    assert not {"supersample", "save_layers", "paper_image"} & file["values"].keys()
    size, tint, least, most = presets["picture"][0]
    assert size == [128, 128] and tint < 0.2 and least < 0.3 and most == 1
    assert presets["left"] == [[1, ["Render Result"]]], "nothing of the picture stays in the file"
    assert presets["format"] == [["OPEN_EXR_MULTILAYER", "32"]]
    assert presets["other"] == [[4, "ink_only"]]
    thickness, color, levels, last = presets["applied"][0]
    assert [round(x, 5) for x in (thickness, *color, *levels)] == [7.3, 0.1, 0.2, 0.3, 0.4, 1] and last == "my_look"


def test_presets_are_shared_and_deleted(presets):
    own, nameless, again = presets["name"]
    assert "preset of Encre's own" in own and "no letter" in nameless and again == [["FINISHED"], "my_look"]
    assert presets["export"] == [[["FINISHED"], "my_look"]]
    assert "already" in presets["twice"][0]
    mine, encres = presets["remove"]
    assert mine[0] == ["FINISHED"] and "comes with Encre" in encres
    assert theirs(presets["removed"]) == [] and len(presets["removed"][0][0]) == len(OURS)
    assert theirs(presets["imported"]) == [["my_look", True]]
    listed, wrong = presets["broken"][0]
    assert theirs([[listed]]) == [["my_look", True]]
    assert len(wrong) == 2 and "broken.json can't be used" in wrong[0] and "presets hold no images" in wrong[1]


@pytest.fixture(scope="module")
def copied(render):
    return {name: facts[0] if len(facts) == 1 else facts for name, facts in render("settings").facts.items()}


def test_settings_are_copied_between_scenes_and_styles(copied):
    assert not copied["offered without a style"]
    scene, style = copied["first"]
    assert {"edge_detector", "paper_image", "shade_levels", "ink_color"} <= scene.keys()
    assert style == {"hatch_amount": 0.25} and copied["paste"] == ["FINISHED"]
    assert copied["second"] == [scene, style, ["Style", "Mine"]]
    assert copied["scene to style"] == {"line_thickness": 60}
    assert copied["style to style"] == style
    assert copied["style to scene"] == [0.25, 11, "DOG"], "the scene's others stay"


def test_a_style_that_is_renamed_keeps_its_users_and_has_a_name_of_its_own(copied):
    assert copied["renamed"] == [[["Style", "Style.001", "Style.002"], "Style.001", "Lost"], ["Style"]]


def test_levels_as_a_ramp(copied):
    before, (same, more, taken), left = copied["ramp"]
    assert sum(same, []) == pytest.approx(sum(before, []), abs=1e-5)
    assert len(more) == 4 and more[3][1] - more[2][1] > (more[2][2] + more[3][2]) / 2 - 1e-6, "they overlap"
    assert taken == pytest.approx([0.5, 0.7, 1.1, 1.0])
    assert not left, "the texture that held the ramp"


def test_rows_are_reset_to_the_preset_or_the_default(copied):
    assert copied["reset"] == [[4, 8], [0, 0]]
    assert copied["levels"] == [3, 2], "one more than the preset has, and its own"
    assert copied["all"] == ["FINE", 4, None] and copied["differ"] == []


def test_nothing_stays_when_the_add_on_is_disabled(render):
    facts = render("registered", alone=True).facts
    assert len(facts["on"][0]) > 30
    [left] = facts["left"]
    assert {name: what for name, what in left.items() if what and name != "every class"} == {}
    assert facts["more"] == [[]]


def test_opening_an_inked_picture_says_that_it_is_inked_again(render):
    assert any("inked again" in said for said in render("inked_file").facts["lacks"][0])
