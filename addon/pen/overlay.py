# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rasteriser drew, laid over what Cycles rendered: each pixel gets what belongs to its own object."""

from collections.abc import Callable

import numpy as np

# The 5x5 window about a pixel without it: least distance first, then least row, then least column.
_WINDOW = sorted(((y, x) for y in range(-2, 3) for x in range(-2, 3) if y or x),
                 key=lambda at: (at[0] ** 2 + at[1] ** 2, at))


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
    alike = np.arange(int(max(index.max(), drawn.max())) + 1)
    for one, other in pairs.astype(np.intp):
        alike[alike == alike[other]] = alike[one]
    grown = np.pad(where, 1)  # a centre on the edge of one of them
    near = where | grown[:-2, 1:-1] | grown[2:, 1:-1] | grown[1:-1, :-2] | grown[1:-1, 2:]
    given, own = (np.clip(numbers, 0, len(alike) - 1).astype(np.intp) for numbers in (index, drawn))
    return np.where(near & (alike[given] == alike[own]), drawn, index)


def compact(maps: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The rasteriser's pictures as long as Cycles renders: numbers in as few bytes as they need, and what is 0
    everywhere left out. Creases get as a fifth channel what bends() tells of the `normal` of the faces, which goes.
    Of `coincident` it stays where there are any, and in `pairs` of which objects."""
    out = {}
    coincident = maps.pop("coincident", None)
    if coincident is not None and coincident.any():
        out["coincident"] = coincident != 0
        both = maps["object"][out["coincident"]], coincident[out["coincident"]]
        out["pairs"] = np.unique(np.stack(both, 1).astype(np.int32), axis=0)
    if "creases" in maps:
        creases, normal = maps.pop("creases"), maps.pop("normal")
        out["creases"] = np.empty((*creases.shape[:2], 5), np.float16)  # to 1/2048 pixel and 1/16 degree
        out["creases"][..., :4] = creases
        out["creases"][..., 4] = bends(normal)
    for name, picture in maps.items():
        if name not in ("attributes", "marks"):
            out[name] = picture.astype(np.min_scalar_type(int(picture.max())))
        elif picture.any():
            out[name] = picture
    return out


def rasterised(index: np.ndarray, maps: dict[str, np.ndarray], owners: np.ndarray, numbers: np.ndarray,
               strays: Callable[[np.ndarray], np.ndarray]) -> dict[str, np.ndarray]:
    """The layers object, material and style, and, where there are any, controls and marks.

    index: (height, width) object index that Cycles wrote. maps: what compact() gave of the rasteriser's pictures
    `object` (a number per part of an instance, 0 = nothing), `material`, `style`, `attributes` (the controls) and
    `marks` and `creases`, and `coincident` and `pairs`; each is popped when it is read.
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

    lost = strays(index.reshape(-1)[pixels[~found]]).reshape(-1, 1)
    layers = {"object": moved(numbers[instance], lost), "material": moved(maps.pop("material")),
              "style": moved(maps.pop("style"))}
    if "attributes" in maps:
        layers["controls"] = moved(maps.pop("attributes"))
    if "marks" in maps:
        layers["marks"] = without(maps.pop("marks"), pixels)
    if "creases" in maps:
        layers["creases"] = np.array(maps.pop("creases"), np.float32)
        without(layers["creases"][..., :4], pixels)
        layers["creases"].reshape(-1, 5)[pixels, 4] = -1  # no mesh tells of them
    return layers


# A layer's value where nothing is.
_NOTHING = {"object": 0, "material": 0, "style": 0, "controls": 0, "depth": 1e10, "normal": 0, "color": 0, "albedo": 0,
            "diffuse": 0, "specular": 0, "highlights": 0, "seen_color": 0, "seen_normal": 0, "seen_depth": 0}


def hide(layers: dict[str, np.ndarray], hidden: np.ndarray) -> None:
    """Changes the layers so that nothing is at the pixels `hidden` (height, width) but what `combined` shows: a shadow
    catcher. Along a way between two pixels at which nothing is there is no contour and no crease."""
    nothing = _nothing(layers["depth"])
    beside = np.zeros(np.add(hidden.shape, 2), bool)
    for y, x in np.ndindex(3, 3):
        beside[y:y + hidden.shape[0], x:x + hidden.shape[1]] |= hidden
    hidden = hidden | (beside[1:-1, 1:-1] & nothing)  # whose colours are averaged with the catcher's
    for name, value in _NOTHING.items():
        if name in layers:
            layers[name][hidden] = value
    nothing |= hidden
    between = np.zeros((*nothing.shape, 2), bool)
    between[:, :-1, 0] = nothing[:, :-1] & nothing[:, 1:]
    between[:-1, :, 1] = nothing[:-1] & nothing[1:]
    if "marks" in layers:
        layers["marks"][between & (layers["marks"] < 0)] = 0
    if "creases" in layers:
        layers["creases"][..., :4][np.repeat(between, 2, 2)] = 0


def _nothing(depth):
    return (depth[..., 0] >= 1e9) | ~(depth[..., 0] > 0)


def without(ways: np.ndarray, strays: np.ndarray) -> np.ndarray:
    """What is told of ways to the right and down (height, width, 2 n), changed: nothing of those to or from `strays`,
    flat numbers of pixels that show something else than the rasteriser drew."""
    n = ways.shape[2] // 2
    stray = np.zeros(ways.shape[:2], bool)
    stray.reshape(-1)[strays] = True
    ways[stray] = 0
    ways[:, :-1, :n][stray[:, 1:]] = 0
    ways[:-1, :, n:][stray[1:]] = 0
    return ways


def bends(normal: np.ndarray) -> np.ndarray:
    """By how many degrees the faces on both sides of each pixel differ, in the direction in which they do most,
    (height, width). normal: (height, width, 3), 0 where nothing is."""
    height, width = normal.shape[:2]
    least = np.ones((height, width), np.float32)
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        inner = least[down:height - down, abs(right):width - abs(right)]
        first, last = abs(right) - right, width - abs(right) - right
        one = normal[:height - 2 * down, first:last]
        other = normal[2 * down:, first + 2 * right:last + 2 * right]
        np.minimum(inner, np.einsum("yxc,yxc->yx", one, other), out=inner)
    return np.degrees(np.arccos(np.clip(least, -1, 1)))
