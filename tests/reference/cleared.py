# SPDX-License-Identifier: GPL-3.0-or-later
"""What tones leave clear of fine things, and where a screen has no room."""

import numpy as np

from .metric import clamp01

LEAST, SURE, ALIKE, SAME_DEPTH = 0.3 * 255, 0.34 * 255, 0.08 * 255, 0.005
GROUND, MANY, SOME, SMALL, WHOLE, FILLED = 20, 3, 10, 7, 6, 88
TWO_EYES, WORD, ROUND = 12, 15, 0.45
SLANTED, FLAT_SHARE = 0.97, 0.6
NARROW, WIDE, BESIDE = 0.7, 1.4, 2
FINE = 0.35, 0.525


def deep(color):
    """How deep a red or a blue is."""
    most, other = np.maximum(color[..., 1], color[..., 2]), np.maximum(color[..., 0], color[..., 1])
    return clamp01(np.maximum((color[..., 0] - 2.6 * most) / np.maximum(most, 1e-37),
                              (color[..., 2] - 1.6 * other) / np.maximum(other, 1e-37)))


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


def _lengths(value, fine, depth, reach, sign):
    """How long what differs by `fine` from its ground is along the row or the column, in pixels of its most contrast;
    infinite where it is longer than is looked for, or cut off by the frame or, of what is dark, by a nearer thing."""
    most = 2 * reach + 1
    wide = most + 2
    values, depths = np.pad(sign * value, wide, mode="edge"), np.pad(depth, wide, mode="edge")
    inside, ground = np.pad(np.ones(value.shape, bool), wide), sign * value - fine
    height, width = value.shape

    def at(plane, k, way):
        return plane[wide + k * way[0]:, wide + k * way[1]:][:height, :width]

    def nearer(k, way):
        return (sign < 0) & (at(depths, k, way) < depth * (1 - SAME_DEPTH))

    def along(way):
        total, best, lost = fine.astype(float), fine.astype(float), np.zeros(value.shape, bool)
        for side in (way, tuple(-a for a in way)):
            goes = np.ones(value.shape, bool)
            for k in range(1, most + 1):
                more = at(values, k, side) - ground
                total += np.where(goes, np.maximum(more, 0), 0)
                best = np.where(goes, np.maximum(best, more), best)
                ends = goes & (2 * more < best)
                lost |= goes & (~at(inside, k, side) | nearer(k, side)) | ends & nearer(k + 1, side)
                goes &= ~ends
            lost |= goes
        return np.where(lost, np.inf, total / np.maximum(best, 1))

    return np.minimum(along((0, 1)), along((1, 0)))


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


def _survey(marks, labels):
    """(how many pixels hang together with each, share of them that is marked, by 0..1), where any is; else NaN."""
    count, marked, total = (np.bincount(labels.flat, by.flat) for by in (np.ones(marks.shape), marks > 0, marks))
    return (np.where(marked > 0, count, np.nan)[labels],
            *(np.where(marked > 0, by / np.maximum(count, 1), np.nan)[labels] for by in (marked, total)))


def _most(share):
    return clamp01(4 * share - 3.5)


def _flatness(details, labels, normal):
    """Whether words lie in one plane: by how many of their pixels face as all do in the mean."""
    size = np.linalg.norm(normal, axis=-1)
    way = np.fix(1000 * normal / np.where(size > 0, size, 1)[..., None]) * details[..., None]
    mean = np.stack([np.bincount(labels.flat, way[..., c].flat, labels.size) for c in range(3)], -1)[labels]
    along = details & ((way * mean).sum(-1) > 1000 * SLANTED * np.linalg.norm(mean, axis=-1))
    count, facing = (np.bincount(labels.flat, of.flat, labels.size) for of in (details, along))
    return (facing > FLAT_SHARE * count)[labels]


