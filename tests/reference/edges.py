# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers to edge strength: Vainumäe's difference of Gaussians (2020, 3.1) and Herring's Sobel (2016, A.2).

Each source gives a signed *response*; the strength is the response clamped to 0…limit."""

from dataclasses import dataclass

import numpy as np

from . import grid, metric, shade
from .params import strength as strength_of
from .params import width

# In the order in which the first of equals gives the line its width.
SOURCES = ("object", "material", "depth", "normal", "color", "light", "mark")
_PAIRS = ((-1, 0), (-1, 1), (0, 1), (1, 1))  # and their opposites


@dataclass
class Source:
    response: np.ndarray  # (H, W), negative = no edge
    limit: float = np.inf
    doubtful: np.ndarray | bool = False  # within float32's reach of a jump

    @property
    def strength(self):
        return np.clip(self.response, 0.0, self.limit)


@dataclass
class Edges:
    strength: np.ndarray  # (H, W)
    mask: np.ndarray  # (H, W) bool
    source: np.ndarray  # (H, W) index into SOURCES, -1 where the strength is 0
    sources: dict  # name -> (H, W), unweighted
    owner: tuple  # (row, column), each (H, W): the pixel whose controls and style an edge here takes
    z: np.ndarray  # (H, W) the owner's depth
    strength_doubtful: np.ndarray  # (H, W) the strength may be another one: no tolerance holds
    mask_doubtful: np.ndarray  # (H, W) may or may not be an edge pixel
    width_doubtful: np.ndarray  # (H, W) two sources of different width are as strong


def find(layers, params):
    sources = {
        "object": Source(_differs(layers.object)),
        "material": Source(_differs(layers.material)),
        "depth": _depth(layers, params),
        "normal": _normal(layers, params),
        "color": _color(_color_layer(layers, params), layers, params),
        "light": _light(layers, params),
        "mark": Source(layers.marked),
    }
    owner = nearest_depth(layers.depth)
    style = layers.style[owner]
    weights = {name: params.at(strength_of(name), style) for name in SOURCES}
    control = layers.controls["color_edge"]
    weights["color"] = painted_weight(params, weights["color"], control)

    weighted = np.array([weights[name] * sources[name].strength for name in SOURCES])
    signed = np.array([
        weights[name] * np.minimum(sources[name].response, sources[name].limit) for name in SOURCES
    ])
    if _by_contrast(params) and (control > 0).any():
        encoded, color = _color_layer(layers, params), SOURCES.index("color")
        ends = [(grid.read(encoded, dy, dx), grid.read(encoded, -dy, -dx)) for dy, dx in _PAIRS]
        apart = np.max([metric.difference("CIEDE2000", *pair) for pair in ends], axis=0)
        painted = painted_strength(params, control, apart)
        weighted[color], signed[color] = np.maximum(weighted[color], painted), np.maximum(signed[color], painted)
        jumps = np.any([metric.jumps("CIEDE2000", *pair) for pair in ends], axis=0)
        sources["color"].doubtful = sources["color"].doubtful | (jumps & (control > 0))
    strength = weighted.max(axis=0)
    source = np.where(strength > 0, weighted.argmax(axis=0), -1)  # argmax takes the first of equals
    threshold = params["edge_threshold"]
    mask = (strength >= threshold) & (strength > 0)

    tolerance = 2e-5 + 1e-4 * strength
    quiet = (signed == 0).all(axis=0)
    weights["color"] = np.where(control > 0, 1.0, weights["color"])  # it matters, whatever the weight
    jumpy = np.any([(weights[name] > 0) & sources[name].doubtful for name in SOURCES], axis=0)
    near = (np.abs(signed.max(axis=0) - threshold) <= tolerance) & ~quiet
    widths = np.array([params.at(width(name), style) for name in SOURCES])
    return Edges(
        strength, mask, source, {name: sources[name].strength for name in SOURCES},
        owner, layers.depth[owner],
        strength_doubtful=jumpy, mask_doubtful=near | jumpy,
        width_doubtful=_rivals(sources, weighted, widths, source, tolerance),
    )


def painted_weight(params, weight, control):
    """Of colours: what is painted black takes it away; of DOG, white adds to it."""
    return weight * (1 + np.minimum(control, 0)) + (0 if _by_contrast(params) else np.maximum(control, 0))


def painted_strength(params, control, difference):
    """What white paint gives at least to a boundary between colours with a CIEDE2000 of 100 · `difference`."""
    least = max(0.5, params["edge_threshold"]) * np.minimum(1, control * difference / 0.05)
    return least * (np.asarray(control) > 0) * _by_contrast(params)


def nearest_depth(depth):
    """Row and column of the least depth in the 5×5 about each pixel: the near side of a silhouette."""
    y, x = grid.positions(depth.shape)
    best = np.full(depth.shape, np.inf)
    row, column = y, x
    for dy, dx in sorted(grid.window(2), key=lambda o: (o[0] ** 2 + o[1] ** 2, o[0], o[1])):
        ny, nx = y + dy, x + dx
        inside = (ny >= 0) & (ny < depth.shape[0]) & (nx >= 0) & (nx < depth.shape[1])
        z = np.where(inside, grid.read(depth, dy, dx), np.inf)
        closer = z < best
        best[closer] = z[closer]
        row, column = np.where(closer, ny, row), np.where(closer, nx, column)
    return row, column


def _rivals(sources, weighted, widths, source, tolerance):
    """Where another source is as strong within the tolerance, has another width, and the tie is not exact."""
    names = range(len(SOURCES))
    exact = np.array([
        sources[SOURCES[k]].response > sources[SOURCES[k]].limit + tolerance
        if SOURCES[k] not in ("object", "material", "mark") else np.ones_like(weighted[k], bool) for k in names
    ])
    first = np.maximum(source, 0)[None]
    best, width, sure = (np.take_along_axis(a, first, 0)[0] for a in (weighted, widths, exact))
    doubtful = np.zeros(source.shape, bool)
    for k in names:
        tie = (weighted[k] == best) & exact[k] & sure
        doubtful |= (weighted[k] >= best - 2 * tolerance) & (widths[k] != width) & ~tie & (source >= 0)
    return doubtful


def _differs(index):
    """1 where a pixel of the 3×3 has another index."""
    return np.any([grid.read(index, dy, dx) != index for dy, dx in grid.window(1)], axis=0).astype(float)


# Gaussians


def gaussian(sigma, radius):
    weights = np.exp(-(np.arange(-radius, radius + 1) ** 2) / (2 * sigma**2))
    return weights / weights.sum()


def _sigma(params):
    sigma = min(4.0, max(0.5, params["edge_blur"]))
    return sigma, int(np.ceil(2 * sigma))


def _dog(at, sigma, radius):
    """Difference of Gaussians of at(dy, dx), on differences from the centre so that flat is exactly 0."""
    narrow, wide = gaussian(sigma, radius), gaussian(1.6 * sigma, radius)
    kernel = np.outer(narrow, narrow) - np.outer(wide, wide)
    centre = at(0, 0)
    return sum(kernel[dy + radius, dx + radius] * (at(dy, dx) - centre) for dy, dx in grid.window(radius))


def _reader(image):
    return lambda dy, dx: grid.read(image, dy, dx)


# Depth


def _depth_reader(layers, params, radius):
    """at(dy, dx) of the depth signal in windows of that radius, and what to divide a response by."""
    height, width = layers.depth.shape
    there, z = layers.there, np.where(layers.there, layers.depth, 1.0)

    def tap(padded):
        return lambda dy, dx: padded[radius + dy : radius + dy + height, radius + dx : radius + dx + width]

    if params["depth_space"] == "LINEAR":
        near, far = params["depth_near"], params["depth_far"]
        return _reader(np.where(there, metric.clamp01((z - near) / (far - near)), 1.0)), np.ones_like(z)
    if not layers.orthographic:
        u = np.where(there, 1 / z, 0.0)  # a plane is linear in 1/z on screen, at any grazing angle
        return tap(grid.continued(u, radius)), grid.most(u, radius)
    # Nothing lies one frame height behind the farthest of the window's pixels: no frame-wide value would do.
    farthest = grid.most(np.where(there, z, -np.inf), radius)
    behind = np.where(np.isfinite(farthest), -(farthest + layers.height) / layers.height, 0.0)
    surface = tap(grid.continued(np.where(there, -z / layers.height, 0.0), radius))
    hole = tap(grid.continued((~there).astype(float), radius))
    return lambda dy, dx: surface(dy, dx) + behind * hole(dy, dx), np.ones_like(z)


def _relative(response, divisor):
    return np.where(divisor > 0, response / np.where(divisor > 0, divisor, 1.0), 0.0)


def _depth(layers, params):
    linear = params["depth_space"] == "LINEAR"
    if params["edge_detector"] == "DOG":
        sigma, radius = _sigma(params)
        at, divisor = _depth_reader(layers, params, radius)
        return Source((200 if linear else 60) * _relative(_dog(at, sigma, radius), divisor))
    at, divisor = _depth_reader(layers, params, 1)
    # A first derivative of 1/z would blacken every slanted floor: a second one is 0 on planes.
    kernel = (-1, 0, 1) if linear else (1, -2, 1)
    return Source(10 * _relative(_slope(at, kernel), divisor), limit=1.0)


def _slope(at, kernel):
    """hypot of `kernel` across times (1 2 1) along, in both directions."""
    smooth = (1, 2, 1)
    gx = sum(kernel[dx + 1] * smooth[dy + 1] * at(dy, dx) for dy, dx in grid.window(1))
    gy = sum(kernel[dy + 1] * smooth[dx + 1] * at(dy, dx) for dy, dx in grid.window(1))
    return np.hypot(gx, gy)


# Normals


def _normal(layers, params):
    if params["edge_detector"] == "DOG":
        sigma, radius = _sigma(params)
        peak = 5 * _dog(_reader(layers.normal), sigma, radius).max(axis=-1)
        return Source(50 * np.sign(peak) * np.abs(peak) ** 1.5)
    at = _reader(0.5 + 0.5 * layers.normal)
    response = 0.1 * _slope(at, (-1, 0, 1)).sum(axis=-1)
    least = params["sobel_crease_threshold"]
    doubtful = (np.abs(response - least) < 1e-4) & (least > 0)
    return Source(np.where(response < least, 0.0, response), doubtful=doubtful)


# Colour and light


def _color_layer(layers, params):
    return metric.encode(layers.albedo if params["color_layer"] == "ALBEDO" else layers.combined[..., :3])


def _light(layers, params):
    level, _, doubtful = shade.levels(layers, params)
    grey = metric.encode(np.repeat(level[..., None], 3, axis=-1))
    source = _color(grey, layers, params)
    reach = 1 if _by_contrast(params) else _sigma(params)[1]
    if _by_contrast(params) and params["contrast_local"]:
        reach += _auto_radius(layers, params)
    source.doubtful = source.doubtful | grid.most(doubtful, reach)
    return source


def _by_contrast(params):
    return params["edge_detector"] != "DOG" or params["color_detector"] == "CONTRAST"


def _color(encoded, layers, params):
    if _by_contrast(params):
        return _contrast(encoded, layers, params)
    sigma, radius = _sigma(params)
    return Source(50 * _dog(_reader(encoded), sigma, radius).max(axis=-1))


def _auto_radius(layers, params):
    return int(np.floor(params["contrast_window"] * params.pixels(layers.full_height) / 2))


def _contrast(encoded, layers, params):
    """Herring's inter-color metric: the largest difference across the pixel."""
    kind, least = params["contrast_metric"], params["contrast_threshold"]
    ends = [(grid.read(encoded, dy, dx), grid.read(encoded, -dy, -dx)) for dy, dx in _PAIRS]
    weights = [params[f"contrast_{part}"] for part in ("hue", "saturation", "lightness")]
    deltas = np.array([metric.difference(kind, *pair, weights) for pair in ends])
    full = np.full(encoded.shape[:2], float(params["contrast_full"]))
    if params["contrast_local"]:
        full = np.maximum(0.25, grid.most(deltas.max(axis=0), _auto_radius(layers, params)))
    ramp = full - least
    share = np.where(ramp > 0, (deltas - least) / np.where(ramp > 0, ramp, 1.0), np.inf)
    response = np.where(deltas < least, 0.0, share).max(axis=0)

    steep = (ramp < 0.02) & (np.abs(deltas - least) < 1e-4 + np.maximum(ramp, 0.0))
    jumps = np.array([metric.jumps(kind, *pair) for pair in ends]) & (deltas > least - 1e-3)
    doubtful = (steep | jumps).any(axis=0)
    if params["contrast_local"]:  # the window's largest may be another
        unsteady = grid.most(np.where(jumps, deltas, 0.0).max(axis=0), _auto_radius(layers, params))
        doubtful |= (unsteady > 0) & (unsteady >= (1 - metric.JUMP[kind]) * full)
    return Source(response, limit=1.0, doubtful=doubtful)
