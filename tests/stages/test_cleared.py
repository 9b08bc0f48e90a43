# SPDX-License-Identifier: GPL-3.0-or-later
"""What tones leave clear of fine things, and screens that have no room, against tests/reference/cleared.py."""

import time

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame
from toned import ALONE, crowded, shaded, twins, whole

BLACK = dict(ALONE, shade_levels=[(0.0,), (0.65, 0.25, 0.0), (1.0, 0.55, 0.0)], tone_1="SOLID", tone_2="DOTS",
             tone_2_pitch=6.0, tone_2_space="SCREEN", tone_3="NONE")


@pytest.mark.parametrize("seed", range(5))
def test_twin(seed):
    scene = dict(BLACK, tone_detail=(0.0, 5.0, 9.0, 7.0, 0.0)[seed], tone_least=(1.5, 0.0, 1.2, 2.5, 9.0)[seed])
    style = dict(tone_2="LINES", tone_2_pitch=4.0, tone_1="STIPPLE" if seed == 3 else "SOLID",
                 tone_reds=9.0 * (seed == 2))
    got = twins(crowded(seed), scene, [style], Frame(200, 160, 31, 20), few=3e-3, wrong=3e-3)
    plain = library.render(crowded(seed), dict(scene, tone_detail=0.0, tone_least=0.0), [style],
                           frame=Frame(200, 160, 31, 20), outputs=("Encre Tones",)).images
    assert (np.abs(got["Encre Tones"] - plain["Encre Tones"]).max(-1) > 0.5).mean() > 0.003


def ink(layers, **scene):
    return library.render(whole(layers), dict(BLACK, **scene), outputs=("Encre Tones",)).images["Encre Tones"][..., 3]


def test_letters_are_read_in_black():
    light, dark = shaded(60, 60, 0.1, 0.02), shaded(60, 60, 0.1, 0.8)
    for layers, color in ((light, 0.8), (dark, 0.02)):
        layers["color"][20:40, 20:23] = layers["color"][36:39, 20:34] = color
    assert (ink(light) == 1).all() and (ink(dark) == 1).all()
    light, dark = ink(light, tone_detail=5.0), ink(dark, tone_detail=5.0)
    assert (light[22:36, 20:23] == 0).all() and (light[36:39, 20:30] == 0).all() and light[22:36, 24:].all()
    assert (dark[20:40, 20:23] == 1).all() and (dark[22:34, [19, 23]] < 0.6).all() and dark[:, 30:].any()


def test_a_word_is_all_one_way():
    """Strokes of 4 pixels are fine and such of 7 nearly: beside one that is, but not alone, nor such of 12."""
    layers = shaded(60, 160, 0.1, 0.02)
    for x, wide in ((20, 7), (32, 4), (42, 6), (55, 7), (100, 7), (130, 12)):
        layers["color"][20:40, x:x + wide] = 0.8
    drawn = ink(layers, tone_detail=5.0)
    assert not any(drawn[22:38, x:x + wide].any() for x, wide in ((20, 7), (32, 4), (42, 6), (55, 7)))
    assert drawn[:, 70:].all()


def word(stroke, shift, height=90, width=200, fine=8):
    """How far letters of uneven strokes cover pixels."""
    covered, x = np.zeros((height * fine, width * fine)), (20 + shift) * fine
    for wide in (1, 1.15, 0.9, 1.25):
        left, right = (round(x + k * stroke * fine) for k in (wide, 3))
        covered[20 * fine:round(20 + 6 * stroke) * fine, round(x):left] = 1
        covered[20 * fine:round((20 + 0.8 * stroke) * fine), round(x):right] = 1
        x += 4.2 * stroke * fine
    return covered.reshape(height, fine, width, fine).mean((1, 3))


def test_a_word_that_grows_is_filled_by_and_by_and_as_a_whole():
    clear = []
    for stroke in np.arange(3, 9, 0.25):
        letters = [word(stroke, shift) for shift in (0, 0.3, 0.7)]
        own = []
        for drawn in letters:
            layers = shaded(*drawn.shape, 0.1, 1)
            layers["color"] *= 0.02 + 0.78 * drawn[..., None]
            own.append(1 - ink(layers, tone_detail=5.5)[drawn > 0.95].mean())
        clear.append(own)
    means = np.mean(clear, 1)
    assert means[0] == 1 and means[-1] == 0 and np.ptp(clear, 1).max() < 0.15, clear
    assert (np.diff(means) < 0.02).all() and np.diff(means).min() > -0.35, means


