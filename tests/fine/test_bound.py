# SPDX-License-Identifier: GPL-3.0-or-later
"""Which marks become sites where there are more than a tile may have, against all of them ordered by hand."""

import re
from pathlib import Path

import noise
import numpy as np
import passes
import pytest
from reference.passes import COLUMN, FAMILIES, JUNCTION

ROWS = Path(__file__).parents[2] / "csrc" / "fine" / "families.rows.h"
FIRST = {"CRACK": 0, "RIDGE": 16, "MORE": 32}  # of a word of marks, among the numbers that are shuffled
WORDS = {name.lower(): FIRST[word or dict(CRACK="CRACK", THIN="RIDGE", VALLEY="MORE")[kind]] + int(bit)
         for kind, name, word, bit in re.findall(
             r"^(?!CHAIN)(\w+)_FAMILY\((\w+),.*?(RIDGE|MORE|), +(\d+)\)", ROWS.read_text(), re.MULTILINE)}
SETTINGS = dict(line_color_strength=2.0, line_shadow_strength=3.0, line_mirror_strength=1.0, edge_threshold=0.05)
TILE, WIDE, MARGIN = (60, 70), 10, 12  # two tiles; strips, and what lies around them and may say what they show


def shuffled(x):
    x = np.asarray(x, np.uint32)
    for factor in (0x7feb352d, 0x846ca68b):
        x = (x ^ x >> np.where(factor == 0x7feb352d, np.uint32(16), np.uint32(15))) * np.uint32(factor)
    return x ^ x >> np.uint32(16)


def key_of(site):
    """The strongest first; as strong ones by squares of 2 x 2 pixels, then each for itself."""
    row, column = site["row"].astype(np.uint32), site["column"].astype(np.uint32)
    slot = np.array([WORDS[FAMILIES[k]] for k in site["family"]]) + (site["axis"] == COLUMN)
    slot = np.where(site["axis"] == JUNCTION, 8 + slot // 2, slot).astype(np.uint32)
    block = shuffled(row // 2 << np.uint32(16) | column // 2) & np.uint32(0xffff0000)
    own = shuffled(shuffled(row << np.uint32(16) | column) + slot) >> np.uint32(16)
    return site["strength"].view(np.uint32).astype(np.uint64) << np.uint64(32) | (block | own)


def drawn(height, width):
    """Noise of which every family has a part."""
    rng, layers = np.random.default_rng(1), noise.everywhere(width, height)
    layers["depth"][:] = 4
    layers["material"][:] = 0
    layers["object"] = (rng.random((height, width)) < 0.12).astype(np.float32)
    return layers


def found(layers):
    every = passes.run({name: np.ascontiguousarray(a) for name, a in layers.items()}, SETTINGS)[1]
    return next(s.site for s in every if s.name == "gather")


def all_of(layers, size, axis):
    """Sites of strips that are too small to be bounded."""
    parts = []
    for begin in range(0, size, WIDE):
        low, high = max(0, begin - MARGIN), min(size, begin + WIDE + MARGIN)
        at = (slice(None),) * axis + (slice(low, high),)
        site = found({name: a[at] for name, a in layers.items()})
        assert len(site) < 4096
        along = ("row", "column")[axis]
        site = site.copy()
        site[along] += low
        parts.append(site[(site[along] >= begin) & (site[along] < begin + WIDE)])
    return np.concatenate(parts)


@pytest.mark.parametrize("axis", [0, 1])
def test_the_strongest_of_a_tile_become_sites(axis):
    height, width = shape = (2 * TILE[1] + 1, TILE[0]) if axis == 0 else (TILE[0], 2 * TILE[1] + 1)
    layers = drawn(height, width)
    every, got = all_of(layers, shape[axis], axis), found(layers)
    which = ("row", "column")[axis]
    for first, end in ((0, TILE[1]), (TILE[1], 2 * TILE[1] + 1)):  # the second is wider by one
        mine = every[(every[which] >= first) & (every[which] < end)]
        most = TILE[0] * (end - first)
        assert len(mine) > 1.05 * most
        own = got[(got[which] >= first) & (got[which] < end)]
        assert named(mine[np.argsort(key_of(mine))[-most:]]) == named(own)


def named(sites):
    return {tuple(s) for s in sites[["family", "row", "column", "axis"]]}
