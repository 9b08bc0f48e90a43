# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a sky as a drawn backdrop: few flat shapes with smooth borders, fixed to the world."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from . import library, suns
from .job import Frame, Picture
from .sky import Sky, directions, places

_ROWS = 256  # of the picture in which shapes are found: details of less than about a degree go
_BAND = 64   # rows of a picture whose ways to look are held at once
_NEAR = 2    # texels about a mixed one in which the shapes are sought that it may belong to
_WEIGHTS = 0.054, 0.244, 0.404, 0.244, 0.054  # along rows and columns: corners are rounded
_WHOLE = 0.9  # share of a shape at all four texels about a place, from which on there is no border


@dataclass
class Backdrop:
    """palette (n, 3), scene-linear; shares (n, rows, columns): how much of what is about a texel of an equirectangular
    picture each color's shapes are. Borders run where two are as large, as sharp as the frame's pixels."""

    palette: np.ndarray
    shares: np.ndarray
    even: ClassVar[bool] = False  # as Sky.even

    @cached_property
    def most(self) -> np.ndarray:
        """(rows, columns): the color of which there is most."""
        return self.shares.argmax(0).astype(np.uint8)

    def seen(self, view: np.ndarray, projection: np.ndarray, frame: Frame, pixels: np.ndarray,
             width: int) -> np.ndarray:
        """As Sky.seen()."""
        way = directions(view, projection, frame, pixels, width)
        texel = np.pi / self.shares.shape[1]
        pixel = 2 / (projection[1, 1] * frame.height)  # an angle; by an orthographic camera nothing changes
        (row, column), (down, right), level = places(way, *self.shares.shape[1:])
        corners = [(row[k], column[j]) for k in (0, 1) for j in (0, 1)]
        own = self.most[corners[0]]
        whole = np.ones(len(way), bool)
        for corner in corners:
            whole &= (self.most[corner] == own) & (self.shares[own, corner[0], corner[1]] > _WHOLE)
        out = self.palette[own]
        some = np.flatnonzero(~whole)
        shares = [self.shares[:, a[some], b[some]] for a, b in corners]
        out[some] = self._mixed(shares, down[some], right[some], np.maximum(level[some], 1e-3), pixel / texel)
        return out

    def _mixed(self, corners, down, right, level, pixel):
        """Of two colors each: where as much of both is there, half; a pixel further of one alone. level: the cosine of
        how high it is; pixel: in texels."""
        if len(self.palette) == 1:
            return self.palette[np.zeros(len(down), int)]
        upper, lower = (one * (1 - right) + other * right for one, other in (corners[:2], corners[2:]))
        shares, every = upper * (1 - down) + lower * down, np.arange(len(down))
        second, first = np.argpartition(shares, -2, 0)[-2:]
        more = [corner[first, every] - corner[second, every] for corner in corners]
        across = (more[1] - more[0]) * (1 - down) + (more[3] - more[2]) * down
        along = (more[2] - more[0]) * (1 - right) + (more[3] - more[1]) * right
        slope = np.hypot(across / level, along) * np.float32(pixel)
        share = np.clip(0.5 + (shares[first, every] - shares[second, every]) / np.maximum(slope, 1e-6), 0, 1)[:, None]
        return self.palette[first] * share + self.palette[second] * (1 - share)


class Once:
    """A sky of one picture, each pixel of which is looked up once."""

    def __init__(self, sky: Sky | Backdrop) -> None:
        self.sky, self.known, self.found = sky, np.zeros(0, bool), np.zeros((0, 3), np.float32)

    def seen(self, view: np.ndarray, projection: np.ndarray, frame: Frame, pixels: np.ndarray,
             width: int) -> np.ndarray:
        """As Sky.seen()."""
        if not self.known.size:
            self.known = np.zeros(frame.width * frame.height, bool)
            self.found = np.zeros((self.known.size, 3), np.float32)
        new = pixels[~self.known[pixels]]
        self.found[new], self.known[new] = self.sky.seen(view, projection, frame, new, width), True
        return self.found[pixels]


