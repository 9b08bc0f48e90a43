# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines that close up: a chequered floor to the horizon, a wall of bricks that leads away and a railing before them."""

import numpy as np
from encre.pen.job import Camera, Frame

CAMERA = Camera((1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0), distance=4.0)
NOTHING, HORIZON, FINE = 1e10, 0.45, 4  # per axis and pixel, samples of what is averaged
PART = 0.33, 0.24, 0.5, 0.44  # left, top, width and height of what is drawn, in heights of the frame


def crowded(lines):
    """(layers, Frame) of a part of a frame of so many lines, about the middle."""
    left, top, width, height = (round(lines * share) for share in PART)
    frame = Frame(lines * 4 // 3, lines, left, top)
    y, x = np.mgrid[top:top + height, left:left + width].astype(float)
    centre = _trace(x, y, lines)
    soft = {name: 0 for name in ("color", "normal", "light", "alpha")}
    for dy in (np.arange(FINE) + 0.5) / FINE - 0.5:
        for dx in (np.arange(FINE) + 0.5) / FINE - 0.5:
            sample = _trace(x + dx, y + dy, lines)
            soft = {name: soft[name] + sample[name] / FINE**2 for name in soft}
    layers = dict(combined=np.concatenate([soft["color"] * soft["light"], soft["alpha"]], -1), color=soft["color"],
                  diffuse=np.repeat(soft["light"], 3, -1), normal=soft["normal"], depth=centre["depth"],
                  object=centre["object"])
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, frame


def _trace(x, y, lines):
    """What is seen at places of the frame; each thing covers what lies behind it."""
    u, v = (x + 0.5) / lines - 2 / 3, HORIZON - (y + 0.5) / lines
    depth, number = np.full(u.shape, NOTHING), np.zeros(u.shape)
    color, normal, light = np.zeros((*u.shape, 3)), np.zeros((*u.shape, 3)), np.zeros(u.shape)

    def put(where, z, own, facing, lit, colors):
        shown = where & (z < depth)
        depth[shown], number[shown], light[shown], normal[shown] = z[shown], own, lit, facing
        color[shown] = colors[shown]

    z = 0.5 / np.maximum(-v, 1e-3)
    odd = (np.floor(u * z / 0.35) + np.floor(z / 0.35)) % 2
    put(v < -1e-3, z, 1, (0, 1, 0), 1.0, np.where(odd[..., None] > 0, (0.75, 0.7, 0.6), (0.25, 0.3, 0.4)))
    z = 1.2 / np.maximum(u, 1e-3)
    up = v * z / 0.08
    along = z / 0.2 + 0.5 * (np.floor(up) % 2)
    joint = (up % 1 < 0.15) | (along % 1 < 0.08)
    put((u > 1e-3) & (z < 30) & (np.abs(v * z - 0.2) < 0.7), z, 2, (-1, 0, 0), 0.8,
        np.where(joint[..., None], (0.7, 0.68, 0.62), (0.5, 0.2, 0.14)))
    z = np.full(u.shape, 1.6)
    across, up = u * z, v * z
    post = (np.abs((across / 0.07) % 1 - 0.5) < 0.11) & (np.abs(up + 0.2) < 0.3)
    rail = (np.abs(up - 0.095) < 0.015) | (np.abs(up + 0.41) < 0.01)
    put((post | rail) & (np.abs(across + 0.35) < 0.57), z, 3, (0, 0, 1), 0.6,
        np.broadcast_to((0.15, 0.3, 0.2), color.shape))
    return dict(depth=depth[..., None], object=number[..., None], color=color, normal=normal, light=light[..., None],
                alpha=(depth < NOTHING)[..., None] * 1.0)
