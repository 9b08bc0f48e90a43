# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines in textures: against the reference, byte for byte across threads and builds, and what bad input gets."""

import kept
import numpy as np
import pytest
from encre.pen import library
from encre.pen.errors import Cancelled, EncreError
from reference import DEFAULTS, metric
from reference import bake as reference

METRICS = ("RGB", "CIE76", "CIEDE2000", "CMC")
WRAPS = [(True, True), (True, False), (False, True), (False, False)]


def blots(height, width, seed=0, channels=3, soft=False):
    """Areas of one colour with sharp edges, or noise."""
    rng = np.random.default_rng(seed)
    y, x = np.indices((height, width))
    out = np.full((height, width, channels), 0.5)
    for _ in range(6):
        cy, cx, r = rng.uniform(0, height), rng.uniform(0, width), rng.uniform(0.5, 0.5 * max(height, width))
        inside = np.abs(y - cy) + np.abs(x - cx) < r if rng.random() < 0.5 else np.hypot(y - cy, x - cx) < r
        out[inside] = rng.random(channels)
    if soft:
        out = (out + np.roll(out, 1, 0) + np.roll(out, 1, 1)) / 3 + 0.01 * rng.random(out.shape)
    return out.astype(np.float32)


def forms(height, width, seed=0, stretch=2.0):
    rng = np.random.default_rng(seed)
    a = rng.normal(0, 1, (height, width, 2, 2)) * stretch + np.eye(2)
    m = a.swapaxes(2, 3) @ a + 0.05 * np.eye(2)
    return np.stack([m[..., 0, 0], m[..., 0, 1], m[..., 1, 1]], -1).astype(np.float32)


def smooth_forms(height, width):
    y, x = np.indices((height, width)) / max(height, width, 2)
    return np.stack([0.2 + 3 * x, 0.3 * np.sin(3 * x + y), 2.5 - 2 * y], -1).astype(np.float32)


def check(texture, scene=None, tolerance=1e-4, **options):
    want, greatest = kept.of(reference.bake, texture, {**DEFAULTS, **(scene or {})}, **options)
    got = library.bake(texture, scene, **options)
    assert got.greatest == pytest.approx(greatest, abs=2e-5)
    assert np.abs(got.texture - want).max() <= tolerance
    return got.texture


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("size", [(1, 1), (1, 7), (9, 1), (2, 3), (19, 27), (37, 16)])
def test_discs(size, wrap):
    for seed, thickness in enumerate((3.0, 8.0, 21.0)):
        scene = dict(line_thickness=thickness, contrast_full=0.6)
        check(blots(*size, seed), scene, wrap=wrap)
        check(blots(*size, seed, 4, soft=True), scene, wrap=wrap)
        check(np.random.default_rng(seed).random((*size, 3), np.float32), scene, wrap=wrap)


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("size", [(1, 1), (1, 7), (9, 1), (2, 3), (17, 23)])
def test_ellipses(size, wrap):
    wrap = (wrap[0] and size[1] > 1, wrap[1])  # by shear a single column may be inked best by a far repetition
    for seed, thickness in enumerate((2.0, 7.0)):
        scene = dict(line_thickness=thickness, contrast_full=0.6)
        check(blots(*size, seed), scene, form=smooth_forms(*size), wrap=wrap, tolerance=5e-4)
        check(blots(*size, seed, 4, soft=True), scene, form=forms(*size, seed, 0.5), wrap=wrap, tolerance=5e-4)


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("kind", METRICS)
def test_metrics(kind, linear):
    texture = blots(24, 35, 3)
    if linear:
        texture = (texture * 1.2 - 0.1).astype(np.float32)
    for threshold, most in ((0.01, 1.0), (0.2, 0.5), (0.3, 0.1)):
        check(texture, dict(contrast_metric=kind, contrast_threshold=threshold, contrast_full=most), linear=linear,
              tolerance=1e-3)


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("window", [1.0, 7.0, 16.0, 500.0])
def test_local_contrast(window, wrap):
    texture = blots(23, 31, 5) * 0.4
    texture[:, 20:] *= 2
    check(texture, dict(contrast_local=True, contrast_window=window), wrap=wrap)


def test_a_boundary_gives_the_thickness_asked():
    """Between black and white the line is line_thickness wide at half darkness, both ways of drawing."""
    texture = np.ones((40, 160, 3), np.float32)
    texture[:, :80] = 0.5
    thickness = 9.0
    contrast = library.bake(texture, draw=False).greatest
    scene = dict(line_thickness=thickness, contrast_full=contrast)
    for form in (None, np.tile(np.float32((1, 0, 1)), (40, 160, 1))):
        got = library.bake(texture, scene, form, wrap=(False, False)).texture[20, :, 0] / texture[20, :, 0]
        assert (1 - got).sum() == pytest.approx(thickness, abs=1e-4)
    for e in (0.3, 2.0, 7.0):  # on the surface a texel is sqrt(e) wide
        got = library.bake(texture, scene, np.tile(np.float32((e, 0, 1)), (40, 160, 1)), wrap=(False, False)).texture
        assert (1 - got[20, :, 0] / texture[20, :, 0]).sum() * e**0.5 == pytest.approx(thickness, abs=1e-3)


