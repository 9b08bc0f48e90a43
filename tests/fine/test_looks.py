# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines as presets have them, on layers by formula."""

import numpy as np
import pytest
from encre.pen import library, presets

HEIGHT, WIDTH = 1080, 120


def drawn(name, seed=0, **own):
    """The ink of a preset's lines, with those of shade, over a plain wall, and over what is given of it."""
    one = np.ones((HEIGHT, WIDTH, 3), np.float32)
    layers = dict(combined=np.ones((HEIGHT, WIDTH, 4), np.float32), color=0.8 * one, diffuse=one, normal=one,
                  depth=5 * one[..., 0], object=one[..., 0])
    layers = {**layers, **{id_: np.float32(a) for id_, a in own.items()}}
    values = presets.find(name).values | dict(use_tones=False, pen_1_seed=seed, line_shadow_strength=4.0)
    return library.render(layers, values, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]


def parted(one, other, channels=0):
    """One value left of the middle, another right of it."""
    halves = np.where(np.arange(WIDTH) < WIDTH // 2, one, other) * np.ones((HEIGHT, 1))
    return np.repeat(halves[..., None], channels, -1) if channels else halves


def shade_and_contour(name):
    """The ink of each row, of a border of shade and of a contour."""
    return (drawn(name, **layers).sum(1)[20:-20]
            for layers in (dict(diffuse=parted(1, 0.1, 3)), dict(object=parted(1, 2), depth=parted(5, 9))))


def test_ink_dots_borders_of_shade():
    """Whole lines looked like contours, and gaps here and there like errors: dots are even."""
    shade, contour = shade_and_contour("Ink only")
    assert (contour > 0.2).all() and 0.05 < shade.mean() < 0.2 * contour.mean()
    white = np.flatnonzero(shade < 0.05)
    dots = np.diff(white)[np.diff(white) > 1]
    assert len(dots) > 60 and dots.max() < 12 and np.diff(np.flatnonzero(shade > 0.05)).max() < 16


def test_pencils_borders_of_shade_are_faint_and_whole():
    shade, contour = shade_and_contour("Pencil")
    assert (contour > 0.2).all() and (shade > 0.03).all()
    assert 0.05 < shade.mean() < 0.2 * contour.mean()


@pytest.mark.parametrize("name", ["Pencil", "Ink only"])
def test_far_things_are_drawn_lighter(name):
    """Hills behind a harbour weighed as much as its rail."""
    near, far = (drawn(name, object=parted(1, 2), depth=parted(z, 2 * z)).sum() for z in (1.5, 30))
    assert 0.05 * near < far < 0.6 * near, (near, far)


@pytest.mark.parametrize("name", ["Stippled", "Hatched", "Manga", "Heavy blacks", "Superhero"])
def test_no_part_of_a_contour_is_lost(name):
    """However a hand presses: small heads lay in a light place of it, and had none."""
    wide = [drawn(name, seed, object=parted(1, 2), depth=parted(5, 9)).sum(1)[20:-20] for seed in range(10)]
    assert np.min(wide) > 0.22 * np.median(wide), np.min(wide) / np.median(wide)


def test_paving_is_no_net():
    """Of courses that are 24 px high lines cover a quarter."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    joint = ((rows % 24 < 3) | ((columns + 20 * (rows // 24 % 2)) % 40 < 3))[..., None]
    ink = drawn("Clear line", color=np.where(joint, 0.1, 0.6) * np.ones(3))
    assert 0.1 < ink[40:-40, 10:-10].mean() < 0.3
