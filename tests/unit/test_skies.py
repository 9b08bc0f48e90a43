# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies by formula beside what Cycles has of them, and suns that are found in pictures of the world."""

import numpy as np
import pytest
from encre.pen import daylight, irradiance, suns
from encre.pen.sky import Sky


def falls(picture, normal=(0.0, 0.0, 1.0)):
    """Diffuse light (3,) on what faces this way."""
    way, angle = suns.ways(*picture.shape[:2]), suns.angles(*picture.shape[:2])
    return np.einsum("yxc,yx->c", picture, np.maximum(way @ np.array(normal), 0) * angle) / np.pi


# Measured in pictures of 128 x 64 by Cycles of Blender 3.4, whose sun is half a degree wide.
@pytest.mark.parametrize(("elevation", "altitude", "air", "dust", "ozone", "level", "sun"), [
    (35, 0, 1, 1, 1, (2.2229, 2.7769, 3.8966), (2512375, 2021030, 1486420)),
    (15, 0, 1, 1, 1, (1.7212, 2.1641, 2.8245), (2133722, 1543503, 856299)),
    (90, 0, 1, 1, 1, (2.474, 3.1198, 4.6106), (2662262, 2223415, 1808058)),
    (35, 0, 1, 5, 1, (4.8692, 4.7346, 5.0226), (2086804, 1678688, 1234639)),
    (15, 1000, 2, 3, 2, (2.0018, 2.4715, 2.7564), (1772795, 1103305, 405184)),
])
def test_an_atmosphere_is_as_bright_as_in_cycles(elevation, altitude, air, dust, ozone, level, sun):
    given = np.radians(elevation), 0.0, altitude, air, dust
    picture = daylight.atmosphere(*given, ozone, 64)
    np.testing.assert_allclose(falls(picture), level, rtol=0.05)
    width = np.radians(0.545)
    found = daylight.sun_of(*given, width, 1.0)
    middle = found.color / (2 * np.pi * (1 - np.cos(width / 2)) * 0.8)  # its rim is darker
    np.testing.assert_allclose(middle, sun, rtol=0.04)
    np.testing.assert_allclose(found.direction, (0, np.cos(given[0]), np.sin(given[0])), atol=1e-12)


def test_an_atmosphere_turns_with_its_sun_and_ends_below_the_horizon():
    ahead, turned = (daylight.atmosphere(0.6, turn, 0, 1, 1, 1, 64) for turn in (0.0, np.pi / 2))
    np.testing.assert_allclose(np.roll(ahead, 32, 1), turned, rtol=1e-4, atol=1e-6)  # clockwise from above
    assert np.unravel_index(np.argmax(turned.sum(2)), (64, 128))[1] in (63, 64), "+x is the middle of the picture"
    assert not ahead[45:].any()
    assert daylight.sun_of(-0.02, 0.0, 0, 1, 1, 0.01, 1.0) is None
    whole, half = (daylight.sun_of(0.3, 0.0, 0, 1, 1, 0.01, by).color for by in (1.0, 0.5))
    np.testing.assert_allclose(whole, 2 * half)


@pytest.mark.parametrize(("elevation", "turbidity", "level", "zenith"), [
    (35, 2.2, (0.3176, 0.4575, 0.8092), (0.1482, 0.2547, 0.5306)), (15, 6, (0.3589, 0.3731, 0.3988),
                                                                   (0.2368, 0.32, 0.4305)),
    (35, 10, (1.0691, 1.0171, 0.9431), (0.8531, 1.0512, 1.2196))])
def test_the_analytic_sky_is_that_of_cycles(elevation, turbidity, level, zenith):
    e = np.radians(elevation)
    picture = daylight.analytic((0.0, float(np.cos(e)), float(np.sin(e))), turbidity)
    np.testing.assert_allclose(falls(picture), level, rtol=1e-3)
    np.testing.assert_allclose(picture[0].mean(0), zenith, rtol=1e-3)


@pytest.mark.parametrize(("elevation", "turbidity", "albedo", "level"), [
    (35, 2.2, 0.3, (0.0393, 0.0659, 0.112)), (60, 2.2, 0.3, (0.0427, 0.0749, 0.1381)),
    (35, 5, 0.3, (0.0801, 0.1001, 0.1316)), (35, 2.2, 1, (0.0526, 0.0892, 0.1495)),
    (35, 10, 0.3, (0.1866, 0.1835, 0.1803))])
def test_the_sky_of_hosek_and_wilkie_is_about_as_bright_as_in_cycles(elevation, turbidity, albedo, level):
    e = np.radians(elevation)
    way = 0.0, float(np.cos(e)), float(np.sin(e))
    found = falls(daylight.analytic(way, turbidity) * daylight.hosek(way, turbidity, albedo))
    np.testing.assert_allclose(found, level, rtol=0.2)
    np.testing.assert_allclose(found.sum(), sum(level), rtol=0.12)


