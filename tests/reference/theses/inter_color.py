# SPDX-License-Identifier: GPL-3.0-or-later
"""D. G. Herring, Inter-color NPR lines (2016), appendix A.2: the two passes over the image."""

from itertools import product

import numpy as np

from .water_memory import at

BRUSH = 11.0  # pixels: radius of the widest line
SHAPE, COLOR = 0.25, 0.01  # thresholds


def sobel(image):
    """Length of the gradient by 1 2 1."""
    pairs = list(product((-1, 0, 1), repeat=2))
    across = sum(x * (2 - abs(y)) * at(image, y, x) for y, x in pairs)
    down = sum(y * (2 - abs(x)) * at(image, y, x) for y, x in pairs)
    return np.sqrt(across**2 + down**2)


def difference(one, two):
    """Equation 3.1 of sRGB colors; 1 is black to white."""
    square, red = (one - two) ** 2, (one[..., 0] + two[..., 0]) / 2
    return np.sqrt((2 + red) * square[..., 0] + 4 * square[..., 1] + (3 - red) * square[..., 2]) / 3


def strength(color, depth, normal):
    """The first pass, before depth makes lines thinner. depth: 0 at the near plane, 1 at the far one."""
    shape = 0.1 * sum(sobel(0.5 + 0.5 * normal[..., c]) for c in range(3))
    shape = np.maximum(np.where(shape < SHAPE, 0, shape), np.minimum(1, 10 * sobel(depth)))
    apart = np.max([difference(at(color, y, x), at(color, -y, -x)) for y, x in ((-1, 0), (-1, 1), (0, 1), (1, 1))], 0)
    return np.maximum(shape, np.where(apart < COLOR, 0, np.clip((apart - COLOR) / (1 - COLOR), 0, 1)))


def darkness(alpha):
    """The second pass: discs whose radius is the alpha of their pixel, which holds 0 to 1."""
    radius, reach = np.clip(alpha, 0, 1) * BRUSH, int(BRUSH)
    light = np.ones(alpha.shape)
    padded = np.pad(radius, reach)
    height, width = alpha.shape
    for y, x in product(range(-reach, reach + 1), repeat=2):
        own = padded[reach + y:reach + y + height, reach + x:reach + x + width]
        light = np.minimum(light, np.clip(1 + np.hypot(y, x) - own, 0, 1))
    return 1 - light
