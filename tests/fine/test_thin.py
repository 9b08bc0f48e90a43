# SPDX-License-Identifier: GPL-3.0-or-later
"""Rods from a third of a pixel to two and a half, which depth and index hit at pixel centres only: their two lines are
whole, keep their width, and move as the rod moves."""

import itertools

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Camera
from judge import verdict

PEN = dict(verdict.PARAMS, edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_thickness=2.0)
BORDER = 8


def rod(width, slant, moved, wall=np.inf, size=(48, 64), samples=8):
    """Layers of a rod before a wall, and the distance of each pixel from its middle."""
    way = np.array([np.cos(slant), np.sin(slant)])
    y, x = np.mgrid[:size[0], :size[1]].astype(np.float64)
    off = (x - 31.3) * way[0] + (y - 23.6) * way[1] - moved
    part = (np.arange(samples) + 0.5) / samples - 0.5
    share = np.mean([np.abs(off + dx * way[0] + dy * way[1]) < width / 2 for dx in part for dy in part], 0)[..., None]
    hit = np.abs(off) < width / 2
    flat = np.ones((*size, 3))
    layers = dict(combined=np.ones((*size, 4)), color=share * (0.3, 0.2, 0.1) + (1 - share) * (0.6, 0.7, 0.9),
                  diffuse=flat, depth=np.where(hit, 4.0, wall), object=np.where(hit, 2.0, 1.0),
                  normal=share * (0, 0, 1.0) + (1 - share) * ((0, 0, 0) if wall == np.inf else (0, 1, 0)))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, off


def ink(layers, camera=None, pen=PEN, **how):
    return library.render(layers, pen, camera=camera or Camera(), outputs=["Encre Lines"], **how).images[
        "Encre Lines"][..., 3].astype(float)


def inner(image):
    return image[..., BORDER:-BORDER, BORDER:-BORDER]


def flicker(frames):
    return np.sqrt(np.mean(inner(np.diff(frames, axis=0)) ** 2))


@pytest.mark.parametrize("wall", [np.inf, 9.0])
@pytest.mark.parametrize("slant", [0, 5, 15, 30, 45, 75])
@pytest.mark.parametrize("width", [0.4, 0.7, 1.0, 1.5, 2.0, 2.5])
def test_a_rod_is_whole_and_keeps_its_width(width, slant, wall):
    slant = np.radians(slant)
    drawn, ideal = [], []
    for step in range(9):
        layers, off = rod(width, slant, step / 8, wall)
        drawn.append(ink(layers))
        ideal.append(np.clip(width / 2 + 1.5 - np.abs(off), 0, 1))  # what two lines of 2 pixels cover
        assert inner(drawn[-1])[np.abs(inner(off)) < 0.5].min() > 0.95, step
    across = inner(np.array(drawn)).sum(2 if slant < 0.8 else 1) * max(np.cos(slant), np.sin(slant))
    assert across.min() > (width + 1.5 if width >= 1 else 1.9)
    assert across.max() < max(width, 1) + 2.51  # what is narrower than a pixel may look as wide as one
    assert flicker(drawn) < flicker(ideal) * (1.6 if width >= 1 else 3.0)


def test_a_rod_under_an_orthographic_camera():
    for width in (0.7, 1.5):
        layers, off = rod(width, 0.3, 0.2, 9.0)
        t = ink(layers, Camera(orthographic=True, height=10.0))
        assert inner(t)[np.abs(inner(off)) < 0.5].min() > 0.95


def test_a_wider_rod_has_paper_between_its_lines():
    layers, off = rod(4.0, 0.3, 0.2)
    t = ink(layers)
    assert inner(t)[np.abs(inner(off)) < 0.2].max() < 0.1
    assert inner(t)[np.abs(np.abs(inner(off)) - 2) < 0.3].min() > 0.9


def test_a_rod_ends_where_it_ends():
    layers, off = rod(1.0, 0.3, 0.2)
    empty, _ = rod(0.0, 0.3, 0.2)
    for name, a in layers.items():
        a[24:] = empty[name][24:]
    t = ink(layers)
    assert t[:23][np.abs(off[:23]) < 0.5].min() > 0.95
    assert t[26:].max() == 0


