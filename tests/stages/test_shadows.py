# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light against its twin, which does the same by simpler means: on small pictures, lamp by lamp."""

import functools
from pathlib import Path

import kept
import numpy as np
import pytest
from encre.pen import irradiance
from encre.pen.job import Bend, Frame, Lamp
from lamps import CUBE, CUBE_CORNERS, LAMPS, PLANE, PLANE_CORNERS, Stage, ball, look, moved, ways
from reference import light
from reference.light import Hole
from reference.shadows import Picture

WIDTH, HEIGHT = 18, 13
BY_HAND = np.s_[9:12, 2:7]  # pixels that show what no geometry tells of


def scene(eye=(6, -8, 5), at=(0.2, 0, 0.6), size=(WIDTH, HEIGHT)):
    """A cube, a smooth ball, a smaller one in a mirror, and a bar that the camera does not see, on a plane."""
    stage = Stage(*size, eye, at=at)
    points, corners, normals = ball(3)
    stage.add(points, corners, moved(2.6, -0.6, 0.8, 0.8), normals)
    turn = np.eye(4)
    turn[:3, :3] = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    stage.add(points, corners, moved(-2.2, -1.6, 0.9) @ turn @ np.diag([-0.9, 0.6, 0.8, 1]), normals)
    bar = np.diag([0.04, 0.05, 1.4, 1.0])
    bar[:3, 3] = -0.9, -2.3, 1.4
    stage.add(CUBE, CUBE_CORNERS, bar, seen=False)
    return stage


def layers(stage):
    """(depth, normal): with a piece of a wall that is not in the scene, and depths that are a little off."""
    depth = np.float32(light.surfaces(stage.world, stage.view, stage.projection, stage.width, stage.height)[3])
    there = depth < 1e9
    depth[::2][there[::2]] *= np.float32(1.0008)
    normal = np.zeros((*depth.shape, 3), np.float32)
    normal[..., 1:] = -3, 0.5
    depth[BY_HAND] = np.linspace(7.1, 7.9, 5, dtype=np.float32)
    normal[BY_HAND][1, 2] = 0  # tells of none
    depth[6, 0] = depth[0, 6] = 7.3  # up to the picture's borders
    return depth, normal


def alike(got, want, within=3e-6):
    assert want.max() > 0
    np.testing.assert_allclose(got, want, atol=within * want.max(), rtol=0)


def lit(picture, lamps, world, rims):
    """What the twin draws."""
    return Picture(*picture).light(lamps, irradiance.polynomials, world, rims)


class Case:
    """A scene with lamps, its layers, and what the twin draws. Nothing here calls the library."""

    def __init__(self, lamps, stage=None, frame=None, world=None, hidden=np.s_[:0], bends=(), off=1, rims=False):
        self.lamps, self.stage, self.by, self.bends, self.rims = lamps, stage or scene(), world, bends, rims
        self.frame = frame or Frame(WIDTH, HEIGHT)
        part = np.s_[self.frame.y:self.frame.y + HEIGHT, self.frame.x:self.frame.x + WIDTH]
        self.depth, self.normal = (layer[part].copy() for layer in layers(self.stage))
        self.depth[hidden] = 1e10
        self.depth *= np.float32(off)
        picture = (self.stage.world, self.stage.view, self.stage.projection, (self.frame.width, self.frame.height), 0.1,
                   self.depth, self.normal, (self.frame.x, self.frame.y), bends)
        self.want = kept.of(lit, picture, lamps, world, rims, by=Path(irradiance.__file__).read_bytes())

    def got(self):
        return self.stage.light(*self.lamps, depth=self.depth, normal=self.normal, frame=self.frame, world=self.by,
                                bends=self.bends, rims=self.rims)


MORE = {
    "small sun": Lamp("sun", width=0.03, model=ways()),
    "small ball": Lamp("point", width=0.05, model=ways()),
    "small rectangle": Lamp("rectangle", width=0.15, height=0.1, model=ways()),
    "tube": Lamp("rectangle", width=0, height=0.6, model=ways()),
    "level tube": Lamp("rectangle", width=0.6, height=0, model=ways()),
    "narrow grid": Lamp("ellipse", width=3.0, height=4.0, spread=0.09, model=look((18, 7, 30), (0, -1, 0.3))),
    "within": Lamp("point", width=2.0, model=moved(-0.2, -1.5, 1.2)),
    "no shadows": Lamp("rectangle", width=2.0, height=1.0, shadows=False, model=ways()),
}


def with_sets():
    """Each thing with lamps of its own, colours, a corner of the frame, what the layers show nothing of; depths of the
    screen are scaled, which moves no ray."""
    stage = scene(size=(41, 30))
    stage.projection[2] *= 0.25
    for key, sets in ((1, (0b110, ~0)), (2, (~0, 0b101)), (4, (~0, 0b10))):
        stage.world.sets[key] = sets
        stage.sets[key] = sets
    lamps = [Lamp("sun", (1, 0.5, 0.25), width=0.1, model=ways(), light_set=0, shadow_set=1),
             Lamp("point", (0, 90, 10), model=ways(-3.0), light_set=1, shadow_set=0),
             Lamp("rectangle", (50, 5, 0), width=0.5, height=0.5, model=ways(y=-2.0), light_set=2, shadow_set=2)]
    return Case(lamps, stage, Frame(41, 30, 13, 6), np.random.default_rng(4).uniform(-0.3, 1, (9, 3)),
                np.s_[3:7, 6:11])


