# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces painted by the example of a ball, one pixel after the other (after Sýkora et al., StyleBlit, 2019)."""

import math

import numpy as np

from .shade import exposed, other

LIGHT = np.array((-0.5, 0.6, 0.6245))
FLAT = math.hypot(*LIGHT[:2])
PITCH, SEAM, RELIEF = 0.3, 0.08, 0.22
PATCH = 0.1375  # of the ball
WORD = 0xffffffff


def scramble(n):
    n = (n ^ n >> 16) * 0x7feb352d & WORD
    n = (n ^ n >> 15) * 0x846ca68b & WORD
    return n ^ n >> 16


def shares(n):
    """Two numbers 0..1 from a hash."""
    return (n & 0xffff) / 65536, (n >> 16) / 65536


def between(picture, x, y):
    """The four nearest of a picture (H, W, channels), whose middles are at whole numbers, mixed."""
    height, width = picture.shape[:2]
    x, y = min(max(x, 0.0), width - 1.0), min(max(y, 0.0), height - 1.0)
    i, j = int(x), int(y)
    i1, j1, s, t = min(i + 1, width - 1), min(j + 1, height - 1), x - i, y - j
    return ((1 - t) * ((1 - s) * picture[j, i] + s * picture[j, i1])
            + t * ((1 - s) * picture[j1, i] + s * picture[j1, i1]))