def anchored(layers, near):
    """Where on its thing a pixel lies; `near`: how large one is on the rod, a third of one on the wall."""
    anchor = np.zeros((*layers["depth"].shape, 16), np.float32)
    anchor[..., 6] = np.where(layers["object"] == 2, near, 3 * near)
    anchor[..., :2] = np.indices(anchor.shape[1::-1]).T * anchor[..., 6:7]
    anchor[..., 2] = layers["depth"]
    return anchor


@pytest.mark.parametrize("width", [6, 8, 12])
def test_half_of_a_limb_stays_clear(width):
    """Of fingers and thin arms under a fat brush."""
    layers, off = rod(width, 0.3, 0.2, 9.0, (80, 96))
    t = inner(ink(layers, pen=dict(PEN, line_thickness=10.0)))
    assert 0.4 < 1 - t[np.abs(inner(off)) < width / 2].mean() < 0.6


@pytest.mark.parametrize("radius", [2.5, 3.0, 3.4])
def test_an_eye_does_not_blink(radius):
    """A small round thing before another, as it moves: its line has no ways that tell how wide the thing is."""
    flat, drawn = np.ones((40, 40, 3)), []
    for k in range(12):
        y, x = np.mgrid[:40, :40] - np.array((20 + 0.21 * k % 1, 20 + 0.37 * k % 1))[:, None, None]
        hit = np.hypot(x, y) < radius
        layers = dict(combined=np.ones((40, 40, 4)), color=flat, diffuse=flat, normal=flat * (0, 0, 1),
                      depth=np.where(hit, 4.9, 5.0), object=np.where(hit, 2.0, 1.0))
        drawn.append(ink({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}).sum())
    assert np.std(drawn) < 0.07 * np.mean(drawn)


@pytest.mark.parametrize("wide", [9.0, 11.0, 12.6])
def test_half_of_a_ball_stays_clear_as_of_a_bar(wide):
    """Contours of what is round lie aslant of each other along rows: half of it, not of a chord of it."""
    y, x = np.mgrid[:64, :64] - np.array((31.3, 32.6))[:, None, None]
    flat, hit = np.ones((64, 64, 3)), np.hypot(x, y) < wide / 2
    layers = dict(combined=np.ones((64, 64, 4)), color=flat, diffuse=flat, normal=flat * (0, 0, 1),
                  depth=np.where(hit, 4.0, 9.0), object=np.where(hit, 2.0, 1.0))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    t = ink(layers, pen=dict(PEN, line_thickness=10.0))
    half = 0.25 * wide / (1 - (wide / 24) ** 4)  # of the line, as of a bar so wide
    assert np.sqrt((hit * (1 - t)).sum() / np.pi) == pytest.approx(wide / 2 - half, abs=0.35)


@pytest.mark.parametrize("width", [12, 14])
def test_the_sides_of_a_pole_are_no_beads(width):
    """Of a brush whose rim is frayed and whose lines have room for a part of their width: it varies slowly."""
    pen = dict(PEN, line_thickness=10.0, pen_1_rough=0.45, pen_1_pressure=0.32)
    layers, off = rod(width, np.radians(97), 0.2, 9.0, (120, 600))
    t = ink({**layers, "anchor": anchored(layers, 0.01)}, pen=pen)
    for side in off < 0, off > 0:
        across = np.where(side, t, 0).sum(0)[100:-100]
        assert np.mean([across[k:k + 10].std() for k in range(0, 390, 5)]) < 0.26, "over 10 pixels each"


@pytest.mark.parametrize("level", [0, 0.5, 1, 3, 10, 45])
def test_a_level_wire_is_as_wide_all_along(level):
    """Also where it covers no pixel centre, before a wall that is far away and drawn with other widths; and drawn by a
    hand that presses now more, now less, it has no beads, nor is it one line here and two there."""
    near = slice(12, 84) if level < 20 else slice(20, 42)
    pressed = dict(pen_1_pressure=0.5, pen_1_pressure_length=60.0, line_thickness=1.6)
    for width in (0.7, 1.0, 1.5, 2.0, 3.0, 4.0):
        layers, off = rod(width, np.radians(90 - level), 0.2, 9.0, (40, 96))
        layers["anchor"] = anchored(layers, 0.1)
        for hand in ({}, pressed):
            pen = dict(PEN, line_contact_width=0.4, line_far_distance=4.0, **{"line_thickness": 2.0, **hand})
            t = ink(layers, pen=pen)
            across = np.convolve(t.sum(0)[near] * np.cos(np.radians(level)), np.ones(3) / 3, "valid")
            middle = np.where(np.abs(off) < 0.5, t, 0).max(0)[near]
            assert np.abs(across[4:] - across[:-4]).max() < 0.5, (width, hand)
            assert hand or np.ptp(across) < 0.7, width
            assert not hand or width > 3 or np.ptp(middle) < 0.25, width


