# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines against the reference: which edge inks a pixel, how dark, in which colour; and the nearest edge."""

import masks
import numpy as np
import pytest
import reference
from encre.pen import library
from encre.pen.errors import Cancelled
from encre.pen.job import Camera, Frame
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.params import strength
from reference.params import width as width_of

CONTROLS = len(library.controls())

# Only sources that float32 and float64 decide alike: indices, and bright specks on black that are an edge each.
SHARP = dict(line_inner_strength=0.0, line_crease_strength=0.0, line_material_strength=0.8, line_color_strength=1.5,
             color_detector="DOG", edge_blur=0.5,
             edge_threshold=0.3, use_shading=False, use_smudging=False, use_hatching=False)
PASSES = ("Combined", "Encre Lines", "Encre Surface")
SEARCHES = ("EXACT", "NEAREST", "WALK", "DILATE")
STYLES = [
    dict(ink_color=(0.9, 0.1, 0.2), line_thickness=17.0, pen_1_grain=0.1, pen_1_softness=0.2, line_color_width=1.7),
    dict(use_lines=False),
    dict(pen_1_intensity=1.6, pen_1_steepness=2.0, ink_tint=0.7, ink_color=(0.1, 0.2, 0.7), line_outline_width=0.4),
]
CASES = {
    "defaults": {},
    "hard": dict(pen_1_softness=0.0, line_thickness=5.0, pen_1_intensity=2.0, paper_source="NONE"),
    "pale": dict(pen_1_intensity=0.6, pen_1_steepness=1.5, line_thickness=21.0, pen_1_grain=1.0),
    "strong": dict(pen_1_intensity=2.6, pen_1_steepness=1.0, line_thickness=11.0, pen_1_softness=0.5),
    "contrast": dict(line_contrast=0.8, line_thickness=25.0, line_occlude=False),
    "thin": dict(line_thickness=2.1, pen_1_softness=0.4, paper_source="NONE"),
    "distance": dict(line_far_distance=5.0, line_thickness=9.0, line_occlude=False),
    "near": dict(line_far_distance=500.0, line_thickness=4.0),
    "far": dict(line_far_distance=0.4, line_far_thinnest=5.0, line_thickness=9.0, line_inner_width=0.3,
                line_color_strength=1.0),
    "not so near": dict(line_far_distance=500.0, line_far_thickest=1.4, line_thickness=9.0),
    "shade": dict(ink_in_shade=0.9, line_thickness=20.0, shade_exposure=0.8),
    "light": dict(ink_in_shade=-0.7, line_thickness=20.0),
    "widths": dict(line_outline_width=0.6, line_material_width=1.8, line_color_width=2.4),
    "bounded": dict(line_thickness=200.0, line_thickest=24.0),
    "tint": dict(ink_tint=0.6, ink_tint_value=0.8, ink_color=(0.3, 0.5, 0.1), line_thickness=24.0),
    "fade": dict(surface_fade=0.35),
}


