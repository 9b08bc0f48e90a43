# SPDX-License-Identifier: GPL-3.0-or-later
"""Edge pixels to ink: every edge pixel is a disc, the line is the union of the discs."""

import numpy as np

from . import grid
from .edges import SOURCES
from .metric import clamp01, mix
from .params import width as width_of
from .shade import exposed


class Pen:
    """What each pixel's disc would be, were it an edge pixel: arrays (H, W), in the edge's own style."""

    def __init__(self, layers, params, edges, paper):
        owner, height = edges.owner, layers.full_height
        style, unit = layers.style[owner], params.pixels(height)
        controls = {name: layers.controls[name][owner] for name in ("thickness", "intensity")}
        self.layers, self.z, self.paper = layers, edges.z, paper
        self.occlude = params["line_occlude"]
        self.softness = params.at("pen_1_softness", style)
        self.roughness = params.at("pen_1_grain", style)
        self.pressed = 1 + controls["intensity"]
        self.intensity = params.at("pen_1_intensity", style)
        self.strength = self.pressed * self.intensity
        self.gain = params.at("pen_1_steepness", style) * params.at("use_lines", style)

        c = controls["thickness"]
        lit = clamp01(exposed(layers, params)[owner])
        heavier = np.maximum(0.0, 1 + params.at("ink_in_shade", style) * (1 - 2 * lit))
        distance = params.at("line_far_distance", style)
        if layers.distance > 0:
            distance = distance * np.where(params.at("line_far_unit", style) == "RELATIVE", layers.distance, 1.0)
        changes = np.zeros(np.shape(distance), bool) if layers.orthographic else distance > 0
        nearer = np.where(changes, np.minimum(distance / edges.z, params.at("line_far_thickest", style)), 1.0)
        least = np.where(changes, 0.5 * unit * params.at("line_far_thinnest", style), 0.0)
        widths = np.array([params.at(width_of(name), style) for name in (*SOURCES, "seen")])
        width = np.take_along_axis(widths, np.maximum(edges.source, 0)[None], 0)[0]
        contrast = mix(1.0, np.minimum(1.0, edges.strength), params.at("line_contrast", style))
        most = 0.5 * params["line_thickest"] * unit

        half = (0.5 * unit * params.at("line_thickness", style) * np.where(c > 0, 1 + 8 * c, 1 + c)
                * heavier)
        outline = np.isin(edges.source, [SOURCES.index("object"), SOURCES.index("depth")])
        there = half * width * contrast  # at the distance of full width
        self.radius = np.minimum(most, np.maximum(there * nearer, np.where(outline, np.minimum(least, there), 0)))
        self.reach = np.minimum(most, half * widths.max(axis=0) * np.maximum(nearer, 1))  # whatever strength and source

        value_ = params.at("ink_tint_value", style)[..., None]
        tint = params.at("ink_tint", style)[..., None]
        self.ink = mix(params.at("ink_color", style), value_ * layers.color[owner], tint)

    def raw(self, p, e, radius=None):
        """T of the pixels p by the edge pixels e, (rows, columns) each, before its clamp to 1; and where
        the test of what stands before the line is within float32's reach of the other answer."""
        r = (self.radius if radius is None else radius)[e]
        d = np.hypot(p[0] - e[0], p[1] - e[1])
        a = np.minimum((1 - self.softness[e]) * r, r - 1)
        f = np.where(d <= a, 1.0, np.maximum(0.0, (r - d) / (r - a)))
        h = mix(1.0, self.paper[p], self.roughness[e])
        i = self.strength[e]
        t = self.gain[e] * i * np.maximum(0.0, h * f - np.maximum(0.0, 1 - i / 2))
        if not self.occlude:
            return t, np.zeros(t.shape, bool)
        z, ze = self.layers.depth[p], self.z[e]
        if self.layers.orthographic:
            limit, slack = ze - 0.1 * self.layers.height, 1e-4 * self.layers.height
        else:
            limit, slack = 0.9 * ze, 1e-4 * ze
        with np.errstate(invalid="ignore"):  # inf - inf: both are nothing
            close = np.isfinite(z) & np.isfinite(ze) & (np.abs(z - limit) < slack) & (t > 0)
        return np.where(z < limit, 0.0, t), close

    def tolerance(self, e):
        return 1e-4 * np.maximum(1.0, np.abs(self.gain[e] * self.strength[e]))