def _words(details, sure, around, goes_on, value, within, normal):
    """(How sure each detail is: twice the mean over its word of how surely pixels are, weighted by itself; how
    surely its word is strokes: by how many times they are as long as wide; they have no edge beside what is within
    and darker than what they lie on; and whether it lies in one plane.)"""
    labels = _labels(tuple(link & around[to] & around[of] for link, to, of in zip(
        goes_on, (np.s_[:, 1:], np.s_[1:]), (np.s_[:, :-1], np.s_[:-1]), strict=True)))
    count, total, squares = (np.bincount(labels.flat, by.flat) for by in (
        details.astype(float), np.where(details, sure, 0), np.where(details, sure, 0) ** 2))
    own = 2 * squares / np.maximum(total, 1e-9) * np.minimum(1, WHOLE * total / np.maximum(255 * count, 1))
    edges, sums = np.zeros((2, count.size)), np.zeros((2, count.size))
    for v, u in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        for k, beside in enumerate((~_shifted(within, v, u), _shifted(within, v, u))):
            ends = details & ~_shifted(details, v, u) & beside
            edges[k] += np.bincount(labels.flat, ends.flat, count.size)
            sums[k] += np.bincount(labels.flat, (ends * _shifted(value, v, u)).flat, count.size)
    about, inner = sums / np.maximum(edges, 1)
    pupil = np.where(edges[0] > 0, clamp01((about - inner - 2) / 4), 0)
    length = (edges[0] + (1 - pupil) * edges[1]) ** 2 / np.maximum(4 * count, 1)
    strokes = ROUND + (1 - ROUND) * clamp01((length - TWO_EYES) / (WORD - TWO_EYES))
    strokes = np.floor(255 * strokes + 0.5) / 255
    return (np.where(details, np.floor(np.minimum(own, 255) + 0.5)[labels], 0), strokes[labels],
            _flatness(details, labels, normal))


def _level(share):
    """How far so many are enough: from a quarter on, in 254ths."""
    return np.nan_to_num(np.floor(254 * clamp01(6 * share - 1.5) + 0.5)) / 254


def _whole(value, fine, whole):
    """(What is fine and of a whole; how far that is one): at a rim by what stands out most about it."""
    best, at = value.copy(), whole
    for v, u in _places(1):
        other = _shifted(value, v, u)
        at = np.where(other > best, _shifted(whole, v, u), at)
        best = np.maximum(best, other)
    whole = np.where((best - value > GROUND) & (fine > 0), at, whole)
    return np.where((fine > 0) & (whole > 0), fine, np.where(whole >= 1, FILLED, 0)), whole


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
    beside = [np.where(np.abs(_shifted(value, v, u) - value) <= 2 * GROUND, _shifted(ground, v, u), 0)
              for v, u in ((0, 1), (0, -1), (1, 0), (-1, 0))]
    return np.max([ground, *beside], axis=0)


def _prints(value, depth, own, others, reach, sign):
    """Whether most of the ground in sight on which it may lie, which is no detail, is lighter, for sign −1 darker."""
    lighter, steps = np.zeros(value.shape), [int(np.fix(3 * reach * k / 6)) for k in range(-6, 7)]
    rows, columns = np.indices(value.shape)
    for v, u in ((v, u) for v in steps for u in steps):
        other, away = _shifted(depth, v, u), np.maximum(*(np.abs(_shifted(at, v, u) - at) for at in (rows, columns)))
        ground = ~_shifted(own, v, u) & (np.abs(other - depth) <= SAME_DEPTH * away * np.minimum(other, depth))
        more = (sign * (_shifted(value, v, u) - value) > GROUND) & ~_shifted(others, v, u)
        lighter += np.where(ground, np.where(more, 1, -1), 0)
    return own & (lighter > 0)


def _kept_share(clear):
    return np.floor(255 * (1 - clear) + 0.5) / 255


