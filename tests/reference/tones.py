# SPDX-License-Identifier: GPL-3.0-or-later
"""Tones: levels of light as dots and lines, on the screen or stuck to where the thing rests."""

import numpy as np

from . import blacks, cleared, crumbs, hatch, scatter, stipple
from .metric import clamp01, mix, value
from .shade import metered, other, painted, passed, steepness
from .tiles import pictured, thresholds

SLOTS = 6
SCREENS = ("DOTS", "LINES", "CROSS")
SHEARS, BIRTHS, STEPS, RADII = 5, 7, 33, 40
TRIES, ACROSS = 377, 233


def even(dark):
    return np.where(dark < 0.5, np.sqrt(np.maximum(dark, 0) / 2), 1 - np.sqrt(np.maximum(1 - dark, 0) / 2))


def disc(radius, distance, soft):
    r = radius / soft
    true = np.where(r > 0.57735, np.sqrt(np.maximum(r * r - 1 / 12, 0)), np.cbrt(3 * r * r) - 0.5)
    return clamp01(true - distance / soft + 0.5)


def octave(x):
    """(2^m, x / 2^m) with m the whole part of its logarithm."""
    scale = 2.0 ** np.floor(np.log2(np.clip(x, 2.0**-60, 2.0**60)))
    return scale, x / scale


def halfway(grown):
    return grown * (4 - grown) / 3


def births(grown):
    """Areas of young dots half-way to the next dot, to the next row, to both."""
    same = np.minimum(*grown) * (1 - np.maximum(*grown)) / 3
    areas = grown[0] - same, grown[1] - same, grown[0] * grown[1] + 2 * same
    return [area * (0.8 + 0.2 * area) for area in areas]


def away(at, apart, slant, young):
    """Pixels to the nearest dot of a birth, which is in one of the two rows beside."""
    row = at[1] - young[1] / 2
    best = np.inf
    for off in (row - np.floor(row), row - np.floor(row) - 1):
        along = at[0] - young[0] / 2 + off * slant
        best = np.minimum(best, np.hypot((along - np.round(along)) * apart[0], off * apart[1]))
    return best


YOUNG = (0, 0), (1, 0), (0, 1), (1, 1)


def radii(pitch, soft):
    """Radius of whole dots by how slanted rows lie, by how grown the young ones are, and by darkness: tried out on a
    cell."""
    out = np.zeros((SHEARS, BIRTHS, BIRTHS, STEPS))
    tried = np.linspace(0, 1.1 * pitch + soft, RADII + 1)
    number = np.arange(TRIES)
    across, down = number * ACROSS % TRIES / TRIES, (number + 0.5) / (2 * TRIES)
    grown = 2 - np.sqrt(4 - 3 * np.linspace(0, 1, BIRTHS))
    for place in np.ndindex(SHEARS, BIRTHS, BIRTHS):
        slant, g0, g1 = place[0] / (SHEARS - 1), grown[place[1]], grown[place[2]]
        ink = np.zeros((RADII + 1, TRIES))
        for young, share in zip(YOUNG, (1, *births((g0, g1))), strict=True):
            distance = away((across, down), (pitch * (1 + g0), pitch * (1 + g1)), slant, young)
            ink = np.maximum(ink, disc(tried[:, None] * np.sqrt(share), distance, soft))
        mean = even(ink.mean(1))
        mean[0] = 0
        out[place] = np.interp(np.linspace(0, 1, STEPS), np.maximum.accumulate(mean) + 1e-12 * np.arange(RADII + 1),
                               tried)
    return out


def looked_up(table, slant, grown, dark):
    """Between births by threes: along the diagonal they are others than beside it."""
    axes = (slant, SHEARS), (halfway(grown[0]), BIRTHS), (halfway(grown[1]), BIRTHS), (even(dark), STEPS)
    places = [np.clip(x, 0, 1) * (n - 1) for x, n in axes]
    low = [np.minimum(np.floor(p).astype(int), n - 2) for p, (_, n) in zip(places, axes, strict=True)]
    x, a, b, t = (p - at for p, at in zip(places, low, strict=True))
    less, more, first = np.minimum(a, b), np.maximum(a, b), a > b
    out = 0.0
    for shear, step in np.ndindex(2, 2):
        weight = (x if shear else 1 - x) * (t if step else 1 - t)
        for part, i, j in ((1 - more, 0, 0), (more - less, first + 0, 1 - first), (less, 1, 1)):
            out = out + weight * part * table[low[0] + shear, low[1] + i, low[2] + j, low[3] + step]
    return out


