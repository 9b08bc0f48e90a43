# SPDX-License-Identifier: GPL-3.0-or-later
"""Rim light against tests/reference/, on shapes known by formula, and against itself cut up in other ways."""

import drawn
import masks
import numpy as np
import pytest
from encre.pen.job import Camera, Chains, Frame
from known import line
from randomly import random_layers
from reference import render as reference

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, length_unit="PIXELS")
RIM = dict(OFF, use_rim=True)
TURNED = Camera(view=tuple(np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0].ravel()))


def draw(layers, scene, styles=(), **how):
    return masks.render(layers, scene, styles, **how).images["Combined"]


def noise():
    """Steps of depth everywhere, contours at some, and normals of length 1."""
    layers, rng = random_layers(20, 30), np.random.default_rng(1)
    layers["normal"] /= np.linalg.norm(layers["normal"], axis=-1, keepdims=True)
    depth = np.ravel(layers["depth"])
    contours = [line(rng.uniform(0, 1, (2, 2)) * (30, 20), rng.choice(("contour", "mark")), run=k,
                     depth=float(rng.choice(depth[depth < 1e9]))) for k in range(60)]
    return dict(layers, chains=Chains(np.concatenate(contours), np.zeros(3, np.uint8)))


@pytest.mark.parametrize("layers", [drawn.scene(48, 27), noise()], ids=["scene", "noise"])
@pytest.mark.parametrize("camera", [None, TURNED, Camera(orthographic=True, height=4.0)])
@pytest.mark.parametrize("scene", [
    dict(rim_width=5.0),
    dict(rim_width=6.0, rim_facing=1.0, rim_spread=100.0),
    dict(rim_width=5.0, rim_spread=70.0, rim_angle=20.0, rim_softness=0.7, rim_tint=0.5, rim_strength=0.7),
    dict(rim_space="WORLD", rim_angle=70.0, rim_elevation=50.0, rim_spread=60.0, rim_facing=0.5,
         length_unit="RELATIVE", rim_width=150.0),
])
def test_agrees_with_the_reference(scene, camera, layers):
    styles = [dict(use_rim=False), dict(rim_color=(1, 0.5, 0), rim_width=2.0, rim_softness=0.9)]
    want = reference(layers, dict(RIM, **scene), styles, camera and dict(vars(camera)))
    sure = ~want["unsure"]
    assert sure.mean() > 0.9
    got = draw(layers, dict(RIM, **scene), styles, camera=camera)
    np.testing.assert_allclose(got[sure], want["Combined"][sure], atol=3e-6)
    assert (np.abs(got - layers["combined"]).max(-1) > 0.01).any()


def ball(size=129, radius=50.3, wall=None):
    """A ball before nothing, or before a wall that is seen at a grazing angle; contours are where they are."""
    y, x = np.mgrid[:size, :size] - (size - 1) / 2
    square = x * x + y * y
    there = square < radius**2
    z = np.sqrt(np.maximum(radius**2 - square, 0))
    normal = np.where(there[..., None], np.stack([x, -y, z], -1) / radius, 0)
    depth = np.where(there, 2000 - z, 1e10)
    if wall:
        depth = np.where(there, depth, 3000 + wall * x)
        normal = np.where(there[..., None], normal, np.array([wall, 0, 1]) / np.hypot(wall, 1))
    turn, middle = np.linspace(0, 2 * np.pi, 721), (size - 1) / 2
    contour = line(middle + radius * np.stack([np.cos(turn), np.sin(turn)], 1), "contour", depth=2000, side=1)
    grey = np.full((size, size, 3), 0.2)
    layers = dict(combined=np.concatenate([grey, np.ones((size, size, 1))], -1), color=grey, diffuse=grey * 5,
                  depth=depth, normal=normal, object=there)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    return layers | {"chains": Chains(contour, np.zeros(3, np.uint8))}, np.sqrt(square), x, y


def covered(layers, scene, **how):
    """How much of each pixel white paint covers."""
    return (draw(layers, dict(RIM, rim_facing=1.0, **scene), **how)[..., 0] - 0.2) / 0.8


