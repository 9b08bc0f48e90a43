# SPDX-License-Identifier: GPL-3.0-or-later
"""What the denoiser leaves of noise is evened out, and nothing else."""

import noise
import numpy as np
import pytest
from encre.pen import samples
from encre.pen.samples import REACH
from reference import even as reference

HEIGHT, WIDTH = 90, 120
Y, X = np.mgrid[:HEIGHT, :WIDTH]
FLAT = np.full((HEIGHT, WIDTH, 1), 5, np.float32)
FACING = np.tile(np.float32((0, 0, 1)), (HEIGHT, WIDTH, 1))


def even(light, *given):
    return samples.even(light.copy(), *given)


def grey(light):
    return np.repeat(light[..., None], 3, 2).astype(np.float32)


def noisy(light, *more):
    """(light as a denoiser leaves it, with clouds; light as rendered)"""
    return tuple(grey(light * factor) for factor in noise.of_light(light.shape, *more))


def crossings(light, level):
    """By row, the columns after which the light passes the level."""
    return [np.flatnonzero((row[1:] > level) != (row[:-1] > level)) for row in light]


def places(light, level):
    """By row, where the light first passes the level, between two pixels."""
    column = np.array([row[0] for row in crossings(light, level)])
    one, two = light[np.arange(len(light)), column], light[np.arange(len(light)), column + 1]
    return column + (one - level) / (one - two)


def shadow(slope=0.2):
    """The edge of a hard shadow, averaged over pixels, that slants."""
    edge = 60.3 + slope * (Y - 45)
    return 0.2 + 0.8 * np.clip(edge - X + 0.5, 0, 1)


@pytest.mark.parametrize("numbers", [False, True])
def test_as_the_reference_has_it(numbers):
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:24, :31]
    light, rendered = (grey(p[..., 0]) for p in noisy(np.where(x + y > 26, 0.3, 0.5 + 0.01 * x)))
    light *= rng.uniform(0.5, 1, 3).astype(np.float32)
    depth = np.where(x > 20, 9, 5 + 0.01 * y)[..., None].astype(np.float32)
    depth[3:6, 3:7] = 1e10
    depth[9, 2] = np.nan
    number = (y > 17)[..., None].astype(np.float32) if numbers else None
    normal = FACING[:24, :31] + (np.abs(y - 20) < 2)[..., None] * np.float32((0.15, 0, 0))
    exact = (p.astype(float) for p in (light, rendered, normal, depth[..., 0]))
    wanted = reference.even(*exact, number[..., 0] if numbers else np.zeros((24, 31)))
    assert np.abs(wanted - light).max() > 0.004
    np.testing.assert_allclose(even(light, rendered, normal, depth, number), wanted, rtol=1e-3, atol=1e-5)


def test_the_border_of_a_shadow_as_the_reference_has_it():
    light, _ = round_shadow()
    left, rendered = (p[32:50, 24:52].copy() for p in noisy(0.1 + 0.8 * light, 1, 0.01, 0.2))
    normal, depth = FACING[:18, :28], FLAT[:18, :28].copy()
    depth[:3, :4] = 9
    picture = reference.Picture(left.max(2).astype(float), normal, depth[..., 0], np.zeros((18, 28)))
    assert sum(sure > 0.5 for _, sure in reference.bordered(picture, dict.fromkeys(picture.light, 0.1)).values()) > 60
    wanted = reference.even(left.astype(float), rendered.astype(float), normal, depth[..., 0], np.zeros((18, 28)))
    np.testing.assert_allclose(even(left, rendered, normal, depth), wanted, rtol=1e-3, atol=1e-5)


def test_light_without_noise_keeps_every_byte():
    ball = np.maximum(0, 1 - ((X - 50) / 70) ** 2 - ((Y - 40) / 60) ** 2)
    for light in (grey(ball), grey(shadow()), grey(0.3 + 0.001 * X), np.zeros((HEIGHT, WIDTH, 3), np.float32)):
        assert np.array_equal(even(light, light, FACING, FLAT), light)


def test_a_level_in_soft_light_ends_in_one_clean_curve():
    light = 0.9 - 0.004 * (X - 60 - 0.1 * (Y - 45))
    left, rendered = noisy(light)
    before, after = (crossings(p[8:-8, ..., 0], 0.9) for p in (left, even(left, rendered, FACING, FLAT)))
    assert max(map(len, before)) > 2 and {len(row) for row in after} == {1}
    straight = 59.5 + 0.1 * (np.arange(8, HEIGHT - 8) - 45)
    assert np.percentile(np.abs(np.concatenate(after) - straight), 95) < 3
    assert np.std(np.diff(np.concatenate(after))) < 0.8


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_wide_clouds_move_a_level_little(seed):
    light = np.broadcast_to(0.5 + 0.0015 * (np.arange(240) - 120), (HEIGHT, 240))
    left, rendered = noisy(light, seed, 0.004, 0.06, (1, 2, 4, 4))
    normal, depth = np.tile(FACING, (1, 2, 1)), np.tile(FLAT, (1, 2, 1))
    off = np.concatenate(crossings(even(left, rendered, normal, depth)[..., 0], 0.5)) - 119.5
    assert np.std(off) < 0.6


