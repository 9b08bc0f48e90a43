# SPDX-License-Identifier: GPL-3.0-or-later
"""The ink along FINE's lines against its twin, on the sites and links that the library has found."""

import itertools

import hands
import kept
import known
import numpy as np
import passes
import pytest
import tangles
from encre.pen import library
from encre.pen.job import Camera, Frame
from reference import hand, paper, strips, strokes
from reference.frame import Layers
from reference.params import Params
from reference.passes import Table

BARE = dict(paper_source="NONE", length_unit="PIXELS", pen_1_softness=0.0, pen_1_steepness=1.0, pen_1_intensity=1.0,
            use_shading=False, use_smudging=False, use_hatching=False)
PENS = {  # the case, what it is drawn with
    "hairline": ("wires", dict(line_thickness=1.0)),
    "faint": ("things", dict(line_thickness=0.6, pen_1_intensity=2.0, line_color_width=2.0)),
    "soft": ("faces", dict(line_thickness=5.0, pen_1_softness=0.9, pen_1_steepness=4.0)),
    "taper": ("noise", dict(line_thickness=3.0, pen_1_taper=12.0, pen_1_intensity=1.6)),
    "wide": ("rods", dict(line_thickness=7.0, pen_1_softness=0.3, line_outline_width=0.5, line_crease_width=1.4)),
    "filled": ("far rods", dict(line_thickness=1.6, line_contrast=0.5)),
    "paper": ("mirror", dict(line_thickness=2.0, paper_source="COLD_PRESS", pen_1_grain=0.7, pen_1_steepness=4.0)),
    "tinted": ("styles", dict(line_thickness=1.1, ink_tint=0.8, ink_tint_value=0.6, ink_in_shade=0.7, line_contrast=1.0,
                              line_far_distance=4.0)),
    "brush": ("faces", dict(line_thickness=5.0, pen_1_pressure=0.6, pen_1_pressure_length=40.0, pen_1_rough=0.5,
                             pen_1_rough_length=5.0, pen_1_seed=7)),
    "frayed": ("faces", dict(line_thickness=9.0, pen_1_rough=1.2, pen_1_rough_length=1.5)),
    "stray": ("faces", dict(line_thickness=3.0, pen_1_wobble=1.2, pen_1_wobble_length=25.0, pen_1_strokes=2,
                            pen_1_gaps=0.3,
                            pen_1_gaps_length=20.0, line_contact_width=1.6, line_intersection_width=0.4)),
    "dry": ("faces", dict(line_thickness=3.3, pen_1_dry=0.8)),
    "inks": ("faces", dict(line_thickness=3.0, ink_by_kind=True, line_outline_ink=(0.8, 0, 0), ink_in_light=0.4,
                           line_contact_ink=(0, 0.7, 0), line_inner_ink=(0, 0, 0.9), ink_tint=0.2,
                           line_crease_ink=(0.5, 0.5, 0), line_color_ink=(0, 0.5, 0.5))),
    "sketch": ("faces", dict(line_thickness=1.2, pen_1_softness=0.4, pen_1_steepness=2.0, pen_1_wobble=0.5,
                             pen_1_strokes=3,
                             ink_by_kind=True, line_outline_ink=(0.8, 0, 0), line_inner_ink=(0, 0, 0.9))),
    "pens": ("faces", dict(line_thickness=3.0, pen_1_rough=0.4, pen_1_rough_length=6.0, line_crease_pen="PEN_2",
                           line_contact_pen="PEN_2", line_color_pen="PEN_3", pen_2_width=0.5, pen_2_softness=0.0,
                           pen_2_steepness=1.0, pen_2_strokes=2, pen_2_wobble=0.8, pen_2_seed=3, pen_2_grain=0.0,
                           pen_3_softness=0.5, pen_3_intensity=0.8, pen_3_taper=6.0, pen_3_pressure=0.5,
                           pen_3_pressure_length=30.0)),
    "beyond": ("faces", dict(line_thickness=1.5, pen_1_overshoot=9.0, pen_1_strokes=2, pen_1_wobble=0.4,
                             pen_1_overshoot_color=0.4, ink_by_kind=True, line_crease_ink=(0.5, 0, 0))),
    "turning": ("faces", dict(line_thickness=2.0, pen_1_pool=1.0, pen_1_pressure=0.3, pen_1_pressure_length=25.0,
                              pen_1_hold=2,
                              pen_1_boil=0.4)),
    "bending": ("things", dict(line_thickness=3.0, pen_1_curve=1.5, line_crease_pen="PEN_2", pen_2_curve=-0.8,
                               line_color_pen="PEN_2", pen_2_softness=0.0, pen_2_grain=0.0)),
    "dashed": ("faces", dict(line_thickness=1.5, pen_1_dash=7.0, pen_1_dash_space=3.0, line_crease_pen="PEN_2",
                             pen_2_dash=3.0, pen_2_dash_space=4.0, pen_2_softness=0.0, pen_2_grain=0.0)),
    "strip": ("faces", dict(line_thickness=6.0, pen_1_softness=0.3, pen_1_strip=0.9, pen_1_strip_length=25.0,
                            pen_1_strip_image="strip", line_crease_pen="PEN_2", pen_2_strip=1.0, pen_2_strip_length=9.0,
                            pen_2_strip_image="strip", pen_2_dry=0.4, pen_2_softness=0.0, pen_2_grain=0.0)),
    "thin strip": ("rods", dict(line_thickness=2.0, pen_1_strip=1.0, pen_1_strip_length=6.0, pen_1_strip_image="strip",
                                pen_1_wobble=0.6, pen_1_overshoot=6.0)),
    "thicket": ("wires", dict(line_thickness=2.0, line_density=0.2)),
    "fewer": ("wires", dict(line_thickness=2.0, line_density=0.2, line_fewer=1.0)),
    "partly fewer": ("faces", dict(line_thickness=3.0, line_density=0.1, line_fewer=0.6)),
    "fewer of all": ("things", dict(line_thickness=3.0, line_density=0.3, line_fewer=1.0, pen_1_pressure=0.3,
                                    pen_1_pressure_length=25.0)),
    "on dark": ("rods", dict(line_thickness=4.0, ink_on_dark=0.9, ink_dark_threshold=0.4, ink_dark_width=0.6)),
    "colours on dark": ("faces", dict(line_thickness=4.0, ink_on_dark=1.0, ink_dark_threshold=0.6,
                                      ink_dark_colors=0.4)),
    "bright before dark": ("wires", dict(line_thickness=4.0, ink_on_dark=0.9, ink_dark_threshold=0.1)),
    "first": ("few wires 3", dict(line_thickness=5.0, pen_1_taper=5.0)),
    "not hidden": ("things", dict(line_thickness=4.0, line_occlude=False, line_shadow_width=2.0, line_thickest=5.0)),
}


