# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture in relative units has the same ink and lines at every size, and no line is drawn in stairs."""

import numpy as np
import pytest
import sizes
from encre.pen import library, presets
from encre.pen.job import Frame
from sizes import alone, darkness, inked, preset, relative, sized


def agrees(title, name, ink):
    """Whether the page says what was found, but for how other machines round."""
    row = sizes.said(title)[presets.find(name).name]
    assert {size: row[f"{size} %"] for size in sizes.MOST} == {
        size: pytest.approx(found, rel=0, abs=0.15) for size, found in sizes.changes(ink).items()}


@pytest.mark.parametrize("name", relative())
def test_ink_and_lines_are_the_same_at_every_size(name):
    ink = inked(sizes.boxes(), name)
    agrees("boxes", name, ink)
    change = {size: abs(a.mean() / ink[100].mean() - 1) for size, a in ink.items()}
    assert ink[100].mean() > 0.003  # those of gouache are faint
    assert change[50] < 0.05 and change[200] < 0.05 and change[25] < 0.15, change
    other = {size: max(alone(a, ink[100]), alone(ink[100], a)) for size, a in ink.items()}
    assert other[50] < 0.01 and other[200] < 0.01 and other[25] < 0.2, other  # a pixel there is four wide here


@pytest.mark.slow
@pytest.mark.parametrize("name", relative())
def test_crowded_ink_and_lines_are_the_same_at_every_size(name):
    """Where colours differ by about what makes an edge it takes little to make a line, or none."""
    ink = inked(sizes.crowd(), name)
    agrees("crowd", name, ink)
    faint = preset(name)["line_color_strength"] == 1.0 and preset(name)["edge_threshold"] == 0.3
    change = {size: abs(a.mean() / ink[100].mean() - 1) for size, a in ink.items()}
    most = 0.075 if name == "manga" else 0.055  # whose black lies beside fewer of them
    least = 0.051 if name == "heavy_blacks" else 0.05  # whose outer contours alone keep their weight in a crowd
    assert change[200] < most and change[50] < (0.1 if faint else least), change
    more, less = ({size: alone(*pair) for size, pair in pairs.items()} for pairs in (
        {size: (a, ink[100]) for size, a in ink.items()}, {size: (ink[100], a) for size, a in ink.items()}))
    assert more[200] < 0.04 and less[200] < 0.06, (more, less)  # weak joints live where a neighbour is strong
    assert more[50] < (0.06 if faint else 0.03) and less[50] < (0.13 if faint else 0.03), (more, less)


def striped(apart, lean, side=80, fine=5):
    """Stripes of two colours, so many pixels wide straight across, that go `lean` pixels up for each to the right."""
    y, x = np.mgrid[:side * fine, :side * fine] / fine
    share = sized(np.floor((y + lean * x) / (apart * np.hypot(1, lean))) % 2, (side, side))[..., None]
    flat = np.ones((side, side, 3))
    layers = dict(combined=np.ones((side, side, 4)), color=share * (0.75, 0.7, 0.6) + (1 - share) * (0.25, 0.3, 0.4),
                  diffuse=flat, normal=flat * (0, 0, 1), depth=flat[..., :1] * 4, object=flat[..., :1])
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def test_lines_between_colours_fade_at_the_same_distance_at_all_slants():
    for apart in (3.5, 5.0):
        ink = [darkness(striped(apart, lean), frame=Frame(1440, 1080, 100, 100), **preset("ink_only"))[15:-15, 15:-15]
               .mean() for lean in (0.0, 0.5, 1.0)]
        assert min(ink) > 0.15 and max(ink) < 1.15 * min(ink), (apart, ink)


@pytest.mark.parametrize("lean", [0.0, 0.3, 1.0])
def test_lines_of_light_fade_where_they_close_up(lean):
    """As in the shadow of a fence far away: it is a tone, no black ropes."""
    def ink(apart):
        layers = striped(apart, lean)
        layers["diffuse"] = np.repeat(2 * layers["color"][..., :1] - 0.5, 3, 2)
        layers["color"] = np.full_like(layers["diffuse"], 0.6)
        scene = dict(edge_detector="FINE", line_shadow_strength=4.0, line_thickness=2.0, pen_1_softness=0.0,
                     pen_1_grain=0.0)
        return library.render(layers, scene, outputs=["Encre Lines"],
                              frame=Frame(1440, 1080, 100, 100)).images["Encre Lines"][15:-15, 15:-15, 3].mean()
    far = {apart: ink(apart) for apart in (12, 8, 5, 3.5, 2.5, 1.7, 1.0)}
    assert 0.07 < far[12] < far[8] < far[5] and max(far.values()) < 0.36, far
    assert max(far[2.5], far[1.7], far[1.0]) < 0.25, far