def reduced(fields):
    """The shortest steps from dot to dot, the first the shorter: (by whole numbers of both axes, on the screen) each,
    and where none show, as they are seen on their edge."""
    (_, a, b), (_, c, d) = fields
    cross = a * d - b * c
    flat = ~(cross**2 > 1e-6 * (a * a + b * b) * (c * c + d * d))
    cross, none, one = np.where(flat, 1, cross), np.zeros(cross.shape), np.ones(cross.shape)
    first = np.stack([one, none]), np.where(flat, np.stack([one, none]), np.stack([d / cross, -c / cross]))
    second = np.stack([none, one]), np.where(flat, np.stack([none, one]), np.stack([-b / cross, a / cross]))
    for _ in range(10):
        slant = (first[1] * second[1]).sum(0) / (first[1] ** 2).sum(0)
        whole = np.where(np.abs(slant) > 0.5001, np.round(slant), 0)
        second = [other - whole * one for one, other in zip(first, second, strict=True)]
        swap = (second[1] ** 2).sum(0) < (first[1] ** 2).sum(0)
        first, second = ([np.where(swap, two, one) for one, two in zip(first, second, strict=True)],
                         [np.where(swap, one, two) for one, two in zip(first, second, strict=True)])
    return first, second, flat


def spread(fields, pitch):
    """Dots as even on the screen as may be, in rows: (place in full-grown ones along rows and across, pixels between
    them, how slanted rows lie, how grown the young are, their areas, where none show)."""
    ((p, q), a), ((r, t), b), flat = reduced(fields)
    sign, square, area = p * t - q * r, (a**2).sum(0), np.abs(a[0] * b[1] - a[1] * b[0])
    back = np.floor(sign * (p * r + q * t) / (p * p + q * q) + 0.5)
    r, t, slant = sign * r - back * p, sign * t - back * q, sign * (a * b).sum(0) / square - back
    stretched = np.maximum(area / square, 1)
    m0, grown0 = octave(np.sqrt(area / stretched) / pitch)
    m1, grown1 = octave(np.sqrt(area * stretched) / pitch)
    slant = slant * m0 / m1
    turns = np.floor(slant / 2 + 0.5)
    slant = slant - 2 * turns
    rare = np.minimum(m0, m1)
    u, v = (field[0] * rare - np.floor(field[0] * rare) for field in fields)
    across = (v * p - u * q) * m1 / rare
    at = (u * t - v * r) * m0 / rare + 2 * turns * across, across
    grown = np.maximum(grown0 - 1, 0), np.maximum(grown1 - 1, 0)
    shares = births(grown)
    return at, (np.sqrt(square) / m0, area / np.sqrt(square) / m1), slant, grown, shares, flat


def lattice(fields, least, most):
    """Of points that are a pitch or up to two apart, a unit where that is between the least pitch and the most: (place
    in whole ones, these to the unit, how far those half-way between are grown, steps on the screen from one to the
    next) for both fields, (value, growth to the right, down); where none show, as they are seen on their edge; and the
    pitches."""
    (u0, a, b), (u1, c, d) = fields
    cross = a * d - b * c
    flat = ~(cross**2 > 1e-6 * (a * a + b * b) * (c * c + d * d))
    cross = np.where(flat, 1, cross)
    steps = np.stack([d / cross, -c / cross]), np.stack([-b / cross, a / cross])  # on the screen, of a unit of each
    along = [np.maximum(np.hypot(*s), 1e-30) for s in steps]
    shear = np.sqrt(np.clip(np.abs(1 / cross) / (along[0] * along[1]), 0.05, 1))
    pitch = [np.clip(length * shear, least, most) for length in along]
    scale, grown = zip(*(octave(length * shear / p) for length, p in zip(along, pitch, strict=True)), strict=True)
    return ([u * m for u, m in zip((u0, u1), scale, strict=True)], scale, [np.maximum(g - 1, 0) for g in grown],
            [s / m for s, m in zip(steps, scale, strict=True)], flat, pitch)


