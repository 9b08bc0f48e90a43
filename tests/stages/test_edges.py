# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges against the reference: strengths, which pixels are edges, whose source and whose controls they take."""

import masks
import numpy as np
import pytest
import reference
from encre.pen import library
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Chains
from known import line
from reference.params import strength, width

CONTROLS = len(library.controls())

OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False)
NO_EDGES = {strength(source): 0.0 for source in reference.SOURCES}
# Ink is 1 on edge pixels and 0 beside them: discs of radius 1 have no falloff inside.
STAMP = dict(OFF, use_lines=True, line_search="NEAREST", line_thickness=2.0, length_unit="PIXELS", pen_1_softness=0.0,
             pen_1_grain=0.0, paper_source="NONE", line_occlude=False, pen_1_steepness=4.0, pen_1_intensity=1.0,
             line_contrast=0.0, line_far_distance=0.0, **{width(source): 1.0 for source in reference.SOURCES})
ORTHO = Camera(orthographic=True, height=2.5)


def blocks(rng, height, width, size, values):
    coarse = rng.choice(values, (height // size + 1, width // size + 1))
    return np.repeat(np.repeat(coarse, size, 0), size, 1)[:height, :width]


def drawn(height, width, seed=0, kind="noise", nasty=False, painted=True):
    """Layers full of edges of every strength; with holes where nothing is, and values that are no numbers."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:height, 0:width]
    if kind == "noise":
        depth = rng.random((height, width)) * rng.choice([0.05, 1, 20, 150]) + 1e-3
        normal = rng.uniform(-1, 1, (height, width, 3))
        albedo = rng.uniform(-0.1, 1.2, (height, width, 3))
    else:
        depth = 5 + 0.02 * x + 3 * ((x // 7 + y // 5) % 2) + 0.1 * np.sin(x / 3)
        normal = 0.7 * np.stack([np.sin(x / 5), np.cos(y / 4), (x + y) // 9 % 2], -1)
        albedo = np.stack([x // 6 % 3 / 2, y // 4 % 4 / 3, (x + y) // 5 % 2 * 0.8], -1)
    holes = blocks(rng, height, width, 5, [True] + [False] * 4)
    depth[holes] = rng.choice([1e10, np.inf, 0, -1, 2e9])
    normal[holes] = 0
    layers = dict(
        combined=np.concatenate([rng.random((height, width, 3)) * 1.5, np.ones((height, width, 1))], -1),
        color=albedo, albedo=albedo, diffuse=np.repeat(blocks(rng, height, width, 3, [0.2, 0.6, 1.2])[..., None], 3, 2),
        depth=depth, normal=normal, object=blocks(rng, height, width, 8, range(3)),
        material=blocks(rng, height, width, 6, range(3)), style=blocks(rng, height, width, 7, range(4)),
        controls=np.where(rng.random((height, width, 1)) < 0.5, 0, rng.uniform(-1.2, 1.2, (height, width, CONTROLS))))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items() if painted or name != "controls"}
    if nasty:
        for a in layers.values():
            bad = rng.random(a.shape) < 0.01
            a[bad] = rng.choice([np.nan, np.inf, -np.inf], bad.sum())
    strokes = [line(rng.uniform(0, 1, (3, 2)) * (width, height), kind, run=k)
               for k, kind in enumerate(["mark"] * 6 + ["contour"])]
    return layers | {"chains": Chains(np.concatenate(strokes), np.zeros(3, np.uint8))}


def expected(layers, scene, styles=(), camera=None):
    camera = camera or Camera()
    return reference.render(layers, scene, styles, dict(orthographic=camera.orthographic, height=camera.height))


def strengths(layers, scene, styles=(), camera=None, **how):
    return masks.render(layers, {**OFF, **scene}, styles, camera, outputs=("Encre Edges",), **how) \
        .images["Encre Edges"][..., 0]


def check(layers, scene, styles=(), camera=None):
    got = strengths(layers, scene, styles, camera)
    want = expected(layers, {**OFF, **scene}, styles, camera)
    sure = ~want["edge_unsure"]
    error = np.abs(got - want["Encre Edges"]) - (2e-5 + 1e-4 * want["Encre Edges"])
    assert np.isfinite(got).all()
    assert error[sure].max(initial=-1) <= 0
    return want["Encre Edges"]


def alone(source, **more):
    return {**NO_EDGES, strength(source): 1.3, **more}


CASES = {
    "object": alone("object"),
    "material": alone("material"),
    "mark": alone("mark"),
    "depth": alone("depth"),
    "linear depth": alone("depth", depth_space="LINEAR", depth_near=0.5, depth_far=9.0),
    "normal": alone("normal"),
    "color": alone("color", color_detector="DOG"),
    "lit": alone("color", color_detector="DOG", color_layer="LIT"),
    "light": alone("light", color_detector="DOG"),
    "RGB": alone("color", contrast_metric="RGB"),
    "CIE76": alone("color", contrast_metric="CIE76", contrast_threshold=0.2, contrast_full=0.6),
    "CIEDE2000": alone("color", contrast_metric="CIEDE2000", contrast_full=0.8),
    "HSL": alone("color", contrast_metric="HSL"),
    "HSL, weighted": alone("color", contrast_metric="HSL", contrast_hue=2.0, contrast_saturation=0.3,
                           contrast_lightness=0.6, contrast_full=0.7),
    "CMC": alone("color", contrast_metric="CMC", contrast_full=0.9),
    "light, CIE76": alone("light", contrast_metric="CIE76"),
    "a step": alone("color", contrast_threshold=0.3, contrast_full=0.3),
    "all": dict(line_outline_strength=0.4, line_material_strength=0.3, line_inner_strength=0.7,
                line_crease_strength=1.5, line_color_strength=0.5, line_shadow_strength=0.6,
                line_mark_strength=0.2),
}


@pytest.mark.parametrize("row", [8, 12, 100])  # where bands of rows begin, and within one
def test_rows_of_an_unclean_reading_are_forgotten(row):
    """Threads find edges as they look at the layers, and go on below where their last rows end."""
    layers = drawn(200, 40, 0, "drawn")
    bad, clean = (layers | dict(normal=layers["normal"].copy()) for _ in range(2))
    bad["normal"][row, 10:30], clean["normal"][row, 10:30] = np.inf, 0
    want = strengths(clean, CASES["normal"] | dict(edge_detector="DOG"))
    for threads in [1, 2, 3] * 20:
        assert (strengths(bad, CASES["normal"] | dict(edge_detector="DOG"), threads=threads) == want).all()


@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
@pytest.mark.parametrize("name", CASES)
def test_strength(name, detector):
    scene = dict(CASES[name], edge_detector=detector)
    want = [check(drawn(31, 53, seed, kind), scene) for seed, kind in enumerate(("noise", "drawn"))]
    assert max(w.max() for w in want) > 0  # the case shows something
    check(drawn(20, 30, 2, "noise", nasty=True), scene)


@pytest.mark.parametrize("sigma", [0.5, 0.501, 1.3, 4.0])
@pytest.mark.parametrize("name", ["depth", "linear depth", "normal", "color"])
def test_sigma(name, sigma):
    check(drawn(40, 37, 3, "drawn"), dict(CASES[name], edge_blur=sigma))


@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
@pytest.mark.parametrize("space", ["INVERSE", "LINEAR"])
def test_orthographic(detector, space):
    scene = alone("depth", edge_detector=detector, depth_space=space)
    for seed, kind in enumerate(("noise", "drawn", "noise")):
        check(drawn(33, 41, seed, kind, nasty=seed == 2), scene, camera=ORTHO)
    check(drawn(33, 41, 4, "drawn"), dict(scene, edge_blur=2.6), camera=ORTHO)


@pytest.mark.parametrize("size", [(1, 1), (1, 2), (2, 1), (1, 40), (40, 1), (2, 3), (5, 300), (300, 4), (3, 513)])
@pytest.mark.parametrize("camera", [Camera(), ORTHO], ids=["perspective", "orthographic"])
def test_sizes(size, camera):
    for detector, sigma in (("DOG", 1.0), ("DOG", 4.0), ("SOBEL", 1.0)):
        for space in ("INVERSE", "LINEAR"):
            check(drawn(*size, 5, "noise"),
                  dict(CASES["all"], edge_detector=detector, depth_space=space, edge_blur=sigma), camera=camera)
        check(drawn(*size, 6, "drawn"), alone("color", contrast_local=True, contrast_window=7.0))


@pytest.mark.parametrize("window", [1.0, 2.0, 3.0, 9.9, 64.0, 4096.0])
@pytest.mark.parametrize("source", ["color", "light"])
def test_contrast_auto(source, window):
    layers = drawn(37, 70, 7, "drawn")
    layers["albedo"][:, 20:] *= 0.2  # weak contrasts: below and above the 0.25 that counts as full
    layers["diffuse"][:, 30:] *= 0.4
    check(layers, alone(source, contrast_local=True, contrast_window=window, length_unit="PIXELS"))


def test_contrast_auto_counts_at_least_a_quarter():
    layers = drawn(9, 9, kind="drawn", painted=False)
    layers["albedo"][:] = 0
    layers["albedo"][:, 5:] = 0.002  # encoded difference 0.02584
    got = strengths(layers, {**NO_EDGES, "line_color_strength": 1.0, "contrast_local": True, "contrast_threshold": 0.0})
    assert got[:, 4:6] == pytest.approx(0.002 * 12.92 / 0.25, rel=1e-5)


def test_contrast_window_follows_length_unit():
    layers = drawn(27, 60, 8, "drawn")
    layers["albedo"] *= np.linspace(0.05, 1, 60, dtype=np.float32)[:, None]
    scene = alone("color", contrast_local=True, contrast_window=400.0)
    relative = strengths(layers, scene)
    assert np.array_equal(relative, strengths(layers, dict(scene, length_unit="PIXELS", contrast_window=10.0)))
    assert not np.array_equal(relative, strengths(layers, dict(scene, length_unit="PIXELS")))
    check(layers, scene)


STYLES = [{}, dict(line_inner_strength=0.3, line_crease_strength=2.0, line_outline_strength=0.0,
                   line_material_strength=0.8, line_color_strength=0.2, line_shadow_strength=0.1),
          dict(line_inner_strength=0.0, line_color_strength=1.0, edge_threshold=99.0)]


@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
def test_styles_and_painted_color(detector):
    for seed, kind in enumerate(("noise", "drawn")):
        check(drawn(40, 300, seed, kind), dict(CASES["all"], edge_detector=detector), STYLES)
        check(drawn(40, 60, seed, kind), dict(line_color_strength=0.0, edge_detector=detector), STYLES)


@pytest.mark.parametrize("styles", [(), STYLES], ids=["one", "styles"])
def test_edge_pixels_their_source_and_their_controls(styles):
    layers = drawn(45, 70, 9, "drawn")
    layers["controls"][..., 0] = np.random.default_rng(1).integers(-1, 1, (45, 70))  # -1 removes the line
    layers["controls"][..., 1] = 0
    scene = dict(STAMP, line_outline_strength=0.8, line_material_strength=0.7, line_inner_strength=0.2,
                 line_crease_strength=0.15, line_color_strength=0.9,
                 line_shadow_strength=4.0, edge_threshold=0.55)
    want = expected(layers, scene, styles)
    near = owners(layers["depth"])
    kept = layers["controls"][..., 0][near] == 0
    doubtful = np.abs(want["Encre Edges"] - 0.55) < 1e-4
    for number, source in enumerate(reference.SOURCES):
        widths = {width(other): float(other == source) for other in reference.SOURCES}
        ink = masks.render(layers, {**scene, **widths}, styles, outputs=("Encre Lines",)).images["Encre Lines"][..., 3]
        edges = want["edge_mask"] & (want["edge_source"] == number)
        assert edges.any()
        assert np.array_equal((ink > 0)[~doubtful], (edges & kept)[~doubtful])


def owners(depth):
    """Row and column of the least depth in the 5x5 about each pixel, by looking at all of them."""
    height, width = depth.shape
    z = np.where((depth > 0) & (depth < 1e9), depth, np.inf)
    rows, columns = np.empty((2, height, width), int)
    for y in range(height):
        for x in range(width):
            window = [(v, u) for v in range(max(0, y - 2), min(height, y + 3))
                      for u in range(max(0, x - 2), min(width, x + 3))]
            distance = {(v, u): (v - y) ** 2 + (u - x) ** 2 for v, u in window}
            rows[y, x], columns[y, x] = min(window, key=lambda p: (z[p], distance[p], p))  # noqa: B023
    return rows, columns


def test_owner_ties_at_equal_depth():
    layers = drawn(24, 40, 3)
    layers["depth"] = np.random.default_rng(2).choice(np.float32([2, 3, 1e10]), (24, 40), p=[0.08, 0.42, 0.5])
    layers["controls"][..., 0] = np.random.default_rng(3).integers(-1, 1, (24, 40))
    layers["controls"][..., 1] = 0
    scene = dict(STAMP, **alone("object"), edge_threshold=0.5)
    layers["object"] = np.arange(24 * 40, dtype=np.float32).reshape(24, 40)  # every pixel is an edge
    kept = layers["controls"][..., 0][owners(layers["depth"])] == 0
    ink = masks.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][..., 3]
    assert np.array_equal(ink > 0, kept)


def test_threshold_is_inclusive_and_zero_is_no_edge():
    layers = drawn(8, 12, kind="drawn")
    layers["controls"][:] = 0
    layers["object"][:] = np.arange(12) >= 6
    for weight, threshold, edges in ((0.5, 0.5, True), (0.5, 0.50001, False), (0.0, 0.0, False)):
        scene = {**STAMP, **NO_EDGES, "line_outline_strength": weight, "edge_threshold": threshold}
        ink = masks.render(layers, scene, outputs=("Encre Lines",)).images["Encre Lines"][0, :, 3]
        assert (ink > 0).tolist() == [edges and x in (5, 6) for x in range(12)]


@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
def test_sobel_shape_threshold_and_linear_limits(detector):
    layers = drawn(31, 53, 1, "drawn")
    for least in (0.0, 0.31, 0.9):
        check(layers, alone("normal", edge_detector=detector, sobel_crease_threshold=least))
    layers["depth"][:] = np.where(np.arange(53) < 20, 1e-3, 1e6)
    for near, far in ((0.0, 1.0), (0.01, 1e7)):
        check(layers, alone("depth", edge_detector=detector, depth_space="LINEAR", depth_near=near, depth_far=far))


@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
def test_planes_have_no_edges_up_to_the_border(detector):
    y, x = np.mgrid[0:50, 0:80]
    layers = drawn(50, 80, painted=False)
    for camera, depth in ((Camera(), 1 / (0.002 + 0.004 * x + 0.01 * y)), (ORTHO, 3 + 0.4 * x + 0.9 * y)):
        layers["depth"] = depth.astype(np.float32)
        scene = alone("depth", edge_detector=detector, edge_blur=2.0)
        assert strengths(layers, scene, camera=camera).max() < 1e-3
        assert strengths(layers, dict(scene, depth_space="LINEAR"), camera=camera).max() > 0.01


@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
def test_flat_is_exactly_nothing(detector):
    layers = drawn(20, 300, kind="drawn")
    del layers["chains"]
    for name, a in layers.items():
        a[:] = {"depth": 7.3, "normal": 0.37, "albedo": 0.31}.get(name, 0.6)
    for camera in (Camera(), ORTHO):
        for space in ("INVERSE", "LINEAR"):
            scene = {**CASES["all"], "edge_detector": detector, "color_detector": "DOG", "depth_space": space}
            inner = strengths(layers, scene, camera=camera)[8:-8, 8:-8]
            assert not inner.any()
            assert strengths(layers, dict(scene, line_inner_strength=0.0), camera=camera).max() == 0


@pytest.mark.parametrize("name", ["all", "CIEDE2000", "light, CIE76"])
@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
def test_same_bytes_on_all_threads_and_instructions(name, detector):
    layers = drawn(130, 301, 11, "noise", nasty=True)
    for camera in (Camera(), ORTHO):
        for auto in (False, True):
            scene = dict(CASES[name], edge_detector=detector, contrast_local=auto)
            want = strengths(layers, scene, STYLES, camera, threads=1, simd=1).tobytes()
            for threads, simd in ((2, 1), (3, 1), (8, 1), (1, 0), (3, 0)):
                assert strengths(layers, scene, STYLES, camera, threads=threads, simd=simd).tobytes() == want


def test_extreme_numbers_stay_finite():
    rng = np.random.default_rng(4)
    layers = drawn(30, 40, kind="drawn")
    for a in (layers["depth"], layers["normal"], layers["albedo"], layers["combined"], layers["diffuse"]):
        a[:] = (10.0 ** rng.uniform(-44, 38, a.shape)) * rng.choice([-1, 1], a.shape)
    layers["depth"] = np.abs(layers["depth"])
    for detector in ("DOG", "SOBEL"):
        for camera in (Camera(), Camera(orthographic=True, height=1e-37),
                       Camera(orthographic=True, height=3e38)):
            for weight in (1e-38, 1.0, 3e38):
                scene = {strength(source): weight for source in reference.SOURCES} | {"edge_detector": detector}
                got = strengths(layers, scene, camera=camera)
                assert np.isfinite(got).all() and (got >= 0).all()


def test_what_is_cut_to_stay_finite():
    layers = drawn(5, 9, painted=False)
    step = np.arange(9) >= 4
    layers["normal"][:] = np.where(step, 1e20, 0)[:, None]
    got = strengths(layers, {**NO_EDGES, "edge_detector": "SOBEL", "line_crease_strength": 1.0})
    assert got[2, 4] == pytest.approx(3 * 0.1 * 0.5 * 4 * 1e15)
    layers["depth"][:] = np.where(step, 1e-38, 1 / 0.98e15)  # nearer than the cut, just farther than it
    got = strengths(layers, {**NO_EDGES, "edge_detector": "SOBEL", "line_inner_strength": 1.0})
    assert got[2, 4] == pytest.approx(10 * 4 * 0.02, rel=1e-3)
    layers["depth"][:] = np.where(step, 5, 5.001)
    scene = {**NO_EDGES, "line_inner_strength": 1.0}
    unit, tiny = (strengths(layers, scene, camera=Camera(orthographic=True, height=h)).max() for h in (1, 1e-30))
    assert tiny == pytest.approx(unit / 60 * 1e28, rel=1e-5)


def test_far_must_lie_beyond_near():
    with pytest.raises(EncreError, match="depth_far: 2 is not beyond depth_near, 3; give a larger depth_far"):
        library.check(dict(depth_space="LINEAR", depth_near=3.0, depth_far=2.0))
    library.check(dict(depth_space="INVERSE", depth_near=3.0, depth_far=2.0))
