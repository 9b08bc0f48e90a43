# SPDX-License-Identifier: GPL-3.0-or-later
"""Tones against tests/reference/tones.py, against the ink that was asked for, and how they stick to surfaces."""

import numpy as np
import pytest
import sticks
from encre.pen import library
from encre.pen.job import Frame
from encre.pen.settings import Settings
from reference import render as reference

CONTROLS = len(library.controls())

ALONE = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, use_tones=True,
             length_unit="PIXELS")
LEVELS = [(0.15,), (0.5, 0.3, 0.2), (0.8, 0.7, 0.0), (1.1, 1.0, 0.1)]
STYLES = [dict(tone_1="CROSS", tone_2="GRAIN", tone_3="GRAIN", tone_4="DOTS", tone_1_space="SURFACE",
               tone_4_space="SURFACE", tone_1_pitch=9.0, tone_1_gradient=0.7, tone_hardness=0.4, tone_3_gradient=1.0,
               tone_2_color=(0.4, 0.1, 0.0), tone_darkness=0.2, tone_black=0.6),
          dict(tone_1="SOLID", tone_2="LINES", tone_3="LINES", tone_4="LINES", tone_2_angle=-20.0, tone_3_angle=-20.0,
               tone_3_gradient=0.5),
          dict(use_tones=False)]


def stuck(width, height, seed=0):
    """Layers of the scene that `sticks` draws, with noise in what tones read besides."""
    rng = np.random.default_rng(seed)
    meshes, view, projection = sticks.posed(turn=0.3)
    maps = library.raster(meshes, view, projection, Frame(width, height), (width, height), 0.1,
                          outputs=("depth", "object", "shading", "anchor"))
    color, diffuse = rng.uniform(0, 1, (height, width, 3)), rng.uniform(0, 1.3, (height, width, 3))
    alpha = rng.uniform(0.2, 1, (height, width, 1))
    combined = np.concatenate([color * diffuse + rng.uniform(-0.1, 0.2, color.shape), alpha], 2)
    layers = dict(combined=combined, color=color, diffuse=diffuse, depth=maps["depth"], normal=maps["shading"],
                  object=maps["object"], anchor=maps["anchor"], style=rng.integers(0, 4, (height, width)),
                  controls=rng.uniform(-0.5, 0.5, (height, width, CONTROLS)), specular=rng.uniform(0, 0.4, color.shape))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


@pytest.mark.parametrize("kind", ["SOLID", "DOTS", "LINES", "CROSS", "GRAIN"])
@pytest.mark.parametrize("space", ["SCREEN", "SURFACE"])
def test_twin(kind, space):
    width, height = 120, 80
    layers = stuck(width, height)
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone(kind, space=space, pitch=7.3, angle=30.0))
    names = ("Combined", "Encre Tones")
    frame = Frame(200, 160, 31, 20)
    got = library.render(layers, scene, STYLES, frame=frame, outputs=names).images
    want = reference(layers, scene, STYLES, frame=vars(frame))
    for name in names:
        off = np.abs(got[name] - want[name]).max(-1)
        assert (off > 4e-3).mean() < 4e-3, (name, off.max(), (off > 4e-3).mean())
    assert got["Encre Tones"][..., 3].std() > 0.05


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


@pytest.mark.parametrize("kind", ["HATCH", "STIPPLE"])
@pytest.mark.parametrize("space", ["SCREEN", "SURFACE"])
def test_twin_of_strokes(kind, space):
    """With one style: what a stroke of one meets in another's pixels is not told twice."""
    layers = stuck(90, 60)
    layers["diffuse"] = np.ascontiguousarray(np.broadcast_to(np.linspace(0, 1.2, 90, dtype=np.float32)[None, :, None],
                                                             layers["color"].shape))
    layers["combined"][..., :3] = layers["color"] * layers["diffuse"]
    del layers["controls"], layers["style"]
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone(kind, space=space, pitch=8.3, angle=20.0))
    got = library.render(layers, scene, outputs=["Encre Tones"]).images["Encre Tones"][..., 3]
    want = reference(layers, scene, frame=None)["Encre Tones"][..., 3]
    off = np.abs(got - want)
    assert (off > 0.02).mean() < 0.015 and off.mean() < 0.002, ((off > 0.02).mean(), off.mean())
    assert got.std() > 0.2


def test_without_an_anchor_the_screen_is_kept_to():
    layers = stuck(60, 40)
    del layers["anchor"]
    one, two = (library.render(layers, ALONE | sticks.tone("DOTS", space=space)).images["Combined"]
                for space in ("SCREEN", "SURFACE"))
    assert one.tobytes() == two.tobytes()


@pytest.mark.parametrize("space", ["SCREEN", "SURFACE"])
def test_any_width_is_part_of_a_wider_one(space):
    layers, frame, names = stuck(530, 5), Frame(900, 700, 11, 6), ("Combined", "Encre Tones")
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("DOTS", space=space), tone_4_pitch=5.0)
    whole = library.render(layers, scene, STYLES, frame=frame, outputs=names).images
    for width in (1, 7, 8, 9, 15, 16, 17, 31, 33, 255, 256, 257, 511, 513):
        part = library.render({name: a[:, :width] for name, a in layers.items()}, scene, STYLES, frame=frame,
                              outputs=names).images
        assert all(part[name].tobytes() == whole[name][:, :width].tobytes() for name in names), width


