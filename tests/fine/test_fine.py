# SPDX-License-Identifier: GPL-3.0-or-later
"""The detector FINE: its promises on scenes whose contours are known by formula, and what it does with nasty input."""


import numpy as np
import pytest
from encre.pen import library
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame
from judge import scenes, verdict

CONTROLS = len(library.controls())

OUTPUTS = ("Combined", "Encre Lines", "Encre Edges")
ALL = dict(edge_detector="FINE", edge_threshold=0.3, line_color_strength=3.0, line_shadow_strength=4.0,
           line_material_strength=1.0, line_mirror_strength=3.0)


def ink(layers, camera, **params):
    camera = Camera(camera["view"], camera["orthographic"], camera["height"])
    scene = {"edge_detector": "FINE", **params}
    drawn = library.render(layers, scene, camera=camera, outputs=("Combined", "Encre Lines"))
    return drawn.images["Encre Lines"][..., 3]


# ---- promises: most of them are judged in test_judged.py ------------------------------------------------------------


def test_widths_fairness_and_calm():
    scene = scenes.patches()
    layers = scene.layers("blackman")
    found = verdict.widths(ink, scene, layers) | verdict.fair(ink, scene, layers) | verdict.calm(ink, scene)
    assert {promise: value for promise, value in found.items() if not verdict.kept(promise, value)} == {}


@pytest.mark.parametrize("filter", ["box", "blackman"])
def test_moving_lines_are_still(filter):
    assert verdict.still(ink, filter)["still"] <= verdict.LIMITS["still"][1]


# ---- nasty input -----------------------------------------------------------------------------------------------


def noise(height, width, seed=0, smooth=False):
    """Layers in which nearly everything is an edge, some values are not finite and some pixels show nothing."""
    rng = np.random.default_rng(seed)
    layers = {name: rng.random((height, width, channels), np.float32) for name, channels in
              dict(combined=4, color=3, albedo=3, diffuse=3, specular=3, depth=1, normal=3, controls=CONTROLS,
                   seen_color=3, seen_normal=3, seen_depth=1).items()}
    layers["depth"] = 1 + layers["depth"] * 5
    layers["normal"], layers["seen_normal"] = layers["normal"] * 2 - 1, layers["seen_normal"] * 2 - 1
    layers["controls"] = layers["controls"] * 3 - 1.5
    for name in ("object", "material", "style"):
        layers[name] = rng.integers(0, 3, (height, width, 1)).astype(np.float32)
    if smooth:
        y, x = np.mgrid[:height, :width].astype(np.float32)
        for name, a in layers.items():
            waves = sum(np.sin(0.3 * k * x + 0.2 * y + k) for k in rng.uniform(0.2, 1.5, 4))
            layers[name] = np.repeat((waves / 4 + 1.1)[..., None] if name != "object" else np.rint(waves)[..., None],
                                     a.shape[2], 2).astype(np.float32)
    for a in layers.values():
        spots = rng.random(a.shape[:2]) < 0.02
        a[spots] = rng.choice([np.nan, np.inf, -np.inf, 0, 1e30, -1e30, 1e-40], a.shape)[spots]
    return layers


def drawn(layers, scene=ALL, styles=(), **how):
    return library.render(layers, scene, styles, outputs=OUTPUTS, **how).images


@pytest.mark.parametrize("size", [(1, 1), (1, 2), (2, 1), (1, 97), (97, 1), (2, 2), (3, 3), (4, 5), (7, 64), (89, 257)])
@pytest.mark.parametrize("smooth", [False, True])
def test_any_size_gives_finite_numbers(size, smooth):
    for camera in (Camera(), Camera(orthographic=True, height=1e-3)):
        images = drawn(noise(*size, smooth=smooth), dict(ALL, pen_1_taper=5.0, ink_tint=0.5), camera=camera)
        assert all(np.isfinite(a).all() for a in images.values())


@pytest.mark.parametrize("size, thickness", [((1, 9), 9.0), ((9, 1), 4096.0), ((4, 7), 4096.0), ((5, 8), 2.0),
                                             ((7, 15), 4096.0), ((4, 16), 2.0), ((5, 33), 90.0), ((3, 255), 4096.0),
                                             ((7, 256), 2.0), ((5, 257), 9.0), ((3, 2041), 2.0)])