def test_a_sliver_of_a_band_does_not_clear_the_cloth():
    """A fold cuts a narrow piece off a band that is a little too wide to be fine: the hem below keeps its dots."""
    drawn = []
    for cut in (False, True):
        layers = shaded(60, 160)
        layers["object"] = np.zeros((60, 160, 1))
        layers["object"][39:46] = 1
        layers["color"][31:39] = 0.1
        if cut:
            layers["color"][31:39, [40, 44]] = 0.8
        drawn.append(ink(layers, tone_detail=5.0)[39:46, 60:])
    assert drawn[0].mean() > 0.2 and (drawn[0] == drawn[1]).all()


def test_a_dark_ground_is_not_cleared_of_ink():
    """A book with light marks: no dark thing lies on what is dark itself, though its soft rims are light."""
    layers = shaded(60, 60, 0.1, 0.8)
    layers["color"][20:24, 20:44] = 0.03
    for k in range(8):
        layers["color"][20 - k, 20:44] = (0.17 + 0.07 * k) ** 2
    for x in (24, 30, 36):
        layers["color"][12:16, x:x + 3] = 0.02
    assert ink(layers, tone_detail=5.0)[20:24, 20:44].all()


def test_between_dark_letters_it_is_as_around_them():
    layers = shaded(60, 100, 0.1, 0.8)
    for x in (30, 41):
        layers["color"][20:40, x:x + 4] = 0.02
    drawn = ink(layers, tone_detail=5.0)[22:38]
    assert (drawn[:, [29, 34, 40, 45]] < 0.1).all() and drawn[:, 36:39].all() and drawn[:, :27].all()


def test_small_faces_and_pages_have_neither_dots_nor_ink():
    layers = shaded(90, 150, 0.4, 0.8)
    face, page = np.s_[30:54, 20:44], np.s_[20:70, 90:130]
    layers["color"][:] = 0.35
    layers["color"][face] = layers["color"][page] = 0.8
    for x in (26, 35):
        layers["color"][38:42, x:x + 3] = layers["color"][20:24, x + 30:x + 33] = 0.02
    for x in range(93, 127, 6):
        layers["color"][24:66, x:x + 2] = 0.02
    dots = ink(layers, tone_detail=5.0, tone_black=0.05)
    light = layers["color"][..., 0] > 0.5
    assert not dots[face][light[face]].any() and dots[38:42, 26:29].all() and dots[20:24, 56:59].all()
    assert dots[5:15, 50:80].mean() > 0.2 and not dots[page][light[page]].any()
    layers["diffuse"][:] = 0.1
    black = ink(layers, tone_detail=5.0)
    assert not black[page][light[page]].any() and not black[face][light[face]].any() and black[60:, 45:88].all()


def test_a_thin_shadow_does_not_underline_letters():
    layers = shaded(60, 160, 0.9)
    layers["diffuse"][20:22] = layers["diffuse"][22:26, 52:] = 0.4
    for x in range(60, 100, 8):
        layers["color"][12:24, x:x + 3] = 0.02
    drawn = ink(layers, tone_detail=5.0, tone_least=1.5)
    assert drawn[20:22, 10:40].all() and not drawn[24:30, 60:96].any()


@pytest.mark.parametrize("kind", ["STIPPLE", "HATCH"])
def test_dark_letters_are_ink_among_spots_and_strokes(kind):
    layers = shaded(60, 60, 0.2, 0.8)
    layers["color"][20:40, 20:23] = layers["color"][20:40, 40:58] = 0.02
    marks = dict(tone_1=kind, tone_black=0.05, shade_levels=[(0.3,), (0.65, 0.25, 0.0)])
    plain, drawn = ink(layers, **marks), ink(layers, tone_detail=5.0, **marks)
    assert drawn[20:40, 20:23].all() and plain[20:40, 20:23].mean() < 0.98 and drawn[20:40, 40:58].mean() < 0.98


