# SPDX-License-Identifier: GPL-3.0-or-later
"""What line work fills: pupils, brows and buttons, but nothing that is large."""

import pytest


@pytest.mark.parametrize("look", ["ink_only", "brush_ink", "pencil"])
def test_small_blacks_are_filled(render, look):
    shot = render("small_blacks")
    assert shot.facts["failed"] == [None] * 3
    dark = shot.passes(look)["Combined"][..., :3].max(-1) < 0.3
    dark = dark if dark[20:34, 70:90].any() else dark[::-1]

    def share(x, y, half):
        column, row = round(80 + 30 * x), round(45 - 30 * y)
        return dark[row - half:row + half, column - half:column + half].mean()

    assert share(0, 0, 2) > 0.8 and share(0, 0.6, 1) > 0.8 and share(1.9, 0, 2) > 0.8
    assert share(0, -0.8, 3) < 0.2 and share(0.21, 0, 1) < 0.2 and share(0.7, 0.2, 3) == 0
