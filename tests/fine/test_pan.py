# SPDX-License-Identifier: GPL-3.0-or-later
"""Ink of pictures that belong together: it goes where motion takes it, and a frame's border adds none."""

import numpy as np
import pytest
from encre.pen import library, samples
from encre.pen.job import Camera, Frame, Lamp
from encre.pen.scene import Scene as Lit
from judge import kinds, scenes, verdict
from judge.camera import look
from judge.measure import _sample
from judge.meshes import box, sphere
from judge.told import bevelled, matrices_of, rasters, rock, tell
from noise import of_light

FINER = 4  # places a pixel and axis over which colours are averaged
INKED, NONE, REACH = 0.5, 0.2, 1.5  # ink that is a line; what is none; pixels
PEN = dict(verdict.PARAMS, edge_detector="FINE", line_thickness=1.5)


def ink(layers, camera, **values):
    return library.render(layers, PEN | values, camera=Camera(**camera), outputs=["Encre Lines"]).images[
        "Encre Lines"][..., 3]


def lone(t, other, x, y, inside):
    """How much ink of t has none of `other` near the places (x, y) that its pixels are at there."""
    line = (t >= INKED) & inside
    x, y = x[line], y[line]
    near = np.max([_sample(other, x + dx, y + dy) for dx in np.arange(-REACH, REACH + 0.1, 0.5)
                   for dy in np.arange(-REACH, REACH + 0.1, 0.5) if np.hypot(dx, dy) <= REACH], 0)
    return float(t[line][near < NONE].sum())


# ---- a pan


def room():
    turn = scenes.turned
    return [box((9, 0.2, 8), (0, -0.1, 0), turn(0.1), color=(0.5, 0.5, 0.45)),
            bevelled((1.3, 1.1, 1.0), (-1.2, 0.55, 0.3), turn(0.5), 0.1, 1),
            box((0.3, 1.9, 0.3), (1.0, 0.95, -0.9), turn(-0.3), color=(0.3, 0.45, 0.6)),
            rock((1.4, 0.62, 0.7), 0.7, 4), sphere(0.5, (0.05, 0.5, 1.0), 64, color=(0.7, 0.3, 0.25))]


def smooth(ball):
    """Normals at the corners of its triangles: light falls on a ball, not on 4,000 facets."""
    out = (ball.points - ball.points.mean(0))[ball.triangles]
    return np.ascontiguousarray(out / np.linalg.norm(out, axis=-1, keepdims=True), np.float32)


def lamp():
    """Of a metre, above to the right."""
    way = np.array([0.45, 0.8, 0.4]) / np.linalg.norm([0.45, 0.8, 0.4])
    place = np.eye(4)
    place[:3, 2], place[:3, 3] = way, 5 * way
    place[:3, 0] = np.cross([0, 0, 1], way) / np.linalg.norm(np.cross([0, 0, 1], way))
    place[:3, 1] = np.cross(way, place[:3, 0])
    return Lamp("rectangle", (620, 620, 620), 1.0, 1.0, model=place)


def frames(size, noise, count, flat=False, clouds=0.0, **values):
    """(T, camera) of a still room in the soft light of a lamp a metre wide, from a camera that turns. noise: of each
    pixel; clouds: what a denoiser leaves, before it is evened out."""
    meshes, lit, found, eye, (h, w) = room(), Lit(), [], np.array([0.3, 2.2, 6.0]), size
    for k, mesh in enumerate(meshes):
        lit.geometry(k, mesh.points, mesh.triangles, smooth(mesh) if mesh is meshes[-1] and not flat else None)
        lit.instance(k, k)
    lit.lamp(0, lamp())
    colours = np.array([(0, 0, 0), *(mesh.color for mesh in meshes)])
    for k in range(count):
        a = np.radians(-1.0 + 0.083 * k)
        camera = look(eye, eye + (np.sin(a), -0.29 + 0.02 * a, -np.cos(a)))
        matrices = matrices_of(camera, size)
        own = library.raster(rasters(meshes), *matrices, Frame(w, h), (w, h), 0.01, outputs=("depth", "object"))
        fine = library.raster(rasters(meshes), *matrices, Frame(w * FINER, h * FINER), (w * FINER, h * FINER), 0.01,
                              outputs=("depth", "object", "normal"))
        normal, albedo = (np.ascontiguousarray(picture.reshape(h, FINER, w, FINER, 3).mean((1, 3)), np.float32)
                          for picture in (fine["normal"], colours[fine["object"].astype(int)]))
        light = lit.light(own["depth"], normal, *matrices, Frame(w, h), 0.01) + 0.15
        light *= 1 + noise * np.random.default_rng(k).standard_normal(light.shape).astype(np.float32)
        if clouds:
            left, rendered = (np.float32(light * factor[..., None])
                              for factor in of_light((h, w), k, clouds, 3 * clouds, (1, 2, 4, 4)))
            light = samples.even(left, rendered, normal, own["depth"][..., None], own["object"][..., None])
        layers = dict(combined=np.dstack([albedo * light, own["object"][..., None] > 0]).astype(np.float32),
                      color=albedo, albedo=albedo, diffuse=light, normal=normal, depth=own["depth"][..., None],
                      object=own["object"][..., None])
        settings = {"orthographic": False, "height": 1.0, "view": camera.view.ravel().tolist()}
        found.append((ink(tell(layers, meshes, matrices), settings, **values), camera))
    return found


