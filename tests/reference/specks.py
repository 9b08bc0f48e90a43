# SPDX-License-Identifier: GPL-3.0-or-later
"""Specks: every island of light in black, by its pixels, and what is around it."""

import numpy as np

from .metric import value

BLACK, MOST, NARROW = 0.03, 128, 0.5


def _island(light, start):
    """Its pixels, or None if it reaches the rim of the frame."""
    found, todo = {start}, [start]
    height, width = light.shape
    while todo:
        y, x = todo.pop()
        if not (0 < y < height - 1 and 0 < x < width - 1):
            return None
        near = {(v, u) for v in range(y - 1, y + 2) for u in range(x - 1, x + 2) if light[v, u]} - found
        found |= near
        todo += near
    return sorted(found)


def fill(layers, params, picture, ink=None):
    """The picture (H, W, 4) with its specks filled, and the ink of lines, if these are drawn."""
    bright = value(picture[..., :3]) + 1 - picture[..., 3]
    light, left = bright > BLACK, bright > BLACK
    picture, ink = picture.copy(), None if ink is None else ink.copy()
    for start in map(tuple, np.argwhere(light)):
        if not left[start]:
            continue
        island = _island(light, start)
        if island is None:
            continue
        rows, columns = np.array(island).T
        left[rows, columns] = False
        style = layers.style[start]
        size = params.at("speck_size", style) * params.pixels(layers.full_height)
        size *= params.at("use_specks", style)
        length = 0 if ink is not None else max(np.ptp(rows), np.ptp(columns)) + 1
        if not size or len(island) > min(max(size**2, NARROW * size * length), MOST):
            continue
        around = np.mean([picture[v, u, :3] for y, x in island for v in range(y - 1, y + 2)
                          for u in range(x - 1, x + 2) if not light[v, u]], axis=0)
        for image in (picture, ink):
            if image is not None:
                image[rows, columns] = [*around, 1]
    return picture, ink
