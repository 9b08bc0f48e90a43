# SPDX-License-Identifier: GPL-3.0-or-later
"""Two contours a pixel or two apart: a collar's lower rim and its upper one, with a ledge between. They stay two lines,
and nothing leads from one to the other."""

import numpy as np
import passes
import pytest
from judge import verdict
from judge.camera import look
from judge.kinds import FLAT, coloured, column
from judge.scene import Scene
from reference import near
from reference.passes import FAMILIES

COLUMNS = {  # foot, way, radius, height, collars: where, how wide, how far they stand out
    "lying": ((0.8, 0.9, 0.4), (1, 0.15, 0.45), 0.28, 1.6,
              ((0.2, 0.06, 0.05), (0.5, 0.03, 0.03), (0.9, 0.1, 0.05), (1.3, 0.05, 0.01))),
    "standing": ((-1.7, 0, 0), (0, 1, 0), 0.42, 2.1,
                 ((0.2, 0.03, 0.02), (0.5, 0.06, 0.06), (0.9, 0.1, 0.03), (1.25, 0.04, 0.04), (1.7, 0.12, 0.07)))}


def left(layers, **how):
    """The sites that are left, and how many links each has."""
    every = passes.run(layers, verdict.PARAMS | how)[1]
    last = next(s for s in every if s.name == "drop short")
    kept = last.site["dropped"] == 0
    return last.site[kept], np.bincount(last.link[:, 0], minlength=len(kept))[kept]


@pytest.mark.parametrize("name", COLUMNS)
def test_nothing_leads_from_a_rim_of_a_collar_to_the_other(name):
    scene = Scene(look([0.1, 1.8, 6.0], [0, 0.95, 0]), coloured(column(*COLUMNS[name])), FLAT)
    site, links = left(scene.layers("blackman"))
    at, true = np.stack([site["x"], site["y"]], 1), np.stack([scene.truth.x, scene.truth.y], 1)
    assert set(near.pairs(at, true[::2], 0.9)[0]) == set(range(len(site)))
    fold = scene.truth.take((scene.truth.angle > 60) & ~scene.truth.outline)
    other = at[site["family"] > 0]  # a ledge's own fold, where it is wide
    assert set(near.pairs(other, np.stack([fold.x, fold.y], 1), 0.15)[0]) == set(range(len(other)))
    assert (links > 2).sum() < 32  # about where a rim meets the outline: four a collar, and a few more


def aslant(turn, half, depth):
    """Layers of a stripe before, in or behind a wall that is 4 away, half as many pixels wide as it says."""
    y, x = np.mgrid[:48, :64]
    off = (x - 31.3) * np.sin(np.radians(turn)) + (y - 23.7) * np.cos(np.radians(turn))
    stripe = np.abs(off) < half
    flat = np.ones((48, 64, 3), np.float32)
    layers = dict(combined=np.ones((48, 64, 4)), color=flat, diffuse=flat, normal=flat * (0, 0, 1),
                  albedo=np.where(stripe[..., None], 0.3, flat), depth=np.where(stripe, depth, 4.0),
                  object=np.where(stripe, 2, 1))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


@pytest.mark.parametrize("turn", [20, 35, 45, 60])
@pytest.mark.parametrize("depth", [3.98, 4.0, 4.03])
def test_the_sides_of_a_stripe_aslant_never_meet(turn, depth):
    """Whether it is inlaid, or lies a little before or behind what is beside it."""
    site, links = left(aslant(turn, 0.55, depth), line_color_strength=0.0)
    assert len(site) > 60 and links.max() == 2


@pytest.mark.parametrize("turn, half, depth, meet", [
    (45, 0.4, 3.955, 35), (45, 0.4, 3.965, 0), (60, 0.5, 3.9, 4)])  # of the last, other places show on five
def test_those_of_a_wire_do_where_it_is_narrower_than_a_pixel(turn, half, depth, meet):
    """It lies 0.01 of its depth before the others, and shows on four of the 4x4 pixels about the place."""
    site, links = left(aslant(turn, half, depth), line_color_strength=0.0)
    inner = (np.abs(site["x"] - 31.5) < 26) & (np.abs(site["y"] - 23.5) < 18)
    assert (links[inner] > 2).sum() == meet


def ledge(wide, place):
    """Layers of a box before a wall: its top is so many pixels high, and bends at row 24 + place, a little aslant."""
    fine = (np.arange(48 * 64) + 0.5) / 64 - 0.5
    fold = 24 + place + 0.02 * np.arange(96)
    front = fine[:, None] > fold
    normal = np.where(front[..., None], (0, 0.1, 0.995), (0, 0.995, 0.1))
    there = fine[:, None] > fold - wide
    normal = np.where(there[..., None], normal, (0, 0, 1.0)).reshape(48, 64, 96, 3).mean(1)
    number = np.arange(48)[:, None] > fold - wide
    flat = np.ones((48, 96, 3))
    layers = dict(combined=np.ones((48, 96, 4)), color=flat, diffuse=flat, albedo=flat, normal=normal,
                  depth=np.where(number, 3.0, 4.0), object=np.where(number, 2, 1))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, fold


@pytest.mark.parametrize("place", [0.0, 0.45, 0.8])
def test_a_fold_close_beside_an_outline_is_whole(place):
    """The last pixel before the outline's own shows one face: that is enough to tell where it ends."""
    layers, fold = ledge(2.6, place)
    site, _ = left(layers, line_color_strength=0.0)
    crease = site[site["family"] == FAMILIES.index("normal")]
    off = np.abs(crease["y"] - fold[np.rint(crease["x"]).astype(int)])
    assert len(set(np.rint(crease["x"]).astype(int))) > 88 and off.max() < 0.15


@pytest.mark.parametrize("radius", [3.2, 4.7, 8.3])
def test_a_pole_has_no_fold_beside_its_rim(radius):
    across = (np.arange(96) - 47.3) / radius
    on = np.abs(across) < 1
    fine = (np.arange(96 * 16) + 0.5) / 16 - 0.5
    x = np.clip((fine - 47.3) / radius, -1, 1)
    normal = np.stack([x, 0 * x, np.sqrt(1 - x * x)], 1)
    normal[np.abs(x) == 1] = 0, 0, 1
    normal = np.broadcast_to(normal.reshape(96, 16, 3).mean(1), (48, 96, 3))
    flat = np.ones((48, 96, 3))
    layers = dict(combined=np.ones((48, 96, 4)), color=flat, diffuse=flat, albedo=flat, normal=normal,
                  depth=np.broadcast_to(np.where(on, 3.0, 4.0), (48, 96)),
                  object=np.broadcast_to(np.where(on, 2, 1), (48, 96)))
    site, _ = left({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, line_color_strength=0.0)
    assert len(site) > 80 and not site["family"].any()
