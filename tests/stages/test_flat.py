# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in few flat colors: what goes, what stays, and the same bytes however they are made."""

from dataclasses import replace

import numpy as np
import pytest
from encre.pen.colour import decode_srgb
from encre.pen.errors import EncreError
from encre.pen.job import Picture
from encre.pen.library import load

CURVE = np.array([decode_srgb(value / 255) for value in range(256)], np.float32)
SKIN, LIPS, HAIR, CLOTH = (np.array(color, float) for color in ((226, 170, 140), (176, 84, 92), (52, 38, 34),
                                                                (40, 92, 120)))
# Letters of two texels a stroke.
LETTERS = np.kron(np.array([[int(bit) for bit in row] for row in (
    "10001011110111001110010001", "10001010000100101001011001", "11111011100100101001010101",
    "10001010000111001001010011", "10001011110100001110010001")]), np.ones((2, 2), int)) == 1


def flat(image, most=24, threads=0, wrap="repeat"):
    """(height, width, 3 or 4) of bytes or linear floats, flat."""
    height, width, channels = image.shape
    whole = np.full((height * width, 4), 255 if image.dtype == np.uint8 else 1, image.dtype)
    whole[:, :channels] = image.reshape(-1, channels)
    made = Picture(whole, width, height, wrap=wrap, curve=CURVE if image.dtype == np.uint8 else None)
    load().flatten(made, most, threads)
    return whole.reshape(height, width, 4)[..., :channels]


def of_bytes(image):
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def colors(image):
    return {tuple(color) for color in np.unique(image.reshape(-1, image.shape[2]), axis=0).tolist()}


def face(size=256, seed=0):
    """A face with painted shade, grain and lips on a ground of hair, as bytes, and the lips' mask."""
    y, x = (np.mgrid[:size, :size] + 0.5) / size
    image = np.where((np.hypot(x - 0.5, y - 0.5) < 0.4)[..., None], SKIN * (1.12 - 0.35 * y)[..., None], HAIR)
    lips = np.hypot((x - 0.5) / 0.12, (y - 0.7) / 0.04) < 1
    image[lips] = LIPS
    return of_bytes(image + np.random.default_rng(seed).normal(0, 3, (size, size, 1))), lips


def within(mask, texels=2):
    """What of a mask is so far from its border."""
    for _ in range(texels):
        mask = mask & np.roll(mask, 1, 0) & np.roll(mask, -1, 0) & np.roll(mask, 1, 1) & np.roll(mask, -1, 1)
    return mask


def test_what_is_drawn_in_a_clean_image_stays_as_it_is():
    """A nose and a mouth of hardly another color went with grain that was not there, and pupils became as light as
    their rims. Slowly painted shade goes."""
    fine = 4
    y, x = (np.mgrid[:512 * fine, :512 * fine] + 0.5) / fine
    shade = 1 - 0.08 * np.clip((y - 330) / 100, 0, 1)
    image = np.where((np.hypot(x - 256, y - 256) < 200)[..., None], np.array((246, 147, 115)) * shade[..., None], HAIR)
    nose, dot = (np.abs(x - 256) < 12) & (np.abs(y - 260) < 4), np.hypot((x - 256) / 6, (y - 300) / 3) < 1
    pupils = [np.hypot(x - at, y - 230.3) < radius for at, radius in ((200.7, 9), (310.2, 3.2))]
    image[nose | dot], image[pupils[0] | pupils[1]] = (244, 122, 92), (36, 16, 17)

    def small(a):
        return a.reshape(512, fine, 512, fine, -1).mean((1, 3))

    got = flat(of_bytes(small(image)), 48).astype(float)
    for part, color in ((nose, (244, 122, 92)), (dot, (244, 122, 92)), *((pupil, (36, 16, 17)) for pupil in pupils)):
        inside = small(part[..., None])[..., 0] == 1
        assert inside.sum() > 10 and np.abs(got[inside] - color).max() < 9, color
    below = got[380:430, 256]
    assert np.ptp(below, 0).max() < 2


def test_shade_and_grain_go_and_lips_stay():
    image, lips = face()
    got = flat(image)
    y, x = (np.mgrid[:256, :256] + 0.5) / 256
    head = np.hypot(x - 0.5, y - 0.5) < 0.4
    assert len(colors(image)) > 500
    for mask, color in ((lips, LIPS), (head & ~lips, SKIN), (~head, HAIR)):
        (own,) = colors(got[within(mask)][None])
        assert np.abs(np.array(own) - color).max() < 14


def test_columns_of_gradients_are_a_color_each():
    """As palettes of game worlds are; the color is the mean of the lighter half, and so no darker than the mean."""
    down = np.linspace(1, 0.75, 64)[:, None, None]
    columns = np.array([SKIN, CLOTH, LIPS, HAIR, (240, 200, 40), (90, 160, 70)])
    got = flat(of_bytes(np.repeat(columns, 16, 0)[None] * down))
    for k, color in enumerate(columns):
        own = colors(got[:, 16 * k + 2:16 * k + 14])
        assert len(own) == 1
        assert (np.array(next(iter(own))) > color * 0.86).all() and (np.array(next(iter(own))) <= color + 1).all()
    assert len(colors(got[32:33, 8::16])) == 6


@pytest.mark.parametrize("paint, ground", [((250, 250, 245), CLOTH), ((30, 30, 34), (230, 200, 60)),
                                           ((200, 40, 40), (235, 232, 220))])
