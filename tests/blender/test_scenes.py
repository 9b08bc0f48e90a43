# SPDX-License-Identifier: GPL-3.0-or-later
"""Every scene builds in every Blender, and gives a picture with edges in it."""

from pathlib import Path

import blenders
import exr
import numpy as np
import pytest

pytestmark = pytest.mark.slow

SCENES = [path for path in (Path(__file__).parents[2] / "scenes").glob("*.py") if "def build()" in path.read_text()]
ELSEWHERE = {"living_room", "street"}  # files of tests have them rendered, larger


@pytest.mark.parametrize("scene", [
    pytest.param(path, id=path.stem, marks=[pytest.mark.long] if path.stem in ELSEWHERE else [])
    for path in sorted(SCENES)])
@pytest.mark.parametrize("blender", blenders.params())
def test_scene_renders(blender, scene, tmp_path):
    frame = tmp_path / "frame.exr"
    words = blenders.encre(blender, tmp_path, "render", scene, "-o", frame, "--size", "64x36", "--samples", "1")
    assert "warning" not in words, words
    picture = exr.part(frame, "ViewLayer.Combined")
    assert picture.shape == (36, 64, 4) and np.isfinite(picture).all() and picture[..., :3].std() > 0.05
    # So small a frame's lines are too thin to be inked.
    assert (exr.part(frame, "ViewLayer.Encre Edges") >= 0.5).mean() > 0.05
