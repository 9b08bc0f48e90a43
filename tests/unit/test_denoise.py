# SPDX-License-Identifier: GPL-3.0-or-later
"""Light without noise: up to the frame's edge, in strips, in parts of a frame. By bpy's Open Image Denoise."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from encre.pen import denoise
from encre.pen.errors import Cancelled
from hypothesis import given
from hypothesis import strategies as st

SPEC = importlib.util.find_spec("bpy")
HOME = SPEC and str(Path(SPEC.origin).parent)


@pytest.fixture(autouse=True)
def needs_library():
    if not denoise.available(HOME):
        pytest.skip("needs Open Image Denoise")


def noisy(height, width, seed=0):
    """(clean light, with noise as of few samples, albedo, normal) of two walls."""
    rng = np.random.default_rng(seed)
    light = np.full((height, width, 3), 0.8, np.float32)
    light[height // 2:] *= 0.5
    albedo = np.full_like(light, 0.7)
    normal = np.zeros_like(light)
    normal[:height // 2, :, 2], normal[height // 2:, :, 1] = 1, -1
    return light, light * rng.exponential(1, (height, width, 1)).astype(np.float32), albedo, normal


def test_edges_of_the_frame_are_as_clean_as_its_middle():
    light, noise, albedo, normal = noisy(160, 240)
    wrong = np.abs(denoise.denoise(noise, albedo, normal, 2, home=HOME) - light).mean(2) / light.mean(2)
    middle = wrong[16:-16, 16:-16].mean()
    assert middle < 0.1
    edges = [edge.mean() for edge in (wrong[:3], wrong[-3:], wrong[:, :3], wrong[:, -3:])]
    assert np.mean(edges) < 1.5 * middle


def test_no_light_runs_out_to_where_nothing_is():
    """There it would be a shadow that a catcher shows: black crumbs in a light sky, by tones."""
    _, noise, albedo, normal = noisy(120, 160)
    outside = np.zeros((120, 160), bool)
    outside[:, 100:], outside[20:50, 20:60] = True, True
    for layer in noise, albedo, normal:
        layer[outside] = 0
    clean = denoise.denoise(noise, albedo, normal, 2, home=HOME)
    assert not clean[outside].any() and clean[~outside].all()


def test_strips_are_the_whole(monkeypatch):
    _, *given = noisy(500, 150)
    asked = []
    monkeypatch.setattr(denoise, "_PIXELS", 1)
    monkeypatch.setattr(denoise, "_ROWS", 5000)
    whole = denoise.denoise(*given, 2, lambda: asked.append(1) or True, HOME)
    monkeypatch.setattr(denoise, "_ROWS", 128)
    strips = denoise.denoise(*given, 2, lambda: asked.append(2) or True, HOME)
    assert np.abs(strips - whole).max() < 1e-6
    assert asked.count(1) == 1 and asked.count(2) == 4


def test_a_part_of_a_frame_is_cleaned_as_in_the_whole():
    _, *given = noisy(420, 300)
    given[1][:40], given[2][:40] = 0, 0  # nothing is there
    whole = denoise.denoise(*given, 2, home=HOME)
    x, y, reach = 37, 101, 96
    part = denoise.denoise(*(image[y:, x:] for image in given), 2, home=HOME, at=(x, y))
    same = whole[y:, x:]
    assert np.abs(part - same)[reach:, reach:].max() < 1e-6
    assert np.abs(part - same)[:8].max() > 1e-3, "what lies beyond is not known there"


def test_only_where_something_is():
    _, noise, albedo, normal = noisy(90, 120)
    there = np.s_[20:70, 30:100]
    for guide in (albedo, normal):
        inside = guide[there].copy()
        guide[...] = 0
        guide[there] = inside
    clean = denoise.denoise(noise, albedo, normal, 2, home=HOME)
    changed = (clean != noise).any(2)
    assert changed[there].mean() > 0.99
    changed[there] = False
    assert not changed.any()
    nothing = np.zeros_like(albedo)
    assert np.array_equal(denoise.denoise(noise, nothing, nothing, 2, home=HOME), noise)


def test_asked_on_this_thread_and_cancelled_between_strips(monkeypatch):
    import threading

    _, *given = noisy(500, 80)
    monkeypatch.setattr(denoise, "_ROWS", 128)
    monkeypatch.setattr(denoise, "_PIXELS", 1)
    asked = []

    def keep_on():
        asked.append(threading.get_ident())
        return len(asked) < 3

    with pytest.raises(Cancelled):
        denoise.denoise(*given, 2, keep_on, HOME)
    assert asked == 3 * [threading.get_ident()]


@pytest.mark.parametrize("size", [(1, 1), (1, 70), (40, 3)])
def test_small_pictures(size):
    _, *given = noisy(*size)
    clean = denoise.denoise(*given, 2, home=HOME)
    assert clean.shape == (*size, 3) and np.isfinite(clean).all()


def test_scale_and_draft():
    light, *given = noisy(128, 128)

    def wrong(**more):
        return np.abs(denoise.denoise(*given, 2, home=HOME, **more) - light).mean()

    good = wrong()
    assert wrong(scale=0.5) < 1.3 * good and wrong(fast=True) < 2 * good
    dark = [given[0] * np.float32(1e-3), *given[1:]]
    assert np.abs(1e3 * denoise.denoise(*dark, 2, home=HOME, scale=1e3) - light).mean() < 1.1 * good


@given(st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_boxes_hold_all_and_are_far_from_each_other(seed, share):
    """As far as is looked at around both of two."""
    rng = np.random.default_rng(seed)
    there = np.zeros(rng.integers(1, 400, 2), bool)
    for row, column in rng.integers(0, there.shape, (int(12 * share), 2)):
        there[row:row + rng.integers(1, 80), column:column + rng.integers(1, 80)] = True
    boxes, covered = denoise.boxes(there), np.zeros(there.shape, int)
    for rows, columns in boxes:
        covered[rows, columns] += 1
        inside = there[rows, columns]
        assert all(line.any() for line in (inside[0], inside[-1], inside[:, 0], inside[:, -1])), "none is too large"
        grown = [slice(max(0, at.start - 64), at.stop + 64) for at in (rows, columns)]
        assert there[tuple(grown)].sum() == inside.sum() or len(boxes) == 1
    assert covered.max(initial=0) <= 1 and (covered[there] == 1).all()


def test_what_mirrors_show_is_clean_where_they_are():
    rng = np.random.default_rng(4)
    normal = np.zeros((120, 160, 3), np.float32)
    normal[..., 2] = 1
    normal[:, 80:] = (0, 0.6, 0.8)
    noisy = np.where(rng.random((120, 160, 1)) < 0.3, np.float32((0.8, 0, 0.6)), normal).astype(np.float32)
    truth = 0.7 * normal + 0.3 * np.float32((0.8, 0, 0.6))
    where = np.zeros(noisy.shape[:2], bool)
    where[20:100, 30:130] = True
    clean = denoise.seen(noisy, where, "normal", 2, home=HOME)
    assert np.array_equal(clean[~where], noisy[~where])
    wrong = np.abs(clean - truth).mean(2)
    assert wrong[where].mean() < 0.2 * np.abs(noisy - truth).mean(2)[where].mean()
    assert wrong[30:90, 78:82].mean() < 0.1, "the edge between two faces stays"
    with pytest.raises(Cancelled):
        denoise.seen(noisy, where, "albedo", 2, lambda: False, HOME)
    assert np.array_equal(denoise.seen(noisy, where & False, "albedo", 2, home=HOME), noisy)