@pytest.mark.parametrize("kind", ["STIPPLE", "HATCH"])
def test_about_light_letters_all_is_ink_and_holes_of_dark_ones_are_no_ground(kind):
    chalk, printed = shaded(60, 60, 0.2, 0.02), shaded(60, 60, 0.2, 0.8)
    for layers, color, hole in ((chalk, 0.8, 0.02), (printed, 0.02, 0.8)):
        layers["color"][20:50, 20:29], layers["color"][23:47, 23:26] = color, hole
    marks = dict(tone_1=kind, tone_black=0.05, shade_levels=[(0.3,), (0.65, 0.25, 0.0)], tone_detail=5.0)
    chalk, printed = ink(chalk, **marks), ink(printed, **marks)
    assert chalk[23:47, 23:26].all() and chalk[20:50, [16, 17, 18, 31, 32]].all() and chalk[:, 40:].mean() < 0.98
    assert not chalk[24:46, 20:22].any()
    assert printed[20:50, 20:23].all() and printed[20:23, 20:29].all()


@pytest.mark.parametrize("kind", ["STIPPLE", "HATCH"])
@pytest.mark.parametrize("darkness, ground, inked", [(0.8, 0.15, True), (0.6, 0.15, False), (0.3, 0.05, True)])
def test_about_light_letters_all_is_ink_only_where_strokes_cross_thrice_or_on_boards(kind, darkness, ground, inked):
    layers = shaded(60, 60, 0.2, ground)
    layers["color"][10:50, 28:31] = 0.8
    drawn = ink(layers, tone_1=kind, tone_detail=5.0, shade_levels=[(1 - darkness,), (0.65, 0.25, 0.0)])
    assert drawn[14:46, [26, 27, 31, 32]].all() == inked and not drawn[14:46, 29].any()


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "CROSS"])
@pytest.mark.parametrize("curved", [False, True])
def test_what_letters_of_a_board_lie_on_is_ink_in_a_screen_too(kind, curved):
    """A board in dots, into which the letters throw shadows that are ink, would leave nobody to read them."""
    layers = shaded(60, 100, 0.5, 0.08)
    for x in range(20, 80, 10):
        layers["color"][20:40, x:x + 3] = layers["color"][37:40, x:x + 7] = 0.8
    y, x = np.mgrid[:60, :100]
    layers["normal"] = np.stack([curved * (x % 10 / 3 - 1), curved * (y / 10 - 3), 0 * x + 0.5], -1)
    drawn = ink(layers, tone_1=kind, tone_2=kind, tone_2_pitch=6.0, tone_detail=5.0)
    about = drawn[21:36, [19, 23, 29, 33, 49, 53]]
    assert about.mean() < 0.6 if curved else about.all()
    assert not drawn[22:36, [21, 41, 61]].any() and 0.1 < drawn[:12].mean() < 0.9


@pytest.mark.parametrize("paint, inked", [((0.6, 0.02, 0.02), True), ((0.05, 0.15, 0.6), True),
                                          ((0.3, 0.15, 0.1), False), ((0.15, 0.15, 0.15), False)])
def test_red_and_blue_signs_are_boards_and_faces_are_not(paint, inked):
    layers = shaded(60, 60, 0.4)
    layers["color"][:] = paint
    layers["color"][10:50, 28:31] = 0.9
    for kind in "DOTS", "HATCH", "STIPPLE":
        about, plain = (ink(layers, tone_1=kind, tone_2=kind, tone_2_pitch=6.0, tone_detail=5.0, tone_reds=reds)
                        [14:46, [26, 27, 31, 32]] for reds in (4.0, 0.0))
        assert about.all() == inked and plain.mean() < 0.9


def test_the_white_of_an_eye_in_a_dark_face_has_no_ink_about_it():
    layers = shaded(60, 60, 0.2, 0.08)
    layers["color"][27:32, 22:36] = 0.8
    layers["color"][27:32, 26:31] = 0.01
    drawn = ink(layers, tone_1="STIPPLE", tone_detail=11.0, shade_levels=[(0.7,), (0.65, 0.25, 0.0)])
    assert drawn[20:40, [20, 21, 36, 37]].mean() < 0.7 and not drawn[28:31, [23, 34]].any()


@pytest.mark.parametrize("kind", ["STIPPLE", "HATCH"])
def test_plain_round_eyes_are_no_print_and_letters_as_large_are(kind):
    layers = shaded(60, 120, 0.2, 0.05)
    for x in (20, 36):
        layers["color"][24:34, x + 1:x + 7] = layers["color"][26:32, x:x + 8] = 0.8
    for x in (80, 88):
        layers["color"][24:34, x:x + 6], layers["color"][26:32, x + 2:x + 6] = 0.8, 0.05
    drawn = ink(layers, tone_1=kind, tone_detail=11.0, shade_levels=[(0.7,), (0.65, 0.25, 0.0)])
    assert drawn[26:32, [15, 31, 32, 48]].mean() < 0.7 and not drawn[26:32, [24, 40]].any()
    assert drawn[26:32, [74, 83, 87, 99]].all() and not drawn[26:32, 80].any()


