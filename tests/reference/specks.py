# SPDX-License-Identifier: GPL-3.0-or-later
"""Specks: every island of light in black, by its pixels, and what is around it."""

import numpy as np

from .metric import value

BLACK, MOST, NARROW = 0.03, 128, 0.5
CONTRAST, SAME_DEPTH, BEHIND = 0.3, 0.005, 0.001


def _about(light, y, x):
    height, width = light.shape
    return [(v, u) for v in range(y - 1, y + 2) for u in range(x - 1, x + 2) if 0 <= v < height and 0 <= u < width]


def _island(light, start, layers):
    """Its pixels, and whether it reaches a rim beyond which the frame goes on."""
    found, todo, beyond = {start}, [start], False
    height, width = light.shape
    while todo:
        y, x = todo.pop()
        beyond |= (y == 0 < layers.y or x == 0 < layers.x or y == height - 1 < layers.full_height - 1 - layers.y
                   or x == width - 1 < layers.full_width - 1 - layers.x)
        near = {at for at in _about(light, y, x) if light[at]} - found
        found |= near
        todo += near
    return sorted(found), beyond


def fill(layers, params, picture, ink=None):
    """The picture (H, W, 4) with its specks filled, and the ink of lines, if these are drawn."""
    bright = value(picture[..., :3]) + 1 - picture[..., 3]
    light, left = bright > BLACK, bright > BLACK
    lightness = np.sqrt(np.clip(layers.albedo @ (0.2126, 0.7152, 0.0722), 0, 1))
    picture, ink = picture.copy(), None if ink is None else ink.copy()
    if not np.any(params.at("use_specks", layers.style)):
        return picture, ink
    for start in map(tuple, np.argwhere(light)):
        if not left[start]:
            continue
        island, beyond = _island(light, start, layers)
        rows, columns = np.array(island).T
        left[rows, columns] = False
        if beyond:
            continue
        style = layers.style[start]
        size = params.at("speck_size", style) * params.pixels(layers.full_height)
        size *= params.at("use_specks", style)
        length = 0 if ink is not None else max(np.ptp(rows), np.ptp(columns)) + 1
        if not size or len(island) > min(max(size**2, NARROW * size * length), MOST):
            continue
        around = [at for y, x in island for at in _about(light, y, x) if not light[at]]
        if not around:
            continue
        own, ground = layers.depth[rows, columns].mean(), np.mean([layers.depth[at] for at in around])
        lighter = lightness[rows, columns].max() - np.mean([lightness[at] for at in around])
        if lighter > CONTRAST and -SAME_DEPTH * ground <= own - ground <= BEHIND * ground:
            continue
        for image in (picture, ink):
            if image is not None:
                image[rows, columns] = [*np.mean([picture[at][:3] for at in around], axis=0), 1]
    return picture, ink
