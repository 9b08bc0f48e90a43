# SPDX-License-Identifier: GPL-3.0-or-later
"""Rim light: every pixel looks at every place where a surface ends before one that lies farther back."""

import numpy as np

from .metric import clamp01, mix

STEP = 0.05  # how far behind a silhouette the next surface lies at least, of its distance
BESIDE = ((0, 1), (1, 0), (0, -1), (-1, 0))  # rows, columns


class _Site:
    """A way from the pixel `own` to a neighbour, on which its surface ends."""

    def __init__(self, layers, params, own, step):
        y, x = own
        behind = y + step[0], x + step[1]
        style = layers.style[own]

        def value(name):
            return params.at("rim_" + name, style)

        z, far = layers.depth[own], layers.depth[behind]
        span = layers.height if layers.orthographic else z
        self.found = bool(params.at("use_rim", style) and np.isfinite(z) and far - z > STEP * span)
        if not self.found:
            return
        slack = (2 * STEP + 0.05) * span
        around = np.s_[max(y - 2, 0):y + 3, max(x - 2, 0):x + 3]
        same = (np.abs(layers.depth[around] - z) <= slack) & (layers.object[around] == layers.object[own])
        right, up, _ = layers.view @ layers.normal[around][same].sum(0)
        length = np.hypot(right, up)
        if not 0.01 < length < 1e4:
            self.found = False
            return
        away = clamp01(4 * (right * step[1] - up * step[0]) / length)
        angle, rise, spread = np.radians([value("angle"), value("elevation"), value("spread")])
        light, all_round = np.array([np.cos(angle), np.sin(angle)]), 0.0
        if value("space") == "WORLD":
            light = (layers.view @ [*(light * np.cos(rise)), np.sin(rise)])[:2]
            all_round = clamp01((0.3 - np.hypot(*light)) * 5)
            light = light / max(np.hypot(*light), 1e-6)
        near = clamp01(3 * (light @ [right, up] / length - np.cos(spread)))
        side = 1.0 if value("spread") >= 180 else max(near * (2 - near), all_round)
        self.width = value("width") * params.pixels(layers.full_height) * away * side
        first = min(own, behind)  # contours are kept by the upper and the left pixel
        place = layers.contours[(*first, 0 if step[1] else 1)] or 0.5
        place = place if first == own else 1 - place
        self.y, self.x = y + place * step[0], x + place * step[1]
        self.low, self.high = z - slack, z + min(slack, (far - z) / 2)
        self.own = own
        self.softness = value("softness")


def _facing(layers):
    """How far surfaces face the camera, and how fast that changes from pixel to pixel."""
    z = layers.normal @ layers.view[2]
    wide = np.pad(z, 1, mode="edge")
    growth = np.maximum(np.abs(wide[1:-1, 2:] - wide[1:-1, :-2]), np.abs(wide[2:, 1:-1] - wide[:-2, 1:-1])) / 2
    return z, np.maximum(growth, 1e-3)


def light(layers, params, surface):
    """The surface (H, W, 4) with its rim light, and where float32 may choose otherwise."""
    rows, columns = layers.depth.shape
    cover = np.zeros((rows, columns))
    seen = np.stack(np.mgrid[:rows, :columns], -1)  # the pixel whose surface the band lies on
    ends = np.ones((rows, columns))  # how near the surface's own end is
    doubtful = np.zeros((rows, columns), bool)
    y, x = np.mgrid[:rows, :columns]
    z, has = layers.depth, params.at("use_rim", layers.style)
    if not has.any():
        return surface, doubtful
    for own in np.ndindex(rows, columns):
        for step in BESIDE:
            if not (0 <= own[0] + step[0] < rows and 0 <= own[1] + step[1] < columns):
                continue
            site = _Site(layers, params, own, step)
            if not site.found or not site.width > 0:
                continue
            distance = np.hypot(y - site.y, x - site.x)
            inside = (z >= site.low) & (z <= site.high) & (layers.object == layers.object[own])
            allowed = np.where(inside, has, z > site.high)
            fade = max(site.softness * site.width, 1.0)
            part = clamp01((site.width - distance + 0.5) / fade)
            part = np.where(allowed, np.where(inside, part, np.minimum(part, 0.5 - distance)), 0.0)
            ends = np.where(inside & allowed & (part > 0), np.minimum(ends, distance), ends)
            own_seen = np.where(inside[..., None], np.stack([y, x], -1), own)
            tie = (np.abs(part - cover) < 1e-5) & (part > 0) & (own_seen != seen).any(-1)
            doubtful |= tie | ((part > 0) & ((np.abs(z - site.low) < 1e-4 * z) | (np.abs(z - site.high) < 1e-4 * z)))
            better = part > cover
            cover = np.where(better, part, cover)
            seen[better] = own_seen[better]
    cover = np.minimum(cover, 0.5 + ends)
    on = tuple(np.moveaxis(seen, -1, 0))
    style = layers.style[on]
    facing, growth = _facing(layers)
    turn = params.at("rim_facing", style)
    cover = cover * np.where(turn >= 1, 1.0, clamp01((turn - facing[on]) / growth[on] + 0.5))
    cover = (cover * params.at("rim_strength", style))[..., None]
    tint = params.at("rim_tint", style)[..., None]
    color = params.at("rim_color", style) * mix(1.0, clamp01(layers.color[on]), tint) * surface[..., 3:]
    rgb = mix(surface[..., :3], color, cover)
    return np.concatenate([rgb, surface[..., 3:]], -1), doubtful
