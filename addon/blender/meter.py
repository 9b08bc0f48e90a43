# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light is full light in a scene: what a white surface has that faces its strongest lamp.

It comes from lamps and where things stand, never from what a frame shows: a frame that looks at shade must not grow
brighter, and tiles, borders and frames of a farm must agree. Sums over all things change by and by while lamps and
things move, so that levels don't jump.

It is not much more than what most things have: a sun that only comes in by a window does not make night of the
room, while in a street, where it reaches what faces it, shade stays as dark beside it as it is.
"""

import numpy as np

from ..pen import irradiance
from . import lamps, trees, worlds

_NEAREST = 0.25  # of the scene's size: what hangs nearer to a lamp has no more light than there, or a lampshade counted
_MOST = 1.5  # times what most things have: they lie above the thresholds of presets, .55 at most
_DARK = 0.005  # of full light: what has about so little is meant to be dark
_THINGS = 1000  # so many tell what most have
_WEAK = 0.2  # of the strongest lamp at a thing: whether weaker ones reach it makes no difference
_FACES = np.array([(side * x, side * y, side * z) for x, y, z in np.eye(3) for side in (-1, 1)])
_SPOTS = np.array([(a, b) for a in (-0.5, 0.5) for b in (-0.5, 0.5)])  # of a face
_SIDES = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], np.float64)


def light(scene, found, boxes, size, drawn=None):
    """Of lamps found, (object, matrix) pairs, on what stands in boxes (n, 4, 3), the middle and three half axes each;
    0: there is none that can be told. drawn: the lamps.Light that knows what throws shadows, None: nothing does.

    A thing has the light of the lamp that is strongest there, and all that comes from the world. The mean is of its
    logarithm, or a lampshade would outweigh a room; what has little counts little, for it is meant to be dark.
    """
    told = [(obj, lamp) for obj, matrix in found if (lamp := lamps.told(obj, matrix)) is not None]
    n = max(len(boxes), 1)
    falls = [np.broadcast_to(_falls(lamp, boxes[:, 0], _NEAREST * size), n) for _, lamp in told]
    each = np.max([np.zeros(n), *falls], 0)
    around, brightest = _world(scene.world)
    mean = float(np.mean(np.sqrt(each)) ** 2)
    if mean > 0:
        counts = each / (each + mean)
        mean = float(np.exp(counts @ np.log(np.maximum(each, 1e-30)) / counts.sum()))
    full = max(mean + around if mean else 0.0, brightest)
    if drawn and mean > 0 and len(boxes):
        full = max(min(full, _MOST * _usual(drawn, told, falls, boxes, around, full)), brightest)
    return full if np.isfinite(full) else 0.0


def _usual(drawn, told, falls, boxes, around, full):
    """What most things have of the lamps that reach them, and of the world: nearer to the dark than to the bright ones.
    """
    some = slice(None, None, -(-len(boxes) // _THINGS))
    boxes, falls = boxes[some], [fall[some] for fall in falls]
    strongest, has = np.max(falls, 0), np.zeros(len(boxes))
    for (obj, lamp), fall in zip(told, falls, strict=True):
        counts = fall > _WEAK * strongest
        if counts.any():
            share = _reached(drawn, lamp, drawn.sets.numbers(obj)[1], boxes[counts]) if lamp.shadows else 1.0
            has[counts] = np.maximum(has[counts], fall[counts] * share)
    has += around
    counts = has / (has + _DARK * full)
    if not counts.any():
        return full
    return float(counts.sum() / (counts @ np.maximum(has, 1e-30) ** -0.5)) ** 2


def _reached(drawn, lamp, shadow_set, boxes):
    """(n,) of boxes: what share of their sides a lamp reaches, by how large these look from there."""
    middle, axes = boxes[:, 0], boxes[:, 1:]
    large = np.linalg.norm(axes, axis=(1, 2))
    across = np.cross(np.roll(axes, -1, 1), np.roll(axes, -2, 1))
    across *= np.where(np.sum(across * axes, 2, keepdims=True) < 0, -1, 1)
    area = np.linalg.norm(across, axis=2, keepdims=True)
    across = np.einsum("fk,nkc->nfc", _FACES, across / np.maximum(area, 1e-30))
    area = np.einsum("fk,nk->nf", np.abs(_FACES), area[..., 0] + 1e-6 * large[:, None] ** 2)
    others = np.abs(_FACES)[:, None] @ np.roll(np.eye(3), 1, 1), np.abs(_FACES)[:, None] @ np.roll(np.eye(3), 2, 1)
    spots = sum(_SPOTS[None, :, k, None] * others[k] for k in (0, 1)) + _FACES[:, None]
    place = (middle[:, None, None] + np.einsum("fsk,nkc->nfsc", spots, axes)
             + 0.01 * large[:, None, None, None] * across[:, :, None])
    if lamp.kind == "sun":
        toward = np.broadcast_to(lamp.model[:3, 2] / max(np.linalg.norm(lamp.model[:3, 2]), 1e-30), place.shape)
        way = toward * 1e6
    else:
        way = lamp.model[:3, 3] - place
        toward = way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-30)
        way = 0.999 * way
    facing = np.maximum(np.sum(across[:, :, None] * toward, -1), 0)
    where = facing > 0.05
    reached = np.zeros(where.shape)
    reached[where] = drawn.scene.reached(place[where], way[where], shadow_set)
    facing *= where * area[:, :, None]
    return np.sum(facing * reached, (1, 2)) / np.maximum(np.sum(facing, (1, 2)), 1e-30)


def _falls(lamp, places, nearest):
    """Diffuse light of what faces a lamp, without its shadows."""
    strength = float(np.max(lamp.color))
    if lamp.kind == "sun" or not len(places):
        return strength / np.pi if lamp.kind == "sun" else 0.0
    away = places - lamp.model[:3, 3]
    far = np.maximum(np.linalg.norm(away, axis=1), max(nearest, 1e-6))
    axis = -lamp.model[:3, 2] / max(np.linalg.norm(lamp.model[:3, 2]), 1e-30)
    ahead = away @ axis / far
    falls = strength / (2 * np.pi * far) ** 2
    if lamp.kind == "point":
        return falls
    if lamp.kind == "spot":
        edge = np.cos(lamp.spot_angle / 2)
        return falls * np.clip((ahead - edge) / max((1 - edge) * lamp.spot_blend, 1e-3), 0, 1)
    return 4 * falls * np.maximum(ahead, 0)


def _world(world):
    """(mean, greatest) diffuse light of the world over the ways that a surface may face."""
    try:
        told = worlds.light(world)
    except trees.Unknown:
        told = None
    if told is None:
        return 0.0, 0.0
    sides = irradiance.polynomials(_SIDES / np.linalg.norm(_SIDES, axis=1)[:, None]) @ told
    return float(max(np.max(told[0]), 0)), float(max(np.max(sides), 0))
