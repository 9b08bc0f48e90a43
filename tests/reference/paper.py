# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's height under every pixel: an image, or the procedural sheet of docs/paper.md."""

import numpy as np

from .metric import clamp01

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def heights(layers, params):
    """(H, W) heights 0…1 for the lines and for hatching; they differ only where there is no paper."""
    shape = layers.depth.shape
    if params["paper_source"] == "NONE":
        return np.ones(shape), np.full(shape, 0.5)
    texels = _image(params["paper_image"])
    height = clamp01(0.8 + (_sample(texels, layers, params) - 0.8) * params["paper_roughness"])
    return height, height


def _image(image):
    if image is None:
        raise ValueError("paper_source is IMAGE, but paper_image is not set")
    image = np.nan_to_num(np.asarray(image, np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    return image if image.ndim == 2 else image[..., :3] @ _LUMINANCE


def _sample(texels, layers, params):
    """Bilinear and wrapping, texel centres at ½, from the top left of the full frame."""
    pixels = params["paper_scale"] * params.pixels(layers.full_height)
    height, width = layers.depth.shape
    v, u = np.meshgrid((layers.y + np.arange(height) + 0.5) / pixels - 0.5,
                       (layers.x + np.arange(width) + 0.5) / pixels - 0.5, indexing="ij")
    row, column = np.floor(v).astype(int), np.floor(u).astype(int)
    t, s = v - row, u - column

    def texel(dy, dx):
        return texels[(row + dy) % texels.shape[0], (column + dx) % texels.shape[1]]

    return (1 - t) * ((1 - s) * texel(0, 0) + s * texel(0, 1)) + t * ((1 - s) * texel(1, 0) + s * texel(1, 1))
