# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that a window starts, on a thread of their own (blender/inside/render_window.py presses the keys)."""

import shutil
import subprocess
from pathlib import Path

import blenders
import OpenImageIO as oiio
import pytest

WINDOW = Path(__file__).parent / "inside" / "render_window.py"


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    if not shutil.which("blender") or not shutil.which("xvfb-run"):
        pytest.skip("needs the programs blender and xvfb-run")
    folder = tmp_path_factory.mktemp("window")
    command = ["xvfb-run", "-a", "-s", "-screen 0 800x600x24", "blender", "--factory-startup",
               "--enable-event-simulate", "-p", "0", "0", "800", "600", "-P", str(WINDOW), "--", "render", str(folder)]
    return blenders.read(subprocess.run(command, capture_output=True, text=True, timeout=400, errors="replace"), folder)


def read(shot, name):
    return oiio.ImageBuf(str(shot.folder / f"{name}.png")).get_pixels(oiio.FLOAT)[..., :3]


def test_progress_is_seen(shot):
    times, while_rendering = shot.facts["drawn"][0]
    assert times > 2 and while_rendering


def test_papers_are_loaded_on_the_main_thread(shot):
    assert shot.facts["finished"] and "Traceback" not in shot.output
    assert shot.facts["paper on main thread"] == [True]
    assert (read(shot, "paper").max(-1) < 0.1).sum() > 100
