# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from which the denoiser could not take all noise, evened out, so that levels of it end in smooth curves.

What the denoiser leaves are streaks and clouds, some part of the noise that was there; on soft light they move far the
place where it reaches a threshold. How much noise there was is told by neighbours in the light as rendered. Light moves
towards the mean of two places on either side of it, where they lie on the same surface and that mean differs by no more
than such noise: so slopes stay as they are, however steep, shadows keep their edges, and what had no noise keeps every
byte. Passes at several distances reach far with few places (a transform with holes: Dammertz et al. 2010), the farthest
first: the last then takes away what lies between their holes.

What is left are islands where light lies flat: levels would be filled and outlined in crumbs. A place that is brighter,
or darker, than all about it by less than the noise as rendered comes down, or up, to the nearest of those. Only peaks
and pits change, no slope and no ridge. Last, curves of equal light are made calm (along.py), also where shadows' edges
hide from neighbours how much noise there was: what the denoiser took away tells it. Where light is the border of a soft
shadow none of this is done, which would move it: there it is averaged along the border alone.
"""

from collections.abc import Callable

import numpy as np

from . import along

# Of a pass: pixels, and how many standard deviations of the noise as rendered a mean may differ by. Far places lie on
# other slopes more often, and of clouds that large the denoiser leaves less.
_PASSES = (16, 1.5), (8, 1.5), (4, 2), (2, 3), (1, 3)
_STEPS = 8, 4, 2, 1  # pixels: how far peaks and pits are looked for
_AROUND, _ASIDE = 2, 5  # pixels: of the window in which noise is measured, and to the windows beside it
REACH = sum(step for step, _ in _PASSES) + sum(_STEPS) + 1 + _AROUND + _ASIDE + along.REACH
assert along.REACH_FAR <= REACH
_ABOUT = 3  # of _AHEAD: directions in which what is about a place must be known, to call it a peak
_NIL = 1 / 3000  # of the light: less is no noise
_BEND, _TURN = 0.003, 0.2  # of 1/depth, and of the normal: more is another surface, or a relief that light shows
_PIXELS = 1 << 17  # at once: what is around them counts for little, and they stay in the caches
_CALMED = 64  # rows
_ACROSS, _DOWN = (0, 1), (1, 0)
_AHEAD = _ACROSS, _DOWN, (1, 1), (1, -1)  # of two places on either side; the first two count twice

# The places on either side, by one of _AHEAD.
_Pairs = Callable[[tuple[int, int]], tuple[np.ndarray, np.ndarray]]


def even(light: np.ndarray, rendered: np.ndarray, normal: np.ndarray, depth: np.ndarray,
         number: np.ndarray | None = None) -> np.ndarray:
    """Takes from `light` (height, width, 3) what the denoiser left of the noise in `rendered`, in place; returns it.
    normal: finite; depth and number, of the object: (height, width, 1). What lies on both sides of an outline or a fold
    is never mixed."""
    height, width = light.shape[:2]
    every = light.max(2)
    rows = max(_PIXELS // width, REACH)
    for top in range(0, height, rows):
        first, last = max(0, top - REACH), min(height, top + rows + REACH)
        strip, own = slice(first, last), slice(top - first, min(height, top + rows) - first)
        value = every[strip]
        with np.errstate(over="ignore", invalid="ignore"):
            smooth = _strip(value, rendered[strip].max(2), _Surface(
                normal[strip], depth[strip, :, 0], None if number is None else number[strip, :, 0]))
            factor = np.divide(smooth, value, out=np.ones_like(value), where=value > 0)
        light[top:top + rows] *= np.where(np.isfinite(factor), factor, 1)[own][..., None]
    return light


def _strip(value, rendered, surface):
    """`value`, evened out; at its first and last rows REACH of them are not as in a larger picture."""
    given, nil = value, np.float32(_NIL) * value
    noise = _noise(rendered, surface.same(1)) - nil
    if noise.max() > 0:
        same = {}
        for step, most in _PASSES:
            same[step] = surface.same(step)
            value = _pass(value, np.float32(most) * noise, step, same[step])
            if step not in _STEPS:
                del same[step]
        for step in _STEPS:
            value = _levelled(value, noise, step, same[step])
        same = same[1]
        taken = 2 * np.sqrt(_mean((rendered - given) ** 2)) - nil
        border, sure = along.border(given, taken, _whole(same), _slope(given, same), _mean)
        value = _calmed(value, taken, same)
        value += sure * (border - value)
    return value


def _calmed(value, taken, same):
    """In strips of their own: it needs little about them, and many pictures."""
    out, height = np.empty_like(value), len(value)
    for top in range(0, height, _CALMED):
        first, end = max(0, top - along.REACH), min(height, top + _CALMED)
        strip = slice(first, end + along.REACH)
        beside = {ahead: alike[strip] for ahead, alike in same.items()}
        out[top:end] = along.calm(value[strip], taken[strip], _whole(beside), _slope(value[strip], beside),
                                  _mean)[top - first:end - first]
    return out


def _whole(same):
    """Whether all that lies about a pixel is of one surface."""
    return np.logical_and.reduce([same[ahead] for ahead in _AHEAD])


def _slope(light, same):
    """Of light, (down, right); 0 where a place on either side is of another surface."""
    around = _pairs(light, 1)
    return tuple(np.where(same[axis], (one - two) * np.float32(0.5), 0)
                 for axis, (one, two) in ((axis, around(axis)) for axis in (_DOWN, _ACROSS)))


def _pairs(picture: np.ndarray, step: int) -> _Pairs:
    """So many pixels away; beyond the picture its nearest pixel."""
    height, width = picture.shape
    wide = np.pad(picture, step, mode="edge")

    def pair(ahead):
        y, x = step * ahead[0], step * ahead[1]
        return (wide[step + y:step + y + height, step + x:step + x + width],
                wide[step - y:step - y + height, step - x:step - x + width])
    return pair


class _Surface:
    """What the pixels show: near is 1/depth, 0 where nothing is."""

    def __init__(self, normal, depth, number):
        self.normal, self.number = np.moveaxis(normal, 2, 0), number
        self.near = np.divide(1, depth, out=np.zeros(depth.shape, np.float32), where=(depth > 0) & (depth < 1e9))

    def same(self, step):
        """Of each of _AHEAD whether both places show what lies between them."""
        found, most = {}, np.float32(_BEND * max(1, step / 2)) * self.near
        near, normals = _pairs(self.near, step), [_pairs(n, step) for n in self.normal]
        number = None if self.number is None else _pairs(self.number, step)
        for ahead in _AHEAD:
            one, two = near(ahead)
            same = np.abs(one + two - 2 * self.near) < most
            turn = np.zeros_like(self.near)
            for own, pair in zip(self.normal, normals, strict=True):
                one, two = pair(ahead)
                turn += (one + two - 2 * own) ** 2
            same &= turn < _TURN ** 2
            for other in number(ahead) if number else ():
                same &= other == self.number
            found[ahead] = same
        return found


def _noise(light, same):
    """Its standard deviation: by what slopes and folds do not explain (Immerkær 1996), least of the windows about a
    pixel: edges of shadows are not noise."""
    whole, rest, around = _whole(same), 4 * light, _pairs(light, 1)
    for ahead, weight in zip(_AHEAD, (-2, -2, 1, 1), strict=True):
        one, two = around(ahead)
        rest += weight * (one + two)
    rest *= whole
    square, share = _mean(rest * rest / 36), _mean(whole.astype(np.float32))
    found = np.divide(square, share, out=np.full_like(square, np.inf), where=share > 0.2)
    for axis in (_DOWN, _ACROSS):
        found = np.minimum(found, np.minimum(*_pairs(found, _ASIDE)(axis)))
    return np.sqrt(np.where(np.isfinite(found), found, 0))


def _mean(picture, apart=1):
    """Of the window about each pixel, or of as many places farther apart."""
    for axis in (_DOWN, _ACROSS):
        total = picture.copy()
        for step in range(1, _AROUND + 1):
            for other in _pairs(picture, apart * step)(axis):
                total += other
        picture = total / (2 * _AROUND + 1)
    return picture


def _pass(light, most, step, same):
    """Each pixel and the means of the pairs about it, weighted as a B-spline and by how little they differ."""
    total, weights = np.zeros_like(light), np.full_like(light, 4)
    around = _pairs(light, step)
    for ahead, weight in zip(_AHEAD, (4, 4, 2, 2), strict=True):
        one, two = around(ahead)
        off = (one + two) * np.float32(0.5) - light
        share = np.divide(off, most, out=np.ones_like(off), where=same[ahead] & (most > 0))
        alike = np.maximum(1 - share * share, 0)
        alike *= weight * alike
        weights += alike
        total += alike * off
    return light + total / weights


def _levelled(light, most, step, same):
    """Peaks lowered, and pits raised, by less than `most`, to the highest, or lowest, of the places about them."""
    high, low = np.full_like(light, -np.inf), np.full_like(light, np.inf)
    around, known = _pairs(light, step), np.zeros(light.shape, np.uint8)
    for ahead in _AHEAD:
        one, two = around(ahead)
        here = same[ahead]
        known += here
        np.maximum(high, np.maximum(one, two), out=high, where=here)
        np.minimum(low, np.minimum(one, two), out=low, where=here)
    near = np.clip(light, low, high)
    return np.where((known >= _ABOUT) & (np.abs(near - light) < most), near, light)