def test_where_wires_cross_is_no_knot():
    """Lines of a thin thing are thin; where another one passes it has no contour on the other side there, and a broad
    pen made a ball of each crossing."""
    pen = dict(PEN, line_thickness=9.0)
    for width in (1.0, 1.5, 2.2, 3.0):
        for turn, slant in itertools.product((8, 12, 16, 25, 40, 60, 75), (0.4, 1.5)):
            front, off = rod(width, slant, 0.2, size=(64, 160))
            back, behind = rod(width, slant + np.radians(turn), 0.4, size=(64, 160))
            hit = front["object"] == 2
            both = {name: np.where(hit if a.ndim == 2 else hit[..., None], front[name], a) for name, a in back.items()}
            both["depth"] += np.where(hit, 0, 0.8).astype(np.float32)
            both["object"] += ((behind_hit := back["object"] == 2) & ~hit).astype(np.float32)
            alone, t, near = ink(front, pen=pen), ink(both, pen=pen), np.minimum(np.abs(off), np.abs(behind))
            reach = inner(np.abs(off))[inner(alone) > 0.3].max()
            assert behind_hit.any() and reach < 4
            assert inner(near)[inner(t) > 0.3].max() < reach + 0.6, (width, turn, slant)


def test_faint_lines_are_no_thorns_on_a_pole():
    """Streaks of a wall that are too faint to be seen grew to the width of the pole's line where they meet it."""
    pen = dict(PEN, edge_threshold=0.01, line_color_strength=1.0, line_contrast=1.0, line_thickness=5.0)
    for width in (2.0, 4.0, 6.0):
        layers, off = rod(width, 0.1, 0.2, 9.0)
        streaky = {**layers, "color": layers["color"].copy()}
        streaky["color"][(off > width / 2) & (np.indices(off.shape)[0] % 8 < 4)] *= 0.9
        plain, t = (inner(ink(a, pen=pen)) for a in (layers, streaky))
        assert plain.max() > 0.9 and (t - plain).max() < 0.15, width


def test_threads_and_instructions_change_nothing():
    layers, _ = rod(0.7, 0.3, 0.2)
    one = ink(layers, threads=1)
    for how in (dict(threads=3), dict(threads=1, simd=0)):
        assert np.array_equal(one, ink(layers, **how))


@pytest.mark.parametrize("turned", [False, True])
def test_a_joint_beside_a_corner_is_no_wire(turned):
    """A drum's corner covers the centre of one pixel; beside it ends a joint that is drawn on the ground."""
    y, x = np.mgrid[:384, :512] / 8
    drum = (x > 30.3 + 0.25 * np.abs(y - 19.3))[..., None]
    ground = np.where((np.abs(y - 20.8) < 0.4)[..., None], 0.3, 0.5) * np.ones(3)
    fine = dict(color=np.where(drum, (0.9, 0.5, 0.02), ground), normal=np.ones_like(ground) * (0, 0, 1))
    hit = drum[3::8, 3::8, 0]
    assert (hit[17:22, 30].sum(), hit[:, 29].sum()) == (1, 0)
    layers = {name: a.reshape(48, 8, 64, 8, 3).mean((1, 3)) for name, a in fine.items()}
    layers |= dict(combined=np.ones((48, 64, 4)), diffuse=np.ones((48, 64, 3)), depth=np.where(hit, 4.0, 9.0),
                   object=np.where(hit, 2.0, 1.0))
    if turned:
        layers = {name: a.swapaxes(0, 1) for name, a in layers.items()}
    drawn = ink({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()})
    drawn = drawn.T if turned else drawn
    assert drawn[:, 28:].max() > 0.9 and not drawn[:, :28].any()
