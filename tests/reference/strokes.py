# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE's ink: the union of the discs along all links, whose centre, radius, darkness and depth run evenly from one site
to the next; and how far a pixel is from the nearest site."""

from types import SimpleNamespace

import numpy as np

from .hand import Hand, across_at, inks, kinds, left_by
from .lines import Pen
from .metric import clamp01, mix
from .params import KINDS
from .strips import End
from .strips import ends as strip_ends
from .strips import left as strip_left
from .thickets import filled_by, pressed, thinned
from .turns import bends, dashed, spurs, turned


def free_lengths(t, shape):
    """Lengths along its chain from each site to the nearest end that is tied to nothing; where lines meet, of whom at
    most one goes on, that of the longest of the others."""
    found = np.full(len(t), np.inf)
    for i in range(len(t)):
        if t.dropped[i] or len(t.links[i]) > 1 or t.at_border(i, shape):
            continue
        found[i] = along = 0
        before, at = i, t.links[i][0] if t.links[i] else None
        while at is not None and len(t.links[at]) <= 2:
            along += t.apart(before, at)
            found[at] = min(found[at], along)
            before, at = at, t.next(before, at)
    for i in range(len(t)):
        if len(t.links[i]) > 2 and not t.dropped[i]:
            free = [found[j] + t.apart(i, j) for j in t.links[i] if len(t.links[j]) <= 2 and np.isfinite(found[j])]
            if len(free) >= len(t.links[i]) - 1:
                found[i] = max(free)
    return found


def branches_off(t, i, j):
    """Whether of the lines that meet at site i the one over j is younger than the site and two that go on from it."""
    older = [k for k in t.links[i] if not t.dropped[k] and t.rank[k] < t.rank[j]]
    return len(t.links[i]) > 2 and t.rank[j] > t.rank[i] and len(older) > 1


def evened(t, radius, shape):
    """Half the widths, each the mean along its line, up to where that meets others, without that place where it only
    branches off these, by weights that fall to 0 at the width, which counts as 2 to 8 pixels, of the widest of the line
    within 8 pixels; where near by, by cells of 4, the radius changes by more than 0.2 from a site to the next."""
    found = radius.copy()

    def along(i, reach):
        for first in t.links[i]:
            before, at, way = i, first, 0.0
            while at is not None and at != i and not t.dropped[at]:
                way += t.apart(before, at)
                if way >= reach or branches_off(t, at, before):
                    break
                yield radius[at], 1 - way / reach
                before, at = at, t.next(before, at)

    cell = [pixel // 4 for pixel in np.clip(np.floor(t.at + 0.5).astype(int), 0, np.array(shape[::-1]) - 1).T]
    varied = np.zeros((shape[0] // 4 + 1, shape[1] // 4 + 1), bool)
    for i in range(len(t)):
        for j in t.links[i]:
            if not (t.dropped[i] or t.dropped[j]) and abs(radius[i] - radius[j]) > 0.2:
                varied[cell[1][i], cell[0][i]] = True

    def varies(i):
        low, high = (np.clip(np.floor(t.at[i] + off + 0.5).astype(int), 0, np.array(shape[::-1]) - 1) // 4
                     for off in (-8, 8))
        return varied[low[1]:high[1] + 1, low[0]:high[0] + 1].any()

    for i in range(len(t)):
        if t.dropped[i] or len(t.links[i]) > 2 or not varies(i):
            continue
        reach = np.clip(2 * max([radius[i], *(value for value, _ in along(i, 8))]), 2, 8)
        values, weights = zip((radius[i], 1.0), *along(i, reach), strict=True)
        found[i] = np.average(values, weights=weights)
    return found


def ends(t, layers, params, paper, stroke, pictures):
    """What each site gives the links that end at it in one stroke, as columns; its ink; its bristles; where it lies in
    the picture along its line."""
    site, shape = t.site, layers.depth.shape
    owner = site["near_y"], site["near_x"]
    pen = Pen(layers, params, SimpleNamespace(owner=owner, z=layers.depth[owner], strength=site["strength"],
                                              source=site["source"]), paper)
    style = layers.style[owner]
    used = params.at("use_lines", style) > 0
    hand = Hand(t, layers, params, stroke)
    taper = hand.at("taper") * params.pixels(layers.full_height)
    kind = kinds(t, layers)
    half = pen.radius
    for name in ("contact", "intersection"):
        half = np.where(kind == KINDS.index(name), half * params.at(f"line_{name}_width", style), half)
    half = half * hand.at("width")
    most = 0.5 * params["line_thickest"] * params.pixels(layers.full_height)
    half = np.minimum(half, most) * (1 - site["eased"] / 255)
    pressure = mix(1, hand.pressure(), pressed(t, hand, layers, half * used, params.at("line_density", style)))
    half, kept = thinned(t, hand, layers, half * used, params.at("line_density", style), params.at("line_fewer", style))
    used = used & hand.drawn  # how dense lines are is weighed once, before that
    half = half * used
    even = half
    turns = (hand.at("overshoot") > 0).any() or (hand.at("pool") > 0).any()
    turn = turned(t) if turns else np.zeros(len(t))
    pooled = hand.at("pool") * clamp01(turn - 0.5)
    curved = hand.at("curve") * bends(t, hand.scale) if (hand.at("curve") != 0).any() else 0 * pooled
    wider = pressure * (1 + pooled) * (1 + curved)
    half = np.where((hand.at("pressure") > 0) | (pooled > 0) | (curved != 0), np.minimum(half * wider, most), half)
    half = evened(t, np.where(used & ~t.dropped, half, 0.0), shape)
    whole, left = hand.radius(half, clamp01(2 - 4 * np.maximum(half, even) * site["crowd"]))
    radius = dashed(t, hand, whole * left)
    radius = radius * np.where(taper > 0, clamp01(free_lengths(t, shape) / np.where(taper > 0, taper, 1)), 1)
    lift = np.where(whole > 0, radius / np.where(whole > 0, whole, 1), 0)
    crowd = np.where(site["crowd"] > 0, 1 / np.maximum(site["crowd"], 1e-12), np.inf)
    radius = np.minimum(radius, crowd) * kept
    lift = lift * kept
    # as if the pen were always pressed hard, or a wire would be one line here and two there
    even = even * (1 + hand.at("pressure")) + hand.fray(even)
    filled = filled_by(t, np.minimum(even, crowd))
    at = t.at + (filled * site["inside"])[:, None] * np.where(site["axis"][:, None] == 0, (1, 0), (0, 1))
    at = at + hand.stray()
    z = np.zeros(len(t))
    if pen.occlude:
        z = pen.z - 0.1 * layers.height if layers.orthographic else 0.9 * pen.z
    strength = pen.pressed * hand.at("intensity")
    gain = hand.at("steepness") * strength
    columns = np.stack([lift * filled * site["half"] + radius, hand.at("softness") * radius, gain,
                        np.where(gain > 0, 1 / np.where(gain > 0, gain, 1), 0), np.maximum(0, 1 - strength / 2),
                        hand.at("grain"), np.minimum(z, 1e30)], 1)
    color, swollen = inks(t, layers, params, pen.ink, columns[:, 0], layers.combined)
    columns[:, :2] *= swollen[:, None]
    at, columns = np.where(used[:, None], at, t.at), columns * used[:, None]
    numbers, bristles = hand.bristles()
    return _beyond(spurs(t, turn) if turns else (), hand.farther() * used, at, columns, color, numbers * used, bristles,
                   strip_ends(t, hand, pictures))


def _beyond(spurs, farther, at, columns, color, numbers, bristles, strips):
    """Likewise, with ends beyond corners behind the others, and the pairs that these make."""
    pairs = []
    for i, last, way, length in spurs:
        far = min(farther[i], 0.2 * length)
        if far > 0.5:
            pairs.append((i, len(at)))
            at = np.vstack([at, at[i] + far * way])
            end = columns[i] * [0.35, 0.35, 1, 1, 1, 1, 1]
            end[6] = columns[last, 6]
            columns, color = np.vstack([columns, end]), np.vstack([color, color[i]])
            numbers, bristles = np.append(numbers, numbers[i]), np.vstack([bristles, bristles[i:i + 1]])
            strips.append(strips[i])
    return at, columns, color, (numbers, bristles), strips, pairs


def darkness(d, out, fade, gain, ease, bias, height):
    """(T at distance d, the most there can be, pixels from white to that). The pencil's darkness goes from 0 to `most`
    while coverage (out - d)/fade goes from bias/height to (bias + ramp)/height. The ramp is drawn about its middle, at
    least a pixel wide; a line whose middle is less than half a pixel away is drawn as wide as a pixel and as much
    fainter."""
    ramp = np.minimum(ease, np.maximum(0, height - bias))
    most = np.minimum(1, gain * np.maximum(0, height - bias))
    middle = out - fade * (bias + ramp / 2) / height
    width = np.maximum(fade * ramp / height, 1)
    return clamp01(2 * middle) * most * clamp01(0.5 + (np.maximum(middle, 0.5) - d) / width), most, width


def _across(d, along, length, way):
    """What a link adds on the other side of a place than what darkens it most, as a share: lines across from each
    other, square to both ways, that lie not together. d: the way to the link; along: how much of it lies along that."""
    own, its = np.hypot(*d), np.hypot(*way)
    facing = -(d[0] * way[0] + d[1] * way[1]) / (np.maximum(own, 0.25) * np.maximum(its, 0.25))
    aside = 1 - 4 * (along / max(length, 1e-12))**2 / (own**2 + 1e-12)
    return clamp01(facing) * clamp01(aside) * clamp01(2 * (own + its) - 1.5)


def _is_even(params):
    """Whether no pen that may draw leaves some of a line white, nor draws it twice."""
    for table in params.tables:
        for pen in {table[f"line_{kind}_pen"].lower() for kind in KINDS} if table["use_lines"] else ():
            if table[pen + "_strokes"] > 1 or table[pen + "_dry"] > 0 or table[pen + "_strip"] > 0:
                return False
    return True


def draw(t, layers, params, paper, pictures=()):
    """(T (H, W), ink (H, W, 3), where rounding tells whose ink it is, or whether something stands before it); pictures:
    pyramids of strips.py by pen and style."""
    shape = layers.depth.shape
    laid, darkest, unsure = np.zeros(shape), np.zeros(shape), np.zeros(shape, bool)
    ink = np.zeros((*shape, 3))
    pieces = [(i, j) for i in range(len(t)) for j in t.links[i] if j > i and not t.dropped[i] and not t.dropped[j]]
    pieces += [(i, i) for i in range(len(t)) if not t.links[i] and not t.dropped[i]]
    for k in range(int(max(params.at(pen + "strokes", 0) for pen in ("pen_1_", "pen_2_", "pen_3_")))):
        dark, own, doubtful = _stroke(t, ends(t, layers, params, paper, k, dict(pictures)), pieces, layers, paper,
                                      _is_even(params))
        laid = laid + dark - mix(laid * dark, np.minimum(laid, dark), 0.4)  # what one leaves white the next may darken
        differ = np.abs(own - ink).max(-1) > 1e-4
        unsure |= doubtful | (np.abs(dark - darkest) < 1e-4) & (dark > 0) & differ
        wins = dark > darkest
        darkest[wins], ink[wins] = dark[wins], own[wins]
    return laid, ink, unsure


def _beside(t, i, j):
    """The site before a link and the one after it, or its ends."""
    return [other if (other := t.next(*pair)) is not None and not t.dropped[other] else pair[1]
            for pair in ((j, i), (i, j))]


def _stroke(t, each, pieces, layers, paper, even):
    shape = layers.depth.shape
    y, x = np.mgrid[:shape[0], :shape[1]]
    best, nearest, second = np.zeros(shape), np.full(shape, np.inf), np.zeros(shape)
    ways, ties = np.zeros((2, *shape)), np.zeros(shape, bool)
    ink, unsure, links = np.zeros((*shape, 3)), np.zeros(shape, bool), []
    at, columns, color, (numbers, bristles), strips, beyond = each
    for i, j in pieces + beyond:
        a, way = at[i], at[j] - at[i]
        reach = max(columns[i, 0], columns[j, 0]) + 1
        low = np.maximum(np.floor(np.minimum(at[i], at[j]) - reach).astype(int), 0)
        high = np.maximum(np.ceil(np.maximum(at[i], at[j]) + reach).astype(int) + 1, 0)
        box = np.s_[low[1]:high[1], low[0]:high[0]]
        s = clamp01(((x[box] - a[0]) * way[0] + (y[box] - a[1]) * way[1]) / max(way @ way, 1e-12))
        to = np.stack([x[box] - mix(a[0], at[j, 0], s), y[box] - mix(a[1], at[j, 1], s)])
        d = np.hypot(*to)
        rows = columns[[i, j]]
        for one, two in ((0, 1), (1, 0)):  # what branches off is as wide where it meets the others as beside that
            if i != j and j < len(t) and branches_off(t, (i, j)[one], (i, j)[two]) and rows[one, 0] > rows[two, 0]:
                rows[one, :2] = rows[two, :2]
        out, fade, gain, ease, bias, rough, limit = (mix(rows[0, k], rows[1, k], s) for k in range(7))
        dark, most, width = darkness(d, out, fade, gain, ease, bias, 1 + rough * (paper[box] - 1))
        striped = any(strips[k] != End() for k in (i, j))
        ends_ = _beside(t, i, j) if i != j and j < len(t) else (i, j)
        wide = at[ends_[1]] - at[ends_[0]]
        if striped:
            across, doubtful = across_at(wide, x[box] - a[0], y[box] - a[1], out)
            left, more = strip_left(strips[i], strips[j], [strips[k] for k in ends_], wide, way, x[box] - a[0],
                                    y[box] - a[1], s, out, across)
            unsure[box] |= (doubtful | more) & (dark > 0)
            dark = dark * left
        if numbers[i] or numbers[j]:
            left, doubtful = left_by(wide, x[box] - a[0], y[box] - a[1], s, out, numbers[[i, j]], bristles[[i, j]])
            unsure[box] |= doubtful & (dark > 0)
            dark = dark * left
        z = layers.depth[box]
        hidden = z < limit
        unsure[box] |= np.isfinite(z) & (np.abs(z - limit) < 1e-4 * np.maximum(z, 1)) & (dark > 0)
        dark[hidden] = 0
        own = np.where((s > 0.5)[..., None], color[j], color[i])
        close = (np.abs(dark - best[box]) < 1e-4) & (dark > 0)
        unsure[box] |= close & (np.abs(own - ink[box]).max(-1) > 1e-4) & (best[box] > 0)
        turned = close & (np.abs(to - ways[(slice(None), *box)]).max(0) > 0.1)
        ties[box] = turned | (ties[box] & (dark <= best[box] + 1e-4))
        wins = (dark > best[box]) | ((dark == best[box]) & (dark > 0) & (d < nearest[box]))
        best[box][wins], nearest[box][wins], ink[box][wins] = dark[wins], d[wins], own[wins]
        ways[(slice(None), *box)][:, wins] = to[:, wins]
        links.append((box, to, way, dark, most, width))
    for box, to, way, dark, most, width in links if even else ():
        length = np.hypot(*way)
        share = _across(to, to[0] * way[0] + to[1] * way[1], length, ways[(slice(None), *box)]) * clamp01(2 - width)
        room = np.maximum(np.minimum(dark, most - best[box]), 0)
        unsure[box] |= ties[box] & (room > 1e-3)
        second[box] = np.maximum(second[box], room * share)
    return best + second, ink, unsure


def nearest(t, shape):
    """Ways (H, W, 2) from each pixel to the nearest site that is kept, and where two are as near."""
    kept = t.at[~t.dropped]
    y, x = np.mgrid[:shape[0], :shape[1]]
    way = kept[None, None] - np.stack([x, y], -1)[:, :, None]
    d = np.hypot(*np.moveaxis(way, -1, 0))
    first = d.argmin(-1)
    two = np.sort(d, -1)[..., :2]
    return np.take_along_axis(way, first[..., None, None], 2)[:, :, 0], two[..., 1] - two[..., 0] < 1e-4
