# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces in fog and smoke, as a renderer has them: of the samples of a pixel only some come through. Index and depth
are those of the first, and missing where it did not; normals and colours are means over all, of which those that did
not come through count as nothing. What the meshes know takes their place, and colours are those of the samples that
came through."""

from dataclasses import dataclass

import numpy as np

_LEAST = 0.1  # share of the samples that must have come through for their colours to count
_EVEN = 0.98  # cosine from which on normals about a pixel are one: the length of their mean then is that share
_ROUNDS = 12  # pixels over which colours are taken from neighbours
_MEANS = "DiffCol", "GlossCol", "TransCol"  # with the share in them
_RATIOS = "DiffDir", "DiffInd"  # without it, and 0 where nothing came through


@dataclass
class Haze:
    """The rasteriser's pictures, without what is clear: number of the object, 0 = nothing, depth, normal; and which of
    the pixels (rows, columns: slices) may be hazy."""

    object: np.ndarray
    depth: np.ndarray
    normal: np.ndarray
    where: tuple


def settled(index: np.ndarray, depth: np.ndarray, known: Haze, owners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(index, depth) (height, width), those of the meshes where the first sample did not come through. owners: by
    number of the rasteriser's object, the index of each."""
    lost = np.zeros(index.shape, bool)
    lost[known.where] = (index == 0)[known.where]
    lost &= (depth >= 1e9) & (known.object > 0)
    return np.where(lost, owners[known.object], index), np.where(lost, known.depth, depth)


def cleared(passes: dict[str, np.ndarray], known: Haze) -> None:
    """Changes normals, colours and light to what they are without the haze."""
    at = known.where
    normal, number, mesh = passes["Normal"][at], known.object[at], known.normal[at]
    there = number > 0
    share = np.linalg.norm(normal, axis=2)
    sure = there & (share >= _LEAST) & _even(mesh, number)
    far = share < 0.995
    if not (there & far).any():
        return
    by = np.where(sure, share, 1)[..., None]
    for name in ("Normal", *_MEANS, *_RATIOS):  # others may read what was rendered
        if name in passes:
            passes[name] = np.array(passes[name])
    passes["Normal"][at] = np.where((there & far)[..., None], np.where(sure[..., None], normal / by, mesh), normal)
    for name in (*_MEANS, *_RATIOS):
        if name in passes:
            picture = passes[name][at]
            given = picture / by if name in _MEANS else picture
            passes[name][at] = np.where(there[..., None], _filled(given, sure, number), picture)


def _even(normal, number):
    """Whether a pixel's neighbours that show the same thing face as it does."""
    even = np.ones(number.shape, bool)
    for axis in (0, 1):
        for step in (-1, 1):
            other = np.roll(normal, step, axis)
            same = np.roll(number, step, axis) == number
            even &= ~same | (np.einsum("yxc,yxc->yx", normal, other) > _EVEN)
    return even


def _filled(picture, sure, number):
    """A picture whose pixels that are not sure have the mean of their neighbours of the same thing that are, or were
    filled before."""
    picture, known = np.array(picture), np.array(sure)
    for _ in range(_ROUNDS):
        if known.all():
            break
        total, count = np.zeros_like(picture), np.zeros(number.shape, np.float32)
        for axis in (0, 1):
            for step in (-1, 1):
                use = (np.roll(known, step, axis) & (np.roll(number, step, axis) == number))
                total += np.roll(picture, step, axis) * use[..., None]
                count += use
        new = ~known & (count > 0)
        picture[new] = total[new] / count[new][:, None]
        known |= new
    return picture