@pytest.mark.parametrize("space", ["SCREEN", "SURFACE"])
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
    assert all(np.array_equal(part[name], whole[name][20:50, 33:90]) for name in whole)


def test_strokes_lie_alike_in_every_band_and_part():
    """A part of the frame has those that reach it, if as much around it is there as a stroke is long."""
    layers = {name: a for name, a in stuck(160, 120).items() if name not in ("style", "controls")}
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("HATCH", space="SURFACE", pitch=6.0))

    def drawn(part=np.s_[:, :], frame=None, **how):
        return library.render({name: a[part] for name, a in layers.items()}, scene, frame=frame,
                              outputs=["Encre Tones"], **how).images["Encre Tones"]

    whole = drawn(threads=1)
    for how in (dict(threads=5), dict(simd=0)):
        assert drawn(**how).tobytes() == whole.tobytes(), how
    ring = Settings(scene).reach(120)
    part = drawn(np.s_[20:, 10:150], Frame(160, 120, 10, 20))
    assert ring < 60 and np.array_equal(part[ring:, ring:-ring], whole[20 + ring:, 10 + ring:150 - ring])


def flat(dark, size=(444, 444), anchor=None, **scene):
    """Share of ink on a surface that is as dark everywhere."""
    height, width = size
    one = np.ones((height, width, 3), np.float32)
    layers = dict(combined=np.ones((height, width, 4), np.float32), color=one, diffuse=one, depth=5 * one[..., :1],
                  normal=one)
    if anchor is not None:
        layers["anchor"] = anchor
    ink = library.render(layers, dict(ALONE, shade_levels=[(1 - dark,)], **scene), outputs=["Encre Tones"])
    return ink.images["Encre Tones"][..., 3]


RAMP = (0.05, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 0.95)


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "CROSS"])
@pytest.mark.parametrize("look", [dict(tone_1_pitch=8.0), dict(tone_1_pitch=5.3, tone_1_angle=15.0),
                                  dict(tone_1_pitch=12.0, tone_1_angle=0.0, tone_hardness=0.5),
                                  dict(tone_1_pitch=3.0), dict(tone_1_pitch=37.0)])
def test_ink_on_the_screen_is_what_was_asked_for(kind, look):
    for dark in RAMP:
        assert abs(flat(dark, tone_1=kind, **look).mean() - dark) < 0.01, dark


@pytest.mark.parametrize("kind", ["DOTS", "LINES", "CROSS"])
def test_ink_on_surfaces_is_what_was_asked_for_at_any_distance(kind):
    """A plane that is slanted both ways, from where a pitch is 2^m on to where it is 2^(m + 1)."""
    size = 300, 300
    y, x = np.mgrid[:size[0], :size[1]]
    for k in range(5):
        anchor = np.zeros((*size, 16), np.float32)
        right, down = np.array((0.01, 0.002, 0)) * 2 ** (k / 5), np.array((-0.001, 0.017, 0.0)) * 2 ** (k / 5)
        anchor[..., :3] = x[..., None] * right + y[..., None] * down
        anchor[..., 3:7] = 0, 0, 1, 0.01
        anchor[..., 7:10], anchor[..., 10:13] = right, down
        if kind != "DOTS":  # a wall: planes across the up axis cut it
            anchor = anchor[..., (2, 0, 1, 5, 3, 4, 6, 9, 7, 8, 12, 10, 11, 13, 14, 15)].copy()
        for dark in RAMP:
            ink = flat(dark, size, anchor, tone_1=kind, tone_1_space="SURFACE", tone_1_angle=20.0)
            # dark dots whose rows are not at right angles overlap less than the table thinks
            assert abs(ink.mean() - dark) < (0.04 if kind == "DOTS" and dark > 0.7 else 0.01), (k, dark)


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


@pytest.mark.parametrize("kind, off", [("HATCH", 0.025), ("STIPPLE", 0.045)])
def test_ink_of_strokes_is_what_was_asked_for(kind, off):
    for look in (dict(tone_1_pitch=4.0), dict(tone_1_pitch=8.0, tone_1_angle=0.0)):
        for dark in RAMP:
            ink = flat(dark, tone_1=kind, **look)[70:-70, 70:-70]
            assert abs(ink.mean() - dark) < off, (look, dark, ink.mean())


@pytest.mark.parametrize("name, motion, corr, pop", [
    ("hatching", "pan", 0.97, 0.004), ("hatching", "zoom", 0.88, 0.006), ("stipple", "turn", 0.97, 0.004),
    ("dots", "pan", 0.985, 0.002), ("dots", "zoom", 0.93, 0.003), ("dots", "turn", 0.97, 0.003),
    ("lines", "pan", 0.995, 0.001), ("lines", "zoom", 0.95, 0.001), ("lines", "turn", 0.97, 0.001)])
def test_tones_stick_to_what_moves(name, motion, corr, pop):
    found, pops, ink = sticks.followed(sticks.SCREENS[name], sticks.MOTIONS[motion][:3])
    assert found > corr and pops < pop and ink < 0.1, (found, pops, ink)
