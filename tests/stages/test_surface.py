# SPDX-License-Identifier: GPL-3.0-or-later
"""Shading, smudging, hatching and the paper against tests/reference/, and against themselves cut up in other ways."""

import ctypes
import struct

import masks
import numpy as np
import pytest
from encre.pen import library, presets
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame
from encre.pen.library import load
from hypothesis import given, settings
from hypothesis import strategies as st
from randomly import CONTROLS, random_layers
from reference import render as reference

# Edges between objects alone are the same in float32 and float64, so that smudging can be judged everywhere.
SIMPLE = dict(use_lines=False, line_inner_strength=0, line_crease_strength=0, length_unit="PIXELS")
ONLY_SHADING = dict(SIMPLE, use_smudging=False, use_hatching=False)
ONLY_SMUDGING = dict(SIMPLE, use_shading=False, use_hatching=False)
ONLY_HATCHING = dict(SIMPLE, use_shading=False, use_smudging=False)
TONES = [(0.2, 0.9, 0.8, 1.0), (0.6, 0.3, 0.4, 1.0, 0.9, 0.8), (0.9, 0.8, 0.2, 1.0, 0.9, 0.8), (1.3, 1.1, 0)]
STYLES = [
    dict(shade_levels=TONES, shade_tint=(0.2, 0.5, 0.9), shade_tint_weight=0.4, shade_saturation=0.3,
         shade_exposure=1.3, shade_strength=0.8, hatch_amount=1.2, hatch_color=(0.3, 0.1, 0.0),
         smudge_range=25.0, smudge_pick=3.0, smudge_falloff=0.2, smudge_curve=2.0),
    dict(use_shading=False, hatch_color_threshold=0.9, hatch_light_threshold=0.0, smudge_depth=0.4, smudge_curve=0.5),
]
SIZES = [(89, 257), (1, 1), (1, 40), (40, 1)]


def draw(layers, scene, styles=(), image=None, **how):
    how.setdefault("outputs", ("Combined", "Encre Light"))
    if image is not None:
        scene = dict(scene, paper_source="IMAGE", paper_image="grain.png")
    return masks.render(layers, scene, styles, image=lambda path: image, **how).images


def assert_agrees(layers, scene, styles=(), image=None, camera=None, frame=None, tolerance=2e-5):
    expected = reference(
        layers, scene if image is None else dict(scene, paper_source="IMAGE", paper_image=image), styles,
        camera and vars(camera), frame and vars(frame))
    got = draw(layers, scene, styles, image, camera=camera, frame=frame)
    sure = ~expected["unsure"]
    assert sure.mean() > 0.95
    for name in ("Combined", "Encre Light"):
        np.testing.assert_allclose(got[name][sure], expected[name][sure], rtol=1e-5, atol=tolerance, err_msg=name)


# ---- against the reference

@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("scene", [
    ONLY_SHADING,
    dict(ONLY_SHADING, surface="PAPER", paper_color=(0.9, 0.8, 0.7), other_light=0.3),
    dict(ONLY_SHADING, other_light=0.4, shade_strength=0.3, shade_tint_weight=0.0),
    dict(ONLY_SHADING, shade_levels=[(0.7,)]),
    dict(ONLY_SHADING, light_hue=0.0),
    dict(ONLY_SHADING, light_hue=0.4, other_background=0.3,
         other_highlights=1.7, other_reflections=0.2, other_glow=0.6),
    dict(ONLY_SHADING, surface="PAPER", highlight_shape=0.8, highlight_color=(0.9, 0.7, 0.2), other_background=0.0),
    dict(ONLY_SHADING, highlight_shape=1.0, other_light=0.5),
    ONLY_SMUDGING,
    dict(ONLY_SMUDGING, smudge_range=64.0, smudge_pick=20.0, smudge_falloff=1.0),
    dict(ONLY_SMUDGING, smudge_range=40.0, smudge_pick=0.0, smudge_depth=0.0, length_unit="RELATIVE"),
    ONLY_HATCHING,
    dict(ONLY_HATCHING, hatch_color_light=0.0),
    dict(ONLY_HATCHING, hatch_color_light=1.0, shade_levels=TONES),
    dict(ONLY_HATCHING, paper_source="NONE", hatch_amount=2.0),
    dict(ONLY_HATCHING, hatch_color_threshold=0.0, hatch_color=(0.2, 0.4, 0.6), paper_scale=2.7),
    SIMPLE,
])
def test_agrees_with_the_reference(scene, size):
    assert_agrees(random_layers(*size), scene, STYLES)


