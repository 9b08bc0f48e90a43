# SPDX-License-Identifier: GPL-3.0-or-later
"""The sites of FINE as they are found, each family against its twin: where, of what, how strong, whose controls."""

import functools
from collections import Counter

import kept
import numpy as np
import passes
import pytest
import shapes
from encre.pen import library
from encre.pen.job import Camera
from reference import ridged
from reference.frame import Layers
from reference.params import Params
from reference.passes import FAMILIES
from reference.view import SURE, View

CONTROLS = len(library.controls())

GRID = 0.5 / 4096  # pixels: half a step of that on which places lie
OFF = dict(x=2 * GRID + 2e-5, y=2 * GRID + 2e-5, strength=5e-5, thin=1e-4, half=5e-5, inside=GRID + 5e-5)
LEAST = dict(crack=4000, thin=50, normal_band=150, normal=800, color_band=300, color=1000,
             valley=1300, light_band=40, light_step=250, light=900, seen_normal_band=25, seen_normal=200,
             seen_color_band=20, seen_color=140, seen_depth=80)  # compared over all cases


def found_by_c(c):
    """{(family, row, column, axis): site}; what later passes drop is there still."""
    return {(FAMILIES[s["family"]], int(s["row"]), int(s["column"]), int(s["axis"])): s for s in c.named("gather").site}


@functools.cache
def compare(name):
    """Counts by family of what was compared and of what rounding may decide, and a list of what is wrong."""
    return kept.of(_compare, name, by=passes.said(name))


def _compare(name):
    c = passes.case(name)
    view, (want, more) = c.view, passes.wanted(name)
    got, sure, open_, wrong = found_by_c(c), Counter(), Counter(), []
    for key in sorted(set(got) | set(want)):
        family, row, column, axis = key
        s, site = got.get(key), want.get(key)
        if s is None and site.margin < -SURE:
            continue
        if site is not None and (abs(site.margin) < SURE or site.doubtful):
            open_[family] += 1
            continue
        if (s is None) != (site is None or site.margin < 0):
            wrong.append((key, "missing" if s is None else "extra"))
        if s is None or site is None:
            continue
        sure[family] += 1
        wanted = dict(zip(OFF, (site.x, site.y, site.strength, *site.thin), strict=True))
        wrong += [(key, name, float(s[name]), value) for name, value in wanted.items()
                  if abs(s[name] - value) > OFF[name] * site.loose * max(1, abs(value))]
        near = view.near(float(s["x"]), float(s["y"]), column, row, family, axis)
        if s["source"] != site.source:
            wrong.append((key, "source", s["source"], site.source))
        if np.abs(s["step"] - site.step).max() > 1:
            wrong.append((key, "step", s["step"], site.step))
        tells = family in ("color_band", "color", "valley")
        if tells and s["weak"] != site.weak:
            wrong.append((key, "weak", s["weak"]))
        if abs(s["eased"] - site.eased) > 0.5 + 0.01 * site.loose:
            wrong.append((key, "eased", s["eased"], site.eased))
        if (s["near_y"], s["near_x"]) != near:
            wrong.append((key, "near", s["near_y"], s["near_x"], near))
    if more["through"] is not None:
        mirror = c.named("see through").through > 0
        wrong += [("through", *p) for p in np.argwhere((mirror != more["through"]) & ~more["through_unsure"])]
    return sure, open_, wrong


ALL = [*passes.TINY, *passes.CASES, *passes.WIRES, *passes.LIGHTS, *passes.SWEEPS, *passes.CUTS, *passes.ROWS,
       *passes.FORMS]


@pytest.mark.parametrize("name", ALL)
def test_sites_are_where_the_reference_finds_them(name):
    sure, open_, wrong = compare(name)
    assert wrong == []
    most = 0.25 if name in passes.CASES else 0.4  # wires may lie evenly between pixels
    assert name not in (*passes.CASES, *passes.WIRES) or sum(open_.values()) < most * sum(sure.values())
    assert open_["valley"] <= 0.1 * sure["valley"]


def test_every_family_is_compared():
    found, open_ = (sum((compare(name)[k] for name in ALL), Counter()) for k in (0, 1))
    assert open_.total() < 0.1 * found.total()
    assert {name: (found[name], least) for name, least in LEAST.items() if found[name] < least} == {}


@pytest.mark.parametrize("name", ["faces", "mirror", "tiny 3"])
def test_the_strongest_site_of_a_pixel_is_shown(name):
    layers, scene, view = passes.given(name)
    images, every = passes.run(layers, scene, (), passes.CASES.get(name, passes.TINY.get(name))[3], ["Encre Edges"])
    wanted = np.zeros(view.shape, np.float32)
    for s in every[-1].site[~(every[-1].site["dropped"] > 0)]:
        at = tuple(np.clip(np.floor((s["y"] + 0.5, s["x"] + 0.5)).astype(int), 0, np.array(view.shape) - 1))
        wanted[at] = max(wanted[at], s["strength"])
    assert wanted.max() > 0
    assert np.array_equal(images["Encre Edges"][..., 0], wanted)