def draw(layers, params, edges, paper):
    """T (H, W), ink (H, W, 3), and where float32 may decide otherwise; paper (H, W) is its height, 0…1."""
    pen = Pen(layers, params, edges, paper)
    search = params["line_search"]
    if search == "EXACT":
        return _exact(pen, edges)
    find = {"NEAREST": _nearest, "WALK": _walk, "DILATE": _dilate}[search]
    row, column, doubtful = find(pen, edges)
    p, e = grid.positions(edges.mask.shape), (np.maximum(row, 0), np.maximum(column, 0))
    t, close = pen.raw(tuple(p), e)
    found = row >= 0
    t = np.where(found, clamp01(t), 0.0)
    covered = np.hypot(p[0] - e[0], p[1] - e[1]) < pen.reach[e]
    doubtful |= found & (close | (edges.width_doubtful[e] & covered))
    return t, pen.ink[e], doubtful


def _box(e, radius, shape):
    """The pixels within the radius of e, and a few more: (slices, (rows, columns))."""
    k = int(np.ceil(radius))
    rows = slice(max(0, e[0] - k), min(shape[0], e[0] + k + 1))
    columns = slice(max(0, e[1] - k), min(shape[1], e[1] + k + 1))
    y, x = np.mgrid[rows, columns]
    return (rows, columns), (y, x)


def _exact(pen, edges):
    shape = edges.mask.shape
    best, raw = np.zeros(shape), np.zeros(shape)
    squared = np.full(shape, np.inf)
    ink, doubtful = np.zeros((*shape, 3)), np.zeros(shape, bool)
    spots = [(y, x) for y, x in np.argwhere(edges.mask) if pen.radius[y, x] > 0 and pen.gain[y, x] != 0]
    for e in spots:
        box, p = _box(e, pen.radius[e], shape)
        found, close = pen.raw(p, e)
        t, d2 = clamp01(found), (p[0] - e[0]) ** 2 + (p[1] - e[1]) ** 2
        # row by row: of equals at one distance the first stays
        wins = (t > best[box]) | ((t == best[box]) & (t > 0) & (d2 < squared[box]))
        best[box][wins], raw[box][wins], squared[box][wins] = t[wins], found[wins], d2[wins]
        ink[box][wins] = pen.ink[e]
        doubtful[box] |= close

    for e in spots:  # another ink that float32 may prefer
        box, p = _box(e, pen.radius[e], shape)
        t, _ = pen.raw(p, e)
        slack = pen.tolerance(e)
        tie = (t == raw[box]) | (np.minimum(t, raw[box]) > 1 + 10 * slack)
        other = np.abs(pen.ink[e] - ink[box]).max(axis=-1) * best[box] > 1e-3
        doubtful[box] |= other & (clamp01(t) >= best[box] - slack) & ~tie

    for e in map(tuple, np.argwhere(edges.mask_doubtful | (edges.mask & edges.width_doubtful))):
        box, p = _box(e, pen.reach[e], shape)
        t, _ = pen.raw(p, e, pen.reach)
        doubtful[box] |= (t > 0) & (clamp01(t) >= best[box] - pen.tolerance(e))
    return best, ink, doubtful


def _inked(pen, edges):
    if pen is None:
        return True
    """Where any line may reach: within the largest radius of an edge pixel."""
    spots = edges.mask | edges.mask_doubtful
    return grid.nearest(spots)[2] <= pen.reach[spots].max(initial=0.0)


def _nearest(pen, edges):
    row, column, distance = grid.nearest(edges.mask)
    sure = grid.nearest(edges.mask & ~edges.mask_doubtful)[2]
    doubtful = (grid.nearest(edges.mask_doubtful)[2] <= sure) & _inked(pen, edges)
    return np.where(np.isfinite(distance), row, -1), column, doubtful


