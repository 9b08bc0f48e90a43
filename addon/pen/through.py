# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that let some light through. A renderer that decides at random whether a ray is let through shows now the
surface, now what lies behind it, from pixel to pixel; index and depth then hold crumbs. Where they do, what lies behind
counts, as Blender means it by its Alpha Threshold of 0.5 (Cycles is sure of what is denser), unless clearly most pixels
show the surface: far leaves, say. What is cut out cleanly stays as it was rendered."""

from dataclasses import dataclass

import numpy as np

_NEAR, _WIDE = 5, 7  # pixels each way in which neighbours are compared, and in which counts what most show
_CHANCE = 0.9  # of the share of neighbours that differ where each pixel is by chance; lines have 0.83, patches less
_SURE, _MOST = 0.4, 0.6  # shares of the pixels about
_ALIKE = 2e-3  # depths less apart, relative, are the same surface


@dataclass
class Through:
    """What the rasteriser knows of the pixels that show a surface which may let light through: their flat numbers, and
    at each the depth there, the object of the nearest surface that lets none through, 0 = nothing, and its depth."""

    pixels: np.ndarray
    depth: np.ndarray
    behind: np.ndarray
    behind_depth: np.ndarray


def find(maps: dict[str, np.ndarray], solid: dict[str, np.ndarray], clear: np.ndarray) -> Through | None:
    """What is known of the pixels of the rasteriser's pictures that show a material which is `clear`, by its number;
    None without any. solid: `object` and `depth` without such materials."""
    pixels = np.flatnonzero(clear[maps["material"].astype(np.intp)])
    if not pixels.size:
        return None
    behind = solid["object"].reshape(-1)[pixels]
    return Through(pixels.astype(np.int32), maps["depth"].reshape(-1)[pixels],
                   behind.astype(np.min_scalar_type(int(behind.max()))), solid["depth"].reshape(-1)[pixels])


def settled(index: np.ndarray, depth: np.ndarray, known: Through, front: np.ndarray,
            owners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(index, depth).

    index, depth: (height, width) as rendered; front: the rasteriser's objects; owners: by these, the index of each.
    """
    region, solid, shown = (np.zeros(index.shape, bool) for _ in range(3))
    own_index, own_depth = index.reshape(-1)[known.pixels], depth.reshape(-1)[known.pixels]
    behind = owners[known.behind]
    seen = np.where(known.behind > 0, (own_index == behind) & _alike(own_depth, known.behind_depth), own_depth >= 1e9)
    region.reshape(-1)[known.pixels] = True
    solid.reshape(-1)[known.pixels] = ~seen
    shown.reshape(-1)[known.pixels] = (own_index == owners[front.reshape(-1)[known.pixels]]) & _alike(
        own_depth, known.depth)
    rows, columns = (slice(max(0, at.min() - 1), at.max() + 2) for at in np.nonzero(region))
    mixed, whole = (np.zeros(index.shape, bool) for _ in range(2))
    # Gaps in a dense crown lie about like chance, but its leaves do not: they are whole.
    mixed[rows, columns] = (_by_chance(solid[rows, columns], region[rows, columns])
                            & _by_chance(shown[rows, columns], region[rows, columns]))
    whole[rows, columns] = _window(shown[rows, columns], _WIDE) > _MOST * _window(region[rows, columns], _WIDE)
    here = np.flatnonzero(mixed.reshape(-1)[known.pixels])
    pixels, known_here = known.pixels[here], whole.reshape(-1)[known.pixels[here]]
    index, depth = np.array(index, order="C"), np.array(depth, order="C")
    index.reshape(-1)[pixels] = np.where(known_here, owners[front.reshape(-1)[pixels]], behind[here])
    depth.reshape(-1)[pixels] = np.where(known_here, known.depth[here], known.behind_depth[here])
    return index, depth


def _alike(one, other):
    return np.abs(one - other) <= _ALIKE * np.abs(other)


def _by_chance(solid, region):
    """Where neighbours in the region differ by chance, (height, width)."""
    differ, pairs = (np.zeros(solid.shape, np.int32) for _ in range(2))
    height, width = solid.shape
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        at = np.s_[:height - down, max(0, -right):width - max(0, right)]
        to = np.s_[down:, max(0, right):width + min(0, right)]
        both = region[at] & region[to]
        pairs[at] += both
        differ[at] += both & (solid[at] != solid[to])
    found, among, part, whole = (_window(counts, _NEAR) for counts in (differ, pairs, solid, region))
    share = part / np.maximum(whole, 1)
    sure = region & (among >= 40) & (found > 0) & (found >= _CHANCE * 2 * share * (1 - share) * among)
    return region & (_window(sure, _WIDE) > _SURE * _window(region, _WIDE))


def _window(counts, reach):
    """Sums over the pixels at most `reach` away, each way."""
    sums = np.pad(counts.astype(np.int32), ((reach + 1, reach), (reach + 1, reach))).cumsum(0).cumsum(1)
    size = 2 * reach + 1
    return sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
