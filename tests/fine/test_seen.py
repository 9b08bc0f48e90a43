# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines in mirrors and through glass, drawn from layers: by the judge's truth, and against the slow reference."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Camera
from judge import measure, scenes, verdict

CONTROLS = len(library.controls())

RIM = np.s_[20:-20, 30:-30]  # the mirror in the frame
PEN = dict(verdict.PARAMS, edge_detector="FINE", line_shadow_strength=0.0, line_mirror_strength=3.0,
           line_mirror_width=1.0)


def mirrored(scene, filter="box"):
    """A wall with a mirror in it that shows the scene as it would be seen without the wall."""
    layers = scene.layers(filter)
    view = np.reshape(scene.camera_settings["view"], (3, 3))
    shape = layers["depth"].shape[:2]
    flat = np.ones((*shape, 3), np.float32)
    front = {"combined": np.ones((*shape, 4)), "color": flat * 0.5, "albedo": flat * 0.5, "diffuse": flat,
             "depth": flat[..., :1], "normal": flat * (view.T @ (0, 0, 1)), "object": flat[..., :1] * 0}
    there = layers["depth"] < 1e9
    seen = {"seen_color": layers["albedo"], "seen_normal": layers["normal"] @ view.T,
            "seen_depth": np.where(there, 1 + layers["depth"], 0)}
    wall = {"seen_color": front["albedo"], "seen_normal": flat * (0, 0, 1), "seen_depth": front["depth"]}
    front["object"][RIM] = 1
    for name, picture in seen.items():
        front[name] = np.array(wall[name])
        front[name][RIM] = picture[RIM]
    return {name: np.ascontiguousarray(a, np.float32) for name, a in front.items()}


def camera(scene):
    said = scene.camera_settings
    return Camera(said["view"], said["orthographic"], said["height"])


def ink(layers, scene, **params):
    return library.render(layers, {**PEN, **params}, camera=camera(scene), outputs=("Encre Lines",)).images[
        "Encre Lines"][..., 3]


def cut(t, truth, margin=6):
    """Ink and contours well inside the mirror, and without those of light, which mirrors do not show."""
    top, left = RIM[0].start + margin, RIM[1].start + margin
    bottom, right = t.shape[0] - top, t.shape[1] - left
    out = np.zeros_like(t)
    out[top:bottom, left:right] = t[top:bottom, left:right]
    keep = (truth.x > left) & (truth.x < right - 1) & (truth.y > top) & (truth.y < bottom - 1)
    truth = truth.take(keep & ~truth.required("light"))
    return out, truth.take(truth.required("all"))


@pytest.mark.parametrize("name, filter", [
    pytest.param(name, filter, marks=pytest.mark.long if (filter == "box") != (name in ("boxes", "roof"))
                 else pytest.mark.slow if name in ("patches", "roof") else ())
    for name in ("boxes", "patches", "roof", "sphere") for filter in ("box", "blackman")])
def test_a_mirror_shows_the_lines_of_what_is_in_it(name, filter):
    scene = scenes.NAMED[name]()
    t, truth = cut(ink(mirrored(scene, filter), scene), scene.truth)
    found = verdict.lines(t, truth)
    least = {"evenness": 0.97, "once": 0.97, **{f"whole {kind}": 0.99 for kind in ("outline", "crease", "color")}}
    assert {k: found[k] for k, v in least.items() if found[k] < v} == {}
    assert found["place p95"] <= 0.25
    assert measure.stray(t, truth, slack=1) <= 0.0005


def test_an_orthographic_mirror():
    """Two halves that only their depths tell apart."""
    layers = halves()
    eye = Camera(orthographic=True, height=5.0)
    t = drawn(layers, eye, line_mirror_strength=3.0)[..., 3]
    assert (t[25:35, 40:60].max(1) > 0.5).all()
    layers["seen_depth"][...] = 3
    t = drawn(layers, eye, line_mirror_strength=3.0)[..., 3]
    assert t[25:35, 40:60].max() == 0


