# SPDX-License-Identifier: GPL-3.0-or-later
"""What tones leave clear of fine things, and where a screen has no room."""

import numpy as np

from .metric import clamp01

LEAST, SURE, ALIKE, SAME_DEPTH = 0.3 * 255, 0.34 * 255, 0.08 * 255, 0.005
GROUND, MANY, SOME, SMALL, FILLED = 20, 3, 10, 7, 88
NARROW, WIDE, BESIDE = 0.7, 1.4, 2


def _sure(contrast):
    return clamp01((contrast - LEAST) / (SURE - LEAST))


def _shifted(values, dy, dx):
    """Beyond the frame its outermost pixels go on."""
    y, x = (np.clip(np.arange(n) + d, 0, n - 1) for n, d in zip(values.shape, (dy, dx), strict=True))
    return values[y][:, x]


def _about(values, reach, best, axes=(0, 1)):
    for axis in axes:
        values = best([_shifted(values, *((k, 0) if axis == 0 else (0, k))) for k in range(-reach, reach + 1)], axis=0)
    return values


def _places(reach):
    return [(v, u) for v in range(-reach, reach + 1) for u in range(-reach, reach + 1)]


def _fine(value, reach, sign):
    """(By how much light things, for sign −1 dark ones, that are short along the row or the column differ from what
    they lie on; where squares are taken away)."""
    light = sign * value

    def opened(axes):
        return _about(_about(light, reach, np.min, axes), reach, np.max, axes)

    thin = light - np.minimum(opened((0,)), opened((1,)))
    fine = thin > LEAST
    for v, u in _places(1):
        fine &= ~((_shifted(light, v, u) - light > -ALIKE) & (_shifted(thin, v, u) < 0.5 * LEAST))
    return np.where(fine, thin, 0), light - opened((0, 1))


def _whole_runs(value, depth, reach):
    """Where what is dark is short, along the row or the column, and no nearer thing nor the frame cuts it off."""
    most, out = 2 * reach + 1, np.zeros(value.shape, bool)
    wide = most + 2
    values, depths = np.pad(value, wide, mode="edge"), np.pad(depth, wide, constant_values=-1)
    beyond = np.pad(depth, wide, mode="edge")
    height, width = value.shape

    def at(plane, k, way):
        return plane[wide + k * way[0]:, wide + k * way[1]:][:height, :width]

    def run(way):
        length, ended, cut = np.zeros(value.shape, int), np.zeros(value.shape, bool), np.zeros(value.shape, bool)
        for k in range(1, most + 1):
            cut |= ~ended & (at(depths, k, way) < depth * (1 - SAME_DEPTH))
            now = ~ended & ~cut & (at(values, k, way) - value > ALIKE)
            cut |= now & (at(beyond, k + 1, way) < depth * (1 - SAME_DEPTH))
            ended |= now
            length += ~ended & ~cut
        cut |= ~ended & (at(beyond, most + 2, way) < depth * (1 - SAME_DEPTH))
        return np.where(cut, most + 1, length)

    for axis in ((0, 1), (1, 0)):
        out |= run(axis) + run(tuple(-a for a in axis)) <= 2 * reach
    return out


def _grown(mask, within, links):
    """A mask that spreads from pixel to neighbour where it may; `links`: whether it does rightwards, and downwards."""
    mask = mask & within
    right, down = links
    while True:
        more = mask.copy()
        for to, of, link in ((np.s_[:, 1:], np.s_[:, :-1], right), (np.s_[1:], np.s_[:-1], down)):
            more[to] |= mask[of] & link
            more[of] |= mask[to] & link
        more &= within
        if (more == mask).all():
            return mask
        mask = more


def _links(whether):
    """whether(one, other) by slices, of pixels beside each other and of those below each other."""
    return whether(np.s_[:, 1:], np.s_[:, :-1]), whether(np.s_[1:], np.s_[:-1])