def put_behind(sky: Sky | Backdrop | Once, layers: dict[str, np.ndarray], view: np.ndarray, projection: np.ndarray,
               frame: Frame) -> np.ndarray:
    """Shows a sky in the layers of a picture wherever its film is transparent, as if it were in front of no world;
    what of it is seen (height, width, 3). view, projection, frame: as Sky.seen() takes them."""
    height, width, _ = layers["combined"].shape
    combined = layers["combined"] = np.array(layers["combined"], order="C")
    shown = np.zeros((height, width, 3), np.float32)
    for row in range(0, height, _BAND):
        clear = np.clip(1 - combined[row:row + _BAND, :, 3].ravel(), 0, 1)
        there = np.flatnonzero(clear)
        shown[row:row + _BAND].reshape(-1, 3)[there] = clear[there, None] * sky.seen(
            view, projection, frame, row * width + there, width)
    combined[..., :3] += shown
    combined[..., 3] = 1
    if "background" in layers:
        layers["background"] = shown
    return shown


class Backdrops:
    """The latest Backdrop, which is not made again as long as the sky is the same."""

    def __init__(self):
        self._latest: tuple[bytes, Backdrop] | None = None  # digest

    def of(self, sky: Sky, most: int) -> Sky | Backdrop:
        """What is seen of a sky in `most` colors; of one without pictures itself."""
        if not sky.pictures:
            return sky
        colors = _gridded(sky)
        digest = hashlib.sha1(colors.tobytes() + bytes([most])).digest()
        if self._latest is None or self._latest[0] != digest:
            self._latest = digest, _flat(colors, most)
        return self._latest[1]


def _gridded(sky):
    """(_ROWS, 2 _ROWS, 3): what is seen all around."""
    less = Sky(sky.color, tuple((suns.shrunk(picture, _ROWS), turn) for picture, turn in sky.pictures))
    return less.towards(suns.ways(_ROWS, 2 * _ROWS).reshape(-1, 3)).reshape(_ROWS, 2 * _ROWS, 3)


def _flat(colors, most):
    """The Backdrop of `most` colors of an equirectangular picture."""
    height, width = colors.shape[:2]
    texels = np.ones((height * width, 4), np.float32)
    bounded = np.maximum(colors, 0)
    bounded = bounded / (1 + bounded)  # a sky has no brightest color, and shapes are told apart by colors below 1
    texels[:, :3] = bounded.reshape(-1, 3)
    library.load().flatten(Picture(texels, width, height, 1, wrap="repeat"), most)
    palette, shape = _shapes(texels[:, :3].reshape(height, width, 3))
    shares = np.stack([_evened(shape == number) for number in range(len(palette))])
    return Backdrop(palette / np.maximum(1 - palette, 1e-3), shares)


def _around(a, dy, dx):
    """`a` moved by rows, the first and last again, and by columns, all around."""
    rows = np.clip(np.arange(len(a)) + dy, 0, len(a) - 1)
    return np.roll(a[rows], -dx, 1)


def _evened(there):
    share = there.astype(np.float32)
    for dy, dx in (1, 0), (0, 1):
        parts = [np.float32(weight) * _around(share, k * dy, k * dx)
                 for k, weight in zip(range(-2, 3), _WEIGHTS, strict=True)]
        share = np.sum(parts, 0, np.float32)
    return share


def _shapes(texels):
    """(palette (n, 3), (height, width) of its numbers): texels that are mixed of two colors become the likest about
    them, for a mixture may look like a third."""
    pure = np.ones(texels.shape[:2], bool)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            pure &= (np.abs(_around(texels, dy, dx) - texels) < 1e-5).all(-1)
    if not pure.any():
        pure[:] = True
    palette, own = np.unique(np.round(texels[pure], 5), axis=0, return_inverse=True)
    shape = np.full(pure.shape, -1, np.int16)
    shape[pure] = own.ravel()
    found, best = shape.copy(), np.where(pure, 0, np.inf)
    for dy in range(-_NEAR, _NEAR + 1):
        for dx in range(-_NEAR, _NEAR + 1):
            other = _around(shape, dy, dx)
            far = np.where(other < 0, np.inf, ((palette[other] - texels) ** 2).sum(-1))
            found, best = np.where(far < best, other, found), np.minimum(best, far)
    lost = found < 0
    found[lost] = ((palette - texels[lost][:, None]) ** 2).sum(-1).argmin(-1)
    return palette.astype(np.float32), found
