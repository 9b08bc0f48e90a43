# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of tones, hatching and stipple, against tests/reference/strokes.py and the ink that was asked for."""

import numpy as np
import pytest
import sticks
from encre.pen import library
from encre.pen.job import Frame
from encre.pen.settings import Settings
from toned import ALONE, LEVELS, MORE_LEVELS, RAMP, flat, ramped, slanted, stuck, twins, wall, without_some


@pytest.mark.parametrize("kind, space", [("HATCH", "SCREEN"), ("HATCH", "SURFACE"), ("STIPPLE", "SURFACE"),
                                         ("HATCH", "OBJECT"), ("STIPPLE", "OBJECT"), ("HATCH", "FLAT"),
                                         ("STIPPLE", "FLAT")])
def test_twin_of_strokes(kind, space):
    """With one style: what a stroke of one meets in another's pixels is not told twice."""
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone(kind, space=space, pitch=8.3, angle=20.0))
    assert twins(ramped(90, 60), scene)["Encre Tones"][..., 3].std() > 0.2


def test_twin_of_strokes_near_by():
    """Where their pitch would be wider on the screen than it may."""
    layers = wall(60, 40) | dict(anchor=slanted((40, 60), (0.005, 0.015), 0.1))
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("HATCH", space="OBJECT", pitch=8.0, angle=20.0))
    twins(layers, scene)


def test_twin_of_strokes_over_what_is_torn():
    """One thing, whose places jump by up to nine pixels' width from one pixel to the next."""
    rng, size, anchor = np.random.default_rng(1), (36, 48), slanted((36, 48), (0.003, 0.01))
    layers = wall(*size[::-1]) | dict(anchor=anchor, object=np.zeros(size, np.float32))
    for axis in 0, 1:
        gaps = np.cumsum(rng.uniform(0, 0.09, size[axis]) * (rng.random(size[axis]) < 0.3))
        anchor[..., 1 - axis] += np.float32(gaps if axis else gaps[:, None])
    anchor[..., 13:], anchor[..., (9, 12)] = (0.8, 0.3, 0), (0.007, -0.004)
    twins(layers, dict(ALONE, shade_levels=LEVELS, **sticks.tone("HATCH", space="SURFACE", pitch=6.0, angle=20.0)))


@pytest.mark.parametrize("size", [(70, 50), (80, 54)])
def test_strokes_toward_the_light(size):
    """Down the ball from there, and as the reference has them; over the edges of the box none turns to lie along it."""
    scene = dict(ALONE, shade_levels=LEVELS, tone_strokes="LIGHT", tone_light_direction=-120.0, tone_light_height=50.0,
                 **sticks.tone("HATCH", space="SURFACE", pitch=8.3, angle=0.0))
    twins(ramped(*size), scene)


def test_strokes_toward_the_light_lie_along_planes():
    """Level on two walls, seen from above: on all planes they went one way on the screen, as rain."""
    def lean(normal):
        """Degrees from the row, by the structure tensor."""
        right, down = np.array([1, 0, -normal[0] / normal[2]]), np.array([0, -1, normal[1] / normal[2]])
        rows, columns = (a[..., None] for a in np.mgrid[:200, :200])
        one = np.ones((200, 200, 1), np.float32)
        anchor = np.concatenate([(columns * right + rows * down) * one, normal * one, one, right * one, down * one,
                                 np.zeros(3) * one], 2)
        layers = dict(wall(200, 200), normal=np.float32(normal * one), anchor=np.float32(anchor))
        layers["diffuse"] = np.ones((200, 200, 3), np.float32)
        scene = dict(ALONE, shade_levels=[(0.7,)], tone_strokes="LIGHT", tone_light_direction=50.0,
                     tone_light_height=30.0, **sticks.tone("HATCH", space="SURFACE", pitch=8.0, angle=0.0))
        ink = library.render(layers, scene, outputs=["Encre Tones"]).images["Encre Tones"][40:-40, 40:-40, 3]
        y, x = np.gradient(ink)
        return np.degrees(0.5 * np.arctan2(2 * (x * y).sum(), (x * x - y * y).sum())) + 90

    assert abs((lean(np.array((0.0, 0.8, 0.6))) + 90) % 180 - 90) < 12
    assert abs(lean(np.array((0.8, 0.0, 0.6))) - 90) < 12


