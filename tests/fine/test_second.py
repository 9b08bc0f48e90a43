# SPDX-License-Identifier: GPL-3.0-or-later
"""The second ink of lines through dark areas: it begins as a point, and swells along the line."""

import numpy as np
import pytest
from encre.pen import library

PEN = dict(edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=0.0,
           length_unit="PIXELS",
           pen_1_softness=0.0, pen_1_steepness=0.5, pen_1_intensity=2.0, pen_1_grain=0.0, use_shading=False,
           use_smudging=False,
           use_hatching=False, paper_source="NONE", line_thickness=6.0, ink_on_dark=1.0)
HEIGHT, WIDTH = 240, 60


def whites(value, painted=False, **values):
    """The width of what is white along an upright line of 6 pixels, by row, on a ground of so much light (H, W); it is
    between two things, or colours."""
    object_ = np.zeros((HEIGHT, WIDTH, 1), np.float32)
    flat, color = np.ones((2, HEIGHT, WIDTH, 3), np.float32)
    (color if painted else object_)[:, WIDTH // 2:] = 0 if painted else 1
    ground = np.ones((HEIGHT, WIDTH, 4), np.float32)
    ground[..., :3] = value[..., None]
    layers = {"combined": ground, "color": color, "diffuse": flat, "normal": flat, "depth": 5 * flat[..., :1],
              "object": object_}
    lines = library.render(layers, {**PEN, **values}, outputs=("Encre Lines",)).images["Encre Lines"]
    return lines[..., 0].sum(1)


def ground(*dark):
    """White, and black in these rows."""
    rows = np.arange(HEIGHT)[:, None] + 0 * np.arange(WIDTH)
    return 1 - np.any([(rows >= first) & (rows < end) for first, end in dark], 0).astype(float)


def test_white_begins_as_a_point_and_swells_to_the_width_of_the_line():
    width = whites(ground((60, 180)))
    assert width[:60].max() == width[180:].max() == 0
    assert np.abs(np.diff(width)).max() < 1.1  # no square: from a pixel on it swells by a quarter a row
    assert np.abs(width[100:140] - 6).max() < 0.1
    rise = np.flatnonzero(width > 3)[0] - np.flatnonzero(width > 0.3)[0]
    assert 6 <= rise <= 24
    assert np.abs(width[60:180] - width[60:180][::-1]).max() < 0.6


def test_a_long_dark_is_white_and_a_short_one_stays_black():
    """What is dark over less than a width or two of the line would be a row of ticks."""
    ticks = whites(ground(*((k, k + 12) for k in range(20, 220, 24))))
    assert ticks.max() < 0.3
    assert whites(ground((60, 100))).max() > 1


@pytest.mark.parametrize("share", [0.01, 0.5])
def test_little_of_the_second_ink_narrows_a_line_by_little(share):
    """So that nothing jumps as the slider leaves 0."""
    value = ground((60, 180))
    assert np.abs(whites(value, ink_on_dark=share)[100:140] - 6 * share).max() < 0.1
    both = whites(value, ink_on_dark=share, ink_color=(1.0, 1.0, 1.0))  # all of the line
    assert np.abs(both[:60] - 6).max() < 0.1 and 6 * (1 - share) - 0.1 < both[6:-6].min() < 6 - 3 * share


@pytest.mark.parametrize("thick", [2.0, 4.0])
def test_white_comes_by_degrees_as_its_black_gets_wider(thick):
    """Lines on a post, all along it: they came and went as a whole when it moved by a part of a pixel."""
    off = np.abs(np.arange(WIDTH) + 0.5 - WIDTH // 2) + np.zeros((HEIGHT, 1))
    width = [whites(np.clip(off - half + 0.5, 0, 1), line_thickness=thick)[100:140].mean()
             for half in np.arange(3, 10, 0.25)]
    assert width[0] == 0 and abs(width[-1] - thick) < 0.1
    assert np.diff(width).max() < 0.45 * thick and np.diff(width).min() > -0.01


def test_white_goes_on_where_lines_cross():
    """A line through the dark is as wide on both sides of where another crosses it."""
    object_ = np.zeros((120, 120, 1), np.float32)
    object_[60:] = 1
    object_[:, 60:] += 2
    flat = np.ones((120, 120, 3), np.float32)
    layers = {"combined": np.zeros((120, 120, 4), np.float32), "color": flat, "diffuse": flat, "normal": flat,
              "depth": 5 * flat[..., :1], "object": object_}
    layers["combined"][:, :, 3] = 1
    layers["combined"][:62, :, :3] = 1
    lines = library.render(layers, PEN, outputs=("Encre Lines",)).images["Encre Lines"]
    width = lines[..., 0].sum(1)
    assert width[:60].max() == 0 and np.abs(np.diff(width[72:])).max() < 0.5 and np.abs(width[105:115] - 6).max() < 0.1


def test_what_is_thinner_than_a_pixel_leaves_the_black_black():
    """Lines that stand close, as those of far leaves, thin out, and hairs of white were a grey veil over the black."""
    value = ground((0, HEIGHT))
    width = [whites(value, line_thickness=thick)[100:140].mean() for thick in (0.35, 0.6, 1.0, 2.0)]
    assert width[0] == 0 and 0 < width[1] < 0.3
    np.testing.assert_allclose(width[2:], [1, 2], atol=0.05)


def test_a_bright_rope_before_black_stays_bright():
    """Its contours, which would be black on black, took most of it."""
    y, x = np.mgrid[:80, :80].astype(float)
    for width in (3.0, 5.0, 8.0):
        for slant in (0.0, 0.3, 0.8):
            off = (x - 40.3) * np.cos(slant) + (y - 40) * np.sin(slant)
            rope, flat = (np.abs(off) < width / 2)[..., None], np.ones((80, 80, 3))
            layers = dict(combined=np.concatenate([rope * flat, flat[..., :1]], -1), color=0.5 * flat, diffuse=flat,
                          normal=np.where(rope, (0, 0, 1.0), (0, 1, 0)), depth=np.where(rope, 4.0, 9.0),
                          object=np.where(rope, 2.0, 1.0))
            layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
            pen = PEN | dict(line_thickness=5.0)
            white = library.render(layers, pen, outputs=("Combined",)).images["Combined"][20:60, ..., 0].sum(1)
            across = white.mean() * np.cos(slant)
            assert 0.7 * width < across < width + 1, (width, slant)
            layers["combined"][..., :3] = np.where(rope, 1, 0.9)  # before what is light it has contours
            ink = library.render(layers, pen, outputs=("Encre Lines",)).images["Encre Lines"][20:60, ..., 3].sum(1)
            assert ink.mean() * np.cos(slant) > 3, (width, slant)


@pytest.mark.parametrize("wide", [0.5, 0.75])
def test_white_lines_are_as_thin_as_asked_but_no_hairs(wide):
    """Six pixels wide on black, and one."""
    value = np.zeros((HEIGHT, WIDTH))
    assert np.abs(whites(value, ink_dark_width=wide)[100:140] - 6 * wide).max() < 0.1
    thin = dict(line_thickness=1.0)
    assert np.abs(whites(value, ink_dark_width=wide, **thin) - whites(value, **thin))[100:140].max() < 0.02


def test_patterns_can_be_left_out_of_the_dark():
    value, colored = np.zeros((HEIGHT, WIDTH)), dict(line_color_strength=1.0, line_color_width=1.0)
    assert np.abs(whites(value, True, **colored)[100:140] - 6).max() < 0.1
    assert whites(value, True, ink_dark_colors=0.0, **colored).max() == 0
    assert np.abs(whites(value, ink_dark_colors=0.0, **colored)[100:140] - 6).max() < 0.1
