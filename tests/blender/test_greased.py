# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines to Grease Pencil (blender/inside/greased.py): its strokes lie where the picture has ink, and only there."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def shot(render):
    return render("grease")


@pytest.mark.parametrize("source", ["ENCRE", "CYCLES"])
def test_each_pixel_of_ink_has_a_stroke_and_each_stroke_ink(shot, source):
    ink, far = shot.passes(source)["Encre Lines"][..., 3], np.load(shot.folder / f"{source}.npy")
    assert (ink > 0.5).sum() > 400
    assert (far[ink > 0.3] <= 1).mean() > 0.999
    near = np.pad(ink, 1)
    near = np.max([near[y:y + ink.shape[0], x:x + ink.shape[1]] for y in range(3) for x in range(3)], 0)
    assert (near[far <= 0] > 0.05).mean() > 0.995


def test_layers_are_kinds_and_materials_objects_with_their_ink(shot):
    facts = shot.facts
    assert facts["failed"] == [None] * 2 and facts["result"] == [["FINISHED"]] * 2
    for layers, named, materials, (kind, name, selected) in zip(
            facts["layers"], facts["named"], facts["materials"], facts["type"], strict=True):
        assert kind in ("GPENCIL", "GREASEPENCIL") and name == "Lines" and selected
        names = list(layers)
        assert names.index("Creases") < names.index("Outlines"), "outlines lie over creases"
        assert {"Ball Ink", "Cube Ink"} <= {each.split(".")[0] for each in named["Outlines"]}
        creases = [materials[name] for name in named["Creases"]]
        assert creases and np.allclose(creases, [(0, 0, 1)] * len(creases), atol=0.01)
        assert not np.any([materials[name] for name in named["Outlines"]])


def test_what_can_not_be_made_is_said_in_a_sentence(shot):
    off, none, detector, camera = shot.facts["refused"][0]
    assert "Lines: they are off" in off and "no line was drawn in this frame" in none
    assert "only Fine draws lines as strokes" in detector and "has no camera" in camera
    assert "Traceback" not in shot.output
    assert "Lines" not in shot.facts["left"][0]
