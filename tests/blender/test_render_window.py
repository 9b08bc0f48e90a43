# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that a window starts, on a thread of their own (blender/inside/*_window.py press the keys)."""

import ctypes.util
import importlib.util
import os
import shutil
import subprocess
from pathlib import Path

import blenders
import numpy as np
import OpenImageIO as oiio
import pytest

pytestmark = pytest.mark.slow

INSIDE = Path(__file__).parent / "inside"
DENOISER = "libOpenImageDenoise.so.2"


def drive(script, folder, *options, **environment):
    return blenders.window(INSIDE / script, "render", folder, (800, 600), *options, **environment)


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    """With the denoiser of the module bpy, if there is one, and the threads that it was made for."""
    folder, environment = tmp_path_factory.mktemp("window"), {}
    module = shutil.which("blender") and importlib.util.find_spec("bpy")
    libraries = module and Path(module.origin).parent / "lib"
    if libraries and (libraries / DENOISER).exists() and (libraries / "libtbb.so.12").exists():
        beside = tmp_path_factory.mktemp("threads")
        (beside / "libtbb.so.12").symlink_to(libraries / "libtbb.so.12")
        environment = {"ENCRE_OIDN": str(libraries / DENOISER), "LD_LIBRARY_PATH": str(beside)}
        if subprocess.run(["blender", "--version"], capture_output=True, env={**os.environ, **environment}).returncode:
            environment = {}  # a Blender that needs threads of its own
    return drive("render_window.py", folder, "--enable-event-simulate", **environment)


@pytest.fixture(scope="module")
def esc(tmp_path_factory):
    return real_keys("esc_window.py", tmp_path_factory.mktemp("esc"))


@pytest.fixture(scope="module")
def beside(tmp_path_factory):
    return real_keys("beside_window.py", tmp_path_factory.mktemp("beside"))


def real_keys(script, folder, **environment):
    if not ctypes.util.find_library("Xtst"):
        pytest.skip("needs libXtst")
    return drive(script, folder, **environment)


@pytest.fixture(scope="module")
def redraw(tmp_path_factory):
    return drive("redraw_window.py", tmp_path_factory.mktemp("redraw"), "--enable-event-simulate")


def read(shot, name):
    return oiio.ImageBuf(str(shot.folder / f"{name}.png")).get_pixels(oiio.FLOAT)[..., :3]


def test_ink_is_seen_while_the_picture_grows(shot):
    """And what Cycles shows without ink: that it has drawn three times is what the window waits for."""
    assert set(shot.facts["still growing"]) == {True} and shot.facts["persistent"] == [False]
    green = {}
    for name in ("early", "late"):
        red, bright, blue = np.moveaxis(read(shot, f"{name}-growing"), 2, 0)
        green[name] = ((bright > 0.6) & (red < 0.3) & (blue < 0.3)).sum()
    assert green["early"] > green["late"] + 400, green
    assert np.array_equal(read(shot, "early"), read(shot, "late"))


def test_the_ink_grows_with_the_samples(shot):
    """Drawn anew of more samples, and the picture in the end is what it is without."""
    assert shot.facts["late shown"] == [[0, 0]]
    for name in ("early", "shaded"):
        assert shot.facts[f"{name} shown"][0][1] >= 1, name


def test_shade_without_noise_is_seen_while_the_picture_grows(shot):
    """In the colours of the picture when it is done."""
    growing, done = (read(shot, f"shaded-{when}")[100:520, :600] for when in ("growing", "done"))  # of the editor
    assert done.std() > 0.03 and (np.abs(growing - done).max(-1) > 0.05).mean() < 0.005
    assert np.abs(growing - done).mean() < 0.002


def test_shade_that_is_cleaned_grows(shot):
    """Light of more samples is cleaned in the background, and nearer to the picture in the end than the first one's."""
    if "cleaned shown" not in shot.facts:
        pytest.skip("needs the denoiser of the module bpy")
    assert shot.facts["cleaned shown"][0][1] >= 1
    growing, done = (read(shot, f"cleaned-{when}")[100:520, :600] for when in ("growing", "done"))
    assert done.std() > 0.03 and np.abs(growing - done).mean() < 0.02


def test_papers_are_loaded_on_the_main_thread(shot):
    assert shot.facts["finished"] and "Traceback" not in shot.output
    assert shot.facts["paper on main thread"] == [True]
    assert (read(shot, "paper").max(-1) < 0.1).sum() > 100


def test_grease_pencil_comes_on_top(shot):
    def strokes(name):
        red, green, blue = np.moveaxis(read(shot, name)[..., :3], 2, 0)
        return (green > 0.3) & (red < 0.5 * green) & (blue < 0.5 * green)

    if not (shot.folder / "stroke ENCRE.png").exists():
        return  # a Blender with another Grease Pencil
    whole = strokes("stroke ENCRE")
    assert 40 < whole.sum() < 1000
    for name in "stroke CYCLES", "stroke again":  # also where the cube is behind it
        assert (strokes(name) != whole).sum() < 0.02 * whole.sum(), name


def test_esc_inks_what_is_rendered(esc):
    assert esc.facts["finished"] and "Traceback" not in esc.output
    assert esc.facts["once"][0] > 3 and (read(esc, "once").max(-1) < 0.1).sum() > 200


def test_esc_keeps_a_picture_that_grows(esc):
    """Inked, of the samples that there are: as one is that was stopped without having been shown."""
    once, growing = read(esc, "once"), read(esc, "growing")
    assert esc.facts["growing"][0] > 3 and np.abs(once - growing).mean() < 0.02
    assert ((growing.max(-1) < 0.1) == (once.max(-1) < 0.1)).mean() > 0.99