def kept(layers, params):
    """Shares of the tones that are left at each pixel, and of their darkness; fine dark things, how far they are print,
    and how far what is about light print, and that on boards."""
    size = params["tone_detail"]
    if not size > 0:
        return *np.ones((2, *layers.depth.shape)), *np.zeros((4, *layers.depth.shape), bool)
    reach = max(1, int(min(0.5 * size * params.pixels(layers.full_height), 32)))
    wide, stroke = reach + reach // 2 + 1, 2 * reach + 1
    value = np.floor(255 * np.sqrt(clamp01(layers.albedo @ (0.2126, 0.7152, 0.0722))) + 0.5)
    inside = np.pad(np.ones(value.shape, bool), wide + 1)
    height, width = value.shape
    depth = np.where(layers.there, layers.depth, 1e30)
    goes_on, labels = _hang_together(layers, value)
    found, within = [], _fine(value, wide, -1)[0] > 0
    for sign in (1, -1):
        fine, square = _fine(value, wide, sign)
        length = _lengths(value, fine, depth, wide, sign)
        sure = np.where(fine > 0, np.floor(255 * clamp01((stroke - length) / (wide - reach) + 0.5) + 0.5), 0)
        _, share, _ = _survey(fine, labels)
        square = np.where(_level(share) + np.isnan(share) > 0, square, 0)
        whole, level = _whole(sign * value, fine, _level(share))
        sure, strokes, flat = _words(whole > 0, np.floor(sure * level + 0.5), _about(whole > 0, stroke, np.max),
                                     goes_on, value, within, layers.normal)
        fine = np.where(sure > 0, whole, 0)
        found.append((fine, sure / 255, square, strokes if sign > 0 else 1, (fine > 0) & flat))
    (thin, light_sure, square, strokes, flat), (dark, dark_sure, _, one, _) = found

    def there(v, u):
        own = inside[wide + 1 + v:, wide + 1 + u:][:height, :width]
        return own & layers.there & (np.abs(_shifted(depth, v, u) - depth) <= SAME_DEPTH * depth)

    lies = np.zeros(value.shape, bool)
    for v, u in _places(wide + 1):
        lies |= (value - _shifted(value, v, u) > LEAST) & there(v, u)
    most = _about(square, 1, np.max)
    near, sure = (_about(of, wide + 2, np.max) for of in (thin, light_sure))
    clear = np.where(lies & (square > 0), _sure(near) * sure * _sure(most)
                     * clamp01(2 * square / np.maximum(most, 1) - 0.9), 0)

    def around(things, sure, sign, reach):
        best = np.zeros(value.shape)
        for v, u in _places(reach):
            contrast = np.minimum(_shifted(things, v, u), sign * (_shifted(value, v, u) - value))
            best = np.maximum(best, np.where((contrast > LEAST) & there(v, u), _sure(contrast) * clamp01(
                (reach + 0.5) * _shifted(sure, v, u) - np.hypot(v, u)), 0))
        return best

    about = around(dark, dark_sure, -1, reach)
    count, _, share = _survey(1 - _kept_share(np.minimum(1, 2 * about)), labels)
    patch = _most(SOME * share) * _most((SMALL * stroke) ** 2 / count)
    ground = np.nan_to_num(np.floor(254 * np.maximum(_most(MANY * share), patch) + 0.5))
    ground = np.where(ground > 0, ground + 1, 0) / 255
    keep, ease = _kept_share(np.maximum(about, clear)), 1 - np.where(value > 76, _with_rims(value, ground), 0)
    printed, chalked = (np.where(own > 0, _kept_share(1 - sure * _level(
        _survey(_prints(value, depth, own > 0, others > 0, reach, sign), labels)[1]) * lines), 0)
                        for own, others, sure, lines, sign in (
                            (dark, thin, dark_sure, one, 1), (thin, dark, light_sure, strokes, -1)))
    ground = 1 - _kept_share(around(thin, chalked, 1, wide))
    reds = np.array([table["tone_reds"] for table in params.tables])[layers.style]
    board = value ** 2 <= LEAST ** 2 * (1 + reds * deep(layers.albedo))
    board &= (_about(printed, 2 * (wide + 2), np.max) < 128 / 255)
    board &= _about(flat, wide, np.max)
    return keep, ease, dark_sure > 127 / 255, printed, ground, board * ground


