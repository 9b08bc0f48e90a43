# SPDX-License-Identifier: GPL-3.0-or-later
"""Watercolor against tests/reference/, what each of its parts does, how it keeps to things, and cut up."""

import drawn
import masks
import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame
from randomly import random_layers
from reference import render as reference

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, length_unit="PIXELS")
WASH = dict(OFF, use_wash=True)
PLAIN = dict(WASH, wash_pooling=0.0, wash_uneven=0.0, wash_granulation=0.0, wash_gaps=0.0, wash_wobble=0.0,
             wash_wet=0.0, paper_source="NONE", wash_paper=(1.0, 1.0, 1.0))
SHADE, FULL = 0.35, 0.92  # light of either, as it is compared


def draw(layers, scene, styles=(), **how):
    return masks.render(layers, scene, styles, **how).images["Combined"]


def wall(color=(0.6, 0.3, 0.2), light=1.0, size=(60, 90), anchored=None):
    """One color under light of so much, or of so much at each column; perhaps with rest positions."""
    ones = np.ones((*size, 1), np.float32)
    rgb, diffuse = ones * np.float32(color), ones * np.broadcast_to(np.float32(light), size[1])[None, :, None]
    layers = dict(combined=np.concatenate([rgb * diffuse, ones], -1), color=rgb,
                  diffuse=diffuse * np.ones(3, np.float32), depth=5 * ones,
                  normal=ones * np.float32((0, 0, 1)), object=3 * ones)
    if anchored is not None:
        anchor = np.zeros((*size, 16), np.float32)
        y, x = np.mgrid[:size[0], :size[1]]
        pixel, left = anchored
        anchor[..., 0], anchor[..., 1], anchor[..., 5] = pixel * (x + left), -pixel * y, 1
        anchor[..., 6] = anchor[..., 7] = pixel
        anchor[..., 11] = -pixel
        layers["anchor"] = anchor
    return layers


@pytest.mark.parametrize("size", [(59, 97), (1, 1), (1, 40), (40, 1)])
@pytest.mark.parametrize("scene", [
    dict(),
    dict(wash_pooling=3.0, wash_wobble=0.0, wash_seed=7, wash_white=0.3),
    dict(paper_source="NONE", wash_size=2.0, wash_color=0.0, wash_wobble=64.0, wash_density=0.4),
    dict(wash_granulation=1.0, wash_size=1000.0, length_unit="RELATIVE", wash_glaze=(0.0, 0.5, 1.0), wash_wet=1.0,
         wash_paper=(0.9, 0.8, 0.7), use_hatching=True),
])
def test_agrees_with_the_reference(scene, size):
    layers = random_layers(*size)
    rng = np.random.default_rng(1)
    anchor = np.float32(rng.uniform(-1, 1, (*size, 16)))
    anchor[..., 6] = np.where(rng.random(size) < 0.3, 0, rng.uniform(0.01, 0.04, size))
    layers["anchor"] = anchor
    styles = [dict(use_wash=False), dict(wash_pooling=0.2, wash_uneven=3.0, wash_shade=2.0, wash_white=0.5)]
    place = dict(width=900, height=700, x=411, y=333)
    want = reference(layers, dict(WASH, **scene), styles, frame=place)
    sure = ~want["unsure"]
    assert sure.mean() > 0.95
    got = draw(layers, dict(WASH, **scene), styles, frame=Frame(**place))
    np.testing.assert_allclose(got[sure], want["Combined"][sure], atol=2e-3)


def test_brightness_without_bounds_stays_finite():
    layers = random_layers(40, 64)
    layers["combined"][::3, ::5, :3] = 1e38
    layers["combined"][1::3, ::5, :3] = -1e38
    layers["anchor"] = np.full((40, 64, 16), 3e38, np.float32)
    assert np.isfinite(draw(layers, WASH)).all()
    layers["anchor"][:] = 1e-38
    assert np.isfinite(draw(layers, WASH)).all()


def test_paper_stays_white_in_the_light_and_shade_is_cooler_than_it():
    light, half, shade = (draw(wall(light=v), PLAIN)[30, 45, :3] for v in (1.2, 0.75, SHADE))
    assert light.min() > 0.65 and (light > half).all() and (half > shade).all()
    white, gray = (draw(wall((0.98, 0.98, 0.98), v), PLAIN)[30, 45, :3] for v in (1.2, SHADE))
    np.testing.assert_allclose(white, 1, atol=0.02)
    assert gray[2] > gray[0] + 0.1, "the glaze is blue"
    warm = draw(wall((0.98, 0.98, 0.98), SHADE), dict(PLAIN, wash_glaze=(0.9, 0.7, 0.6)))[30, 45, :3]
    assert warm[0] > warm[2] + 0.1


