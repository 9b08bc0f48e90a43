# SPDX-License-Identifier: GPL-3.0-or-later
"""How `encre render` sets scenes up: what is chosen is what is rendered, and nothing that lacks goes unsaid."""

import pytest


@pytest.fixture
def facts(render):
    return lambda case: render(case).facts


def amiss(facts, name, *words):
    """What is said once, as a warning, and with --strict an error, holds all words."""
    [[[kind, text]]], [error] = facts[f"{name} said"], facts[f"{name} strict"]
    assert kind == "warning" and error == text and text.startswith("shot.blend: ")
    assert all(word in text for word in words), text
    return text


def test_a_camera_that_is_asked_for_is_taken_in_all_frames(facts):
    """Whatever cameras markers bind, of which Blender takes the next as soon as one loses its own."""
    assert facts("camera_of_markers")["cameras"] == [["Camera"] * 3]


def test_a_compositor_that_reads_what_is_not_rendered(facts):
    found = facts("compositor_of_other_layers")
    amiss(found, "compositor", "view layer ViewLayer", "--view-layer", "Compositing")
    for name in "own layer", "switched off":
        assert found[f"{name} said"] == [[]] and found[f"{name} strict"] == [None]


def test_files_that_blender_writes_besides(facts):
    """They are named; what stands where their folder would be is found before."""
    found = facts("other_outputs")
    for name in "no strips", "muted":
        assert found[f"{name} said"] == [[]] and found[f"{name} strict"] == [None]
    [[[kind, text]]] = found["free said"]
    assert kind == "note" and "taken" in text and "(node File Output)" in text and found["free strict"] == [None]
    [[_, [kind, text]]], [error] = found["taken said"], found["taken strict"]
    assert kind == "warning" and "taken is no folder" in text and error == text
    [[[kind, text]]] = found["strips said"]
    assert kind == "warning" and "sequencer" in text and "no passes" in text


def test_a_view_transform_that_makes_paper_grey_is_noted(facts):
    """In a PNG, not in layers, to which none is applied. A file for another engine gets Standard."""
    found = facts("view_transforms")
    [[[kind, text]]] = found["washed out said"]
    assert kind == "note" and "Filmic" in text and "choose Standard" in text and found["washed out strict"] == [None]
    assert found["layers said"] == found["standard said"] == [[]]
    assert found["another engine said"] == [[]] and found["another engine"] == [["Standard", 0]]


def test_files_that_cannot_be_used(facts):
    found = facts("files_amiss")
    amiss(found, "style", "Cube has the style Nope", "add such a style")
    [[[kind, text]]], [error] = found["textures said"], found["textures strict"]
    assert kind == "warning" and "empty.png (empty)" in text and "cut.png" not in text and "whole" not in text
    assert "empty.png (empty)" in error and "cut.png (broken)" in error and "whole" not in error
    amiss(found, "volume", "smoke.vdb (not there)", "bring them back")
    assert found["sequence said"] == [[]]
    first, second, third = found["frames"]
    assert first == third == [] and len(second) == 1 and "sq.0002.png (not there)" in second[0]


def test_scripts_that_fail_are_said_once_and_end_a_frame_with_strict(facts):
    found = facts("failing_scripts")
    [[kind, text]] = found["words"][0]
    assert found["strict False"] == [None] * 3 and found["strict True"][0] is None
    assert found["strict True"][1] == found["strict True"][2] == text and kind == "warning"
    assert text.startswith("frame 2: a script failed (staged.py, line ") and "ValueError: the rig is gone" in text