def test_agrees_without_optional_layers():
    layers = {name: a for name, a in random_layers(40, 64).items() if name not in
              ("specular", "highlights", "background", "controls", "style")}
    assert_agrees(layers, SIMPLE)
    assert_agrees(layers, dict(ONLY_SHADING, other_background=0.2, other_reflections=0.5, highlight_shape=0.6))


@pytest.mark.parametrize("scene", [dict(reflection_tones=4), dict(reflection_tones=3, surface="PAPER", other_light=0.6),
                                   dict(reflection_tones=7, other_background=0.3, other_reflections=0.4)])
def test_metals_mirror_flat_tones(scene):
    layers = random_layers(40, 64)
    rng = np.random.default_rng(4)
    layers["gloss"] = np.float32(rng.uniform(0, 0.9, (40, 64, 3)) * rng.choice((0, 0.1, 1), (40, 64, 1)))
    assert_agrees(layers, dict(ONLY_SHADING, **scene), [{}, dict(reflection_tones=0)])
    if "surface" not in scene:
        light = np.float32(np.linspace(0, 1, 500)).reshape(1, -1, 1) * np.ones(3, np.float32)
        chrome = dict(combined=np.concatenate([light, np.ones_like(light[..., :1])], -1), color=0 * light,
                      diffuse=0 * light, depth=1 + 0 * light[..., :1], normal=light, gloss=0 * light + 0.9)
        seen = draw(chrome, dict(ONLY_SHADING, reflection_tones=scene["reflection_tones"]))["Combined"][0, :, 0]
        tones = (np.arange(scene["reflection_tones"] + 1) / scene["reflection_tones"]) ** 2
        assert (np.abs(seen[:, None] - tones).min(1) < 1e-5).mean() > 0.85 and (np.diff(seen) > -1e-6).all()


def test_agrees_under_an_orthographic_camera():
    assert_agrees(random_layers(60, 90), dict(ONLY_SMUDGING, smudge_depth=0.3), STYLES,
                  camera=Camera(orthographic=True, height=5.0))


def test_full_light_is_that_of_the_strongest_lamp():
    assert_agrees(random_layers(40, 64), dict(SIMPLE, shade_meter="LAMPS", use_tones=True, tone_1="DOTS"), STYLES,
                  camera=Camera(light=0.6), tolerance=1e-4)
    layers, lit = random_layers(40, 64), Camera(light=4.0)
    exposed = draw(layers, dict(SIMPLE, shade_exposure=0.25))["Combined"]
    np.testing.assert_array_equal(draw(layers, dict(SIMPLE, shade_meter="LAMPS"), camera=lit)["Combined"], exposed)
    for as_lit in (Camera(), Camera(light=1e-38)):
        np.testing.assert_array_equal(draw(layers, dict(SIMPLE, shade_meter="LAMPS"), camera=as_lit)["Combined"],
                                      draw(layers, SIMPLE)["Combined"])
    with pytest.raises(EncreError, match="light of -1"):
        draw(layers, SIMPLE, camera=Camera(light=-1.0))