@pytest.mark.parametrize("pupil, ring", [(0.01, False), (0.036, True)])
def test_an_eye_in_the_darkest_face_has_no_more_than_an_outline(pupil, ring):
    """Its pupil, hardly darker than it, is no print; a letter whose hole is as dark as its board has all its ink."""
    layers, (y, x) = shaded(60, 70, 0.2, 0.036), np.mgrid[:60, :70]
    away = np.hypot(y - 30, x - 35)
    layers["color"][away < 7] = 0.8
    layers["color"][away < 4.2] = pupil
    drawn = ink(layers, tone_1="HATCH", tone_detail=11.0, shade_levels=[(0.2,), (0.65, 0.25, 0.0)])
    assert (drawn[(away > 11.5) & (away < 13.5)].mean() == 1) == ring and drawn[(away > 7.5) & (away < 9)].mean() > 0.9
    assert not drawn[(away > 5) & (away < 6)].any()


RAIL = dict(tone_1="HATCH", tone_black=0.05, shade_levels=[(0.4,), (0.65, 0.25, 0.0)], tone_detail=5.0)


def test_a_bar_turns_from_strokes_to_ink_by_and_by_as_the_light_behind_it_gets_wider():
    inked = []
    for wide in range(10, 91, 4):
        layers = shaded(40, 100, 0.2, 0.02)
        layers["color"][:, :wide] = 0.8
        layers["color"][20:23] = 0.06
        inked.append(ink(layers, **RAIL)[20:23].mean())
    assert inked[-1] > 0.9 and np.diff(inked).max() < 0.7, inked


@pytest.mark.parametrize("kind", ["HATCH", "STIPPLE"])
def test_what_is_print_in_part_is_no_flat_grey(kind):
    flat = []
    for wide in range(30, 91, 4):
        layers = shaded(40, 100, 0.2, 0.02)
        layers["color"][:, :wide] = 0.8
        layers["color"][20:24] = 0.06
        values, count = np.unique(np.round(ink(layers, **dict(RAIL, tone_1=kind))[21:23], 2), return_counts=True)
        flat.append(count[(values > 0.05) & (values < 0.95)].max(initial=0))
    assert max(flat) < 20, flat


def test_a_post_has_the_same_strokes_whatever_is_seen_behind_it():
    """It lies on none of that; letters on the steep wall beside do."""
    layers = shaded(60, 160, 0.2, 0.8)
    layers["color"][:, 40:80] = 0.02
    layers["depth"][:] = 8 * 1.0008 ** np.arange(160)
    for x in (19, 59):
        layers["color"][:, x:x + 3], layers["depth"][:, x:x + 3] = 0.06, 4
    layers["color"][20:40, 120:123] = 0.06
    drawn = ink(layers, **RAIL)
    shares = [drawn[:, x:x + 3].mean() for x in (19, 59)]
    assert max(shares) < 0.9 and abs(shares[0] - shares[1]) < 0.1 and drawn[20:40, 120:123].all(), shares


@pytest.mark.parametrize("nearer", [True, False])
def test_a_window_that_a_rope_cuts_is_as_the_one_beside(nearer):
    """Windows of 12 pixels are no letters: nor is what a rope before one leaves of it; but what a bar in it does."""
    layers = shaded(60, 90, 0.2, 0.8)
    layers["color"][20:34, 20:32] = layers["color"][20:34, 60:72] = 0.02
    layers["color"][:, 66:70], layers["depth"][:, 66:70] = 0.5, 3.0 if nearer else 5.0
    marks = dict(tone_1="STIPPLE", tone_black=0.05, shade_levels=[(0.3,), (0.65, 0.25, 0.0)], tone_detail=5.0)
    drawn = ink(layers, **marks)
    assert drawn[20:34, 20:32].mean() < 0.98 and (drawn[21:33, 60:66].mean() < 0.98) == nearer


def test_an_eye_is_ink_where_it_is_widest_too():
    layers = shaded(60, 60, 0.2, 0.8)
    for y, half in enumerate((1, 2, 2, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 5, 4, 4, 4, 3, 3, 2, 2, 1)):
        layers["color"][20 + y, 30 - half:30 + half] = 0.02
    eye = layers["color"][..., 0] < 0.1
    marks = dict(tone_1="STIPPLE", tone_black=0.05, shade_levels=[(0.3,), (0.65, 0.25, 0.0)])
    assert ink(layers, tone_detail=5.0, **marks)[eye].all()


