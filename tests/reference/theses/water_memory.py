# SPDX-License-Identifier: GPL-3.0-or-later
"""O. Vainumäe, 3D Comic Rendering (2020), chapters 3 and 4, one function a section."""

from itertools import product

import numpy as np

FALLOFF_START = 0.1  # of a line's radius
STEPS, BLUR = 20, 10.0  # of the walk; sigma
BEYOND = 7  # pixels past an edge, of the color that is smudged (shader)
GAIN, PENCIL = 4.0, 2.5  # of lines (shader) and of hatching


def at(image, down, right):
    """The image so many pixels away; beyond its border the nearest."""
    rows = np.clip(np.arange(image.shape[0]) + down, 0, image.shape[0] - 1)
    columns = np.clip(np.arange(image.shape[1]) + right, 0, image.shape[1] - 1)
    return image[rows][:, columns]


def value(color):
    return color.max(-1)


# 3.1 finding line locations


def difference_of_gaussians(image, sigma=1.0, k=1.6, reach=2):
    """Of each channel, with kernels of 5 x 5 that sum up to 1."""
    def blurred(s):
        places = product(range(-reach, reach + 1), repeat=2)
        weights = {(y, x): np.exp(-(y * y + x * x) / (2 * s * s)) for y, x in places}
        return sum(w * at(image, y, x) for (y, x), w in weights.items()) / sum(weights.values())
    return blurred(sigma) - blurred(k * sigma)


def edges(color, depth, normal, number, color_edge, threshold):
    """ThresholdedEdges: color sRGB-encoded; depth from 0 at the near plane to 1 at the far one."""
    from_color = 50 * difference_of_gaussians(color).max(-1) * np.maximum(0, color_edge)
    from_depth = 200 * difference_of_gaussians(depth)
    from_normal = 50 * (5 * np.maximum(0, difference_of_gaussians(normal).max(-1))) ** 1.5
    from_number = np.any([at(number, y, x) != number for y, x in product((-1, 0, 1), repeat=2)], axis=0)
    return np.max([from_color, from_depth, from_normal, from_number], axis=0) >= threshold


# 3.2 stylizing


def locations(mask):
    """EdgeLocations (row, column), -1 where there is none: up the gradient of the blurred edges, then dilated twice."""
    weights = np.exp(-np.arange(-STEPS, STEPS + 1) ** 2 / (2 * BLUR**2))
    weights /= weights.sum()
    blurred = mask.astype(float)
    for down, right in ((1, 0), (0, 1)):
        blurred = sum(w * at(blurred, k * down, k * right)
                      for k, w in zip(range(-STEPS, STEPS + 1), weights, strict=True))
    dx, dy = (at(blurred, y, x) - at(blurred, -y, -x) for y, x in ((0, 1), (1, 0)))
    corners = {(y, x): 0.5 * at(blurred, y, x) for y, x in product((-1, 1), repeat=2)}
    dx += sum(x * c for (_, x), c in corners.items())
    dy += sum(y * c for (y, _), c in corners.items())
    length = np.hypot(dx, dy)
    known = length > 1e-12
    dx, dy = (np.where(known, d / np.where(known, length, 1), 0) for d in (dx, dy))
    rows, columns = np.indices(mask.shape)
    found = np.full((*mask.shape, 2), -1)
    for step in range(STEPS):
        y, x = (np.clip(np.floor(place + step * d + 0.5).astype(int), 0, n - 1)
                for place, d, n in ((rows, dy, mask.shape[0]), (columns, dx, mask.shape[1])))
        hit = (found[..., 0] < 0) & mask[y, x] & (known | (step == 0))
        found[hit] = np.stack([y, x], -1)[hit]
    for _ in range(2):
        best, least = found.copy(), np.full(mask.shape, np.inf)
        for y, x in sorted(product((-1, 0, 1), repeat=2)):
            other = at(found, y, x)
            far = np.where(other[..., 0] < 0, np.inf, np.hypot(other[..., 0] - rows, other[..., 1] - columns))
            first = (far == least) & np.isfinite(far) & (
                (other[..., 0] < best[..., 0]) | ((other[..., 0] == best[..., 0]) & (other[..., 1] < best[..., 1])))
            nearer = (far < least) | first
            best[nearer], least = other[nearer], np.minimum(far, least)
        found = best
    return found