def test_any_size_gives_the_same_bytes(size, thickness):
    """Around whole vectors, pieces of rows and blocks of the canvas, and with lines much wider than the picture."""
    scene = dict(ALL, line_thickness=thickness, line_thickest=4096.0, length_unit="PIXELS", ink_tint=0.5)
    one, other = (drawn(noise(*size, 2, smooth=True), scene, threads=threads, simd=simd)
                  for threads, simd in ((1, 1), (3, 0)))
    assert all(one[name].tobytes() == other[name].tobytes() for name in OUTPUTS)


@pytest.mark.parametrize("styles", [(), ({"line_crease_strength": 0.3, "pen_1_taper": 9.0, "shade_exposure": 2.0},
                                         {"use_lines": False})])
def test_threads_and_instructions_change_nothing(styles):
    layers = noise(83, 131, 1, smooth=True)
    scene = dict(ALL, ink_tint=0.4, line_thickness=3.0, length_unit="PIXELS")
    one = drawn(layers, scene, styles, threads=1)
    assert (one["Encre Lines"][..., 3] > 0).mean() > 0.05
    for how in (dict(threads=2), dict(threads=3), dict(threads=8), dict(threads=1, simd=0)):
        other = drawn(layers, scene, styles, **how)
        assert all(np.array_equal(one[name], other[name]) for name in OUTPUTS), how


def test_another_search_is_refused_in_one_sentence():
    with pytest.raises(EncreError, match=r"^line_search: .*EXACT.*$"):
        library.check(dict(edge_detector="FINE", line_search="WALK"))


def test_missing_layers_do_without():
    layers = noise(40, 50, smooth=True)
    for name in ("albedo", "object", "material", "controls", "specular", "style", "seen_depth", "seen_color"):
        del layers[name]
        assert np.isfinite(drawn(layers)["Combined"]).all()


def test_a_border_shows_what_the_frame_shows():
    scene, reach = scenes.boxes(), 64
    layers = scene.layers()
    params = verdict.PARAMS | {"edge_detector": "FINE"}
    whole = library.render(layers, params, outputs=OUTPUTS).images
    part = {name: np.ascontiguousarray(a[60:260, 90:330]) for name, a in layers.items()}
    cut = library.render(part, params, frame=Frame(400, 300, 90, 60), outputs=OUTPUTS).images
    for name in OUTPUTS:
        inside = whole[name][60 + reach:260 - reach, 90 + reach:330 - reach]
        np.testing.assert_array_equal(cut[name][reach:-reach, reach:-reach], inside)


# ---- lines -----------------------------------------------------------------------------------------------------


def step(width=64, height=40, slope=0.0, at=31.4):
    """A near object left of a line, a far one right of it, averaged over the pixel along rows."""
    y, x = np.mgrid[:height, :width].astype(np.float64)
    edge = at + slope * (y - height / 2)
    share = np.clip(edge - x + 0.5, 0, 1)[..., None]
    left = (x < edge)[..., None]
    layers = dict(combined=np.ones((height, width, 4)), color=share * (0.7, 0.2, 0.1) + (1 - share) * (0.1, 0.3, 0.8),
                  diffuse=np.ones((height, width, 3)), depth=np.where(left, 4.0, 9.0), object=left * 1.0,
                  normal=share * (0, 0, 1.0) + (1 - share) * (0, 1.0, 0), controls=np.zeros((height, width, CONTROLS)))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


PEN = dict(verdict.PARAMS, edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_thickness=6.0)


def across(image, row=20):
    """Centre and amount of what a row shows."""
    ink = image[row].astype(float)
    return (ink * np.arange(len(ink))).sum() / ink.sum(), ink.sum()


@pytest.mark.parametrize("slope", [0.0, 0.37, -0.5])
def test_a_line_lies_where_surfaces_part_and_is_as_wide_as_asked(slope):
    for thickness in (1.0, 3.0, 12.0):
        t = drawn(step(slope=slope), dict(PEN, line_thickness=thickness))["Encre Lines"][..., 3]
        amounts = [across(t, row)[1] for row in range(10, 30)]  # a row alone sees how pixels meet the slope
        assert across(t)[0] == pytest.approx(31.4, abs=0.1)
        assert np.mean(amounts) == pytest.approx(thickness * np.hypot(1, slope), rel=0.03)