def test_a_highlight_is_a_share_of_the_light_and_none_at_a_grazing_angle():
    scene = dict(ONLY_SHADING, highlight_shape=1.0, shade_meter="LAMPS")
    assert_agrees(random_layers(40, 64), scene, STYLES, camera=Camera(light=2.5), tolerance=1e-4)
    layers = random_layers(1, 4)
    layers["controls"][:], layers["style"][:], layers["color"][:], layers["combined"][..., 3] = 0, 0, 0, 1
    for bright, light, lit, facing, shown in ((1.6, 0.2, 0, 1, 1), (1.6, 1, 0, 1, 1), (1.6, 4, 0, 1, 0),
                                              (1.6, 1, 0, 0.6, 1), (1.6, 1, 0, 0.3, 0), (1.6, 1, 1.5, 1, 1),
                                              (1.6, 1, 4, 1, 0), (0.6, 1, 0, 1, 0)):  # the last: cloth by a lamp
        layers["highlights"][:] = layers["specular"][:] = layers["combined"][..., :3] = bright
        layers["diffuse"][:], layers["normal"][:] = lit, (np.sqrt(1 - facing**2), 0, facing)
        drawn = draw(layers, scene, camera=Camera(light=light))["Combined"][..., :3]
        np.testing.assert_allclose(drawn, shown, atol=1e-5)


@pytest.mark.parametrize(("given", "camera"), [
    (dict(shade_meter="LAMPS"), Camera(light=0.6, shade=0.4)),
    (dict(shade_meter="LAMPS"), Camera(light=0.9, shade=0.1)),
    (dict(shade_meter="FIXED", meter_light=0.6, meter_shade=0.4), Camera(light=5.0))])
def test_shade_is_seen_as_shade(given, camera):
    scene = dict(SIMPLE, use_tones=True, tone_1="DOTS", tone_mirrors=True, tone_sky=0.4, use_hatching=True, **given)
    assert_agrees(random_layers(40, 64), scene, STYLES, camera=camera, tolerance=1e-4)


def test_light_grows_evenly_up_to_shade_and_on_to_full_light():
    light = np.linspace(0, 2, 81, dtype=np.float32)
    layers = random_layers(1, 81)
    layers["diffuse"][:] = light[None, :, None]
    layers["controls"][:], layers["style"][:] = 0, 0
    given = dict(ONLY_SHADING, shade_levels=[(0.0,), (1.0, 0.5, 1.0)], shade_tint_weight=0, shade_saturation=1,
                 light_hue=0)
    layers["color"][:], layers["combined"][..., :3], layers["combined"][..., 3] = 1, light[None, :, None], 1
    drawn = draw(layers, dict(given, shade_meter="FIXED", meter_light=1.5, meter_shade=1.0))["Combined"][0, :, 0]
    right = np.where(light < 1, 0.35 * light, 0.35 + 0.65 * (light - 1) / 0.5)
    np.testing.assert_allclose(drawn, np.minimum(right, 1), atol=1e-5)
    with pytest.raises(EncreError, match="meter_shade: shade of 2"):
        draw(layers, dict(given, shade_meter="FIXED", meter_light=1.5, meter_shade=2.0))
    with pytest.raises(EncreError, match="shade of 2"):
        draw(layers, given, camera=Camera(light=1.0, shade=2.0))


def test_lengths_follow_the_height_of_the_full_frame():
    assert_agrees(random_layers(60, 90), dict(SIMPLE, length_unit="RELATIVE", smudge_range=30, paper_scale=1.6), STYLES,
                  frame=Frame(400, 700, 31, 45), tolerance=1e-4)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_levels(data):
    number = st.floats(0, 2, width=32)
    levels, end = [(data.draw(number),)], 0.0
    for _ in range(data.draw(st.integers(0, 15))):
        transition = data.draw(st.one_of(st.just(0.0), st.floats(0.01, 0.5)))
        threshold = end + transition / 2 + data.draw(st.floats(0.001, 0.3))
        end = threshold + transition / 2
        levels.append((data.draw(number), threshold, transition, *(data.draw(number) for _ in range(3))))
    light = np.linspace(-0.1, 1.1 * end + 0.5, 500, dtype=np.float32).reshape(1, -1, 1) * np.float32([1, 0.9, 0.4])
    layers = dict(random_layers(1, 500), diffuse=light)
    del layers["style"]
    assert_agrees(layers, dict(ONLY_SHADING, shade_levels=levels, shade_tint_weight=0.7), tolerance=1e-4)


