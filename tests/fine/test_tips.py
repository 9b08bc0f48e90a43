# SPDX-License-Identifier: GPL-3.0-or-later
"""Where two contours of one thing run together: at tips of leaves and tines, and along rails. What is drawn has no
bead, and something of a light thing is left between its lines."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Chains
from known import line

PEN = dict(edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=0.0,
           length_unit="PIXELS",
           pen_1_softness=0.0, pen_1_steepness=0.5, pen_1_intensity=2.0, pen_1_grain=0.0, use_shading=False,
           use_smudging=False,
           use_hatching=False, paper_source="NONE")
SIZE = 72, 96


def drawn(inside, thickness, samples=6):
    """Ink on a white thing before a white wall. inside(x, y): whether the thing is there."""
    y, x = np.mgrid[:SIZE[0], :SIZE[1]].astype(float)
    part = (np.arange(samples) + 0.5) / samples - 0.5
    share = np.mean([inside(x + a, y + b) for a in part for b in part], 0)[..., None]
    hit = inside(x, y)
    flat = np.ones((*SIZE, 3))
    layers = dict(combined=np.ones((*SIZE, 4)), color=0.9 - 0.1 * share * flat, diffuse=flat,
                  depth=np.where(hit, 4.0, 9.0), object=np.where(hit, 2.0, 1.0),
                  normal=share * (0, 0, 1.0) + (1 - share) * (0, 0.6, 0.8))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    made = library.render(layers, dict(PEN, line_thickness=thickness), outputs=["Encre Lines"])
    return made.images["Encre Lines"][..., 3].astype(float)


def wedge(opening, turn):
    """(inside, distance along its axis from the tip, and aside) of an endless wedge, in degrees."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    half = np.tan(np.radians(opening / 2))

    def along(x, y):
        return (x - 48.3) * c + (y - 36.2) * s, -(x - 48.3) * s + (y - 36.2) * c

    def inside(x, y):
        far, aside = along(x, y)
        return (far > 0) & (np.abs(aside) < far * half)

    return inside, *along(*np.mgrid[:SIZE[0], :SIZE[1]].astype(float)[::-1]), half


@pytest.mark.parametrize("turn", [0, 17, 45, 70, 90, 200])
@pytest.mark.parametrize("opening", [8, 15, 30])
def test_a_tip_tapers(opening, turn):
    """Ink across it nowhere grows towards the tip beyond what two lines cover, and ends thinner than one line."""
    inside, far, aside, half = wedge(opening, turn)
    for thickness in (4.0, 7.0):
        t = drawn(inside, thickness)
        near = np.abs(aside) < 14
        across = np.array([(t * near * np.maximum(0, 1 - np.abs(far - k) / 1.5)).sum() / 1.5 for k in range(2, 26)])
        assert across.max() < 2 * thickness / np.cos(np.radians(opening / 2)) + 0.5
        assert across[:2].max() < thickness, across[:4]
        widths = 2 * half * np.arange(2, 26) + thickness  # from rim to rim, were the lines as wide as elsewhere
        merged = widths < 2 * thickness
        assert (across[merged] < 0.95 * widths[merged]).all()
        assert t[np.abs(far) + np.abs(aside) < 4].max() > 0.5, "it goes to the tip"


@pytest.mark.parametrize("level", [0, 3, 20, 45])
@pytest.mark.parametrize("width", [4.5, 6.0])
def test_a_light_rail_keeps_its_light(width, level):
    c, s = np.cos(np.radians(level)), np.sin(np.radians(level))
    y, x = np.mgrid[:SIZE[0], :SIZE[1]].astype(float)
    off = (y - 36.3) * c - (x - 48.1) * s
    t = drawn(lambda x, y: np.abs((y - 36.3) * c - (x - 48.1) * s) < width / 2, 7.0)
    core = t[10:-10, 14:-14][np.abs(off[10:-10, 14:-14]) < 0.5]
    assert core.max() < (0.6 if width < 4 else 0.25)
    assert t[10:-10, 14:-14][np.abs(np.abs(off[10:-10, 14:-14]) - width / 2) < 0.4].min() > 0.9