TRIED, LEAST, LOW = 8, 5, 1.75


def grown_dots(fields, dark, soft):
    """Dots as if painted on the thing. soft(pitch): pixels over which edges fade."""
    at, scale, grown, _, flat, pitch = lattice(fields, LEAST, 1e6)
    r = looked_up(radii(TRIED, soft(TRIED)), np.zeros(dark.shape), grown, dark)
    fade = soft(np.sqrt(pitch[0] * pitch[1]))
    size = [TRIED * (1 + g) for g in grown]
    slopes = [np.stack(fields[k][1:]) * size[k] * scale[k] for k in range(2)]
    even_slope = np.sqrt(np.abs(slopes[0][0] * slopes[1][1] - slopes[0][1] * slopes[1][0]))
    ink = np.zeros(dark.shape)
    for young, share in zip(YOUNG, (1, *births(grown)), strict=True):
        to = [size[k] * (at[k] - half / 2 - np.round(at[k] - half / 2)) for k, half in enumerate(young)]
        distance = np.hypot(*to)
        slope = np.hypot(*(to[0] * slopes[0] + to[1] * slopes[1])) / np.maximum(distance, 1e-6)
        slope = np.maximum(np.maximum(np.where(distance > 1e-6, slope, 0), 0.25 * even_slope) * fade, 1e-30)
        ink = np.maximum(ink, disc(r * np.sqrt(share) / slope, distance / slope, 1))
    (a, b), (c, d) = slopes
    steepest = np.linalg.norm(np.moveaxis(np.array([[a, b], [c, d]]), (0, 1), (-2, -1)), 2, (-2, -1))
    low = np.where(flat, 1, clamp01(2 - TRIED / (LOW * np.maximum(steepest, 1e-15))))
    return ink + (dark - ink) * (low if soft(1) >= 1 else flat)


def dots(fields, dark, pitch, soft):
    at, apart, slant, grown, shares, flat = spread(fields, pitch)
    r = looked_up(radii(pitch, soft), np.abs(slant), grown, dark)
    ink = np.zeros(dark.shape)
    for young, share in zip(YOUNG, (1, *shares), strict=True):
        ink = np.maximum(ink, disc(r * np.sqrt(share), away(at, apart, slant, young), soft))
    return np.where(flat, dark, ink)


def lines(field, dark, least, most, fade):
    u, right, down = field
    unit = 1 / np.maximum(np.hypot(right, down), 1e-18)
    pitch = np.clip(unit, least, most)
    soft = fade(pitch)
    scale, grown = octave(unit / pitch)
    at, ink = u * scale, 0.0
    period = pitch * grown
    for half, share in ((0, 1.0), (0.5, grown - 1)):
        middle = np.floor(at - half) + half
        for k in range(-2, 4):
            place, wide = (middle + k - at) * period, pitch * dark * share
            ink = ink + np.maximum(np.minimum(place + wide / 2, soft / 2) - np.maximum(place - wide / 2, -soft / 2), 0)
    return clamp01(ink / soft)


def _both(one, two):
    return one + two - one * two


def _number(of, k):
    """Of the tone of level k, the last of all further levels; those that are the same have the one before."""
    n = min(k + 1, SLOTS)
    while of(f"tone_{n}") == "SAME":
        n -= 1
    return n


def _looks(of):
    """What each level's tone looks like: those that are equal are one."""
    return [(of(f"tone_{n}"), of(f"tone_{n}_pitch"), of(f"tone_{n}_angle"), of(f"tone_{n}_space"),
             tuple(of(f"tone_{n}_color")), id(of(f"tone_{n}_image"))) for n in (_number(of, k) for k in range(SLOTS))]


def _luminance(color):
    return color @ np.array([0.2126, 0.7152, 0.0722])


def _glazed(layers):
    """How far what is mirrored lies over a colour of its own."""
    mirrors = value(layers.gloss)
    share = mirrors / np.maximum(np.maximum(value(layers.albedo - layers.color), mirrors), 1e-30)
    return share * clamp01(50 * value(layers.color) / np.maximum(1 - mirrors, 0.05))


def _lightness(of):
    return _luminance if of("tone_black_by") == "LUMINANCE" else value