def test_a_second_esc_gives_up(esc):
    assert 0 < esc.facts["twice"][0] < esc.facts["once"][0]
    cube = read(esc, "twice").max(-1)
    assert (cube < 0.1).sum() == 0 and cube.std() > 0.05  # as Cycles left it


def test_a_setting_is_drawn_from_memory_as_f12_draws_it(redraw):
    assert redraw.facts["finished"] and "Traceback" not in redraw.output
    assert redraw.facts["redrawn"] == [True] * 6
    assert all(calls == [] for calls in redraw.facts["by Cycles"])
    for name in ("thick", "red", "flat", "off", "border", "super"):
        again, fresh = read(redraw, f"{name}-again"), read(redraw, f"{name}-fresh")
        assert np.abs(again - fresh).max() <= 1 / 255, name
        if name not in ("border", "super"):
            assert np.abs(again - read(redraw, "before")).max() > 0.2, name
        if name in ("thick", "red", "flat"):
            assert np.array_equal(read(redraw, f"{name}-back"), read(redraw, "before")), name


def test_the_button_redraws_where_nothing_does_by_itself(redraw):
    assert redraw.facts["pressed"] == [[]]
    assert np.array_equal(read(redraw, "left alone"), read(redraw, "before"))
    assert np.abs(read(redraw, "pressed") - read(redraw, "thick-fresh")).max() <= 1 / 255


def test_other_passes_and_the_compositor_go_on_from_a_redraw(redraw):
    again, fresh, before = (read(redraw, f"nodes-{when}") for when in ("again", "fresh", "before"))
    assert redraw.facts["redrawn for nodes"] == [True]
    assert np.abs(again - fresh).max() <= 1 / 255 and np.abs(again - before).max() > 0.05
    assert np.abs(fresh - read(redraw, "thick-fresh")).mean() > 0.1


def test_what_is_dragged_is_seen_at_once(redraw):
    """And is what is drawn when it rests; nothing of it stays in the file."""
    for name in ("drag", "quick_drag"):
        pictures, by_cycles, images = redraw.facts[name][0]
        assert pictures > 4 and by_cycles == [] and images == 2, name  # the result and the compositor's viewer
        assert np.abs(read(redraw, f"{name}-seen") - read(redraw, f"{name}-drawn")).max() < 3 / 255, name


def test_a_file_that_is_opened_is_drawn_anew(redraw):
    for name in ("file", "quick_file"):
        assert redraw.facts[name] == [[True, [], "RENDER_RESULT"]]
        again, fresh, thin = (read(redraw, f"{name}-{when}") for when in ("again", "fresh", "thin"))
        assert np.abs(again - fresh).max() <= 1 / 255 and np.abs(again - thin).max() > 0.2, name
        assert np.abs(read(redraw, f"{name}-hand") - thin).max() > 0.05, name
    for lacks, drawn in redraw.facts["lacks"]:  # a hand that sticks to the picture, as encre composite says too
        assert drawn and len(lacks) == 1 and "no rest positions, which save_rest=ON renders" in lacks[0]
    assert all("160 x 90" in said and "170 x 90" in said for said in redraw.facts["not opened"])


def test_a_redraw_gives_way_to_f12(redraw):
    assert redraw.facts["given way"] == [1] and "not by you" not in redraw.output.split("given way")[0]
    assert np.array_equal(read(redraw, "way"), read(redraw, "thick-fresh"))


def test_no_f12_is_lost_beside_a_redraw(beside):
    assert beside.facts["finished"] and "Traceback" not in beside.output
    assert "lost" not in beside.facts


def test_f12_renders_where_no_timer_may_begin_it(beside):
    assert beside.facts["without a timer"] == [True]


def test_a_redraw_gives_way_to_the_render_menu(beside):
    assert beside.facts["beside the menu"] == [False] and beside.facts["by menu"] == [True]


def test_a_window_lives_on_where_python_may_write_nothing(beside):
    """As Blender leaves it by chance."""
    assert beside.facts["may write"] == [False]
    assert beside.facts["redrawn"] == [True] and beside.facts["rendered"] == [True]


@pytest.mark.long
def test_no_f12_of_many_is_lost(tmp_path):
    shot = real_keys("beside_window.py", tmp_path, ENCRE_PRESSES="100")
    assert shot.facts["finished"] and "lost" not in shot.facts and shot.facts["redraws"][0] > 10


def test_layers_of_encre_are_drawn_from_memory_too(redraw):
    assert redraw.facts["quickly redrawn"] == [[True, 0]] * 2
    for name in ("quick", "quick_off"):
        again, fresh, before = (read(redraw, f"{name}-{when}") for when in ("again", "fresh", "before"))
        assert np.abs(again - fresh).max() <= 1 / 255 and np.abs(again - before).max() > 0.2, name
    assert 0 <= redraw.facts["quick bytes"][0] < 300


def test_what_the_layers_can_not_show_is_not_redrawn(redraw):
    for said, wanted in zip(redraw.facts["refused"],
                            ("frame 1", "size", "Supersample", "Object Index", "other passes", "styles", "no layers"),
                            strict=True):
        assert wanted in said
    assert redraw.facts["possible"] == [None]
    assert redraw.facts["bytes"][0] < 260 and redraw.facts["left"] == [0]


def test_a_redraw_that_is_stopped_leaves_the_picture(redraw):
    assert np.array_equal(read(redraw, "whole"), read(redraw, "stopped"))
