# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen of a world where nothing is in front of it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .job import Frame
from .suns import Sun


@dataclass
class Sky:
    """The sum of a colour (3,) and of equirectangular pictures: (height, width, 3), row 0 at the top, whose middle is
    seen towards +x and its upper edge towards +z, each with the rotation world -> picture. suns: what shines in it and
    is in no picture."""

    color: np.ndarray = field(default_factory=lambda: np.zeros(3))
    pictures: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    suns: tuple[Sun, ...] = ()

    @property
    def even(self) -> bool:
        """Whether it has one color all around."""
        return not self.pictures

    def __add__(self, other: Sky) -> Sky:
        return Sky(self.color + other.color, self.pictures + other.pictures, self.suns + other.suns)

    def __mul__(self, factor: float) -> Sky:
        if factor == 1:
            return self
        return Sky(self.color * factor, tuple((pixels * np.float32(factor), turn) for pixels, turn in self.pictures),
                   tuple(sun * factor for sun in self.suns))

    def seen(self, view: np.ndarray, projection: np.ndarray, frame: Frame, pixels: np.ndarray,
             width: int) -> np.ndarray:
        """(n, 3) at flat numbers of pixels of a picture of this width, of which `frame` tells the place."""
        if not self.pictures:
            return self.towards(np.empty((len(pixels), 3)))
        return self.towards(directions(view, projection, frame, pixels, width))

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """(n, 3) in directions (n, 3) of length 1, world space."""
        out = np.broadcast_to(self.color.astype(np.float32), direction.shape).copy()
        for picture, turn in self.pictures:
            out += looked_up(picture, direction @ turn.T)
        return out


def directions(view: np.ndarray, projection: np.ndarray, frame: Frame, pixels: np.ndarray, width: int) -> np.ndarray:
    """In which pixels are seen, (n, 3) of length 1, world space; by an orthographic camera all in the same."""
    row, column = np.divmod(pixels, width)
    x = (2 * (column + frame.x + 0.5) / frame.width - 1 + projection[0, 2]) / projection[0, 0]
    y = (1 - 2 * (row + frame.y + 0.5) / frame.height + projection[1, 2]) / projection[1, 1]
    if projection[3, 3] == 1:
        x, y = np.zeros_like(x), np.zeros_like(y)
    ray = np.stack([x, y, np.full_like(x, -1)], 1)
    return (ray / np.linalg.norm(ray, axis=1, keepdims=True)) @ view[:3, :3]


def places(direction: np.ndarray, height: int, width: int) -> tuple[tuple, tuple, np.ndarray]:
    """Where directions (n, 3) of length 1 lie in an equirectangular picture: (two rows, two columns) of the texels
    about them, (down, right) between these from 0 to 1, and the cosine of how high they are. Round the horizon it
    closes."""
    level = np.hypot(direction[:, 0], direction[:, 1])
    x = (0.5 - np.arctan2(direction[:, 1], direction[:, 0]) / (2 * np.pi)) * width - 0.5
    y = np.arccos(np.clip(direction[:, 2], -1, 1)) / np.pi * height - 0.5
    left, top = np.floor(x), np.clip(np.floor(y), 0, height - 1)
    columns = tuple((left + k).astype(np.intp) % width for k in (0, 1))
    rows = tuple(np.minimum(top + k, height - 1).astype(np.intp) for k in (0, 1))
    return (rows, columns), (np.clip(y - top, 0, 1).astype(np.float32), (x - left).astype(np.float32)), level


def looked_up(picture: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """(n, 3) of an equirectangular picture in directions (n, 3) of length 1: between the four nearest texels."""
    (rows, columns), (down, right), _ = places(direction, *picture.shape[:2])
    down, right = down[:, None], right[:, None]
    upper, lower = (picture[row, columns[0]] * (1 - right) + picture[row, columns[1]] * right for row in rows)
    return upper * (1 - down) + lower * down