def test_what_is_large_or_farther_behind_is_no_letter():
    layers = shaded(60, 60, 0.1, 0.8)
    layers["color"][20:40, 20:40] = 0.02
    assert (ink(layers, tone_detail=5.0) == 1).all()
    layers["color"][:, 50:53], layers["depth"][:, 50:53] = 0.02, 4.0
    assert (ink(layers, tone_detail=5.0) == 1).all()


def test_rims_that_were_rendered_with_noise_are_no_letters():
    layers = shaded(60, 60, 0.1, 0.8)
    layers["color"][30:] = 0.02
    layers["color"][29] = np.random.default_rng(1).choice([0.02, 0.2, 0.5], (60, 1))
    assert (ink(layers, tone_detail=5.0) == 1).all()


def barred(wide, least=1.5, ahead=False, joined=False, turned=False):
    """The ink of a bar in the shade, so many pixels wide, of 6 from dot to dot: a shadow, or a thing ahead of a wall;
    perhaps with a larger one at its end."""
    layers = shaded(60, 120, 0.9)
    layers["diffuse"][10:10 + wide, 10:90] = 0.4
    if joined:
        layers["diffuse"][10:50, 80:110] = 0.4
    if ahead:
        layers["depth"][layers["diffuse"][..., 0] < 0.9] = 4
    if turned:
        layers = {name: np.swapaxes(a, 0, 1) for name, a in layers.items()}
    drawn = ink(layers, tone_least=least)
    return (drawn.T if turned else drawn)[10:10 + wide, 10:]


@pytest.mark.parametrize("turned", [False, True])
def test_a_shadow_as_thin_as_a_line_is_ink_and_a_wider_one_a_screen(turned):
    """Cheeks and noses would have black scars."""
    assert (barred(2, turned=turned)[:, :80] == 1).all()
    for wide in (8, 9, 15):
        assert np.abs(barred(wide, turned=turned) - barred(wide, least=0.0, turned=turned)).max() < 1e-5


def test_a_shadow_that_tapers_off_ends_in_dots():
    layers = shaded(60, 120, 0.9)
    for x in range(20, 80):
        layers["diffuse"][30 - (80 - x) // 3:30 + (80 - x) // 3, x] = 0.4
    drawn = ink(layers, tone_least=1.5)
    assert (np.abs(drawn - ink(layers)) > 0.3).sum() < 6


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("joined", "most"), [(False, 0.2), (True, 0.4)])
def test_a_thing_that_widens_turns_from_ink_to_a_screen_by_and_by(turned, joined, most):
    """Alone, and faster where it leads to a larger one."""
    shares = [barred(wide, ahead=True, joined=joined, turned=turned)[:, 10:50].mean() for wide in range(5, 16)]
    assert shares[0] == 1 and shares[-1] < 0.5
    assert np.diff(shares).min() > -most and np.diff(shares).max() < 0.05, shares


def test_dark_skin_has_one_tone_in_the_light_and_in_the_shade():
    """Its darkest quarter is ink, as of all that is lit; what has a third of the light is none, but of black things."""
    def inked(light, color, **of):
        return ink(shaded(20, 20, light, color), tone_black=0.03, tone_dark=0.14, **of).mean()

    assert [inked(light, 0.073) for light in (0.2, 1.0)] == [1, inked(1.0, 0.073)] and inked(1.0, 0.073) < 0.5
    assert all(inked(light, 0.073) < 0.5 for light in (0.33, 0.55)) and inked(0.55, 0.04) == 1
    assert inked(2.0, 0.073) == 0


def test_a_large_least_width_takes_no_more_than_a_few_times_as_long():
    layers, least = whole(crowded(1, 360, 640)), {}
    for wide in (1.5, 30.0) * 3:
        start = time.process_time()
        library.render(layers, dict(BLACK, tone_least=wide), threads=1, outputs=("Encre Tones",))
        least[wide] = min(least.get(wide, 1e9), time.process_time() - start)
    assert least[30.0] < 8 * least[1.5], least


def test_a_slit_in_ink_is_paper():
    layers = shaded(60, 60, 0.1)
    layers["diffuse"][:, 30:32] = 0.4
    assert ink(layers)[:, 30:32].any() and not ink(layers, tone_least=1.5)[:, 30:32].any()
