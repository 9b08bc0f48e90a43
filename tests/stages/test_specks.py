# SPDX-License-Identifier: GPL-3.0-or-later
"""Specks against tests/reference/, and what an inker fills and leaves."""

import masks
import numpy as np
import pytest
from encre.pen.job import Frame
from randomly import random_layers
from reference import render as reference

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, length_unit="PIXELS")
SPECKS = dict(OFF, use_specks=True)


def draw(layers, scene, styles=(), **how):
    return masks.render(layers, scene, styles, **how).images["Combined"]


def page(height=40, width=60):
    """Black ink, and nothing that a line would be drawn along."""
    flat = np.ones((height, width, 3), np.float32)
    layers = dict(combined=np.zeros((height, width, 4)), color=flat, diffuse=flat, normal=flat, depth=4 * flat[..., :1])
    layers["combined"][..., 3] = 1
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def crumbs(share=0.12, height=70, width=90):
    """Noise of ink and light, some of it coloured, some clear, of two styles."""
    layers, rng = page(height, width), np.random.default_rng(5)
    light = rng.random((height, width)) < share
    layers["combined"][..., :3] = np.where(light[..., None], rng.uniform(0.1, 1, (height, width, 3)),
                                           rng.uniform(0, 0.02, (height, width, 3)))
    layers["combined"][..., 3] = np.where(rng.random((height, width)) < 0.02, 0.5, 1)
    layers["style"] = np.float32(np.arange(width) > 50) * np.ones((height, 1), np.float32)
    return layers


@pytest.mark.parametrize("share", [0.08, 0.3])
@pytest.mark.parametrize("scene", [dict(), dict(speck_size=1.0), dict(speck_size=2.5), dict(speck_size=32.0),
                                   dict(length_unit="RELATIVE", speck_size=32.0)])
def test_agrees_with_the_reference(scene, share):
    layers, styles = crumbs(share), [dict(speck_size=3.0)]
    want = reference(layers, SPECKS | scene, styles)["Combined"]
    got = draw(layers, SPECKS | scene, styles)
    np.testing.assert_allclose(got, want, atol=1e-6)
    assert (got != layers["combined"]).any()


def test_specks_that_lines_leave_are_filled_in_what_shows_lines_as_well():
    layers = page()
    layers["object"] = np.zeros((40, 60, 1), np.float32)
    layers["object"][10:12, 10:12], layers["object"][10:30, 30:50] = 1, 2  # a nail and a box
    scene = dict(SPECKS, use_lines=True, ink_color=(1.0, 1.0, 1.0), line_thickness=2.0, pen_1_grain=0.0,
                 pen_1_softness=0.0, edge_detector="SOBEL", speck_size=7.0)
    want, plain = reference(layers, scene), reference(layers, scene | dict(use_specks=False))
    sure = ~want["unsure"]
    got = masks.render(layers, scene, (), outputs=("Combined", "Encre Lines", "Encre Surface")).images
    assert want["Combined"][:, :20, :3].max() < 0.01 < 0.9 < plain["Combined"][:, :20, :3].max()
    assert (want["Combined"][:, 20:] == plain["Combined"][:, 20:]).all()
    for name in ("Combined", "Encre Lines"):
        np.testing.assert_allclose(got[name][sure], want[name][sure], atol=3e-5)
    lines, surface = got["Encre Lines"], got["Encre Surface"]
    np.testing.assert_allclose(lines + surface * (1 - lines[..., 3:]), got["Combined"], atol=1e-6)


def light(*pixels):
    layers = page()
    for y, x in pixels:
        layers["combined"][y, x, :3] = 1
    return layers


def filled(layers, **scene):
    return draw(layers, SPECKS | scene)[..., 0].sum() == 0


def test_what_has_less_than_its_area_is_a_speck():
    block = [(y, x) for y in range(10, 13) for x in range(20, 23)]
    assert filled(light(*block), speck_size=3.0) and not filled(light(*block), speck_size=2.9)
    assert not filled(light(*block, (13, 23)), speck_size=3.0), "diagonal neighbours are of one island"


def test_a_slit_is_filled_however_long_and_a_wider_one_is_light():
    slit = [(10 + x // 4, x) for x in range(5, 55)]
    assert filled(light(*slit), speck_size=2.0) and not filled(light(*slit), speck_size=1.9)
    assert not filled(light(*slit, *((y + 1, x) for y, x in slit)), speck_size=3.9)


def test_ink_that_is_not_closed_around_it_makes_no_speck():
    layers = light((10, 20))
    layers["combined"][9, 19, 3] = 0.5  # clear: the page shows white there
    layers["combined"][:9, 15:20, :3] = 1
    assert not filled(layers)


def test_at_the_frame_s_own_rim_specks_are_filled_and_where_it_goes_on_they_are_not():
    rims = dict(y=0, x=20), dict(y=39, x=20), dict(y=20, x=0), dict(y=20, x=59)
    for at in rims:
        layers = light((at["y"], at["x"]))
        assert filled(layers)
        part = dict(width=62, height=42, x=1, y=1)
        np.testing.assert_array_equal(draw(layers, SPECKS, frame=Frame(**part)), layers["combined"])
        for frame in (None, part):
            want = reference(layers, SPECKS, frame=frame)["Combined"]
            np.testing.assert_allclose(draw(layers, SPECKS, frame=frame and Frame(**frame)), want, atol=1e-6)
    assert (draw(page(1, 2) | dict(combined=np.ones((1, 2, 4), np.float32)), SPECKS) == 1).all(), "nothing is around"


def test_it_takes_the_colour_around_it():
    layers = light((10, 20))
    layers["combined"][..., :3] += np.float32((0.02, 0.01, 0))
    np.testing.assert_allclose(draw(layers, SPECKS)[10, 20], (0.02, 0.01, 0, 1), atol=1e-6)


@pytest.mark.parametrize("color, depth, stays", [(0.8, 4.0, True), (0.8, 3.99, True), (0.8, 4.02, False),
                                                 (0.8, 3.9, False), (0.1, 4.0, False)])
def test_a_point_that_is_printed_stays_and_a_crumb_of_light_and_what_is_behind_go(color, depth, stays):
    layers = page()
    layers["color"][:], layers["combined"][20:22, 30:32, :3] = 0.05, 0.7
    layers["color"][20:22, 30:32], layers["depth"][20:22, 30:32] = color, depth
    got = draw(layers, SPECKS)
    assert got[20:22, 30:32, :3].any() == stays
    np.testing.assert_allclose(got, reference(layers, SPECKS)["Combined"], atol=1e-6)


def test_without_specks_no_bit_changes():
    layers = random_layers(40, 64)
    layers["style"][:, :30], layers["style"][:, 30:] = 1, 0
    for off in (dict(use_specks=False), dict(speck_size=0.0)):
        assert draw(layers, SPECKS | dict(speck_size=0.0), [off]).tobytes() == layers["combined"].tobytes()


def test_threads_and_instructions_change_nothing():
    layers = crumbs(0.2, 300, 90)
    one = draw(layers, SPECKS, [{}], threads=1, simd=0)
    assert draw(layers, SPECKS, [{}], threads=3, simd=1).tobytes() == one.tobytes()


def test_what_is_around_is_a_number_where_its_pixels_are_the_largest():
    """A picture whose alpha is as large as its light counts as black."""
    layers = page()
    layers["combined"][:] = 3e38
    layers["combined"][10:12, 10:12] = 0.5, 0.5, 0.5, 1
    got = draw(layers, SPECKS)
    assert np.isfinite(got).all() and (got[10:12, 10:12, :3] > 1e38).all()
