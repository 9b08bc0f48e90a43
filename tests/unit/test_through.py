# SPDX-License-Identifier: GPL-3.0-or-later
"""What lets light through at random: index and depth of its pixels, on drawn pictures."""

import numpy as np
import pytest
from encre.pen import through

SHAPE = 60, 80
OWNERS = np.array([0, 7, 8, 9], np.float32)  # the board's object is 1, behind it lie 2 on the left, 3 on the right


def board(shown):
    """(index, depth, what the rasteriser knows, its objects) of a board at depth 2, of which `shown` is rendered."""
    behind = np.where(np.arange(SHAPE[1]) < 37, 2, 3) * np.ones(SHAPE, int)
    far = np.where(behind == 2, 5.0, 6.0) + 0.01 * np.arange(SHAPE[1])
    front = np.zeros(SHAPE, int)
    front[5:55, 6:74] = 1
    covered = front > 0
    index = np.where(covered & shown, OWNERS[1], OWNERS[behind])
    depth = np.where(covered & shown, 2.0, far).astype(np.float32)
    maps = {"material": np.where(covered, 4.0, 1.0), "depth": np.where(covered, 2.0, far)}
    known = through.find(maps, {"object": behind, "depth": far}, np.arange(6) == 4)
    return index, depth, known, np.where(covered, front, behind), OWNERS[behind], far, covered


def reference(region, solid, reach):
    """For every pixel of the region: by how much the share of its neighbours about that differ is above what chance
    makes of it, one pixel after the other."""
    out = {}
    for y, x in np.argwhere(region):
        part = whole = differ = pairs = 0
        for j in range(max(0, y - reach), min(SHAPE[0], y + reach + 1)):
            for i in range(max(0, x - reach), min(SHAPE[1], x + reach + 1)):
                whole, part = whole + region[j, i], part + (region[j, i] and solid[j, i])
                for b, a in ((0, 1), (1, 0), (1, 1), (1, -1)):
                    one, other = (j, i), (j + b, i + a)
                    if other[0] < SHAPE[0] and 0 <= other[1] < SHAPE[1] and region[one] and region[other]:
                        pairs, differ = pairs + 1, differ + (solid[one] != solid[other])
        out[y, x] = differ - 0.9 * 2 * part / whole * (1 - part / whole) * pairs if pairs >= 40 and differ else -1
    return out


@pytest.mark.parametrize("share", [0.05, 0.2, 0.35, 0.45])
def test_what_is_shown_at_random_is_what_lies_behind(share):
    shown = np.random.default_rng(1).random(SHAPE) < share
    index, depth, known, front, behind, far, covered = board(shown)
    got, at = through.settled(index, depth, known, front, OWNERS)
    wrong = (got != behind) & covered
    assert wrong.sum() < 0.01 * (shown & covered).sum() + 3
    np.testing.assert_allclose(at[~wrong], far[~wrong], rtol=1e-6)
    assert covered[got != index].all()


def test_what_is_mostly_shown_is_there():
    shown = np.random.default_rng(1).random(SHAPE) < 0.8
    index, depth, known, front, *_ = board(shown)
    got, at = through.settled(index, depth, known, front, OWNERS)
    inside = np.s_[9:51, 10:70]
    assert (got[inside] == 7).mean() > 0.99 and (at[inside] == 2).mean() > 0.99


@pytest.mark.parametrize("cut", ["all", "none", "half", "stems", "squares", "disc"])
def test_what_is_cut_out_stays_as_it_is(cut):
    y, x = np.mgrid[:SHAPE[0], :SHAPE[1]]
    shown = {"all": y >= 0, "none": y < 0, "half": 2 * y + x < 80,
             "stems": ((x + y // 3) % 13 == 0) & (abs(x - 40) < 25), "squares": (x // 6 + y // 6) % 2 == 0,
             "disc": np.hypot(y - 30, x - 40) < 17}[cut]
    index, depth, known, front, *_ = board(shown)
    got, at = through.settled(index, depth, known, front, OWNERS)
    assert np.array_equal(got, index) and np.array_equal(at, depth)


def test_chance_against_the_reference():
    """Chance on the left, squares on the right; where enough pixels about are sure of it, it is."""
    random, (y, x) = np.random.default_rng(2), np.mgrid[:SHAPE[0], :SHAPE[1]]
    region = (y > 3) & (y < 50) & (x > 5)
    solid = np.where(x < 40, random.random(SHAPE) < 0.3, (x // 7 + y // 7) % 2 == 0) & region
    margins = reference(region, solid, 5)
    sure = np.zeros(SHAPE, bool)
    for at, margin in margins.items():
        sure[at] = margin >= 0
    want = np.zeros(SHAPE, bool)
    for j, i in margins:
        about = np.s_[max(0, j - 7):j + 8, max(0, i - 7):i + 8]
        want[j, i] = sure[about].sum() > 0.4 * region[about].sum()
    got = through._by_chance(solid, region)
    assert 0.2 < got.mean() < 0.8
    assert (got != want).sum() == 0


def test_gaps_in_a_dense_crown_stay():
    """Leaves one behind the other with gaps by chance: which leaf is seen is not by chance."""
    random, y, x = np.random.default_rng(2), *np.mgrid[:SHAPE[0], :SHAPE[1]]
    leaves = np.zeros(SHAPE, bool)
    for at in random.random((90, 2)) * SHAPE:
        leaves |= np.hypot(y - at[0], x - at[1]) < 3
    gaps = random.random(SHAPE) < 0.06
    index, depth, known, front, _, far, covered = board(leaves & ~gaps)
    behind = covered & ~leaves & ~gaps
    index, depth = np.where(behind, OWNERS[3], index), np.where(behind, 3.0, depth).astype(np.float32)
    got, at = through.settled(index, depth, known, front, OWNERS)
    assert (got != index).mean() < 0.01 and (np.abs(at - depth) > 0.01).mean() < 0.01