@pytest.mark.parametrize("name", ["faces", "mirror", "dim mirror", "rods"])
def test_the_unit_of_length_does_not_matter(name):
    """Where all is 64 times as near there are the same sites, to the bit."""
    layers, scene, _ = passes.given(name)
    styles, camera = passes.EVERY[name][2:]
    near = {layer: np.where((a > 0) & (a < 1e9), a / np.float32(64), a) if "depth" in layer else a
            for layer, a in layers.items()}
    nearer = camera and Camera(orthographic=True, height=camera.height / 64)
    far, close = (passes.run(given, scene, styles, lens)[1][-1].site
                  for given, lens in ((layers, camera), (near, nearer)))
    assert len(far) > 20 and [name for name in far.dtype.names if not np.array_equal(far[name], close[name])] == []


def test_forms_are_blurred_by_no_more_than_64_pixels():
    layers = shapes.forms(861, (8, 260), steep=4.0, bumps=1)
    found = []
    for scale, finer in ((64, 1), (33, 2), (62, 1)):
        scene = {**passes.ALL, **passes.FORM, "suggestive_size": scale, "supersample": finer, "edge_threshold": 0.0}
        site = next(s for s in passes.run(layers, scene)[1] if s.name == "gather").site
        found.append(site[site["family"] == FAMILIES.index("valley")])
    assert len(found[0]) > 10
    assert np.array_equal(found[0], found[1]) and not np.array_equal(found[0]["x"], found[2]["x"])