STRIP = np.random.default_rng(3).random((6, 37, 4))


@pytest.mark.parametrize("name", PENS)
def test_lines_are_the_union_of_discs_along_links(name):
    case, pen = PENS[name]
    few = {"strip": 0.02, "fewer": 0.036, "fewer of all": 0.03, "dark": 0.003}  # rounding tells one of two as good ways
    assert compared(case, pen, few.get(name, few.get(name.split()[-1], 0))) > 0.03


@pytest.mark.parametrize("k", range(1, 18, 2))
def test_lines_that_leave_the_picture_are_drawn_as_far_as_it_goes(k):
    compared(f"cut {k}", [*PENS.values()][k % len(PENS)][1], 0.02)


ANY = {  # of a pen, what it may be, and how long it is
    "pressure": (0.2, 0.9), "pressure_length": (15, 60), "wobble": (0.3, 2), "wobble_length": (12, 40),
    "gaps": (0.05, 0.5), "gaps_length": (8, 40), "dry": (0.2, 1.2), "overshoot": (3, 15),
    "rough": (0.3, 0.9), "rough_length": (3, 12), "pool": (0.5, 2), "dash": (2, 12), "dash_space": (0, 6),
    "boil": (0, 1)}
LENGTHS = ("pressure_length", "wobble_length", "gaps_length", "dash_space", "rough_length", "boil")
CHOSEN = ("pressure", "wobble", "gaps", "dry", "overshoot", "rough", "pool", "dash")


def any_pen(rng, pen="pen_1_"):
    """A few of the things that a hand does."""
    own = {name: rng.uniform(*ANY[name]) for name in (*LENGTHS, *rng.choice(CHOSEN, 3, False))}
    own |= dict(seed=int(rng.integers(0, 2**31)), strokes=int(rng.choice([1, 1, 2])),
                hold=int(rng.integers(0, 3)))
    return {pen + name: value for name, value in own.items()}


@pytest.mark.parametrize("seed", [k if k < 5 else pytest.param(k, marks=pytest.mark.long) for k in range(10)])
def test_any_pen_on_any_lines(seed):
    rng = np.random.default_rng(seed)
    case = ("faces", "rods", "things", "wires", "painted")[seed % 5]
    pen = dict(any_pen(rng), line_thickness=rng.uniform(1, 5), line_density=rng.choice([1, 0.3]),
               pen_1_taper=rng.choice([0, 9]), line_contact_width=rng.uniform(0.5, 1.5), **any_pen(rng, "pen_2_"),
               line_crease_pen="PEN_2", line_inner_pen="PEN_2", pen_2_width=rng.uniform(0.5, 1.5), pen_2_grain=0.0,
               pen_2_softness=rng.random(), pen_2_steepness=rng.uniform(1, 4), pen_2_intensity=rng.uniform(0.5, 2))
    compared(case, pen, 0.02, seed % 3 == 0)  # rounding tells between two as good ways along which to part a line


