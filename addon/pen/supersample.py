# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of n times the frame's size: put together from sub-frames and windows, averaged down."""

import numpy as np

from . import layers, samples, saved
from .around import Window
from .job import Frame

# What can't be averaged: numbers of things, and places, where the mean of near and far is neither.
_ONE_SAMPLE = {"Depth", "Denoising Depth", "IndexOB", "IndexMA", "Position", "UV", "Vector", "Encre Index",
               "Encre Seen Depth", "Encre Tangent", "Encre Card"}
_ANCHOR_PIXEL = 3  # channel of Encre Anchor Normal: the size of a pixel


def frame(place: Frame, factor: int) -> Frame:
    """The Frame of the large picture."""
    return Frame(factor * place.width, factor * place.height, factor * place.x, factor * place.y, place.number)


def shrink(name: str, picture: np.ndarray, factor: int) -> np.ndarray:
    """The pass `name` (classic or not) of the frame's size: the mean of each factor x factor pixels, or one of them; of
    factor 1 the picture itself."""
    if factor == 1:
        return picture
    if name in saved.ANCHOR:
        return _anchor(name, picture[factor // 2::factor, factor // 2::factor].copy(), factor)
    if name == "Encre Card":
        return picture[factor // 2::factor, factor // 2::factor] * np.array((1, 1, factor, factor), np.float32)
    if _one_sample(name):
        return picture[factor // 2::factor, factor // 2::factor].copy()  # or the large one would stay
    return samples.average(picture, factor)


def _one_sample(name):
    return (layers.classic(name) in _ONE_SAMPLE or name in saved.control_passes()
            or name.startswith(("Crypto", "Debug")))


def _anchor(name, picture, factor):
    """One sample; what is told per pixel grows with it."""
    if name in ("Encre Anchor X", "Encre Anchor Y"):
        picture *= np.float32(factor)
    elif name == "Encre Anchor Normal":
        picture[..., _ANCHOR_PIXEL] *= np.float32(factor)
    return picture


class Gathered:
    """The passes of one view, from its sub-frames: in `large` those that the stages read, of the large picture's
    size, in `small` all others, of the frame's; both by their names in this Blender, row 0 at the top."""

    def __init__(self, factor: int, place: Window) -> None:
        """place: the part of the frame that is gathered."""
        self.factor, self.place = factor, place
        self.large: dict[str, np.ndarray] = {}
        self.small: dict[str, np.ndarray] = {}

    def take(self, name: str, picture: np.ndarray, column: int, row: int, window: Window, own: bool) -> None:
        """Adds what a sub-frame has of the pass `name` in a window; own: whether it is the one that is saved."""
        factor, channels = self.factor, picture.shape[2]
        if layers.classic(name) in {**layers.CYCLES, **layers.BEHIND, **layers.SEEN}:
            if name not in self.large:
                size = factor * self.place.height, factor * self.place.width, channels
                self.large[name] = np.empty(size, np.float32)
            y, x = factor * (window.y - self.place.y), factor * (window.x - self.place.x)
            part = self.large[name][y:y + factor * window.height, x:x + factor * window.width]
            part[row::factor, column::factor] = picture
        elif not own:
            return
        elif not _one_sample(name):
            self.small[name] = self.small.get(name, np.float32(0)) + picture * np.float32(1 / factor ** 2)
        elif row == column == factor // 2:
            self.small[name] = picture
