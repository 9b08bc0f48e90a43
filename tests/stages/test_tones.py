# SPDX-License-Identifier: GPL-3.0-or-later
"""Tones against tests/reference/tones.py, against the ink that was asked for, and how they stick to surfaces."""

import itertools

import hands
import numpy as np
import pytest
import sticks
from encre.pen import library, presets
from encre.pen.job import Camera, Frame
from reference import render as reference
from reference.tiles import thresholds
from toned import ALONE, LEVELS, MORE_LEVELS, RAMP, TILE, flat, ramped, slanted, steep, stuck, tile, twins, without_some

STYLES = [dict(tone_1="CROSS", tone_2="GRAIN", tone_3="GRAIN", tone_4="DOTS", tone_1_space="SURFACE",
               tone_4_space="SURFACE", tone_1_pitch=9.0, tone_1_gradient=0.7, tone_3_gradient=1.0,
               tone_2_color=(0.4, 0.1, 0.0), tone_darkness=0.2, tone_black=0.6),
          dict(tone_1="SOLID", tone_2="LINES", tone_3="LINES", tone_4="LINES", tone_2_angle=-20.0, tone_3_angle=-20.0,
               tone_3_gradient=0.5),
          dict(use_tones=False)]


@pytest.mark.parametrize("kind, space", [("DOTS", "SURFACE"), ("DOTS", "OBJECT"), ("LINES", "SURFACE"),
                                         ("CROSS", "OBJECT"), ("IMAGE", "SURFACE"), ("IMAGE", "OBJECT")])
def test_twin_of_what_is_seen_on_its_edge(kind, space):
    scene = dict(ALONE, shade_levels=MORE_LEVELS,
                 **sticks.tone(kind, space=space, pitch=9.0, angle=25.0, image="tile"))
    few = 0.06 if (kind, space) == ("DOTS", "SURFACE") else 0.02
    assert twins(steep(90, 60), scene, few=few, rounding=5e-4, wrong=4e-3)["Encre Tones"][..., 3].std() > 0.05


@pytest.mark.parametrize("kind, space", [*itertools.product(("SOLID", "DOTS", "LINES", "CROSS", "GRAIN"),
                                                            ("SCREEN", "SURFACE")),
                                         *itertools.product(("DOTS", "CROSS"), ("OBJECT", "FLAT"))])
def test_twin(kind, space):
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone(kind, space=space, pitch=7.3, angle=30.0))
    far = kind == "DOTS" and space != "SCREEN"  # towards the horizon of the floor
    got = twins(stuck(120, 80), scene, STYLES, Frame(200, 160, 31, 20), few=0.05 if far else 0.02,
                wrong=4e-3 if far else 5e-4)
    assert got["Encre Tones"][..., 3].std() > 0.05


@pytest.mark.parametrize("pitch", [3.1, 8.8, 13.0])
def test_twin_of_dots_of_all_sizes(pitch):
    """Pitches that rounding leaves on the same side of where an octave ends."""
    scene = dict(ALONE, shade_levels=[(0.6,), (0.9, 0.3, 0.2), (0.97, 0.7, 0.0), (1.1, 1.0, 0.1)],
                 **sticks.tone("DOTS", pitch=pitch, angle=20.0))
    twins(stuck(90, 60, 1), scene)


def look(rng, kinds):
    own = dict(tone_black=rng.choice([0, rng.random()]),
               tone_black_by=str(rng.choice(["VALUE", "LUMINANCE"])), tone_dark=rng.choice([0, rng.random()]),
               tone_reds=rng.choice([0, 2 * rng.random()]),
               tone_local=rng.choice([0, rng.random()]), tone_darkness=rng.choice([0, rng.uniform(-0.5, 0.5)]))
    own["tone_form"] = own["tone_local"]  # as random as that
    for n in range(1, 7):
        own |= {f"tone_{n}": str(rng.choice([*kinds, *["SAME"] * (n > 4)])),
                f"tone_{n}_pitch": rng.choice([3, 6, 14]) * rng.uniform(0.5, 1),
                f"tone_{n}_angle": rng.uniform(-180, 180), f"tone_{n}_space": str(rng.choice(["SCREEN", "SURFACE"])),
                f"tone_{n}_gradient": rng.choice([0, rng.random()]), f"tone_{n}_color": tuple(rng.random(3))}
    return own


@pytest.mark.parametrize("seed", range(8))
def test_twin_of_any_look(seed):
    rng, kinds = np.random.default_rng(seed), ["NONE", "SOLID", "LINES", "LINES", "CROSS", "CROSS"]
    layers = without_some(rng, stuck(90, 60, seed), "anchor", "object", "style", "controls", "specular")
    levels = {1: [(0.2,), (0.5, 0.0, 0.3), (0.8, 0.6, 0.0), (0.9, 0.6, 0.0)], 2: MORE_LEVELS}.get(seed % 4, LEVELS)
    scene = dict(ALONE, shade_levels=levels, tone_pitch_unit=str(rng.choice(["LENGTH", "LPI"])), page_height=20.0,
                 **look(rng, kinds))
    twins(layers, scene, [look(rng, kinds), look(rng, kinds), dict(use_tones=False)], Frame(200, 160, 31, 20))


@pytest.mark.parametrize("how", [dict(space="SCREEN", pitch=60.0), dict(space="SURFACE", pitch=16.0),
                                 dict(space="SURFACE", pitch=29.0), dict(space="OBJECT", pitch=60.0),
                                 dict(space="FLAT", pitch=29.0)])
@pytest.mark.parametrize("crisp", [False, True])
def test_twin_of_pictures(how, crisp):
    scene = dict(ALONE, shade_levels=LEVELS, tone_crisp=crisp, **sticks.tone("IMAGE", angle=30.0, image="tile", **how))
    got = twins(stuck(90, 60), scene, STYLES, Frame(200, 160, 31, 20), few=0.02)
    assert got["Encre Tones"][..., 3].std() > 0.05