def test_strokes_along_uv():
    """As the reference has them; along the form on what has no UV map, and where the layer is not there."""
    layers = ramped(70, 50)
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("HATCH", space="SURFACE", pitch=8.3, angle=0.0))
    by_form, by_uv = (twins(layers, scene | dict(tone_strokes=strokes))["Encre Tones"] for strokes in ("FORM", "UV"))
    differ = np.abs(by_form - by_uv).max(-1) > 0.1
    has = layers["tangent"].any(-1)
    assert differ[has].mean() > 0.2 and not differ[~has].any()
    del layers["tangent"]
    assert np.array_equal(twins(layers, scene | dict(tone_strokes="UV"))["Encre Tones"], by_form)


def test_strokes_along_uv_in_long_rows():
    """Three pictures side by side: longer than the 256 pixels that are worked on together."""
    layers = {name: np.concatenate([a] * 3, 1) for name, a in ramped(110, 30).items()}
    layers["anchor"][..., 0] += np.arange(330) // 110 * np.float32(7)
    scene = dict(ALONE, shade_levels=LEVELS, tone_strokes="UV", **sticks.tone("HATCH", space="SURFACE", pitch=8.3))
    assert layers["tangent"][:, 260:].any()
    twins(layers, scene)


@pytest.mark.parametrize("kind", ["HATCH", "STIPPLE"])
@pytest.mark.parametrize("seed", range(3))
def test_twin_of_any_strokes(seed, kind):
    rng = np.random.default_rng(seed)
    layers = without_some(rng, ramped(70, 50, seed), "anchor", "object")
    scene = dict(ALONE, shade_levels=LEVELS, tone_crisp=seed == 2, tone_darkness=rng.uniform(-0.2, 0.2),
                 **sticks.tone(kind, space=("SURFACE", "SCREEN")[seed % 2], pitch=rng.uniform(6, 12),
                               angle=rng.uniform(-180, 180)))
    gradients = {f"tone_{n}_gradient": rng.random() for n in range(1, 5)}
    twins(layers, scene | gradients, frame=Frame(200, 160, 31, 20))


@pytest.mark.parametrize("kind", ["HATCH", "STIPPLE"])
@pytest.mark.parametrize("crisp", [False, True])
def test_twin_of_strokes_up_to_the_borders(kind, crisp):
    scene = dict(ALONE, shade_levels=MORE_LEVELS, tone_crisp=crisp, tone_darkness=0.08,
                 **sticks.tone(kind, pitch=6.0, angle=-35.0))
    assert twins(wall(43, 37), scene)["Encre Tones"][..., 3].std() > 0.2


@pytest.mark.parametrize("kind", ["HATCH", "STIPPLE"])
def test_strokes_may_fill_one_level_alone(kind):
    layers = ramped(90, 40)
    for n in range(1, 5):
        scene = dict(ALONE, shade_levels=LEVELS, tone_darkness=0.3, tone_1="NONE", tone_2="NONE") | {f"tone_{n}": kind}
        assert library.render(layers, scene, outputs=["Encre Tones"]).images["Encre Tones"][..., 3].max() > 0.3


