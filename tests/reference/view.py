# SPDX-License-Identifier: GPL-3.0-or-later
"""What the families of FINE's sites look at, and what a site is when it is found.

Every decision comes with a margin, which is positive where it is yes; where a margin is nearer to 0 than rounding is,
float32 may decide otherwise. Numbers along an axis: images with that axis last but for channels (turn)."""

from dataclasses import dataclass

import numpy as np

from . import edges, grid, metric
from .edges import SOURCES
from .metric import clamp01
from .params import strength as strength_of
from .passes import COLUMN, CRACKS, ROW

SEEN, SUGGESTIVE = len(SOURCES), len(SOURCES) + 1
SURE = 2e-5  # of numbers of size 1


@dataclass
class Place:
    x: float
    y: float
    strength: float
    source: int
    margin: float
    weak: bool = False
    thin: tuple = (0.0, 0.0, 0.0)
    step: tuple = (0, 0, 0)
    near: tuple = ()
    eased: float = 0.0  # 255ths of its width that it lacks
    doubtful: bool = False  # what its strength is made of is two things at once
    loose: float = 1.0  # times as far off as others it may be: by what it is divided is so little


def turn(axis, image):
    """The image with the pixels of an axis (0: of a row) last but for channels."""
    return np.swapaxes(image, 0, 1) if axis == COLUMN else image


def along(image, k):
    return grid.read(image, 0, k)


def more(a, b):
    """Positive where a > b, relative to both."""
    return (a - b) / np.maximum(np.maximum(np.abs(a), np.abs(b)), 1e-12)


def norm2(v):
    return (v**2).sum(-1)


class View:
    """Layers and parameters as the families look at them."""

    def __init__(self, layers, params, given=(), crease_angle=32.0):
        self.layers, self.params, self.given = layers, params, set(given)
        self.shape = layers.depth.shape
        self.threshold = params["edge_threshold"]
        self.bend = 2 * np.sin(np.radians(crease_angle) / 2)
        self.metric = params["contrast_metric"]
        self.weights = {k: params.at(strength_of(name), np.arange(len(params.tables)))
                        for k, name in enumerate((*SOURCES, "seen", "suggestive"))}

    def space(self, linear):
        """Colours as the metric compares them."""
        encoded = metric.encode(linear)
        return encoded if self.metric == "RGB" else metric.hsl(encoded) if self.metric == "HSL" else metric.lab(encoded)

    def difference(self, one, two):
        if self.metric == "RGB":
            return float(metric.rgb(one, two))
        if self.metric == "HSL":
            weights = [self.params[f"contrast_{part}"] for part in ("hue", "saturation", "lightness")]
            return float(metric.by_hsl(one, two, *weights))
        return float(getattr(metric, self.metric.lower())(one, two)) / 100

    def painted(self, one, two):
        """The CIEDE2000 of two colours of the metric's space, over 100."""
        lab = np.array([one, two])
        if self.metric == "HSL":
            lab = metric.rgb_of_hsl(lab)
        if self.metric in ("RGB", "HSL"):
            lab = metric.lab(clamp01(lab))
        return float(metric.ciede2000(*lab)) / 100

    def contrast(self, difference):
        least, most = self.params["contrast_threshold"], self.params["contrast_full"]
        if difference < least:
            return 0.0
        return float(clamp01((difference - least) / (most - least))) if most > least else 1.0

    def pixel(self, x, y):
        """The pixel that holds a place."""
        return tuple(np.clip(grid.round_half_up(np.array([y, x])), 0, np.array(self.shape) - 1))

    def near(self, x, y, column, row, family, axis):
        """The pixel whose controls and style a site takes: the least depth of the 5×5, of the object it bounds, which
        is the nearest of the pixels it parts, or where two touch the one whose line is painted more,
        then one that has a style."""
        z, (py, px) = self.layers.depth, self.pixel(x, y)
        height, width = self.shape
        crack = family in CRACKS
        parted = [(r, c) for r in range(row, min(row + 1 + (crack and axis != ROW), height))
                  for c in range(column, min(column + 1 + (crack and axis != COLUMN), width))]
        least = min(z[p] for p in parted)
        reach = least + 0.02 * (self.layers.height if self.layers.orthographic else least)
        painted, style = np.abs(self.layers.controls["thickness"]), self.layers.style
        bounded = min((p for p in parted if z[p] <= reach), key=lambda p: (-painted[p], not style[p], z[p], p),
                      default=parted[0])
        window = [(r, c) for r in range(max(0, py - 2), min(py + 3, height))
                  for c in range(max(0, px - 2), min(px + 3, width))]
        if family.startswith("seen"):  # it lies in the mirror, whatever stands before that
            return py, px
        its = [p for p in window if family == "thin" or self.layers.object[p] == self.layers.object[bounded]] or window
        return min(its, key=lambda p: (z[p], (p[0] - py)**2 + (p[1] - px)**2, p))

    def weigh(self, place, family, column, row, axis, strengths, style=None, apart=0.0):
        """The site with the largest of its weighted strengths {source: S}, the first of equals; by the style of where
        it takes its controls. apart: CIEDE2000 of the colours that it parts, over 100."""
        if style is None:
            style = self.layers.style[self.near(place[0], place[1], column, row, family, axis)]
        pixel, styled = self.pixel(*place), len(self.params.tables) > 1 or "controls" in self.given
        doubt = styled and bool(grid.rounds_doubtfully(np.array(place), 1e-5).any())  # another pixel's style
        best = (0.0, 0)
        every = []
        for source, strength in strengths.items():
            weight = self.weights[source][style]
            least = 0.0
            if source == SOURCES.index("color"):
                control = self.layers.controls["color_edge"][pixel]
                weight = edges.painted_weight(self.params, weight, control)
                least = edges.painted_strength(self.params, control, apart)
            every.append(max(least, weight * strength))
            if every[-1] > best[0]:
                best = (every[-1], source)
        margin = best[0] - self.threshold if self.threshold > 0 else best[0] or -1.0
        every.sort()
        close = len(every) > 1 and 0 < every[-1] - every[-2] < 1e-4
        return Place(*place, *best, margin / max(1, self.threshold), doubtful=close or doubt)


def level_of(x, steps):
    """Into how many levels the light x rises."""
    return int(sum(x > step[1] for step in steps[1:]))


def levels_apart(view, steps, one, two):
    greys = [np.full(3, clamp01(steps[level_of(x, steps)][0])) for x in (one, two)]
    return view.difference(*(view.space(grey) for grey in greys))