def test_a_picture_that_is_read_for_each_level_flows_from_one_to_the_next():
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("IMAGE", image="tile", pitch=30.0))
    one, copies = (library.render(ramped(60, 20), scene, image=image).images["Combined"].tobytes()
                   for image in (lambda _: TILE, lambda _: TILE.copy()))
    assert one == copies


@pytest.mark.parametrize("kind", ["SOLID", "DOTS", "CROSS"])
def test_twin_in_ink_or_none_by_lines_an_inch(kind):
    layers = stuck(120, 80)
    scene = dict(ALONE, shade_levels=LEVELS, tone_crisp=True, tone_pitch_unit="LPI", length_unit="MM",
                 page_height=40.0, **sticks.tone(kind, pitch=15.0, angle=30.0))
    got, want = (images["Encre Tones"][..., 3] / layers["combined"][..., 3] for images in
                 (library.render(layers, scene, outputs=["Encre Tones"]).images, reference(layers, scene)))
    assert np.abs(got - np.round(got)).max() < 1e-6 and 0.1 < got.mean() < 0.9
    assert (np.abs(got - want) > 0.5).mean() < 0.01


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "CROSS"])
def test_crisp_screens_repeat_themselves_by_whole_pixels(kind):
    """(7, 5) pixels on, and as far across, the same: no moire; and the ink is what was asked for, by whole pixels."""
    look = dict(tone_1=kind, tone_crisp=True, tone_1_pitch=74**0.5, tone_1_angle=np.degrees(np.arctan2(5, 7)))
    for dark in (0.2, 0.5, 0.8):
        ink = flat(dark, (222, 222), **look)
        assert set(np.unique(ink)) == {0, 1} and abs(ink.mean() - dark) < 0.08
        assert np.array_equal(ink[7:, 5:], ink[:-7, :-5]) or np.array_equal(ink[5:, 7:], ink[:-5, :-7])


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "IMAGE", "HATCH", "STIPPLE"])
def test_a_surface_of_which_no_place_is_known_is_as_dark_as_asked(kind):
    ink = flat(0.3, (9, 300), np.zeros((9, 300, 16), np.float32), tone_1=kind, tone_1_space="SURFACE",
               tone_1_image="tile")
    assert np.abs(ink - 0.3).max() < 0.5 / 255


def test_mirrors_have_the_tones_of_what_they_show():
    """A thing in half light, a black one and the sky, seen in a mirror that is not lit itself."""
    size, light, dots = (12, 36), 0.45, dict(ALONE, tone_1="SOLID", tone_2="SOLID", tone_2_color=(0.0, 1.0, 0.0),
                                            tone_3="NONE", tone_black=0.12, shade_levels=LEVELS)
    zero = np.zeros((*size, 3), np.float32)
    seen, depth = zero + 0.4, np.ones((*size, 1), np.float32)
    seen[:, 12:24], depth[:, 24:] = 0.05, 0
    layers = dict(combined=np.concatenate([seen * light, np.ones_like(depth)], 2), color=zero, diffuse=zero,
                  depth=np.ones_like(depth), normal=zero + 1, seen_color=seen, seen_normal=zero + 1, seen_depth=depth)
    for on in False, True:
        got = library.render(layers, dots | dict(tone_mirrors=on), outputs=["Encre Tones"]).images["Encre Tones"]
        np.testing.assert_allclose(got, reference(layers, dots | dict(tone_mirrors=on))["Encre Tones"], atol=2e-5)
        assert (got[:, :12, 1] == on).all() and (got[:, 12:24, 1] == 0).all() and (got[:, 24:, 3] == (not on)).all()
        assert (got[:, :24, 3] == 1).all()
    blue = dots | dict(tone_mirrors=True), layers | dict(color=zero + np.float32((0, 0, 0.06)))  # is no mirror
    got = library.render(blue[1], blue[0], outputs=["Encre Tones"]).images["Encre Tones"]
    assert (got[:, 24:] == (0, 0, 0, 1)).all()