@pytest.mark.parametrize("axis", [1, 2])
def test_where_strokes_can_not_be_counted_there_are_none(axis):
    """Beyond a thousand million pitches from where a thing rests, along either axis of its surface."""
    size = 60, 90
    y, x = np.mgrid[:size[0], :size[1]].astype(np.float32) * np.float32(0.01)
    anchor = np.zeros((*size, 16), np.float32)
    anchor[..., 1], anchor[..., 2], anchor[..., 3], anchor[..., 6] = x, y, 1, 0.01
    anchor[..., 8], anchor[..., 12] = 0.01, 0.01
    look = dict(tone_1="STIPPLE", tone_1_space="SURFACE", tone_1_pitch=16.0, tone_1_angle=0.0)
    assert flat(0.5, size, anchor, **look).any()
    anchor[..., axis] = 1e9
    assert not flat(0.5, size, anchor, **look).any()


def test_strokes_lie_alike_in_every_band_and_part():
    """A part of the frame has those that reach it, if as much around it is there as a stroke is long."""
    layers = {name: a for name, a in stuck(160, 120).items() if name not in ("style", "controls")}
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone("HATCH", space="SURFACE", pitch=6.0))

    def drawn(part=np.s_[:, :], frame=None, **how):
        return library.render({name: a[part] for name, a in layers.items()}, scene, frame=frame,
                              outputs=["Encre Tones"], **how).images["Encre Tones"]

    whole = drawn(threads=1)
    for how in (dict(threads=5), dict(simd=0)):
        assert drawn(**how).tobytes() == whole.tobytes(), how
    toward = dict(tone_strokes="LIGHT")
    lit = [library.render(layers, scene | toward, outputs=["Encre Tones"], **how).images["Encre Tones"].tobytes()
           for how in (dict(threads=1), dict(threads=5), dict(simd=0))]
    assert lit[0] == lit[1] == lit[2] != whole.tobytes()
    ring = Settings(scene).reach(120)
    part = drawn(np.s_[20:, 10:150], Frame(160, 120, 10, 20))
    assert ring < 60 and np.array_equal(part[ring:, ring:-ring], whole[20 + ring:, 10 + ring:150 - ring])


def test_a_part_has_strokes_along_planes_as_the_whole():
    """Between two slight bends: whether the surface is a plane is asked farther off than a stroke is long."""
    height, width, bend = 120, 420, 120
    rows, columns = (a[..., None] for a in np.mgrid[:height, :width])
    one, flat_ = np.ones((height, width, 1)), np.array([0.3, 0.5, 0.81])
    normal = np.where(columns < bend, flat_ + (0.03, 0, 0), np.where(columns < bend + 80, flat_, (0.36, 0.5, 0.79)))
    right, down = np.array([1, 0, -flat_[0] / flat_[2]]), np.array([0, -1, flat_[1] / flat_[2]])
    anchor = np.concatenate([(columns * right + rows * down) * one, normal * one, one, right * one, down * one,
                             np.zeros(3) * one], 2)
    layers = wall(width, height) | dict(normal=normal * one, anchor=anchor, diffuse=np.ones((height, width, 3)))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    scene = dict(ALONE, shade_levels=[(0.7,)], tone_strokes="LIGHT", tone_light_direction=-120.0,
                 tone_light_height=30.0, **sticks.tone("HATCH", space="SURFACE", pitch=4.0, angle=0.0))
    reach = Settings(scene).reach(height)

    def drawn(left):
        part = {name: np.ascontiguousarray(a[:, left:]) for name, a in layers.items()}
        return library.render(part, scene, frame=Frame(width, height, left, 0),
                              outputs=["Encre Tones"]).images["Encre Tones"]

    whole = drawn(0)
    for first in range(bend + 5, bend + 100, 4):
        left = max(0, first - reach)
        np.testing.assert_array_equal(drawn(left)[:, first - left:], whole[:, first:], err_msg=str(first))


