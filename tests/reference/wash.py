# SPDX-License-Identifier: GPL-3.0-or-later
"""Wash: borders that stray, colour that runs, and pigment that lies unevenly on the paper."""

import numpy as np

from .metric import clamp01, mix
from .paper import _mix as hashed

BRIGHTEST, UNIT, MOST_REACH = 3.999, 16384, 128
ONE, OTHER = (0.8, 0.6), (0.28, -0.96)  # cosines and sines


def _noise(layers, params, seed, length, turn):
    """Value noise of the full frame, -1…1, on a turned lattice."""
    rows, columns = layers.depth.shape
    key = hashed(np.array([seed + params["wash_seed"] * 0x9E3779B9], np.int64).astype(np.uint32))
    y, x = np.mgrid[layers.y:layers.y + rows, layers.x:layers.x + columns] + 0.5
    cosine, sine = turn
    u, v = (a / max(length, 1.0) for a in (x * cosine + y * sine, y * cosine - x * sine))
    left, top = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)

    def at(dy, dx):
        return (hashed(hashed(key + (left + dx).astype(np.uint32)) + (top + dy).astype(np.uint32)) >> 8) / 2.0**23 - 1

    s, t = (a**3 * (a * (a * 6 - 15) + 10) for a in (u - left, v - top))
    return mix(mix(at(0, 0), at(0, 1), s), mix(at(1, 0), at(1, 1), s), t)


def _cloud(layers, params, seed, length, fine):
    return (_noise(layers, params, seed, length, ONE) * (1 - fine)
            + _noise(layers, params, seed + 77, length * 0.37, OTHER) * fine)


def _take(picture, y, x):
    """Bilinear, from the nearest pixel beyond the border."""
    rows, columns = picture.shape[:2]
    y, x = np.clip(y, 0, rows - 1), np.clip(x, 0, columns - 1)
    iy, ix = np.floor(y).astype(int), np.floor(x).astype(int)
    jy, jx = np.minimum(iy + 1, rows - 1), np.minimum(ix + 1, columns - 1)
    v, u = (y - iy)[..., None], (x - ix)[..., None]
    return mix(mix(picture[iy, ix], picture[iy, jx], u), mix(picture[jy, ix], picture[jy, jx], u), v)


def _counted(picture):
    return np.floor(np.clip(np.nan_to_num(picture), 0, BRIGHTEST) * UNIT + 0.5)


def _blurred(picture, reach):
    """A tent of `reach` pixels to all sides, of whole numbers, rounded between rows and columns; None: none."""
    if reach <= 1:
        return None
    weights = reach - np.abs(np.arange(1 - reach, reach))
    wide = np.pad(_counted(picture), [(0, 0), (reach, reach), (0, 0)], mode="edge")
    n = picture.shape[1]
    sums = sum(w * wide[:, k + 1:k + 1 + n] for k, w in enumerate(weights))
    rows = np.floor(sums / reach**2 + 0.5)
    tall = np.pad(rows, [(reach, reach), (0, 0), (0, 0)], mode="edge")
    n = picture.shape[0]
    return sum(w * tall[k + 1:k + 1 + n] for k, w in enumerate(weights)) / reach**2 / UNIT


def paint(layers, params, surface, height):
    """The surface (H, W, 4) as it is painted; height: of the paper."""
    on = params.at("use_wash", layers.style)
    if not on.any():
        return surface
    scale = params.pixels(layers.full_height)

    def amount(name):
        return np.where(on, params.at("wash_" + name, layers.style), 0.0)

    y, x = np.mgrid[:surface.shape[0], :surface.shape[1]]
    far = amount("wobble") * scale
    strayed = _take(surface, y + far * _cloud(layers, params, 2, 44 * scale, 0.3),
                    x + far * _cloud(layers, params, 1, 44 * scale, 0.3))
    strayed = np.where((far > 0)[..., None], strayed, surface)

    pool, run = (_blurred(strayed, min(int(params[name] * scale + 0.5), MOST_REACH))
                 for name in ("wash_pool_width", "wash_bleed_width"))
    size = params["wash_size"] * scale
    cloud, other = _cloud(layers, params, 3, size, 0.4), _cloud(layers, params, 4, 0.5 * size, 0.4)
    density = amount("uneven") * cloud
    if pool is not None:
        around = pool[..., :3]
        lacks = (around - np.clip(strayed[..., :3], 0, BRIGHTEST)) / (around + 0.02)
        density = density + amount("pooling") * (2 + 1.2 * other) * np.maximum(lacks, 0).max(-1)
    if params["paper_source"] != "NONE":
        density = density + amount("granulation") * (2 * clamp01(2.5 - 2.5 * height) - 1)
    out = strayed
    if run is not None:
        out = mix(strayed, run, (amount("bleed") * clamp01(0.5 + other))[..., None])

    alpha = out[..., 3:]
    share = clamp01(out[..., :3] / np.where(alpha > 0, np.maximum(alpha, 1e-6), np.inf))
    parted = (amount("pigments") * _noise(layers, params, 5, 0.7 * size, OTHER))[..., None] * np.array([-1.0, 0.0, 1.0])
    rgb = out[..., :3] * (1 - (1 - share) * np.clip(density[..., None] + parted, -1, 1))
    rgb = rgb + amount("dilution")[..., None] * np.maximum(alpha - rgb, 0)
    return np.where(on[..., None], np.concatenate([rgb, alpha], -1), surface)