@pytest.mark.parametrize("pen", [dict(line_thickness=2.0, pen_1_pool=1.0, line_density=0.15),
                                 dict(line_thickness=1.5, pen_1_overshoot=9.0, pen_1_strokes=2),
                                 dict(line_thickness=2.0, pen_1_curve=1.5),
                                 dict(line_thickness=1.5, pen_1_dash=7.0, pen_1_dash_space=3.0)],
                         ids=lambda pen: [*pen][1])
@pytest.mark.parametrize("seed", range(2))
def test_any_lines_turn_and_part(seed, pen):
    """Chains by chance."""
    layers, site, link = tangles.tangle(seed)
    layers = {**layers, "anchor": leaning(layers["depth"].shape)}
    scene = {**passes.ALL, **BARE, **pen}
    images, every = passes.run(layers, scene, given=(site, link))
    held(images, every, Layers(layers, 0, {}, None), scene, (), 0.004)


def compared(case, pen, few=0.0, anchored=False):
    """The ink of a case held to the twin's; how much of the picture there is ink on."""
    layers, scene, view = passes.given(case)
    _, _, styles, camera = passes.EVERY[case]
    scene = {**scene, **BARE, **pen}
    if anchored:
        layers = {**layers, "anchor": leaning(view.shape)}
    images, every = passes.run(layers, scene, styles, camera, image=lambda _: STRIP)
    return held(images, every, Layers(layers, len(styles), vars(camera or Camera()), None), scene, styles, few)


def leaning(shape):
    """The anchor of a surface that no axis is along."""
    place = np.zeros((*shape[:2], 16), np.float32)
    place[..., 6:13] = 0.05, 0.05, 0.01, 0.007, 0.02, 0.04, 0.03
    place[..., :3] = np.indices(shape[1::-1]).T @ place[0, 0, 7:13].reshape(2, 3)
    return place


def held(images, every, layers, scene, styles, few):
    last = [s for s in every if s.name in ("drop short", "even eased", "ease forms")][-1]
    params = Params({k: v for k, v in scene.items() if k != "crease_angle" and not k.endswith("_image")}, styles)
    pictures = {(id_.removesuffix("_strip_image"), style): strips.pyramid(STRIP) for id_ in scene
                if id_.endswith("_strip_image") for style in range(len(styles) + 1)}
    t, ink, unsure = kept.of(strokes.draw, Table(last.site, last.link), layers, params,
                             paper.heights(layers, params)[0], pictures)
    got, sure = images["Encre Lines"], ~unsure
    assert unsure.mean() < 0.4
    assert (np.abs(got[..., 3] - t)[sure] > 1e-3).mean() <= few
    assert (np.abs(got[..., :3] - ink * t[..., None])[sure].max(-1) > 2e-3).mean() <= few
    return (t > 0.02).mean()