def _sum(values, reach):
    """Of the pixels so far about each, in a square; beyond the frame is none."""
    for axis in (0, 1):
        ends = np.cumsum(np.pad(values, [(reach + 1, reach) if k == axis else (0, 0) for k in (0, 1)]), axis)
        n = values.shape[axis]
        values = np.take(ends, np.arange(n) + 2 * reach + 1, axis) - np.take(ends, np.arange(n), axis)
    return values


def _depth(screen, radius):
    """How far pixels of a screen are from its end, at most `radius`."""
    most = int(radius.max())
    wide, far = np.pad(screen, most, constant_values=True), np.full(screen.shape, np.inf)
    height, width = screen.shape
    for v, u in _places(most):
        there = wide[most + v:, most + u:][:height, :width]
        far = np.where(there, far, np.minimum(far, np.hypot(v, u)))
    return np.where(screen, np.minimum(far, radius), 0)


def _widest(values, radius, reach):
    """The most within a radius by pixel, at most `reach`."""
    high, wide = values.shape
    around, most = np.pad(values, reach), values
    for v, u in _places(reach):
        there = around[reach + v:, reach + u:][:high, :wide]
        most = np.where(v * v + u * u <= radius * radius, np.maximum(most, there), most)
    return most


def rooms(layers, screens, solid, clear, dark, radius):
    """(how much of its darkness a screen keeps at each pixel; how much is added to it); `radius`: half of how wide they
    are at least."""
    inked = solid > 0.5
    screen = ~inked & ~clear & (screens > 0.5)
    light = ~inked & ~clear & ~screen
    enough = WIDE * radius
    part = np.floor(255 * _depth(screen, enough) / np.maximum(enough, 1e-30) + 0.5)
    high, wide = screen.shape
    edged = np.pad(part, 1, mode="edge")
    fours = [edged[y:, x:][:high + 1, :wide + 1] for y in (0, 1) for x in (0, 1)]
    fours = sum(fours)  # of the corners of pixels
    most = np.max([fours[y:, x:][:high, :wide] for y in (0, 1) for x in (0, 1)], axis=0)
    middle = np.where((part > 0) & (most > 510), np.floor((most - 509) / 2), 0)
    own = np.where(screen, _widest(middle, NARROW * radius, int(NARROW * radius.max())), 0)
    neck, room = np.minimum(4 * own, 255), own
    step = 255 // (int(BESIDE * radius.max()) + 1)
    while True:
        edged, before = np.pad(room, 1), room
        for way in (edged[1:-1, :-2], edged[1:-1, 2:], edged[:-2, 1:-1], edged[2:, 1:-1]):
            room = np.where(screen, np.maximum(room, np.maximum(np.minimum(way, neck), way - step)), 0)
        if (room == before).all():
            break
    at_light, at_dark, within = (np.zeros(screen.shape, int) for _ in range(3))
    for v, u in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        other, near, there = (_shifted(plane, v, u) for plane in (layers.depth, clear & ~inked, layers.there))
        with np.errstate(invalid="ignore"):
            beside = np.abs(other - layers.depth) <= SAME_DEPTH * np.minimum(other, layers.depth)
        same = (_shifted(layers.object, v, u) == layers.object) | (there & layers.there & beside)
        ends = screen & ~_shifted(screen, v, u)
        at_light |= ends & _shifted(light, v, u)
        at_dark |= ends & ~_shifted(light, v, u)
        within |= ends & ~near & same
    reach = int(BESIDE * radius.max()) + 1
    at_light, at_dark, within = (_sum(plane, reach) for plane in (at_light, at_dark, within))
    ends = np.maximum(at_light + at_dark, 1)
    half = _widest(part, NARROW * radius, int(NARROW * radius.max())) * WIDE / 255
    line = clamp01((FINE[1] - half) / (FINE[1] - FINE[0]))
    less = (1 - room / 255) * (1 + (line - 1) * clamp01(4 * within / ends - 2))
    ink = np.where(dark, 1, clamp01(8 * at_light / ends - 5))
    less = np.where(screen & (room < 255), less, 0)
    return np.floor(255 * (1 - less) + 0.5) / 255, np.floor(255 * ink * less + 0.5) / 255
