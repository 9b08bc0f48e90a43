# SPDX-License-Identifier: GPL-3.0-or-later
"""Washes against tests/reference/, what each of their parts does, and cut up in other ways."""

import drawn
import masks
import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame
from randomly import random_layers
from reference import render as reference

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, length_unit="PIXELS")
PLAIN = dict(wash_granulation=0, wash_pooling=0, wash_uneven=0, wash_pigments=0, wash_bleed=0, wash_wobble=0,
             wash_dilution=0)
WASH = dict(OFF, use_wash=True)


def draw(layers, scene, styles=(), **how):
    return masks.render(layers, scene, styles, **how).images["Combined"]


@pytest.mark.parametrize("size", [(59, 97), (1, 1), (1, 40), (40, 1)])
@pytest.mark.parametrize("scene", [
    dict(),
    dict(wash_pool_width=30.0, wash_bleed_width=3.0, wash_pooling=2.0, wash_bleed=1.0, wash_wobble=0.0, wash_seed=7),
    dict(paper_source="NONE", wash_size=2.0, wash_pigments=3.0, wash_pool_width=1.0, wash_wobble=64.0),
    dict(wash_bleed=0.0, wash_granulation=3.0, wash_size=1000.0, length_unit="RELATIVE", use_hatching=True),
])
def test_agrees_with_the_reference(scene, size):
    layers = random_layers(*size)
    styles = [dict(use_wash=False), dict(wash_pooling=0.0, wash_uneven=1.5, wash_dilution=0.5, wash_wobble=1.5)]
    place = dict(width=900, height=700, x=411, y=333)
    want = reference(layers, dict(WASH, **scene), styles, frame=place)
    sure = ~want["unsure"]
    assert sure.mean() > 0.95
    got = draw(layers, dict(WASH, **scene), styles, frame=Frame(**place))
    np.testing.assert_allclose(got[sure], want["Combined"][sure], atol=4e-4)


def test_brightness_without_bounds_stays_finite():
    layers = random_layers(40, 64)
    layers["combined"][::3, ::5, :3] = 1e38
    layers["combined"][1::3, ::5, :3] = -1e38
    assert np.isfinite(draw(layers, WASH)).all()


