# SPDX-License-Identifier: GPL-3.0-or-later
"""The detector FINE on what makes lines come and go: noise in soft light, lines beside lines, feet of thin things."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Chains
from encre.pen.samples import even
from judge import kinds, measure, verdict
from judge.camera import look
from judge.scene import Scene
from known import END, line

CONTROLS = len(library.controls())

PEN = dict(verdict.PARAMS, edge_detector="FINE", line_thickness=1.0)


def ink(layers, **params):
    layers = {name: a if name == "chains" else np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    return library.render(layers, {**PEN, **params}, outputs=("Combined", "Encre Lines")).images["Encre Lines"][..., 3]


def flat(height, width, diffuse=1.0):
    """A wall seen face on, under the light given (height, width)."""
    ones = np.ones((height, width, 3))
    return dict(combined=np.ones((height, width, 4)), color=ones / 2, albedo=ones / 2, depth=5 * ones[..., 0],
                normal=np.tile([0.0, 0, 1], (height, width, 1)), diffuse=ones * np.atleast_1d(diffuse)[..., None])


def blurred(a):
    for axis in (0, 1):
        a = (np.roll(a, 1, axis) + 2 * a + np.roll(a, -1, axis)) / 4
    return a


@pytest.mark.parametrize("slope", [0.01, 0.004])
def test_noise_in_soft_light_leaves_a_level_one_smooth_line(slope):
    """What a denoiser leaves, 0.6 %, would move a threshold 1.4 pixels on the softer of these."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[:160, :120]
    noise = blurred(rng.standard_normal(x.shape))
    light = np.maximum(0.6, 0.9 + slope * (x - 60 - 0.1 * (y - 80)))
    left = (light * (1 + 0.006 * noise / noise.std())).astype(np.float32)[..., None].repeat(3, 2)
    rendered = (left * (1 + 0.05 * rng.standard_normal((160, 120, 1)))).astype(np.float32)
    evened = even(left, rendered, np.tile((0.0, 0, 1), (160, 120, 1)), np.full((160, 120, 1), 5.0))
    t = ink(flat(160, 120, evened[..., 0]))[8:-8]
    rows = np.arange(8, 152)
    centre = (t * np.arange(120)).sum(1) / t.sum(1)
    assert t.sum(1) == pytest.approx(np.ones(144), abs=0.6)  # once in every row, hardly slanting
    assert np.percentile(np.abs(centre - 60 - 0.1 * (rows - 80)), 95) < 0.006 / slope
    assert np.abs(np.diff(centre)).max() < 1


def test_a_hard_shadow_stays_where_it_is():
    y, x = np.mgrid[:80, :100]
    edge = 50.3 + 0.3 * (y - 40)
    t = ink(flat(80, 100, 0.2 + 0.8 * np.clip(x - edge + 0.5, 0, 1)))[6:-6]
    centre = (t * np.arange(100)).sum(1) / t.sum(1)
    assert np.abs(centre - edge[6:-6, 0]).max() < 0.3


@pytest.mark.parametrize("apart", [2.0, 2.5, 3.0, 3.3])
def test_a_line_beside_another_is_whole_or_is_not(apart):
    """A crease beside a silhouette, on every phase in which both can meet the pixels."""
    y, x = np.mgrid[:300, :80]
    edge = 40.2 + 0.03 * (y - 150)
    layers = flat(300, 80)
    fine = (np.arange(8) + 0.5) / 8 - 0.5
    share = np.mean([x + k < edge - apart for k in fine], axis=0)[..., None]
    near = np.mean([x + k < edge for k in fine], axis=0)[..., None]
    layers["normal"] = near * (share * (0, 0.0, 1.0) + (1 - share) * (0.8, 0, 0.6)) + (1 - near) * (0, 1.0, 0)
    layers["depth"] = np.where(x < edge, 5.0, 9.0)
    layers["object"] = (x < edge) * 1.0
    t = ink(layers)[10:-10]
    at = np.rint(edge[10:-10, :1] - apart).astype(int) + np.arange(-1, 1)
    second = np.take_along_axis(t, at, 1).sum(1) > 0.4
    assert second.mean() < 0.01 or second.mean() > 0.99


def test_the_foot_of_a_thin_thing_keeps_its_own_line():
    """A blade with a thin line stands on ground that rises towards the eye, and has a full one."""
    y, x = np.mgrid[:90, :100]
    blade = (np.abs(x - 50) <= 4) & (y < 60)
    layers = flat(90, 100)
    layers["depth"] = np.where(blade, 8.0, 8.0 - 0.1 * (y - 59.5) / 10)
    layers["object"] = blade * 1.0
    layers["normal"] = np.where(blade[..., None], (0, 0, 1.0), (0, 1.0, 0))
    layers["controls"] = np.zeros((90, 100, CONTROLS))
    layers["controls"][..., 0] = np.where(blade, -0.75, 0)
    t = ink(layers, line_thickness=8.0, line_crease_strength=0.0)
    assert t[20:52].sum(1) == pytest.approx(np.full(32, 4.0), abs=0.3)  # two sides, a quarter of 8 each
    assert t[50:75, 50].sum() == pytest.approx(2.0, abs=0.3)
    assert (t[:, :40] == 0).all() and (t[64:] == 0).all()