def _looking(of, color):
    """Reds that are not deep are lighter than the eye has them."""
    own = _lightness(of)(color)
    return own + 0.6 * (1 - cleared.deep(color)) * np.maximum(color[..., 0] - own, 0)


def _counted(of, color, bright, black, dark):
    """How far a color is from black to dark by cube roots: deep reds and blues less."""
    first, last, own = np.cbrt(black), np.cbrt(dark), np.cbrt(np.maximum(bright, 0))
    begin = first + 0.25 * (last - first)
    span = last - begin
    with np.errstate(invalid="ignore", divide="ignore"):
        less = begin + (own - begin) * span / (span + of("tone_reds") * cleared.deep(color) * last)
        own = np.where((of("tone_reds") > 0) & (own > begin), less, own)
        return np.where(dark > black, clamp01((own - first) / (last - first)), 1)


def _compared(layers, of, spotted=None):
    """(the light that levels are compared with, where shadows are caught, whether there is a night)."""
    levels = of("shade_levels")
    end = levels[1][1] + max(levels[1][2] / 2, 1e-3) if len(levels) > 1 else 0.0

    def spared(lit, color):
        more = lit * (1 + of("tone_local") * np.maximum(2 * np.sqrt(clamp01(value(color))) - 1, 0))
        return np.maximum(lit, np.minimum(more, end))

    lit = spared(metered(layers, value(layers.diffuse)) * of("shade_exposure"), layers.color) + painted(layers)
    rest = value(other(layers))
    lightness = _lightness(of)
    left = np.maximum(1 - value(layers.gloss) * _glazed(layers), 0.05) if of("tone_black_by") == "LUMINANCE" else 1

    def kept(lit, share, bright, mirrored=0):
        own = bright / np.maximum(np.maximum(bright, mirrored), 1e-30)
        left = share / np.maximum(mix(own ** 2, 1, share), 1e-30)
        both = np.minimum(lit, 1) ** 2 * (1 - left ** 2) + left ** 2
        own = lit * left / np.sqrt(np.maximum(both, 1e-30))
        formed = mix(own, lit * np.minimum(left / 0.7, 1), of("tone_form"))
        told = np.maximum(formed, np.minimum(own, end))  # nothing gets solid
        return np.where((left < 1) & (lit > 0), told, lit)

    own, black = _looking(of, layers.color), of("tone_black") * left
    mirrored = clamp01(lightness(other(layers))) * _glazed(layers)
    black = black if spotted is None else np.where(spotted, black, 0)
    lit = kept(lit, _counted(of, layers.color, own, black, of("tone_dark") * left), own, mirrored)
    shine = rest - _glazed(layers) if spotted is None else np.where(rest > 0.5, rest, -1)
    light = np.where(own < black, np.maximum(shine, -1), np.maximum(lit, rest))
    sky = np.full(light.shape, np.inf)
    if of("tone_sky") > 0:
        bright = metered(layers, np.maximum(rest, 0)) * of("shade_exposure") * of("tone_sky")
        sky = np.where(layers.combined[..., 3] > 0, bright, np.inf)
    if of("tone_mirrors") and layers.seen_color is None:
        light = np.where((value(layers.color) < 0.05) & ~((layers.depth > 0) & (layers.depth < 1e9)), sky, light)
    elif of("tone_mirrors"):
        least = max(of("tone_black"), 0.05)
        seen = value(layers.seen_color)
        lit = metered(layers, value(other(layers)) / np.maximum(seen, least)) * of("shade_exposure")
        lit = spared(lit, layers.seen_color)
        shown = _looking(of, layers.seen_color)
        share = _counted(of, layers.seen_color, shown, least, of("tone_dark"))
        lit = np.where(shown >= least, kept(lit, share, shown), -1)
        nothing = ~((layers.seen_depth > 0) & (layers.seen_depth < 1e9))
        itself = np.abs(layers.seen_depth - layers.depth) <= 0.02 * layers.depth
        shows = ((value(layers.color) < 0.05)
                 & ((_glazed(layers) <= 0.5) | ~itself & (value(layers.gloss) >= 0.7)))
        light = np.where(shows, np.where(nothing, sky, np.maximum(light, lit)), light)
    sky = ~layers.there & (layers.combined[..., 3] > 0.999)
    bright = value(layers.combined[..., :3])
    night = bool((sky & (bright > 0)).any()) and 4 * (sky & (bright > 0.1)).sum() < sky.sum() and (
        of("tone_mirrors") and of("tone_black") > 0 and not of("tone_sky") > 0)
    if night:
        own = lightness(layers.combined[..., :3])
        seen = (own - of("tone_black")) * 2 / of("tone_black")
        light = np.where(sky, np.select([own < of("tone_black"), seen < 1], [-1, seen], np.inf), light)
    caught = ~layers.there & (value(layers.diffuse) > 0)
    return np.where(caught, metered(layers, value(layers.diffuse)) * of("shade_exposure"), light), caught, night


