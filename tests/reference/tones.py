# SPDX-License-Identifier: GPL-3.0-or-later
"""Tones: levels of light as dots and lines, on the screen or stuck to where the thing rests."""

import numpy as np

from . import hatch, scatter
from .metric import clamp01, mix, value
from .shade import other, painted

SLOTS = 4
BIRTHS, STEPS, RADII, SAMPLES = 11, 33, 40, 12


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


def radii(pitch, soft):
    """Radius of whole dots by how grown the young ones along both axes are, and by darkness: tried out on a cell."""
    out = np.zeros((BIRTHS, BIRTHS, STEPS))
    tried = np.linspace(0, 1.1 * pitch + soft, RADII + 1)
    number = np.arange(SAMPLES)
    down = np.repeat((number[:, None] + 0.5) / (2 * SAMPLES), SAMPLES, 1)
    across = (number + (0.618034 * number[:, None]) % 1) / (2 * SAMPLES)  # rows are shifted against each other
    for i, h0 in enumerate(np.linspace(0, 1, BIRTHS)):
        for j, h1 in enumerate(np.linspace(0, 1, BIRTHS)):
            x, y = across * pitch * (1 + h0**2), down * pitch * (1 + h1**2)
            ink = np.zeros((RADII + 1, SAMPLES, SAMPLES))
            for dx, w0 in ((0, 1), (0.5 * pitch * (1 + h0**2), h0)):
                for dy, w1 in ((0, 1), (0.5 * pitch * (1 + h1**2), h1)):
                    distance = np.hypot(x - dx, y - dy)
                    ink = np.maximum(ink, disc(tried[:, None, None] * w0 * w1, distance, soft))
            mean = even(ink.mean((1, 2)))
            mean[0] = 0
            out[i, j] = np.interp(np.linspace(0, 1, STEPS), np.maximum.accumulate(mean) + 1e-12 * np.arange(RADII + 1),
                                  tried)
    return out


def looked_up(table, h0, h1, dark):
    out = 0.0
    places = [np.clip(x, 0, 1) * (n - 1) for x, n in ((h0, BIRTHS), (h1, BIRTHS), (even(dark), STEPS))]
    low = [np.minimum(np.floor(p).astype(int), n - 2) for p, n in zip(places, table.shape, strict=True)]
    for corner in np.ndindex(2, 2, 2):
        weight = 1.0
        for c, p, a in zip(corner, places, low, strict=True):
            weight = weight * (p - a if c else 1 - (p - a))
        out = out + weight * table[tuple(a + c for a, c in zip(low, corner, strict=True))]
    return out


def lattice(fields, pitch):
    """Of points that are a pitch or up to two apart: (place in whole ones, these to the unit, how far those half-way
    between are grown, steps on the screen from one to the next) for both fields, (value, growth to the right, down);
    and where none show, as they are seen on their edge."""
    (u0, a, b), (u1, c, d) = fields
    cross = a * d - b * c
    flat = ~(cross**2 > 1e-6 * (a * a + b * b) * (c * c + d * d))
    cross = np.where(flat, 1, cross)
    steps = np.stack([d / cross, -c / cross]), np.stack([-b / cross, a / cross])  # on the screen, of a unit of each
    along = [np.maximum(np.hypot(*s), 1e-30) for s in steps]
    shear = np.sqrt(np.clip(np.abs(1 / cross) / (along[0] * along[1]), 0.05, 1))
    scale, grown = zip(*(octave(length * shear / pitch) for length in along), strict=True)
    return ([u * m for u, m in zip((u0, u1), scale, strict=True)], scale, [np.maximum(g - 1, 0) for g in grown],
            [s / m for s, m in zip(steps, scale, strict=True)], flat)


def dots(fields, dark, pitch, soft):
    at, _, grown, step, flat = lattice(fields, pitch)
    root = [np.sqrt(g) for g in grown]
    r = looked_up(radii(pitch, soft), root[0], root[1], dark)
    ink = np.zeros(dark.shape)
    for half0 in (0, 0.5):
        for half1 in (0, 0.5):
            part = [at[0] - half0, at[1] - half1]
            part = [p - np.floor(p) for p in part]
            best = np.full(dark.shape, np.inf)
            for i, j in np.ndindex(2, 2):
                x, y = (i - part[0]) * step[0] + (j - part[1]) * step[1]
                best = np.minimum(best, np.hypot(x, y))
            weight = (root[0] if half0 else 1) * (root[1] if half1 else 1)
            ink = np.maximum(ink, disc(r * weight, best, soft))
    return np.where(flat, dark, ink)


def lines(field, dark, pitch, soft):
    u, right, down = field
    scale, grown = octave(1 / np.maximum(np.hypot(right, down) * pitch, 1e-18))
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


def _looks(of):
    """What each level's tone looks like, the last that of all further levels: those that are equal are one."""
    return [(of(f"tone_{n}"), of(f"tone_{n}_pitch"), of(f"tone_{n}_angle"), of(f"tone_{n}_space"),
             tuple(of(f"tone_{n}_color"))) for n in range(1, SLOTS + 1)]


