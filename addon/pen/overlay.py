# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rasteriser drew, laid over what Cycles rendered: each pixel gets what belongs to its own object."""

from collections.abc import Callable

import numpy as np

from . import saved
from .job import Frame

# The 5x5 window about a pixel without it: least distance first, then least row, then least column.
_WINDOW = sorted(((y, x) for y in range(-2, 3) for x in range(-2, 3) if y or x),
                 key=lambda at: (at[0] ** 2 + at[1] ** 2, at))
# Channels of the layer `anchor`; the size of a pixel follows the normal.
_PLACE, _FACING, _RIGHT, _DOWN = (saved.ANCHOR[f"Encre Anchor{which}"] for which in ("", " Normal", " X", " Y"))
_NORMAL, _PIXEL = slice(_FACING.start, _FACING.stop - 1), _FACING.stop - 1
_GRAZING = 0.06  # cosine of the steepest slope that is told of a surface which only its normal tells of


def own_pixels(index: np.ndarray, drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where to read what was rasterised, so that each pixel gets what belongs to its own object.

    index: (height, width) object numbers of the picture; drawn: those of the rasteriser, which knows nothing of
    clipped leaves, hair and displacement. Returns (pixels, sources), flat pixel numbers: `pixels` are those
    where the two differ, `sources` the nearest pixel of the 5x5 whose `drawn` is the pixel's object, -1 for none.
    """
    height, width = index.shape
    pixels = np.flatnonzero(index != drawn)
    rows, columns = np.divmod(pixels, width)
    own, sources = index[rows, columns], np.full(pixels.size, -1, np.intp)
    for y, x in _WINDOW:
        at = np.flatnonzero(sources < 0)
        row, column = rows[at] + y, columns[at] + x
        inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
        at, row, column = at[inside], row[inside], column[inside]
        hit = drawn[row, column] == own[at]
        sources[at[hit]] = row[hit] * width + column[hit]
    return pixels, sources


def settled(index: np.ndarray, drawn: np.ndarray, where: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """The index of the picture, where surfaces of several objects coincide the rasteriser's: a renderer shows now one
    of them, now another, from pixel to pixel.

    index, drawn: (height, width) object numbers; where: bool, the pixels at which the rasteriser says that two
    coincide; pairs: (n, 2) numbers of those that do somewhere.
    """
    alike = np.arange(int(max(index.max(), drawn.max(), pairs.max(initial=0))) + 1)  # one may never lie in front
    for one, other in pairs.astype(np.intp):
        alike[alike == alike[other]] = alike[one]
    grown = np.pad(where, 1)  # a centre on the edge of one of them
    near = where | grown[:-2, 1:-1] | grown[2:, 1:-1] | grown[1:-1, :-2] | grown[1:-1, 2:]
    given, own = (np.clip(numbers, 0, len(alike) - 1).astype(np.intp) for numbers in (index, drawn))
    return np.where(near & (alike[given] == alike[own]), drawn, index)


def compact(maps: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The rasteriser's pictures as long as Cycles renders: numbers in as few bytes as they need, and what is 0
    everywhere left out. Of `coincident` it stays where there are any, and in `pairs` of which objects."""
    out = {}
    coincident = maps.pop("coincident", None)
    if coincident is not None and coincident.any():
        out["coincident"] = coincident != 0
        both = maps["object"][out["coincident"]], coincident[out["coincident"]]
        out["pairs"] = np.unique(np.stack(both, 1).astype(np.int32), axis=0)
    for name, picture in maps.items():
        if name not in ("attributes", "anchor", "tangent", "card"):
            out[name] = picture.astype(np.min_scalar_type(int(picture.max())))
        elif picture.any():
            out[name] = picture
    return out


def rasterised(index: np.ndarray, maps: dict[str, np.ndarray], owners: np.ndarray, numbers: np.ndarray,
               strays: Callable[[np.ndarray], np.ndarray]) -> dict[str, np.ndarray]:
    """The layers object, material and style, and, where there are any, controls, anchor, tangent and card.

    index: (height, width) object index that Cycles wrote. maps: what compact() gave of the rasteriser's pictures
    `object` (a number per part of an instance, 0 = nothing), `material`, `style`, `attributes` (the controls),
    `anchor`, `tangent` and `card`, and `coincident` and `pairs`; each is popped when it is read.
    owners[number]: what Cycles wrote for that instance; numbers[number]: what the object layer says for it.
    strays(indices): the same for pixels whose object was not drawn nearby, from Cycles' indices.
    """
    instance = maps.pop("object").reshape(index.shape)
    if "coincident" in maps:
        index = settled(index, owners[instance], maps.pop("coincident"), owners[maps.pop("pairs")])
    pixels, sources = own_pixels(index, owners[instance])
    found = sources >= 0

    def moved(picture, neutral=0):
        flat = np.array(picture, np.float32, order="C").reshape(index.size, -1)
        flat[pixels[found]] = flat[sources[found]]
        flat[pixels[~found]] = neutral
        return flat.reshape(*index.shape, -1)

    own = index.reshape(-1)[pixels[~found]]

    def usual(picture):
        """Of each pixel whose object was not drawn nearby, as where a leaf's clear part hides it, what most have of it:
        else there would be borders of materials around nothing."""
        at = np.flatnonzero(np.isin(index, own) & (index == owners[instance]))
        both = index.reshape(-1)[at], picture.reshape(-1)[at]
        (things, values), count = np.unique(both, axis=1, return_counts=True)
        order = np.lexsort((-values, count))  # the last of each thing is its most frequent, of those the least
        most = dict(zip(things[order], values[order], strict=True))
        return np.array([most.get(thing, 0) for thing in own], np.float32).reshape(-1, 1)

    layers = {"object": moved(numbers[instance], strays(own).reshape(-1, 1))}
    for name in ("material", "style"):
        picture = maps.pop(name)
        layers[name] = moved(picture, usual(picture) if picture.any() and own.size else 0)
    if "attributes" in maps:
        layers["controls"] = moved(maps.pop("attributes"))
    if "anchor" in maps:
        layers["anchor"] = moved(maps.pop("anchor"))
        _extrapolate(layers["anchor"], pixels[found], sources[found])
    if "tangent" in maps:
        layers["tangent"] = moved(maps.pop("tangent"))
    if "card" in maps:
        layers["card"] = card = moved(maps.pop("card"))
        right, down = _steps(pixels[found], sources[found], card.shape[1])
        there = card.reshape(-1, card.shape[2])[pixels[found]]
        there[:, :2] += right * there[:, 2:] + down * there[:, 3:1:-1] * np.array((1, -1), np.float32)
        card.reshape(-1, card.shape[2])[pixels[found]] = there
    return layers


def _extrapolate(anchor, pixels, sources):
    """Puts right the rest positions at `pixels` that were taken from `sources`, flat numbers, as if the surface went on
    evenly: else a pattern would be torn there."""
    flat = anchor.reshape(-1, anchor.shape[2])
    right, down = _steps(pixels, sources, anchor.shape[1])
    flat[pixels, _PLACE] += right * flat[pixels, _RIGHT]
    flat[pixels, _PLACE] += down * flat[pixels, _DOWN]


def _steps(pixels, sources, width):
    """How many pixels to the right and down `pixels` lie of `sources`, flat numbers, (n, 1) each."""
    rows, columns = (one - other for one, other in zip(np.divmod(pixels, width), np.divmod(sources, width),
                                                       strict=True))
    return columns[:, None].astype(np.float32), rows[:, None].astype(np.float32)


def complete_anchor(layers: dict[str, np.ndarray], view: np.ndarray, projection: np.ndarray, frame: Frame) -> None:
    """Fills the layer `anchor`, if there is one, where something is that the rasteriser knows nothing of, as hair: with
    its own place in the world.

    view, projection: world -> camera and camera -> clip, 4 x 4; frame: the full frame and the place of the picture in
    it.
    """
    anchor = layers.get("anchor")
    if anchor is None:
        return
    rows, columns = np.nonzero((anchor[..., _PIXEL] == 0) & ~_nothing(layers["depth"]))
    depth, normal = (layers[name][rows, columns].astype(np.float64) for name in ("depth", "normal"))
    to_world, orthographic = np.linalg.inv(view), projection[3, 3] == 1

    def place(right, down, z):
        """Of what lies at depth z on the line of sight through a place beside the pixels' centres."""
        x = 2 * (columns + frame.x + 0.5 + right) / frame.width - 1
        y = 1 - 2 * (rows + frame.y + 0.5 + down) / frame.height
        along = 1 if orthographic else z  # w of the clip space
        camera = np.stack([(x * along + projection[0, 2] * z - projection[0, 3]) / projection[0, 0],
                           (y * along + projection[1, 2] * z - projection[1, 3]) / projection[1, 1], -z], 1)
        return camera @ to_world[:3, :3].T + to_world[:3, 3]

    z = depth[:, 0]
    here = place(0, 0, z)
    pixel = np.linalg.norm(place(0, 1, z) - here, axis=1)
    ray = place(0, 0, z + 1) - here
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(length > 0, normal / np.maximum(length, 1e-30), -ray)
    facing = (normal * ray).sum(1)
    facing = np.copysign(np.maximum(np.abs(facing), _GRAZING * np.linalg.norm(ray, axis=1)), facing)
    known = anchor[rows, columns]
    known[:, _PLACE], known[:, _NORMAL], known[:, _PIXEL] = here, normal, pixel
    for channels, right, down in ((_RIGHT, 1, 0), (_DOWN, 0, 1)):
        aside = place(right, down, z) - here
        known[:, channels] = aside - ray * ((normal * aside).sum(1) / facing)[:, None]
    anchor[rows, columns] = known


# A layer's value where nothing is.
_NOTHING = {"object": 0, "material": 0, "style": 0, "controls": 0, "depth": 1e10, "normal": 0, "color": 0, "albedo": 0,
            "diffuse": 0, "specular": 0, "highlights": 0, "gloss": 0, "anchor": 0, "tangent": 0, "card": 0,
            "seen_color": 0, "seen_normal": 0, "seen_depth": 0}


SHADED = 0.98  # share of its light that no shadow leaves to a catcher
# What tones need of a shadow that a catcher shows.
_SHADOW = "diffuse", "anchor", "tangent", "card"


def hide(layers: dict[str, np.ndarray], hidden: np.ndarray, shadows: np.ndarray | None = None) -> None:
    """Changes the layers so that nothing is at the pixels `hidden` (height, width) but what `combined` shows, and of
    those in `shadows`, which a catcher shows, how much light falls where."""
    hidden = with_beside(hidden, _nothing(layers["depth"]))
    bare = hidden if shadows is None else hidden & ~shadows
    for name, value in _NOTHING.items():
        if name in layers:
            layers[name][bare if name in _SHADOW else hidden] = value


def with_beside(hidden: np.ndarray, nothing: np.ndarray) -> np.ndarray:
    """The pixels `hidden`, and those beside them that show nothing, whose colours are averaged with theirs."""
    beside = np.zeros(np.add(hidden.shape, 2), bool)
    for y, x in np.ndindex(3, 3):
        beside[y:y + hidden.shape[0], x:x + hidden.shape[1]] |= hidden
    return hidden | (beside[1:-1, 1:-1] & nothing)


def _nothing(depth):
    return (depth[..., 0] >= 1e9) | ~(depth[..., 0] > 0)
