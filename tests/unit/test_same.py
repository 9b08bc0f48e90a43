# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges that are found once for all jobs of the same layers: the same bytes as those that are found each time."""

import contextlib
import ctypes

import numpy as np
import pytest
from drawn import scene
from encre.pen.background import Background
from encre.pen.errors import Cancelled, EncreError
from encre.pen.job import Camera, Frame
from encre.pen.library import load

WIDTH, HEIGHT = 96, 64
LOOKS = {"FINE": {}, "FINE, all sources": dict(line_shadow_strength=1.0, line_color_strength=0.7,
                                               line_material_strength=1.0, contrast_local=True),
         "DOG": dict(edge_detector="DOG", line_search="WALK"),
         "SOBEL": dict(edge_detector="SOBEL", line_search="NEAREST", line_shadow_strength=1.0, line_color_strength=1.0)}
OUTPUTS = ("Combined", "Encre Lines")


def layers_of(width=WIDTH, height=HEIGHT):
    layers = scene(width, height, n=12)
    layers["style"][height // 3:2 * height // 3] = 1
    layers["seen_color"], layers["seen_normal"] = layers["albedo"], -layers["normal"]
    return layers


def work(layers, values, same=0, outputs=OUTPUTS, **more):
    styles = [dict(line_thickness=14.0, line_crease_strength=0.5,
                   line_shadow_strength=values.get("line_shadow_strength", 0.0))]
    return load().draw_work(layers, load().complete(load().check(values), styles), outputs=outputs, same=same, **more)


def draw(behind, *given, **more):
    behind.start([work(*given, **more)])
    return behind.wait()[0].images


def other(p, value):
    """Another value of a parameter; None: there is none."""
    if p.type == "bool":
        return not value
    if p.type == "enum":
        return next((item for item in p.number if item != value), None)
    if p.type in ("int", "float"):
        low, high = p.soft_min, p.soft_max
        way = low + 0.35 * (high - low)
        way = way if abs(way - value) > 1e-3 * (high - low) else low + 0.6 * (high - low)
        return round(way) if p.type == "int" else way
    if p.type == "color":
        return (0.2, 0.7, 0.4)
    return [(0.3,), (0.6, 0.35, 0.05), (1.0, 0.8, 0.1)] if p.type == "levels" else None


def test_whatever_changes_the_picture_is_that_of_a_fresh_context():
    """Each parameter that there is, one after the other, in one context; what a fresh one draws with it, and with the
    first values again."""
    for name, look in LOOKS.items():
        layers, behind, base, kept = layers_of(48, 32), Background(2), load().complete(load().check(look))[0], 0
        want = draw(Background(2), layers, look)
        for p in load().params.values():
            value = other(p, base[p.id])
            if value is None:
                continue
            try:
                one = work(layers, {**look, p.id: value})
            except EncreError:  # not with this detector
                continue
            behind.start([work(layers, look, 5), work(layers, {**look, p.id: value}, 5)])
            before, after = (result.images for result in behind.wait())
            fresh = load().run(one).images
            for output in OUTPUTS:
                assert np.array_equal(before[output], want[output]), (name, p.id)
                assert np.array_equal(after[output], fresh[output]), (name, p.id)
            kept += not np.array_equal(before["Combined"], after["Combined"])
        assert kept > 40, name


def blank(layers):
    """Leaves nothing between which there is an edge."""
    for name in ("object", "depth", "normal", "seen_color", "seen_normal"):
        layers[name][...] = layers[name][0, 0]


def lines(images):
    return (images["Encre Lines"][..., 3] > 0.02).sum()


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
def test_edges_are_found_once_for_what_is_the_same(look):
    """What is told to be the same is not looked at: in truth there is no edge any more."""
    look = {**look, "line_shadow_strength": 0.0, "line_color_strength": 0.0, "line_material_strength": 0.0,
            "line_mirror_strength": 0.0}
    layers, behind = layers_of(), Background(2)
    many = lines(draw(behind, layers, look, 1))
    assert many > 50
    blank(layers)
    for change in (dict(line_thickness=9.0), dict(paper_roughness=0.1), dict(shade_strength=0.3),
                   dict(use_hatching=False)):
        assert lines(draw(behind, layers, {**look, **change}, 1)) > many / 2, change
    for found_anew in dict(edge_threshold=0.4), dict(line_shortest=30.0):
        layers = layers_of()
        assert lines(draw(behind, layers, look, 3)) == many
        blank(layers)
        assert lines(draw(behind, layers, {**look, **found_anew}, 3)) == 0, found_anew
    layers = layers_of()
    assert lines(draw(behind, layers, look, 1)) == many
    blank(layers)
    assert lines(draw(behind, layers, look, 2)) == 0  # other layers


@pytest.mark.parametrize("change", [
    dict(camera=Camera(orthographic=True, height=9.0)), dict(frame=Frame(WIDTH, HEIGHT + 20)),
    dict(outputs=("Combined", "Encre Lines", "Encre Edges"))])
def test_edges_are_found_again_for_what_is_not(change):
    layers, behind = layers_of(), Background(2)
    draw(behind, layers, {}, 1)
    blank(layers)
    assert lines(draw(behind, layers, {}, 1)) > 100
    assert lines(draw(behind, layers, {}, 1, **change)) == 0


def test_as_many_threads_as_are_asked_for():
    """Their memory is planned with that of edges."""
    layers, context, want = layers_of(), load().context(1), []
    for threads in (1, 4, 2, 1):
        one = work(layers, {}, 1)
        assert load().lib.encre_set_threads(context, threads) == 0
        assert load().lib.encre_render(context, ctypes.byref(one.job)) == 0
        want.append(one.result().images["Combined"].tobytes())
    load().lib.encre_destroy(context)
    assert len(set(want)) == 1


def test_nothing_is_kept_of_what_has_no_number():
    layers, behind = layers_of(), Background(2)
    draw(behind, layers, {}, 1)
    draw(behind, layers, {})
    blank(layers)
    assert lines(draw(behind, layers, {}, 1)) == 0


def test_what_was_cancelled_is_not_kept():
    layers, behind = layers_of(), Background(2)
    for _ in range(20):
        behind.start([work(layers, {}, 1)])
        behind.cancel()
        with contextlib.suppress(Cancelled):
            behind.wait()
        assert lines(draw(behind, layers, {}, 1)) > 100