class Ball:
    """A painting in square roots of colours: coarse colours, and the rest with its lightness."""

    def __init__(self, image, size):
        image = np.asarray(image, np.float64)
        image = image[..., None] if image.ndim == 2 else image
        image = image[..., :3] if image.shape[2] > 2 else np.repeat(image[..., :1], 3, 2)
        with np.errstate(invalid="ignore"):
            root = np.where((image > 0) & (image <= 1e30), np.sqrt(np.where(image > 0, image, 0)), 0)
        side = min(image.shape[:2])
        texels = 0.75 * side / max(size, 1e-3)
        shrink = 1
        while (shrink + 1 <= texels or max(image.shape[:2]) // shrink > 2048) and shrink < side:
            shrink += 1
        height, width = (n // shrink for n in image.shape[:2])
        paint = root[:height * shrink, :width * shrink].reshape(height, shrink, width, shrink, 3).mean((1, 3))
        self.texels, self.radius = texels / shrink, 0.375 * min(height, width)
        self.middle = (width - 1) / 2, (height - 1) / 2
        self.square = max(int(self.radius / 24), 1)
        grid = np.array([[paint[y:y + self.square, x:x + self.square].mean((0, 1))
                          for x in range(0, width, self.square)] for y in range(0, height, self.square)])
        for _ in range(3):
            for axis in (1, 0):
                index = np.arange(grid.shape[axis])
                grid = sum(np.take(grid, np.clip(index + k, 0, index[-1]), axis) for k in range(-2, 3)) / 5
        self.grid = grid
        rest = paint - np.array([[self.coarse(x, y) for x in range(width)] for y in range(height)])
        light = np.clip(rest @ (0.2126, 0.7152, 0.0722) * 8, -1, 1)
        self.detail = np.concatenate([rest, light[..., None]], -1)

    def coarse(self, x, y):
        return between(self.grid, (x + 0.5) / self.square - 0.5, (y + 0.5) / self.square - 0.5)


def lit_place(u, v, light):
    """The place on the ball, right and up in radii, where light falls as here, and beside that where a surface that
    faces (u, v) faces."""
    across = min(max(v * LIGHT[0] / FLAT - u * LIGHT[1] / FLAT, -0.95), 0.95)
    t = 0.95 * min(max(light, 0.0), 1e6)
    t = t if t < 0.6 else 1 - 0.16 / (t - 0.2)
    rest = math.sqrt(1 - across * across)
    a = max(1.7 * t - 0.7, -FLAT * rest)
    lack = math.sqrt(max(1 - a * a, 0))
    along = a * FLAT - lack * rest * LIGHT[2]
    across *= lack
    return (along * LIGHT[0] - across * LIGHT[1]) / FLAT, (along * LIGHT[1] + across * LIGHT[0]) / FLAT


def octave(at, inverse, m, share, grown):
    """[(weight, hash, way from its middle on the screen, had it not grown)] of the four cells about a place, of lattice
    m."""
    at = np.clip(at * 2.0 ** (m - 1) + 17.3 * m, -1e6, 1e6)
    base = np.floor(at + at.sum() / 3)
    off = at - (base - base.sum() / 6)
    found = []
    # with the largest rest first; those that are equal in the order of the axes
    order = sorted(range(3), key=lambda axis: (-off[axis], axis))
    for k in range(4):
        gone = np.zeros(3)
        gone[order[:k]] = 1
        d = off - gone + k / 6
        x, y, z = (int(n) & WORD for n in base + gone)
        n = ((m & WORD) * 0x9e3779b1 & WORD ^ x) * 0x85ebca6b & WORD
        n = ((n ^ n >> 15) ^ y) * 0xc2b2ae35 & WORD
        n = scramble(((n ^ n >> 13) ^ z) * 0x27d4eb2f & WORD)
        low, high = shares(n)
        weight = max(1 - 2 * (d @ d), 0) * (0.75 + 0.5 * high) * min(max(2 * share - low, 0), 1)
        found.append((weight, n, inverse @ d * 2.0 ** (1 - m) / grown))
    return found


def cells(anchor, size):
    """Likewise of all cells that may reach a pixel."""
    at, pixel, right, down = anchor[:3], anchor[6], anchor[7:10], anchor[10:13]
    rr, dd, rd = right @ right, down @ down, right @ down
    det = rr * dd - rd * rd
    if not (pixel * size > 0 and max(1e-6 * rr * dd, 1e-36) < det < 1e36 and 1e-18 < 1 / (pixel * size) < 1e18):
        return []
    inverse = np.array([dd * right - rd * down, rr * down - rd * right]) / det
    m = math.floor(math.log2(1 / (pixel * size)))
    finer = 1 / (pixel * size) / 2.0 ** m - 1
    fine = octave(at, inverse, m + 1, finer, (1 + finer) / 2) if finer > 0 else []
    return octave(at, inverse, m, 1 - finer, 1 + finer) + fine


def nodes(u, v):
    """[(weight, hash, place)] of places of the ball near one."""
    at = np.array((u, v)) / PITCH
    base = np.floor(at + at.sum() * 0.36602540)
    off = at - (base - base.sum() * 0.21132487)
    found = []
    for gone in (0, 0), ((1, 0) if off[0] > off[1] else (0, 1)), (1, 1):
        d = off - gone + sum(gone) * 0.21132487
        i, j = (int(n) & WORD for n in base + gone)
        found.append((max(1 - 2 * (d @ d), 0), (i * 0x27d4eb2f ^ j * 0x165667b1) & WORD, (at - d) * PITCH))
    return found


def on_picture(x, y):
    """The anchor of a pixel of which no place is known: patches lie on the picture."""
    return np.array([x, y, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0]) / 64


def color(ball, loose, patches, place):
    own = np.array((ball.middle[0] + ball.radius * place[0], ball.middle[1] - ball.radius * place[1]))
    seen = []
    for weight, hash_, way in patches:
        for share, other_hash, (x, y) in nodes(*place):
            aside = np.array(shares(scramble(hash_ ^ other_hash))) - 0.5
            x, y = 0.95 * x + 0.25 * aside[0], 0.95 * y + 0.25 * aside[1]
            at = np.array((ball.middle[0] + ball.radius * x, ball.middle[1] - ball.radius * y)) + way * ball.texels
            seen.append((weight * share, at, between(ball.detail, *at)))
    most = max((weight for weight, *_ in seen), default=0)
    if most <= 0:
        return ball.coarse(*own) + between(ball.detail, *own)[:3]
    scores = [(weight / most + RELIEF * detail[3], at, detail) for weight, at, detail in seen]
    best = max(score for score, *_ in scores)
    part = np.array([max(score - best + SEAM, 0) for score, *_ in scores])
    part /= part.sum()
    at, detail = part @ [at for _, at, _ in scores], part @ [detail for *_, detail in scores]
    return ball.coarse(*(own + loose * (at - own))) + detail[:3]


def paint(layers, params, surface):
    """The surface (H, W, 4), painted where its style wants that."""
    out, light, left = surface.copy(), exposed(layers, params), other(layers)
    balls = {}
    for y, x in zip(*np.nonzero(params.at("use_example", layers.style) & layers.there & (surface[..., 3] != 0)),
                    strict=True):
        style = layers.style[y, x]
        one = params.of(style)
        scale = params.pixels(layers.full_height)
        if style not in balls:
            balls[style] = Ball(one["example_image"], one["example_size"] * scale)
        normal = layers.view @ layers.normal[y, x]
        length = np.linalg.norm(normal)
        normal = normal / length if 1e-6 < length < 1e6 else normal * 0
        place = np.array(normal[:2])
        place += one["example_light"] * (np.array(lit_place(*place, light[y, x])) - place)
        anchor = on_picture(layers.x + x, layers.y + y) if layers.anchor is None else layers.anchor[y, x]
        patches = cells(anchor, PATCH * one["example_size"] * scale)
        root = np.maximum(color(balls[style], one["example_loose"], patches, place), 0)
        own = 1 + one["example_own_color"] * (layers.color[y, x] - 1)
        rest = params["other_light"] * left[y, x]
        painted = np.maximum(root ** 2 * own * surface[y, x, 3] + rest, 0)
        out[y, x, :3] += one["example_strength"] * (painted - out[y, x, :3])
    return out