def halves(color=(0.5, 0.5, 0.5), depth=(3.0, 4.0)):
    """A mirror that fills the frame and shows two walls side by side, each with the normal (1, 0, 0)."""
    shape = 60, 100
    flat = np.ones((*shape, 3), np.float32)
    left = (np.arange(100) < 50)[None, :, None]
    layers = {"combined": np.ones((*shape, 4)), "color": flat * 0.5, "diffuse": flat, "depth": flat[..., :1],
              "normal": flat * (0, 0, 1), "seen_color": np.where(left, color, 0.5) * flat,
              "seen_normal": flat * (1, 0, 0), "seen_depth": np.where(left, *depth) * flat[..., :1]}
    return {name: np.array(a, np.float32) for name, a in layers.items()}


def drawn(layers, camera=None, **params):
    values = {**PEN, "line_mirror_strength": 1.0, "line_thickness": 2.0, **params}
    return library.render(layers, values, camera=camera, outputs=("Encre Lines",)).images["Encre Lines"]


def test_weight_width_and_the_mirrors_own_controls():
    layers = halves(color=(1.0, 0.1, 0.1))
    for width in (2.0, 6.0):
        t = drawn(layers, line_thickness=4.0, line_mirror_width=width / 4)[30, :, 3]
        assert t.sum() == pytest.approx(width, abs=0.2)
        assert (t * np.arange(100)).sum() / t.sum() == pytest.approx(49.5, abs=0.1)
    assert drawn(layers, line_mirror_strength=0.2)[..., 3].max() == 0
    near = {**layers, "depth": layers["depth"].copy(), "controls": np.zeros((60, 100, CONTROLS), np.float32)}
    near["depth"][:, 52:54] = 0.5  # a post before the mirror, beside the line
    near["controls"][:, 52:54, 0] = -1
    near["controls"][:, :52, 0] = 0.25
    t = drawn(near, line_thickness=2.0, line_inner_strength=0.0, line_outline_strength=0.0)[30, 40:52, 3]
    assert t.sum() > 3  # three times as thick as without controls, but for the post's side


def test_other_detectors_and_files_without_what_is_seen_draw_none():
    layers = halves(color=(1.0, 0.1, 0.1))
    assert drawn(layers)[..., 3].max() == 1
    for detector in ("DOG", "SOBEL"):
        assert drawn(layers, edge_detector=detector)[..., 3].max() == 0
    for name in ("seen_color", "seen_normal"):
        assert drawn({k: a for k, a in layers.items() if k != name})[..., 3].max() == 0
    assert drawn({k: a for k, a in layers.items() if k != "seen_depth"})[..., 3].max() == 1
    layers["normal"][...] = layers["seen_normal"]  # no mirror: it is the surface's own colour
    layers["depth"][...] = layers["seen_depth"]
    assert drawn(layers, line_inner_strength=0.0)[..., 3].max() == 0


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("blur", [0, 1, 2])
def test_noise_makes_no_scribble(seed, blur):
    """What rough metal shows at few samples: noise, and blurred noise."""
    rng = np.random.default_rng(seed)
    layers = halves()
    for name in ("seen_color", "seen_normal", "seen_depth"):
        noise = rng.standard_normal(layers[name].shape)
        for axis in (0, 1):
            for _ in range(blur):
                noise = (np.roll(noise, 1, axis) + 2 * noise + np.roll(noise, -1, axis)) / 4
        noise *= {"seen_color": 0.3, "seen_normal": 0.5, "seen_depth": 0.5}[name] / noise.std()
        layers[name] = (np.abs(layers[name].mean((0, 1)) + noise)).astype(np.float32)
    assert (drawn(layers)[5:-5, 5:-5, 3] > 0.5).mean() < 0.01


def test_black_spots_are_no_mirrors():
    """Where a texture is black Cycles writes nothing of what is seen: pixels with a share of black."""
    y, x = np.indices((90, 160), np.float32)
    share = 1 - np.clip(1.5 - np.abs(np.hypot(x % 40 - 20, y % 30 - 15) - 9), 0, 1)[..., None]
    flat = np.ones((90, 160, 3), np.float32)
    paint, normal = flat * share * (0.8, 0.5, 0.2), flat * (0, 0.6, 0.8)
    layers = {"combined": np.ones((90, 160, 4)), "color": paint, "albedo": paint, "diffuse": flat,
              "depth": flat[..., :1] * 5, "normal": normal, "object": flat[..., :1], "seen_color": paint,
              "seen_normal": normal * share, "seen_depth": flat[..., :1] * 5 * share}
    t = drawn({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, line_color_strength=0.0)
    assert t.max() == 0