def taken(one, other, size):
    """Where each pixel that a camera sees is in the picture of another one with the same eye, and whether inside."""
    h, w = size
    y, x = np.mgrid[0.0:h, 0.0:w]
    _, way = one.rays(x, y, size)
    x, y, z = other.project(other.eye + way, size)
    margin = 4
    return x, y, (z > 0) & (x > margin) & (x < w - 1 - margin) & (y > margin) & (y < h - 1 - margin)


LARGE = pytest.param((360, 640), 24, marks=pytest.mark.long)


def share_that_pops(found, size):
    """Of the ink, how much is gone and how much new from frame to frame, beside what motion explains."""
    lost = gained = total = 0
    for (t, camera), (after, turned) in zip(found, found[1:], strict=False):
        lost += lone(t, after, *taken(camera, turned, size))
        gained += lone(after, t, *taken(turned, camera, size))
        total += t.sum()
    assert total > 400 * len(found)
    return lost / total, gained / total


@pytest.mark.parametrize("size, count", [((108, 192), 8), LARGE])
def test_lines_of_shapes_go_where_a_pan_takes_them(size, count):
    assert max(share_that_pops(frames(size, 0.03, count, line_shadow_strength=0.0), size)) < 0.001


@pytest.mark.parametrize("flat, size, count", [(True, (108, 192), 8),
                                               pytest.param(False, (360, 640), 24, marks=pytest.mark.long)])
def test_lines_of_soft_light_go_where_a_pan_takes_them(flat, size, count):
    assert max(share_that_pops(frames(size, 0.0, count, flat), size)) < 0.001


@pytest.mark.parametrize("size, count, clouds, most", [
    ((108, 192), 8, 0.02, 0.0005), *(pytest.param((360, 640), 24, clouds, most, marks=pytest.mark.long)
                                     for clouds, most in ((0.006, 0.0005), (0.02, 0.0045)))])
def test_lines_of_denoised_light_go_where_a_pan_takes_them(size, count, clouds, most):
    """Clouds move a line by their share of the light over light's slope, which is 3.3 times less where a frame is 3.3
    times as large. So clouds of .006 are there what .02 are in a small one; by .02, lines that slope by 0.4 to 1 % a
    pixel would have to keep their place within 1.5 pixels to 0.2 % of the light, for .0005. If nothing were evened out,
    .0123 would pop."""
    assert max(share_that_pops(frames(size, 0.0, count, clouds=clouds), size)) < most


# ---- light beyond a surface


@pytest.mark.parametrize("far", [1.5, 2.5, 3.5])
def test_light_that_goes_on_where_a_surface_has_ended_has_no_line(far):
    y, x = np.mgrid[:64, :72] - np.array([31.3, 35.2])[:, None, None]
    off = np.hypot(y, x) - 17.6
    share, hit, flat = np.clip(0.5 - off, 0, 1)[..., None], off < 0, np.ones((64, 72, 3))
    layers = dict(combined=np.dstack([0.5 * share * flat, share]), color=0.5 * share * flat, normal=share * (0, 0, 1.0),
                  depth=np.where(hit, 5, 1e10), object=1.0 * hit, diffuse=(off < far)[..., None] * flat)
    t = ink({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()},
            {"orthographic": False, "height": 1.0, "view": np.eye(3).ravel().tolist()})
    assert t[np.abs(off) < 0.3].min() > 0.8 and not t[np.abs(off) > 1.8].any()


# ---- the border


@pytest.mark.parametrize("name", ["facets", *(pytest.param(name, marks=pytest.mark.long)
                                             for name in ("shadows", "boxes"))])
def test_a_border_adds_no_ink(name):
    make = {**kinds.ANALYTIC, **kinds.MESHES, **scenes.NAMED}[name]
    scene = make()
    layers = scene.layers()
    layers.pop("chains", None)  # pixels alone
    whole, edge = ink(layers, scene.camera_settings), 0
    for left, top, wide, tall in ((60, 60, 200, 150), (103, 87, 131, 99), (150, 120, 240, 170)):
        part = {k: np.ascontiguousarray(a[top:top + tall, left:left + wide]) for k, a in layers.items()}
        t = ink(part, scene.camera_settings)
        y, x = np.mgrid[top:top + tall, left:left + wide].astype(float)
        band = np.ones(t.shape, bool)
        band[3:-3, 3:-3] = False
        assert lone(t, whole, x, y, band) == 0
        edge += int((t[band] >= INKED).sum())
    assert edge > 10