def test_nothing_is_drawn_on_one_colour():
    texture = np.full((16, 16, 4), 0.3, np.float32)
    assert library.bake(texture).texture.tobytes() == texture.tobytes()


def test_alpha_is_kept():
    texture = blots(30, 30, 1, 4)
    assert np.array_equal(library.bake(texture).texture[..., 3], texture[..., 3])


@pytest.mark.parametrize("scene", [{}, dict(contrast_local=True), dict(contrast_metric="CMC", line_thickness=40.0)])
@pytest.mark.parametrize("stretched", [False, True])
def test_same_bytes(scene, stretched):
    texture = blots(203, 157, 7, 4)
    form = smooth_forms(203, 157) if stretched else None
    want = library.bake(texture, scene, form, threads=1).texture.tobytes()
    for threads in (2, 3, 8):
        assert library.bake(texture, scene, form, threads=threads).texture.tobytes() == want
    assert library.bake(texture, scene, form, simd=0).texture.tobytes() == want
    mirrored = form[::-1] * np.float32((1, -1, 1)) if stretched else None
    upside = library.bake(texture[::-1][:, :, :3], scene, mirrored).texture[::-1]
    assert np.abs(upside - library.bake(texture[:, :, :3], scene, form).texture).max() < 2e-3  # strides of any kind


def test_not_finite():
    texture = blots(20, 20, 2, 4)
    texture[3, 4, 0], texture[5, 6, 1], texture[7, 8, 3] = np.nan, np.inf, -np.inf
    got = library.bake(texture)
    assert got.nonfinite == 3 and np.isfinite(got.texture).all()
    assert np.abs(got.texture - reference.bake(texture, DEFAULTS)[0]).max() < 1e-4


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf, 1e30])
def test_forms_that_are_none(bad):
    texture, form = blots(20, 30, 2), np.full((20, 30, 3), bad, np.float32)
    got = library.bake(texture, {}, form).texture
    neutral = library.bake(texture, {}, np.tile(np.float32((1, 0, 1)), (20, 30, 1))).texture
    assert got.tobytes() == neutral.tobytes()


@pytest.mark.parametrize("form", [(1e-12, 0, 1), (1, 0, 1e-12), (1, 1, 1), (4, -2, 1), (1e10, 0, 1e-10), (1e-30, 0, 0)])
def test_collapsed_forms(form):
    got = library.bake(blots(20, 30, 2), {}, np.tile(np.float32(form), (20, 30, 1))).texture
    assert np.isfinite(got).all()


def test_cancel_and_progress():
    texture, seen = blots(200, 200), []
    library.bake(texture, threads=1, progress=lambda f: seen.append(f) or True)
    assert seen == sorted(seen) and seen[0] > 0 and seen[-1] == 1
    for k in range(len(seen)):
        count = iter(range(len(seen)))
        with pytest.raises(Cancelled):
            library.bake(texture, threads=1, progress=lambda _f, n=count, k=k: next(n) < k)


@pytest.mark.parametrize("texture, form, words", [
    (np.zeros((0, 4, 3)), None, "give at least one pixel"),
    (np.zeros((4, 4, 2)), None, "give (height, width, 3 or 4)"),
    (np.zeros((4, 4)), None, "give (height, width, 3 or 4)"),
    (np.zeros((1, 32769, 3)), None, "give 1 to 32768"),
    (np.zeros((4, 4, 3)), np.zeros((4, 5, 3)), "give all images the same size"),
    (np.zeros((4, 4, 3)), np.zeros((4, 4, 2)), "give (height, width, 3)"),
])
def test_refuses(texture, form, words):
    with pytest.raises(EncreError) as error:
        library.bake(texture, {}, form)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_refuses_values():
    with pytest.raises(EncreError, match="line_thickness"):
        library.bake(blots(4, 4), dict(line_thickness=-1.0))


@pytest.mark.parametrize("most", [1.0, 0.04])
def test_decodes(most):
    """CIE differences of encoded values see the same light as those of linear ones, in the dark too."""
    encoded = np.random.default_rng(0).random((16, 16, 3)).astype(np.float32) * np.float32(most)
    light = metric.decode(encoded.astype(float)).astype(np.float32)
    for kind in METRICS:
        one, two = (library.bake(t, dict(contrast_metric=kind), linear=x, draw=False).greatest
                    for t, x in ((encoded, False), (light, True)))
        assert one == pytest.approx(two, rel=1e-3)