def test_blacks_are_what_the_eye_sees_as_dark():
    """By the brightest channel navy is lighter than a green sea; by luminance it is darker. So it is in mirrors."""
    navy, sea = np.float32((0.05, 0.09, 0.22)), np.float32((0.03, 0.15, 0.17))
    color = np.repeat(np.stack([navy, sea])[None], 6, 0).repeat(6, 1)
    zero, one = np.zeros_like(color), np.ones((6, 12, 1), np.float32)
    layers = dict(color=color, combined=np.concatenate([color, one], 2), diffuse=zero + 1, depth=one, normal=zero + 1)
    seen = dict(color=zero, diffuse=zero, seen_color=color, seen_normal=zero + 1, seen_depth=one)
    scene = dict(ALONE, tone_1="SOLID", tone_2="NONE", tone_3="NONE", tone_mirrors=True,
                 shade_levels=[(0.0,), (1, 0.3, 0)])
    for held in layers, layers | seen:
        for by, black, inked in ("VALUE", 0.2, (0, 1)), ("LUMINANCE", 0.1, (1, 0)):
            params = scene | dict(tone_black=black, tone_black_by=by)
            ink = library.render(held, params, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
            np.testing.assert_allclose(ink, reference(held, params)["Encre Tones"][..., 3], atol=2e-5)
            assert (ink[:, :6] == inked[0]).all() and (ink[:, 6:] == inked[1]).all(), (by, black)
    gloss = zero + np.float32(0.5)  # as dark as under no mirror
    held = layers | dict(color=color / 2, combined=np.concatenate([color / 2, one], 2), gloss=gloss,
                         albedo=color / 2 + gloss)
    for by, black, inked in ("VALUE", 0.12, (1, 1)), ("LUMINANCE", 0.1, (1, 0)):
        params = scene | dict(tone_black=black, tone_black_by=by)
        ink = library.render(held, params, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
        np.testing.assert_allclose(ink, reference(held, params)["Encre Tones"][..., 3], atol=2e-5)
        assert (ink[:, :6] == inked[0]).all() and (ink[:, 6:] == inked[1]).all(), (by, black)


def test_dark_colours_have_tones_in_the_light_and_are_black_in_the_shade():
    """From black in any light to as white as white by and by, on things and in mirrors; brown skin has its tone."""
    bright = np.linspace(0.02 ** (1 / 3), 0.18 ** (1 / 3), 33) ** 3
    color = np.tile(bright[None, :, None], (40, 1, 3)).astype(np.float32)
    light = np.tile(np.linspace(0.02, 1, 40)[:, None, None], (1, 33, 3)).astype(np.float32)
    zero, one = np.zeros_like(color), np.ones((40, 33, 1), np.float32)
    layers = dict(color=color, combined=np.concatenate([color * light, one], 2), diffuse=light, depth=one,
                  normal=zero + 1)
    seen = dict(color=zero, diffuse=zero, seen_color=color, seen_normal=zero + 1, seen_depth=one)
    scene = dict(ALONE, tone_1="SOLID", tone_2="SOLID", tone_2_color=(0, 1, 0), tone_3="NONE", tone_mirrors=True,
                 tone_black=0.05, tone_dark=0.15, shade_levels=[(0.0,), (0.5, 0.25, 0), (1, 0.55, 0)])
    for held in layers, layers | seen:
        ink = library.render(held, scene, outputs=["Encre Tones"]).images["Encre Tones"]
        np.testing.assert_allclose(ink, reference(held, scene)["Encre Tones"], atol=1e-4)
        black, paper = (ink[..., 3] > 0.5) & (ink[..., 1] < 0.1), ink[..., 3] < 0.5
        assert black[:, bright < 0.05].all()
        rows = black.sum(0)[bright > 0.05]
        assert (np.diff(rows) <= 0).all() and np.abs(np.diff(rows)).max() < 14 and 8 < rows[-1] < 12
        skin = np.argmin(np.abs(bright - 0.09))
        assert not black[-1, skin] and not paper[-1, skin] and black[8, skin] and paper[-1, -1]


@pytest.mark.parametrize("space", ["SCREEN", "SURFACE"])
def test_a_dark_sky_has_tones_where_asked(space):
    """By its own brightness, seen and mirrored; what shines in it is light, and so is a transparent film."""
    size = 8, 40
    zero, one = np.zeros((*size, 3), np.float32), np.ones((*size, 1), np.float32)
    sky = zero + np.linspace(0.05, 0.9, 40, dtype=np.float32)[None, :, None]
    sky[:3, :8] = 3  # the moon
    alpha = one.copy()
    alpha[6:] = 0
    layers = dict(combined=np.concatenate([sky * alpha, alpha], 2), color=zero, diffuse=zero, normal=zero,
                  depth=one * np.float32(1e10))
    seen = dict(seen_color=zero, seen_normal=zero, seen_depth=one * 0)
    mirror = layers | seen | dict(depth=one, normal=zero + 1)
    scene = dict(ALONE, tone_1="SOLID", tone_2="DOTS", tone_2_space=space, tone_3="NONE", tone_mirrors=True,
                 tone_black=0.03, shade_levels=[(0.0,), (0.45, 0.2, 0), (1, 0.5, 0)])
    for held, shown in (layers, 1e10), (layers | seen, 1e10), (mirror, 1):
        for amount, exposure in (0, 1), (1, 1), (2, 0.25):
            params = scene | dict(tone_sky=amount, shade_exposure=exposure)
            ink = library.render(held, params, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
            np.testing.assert_allclose(ink, reference(held, params)["Encre Tones"][..., 3], atol=2e-5)
            bright, night = sky[4, :, 0] * amount * exposure, ink[3:6]
            assert amount or not ink.any()
            assert not ink[:2, :8].any() and not ink[6:].any() and not night[:, bright > 0.52].any()
            assert (night[:, bright < 0.19] == 1).all() or not amount
            dots = night[:, (bright > 0.21) & (bright < 0.49)]
            sticks = space == "SURFACE" and shown > 1  # to nothing
            assert not amount or (dots == 1).all() or not sticks and 0.3 < dots.mean() < 0.8


def test_the_sky_in_a_dark_sea_does_not_cut_it():
    """At any angle, from where it mirrors little to where it mirrors nearly all. What lamps throw back is seen, and so
    is the sky in black metal and, by the layers of what is seen, where the sea is a mirror."""
    size, sky = (9, 40), 0.8
    zero, one = np.zeros((*size, 3), np.float32), np.ones((*size, 1), np.float32)
    gloss = zero + np.linspace(0.05, 0.95, 40, dtype=np.float32)[None, :, None]
    color = np.float32(0.1) * (1 - gloss)
    light = np.full(size, sky, np.float32)[..., None]
    light[:3] = 4  # glitter
    color[6:] = 0  # metal
    layers = dict(combined=np.concatenate([color + gloss * light, one], 2), color=color, albedo=color + gloss,
                  gloss=gloss, diffuse=zero + 1, depth=one, normal=zero + 1, seen_color=color + gloss,
                  seen_normal=zero + 1, seen_depth=one)
    scene = dict(ALONE, tone_1="SOLID", tone_2="NONE", tone_3="NONE", tone_black=0.12,
                 shade_levels=[(0.0,), (1, 0.3, 0)])
    for mirrors in False, True:
        for depth in one, 2 * one:  # the surface itself, another thing
            held, params = layers | dict(seen_depth=depth), scene | dict(tone_mirrors=mirrors)
            ink = library.render(held, params, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
            np.testing.assert_allclose(ink, reference(held, params)["Encre Tones"][..., 3], atol=2e-5)
            clear = mirrors and depth[0, 0] == 2
            assert (ink[3:6] == (gloss[3:6, :, 0] < 0.7 if clear else 1)).all()
            assert (ink[:3, 14:] == 0).all() and (ink[6:, 18:] == 0).all() and ink[6:, :8].all() != mirrors


def test_light_that_falls_off_a_lamp_has_one_shape_in_manga():
    """Each level's border was a ring around it: dots get smaller toward it, and only black has an edge."""
    values = presets.find("Manga").values | dict(use_lines=False, length_unit="PIXELS", tone_detail=0.0, tone_least=0.0,
                                                 shade_meter="SCENE", tone_local=0.0)
    one = np.ones((120, 900, 3), np.float32)
    light = one * (1.3 / (1 + (np.arange(900) / 300) ** 2)).astype(np.float32)[None, :, None] ** 1.5
    layers = dict(color=0.7 * one, diffuse=light, depth=one[..., :1], normal=one,
                  combined=np.concatenate([0.7 * light, one[..., :1]], 2))
    ink = library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].mean(0)
    smooth = np.convolve(ink, np.ones(17) / 17, "same")[30:-30]  # two rows of dots
    steps = np.abs(smooth[17:] - smooth[:-17])
    grays = (smooth[17:] < 0.75) & (smooth[:-17] < 0.75)
    assert smooth[0] < 0.01 and smooth[-1] > 0.99 and steps.max() > 0.2 and steps[grays].max() < 0.12


HAIR = {"auburn": (0.22, 0.065, 0.03), "dark auburn": (0.165, 0.037, 0.011), "chestnut": (0.3, 0.06, 0.036)}
SKIN = {"light": (0.8, 0.55, 0.42), "tan": (0.45, 0.25, 0.15), "brown": (0.22, 0.11, 0.06), "olive": (0.2, 0.12, 0.06)}


@pytest.mark.parametrize("preset", ["Manga", "Heavy blacks", "Superhero"])
def test_dark_skin_wood_and_wine_red_are_no_blacks_in_the_light(preset):
    """As luminance goes they were: faces and rooms lost all that is in them. Iron and navy as light stay black."""
    values = presets.find(preset).values | dict(use_lines=False, length_unit="PIXELS", tone_detail=0.0,
                                                tone_least=0.0, use_specks=False)

    def ink(color, light):
        one = np.ones((60, 60, 3), np.float32)
        layers = dict(color=one * np.float32(color), diffuse=light * one, depth=one[..., :1], normal=one,
                      combined=np.concatenate([light * one * np.float32(color), one[..., :1]], 2))
        return library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].mean()

    shown = {"dark skin": (0.085, 0.045, 0.028), "walnut": (0.092, 0.071, 0.045), "wine": (0.082, 0.028, 0.019),
             "plum": (0.07, 0.018, 0.103)}
    if preset == "Heavy blacks":
        del shown["wine"]  # as red-brown hair is there
    for name, color in shown.items():
        assert ink(color, 1.0) < 0.8, name
        assert ink(color, 0.3) > 0.4, name
    assert all(ink(color, 1.0) == 1 for color in ((0.028, 0.028, 0.028), (0.01, 0.015, 0.06), (0.03, 0.015, 0.01)))


def test_red_brown_hair_is_dark_and_brown_skin_as_light_is_paper():
    """Any single number below which colours are dark that fills the one blackens the other. None gets black, and from
    brown to red nothing jumps."""
    values = presets.find("Heavy blacks").values | dict(use_lines=False, length_unit="PIXELS", tone_detail=0.0,
                                                        tone_least=0.0)

    def ink(color, light=1.0, **of):
        one = np.ones((60, 60, 3), np.float32)
        layers = dict(color=one * np.float32(color), diffuse=light * one, depth=one[..., :1], normal=one,
                      combined=np.concatenate([light * one * np.float32(color), one[..., :1]], 2))
        return library.render(layers, values | of, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].mean()

    for name, color in HAIR.items():
        assert ink(color) > 0.3 or name == "chestnut", name
        assert ink(color, tone_reds=0.0) < (0.1 if name != "dark auburn" else 1.1), name
    assert not any(ink(color) for color in SKIN.values())
    by_degrees = dict(tone_1="DOTS", tone_1_gradient=1.0, shade_levels=[(0.0,), (1.0, 1.0, 0.0)])
    reds = [ink((0.22, green, 0.03), **by_degrees) for green in np.linspace(0.11, 0.02, 160)]
    assert np.abs(np.diff(reds)).max() < 0.06 and ink(HAIR["dark auburn"], **by_degrees) < 1


@pytest.mark.parametrize("preset", ["Manga", "Hatched", "Stippled"])
def test_paint_and_cloth_of_a_strong_red_or_blue_have_a_tone_in_full_light(preset):
    """Beside what is cream, grass or skin, which is paper. Manga has a light screen on brown skin, and a dark one on
    hair that is no darker."""
    values = presets.find(preset).values | dict(use_lines=False, length_unit="PIXELS", tone_detail=0.0, tone_least=0.0)

    def ink(color):
        one = np.ones((90, 90, 3), np.float32)
        layers = dict(color=one * np.float32(color), diffuse=1.05 * one, depth=one[..., :1], normal=one,
                      combined=np.concatenate([1.05 * one * np.float32(color), one[..., :1]], 2))
        return library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].mean()

    assert min(ink(color) for color in ((0.62, 0.07, 0.07), (0.58, 0.06, 0.05), (0.06, 0.16, 0.42))) > 0.1
    assert max(ink(color) for color in ((0.84, 0.8, 0.7), (0.1, 0.3, 0.08), SKIN["light"], SKIN["tan"])) < 0.02
    brown = [ink(SKIN[name]) for name in ("brown", "olive")]
    assert max(brown) < 0.02 if preset != "Manga" else max(brown) < 0.45 < 0.55 < min(map(ink, HAIR.values()))


@pytest.mark.parametrize("preset", ["Manga", "Hatched", "Stippled"])
def test_pupils_are_black_in_any_light(preset):
    """Of 14 pixels, on a pale face in half shade: of strokes or spots as large as they are they were smudges."""
    y, x = np.mgrid[:80, :200]
    dark = ((y - 40) ** 2 + (np.abs(x - 100) - 50) ** 2 < 49)[..., None]
    one = np.ones((80, 200, 1), np.float32)
    color = np.where(dark, np.float32(0.012), np.float32((0.8, 0.6, 0.5)))
    light = np.where(x < 100, np.float32(0.4), np.float32(1.05))[..., None] * np.ones(3, np.float32)
    layers = dict(color=color, diffuse=light, depth=one, normal=0 * light + np.float32((0, 0, 1)),
                  combined=np.concatenate([color * light, one], 2))
    values = presets.find(preset).values | dict(use_lines=False, length_unit="PIXELS")
    ink = library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
    assert (ink[dark[..., 0]] > 0.99).mean() > 0.97 and ink[~dark[..., 0]].mean() < 0.6


def test_a_dark_sea_is_as_light_as_the_sky_in_it():
    """By day paper and by night black, while what is near black is black, and what mirrors less than it shows itself is
    as dark as under no mirror; nothing is cut where a colour passes into black or a sky into night."""
    size, mirrors, names = (50, 40), np.float32(0.3), dict(outputs=["Encre Tones"])
    zero, one = np.zeros((*size, 3), np.float32), np.ones((*size, 1), np.float32)
    sky = np.linspace(0, 1, 50, dtype=np.float32)[:, None, None]
    blue = np.linspace(0, 0.06, 40, dtype=np.float32)[None, :, None]
    color = (1 - mirrors) * (zero + blue * np.float32((0.4, 1, 2)))
    layers = dict(color=color, diffuse=zero + 1, depth=one, normal=zero + 1)
    scene = dict(ALONE, tone_1="SOLID", tone_2="NONE", tone_3="NONE", tone_black=0.03, tone_dark=0.12,
                 tone_black_by="LUMINANCE", shade_levels=[(0.0,), (1, 0.5, 0.9)])  # all shades between
    over = layers | dict(gloss=zero + mirrors, albedo=color + mirrors)
    inks = []
    for held, light in (layers, 0), (over, mirrors * sky):
        held = held | dict(combined=np.concatenate([color + light * np.float32((0.6, 0.7, 1)), one], 2))
        inks.append(library.render(held, scene, **names).images["Encre Tones"][..., 3])
        np.testing.assert_allclose(inks[-1], reference(held, scene)["Encre Tones"][..., 3], atol=2e-5)
    matt, sea = inks
    bright = (color @ np.float32((0.2126, 0.7152, 0.0722)))[0] / (1 - mirrors)
    daylit, dark = bright > 0.045, (bright > 0.01) & (bright < 0.029)  # below is metal
    assert (sea[40:, daylit] < 0.25).all() and (sea[:5, daylit] > 0.6).all() and (sea[:, dark] == 1).all()
    assert (np.diff(sea, axis=0) < 1e-6).all() and np.diff(sea[:, bright > 0.01], axis=0).min() > -0.15
    assert matt[0, daylit].min() > 0.3


def test_dark_colors_have_a_light_side_and_a_dark_side():
    """A color that has a third of full light has a third of a middle one with `tone_form` and as much of any, but no
    less than where solid ends, if it had more without."""
    light = np.float32((0.06, 0.35, 0.7, 1))[None, :, None]
    zero, one = np.zeros((3, 4, 3), np.float32), np.ones((3, 4, 1), np.float32)
    color = zero + np.float32((0.03 ** (1 / 3) * 2 / 3 + 0.14 ** (1 / 3) / 3) ** 3)
    layers = dict(color=color, diffuse=zero + light, depth=one, normal=zero + 1,
                  combined=np.concatenate([color * light, one], 2))

    def left(form):
        scene = dict(ALONE, tone_1="SOLID", tone_2="SOLID", tone_3="NONE", tone_black=0.03, tone_dark=0.14,
                     tone_black_by="LUMINANCE", shade_levels=[(0.0,), (0, 0.02, 0.04), (1, 0.5, 0.92)], tone_form=form)
        drawn, want = library.render(layers, scene, outputs=["Encre Tones"]).images, reference(layers, scene)
        np.testing.assert_allclose(drawn["Encre Tones"], want["Encre Tones"], atol=2e-5)
        return 0.04 + 0.92 * (1 - drawn["Encre Tones"][0, :, 3])

    bright = light[0, :, 0]
    usual = bright / 3 / np.sqrt(bright ** 2 * 8 / 9 + 1 / 9)
    np.testing.assert_allclose(left(0), usual, atol=1e-4)
    np.testing.assert_allclose(left(1), [0.04, *bright[1:] / 2.1], atol=1e-4)
    np.testing.assert_allclose(left(0.5), (usual + bright / 2.1) / 2, atol=1e-4)


def test_without_an_anchor_or_a_card_the_screen_is_kept_to():
    layers = stuck(60, 40)
    del layers["anchor"], layers["card"]
    screen, *stuck_ = (library.render(layers, ALONE | sticks.tone("DOTS", space=space)).images["Combined"].tobytes()
                       for space in ("SCREEN", "SURFACE", "FLAT"))
    assert stuck_ == [screen, screen]


@pytest.mark.parametrize("kind, off", [("DOTS", 0.01), ("LINES", 0.01), ("CROSS", 0.01), ("IMAGE", 0.03),
                                       ("HATCH", 0.03), ("STIPPLE", 0.02)])
def test_ink_of_flat_tones_is_what_was_asked_for(kind, off):
    """On a sheet that has rolled, from where a pitch is 2^m on to where it is 2^(m + 1)."""
    size = 300, 300
    y, x = np.mgrid[:size[0], :size[1]]
    for k in range(4):
        right, up = 0.01 * 2 ** (k / 4) * np.array((np.cos(0.3), np.sin(0.3)))
        card = np.stack([x * right + y * up, x * up - y * right, 0 * x + right, 0 * x + up], -1).astype(np.float32)
        for dark in RAMP:
            ink = flat(dark, size, card=card, **sticks.tone(kind, space="FLAT", angle=20.0, image="tile",
                                                            pitch=24.0 if kind == "IMAGE" else 8.0))
            ink = ink[60:-60, 60:-60] if kind in ("HATCH", "STIPPLE") else ink
            assert abs(ink.mean() - dark) < off, (k, dark, ink.mean())


def test_flat_tones_are_alike_wherever_a_thing_is():
    """A plane that faces the eye, pushed and pulled by whole pixels, rolled by a right angle: its dots go with it."""
    from encre.pen.job import Mesh

    square = np.array([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], np.float32) * 0.5
    view, projection = sticks.eye(pitch=0.0)
    pixel = 2 * 7 / (2.0 * sticks.SIZE[0])

    def drawn(right=0, up=0, turn=0):
        model = np.eye(4)
        model[:3, 3] = right * pixel, 0, 0.7 + up * pixel
        model[(0, 2, 0, 2), (0, 2, 2, 0)] = np.cos(turn), np.cos(turn), np.sin(turn), -np.sin(turn)
        plane = Mesh(square, np.array([[0, 1, 2], [0, 2, 3]], np.int32), object_index=1, model=model)
        return sticks.frame([plane], view, projection, sticks.SCREENS["flat dots"])[0]

    ink = drawn()
    at = np.s_[140:220, 280:360]
    assert ink[at].std() > 0.2
    np.testing.assert_allclose(drawn(13, -9)[149:229, 293:373], ink[at], atol=2e-3)
    np.testing.assert_allclose(drawn(turn=np.pi / 2)[at], np.rot90(ink[at], -1), atol=2e-3)


@pytest.mark.parametrize("space", ["SCREEN", "SURFACE", "FLAT"])
def test_any_width_is_part_of_a_wider_one(space):
    layers, frame, names = stuck(530, 5), Frame(900, 700, 11, 6), ("Combined", "Encre Tones")
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("DOTS", space=space), tone_4_pitch=5.0)
    whole = library.render(layers, scene, STYLES, frame=frame, outputs=names).images
    for width in (1, 7, 8, 9, 15, 16, 17, 31, 33, 255, 256, 257, 511, 513):
        part = library.render({name: a[:, :width] for name, a in layers.items()}, scene, STYLES, frame=frame,
                              outputs=names).images
        inner = np.s_[:, :width - 1]  # beyond it the light is not known, by which a step's edge is smooth
        assert all(part[name][inner].tobytes() == whole[name][inner].tobytes() for name in names), width


