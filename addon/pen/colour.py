# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours: sRGB and linear light, what painted greys say, pictures of half the size."""

from collections.abc import Sequence

import numpy as np

LUMINANCE = (0.2126, 0.7152, 0.0722)  # of red, green and blue, linear, with sRGB's primaries


def encode_srgb(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, 0…1 in and out; what lies outside is clipped."""
    return _encoded(np.clip(linear, 0, 1))


def _encoded(x):
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(np.maximum(x, 0), 1 / 2.4) - 0.055)


def decode_srgb(encoded: np.ndarray) -> np.ndarray:
    """Its inverse."""
    return np.where(encoded <= 0.04045, encoded / 12.92, np.power((np.maximum(encoded, 0) + 0.055) / 1.055, 2.4))


# Chromaticities of red, green, blue and white of the spaces that files name by a colorInteropID.
INTEROP = "colorInteropID"
_SPACES = {
    "lin_rec709_scene": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.3290)),
    "lin_rec2020_scene": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), (0.3127, 0.3290)),
    "lin_ap1_scene": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), (0.32168, 0.33767)),  # ACEScg
}
_BRADFORD = np.array(((0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)))


def to_rec709(interop: str) -> np.ndarray | None:
    """The matrix from a linear space to linear Rec. 709; None: they are the same, or it is not known."""
    if interop not in _SPACES or interop == "lin_rec709_scene":
        return None
    there, here = _to_cones(_SPACES[interop]), _to_cones(_SPACES["lin_rec709_scene"])
    return np.linalg.inv(here) @ there


def from_rec709(color: Sequence[float], space: str) -> tuple[float, ...]:
    """A linear Rec. 709 colour in a linear space, by its colorInteropID; as it is where that is not known."""
    matrix = to_rec709(space)
    if matrix is None:
        return tuple(color)
    return tuple(float(c) for c in np.maximum(np.linalg.solve(matrix, np.asarray(color, np.float64)), 0))


def _to_cones(space):
    """Linear colours of a space -> responses of Bradford's cones, of which its white has one each."""
    xyz = np.array([(x / y, 1, (1 - x - y) / y) for x, y in space]).T
    primaries, white = xyz[:, :3], xyz[:, 3]
    rgb_to_xyz = primaries * np.linalg.solve(primaries, white)
    return (_BRADFORD @ rgb_to_xyz) / (_BRADFORD @ white)[:, None]


def control_values(linear: np.ndarray) -> np.ndarray:
    """Control values of scene-linear colours (n, 3 or more): -1 black ... 0 mid grey ... 1 white."""
    grey = np.asarray(linear, np.float64)[:, :3] @ LUMINANCE
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
