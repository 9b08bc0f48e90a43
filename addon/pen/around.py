# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies around a part of a frame: what is drawn at its edge depends on it. All in pixels, y from the top."""

from collections.abc import Iterator
from typing import NamedTuple

CELL = 4  # pixels each way: FINE gathers what lies in one (csrc/fine/fine.h), and a part's cells are those of the frame


class Window(NamedTuple):
    """A part of a frame."""

    x: int
    y: int
    width: int
    height: int

    def grown(self, reach: int, width: int, height: int) -> "Window":
        """With `reach` pixels more on each side, and what fills the first cells, as far as a frame of this size has
        them."""
        left, top = (max(0, start - reach) // CELL * CELL if reach else start for start in self[:2])
        right, bottom = min(width, self.x + self.width + reach), min(height, self.y + self.height + reach)
        return Window(left, top, right - left, bottom - top)


def pieces(inner: Window, outer: Window) -> Iterator[Window]:
    """What `outer` has and `inner`, which lies in it, has not: windows no wider and no higher than `inner`."""
    below, beside = inner.y + inner.height, inner.x + inner.width
    left, right = inner.x - outer.x, outer.x + outer.width - beside
    for y, height in ((outer.y, inner.y - outer.y), (below, outer.y + outer.height - below)):
        yield from _cut(Window(inner.x, y, inner.width, height), inner)
    for x, width in ((outer.x, left), (beside, right)):
        yield from _cut(Window(x, outer.y, width, outer.height), inner)


def _cut(window, most):
    for y in range(0, window.height, most.height):
        for x in range(0, window.width, most.width):
            yield Window(window.x + x, window.y + y, min(most.width, window.width - x),
                         min(most.height, window.height - y))