@pytest.mark.parametrize("space", ["SCREEN", "SURFACE", "FLAT"])
def test_threads_instructions_and_borders_change_nothing(space):
    layers = stuck(97, 61)
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("DOTS", space=space), tone_4_pitch=5.0)

    def drawn(part=np.s_[:, :], frame=None, **how):
        return library.render({name: a[part] for name, a in layers.items()}, scene, STYLES, frame=frame,
                              outputs=("Combined", "Encre Tones"), **how).images

    whole = drawn(threads=1)
    for how in (dict(threads=4), dict(simd=0)):
        for name, picture in drawn(**how).items():
            assert picture.tobytes() == whole[name].tobytes(), (name, how)
    part = drawn(np.s_[20:50, 33:90], Frame(97, 61, 33, 20))
    assert all(np.array_equal(part[name][1:-1, 1:-1], whole[name][21:49, 34:89]) for name in whole)


def test_a_step_s_edge_is_as_smooth_as_a_line_s():
    """Of a drawn shadow, whose light takes two pixels from none to all, and of light that falls off by and by."""
    y, x = np.mgrid[:40, :60]
    scene = dict(ALONE, tone_1="SOLID", tone_2="NONE", tone_3="NONE", shade_levels=[(0.0,), (1, 0.5, 0)])
    for wide, slope in ((2.0, 0.1), (2.0, 0.7), (40.0, 0.3)):
        off = ((x - 29.7) - slope * (y - 20)) / np.hypot(1, slope)
        light, one = np.clip(off / wide + 0.5, 0, 1)[..., None].astype(np.float32), np.ones((40, 60, 1), np.float32)
        layers = dict(combined=np.dstack([light, light, light, one]), color=np.repeat(one, 3, 2),
                      diffuse=np.repeat(light, 3, 2), depth=5 * one, normal=np.dstack([0 * one, 0 * one, one]))
        for crisp in (False, True):
            ink = library.render(layers, scene | dict(tone_crisp=crisp), outputs=["Encre Tones"]).images["Encre Tones"]
            ink = ink[2:-2, 2:-2, 3]
            edge = np.clip(0.5 - off, 0, 1)[2:-2, 2:-2]
            if crisp:
                assert set(np.unique(ink)) == {0, 1}
            else:
                assert np.abs(ink - edge).max() < 0.25 and np.abs(ink.sum(1) - edge.sum(1)).max() < 0.15, (wide, slope)


