# SPDX-License-Identifier: GPL-3.0-or-later
"""Slits between two things, as of boards, or parts of one: one line of one width where they are narrow, two where they
are not."""

import chained
import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import EDGES, Camera, Chains, Frame, Mesh, edge_kinds
from known import line
from views import pixels

SIZE, HIGH = (64, 150), 720
FACES = np.array([(0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)])


def board(left, right, slope, number, turn=0.0):
    """Upright, of so much of the picture, leaning; turned away to one side, where it is as wide in the picture."""
    points = [(x + slope * y, y, z - np.tan(turn) * (x - 30)) for z in (-60, -80) for x, y in (
        (left, -40), (right, -40), (right, 190), (left, 190))]
    corners = np.concatenate([FACES[:, [0, 1, 2]], FACES[:, [0, 2, 3]]]).astype(np.int32)
    kinds = edge_kinds(np.full((len(corners), 3), EDGES["flat"]))
    return Mesh(np.array(points, np.float32), corners, edges=kinds, object_index=number)


def wall(number):
    return Mesh(np.array([(-90, -90, -99), (190, -90, -99), (190, 190, -99), (-90, 190, -99)], np.float32),
                np.array([(0, 1, 2), (0, 2, 3)], np.int32), object_index=number)


def layers_of(*boards, slope):
    return layers_with([*(board(*sides, slope, k + 1) for k, sides in enumerate(boards)), wall(9)])


def layers_with(meshes):
    return chained.layers(meshes, *pixels(1280, HIGH), Frame(1280, HIGH), SIZE)


SCENE = dict(edge_detector="FINE", line_thickness=3.0, pen_1_softness=0.0, pen_1_grain=0.0, pen_1_steepness=0.5,
             pen_1_intensity=2.0)


def drawn(*boards, slope):
    return lines_of(layers_of(*boards, slope=slope))


def lines_of(layers):
    out = library.render(layers, {**SCENE, "length_unit": "PIXELS"}, frame=Frame(1280, HIGH),
                         camera=Camera(orthographic=True, height=float(HIGH)), outputs=("Encre Lines",))
    return out.images["Encre Lines"][8:-8, 4:-4, 3]


@pytest.mark.parametrize("slope", [0.004, 0.02, -0.013, 0.06])
def test_a_narrow_slit_is_one_line_as_wide_everywhere(slope):
    """Whether rows see what is behind it or not."""
    for gap in (0.2, 0.5, 0.8, 1.2):
        rows = drawn((-80, 30.3), (30.3 + gap, 140), slope=slope).sum(1)
        assert np.ptp(rows) < 0.1 and np.abs(rows - 3).max() < 0.55, (gap, rows.min(), rows.max())


def test_a_wide_one_has_two_and_what_comes_between_is_between():
    narrow, half, wide = (drawn((-80, 30.3), (30.3 + gap, 140), slope=0.02).sum(1).mean() for gap in (1, 2.1, 3.5))
    assert narrow < 3.1 < 3.6 < half < 5.2 < 5.8 < wide


def lines_of_shadow(width, slope, tapers=0.0):
    """By column, how much ink there is of a nearly level shadow that is so many pixels high, by a few noisy samples."""
    y, x = np.mgrid[:40, :160].astype(float)
    off = np.add.outer(np.arange(64) / 64 - 0.5, y - 20 - slope * (x - 80))
    dark = (2 * np.abs(off) < width + tapers * (x / 160 - 0.5)).mean(0)
    dark += 0.03 * np.random.default_rng(1).standard_normal(dark.shape) * ((dark > 0) & (dark < 1))
    grey, light = np.full((40, 160, 3), 0.5, np.float32), np.float32(np.repeat((1 - 0.8 * dark)[..., None], 3, 2))
    layers = dict(combined=np.dstack([grey, np.ones((40, 160), np.float32)]), color=grey, diffuse=light,
                  depth=np.full((40, 160), 5, np.float32), normal=np.tile(np.float32((0, 0, 1)), (40, 160, 1)))
    settings = {**SCENE, "line_thickness": 1.0, "length_unit": "PIXELS", "line_shadow_strength": 4.0,
                "line_shadow_width": 1.0}
    out = library.render(layers, settings, frame=Frame(160, 40), camera=Camera(orthographic=True, height=5.0),
                         outputs=("Encre Lines",))
    return out.images["Encre Lines"][:, 8:-8, 3].sum(0)


@pytest.mark.parametrize("slope", [0.02, 0.05])
def test_a_narrow_shadow_is_one_line_or_two_from_end_to_end(slope):
    for width in (1.8, 2.0, 2.1):
        assert np.abs(lines_of_shadow(width, slope) - 1).max() < 0.3
    for width in (2.3, 2.8):
        assert np.abs(lines_of_shadow(width, slope) - 2).max() < 0.4
    two = lines_of_shadow(2.1, slope, tapers=0.8) > 1.5
    assert (two[1:] != two[:-1]).sum() == 1


def light_beside(apart, fold):
    """How much ink a row has of light that steps so many px beside a contour, behind which the same thing goes on or
    another one."""
    grey, side = np.full((60, 80, 3), 0.5, np.float32), np.arange(80) < 40
    light = np.clip(np.arange(80) - 40 - apart + 0.5, 0.2, 1)
    contour = line([(39.5, -40), (39.5, 100)], "contour", side=1, depth=4, behind=1 if fold else 2)
    layers = dict(combined=np.dstack([grey, np.ones((60, 80), np.float32)]), color=grey,
                  chains=Chains(contour, np.ones(3, np.uint8)), normal=np.tile(np.float32((0, 0, 1)), (60, 80, 1)))
    for name, row in (("diffuse", np.repeat(light[:, None], 3, 1)), ("depth", np.where(side, 4, 5)[:, None]),
                      ("object", np.where(side | fold, 1, 2)[:, None])):
        layers[name] = np.tile(row, (60, 1, 1)).astype(np.float32)
    settings = {**SCENE, "line_thickness": 2.0, "line_shadow_strength": 4.0, "line_shadow_width": 1.0}
    out = library.render(layers, settings, frame=Frame(1920, 1080), outputs=("Encre Lines",))
    return out.images["Encre Lines"][20:40, 42:70, 3].sum(1).mean()


def test_light_that_steps_beside_a_fold_is_no_second_one():
    assert light_beside(2.0, fold=True) < 0.02
    assert light_beside(9.0, fold=True) == pytest.approx(2, abs=0.3)
    assert light_beside(3.0, fold=False) == pytest.approx(2, abs=0.3)
