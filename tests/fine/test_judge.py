# SPDX-License-Identifier: GPL-3.0-or-later
"""The judge of lines is itself on trial: ideal ink keeps every promise, each defect breaks the promise about it."""

from dataclasses import replace

import numpy as np
import pytest
from judge import kinds, measure, meshes, scenes, shapes, thin, verdict
from judge.camera import look
from judge.scene import Light, Scene
from judge.told import ToldMeshes, joined
from reference import near

LONG = {"sphere", "boxes", "roof", "horizon", "patches", 12}  # what the others show too
SCENES = [pytest.param(name, marks=pytest.mark.long if name in LONG else () if name == "parallel" else pytest.mark.slow)
          for name in [*scenes.NAMED, 11, 12]]


def scene_of(name):
    return scenes.NAMED[name]() if name in scenes.NAMED else scenes.draw(name)


@pytest.fixture(scope="module", params=SCENES)
def truth(request):
    return scene_of(request.param).truth


@pytest.fixture(scope="module")
def contours():
    return scenes.patches().truth


def shifted(truth, pixels):
    return replace(truth, x=truth.x + pixels * truth.nx, y=truth.y + pixels * truth.ny)


def broken(t, truth):
    """The promises that the ink breaks."""
    return {promise for promise, value in verdict.lines(t, truth).items() if not verdict.kept(promise, value)}


def test_ideal_ink_keeps_every_promise(truth):
    assert broken(measure.ideal(truth), truth) == set()
    for asked in (1, 2, 4, 8):
        width = measure.width(measure.ideal(truth, asked), truth, asked)
        assert np.isnan(width) or abs(width - asked) < 0.01


def test_ideal_ink_is_well_placed(truth):
    place = measure.place(measure.ideal(truth), truth)
    assert place["count"] > 500 and place["p95"] < 0.05 and place["max"] < 0.16


@pytest.mark.parametrize("pixels", [-0.4, 0.3])
def test_shifted_ink_is_out_of_place(contours, pixels):
    t = measure.ideal(shifted(contours, pixels))
    assert {"place p95"} <= broken(t, contours) <= {"place p95", "evenness", "steady", "stray"}
    assert measure.place(t, contours)["p95"] == pytest.approx(abs(pixels), abs=0.05)