def noise_layers(height, width, seed=0, styles=0, painted=True, smooth=False):
    """Blocks of objects and materials, specks of colour, a few long strokes, jumps and holes in depth."""
    rng = np.random.default_rng(seed)

    def blocks(size, values):
        coarse = rng.choice(values, (height // size + 1, width // size + 1))
        return np.repeat(np.repeat(coarse, size, 0), size, 1)[:height, :width].astype(np.float32)

    def noise(channels, low=0.0, high=1.0):
        return rng.uniform(low, high, (height, width, channels)).astype(np.float32)

    waves = sum(np.sin(np.add.outer(np.arange(height) * a, np.arange(width) * b) + c)
                for a, b, c in rng.uniform(-0.15, 0.15, (6, 3)) * (1, 1, 40)) / 6
    albedo = noise(1, 0.2) * (rng.random((height, width, 1)) < 0.004) * np.ones(3, np.float32)
    index = blocks(37, range(2)) if not smooth else (waves > 0.1).astype(np.float32) + (np.abs(waves + 0.2) < 0.02)
    depth = blocks(17, (3, 4, 6)) + (noise(1)[..., 0] if not smooth else 2 * waves)
    depth[blocks(11, range(9)) == 3] = 1e10
    controls = np.zeros((height, width, CONTROLS), np.float32)
    if painted:
        controls[..., :2] = noise(2, -1.1, 1.1) * (rng.random((height, width, 2)) < 0.4)
        if smooth:
            controls[..., 0], controls[..., 1] = 0.4 * waves, 0.3 * waves[::-1]
    return dict(combined=noise(4), color=noise(3), albedo=albedo, diffuse=noise(3, 0, 1.4),
                depth=depth.astype(np.float32), normal=noise(3, -1), object=index,
                material=blocks(31, range(2)), controls=controls, style=blocks(13, range(styles + 1)))


def check(layers, scene, styles=(), camera=None, frame=None, tolerance=1e-4):
    camera, frame = camera or Camera(), frame or {}
    scene = {**SHARP, **scene}
    want = reference.render(layers, scene, styles, vars(camera), frame)
    got = masks.render(layers, scene, styles, camera, Frame(**frame) if frame else None, PASSES).images
    sure = ~want["unsure"]
    for name in PASSES:
        assert np.isfinite(got[name]).all()
        assert np.abs(got[name] - want[name])[sure].max(initial=0) <= tolerance, name
    over = got["Encre Surface"] * (1 - got["Encre Lines"][..., 3:]) + got["Encre Lines"]
    assert np.abs(over - got["Combined"]).max() <= 1e-6
    return want


def full(height, width):
    """The images lie in a frame of 1080 rows, so that lengths are pixels."""
    return dict(width=width + 7, height=1080, x=5, y=300)


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("name", CASES)
def test_agrees(name, search):
    layers = noise_layers(47, 71, len(name), painted=name not in ("contrast", "thin", "bounded"))
    want = check(layers, dict(CASES[name], line_search=search), frame=full(47, 71))
    ink = want["Encre Lines"][..., 3][~want["unsure"]]
    assert (ink > 0).mean() > 0.02 and ((ink > 0.01) & (ink < 0.99)).any()  # the case shows something


@pytest.mark.parametrize("search", SEARCHES)
def test_styles(search):
    for seed in range(2):
        check(noise_layers(47, 71, seed, 3), dict(surface_fade=0.2, line_search=search), STYLES, frame=full(47, 71))


def test_fade_spares_styles_without_a_stage():
    layers = noise_layers(20, 30, styles=2)
    scene = dict(SHARP, surface_fade=0.5)
    got = masks.render(layers, scene, [dict(use_lines=False), {}], outputs=PASSES).images["Encre Surface"]
    same = (got == layers["combined"]).all(-1)
    assert same[layers["style"] == 1].all() and not same[layers["style"] != 1].any()


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("size", [(1, 1), (1, 2), (3, 1), (1, 90), (90, 1), (2, 3), (2, 8), (3, 9), (2, 31), (3, 32),
                                  (2, 33), (17, 15), (2, 255), (1, 256), (2, 257)])
def test_sizes(size, search):
    for seed in range(3 if max(size) < 100 else 1):
        layers = noise_layers(*size, seed)
        layers["albedo"][:] = np.random.default_rng(seed).random((*size, 1)) < 0.3
        check(layers, dict(line_search=search, edge_threshold=0.01), frame=full(*size))


@pytest.mark.parametrize("search", SEARCHES)
def test_widths_at_which_blocks_of_the_canvas_double(search):
    """One more than 64 blocks do not fit a row's word."""
    for width in (2007, 2008, 2009, 2040, 4056):
        layers = noise_layers(3, width, styles=2)
        one, other = (masks.render(layers, dict(line_thickness=9.0, ink_tint=0.5, line_search=search,
                                                length_unit="PIXELS"), STYLES, outputs=PASSES, threads=threads,
                                   simd=simd).images for threads, simd in ((1, 1), (2, 0)))
        assert all(one[name].tobytes() == other[name].tobytes() and np.isfinite(one[name]).all() for name in PASSES)
        assert one["Encre Lines"][..., 3].any(0)[-99:].any()


@pytest.mark.parametrize("search", ["EXACT", "NEAREST"])
@pytest.mark.parametrize("space", ["INVERSE", "LINEAR"])
def test_orthographic(search, space):
    """Occlusion counts in frame heights, and distance thins nothing."""
    scene = dict(line_search=search, line_thickness=20.0, line_far_distance=2.0, depth_space=space)
    for height in (2.0, 8.0, 30.0):
        check(noise_layers(40, 60, 3), scene, camera=Camera(orthographic=True, height=height), frame=full(40, 60))


def test_every_source_has_its_width():
    """Depth, creases and light too; their strengths are the edge stage's, so only sure pixels count."""
    rng = np.random.default_rng(1)
    layers = noise_layers(60, 80, 1, painted=False)
    x = np.arange(80)
    layers["depth"][:] = np.where(x < 20, 3.0, 7.0)
    layers["normal"][:] = np.where((x > 40)[:, None], (0.0, 0.0, 1.0), (0.9, 0.0, 0.4))
    layers["diffuse"][:] = np.where((x > 60)[:, None], 0.2, 1.4)
    layers["object"][:], layers["albedo"][:], layers["material"][:] = 0, 0, 0
    for source in ("depth", "normal", "light"):
        weights = {strength(s): float(s == source) for s in reference.SOURCES}
        for width in rng.uniform(0.3, 3.0, 2):
            want = check(layers, dict(weights, **{width_of(source): width}, line_occlude=False), frame=full(60, 80))
            assert (want["Encre Lines"][..., 3] > 0).any()


def test_a_small_thing_near_by_hides_what_is_drawn_farther_right():
    """It lies at the end of one of the squares of which the least depth is known; the line in the next, alone."""
    size, near = (70, 110), np.s_[36:60, 50:64]
    layers = {"combined": np.ones((*size, 4)), "depth": np.full((*size, 1), 10.0),
              "controls": np.zeros((*size, CONTROLS)), "object": (np.indices(size)[1] > 67)[..., None] * 1.0}
    layers |= dict.fromkeys(("color", "diffuse", "normal"), np.ones((*size, 3)))
    layers["depth"][near], layers["object"][near], layers["controls"][near + (0,)] = 1, 2, -1
    layers = {name: np.float32(layer) for name, layer in layers.items()}
    scene = dict(edge_detector="DOG", line_inner_strength=0, line_crease_strength=0, line_thickness=20.0,
                 length_unit="PIXELS")
    for occlude in False, True:
        ink = library.render(layers, dict(scene, line_occlude=occlude), outputs=["Encre Lines"]).images["Encre Lines"]
        assert ink[40:56, 66:70, 3].min() > 0.5 and ink[near][..., 3].any() != occlude



@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.sampled_from([3.0, 9.0, 24.0, 60.0]), st.sampled_from([0.0, 0.3, 0.9]),
       st.sampled_from([0.8, 1.0, 2.0, 4.0]), st.booleans(), st.booleans())
def test_strongest_of_all(seed, thickness, softness, intensity, occlude, tint):
    """Discs are cut down to where they can win: smooth changes of radius, depth and pressure are where that is hard.
    Half of all are nearer than 1."""
    layers = noise_layers(40, 64, seed, painted=seed % 3 > 0, smooth=True)
    layers["depth"][layers["depth"] < 1e10] *= 0.05 if seed % 2 else 1
    check(layers, dict(line_thickness=thickness, pen_1_softness=softness, pen_1_intensity=intensity,
                       line_occlude=occlude,
                       ink_tint=0.6 * tint, line_material_strength=0.0), frame=full(40, 64))


@pytest.mark.parametrize("unit", ["RELATIVE", "SCENE"])
def test_the_full_width_s_distance_is_relative(unit):
    """To the camera's distance, in styles too; where that is not known, and for other cameras, as it is."""
    layers, scene = noise_layers(40, 60, 5, styles=1), dict(line_far_distance=0.8, line_far_unit=unit,
                                                            line_thickness=14.0)
    for camera in (Camera(distance=6.0), Camera(), Camera(orthographic=True, height=4.0, distance=6.0)):
        check(layers, scene, [dict(line_far_distance=1.5, line_far_unit="SCENE")], camera)


@pytest.mark.parametrize("search", ["EXACT", "NEAREST"])
@pytest.mark.parametrize("camera,share", [(Camera(), 0.1), (Camera(orthographic=True, height=4.0), 0.08)])
def test_occlusion_begins_a_tenth_nearer(search, camera, share):
    """Of the edge's depth, or of the frame's height; the edge is at 5 and its line lies over a gentle slope."""
    layers = {name: a * 0 for name, a in noise_layers(9, 400).items()}
    slope = 5 * (1 - share) + np.linspace(-0.01, 0.01, 390)
    layers["depth"][:] = np.concatenate([np.full(10, 5), slope])
    layers["albedo"][4, 4] = 1
    scene = dict(SHARP, line_search=search, line_thickness=2000.0, line_thickest=2000.0, length_unit="PIXELS",
                 pen_1_softness=0.0, paper_source="NONE", pen_1_intensity=2.0)
    ink = masks.render(layers, scene, camera=camera, outputs=PASSES).images["Encre Lines"][4, 10:, 3]
    assert (ink[slope < 5 * (1 - share) - 1e-4] == 0).all() and (ink[slope > 5 * (1 - share) + 1e-4] == 1).all()


# ---- which edge ------------------------------------------------------------------------------------------------


def locations(search, specks, shape):
    """Row and column of the edge that inks each pixel in full, told by its tint; -1 where none does."""
    rng = np.random.default_rng(0)
    layers = {name: a * 0 for name, a in noise_layers(*shape).items()}
    layers["depth"] += 5
    layers["combined"] += rng.random(layers["combined"].shape, np.float32)
    for y, x in specks:
        layers["albedo"][y, x] = 1
    layers["color"][..., 0], layers["color"][..., 1] = np.mgrid[: shape[0], : shape[1]] + 1
    scene = dict(SHARP, line_search=search, line_thickness=4096.0, line_thickest=4096.0, length_unit="PIXELS",
                 pen_1_softness=0.0, paper_source="NONE", pen_1_intensity=4.0, ink_tint=1.0, ink_tint_value=1.0)
    assert (masks.render(layers, scene, outputs=("Encre Edges",)).images["Encre Edges"] > 0.3).sum() == len(specks)
    lines = masks.render(layers, scene, outputs=PASSES).images["Encre Lines"]
    assert set(np.unique(lines[..., 3])) <= {0, 1}
    return lines[..., 0].astype(int) - 1, lines[..., 1].astype(int) - 1


def scattered(n, shape, seed):
    """Places no two of which are neighbours."""
    rng = np.random.default_rng(seed)
    taken = np.zeros((shape[0] + 4, shape[1] + 4), bool)
    places = []
    for y, x in zip(rng.integers(0, shape[0], 4 * n), rng.integers(0, shape[1], 4 * n), strict=True):
        if len(places) < n and not taken[y : y + 5, x : x + 5].any():
            taken[y + 2, x + 2] = True
            places.append((y, x))
    return places


@pytest.mark.parametrize("search", ["EXACT", "NEAREST"])
@pytest.mark.parametrize("shape,n", [((89, 257), 40), ((89, 257), 2), ((300, 5), 6), ((4, 600), 5), ((64, 64), 150)])
def test_nearest_edge(search, shape, n):
    """Exactly the nearest, then the one in the least row, then in the least column; EXACT too where all ink in full."""
    specks = np.array(scattered(n, shape, n))
    row, column = locations(search, specks, shape)
    y, x = np.mgrid[: shape[0], : shape[1]]
    squared = (y[..., None] - specks[:, 0]) ** 2 + (x[..., None] - specks[:, 1]) ** 2
    best = (squared * 10**7 + specks[:, 0] * 1000 + specks[:, 1]).argmin(-1)
    assert (row == specks[best, 0]).all() and (column == specks[best, 1]).all()


@pytest.mark.parametrize("search", SEARCHES)
def test_equals_are_taken_in_reading_order(search):
    specks = [(8, 12), (12, 8), (12, 16), (16, 12)]  # about (12, 12)
    row, column = locations(search, specks, (25, 25))
    assert (row[12, 12], column[12, 12]) == (8, 12) or search == "WALK"  # where the gradient is 0, a walk finds nothing
    row, column = locations(search, [(12, 8), (12, 16)], (25, 25))
    if search != "WALK":
        assert (column[:, 12] == 8).all()


def test_dilation_goes_twenty_pixels():
    row, _ = locations("DILATE", [(50, 50)], (101, 101))
    y, x = np.mgrid[:101, :101]
    assert ((row >= 0) == (np.maximum(abs(y - 50), abs(x - 50)) <= 20)).all()


def test_walk_goes_nineteen_pixels():
    row, _ = locations("WALK", [(30, 30)], (61, 61))
    found = np.flatnonzero(row[30] >= 0)
    assert (found[0], found[-1]) == (30 - 21, 30 + 21)  # two more are handed on


def test_large_discs_reach_their_radius():
    """2048 pixels, the most there is; beyond 16 bits of distance squared."""
    layers = {name: a * 0 for name, a in noise_layers(3, 2500).items()}
    layers["depth"] += 5
    layers["albedo"][1, 100] = 1
    scene = dict(SHARP, line_thickness=4096.0, line_thickest=4096.0, length_unit="PIXELS", pen_1_softness=0.0,
                 paper_source="NONE", pen_1_intensity=2.0, pen_1_steepness=1.0, line_color_width=1.0)
    for search in ("EXACT", "NEAREST"):
        for turn in (False, True):
            turned = {name: np.ascontiguousarray(a.swapaxes(0, 1)) if turn else a for name, a in layers.items()}
            ink = masks.render(turned, dict(scene, line_search=search), outputs=PASSES).images["Encre Lines"][..., 3]
            ink = ink[:, 1] if turn else ink[1]
            assert (ink[:2147] > 0.999).all() and (ink[2148:] == 0).all()


@pytest.mark.parametrize("search", SEARCHES)
def test_no_line_without_an_edge(search):
    layers = {name: a * 0 for name, a in noise_layers(300, 6).items()}
    layers["depth"] += 5
    layers["combined"] += 1
    scene = dict(SHARP, line_search=search, length_unit="PIXELS", line_thickness=30.0, line_thickest=30.0)
    for edges in (0, 1):
        layers["albedo"][3, 3] = edges
        ink = masks.render(layers, scene, outputs=PASSES).images["Encre Lines"][..., 3]
        assert ink[:10].any() == bool(edges) and not ink[20:].any()


# ---- bits ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("tint", [0.0, 0.5])
def test_threads_and_instruction_sets(search, tint):
    layers = noise_layers(150, 143, 5, styles=3)
    scene = dict(SHARP, line_search=search, ink_tint=tint, line_thickness=12.0, surface_fade=0.1)
    frame = Frame(**full(150, 143))
    first = masks.render(layers, scene, STYLES, frame=frame, outputs=PASSES, threads=1, simd=0).images
    for threads, simd in ((1, 1), (2, 1), (3, 0), (8, 1)):
        other = masks.render(layers, scene, STYLES, frame=frame, outputs=PASSES, threads=threads, simd=simd).images
        assert all(first[name].tobytes() == other[name].tobytes() for name in PASSES)


@pytest.mark.parametrize("search", SEARCHES)
def test_pixels_without_ink_keep_their_bits(search):
    layers = noise_layers(50, 70, 6)
    layers["combined"][::2] = -0.0
    got = masks.render(layers, dict(SHARP, line_search=search), outputs=PASSES).images
    clear = got["Encre Lines"][..., 3] == 0
    assert 0 < clear.sum() < clear.size
    assert got["Combined"][clear].tobytes() == layers["combined"][clear].tobytes()
    assert not got["Encre Lines"][clear].any()
    assert got["Encre Surface"].tobytes() == layers["combined"].tobytes()


@pytest.mark.parametrize("search", SEARCHES)
def test_extremes_stay_finite(search):
    most = float(np.finfo(np.float32).max)
    layers = noise_layers(30, 40, 7)
    layers["color"][::3], layers["color"][1::3] = most, -most
    layers["combined"][:, ::2], layers["combined"][:, 1::2] = most, -most
    layers["depth"][::2] = 1e-38
    layers["controls"][:, ::4, :2] = -1
    wide = {width_of(source): most for source in reference.SOURCES}
    none = (dict(pen_1_steepness=0.0), dict(pen_1_intensity=0.0), dict(line_thickness=0.0), dict(line_thickest=0.0))
    some = (dict(pen_1_intensity=most), dict(pen_1_steepness=most, pen_1_intensity=most), dict(ink_tint=0.5), wide,
            dict(line_far_distance=most, ink_in_shade=1.0, shade_exposure=most, **wide), dict(surface_fade=0.5))
    for scene in none + some:
        scene = dict(SHARP, line_search=search, ink_color=(most, 0, 1), **scene)
        got = masks.render(layers, scene, outputs=PASSES).images
        assert all(np.isfinite(a).all() for a in got.values())
        if scene in [dict(scene, **n) for n in none]:
            assert not got["Encre Lines"].any()


@pytest.mark.parametrize("search", SEARCHES)
def test_cancelling_at_every_step(search):
    layers, scene, seen = noise_layers(60, 50, 8), dict(SHARP, line_search=search), []
    masks.render(layers, scene, threads=1, progress=lambda fraction: seen.append(fraction) or True)
    for stop in seen[::3]:
        with pytest.raises(Cancelled):
            masks.render(layers, scene, threads=1, progress=lambda fraction, stop=stop: fraction < stop)