def test_a_hand_draws_the_same_with_any_threads_and_instructions():
    layers, scene, _ = passes.given("things")
    scene = {**scene, **BARE, "line_thickness": 5.0, "pen_1_pressure": 0.5, "pen_1_wobble": 1.0,
             "pen_1_wobble_length": 20.0,
             "pen_1_rough": 0.6, "pen_1_gaps": 0.2, "pen_1_dry": 0.6, "pen_1_strokes": 3, "ink_on_dark": 0.5,
             "ink_in_light": 0.5}
    styles = [{"pen_1_strokes": 1, "pen_1_dry": 0.0, "ink_by_kind": True}]
    layers = {**layers, "style": np.float32(np.indices(layers["depth"].shape[:2]).sum(0)[..., None] // 9 % 2)}
    outputs = ("Combined", "Encre Lines")
    first = library.render(layers, scene, styles, outputs=outputs, threads=1, simd=1).images
    for threads, simd in ((2, 1), (5, 1), (1, 0), (3, 0)):
        other = library.render(layers, scene, styles, outputs=outputs, threads=threads, simd=simd).images
        assert all(first[name].tobytes() == other[name].tobytes() for name in outputs)


def test_dashes_stick_while_the_camera_pans():
    """On rims too, where rest positions grow without bounds from pixel to pixel."""
    poses = [(hands.sticks.scene(), *hands.sticks.eye(pose["pan"])) for pose in hands.sticks.MOTIONS["pan"][:4]]
    assert hands.followed(hands.PENS["dashes"], poses)[1] > 0.92


def test_a_hand_sticks_to_one_who_walks():
    """Skin that bends, and legs that pass before each other."""
    poses = [(hands.walker(k / 24, 0.05 * k - 0.3), *hands.sticks.eye(zoom=1.6)) for k in range(3)]
    assert hands.followed(hands.PENS["brush"], poses)[1] > 0.94
    assert max(abs(share - 1) for share in hands.sizes(hands.PENS["brush"])) < 0.1


@pytest.mark.parametrize("wobble", [1.3, 3.0])
def test_two_strokes_are_as_dark_at_a_quarter_of_the_size(wobble):
    """Thin ones, that overlap in most pixels, or hardly do."""
    values = {**hands.PENS["pencil"], "line_thickness": 4.0, "pen_1_wobble": wobble}
    assert hands.sizes(values, (180,))[0] == pytest.approx(1, abs=0.1)


def test_a_part_of_a_frame_is_as_dense_as_the_frame():
    """Farther from its rim than anything is looked at: ink is weighed on nodes of the full frame."""
    view, projection = hands.sticks.eye()
    layers, _ = hands.sticks.layers_of(hands.sticks.scene(), view, projection)
    whole = hands.drawn(layers, view, {"line_density": 0.1})[0]
    x, y, width, height = 137, 41, 300, 250
    part = {name: np.ascontiguousarray(a[y:y + height, x:x + width]) for name, a in layers.items()}
    ink = library.render(part, {**hands.PLAIN, "line_density": 0.1}, camera=Camera(view[:3, :3].ravel()),
                         frame=Frame(*hands.sticks.SIZE, x, y), outputs=("Encre Lines",)).images["Encre Lines"][..., 3]
    inner = np.s_[60:-60, 60:-60]
    assert (ink[inner] > 0.5).sum() > 100
    assert np.abs(ink - whole[y:y + height, x:x + width])[inner].max() < 1e-3


def palisade():
    """Bars of two pixels every four, before what is far behind them."""
    shape = 90, 160
    bar = np.broadcast_to(np.arange(shape[1]) // 2 % 2, shape)[..., None] > 0
    flat = np.ones((*shape, 3))
    layers = dict(combined=np.ones((*shape, 4)), color=np.where(bar, 0.2, 0.7) * flat, diffuse=flat,
                  depth=np.where(bar, 4.0, 20.0), normal=flat * (0, 0, 1), object=bar + 1)
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def sparse(**values):
    values = {**hands.PLAIN, "length_unit": "PIXELS", "line_thickness": 1.6, "line_density": 0.3, **values}
    return library.render(palisade(), values, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]


def test_of_too_many_lines_some_are_left_out_and_the_others_black():
    thin, few = (sparse(line_fewer=fewer)[10:-10, 10:-10] for fewer in (0.0, 1.0))
    assert thin.max() < 0.4 and thin.min() > 0.2  # a grey haze
    black = few > 0.9
    assert 0.02 < black.mean() < 0.2 and (few < 0.1).mean() > 0.8
    assert (few[1:][black[:-1]] > 0.5).mean() > 0.9  # strokes, not crumbs


def bodies(number, **values):
    """The ink of what is seen of bodies of these numbers, each a little farther away than the one before: so little
    that none has an outer contour, as the lids of an eye have none."""
    number, flat = number[..., None], np.ones((*number.shape, 3))
    layers = dict(combined=np.ones((*flat.shape[:2], 4)), color=flat, diffuse=flat, depth=4.0 + 0.05 * number,
                  normal=flat * (0, 0, 1), object=number + 1)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    values = {**hands.PLAIN, "length_unit": "PIXELS", **values}
    return library.render(layers, values, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]


def beside(*columns, **values):
    """The ink of a row in the middle, where one body borders on the next at these columns."""
    shape = 160, 160
    return bodies(np.broadcast_to((np.arange(shape[1])[:, None] >= columns).sum(1), shape), **values)[80]


def test_four_lines_close_by_leave_paper_between_them_and_a_broad_one_is_alone():
    values = dict(line_thickness=6.0, line_density=0.4)
    rings = beside(69, 77, 85, 93, **values)
    assert all(rings[column] > 0.9 for column in (69, 77, 85, 93)) and rings[72:90].mean() < 0.5
    assert beside(80, **{**values, "line_thickness": 24.0}).sum() == pytest.approx(24, abs=0.3)


def test_three_rings_of_a_small_eye_thin_out_but_stay():
    far = np.hypot(*(np.mgrid[:120, :120] - np.reshape((59.7, 60.2), (2, 1, 1))))
    eye = [bodies(sum((far > radius).astype(int) for radius in radii), line_thickness=4.0, line_density=0.4)
           for radii in ((14, 9.5, 5), (14,))]
    assert eye[0][far < 14].mean() < 0.7  # of lines 4 pixels wide, which rings so close would cover by 0.87
    assert all(eye[0][np.abs(far - radius) < 0.5].min() > 0.8 for radius in (14, 9.5, 5))
    assert all(eye[0][np.abs(far - radius) < 0.3].mean() < 0.4 for radius in (11.75, 7.25))
    assert eye[1].sum() == pytest.approx(2 * np.pi * 14 * 4, rel=0.05)  # one by itself stays as it is


def test_four_broad_lines_close_by_leave_as_much_paper():
    """Each covers more than the bound of what is closest about it, and may by itself."""
    ink = beside(56, 72, 88, 104, line_thickness=12.0, line_density=0.4)
    assert all(ink[column] > 0.9 for column in (56, 72, 88, 104)) and ink[64:96].mean() < 0.55


def crowded(inside, **values):
    """The ink of a row, summed about the outer contour of a body far before what is behind it, on which flat things
    border on each other at each of these columns."""
    number = np.broadcast_to((np.arange(160)[:, None] >= (60, *inside)).sum(1), (160, 160))[..., None]
    flat = np.ones((*number.shape[:2], 3))
    layers = dict(combined=np.ones((*flat.shape[:2], 4)), color=flat, diffuse=flat, normal=flat * (0, 0, 1),
                  depth=np.where(number > 0, 4.0, 100.0), object=number + 1)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    values = {**hands.PLAIN, "length_unit": "PIXELS", "line_thickness": 4.0, "line_density": 0.3, **values}
    ink = library.render(layers, values, outputs=["Encre Lines"]).images["Encre Lines"][80, :, 3]
    return ink[54:63].sum(), ink[66:100].mean()


def test_an_outer_contour_keeps_its_width_beside_many_lines():
    """Which thin out."""
    alone, crowd, each = crowded(()), crowded(range(66, 120, 4)), crowded(range(66, 120, 4), line_density=1)
    assert crowd[0] == pytest.approx(alone[0], rel=0.05)
    assert crowd[1] < 0.4 < 0.8 < each[1]


@pytest.mark.parametrize("apart", [0.0, 0.15])
def test_lines_that_lie_on_each_other_count_once(apart):
    """Nor does the hand of a doubled shell differ from that of a single one."""
    ink = [known.drawn(known.flat(), [known.line([(40 + k * apart, -5), (40 + k * apart, 101)], "mark", k)
                                      for k in range(lines)], line_thickness=4.0, line_density=0.2)[20:-20].sum(1)
           for lines in (1, 4)]
    assert np.abs(ink[1] - ink[0]).max() < 3 * apart + 0.1
    assert ink[0].min() > 2


def test_lines_are_as_dense_at_the_rim_of_the_frame():
    ink = sparse()
    assert ink[:, :16].mean() == pytest.approx(ink[:, 60:100].mean(), rel=0.15)
    assert ink[:12, 60:100].mean() == pytest.approx(ink[30:60, 60:100].mean(), rel=0.15)


def test_a_hand_draws_anew_when_its_frames_are_over():
    """By the number of a frame alone: it needs none before it."""
    layers, scene, _ = passes.given("faces")
    scene = {**scene, **BARE, "line_thickness": 3.0, "pen_1_wobble": 1.0, "pen_1_wobble_length": 20.0}
    height, width = layers["depth"].shape[:2]

    def drawn(number, **values):
        frame = Frame(width, height, number=number)
        return library.render(layers, {**scene, **values}, outputs=("Encre Lines",), frame=frame).images["Encre Lines"]

    once = drawn(7)
    assert np.array_equal(once, drawn(8)) and np.array_equal(once, drawn(8, pen_1_hold=2, pen_1_boil=0.0))
    twos = [drawn(number, pen_1_hold=2) for number in (-2, -1, 0, 1, 2)]
    assert np.array_equal(twos[0], twos[1]) and np.array_equal(twos[2], twos[3])
    steps = [np.abs(one - other).mean() for one, other in ((twos[1], twos[2]), (twos[3], twos[4]))]
    little = np.abs(drawn(1, pen_1_hold=2, pen_1_boil=0.1) - once).mean()
    assert min(steps) > 3 * little > 0


def test_pressure_swells_a_line_by_the_noise_where_it_runs():
    """A straight outline in the frame: its width, row by row, is that of the twin's noise, and of the mean asked."""
    height, width = 400, 40
    object_ = np.zeros((height, width, 1), np.float32)
    object_[:, 20:] = 1
    flat = np.ones((height, width, 3), np.float32)
    layers = {"combined": np.ones((height, width, 4), np.float32), "color": flat, "diffuse": flat, "normal": flat,
              "depth": 5 * flat[..., :1], "object": object_}
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 6.0, "pen_1_intensity": 2.0,
             "pen_1_pressure": 0.4, "pen_1_pressure_length": 60.0}
    ink = library.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3].sum(1)[4:-4]
    at = np.stack([np.full(height, 20.0), np.arange(height) + 0.5, np.zeros(height)], -1)
    noise = hand.solid(at, np.full(height, 60.0), hand.PRESSURE)[4:-4]
    assert np.abs(ink - 6 * np.clip(1 + 0.4 * noise, 0.12, 3)).max() < 0.15


def test_a_hand_presses_evenly_where_lines_are_many():
    """Small things side by side, each shorter than a swelling: none is bold beside faint ones. By itself one is."""
    side, count = 14, 16
    flat = np.ones((side * count, side * count, 3), np.float32)
    apart, scene = [], {**BARE, "edge_detector": "FINE", "line_thickness": 5.0, "line_density": 0.3,
                        "pen_1_pressure": 0.4, "pen_1_pressure_length": 60.0}
    for every in (1, 4):
        place = np.arange(side * count) // (every * side)
        layers = {"combined": np.ones((*flat.shape[:2], 4), np.float32), "color": flat, "diffuse": flat, "normal": flat,
                  "depth": 5 * flat[..., :1], "object": np.float32(place[:, None] * 99 + place)[..., None]}
        ink = library.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3]
        cells = ink.reshape(count // every, every * side, count // every, every * side).mean((1, 3))[1:-1, 1:-1]
        apart.append(cells.std() / cells.mean())
    assert apart[0] < 0.06 < 0.12 < apart[1]


def test_noise_is_of_one_thing_where_two_touch():
    """An upright line between two things of which now this one is nearer, now that one, by a thousandth."""
    height, width = 400, 40
    flat = np.ones((height, width, 3), np.float32)
    object_, place = np.ones((height, width, 1), np.float32), np.full((height, width, 16), 0.02, np.float32)
    object_[:, 20:] = 2
    place[..., :3] = (np.indices((height, width)).sum(0) * 0.02)[..., None]
    place[:, :20, :3] += 31  # units: the left one is elsewhere at rest
    depth = 5 * flat[..., :1]
    depth[::2, 20:] = depth[1::2, :20] = 5.005
    layers = {"combined": np.ones((height, width, 4), np.float32), "color": flat, "diffuse": flat, "normal": flat,
              "depth": depth, "object": object_, "anchor": place}
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 6.0, "pen_1_intensity": 2.0,
             "pen_1_pressure": 0.4, "pen_1_pressure_length": 60.0}
    ink = library.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][4:-4, :, 3].sum(1)
    front = np.repeat((19.5 + np.arange(height)) * 0.02, 3).reshape(-1, 3)[4:-4]
    noise = hand.solid(front, np.full(len(front), 1.2), hand.PRESSURE)
    assert np.abs(ink - 6 * np.clip(1 + 0.4 * noise, 0.12, 3)).max() < 0.3


