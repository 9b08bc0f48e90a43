# SPDX-License-Identifier: GPL-3.0-or-later
"""Each kind of line takes its own ink and its own pen, and no other kind's."""

import chained
import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Camera, Frame, Mesh
from judge import verdict
from views import pixels

ROWS, COLUMNS, MIDDLE = 40, 60, 30
PEN = dict(verdict.PARAMS, edge_detector="FINE", line_shadow_strength=4.0, line_mirror_strength=3.0,
           line_mirror_width=1.0, line_shadow_width=1.0,
           line_color_width=1.0, line_material_width=1.0, line_material_strength=1.0, line_suggestive_strength=1.0,
           line_suggestive_width=1.0, line_suggestive_shortest=20.0, line_thickness=2.0, ink_by_kind=True)


def wall():
    """A grey wall seen face on, (ROWS, COLUMNS)."""
    ones = np.ones((ROWS, COLUMNS, 3), np.float32)
    return dict(combined=np.ones((ROWS, COLUMNS, 4), np.float32), color=ones / 2, albedo=ones / 2, diffuse=ones.copy(),
                depth=5 * ones[..., 0], normal=np.tile(np.float32([0, 0, 1]), (ROWS, COLUMNS, 1)),
                object=ones[..., 0].copy())


def right(name, *value):
    """The wall, whose right half has another value of a layer."""
    def layers():
        found = wall()
        found[name][:, MIDDLE:] = value
        return found
    return layers


def outline():
    layers = right("object", 0)()
    layers["depth"][:, MIDDLE:] = 1e10
    return layers


def material():
    return {**wall(), "material": np.repeat(np.float32([[1] * MIDDLE + [2] * (COLUMNS - MIDDLE)]), ROWS, 0)}


def seen():
    layers = wall()
    layers |= dict(seen_color=layers["albedo"].copy(), seen_normal=layers["normal"].copy(),
                   seen_depth=layers["depth"] + 3)
    layers["seen_color"][:, MIDDLE:] = 0.1
    return layers


def rastered(*meshes):
    size = (COLUMNS, ROWS)
    layers = chained.layers(meshes, *pixels(*size), Frame(*size), size)
    return {**wall(), **{name: layers[name] for name in ("depth", "object", "chains")}}


def faces(*squares, **more):
    points = np.concatenate([np.float32(square) for square in squares])
    first = np.arange(0, len(points), 4)[:, None, None]
    return Mesh(points, (first + [(0, 1, 2), (0, 2, 3)]).reshape(-1, 3).astype(np.int32), **more)


def square(left, right, depth):
    """Of the frame's whole height, at two depths."""
    near, far = (-z for z in depth)
    return [(left, -9, near), (right, -9, far), (right, ROWS + 9, far), (left, ROWS + 9, near)]


def crease():
    points = square(-9, MIDDLE, (60, 30)) + square(MIDDLE, COLUMNS + 9, (30, 69))
    return rastered(Mesh(np.float32(points), np.int32([(0, 1, 2), (0, 2, 3), (1, 5, 6), (1, 6, 2)]), object_index=1))


def intersection():
    return rastered(faces(square(-9, COLUMNS + 9, (60, 30)), square(-9, COLUMNS + 9, (30, 60)), object_index=1))


def mark():
    line = Mesh(np.float32([(MIDDLE, -9, -30), (MIDDLE, ROWS + 9, -30)]), np.int32([(0, 1)]), kind="lines")
    return rastered(faces(square(-9, COLUMNS + 9, (30, 30)), object_index=1), line)


def suggestive():
    layers = right("normal", 1)()
    turned = 0.9 * np.exp(-((np.arange(COLUMNS) - MIDDLE) / 6) ** 2)
    layers["normal"] = np.broadcast_to(np.stack([turned, 0 * turned, np.sqrt(1 - turned**2)], -1), (ROWS, COLUMNS, 3))
    return layers


KINDS = {"outline": outline, "contact": right("object", 2), "inner": right("depth", 9), "crease": crease,
         "intersection": intersection, "material": material, "color": right("albedo", 0.1), "mirror": seen,
         "shadow": right("diffuse", 0.1), "mark": mark, "suggestive": suggestive}


def lines(layers, **values):
    layers = {name: a if name == "chains" else np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    drawn = library.render(layers, {**PEN, **values}, camera=Camera(orthographic=True, height=ROWS),
                           outputs=("Encre Lines",)).images["Encre Lines"]
    return drawn[8:-8]


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_has_its_ink_and_its_pen(kind):
    layers = KINDS[kind]()
    if kind == "color":
        layers["color"] = layers["albedo"]
    own = {f"line_{kind}_ink": (1, 0, 0)}
    others = {f"line_{other}_ink": (1, 0, 0) for other in KINDS if other != kind}
    ink = lines(layers)
    assert (ink[..., 3].sum(1) > 1.5).all() and not ink[..., :3].any()
    assert ink[:, :MIDDLE - 6].max() == 0 == ink[:, MIDDLE + 6:].max()
    red, black = (lines(layers, **colors) for colors in (own, others))
    np.testing.assert_allclose(red[..., 0], ink[..., 3], atol=1e-6)
    np.testing.assert_array_equal(black, ink)
    wide = dict(pen_2_width=2.0, pen_2_softness=0.0, pen_2_grain=0.0, pen_2_steepness=PEN["pen_1_steepness"],
                pen_2_intensity=PEN["pen_1_intensity"])
    thick = lines(layers, **wide, **{f"line_{kind}_pen": "PEN_2"})[..., 3].sum(1)
    np.testing.assert_allclose(thick, 2 * ink[..., 3].sum(1), rtol=0.1)
    np.testing.assert_array_equal(ink, lines(layers, **wide, **{f"line_{other}_pen": "PEN_2" for other in KINDS
                                                               if other != kind}))
