# SPDX-License-Identifier: GPL-3.0-or-later
"""The detector FINE: thin edge sites at sub-pixel places, linked to chains, drawn as strokes of exact width."""

from dataclasses import dataclass

import numpy as np

from . import edges as edge_stage
from . import grid, metric
from .chains import Web, chains, drop_crumbs, linked
from .edges import SOURCES
from .lines import Pen
from .metric import clamp01, mix, value
from .sites import (
    CLEAR,
    Sites,
    bands,
    clear_of,
    grey_of,
    level_of,
    light_cracks,
    outlines,
    ridges,
    sites,
    touched,
    turn,
    weave,
)

CREASE_ANGLE = 20.0  # degrees: default of crease_angle
BAND = 1.2  # how much more a sliver must have than a step


@dataclass
class Fine:
    """What FINE found; arrays over sites, as Edges has over pixels."""
    sites: Sites
    links: np.ndarray  # (m, 2)
    chains: list
    owner: tuple  # (rows, columns) of the pixel whose controls and style a site takes
    z: np.ndarray  # its depth

    @property
    def source(self):
        return self.sites.source

    @property
    def strength(self):
        return self.sites.strength


def find(layers, params, crease_angle=CREASE_ANGLE):
    shape = layers.depth.shape
    threshold = params["edge_threshold"]
    owner = edge_stage.nearest_depth(layers.depth)
    weights = {name: params.at("edge_" + name, layers.style[owner]) for name in SOURCES}
    weights["color"] = np.maximum(0.0, weights["color"] + layers.controls["color_edge"])
    albedo = layers.albedo if params["color_layer"] == "ALBEDO" else layers.combined[..., :3]
    encoded = metric.encode(albedo)

    web = Web(shape)
    cracks = list(outlines(layers, params, weights))
    web.add(*weave(cracks, shape, threshold, "outline"))
    mixed = touched(cracks, threshold, shape)

    bend = 2 * np.sin(np.radians(crease_angle) / 2)
    for kind, least in ((_creases, 3), (_colors, 3), (_shadows, 3)):
        for thin in (True, False):
            args = (layers, params, weights, mixed, albedo, encoded, bend)
            found = kind(*args, thin=thin)
            found = found.take((found.strength >= threshold) & (found.strength > 0))
            found = found.take(clear_of(found.at, web.curve(), CLEAR))
            links = linked(found.at)
            web.add(*drop_crumbs(found, links, least + thin))
    found, links = _terminators(layers, params, weights, threshold)
    keep = clear_of(found.at, web.curve(), CLEAR)
    number = np.cumsum(keep) - 1
    web.add(found.take(keep), number[links[keep[links].all(1)]])

    light = metric.value(layers.diffuse)[..., None]
    signals = {"outline": (layers.normal, 0.12), "normal": (layers.normal, 0.12), "color": (encoded, 0.02), "light": (light, 0.05)}
    web.tie(lambda family, a, b: family == "light" or _agree(*signals[family], a, b),
            lambda family, a, b, corner: _wedge(*signals[family], a, b, corner))
    pixel = tuple(web.sites.pixel.T)
    own = tuple(o[pixel] for o in owner)
    return Fine(web.sites, web.links, chains(len(web.sites), web.links), own, layers.depth[own])


def _weight(weights, name, at, shape):
    pixel = np.clip(grid.round_half_up(at), 0, np.array(shape) - 1)
    return weights[name][tuple(pixel.T)]


def _creases(layers, params, weights, mixed, albedo, encoded, bend, thin):
    floor = 0.35 * bend
    if thin:
        at, jump, _, _ = bands(layers.normal, mixed, BAND * floor)
        jump = jump / BAND
    else:
        at, jump, _, _ = ridges(layers.normal, layers.normal, mixed, floor)
    strength = clamp01((jump - floor) / (0.37 * bend))
    strength = strength * _weight(weights, "normal", at, mixed.shape)
    return sites(at, "normal", SOURCES.index("normal"), strength, mixed.shape)


def _contrast(params, one, two):
    """Herring's inter-color metric of encoded colours, as a strength."""
    delta = metric.difference(params["contrast_metric"], one, two)
    least, most = params["contrast_threshold"], params["contrast_max"]
    share = np.where(most > least, (delta - least) / max(most - least, 1e-12), 1.0)
    return np.where(delta < least, 0.0, clamp01(share))


def _colors(layers, params, weights, mixed, albedo, encoded, bend, thin):
    if thin:
        at, _, one, two = bands(encoded, mixed, BAND * 0.01)
    else:
        at, _, one, two = ridges(encoded, albedo, mixed, 0.01)
    strength = _contrast(params, one, two) * _weight(weights, "color", at, mixed.shape)
    return sites(at, "color", SOURCES.index("color"), strength, mixed.shape)


def _steps(layers, params):
    """(style number, levels, exposed light) of each style."""
    for k, steps in params.levels():
        yield k, steps, value(layers.diffuse) * params.tables[k]["shade_exposure"]


def _shadows(layers, params, weights, mixed, albedo, encoded, bend, thin):
    """Hard steps of light across a threshold, at once over all the thresholds that they cross."""
    every = Sites()
    for style, steps, x in _steps(layers, params):
        if thin:
            at, _, one, two = bands(x[..., None], mixed, 0.1)
        else:
            at, _, one, two = ridges(x[..., None], x[..., None], mixed, 0.05)
        greys = [grey_of(level_of(side[:, 0], steps), steps) for side in (one, two)]
        strength = _contrast(params, *greys) * _weight(weights, "light", at, mixed.shape)
        pixel = tuple(np.clip(grid.round_half_up(at), 0, np.array(mixed.shape) - 1).T)
        strength = np.where(layers.style[pixel] == style, strength, 0)
        every = every.add(sites(at, "light", SOURCES.index("light"), strength, mixed.shape))
    return every