def test_noise_has_one_variance_at_any_wavelength():
    at = np.random.default_rng(5).uniform(-50, 50, (40000, 3))
    for wavelength in (0.5, 0.7, 0.99, 3.0, 11.0):
        noise = hand.solid(at, np.full(len(at), wavelength), 9)
        assert abs(noise.mean()) < 0.1 and abs(noise.std() - 1) < 0.06


def test_styles_without_lines_pool_no_ink():
    layers, _, _ = passes.given("faces")
    layers = {**layers, "style": np.float32(np.indices(layers["depth"].shape[:2])[1] > 20)}
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 3.0}
    plain, pooled = (library.render(layers, library.check(scene), [{"use_lines": False, "pen_1_pool": pool}]).images
                     for pool in (0.0, 1.0))
    assert np.array_equal(plain["Combined"], pooled["Combined"])


def outlined(inside, full_height, **pen):
    """The ink of a shape's outline, in a cut from a frame of that height; inside(x, y) where the shape is."""
    height, width = side = np.array((300, 300)) * full_height // 1080
    y, x = (np.indices(side) - np.array((height, width))[:, None, None] / 2 + 0.5) * 1080 / full_height
    flat = np.ones((height, width, 3), np.float32)
    layers = {"combined": np.ones((height, width, 4), np.float32), "color": flat, "diffuse": flat, "normal": flat,
              "depth": 5 * flat[..., :1], "object": np.float32(inside(x, y))[..., None]}
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 8.0, "pen_1_intensity": 2.0, "line_contact_width": 1.0,
             "length_unit": "RELATIVE", **pen}
    frame = Frame(2 * full_height, full_height)
    return library.render(layers, scene, frame=frame, outputs=("Encre Lines",)).images["Encre Lines"][..., 3], x, y