@pytest.mark.parametrize("aside", [0.0, 1.0])
@pytest.mark.parametrize("soft", [0.0, 0.3])
def test_the_shadow_of_a_fence_far_away_is_a_tone(aside, soft):
    """On ground that goes to the horizon: its posts' shadows come ever closer, from 25 pixels to less than one."""
    height, width, fine = 120, 160, 6
    y, x = (np.mgrid[:height * fine, :width * fine] + 0.5) / fine
    far = 1 / (y + 3)
    across = ((x - width / 2) * far + aside * 100 * far) * 5  # in fields
    share = np.abs(np.mod(across, 1) - 0.5) - 0.25
    light = np.clip(0.5 + share / soft, 0, 1) if soft else share > 0
    light = 0.2 + 0.8 * sized(light.astype(float), (height, width))
    flat = np.ones((height, width, 3))
    layers = dict(combined=np.ones((height, width, 4)), color=flat * 0.6, normal=flat * (0, 1, 0),
                  diffuse=flat * light[..., None], object=flat[..., :1],
                  depth=400 * np.repeat(1 / (np.arange(height) + 3.5), width).reshape(height, width, 1))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    scene = dict(edge_detector="FINE", line_shadow_strength=4.0, line_thickness=2.0, pen_1_softness=0.0,
                 pen_1_grain=0.0)
    ink = library.render(layers, scene, outputs=["Encre Lines"],
                         frame=Frame(1440, 1080, 100, 100)).images["Encre Lines"][:, 10:-10, 3]
    by_row = ink.reshape(-1, 10 * ink.shape[1]).mean(1)  # from the horizon
    most = by_row.argmax()
    assert 0.15 < by_row[most] < 0.25 and 0.05 < by_row[-1] < 0.13 and by_row[:2].max() < 0.005, by_row
    assert np.diff(by_row[:most + 1]).min() > -0.005 and np.diff(by_row[most:]).max() < 0.005, by_row


@pytest.mark.parametrize("lines", [1080, 2160])
def test_a_rail_is_as_wide_above_its_posts(lines):
    """Where a post goes down from it, nothing says that it is thin but what lies on both sides."""
    unit = lines // 1080
    y, x = np.mgrid[:60 * unit, :160 * unit] // unit
    thing = ((y >= 20) & (y < 36) | (y >= 20) & (np.abs(x % 50 - 25) < 7))[..., None]
    flat = np.ones((*thing.shape[:2], 3))
    layers = dict(combined=np.ones((*thing.shape[:2], 4)), color=flat * 0.5, diffuse=flat, normal=flat * (0, 0, 1),
                  depth=np.where(thing, 4.0, 20.0), object=thing + 1)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    values = dict(preset("ink_only"), line_thickness=14, line_density=1)
    wide = darkness(layers, frame=Frame(lines * 4 // 3, lines, 100, 100), **values)[5 * unit:28 * unit].sum(0)
    wide = wide[25 * unit:-25 * unit]
    assert wide.min() > 3 * unit and wide.max() < 1.03 * wide.min(), (wide.min(), wide.max())


def slanted(rows=60, columns=200):
    """Two flat objects side by side, whose border leans by one pixel in eight."""
    y, x = np.mgrid[:rows, :columns].astype(np.float64)
    off = x - columns / 2 - y / 8
    share = np.clip(off + 0.5, 0, 1)[..., None]
    flat = np.ones((rows, columns, 3))
    layers = dict(combined=np.ones((rows, columns, 4)), color=share * (0.3, 0.2, 0.1) + (1 - share) * (0.6, 0.7, 0.9),
                  diffuse=flat, depth=flat[..., :1] * 4, normal=flat * (0, 0, 1), object=(off[..., None] > 0) + 1)
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


@pytest.mark.parametrize("width", [0.3, 0.8, 1.5, 3.0, 6.0])
@pytest.mark.parametrize("height", [1.0, 0.8])
def test_the_pencil_draws_no_stairs(width, height):
    """Along a border that crosses the rows at all places, each row has as much ink, and passes evenly into paper.

    Of the pencil's ramp, from coverage 0.5 to 0.75 of paper of full height, the middle lies at the line's half width
    times 1 - 0.9 * 0.625; on lower paper closer to the middle of the line, and what is less high is less dark. Whatever
    the height of an even sheet is, it lies at 0.8."""
    values = dict(preset("water_memory"), length_unit="PIXELS", line_thickness=width, use_shading=False,
                  use_smudging=False, use_hatching=False, paper_source="IMAGE", paper_image="sheet")
    image = np.full((2, 2, 1), height, np.float32)
    shown = library.render(slanted(), values, image=lambda _: image, outputs=["Encre Lines"])
    t = shown.images["Encre Lines"][5:-5, :, 3]
    rough = 1 + values["pen_1_grain"] * (0.8 - 1)
    rise = min(0.25, rough - 0.5)
    want = width * (1 - 0.9 * (0.5 + rise / 2) / rough) * min(1, 4 * (rough - 0.5)) * np.sqrt(1 + 1 / 64)
    assert t.sum(1) == pytest.approx(want, rel=0.06)
    steps = np.abs(np.diff(t, axis=1)).max(1)
    assert steps.max() < 1.05 * min(1.0, max(want, 0.1))
    if width >= 1.5:
        between = ((t > 0.02) & (t < 0.98)).sum() / (t > 0.02).sum()
        assert between > 0.45 if width > 3 else between > 0.6
