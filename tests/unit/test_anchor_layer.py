# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer of rest positions, put together in Python."""

import numpy as np
import pytest
import views
from encre.pen import library, overlay, saved, supersample
from encre.pen.job import Frame, Mesh


def test_rest_positions_go_on_evenly_where_a_pixel_shows_what_its_neighbour_does():
    index = np.zeros((5, 6), np.int32)
    index[2, 1:5] = 7
    drawn = index.copy()
    drawn[2, 4] = 0  # Cycles shows it here, the rasteriser does not
    anchor = np.zeros((5, 6, 16), np.float32)
    anchor[2, 1:4] = np.arange(3)[:, None] * np.eye(16, dtype=np.float32)[0] * 0.5
    anchor[2, 1:4, 6:] = (0.5, 0.5, 0, 0, 0, 0.5, 0, 0, 0, 0)
    maps = {"object": drawn, "material": 0 * drawn, "style": 0 * drawn, "anchor": anchor}
    owners = np.arange(8.0)
    made = overlay.rasterised(index, maps, owners, owners, np.negative)["anchor"]
    np.testing.assert_allclose(made[2, 1:5, 0], (0, 0.5, 1, 1.5))
    np.testing.assert_array_equal(made[2, 4, 6:], made[2, 3, 6:])


@pytest.mark.parametrize("orthographic", [False, True])
def test_what_no_mesh_tells_of_sticks_to_the_world(orthographic):
    """A plane, as the rasteriser tells of it and as its depth and normal do."""
    width, height = 24, 16
    projection = (views.orthographic(width, height) if orthographic
                  else views.perspective(width, height, 1.2, (0.1, -0.2)))
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = np.linalg.qr([(1, 0.2, 0.4), (-0.3, 1, 0.5), (-0.2, -0.6, 1)])[0], (0.3, -0.2, -6)
    points = np.array([(-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)], np.float32)
    mesh = Mesh(points, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    frame = Frame(30, 20, 3, 2)
    maps = library.raster([mesh], view, projection, frame, (width, height), 0.1, outputs=("depth", "normal", "anchor"))
    layers_ = {"depth": maps["depth"][..., None].copy(), "normal": maps["normal"],
               "anchor": np.zeros_like(maps["anchor"])}
    layers_["depth"][3, 4] = 1e10
    overlay.complete_anchor(layers_, view, projection, frame)
    assert not layers_["anchor"][3, 4].any()
    layers_["anchor"][3, 4] = maps["anchor"][3, 4]
    told = [np.concatenate([a[..., :3], np.abs(a[..., 3:6]), a[..., 6:]], 2)
            for a in (layers_["anchor"], maps["anchor"])]
    np.testing.assert_allclose(*told, rtol=2e-3, atol=2e-5)


def test_of_a_larger_anchor_one_sample_stays_and_what_is_told_per_pixel_grows():
    anchor = np.random.default_rng(2).uniform(0.1, 1, (6, 9, 16)).astype(np.float32)
    made = np.concatenate([supersample.shrink(name, anchor[..., at], 3) for name, at in saved.ANCHOR.items()], 2)
    want = anchor[1::3, 1::3].copy()
    want[..., 6:13] *= 3
    np.testing.assert_array_equal(made, want)
