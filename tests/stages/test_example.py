# SPDX-License-Identifier: GPL-3.0-or-later
"""By example, against tests/reference/example.py, cut up in other ways, and how it sticks to surfaces."""

import numpy as np
import pytest
import sticks
from encre.pen import library
from encre.pen.job import Camera, Frame
from encre.pen.params import shipped
from reference import render as reference

ALONE = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, use_example=True,
             example_ball="IMAGE", example_image="ball", length_unit="PIXELS")
STYLES = [dict(example_image="other", example_own_color=0.3, example_light=1.0, example_loose=1.0, example_size=40.0,
               example_strength=0.8),
          dict(use_example=False)]


def ball(height=60, width=60, channels=3, seed=0):
    """Paint in blots, darker to the right and down."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width] / max(height, width)
    blots = np.kron(rng.random((height // 4 + 1, width // 4 + 1, channels)), np.ones((4, 4, 1)))[:height, :width]
    return np.float32(np.clip(1.1 - (x + y)[..., None] * 0.5 + 0.3 * (blots - 0.5), 0, 2))


IMAGES = {"ball": ball(), "other": ball(90, 70, 3, 1)}


def layers_of(size, turn=0.3):
    """Noise over the scene that `sticks` draws, and things of which no place is known."""
    width, height = size
    rng = np.random.default_rng(2)
    meshes, view, projection = sticks.posed(turn=turn)
    maps = library.raster(meshes, view, projection, Frame(width, height), size, 0.1,
                          outputs=("depth", "object", "shading", "anchor"))
    color = rng.uniform(0, 1, (height, width, 3))
    diffuse = np.linspace(0, 1.5, width)[:, None] * rng.uniform(0.9, 1, (height, width, 1)) * np.ones(3)
    alpha = np.where(rng.random((height, width, 1)) < 0.05, 0, rng.uniform(0.3, 1, (height, width, 1)))
    combined = np.concatenate([color * diffuse + rng.uniform(-0.05, 0.2, color.shape), alpha], 2)
    gloss = color * rng.choice((0, 0.12, 0.5), (height, width, 1))
    anchor = np.where(rng.random((height, width, 1)) < 0.03, 0, maps["anchor"])
    layers = dict(combined=combined, color=color, diffuse=diffuse, depth=maps["depth"], normal=maps["shading"],
                  object=maps["object"], anchor=anchor, gloss=gloss, style=rng.integers(0, 3, (height, width)))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, Camera(view[:3, :3].ravel())


def draw(layers, camera, scene, styles=(), **how):
    return library.render(layers, scene, styles, camera=camera, image=lambda chosen: IMAGES[chosen.name],
                          **how).images["Combined"]


@pytest.mark.parametrize(("how", "anchored"),
                         [(dict(example_size=44.0), True),
                          (dict(example_size=200.0, other_light=0.2), True),
                          (dict(example_size=90.0), False)],
                         ids=["shrunk", "grown", "on the picture"])
def test_twin(how, anchored):
    layers, camera = layers_of((60, 36) if anchored else (30, 18))
    if not anchored:
        del layers["anchor"]
    frame = Frame(80, 60, 11, 9)
    got = draw(layers, camera, ALONE | how, STYLES, frame=frame)
    styles = [{**style, **({"example_image": IMAGES[style["example_image"]]} if "example_image" in style else {})}
              for style in STYLES]
    want = reference(layers, ALONE | how | {"example_image": IMAGES["ball"]}, styles,
                     dict(view=np.float64(camera.view).reshape(3, 3)), vars(frame))["Combined"]
    off = np.abs(got - want).max(-1)
    assert (off > 2e-4).mean() < 1e-3 and (off > 2e-5).mean() < 0.05, (off.max(), (off > 2e-5).mean())
    assert np.abs(got - layers["combined"]).mean() > 0.05


@pytest.mark.parametrize("image", [ball(1, 1), ball(1, 50), ball(70, 8, 1), ball(9, 9, 4) * np.float32("nan"),
                                   ball() * np.float32(1e38)], ids=["texel", "row", "grey", "nan", "bright"])
def test_any_picture_paints_something_finite(image):
    layers, camera = layers_of((40, 24))
    for anchored in (True, False):
        out = library.render({k: a for k, a in layers.items() if anchored or k != "anchor"}, ALONE, camera=camera,
                             image=lambda _: image).images["Combined"]
        assert np.isfinite(out).all() and (out >= np.minimum(layers["combined"], 0)).all()


def test_a_part_of_the_frame_is_the_frame_s_part():
    """On one thread or more, by either build: the same bytes."""
    layers, camera = layers_of((90, 50))
    whole = draw(layers, camera, ALONE, STYLES, threads=1)
    assert np.array_equal(whole, draw(layers, camera, ALONE, STYLES, threads=3))
    assert np.array_equal(whole, draw(layers, camera, ALONE, STYLES, simd=0))
    part = {name: a[7:40, 13:77] for name, a in layers.items()}
    assert np.array_equal(whole[7:40, 13:77], draw(part, camera, ALONE, STYLES, frame=Frame(90, 50, 13, 7)))


def test_it_sticks_to_surfaces():
    """Paint moves with the thing."""
    rng = np.random.default_rng(5)
    grain = np.float32(0.5 + 0.3 * np.kron(rng.random((64, 64, 1)), np.ones((8, 8, 3))))
    values = dict(ALONE, example_image="grain", example_light=0.0, example_size=380.0)
    for motion, least in ("pan", 0.98), ("zoom", 0.81), ("turn", 0.95):
        corr, pop = sticks.painted(values, sticks.MOTIONS[motion][:3], lambda _: grain)
        assert corr > least and pop < 0.002, (motion, corr, pop)


def test_balls_are_shipped():
    p = library.params()["example_image"]
    for item in library.params()["example_ball"].number:
        assert bool(shipped(p, {**library.defaults(), "example_ball": item})) == (item != "IMAGE")
