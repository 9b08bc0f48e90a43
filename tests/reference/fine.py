# SPDX-License-Identifier: GPL-3.0-or-later
"""The detector FINE: thin edge sites at sub-pixel places, linked to chains, drawn as strokes of exact width."""

from dataclasses import dataclass

import numpy as np

from . import edges as edge_stage
from . import grid, metric, seen
from .chains import Web, chains, drop_crumbs, linked
from .edges import SOURCES
from .frame import Layers
from .lines import Pen
from .metric import clamp01, mix, value
from .params import Params
from .sites import (
    CLEAR,
    FAMILIES,
    SEEN,
    Sites,
    bands,
    clear_of,
    evened,
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

CREASE_ANGLE, LINE_TAPER = 20.0, 0.0  # degrees, pixels: the parameters' defaults
CHAIN, BAND_CHAIN = 3, 4  # sites: shorter chains of ridges, of bands are chance
BAND = 1.2  # how much more a sliver must have than a step


@dataclass
class Fine:
    """What FINE found; arrays over sites, as Edges has them over pixels."""
    sites: Sites
    links: np.ndarray  # (m, 2)
    chains: list  # of lists of sites
    owner: tuple  # (rows, columns) of the pixel whose controls and style a site takes
    z: np.ndarray  # its depth

    @property
    def source(self):
        return self.sites.source

    @property
    def strength(self):
        return self.sites.strength


@dataclass
class View:
    """What the families look at."""
    layers: Layers
    params: Params
    weights: dict  # source -> (H, W)
    mixed: np.ndarray  # (H, W) pixels that hold two surfaces
    albedo: np.ndarray
    encoded: np.ndarray
    bend: float  # least difference of unit normals that is a crease

    @property
    def shape(self):
        return self.mixed.shape

    def weight(self, source, at):
        pixel = np.clip(grid.round_half_up(at), 0, np.array(self.shape) - 1)
        return self.weights[source][tuple(pixel.T)]


def ink(layers, scene=None, camera=None, crease_angle=CREASE_ANGLE, line_taper=LINE_TAPER):
    """T (H, W) of bare lines, on paper without grain, and what was found; arguments as render() has them."""
    params = Params(scene, ())
    layers = Layers(layers, 0, camera, None)
    fine = find(layers, params, crease_angle)
    return draw(layers, params, fine, np.ones(layers.depth.shape), line_taper)[0], fine


def find(layers, params, crease_angle=CREASE_ANGLE):
    """All sites, family by family, each keeping clear of the older ones; then what loose ends belong to."""
    shape, threshold = layers.depth.shape, params["edge_threshold"]
    owner = edge_stage.nearest_depth(layers.depth)
    weights = {name: params.at("edge_" + name, layers.style[owner]) for name in SOURCES}
    weights["color"] = np.maximum(0.0, weights["color"] + layers.controls["color_edge"])
    albedo = layers.albedo if params["color_layer"] == "ALBEDO" else layers.combined[..., :3]

    cracks = list(outlines(layers, params, weights))
    web = Web(shape)
    web.add(*weave(cracks, shape, threshold, "outline"))
    view = View(layers, params, weights, touched(cracks, threshold, shape), albedo, metric.encode(albedo),
                2 * np.sin(np.radians(crease_angle) / 2))
    found, links = _drawn(view, threshold)
    web.add(*drop(found, links, ~clear_of(found.at, web.curve(), CLEAR)))
    for family in (_creases, _colors, _shadows):
        for thin, least in ((True, BAND_CHAIN), (False, CHAIN)):
            found = family(view, thin)
            strong = (found.strength >= threshold) & (found.strength > 0)
            found = found.take(strong & clear_of(found.at, web.curve(), CLEAR))
            web.add(*drop_crumbs(found, linked(found), least))
    found, links = _terminators(view, threshold)
    web.add(*drop(found, links, ~clear_of(found.at, web.curve(), CLEAR)))
    weights["seen"] = params.at("edge_seen", layers.style)
    for found, least in seen.families(layers, params, lambda at: view.weight("seen", at), view.mixed, view.bend):
        strong = (found.strength >= threshold) & (found.strength > 0)
        found = found.take(strong & clear_of(found.at, web.curve(), CLEAR))
        web.add(*drop_crumbs(found, linked(found), least))

    light = value(layers.diffuse)[..., None]
    signals = {"normal": (layers.normal, 0.12), "color": (view.encoded, 0.02), "light": (light, 0.05)}
    if layers.seen_normal is not None:  # a tenth of a normal counts as much as colours
        signals["seen"] = np.concatenate([metric.encode(clamp01(layers.seen_color)), layers.seen_normal / 10], -1), 0.02
    web.tie(lambda family, a, b: family == "light" or _agree(*signals[family], a, b),
            lambda family, a, b, corner: _wedge(*signals[family], a, b, corner))
    pixel, mirrored = web.sites.pixel.T, web.sites.source == SEEN  # which have the controls of the mirror itself
    own = tuple(np.where(mirrored, pixel[k], o) for k, o in enumerate(_owners(layers, web.sites)))
    return Fine(web.sites, web.links, chains(len(web.sites), web.links), own, layers.depth[own])


def _owners(layers, found, touching=0.02):
    """(rows, columns): the least depth of the 5×5 about each site's pixel, of the object that its line bounds.

    That is the nearest of the pixels it parts; where two things touch, the one whose line is painted more. At the foot
    of a blade of grass the ground before it is nearer, and has other controls."""
    bound = np.array(layers.depth.shape) - 1
    own = np.zeros((len(found), 2), int)
    for k, (at, pixel, family) in enumerate(zip(found.at, found.pixel, found.family, strict=True)):
        crack = FAMILIES[family] in ("outline", "light")
        low, high = (np.floor(at), np.ceil(at)) if crack else (pixel, pixel)
        parted = [(int(r), int(c)) for r in {low[0], high[0]} for c in {low[1], high[1]}]
        least = min(layers.depth[p] for p in parted)
        reach = least + touching * (layers.height if layers.orthographic else least)
        bounded = min((p for p in parted if layers.depth[p] <= reach),
                      key=lambda p: (-abs(layers.controls["thickness"][p]), layers.depth[p], p))
        near = [(int(r), int(c)) for r in range(pixel[0] - 2, pixel[0] + 3) for c in range(pixel[1] - 2, pixel[1] + 3)
                if 0 <= r <= bound[0] and 0 <= c <= bound[1]]
        its = [p for p in near if layers.object[p] == layers.object[bounded]]
        own[k] = min(its or near, key=lambda p: (layers.depth[p], (p[0] - pixel[0])**2 + (p[1] - pixel[1])**2, p))
    return tuple(own.T)


def drop(found, links, gone):
    number = np.cumsum(~gone) - 1
    return found.take(~gone), number[links[~gone[links].any(1)]]


# The families


def _drawn(view, threshold):
    """Lines drawn by hand lie where the layer says."""
    cracks = []
    for axis in (1, 0):
        place, weight = (turn(axis, a)[:, :-1] for a in (view.layers.marks[..., 1 - axis], view.weights["mark"]))
        cracks.append(((place > 0) * weight, np.full(place.shape, SOURCES.index("mark")), clamp01(place)))
    return weave(cracks, view.shape, threshold, "mark")


def _creases(view, thin):
    normal, floor = view.layers.normal, 0.35 * view.bend
    if thin:
        at, jump, *_, step = bands(normal, view.mixed, BAND * floor)
        jump = jump / BAND
    else:
        at, jump, *_, step = ridges(normal, normal, view.mixed, floor)
    strength = clamp01((jump - floor) / (0.37 * view.bend)) * view.weight("normal", at)
    return sites(at, "normal", SOURCES.index("normal"), strength, view.shape, step)


def _contrast(params, one, two):
    """Herring's inter-color metric of encoded colours, as a strength."""
    delta = metric.difference(params["contrast_metric"], one, two)
    least, most = params["contrast_threshold"], params["contrast_max"]
    share = np.where(most > least, (delta - least) / max(most - least, 1e-12), 1.0)
    return np.where(delta < least, 0.0, clamp01(share))


def _colors(view, thin):
    if thin:
        at, _, one, two, step = bands(view.encoded, view.mixed, BAND * 0.01)
    else:
        at, _, one, two, step = ridges(view.encoded, view.albedo, view.mixed, 0.01)
    strength = _contrast(view.params, one, two) * view.weight("color", at)
    return sites(at, "color", SOURCES.index("color"), strength, view.shape, step)


def _steps(view):
    """(style number, its levels, light as it sees it) of each style."""
    for k, steps in view.params.levels():
        yield k, steps, value(view.layers.diffuse) * view.params.tables[k]["shade_exposure"]


def _shadows(view, thin):
    """Hard steps of light, each once however many thresholds it crosses."""
    every = Sites()
    for style, steps, x in _steps(view):
        x = x[..., None]
        at, _, one, two, step = bands(x, view.mixed, 0.1) if thin else ridges(x, x, view.mixed, 0.05)
        greys = (grey_of(level_of(side[:, 0], steps), steps) for side in (one, two))
        strength = _contrast(view.params, *greys) * view.weight("light", at)
        found = sites(at, "light", SOURCES.index("light"), strength, view.shape, step)
        every = every.add(found.take(view.layers.style[tuple(found.pixel.T)] == style))
    return every


def _terminators(view, threshold):
    """Where soft light crosses a threshold, by the levels of the nearer pixel."""
    cracks, light = [], evened(value(view.layers.diffuse))
    for axis in (1, 0):
        z, style, weight = (turn(axis, a) for a in (view.layers.depth, view.layers.style, view.weights["light"]))
        nearer = np.where(z[:, 1:] < z[:, :-1], style[:, 1:], style[:, :-1])
        there = np.isfinite(z[:, 1:]) & np.isfinite(z[:, :-1])
        strength, t = np.zeros(nearer.shape), np.zeros(nearer.shape)
        for k, steps, _ in _steps(view):
            x = light * view.params.tables[k]["shade_exposure"]
            one, two, place = light_cracks(turn(axis, x), steps)
            contrast = _contrast(view.params, grey_of(one, steps), grey_of(two, steps))
            own = there & (nearer == k)
            strength = np.where(own, contrast * np.where(place < 0.5, weight[:, :-1], weight[:, 1:]), strength)
            t = np.where(own, place, t)
        cracks.append((strength, np.full(t.shape, SOURCES.index("light")), t))
    return weave(cracks, view.shape, threshold, "light")


# What the picture shows between two ends


def _read(image, at):
    return image[tuple(np.clip(grid.round_half_up(at), 0, np.array(image.shape[:2]) - 1))]


def _beside(a, b):
    """1.5 pixels at right angles to the way from a to b; 0 if there is none."""
    way = b - a
    length = np.hypot(*way)
    return 1.5 * np.array([-way[1], way[0]]) / length if length > 1e-6 else 0 * way


def _agree(image, least, a, b):
    """Whether at ¼, ½ and ¾ of the way from a to b the values 1.5 pixels to either side differ by `least`."""
    side = _beside(a, b)
    middles = [mix(a, b, share) for share in (0.25, 0.5, 0.75)]
    return all(np.linalg.norm(_read(image, p - side) - _read(image, p + side)) >= least for p in middles)


def _wedge(image, least, a, b, corner):
    """Whether what two lines enclose that would meet at the corner differs from what lies outside of either."""
    inside = _read(image, (a + b + corner) / 3)
    for p, other in ((a, b), (b, a)):
        side = _beside(p, corner)
        outside = (p + corner) / 2 - side * np.sign(side @ (other - p))
        if np.linalg.norm(_read(image, outside) - inside) < least:
            return False
    return True


# Ink


def draw(layers, params, fine, paper, line_taper=LINE_TAPER):
    """T (H, W) and ink (H, W, 3): the union of the discs along all links; line_taper in the unit of lengths."""
    pen = Pen(layers, params, fine, paper)
    shape = layers.depth.shape
    best, nearest = np.zeros(shape), np.full(shape, np.inf)
    color = np.zeros((*shape, 3))
    for (i, j), thinner in _strokes(fine, shape, line_taper * params.pixels(layers.full_height)):
        a, b = fine.sites.at[i], fine.sites.at[j]
        radii = pen.radius[[i, j]] * thinner
        reach = max(*radii, 0.5) + 1
        low = np.maximum(np.ceil(np.minimum(a, b) - reach).astype(int), 0)
        high = np.minimum(np.floor(np.maximum(a, b) + reach).astype(int) + 1, shape)
        box = slice(low[0], high[0]), slice(low[1], high[1])
        y, x = np.mgrid[box]
        way = b - a
        s = clamp01(((y - a[0]) * way[0] + (x - a[1]) * way[1]) / max(way @ way, 1e-12))
        d = np.hypot(y - mix(a[0], b[0], s), x - mix(a[1], b[1], s))
        t = _darkness(pen, layers, (y, x), d, i, j, s, mix(*radii, s))
        wins = (t > best[box]) | ((t == best[box]) & (t > 0) & (d < nearest[box]))
        best[box][wins], nearest[box][wins] = t[wins], d[wins]
        color[box][wins] = np.where(s[wins][:, None] < 0.5, pen.ink[i], pen.ink[j])
    return best, color


def _strokes(fine, shape, taper):
    """Each link with the factors of its ends' radii; a site without links is a link to itself."""
    at, degree = fine.sites.at, np.bincount(fine.links.ravel(), minlength=len(fine.sites))
    border = np.minimum(at, np.array(shape) - 1 - at).min(axis=1)
    free = (degree < 2) & (border > 2)
    for chain in [*fine.chains, *([k, k] for k in np.flatnonzero(degree == 0))]:
        length = np.cumsum([0, *np.hypot(*np.diff(at[chain], axis=0).T)])
        factor = np.ones(len(chain))
        for end, along in ((chain[0], length), (chain[-1], length[-1] - length)):
            if free[end] and taper > 0:
                factor = np.minimum(factor, clamp01(along / taper))
        yield from zip(zip(chain, chain[1:]), zip(factor, factor[1:]))  # noqa: B905


def _darkness(pen, layers, pixels, d, i, j, s, r):
    soft, gain, rough = (np.where(s < 0.5, a[i], a[j]) for a in (pen.softness, pen.gain, pen.roughness))
    strength = mix(pen.strength[i], pen.strength[j], s)
    rho = np.maximum(r, 0.5)
    core, edge = np.minimum((1 - soft) * rho, rho - 0.5), np.maximum(soft * rho, 1)
    f = np.minimum(1, 2 * r) * clamp01((core + edge - d) / edge)
    h = mix(1.0, pen.paper[pixels], rough)
    t = clamp01(gain * strength * np.maximum(0, h * f - np.maximum(0, 1 - strength / 2)))
    if pen.occlude:
        z = np.where(pen.z[i] == pen.z[j], pen.z[i], mix(pen.z[i], pen.z[j], s))
        limit = z - 0.1 * layers.height if layers.orthographic else 0.9 * z
        t = np.where(layers.depth[pixels] < limit, 0.0, t)
    return t
