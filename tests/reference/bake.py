# SPDX-License-Identifier: GPL-3.0-or-later
"""Inter-color lines in a texture: slow, obvious, float64. Every texel with contrast inks every texel in reach."""

import numpy as np

from . import metric

PAIRS = ((-1, 0), (-1, 1), (0, 1), (1, 1))  # rows down, columns right of one of two opposite neighbours


def beside(image, dy, dx, wrap):
    """What is dy rows down and dx columns right of each texel; outside, the other side's or the nearest."""
    for axis, step, tiles in ((0, dy, wrap[1]), (1, dx, wrap[0])):
        index = np.arange(image.shape[axis]) + step
        n = image.shape[axis]
        image = np.take(image, index % n if tiles else np.clip(index, 0, n - 1), axis)
    return image


def contrast(texture, linear, wrap, kind):
    """The largest difference of a texel's four pairs."""
    color = metric.encode(texture[..., :3]) if linear else metric.clamp01(texture[..., :3])
    return np.max([metric.difference(kind, beside(color, dy, dx, wrap), beside(color, -dy, -dx, wrap))
                   for dy, dx in PAIRS], axis=0)


def strength(difference, params, wrap):
    least, full = params["contrast_threshold"], np.full(difference.shape, params["contrast_full"])
    if params["contrast_local"]:
        reach = int(params["contrast_window"] / 2)
        full = difference
        for axis, n, tiles in ((1, difference.shape[1], wrap[0]), (0, difference.shape[0], wrap[1])):
            steps = range(-min(reach, n), min(reach, n) + 1)
            full = np.max([beside(full, *((0, k) if axis else (k, 0)), (tiles, tiles)) for k in steps], axis=0)
        full = np.maximum(full, 0.25)
    ramp = full - least
    share = np.where(ramp > 0, metric.clamp01((difference - least) / np.where(ramp > 0, ramp, 1)), 1)
    return np.where(difference < least, 0, share)


def _offsets(shape, cy, cx, wrap):
    """(dy, dx) of every texel from a centre, once for each repetition of the texture that is near."""
    height, width = shape
    y, x = np.indices(shape)
    for i in (-2, -1, 0, 1, 2) if wrap[1] else (0,):
        for j in (-2, -1, 0, 1, 2) if wrap[0] else (0,):
            yield y + i * height - cy, x + j * width - cx


def discs(radius, wrap):
    cover = np.zeros(radius.shape)
    for y, x in np.argwhere(radius > 0):
        for dy, dx in _offsets(radius.shape, y, x, wrap):
            cover = np.maximum(cover, metric.clamp01(radius[y, x] - np.hypot(dy, dx)))
    return cover


def ellipses(radius, form, texture, wrap):
    """On the surface: centres on the boundary of the colours, rims one texel wide."""
    cover = np.zeros(radius.shape)
    color = metric.clamp01(texture[..., :3])
    axes = [_boundary(color, axis, wrap) for axis in (0, 1)]
    clear = np.maximum(axes[0][0], axes[1][0]) / 2
    for axis, (square, offset) in enumerate(axes):
        for y, x in np.argwhere((radius > 0) & (square > 0) & (square >= clear)):
            oy, ox = (offset[y, x], 0) if axis else (0, offset[y, x])
            for dy, dx in _offsets(radius.shape, y + oy, x + ox, wrap):
                cover = np.maximum(cover, _line(dx, dy, *form[y, x], radius[y, x]))
    return cover


def _boundary(color, axis, wrap):
    """How much the neighbours before and behind differ (squared), and where along the axis the boundary is: in three
    lines side by side, of three texels each, as many are before it as are of the first one's colour; their mean."""
    def at(along, aside):
        return beside(color, *((along, aside) if axis else (aside, along)), wrap)

    first = at(-1, 0)
    change = at(1, 0) - first
    square = (change**2).sum(-1)
    places = []
    for aside in (-1, 0, 1):
        of_second = sum(metric.clamp01(((at(k, aside) - first) * change).sum(-1) / np.where(square > 0, square, 1))
                        for k in (-1, 0, 1))
        places.append(1.5 - of_second)
    return square, (places[0] + 2 * places[1] + places[2]) / 4


def _line(dx, dy, e, f, g, radius):
    """The share of a texel that a straight line at this distance covers: the step over one texel in that direction is
    the length of the distance's gradient."""
    distance = np.sqrt(e * dx * dx + 2 * f * dx * dy + g * dy * dy)
    at = distance > 0
    safe = np.where(at, distance, 1)
    step = np.where(at, np.hypot(e * dx + f * dy, f * dx + g * dy) / safe, np.sqrt((e + g) / 2))
    return (metric.clamp01((radius - distance) / step + 0.5) + metric.clamp01((radius + distance) / step + 0.5) - 1)


def bake(texture, params, form=None, linear=False, wrap=(True, True)):
    """(texture with lines, largest difference)."""
    texture = np.where(np.isfinite(texture), texture, 0).astype(float)
    difference = contrast(texture, linear, wrap, params["contrast_metric"])
    radius = 0.5 * params["line_thickness"] * strength(difference, params, wrap)
    cover = discs(radius, wrap) if form is None else ellipses(radius, form.astype(float), texture, wrap)
    out = texture.copy()
    out[..., :3] *= 1 - cover[..., None]
    return out, difference.max()
