# SPDX-License-Identifier: GPL-3.0-or-later
"""Paper: the sheet that is computed, and images of one."""

import ctypes

import numpy as np
import pytest
from encre.pen import library
from encre.pen.errors import Cancelled
from encre.pen.job import Frame
from encre.pen.library import load
from reference import paper as reference_paper

ONLY_HATCHING = dict(use_lines=False, use_shading=False, use_smudging=False, length_unit="PIXELS", hatch_amount=0.7,
                     hatch_light_threshold=0, hatch_color_threshold=1.0, hatch_color_light=0.0)
IMAGE = dict(paper_source="IMAGE", paper_image="grain.png")


def heights(width, height, scene=(), image=None, **how):
    """The paper as hatching sees it: over white light and a colour of 0.3, T = 2.5 (amount h - 0.3)."""
    ones = np.ones((height, width, 4), np.float32)
    layers = dict(combined=ones, color=ones[..., :3] * np.float32(0.3), diffuse=ones[..., :3] * np.float32(1 / 0.3),
                  normal=ones[..., :3], depth=ones[..., :1])
    scene = dict(ONLY_HATCHING, **dict(scene), **({} if image is None else IMAGE))
    drawn = library.render(layers, scene, image=lambda _: image, outputs=["Combined"], **how).images["Combined"]
    return (1 - np.float64(drawn[..., 0])) / 2.5 / 0.7 + 0.3 / 0.7


@pytest.mark.parametrize("seed, kind", [(0, "COLD_PRESS"), (1, "COLD_PRESS"), (2**31 - 1, "COLD_PRESS"), (0, "ROUGH"),
                                        (5, "HOT_PRESS"), (0, "LAID"), (2, "BRISTOL")])
def test_the_sheet_is_the_recipe(seed, kind):
    np.testing.assert_allclose(heights(520, 515, dict(paper_seed=seed, paper_source=kind)),
                               np.pad(reference_paper.sheet(seed, kind), ((0, 3), (0, 8)), "wrap"), atol=5e-7)


@pytest.mark.parametrize("kind", reference_paper.KINDS)
def test_each_sheet_is_evenly_spread_and_of_its_kind(kind):
    """How like the next texel aside and down it is, and the one a laid line further."""
    sheet = heights(512, 512, dict(paper_source=kind))
    share, _ = np.histogram(sheet, 8, (0.6, 1.0))
    assert np.ptp(share) < 0.01 * share.mean()
    assert np.ptp(sheet.reshape(16, 32, 16, 32).mean((1, 3))) < 0.035, "a blotch would show the tiling"
    power = np.abs(np.fft.fft2(sheet - sheet.mean())) ** 2
    alike = np.fft.ifft2(power).real / power.mean()
    fine = {"HOT_PRESS": (0.6, 0.72), "LAID": (0.68, 0.8), "COLD_PRESS": (0.68, 0.76), "BRISTOL": (0.74, 0.84),
            "ROUGH": (0.78, 0.9)}[kind]
    assert fine[0] < alike[0, 1] < fine[1]
    assert (alike[8, 0] > 0.1) == (kind == "LAID")


def test_the_sheet_is_evenly_spread_and_even():
    sheet = heights(512, 512)
    assert sheet.min() >= 0.6 - 1e-6 and sheet.max() <= 1 + 1e-6
    assert abs(sheet.mean() - 0.8) < 1e-6
    share, _ = np.histogram(sheet, 8, (0.6, 1.0))
    assert np.ptp(share) < 0.01 * share.mean()
    blocks = sheet.reshape(16, 32, 16, 32).mean((1, 3))
    assert np.ptp(blocks) < 0.035, "a blotch would show the tiling"
    power = np.abs(np.fft.fft2(sheet - sheet.mean())) ** 2
    alike = np.fft.ifft2(power).real / power.mean()
    assert 0.68 < alike[0, 1] < 0.76 and 0.68 < alike[1, 0] < 0.76, "grain of two pixels and more"
    assert abs(alike[0, 1] - alike[1, 0]) < 0.02, "no grain direction"
    assert np.abs(alike[16:-16, 16:-16]).max() < 0.03, "no repetition within the sheet"
    f = np.hypot(*np.meshgrid(*[np.fft.fftfreq(512)] * 2))
    rings = [power[(f >= low) & (f < 1.4 * low)].mean() / power.mean() for low in (0.06, 0.09, 0.125, 0.18)]
    assert rings == sorted(rings, reverse=True), "tooth of many sizes: of one alone it reads as worms"


