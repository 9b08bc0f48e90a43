# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a sky as flat shapes."""

import numpy as np
import pytest
from encre.pen import suns
from encre.pen.backdrop import Backdrop, Backdrops, Once, put_behind
from encre.pen.job import Frame
from encre.pen.sky import Sky

BLUE, GROUND, SUN = (0.2, 0.4, 0.9), (0.3, 0.25, 0.1), (6.0, 5.5, 4.0)


def photograph(rows=512):
    """A ground with grain below a horizon that is 12 degrees high at +x and a blue that gets paler toward it, with a
    bright disc at −y."""
    way = suns.ways(rows, 2 * rows)
    rise = np.degrees(np.arcsin(way[..., 2]))
    ground = rise < 12 * way[..., 0]
    color = np.where(ground[..., None], GROUND, np.array(BLUE) * (1 - 0.1 * np.clip(rise / 90, 0, 1))[..., None])
    color[way @ [0, -0.95, 0.312] > np.cos(np.radians(8))] = SUN
    color *= 1 + np.random.default_rng(0).normal(0, 0.04, (*color.shape[:2], 1))
    return color.astype(np.float32)


def looking(toward, wide, size):
    """world -> camera and camera -> clip of a frame so many degrees high."""
    ahead = np.array(toward, float) / np.linalg.norm(toward)
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    view, projection, scale = np.eye(4), np.zeros((4, 4)), 1 / np.tan(np.radians(wide / 2))
    view[:3, :3] = right, np.cross(right, ahead), -ahead
    projection[0, 0], projection[1, 1], projection[3, 2] = scale * size[1] / size[0], scale, -1
    return view, projection


def seen(sky, toward, wide=20.0, size=(240, 160), place=None):
    """(rows, columns, 3) of a frame so many degrees high; place: left, top, width and height of a part of it."""
    left, top, width, height = place or (0, 0, *size)
    pixels = np.arange(width * height)
    return sky.seen(*looking(toward, wide, size), Frame(*size, left, top), pixels, width).reshape(height, width, 3)


@pytest.fixture(scope="module")
def backdrop():
    found = Backdrops().of(Sky(pictures=((photograph(), np.eye(3)),)), 16)
    assert isinstance(found, Backdrop)
    return found


def test_a_photograph_becomes_few_flat_shapes(backdrop):
    """Grain and what gets slowly paler go; what is bright keeps its color, above 1 too."""
    for toward in (1, 0, 0.2), (0, 1, 0), (-1, 0.2, -0.2), (0, -0.95, 0.312):
        pixels = seen(backdrop, toward).reshape(-1, 3)
        assert len(np.unique(pixels.round(4), axis=0)) < 0.05 * len(pixels)
        colors, counts = np.unique(pixels[np.isin(pixels[:, 0], backdrop.palette[:, 0])], axis=0, return_counts=True)
        assert (counts > 50).sum() in (1, 2)
    middle = seen(backdrop, (0, -0.95, 0.312))[80, 120]
    np.testing.assert_allclose(middle, SUN, rtol=0.1)
    np.testing.assert_allclose(seen(backdrop, (0, 0.1, -1))[80, 120], GROUND, rtol=0.15)


@pytest.mark.parametrize("wide", [60.0, 10.0, 3.0])
def test_borders_lie_where_they_were_and_are_a_pixel_wide_at_any_size(backdrop, wide):
    """To a texel of 0.7 degrees, and mixed over a pixel."""
    height = np.radians(11.75)
    column = seen(backdrop, (np.cos(height), 0, np.sin(height)), wide)[:, 120, 2]
    sky, ground = column[2], column[-3]
    assert sky > 0.7 and ground < 0.2
    mixed = (column < sky - 0.01) & (column > ground + 0.01)
    assert mixed.sum() <= 2
    row = np.interp(-(sky + ground) / 2, -column, np.arange(160))
    assert abs(row - 79.5) * wide / 160 < 0.7


def test_a_part_of_a_frame_and_the_seam_of_the_picture_are_as_the_whole(backdrop):
    whole = seen(backdrop, (-1, 0, -0.2), 50.0)
    np.testing.assert_array_equal(seen(backdrop, (-1, 0, -0.2), 50.0, place=(90, 40, 60, 50)), whole[40:90, 90:150])
    rows = np.diff((whole[..., 2] > 0.5).sum(0))  # the horizon goes on where the picture closes
    assert np.abs(rows).max() <= 1


def test_a_sky_is_put_behind_by_what_each_pixel_leaves_of_it(backdrop):
    rng, toward = np.random.default_rng(0), (-1, 0, -0.2)
    combined = rng.random((160, 240, 4), np.float32)
    combined[:, :80, 3], combined[:, -80:, 3] = 0, 1
    whole = seen(backdrop, toward)
    layers = {"combined": combined, "background": np.zeros_like(whole)}
    shown = put_behind(backdrop, layers, *looking(toward, 20.0, (240, 160)), Frame(240, 160))
    np.testing.assert_allclose(shown, whole * (1 - combined[..., 3:]), atol=1e-6)
    np.testing.assert_array_equal(layers["combined"][..., :3], combined[..., :3] + shown)
    assert (layers["combined"][..., 3] == 1).all() and layers["background"] is shown and combined[0, 0, 3] == 0
    part = {"combined": combined[40:90, 90:150]}
    put_behind(backdrop, part, *looking(toward, 20.0, (240, 160)), Frame(240, 160, 90, 40))
    np.testing.assert_array_equal(part["combined"], layers["combined"][40:90, 90:150])


def test_a_sky_that_is_looked_up_once_is_the_same(backdrop):
    where, asked = (*looking((1, 0, 0.2), 20.0, (240, 160)), Frame(240, 160)), []

    class Counting:
        def seen(self, view, projection, frame, pixels, width):
            asked.extend(pixels)
            return backdrop.seen(view, projection, frame, pixels, width)

    once = Once(Counting())
    for pixels in np.arange(0, 20000, 3), np.arange(0, 38400, 2), np.arange(7):
        np.testing.assert_array_equal(once.seen(*where, pixels, 240), backdrop.seen(*where, pixels, 240))
    assert len(asked) == len(set(asked))


def test_the_same_sky_is_made_flat_once_and_one_color_not_at_all():
    kept, sky = Backdrops(), Sky(pictures=((photograph(256), np.eye(3)),))
    first = kept.of(sky, 16)
    assert kept.of(Sky(pictures=((photograph(256), np.eye(3)),)), 16) is first
    assert kept.of(sky * 2, 16) is not first and len(kept.of(sky, 2).palette) <= 2
    plain = Sky(np.array(BLUE))
    assert kept.of(plain, 16) is plain
