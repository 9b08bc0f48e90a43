# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rasteriser drew, laid over what Cycles rendered: each pixel gets what belongs to its own object."""

import numpy as np

from . import layers

# The 5x5 window about a pixel without it: least distance first, then least row, then least column.
_WINDOW = sorted(((y, x) for y in range(-2, 3) for x in range(-2, 3) if y or x),
                 key=lambda at: (at[0] ** 2 + at[1] ** 2, at))


def own_pixels(index, drawn):
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


def rasterised(index, maps, owners, numbers, strays):
    """The passes Encre Index, those of the painted controls, and Encre Marks.

    index: (height, width) object index that Cycles wrote. maps: the rasteriser's pictures `object` (a number per
    part of an instance, 0 = nothing), `material`, `style`, `attributes` (the controls) and `marks`.
    owners[number]: what Cycles wrote for that instance; numbers[number]: what the object layer says for it.
    strays(indices): the same for pixels whose object was not drawn nearby, from Cycles' indices.
    """
    shape = index.shape
    instance = maps["object"].reshape(shape).astype(np.intp)
    pixels, sources = own_pixels(index, owners[instance])
    found = sources >= 0
    passes = {}

    def moved(picture, channels, neutral=0):
        flat = np.array(picture, np.float32, order="C").reshape(-1, channels)
        flat[pixels[found]] = flat[sources[found]]
        flat[pixels[~found]] = neutral
        return flat.reshape(*shape, channels)

    lost = strays(index.reshape(-1)[pixels[~found]]).reshape(-1, 1)
    passes["Encre Index"] = np.concatenate(
        [moved(numbers[instance], 1, lost), moved(maps["material"], 1), moved(maps["style"], 1)], axis=2)
    passes.update(layers.saved_controls(moved(maps["attributes"], maps["attributes"].shape[-1])))
    passes["Encre Marks"] = _seen_marks(maps["marks"], pixels)
    return passes


def _seen_marks(marks, strays):
    """(height, width, 3): marks (height, width, 2) but for ways to or from `strays`, flat numbers of pixels that show
    something else than the rasteriser drew."""
    seen = np.zeros((*marks.shape[:2], 3), np.float32)
    seen[..., :2] = marks
    stray = np.zeros(marks.shape[:2], bool)
    stray.reshape(-1)[strays] = True
    seen[stray] = 0
    seen[:, :-1, 0][stray[:, 1:]] = 0
    seen[:-1, :, 1][stray[1:]] = 0
    return seen
