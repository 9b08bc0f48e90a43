# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender with a window: panels, real brush strokes, F12, the viewport (blender/window.py does the clicking)."""

from pathlib import Path

import blenders
import OpenImageIO as oiio
import pytest

pytestmark = pytest.mark.slow

WINDOW = Path(__file__).parents[1] / "blender" / "inside" / "window.py"


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("window")
    return blenders.window(WINDOW, "window", folder, (1200, 800), "--enable-event-simulate",
                           BLENDER_USER_CONFIG=str(folder / "config"))


def read(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]


def fact(shot, name):
    return shot.facts[name][0]


def test_no_panel_fails_to_draw(shot):
    assert fact(shot, "finished")
    assert "Traceback" not in shot.output and "rna_uiItem" not in shot.output, shot.output[-3000:]


def test_every_row_has_its_place(shot):
    assert fact(shot, "nowhere") == [] and fact(shot, "twice") == 0
    assert {f"ENCRE_PT_{id_}" for id_ in (
        "encre", "lines", "pens", "shade", "rim", "tones", "colors", "paper", "layers",
                                          "detectors", "styles")} <= set(fact(shot, "panels"))


def test_lists_show_pens_and_tones_and_names_are_undone(shot):
    assert fact(shot, "listed") == {"pens": [0, 1, 2], "tones": [0, 1, 2]}
    assert shot.facts["pen"] == ["Pen 1", "Sketch", "Pen 1", "Sketch"]


def test_encres_panel_stands_under_the_engines_row(shot):
    assert fact(shot, "drawn") == ["RENDER_PT_context", "ENCRE_PT_encre", "CYCLES_RENDER_PT_sampling"]


def test_a_scene_for_which_encre_is_chosen_first_begins_with_a_fast_look(shot):
    assert fact(shot, "first look") == ["cel", "ENCRE"]


def test_encres_view_offers_no_light_that_only_cycles_has(shot):
    assert fact(shot, "pop-over") == [[], ["lighting", "render_pass"]]


def test_a_style_is_made_for_what_is_selected_and_changed_there(shot):
    assert fact(shot, "styled") == ["Cube", "Cube", "", ["ink_color"], 1]


def test_cycles_panels_and_nodes_are_there(shot):
    assert fact(shot, "cycles panels") > 100
    assert fact(shot, "cycles panels without Encre") == []
    assert fact(shot, "shown with Cycles") > 50 and fact(shot, "not with Encre") == []
    assert fact(shot, "shader nodes")


def test_panels_speak_the_languages_of_blender(shot):
    english = ["Hatching", "Lines", "Add Style", "Color of the ink"]
    assert shot.facts["language"] == [
        ["de", "Schraffur", "Linien", "Stil hinzufügen", "Farbe der Tinte"],
        ["fr", "Hachures", "Lignes", "Ajouter un style", "Couleur de l’encre"], ["en", *english]]


def test_operators(shot):
    assert fact(shot, "thickness") == 4  # Ink only
    assert fact(shot, "levels") == 4
    assert fact(shot, "mark") == ["FINISHED"]
    assert fact(shot, "view transform") in ("Filmic", "AgX") and fact(shot, "new view transform") == "Standard"


def test_brush_strokes_paint_the_control(shot):
    assert fact(shot, "mode") == "VERTEX_PAINT"
    assert fact(shot, "neutral") == [128, 128]
    painted, neutral, corners = fact(shot, "painted")
    assert painted > 100 and neutral > corners / 3


def test_f12_draws_the_stroke(shot):
    """Painted white, the cube's left contour is several times as wide as its right one."""
    picture = read(shot.folder / "f12.png").max(-1)
    black = (picture < 0.05).sum(0)
    half = picture.shape[1] // 2
    assert black[:half].sum() > 500 and black[half + 40:].sum() < 200


def test_viewport_shows_the_scene(shot):
    picture = read(shot.folder / "viewport.png")
    view = picture[200:800, 200:900].mean(-1)
    assert (view > view.min() + 0.2).mean() > 0.005
