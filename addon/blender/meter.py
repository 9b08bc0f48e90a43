# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light is full light in a scene: what a white surface has that faces its strongest lamp.

It comes from lamps and where things stand, never from what a frame shows: a frame that looks at shade must not grow
brighter, and tiles, borders and frames of a farm must agree. Sums over all things change by and by while lamps and
things move, so that levels don't jump.
"""

import numpy as np

from ..pen import irradiance
from . import lamps, trees, worlds

_NEAREST = 0.25  # of the scene's size: what hangs nearer to a lamp has no more light than there, or a lampshade counted
_SIDES = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], np.float64)


def light(scene, found, places, size):
    """Of lamps found, (object, matrix) pairs, on what stands at places (n, 3); 0: there is none that can be told.

    A thing has the light of the lamp that is strongest there, and all that comes from the world. The mean is of its
    logarithm, or a lampshade would outweigh a room; what has little counts little, for it is meant to be dark.
    """
    each = np.zeros(max(len(places), 1))
    for obj, matrix in found:
        if (lamp := lamps.told(obj, matrix)) is not None:
            each = np.maximum(each, _falls(lamp, places, _NEAREST * size))
    around, brightest = _world(scene.world)
    mean = float(np.mean(np.sqrt(each)) ** 2)
    if mean > 0:
        counts = each / (each + mean)
        mean = float(np.exp(counts @ np.log(np.maximum(each, 1e-30)) / counts.sum()))
    full = max(mean + around if mean else 0.0, brightest)
    return full if np.isfinite(full) else 0.0


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