def _terminators(layers, params, weights, threshold):
    """Where soft light crosses a threshold."""
    cracks = []
    for axis in (1, 0):
        z, style, weight = (turn(axis, a) for a in (layers.depth, layers.style, weights["light"]))
        near_q = z[:, 1:] < z[:, :-1]
        strength, t = np.zeros(near_q.shape), np.zeros(near_q.shape)
        for k, steps, x in _steps(layers, params):
            one, two, place = light_cracks(x, steps, axis)
            own = np.where(near_q, style[:, 1:], style[:, :-1]) == k
            contrast = _contrast(params, grey_of(one, steps), grey_of(two, steps))
            both = np.isfinite(z[:, 1:]) & np.isfinite(z[:, :-1])
            heavy = np.where(place < 0.5, weight[:, :-1], weight[:, 1:])
            strength = np.where(own & both, contrast * heavy, strength)
            t = np.where(own, place, t)
        cracks.append((strength, np.full(t.shape, SOURCES.index("light")), t))
    return weave(cracks, layers.depth.shape, threshold, "light")


def _agree(image, least, a, b):
    """Whether at ¼, ½ and ¾ of the way from a to b the values 1.5 pixels to either side differ by `least`."""
    way = (b - a) / np.hypot(*(b - a))
    side = 1.5 * np.array([-way[1], way[0]])
    for share in (0.25, 0.5, 0.75):
        p = a + (b - a) * share
        one, two = (image[tuple(np.clip(grid.round_half_up(q), 0, np.array(image.shape[:2]) - 1))]
                    for q in (p - side, p + side))
        if np.sqrt(((one - two) ** 2).sum()) < least:
            return False
    return True


def _wedge(image, least, a, b, corner):
    """Whether what lies between two lines that would meet at a corner differs from what lies outside."""
    def read(p):
        return image[tuple(np.clip(grid.round_half_up(p), 0, np.array(image.shape[:2]) - 1))]
    if min(np.hypot(*(corner - a)), np.hypot(*(corner - b))) < 1e-6:
        return False
    inside = read((a + b + corner) / 3)
    for p, other in ((a, b), (b, a)):
        way = (corner - p) / np.hypot(*(corner - p))
        side = np.array([-way[1], way[0]])
        side *= -np.sign(side @ (other - p))
        if np.sqrt(((read((p + corner) / 2 + 1.5 * side) - inside) ** 2).sum()) < least:
            return False
    return True


# Ink


def draw(layers, params, fine, paper):
    """T (H, W) and ink (H, W, 3): the union of the discs along all links."""
    pen = Pen(layers, params, fine, paper)
    shape = layers.depth.shape
    best, nearest = np.zeros(shape), np.full(shape, np.inf)
    ink = np.zeros((*shape, 3))
    alone = np.setdiff1d(np.arange(len(fine.sites)), fine.links)
    for i, j in [*fine.links, *zip(alone, alone, strict=True)]:
        a, b = fine.sites.at[i], fine.sites.at[j]
        reach = max(pen.radius[i], pen.radius[j], 0.5) + 1
        low = np.maximum(np.ceil(np.minimum(a, b) - reach).astype(int), 0)
        high = np.minimum(np.floor(np.maximum(a, b) + reach).astype(int) + 1, shape)
        box = slice(low[0], high[0]), slice(low[1], high[1])
        y, x = np.mgrid[box]
        square = ((b - a) ** 2).sum()
        s = clamp01(((y - a[0]) * (b - a)[0] + (x - a[1]) * (b - a)[1]) / square) if square > 0 else np.zeros(y.shape)
        d = np.hypot(y - mix(a[0], b[0], s), x - mix(a[1], b[1], s))
        t = _darkness(pen, layers, (y, x), d, i, j, s)
        wins = (t > best[box]) | ((t == best[box]) & (t > 0) & (d < nearest[box]))
        best[box][wins], nearest[box][wins] = t[wins], d[wins]
        ink[box][wins] = np.where(s[wins][:, None] < 0.5, pen.ink[i], pen.ink[j])
    return best, ink


def _darkness(pen, layers, pixels, d, i, j, s):
    nearer = s < 0.5
    r, z = mix(pen.radius[i], pen.radius[j], s), mix(pen.z[i], pen.z[j], s) if pen.z[i] != pen.z[j] else pen.z[i]
    strength = mix(pen.strength[i], pen.strength[j], s)
    soft, gain, rough = (np.where(nearer, a[i], a[j]) for a in (pen.softness, pen.gain, pen.roughness))
    rho = np.maximum(r, 0.5)
    core = np.minimum((1 - soft) * rho, rho - 0.5)
    f = np.minimum(1, 2 * r) * clamp01((core + np.maximum(soft * rho, 1) - d) / np.maximum(soft * rho, 1))
    h = mix(1.0, pen.paper[pixels], rough)
    t = clamp01(gain * strength * np.maximum(0, h * f - np.maximum(0, 1 - strength / 2)))
    if pen.occlude:
        depth = layers.depth[pixels]
        t = np.where(depth < (z - 0.1 * layers.height if layers.orthographic else 0.9 * z), 0.0, t)
    return t
