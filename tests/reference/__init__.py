# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages in slow, obvious float64, and where float32 may decide otherwise.

In: layers, parameters, camera and frame, as encre_render() takes them. Out: the pictures that it should give, and masks
of pixels where rounding may decide (a threshold, a tie), which tests leave out.

frame runs the stages; edges, shade, smudge, hatch, paper and lines are one each, raster and bake the other
functions of the library. fine is the detector FINE: sites its first half, chains its second, seen what it does in
mirrors. params has defaults and scopes of its own, metric the colour differences; grid and near are windows and
neighbours.

To add: a stage's twin is written from the formulas of docs/stages.md without a look at its C, whole arrays at a time,
with no trick for speed; frame calls it, and tests/stages compares.
"""

from kept import kept

from .edges import SOURCES
from .frame import CONTROLS
from .frame import render as _render
from .params import DEFAULTS, ENGINE, is_surface

render = kept(_render)

__all__ = ["CONTROLS", "DEFAULTS", "ENGINE", "SOURCES", "is_surface", "render"]
