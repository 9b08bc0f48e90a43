# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE in mirrors and through glass: where the eye sees something else than the front surface, and lines in it."""

import numpy as np

from . import grid, metric
from .metric import clamp01
from .sites import SEEN, Reads, bands, ridges, sites, turn

STEP, CRACK = 4, 9  # sites: shorter chains are chance, of depths the longer
JUMP, RAMP = 0.1, 0.03  # of a depth


def through(layers):
    """(H, W) where normals differ by .1, or depths by 2 % over all of a 3×3; grown by 5×5."""
    turned = layers.normal @ layers.view.T
    apart = np.linalg.norm(layers.seen_normal - turned, axis=-1)
    length = (turned ** 2).sum(-1)
    share = clamp01((layers.seen_normal * turned).sum(-1) / np.where(length > 0, length, 1))
    own = (np.linalg.norm(layers.seen_normal - share[..., None] * turned, axis=-1) < 0.1) & (
        np.linalg.norm(clamp01(layers.seen_color) - clamp01(layers.albedo), axis=-1) < 0.1)  # a lamp, or black in part
    unit = layers.height if layers.orthographic else np.where(layers.there, layers.depth, 1)
    gap = np.abs(layers.seen_depth - np.where(layers.there, layers.depth, 0))
    other = layers.there & (layers.seen_depth > 0) & (gap > 0.02 * unit) & ~(own & (apart > 0.1))
    begin = (layers.there & ~own & (apart > 0.1)) | np.all(
        [grid.read(other, dy, dx) for dy, dx in grid.window(1)], axis=0)
    return grid.most(begin, 2)


def families(layers, params, weight, mixed, bend):
    """Yield (sites, least length of a chain) of each family, older first; weight(at), `mixed` with the cracks."""
    if layers.seen_normal is None:
        return
    closed = mixed | ~through(layers)
    color, depth = clamp01(layers.seen_color), _inverse(layers)
    signals = ((layers.seen_normal, layers.seen_normal, layers.seen_normal, 0.6 * bend, 0.55),
               (metric.encode(color), color, np.sqrt(color), 0.01, 0.55), (depth, depth, depth, 0.0, 0.5))
    for k, (signal, linear, plain, floor, most) in enumerate(signals):
        for thin in (True, False) if k < 2 else (False,):
            if thin:
                at, jump, one, two, step = bands(signal, closed, 1.2 * floor)
                jump = jump / 1.2 if k == 0 else jump
            else:
                at, jump, one, two, step = ridges(signal, linear, closed, floor)
            if k == 0:
                strength = clamp01((jump - floor) / (0.37 * bend))
            elif k == 1:
                delta = metric.difference(params["contrast_metric"], one, two)
                least, full = params["contrast_threshold"], params["contrast_max"]
                strength = np.where(delta < least, 0, clamp01((delta - least) / max(full - least, 1e-12)))
            else:
                strength = clamp01((_jump(layers, depth, closed, at, step) - JUMP) / RAMP)
            strength = strength * _clarity(plain, closed, at, step, most)
            yield sites(at, "seen", SEEN, strength * weight(at), mixed.shape, step), STEP if k < 2 else CRACK


def _inverse(layers):
    z = layers.seen_depth[..., None]
    there = z > 0
    if layers.orthographic:
        return np.where(there, -z / layers.height, -1e15)
    return np.where(there, 1 / np.where(there, z, 1), 0)


def _jump(layers, depth, closed, at, step):
    """What each side's straight continuation misses at the other, relative to the nearest."""
    found = np.zeros(len(at))
    height, width = closed.shape
    for axis in (1, 0):
        r = Reads(depth, closed, axis)
        before, one, own, two, after = (r[k][..., 0] for k in (-2, -1, 0, 1, 2))
        left, right = two - 3 * one + 2 * before, one - 3 * two + 2 * after
        jump = np.maximum(0, np.maximum(np.minimum(left, -right), np.minimum(-left, right)))
        if not layers.orthographic:
            jump = jump / np.maximum(np.max([before, one, own, two, after], axis=0), 1e-12)
        jump = turn(axis, jump)
        along = step[:, 0] == 0 if axis else step[:, 0] != 0
        row, column = np.clip(grid.round_half_up(at), 0, (height - 1, width - 1)).T
        found = np.where(along, jump[row, column], found)
    return found


def _clarity(image, closed, at, step, most):
    """0 where half the pixels of a 9×9 differ by 6 % of the step from the mean of their neighbours in the row and
    from that of those in the column, or 80 % from that of those across the line; 1 where enough do not."""
    up, down, left, right = (grid.read(image, *d) for d in _SIDES)
    column, row = (np.linalg.norm(image - (a + b) / 2, axis=-1) for a, b in ((up, down), (left, right)))
    bent = np.minimum(column, row)
    known = ~closed & ~np.any([grid.read(closed, *d) for d in _SIDES], axis=0)
    inside = np.zeros_like(known)
    inside[1:-1, 1:-1] = True
    known &= inside
    found = np.ones(len(at))
    height, width = closed.shape
    for k, (y, x) in enumerate(np.clip(grid.round_half_up(at), 0, (height - 1, width - 1))):
        dy, dx = (1, 0) if np.any(step[k, :3]) else (0, 1)
        line = [image[np.clip(y + i * dy, 0, height - 1), np.clip(x + i * dx, 0, width - 1)] for i in (-1, 0, 1)]
        size = max(np.linalg.norm(line[a] - line[b]) for a, b in ((0, 1), (0, 2), (1, 2)))
        box = np.s_[max(y - 4, 0):y + 5, max(x - 4, 0):x + 5]
        if known[box].any():
            stirred, rippled = ((off[box] > 0.06 * size)[known[box]].mean() for off in (bent, column if dy else row))
            found[k] = clamp01((most - stirred) / 0.15) * clamp01((0.8 - rippled) / 0.15)
    return found


_SIDES = ((-1, 0), (1, 0), (0, -1), (0, 1))