def test_letters_keep_every_texel(paint, ground):
    shade = np.linspace(1, 0.85, 64)[None, :, None]
    image = np.array(ground, float) * np.ones((64, 64, 1)) * shade
    there = np.zeros((64, 64), bool)
    there[20:30, 6:58] = LETTERS
    image[there] = paint
    got = flat(of_bytes(image + np.random.default_rng(1).normal(0, 2, (64, 64, 3)))).astype(float)
    on, off = np.median(got[there], axis=0), np.median(got[~there], axis=0)
    nearer = np.linalg.norm(got - on, axis=2) < np.linalg.norm(got - off, axis=2)
    assert (nearer == there).all()
    assert np.linalg.norm(on - off) > 0.8 * np.linalg.norm(np.array(paint) - ground)


def test_what_is_flat_stays_as_it_is():
    rng = np.random.default_rng(2)
    patches = rng.permutation(np.array([(r, g, b) for r in (20, 235) for g in (20, 128, 235)
                                        for b in (20, 128, 235)], np.uint8))[:16].reshape(4, 4, 3)
    image = np.kron(patches, np.ones((16, 16, 1), np.uint8))
    np.testing.assert_array_equal(flat(image), image)


@pytest.mark.parametrize("most", [1, 2, 3, 5, 8])
def test_no_more_colors_than_are_asked_for(most):
    """Texels at a border are mixed of two, the others are not."""
    patches = np.random.default_rng(3).integers(0, 256, (8, 8, 3)).astype(np.uint8)
    got = flat(np.kron(patches, np.ones((16, 16, 1), np.uint8)), most)
    assert len(colors(got[8::16, 8::16])) == most


def test_strong_colors_outlive_greys():
    image = np.full((128, 128, 3), 120, np.uint8)
    image[:, :60] = 165
    image[40:50, 100:108] = 220, 20, 30
    got = flat(image, 2)
    assert (np.abs(got[45, 104].astype(int) - (220, 20, 30)) < 3).all()


@pytest.mark.parametrize("dull, gray", [((105, 117, 135), 118), ((60, 66, 80), 66)])
def test_a_dull_blue_stays_blue_beside_a_gray_that_is_as_light(dull, gray):
    image = np.full((128, 128, 3), gray, float)
    image[:, 64:] = dull
    drawn = flat(of_bytes(image + np.random.default_rng(5).normal(0, 2, (128, 128, 1)))).astype(int)
    assert np.abs(drawn[:, 70:] - dull).max() <= 8 and np.ptp(drawn[:, :58], axis=2).max() <= 3
    assert len(colors(drawn[:, 70:])) == len(colors(drawn[:, :58])) == 1


def test_grass_is_patches():
    rng = np.random.default_rng(4)
    blades = rng.normal(0, 1, (256, 256))
    for axis in (0, 0, 0, 1):
        blades = (blades + np.roll(blades, 1, axis)) * 0.5
    image = of_bytes(np.array((90, 120, 50)) * (1 + 0.9 * blades[..., None]))
    step = [np.abs(np.diff(of.astype(float), axis=1)).sum(2) > 12 for of in (image, flat(image))]
    assert step[0].mean() > 0.8 and step[1].mean() < 0.4 * step[0].mean()


def test_what_alpha_leaves_out_stays():
    image = np.dstack([face(64)[0], np.zeros((64, 64), np.uint8)])
    image[:, 32:, 3] = 255
    got = flat(image)
    np.testing.assert_array_equal(got[:, :32], image[:, :32])
    np.testing.assert_array_equal(got[..., 3], image[..., 3])
    assert (got[:, 32:] != image[:, 32:]).any()


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_the_same_bytes_on_any_number_of_threads(kind):
    image = face(300, 5)[0]
    image = image if kind == np.uint8 else CURVE[image]
    one = flat(image, 12, 1)
    assert (one != image).any()
    for threads in (2, 4, 7):
        assert flat(image, 12, threads).tobytes() == one.tobytes()


def test_bytes_and_floats_are_made_flat_alike():
    image = face(128)[0]
    assert np.abs(CURVE[flat(image)] - flat(CURVE[image])).max() < 0.01


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (2, 2), (5, 7), (1100, 3), (3, 2100)])
@pytest.mark.parametrize("wrap", ["repeat", "extend"])
def test_images_of_any_size(size, wrap):
    image = np.random.default_rng(6).integers(0, 256, (*size, 3)).astype(np.uint8)
    got = flat(image, 3, wrap=wrap)
    assert got.shape == image.shape and flat(np.full_like(image, 77), wrap=wrap).min() == 77


def test_large_images_are_sharp_to_the_texel():
    image = np.full((2048, 2048, 3), 240, np.uint8)
    image[301:305, 5:2000], image[700:1401, 701] = 20, (200, 30, 30)
    image[1501:1777, 303:1311] = CLOTH
    got = flat(image)
    assert (got[1501:1777, 303:1311] == CLOTH).all() and (got[1500, 303:1311] == 240).all()
    assert (got[301:305, 10:1990] == 20).all() and (got[299:301, 10:1990] == 240).all()


def test_numbers_that_are_none_end_nothing():
    image = np.random.default_rng(7).random((32, 32, 3)).astype(np.float32)
    image[3, 4], image[9], image[20, 20:] = np.nan, np.inf, -3e38
    assert np.isfinite(flat(image)).all()


@pytest.mark.parametrize("change, most", [({"texels": np.zeros((15, 4), np.uint8)}, 4), ({}, 0), ({}, 65),
                                          ({"texels": np.zeros((16, 4), np.uint8)[::-1]}, 4)])
def test_what_cannot_be_made_flat_is_refused(change, most):
    with pytest.raises(EncreError, match="^(texture|texels|flat colors)"):
        load().flatten(replace(Picture(np.zeros((16, 4), np.uint8), 4, 4, curve=CURVE), **change), most)