def halves(dark=0.2, light=0.7, size=80, rows=40):
    """A darker left half and a lighter right one, seen under flat light."""
    x = np.broadcast_to(np.arange(size) < size // 2, (rows, size))[..., None]
    color = np.where(x, (dark, dark, dark), (light, light, light))
    ones = np.ones((rows, size, 1))
    layers = dict(combined=np.concatenate([color, ones], -1), color=color, diffuse=ones * (1, 1, 1), depth=ones,
                  normal=ones * (0, 0, 1))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def test_pigment_pools_on_the_darker_side_of_a_border():
    layers = halves()
    row = draw(layers, dict(WASH, **{**PLAIN, "wash_pooling": 0.3}, wash_pool_width=8.0))[20, :, 0]
    np.testing.assert_allclose(row[40:], 0.7, atol=1e-4)
    np.testing.assert_allclose(row[:31], 0.2, atol=1e-4)
    assert row[39] < 0.16 and (np.diff(row[33:40]) < 0).all(), "darkest at the border"


def test_pigment_settles_in_valleys_of_the_paper_and_not_on_white():
    layers = halves(light=1.0)
    for rough, grainy in ((0.0, False), (1.0, True)):
        scene = dict(WASH, **{**PLAIN, "wash_granulation": 1.0}, paper_roughness=rough)
        picture = draw(layers, scene)[..., 0]
        assert (picture[:, :40].std() > 0.03) == grainy
        np.testing.assert_allclose(picture[:, 40:], 1, atol=1e-6)
    rubbed = dict(OFF, use_hatching=True, hatch_amount=0.7, hatch_color_threshold=0.4, hatch_color_light=0)
    alike = np.corrcoef(picture[:, :40].ravel(), draw(layers, rubbed)[:, :40, 0].ravel())[0, 1]
    assert alike < -0.7, "pencil takes the hills"


def test_colour_runs_over_the_border_as_far_as_asked():
    row = draw(halves(), dict(WASH, **{**PLAIN, "wash_bleed": 1.0}, wash_bleed_width=12.0))[20, :, 0]
    assert 0.2 < row[36] < 0.69 and 0.21 < row[43] < 0.7
    np.testing.assert_allclose(row[[26, 53]], [0.2, 0.7], atol=5e-4)


def test_colour_runs_on_beyond_a_line_of_ink():
    """As watercolour does over waterproof ink: the line stays as it is, and beyond it is colour from its other side."""
    layers = halves()
    layers["object"] = np.float32(np.arange(80) >= 40)[None, :, None] * np.ones((40, 1, 1), np.float32) + 1
    inked = dict(WASH, **PLAIN, use_lines=True, line_color_strength=0, line_thickness=6.0, pen_1_softness=0.0,
                 pen_1_grain=0.0,
                 wash_bleed_width=16.0)
    names = "Combined", "Encre Lines"
    dry, wet = (library.render(layers, dict(inked, wash_bleed=bleed), outputs=names).images for bleed in (0.0, 1.0))
    ink = dry["Encre Lines"][20, :, 3]
    assert dry["Encre Lines"].tobytes() == wet["Encre Lines"].tobytes() and ink.max() > 0.99
    left, right = np.flatnonzero(ink > 0.01)[[0, -1]]
    assert 33 < left < 40 <= right < 46
    one, other = (picture["Combined"][20, :, 0] for picture in (dry, wet))
    assert (np.abs(one - other)[ink > 0.99] < 1e-6).all()
    np.testing.assert_allclose(one[right + 1:], 0.7, atol=1e-4)
    assert (other[right + 1:right + 4] < 0.69).all() and (other[left - 3:left] > 0.21).all()
    np.testing.assert_allclose(other[60:], 0.7, atol=1e-3)


def test_borders_stray_no_farther_than_asked_and_are_crisp():
    picture = draw(halves(size=160, rows=300), dict(WASH, **{**PLAIN, "wash_wobble": 6.0}))[..., 0]
    ends = (picture < 0.45).sum(1)
    assert 2 < np.ptp(ends) < 12 and np.abs(ends - 80).max() <= 6
    assert ((picture > 0.21) & (picture < 0.69)).sum(1).max() <= 4


def test_a_wash_of_nothing_changes_nothing():
    layers = random_layers(50, 70)
    np.testing.assert_allclose(draw(layers, dict(WASH, **PLAIN)), layers["combined"], atol=1e-6)
    styles = [dict(use_wash=False), dict(use_wash=False)]
    kept = np.isin(layers["style"][..., 0], (1, 2))
    assert draw(layers, WASH, styles)[kept].tobytes() == layers["combined"][kept].tobytes()


def test_granulation_asks_for_an_image_of_paper():
    values = library.complete(dict(WASH, paper_source="IMAGE", paper_image="grain.png"), [])
    assert library.images(values) == [[("paper_image", "grain.png")]]
    assert library.images([dict(values[0], wash_granulation=0.0)]) == [[]]


def test_another_seed_is_another_wash():
    layers = halves()
    one, other = (draw(layers, dict(WASH, **{**PLAIN, "wash_uneven": 1.0}, wash_size=10.0, wash_seed=seed))[:, :40, 0]
                  for seed in (0, 1))
    assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.35
    assert one.std() > 0.02


def test_however_it_is_cut_up_the_bytes_are_the_same():
    layers = drawn.scene(190, 170)
    scene = dict(WASH, wash_bleed_width=20.0)
    whole = draw(layers, scene, threads=1, simd=0)
    assert draw(layers, scene, threads=3, simd=1).tobytes() == whole.tobytes()
    part = {name: a[20:150, 30:170] for name, a in layers.items()}
    piece = draw(part, scene, frame=Frame(190, 170, 30, 20))
    assert piece[30:-30, 30:-30].tobytes() == whole[50:120, 60:140].tobytes()