def _labels(links):
    """Of each pixel the last of all that hang together with it."""
    labels = np.arange(links[0].shape[0] * links[1].shape[1]).reshape(links[0].shape[0], links[1].shape[1])
    while True:
        more = labels.copy()
        for to, of, link in ((np.s_[:, 1:], np.s_[:, :-1], links[0]), (np.s_[1:], np.s_[:-1], links[1])):
            for one, other in ((to, of), (of, to)):
                more[one] = np.where(link, np.maximum(more[one], more[other]), more[one])
        if (more == labels).all():
            return labels
        labels = more


def _survey(marks, labels, stroke):
    """Of what hangs together and has marks: whether it has many, is small and has some, has not many, has most."""
    count, marked = np.bincount(labels.flat), np.bincount(labels.flat, marks.flat)
    many = (MANY * marked >= count) & (marked > 0)
    some = (count <= (SMALL * stroke) ** 2) & (SOME * marked >= count) & (marked > 0) & ~many
    most = (2 * marked >= count) & many
    return many[labels], some[labels], ((marked > 0) & ~many)[labels], most[labels]


def _whole(value, fine, many, most):
    """What is fine and a whole, or in most of one: at a rim by what stands out most about it."""
    own = (fine > 0) & many | most
    best, at = value.copy(), own
    for v, u in _places(1):
        other = _shifted(value, v, u)
        at = np.where(other > best, _shifted(own, v, u), at)
        best = np.maximum(best, other)
    whole = np.where((best - value > GROUND) & (fine > 0), at, own)
    return np.where(whole, np.where(fine > 0, fine, FILLED), 0)


def _hang_together(layers, value):
    """From pixel to pixel: whether the same thing goes on. What is of one colour, too, is labelled."""
    depth, numbers = np.where(layers.there, layers.depth, 1e30), layers.object

    def goes_on(one, other):
        least = np.minimum(depth[one], depth[other])
        return layers.there[one] & layers.there[other] & (np.abs(depth[one] - depth[other]) <= SAME_DEPTH * least)

    def alike(one, other):
        return goes_on(one, other) & (np.abs(value[one] - value[other]) <= GROUND) & (numbers[one] == numbers[other])
    return _links(goes_on), _labels(_links(alike))


def _with_rims(value, ground):
    """With pixels beside it that show it, too."""
    beside = [_shifted(ground, v, u) & (np.abs(_shifted(value, v, u) - value) <= 2 * GROUND)
              for v, u in ((0, 1), (0, -1), (1, 0), (-1, 0))]
    return np.any([ground, *beside], axis=0)


def _on_light(value, dark, thin, reach):
    """Whether most of the ground in sight, which is no detail, is lighter."""
    lighter, steps = np.zeros(value.shape), [int(np.fix(3 * reach * k / 6)) for k in range(-6, 7)]
    for v, u in ((v, u) for v in steps for u in steps):
        more = (_shifted(value, v, u) - value > LEAST) & ~_shifted(thin, v, u)
        lighter += np.where(_shifted(dark, v, u), 0, np.where(more, 1, -1))
    return lighter > 0


def _kept_share(clear):
    return np.floor(255 * (1 - clear) + 0.5) / 255