def test_how_light_a_scan_is_does_not_tell_how_much_pencil_there_is():
    sheet = np.random.default_rng(0).uniform(-0.2, 0.2, (32, 32, 1)).astype(np.float32)
    light, dark = (heights(64, 64, dict(length_unit="PIXELS"), sheet + np.float32(mean)) for mean in (0.95, 0.4))
    assert abs(light.mean() - 0.8) < 2e-3 and np.abs(light - dark).max() < 1e-5


def test_another_seed_is_another_sheet():
    a, b = heights(200, 200), heights(200, 200, dict(paper_seed=1))
    assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.02


def test_a_sheet_that_is_kept_is_the_one_asked_for():
    first = None
    for cancelled_after in None, 0, 1, 3:
        heights(60, 40, dict(paper_seed=8), threads=1)
        if cancelled_after is not None:
            calls = iter([True] * cancelled_after + [False])
            with pytest.raises(Cancelled):
                heights(60, 40, dict(paper_seed=7), threads=1, progress=lambda _, calls=calls: next(calls))
        drawn = heights(60, 40, dict(paper_seed=7), threads=1)
        first = drawn if first is None else first
        np.testing.assert_array_equal(drawn, first)
        load().forget()
    np.testing.assert_array_equal(heights(60, 40, dict(paper_seed=7), threads=1), first)


@pytest.mark.parametrize("scale", [1.0, 0.37, 2.6])
def test_a_border_shows_its_piece_of_the_sheet(scale):
    scene = dict(paper_scale=scale, length_unit="PIXELS")
    whole = heights(700, 560, scene)
    piece = heights(90, 40, scene, frame=Frame(700, 560, 600, 515))
    np.testing.assert_array_equal(piece, whole[515:555, 600:690])


@pytest.mark.parametrize("channels", [0, 1, 2, 3, 4])
@pytest.mark.parametrize("scale", [1.0, 1.7, 0.3])
def test_an_image_is_paper(channels, scale):
    shape = (7, 13, channels) if channels else (7, 13)
    image = np.random.default_rng(channels).uniform(0.5, 1.0, shape).astype(np.float32)
    image[3, 4] = np.nan
    grey = {0: image, 1: image, 2: image[..., :1]}.get(channels, image)
    grey = grey.reshape(7, 13, -1)
    expected = reference_paper.heights(
        _Place(50, 60), _Values(dict(paper_source="IMAGE", paper_scale=scale, paper_roughness=0.8,
                                     paper_image=grey[..., 0] if grey.shape[-1] == 1 else grey)))[0]
    got = heights(60, 50, dict(paper_scale=scale, paper_roughness=0.8, length_unit="PIXELS"), image)
    visible = expected > 0.45
    np.testing.assert_allclose(got[visible], expected[visible], atol=1e-5)


class _Place:
    """What the reference's paper wants to know of the layers."""

    def __init__(self, height, width):
        self.depth, self.x, self.y, self.full_height = np.zeros((height, width)), 0, 0, height


class _Values(dict):
    def pixels(self, full_height):
        return 1.0


def test_the_library_looks_at_the_image():
    for size, refused in (((4, 4, 5), True), ((1, 2, 1), False), ((2, 1, 3), False), ((1, 1, 4), False)):
        block, keep = load().pack({}, {"paper_image": np.zeros(size, np.float32)})
        found = load().lib.encre_params_check(block, ctypes.create_string_buffer(400), 400)
        assert keep and (b"paper_image" in found if refused else not found)
