# SPDX-License-Identifier: GPL-3.0-or-later
"""Crumbs: small islands of ink in light, and of light in ink, become what is around them, but for features."""

import numpy as np
import pytest
from encre.pen import library, presets
from encre.pen.job import Frame
from toned import ALONE, LEVELS, MORE_LEVELS, stuck, twins

SOLID = dict(ALONE, tone_1="SOLID", tone_2="NONE", tone_3="NONE", tone_black=0.03, tone_black_by="LUMINANCE",
             tone_crumbs=4.0, shade_levels=[(0.0,), (1, 0.5, 0.0)])
LOOKS = ["Heavy blacks", "Superhero", "Manga", "Hatched", "Stippled"]


def page(light=1.0, color=0.08, size=(40, 60)):
    """A wall of one color in one light."""
    one = np.ones((*size, 1), np.float32)
    return dict(combined=np.concatenate([one.repeat(3, 2) * light * color, one], 2), color=one.repeat(3, 2) * color,
                diffuse=one.repeat(3, 2) * light, depth=5 * one, normal=one * (0, 0, 1), object=one)


def put(layers, rows, columns, light=None, color=None, depth=None):
    if light is not None:
        layers["diffuse"][rows, columns] = light
    if color is not None:
        layers["color"][rows, columns] = color
    if depth is not None:
        layers["depth"][rows, columns] = depth
    layers["combined"][..., :3] = layers["color"] * layers["diffuse"]
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def ink(layers, scene=SOLID, **more):
    frame = more.pop("frame", None)
    return library.render(layers, scene | more, frame=frame, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]


A = slice(10, 14), slice(20, 24)  # as large as a crumb may be


@pytest.mark.parametrize("seed", range(6))
def test_twin(seed):
    """Of noise: ink and dots, with styles of their own, and where only small blacks are spotted."""
    rng = np.random.default_rng(seed)
    layers = stuck(90, 60, seed)
    layers["color"] = np.float32(rng.choice([0.02, 0.06, 0.3], layers["depth"].shape[:2], p=[.5, .4, .1])[..., None]
                                 * np.ones(3))
    layers["diffuse"] *= np.float32(rng.choice([0.3, 0.7, 1]))
    scene = dict(ALONE, shade_levels=[[(0.0,), (1.0, 0.4, 0.0)], LEVELS, MORE_LEVELS][seed % 3], tone_1="SOLID",
                 tone_2="LINES", tone_3="NONE", tone_black=0.03, tone_dark=0.1, tone_open=float(seed % 2),
                 tone_crumbs=float(rng.choice([1, 2, 5])), tone_black_widest=float(rng.choice([0, 40])))
    styles = [dict(tone_1="DOTS"), dict(tone_black=0.0), dict(use_tones=False)]
    twins(layers, scene, styles, few=4e-3, wrong=4e-3)


@pytest.mark.parametrize("light, spot", [(1.0, 0.1), (0.1, 1.0)])
def test_crumbs_of_shade_and_of_light_go_and_what_is_larger_stays(light, spot):
    plain, layers = ink(page(light)), put(page(light), *A, light=spot)
    assert np.array_equal(ink(layers), plain) and not np.array_equal(ink(layers, tone_crumbs=0.0), plain)
    assert not np.array_equal(ink(layers, tone_crumbs=3.9), plain)
    assert not np.array_equal(ink(put(layers, slice(14, 15), slice(24, 25), light=spot)), plain), "by corners"


@pytest.mark.parametrize("ground, spot, stays", [(0.06, 0.02, False), (0.1, 0.005, True), (0.5, 0.02, True)])
def test_patches_of_camouflage_go_and_pupils_of_dark_and_light_faces_stay(ground, spot, stays):
    got = ink(put(page(1.0, ground), *A, color=spot))
    assert got[A].all() == stays and not got[:9].any()


def test_a_red_spot_on_yellow_stays():
    layers = page()
    layers["color"][:] = 0.75, 0.35, 0.02
    assert ink(put(layers, *A, color=(0.56, 0.05, 0.03)), tone_dark=0.5, tone_reds=2.0, tone_black=0.1,
               shade_levels=[(0.0,), (1, 0.95, 0.0)])[A].any()


@pytest.mark.parametrize("depth, stays", [(5.0, True), (4.99, True), (5.02, False)])
def test_a_mark_on_black_stays_and_what_is_seen_between_it_goes(depth, stays):
    got = ink(put(page(1.0, 0.01), *A, color=0.5, depth=depth))
    assert (not got[A].any()) == stays


def test_a_fold_stays_however_thin():
    assert ink(put(page(), slice(20, 21), slice(10, 26), light=0.1), tone_crumbs=4.0)[20, 12:24].max() < 0.6
    assert ink(put(page(), slice(20, 21), slice(10, 27), light=0.1), tone_crumbs=5.0)[20, 12:24].max() < 0.6
    assert ink(put(page(), slice(20, 22), slice(10, 27), light=0.1), tone_crumbs=4.0)[20:22, 12:24].all()


def test_stars_stay():
    layers = put(page(0.01), *A, light=1.0)
    layers["depth"][A] = 0
    assert not ink(layers)[A].any()


def test_ink_within_a_crumb_of_light_goes_with_it():
    layers = put(put(page(0.1), *A, light=1.0), slice(11, 12), slice(21, 22), light=0.1)
    assert ink(layers).all()


def test_dusk_between_blacks_is_no_gray_speck():
    """The edge of a step goes over a pixel where there is one: between two blacks it was told by how black they are."""
    layers = put(page(0.45, 0.08), slice(None), slice(None, None, 2), color=0.01)
    assert (ink(layers, tone_crumbs=0.0) == 1).all()


def test_at_a_rim_beyond_which_the_frame_goes_on_they_stay():
    for rows, columns in ((slice(0, 2), A[1]), (slice(38, 40), A[1]), (A[0], slice(0, 2)), (A[0], slice(58, 60))):
        layers = put(page(), rows, columns, light=0.1)
        assert not ink(layers).any()
        assert ink(layers, frame=Frame(width=62, height=42, x=1, y=1))[rows, columns].any()


@pytest.mark.parametrize("preset", LOOKS)
def test_looks_with_solid_blacks_have_no_crumbs(preset):
    values = presets.find(preset).values | dict(use_lines=False, length_unit="PIXELS", tone_detail=0.0, tone_least=0.0,
                                                shade_meter="SCENE", use_specks=False, tone_open=0.0)
    plain, layers = page(0.02, 0.3), put(page(0.02, 0.3), *A, light=1.0)
    assert np.array_equal(ink(layers, values), ink(plain, values))
    assert not np.array_equal(ink(layers, values, tone_crumbs=0.0), ink(plain, values))


def test_any_number_of_threads_draws_the_same():
    layers = stuck(90, 60)
    layers["diffuse"] *= np.float32(0.4)
    one, many = (library.render(layers, SOLID, threads=n, outputs=["Encre Tones"]).images["Encre Tones"].tobytes()
                 for n in (1, 5))
    assert one == many