def test_painted_light_is_half_of_full_light_more_or_less():
    """A control of 1 lights .3 up over a threshold of .75, and not .2; -1 takes as much; and of .5 half."""
    light = np.float32([0.2, 0.3, 1.2, 1.3, 0.45, 0.55])[None, :, None] * np.ones((3, 1, 3), np.float32)
    one, painted = np.ones_like(light[..., :1]), np.zeros((3, 6, CONTROLS), np.float32)
    painted[..., list(library.controls()).index("light")] = [1, 1, -1, -1, 0.5, 0.5]
    layers = dict(combined=np.concatenate([light, one], -1), color=np.ones_like(light), diffuse=light, depth=one,
                  normal=np.ones_like(light))
    scene = dict(ONLY_SHADING, shade_levels=[(0.25,), (1.0, 0.75, 0.0)])
    lit = draw(dict(layers, controls=painted), scene)["Combined"][..., 0] > 0.5
    assert (lit == [False, True, False, True, False, True]).all()
    lit = draw(layers, scene)["Combined"][..., 0] > 0.5
    assert (lit == [False, False, True, True, False, False]).all()


@pytest.mark.parametrize("slider", ["other_background", "other_highlights", "other_reflections", "other_glow"])
def test_with_all_of_what_is_not_diffuse_at_1_layers_of_its_parts_change_nothing(slider):
    layers, ones = random_layers(40, 64), dict(other_background=1.0, other_highlights=1.0, other_reflections=1.0,
                                               other_glow=1.0)
    parts = {name: layers[name] for name in ("specular", "highlights", "background")}
    plain = {name: a for name, a in layers.items() if name not in parts}
    for scene in ONLY_SHADING, dict(ONLY_SHADING, other_light=0.4):
        whole = draw(plain, scene)["Combined"]
        assert draw(layers, dict(scene, **ones))["Combined"].tobytes() == whole.tobytes()
        assert np.abs(draw(layers, {**scene, **ones, slider: 0.5})["Combined"] - whole).max() > 0.01


def test_a_dim_wall_is_no_black_grain_in_water_memory():
    """The paper's highest crumbs were black there; what is darkest is hatched."""
    values = presets.find("Water Memory").values | dict(light_source="CYCLES", use_lines=False)
    one = np.ones((270, 480, 3), np.float32)

    def black(light):
        layers = dict(color=0.3 * one, diffuse=light * one, depth=one[..., :1], normal=one,
                      combined=np.concatenate([light * 0.3 * one, one[..., :1]], 2))
        drawn = {on: library.render(layers, values | dict(use_hatching=on)).images["Combined"][..., :3].mean(2)
                 for on in (False, True)}
        return (drawn[True] < 0.4 * drawn[False]).mean()

    assert black(0.15) < 0.01 and black(0.02) > 0.5


def test_dark_colours_keep_their_levels_apart():
    """A black coat under rising light: without help it is black all over, with it each level is lighter."""
    light = np.repeat(np.float32([0.3, 0.6, 1.2]), 40).reshape(1, -1, 1) * np.ones((40, 1, 3), np.float32)
    color = np.full_like(light, 0.02)
    layers = dict(combined=np.concatenate([color * light, np.ones_like(light[..., :1])], -1), color=color,
                  diffuse=light, depth=np.full_like(light[..., :1], 4), normal=np.ones_like(light))
    alone = dict(use_lines=False, use_smudging=False, hatch_amount=0.7)

    def bands(**scene):
        picture = draw(layers, {**alone, **scene})["Combined"][..., 0]
        return [picture[:, 40 * k:40 * k + 40].mean() for k in range(3)]

    flat = bands(use_hatching=False)
    black, kept = bands(hatch_color_light=0.0), bands()
    assert max(black) < 0.1 * flat[2]
    assert kept[0] < 0.3 * kept[1] < 0.3 * kept[2] and kept[2] > 0.8 * flat[2]