def test_what_the_sun_shines_on_has_no_spots():
    """Ground under a sun 35 degrees high, which is lit by .57 of it, had them all over. What the sun but grazes has
    some, and the shade many."""
    values, one, ink = presets.find("Stippled").values | dict(use_lines=False), np.ones((64, 64, 3), np.float32), []
    for light in (0.57, 0.3, 0.05):
        layers = dict(combined=np.dstack([0.3 * light * one, one[..., :1]]), color=0.3 * one, diffuse=light * one,
                      depth=5 * one[..., :1], normal=one * np.float32((0, 0, 1)))
        ink.append(library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].mean())
    assert ink[0] == 0 < 0.03 < ink[1] < ink[2] - 0.2, ink


def test_hatched_has_fewer_strokes_the_lighter_it_is():
    """Sunlit ground was as dark as half shade."""
    values, one, ink = presets.find("Hatched").values | dict(use_lines=False), np.ones((96, 96, 3), np.float32), []
    for light in (0.45, 0.55, 0.64):
        layers = dict(combined=np.dstack([0.3 * light * one, one[..., :1]]), color=0.3 * one, diffuse=light * one,
                      depth=5 * one[..., :1], normal=one * np.float32((0, 0, 1)))
        ink.append(library.render(layers, values, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].mean())
    assert ink[0] > 0.1 and ink[1] < 0.8 * ink[0] and ink[2] < 0.25 * ink[0], ink