def _opened(layers, params, spotted):
    """The least light that pixels have in the dark: things that hardly have any are left open where they are light and
    turn to the upper left."""
    out, light, lit = (np.zeros(layers.depth.shape) for _ in range(3))
    begins, part, most = (np.zeros(out.shape) for _ in range(3))
    for number, table in enumerate(params.tables):
        of, own, levels = table.__getitem__, layers.style == number, table["shade_levels"]
        start = max(levels[1][1], 0) if len(levels) > 1 else 0
        if not (of("use_tones") and of("tone_open") > 0 and start > 0):
            continue
        compared, *_ = _compared(layers, of, spotted)
        has = np.maximum(compared, metered(layers, value(layers.diffuse)) * of("shade_exposure") + painted(layers))
        looks, black = _looking(of, layers.color), np.cbrt(of("tone_black"))
        bright = clamp01((np.cbrt(clamp01(looks)) - black) / max(1 - black, 1e-3))
        end = 2 * start if len(levels) < 3 else mix(start, levels[2][1], 0.25)
        full = _counted(of, layers.color, looks, of("tone_black"), of("tone_dark"))
        part = np.where(own, (compared >= 0) & layers.there, part)
        for to, value_ in ((light, bright), (lit, clamp01((has - start) / (0.25 * start) + 0.5)),
                           (begins, start * of("tone_open")), (most, np.minimum(max(end, start), full))):
            to[own] = np.broadcast_to(value_, own.shape)[own]
    part = part > 0
    shade, lit = np.floor(1024 * np.minimum(light / 0.83, 1) + 0.5) / 256, np.floor(255 * lit + 0.5) / 255
    less = np.zeros(out.shape)
    for thing in np.unique(layers.object[part]):
        own = part & (layers.object == thing)
        for k in range(5):
            near = np.maximum(1 - np.abs(shade - k), 0) * own
            share = (near * lit).sum() / max(near.sum(), 1e-30)
            less += near * share
    normal = layers.normal @ layers.view.T
    square = (normal ** 2).sum(-1)
    turned = np.maximum(normal @ np.array((-0.7, 0.25, 0.67)), 0) ** 2 / np.where(square > 1e-12, square, np.inf)
    return np.where(part, np.minimum(begins * turned * light * np.maximum(1 - 3 * less, 0) / 0.145, most), 0)


def _lit(layers, of, spotted, opened):
    light, caught, night = _compared(layers, of, spotted)
    return np.where(light >= 0, np.maximum(light, opened), light), caught, night


def _beside(light):
    """The least and the most of each pixel and the four beside it."""
    around = np.pad(light, 1, mode="edge")
    every = np.stack([light, around[:-2, 1:-1], around[2:, 1:-1], around[1:-1, :-2], around[1:-1, 2:]])
    return every.min(0), every.max(0)


def _settled(layers, params, spotted, opened):
    """(the light of all pixels without crumbs, what is spotted then); None where crumbs stay."""
    size = params["tone_crumbs"] * params.pixels(layers.full_height)
    if not size:
        return None, spotted
    light, begins, inks = (np.zeros(layers.depth.shape) for _ in range(3))
    ends = np.zeros(light.shape)
    for number, table in enumerate(params.tables):
        of, own, levels = table.__getitem__, layers.style == number, table["shade_levels"]
        solid = of("use_tones") and len(levels) > 1 and (spotted is not None or of("tone_1") == "SOLID")
        light[own], inks[own] = _lit(layers, of, spotted, opened)[0][own], solid
        begins[own] = levels[1][1] if solid else 0
        ends[own] = levels[1][1] + max(levels[1][2] / 2, 1e-3) if solid else 0
    ink = light < begins if spotted is None else spotted & (light < 0)
    return crumbs.settled(layers, light, np.where(inks > 0, 1 + ink, 0), ends, size, spotted)