# ---- against themselves

NASTY = [np.nan, np.inf, -np.inf, 3e38, -3e38, 1e-40, -1e-40, 0.0, 1e9, 1e10]


def nasty_layers(height, width, values=NASTY):
    rng = np.random.default_rng(7)
    layers = random_layers(height, width)
    for a in layers.values():
        at = rng.random(a.shape) < 0.2
        a[at] = rng.choice(np.float32(values), a.shape)[at]
    return layers


@pytest.mark.parametrize("layers", [random_layers(89, 257), nasty_layers(89, 257)], ids=["noise", "nasty"])
@pytest.mark.parametrize("scene", [SIMPLE, dict(SIMPLE, surface="PAPER", paper_scale=1.7)], ids=["shaded", "paper"])
def test_bytes_depend_on_neither_threads_nor_instructions(layers, scene):
    expected = draw(layers, scene, STYLES, threads=1, simd=1)
    for threads, simd in ((2, 1), (3, 1), (8, 1), (1, 0), (3, 0)):
        for name, image in draw(layers, scene, STYLES, threads=threads, simd=simd).items():
            assert image.tobytes() == expected[name].tobytes(), (name, threads, simd)


@pytest.mark.parametrize("scene", [ONLY_SHADING, ONLY_HATCHING, dict(SIMPLE, surface="PAPER", highlight_shape=0.7)],
                         ids=["shading", "hatching", "paper"])
def test_any_width_is_part_of_a_wider_one(scene):
    """Rows are worked on in vectors and in pieces of 256 pixels; what is left over of them is as the rest. But for the
    last column: a step of light goes by what lies to its right."""
    layers, frame = nasty_layers(3, 531), Frame(900, 700, 11, 6)
    scene = dict(scene, use_smudging=False)
    whole = draw(layers, scene, STYLES, frame=frame)
    for width in (2, 8, 9, 10, 16, 17, 18, 32, 34, 256, 257, 258, 512, 514):
        part = draw({name: a[:, :width] for name, a in layers.items()}, scene, STYLES, frame=frame)
        for name, image in part.items():
            assert image[:, :-1].tobytes() == whole[name][:, :width - 1].tobytes(), (name, width)


def test_nothing_comes_out_infinite():
    image = np.random.default_rng(1).choice(np.float32(NASTY), (9, 5, 3))
    extremes = dict(SIMPLE, shade_exposure=3e38, shade_tint_weight=3e38, hatch_amount=3e38, paper_roughness=3e38,
                    shade_tint=(3e38, 0, 1), hatch_color=(3e38, 1, 0), paper_color=(3e38, 1, 0), smudge_depth=3e38)
    for scene in (SIMPLE, extremes, dict(extremes, surface="PAPER")):
        for grain in (None, image):
            for name, out in draw(nasty_layers(70, 130), scene, STYLES, grain).items():
                assert np.isfinite(out).all(), name


def test_shading_off_leaves_the_image_as_it_is():
    layers = random_layers(40, 64)
    for scene, styles, there in [
        (dict(ONLY_SHADING, use_shading=False, use_hatching=True, hatch_amount=0.0), (), True),
        (dict(ONLY_SHADING, shade_strength=0.0), STYLES, layers["style"][..., 0] == 2),
        (dict(ONLY_SHADING), (), layers["combined"][..., 3] == 0),
    ]:
        same = (draw(layers, scene, styles)["Combined"].view(np.uint32) == layers["combined"].view(np.uint32)).all(-1)
        assert same[there].all()


def test_the_scene_smudges_as_far_without_another_style():
    layers = random_layers(30, 40)
    layers["style"][:] = 0
    alone, beside = (draw(layers, ONLY_SMUDGING, styles)["Combined"] for styles in ((), [{}]))
    assert alone.tobytes() == beside.tobytes() and np.abs(alone - layers["combined"]).max() > 0.1


