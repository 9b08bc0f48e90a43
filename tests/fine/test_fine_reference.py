# SPDX-License-Identifier: GPL-3.0-or-later
"""The slow FINE keeps every promise on the scenes by name and on fresh ones, which nothing was tuned on."""

import numpy as np
import pytest
from judge import scenes, verdict
from reference import fine


def draw(layers, camera, **params):
    return fine.ink(layers, params, camera)[0]


def test_named_scenes():
    every = {name: scene() for name, scene in scenes.NAMED.items()}
    assert verdict.broken(verdict.judge(draw, every, full=False)) == {}


def test_a_still_fair_and_calm_line_of_the_asked_width():
    scene = scenes.boxes(size=(150, 200))
    found = verdict.judge(draw, {"boxes": scene}, full=True)
    assert verdict.broken(r for r in found if not r.promise.startswith(("whole", "place"))) == {}


@pytest.mark.long
@pytest.mark.parametrize("first", [1000, 1010])
def test_fresh_scenes(first):
    fresh = {str(k): scenes.draw(k) for k in range(first, first + 10)}
    assert verdict.broken(verdict.judge(draw, fresh, full=False)) == {}


def test_a_free_end_tapers():
    """Two colours that differ less and less: the line between them has an end that meets nothing."""
    h, w = 60, 120
    contrast = 0.3 * np.clip(1.5 - np.arange(w) / 60, 0, 1)
    albedo = np.full((h, w, 3), 0.3)
    albedo[h // 2:] += contrast[:, None]
    layers = {"combined": np.ones((h, w, 4)), "color": albedo, "albedo": albedo, "diffuse": np.ones((h, w, 3)),
              "depth": np.ones((h, w)), "normal": np.tile([0.0, 0, 1], (h, w, 1))}
    params = verdict.PARAMS | {"line_thickness": 6.0}
    plain, found = fine.ink(layers, params)
    end = found.sites.at[:, 1].max()
    assert 60 < end < 95
    tapered, _ = fine.ink(layers, params, line_taper=20.0)
    widths = tapered.sum(0)
    assert np.allclose(plain.sum(0)[:int(end) - 3], 6, atol=0.1)
    assert widths[int(end) - 10] == pytest.approx(3, abs=0.4)
    assert widths[5] == pytest.approx(6, abs=0.1)  # the frame's border is no end