def specks(bright):
    """How many pieces of fewer than 12 pixels a level is filled in."""
    left, sizes = set(zip(*np.nonzero(bright), strict=True)), []
    while left:
        piece = [left.pop()]
        for y, x in piece:
            beside = {(y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)} & left
            left -= beside
            piece += beside
        sizes.append(len(piece))
    return sum(size < 12 for size in sizes)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_between_shadows_flat_light_makes_no_crumbs(seed):
    shadows = ((X + Y // 3) % 14 < 4) | ((Y - X // 4) % 17 < 4)
    left, rendered = noisy(np.where(shadows, 0.1, 0.49), seed, 0.02, 0.06)
    assert specks(left[..., 0] > 0.5) > 50
    assert specks(even(left, rendered, FACING, FLAT)[..., 0] > 0.5) <= 6


def test_the_edge_of_a_shadow_stays_where_it_is():
    light = shadow()
    left, rendered = noisy(light, 1, 0.003)
    off = np.abs(places(even(left, rendered, FACING, FLAT)[..., 0], 0.6) - places(light, 0.6))
    assert np.percentile(off, 95) < 0.05 and off.max() < 0.2


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_level_in_a_noisy_penumbra_is_a_calm_curve(seed):
    light = 0.1 + 0.8 * np.clip((60.3 + 0.3 * (Y - 45) + 4 * np.sin(Y / 12) - X) / 8 + 0.5, 0, 1)
    noisy_there = (light - 0.1) * (0.9 - light) / 0.16  # where all or nothing of a lamp is seen there is no noise
    left, rendered = (grey(light * (1 + noisy_there * (factor - 1)))
                      for factor in noise.of_light(light.shape, seed, 0.04, 0.2))
    off = (places(even(left, rendered, FACING, FLAT)[..., 0], 0.5) - places(light, 0.5))[8:-8]
    assert np.std(np.diff(off)) < 0.05 and np.percentile(np.abs(off), 95) < 0.4


def round_shadow():
    """Of a ball, its border 24 pixels wide, and the noise that a lamp with a size makes there; how far from its middle
    each pixel is, too."""
    far = np.hypot(X - 60.2, Y - 44.7)
    share = np.clip((far - 15) / 24, 0, 1)
    return share * share * (3 - 2 * share), far


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_border_of_a_soft_shadow_is_not_moved(seed):
    share, far = round_shadow()
    light = 0.1 + 0.8 * share
    left, rendered = (grey(light * (1 + 4 * share * (1 - share) * (factor - 1)))
                      for factor in noise.of_light(light.shape, seed, 0.02, 0.25))
    made = even(left, rendered, FACING, FLAT)[..., 0]
    at = np.abs(far - far[light > 0.3].min()) < 1.5
    off = (made - light)[at] / np.hypot(*np.gradient(light))[at]
    assert np.percentile(np.abs(off), 95) < 0.22


@pytest.mark.parametrize("dark", [abs(X - 50 - 0.3 * (Y - 45)) < 1.5, (abs(X - 60) < 0.12 * (Y - 20)) & (Y > 20)],
                         ids=["rail", "tip"])
def test_shadows_of_thin_things_keep_their_shape(dark):
    left, rendered = noisy(np.where(dark, 0.2, 0.8), 1, 0.01, 0.1)
    assert np.array_equal(even(left, rendered, FACING, FLAT)[..., 0] < 0.5, dark)


def test_nothing_is_mixed_across_an_outline():
    light = np.where(X < 60, 0.5, 0.502)
    left, rendered = noisy(light, 1, 0)
    fold = np.where(X[..., None] < 60, FACING, np.float32((0.6, 0, 0.8)))
    for normal, depth, number in ((FACING, np.where(X < 60, 5, 6), None), (FACING, FLAT[..., 0], (X < 60)[..., None]),
                                  (fold, FLAT[..., 0], None)):
        made = even(left, rendered, normal, depth[..., None].astype(np.float32), number)
        assert np.array_equal(made, left)
    assert not np.array_equal(even(left, rendered, FACING, FLAT), left)


def test_a_part_is_as_in_the_whole():
    left, rendered = noisy(np.tile(shadow(), (2, 2)))
    normal, depth = np.tile(FACING, (2, 2, 1)), np.tile(FLAT, (2, 2, 1))
    whole = even(left, rendered, normal, depth)
    part = (slice(10, 170), slice(5, 200))
    inner = (slice(REACH, -REACH),) * 2
    made = even(left[part], rendered[part], normal[part], depth[part])[inner]
    assert made.size and np.array_equal(made, whole[part][inner])


def test_a_frame_of_several_strips_is_as_one():
    left, rendered = noisy(np.tile(shadow(), (7, 35)))
    normal, depth = np.tile(FACING, (7, 35, 1)), np.tile(FLAT, (7, 35, 1))
    whole, part = even(left, rendered, normal, depth), (slice(100, 560), slice(1000, 1300))
    inner = (slice(REACH, -REACH),) * 2
    made = even(left[part], rendered[part], normal[part], depth[part])[inner]
    assert made.size and np.array_equal(made, whole[part][inner])


def test_any_threads_and_instructions_give_the_same_bytes():
    left, rendered = noisy(shadow())
    one = samples.even(left.copy(), rendered, FACING, FLAT, threads=1, simd=0)
    assert np.array_equal(samples.even(left.copy(), rendered, FACING, FLAT, threads=5), one)
    strange = np.array(left)
    strange[3, 4], strange[20:22, 7] = np.nan, np.inf
    made = samples.even(strange.copy(), rendered, FACING, FLAT)
    assert np.isfinite(made[np.isfinite(strange)]).all()


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (2, 3)])
def test_small_pictures(size):
    light = np.random.default_rng(1).random((*size, 3), np.float32)
    made = even(light, light[::-1], np.tile(np.float32((0, 0, 1)), (*size, 1)), np.full((*size, 1), 5, np.float32))
    assert made.shape == light.shape and np.isfinite(made).all()


def test_huge_light_stays_as_it_is():
    light = np.full((20, 20, 3), 3e38, np.float32)
    light[::3, ::2] = 1
    assert np.isfinite(even(light, light, FACING[:20, :20], FLAT[:20, :20])).all()
