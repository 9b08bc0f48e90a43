# SPDX-License-Identifier: GPL-3.0-or-later
"""Light in the dark: what hardly any light reaches is no negative of white lines, where it is light and turns to the
upper left."""

import numpy as np
import pytest
from encre.pen import library, presets
from toned import ALONE, LEVELS, MORE_LEVELS, stuck, twins

SIZE = 120
SOLID = dict(ALONE, tone_1="SOLID", tone_2="NONE", tone_3="NONE", tone_black=0.03, tone_dark=0.088,
             tone_black_by="LUMINANCE", tone_open=1.0, shade_levels=[(0.0,), (1, 0.5, 0.0)])
SKIN, CLOTH, COAT = (0.7, 0.45, 0.33), (0.12, 0.12, 0.1), (0.01, 0.01, 0.02)


def ball(light, color=SKIN, width=SIZE, ground=0.0):
    """Layers of a ball in such light, a number or (height, width), before a floor that faces up and has none."""
    y, x = (np.mgrid[:SIZE, :width] + 0.5 - np.array((SIZE, width))[:, None, None] / 2) / (0.4 * SIZE)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    normal = np.where(inside[..., None], np.stack([x, -y, z], -1), (0, 0.98, 0.2))
    color = np.where(inside[..., None], color, 0.5)
    diffuse = np.where(inside, light, ground)[..., None] + np.zeros(3)
    layers = dict(combined=np.concatenate([color * diffuse, np.ones((*x.shape, 1))], 2), color=color, diffuse=diffuse,
                  depth=np.where(inside, 5, 6)[..., None], normal=normal, object=np.where(inside, 1, 2)[..., None])
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, inside


def ink(layers, scene=SOLID, **more):
    return library.render(layers, scene | more, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]


def of_ball(light, color=SKIN, **more):
    layers, inside = ball(light, color)
    return ink(layers, **more)[inside].mean()


@pytest.mark.parametrize("seed", range(6))
def test_twin(seed):
    """Of dots and ink, with things, without, and with styles of their own."""
    rng = np.random.default_rng(seed)
    layers = stuck(90, 60, seed)
    layers["diffuse"] *= np.float32(rng.choice([0.1, 0.4, 1]))
    if seed % 3 == 2:
        del layers["object"]
    scene = dict(ALONE, shade_levels=[[(0.0,), (1.0, 0.4, 0.0)], LEVELS, MORE_LEVELS][seed % 3], tone_1="SOLID",
                 tone_2="LINES", tone_3="NONE", tone_black=0.1, tone_dark=0.3, tone_reds=1.0, tone_open=1.5,
                 tone_black_by=str(rng.choice(["VALUE", "LUMINANCE"])), tone_black_widest=float(rng.choice([0, 40])))
    styles = [dict(tone_open=0.0), dict(tone_open=3.0, tone_black=0.0), dict(use_tones=False)]
    # of numbers on either side of a step rounding tells
    twins(layers, scene, styles, few=4e-3, wrong=4e-3)


@pytest.mark.parametrize("preset", ["Heavy blacks", "Superhero", "Manga"])
def test_a_face_in_the_dark_is_left_open(preset):
    """It was solid ink. Its lower right is, and so are a black coat, and the ground, which turns to neither."""
    values = presets.find(preset).values | dict(use_lines=False, length_unit="PIXELS", tone_detail=0.0, tone_least=0.0,
                                                shade_meter="SCENE", use_specks=False)
    layers, inside = ball(0.02)
    face = ink(layers, values)
    y, x = np.mgrid[:SIZE, :SIZE]
    near = (np.abs(y - SIZE / 2 + 12) < 6) & (np.abs(x - SIZE / 2 + 20) < 6)
    far = (np.abs(y - SIZE / 2 - 27) < 5) & (np.abs(x - SIZE / 2 - 27) < 5)
    assert (ink(layers, values, tone_open=0.0) == 1).all()
    assert face[near].mean() < 0.8 and (face[far] == 1).all() and (face[~inside] == 1).all()
    assert (ink(ball(0.02, COAT)[0], values) == 1).all()


def test_the_lighter_a_color_the_more_of_it_is_left_open():
    shares = [of_ball(0.02, color) for color in ((0.9, 0.9, 0.9), SKIN, CLOTH, COAT)]
    assert 0.05 < shares[0] < shares[1] < 0.6 < shares[2] < shares[3] == 1


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0])
def test_what_has_light_keeps_its_shade(turn):
    """Half of a ball in the light tells its shape: nothing of its shade is taken away."""
    y, x = np.mgrid[:SIZE, :SIZE] - SIZE / 2
    layers, _ = ball(np.where(x * np.cos(turn) + y * np.sin(turn) > 0, 1.0, 0.02))
    assert np.array_equal(ink(layers), ink(layers, tone_open=0.0))


def test_a_face_in_a_hood_that_is_lit_is_left_open():
    """Of one thing, shade by shade of its colors: the hood has light, the face has none."""
    layers, inside = ball(1.0, CLOTH)
    y, x = np.mgrid[:SIZE, :SIZE] - SIZE / 2
    face = np.hypot(x, y) < 20
    layers["color"][face], layers["diffuse"][face] = SKIN, 0.02
    assert ink(layers)[face].mean() < 0.3 and (ink(layers, tone_open=0.0)[face] == 1).all()


def test_a_deep_red_is_no_lighter_in_the_dark_than_in_the_light():
    wine = (0.12, 0.012, 0.012)
    assert of_ball(1.0, wine, tone_reds=3.0) == of_ball(0.02, wine, tone_reds=3.0) == 1


def test_as_light_comes_over_a_thing_its_ink_changes_by_and_by():
    """A shadow that leaves a ball by half a pixel a frame, up and down its face: nothing turns at once."""
    y, _ = np.mgrid[:SIZE, :SIZE] - SIZE / 2
    got = [of_ball(np.where(y > edge, 0.02, 1.0)) for edge in np.arange(-50, 50, 0.5)]
    assert np.abs(np.diff(got)).max() < 0.06 and got[0] > 0.15 and got[-1] == 0


def test_a_border_that_cuts_no_thing_changes_nothing():
    whole, _ = ball(0.02, width=160)
    part = {name: np.ascontiguousarray(a[:, 20:-20]) for name, a in whole.items()}
    assert np.array_equal(ink(whole)[:, 20:-20], ink(part))


def test_any_number_of_threads_draws_the_same():
    layers = stuck(90, 60)
    layers["diffuse"] *= np.float32(0.2)
    one, many = (library.render(layers, SOLID, threads=n, outputs=["Encre Tones"]).images["Encre Tones"].tobytes()
                 for n in (1, 5))
    assert one == many