def least_deep(depth, *controls):
    """Controls dilated twice by 3 x 3: of the pixel with the least depth."""
    for _ in range(2):
        best, kept = depth.copy(), [c.copy() for c in controls]
        for y, x in product((-1, 0, 1), repeat=2):
            nearer = at(depth, y, x) < best
            best = np.where(nearer, at(depth, y, x), best)
            kept = [np.where(nearer, at(c, y, x), k) for c, k in zip(controls, kept, strict=True)]
        depth, controls = best, kept
    return controls


def falloff(x, range_, start):
    return np.where(x < start, 1, np.maximum(0, (range_ - x) / np.where(range_ > start, range_ - start, 1)))


def lines(found, depth, thickness, intensity, paper, radius, pressure):
    """How black each pixel is. radius: of a line whose control is 0."""
    thickness, intensity = least_deep(depth, thickness, intensity)
    rows, columns = np.indices(depth.shape)
    y, x = np.maximum(found, 0)[..., 0], np.maximum(found, 0)[..., 1]
    c, i = thickness[y, x], (1 + intensity[y, x]) * pressure
    r = radius * (1 + np.where(c > 0, 8 * c, c))
    excess = paper * falloff(np.hypot(y - rows, x - columns), r, FALLOFF_START * r) - np.maximum(0, 1 - i / 2)
    return np.where(found[..., 0] < 0, 0, np.clip(GAIN * i * excess, 0, 1))


# 4.1 discrete shading


def discrete(diffuse, levels, tint, tint_weight):
    """TintedDiscreteDiffuse, and the intensity. levels: low, mid, high; (threshold, transition) below mid and high."""
    low, mid, high = levels[0], *(level[0] for level in levels[1:])
    v = value(diffuse)
    intensity = np.full(v.shape, float(low))
    for below, above, (_, t, w) in ((low, mid, levels[1]), (mid, high, levels[2])):
        share = np.clip((v - (t - w / 2)) / w, 0, 1)
        intensity = np.where(v > t - w / 2, below + (above - below) * share, intensity)
    hue = diffuse / v[..., None]
    weight = ((1 - intensity) * tint_weight)[..., None]
    return (hue * intensity[..., None] + weight * tint) / (1 + weight), intensity


def shaded(color, tinted, intensity, saturation):
    v = value(color)[..., None]
    kept = 1 - (1 - intensity) * (1 - saturation)
    return (v - (v - color) * kept[..., None]) * tinted  # of HSV only the saturation changes


# 4.2 color smudging


def smudged(surface, found, depth, range_, falloff_start, least_difference):
    """falloff_start: with its control, relative to the range; least_difference: of depth, by pixel."""
    rows, columns = np.indices(depth.shape)
    y, x = found[..., 0], found[..., 1]
    d, far = np.hypot(y - rows, x - columns), np.abs(range_)
    over = np.where(d > 0, d, 1)
    pick = tuple(np.clip(np.floor(e + BEYOND * (e - own) / over + 0.5).astype(int), 0, n - 1)
                 for e, own, n in ((y, rows, depth.shape[0]), (x, columns, depth.shape[1])))
    behind = depth[pick] - depth
    applies = (y >= 0) & (d > 0) & (d <= far) & (np.where(range_ > 0, behind, -behind) > least_difference)
    intensity = np.where(applies, falloff(d, far, falloff_start * (1 + far)), 0)[..., None]
    return intensity * surface[pick] + (1 - intensity) * surface, applies


# 4.3 hatching


def hatching(color, diffuse, specular, control, paper, of_color, of_light):
    """How black the pencil makes each pixel."""
    lightness = np.minimum(1, np.minimum(value(color) / of_color, value(diffuse) / of_light))
    strength = paper * (1 + control) - lightness
    return np.clip(PENCIL * (1 - value(specular)) * strength, 0, 1)
