# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of a picture, as library.strokes() tells them, in a plane before the camera that saw it."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from . import abi
from .job import Frame

_STEPS = 255  # of ink: what differs by less is one
_LOOP = abi.CHAIN_ENDS.index("loop")


@dataclass
class Stroke:
    """A polyline in the camera's space, which looks along -z."""

    kind: int
    object: int           # number of the object that it is of
    places: np.ndarray    # (n, 3)
    radii: np.ndarray     # (n,), in the same unit
    ink: np.ndarray       # (n, 3), scene-linear
    darkness: np.ndarray  # (n,)
    closed: bool
    tinted: bool = False  # whether its ink is not that of most strokes of its kind and object

    @property
    def own_ink(self) -> tuple[int, ...]:
        """The ink that most of it has, in steps."""
        return tuple(np.round(_STEPS * np.clip(np.median(self.ink, 0), 0, 1)).astype(int).tolist())


def strokes(points: np.ndarray, projection: np.ndarray, frame: Frame, distance: float) -> list[Stroke]:
    """Those of points (n,) of abi.STROKE_POINT, in their order, in the plane at a distance.

    projection: camera -> clip, 4 x 4, of the full frame.
    """
    weight = -distance * projection[3, 2] + projection[3, 3]  # of the clip space there
    x = (2 * (points["x"].astype(np.float64) + 0.5) / frame.width - 1) * weight
    y = (1 - 2 * (points["y"].astype(np.float64) + 0.5) / frame.height) * weight
    places = np.stack([(x + distance * projection[0, 2] - projection[0, 3]) / projection[0, 0],
                       (y + distance * projection[1, 2] - projection[1, 3]) / projection[1, 1],
                       np.full(len(points), -distance)], 1)
    # What is thinner than a pixel is drawn as wide, and so much fainter, as in the picture.
    radii = np.maximum(points["width"], 1) * weight / (frame.height * projection[1, 1])
    darkness = points["ink"][:, 3] * np.minimum(points["width"], 1)
    starts, out = np.flatnonzero(np.diff(points["stroke"], prepend=-1)), []
    for first, end in zip(starts, [*starts[1:], len(points)], strict=True):
        closed = bool(end - first > 3 and points["end"][first] == _LOOP)
        of = slice(first, end - 1 if closed else end)  # whose last point is its first
        out.append(Stroke(int(points["kind"][first]), int(points["object"][first]), places[of], radii[of],
                          points["ink"][of, :3], darkness[of], closed))
    return out


def inks(those: list[Stroke]) -> dict[tuple[int, int], tuple[float, ...]]:
    """{(kind, object): the ink that most of its strokes have}; strokes that have another one are noted as tinted."""
    known: dict[tuple[int, int], Counter] = {}
    for stroke in those:
        known.setdefault((stroke.kind, stroke.object), Counter())[stroke.own_ink] += len(stroke.places)
    most = {key: counted.most_common(1)[0][0] for key, counted in known.items()}
    for stroke in those:
        own = np.array(most[stroke.kind, stroke.object]) / _STEPS
        stroke.tinted = bool(np.abs(np.clip(stroke.ink, 0, 1) - own).max() > 1 / _STEPS)
    return {key: tuple(k / _STEPS for k in ink) for key, ink in most.items()}