def test_where_hardly_any_stroke_would_be_there_is_none():
    """One here and one there on a white wall was rain."""
    one = np.ones((120, 160, 3), np.float32)
    look = dict(use_tones=True, tone_1="HATCH", tone_1_pitch=8.0, tone_1_angle=0.0, length_unit="PIXELS")
    layers = dict(combined=np.dstack([one, one[..., :1]]), color=one, diffuse=one, depth=5 * one[..., :1],
                  normal=one * np.float32((0, 0, 1)))
    none, few, asked = (library.render(layers, dict(look, shade_levels=[(1 - dark,)]), outputs=["Encre Tones"])
                        .images["Encre Tones"][..., 3].mean() for dark in (0.02, 0.035, 0.05))
    assert none == 0 and 0.005 < few < 0.03 and abs(asked - 0.05) < 0.02, (none, few, asked)


def test_dots_of_manga_are_thinner_than_its_inner_contours():
    """A nose and lips among dots as wide as they were dots themselves. The darkest screen has holes, not dots."""
    values = presets.find("Manga").values
    dot = 2 * values["tone_3_pitch"] * ((1 - values["shade_levels"][2][0]) / np.pi) ** 0.5
    assert dot < 0.8 * values["line_thickness"] * values["line_inner_width"]


def test_about_letters_in_superhero_their_ground_keeps_its_hue():
    """What is clear of ink in the shade was mauve, whatever it was."""
    values = presets.find("Superhero").values | dict(use_lines=False, length_unit="PIXELS")
    cream = np.float32((0.7, 0.6, 0.4))
    color, light = cream * np.ones((60, 60, 3), np.float32), np.full((60, 60, 3), 0.1, np.float32)
    color[20:40, 20:24] = 0.02
    layers = dict(combined=np.dstack([color * light, light[..., :1] * 10]), color=color, diffuse=light,
                  depth=light[..., :1] * 50, normal=light * 10)
    drawn = library.render(layers, values, outputs=["Combined"]).images["Combined"]
    margin = drawn[24:36, [18, 25], :3]
    assert np.abs(margin / margin[..., :1] - cream / cream[0]).max() < 0.01 and (margin[..., 0] > 0.3).all()
    assert not drawn[24:36, [20, 23, 40], :3].any()


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "CROSS"])
@pytest.mark.parametrize("look", [dict(tone_1_pitch=8.0), dict(tone_1_pitch=5.3, tone_1_angle=15.0),
                                  dict(tone_1_pitch=12.0, tone_1_angle=0.0),
                                  dict(tone_1_pitch=3.0), dict(tone_1_pitch=37.0)])
