# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light is full light in a scene: what a white surface has that faces its strongest lamp.

It comes from lamps and where things stand, never from what a frame shows: a frame that looks at shade must not grow
brighter, and tiles, borders and frames of a farm must agree. Sums over all things change by and by while lamps and
things move, so that levels don't jump.

Of a lamp near by a thing tells by how large it looks from there: the windows of a town across the bay are hundreds, and
no night gets light because nothing reaches them. Nor does shade make much less of it than what most things have: a sun
that only comes in by a window does not make night of the room, while in a street, where it reaches what faces it, shade
stays as dark beside it as it is.
"""

import pickle
from dataclasses import dataclass

import numpy as np

from ..pen import irradiance
from . import lamps, receivers, skies, trees

_NEAREST = 0.25  # of the scene's size: what hangs nearer to a lamp has no more light than there, or a lampshade counted
_MOST = 1.5  # times what shadows leave to most things: they lie above the thresholds of presets, .55 at most
_LARGE = 0.03  # steradians: a figure at five paces. What looks larger from its lamp is one thing among others, too
_DARK = 0.005  # of full light: what has about so little is meant to be dark
_THINGS = 1000  # so many tell what most have
_WEAK = 0.2  # of the strongest lamp at a thing: whether weaker ones reach it makes no difference, but for a sun
_SHADE = 0.35  # what shade counts as: ENCRE_SHADE
_PALE, _DIM = 0.38, 0.3  # of full light: what shade has at most, and at least under a sky, before it counts as that
_OPEN, _DEEP = 0.6, 0.1  # of open shade under a sky what counts as shade, where it is below _DIM by _DEEP of F
_SURE = 0.2    # of full light: over which shade has more before full light is what surfaces have most of
_BRIGHT = 0.97 # what counts as by then
_FACED, _UNFACED = 0.65, 0.5  # of what faces a sky's sun: where surfaces have less at most, few face it, or none
_FLAT = 1.5    # times shade, what is brightest at least, or light that is even would be cut by its last hundredths
_FACES = np.array([(side * x, side * y, side * z) for x, y, z in np.eye(3) for side in (-1, 1)])
_SPOTS = np.array([(a, b) for a in (-0.5, 0.5) for b in (-0.5, 0.5)])  # of a face
_SIDES = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], np.float64)


found = {}  # scene's full name -> the last Metered, for the panel


@dataclass
class Metered:
    """Diffuse light that is full light, 0: there is none that can be told; and that of the shade, 0: not told."""

    light: float = 0.0
    shade: float = 0.0


def read(world, found, things, drawn=None):
    """The Metered of a world, and of lamps found, (object, matrix) pairs, on what stands there; things: a
    subject.Things. drawn: the lamps.Light that knows what throws shadows, None: nothing does."""
    around = drawn.around if drawn else _around(world)
    exposure = drawn.exposure if drawn else 1.0
    told = [(drawn.sets.numbers(obj)[1] if drawn else 0, lamp, False) for obj, matrix in found
            if (lamp := lamps.told(obj, matrix)) is not None]
    told += [(0, lamp, True) for lamp in lamps.suns(around, world)]
    full = _light(told, around.ambient, things.boxes, things.size(), drawn)
    shade = 0.0
    if drawn and full > 0:
        full, shade = _with_shade(full, told, around.ambient, things, drawn)
    return Metered(_finite(full * exposure), _finite(shade * exposure))


def _with_shade(full, told, ambient, things, drawn):
    """(full light, shade, 0: as it is) by what surfaces receive. Where that is as usual, shade between _DIM and _PALE
    of full light, it is left alone."""
    got = _measured(told, ambient, things, drawn)
    if got is None:
        return full, 0.0
    shade, most = min(got.shade, got.full / _FLAT), max(got.full, got.shade)
    if got.sky and most > 0:
        unfaced = np.clip((_FACED - most / full) / (_FACED - _UNFACED), 0, 1)
        full += float(unfaced) * (most / _BRIGHT - full)
    if shade > _PALE * full:
        sure = min(1.0, (shade / full - _PALE) / _SURE)
        return full + sure * (max(most / _BRIGHT, 1e-3 * full + shade) - full), shade * _SHADE / _PALE
    if got.sky and 0 < got.open < _DIM * full:
        far = min(1.0, (_DIM - got.open / full) / _DEEP)
        return full, got.open * (_SHADE / _DIM + far * (_OPEN - _SHADE / _DIM))
    return full, 0.0


def _measured(told, ambient, things, drawn):
    """The receivers.Found of what stands still, kept as long as nothing of it changes; None: there is nothing."""
    still = [(placed, spots) for placed, spots, movers in drawn.instances if not things.moved(movers)
             and spots and np.isfinite(placed[1]).all() and np.isfinite(spots.places).all()]
    if not still or not things.size() > 0:
        return None
    by = pickle.dumps([still, things.size(), ambient, told])
    if drawn.kept.measured is None or drawn.kept.measured[0] != by:
        with drawn.without(things.moved):
            surfaces = receivers.Surfaces(drawn.scene, [(spots, placed[1]) for placed, spots in still],
                                          things.size())
            found = None
            if np.sum(surfaces.weights) > 0:
                found = surfaces.received(drawn.scene, told, lambda lamp, at: _falls(lamp, at, 0.0), ambient)
        drawn.kept.measured = by, found
    return drawn.kept.measured[1]


def _light(told, ambient, boxes, size, drawn=None):
    """Full light, 0: there is none that can be told, on what stands in boxes (n, 4, 3), the middle and three half axes
    each.

    A thing has the light of the lamp that is strongest there, and all that comes from the world. The mean is of its
    logarithm, or a lampshade would outweigh a room; what has little counts little, for it is meant to be dark.
    """
    n = max(len(boxes), 1)
    falls = np.array([np.broadcast_to(_falls(lamp, boxes[:, 0], _NEAREST * size), n) for _, lamp, _ in told])
    each = np.max(falls, 0) if told else np.zeros(n)
    around, brightest = _world(ambient)
    if not (np.any(each > 0) and len(boxes)):
        full = np.max(each) + around if np.any(each > 0) else 0.0
        return max(full, brightest)
    some = slice(None, None, -(-n // _THINGS)) if drawn else slice(None)
    boxes, falls, each = boxes[some], falls[:, some], each[some]
    reached = _all_reached(drawn, told, falls, boxes)
    votes = _votes(told, falls, reached if drawn else None, boxes)
    mean = float(votes @ np.sqrt(each) / votes.sum()) ** 2
    counts = votes * each / (each + mean)
    full = float(np.exp(counts @ np.log(np.maximum(each, 1e-30)) / counts.sum())) + around
    shaded = _usual(np.max(falls * reached, 0) + around, votes, full) / _usual(each + around, votes, full)
    return max(full * min(1.0, _MOST * shaded), brightest)


def _finite(full):
    return float(full) if np.isfinite(full) else 0.0


def _votes(told, falls, reached, boxes):
    """(n,): how much each thing tells: by how large it looks from the near lamp that it has most of, at most 1. What
    has a sun's light counts in full where no sun comes to what lamps light, as to a room in the daylight; where one
    does, it is a moon, and what it alone lights counts as the lamps say. reached: of lamps, None: nobody knows.
    """
    suns = np.array([lamp.kind == "sun" for _, lamp, _ in told])
    if suns.all():
        return np.ones(len(boxes))
    near, sun = falls[~suns], falls[suns] * (1 if reached is None else reached[suns])
    places = np.array([lamp.model[:3, 3] for _, lamp, _ in told])[~suns][np.argmax(near, 0)]
    a, b, c = np.linalg.norm(boxes[:, 1:], axis=2).T
    area = 2 * (a * b + b * c + c * a)  # of a box, the mean from all sides: a quarter of its faces
    looks = area / np.maximum(_LARGE * np.sum((boxes[:, 0] - places) ** 2, 1), area + 1e-30)
    lit = np.max(near, 0)
    lit = lit / np.maximum(lit + np.max(sun, 0, initial=0), 1e-30)
    outside = 0.0
    if suns.any() and reached is not None:
        share = reached[suns][np.argmax(np.max(falls[suns], 1))]
        there, most = looks * lit, max(float(share.mean()), 1e-30)
        outside = min(1.0, float(there @ share) / max(there.sum(), 1e-30) / most)
    votes = lit * looks + (1 - lit) * (1 + outside * (looks - 1))
    return votes if votes.sum() > 0 else np.ones(len(boxes))


def _usual(has, votes, full):
    """What most things have: nearer to the dark than to the bright ones."""
    counts = votes * has / (has + _DARK * full)
    return float(counts.sum() / max(counts @ np.maximum(has, 1e-30) ** -0.5, 1e-30)) ** 2


def _all_reached(drawn, told, falls, boxes):
    """(lamps, n): what share of each thing's sides lamps reach; 1 where shadows make no difference, or nobody knows."""
    reached = np.ones(falls.shape)
    strongest = np.max(falls, 0)
    for k, (shadow_set, lamp, _) in enumerate(told if drawn else []):
        counts = (falls[k] > _WEAK * strongest) | (lamp.kind == "sun")
        if counts.any() and lamp.shadows:
            reached[k, counts] = _reached(drawn, lamp, shadow_set, boxes[counts])
    return reached


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


def _around(world):
    try:
        return skies.light(world)
    except trees.Unknown:
        return skies.Around()


def _world(told):
    """(mean, greatest) diffuse light of the world over the ways that a surface may face."""
    if told is None:
        return 0.0, 0.0
    sides = irradiance.polynomials(_SIDES / np.linalg.norm(_SIDES, axis=1)[:, None]) @ told
    return float(max(np.max(told[0]), 0)), float(max(np.max(sides), 0))