@pytest.mark.parametrize("full_height", [1080, 540])
@pytest.mark.parametrize("radius", [40, 60, 110])
@pytest.mark.parametrize("shift", [0, 0.4])
def test_lines_are_wider_where_they_bend(radius, full_height, shift):
    """A round of 60 px radius takes half of the swelling, evenly all about."""
    widths = []
    for curve in (0.0, 0.8):
        ink, x, y = outlined(lambda x, y: np.hypot(x - shift, y) < radius, full_height, pen_1_curve=curve)
        turn = np.floor((np.arctan2(y, x - shift) / np.pi + 1) * 16).astype(int) % 32
        widths.append(np.bincount(turn.ravel(), ink.ravel(), 32))
    swelling = widths[1] / widths[0] - 1
    assert abs(swelling.mean() - 0.8 * 60 / (60 + radius)) < 0.02
    assert swelling.std() < (0.045 if full_height == 1080 else 0.07)  # a quarter of a pixel of the width


@pytest.mark.parametrize("slope", [-0.7, -0.2, 0.05, 0.5, 1.1])
def test_lines_bend_by_themselves_where_others_meet_them(slope):
    def met(x, y):
        return np.where(np.hypot(x, y) < 60, 1, np.where(y > slope * x + 25, 2, 0))

    (plain, x, y), (curved, _, _) = (outlined(met, 1080, pen_1_curve=curve) for curve in (0.0, 0.8))
    beyond = np.hypot(x, y) > 68
    assert np.abs(curved - plain)[beyond].sum() < 0.02 * plain[beyond].sum()
    assert abs(curved[~beyond].sum() / plain[~beyond].sum() - 1.4) < 0.04