def test_ink_on_the_screen_is_what_was_asked_for(kind, look):
    for dark in RAMP:
        assert abs(flat(dark, tone_1=kind, **look).mean() - dark) < 0.01, dark


@pytest.mark.parametrize("crisp", [False, True])
@pytest.mark.parametrize("pitch, angle", [(36.0, 0.0), (91.0, 15.0), (13.0, -70.0)])
def test_ink_of_pictures_is_what_was_asked_for(pitch, angle, crisp):
    for dark in RAMP:
        look = dict(tone_1="IMAGE", tone_1_image="tile", tone_1_pitch=pitch, tone_1_angle=angle, tone_crisp=crisp)
        assert abs(flat(dark, **look).mean() - dark) < 0.01, dark


def test_a_black_picture_is_inked_by_chance():
    black = np.zeros((2, 3, 1), np.float32)
    for dark in (0.2, 0.4, 0.6, 0.8):
        ink = flat(dark, (48, 72), tile=black, tone_1="IMAGE", tone_1_image="tile", tone_1_pitch=24.0, tone_1_angle=0.0)
        assert abs(ink.mean() - (thresholds(black, 24.0) < dark).mean()) < 0.02


@pytest.mark.parametrize("amount, inks", [(0.7, (0, 0, 0.18, 0.76, 0.97)), (1.0, (0.03, 0.2, 0.72, 0.99, 1)),
                                          (None, (0.1, 0.25, 0.5, 0.75, 0.9))])
def test_ink_of_grain_is_what_the_page_says(amount, inks):
    """docs/tones.md, as a cubic tells for what is asked for where no amount is given."""
    for dark, ink in zip((0.1, 0.25, 0.5, 0.75, 0.9), inks, strict=True):
        own = amount or ((1.021 * dark - 1.735) * dark + 0.21) * dark + 1.078
        assert abs(flat(dark, tone_1="GRAIN", hatch_amount=own).mean() - ink) < 0.01, dark


@pytest.mark.parametrize("kind, down", [("DOTS", (-0.001, 0.017)), ("DOTS", (0.005, 0.015)), ("DOTS", (0.009, 0.009)),
                                        ("LINES", (-0.001, 0.017)), ("CROSS", (-0.001, 0.017)),
                                        ("IMAGE", (-0.001, 0.017))])
def test_ink_on_surfaces_is_what_was_asked_for_at_any_distance(kind, down):
    """From where a pitch is 2^m on to where it is 2^(m + 1); planes across the up axis cut walls."""
    size = 300, 300
    for k in range(5):
        anchor = slanted(size, down, 2 ** (k / 5), wall=kind in ("LINES", "CROSS"))
        for dark in RAMP:
            ink = flat(dark, size, anchor, tone_1=kind, tone_1_space="SURFACE", tone_1_angle=20.0, tone_1_image="tile",
                       **(dict(tone_1_pitch=24.0) if kind == "IMAGE" else {}))
            assert abs(ink.mean() - dark) < (0.03 if kind == "IMAGE" else 0.01), (k, dark)


@pytest.mark.parametrize("kind, off, look", [
    ("DOTS", 0.03, dict(space="OBJECT")), ("LINES", 0.01, dict(space="OBJECT")), ("CROSS", 0.01, dict(space="OBJECT")),
    ("IMAGE", 0.01, dict(space="OBJECT", pitch=60.0)), ("HATCH", 0.04, dict(space="OBJECT")),
    ("HATCH", 0.03, dict(space="SURFACE")), ("HATCH", 0.04, dict(space="SURFACE", strokes="LIGHT")),
    ("STIPPLE", 0.03, dict(space="OBJECT")), ("STIPPLE", 0.02, dict(space="SURFACE"))])
