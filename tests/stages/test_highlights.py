# SPDX-License-Identifier: GPL-3.0-or-later
"""Highlights of drawn light: against the sum over every lamp's points, and what makes none."""

from dataclasses import replace

import kept
import numpy as np
import pytest
from encre.pen.errors import EncreError
from encre.pen.job import Frame, Lamp
from lamps import CUBE, CUBE_CORNERS, Stage, ball, look, moved, ways
from reference import highlights as reference

WIDTH, HEIGHT = 44, 32
SHINING = {
    "sun": Lamp("sun", width=0.1, model=ways()),
    "wide sun": Lamp("sun", width=0.5, model=ways()),
    "point": Lamp("point", (60, 30, 20), model=ways()),
    "ball": Lamp("point", (60, 30, 20), width=0.6, model=ways()),
    "spot": Lamp("spot", (60, 60, 60), width=0.3, spot_angle=1, spot_blend=0.5, model=ways()),
    "rectangle": Lamp("rectangle", (60, 60, 60), width=3, height=0.5, model=ways()),
    "ellipse": Lamp("ellipse", (60, 60, 60), width=2, height=1.2, spread=2, model=ways()),
    "line": Lamp("rectangle", (60, 60, 60), width=0.3, height=0, model=ways()),
}


class Shining(Stage):
    """A smooth ball that fills the picture."""

    def __init__(self, eye=(2, -7, 3)):
        super().__init__(WIDTH, HEIGHT, eye, at=(0, 0, 0))
        self.world, self.meshes, self._given = type(self.world)(), [], []
        points, corners, normals = ball(16)
        self.add(points, corners, np.diag([2.2, 2.2, 2.2, 1]), normals)

    def shine(self, lamps, surface, frame=None, size=None, depth=None, threads=0, simd=1):
        for k, lamp in enumerate(lamps):
            self.scene.lamp(k, lamp)
        size, frame = size or (WIDTH, HEIGHT), frame or Frame(WIDTH, HEIGHT)
        depth = self.depth(frame, size) if depth is None else depth
        out = np.full((*size[::-1], 3), 7, np.float32)
        surface = np.broadcast_to(np.float32(surface), (*size[::-1], 6))
        work = self.scene.light_work(depth, None, self.view, self.projection, frame, 0.1, shine=surface, specular=out)
        self.scene._library.run(work, threads, simd)
        return out


@pytest.mark.parametrize("rough", (0.25, 0.7))
@pytest.mark.parametrize("name", SHINING)
def test_as_every_point_of_a_lamp_gives(name, rough):
    stage, surface = Shining(), (0.8, 0.5, 0.04, rough, 0.04, 0.3)
    found = stage.shine([SHINING[name]], surface)
    sharp = name == "point"
    wanted, there = kept.of(reference.draw, stage.world, SHINING[name], surface, stage.view, stage.projection, WIDTH,
                            HEIGHT, 1 if sharp else 256)
    apart, peak = abs(found - wanted)[there], wanted[there].max(0)
    assert (peak > 0.03).all() and not found[~there].any()
    mean, most, whole = (1e-5, 1e-4, 1e-3) if sharp else (0.025, 0.17, 0.05)
    assert (apart.mean(0) < mean * peak).all() and (np.percentile(apart, 99, 0) < most * peak).all()
    assert (abs(found[there].sum(0) / wanted[there].sum(0) - 1) < whole).all()


def test_a_mirror_shows_the_lamp_itself():
    stage, lamp = Shining(), SHINING["wide sun"]
    seen = stage.shine([lamp], (1, 1, 1, 0, 0, 0))[..., 0]
    bright = 1 / (np.pi * np.sin(0.25) ** 2)  # its radiance
    assert 0.97 < np.percentile(seen[seen > bright / 2], 50) / bright < 1.03
    assert ((seen > 0.02 * bright) & (seen < 0.9 * bright)).sum() < (seen > bright / 2).sum()