def straight():
    stage = scene((7, 0, 4), (0.2, 0, 0.8))  # nothing to the right goes along the first axis
    stage.projection = np.array([[0.3, 0, 0, 0.05], [0, 0.4, 0, -0.1], [0, 0, -0.02, -1], [0, 0, 0, 1.0]])
    return Case([Lamp("sun", width=0.05, model=ways()), Lamp("spot", spot_angle=0.7, spot_blend=0.4, model=ways())],
                stage)


def with_bends(lamp):
    """Ellipsoids about the cube, half of the ball and the wall, of which two lie in each other, and one bends nothing.
    """
    def about(at, size, amount, fade, seed):
        turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        model = np.eye(4)
        model[:3, :3], model[:3, 3] = turn @ np.diag(size), at
        return Bend(model, amount, fade)

    return Case([lamp], bends=[about((0, 0, 1.0), (2.2, 1.9, 2.4), 1.0, 0.3, 4),
                               about((2.4, -0.6, 0.9), (1.3, 1, 1), 0.6, 0.0, 5), about((0, 0, 1), (9, 9, 9), 0, 0, 6),
                               about((-1.5, -1.0, 0.5), (1.4, 2.0, 0.9), 0.8, 1.0, 7)])


def rough(seed):
    """A sheet whose normals are not its facets', but any, in low light."""
    rng, n, stage = np.random.default_rng(seed), 7, Stage(WIDTH, HEIGHT)
    x, y = np.meshgrid(np.linspace(-3, 3, n), np.linspace(-3, 3, n))
    points = np.stack([x, y, 0.3 + 0.5 * rng.random(x.shape)], -1).reshape(-1, 3).astype(np.float32)
    k = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    corners = np.concatenate([np.stack([k, k + 1, k + n + 1], 1), np.stack([k, k + n + 1, k + n], 1)])
    normals = rng.normal(size=(n * n, 3)) * 0.5
    normals[:, 2] = np.where(rng.random(n * n) < 0.5, -1, 1)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    stage.add(points, corners.astype(np.int32), np.eye(4), np.float32(normals[corners]))
    return Case([Lamp("sun", model=ways(-4.0, 2.2, 0.8))], stage)


def between():
    """Depths between two sheets that lie so close that they could be either's."""
    stage = Stage(WIDTH, HEIGHT)
    normals = np.zeros((2, 3, 3), np.float32) + np.float32((0.6, 0, 0.8))
    stage.add(PLANE, PLANE_CORNERS, moved(0, 0, 0.003), normals)
    off = np.random.default_rng(1).uniform(1, 1.0007, (HEIGHT, WIDTH))
    return Case([Lamp("sun", model=ways())], stage, off=off)


LEAF = np.array([[-1.8, -2.4, 2.2], [0.6, -2.4, 2.3], [0.6, -0.2, 2.4], [-1.8, -0.2, 2.3]], np.float32)


def with_holes(extension, closest):
    """Leaves cut out of two triangles, one of which goes beyond its picture."""
    stage, rng = scene(), np.random.default_rng(7)
    alpha = rng.choice([0, 90, 127, 128, 160, 255], (5, 4)).astype(np.uint8)
    uvs = np.array([[[0.1, 0], [1, 0.2], [0.9, 1]], [[-0.6, 0.2], [1.4, 1.5], [-0.3, 1.9]]], np.float32)
    first = len(stage.world.owner)
    stage.add(LEAF, PLANE_CORNERS, np.eye(4), seen=False)
    stage.world.holes = {first + k: Hole(uvs[k].astype(float), alpha, extension, closest) for k in range(2)}
    stage.holes[len(stage.meshes) - 1] = uvs, np.array([3, 3], np.int32), (3, alpha, extension, closest)
    small = Lamp("rectangle", (9, 9, 9), width=0.3, height=0.2, model=ways(1.0))
    return Case([Lamp("sun", model=ways(0.6, 0.5)), small], stage)


ALL = {**{name: functools.partial(Case, [lamp]) for name, lamp in {**LAMPS, **MORE}.items()},
       **{f"bends, {name}": functools.partial(with_bends, lamp) for name, lamp in
          (("sun", LAMPS["sun"]), ("point", LAMPS["point"]), ("small rectangle", MORE["small rectangle"]))},
       **{f"rims, {name}": functools.partial(Case, [LAMPS["sun"], LAMPS[name]], rims=True)
          for name in ("point", "ball")},
       "rough": functools.partial(rough, 8), "rougher": functools.partial(rough, 1),
       "between": between, "sets": with_sets, "orthographic": straight,
       "holes": functools.partial(with_holes, "REPEAT", False),
       "holes, once": functools.partial(with_holes, "CLIP", True),
       "holes, drawn out": functools.partial(with_holes, "EXTEND", False)}


@functools.cache
def case(name):
    return ALL[name]()


OF_LITTLE_MORE = "within", "level tube", "small ball", "rims, ball", "holes, drawn out"


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow if name in OF_LITTLE_MORE else ())
                                  for name in ALL])
def test_as_the_twin_draws_it(name):
    # A narrow cone is a small difference of floats.
    alike(case(name).got(), case(name).want, 0.01 if name == "narrow grid" else 3e-6)