def test_ink_that_sticks_is_what_was_asked_for_near_and_far(kind, off, look):
    """As if painted on: a pitch of 8 hundredths of a unit, from 32 pixels on to 4."""
    size, strokes = (300, 300), look.get("strokes", "FORM")
    own = dict(pitch=8.0, angle=20.0, image="tile") | {id_: value for id_, value in look.items() if id_ != "strokes"}
    for scale in (0.25, 0.7, 2.0):
        anchor = slanted(size, (0.005, 0.015), scale, wall=kind != "DOTS")
        for dark in RAMP:
            ink = flat(dark, size, anchor, tone_strokes=strokes, **sticks.tone(kind, **own))
            ink = ink[60:-60, 60:-60] if kind in ("HATCH", "STIPPLE") else ink
            assert abs(ink.mean() - dark) < off, (scale, dark, ink.mean())


@pytest.mark.parametrize("pitch", [4.0, 12.0])
def test_dots_painted_on_the_ground_are_no_moire_far_away(pitch):
    """Rows of dots a pixel or two high, slanted to those of pixels, were bands and had a tenth less ink."""
    height, width, pixel = 200, 320, 0.001
    y, x = np.mgrid[:height, :width]
    far = 1.6 / (pixel * (y + 12.0))
    anchor = np.zeros((height, width, 16), np.float32)
    anchor[..., 0], anchor[..., 1], anchor[..., 5] = (x - width / 2) * pixel * far, far, 1
    anchor[..., 6] = anchor[..., 7] = pixel * far
    anchor[..., 10:12] = -anchor[..., :2] / (y + 12.0)[..., None]
    for dark in (0.2, 0.5):
        ink = flat(dark, (height, width), anchor, **sticks.tone("DOTS", space="OBJECT", pitch=pitch, angle=35.0))
        blocks = ink[:192].reshape(12, 16, 20, 16).mean((1, 3)) - dark
        assert np.sqrt((blocks**2).mean(1)).max() < 0.01 and abs(ink.mean() - dark) < 0.005, (dark, ink.mean())


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "CROSS"])
def test_an_octave_ends_as_the_next_begins(kind):
    """Nothing pops: of two pictures a hair apart in scale hardly a pixel differs."""
    size = 120, 120
    y, x = np.mgrid[:size[0], :size[1]]
    drawn = []
    for pixel in (2**-7 * (1 - 1e-5), 2**-7 * (1 + 1e-5)):
        anchor = np.zeros((*size, 16), np.float32)
        anchor[..., 1], anchor[..., 2] = x * pixel, y * pixel
        anchor[..., 3], anchor[..., 6], anchor[..., 8], anchor[..., 12] = 1, pixel, pixel, pixel
        drawn.append(flat(0.4, size, anchor, tone_1=kind, tone_1_space="SURFACE", tone_1_pitch=8.0, tone_1_angle=0.0))
    assert drawn[0].std() > 0.2 and np.abs(drawn[0] - drawn[1]).max() < 0.1


@pytest.mark.parametrize("motion, corr, pop", [("pan", 0.98, 0.001), ("zoom", 0.91, 0.015), ("turn", 0.97, 0.008)])
def test_pictures_stick_to_what_moves(motion, corr, pop):
    values = {**sticks.RAMP, **sticks.tone("IMAGE", space="SURFACE", pitch=90.0, image="tile")}
    found, pops, ink = sticks.followed(values, sticks.MOTIONS[motion][:3], lambda _: tile(90, 90))
    assert found > corr and pops < pop and ink < 0.03, (found, pops, ink)


@pytest.mark.parametrize("name, motion, corr, pop", [
    ("hatching", "pan", 0.97, 0.004), ("hatching", "zoom", 0.88, 0.006), ("stipple", "turn", 0.97, 0.004),
    ("dots", "pan", 0.985, 0.002), ("dots", "zoom", 0.93, 0.003), ("dots", "turn", 0.97, 0.003),
    ("flat dots", "zoom", 0.93, 0.003),
    ("lines", "pan", 0.995, 0.001), ("lines", "zoom", 0.95, 0.001), ("lines", "turn", 0.97, 0.001)])
def test_tones_stick_to_what_moves(name, motion, corr, pop):
    found, pops, ink = sticks.followed(sticks.SCREENS[name], sticks.MOTIONS[motion][:3])
    assert found > corr and pops < pop and ink < 0.1, (found, pops, ink)


def test_frames_alone_and_in_sequence_are_the_same_bytes():
    """Every tone, every pen, by example and papers: what a context keeps from the frames before leaves no trace,
    whichever they were."""
    size = 96, 60
    kinds, spaces = "SOLID DOTS LINES CROSS GRAIN IMAGE HATCH STIPPLE", "SCREEN SURFACE OBJECT FLAT"
    screens = [sticks.tone(kind, space=space, pitch=8.0, image="tile")
               for kind, space in itertools.product(kinds.split(), spaces.split())]
    looks = [*(ALONE | sticks.RAMP | screen for screen in screens),
             *(hands.PLAIN | pen | dict(pen_1_hold=2) for pen in hands.PENS.values()),
             ALONE | dict(use_tones=False, use_example=True, example_ball="IMAGE", example_image="ball"),
             *(dict(paper_seed=seed, use_tones=True) for seed in range(2))]
    poses = [sticks.posed(pan=0.03 * k, turn=0.1 * k) for k in range(2)]
    frames = [(number, sticks.layers_of(*pose, size)[0], Camera(pose[1][:3, :3].ravel()), look)
              for number, pose in enumerate(poses) for look in looks]

    def drawn(number, layers, camera, look):
        return library.render(layers, look, camera=camera, frame=Frame(*size, number=number),
                              image=lambda chosen: TILE).images["Combined"].tobytes()

    alone = []
    for one in frames:
        library.load().forget()
        alone.append(drawn(*one))
    assert len(set(alone)) > 1.6 * len(looks)
    order = list(range(len(frames)))
    for k in (*order, *reversed(order), *np.random.default_rng(0).permutation(order)):
        assert drawn(*frames[k]) == alone[k], frames[k]
