# SPDX-License-Identifier: GPL-3.0-or-later
"""Suggestive contours: lines on smooth forms that nearly turn away, drawn from layers that formulas give."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.around import Window
from encre.pen.job import Camera, Chains, Frame
from encre.pen.settings import Settings
from judge import verdict
from known import line

ROWS, COLUMNS, MIDDLE = 96, 128, 60.3
PEN = dict(verdict.PARAMS, edge_detector="FINE", line_shadow_strength=0.0, line_mirror_strength=0.0,
           line_color_strength=0.0, line_suggestive_strength=1.0,
           length_unit="PIXELS", suggestive_size=3.0, line_suggestive_shortest=30.0, line_thickness=4.0,
           line_suggestive_width=1.0)
ALONE = dict(line_inner_strength=0.0, line_crease_strength=0.0, line_outline_strength=0.0)
Y, X = np.mgrid[:ROWS, :COLUMNS].astype(float)


def of(height):
    """Of a surface `height` pixels before a wall, seen from the front by parallel rays."""
    down, right = np.gradient(height)
    normal = np.stack([-right, down, np.ones_like(height)], -1)
    flat = np.ones((*height.shape, 3))
    made = {"combined": np.ones((*height.shape, 4)), "color": flat * 0.5, "albedo": flat * 0.5, "diffuse": flat,
            "depth": (300 - height)[..., None], "normal": normal / np.linalg.norm(normal, axis=-1, keepdims=True),
            "object": flat[..., :1]}
    return made


def slope(steepness, width=5.0, middle=MIDDLE):
    """From one level to another, as the side of a nose."""
    return steepness * width * np.tanh((X - middle) / width)


def ink(made, threads=0, styles=(), **values):
    made = {name: a if name == "chains" else np.ascontiguousarray(a, np.float32) for name, a in made.items()}
    drawn = library.render(made, {**PEN, **values}, styles, Camera(orthographic=True, height=ROWS), threads=threads,
                           outputs=("Encre Lines",))
    return drawn.images["Encre Lines"][..., 3]


def test_a_line_goes_where_a_slope_is_steepest_from_border_to_border():
    drawn = ink(of(slope(1.0)))
    np.testing.assert_allclose((drawn * X).sum(1) / drawn.sum(1), MIDDLE, atol=0.05)
    np.testing.assert_allclose(drawn.sum(1), 4, atol=0.1)


def test_none_is_drawn_by_default():
    assert ink(of(slope(1.0)), line_suggestive_strength=0.0).max() == 0


@pytest.mark.parametrize("angle", (20, 45, 70))
def test_it_is_even_at_any_angle(angle):
    a = np.radians(angle)
    off = (X - 64) * np.cos(a) + (Y - 48) * np.sin(a)
    drawn = ink(of(5 * np.tanh(off / 5)))
    near = drawn * (np.hypot(X - 64, Y - 48) < 40)
    assert np.abs((near * off).sum() / near.sum()) < 0.05
    assert np.sqrt((near * off**2).sum() / near.sum()) == pytest.approx(4 / np.sqrt(12), abs=0.1)
    assert near.sum() == pytest.approx(4 * 80, rel=0.03)


def test_it_comes_with_the_steepness_and_not_at_once():
    widths = [ink(of(slope(s)))[48].sum() for s in np.arange(0.2, 1.21, 0.02)]
    assert widths[0] == 0 and widths[-1] == pytest.approx(4, abs=0.1)
    assert (np.diff(widths) >= -1e-3).all() and np.diff(widths).max() < 0.8


def test_a_fold_that_is_deep_here_and_there_is_one_stroke():
    """Its line was dashes: each place was as wide as it is deep."""
    drawn = ink(of(slope(0.6 + 0.25 * np.cos(Y * 2 * np.pi / 24)))).sum(1)[12:-12]
    assert drawn.min() > 0.6 * drawn.max() > 1


def test_short_ones_are_thin_and_grow_wider_with_their_length():
    sums = []
    for half in range(8, 40, 2):
        made = of(slope(0.0))
        turned = 0.9 * np.exp(-((X - MIDDLE) / 4) ** 2) / (1 + np.exp((np.abs(Y - 48) - half) / 2))
        made["normal"] = np.stack([turned, 0 * turned, np.sqrt(1 - turned**2)], -1)
        sums.append(ink(made, line_suggestive_shortest=90.0, **ALONE)[48].sum())
    assert sums[0] < 1.8 and sums[-1] > 3.8
    assert (np.diff(sums) > -0.05).all() and np.diff(sums).max() < 0.6


def test_planes_and_round_things_have_none():
    ball = np.sqrt(np.maximum(50**2 - (X - 64) ** 2 - (Y - 48) ** 2, 0.0))
    made = of(ball)
    made["object"] = (ball > 0).astype(float)[..., None]
    outline = ink(made, line_suggestive_strength=0.0)
    assert outline.max() == 1
    np.testing.assert_array_equal(ink(made), outline)
    assert ink(of(0.8 * X)).max() == 0


def test_what_is_rough_has_none():
    rng = np.random.default_rng(5)
    rough = rng.normal(size=(ROWS, COLUMNS))
    for _ in range(2):
        rough = sum(np.roll(rough, shift, axis) for shift in (-1, 0, 1) for axis in (0, 1)) / 6
    rough *= 1.2 / rough.std()
    assert ink(of(rough), **ALONE).sum() < 0.01 * ink(of(slope(1.0))).sum()
    assert ink(of(slope(1.0) + 0.02 * rough), **ALONE).sum() == pytest.approx(4 * ROWS, rel=0.05)


def test_what_is_shaded_flat_has_none():
    made = of(slope(1.0))
    made["normal"] = np.where((np.abs(X - MIDDLE) < 4)[..., None], (0.5, 0, 0.8660254), (0.0, 0, 1))
    assert ink(made, **ALONE).sum() > 3 * ROWS
    for kind, any_ in (("crease", False), ("crease smooth", True)):
        edges = np.concatenate([line([(x, -40), (x, ROWS + 40)], kind, run=k, bend=30, depth=4)
                                for k, x in enumerate((56.5, 64.5))])
        lines = ink({**made, "chains": Chains(edges, np.ones(2, np.uint8))}, crease_angle=40.0)
        assert lines.sum() > 3 * ROWS if any_ else lines.max() == 0


@pytest.mark.parametrize("apart", (2, 3, 4))
def test_it_doubles_no_outline(apart):
    made = of(slope(1.0))
    made["object"] = 1 + (MIDDLE + apart < X).astype(float)[..., None]
    outline = ink(made, line_suggestive_strength=0.0)
    assert outline.max() == 1
    np.testing.assert_array_equal(ink(made), outline)


def test_it_goes_on_from_where_a_contour_ends():
    gap = 40 * np.clip((40 - Y) / 30, 0, 1) * (X > MIDDLE)
    drawn = ink(of(slope(1.0) + gap), pen_1_taper=12.0)
    assert (drawn.sum(1) > 1).all()
    assert ink(of(slope(1.0) + gap), pen_1_taper=12.0, line_suggestive_strength=0.0)[60:].max() == 0


def test_a_small_patch_of_shade_has_no_border_and_a_large_one_has_by_degrees():
    scene = dict(ALONE, line_suggestive_strength=0.0, line_shadow_strength=1.0, line_shadow_width=1.0,
                 line_thickness=2.0, use_shading=True,
                 shade_levels=[(0.0,), (1.0, 0.5, 0.0)], line_shadow_shortest=120.0)
    far, shares = np.hypot(X - 64, Y - 48), []
    for radius in np.arange(8, 25, 0.5):
        made = of(slope(0.0))
        made["diffuse"] = np.repeat((np.clip((far - radius) / 4 + 0.5, 0, 1))[..., None], 3, 2)
        whole = ink(made, **{**scene, "line_shadow_shortest": 0.0}).sum()
        assert whole == pytest.approx(2 * 2 * np.pi * radius, rel=0.05)
        shares.append(ink(made, **scene).sum() / whole)
    assert shares[0] == 0 and shares[-1] == pytest.approx(1, abs=1e-3)
    assert np.diff(shares).min() > -0.01 and np.diff(shares).max() < 0.2


def coloured(length, contrast, wide=6):
    """A bar of another colour on a wall, so many pixels long."""
    made = of(slope(0.0))
    across = np.clip(length / 2 + 0.5 - np.abs(X - 64), 0, 1) * np.clip(wide / 2 + 0.5 - np.abs(Y - 48), 0, 1)
    made["color"] = made["albedo"] = made["color"] + contrast * across[..., None]
    return made


def test_short_faint_lines_between_colours_go_by_degrees_and_strong_ones_stay():
    """Round bars that are just an edge the border's length counts about once, round dark ones many times and more."""
    scene = dict(line_suggestive_strength=0.0, line_color_strength=2.5, line_color_width=1.0, edge_threshold=0.3,
                 line_thickness=2.0)
    shares = []
    for length in np.arange(8, 70, 2.0):
        faint = coloured(length, 0.25)
        whole = ink(faint, **scene).sum()
        assert whole > 2 * length
        shares.append(ink(faint, **scene, line_color_shortest=96.0).sum() / whole)
    assert shares[0] == 0 and shares[-1] == pytest.approx(1, abs=1e-3)
    assert np.diff(shares).min() > -0.01 and np.diff(shares).max() < 0.2
    strong = coloured(6, -0.45)
    np.testing.assert_array_equal(ink(strong, **scene, line_color_shortest=96.0), ink(strong, **scene))