def shining(height, direction, degrees, color, around=(0.2, 0.3, 0.5)):
    """A picture with a disc in it that gives `color` to what faces it."""
    way, angle = suns.ways(height, 2 * height), suns.angles(height, 2 * height)
    disc = way @ direction > np.cos(np.radians(degrees / 2))
    picture = np.broadcast_to(np.array(around), way.shape).copy()
    picture[disc] += np.array(color) / np.sum(angle * disc)
    return picture


@pytest.mark.parametrize("height", [64, 256, 700])
@pytest.mark.parametrize("degrees", [3.0, 12.0, 30.0])
def test_a_sun_leaves_its_picture_as_a_lamp(height, degrees):
    direction = np.array([0.48, -0.6, 0.64])
    picture = shining(height, direction, degrees, (6.0, 5.0, 3.0))
    left, (sun,) = suns.parted(picture)
    np.testing.assert_allclose(sun.color, (6, 5, 3), rtol=0.04)
    assert sun.direction @ direction > np.cos(np.radians(0.05 * degrees + 100 / height))
    assert np.degrees(sun.width) == pytest.approx(degrees, rel=0.1, abs=60 / height)
    np.testing.assert_allclose(left, np.broadcast_to((0.2, 0.3, 0.5), left.shape), atol=0.02)
    for normal in ((0, 0, 1), (0, -1, 0), direction):  # nothing is lost on the way
        both = falls(left, normal) + sun.color * max(np.dot(normal, sun.direction), 0) / np.pi
        np.testing.assert_allclose(both, falls(suns.shrunk(picture, 256), normal), rtol=0.02)


def test_what_throws_no_shadow_stays_in_the_picture():
    for degrees, color in ((3.0, (0.1, 0.1, 0.1)), (150.0, (3, 3, 3))):  # a moon by day; an overcast sky
        picture = shining(128, np.array([0, 0.6, 0.8]), degrees, color)
        left, found = suns.parted(picture)
        assert found == [] and np.allclose(left, picture)
    for elevation in (0.1, 0.6, 1.0):  # nor does a bright horizon
        assert suns.parted(daylight.atmosphere(elevation, 0.0, 0, 1, 0, 1))[1] == []
    broken = np.full((128, 256, 3), np.inf)
    assert suns.parted(broken)[1] == [] and suns.parted(np.ones((2, 4, 3)))[1] == []


def test_two_windows_are_two_lamps():
    picture = shining(128, np.array([1.0, 0, 0]), 12, (4, 4, 4)) + shining(128, np.array([0, 0.8, 0.6]), 9, (2, 2, 3))
    _, found = suns.parted(picture)
    assert len(found) == 2
    assert max(sun.direction[0] for sun in found) > 0.99
    assert max(sun.direction @ (0, 0.8, 0.6) for sun in found) > 0.99


def test_suns_are_added_and_multiplied_with_their_sky():
    one = Sky(np.ones(3), suns=(suns.Sun(np.eye(3)[2], np.array([1.0, 2, 3]), 0.1),))
    both = one * 2 + one
    assert [list(sun.color) for sun in both.suns] == [[2, 4, 6], [1, 2, 3]] and both.color[0] == 3
    assert np.allclose(irradiance.of_picture(np.ones((32, 64, 3)))[0], 1, atol=0.01)


def test_planes_tell_sides_apart():
    """Top as it was, then the side toward the light, across, away, and below."""
    level = np.array([0.6, -0.8])
    sides = np.array([[0, 0, 1], [0.6, -0.8, 0], [0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, -1]])
    light = irradiance.constant(np.array([0.2, 0.3, 0.4]))
    seen = irradiance.polynomials(sides) @ irradiance.planes(light, level, 0.6) / [0.2, 0.3, 0.4]
    rise = np.sqrt(0.75)
    wanted = 1 - 0.6 * (rise - np.array([rise, 0.5, 0, -0.5, -rise])) / (1 + rise)
    np.testing.assert_allclose(seen, np.repeat(wanted[:, None], 3, 1), rtol=1e-12)
    # A world that is brighter on one side: each side has its own light, times as much.
    light[1:4] = np.random.default_rng(1).uniform(-0.1, 0.1, (3, 3))
    own = irradiance.polynomials(sides) @ light
    np.testing.assert_allclose(irradiance.polynomials(sides) @ irradiance.planes(light, level, 0.6),
                               own * wanted[:, None], rtol=1e-12)
