# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rendered 3D view reads when a setting changes (blender/inside/slider_window.py changes them)."""

from pathlib import Path

import blenders
import pytest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    return blenders.window(Path(__file__).parent / "inside" / "slider_window.py", "slider",
                           tmp_path_factory.mktemp("slider"), (800, 600))


def found(shot, name):
    """(how often the scene was read, whether the picture is another); what is shown is the scene as it is."""
    reads, another, right, anew, same = shot.facts[name][0]
    assert right and anew == 1 and same, name
    return reads, another


def test_a_setting_reads_nothing(shot):
    assert shot.facts["finished"][0] and "Traceback" not in shot.output, shot.output[-3000:]
    assert shot.facts["at first"][0] >= 1
    for name in ("slider", "colour", "angle that none has"):
        assert found(shot, name) == (0, True), name
    assert found(shot, "angle of creases") == (0, False)  # which are of 90 degrees


def test_what_a_setting_asks_of_the_scene_is_read(shot):
    for name in ("what rests", "style", "name of a style"):
        assert found(shot, name)[0] == 1, name


@pytest.mark.parametrize("name", ["flat tones", "flat tones at once"])
def test_layers_that_a_setting_asks_for_are_drawn(shot, name):
    assert found(shot, name)[1]


def test_a_study_takes_the_window_and_gives_it_back(shot):
    assert shot.facts["study"][0] == [["PENCIL", "PLAIN"], 1]
    assert shot.facts["after it"][0] == ["View", "RENDERED", []]


@pytest.mark.parametrize("name", ["look of a view", "plain look"])
def test_a_view_may_have_a_look_of_its_own(shot, name):
    assert found(shot, name)[1]


@pytest.mark.parametrize("name", ["lines in mirrors", "smaller at rest"])
def test_layers_are_drawn_anew_that_others_were_drawn_for(shot, name):
    assert found(shot, name)[1]


def test_frames_are_drawn_where_pens_draw_anew(shot):
    """And only there: a still scene is not drawn again while it plays."""
    assert [found(shot, name)[1] for name in ("still", "still, held", "still, drawn anew")] == [False, False, True]


@pytest.mark.parametrize("name", ["hidden", "there again", "world", "film", "moved", "indirect only", "direct",
                                  "excluded", "override", "exposure", "no surfaces", "hidden alone", "driver",
                                  "handler", "frame", "image loaded anew", "image of another file",
                                  "image's pixels", "image's pixels again", "sky loaded anew", "sky of another file",
                                  "sky's pixels"])
def test_what_changes_beside_a_setting_is_seen(shot, name):
    reads, another = found(shot, name)
    assert reads >= 1 and another