def test_without_color_it_is_ink_and_water():
    got = draw(wall((0.1, 0.5, 0.2), 0.6), dict(PLAIN, wash_color=0.0, wash_glaze=(0.7, 0.7, 0.7)))[30, 45, :3]
    assert np.ptp(got) < 1e-5 and 0.2 < got[0] < 0.8


def test_shade_dries_darker_along_its_border_and_no_farther_than_the_pool_is_wide():
    light = np.where(np.arange(90) < 45, SHADE - 0.05, 0.85)
    row = draw(wall((0.9, 0.9, 0.9), light), dict(PLAIN, wash_pooling=1.5))[30, :, 0]
    assert row[43] < row[34] - 0.03 and abs(row[21] - row[10]) < 2e-3
    assert (row[47:] > row[43] + 0.2).all()


def test_borders_of_shade_stray_and_those_of_things_do_not():
    """Light that falls off over some pixels; a wall that is flat stays flat."""
    light = SHADE + (FULL - SHADE) * np.clip((np.arange(120) - 30) / 60, 0, 1)
    shaded = draw(wall((0.9, 0.9, 0.9), light, (300, 120)), dict(PLAIN, wash_wobble=40.0, wash_size=60.0))[..., 0]
    ends = (shaded < 0.5 * (shaded.min() + shaded.max())).sum(1)
    assert np.ptp(ends) > 3
    flat = draw(wall((0.9, 0.9, 0.9), 0.6, (300, 120)), dict(PLAIN, wash_wobble=40.0, wash_size=60.0))
    assert np.ptp(flat[..., 0]) < 1e-5


def test_pigment_settles_on_the_paper_and_not_where_there_is_none():
    grainy = dict(PLAIN, wash_granulation=0.5, paper_source="COLD_PRESS")
    assert draw(wall((0.3, 0.3, 0.5), 0.5), grainy)[..., 0].std() > 0.01
    assert draw(wall((0.985, 0.985, 0.985), 1.3), grainy)[..., 0].std() < 0.012, "paper alone"


def test_washes_keep_to_things_as_the_camera_passes_and_comes_nearer():
    """A place of a wall has the same wash 40 pixels aside and at 1.06 times the size, another place another."""
    scene = dict(PLAIN, wash_uneven=4.0, wash_size=40.0)
    size = (120, 200)
    one = draw(wall(light=0.6, size=size, anchored=(0.01, 0)), scene)[..., 0]
    aside = draw(wall(light=0.6, size=size, anchored=(0.01, 40)), scene)[..., 0]
    assert np.abs(one[:, 40:] - aside[:, :-40]).max() < 2e-3 and one.std() > 0.01
    near = draw(wall(light=0.6, size=size, anchored=(0.01 / 1.06, 0)), scene)[..., 0]
    y, x = np.mgrid[:110, :180]
    found = near[np.round(y * 1.06).astype(int), np.round(x * 1.06).astype(int)]
    assert np.corrcoef(one[:110, :180].ravel(), found.ravel())[0, 1] > 0.97
    assert abs(np.corrcoef(one[:, 40:].ravel(), one[:, :-40].ravel())[0, 1]) < 0.7


def test_other_things_and_seeds_have_other_washes():
    scene = dict(PLAIN, wash_uneven=4.0, wash_size=4.0)
    layers = wall(light=0.6, anchored=(0.01, 0))
    one = draw(layers, scene)[..., 0]
    other = draw(layers | dict(object=layers["object"] + 1), scene)[..., 0]
    again = draw(layers, scene | dict(wash_seed=1))[..., 0]
    for two in (other, again):
        assert abs(np.corrcoef(one.ravel(), two.ravel())[0, 1]) < 0.4


def test_styles_without_it_stay_as_they_are():
    layers = random_layers(50, 70)
    styles = [dict(use_wash=False), dict(use_wash=False)]
    kept = np.isin(layers["style"][..., 0], (1, 2))
    assert draw(layers, WASH, styles)[kept].tobytes() == layers["combined"][kept].tobytes()


def test_granulation_asks_for_an_image_of_paper():
    values = library.complete(dict(WASH, paper_source="IMAGE", paper_image="grain.png"), [])
    assert library.images(values) == [[("paper_image", "grain.png")]]
    assert library.images([dict(values[0], wash_granulation=0.0)]) == [[]]


def test_however_it_is_cut_up_the_bytes_are_the_same():
    layers = drawn.scene(190, 170)
    whole = draw(layers, WASH, threads=1, simd=0)
    assert draw(layers, WASH, threads=3, simd=1).tobytes() == whole.tobytes()
    part = {name: a[20:150, 30:170] for name, a in layers.items()}
    piece = draw(part, WASH, frame=Frame(190, 170, 30, 20))
    assert piece[30:-30, 30:-30].tobytes() == whole[50:120, 60:140].tobytes()