def test_softness_is_half_dark_at_the_asked_width():
    for softness in (0.2, 0.5, 0.9):
        t = drawn(step(at=31.0), dict(PEN, line_thickness=20.0, pen_1_softness=softness))["Encre Lines"][20, :, 3]
        soft = softness * 10
        for d in range(1, 14):
            want = np.clip((10 - max(soft, 0.5) + max(soft, 1) - d) / max(soft, 1), 0, 1)
            assert t[31 + d] == pytest.approx(want, abs=0.02), (softness, d)


def test_controls_vary_along_the_line():
    layers = step()
    layers["controls"][..., 0] = np.linspace(-1, 1, 40, dtype=np.float32)[:, None]
    t = drawn(layers, dict(PEN, line_thickness=2.0))["Encre Lines"][..., 3]
    asked = [2 * (1 + 8 * c if c > 0 else 1 + c) for c in np.linspace(-1, 1, 40)]
    for row in (6, 12, 18, 22, 26):
        # A width eases into a greater one over about that, which rounds the corner that the control has at 0.
        assert across(t, row)[1] == pytest.approx(asked[row], rel=0.15, abs=0.4)


def test_far_lines_stay_behind_near_things():
    layers = step(at=40.4)
    layers["depth"][:, :24], layers["object"][:, :24] = 1.0, 2.0
    wide = dict(PEN, line_thickness=44.0)
    covered, free = (drawn(layers, dict(wide, line_occlude=on))["Encre Lines"][20, :, 3] for on in (True, False))
    assert (free[5:60] > 0.9).all()
    assert (covered[30:60] > 0.9).all()
    only_far = dict(wide, line_outline_strength=0.0, line_inner_strength=1.0)
    assert drawn(layers, only_far)["Encre Lines"][20, 2, 3] > 0.9  # its own edge inks the near thing


def test_ink_takes_the_tint_of_the_near_side():
    t = drawn(step(), dict(PEN, ink_tint=1.0, ink_tint_value=1.0))["Encre Lines"][20]
    full = t[..., 3] > 0.99
    assert full.sum() >= 5 and np.allclose(t[full, :3], step()["color"][20, 31], atol=1e-6)


def striped(edges, width=160, height=60):
    """White between edges 0 and 1, 2 and 3, ..., in columns of grey, averaged over the pixel along rows."""
    fine = np.zeros(64 * width)
    for left, right in zip(edges[::2], edges[1::2], strict=True):
        fine[round(64 * left):round(64 * right)] = 0.6
    albedo = np.tile(0.2 + fine.reshape(1, width, 64, 1).mean(2), (height, 1, 3))
    layers = dict(combined=np.ones((height, width, 4)), color=albedo, diffuse=np.ones((height, width, 3)),
                  depth=np.full((height, width), 5.0), normal=np.tile([0.0, 0, 1], (height, width, 1)))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("thickness", [1.0, 3.0])
def test_lines_between_colors_fade_where_they_close_up(thickness, turned):
    """What is left of the width of each of many lines, by their distance; a stripe on its own keeps both its lines."""
    scene = dict(edge_detector="FINE", edge_threshold=0.1, line_color_strength=1.0, line_color_width=1.0,
                 line_thickness=thickness,
                 length_unit="PIXELS", pen_1_softness=0.0, pen_1_grain=0.0, pen_1_steepness=0.5, pen_1_intensity=2.0)

    def row(edges):
        layers = {name: np.swapaxes(a, 0, 1) if turned else a for name, a in striped(edges).items()}
        image = drawn({name: np.ascontiguousarray(a) for name, a in layers.items()}, scene)["Encre Lines"][..., 3]
        return (image.T if turned else image)[30]

    left = [row(30.3 + apart * np.arange(2 * int(50 / apart)))[56:104].mean() * apart / thickness
            for apart in (2, 2.25, 3, 4, 4.5, 6, 8, 12)]
    assert left[0] < 0.01 and left[1] < 0.2 and np.diff(left[:6]).min() > -0.05 and left[2] < 0.8
    assert left[5:] == pytest.approx([1] * 3, abs=0.1)
    for broad in 3, 4, 6:
        assert row([70.3, 70.3 + broad]).sum() == pytest.approx(min(2 * thickness, thickness + broad), rel=0.03)