def test_lines_between_colours_thin_out_as_those_about_them_do():
    """A short bar that is just an edge, which alone has no border, near a long one: as joints far away, of which now
    these and now those hang together."""
    scene = dict(line_suggestive_strength=0.0, line_color_strength=2.5, line_color_width=1.0, edge_threshold=0.3,
                 line_thickness=2.0)
    long_, short = coloured(80, 0.25), coloured(10, 0.25)["color"]
    alone = dict(long_, color=short, albedo=short)
    assert ink(alone, **scene).sum() > 20 and ink(alone, **scene, line_color_shortest=96.0).max() == 0
    shares = []
    for apart in range(9, 30, 2):
        both = dict(long_)
        both["color"] = both["albedo"] = long_["color"] + np.roll(short - short[0, 0], apart, 0)
        part = np.s_[48 + apart - 5:48 + apart + 6, 40:88]
        shares.append(ink(both, **scene, line_color_shortest=96.0)[part].sum() / ink(both, **scene)[part].sum())
    assert 0.4 < shares[0] < 0.95 and shares[-1] == 0
    assert np.diff(shares).max() <= 1e-3 and np.diff(shares).min() > -0.25


def test_forms_smaller_than_the_scale_have_none():
    small = slope(1.0, width=1.2)
    assert ink(of(small), suggestive_size=12.0, **ALONE).max() == 0 < ink(of(small), **ALONE).max()


