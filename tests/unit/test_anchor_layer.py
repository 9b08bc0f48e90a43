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


@pytest.mark.parametrize("scale", [(0.35, 2.4, 0.3), (3.0, -1.0, 0.5)])
def test_a_scale_that_is_not_applied_draws_nothing_out(scale):
    """Where things rest is as if the scale were applied, but for a size that is the same all over."""
    rng = np.random.default_rng(8)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    corners = rng.normal(size=(40, 3, 3))
    normals = rng.normal(size=(40, 3, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    drawn = []
    for factor in (np.ones(3), np.array(scale)):
        model, points = np.eye(4), corners * np.abs(np.array(scale) / factor)
        model[:3, :3], model[2, 3] = turn * np.abs(factor), -6
        across = normals / np.abs(np.array(scale) / factor)
        mesh = Mesh(points.reshape(-1, 3).astype(np.float32), model=model,
                    rest_normals=(across / np.linalg.norm(across, axis=-1, keepdims=True)).astype(np.float32))
        drawn.append(library.raster([mesh], np.eye(4), views.perspective(60, 40, 1.2), Frame(60, 40), (60, 40), 0.1,
                                    outputs=("anchor",))["anchor"])
    applied, own = drawn
    there = applied[..., 6] > 0
    assert there.mean() > 0.05
    size = np.median(own[there][:, 6] / applied[there][:, 6])
    own[..., :3] /= size
    own[..., 6:13] /= size
    close = np.isclose(own, applied, rtol=1e-3, atol=2e-4 * np.abs(applied[there]).max(0)).all(-1)
    assert close[there].mean() > 0.99  # but where two triangles share a pixel's centre


def test_of_a_larger_anchor_one_sample_stays_and_what_is_told_per_pixel_grows():
    anchor = np.random.default_rng(2).uniform(0.1, 1, (6, 9, 16)).astype(np.float32)
    made = np.concatenate([supersample.shrink(name, anchor[..., at], 3) for name, at in saved.ANCHOR.items()], 2)
    want = anchor[1::3, 1::3].copy()
    want[..., 6:13] *= 3
    np.testing.assert_array_equal(made, want)
    card = anchor[..., :4]
    grown = card[1::3, 1::3] * np.float32((1, 1, 3, 3))
    np.testing.assert_array_equal(supersample.shrink("Encre Card", card, 3), grown)


def test_where_another_thing_hides_it_a_sheet_goes_on():
    """What Cycles has of an object beside where the rasteriser drew it."""
    y, x = np.mgrid[:4, :6].astype(np.float32)
    card = np.stack([0.3 * x + 0.4 * y, 0.4 * x - 0.3 * y, 0.3 + 0 * x, 0.4 + 0 * x], -1)
    maps = {"object": np.ones((4, 6), np.int32), "material": 0 * x, "style": 0 * x, "card": card.copy()}
    maps["object"][1:3, 2:4], maps["card"][1:3, 2:4] = 0, 0
    made = overlay.rasterised(np.full((4, 6), 5.0, np.float32), maps, np.array([0, 5]), np.array([0, 50]), np.negative)
    np.testing.assert_allclose(made["card"], card, atol=1e-6)