def test_a_wide_thing_keeps_its_lines():
    t = drawn(lambda x, y: np.abs(x - 48.2) < 12, 6.0)
    assert t[20:50, :48].sum(1) == pytest.approx(6, abs=0.05)


def test_a_square_corner_is_as_wide_as_its_sides():
    """At 90 degrees two lines have little to do with each other."""
    inside = wedge(90, 90)[0]
    t = drawn(inside, 4.0)
    far = wedge(90, 90)[1]
    assert t[np.abs(far) < 1.5].max() > 0.99
    for k in (4, 6, 9):  # across one side
        row = t[36 + k, 48:]
        assert row[row > 0.01].sum() > 3.3


@pytest.mark.parametrize("slant", [0.07, 0.3, 0.8, 1.7])
def test_a_joint_of_two_materials_runs_where_the_mesh_says(slant):
    """Also where colours are not averaged and show stairs, as in fast layers."""
    y, x = np.mgrid[:SIZE[0], :SIZE[1]].astype(float)

    def side(x, y):
        return (y - 36.3) - slant * (x - 48.1) > 0

    below = side(x, y)
    joint = line([(x, 36.3 + slant * (x - 48.1)) for x in (-200, 300)], "material", bend=0, depth=4)
    flat = np.ones((*SIZE, 3))
    layers = dict(combined=np.ones((*SIZE, 4)), color=np.where(below[..., None], (0.6, 0.3, 0.2), (0.5, 0.6, 0.7)),
                  diffuse=flat, normal=flat * (0, 0, 1), depth=np.full(SIZE, 4.0), object=np.ones(SIZE),
                  material=1.0 + below)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    layers["chains"] = Chains(joint, np.ones(2, np.uint8))
    made = library.render(layers, dict(PEN, line_color_strength=3.0, line_material_strength=0.0, line_thickness=1.5,
                                       edge_threshold=0.1),
                          outputs=["Encre Lines"])
    t = made.images["Encre Lines"][..., 3].astype(float)[8:-8, 8:-8]
    off = ((y - 36.3) - slant * (x - 48.1))[8:-8, 8:-8]
    for axis in (0,) if slant < 1 else (1,):
        ink = t.sum(axis)
        place = np.where(ink > 0.5, (t * off).sum(axis) / np.maximum(ink, 0.5), 0) / np.hypot(1, slant)
        whole = (np.abs(off).min(axis) < 0.6) & (ink > 0)
        inner = whole[6:-6]
        assert inner.sum() > 20
        assert np.abs(place[6:-6][inner]).max() < 0.2


def reach_of_overshoot(size, painted=False, **more):
    """Pixels that the strokes round a square go on beyond it, of a pen that would by 12; it is a thing, or a colour."""
    object_ = np.zeros((96, 96, 1), np.float32)
    flat = np.ones((96, 96, 3), np.float32)
    (flat if painted else object_)[40:40 + size, 40:40 + size] = 0 if painted else 1
    anchor = np.zeros((96, 96, 16), np.float32)  # where nothing is hidden, and noise is somewhere
    anchor[..., :2], anchor[..., 6] = np.indices((96, 96)).T, 1
    one = np.ones_like(flat)
    layers = dict(combined=np.ones((96, 96, 4), np.float32), color=flat, diffuse=one, normal=one,
                  depth=5 * one[..., :1], object=object_, anchor=anchor)
    pen = dict(PEN, line_thickness=2.0, pen_1_overshoot=12.0, line_color_strength=float(painted), **more)
    t = library.render(layers, pen, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]
    rows = np.flatnonzero(t.max(1) > 0.1)
    return max(40 - rows[0], rows[-1] - 39 - size)


def test_what_is_tiny_does_not_bristle():
    """A stroke goes on beyond a corner by a share of its own length: round a nail the line is four of them."""
    for size in (8, 14, 20):
        assert reach_of_overshoot(size) <= 0.2 * size + 2, size
    assert reach_of_overshoot(50) > 6


def test_lines_between_colours_bristle_less_if_asked():
    assert reach_of_overshoot(50, True) > 6
    assert reach_of_overshoot(50, True, pen_1_overshoot_color=0.0) < 2
    assert reach_of_overshoot(50, pen_1_overshoot_color=0.0) > 6