@pytest.mark.parametrize("dark", [0.3, 0.36])
def test_a_joint_is_one_line_on_every_phase(dark):
    """A dark joint of 1.3 pixels that slants by a pixel in 40, seen through a filter wider than a pixel."""
    y, x = np.mgrid[:40, :200].astype(float)
    fine = (np.arange(24) + 0.5) / 8 - 1.5
    inside = [np.abs(y + k - 20.2 - x / 40 + 2.5) < 0.65 for k in fine]
    joint = np.average(inside, 0, weights=np.cos(fine / 1.5 * np.pi / 2) ** 2)[..., None]
    layers = flat(40, 200)
    layers["albedo"] = layers["color"] = (1 - joint) * (0.5, 0.5, 0.5) + joint * (dark, dark, dark)
    t = ink(layers, line_color_strength=2.5, line_contrast=0.0)[:, 10:-10]
    assert (np.abs(t.sum(0) - 1) < 0.3).mean() > 0.95


def test_what_is_smaller_than_pixels_draws_no_labyrinth():
    """Normals of gravel far away: their mean differs from pixel to pixel."""
    rng = np.random.default_rng(3)
    layers = flat(120, 160)
    layers["normal"][..., :2] += 0.15 * blurred(rng.standard_normal((120, 160, 2)))
    assert (ink(layers) > 0.3).mean() < 0.14


def scraps(length, start=20, closed=False, size=(60, 80)):
    """Layers of a wall with a fold down it that ends after `length` pixels, and with `closed` a small ring of folds."""
    found = [line([(40.4, start - 0.5), (40.4, start + length - 0.5)], "crease", bend=60)]
    if closed:  # a square
        found.append(line([(7.5, 7.5), (13.5, 7.5), (13.5, 13.5), (7.5, 13.5), (7.5, 7.5)], "crease", run=1, bend=60))
        found[1]["end"][[0, -1]] = END["loop"]
    flat = np.ones((*size, 3))
    layers = dict(combined=np.ones((*size, 4)), color=flat, diffuse=flat, depth=5 * flat[..., :1], normal=0 * flat,
                  object=flat[..., :1])
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    return layers | {"chains": Chains(np.concatenate(found), np.ones(2, np.uint8))}


@pytest.mark.parametrize("length", [6, 11, 15])
def test_scraps_are_not_drawn(length):
    t = ink(scraps(length, closed=True), line_shortest=12.0)
    assert (t[15:45, 30:50].max() > 0.5) == (length > 12), "open at both ends"
    assert t[5:16, 5:16].max() > 0.4, "closed"
    assert ink(scraps(length), line_shortest=0.0)[15:45, 30:50].max() > 0.5
    assert ink(scraps(length, start=60 - length), line_shortest=12.0)[:, 30:50].max() > 0.5, "goes on beyond it"


def test_a_line_s_width_eases_where_what_it_is_made_of_changes():
    """An outline, where a leaf stands off a wall, that goes on as a crease a fifth as wide: no blob, no step."""
    y, x = np.mgrid[:90, :60]
    layers = flat(90, 60)
    layers["depth"] = np.where((x < 30) | (y > 45), 5.0, 5 + 0.05 * (45 - y))
    layers["normal"] = np.where((x < 30)[..., None], (-0.6, 0, 0.8), (0.6, 0, 0.8))
    t = ink(layers, line_thickness=10.0, line_crease_width=0.2, line_color_strength=0.0)[:, 10:50]
    width = t.sum(1)
    assert width[10:30] == pytest.approx(np.full(20, 10.0), abs=0.3)
    assert width[60:80] == pytest.approx(np.full(20, 2.0), abs=0.3)
    assert (np.diff(width[10:80]) < 0.3).all() and np.abs(np.diff(width[10:80])).max() < 2.0


def test_a_narrow_ledge_leads_no_line_over_to_the_contour_above():
    """The underside of a rail, seen at a grazing angle, and the sky are 1.5 pixels from a way between both."""
    camera = look([-0.9, 1.5, 6.0], [-0.4, 1.0, 0], focal=7.5, shift=(18.25, 59.375))
    scene = Scene(camera, kinds.louvres().solids, kinds.FLAT, (48, 64))
    t = library.render(scene.layers("blackman"), PEN, camera=library.Camera(**scene.camera_settings),
                       outputs=["Encre Lines"]).images["Encre Lines"][..., 3]
    assert measure.stray(t, scene.truth) == 0 and measure.place(t, scene.truth)["max"] < 0.25


