# SPDX-License-Identifier: GPL-3.0-or-later
"""Small blacks that are spotted in pure line work, against tests/reference/blacks.py."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame
from toned import ALONE, crowded, shaded, twins, whole

LINES = dict(ALONE, shade_levels=[(0.5,), (1.0, 0.45, 0.0)], tone_1="SOLID", tone_2="NONE",
             tone_3="NONE", tone_4="NONE", tone_black=0.05, tone_black_by="LUMINANCE", tone_black_widest=12.0)


@pytest.mark.parametrize("seed", range(5))
def test_twin(seed):
    scene = dict(LINES, tone_black=(0.05, 0.02, 0.2, 0.05, 0.05)[seed],
                 tone_black_widest=(9.0, 14.0, 6.5, 20.0, 4.0)[seed])
    styles = [dict(tone_black=0.2, tone_black_by="VALUE", tone_1="DOTS" if seed == 3 else "SOLID",
                   tone_darkness=-0.3),
              dict(use_tones=False)]
    if seed == 4:
        scene |= dict(tone_detail=5.0, tone_least=1.5, tone_2="DOTS")
    layers = crowded(seed)
    twins(layers, scene, styles[:1 + seed % 2], Frame(200, 160, 31, 20), few=3e-3, wrong=3e-3)
    drawn = [library.render(layers, dict(scene, tone_black_widest=wide), styles[:1 + seed % 2],
                            frame=Frame(200, 160, 31, 20), outputs=("Encre Tones",)).images["Encre Tones"][..., 3]
             for wide in (scene["tone_black_widest"], 0.0)]
    assert (drawn[0] > 0.5).mean() > 0.005 and np.abs(drawn[0] - drawn[1]).max() == 1


def ink(layers, **scene):
    return library.render(whole(layers), dict(LINES, **scene), outputs=("Encre Tones",)).images["Encre Tones"][..., 3]


def disc(y, x, radius, size=100):
    rows, columns = np.mgrid[:size, :size]
    return np.hypot(rows - y, columns - x) <= radius


def test_pupils_brows_and_letters_are_black_and_coats_are_not():
    layers = shaded(100, 100)
    eye, pupil, coat = disc(30, 30, 12), disc(30, 30, 5), np.s_[60:95, 20:80]
    brow = np.s_[8:13, 10:50]
    layers["color"][eye], layers["color"][pupil], layers["color"][brow], layers["color"][coat] = 0.1, 0.01, 0.03, 0.01
    drawn = ink(layers)
    assert drawn[pupil].all() and drawn[brow].all()
    assert not drawn[eye & ~pupil].any() and not drawn[coat].any() and not drawn[~eye][200:400].any()
    assert ink(layers, tone_black_widest=0.0)[coat].all()


def test_in_a_brown_iris_that_is_too_wide_the_pupil_is_black():
    layers = shaded(100, 100)
    eye, pupil = disc(50, 50, 14), disc(50, 50, 5)
    layers["color"][eye], layers["color"][pupil] = 0.03, 0.002
    drawn = ink(layers)
    assert drawn[pupil].all() and not drawn[eye & ~pupil].any()


def test_dark_skin_is_no_small_black():
    """As dark as the eye has it as the gray beside it, which is one."""
    layers = shaded(100, 100)
    face, patch = disc(30, 30, 5), disc(70, 70, 5)
    layers["color"][face], layers["color"][patch] = (0.09, 0.04, 0.025), 0.0486
    drawn = ink(layers)
    assert drawn[patch].all() and not drawn[face].any()


def test_light_does_not_matter_but_highlights_stay():
    layers = shaded(100, 100, light=0.0)
    eye = disc(50, 50, 5)
    layers["color"][eye] = 0.01
    assert (ink(layers) == eye).all()  # the dark is no black
    layers = whole(layers)
    layers["combined"][48:50, 48:50, :3] = 1
    drawn = library.render(layers, LINES, outputs=("Encre Tones",)).images["Encre Tones"][..., 3]
    assert not drawn[48:50, 48:50].any() and drawn[eye].sum() == eye.sum() - 4


def test_a_black_wall_behind_rails_is_no_row_of_spots():
    layers = shaded(100, 100)
    layers["color"][:44], layers["depth"][:] = 0.01, 6.0
    for x in range(0, 100, 10):
        layers["color"][:, x:x + 4], layers["depth"][:, x:x + 4] = 0.8, 5.0
    assert not ink(layers).any()
    layers["depth"][:] = 5.0  # painted on the wall it is
    assert ink(layers).any()


def test_dark_things_among_dark_ones_stay_open():
    layers = shaded(100, 100, color=0.1)
    layers["color"][disc(50, 50, 5)] = 0.01
    assert not ink(layers).any()


def test_nothing_turns_white_at_once_as_it_grows():
    shares = []
    for radius in np.arange(4.0, 9.0, 0.05):
        layers = shaded(100, 100)
        own = disc(50, 50, radius)
        layers["color"][own] = 0.01
        shares.append(ink(layers)[own].mean())
    assert shares[0] == 1 and shares[-1] == 0
    assert max(before - after for before, after in zip(shares, shares[1:], strict=False)) < 0.75
    assert sum(0 < share < 1 for share in shares) >= 2


def test_what_the_frame_cuts_off_is_not_taken_for_small():
    layers = shaded(100, 100)
    layers["color"][disc(50, 0, 5)] = layers["color"][disc(50, 50, 5)] = 0.01
    drawn = ink(layers)
    assert drawn[disc(50, 50, 5)].all() and not drawn[:, :10].any()


def test_levels_of_light_begin_with_the_second_tone():
    layers = shaded(100, 100, light=0.2)
    eye = disc(50, 50, 5)
    layers["color"][eye] = 0.01
    assert (ink(layers, tone_2="SOLID", tone_1="NONE") == ~eye).all()
    assert ink(layers, tone_2="SOLID").all() and not ink(layers, tone_3="SOLID")[~eye].any()


def test_a_long_black_is_no_brow():
    """A skirting along a wall stays open, and none appears at once."""
    drawn = []
    for length in (44, 48, 50, 52, 60):
        layers = shaded(100, 100)
        layers["color"][40:46, 20:20 + length] = 0.01
        drawn.append(ink(layers)[40:46, 20:20 + length].mean())
    assert drawn[:2] == [1, 1] and 0 < drawn[2] <= 1 and drawn[4] == 0