@pytest.mark.parametrize("threads", [1, 3])
def test_all_off_copies_in_one_pass_what_the_stages_would_copy(threads):
    layers = dict(random_layers(40, 64), combined=np.float32(np.random.default_rng(5).normal(size=(40, 80, 4))))
    layers["combined"][3, 25:29, :3] = np.nan, np.inf, -np.inf
    layers["combined"] = layers["combined"][::-1, 8:72]  # rows upwards, with gaps between them
    layers["diffuse"][2, 2] = np.nan
    off, names = dict(ONLY_SHADING, use_shading=False), ["Combined", "Encre Surface", "Encre Lines"]
    styles = [{"line_thickness": 30.0}, {"shade_strength": 0.5}]
    drawn = library.render(layers, off, styles, outputs=names + ["Encre Edges"], threads=threads)
    copied = library.render(layers, off, styles, outputs=names, threads=threads)
    for name in names:
        assert copied.images[name].tobytes() == drawn.images[name].tobytes()
    clean = np.where(np.isfinite(layers["combined"]), layers["combined"], 0)
    assert copied.images["Combined"].tobytes() == np.float32(clean).tobytes() and not copied.images["Encre Lines"].any()
    assert (copied.nonfinite, drawn.nonfinite) == (12, 15)  # of the layers that are read
    assert library.render(layers, off, outputs=["Encre Lines"], threads=threads).nonfinite == 12
    apart = dict(layers, combined=np.repeat(layers["combined"], 2, 1)[:, ::2])  # gaps between pixels
    assert library.render(apart, off, outputs=["Encre Lines"], threads=threads).nonfinite == 12
    assert library.render(layers, off, [{"use_hatching": True}], threads=threads).nonfinite == 15


def test_light_is_given_where_shading_is_off_and_nothing_is_there():
    layers = random_layers(40, 64)
    on = draw(layers, ONLY_SHADING)["Encre Light"]
    off = draw(layers, dict(ONLY_SHADING, use_shading=False, use_hatching=True))["Encre Light"]
    np.testing.assert_array_equal(on, off)
    assert on.std() > 0.1


def test_a_flat_tone_is_flat():
    rng = np.random.default_rng(2)
    diffuse = np.repeat(rng.uniform(0.6, 0.8, (30, 40, 1)), 3, -1).astype(np.float32)
    ones = np.ones((30, 40, 3), np.float32)
    layers = dict(combined=np.concatenate([diffuse * 0.5, ones[..., :1]], -1), color=ones * 0.5, diffuse=diffuse,
                  depth=ones[..., :1], normal=ones)
    picture = draw(layers, ONLY_SHADING)["Combined"][..., :3]
    assert np.ptp(picture.reshape(-1, 3), axis=0).max() < 1e-6


# ---- smudging

def two_halves(width=40, edge=20):
    """A near red surface on the left of a far blue one; the edge pixels are columns edge - 1 and edge."""
    x = np.broadcast_to(np.arange(width), (9, width))[..., None]
    left = x < edge
    ones = np.ones((9, width, 1), np.float32)
    rgba = np.where(left, (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 0.5)).astype(np.float32)
    return dict(combined=rgba, color=rgba[..., :3], diffuse=np.repeat(ones, 3, -1), normal=np.repeat(ones, 3, -1),
                depth=np.where(left, 2.0, 3.0).astype(np.float32), object=left.astype(np.float32))


def painted(layers, smudge_range, falloff):
    controls = np.zeros((*layers["depth"].shape[:2], CONTROLS), np.float32)
    controls[..., 3], controls[..., 4] = smudge_range, falloff
    return dict(layers, controls=controls)