def _closest_held(row, column):
    """Replace each location by the nearest among those held in the 3×3 (row -1 = none held)."""
    y, x = grid.positions(row.shape)
    far = np.iinfo(np.int64).max
    best = (np.full(row.shape, far), np.full(row.shape, -1), np.full(row.shape, -1))
    for dy, dx in grid.window(1):
        r, c = grid.read(row, dy, dx), grid.read(column, dy, dx)
        candidate = (np.where(r >= 0, (r - y) ** 2 + (c - x) ** 2, far), r, c)
        less, equal = np.zeros(row.shape, bool), np.ones(row.shape, bool)
        for one, two in zip(candidate, best, strict=True):
            less |= equal & (one < two)
            equal &= one == two
        less &= r >= 0
        best = tuple(np.where(less, one, two) for one, two in zip(candidate, best, strict=True))
    return best[1], best[2]


def _own(mask):
    y, x = grid.positions(mask.shape)
    return np.where(mask, y, -1), np.where(mask, x, -1)


def held(params, edges):
    """(row, column, doubtful) of the edge that WALK or DILATE finds for each pixel (row -1 = none), else None."""
    find = {"WALK": _walk, "DILATE": _dilate}.get(params["line_search"])
    return find(None, edges) if find else None


def _dilate(pen, edges):
    row, column = _own(edges.mask)
    for _ in range(20):
        row, column = _closest_held(row, column)
    sure = grid.nearest(edges.mask & ~edges.mask_doubtful)[2]
    # what is handed on from pixel to pixel may be a little farther than the nearest
    doubtful = (grid.nearest(edges.mask_doubtful)[2] <= sure + 1.5) & _inked(pen, edges)
    return row, column, doubtful


def _walk(pen, edges):
    """Uphill on the blurred mask, at most 19 pixels (Vainumäe 2020, 3.2)."""
    mask, (y, x) = edges.mask, grid.positions(edges.mask.shape)
    weights = np.exp(-(np.arange(-20, 21) ** 2) / (2 * 10.0**2))
    weights /= weights.sum()
    blurred = mask.astype(float)
    blurred = sum(w * grid.read(blurred, k, 0) for k, w in zip(range(-20, 21), weights, strict=True))
    blurred = sum(w * grid.read(blurred, 0, k) for k, w in zip(range(-20, 21), weights, strict=True))

    def at(dy, dx):
        return grid.read(blurred, dy, dx)

    gx = (at(0, 1) + 0.5 * (at(-1, 1) + at(1, 1))) - (at(0, -1) + 0.5 * (at(-1, -1) + at(1, -1)))
    gy = (at(1, 0) + 0.5 * (at(1, -1) + at(1, 1))) - (at(-1, 0) + 0.5 * (at(-1, -1) + at(-1, 1)))
    length = np.hypot(gx, gy)
    walks = length >= 1e-12
    ux, uy = (np.where(walks, g / np.where(walks, length, 1.0), 0.0) for g in (gx, gy))

    row, column = _own(mask)
    faint = (length < 0.02 * grid.most(blurred, 1)) & ~mask
    doubtful = faint.copy()
    def land(i, dy, dx):
        spots = zip((y + i * uy + dy, x + i * ux + dx), mask.shape, strict=True)
        return tuple(np.clip(grid.round_half_up(f), 0, n - 1) for f, n in spots)

    for i in range(1, 20):
        looking = walks & (row < 0)
        q = land(i, 0, 0)
        for near in (land(i, dy, dx) for dy in (-1e-3, 1e-3) for dx in (-1e-3, 1e-3)):
            moved = (near[0] != q[0]) | (near[1] != q[1])
            doubtful |= looking & moved & (mask[near] | mask[q])
        hit = looking & mask[q]
        row[hit], column[hit] = q[0][hit], q[1][hit]
    doubtful |= grid.most(edges.mask_doubtful, 21)  # the gradient there is, and so the way

    nearest = grid.nearest(mask)
    for _ in range(2):
        # nothing that a doubtful neighbour may hold beats the nearest of all
        sure = _closest_held(np.where(doubtful, -1, row), column)
        settled = (sure[0] == nearest[0]) & (sure[1] == nearest[1]) & (sure[0] >= 0)
        doubtful = grid.most(doubtful, 1) & ~settled
        row, column = _closest_held(row, column)
    return row, column, (doubtful | grid.most(edges.mask_doubtful, 23)) & _inked(pen, edges)