@functools.cache
def sites_moved_to(moved, turn=1, width=60):
    """Sites of a small picture in a wider one; a wire in one column of centres, a spot, a blade
    that rises from the wall; in a narrower one without that. turn: which way the wire leans."""
    rows, columns = np.mgrid[:44, :width].astype(float)
    columns -= moved
    off = columns - 9 - turn * rows / 50
    fine = (np.arange(16) + 0.5) / 16 - 0.5
    share = np.mean([np.abs(off + k) < 0.21 for k in fine], 0)[..., None] * (rows < 36)[..., None]
    hit = (np.abs(off) < 0.21) & (rows < 36)
    spot = ((rows == 40) & (np.abs(columns - 9) < 2))[..., None]
    ones = np.ones((*rows.shape, 3))
    layers = dict(combined=np.ones((*rows.shape, 4)), color=0.5 * ones - 0.4 * share + 0.3 * spot, diffuse=ones,
                  depth=np.where(hit, 4.0, 5.0), object=hit * 1.0, normal=ones * (0, 0, 1) - share * (0, 0.6, 0.2))
    if width == 60:
        layers["depth"][42] -= 0.004 * np.clip(columns[42] - 16, 0, 15) * (columns[42] < 34)
    _, every = passes.run({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, passes.ALL)
    return every[-1].site


@pytest.mark.parametrize("moved", range(1, 20))
def test_where_a_picture_lies_in_a_frame_does_not_matter(moved):
    """What has nothing to see is passed over many pixels at once, and pictures begin anywhere after it."""
    turn = (1, -1)[moved % 2]
    first, site = sites_moved_to(0, turn), sites_moved_to(moved, turn).copy()
    assert {"crack", "thin", "color_band"} <= {FAMILIES[k] for k in first["family"]}
    for name in ("column", "near_x"):
        site[name] -= moved
    assert [s["x"] - moved for s in site] == pytest.approx(list(first["x"]), abs=1e-4)
    for name in ("family", "row", "column", "axis", "near_x", "near_y", "dropped"):
        assert np.array_equal(site[name], first[name]), name
    assert site["strength"] == pytest.approx(first["strength"], abs=1e-4)


@pytest.mark.parametrize("turn", [-1, 1])
@pytest.mark.parametrize("moved", range(5, 9))
def test_where_a_picture_ends_does_not_matter(turn, moved):
    """Spans of pixels in which a wire covers a centre begin and end here and there, and are cut off."""
    first, site = sites_moved_to(4, turn, 17).copy(), sites_moved_to(moved, turn, moved + 13)
    assert (first["family"] == FAMILIES.index("thin")).sum() > 3
    first["column"] += moved - 4
    for name in ("family", "row", "column", "axis", "dropped"):
        assert np.array_equal(site[name], first[name]), name


@pytest.mark.parametrize("ortho", [False, True])
def test_where_the_eye_passes_through(ortho):
    """Spots that show, by a little more or less than what tells a mirror, another normal, colour or depth."""
    rng = np.random.default_rng(ortho)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    told = dict(view=turn.ravel(), orthographic=ortho, height=3.0)
    shape, eye = (96, 144), Camera(**told)
    layers = dict(combined=np.ones((*shape, 4)), color=rng.uniform(0.2, 0.7, (*shape, 3)), diffuse=np.ones((*shape, 3)),
                  depth=np.full((*shape, 1), 4.0), normal=np.tile([0.0, 0, 0.8], (*shape, 1)) @ turn)
    seen = [layers["normal"] @ turn.T, layers["color"].copy(), layers["depth"].copy()]
    for k, (y, x) in enumerate(np.ndindex(8, 12)):
        spot = np.s_[12 * y + 4:12 * y + 7, 12 * x + 4:12 * x + 7]
        near = rng.uniform(0.83, 1.17, 3)
        if k % 3 == 0:  # another normal
            seen[0][spot] += 0.1 * near[0] * np.array([0.6, 0.8, 0])
        elif k % 3 == 1:  # a shorter one, and another colour
            seen[0][spot] *= 1 - 0.125 * near[0]
            seen[0][spot] += 0.1 * near[1] * np.array([1, 0, 0])
            seen[1][spot] += 0.1 * near[2] * np.array([0, 0.6, -0.8])
        else:
            seen[2][spot] += 0.02 * near[0] * (3 if ortho else 4) * rng.choice([-1, 1])
            if k % 2:  # a row of it, or a column, shows nothing
                seen[2][spot][np.s_[1] if k % 4 == 1 else np.s_[:, 1]] = 4
            seen[0][spot] *= rng.choice([1, 0.8])
    layers.update(zip(("seen_normal", "seen_color", "seen_depth"), seen, strict=True))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    _, every = passes.run(layers, passes.ALL, camera=eye)
    found = next(s for s in every if s.name == "see through").through > 0
    view = View(Layers(layers, 0, told, None), Params(passes.ALL, ()), layers)
    wanted, unsure = ridged.through(view)
    assert 0.05 < found.mean() < 0.5 and unsure.mean() < 0.05
    assert np.array_equal(found | unsure, wanted | unsure)


@pytest.mark.parametrize("ortho", [False, True])
@pytest.mark.parametrize("apart", [0.018, 0.022])
def test_where_two_things_touch_the_line_belongs_to_the_one_painted_more(apart, ortho):
    """They touch within 2 % of the depth, or of the height that an orthographic camera sees."""
    eye = Camera(orthographic=ortho, height=3.0)
    right = np.tile(np.arange(24) >= 12, (20, 1))[..., None]
    layers = dict(combined=np.ones((20, 24, 4)), color=np.ones((20, 24, 3)), diffuse=np.ones((20, 24, 3)),
                  object=1.0 + right, normal=np.tile([0.0, 0, 1], (20, 24, 1)),
                  depth=4 + apart * (3 if ortho else 4) * right, controls=right * (np.arange(CONTROLS) == 0))
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    _, every = passes.run(layers, passes.ALL, camera=eye)
    sites = every[-1].site
    assert len(sites) > 15 and (sites["column"] == 11).all()
    # Of the object that it bounds the nearest pixel, then the one beside the line.
    assert (sites["near_x"] >= 12).all() if apart < 0.02 else (sites["near_x"] <= 11).all()


def test_the_foot_of_what_has_a_style_is_its_own_whichever_pixel_is_nearer():
    right = np.tile(np.arange(24) >= 12, (20, 1))[..., None]
    nearer = np.where((np.arange(20) % 3 == 0)[:, None, None], -0.01, 0.01) * right  # as faces that coincide are
    layers = dict(combined=np.ones((20, 24, 4)), color=np.ones((20, 24, 3)), diffuse=np.ones((20, 24, 3)),
                  object=1.0 + right, style=1.0 * right, normal=np.tile([0.0, 0, 1], (20, 24, 1)), depth=4 + nearer)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    for styled in right, ~right:
        layers["style"] = np.ascontiguousarray(styled, np.float32)
        sites = passes.run(layers, passes.ALL, [{"ink_color": (1, 0, 0)}], camera=Camera())[1][-1].site
        sites = sites[sites["column"] == 11]  # others part what is nearer of one thing from what is farther
        assert len(sites) > 15 and styled[sites["near_y"], sites["near_x"], 0].all()


def test_what_a_mirror_shows_takes_the_controls_of_its_own_pixel_however_near_it_is():
    layers, scene, _ = passes.given("mirror")
    layers = {name: a * np.float32(0.01) if name.endswith("depth") else a for name, a in layers.items()}
    assert layers["depth"].min() < 0.1
    _, every = passes.run(layers, scene, passes.CASES["mirror"][2], passes.CASES["mirror"][3])
    sites = next(s for s in every if s.name == "gather").site
    sites = sites[[FAMILIES[k].startswith("seen") for k in sites["family"]]]
    height, width = layers["depth"].shape[:2]
    assert len(sites) > 50
    assert np.array_equal(sites["near_x"], np.clip(np.floor(sites["x"] + 0.5), 0, width - 1))
    assert np.array_equal(sites["near_y"], np.clip(np.floor(sites["y"] + 0.5), 0, height - 1))
