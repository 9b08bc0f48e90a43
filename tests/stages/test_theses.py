# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets *After W* and *After H* against both theses' own chains (tests/reference/theses)."""

from dataclasses import dataclass

import drawn
import numpy as np
import pytest
from encre.pen import library, presets
from reference import metric
from reference.theses import inter_color as h
from reference.theses import water_memory as w

WIDTH, HEIGHT = 320, 180
CONTROLS = list(library.controls())
STAGES = ("lines", "smudging", "hatching")


@dataclass
class Case:
    layers: dict
    paper: np.ndarray
    values: dict

    def image(self, name, off=(), **own):
        values = {**self.values, "paper_source": "IMAGE", "paper_image": "grain.png", **own,
                  **{f"use_{stage}": False for stage in off}}
        return library.render(self.layers, values, outputs=[name], image=lambda path: self.paper).images[name]

    def __getattr__(self, name):
        return self.layers[name].astype(float)


def case(look, painted, seed=3):
    """Balls before a wall, no pixel of which shows nothing. painted: controls and from where on they are; a line
    of less than about a pixel has a rim as wide as one, which W's has not."""
    rng = np.random.default_rng(seed)
    layers = drawn.scene(WIDTH, HEIGHT, seed=seed)
    sky = layers["depth"] > 1e9
    layers["depth"][sky], layers["normal"][sky] = 60, (0, 0, 1)
    layers["color"][sky], layers["diffuse"][sky] = (0.5, 0.45, 0.4), (0.7, 0.65, 0.6)
    layers["albedo"] = layers["color"]
    layers["combined"] = np.concatenate([layers["color"] * layers["diffuse"], np.ones((HEIGHT, WIDTH, 1))], -1)
    layers["combined"] = layers["combined"].astype(np.float32)
    paint = rng.uniform(-1, 1, (int(layers["object"].max()) + 1, len(CONTROLS)))
    paint[rng.random(paint.shape) < 0.5] = 0
    paint = np.maximum(paint, [painted.get(name, -1) for name in CONTROLS]) * [name in painted for name in CONTROLS]
    layers["controls"] = paint[layers["object"].astype(int)].astype(np.float32)
    paper = rng.uniform(0.62, 0.98, (HEIGHT, WIDTH)).astype(np.float32)
    paper += np.float32(0.8) - paper.mean()  # Encre lays any sheet's mean there
    return Case(layers, paper, dict(library.complete(presets.find(look).values)[0]))


@pytest.fixture(scope="module")
def after_w():
    return case("After W", {"thickness": -0.4, "intensity": -1, "color_edge": -1, "smudge_range": -1,
                            "smudge_falloff": -1, "hatching": -1})


@pytest.fixture(scope="module")
def after_h():
    return case("After H", {})


def control(c, name):
    return c.controls[..., CONTROLS.index(name)]


def unit_depth(c):
    near, far = c.values["depth_near"], c.values["depth_far"]
    return np.clip((c.depth - near) / (far - near), 0, 1)


def w_edges(c):
    return w.edges(metric.encode(c.albedo), unit_depth(c), c.normal, c.object, control(c, "color_edge"),
                   c.values["edge_threshold"])


def w_surface(c):
    levels = [level if k else level[0] for k, level in enumerate(c.values["shade_levels"])]
    levels = [levels[0], *(level[:3] for level in levels[1:])]
    tinted, intensity = w.discrete(c.diffuse, levels, c.values["shade_tint"], c.values["shade_tint_weight"])
    return tinted, w.shaded(c.color, tinted, intensity, c.values["shade_saturation"])


def w_smudged(c):
    start = c.values["smudge_falloff"] * np.maximum(0, control(c, "smudge_falloff"))
    return w.smudged(w_surface(c)[1], w.locations(w_edges(c)), c.depth, c.values["smudge_range"] * control(
        c, "smudge_range"), start, c.values["smudge_depth"] * c.depth)


def test_after_w_has_the_edges_of_w(after_w):
    found = after_w.image("Encre Edges")[..., 0] >= after_w.values["edge_threshold"]
    assert 0.02 < found.mean() < 0.5
    assert (found != w_edges(after_w)).sum() == 0


def test_after_w_has_the_light_of_w(after_w):
    tinted, _ = w_surface(after_w)
    assert tinted.max() > 1.05  # beyond full light
    assert np.abs(after_w.image("Encre Light") - tinted).max() < 1e-5


def test_after_w_smudges_the_pixels_that_w_smudges(after_w):
    surface, applies = w_smudged(after_w)
    plain, got = (after_w.image("Combined", off)[..., :3] for off in (STAGES, ("lines", "hatching")))
    changed = (np.abs(surface - w_surface(after_w)[1]) > 1e-9).any(-1)  # also by the same color
    assert changed.mean() > 0.02 and applies.sum() >= changed.sum()
    assert ((got != plain).any(-1) != changed).sum() == 0
    assert np.abs(got - np.maximum(surface, 0)).max() < 1e-5


def test_after_w_hatches_as_w(after_w):
    black = w.hatching(after_w.color, after_w.diffuse, after_w.specular, control(after_w, "hatching"), after_w.paper,
                       after_w.values["hatch_color_threshold"], after_w.values["hatch_light_threshold"])
    surface = np.maximum(w_surface(after_w)[1], 0) * (1 - black[..., None])
    assert 0.1 < black.mean() < 0.9
    assert np.abs(after_w.image("Combined", ("lines", "smudging"))[..., :3] - surface).max() < 2e-5


def test_after_w_draws_the_lines_of_w(after_w):
    found = w.locations(w_edges(after_w))
    ink = w.lines(found, after_w.depth, control(after_w, "thickness"), control(after_w, "intensity"), after_w.paper,
                  after_w.values["line_thickness"] / 2, after_w.values["pen_1_intensity"])
    off = np.abs(after_w.image("Encre Lines")[..., 3] - ink)
    assert ink.mean() > 0.01
    assert (off > 0.02).mean() < 2e-4


def h_strength(c):
    return h.strength(metric.encode(c.albedo), unit_depth(c), c.normal)


def test_after_h_has_the_strengths_of_h(after_h):
    found, wanted = after_h.image("Encre Edges")[..., 0], h_strength(after_h)
    assert 0.05 < (wanted > 0).mean() < 0.95
    assert np.abs(found - wanted).max() < 1e-5
    assert ((found > 0) != (wanted > 0)).sum() == 0


def test_after_h_draws_the_lines_of_h(after_h):
    """But for the depth that makes them thick: H's is each pixel's own, Encre's that of the nearest of five by five, so
    that both sides of an outline are as thick. And what is less than the threshold of colors is no line."""
    depth, = w.least_deep(after_h.depth, after_h.depth)
    alpha = h_strength(after_h) * after_h.values["line_far_distance"] / depth
    alpha[h_strength(after_h) < after_h.values["edge_threshold"]] = 0
    assert h.darkness(alpha).mean() > 0.1
    assert np.abs(after_h.image("Encre Lines")[..., 3] - h.darkness(alpha)).max() < 1e-5


def test_after_h_reads_in_a_room(after_h):
    """A line of full contrast 4 m away is 5.5 pixels wide: nearly all were as wide as there are any, and black ran
    together."""
    assert after_h.values["line_thickness"] * after_h.values["line_far_distance"] / 4 == pytest.approx(5.5)
    assert after_h.values["line_outline_strength"] == 0 and after_h.values["depth_space"] == "LINEAR"
