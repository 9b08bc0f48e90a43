# SPDX-License-Identifier: GPL-3.0-or-later
"""Tones where nothing is: a night is black, a world that has no light is none, and shadows that were caught."""

import numpy as np
import pytest
from encre.pen import library
from toned import ALONE, LEVELS, stuck, twins, wall


def sky(color, **scene):
    """Share of ink of a sky that has such colors from the left to the right, above ground."""
    layers = wall(60, 40)
    layers["depth"][:20] = 0
    layers["color"][:20] = layers["diffuse"][:20] = 0
    layers["combined"][:20, :, :3] = np.repeat(np.float32(color), 60 // len(color))[:, None]
    params = dict(ALONE, tone_1="SOLID", tone_2="DOTS", tone_3="NONE", tone_4="NONE", tone_mirrors=True,
                  tone_black=0.03, tone_black_by="LUMINANCE", shade_levels=LEVELS) | scene
    ink = library.render(layers, params, outputs=["Encre Tones"]).images["Encre Tones"][:20, :, 3]
    return ink.reshape(20, len(color), -1).mean((0, 2)).tolist()


def test_a_night_is_black_and_its_stars_are_not():
    assert sky([0.02]) == [1] and sky([0.5]) == sky([0.051]) == [0]
    assert sky([0.02, 0.02, 0.02, 0.9, 0.0]) == [1, 1, 1, 0, 1]
    assert 0.1 < sky([0.037])[0] < 0.9


def test_what_is_dark_in_a_bright_sky_is_paper():
    """As the trees in a picture of a day."""
    assert sky([0.02, 0.02, 0.9]) == [0, 0, 0] and sky([0.02, 0.02, 0.09]) == [1, 1, 0]


def test_where_no_world_is_there_is_paper():
    assert sky([0.0]) == [0] and sky([0.02], tone_mirrors=False) == [0] and sky([0.02], tone_sky=2000.0) == [0]


@pytest.mark.parametrize(("surface", "light"), [("PAPER", 0.2), ("SHADED", 0.2), ("PAPER", 0.6)])
def test_twin_of_a_night_and_of_caught_shadows(surface, light):
    layers = stuck(90, 60, 3)
    rng = np.random.default_rng(3)
    nothing = ~((layers["depth"] > 0) & (layers["depth"] < 1e9)).reshape(60, 90)
    assert nothing.mean() > 0.1
    layers["combined"][nothing, :3] = rng.choice([0, 0.05, 0.12, 0.14, 0.9], (nothing.sum(), 1),
                                                 p=[(1 - light) / 2] * 2 + [light / 3] * 3)
    layers["combined"][nothing, 3] = rng.choice([0.5, 1], nothing.sum())
    layers["color"][nothing] = 0
    layers["diffuse"][nothing & (rng.random((60, 90)) < 0.5)] = 0
    twins(layers, dict(ALONE, shade_levels=LEVELS, tone_1="SOLID", tone_2="LINES", tone_mirrors=True, tone_black=0.1,
                       surface=surface),
          [dict(tone_black=0.0), dict(tone_black=0.13, tone_black_by="LUMINANCE"), dict(tone_mirrors=False)])


def test_a_caught_shadow_is_its_tones_alone():
    """On a film that shows through: of the shadow, which has an alpha, the ink of the dots is left, and nothing
    between them; on one that does not, they are on paper."""
    layers = wall(60, 40)
    layers["depth"][:] = layers["combined"][:] = layers["color"][:] = layers["diffuse"][:] = 0
    layers["combined"][10:30, 10:50, 3], layers["diffuse"][10:30, 10:50] = 0.6, 0.4
    params = dict(ALONE, use_shading=True, surface="PAPER", tone_1="SOLID", tone_2="DOTS", tone_2_pitch=6.0,
                  tone_3="NONE", tone_4="NONE", shade_levels=[(0.0,), (0.6, 0.2, 0.0), (1.0, 0.7, 0.0)])
    for film in (0.6, 1.0):
        layers["combined"][10:30, 10:50, 3] = film
        drawn = library.render(layers, params).images["Combined"]
        inside, outside = drawn[14:26, 14:46], drawn[:, 54:]
        ink = inside[..., 3] if film < 1 else 1 - inside[..., 0]
        assert 0.25 < ink.mean() < 0.55 and ink.min() < 0.05 and ink.max() > 0.95 and not outside.any()
        assert (inside[..., :3] == 0).all() if film < 1 else (inside[..., 3] == 1).all()