def test_straight_lines_and_corners_do_not_swell():
    def box(x, y):
        return (np.abs(x + 0.3 * y) < 80) & (np.abs(y - 0.2 * x) < 90)

    plain, curved = (outlined(box, 1080, pen_1_curve=curve)[0] for curve in (0.0, 0.8))
    assert np.abs(curved - plain).sum() < 0.01 * plain.sum()


@pytest.mark.parametrize("case", ["faces", "rods"])
def test_smudging_takes_the_nearest_site(case):
    """A picture that tells each pixel's place, pulled over by a fixed length: where it comes from tells the way."""
    layers, scene, view = passes.given(case)
    height, width = view.shape
    y, x = np.mgrid[:height, :width]
    layers = {**layers, "combined": np.stack([x / 64, y / 64, 0 * x, 1 + 0 * x], -1).astype(np.float32),
              "controls": np.tile(np.float32([name.startswith("smudge_") for name in library.controls()]),
                                  (height, width, 1))}
    scene = {**scene, **BARE, "use_lines": False, "use_smudging": True, "smudge_range": 6.0, "smudge_pick": 0.0,
             "smudge_falloff": 1.0, "smudge_depth": 0.0}
    images, every = passes.run(layers, scene, (), passes.CASES[case][3])
    last = [s for s in every if s.name in ("drop short", "even eased", "ease forms")][-1]
    way, unsure = strokes.nearest(Table(last.site), view.shape)
    at = np.floor(np.stack([x, y], -1) + way + 0.5)
    unsure |= (np.abs((way + 0.5) - np.round(way + 0.5)) < 1e-3).any(-1)
    picked = np.rint(images["Combined"][..., :2] * 64)
    moved = (picked != np.stack([x, y], -1)).any(-1) & ~unsure
    assert moved.sum() > 50
    assert (np.hypot(*np.moveaxis(way, -1, 0))[moved] <= 6.001).all()
    assert np.array_equal(picked[moved], np.clip(at, 0, (width - 1, height - 1))[moved])


def drawn_edge(zoom, shift, **pen):
    """(ink across an upright edge by row, its middle, rest height of each row) where so many pixels show a unit."""
    height, width = 900, 32
    rest = ((np.arange(height) - height / 2 + shift) / zoom).astype(np.float32)
    flat = np.ones((height, width, 3), np.float32)
    place = np.zeros((height, width, 16), np.float32)
    place[..., 2], place[..., 6] = rest[:, None], 1 / zoom
    layers = {"combined": np.ones((height, width, 4), np.float32), "color": flat, "diffuse": flat, "normal": flat,
              "depth": 5 * flat[..., :1], "object": np.repeat(np.arange(width) > 15, 1).astype(np.float32)
              .reshape(1, -1, 1) * flat[..., :1], "anchor": place}
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 8.0, "pen_1_intensity": 2.0, **pen}
    ink = library.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][4:-4, :, 3]
    return ink.sum(1), ink @ np.arange(width) / np.maximum(ink.sum(1), 1e-6), rest[4:-4]


def alike(one, two, k):
    """Correlation of what two frames show of the same things."""
    low, high = max(one[2][0], two[2][0]), min(one[2][-1], two[2][-1])
    at = np.linspace(low, high, 2000)
    return np.corrcoef(*(np.interp(at, frame[2], frame[k]) for frame in (one, two)))[0, 1]


@pytest.mark.parametrize("k, pen", [(0, dict(pen_1_pressure=0.4, pen_1_pressure_length=70.0)),
                                    (0, dict(pen_1_rough=0.8, pen_1_rough_length=12.0)),
                                    (1, dict(pen_1_wobble=1.2, pen_1_wobble_length=45.0))])
