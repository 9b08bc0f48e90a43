# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking in Blender: the operators, and with a window their dialog, Esc and undo (blender/bake_window.py clicks)."""

from pathlib import Path

import blenders
import numpy as np
import pytest
from encre.pen import library

WINDOW = Path(__file__).parents[1] / "blender" / "inside" / "bake_window.py"


@pytest.mark.parametrize("blender", blenders.params())
def test_operators(blender, tmp_path):
    shot = blenders.run(blender, "bake_lines", tmp_path)
    facts = {name: values[0] for name, values in shot.facts.items()}
    assert facts["plain"] == facts["again"] == facts["uniform"] == facts["fit"] == ["FINISHED"]

    # Colour textures have lines, in new images that keep their kind; a normal map has none.
    names, packed, floats = zip(*facts["packed"], strict=True)
    assert [name.startswith(old) and name != old for name, old in zip(names, facts["images"], strict=True)] == [
        True, True, False, True]
    assert packed == (True, True, False, True) and floats == (False, True, False, False)
    for row, red, linear in zip(facts["red"], (0.4, 0.8), (False, True), strict=True):
        texture = np.ones((4, 64, 3), np.float32)
        texture[:, 24:40] = red, 0.2, 0.2
        want = library.bake(texture, dict(line_thickness=6.0), linear=linear).texture[0, :, 0]
        assert np.abs(np.array(row) - want).max() < (1e-3 if linear else 3e-3)
    assert facts["not twice"] == facts["red"][0] and facts["source"] == facts["images"][0]

    # Files: beside the original, which is left alone. What no UV map alone lays on is skipped with a warning.
    assert facts["original kept"] and len(facts["files"]) == 3
    assert any(name.endswith(".exr") for name in facts["files"])
    assert "Scaled: is not laid on by a UV map alone" in shot.output
    for name, metric in (("contrast", "RGB"), ("contrast, CMC", "CMC")):
        contrast = max(library.bake(np.float32([[[1, 1, 1], [red, 0.2, 0.2], [1, 1, 1]]]), {"contrast_metric": metric},
                                 linear=linear, draw=False).greatest
                       for red, linear in ((0.4, False), (0.8, True), (0.6, False)))
        assert facts[name] == pytest.approx(contrast, abs=5e-3)
    assert facts["linked"] == ["CANCELLED"] and "is shown by a linked material" in shot.output
    for sentence, words in zip(shot.facts["refused"], ("choose another folder", "shows a color image", "name one"),
                               strict=True):
        assert words in sentence and "Traceback" not in sentence
    assert "Traceback" not in shot.output


@pytest.mark.slow
def test_dialog_escape_and_undo(tmp_path):
    shot = blenders.window(WINDOW, "bake", ".", (1000, 700), "--enable-event-simulate", cwd=tmp_path)
    facts = {name: values[0] for name, values in shot.facts.items()}
    assert "Traceback" not in shot.output, shot.output[-3000:]
    names = [f"Image {k}" for k in range(6)]
    assert facts["cancelled"] == names and not facts["left over"]
    assert facts["baked"] == [f"{name} lines" for name in names]
    assert facts["undone"] == names
