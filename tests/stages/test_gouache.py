# SPDX-License-Identifier: GPL-3.0-or-later
"""Gouache against tests/reference/, where strokes are large and where small, how they keep to things, and cut up."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Camera, Frame
from randomly import random_layers
from reference import render as reference

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, length_unit="PIXELS")
GOUACHE = dict(OFF, use_gouache=True, gouache_size=30.0)
VIEW = np.array([(0.8, 0.6, 0), (0, 0, 1), (0.6, -0.8, 0)])


def scene(size=(70, 90), scale=0.02, left=0.0, light=(0.4, 1.0)):
    """A ball before a wall, whose right half has another color, and the sky above them."""
    y, x = np.mgrid[:size[0], :size[1]] + 0.5
    ones = np.ones((*size, 1), np.float32)
    u, v = (x - 0.35 * size[1]) / 22, (y - 0.65 * size[0]) / 22
    ball, sky = u * u + v * v < 1, y < 0.25 * size[0]
    rise = np.sqrt(np.maximum(1 - u * u - v * v, 0.02))
    color = np.where(ball[..., None], (0.7, 0.3, 0.2), np.where((x > 0.6 * size[1])[..., None], (0.2, 0.5, 0.3),
                                                               (0.6, 0.6, 0.5)))
    diffuse = np.where(u < 0.2, *light)[..., None] * ones * np.ones(3)
    anchor = np.zeros((*size, 16))
    anchor[..., 0], anchor[..., 1], anchor[..., 5], anchor[..., 6] = scale * x + left, -scale * y, 1, scale
    anchor[..., 7], anchor[..., 11] = scale, -scale
    round_ = np.zeros_like(anchor)
    round_[..., :3] = round_[..., 3:6] = np.stack([u, -v, rise], -1)
    round_[..., 6], round_[..., 7], round_[..., 9] = 1 / 22, 1 / 22, -u / rise / 22
    round_[..., 11], round_[..., 12], round_[..., 13] = -1 / 22, -v / rise / 22, 0.5
    anchor = np.where(ball[..., None], round_, anchor)
    depth = np.where(ball, 5 - rise, 6 + 0.01 * x)
    lit = np.where(sky[..., None], (0.3, 0.5, 0.8), color * diffuse)
    layers = dict(combined=np.concatenate([lit, ones], -1), color=color, diffuse=diffuse, normal=anchor[..., 3:6],
                  depth=np.where(sky, 1e10, depth), object=np.where(sky, 0, np.where(ball, 2, 1)),
                  anchor=np.where(sky[..., None], 0, anchor))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def draw(layers, scene, styles=(), **how):
    return library.render(layers, scene, styles, **how).images["Combined"]


@pytest.mark.parametrize("values, camera", [
    (dict(), dict(view=VIEW, height=0.7)),
    (dict(use_shading=True, gouache_size=12.0), dict(view=VIEW, height=0.7)),
    (dict(gouache_size=80.0, gouache_variety=4.0, gouache_body=3.0), dict(view=VIEW, height=2.0)),
    (dict(length_unit="RELATIVE", gouache_size=400.0), dict(orthographic=True, height=3.0)),
])
def test_agrees_with_the_reference(values, camera):
    layers, place = scene((60, 70)), dict(width=200, height=100, x=31, y=17)
    layers["style"] = np.zeros((60, 70, 1), np.float32)
    layers["style"][45:, 50:], layers["style"][50:, :30] = 1, 2
    styles = [dict(use_gouache=False), dict(gouache_body=0.2, gouache_variety=0.0)]
    want = reference(layers, GOUACHE | values, styles, camera=camera, frame=place)["Combined"]
    got = draw(layers, GOUACHE | values, styles, camera=Camera(**{**camera, "view": np.ravel(
        camera.get("view", np.eye(3)))}), frame=Frame(**place))
    off = np.abs(got - want).max(-1)
    assert (off > 2e-3).mean() < 0.01, np.argwhere(off > 2e-3)
    assert np.abs(want - layers["combined"]).max(-1)[:12].mean() > 1e-3, "strokes in the sky"


@pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1), (59, 97)])
def test_of_any_layers_the_same_bytes_on_any_threads_and_whatever_is_kept(size):
    layers = random_layers(*size)
    anchor = np.float32(np.random.default_rng(1).uniform(-1, 1, (*size, 16)))
    layers["anchor"] = anchor
    pictures = []
    for how in (dict(threads=1), dict(threads=3), dict(simd=0), dict(threads=1)):
        if len(pictures) != 3:
            library.load().forget()
        pictures.append(draw(layers, GOUACHE, **how).tobytes())
    assert len(set(pictures)) == 1


def test_numbers_without_bounds_stay_finite():
    layers = random_layers(40, 64)
    layers["combined"][::3, ::5] = 1e38
    layers["combined"][1::3, ::5] = -1e38
    layers["depth"][::2] = 1e-38
    for value in (3e38, 1e-38, 1):
        layers["anchor"] = np.full((40, 64, 16), value, np.float32)
        assert np.isfinite(draw(layers, GOUACHE)).all()


def test_strokes_stay_on_their_thing_and_their_paint():
    """Black and white meet in no mixture."""
    layers = scene(size=(140, 180))
    bright = np.isin(layers["object"], (2,))[..., None] | (np.arange(180) > 108)[:, None]
    layers["color"] = np.float32(bright * np.ones(3))
    layers["diffuse"][:] = 1
    layers["combined"][..., :3] = layers["color"]
    got = draw(layers, GOUACHE | dict(gouache_body=0.0, gouache_variety=0.0))
    np.testing.assert_allclose(got, layers["combined"], atol=1e-3)


def test_walls_stay_quiet_and_borders_of_light_get_ragged_but_those_of_strong_light_do_not():
    found = {}
    for dark in (1.0, 0.7, 0.4):
        layers = scene(size=(140, 180), light=(dark, 1.0))
        wall, ball = (layers["object"] == 1) & (np.arange(180) > 120), layers["object"] == 2
        got = draw(layers, GOUACHE)[..., :3]
        assert 0.002 < got[wall].std(0).max() < 0.03
        found[dark] = (np.abs(got - layers["combined"][..., :3])[ball].max(-1) > 0.1).mean()
    assert found[1.0] < 0.01 and found[0.4] < 0.01 and 0.01 < found[0.7] < 0.3, found


def sizes(picture, where):
    """How long what is of one color lies side by side, on the mean."""
    steps = np.abs(np.diff(picture[..., 1], axis=1)) > 4e-3
    return (~steps)[where[:, 1:] & where[:, :-1]].mean() / max(steps[where[:, 1:] & where[:, :-1]].mean(), 1e-3)


def test_strokes_are_large_on_walls_and_small_where_there_is_detail():
    layers = scene(size=(240, 360), light=(1.0, 1.0))
    detailed = {name: a.copy() for name, a in layers.items()}
    stripes = (np.arange(360) // 4 % 2 == 0) & (np.arange(360) > 250)
    where = (layers["object"] == 1) & (np.arange(360) > 270)
    for name in ("color", "combined"):
        detailed[name][:, stripes, :3] *= 0.9
    plain = dict(GOUACHE, gouache_size=60.0, gouache_body=0.0, gouache_variety=3.0)
    assert sizes(draw(layers, plain), where) > 1.5 * sizes(draw(detailed, plain), where)


def test_strokes_keep_to_things_as_the_camera_passes():
    one, two = (draw(scene(size=(140, 180), left=left, light=(1.0, 1.0)), GOUACHE) for left in (0.0, 0.02 * 12))
    rows, wall = slice(60, 140), slice(125, 165)
    same = np.abs(two[rows, wall] - one[rows, slice(wall.start + 12, wall.stop + 12)])
    other = np.abs(two[rows, wall] - one[rows, wall])
    assert np.median(same) < 0.2 * np.median(other)


def test_a_cut_is_as_the_whole():
    layers, frame = scene(size=(200, 300)), dict(width=300, height=200)
    whole = draw(layers, GOUACHE, frame=Frame(**frame))
    cut = {name: np.ascontiguousarray(a[40:180, 50:250]) for name, a in layers.items()}
    part = draw(cut, GOUACHE, frame=Frame(**frame, x=50, y=40))
    far = 60
    np.testing.assert_allclose(part[far:-far, far:-far], whole[40:180, 50:250][far:-far, far:-far], atol=1e-5)


def test_off_it_draws_nothing():
    layers = scene()
    np.testing.assert_array_equal(draw(layers, OFF), layers["combined"])