def kept(layers, params):
    """Shares of the tones that are left at each pixel, fine dark things, and which are print."""
    size = params["tone_detail"]
    if not size > 0:
        return np.ones(layers.depth.shape), *np.zeros((2, *layers.depth.shape), bool)
    reach = max(1, int(min(0.5 * size * params.pixels(layers.full_height), 32)))
    wide, stroke = reach + reach // 2 + 1, 2 * reach + 1
    value = np.floor(255 * np.sqrt(clamp01(layers.albedo @ (0.2126, 0.7152, 0.0722))) + 0.5)
    inside = np.pad(np.ones(value.shape, bool), wide + 1)
    height, width = value.shape
    depth = np.where(layers.there, layers.depth, 1e30)
    goes_on, labels = _hang_together(layers, value)
    found = []
    for sign in (1, -1):
        fine, square = _fine(value, wide, sign)
        many, _, few, most = _survey(fine > 0, labels, stroke)
        square = np.where(few, 0, square)
        whole = _whole(sign * value, fine, many, most)
        sure = (whole > 0) & (_fine(value, reach, sign)[0] > 0)
        sure &= (sign > 0) | _whole_runs(value, depth, reach)
        reached = _grown(sure, _about(whole > 0, stroke, np.max), goes_on)
        found.append((np.where(reached, whole, 0), square))
    (thin, square), (dark, _) = found

    def there(v, u):
        own = inside[wide + 1 + v:, wide + 1 + u:][:height, :width]
        return own & layers.there & (np.abs(_shifted(depth, v, u) - depth) <= SAME_DEPTH * depth)

    lies = np.zeros(value.shape, bool)
    for v, u in _places(wide + 1):
        lies |= (value - _shifted(value, v, u) > LEAST) & there(v, u)
    most = _about(square, 1, np.max)
    clear = np.where(lies & (square > 0), _sure(_about(thin, wide + 2, np.max)) * _sure(most)
                     * clamp01(2 * square / np.maximum(most, 1) - 0.9), 0)
    about = np.zeros(value.shape)
    for v, u in _places(reach):
        contrast = np.minimum(_shifted(dark, v, u), value - _shifted(value, v, u))
        about = np.maximum(about, np.where((contrast > LEAST) & there(v, u),
                                           _sure(contrast) * clamp01(reach + 0.5 - np.hypot(v, u)), 0))
    many, some, _, _ = _survey(about >= 0.5, labels, stroke)
    keep = _kept_share(np.maximum(about, clear))
    many, some = _with_rims(value, many), _with_rims(value, some)
    printed = _survey((dark > 0) & _on_light(value, dark > 0, thin > 0, reach), labels, stroke)[3] & (dark > 0)
    return np.where(many | some, 0, keep), dark > 0, printed


def _near(sought, radius):
    """Whether any of what is sought is so near; `radius` by pixel."""
    most = int(radius.max())
    wide, found = np.pad(sought, most), np.zeros(sought.shape, bool)
    height, width = sought.shape
    for v, u in _places(most):
        found |= (v * v + u * u <= radius * radius) & wide[most + v:, most + u:][:height, :width]
    return found


def _depth(screen, radius):
    """How far pixels of a screen are from its end, at most `radius`."""
    most = int(radius.max())
    wide, far = np.pad(screen, most, constant_values=True), np.full(screen.shape, np.inf)
    height, width = screen.shape
    for v, u in _places(most):
        there = wide[most + v:, most + u:][:height, :width]
        far = np.where(there, far, np.minimum(far, np.hypot(v, u)))
    return np.where(screen, np.minimum(far, radius), 0)


def rooms(screens, solid, keep, dark, radius):
    """(the room that screens have at each pixel, of what they want; what they are without it); `radius`: half of how
    wide they are at least."""
    apart = (solid > 0.5) | (keep < 0.5)
    screen = ~apart & (screens > 0.5)
    enough = WIDE * radius
    part = np.floor(255 * _depth(screen, enough) / np.maximum(enough, 1e-30) + 0.5)
    high, wide = screen.shape
    edged = np.pad(part, 1, mode="edge")
    fours = [edged[y:, x:][:high + 1, :wide + 1] for y in (0, 1) for x in (0, 1)]
    fours = sum(fours)  # of the corners of pixels
    most = np.max([fours[y:, x:][:high, :wide] for y in (0, 1) for x in (0, 1)], axis=0)
    middle = np.where((part > 0) & (most > 510), np.floor((most - 509) / 2), 0)
    own, reach = middle, int(NARROW * radius.max())
    around = np.pad(middle, reach)
    for v, u in _places(reach):
        there = around[reach + v:, reach + u:][:high, :wide]
        own = np.where(v * v + u * u <= (NARROW * radius) ** 2, np.maximum(own, there), own)
    own = np.where(screen, own, 0)
    neck, room = np.minimum(4 * own, 255), own
    while True:
        edged, before = np.pad(room, 1), room
        for way in (edged[1:-1, :-2], edged[1:-1, 2:], edged[:-2, 1:-1], edged[2:, 1:-1]):
            room = np.maximum(room, np.minimum(way, neck))
        if (room == before).all():
            break
    light, cleared = ~apart & ~screen, apart & ~(solid > 0.5)
    ink = dark | _near(light, BESIDE * radius) & ~_near(cleared, radius)
    return np.where(screen, np.floor(room / 2) / 127, 1), ink