def test_what_the_hand_does_sticks_to_the_thing(k, pen):
    """Panned by 42.4 pixels it is the same; zoomed by 4 in 16 frames it goes over from each frame to the next."""
    first = drawn_edge(40.0, 0.0, **pen)
    assert alike(first, drawn_edge(40.0, 42.4, **pen), k) > 0.985
    frames = [drawn_edge(40.0 * 4 ** (frame / 15), 0.0, **pen) for frame in range(16)]
    steps = [alike(*pair, k) for pair in itertools.pairwise(frames)]
    assert np.mean(steps) > 0.97 and min(steps) > 0.9, steps
    spreads = [frame[k].std() for frame in frames]
    assert max(spreads) < 3 * min(spreads), "as strong at any distance"


def test_a_gap_a_pixel_wide_is_one_kind_of_line_all_along():
    """Two boards, one as far away as the other, with less than a pixel between them, that run nearly level."""
    rows, columns = np.mgrid[:60, :240].astype(float)
    below = rows - 30 + (columns - 120) / 30
    object_ = np.where(below < -0.4, 1, np.where(below < 0.4, 3, 2))
    flat = np.ones((60, 240, 3))
    layers = {"combined": np.ones((60, 240, 4)), "color": flat, "diffuse": flat, "normal": flat * (0, 0, 1),
              "depth": np.where(object_ == 3, 9.0, 5.0)[..., None], "object": object_[..., None]}
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 8.0, "pen_1_intensity": 2.0,
             "line_shadow_strength": 0.0,
             "line_color_strength": 0.0, "line_contact_width": 0.25}
    ink = library.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3].sum(0)[30:-30]
    assert ink.min() > 8 and np.ptp(ink) < 1.5
    solid = {**layers, "object": np.where(layers["object"] == 3, 2, layers["object"]).astype(np.float32),
             "depth": np.full_like(layers["depth"], 5)}
    touch = library.render(solid, scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3].sum(0)[30:-30]
    assert touch.min() > 1 and touch.max() < 3


def test_noise_runs_on_where_a_line_steps_from_row_to_row():
    """On a surface seen so flat that a row is eight columns long, the width is that of the noise where it runs."""
    rows, columns = np.mgrid[:80, :300].astype(float)
    below = rows - 40 + (columns - 150) / 40
    flat = np.ones((80, 300, 3), np.float32)
    share = np.clip(below + 0.5, 0, 1)[..., None].astype(np.float32)  # by which the line is placed
    layers = {"combined": np.ones((80, 300, 4), np.float32), "color": 0.2 + 0.6 * share * flat, "diffuse": flat,
              "normal": flat, "depth": np.where(below < 0, 9, 5).astype(np.float32)[..., None],
              "object": (below >= 0).astype(np.float32)[..., None]}
    anchor = np.zeros((80, 300, 16), np.float32)
    anchor[..., 6], anchor[..., 7], anchor[..., 11] = 0.02, 0.02, 0.16
    anchor[..., 0], anchor[..., 1] = 0.02 * columns, 0.16 * rows
    scene = {**BARE, "edge_detector": "FINE", "line_thickness": 6.0, "pen_1_intensity": 2.0,
             "line_shadow_strength": 0.0,
             "line_color_strength": 0.0, "pen_1_pressure": 0.4, "pen_1_pressure_length": 60.0}
    ink = library.render({**layers, "anchor": anchor}, scene, outputs=("Encre Lines",)).images["Encre Lines"]
    x = columns[0]
    at = np.stack([0.02 * x, 0.16 * (40 - (x - 150) / 40), 0 * x], -1)
    noise = hand.solid(at, np.full(len(x), 1.2), hand.PRESSURE)
    wrong = ink[..., 3].sum(0) - 6 * np.clip(1 + 0.4 * noise, 0.12, 3)
    assert np.abs(wrong[20:-20]).max() < 0.6


@pytest.mark.parametrize("width", [3.3, 3.6, 3.9])
def test_a_gap_of_less_than_a_pixel_is_even(width):
    """Between two lines along each other, however they lie to the pixels: as much of it is dark as they cover, and no
    row of rungs."""
    apart, at = 4.0, np.array([[-5, 20], [101, 43]], float)
    way = np.diff(at, axis=0)[0] / np.linalg.norm(np.diff(at, axis=0))
    ink = known.drawn(known.flat(), [known.line(at + k * apart * way[::-1] * (-1, 1), "mark", k) for k in range(2)],
                      line_thickness=width, pen_1_steepness=0.5)
    y, x = np.indices(np.multiply(ink.shape, 8)) / 8 - 7 / 16
    across = (y - at[0, 1]) * way[0] - (x - at[0, 0]) * way[1]
    covered = np.minimum(np.abs(across), np.abs(across - apart)) < width / 2
    off = ink - covered.reshape(ink.shape[0], 8, -1, 8).mean((1, 3))
    gap = (np.abs(across[4::8, 4::8] - apart / 2) < 1) & (np.abs(x[4::8, 4::8] - 48) < 40)
    assert np.abs(off[gap]).max() < 0.12