def _dark(layers, levels, of, look, spotted=None, opened=0, settled=None):
    """(share, darkness) of a tone at each pixel."""
    light, caught, night = _lit(layers, of, spotted, opened)
    light = light if settled is None else settled
    added = 0.0 if look[0] == "GRAIN" else layers.controls["hatching"]
    clipped = np.clip(light, None if spotted is None else 0, np.inf)
    steep = 0 if of("tone_crisp") else steepness(np.clip(clipped, None, 1e6))
    least, most = (light, light) if of("tone_crisp") else _beside(clipped)

    def past(threshold, transition):
        share = passed(light, threshold, transition, steep)
        if transition > 1e-30:
            return share
        return np.where(least > threshold, 1, np.where(most < threshold, 0, share))

    share, total = np.zeros(light.shape), np.zeros(light.shape)
    for k, level in enumerate(levels):
        if _looks(of)[min(k + (spotted is not None), SLOTS - 1)] != look:
            continue

        here = (past(*level[1:3]) if k else 1.0) - (past(*levels[k + 1][1:3]) if k < len(levels) - 1 else 0.0)
        here = np.maximum(here, 0) * np.ones(light.shape)
        brighter = level[0]
        if k < len(levels) - 1:
            start, end = level[1] if k else 0.0, levels[k + 1][1]
            along = clamp01((light - start) / (end - start)) if end > start else 0.0
            brighter = mix(level[0], levels[k + 1][0], of(f"tone_{_number(of, k)}_gradient") * along)
        share += here
        total += here * clamp01(1 - brighter + of("tone_darkness") + added)
    if spotted is not None:
        own = spotted & (light < 0)
        first = float(look == _looks(of)[0])
        share, total = np.where(own, first, share), np.where(own, first * clamp01(1 + of("tone_darkness")), total)
    shows_sky = night or of("tone_mirrors") and of("tone_sky") > 0
    share = np.where(layers.there | caught | shows_sky, share, 0)
    dark = clamp01(np.where(share > 0, total / np.maximum(share, 1e-30), 0))
    if shows_sky and look[3] != "SCREEN":
        dark = np.where(layers.there | caught, dark, dark >= 0.5)
    if look[0] == "HATCH":
        dark = dark * clamp01((dark - 0.02) / 0.03)
    return clamp01(share), dark


def _sheet(card):
    """What the layer anchor would tell of sheets that stand upright in x and z."""
    if card is None:
        return None
    anchor = np.zeros((*card.shape[:2], 16))
    anchor[..., (0, 2)], anchor[..., 4], anchor[..., 6] = card[..., :2], -1, np.hypot(*np.moveaxis(card[..., 2:], 2, 0))
    anchor[..., (7, 9)], anchor[..., 10], anchor[..., 12] = card[..., 2:], card[..., 3], -card[..., 2]
    return anchor


def _light(of):
    if of("tone_strokes") != "LIGHT":
        return None
    turn, height = np.radians(of("tone_light_direction")), np.radians(of("tone_light_height"))
    return np.array((np.cos(turn) * np.cos(height), np.sin(turn) * np.cos(height), np.sin(height)))