def test_a_style_has_its_own_weight():
    made = of(slope(1.0))
    made["style"] = (Y > 48).astype(float)[..., None]
    drawn = ink(made, styles=({"line_suggestive_strength": 0.0},))
    assert (drawn[:45].sum(1) > 3).all() and drawn[52:].max() == 0


def test_threads_draw_the_same():
    made = of(slope(0.6) + 6 * np.sin(X / 9) * np.cos(Y / 11))
    one = ink(made, threads=1)
    assert one.max() > 0
    for threads in (2, 3):
        np.testing.assert_array_equal(ink(made, threads=threads), one)


def test_a_border_is_drawn_as_in_the_whole_frame():
    """Unless a piece of all that hangs together is clearer than any within reach."""
    rng, y, x = np.random.default_rng(3), *np.mgrid[:300, :400].astype(float)
    height = np.zeros_like(x)
    for across, down, wide, high in rng.uniform((0, 0, 6, -2.5), (400, 300, 20, 2.5), (80, 4)):
        height += high * wide * np.exp(-((x - across) ** 2 + (y - down) ** 2) / (2 * wide * wide))
    made = {name: np.ascontiguousarray(a, np.float32) for name, a in of(height).items()}
    values = {**PEN, "suggestive_size": 6.0, "line_suggestive_shortest": 48.0}
    inner = Window(150, 120, 60, 50)
    outer = inner.grown(Settings(values).reach(300), 400, 300)
    assert outer.width < 400

    def drawn(window):
        cut = {name: np.ascontiguousarray(a[window.y:window.y + window.height, window.x:window.x + window.width])
               for name, a in made.items()}
        return library.render(cut, values, camera=Camera(orthographic=True, height=300),
                              frame=Frame(400, 300, window.x, window.y), outputs=("Encre Lines",)
                              ).images["Encre Lines"][..., 3]

    def within(picture, window):
        return picture[inner.y - window.y:, inner.x - window.x:][:inner.height, :inner.width]

    whole, part = within(drawn(Window(0, 0, 400, 300)), Window(0, 0, 400, 300)), within(drawn(outer), outer)
    assert (whole > 0.5).sum() > 20 and np.abs(whole - part).max() < 0.03
