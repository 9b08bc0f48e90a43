# SPDX-License-Identifier: GPL-3.0-or-later
"""Where things touch and nothing jumps: lines run where both surfaces meet, by depths alone, too."""

import numpy as np
import pages
import pytest
from judge import measure, scenes, verdict


def place_of_contacts(scene, filter):
    """How far hairlines between things that touch are from where they do, of layers that no mesh is told of."""
    t = pages.drawer("FINE")(scene.layers(filter), scene.camera_settings,
                             **verdict.PARAMS | {"line_shadow_strength": 0.0, "line_color_strength": 0.0})
    truth = scene.truth
    clear = measure._clear(truth, 3.5)
    truth.clear[3.5] = clear.take(clear.index & (clear.depth < 0.003))
    return measure.place(t, truth)


@pytest.mark.parametrize("filter", ["centre", pytest.param("box", marks=pytest.mark.long)])
@pytest.mark.parametrize("name", [
    "boxes", *(pytest.param(name, marks=pytest.mark.slow) for name in ("roof", "parallel"))])
def test_things_that_touch_have_their_line_where_they_do(name, filter):
    """Of one sample a pixel colours and normals tell nothing but whose the pixel is: stairs, p95 0.31 to 0.36."""
    place = place_of_contacts(scenes.NAMED[name](), filter)
    assert place["count"] > 150
    assert place["p95"] < 0.06 and place["max"] < 0.2


END = 19.9


def wall_before_a_floor(samples):
    """The layers of a wall that ends at END, before it would meet the floor, seen at a grazing angle."""
    x = np.broadcast_to(np.arange(30.0), (60, 30))
    spot = x[..., None] + np.random.default_rng(0).random((60, 30, samples)) - 0.5
    wall, flat = x > END, np.ones((60, 30, 3))
    albedo = np.where(spot > END, 0.7, 0.3).mean(-1)[..., None] * flat
    layers = dict(combined=np.ones((60, 30, 4)), color=albedo, albedo=albedo, diffuse=flat, normal=flat * (0, 0, 1),
                  depth=np.where(wall, 6.7 - 0.37 * (x - 20), 6.961)[..., None], object=1.0 + wall[..., None])
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def test_averages_know_where_a_thing_ends_before_it_touches():
    """The planes meet .6 pixel farther out than the wall reaches; where colours are averaged they tell."""
    t = pages.drawer("FINE")(wall_before_a_floor(256), {}, **verdict.PARAMS | {"line_shadow_strength": 0.0,
                                                                               "line_color_strength": 0.0})
    place = (t[20:40] * np.arange(30)).sum(1) / t[20:40].sum(1)
    assert np.abs(place - END).max() < 0.15