def _ink(layers, of, look, dark, scale, paper, own):
    kind, pitch, angle, space = look[:4]
    painted_on = space == "OBJECT"
    own_pitch = 0.01 * pitch
    unit = own_pitch if painted_on and kind != "STIPPLE" else 1  # of a field on the thing
    pitch, c, s = _pitch(of, look, layers, scale)
    pitch = max(2.0, pitch)

    def soft(pitch):
        return 0.002 + 0 * pitch if of("tone_crisp") else 1 + 0 * pitch

    height, width = dark.shape
    anchor = {"SCREEN": None, "FLAT": _sheet(layers.card)}.get(space, layers.anchor)

    def screen(right, down):
        each = {"HATCH": max(pitch, 3), "STIPPLE": 1}.get(kind, pitch)
        right, down = right / each, down / each
        y, x = np.mgrid[:height, :width]
        return right * (x + layers.x + 0.5) + down * (y + layers.y + 0.5), right + 0 * x, down + 0 * x

    def surface(direction):
        return tuple(anchor[..., k:k + 3] @ np.asarray(direction) / unit for k in (0, 7, 10))

    if kind == "SOLID":
        return (dark > 0).astype(float)
    if kind == "GRAIN":
        return hatch.cover(layers, of, 1 - dark, paper)

    def chart(c, s, axis=None):
        if anchor is None:
            return screen(c, -s), screen(s, c)
        axis = scatter.axes(anchor)[0] if axis is None else axis
        first, second = np.where(axis == 0, 1, 0), np.where(axis == 2, 1, 2)

        def turned(one, two):
            def along(k):
                return (one * np.take_along_axis(anchor, (k + first)[..., None], 2)
                        + two * np.take_along_axis(anchor, (k + second)[..., None], 2))[..., 0] / unit
            return along(0), along(7), along(10)

        return turned(c, s), turned(-s, c)

    if kind in ("DOTS", "HATCH", "STIPPLE", "IMAGE"):
        if kind == "DOTS":
            ink = grown_dots(chart(c, s), dark, soft) if painted_on else dots(chart(c, s), dark, pitch, soft(pitch))
        elif kind == "IMAGE":
            image = next(of(f"tone_{n}_image") for n in range(1, SLOTS + 1) if id(of(f"tone_{n}_image")) == look[5])
            tile = thresholds(image, pitch)
            bounds = (tile.shape[1], 1e6) if painted_on else (pitch, pitch)
            ink = pictured(tile, lattice(chart(c, s), *bounds), dark, of("tone_crisp"))
        else:
            apart = max(pitch * (0.5 if kind == "STIPPLE" else 1), 3)
            bounds = (3, max(40 * scale, 3)) if painted_on else (apart, apart)
            axes = (None,) if anchor is None else scatter.axes(anchor)
            if kind == "STIPPLE":
                ink = stipple.Spots(layers, [(axis, chart(1, 0, axis)) for axis in axes], dark, bounds,
                                    0.5 * own_pitch if painted_on else 1,
                                    None if anchor is None else scatter.Seams(anchor), of("tone_crisp")).draw(own)
            else:
                turn = np.radians(angle) + np.arctan2(0.3511234, 0.9363292)
                ink = scatter.Drawing(layers, bounds, np.radians(angle), anchor,
                                      (axes[0], chart(np.cos(turn), np.sin(turn), axes[0])), dark, lattice,
                                      of("tone_crisp"), _light(of), of("tone_strokes") == "UV" and space != "FLAT",
                                      space == "FLAT", scale).draw(own)
        return ink if anchor is None else np.where(anchor[..., 6] > 0, ink, dark)
    first = 1 - np.sqrt(1 - dark) if kind == "CROSS" else dark
    if anchor is None:
        ink = lines(screen(s, c), first, pitch, pitch, soft)
        return _both(ink, lines(screen(c, -s), first, pitch, pitch, soft)) if kind == "CROSS" else ink
    across = np.array((s + 0.15, 0.1, c))
    across /= np.linalg.norm(across)
    other_way = np.cross(across, (0.6, 0.75, 0.2))
    other_way /= np.linalg.norm(other_way)
    dot = anchor[..., 3:6] @ across
    first = first * clamp01((np.sqrt(np.maximum(1 - dot * dot, 0)) - 0.3) / 0.12)
    second = np.where(first < 1, clamp01(1 - (1 - dark) / np.maximum(1 - first, 1e-30)), 0)
    bounds = (LEAST, 1e6) if painted_on else (pitch, pitch)
    ink = _both(lines(surface(across), first, *bounds, soft), lines(surface(other_way), second, *bounds, soft))
    return np.where(anchor[..., 6] > 0, ink, dark)


def _pitch(of, look, layers, scale):
    """Pixels, at any size; and the screen's cosine and sine."""
    kind, pitch, angle, space = look[:4]
    pitch = 25.4 * layers.full_height / (of("page_height") * pitch) if of("tone_pitch_unit") == "LPI" else pitch * scale
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    if of("tone_crisp") and space == "SCREEN" and kind in SCREENS and np.hypot(*np.round((pitch * c, pitch * s))) >= 2:
        whole = np.round(pitch * c), np.round(pitch * s)  # pixels
        pitch = np.hypot(*whole)
        c, s = whole[0] / pitch, whole[1] / pitch
    return pitch, c, s