def _dark(layers, levels, of, look):
    """(share, darkness) of a tone at each pixel."""
    lit = value(layers.diffuse) * of("shade_exposure") + painted(layers)
    light = np.maximum(np.where(value(layers.color) < of("tone_black"), -1, lit), value(other(layers)))
    added = 0.0 if look[0] == "GRAIN" else layers.controls["hatching"]
    share, total = np.zeros(light.shape), np.zeros(light.shape)
    for k, level in enumerate(levels):
        n = min(k, SLOTS - 1)
        if _looks(of)[n] != look:
            continue

        def passed(steps):
            if steps[2] > 1e-30:
                return clamp01((light - steps[1]) / steps[2] + 0.5)
            return (light > steps[1]).astype(float)

        here = (passed(level) if k else 1.0) - (passed(levels[k + 1]) if k < len(levels) - 1 else 0.0)
        here = np.maximum(here, 0) * np.ones(light.shape)
        brighter = level[0]
        if k < len(levels) - 1:
            start, end = level[1] if k else 0.0, levels[k + 1][1]
            along = clamp01((light - start) / (end - start)) if end > start else 0.0
            brighter = mix(level[0], levels[k + 1][0], of(f"tone_{n + 1}_gradient") * along)
        share += here
        total += here * clamp01(1 - brighter + of("tone_darkness") + added)
    share = np.where(layers.there, share, 0)
    return clamp01(share), clamp01(np.where(share > 0, total / np.maximum(share, 1e-30), 0))


def _ink(layers, of, look, dark, scale, paper, own):
    kind, pitch, angle, space = look[:4]
    counted = of("tone_pitch_unit") == "LPI"
    pitch = 25.4 * layers.full_height / (of("page_height") * pitch) if counted else pitch * scale
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    if of("tone_crisp") and space == "SCREEN" and kind in ("DOTS", "LINES", "CROSS"):  # whole pixels
        whole = np.round(pitch * c), np.round(pitch * s)
        pitch = np.hypot(*whole)
        c, s = whole[0] / pitch, whole[1] / pitch
    pitch = max(2.0, pitch)
    soft = 0.002 if of("tone_crisp") else 1 + (1 - of("tone_hardness")) * pitch / 2
    height, width = dark.shape
    anchor = layers.anchor if space == "SURFACE" else None

    def screen(right, down):
        each = {"HATCH": max(pitch, 3), "STIPPLE": max(pitch / 2, 3)}.get(kind, pitch)
        right, down = right / each, down / each
        y, x = np.mgrid[:height, :width]
        return right * (x + layers.x + 0.5) + down * (y + layers.y + 0.5), right + 0 * x, down + 0 * x

    def surface(direction):
        return tuple(anchor[..., k:k + 3] @ np.asarray(direction) for k in (0, 7, 10))

    if kind == "SOLID":
        return (dark > 0).astype(float)
    if kind == "GRAIN":
        return hatch.cover(layers, of, 1 - dark, paper)

    def chart(c, s):
        if anchor is None:
            return screen(c, -s), screen(s, c)
        normal = np.abs(anchor[..., 3:6])
        axis = np.argmax(normal, -1)  # of equal ones the first
        first, second = np.where(axis == 0, 1, 0), np.where(axis == 2, 1, 2)

        def turned(one, two):
            def along(k):
                return (one * np.take_along_axis(anchor, (k + first)[..., None], 2)
                        + two * np.take_along_axis(anchor, (k + second)[..., None], 2))[..., 0]
            return along(0), along(7), along(10)

        return turned(c, s), turned(-s, c)

    if kind in ("DOTS", "HATCH", "STIPPLE"):
        if kind == "DOTS":
            ink = dots(chart(c, s), dark, pitch, soft)
        else:
            turn = np.radians(angle) + (np.arctan2(0.3511234, 0.9363292) if kind == "HATCH" else 0)
            ink = scatter.Drawing(layers, kind, pitch, np.radians(angle), anchor, chart(np.cos(turn), np.sin(turn)),
                                  dark, lattice, of("tone_crisp")).draw(own)
        return ink if anchor is None else np.where(anchor[..., 6] > 0, ink, dark)
    first = 1 - np.sqrt(1 - dark) if kind == "CROSS" else dark
    if anchor is None:
        ink = lines(screen(s, c), first, pitch, soft)
        return _both(ink, lines(screen(c, -s), first, pitch, soft)) if kind == "CROSS" else ink
    across = np.array((s + 0.15, 0.1, c))
    across /= np.linalg.norm(across)
    other_way = np.cross(across, (0.6, 0.75, 0.2))
    other_way /= np.linalg.norm(other_way)
    dot = anchor[..., 3:6] @ across
    first = first * clamp01((np.sqrt(np.maximum(1 - dot * dot, 0)) - 0.3) / 0.12)
    second = np.where(first < 1, clamp01(1 - (1 - dark) / np.maximum(1 - first, 1e-30)), 0)
    ink = _both(lines(surface(across), first, pitch, soft), lines(surface(other_way), second, pitch, soft))
    return np.where(anchor[..., 6] > 0, ink, dark)


def fill(layers, params, surface, paper):
    """(the surface (H, W, 4) with its tones, these alone). paper: as for hatching."""
    drawn, alone = surface.copy(), np.zeros(surface.shape)
    scale = params.pixels(layers.full_height)
    for number, table in enumerate(params.tables):
        of, own = table.__getitem__, layers.style == number
        if not of("use_tones"):
            continue
        looks = _looks(of)
        for k, look in reversed(list(enumerate(looks))):
            if look[0] == "NONE" or look in looks[:k]:
                continue
            share, dark = _dark(layers, of("shade_levels"), of, look)
            if not (dark > 0).any():
                continue
            t = np.where(own, _ink(layers, of, look, dark, scale, paper, own) * share, 0)[..., None]
            t = np.where(t >= 0.5, 1.0, 0.0) if of("tone_crisp") else t
            alpha = surface[..., 3:]
            drawn[..., :3] = mix(drawn[..., :3], np.array(look[4]) * alpha, t)
            ink = np.concatenate([np.array(look[4]) * alpha, alpha], -1)
            alone = mix(alone, ink, t)
    return drawn, alone
