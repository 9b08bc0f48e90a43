# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours: sRGB and linear light, what painted greys say, pictures of half the size."""

import numpy as np


def encode_srgb(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, 0…1 in and out; what lies outside is clipped."""
    return _encoded(np.clip(linear, 0, 1))


def _encoded(x):
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(np.maximum(x, 0), 1 / 2.4) - 0.055)


def decode_srgb(encoded: np.ndarray) -> np.ndarray:
    """Its inverse."""
    return np.where(encoded <= 0.04045, encoded / 12.92, np.power((np.maximum(encoded, 0) + 0.055) / 1.055, 2.4))


def control_values(linear: np.ndarray) -> np.ndarray:
    """Control values of scene-linear colours (n, 3 or more): -1 black ... 0 mid grey ... 1 white."""
    grey = np.asarray(linear, np.float64)[:, :3] @ (0.2126, 0.7152, 0.0722)
    value = 2 * _encoded(grey) - 1
    return np.where(np.abs(value) < 1 / 128, 0, value).astype(np.float32)  # 8-bit mid grey is neutral


def halved(pixels: np.ndarray, linear: bool) -> np.ndarray:
    """The next mip level (H // 2, W // 2, at least 1): each texel the mean, in linear light, of those it covers."""
    colors, alpha = pixels[..., :3], pixels[..., 3:]
    light = colors if linear else decode_srgb(colors)
    light, alpha = _halved(_halved(light, 0), 1), _halved(_halved(alpha, 0), 1)
    return np.concatenate([light if linear else encode_srgb(light), alpha], 2, dtype=np.float32)


def _halved(a, axis):
    a = np.moveaxis(a, axis, 0)
    n, half = len(a), len(a) // 2
    if n == 1:
        out = a
    elif n == 2 * half:
        out = (a[::2] + a[1::2]) / 2
    else:  # each covers two and a share of a third: on the left first, then on the right
        k = np.arange(half).reshape(-1, *[1] * (a.ndim - 1))
        out = (a[:-1:2] * (half - k) + a[1::2] * half + a[2::2] * (k + 1)) / n
    return np.moveaxis(out, 0, axis)