def test_shadows_and_matt_lamps_and_matt_things_have_none():
    stage, lamp, surface = Shining(), SHINING["ball"], (0.5, 0.5, 0.5, 0.3, 0, 0)
    free = stage.shine([lamp], surface)
    assert free.max() > 0.1 and not stage.shine([lamp], (0, 0, 0, 0.3, 0, 0.3)).any()
    assert not stage.shine([replace(lamp, matt=True)], surface).any()
    two = stage.shine([lamp, replace(lamp, matt=True)], surface)
    np.testing.assert_array_equal(two, free)
    stage.scene.lamp(1, None)
    stage.add(CUBE, CUBE_CORNERS, moved(2.4, 0.9, 4, 0.9), seen=False)  # before the lamp
    assert stage.shine([lamp], surface).max() < 0.01 * free.max()


def test_same_bytes_on_any_threads_and_instructions_and_in_parts():
    stage, lamps, surface = Shining(), list(SHINING.values()), (0.8, 0.5, 0.04, 0.2, 0.04, 0.1)
    whole = stage.shine(lamps, surface)
    for options in ({"threads": 1}, {"threads": 3}, {"simd": 0}):
        np.testing.assert_array_equal(stage.shine(lamps, surface, **options), whole)
    part = stage.shine([], surface, Frame(WIDTH, HEIGHT, 9, 7), (20, 15))
    np.testing.assert_array_equal(part, whole[7:22, 9:29])


def test_normals_of_maps_turn_light_and_highlights():
    stage, lamp = Stage(WIDTH, HEIGHT), Lamp("sun", model=ways())
    stage.scene.lamp(0, lamp)
    depth, frame, size = stage.depth(), Frame(WIDTH, HEIGHT), (HEIGHT, WIDTH, 3)
    way = np.array([0.3, -0.2, 0.9])
    turned, shine, lit = np.zeros(size, np.float32), np.zeros((*size[:2], 6), np.float32), np.zeros(size, np.float32)
    turned[:, 20:], shine[..., :4] = 3 * way, (1, 1, 1, 0.5)

    def draw(**more):
        work = stage.scene.light_work(depth, None, stage.view, stage.projection, frame, 0.1, shine=shine, specular=lit,
                                      **more)
        return stage.scene._library.run(work, 0, 1), lit.copy()

    (plain, before), (light, after) = draw(), draw(turned=turned)
    np.testing.assert_array_equal(light[:, :20], plain[:, :20])
    np.testing.assert_array_equal(after[:, :20], before[:, :20])
    slope = way @ lamp.model[:3, 2] / np.linalg.norm(way)
    free = (plain[..., 0] > 0.99 * plain[..., 0].max()) & (stage.objects() == 1)  # the ground, where there is no shadow
    assert free[:, 20:].sum() > 100
    np.testing.assert_allclose(light[:, 20:][free[:, 20:]], slope / np.pi, rtol=1e-4)
    assert (abs(after - before)[:, 20:][free[:, 20:]] > 1e-4).any()


def test_nothing_comes_out_that_is_not_finite():
    stage, rng = Shining(), np.random.default_rng(4)
    surface = rng.choice(np.float32([0, 1, -1, 1e-30, 1e30, np.inf, np.nan, 0.3]), (HEIGHT, WIDTH, 6))
    lamps = [*SHINING.values(), Lamp("point", model=look((0, 0.1, 2.2001), (0, 0, 0))), Lamp("sun", width=3.1),
             Lamp("rectangle", width=1e20, height=1e20, model=ways()), Lamp("point", width=1e3, model=ways())]
    out = stage.shine(lamps, surface)
    assert np.isfinite(out).all() and (out >= 0).all()


def test_pictures_that_are_wrong_are_refused():
    stage = Shining()
    depth = stage.depth()
    for shine, specular, words in ((np.zeros((4, 4, 6)), np.zeros((HEIGHT, WIDTH, 3)), "shine: is 4 x 4 pixels"),
                                   (np.zeros((HEIGHT, WIDTH, 6)), np.zeros((4, 4, 3)), "specular: the array")):
        with pytest.raises(EncreError, match=words):
            work = stage.scene.light_work(depth, None, stage.view, stage.projection, Frame(WIDTH, HEIGHT), 0.1,
                                          shine=np.float32(shine), specular=np.float32(specular))
            stage.scene._library.run(work, 1, 1)