@pytest.mark.parametrize("width", [1.5, 4.0, 8.0])
def test_the_band_is_as_wide_as_asked_everywhere(width):
    layers, far, _, _ = ball()
    share = covered(layers, dict(rim_width=width))
    want = np.clip(50.8 - far, 0, 1) * np.clip(far - (50.3 - width) + 0.5, 0, 1)
    assert np.abs(share - want).max() < 0.2
    assert abs(share.sum() / want.sum() - 1) < 0.02


@pytest.mark.parametrize("turn", [0.3, 0.6])
def test_a_band_by_form_ends_where_the_surface_has_turned(turn):
    layers, far, _, _ = ball()
    share = covered(layers, dict(rim_width=60.0)) > 0.5
    formed = (draw(layers, dict(RIM, rim_facing=turn, rim_width=60.0))[..., 0] - 0.2) / 0.8 > 0.5
    assert share[far < 49].all()
    inner = 50.3 * np.sqrt(1 - turn**2)
    assert formed[(far > inner + 1) & (far < 49)].all() and not formed[far < inner - 1].any()


def test_only_a_silhouette_has_a_band():
    layers, far, _, _ = ball(wall=8.0)  # turned by 83 degrees, and 8 deeper from pixel to pixel
    assert not covered(layers, dict(rim_width=8.0))[far > 51].any()
    front = layers["depth"][far < 50.3].max()
    for behind, banded in (1.1, True), (1.03, False):
        layers["depth"] = np.where(far < 50.3, layers["depth"], np.float32(behind * front))
        assert (covered(layers, dict(rim_width=8.0)).max() > 0.9) == banded, behind


@pytest.mark.parametrize("scene", [
    dict(rim_angle=30.0), dict(rim_space="WORLD", rim_angle=0.0, rim_elevation=30.0)])
def test_a_side_is_chosen(scene):
    """The world is turned about the axis of sight, so that its z is the picture's up."""
    camera = Camera(view=(1, 0, 0, 0, 0, 1, 0, -1, 0))
    layers, far, x, y = ball()
    layers["normal"] = np.ascontiguousarray(layers["normal"] @ np.float32(camera.view).reshape(3, 3))
    share = covered(layers, dict(rim_width=8.0, rim_spread=60.0, **scene), camera=camera)
    aside = np.degrees(np.abs(np.angle((x - 1j * y) * np.exp(-1j * np.radians(30)))))
    rim = (far < 49) & (far > 44)
    assert share[rim & (aside < 20)].min() > 0.9
    assert not share[aside > 63].any()
    ends = rim & (aside > 55) & (aside < 59)
    assert 0 < share[ends].mean() < 0.7, "it gets narrower"


def test_a_light_straight_from_behind_goes_all_round():
    layers, *_ = ball()
    world = dict(rim_width=8.0, rim_spread=60.0, rim_space="WORLD", rim_elevation=-90.0)
    np.testing.assert_allclose(covered(layers, world), covered(layers, dict(rim_width=8.0)), atol=1e-6)


@pytest.mark.parametrize("style", [dict(use_rim=False), dict(rim_strength=0.0), dict(rim_width=0.0)])
def test_without_a_band_no_bit_changes(style):
    layers = random_layers(40, 64)
    layers["style"][:, :30], layers["style"][:, 30:] = 1, 0
    changed = draw(layers, RIM, [style]) != layers["combined"]
    assert not changed[:, :20].any() and changed[:, 31:].any()


def test_however_it_is_cut_up_the_bytes_are_the_same():
    layers = drawn.scene(150, 100)
    whole = draw(layers, dict(RIM, rim_width=7.0), threads=1, simd=0)
    assert draw(layers, dict(RIM, rim_width=7.0), threads=3, simd=1).tobytes() == whole.tobytes()
    part = {name: a[20:90, 30:130] for name, a in layers.items()}
    piece = draw(part, dict(RIM, rim_width=7.0), frame=Frame(150, 100, 30, 20))
    assert piece[10:-10, 10:-10].tobytes() == whole[30:80, 40:120].tobytes()
