# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from all sides -> what falls on a matt surface by its normal: spherical harmonics up to order 2, which leave
out about a hundredth of it (Ramamoorthi and Hanrahan 2001)."""

import math

import numpy as np

# Of the harmonics in the order of encre_light_job.world: the factor before the polynomial, and the share of its order
# that is left in what falls.
_FACTOR = np.sqrt(np.array([1 / 4, 3 / 4, 3 / 4, 3 / 4, 15 / 4, 15 / 4, 5 / 16, 15 / 4, 15 / 16]) / np.pi)
_SHARE = np.array([1, *[2 / 3] * 3, *[1 / 4] * 5])


def polynomials(d: np.ndarray) -> np.ndarray:
    """(..., 9) of directions (..., 3) of length 1."""
    x, y, z = np.moveaxis(np.asarray(d, np.float64), -1, 0)
    return np.stack([np.ones_like(x), x, y, z, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y], -1)


def constant(color: np.ndarray) -> np.ndarray:
    """(9, 3) of light that is the same from all sides."""
    out = np.zeros((9, 3))
    out[0] = color
    return out


_RISES = math.sqrt(0.75)  # of the way to the light that planes have: 60 degrees up


def planes(light: np.ndarray, level: np.ndarray, amount: float) -> np.ndarray:
    """The (9, 3) of light whose sides are told apart as draftsmen do it, whatever it comes from: what faces up has as
    much as before, what faces the way `level` (2,), of length 1, nearly that, and what faces away or down less by up to
    the share `amount`."""
    t = np.array([*(np.asarray(level, np.float64) * math.sqrt(1 - _RISES ** 2)), _RISES])
    steep = amount / (1 + _RISES)  # light is multiplied by 1 - steep (t[2] - n t), n the normal
    a = light[1:4]
    out = (1 - steep * _RISES) * light
    out[1:4] += steep * t[:, None] * light[0]
    xx, yy, zz = t[:, None] * a
    out[0] += steep * (xx + yy + zz) / 3
    out[4] += steep * (t[0] * a[1] + t[1] * a[0])
    out[5] += steep * (t[1] * a[2] + t[2] * a[1])
    out[6] += steep * (2 * zz - xx - yy) / 6
    out[7] += steep * (t[0] * a[2] + t[2] * a[0])
    out[8] += steep * (xx - yy) / 2
    return out


def of_picture(picture: np.ndarray, rotation: np.ndarray | None = None) -> np.ndarray:
    """(9, 3) of an equirectangular picture (height, width, 3 or more), row 0 at the top, whose middle is seen towards
    +x and its upper edge towards +z; rotation (3, 3): world -> picture."""
    height, width = picture.shape[:2]
    elevation = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    turn = np.pi - 2 * np.pi * (np.arange(width) + 0.5) / width
    level, rise = _each(math.cos, elevation)[:, None], _each(math.sin, elevation)[:, None]
    direction = np.stack([level * _each(math.cos, turn), level * _each(math.sin, turn),
                          np.broadcast_to(rise, (height, width))], -1)
    if rotation is not None:
        direction = direction @ rotation  # its inverse, applied to rows
    weight = level * (2 * np.pi / width) * (2 * np.sin(np.pi / 2 / height))
    color = np.nan_to_num(picture[..., :3].astype(np.float64), posinf=0, neginf=0) * weight[..., None]
    projected = np.einsum("yxk,yxc->kc", polynomials(direction), color)
    return projected * (_FACTOR ** 2 * _SHARE)[:, None]


def _each(of, angles):
    """numpy's own, up to 1.24, have last bits that depend on where an array lies: what is the same would look new."""
    return np.array([of(angle) for angle in angles])
