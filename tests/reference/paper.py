# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's height under every pixel: an image, or the built-in sheet of docs/paper.md."""

from functools import cache

import numpy as np

from .metric import clamp01

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def heights(layers, params, down=0):
    """(H, W) heights 0…1 for the lines and for hatching, so many rows below; they differ only where there is no
    paper."""
    shape = layers.depth.shape
    if params["paper_source"] == "NONE":
        return np.ones(shape), np.full(shape, 0.5)
    source = params["paper_source"]
    texels = _image(params["paper_image"]) if source == "IMAGE" else sheet(params["paper_seed"], source)
    height = clamp01(0.8 + (_sample(texels, layers, params, down) - 0.8) * params["paper_roughness"])
    return height, height


def _image(image):
    if image is None:
        raise ValueError("paper_source is IMAGE, but paper_image is not set")
    image = np.nan_to_num(np.asarray(image, np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    gray = image if image.ndim == 2 else image[..., :3] @ _LUMINANCE
    return gray + 0.8 - gray.mean()


def _mix(n):
    """A bijective hash of uint32, which wraps silently in arrays."""
    n = (n ^ (n >> 16)) * np.uint32(0x7FEB352D)
    n = (n ^ (n >> 15)) * np.uint32(0x846CA68B)
    return n ^ (n >> 16)


def _wave(angle):
    """A sine of two parabolas: 2^32 is a full turn, 2^23 one texel."""
    p = angle >> 16
    q = p & 32767
    s = (q * (32768 - q)) >> 5
    return np.where(p < 32768, s, 0 - s)


def _around(image, weights):
    """Sum over the neighbours in each direction, wrapping."""
    for axis in (0, 1):
        reach = len(weights) // 2
        image = sum(w * np.roll(image, k - reach, axis) for k, w in enumerate(weights))
    return image


# of tooth of 2, 3, 5 and 9 texels, fibers, pits, lines
KINDS = {"COLD_PRESS": ((256, 64, 8, 1), 16, 12, 0), "ROUGH": ((192, 64, 16, 4), 16, 24, 0),
         "HOT_PRESS": ((320, 16, 0, 0), 56, 0, 0), "LAID": ((256, 32, 2, 0), 24, 0, 48),
         "BRISTOL": ((160, 96, 6, 1), 28, 0, 0)}


@cache
def sheet(seed, kind="COLD_PRESS"):
    """(512, 512) heights, 0.6…1."""
    weights, fibers, hollow, lines = KINDS[kind]
    key = _mix(np.array([seed + 1], np.int64).astype(np.uint32))

    def number(index):
        return _mix(index.astype(np.uint32) + key)

    ground = number(np.arange(512 * 512)).reshape(512, 512)
    pulp = np.zeros((512, 512), np.int64)
    x, y, a, c = number(262144 + np.arange(4 * 8192)).reshape(8192, 4).T
    steps = (16 + (c & 31)).astype(np.int64)
    ink = (16 + 2 * ((c >> 5) & 7)).astype(np.int64)
    turn = (((c >> 8) & 65535) - np.uint32(32768)) << 9
    bend = ((c >> 24) - np.uint32(128)) << 13
    for t in range(47):
        on = t < steps
        depth = np.minimum(np.minimum(t + 1, steps - t), 4) * ink
        np.add.at(pulp, ((y >> 23)[on], (x >> 23)[on]), depth[on])
        x, y = x + _wave(a + np.uint32(0x40000000)), y + _wave(a)
        a, turn = a + turn, turn + bend

    def pressed(tile, size):
        return _around(tile, [size - abs(k) for k in range(1 - size, size)])

    parts = [(ground >> 8 * k & 255).astype(np.int64) for k in range(4)]
    tooth = sum(weight * pressed(part, size) for weight, part, size in zip(weights, parts, (2, 3, 5, 9),
                                                                        strict=True))
    pits = np.maximum(pressed(np.roll(parts[3], (256, 256), (0, 1)), 5) - 84712, 0)
    wires = _wave(np.arange(512, dtype=np.uint32) << np.uint32(29)).astype(np.int64)
    wires = np.where(wires < 2**31, wires, wires - 2**32)[:, None]
    laid = (wires + 3 * 2**23 - 2**22 * np.maximum(4 - np.arange(512) % 128, 0)) >> 12
    felt = 2**20 + tooth + fibers * pressed(pulp, 2) + lines * laid - hollow * pits
    level = np.minimum(16383, np.maximum(0, 225 * felt + 2**28 - _around(felt, (1,) * 15)) >> 15)
    _, which, count = np.unique(level, return_inverse=True, return_counts=True)
    rank = 2 * (np.cumsum(count) - count) + count
    return 0.6 + 0.4 * rank[which].reshape(512, 512) / 524288


def _sample(texels, layers, params, down=0):
    """Bilinear and wrapping, texel centres at ½, from the top left of the full frame."""
    pixels = params["paper_scale"] * params.pixels(layers.full_height)
    height, width = layers.depth.shape
    v, u = np.meshgrid((layers.y + down + np.arange(height) + 0.5) / pixels - 0.5,
                       (layers.x + np.arange(width) + 0.5) / pixels - 0.5, indexing="ij")
    row, column = np.floor(v).astype(int), np.floor(u).astype(int)
    t, s = v - row, u - column

    def texel(dy, dx):
        return texels[(row + dy) % texels.shape[0], (column + dx) % texels.shape[1]]

    return (1 - t) * ((1 - s) * texel(0, 0) + s * texel(0, 1)) + t * ((1 - s) * texel(1, 0) + s * texel(1, 1))
