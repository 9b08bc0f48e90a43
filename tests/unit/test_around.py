# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies around a part of a frame, and how far what is drawn reaches."""

import numpy as np
import pytest
from encre.pen.around import Window, pieces
from encre.pen.settings import Settings


@pytest.mark.parametrize("inner", [(40, 30, 50, 20), (0, 0, 20, 60), (99, 0, 1, 1), (3, 70, 97, 5), (0, 0, 100, 75)])
@pytest.mark.parametrize("reach", [0, 1, 13, 500])
def test_pieces_cover_what_is_around(inner, reach):
    inner, count = Window(*inner), np.zeros((75, 100), int)
    outer = inner.grown(reach, 100, 75)
    for x, y, width, height in [*pieces(inner, outer), inner]:
        assert 0 < width <= inner.width and 0 < height <= inner.height
        count[y:y + height, x:x + width] += 1
    wanted = np.zeros_like(count)
    wanted[max(0, inner.y - reach):inner.y + inner.height + reach,
           max(0, inner.x - reach):inner.x + inner.width + reach] = 1
    assert np.array_equal(count, wanted)


def test_reach_follows_the_settings():
    off = {"use_lines": False, "use_shading": False, "use_smudging": False, "use_hatching": False}
    assert Settings(off).reach(1080) == 0
    thin, wide = ({**off, "use_lines": True, "line_thickness": t} for t in (1, 20))
    assert Settings(wide).reach(1080) - Settings(thin).reach(1080) == 38
    assert Settings(wide).reach(2160) > Settings(wide).reach(1080)
    assert Settings({**wide, "length_unit": "PIXELS"}).reach(2160) == Settings(wide).reach(1080)
    assert Settings(thin, [("Bold", {"line_thickness": 20})]).reach(1080) == Settings(wide).reach(1080)
    assert Settings({**thin, "use_smudging": True, "smudge_range": 100}).reach(1080) > 200