def test_edges_show_the_strength_where_sites_are():
    for weight in (0.5, 1.7):
        edges = drawn(step(), dict(PEN, line_outline_strength=weight, line_inner_strength=0.0,
                                   line_crease_strength=0.0))["Encre Edges"][..., 0]
        assert set(np.unique(edges)) == {0, np.float32(weight)}
        assert (edges > 0).sum(1).tolist() == [1] * 40


def fading():
    """A crease that gets blunter upwards and ends."""
    y, x = np.mgrid[:120, :90].astype(np.float64)
    angle = np.clip((y - 20) / 80, 0, 1) * 0.6 * np.clip((x - 45 + 0.2 * (y - 60)), -0.5, 0.5) * 2
    flat = np.ones((120, 90, 3))
    layers = dict(combined=np.ones((120, 90, 4)), color=flat / 2, diffuse=flat, depth=5 * flat[..., 0],
                  normal=np.stack([np.sin(angle), 0 * x, np.cos(angle)], -1))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def test_taper_thins_a_line_towards_its_free_end_only():
    blunt, taper = (drawn(fading(), dict(PEN, pen_1_taper=length))["Encre Lines"][..., 3] for length in (0.0, 30.0))
    inked = np.flatnonzero(blunt.sum(1) > 1)
    top = inked.min()
    assert top > 20 and inked.max() == 119
    slant = np.hypot(1, 0.2)
    for row in range(top + 6, 100, 7):
        share = min(1.0, (row - top - 3) * slant / 30)  # the blunt end's cap is 3 pixels
        assert taper[row].sum() == pytest.approx(blunt[row].sum() * share, abs=0.4), row
    assert np.array_equal(taper[80:], blunt[80:])  # the border cuts the line off: no end


def test_a_line_that_tapers_leaves_no_gap_in_the_one_it_meets():
    """A stripe of another colour, 12 pixels long, that stands on an outline."""
    layers = fading()
    layers["normal"][:] = 0, 0, 1
    layers["object"] = np.repeat(np.arange(120)[:, None, None] > 60, 90, 1).astype(np.float32)
    layers["color"][49:60, 45] = 0
    blunt, taper = (drawn(layers, dict(PEN, line_color_strength=3, line_thickness=1.5,
                                       pen_1_taper=length))["Encre Lines"][..., 3]
                    for length in (0.0, 30.0))
    assert taper[50:57, 40:51].sum() < 0.6 * blunt[50:57, 40:51].sum()
    outline = np.s_[59:63, 2:-2]
    assert taper[outline].sum(0).min() > 0.99 * blunt[outline].sum(0).min()


def test_crease_angle():
    """A crease of the asked angle is drawn in full, one of a third of it is not."""
    for angle in (10.0, 20.0, 40.0):
        for share, drawn_ in ((0.3, False), (1.05, True)):
            turn = np.radians(angle * share / 2)
            layers = fading()
            left = np.arange(90)[None, :, None] < 45
            layers["normal"][:] = np.where(left, (np.sin(turn), 0, np.cos(turn)), (-np.sin(turn), 0, np.cos(turn)))
            edges = drawn(layers, dict(PEN, crease_angle=angle, edge_threshold=0.01))["Encre Edges"]
            assert edges.max() == pytest.approx(float(drawn_), abs=1e-6)


def test_smudging_takes_the_nearest_site_unrounded():
    layers = step(at=31.4)
    layers["combined"][..., :3] = np.linspace(0, 1, 64)[None, :, None]
    layers["controls"][..., 3], layers["controls"][..., 4] = 1.0, 1.0
    scene = dict(PEN, use_lines=False, use_smudging=True, smudge_range=12.0, smudge_pick=6.0, smudge_falloff=1.0)
    got = drawn(layers, scene)["Combined"][20, :, 0]
    was = layers["combined"][20, :, 0]
    for x in range(20, 31):
        site = 31.4 + 0.02
        picked = int(np.floor(site + 6 + 0.5))
        assert got[x] == pytest.approx(was[picked], abs=1e-5), x
    assert np.array_equal(got[34:], was[34:])