def test_ink_far_out_of_place_in_one_spot(contours):
    bump = 0.95 * (np.arange(contours.x.size) // 64 % 40 == 0)
    t = measure.ideal(shifted(contours, bump))
    assert "place max" in broken(t, contours)


@pytest.mark.parametrize("pixels", [2.5, 4, 5.5])
def test_doubled_ink_is_not_once(contours, pixels):
    t = np.maximum(measure.ideal(contours), measure.ideal(shifted(contours, pixels)))
    assert "once" in broken(t, contours)


def test_a_short_double_is_found(contours):
    some = contours.take(np.arange(contours.x.size) // 40 % 20 == 0)  # 5 pixels in 100
    t = np.maximum(measure.ideal(contours), measure.ideal(shifted(some, 3)))
    assert "once" in broken(t, contours)


@pytest.mark.parametrize("kind", ["outline", "crease", "color"])
def test_gaps_are_found_in_their_kind(contours, kind):
    gap = contours.required(kind) & (np.arange(contours.x.size) % 640 < 20)  # 2.5 of 80 pixels
    lines = broken(measure.ideal(contours.take(~gap)), contours)
    assert "whole " + kind in lines and lines <= {"whole " + kind, "evenness"}


def test_gaps_in_light_are_found():
    truth = scenes.terminators().truth
    gap = truth.required("light") & (np.arange(truth.x.size) % 640 < 20)
    assert "whole light" in broken(measure.ideal(truth.take(~gap)), truth)


def test_widened_ink_has_another_width(contours):
    assert "evenness" in broken(measure.ideal(contours, 1.4), contours)
    for asked in (1, 2, 4, 8):
        width = measure.width(measure.ideal(contours, asked + 0.2), contours, asked)
        assert width == pytest.approx(asked + 0.2, abs=0.03)


def test_a_line_of_something_thin_is_as_wide_as_half_of_that_allows():
    """What covers a bar is too wide, and what would be too wide elsewhere is not."""
    bar = shapes.box((0.19, 2.4, 0.05), (0.1, 0.3, 0.2), scenes.turned(0.0, 0.0, 0.3))
    scene = Scene(look([0, 0.3, 6], [0, 0.3, 0]), [bar, shapes.box((20, 20, 0.1), (0, 0.3, -1), scenes.turned(0.0))],
                  kinds.FLAT, (300, 400))
    truth, wide = scene.truth, 0.19 * 1.2 * 300 / (6 - 0.225)
    points = measure._clear(truth, 8 + 2.5)
    found = thin.widest(scene, points, 8)
    assert points.x.size > 200 and found == pytest.approx(0.5 * wide / (1 - (wide / 24) ** 4), abs=0.01)
    for asked, kept in (8, False), (found.mean(), True):
        t = measure.ideal(truth, asked)
        width = measure.width(t, truth, 8, lambda at, asked: thin.widest(scene, at, asked))
        assert verdict.kept("width 8", width) == kept, width


def test_a_line_of_a_ball_is_as_wide_as_half_of_that_allows():
    scene = Scene(look([0, 0, 6], [0, 0, 0]), [shapes.ball((0.01, 0.02, 0), 0.1)], kinds.FLAT, (300, 400))
    wide = 2 * 0.1 * 1.2 * 300 / 6
    points = measure._clear(scene.truth, 4 + 2.5)
    assert points.x.size > 50
    assert thin.widest(scene, points, 8) == pytest.approx(0.5 * wide / (1 - (wide / 24) ** 4), abs=0.02)


@pytest.mark.parametrize("deep, asked", [(0.24, False), (0.45, True)])
def test_a_fold_beside_a_strip_of_less_than_three_pixels_may_be_left_out(deep, asked):
    """Of a step: its top is 2.4 or 4.5 pixels high before the next, and wider where that does not stand on it."""
    slabs = [shapes.box((1.4, 0.3, 0.8), (0, 0, 0), scenes.turned(0.0)),
             shapes.box((1.3, 0.6, 0.8 - deep), (0.1, 0.4, -deep / 2), scenes.turned(0.0))]
    for k, slab in enumerate(slabs):
        slab.color = np.array((0.3 + 0.3 * k, 0.4, 0.5))
    scene = Scene(look([0, 1.0, 6], [0, 0, 0]), slabs, kinds.FLAT, (300, 200))
    truth, edge = scene.truth, scene.camera.project(np.array([-0.55, 0.15, 0.4 - deep]), scene.size)[0]
    fold = (truth.angle > 80) & (np.abs(truth.ny) > 0.9) & (truth.x > edge + 1) & (truth.x < edge + 20) & ~truth.outline
    assert fold.sum() > 100 and truth.required("crease")[fold].any() == asked


def test_a_contour_beside_a_faint_one_is_not_alone(contours):
    k = measure._drawn(contours).take(measure._alone(contours, measure._drawn(contours), 3.5))
    x, y, nx, ny = (float(getattr(k, name)[0]) for name in ("x", "y", "nx", "ny"))
    other = replace(contours)
    other.faint = np.array([[x + 3 * nx, y + 3 * ny]] * 2)
    points = other.take(np.flatnonzero((other.x == x) & (other.y == y)))
    assert measure._alone(contours, points, 3.5).all() and not measure._alone(other, points, 3.5).any()


def test_beads_are_uneven(contours):
    bead = 1 + 0.5 * np.sin(np.arange(contours.x.size) * 0.125 * 2 * np.pi / 8)
    t = np.max([measure.ideal(contours.take(np.abs(bead - w) < 0.13), w) for w in np.arange(0.5, 1.6, 0.25)], axis=0)
    assert "evenness" in broken(t, contours)


def test_stray_ink_is_found(contours):
    t = measure.ideal(contours)
    clear = measure.ideal(contours, 16) == 0
    t[tuple(np.argwhere(clear)[::900].T)] = 1
    assert broken(t, contours) == {"stray"}


def test_rungs_knots_and_gaps_are_not_steady(contours):
    """Each every 24 pixels, but where they have bent the line itself."""
    ideal, every = measure.ideal(contours), np.arange(contours.x.size) % 192
    assert measure.steady(ideal, contours) == 1
    rung = [replace(contours, x=contours.x + k * contours.nx, y=contours.y + k * contours.ny).take(every < 4)
            for k in np.arange(0, 4, 0.5)]
    ladder = np.max([ideal, *(measure.ideal(points) for points in rung)], axis=0)
    knots = np.maximum(ideal, measure.ideal(contours.take(every < 4), 4))
    gaps = measure.ideal(contours.take(every > 16))
    assert max(measure.steady(t, contours) for t in (ladder, knots, gaps)) < 0.97


def test_popping_ink_is_not_still():
    moving = [scene.truth for scene in verdict.moving()]
    assert measure.stillness([measure.ideal(truth) for truth in moving], moving) == 1
    jumpy = [measure.ideal(replace(truth, x=np.rint(2 * truth.x) / 2, y=np.rint(2 * truth.y) / 2)) for truth in moving]
    assert measure.stillness(jumpy, moving) > 1.1
    late = [measure.ideal(moving[k // 4 * 4]) for k in range(9)]
    assert measure.stillness(late, moving) > 1.1


def test_what_need_not_be_inked_may_move_but_not_pop():
    moving = [scene.truth for scene in verdict.moving()]
    narrow = [replace(truth, index=truth.index & (truth.y < 75), depth=np.where(truth.y < 75, truth.depth, 0),
                      angle=np.where(truth.y < 75, truth.angle, 90), narrow=truth.y >= 75) for truth in moving]
    every = [measure.ideal(truth) for truth in moving]
    assert measure.stillness(every, narrow) == 1
    needed = [measure.ideal(truth) for truth in narrow]
    assert measure.stillness(needed, narrow) == pytest.approx(1, abs=0.03)
    assert measure.stillness([*every[:4], *needed[4:]], narrow) > 1.1


def test_unfair_ink_differs(contours):
    t = measure.ideal(contours)
    for symmetry in measure.SYMMETRIES:
        assert measure.differs(measure.moved(t, symmetry), measure.moved(t, symmetry)) == 0
    assert measure.differs(measure.ideal(shifted(contours, 0.3)), t) > 0.002


@pytest.mark.parametrize("name", [*(pytest.param(name, marks=pytest.mark.slow) for name in ("boxes", "terminators")),
                                  "parallel"])
def test_layers_agree_with_the_truth(name):
    """Wherever two pixels of a row have another index a contour runs between them."""
    scene = scene_of(name)
    layers, truth = scene.layers(), scene.truth
    index = layers["object"][..., 0]
    rows, columns = np.nonzero(index[:, 1:] != index[:, :-1])
    i, j = near.pairs(np.stack([rows, columns + 0.5], 1), np.stack([truth.y, truth.x], 1)[truth.index], 0.51)
    assert len(np.unique(i)) == len(rows)


@pytest.mark.parametrize("filter", ["box", "blackman"])
def test_averages_are_what_a_filter_gives(filter):
    """The shares of all pixels together are the area of what is seen."""
    scene = scenes.sphere(size=(60, 80))
    alpha = scene.layers(filter)["combined"][..., 3]
    assert np.all((alpha >= 0) & (alpha <= 1))
    r = 1.2 * 60 * 1.3 / np.sqrt(25 - 1.3**2)  # the ball's outline is nearly a circle
    assert alpha.sum() == pytest.approx(np.pi * r * r, rel=0.01)


def test_noise_is_as_strong_as_it_says():
    scene = scenes.sphere(size=(90, 120))
    clean, noisy = scene.layers(), scene.layers(noise=1.0)
    inside = clean["combined"][..., 3] == 1
    assert (noisy["normal"] - clean["normal"])[inside].std() == pytest.approx(0.01, rel=0.1)
    assert (noisy["diffuse"] / np.maximum(clean["diffuse"], 1e-9) - 1)[inside].std() == pytest.approx(0.03, rel=0.1)


def test_the_contours_of_meshes_are_those_of_the_formulas():
    camera, size, turn = look([0.4, 1.7, 6.0], [0.2, 0.6, 0], roll=0.03), (135, 240), scenes.turned(0.5, 0.2)
    solids = [shapes.box((1.6, 1.2, 1.1), (-0.9, 0.6, 0.2), turn), shapes.ball((0.7, 0.7, -0.4), 0.9)]
    formulas = Scene(camera, solids, Light(scenes.SUN, sun=0.0), size).truth
    shown = meshes.MeshScene(camera, [meshes.box((1.6, 1.2, 1.1), (-0.9, 0.6, 0.2), turn),
                                      meshes.sphere(0.9, (0.7, 0.7, -0.4))], size).truth
    for kind in ("outline", "crease"):
        one, two = (truth.take(truth.required(kind)) for truth in (formulas, shown))
        for points, others in (one, two), (two, one):
            found, _ = near.pairs(np.stack([points.x, points.y], 1), np.stack([others.x, others.y], 1),
                                   0.13)  # ends fall between points, which are an eighth of a pixel apart
            assert len(np.unique(found)) == points.x.size > 300


def board(left, right, depth):
    """From one column of a frame of 60 x 80 to another."""
    return meshes.box(((right - left) / 100, 0.4, 0.02), ((left + right - 79) / 200, 0, -depth), np.eye(3))


@pytest.mark.parametrize("boards, columns, faint", [
    ([joined(board(20, 48, 1), board(24, 45.5, 0))], [20, 24, 48], [45.5]),  # a fold beside an outline of its thing
    ([joined(board(20, 48, 1), board(24, 44, 0))], [20, 24, 44, 48], []),
    ([board(20, 48, 1), board(24, 45.5, 0)], [20, 24, 45.5, 48], []),  # of two things
    ([board(20, 40, 0), board(41.5, 60, 0.1), board(10, 70, 1)], [10, 20, 40, 60, 70], [41.5]),  # a slit
    ([board(20, 40, 0), board(42.5, 60, 0.1), board(10, 70, 1)], [10, 20, 40, 42.5, 60, 70], []),
    ([joined(board(20, 40, 0), board(41.5, 60, 0.1))], [20, 40, 60], [41.5]),  # of one thing, behind it nothing
    ([board(40, 41.5, 0), board(10, 70, 1)], [10, 40, 41.5, 70], [])])  # a thin thing
def test_of_contours_close_together_one_may_be_left_out(boards, columns, faint):
    truth = ToldMeshes(look([0, 0, 5], [0, 0, 0], height=0.6), boards, (60, 80)).truth
    asked = truth.take(truth.required("all"))
    for (x, y), want in ((np.stack([asked.x, asked.y]), columns), (truth.faint.T, faint)):
        assert np.allclose(np.unique(x[abs(y - 29) < 3].round(2)), want)


@pytest.mark.parametrize("defect", ["none", "gone", "horn"])
def test_equal_spots_are_drawn_alike(defect):
    scene = kinds.spots()
    t = measure.ideal(replace(scene.truth, narrow=np.zeros_like(scene.truth.narrow)))
    x, y = np.rint(scene.spots[4][0][0]).astype(int)
    if defect == "gone":
        t[y - 6:y + 7, x - 6:x + 7] = 0
    if defect == "horn":
        t[y + 3:y + 6, x + 2] = 1
    assert verdict.kept("alike", measure.alike(t, scene.spots)) == (defect == "none")
