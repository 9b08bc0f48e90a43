# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheet under the picture: its slopes in light from the upper left, and its color."""

import numpy as np

from . import paper
from .metric import mix


def shine(layers, params, surface):
    """The surface (H, W, 4) with what is seen of the sheet."""
    height, below = (paper.heights(layers, params, down)[0] for down in (0, 1))
    right = np.concatenate([height[:, 1:], height[:, -1:]], 1)
    slope = ((right - height) + (below - height)) / 2
    lit = np.clip(1 + params["paper_relief"] * slope, 0, 2)[..., None]
    under, color, alpha = params["paper_under"], np.array(params["paper_under_color"]), surface[..., 3:]
    bare = (1 - alpha) * under
    rgb = (surface[..., :3] * mix(1.0, color, under) + bare * color) * lit
    on = params.at("use_relief", layers.style)[..., None] > 0
    return np.where(on, np.concatenate([rgb, alpha + bare], -1), surface)
