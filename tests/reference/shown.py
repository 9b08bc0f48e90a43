# SPDX-License-Identifier: GPL-3.0-or-later
"""What pixels show, and which edges pass near them: for shadows.py."""

from dataclasses import dataclass

import numpy as np

from .lamps import dot

NOTHING, STRAY = -1, -2


@dataclass
class Shown:
    """Of n places: where, the normal by which light falls, how far above rays begin that graze it, the triangle's own
    normal to the eye, and its number, or NOTHING, or STRAY."""

    at: np.ndarray
    normal: np.ndarray
    lift: np.ndarray
    across: np.ndarray
    triangle: np.ndarray

    def __getitem__(self, which):
        return Shown(*(array[which] for array in vars(self).values()))

    def where(self, which, other):
        return Shown(*(np.where(which if mine.ndim == 1 else which[:, None], mine, its)
                       for mine, its in zip(vars(self).values(), vars(other).values(), strict=True)))

    def one_surface(self, i, j):
        """Whether places i and j lie on one smooth surface."""
        way = self.at[j] - self.at[i]
        near = 0.3 * np.linalg.norm(way, axis=-1)
        return ((dot(self.across[i], self.across[j]) > 0.5) & (abs(dot(way, self.across[i])) <= near)
                & (abs(dot(way, self.across[j])) <= near))


class Edges:
    """The lines by which edges pass near pixels, through (a, 0) and (0, b) from their centres; 9: not there."""

    def __init__(self, a, b):
        self.a, self.b = a, b
        length = np.sqrt(a * a + b * b + 1e-12)
        self.x, self.y, self.far = b / length, a / length, a * b / length
        self.there = (a != 9) | (b != 9)