@pytest.mark.parametrize("kind", ["HATCH", "STIPPLE"])
def test_values_that_are_none_leave_strokes_as_clean_ones_do(kind):
    """Strokes are told with the reading that finds such values, and then once more."""
    layers, rng = ramped(120, 90), np.random.default_rng(2)
    layers = {name: np.array(a, np.float32) for name, a in layers.items()}
    for name in "diffuse", "anchor":
        flat_ = layers[name].reshape(-1)
        flat_[rng.integers(flat_.size, size=9)] = np.nan
    scene = dict(ALONE, shade_levels=LEVELS, **sticks.tone(kind, space="SURFACE", pitch=6.0))
    clean = {name: np.nan_to_num(a) for name, a in layers.items()}
    got, wanted = (library.render(x, scene, outputs=["Encre Tones"]).images["Encre Tones"] for x in (layers, clean))
    assert np.array_equal(got, wanted) and got[..., 3].std() > 0.2


@pytest.mark.parametrize("pitch", [3.0, 6.0, 40.0])
def test_strokes_reach_as_far_in_any_band(pitch):
    """Upright ones, of which the last part ends beyond their length: bands of 64 rows and of 130."""
    one = np.ones((520, 90, 3), np.float32)
    layers = dict(combined=np.ones((520, 90, 4), np.float32), color=one, diffuse=one, depth=one[..., :1], normal=one)
    scene = dict(ALONE, shade_levels=[(0.4,)], **sticks.tone("HATCH", space="SCREEN", pitch=pitch, angle=90.0))
    narrow, tall = (library.render(layers, scene, threads=n, outputs=["Encre Tones"]).images["Encre Tones"]
                    for n in (5, 1))
    assert narrow.tobytes() == tall.tobytes() and tall.any()


def test_strokes_go_on_to_the_frames_edge():
    """Those whose middle is outside are missing, but none ends before the edge."""
    ink = flat(0.6, **sticks.tone("HATCH", space="SCREEN", pitch=6.0))
    for edge in (ink[:2], ink[-2:], ink[:, :2], ink[:, -2:]):
        assert edge.mean() > 0.6 * ink[40:-40, 40:-40].mean()


@pytest.mark.parametrize("kind, off", [("HATCH", 0.025), ("STIPPLE", 0.02)])
def test_ink_of_strokes_is_what_was_asked_for(kind, off):
    for look in (dict(tone_1_pitch=4.0), dict(tone_1_pitch=8.0, tone_1_angle=0.0)):
        for dark in RAMP:
            ink = flat(dark, tone_1=kind, **look)[70:-70, 70:-70]
            assert abs(ink.mean() - dark) < off, (look, dark, ink.mean())


@pytest.mark.parametrize("turn", range(-75, 91, 15))
def test_ink_of_strokes_is_what_was_asked_for_whichever_way_they_go(turn):
    """Also along the rows of the lattice on which they begin."""
    for dark in RAMP[2:-2]:
        ink = flat(dark, (340, 340), tone_1="HATCH", tone_1_pitch=8.0, tone_1_angle=0.0, tone_strokes="LIGHT",
                   tone_light_direction=turn, tone_light_height=0)[70:-70, 70:-70]
        assert abs(ink.mean() - dark) < 0.03, (dark, ink.mean())


@pytest.mark.parametrize("kind, frames, most", [("hatching", 4, 0.025), ("stipple", 4, 0.0195),
                                                ("strokes toward the light", 13, 0.022)])
def test_strokes_of_one_who_walks_do_not_pop(kind, frames, most):
    """Strokes go as far as their surface does, not to the last whole step; where the surface bends each mark has a
    pixel that holds it; and spots beside a seam of two lattices are told by their places: by pixels 2.5 % popped.
    Toward the light they hold to how it falls at rest: as they slipped on limbs that turn, 2.6 % did. As meridians
    from the light, which met in stars, 1.5 % did."""
    assert sticks.followed(sticks.SCREENS[kind], sticks.MOTIONS["walk"][:frames])[1] < most


def test_strokes_beside_the_seam_of_two_lattices_come_and_go_little_by_little():
    """Where a ball turns, and its normal's largest part is another's from a pixel to the next: .17 % popped there."""
    _, pop, varies = sticks.followed(sticks.SCREENS["hatching"], sticks.MOTIONS["turn"][:5])
    assert pop < 0.0014 and varies < 0.01
