# SPDX-License-Identifier: GPL-3.0-or-later
"""How wide a line may be beside something thin: FINE's rule, which leaves half of a limb or a bar clear, applied to
what a scene's rays meet across it. Pixels and links have no part in this."""

import numpy as np
from reference import near
from reference.metric import clamp01
from reference.slender import AROUND, LEAST, WIDEST, crowd_of

STEP = 0.5  # pixels between two places that are looked at across a thing
JUMP = 0.01  # of the depth, relative, at which something else begins
APART = 0.5  # pixels from where a thing ends to its contour there, at most
COARSE = 4  # points of a contour from one that is looked at to the next


def _across(scene, points):
    """Depths and solids across what lies before the contour at each point, (points, places); where these places lie;
    and on which side of the contour that is."""
    at = np.arange(0.5, WIDEST + STEP, STEP)

    def seen(side, at):
        found = scene.trace(points.x[:, None] + (side * points.nx)[:, None] * at,
                            points.y[:, None] + (side * points.ny)[:, None] * at)
        return np.minimum(found["depth"], 1e9), found["solid"]
    one, other = (seen(side * np.ones(points.x.size), at[:1])[0][:, 0] for side in (1, -1))
    side = np.where(one <= other, 1.0, -1.0)
    return *seen(side, at), at, side


def _wide(scene, points):
    """(how many pixels wide each thing is, inf: too wide to matter; whether something before it hides its end, so that
    this is where what lies behind both begins; the side of the contour that it lies on)."""
    depth, solid, at, side = _across(scene, points)
    u = -depth if scene.camera.height else 1 / depth
    whole = scene.camera.height or np.maximum(u[:, :-1], u[:, 1:])
    second = u[:, 2:] - 2 * u[:, 1:-1] + u[:, :-2]
    one, two = np.pad(second, ((0, 0), (1, 0))), -np.pad(second, ((0, 0), (0, 1)))
    jump = np.maximum(np.minimum(one, two), np.minimum(-one, -two)) > JUMP * whole
    ends = (solid[:, 1:] != solid[:, :-1]) | jump
    place = np.arange(ends.shape[1])
    first = np.where(ends.any(1), ends.argmax(1), 0)[:, None]
    inside, outside = depth[:, :-1], depth[:, 1:]
    thing = np.take_along_axis(inside, first, 1)
    hidden = np.take_along_axis(outside, first, 1) <= thing
    behind = (place > first) & (outside > thing) & (solid[:, 1:] != solid[:, :1])
    ends &= np.where(hidden, behind, place == first)
    return np.where(ends.any(1), at[ends.argmax(1)] + STEP / 2, np.inf), hidden[:, 0], side


def _bounds(scene, points):
    """1 over half the width of a line at each point, by the contour opposite alone; 0: it may be any."""
    wide, hidden, side = _wide(scene, points)
    bound = np.zeros(points.x.size)
    thin = np.flatnonzero(np.isfinite(wide))
    outline = scene.truth.take(scene.truth.outline)
    x, y = (p[thin] + (side * n)[thin] * wide[thin] for p, n in ((points.x, points.nx), (points.y, points.ny)))
    i, j = near.pairs(np.stack([x, y], 1), np.stack([outline.x, outline.y], 1), APART)
    order = np.lexsort((np.hypot(outline.x[j] - x[i], outline.y[j] - y[i]), i))
    i, first = np.unique(i[order], return_index=True)
    j, i = j[order][first], thin[i]
    wide[i] = np.abs((outline.x[j] - points.x[i]) * points.nx[i] + (outline.y[j] - points.y[i]) * points.ny[i])
    level = np.minimum(np.abs(points.nx[i] * outline.nx[j] + points.ny[i] * outline.ny[j]), 1)
    bound[i] = clamp01((level - 0.5) / 0.3) * crowd_of(wide[i] * np.sqrt((1 + level) / 2), np.sqrt(1 - level**2), 1.0)
    covered = thin[hidden[thin]]
    bound[covered] = crowd_of(wide[covered], 0.0, 1.0)
    return bound


def _arms(start, links):
    """What hangs together of the points within AROUND of one along contours, without it: a set for each way from it.
    A pixel's two sides count as a line crosses them: that is how many sites it has there."""
    far, growing = {start: 0.0}, [start]
    while growing:
        i = growing.pop(0)
        for j, step in links[i].items():
            length = far[i] + step
            if length <= AROUND and length < far.get(j, np.inf) - 1e-9:
                far[j] = length
                growing.append(j)
    left, arms = {j for j, length in far.items() if length > 1}, []
    while left:
        arm = [left.pop()]
        for i in arm:
            beyond = left.intersection(links[i])
            left -= beyond
            arm += beyond
        arms.append(arm)
    return arms


def widest(scene, points, asked):
    """The greatest width in pixels, if it is less than `asked`, of a line at each of `points`: as it is on both its
    sides, at a corner, too."""
    if asked <= 2 * LEAST or not points.x.size:
        return np.full(points.x.size, asked)
    outline = scene.truth.take(scene.truth.outline)
    outline = outline.take(np.arange(0, outline.x.size, COARSE))
    places = np.stack([points.x, points.y], 1)
    _, some = near.pairs(places, np.stack([outline.x, outline.y], 1), AROUND)
    outline = outline.take(np.unique(some))
    at, bound, own = np.stack([outline.x, outline.y], 1), _bounds(scene, outline), _bounds(scene, points)
    links = [{} for _ in at]
    i, j = near.pairs(at, at, 0.2 * COARSE)
    for one, other, step in zip(i.tolist(), j.tolist(), np.abs(at[j] - at[i]).sum(1).tolist(), strict=True):
        if one != other:
            links[one][other] = step
    thin = np.unique(near.pairs(places, at[bound > 2 / asked], AROUND)[0])
    i, j = near.pairs(places[thin], at, 0.1 * COARSE)
    for k, start in dict(zip(thin[i], j, strict=True)).items():
        most = sorted(bound[arm].max() for arm in _arms(start, links))
        own[k] = max(own[k], most[-2] if len(most) > 1 else most[-1] if most else 0)
    return np.minimum(2 / np.maximum(own, 1e-9), asked)