def test_a_ball_that_touches_another_thing_has_one_line_there():
    """Of one object: its normals turn ever faster up to the fold, and back beyond it."""
    scene = kinds.balls()
    scene.size = 90, 120
    t = library.render(scene.layers("blackman", one_index=True), PEN, camera=library.Camera(**scene.camera_settings),
                       outputs=["Encre Lines"]).images["Encre Lines"][..., 3]
    truth = scene.truth.one_index()
    assert measure.evenness(t, truth) > 0.99 and measure.place(t, truth)["p95"] < 0.25
    assert measure.whole(t, truth)["crease"][0] > 0.995


def test_a_lone_pixel_does_not_end_a_line():
    """A ledge that rises from a wall and goes back into it; pixels on its edge are as far as neither side of it."""
    def widths(lone):
        y, x = np.mgrid[:120, :60]
        layers = flat(120, 60)
        step = 2 * np.maximum(0, 1 - np.abs(y - 60) / 50)
        layers["depth"] = np.where(x < 30.2 + 0.04 * (y - 60), 5.0, 5 + step)
        for row in lone:
            layers["depth"][row, 30] = 5 + step[row, 0] / 2
        return ink(layers, line_shadow_strength=0.0, pen_1_taper=60.0, line_thickness=12.0).sum(1)

    plain, parted = widths(()), widths((40, 55, 70))
    assert plain.max() > 7 and (plain > 0.5).sum() > 60
    assert parted == pytest.approx(plain, abs=1.5)


SOFT = {"slow": 100, "quick": 33, "penumbra": 6, "hard": 1}  # pixels over which light gets from 0 to 1


@pytest.mark.parametrize("threshold", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("width", SOFT.values(), ids=SOFT)
def test_a_line_of_light_runs_where_the_fill_ends(width, threshold):
    """Along an edge that winds, with a fill that is a pixel soft, so that it tells its place."""
    rows, columns, fine = 60, 90, 8
    y, x = (np.indices((rows * fine, columns * fine)) + 0.5) / fine
    lean = 1 / 7 + np.cos(y / 9) / 3
    across = (x - 40 - y / 7 - 3 * np.sin(y / 9)) / np.sqrt(1 + lean**2)
    light = across > 0 if width == 1 else np.clip(0.5 + across / width, 0, 1)
    layers = flat(rows, columns, light.reshape(rows, fine, columns, fine).mean((1, 3)))
    layers["combined"][..., :3] = layers["color"] * layers["diffuse"]
    params = dict(line_shadow_strength=4.0, line_color_strength=0.0, line_thickness=4.0, use_hatching=False,
                  use_smudging=False,
                  use_shading=True, shade_levels=[(0.2,), (threshold, 0.5, 1 / width)])
    drawn = ink(layers, **params)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    fill = library.render(layers, {**PEN, **params, "use_lines": False}).images["Combined"][..., 0]
    end = columns - ((fill - fill.min()) / (fill.max() - fill.min())).sum(1)
    middle = (drawn * (np.arange(columns) + 0.5)).sum(1) / drawn.sum(1)
    apart = np.abs(middle - end)[6:-6] / np.sqrt(1 + lean.reshape(rows, fine, -1).mean((1, 2))[6:-6] ** 2)
    assert apart.max() < 0.1


@pytest.mark.parametrize("width", [3, 6, 12, 26])
@pytest.mark.parametrize("levels", [[(0.2,), (0.5, 0.5, 0.05)], [(0.2,), (0.4, 0.4, 0.05), (0.75, 0.7, 0.05)],
                                    [(0.1,), (0.2, 0.3, 0.05), (0.5, 0.5, 0.05), (0.75, 0.7, 0.05)]],
                         ids=["one", "two", "three"])
def test_a_penumbra_has_one_line_for_each_level_that_has_room(width, levels):
    """A shadow of a sun, however broad: never two lines beside each other that its width has no room for."""
    rows, columns, fine = 60, 110, 8
    y, x = (np.indices((rows * fine, columns * fine)) + 0.5) / fine
    light = np.clip(0.5 + (x - 55 - 0.2 * y) / np.hypot(1, 0.2) / width, 0, 1)
    layers = flat(rows, columns, light.reshape(rows, fine, columns, fine).mean((1, 3)))
    layers["combined"][..., :3] = layers["color"] * layers["diffuse"]
    drawn = ink(layers, line_shadow_strength=4.0, line_color_strength=0.0, line_thickness=2.0, use_hatching=False,
                use_smudging=False,
                use_shading=True, shade_levels=levels)[6:-6]
    lines = ((drawn[:, 1:] > 0.25) & (drawn[:, :-1] <= 0.25)).sum(1)
    room = 1 + int(width >= 12) * (len(levels) - 2)
    assert (lines >= 1).all() and (lines <= room).all(), np.unique(lines, return_counts=True)