def _rooms(layers, params, keep, scale, spotted, opened, settled):
    """What screens have at each pixel."""
    if not params["tone_least"] > 0:
        return np.ones(keep[0].shape), 0
    screens, solid, radius = (np.zeros(keep[0].shape) for _ in range(3))
    for number, table in enumerate(params.tables):
        of, own = table.__getitem__, layers.style == number
        if not of("use_tones"):
            continue
        looks = _looks(of)
        screen = [look[0] in SCREENS and look[3] != "OBJECT" for look in looks]
        pitch = max((_pitch(of, look, layers, scale)[0] for look, is_one in zip(looks, screen, strict=True) if is_one),
                    default=0)
        radius = np.where(own, min(0.5 * params["tone_least"] * pitch, 60), radius)
        for look in {look for look, is_one in zip(looks, screen, strict=True) if is_one or look[0] == "SOLID"}:
            share, dark = _eased(*_dark(layers, of("shade_levels"), of, look, spotted, opened, settled), look[0], keep)
            (solid if look[0] == "SOLID" else screens)[own] += np.where(dark > 0, share, 0)[own]
    return cleared.rooms(layers, screens, solid, np.minimum(keep[0], keep[1]) < 0.5, keep[2], radius)


def _eased(share, dark, kind, keep):
    """With what is left of them of what is cleared: dots and strokes of the darkness, of others all or nothing."""
    eases = kind in SCREENS or kind in ("HATCH", "STIPPLE")
    return share * keep[0] * (1 if eases else keep[1] > 127 / 255), dark * (keep[1] if eases else 1)


def _fitted(dark, rooms):
    """With less room than they want screens grow to ink, or shrink to paper."""
    room, more = rooms
    return np.minimum(1, dark * room + more)


def fill(layers, params, surface, paper):
    """(the surface (H, W, 4) with its tones, these alone). paper: as for hatching."""
    drawn, alone = surface.copy(), np.zeros(surface.shape)
    clear = ~layers.there & (value(layers.diffuse) > 0) & (drawn[..., 3] < 1) & (params["surface"] == "PAPER")
    scale = params.pixels(layers.full_height)
    keep = cleared.kept(layers, params)
    spotted = blacks.spotted(layers, params, _looking) if params["tone_black_widest"] > 0 else None
    opened = _opened(layers, params, spotted)
    settled, spotted = _settled(layers, params, spotted, opened)
    rooms = _rooms(layers, params, keep, scale, spotted, opened, settled)
    for number, table in enumerate(params.tables):
        of, own = table.__getitem__, layers.style == number
        if not of("use_tones"):
            continue
        drawn[own & clear] = 0
        looks = _looks(of)
        for k, look in reversed(list(enumerate(looks))):
            if look[0] == "NONE" or look in looks[:k]:
                continue
            share, dark = _eased(*_dark(layers, of("shade_levels"), of, look, spotted, opened, settled), look[0], keep)
            if not (dark > 0).any():
                continue
            if look[0] in ("HATCH", "STIPPLE"):
                printed, around = (dark > 0.5) * keep[3], np.where(dark > 2 / 3, keep[4], (dark > 0) * keep[5])
                ink = _ink(layers, of, look, dark + (1 - dark) * printed, scale, paper, own)
                ink = np.where(printed >= 250 / 255, 1, np.maximum(ink, around))
            elif look[0] in SCREENS:
                ink = np.maximum(_ink(layers, of, look, _fitted(dark, rooms), scale, paper, own), (dark > 0) * keep[5])
            else:
                ink = _ink(layers, of, look, dark, scale, paper, own)
            t = np.where(own, ink * share, 0)[..., None]
            t = np.where(t >= 0.5, 1.0, 0.0) if of("tone_crisp") else t
            drawn[..., 3:] = np.where(clear[..., None], mix(drawn[..., 3:], 1, t), drawn[..., 3:])
            alpha = np.where(clear[..., None], 1, surface[..., 3:])
            drawn[..., :3] = mix(drawn[..., :3], np.array(look[4]) * alpha, t)
            ink = np.concatenate([np.array(look[4]) * alpha, alpha], -1)
            alone = mix(alone, ink, t)
    return drawn, alone