@pytest.mark.parametrize("reach", [1.0, 0.5, -0.5, -1.0])
def test_colour_runs_over_the_edge(reach):
    """Colour from behind runs into the near surface, or that of the near one over what is behind."""
    layers = painted(two_halves(), reach, 1.0)
    scene = dict(ONLY_SMUDGING, smudge_range=10.0, smudge_falloff=0.0)
    share = draw(layers, scene)["Combined"][4, :, 2 if reach > 0 else 0]
    distance = 19 - np.arange(40) if reach > 0 else np.arange(40) - 20
    side = (distance > 0) & (distance <= 10 * abs(reach))
    expected = np.where(side, 1 - distance / (10 * abs(reach)), 0)
    own = layers["combined"][4, :, 2 if reach > 0 else 0]
    np.testing.assert_allclose(share, np.where(side, expected, own), atol=1e-6)


def test_the_reach_is_sharp():
    """A range of 1 reaches the pixel beside the edge; one of 0.99 reaches none."""
    for reach, reached in ((1.0, 1), (0.99, 0)):
        layers = painted(two_halves(), 1.0, 1.0)
        picture = draw(layers, dict(ONLY_SMUDGING, smudge_range=reach, smudge_falloff=0.5))["Combined"]
        assert (picture != layers["combined"]).any(-1)[4].sum() == reached


def test_unpainted_pixels_keep_every_bit():
    layers = random_layers(50, 70)
    layers["controls"][:, :35, 3] = 0
    off = draw(layers, dict(ONLY_SHADING), STYLES)["Combined"]
    on = draw(layers, dict(ONLY_SHADING, use_smudging=True), STYLES)["Combined"]
    assert off[:, :35].tobytes() == on[:, :35].tobytes()
    assert (off[:, 35:] != on[:, 35:]).any()


# ---- what is refused

@pytest.mark.parametrize("levels, words", [
    ([(0.5,), (0.7, 0.5, 0.2), (1.1, 0.6, 0.2)], "levels 2 and 3 overlap; move thresholds 0.5 and 0.6 apart"),
    ([(0.5,), (0.7, 0.5, 0.2), (1.1, 0.6999981, 0.2)], "overlap"),
    ([(0.5,), (0.7, 0.5, 0.0), (1.1, 0.4, 0.0)], "threshold 0.4 of level 3 lies under 0.5 .*; give darkest first"),
    ([(0.5,)] + [(1.0, k, 0.0) for k in range(16)], "16"),
    ([], "16"),
    ([(0.5,), (-0.7, 0.5, 0.2)], "0 or more"),
    ([(0.5,), (0.7, 0.5, -0.2)], "0 or more"),
    ([(0.5,), (0.7, np.nan, 0.2)], "level 2 has|0 or more|finite"),
])
def test_levels_that_make_no_sense(levels, words):
    with pytest.raises(EncreError, match=words) as error:
        library.check(dict(shade_levels=levels))
    assert "shade_levels" in str(error.value) and "\n" not in str(error.value)


def test_levels_that_touch():
    library.check(dict(shade_levels=[(0.5,), (0.7, 0.3, 0.2), (1.1, 0.5, 0.2), (1.2, 0.6, 0.0), (1.3, 0.6, 0.0)]))
    library.check(dict(shade_levels=[(0.5,), (0.7, 0.5, 0.2), (1.1, 0.6999988, 0.2)]))


@pytest.mark.parametrize("count, words", [(0, b"give 1 to 16"), (17, b"give 1 to 16")])
def test_the_library_counts_levels_itself(count, words):
    library = load()
    block = library.pack({})[0]
    struct.pack_into("i", block, library.params["shade_levels"].offset, count)
    assert words in library.lib.encre_params_check(block, ctypes.create_string_buffer(400), 400)


@pytest.mark.parametrize("channel", range(3))
@pytest.mark.parametrize("wrong", [-1e-6, np.inf, np.nan])
def test_the_library_looks_at_the_colours_of_levels_itself(channel, wrong):
    library = load()
    block = library.pack({})[0]
    struct.pack_into("f", block, library.params["shade_levels"].offset + 4 + 12 + 4 * channel, wrong)
    assert b"level 1 has" in library.lib.encre_params_check(block, ctypes.create_string_buffer(400), 400)
