# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes and jobs of drawn light that are refused: the sentence, and that nothing has changed."""

import numpy as np
import pytest
from encre.pen.errors import EncreError
from encre.pen.job import Frame, Lamp
from lamps import CUBE, CUBE_CORNERS, LAMPS, Stage

REFUSED = [
    (lambda s: s.geometry(1, CUBE, CUBE_CORNERS + 1), "geometry 1: triangle 2 has a corner at point 8 of 8"),
    (lambda s: s.geometry(1, CUBE, np.int32([(8, 0, 1)])), "geometry 1: triangle 0 has a corner at point 8 of 8"),
    (lambda s: s.texture(1, np.zeros((0, 4))), "texture 1: 4 x 0 texels"),
    (lambda s: s.instance(4, 99), "instance 4: shows geometry 99, which is not there"),
    (lambda s: s.geometry(0, None), "geometry 0: is shown by 1 instances"),
    (lambda s: s.lamp(2, Lamp("sun", width=4)), "lamp 2: width is 4; give 0 to 3.1416"),
    (lambda s: s.lamp(2, Lamp("point", width=-1)), "lamp 2: width is -1"),
    (lambda s: s.lamp(2, Lamp("point", height=np.inf)), "lamp 2: height is inf; give 0 to 3"),
    (lambda s: s.lamp(2, Lamp("point", (np.nan, 1, 1))), "lamp 2: its color is not finite"),
    (lambda s: s.lamp(2, Lamp("point", model=np.full((4, 4), np.inf))), "lamp 2: its model is not finite"),
    (lambda s: s.lamp(2, Lamp("spot", spot_blend=2)), "lamp 2: spot_blend is 2"),
    (lambda s: s.lamp(2, Lamp("point", light_set=64)), "lamp 2: light_set is 64; give 0 to 63"),
]


@pytest.mark.parametrize("wrong, sentence", REFUSED, ids=[s for _, s in REFUSED])
def test_what_is_wrong_is_refused(wrong, sentence):
    stage = Stage(16, 10)
    before = stage.light(LAMPS["sun"])
    with pytest.raises(EncreError, match=sentence) as e:
        wrong(stage.scene)
    assert ";" in str(e.value)
    assert (stage.light() == before).all()  # nothing has changed


def test_jobs_that_are_wrong_are_refused():
    stage = Stage(16, 10)
    depth = stage.depth()
    with pytest.raises(EncreError, match="frame: 16 x 10 pixels at 1, 0"):
        stage.light(depth=depth, frame=Frame(16, 10, 1, 0))
    with pytest.raises(EncreError, match="normal: is 8 x 10 pixels where 16 x 10 are due"):
        stage.light(depth=depth, normal=np.zeros((10, 8, 3), np.float32))
    with pytest.raises(EncreError, match="world: its light is not finite"):
        stage.light(depth=depth, world=np.full((9, 3), np.inf))
    with pytest.raises(EncreError, match="camera: a matrix"):
        stage.scene.light(depth, None, np.zeros((4, 4)), stage.projection, Frame(16, 10), 0.1)
