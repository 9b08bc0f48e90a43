# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers that Encre draws without Cycles: they are Cycles', and wherever they are asked for."""

import re

import exr
import numpy as np
import pytest
from encre.cli import main
from encre.cli.composite import composite
from encre.pen.layers import classic


@pytest.fixture(scope="module")
def shots(render):
    return render("layer_sources")


def partners(labels, others):
    """Share of the pixels at which both say the same, by whatever numbers."""
    found, counts = np.unique(np.stack([labels.ravel(), others.ravel()]), axis=1, return_counts=True)
    return sum(counts[found[0] == label].max() for label in np.unique(found[0])) / labels.size


def inside(labels):
    """Where a pixel and its neighbours show the same thing."""
    padded = np.pad(labels, 1, mode="edge")
    height, width = labels.shape
    return np.all([padded[y:y + height, x:x + width] == labels for y in range(3) for x in range(3)], 0)


def test_as_cycles_has_them(shots):
    ours, theirs = shots.passes("encre"), shots.passes("cycles")
    index, other = (p["Encre Index"][..., 0] for p in (ours, theirs))
    assert partners(index, other) > 0.9995 and partners(other, index) > 0.9995
    near, far = (np.minimum(p["Depth"][..., 0], 1e6) for p in (ours, theirs))
    assert (abs(near - far) > 2e-3 * far).mean() < 0.0005
    same = inside(index) & inside(other)  # elsewhere Cycles' colours and normals are means
    color = abs(ours["DiffCol"] - theirs["DiffCol"]).max(2)[same]
    assert color.mean() < 0.015 and np.percentile(color, 80) < 0.002  # Cycles averages across texels and checks
    grey = np.ptp(theirs["DiffCol"], axis=2)[same] == 0
    assert len(np.unique(theirs["DiffCol"][same][grey][:, 0].round(2))) > 30 and color[grey].mean() < 0.002  # the waves
    turned = np.einsum("yxc,yxc->yx", ours["Normal"], theirs["Normal"])[same & (far < 1e6)]
    assert (turned > 0.99).mean() > 0.98
    light = abs(ours["Encre Diffuse"] - theirs["Encre Diffuse"]).max(2)[same]
    assert light.mean() < 0.001
    picture = abs(ours["Encre Source"] - theirs["Encre Source"]).max(2)[same]
    assert picture.mean() < 0.02


@pytest.mark.parametrize("name", ["bare", "seen 1", "seen 0"])
def test_a_file_with_tones_draws_the_same_picture_again(render, tmp_path, name):
    shot = render("toned")
    assert not main.main(["composite", str(shot.folder / f"{name}.exr"), "-o", str(tmp_path / "again.exr")])
    picture, again = (exr.picture(path) for path in (shot.folder / f"{name}.exr", tmp_path / "again.exr"))
    assert picture[..., :3].std() > 0.1 and np.array_equal(picture, again)


def test_a_thing_has_the_random_number_that_cycles_gives_it(render):
    """By its name, or as an instance; for what is drawn by noise on copies too."""
    shot = render("named")
    ours, theirs = (shot.passes(name)["DiffCol"][8, [8, 24, 40, 56], 0] for name in ("encre", "cycles"))
    assert len(np.unique(theirs.round(2))) == 4
    np.testing.assert_allclose(ours, theirs, atol=1e-3)


def test_noise_has_the_colours_that_cycles_gives_it(render):
    shot = render("noise_in_colours")
    theirs, ours = (shot.passes(name) for name in ("CYCLES", "ENCRE"))
    index = ours["Encre Index"][..., 0]
    near = (index == index[-1, 80]) & inside(index) & (ours["Depth"][..., 0] < 8)
    color, wanted = (p["DiffCol"][near] for p in (ours, theirs))
    assert len(color) > 1000 and (np.ptp(wanted, 0) > 0.15).all()
    assert (abs(color - wanted).mean(0) < 0.02 * np.ptp(wanted, 0)).all()
    assert (abs(color[:, [1, 2, 0]] - wanted).mean(0) > 0.1 * np.ptp(wanted, 0)).all()


def test_the_same_again_and_in_parts(shots):
    whole, again, part = (shots.passes(name) for name in ("encre", "again", "border"))
    height, width = whole["Combined"].shape[:2]
    assert all((whole[name] == again[name]).all() for name in whole)
    top, left = height - int(np.float32(0.9) * np.float32(height)), int(np.float32(0.25) * np.float32(width))
    for name in ("Combined", "Encre Index", "Depth", "DiffCol"):
        own = part[name]
        there = whole[name][top:top + own.shape[0], left:left + own.shape[1]]
        np.testing.assert_allclose(own, there, atol=1e-5, err_msg=name)  # the matrices of a part round otherwise


def test_larger_and_averaged_down(shots):
    whole, large = shots.passes("encre"), shots.passes("large")
    assert abs(whole["Combined"] - large["Combined"]).mean() < 0.05
    steps = [(abs(np.diff(p["DiffCol"], axis=1)).max(2) > 0.3).mean() for p in (whole, large)]
    assert steps[1] < 0.9 * steps[0]  # edges have colours between


def test_nothing_behind(shots):
    alpha, depth = (shots.passes("transparent")[name] for name in ("Encre Source", "Depth"))
    assert ((alpha[..., 3] == 0) == (depth[..., 0] >= 1e9)).all() and (alpha[..., 3] == 0).any()


def test_a_thing_that_shows_no_hole_of_its_image_has_the_lines_of_its_mesh(render):
    """They were found in pixels, in steps, as soon as an image had holes anywhere: many files keep all in one image."""
    shot = render("atlas")
    cut, plain, open_ = (shot.passes(name) for name in ("cut", "plain", "open"))
    np.testing.assert_array_equal(cut["Encre Lines"], plain["Encre Lines"])
    gone = (open_["Depth"] > plain["Depth"] + 0.01)[..., 0]  # its inside is seen
    assert 0.02 < gone.mean() < 0.4 and (plain["Encre Lines"][..., 3] > 0.5).sum() > 100


def test_a_photograph_behind_things_is_flat_shapes_and_their_light_the_same(render):
    shot = render("photograph_behind")
    flat, whole = (shot.passes(name) for name in ("flat", "whole"))
    behind = flat["Depth"][..., 0] >= 1e9
    counts = (np.unique(p["Encre Source"][behind].round(3), axis=0, return_counts=True)[1] for p in (flat, whole))
    few, many = (np.sort(count)[-3:].sum() / behind.sum() for count in counts)  # what three colors cover
    assert behind.mean() > 0.1 and few > 0.9 > 0.5 > many
    np.testing.assert_array_equal(flat["Encre Source"][~behind], whole["Encre Source"][~behind])


def test_a_photograph_behind_what_cycles_renders_is_the_same_flat_shapes(render):
    """By how much of it each pixel shows. What surfaces show of the world is as it was; a film that the user has made
    transparent stays so, and beside a hole, whose pixels are transparent too, the photograph."""
    shot = render("photograph_behind")
    fast, flat, whole, part, film, hole = (shot.passes(name) for name in (
        "flat", "flat by Cycles", "whole by Cycles", "part by Cycles", "film", "hole"))
    source, shown = flat["Encre Source"], flat["Env"]
    behind = inside(flat["Depth"][..., 0] >= 1e9) & (flat["Depth"][..., 0] >= 1e9)
    assert behind.mean() > 0.1 and (source[..., 3] == 1).all()
    np.testing.assert_array_equal(source[behind], fast["Encre Source"][behind])
    np.testing.assert_array_equal(shown[behind], source[behind][:, :3])
    left = [p["Encre Source"][..., :3] - p["Env"] for p in (flat, whole)]
    np.testing.assert_allclose(*left, atol=1e-5)
    assert ((whole["Env"] > 0).any(2) == (shown > 0).any(2)).all() and 0.1 < (shown > 0).any(2).mean() < 0.9
    for name in "Depth", "Encre Index", "Encre Diffuse":
        np.testing.assert_array_equal(flat[name], whole[name])
    height, width = part["Depth"].shape[:2]
    np.testing.assert_array_equal(part["Encre Source"], source[:height, -width:])
    composite(str(shot.folder / "flat by Cycles.exr"), str(shot.folder / "again.exr"), {})
    np.testing.assert_allclose(shot.passes("again")["Combined"], flat["Combined"], atol=1e-5)
    assert film["Encre Source"][..., 3][behind].max() == 0
    for turn in map(shot.passes, ("turn_1", "turn_2")):
        np.testing.assert_array_equal(turn["Encre Source"][behind], source[behind])
    there = behind & (hole["Encre Source"][..., 3] == 1)
    np.testing.assert_array_equal(hole["Encre Source"][there], whole["Encre Source"][there])
    assert hole["Encre Source"][..., 3].min() == 0
    assert shot.output.count("the picture of the sky stays as it is because of the holdout Cube; choose Fast") == 1
    assert shot.facts["film"] == [[False, False]]


def test_flat_mirrors_show_what_stands_before_them(render):
    shot = render("flat_mirror")
    ours, theirs, glass = (shot.passes(name) for name in ("encre", "cycles", "glass"))
    index, differs = ours["Encre Index"][..., 0], (ours["Encre Source"] != glass["Encre Source"]).any(2)
    (number,) = np.unique(index[differs])
    mirror = (index == number) & inside(index)
    shown, wanted, sky = (p["Encre Source"][..., :3][mirror] for p in (ours, theirs, glass))
    assert mirror.mean() > 0.1 and wanted.std() > 0.1
    away = abs(shown - wanted).max(1)  # Cycles averages at the edges of what is seen
    assert away.mean() < 0.015 and (away > 0.05).mean() < 0.08
    assert sky.std() < 0.01
    assert not np.array_equal(ours["Encre Lines"][mirror], glass["Encre Lines"][mirror])  # what is seen is inked
    assert shot.output.count("materials that show more in Cycles: Silver (what is behind it);") == 1  # of glass alone


def measured(light, where):
    """(its sum, where its bright part is, how wide that is in pixels) of a highlight."""
    light = light.sum(2) * where
    bright = light > 0.5 * np.percentile(light[where], 99.8)
    share = light * bright / (light * bright).sum()
    middle = [(share * at).sum() for at in np.indices(share.shape)]
    return light.sum(), np.array(middle), 2 * np.sqrt(bright.sum() / np.pi)


def test_facets_are_lit_as_one_smooth_surface(render):
    flat, smoothed, smooth = (render("facets").passes(name)["Normal"] for name in ("flat", "smoothed", "smooth"))
    np.testing.assert_allclose(smoothed, smooth, atol=1e-5)
    assert (np.abs(smoothed - flat).max(-1) > 0.05).sum() > 1000


@pytest.mark.slow
def test_highlights_are_where_cycles_has_them_and_as_large_and_bright(render):
    shot = render("highlights")
    for kind in ("SUN", "POINT", "SPOT", "AREA"):
        theirs, ours = (shot.passes(f"{kind} {source}") for source in ("CYCLES", "ENCRE"))
        index = ours["Encre Index"][..., 0]
        found = np.unique(index[index > 0])
        assert len(found) == 9
        for number in found:
            (sum_, at, wide), (other, place, width) = (measured(p["GlossDir"] * p["GlossCol"], index == number)
                                                       for p in (ours, theirs))
            assert 0.86 < sum_ / other < 1.05 and np.hypot(*(at - place)) < 0.5, (kind, number)
            if number < 7 or not shot.facts["clearcoat"][0]:  # which had wider lobes than GGX
                assert abs(wide - width) < 0.05 * width + 0.5, (kind, number, wide, width)


@pytest.mark.slow
def test_normal_maps_turn_light_as_cycles_has_it(render):
    shot = render("normal_maps")
    theirs, ours, flat = (shot.passes(name) for name in ("cycles", "encre", "flat"))
    index = ours["Encre Index"][..., 0]
    np.testing.assert_array_equal(index, flat["Encre Index"][..., 0])
    np.testing.assert_array_equal(ours["Normal"], flat["Normal"])  # lines follow the mesh
    assert "Normal Map" not in shot.output
    for number in np.unique(index[index > 0]):
        where = (index == number) & inside(index)
        light, wanted, plain = (p["DiffDir"][..., 0][where] for p in (ours, theirs, flat))
        away = [abs(light - wanted).mean(), abs(plain - wanted).mean()]
        most = 0.4 if number == 1 else 0.7  # it shines without the map, which is not seen here
        assert away[0] < 0.05 and away[0] < most * away[1], (number, away)
    (count, sides, apart, same), = shot.facts["tangents"]  # of a mesh of which Blender knows them, too
    assert count > 2500 and sides == 2 and apart < 1e-3 and same


def test_colors_part_where_other_materials_read_more_of_meshes(render):
    """Where a picture's colors part is found by running its material alone."""
    shot = render("normal_maps")
    printed, bare = (shot.passes(name)["Combined"][..., :3].sum(2) for name in ("printed", "unprinted"))
    here = shot.passes("printed")["DiffCol"].std(2) > 0.02  # the print: all else is gray
    assert here.mean() > 0.02 and (printed < bare)[here].mean() > 0.005
    assert (printed[~here] == bare[~here]).mean() > 0.99



@pytest.mark.slow
def test_hair_is_where_cycles_has_it(render):
    shot = render("hair")
    theirs, ours, bald = (shot.passes(name) for name in ("cycles", "encre", "bald"))
    index, other, without = (p["Encre Index"][..., 0] for p in (ours, theirs, bald))
    assert min(partners(index, other), partners(other, index)) > 0.9995 and partners(without, other) < 0.9
    near, far = (np.minimum(p["Depth"][..., 0], 1e6) for p in (ours, theirs))
    assert (abs(near - far) > 2e-3 * far).mean() < 0.0005
    same = inside(index) & inside(other)
    red, wanted = (p["DiffCol"][same][:, 0] > 2 * p["DiffCol"][same][:, 1] for p in (ours, theirs))
    assert wanted.mean() > 0.1 and (red == wanted).mean() > 0.95
    ground = same & (index == index[-1, -1]) & (without == index[-1, -1])
    light, plain = (abs(p["DiffDir"] - theirs["DiffDir"]).max(2)[ground].mean() for p in (ours, bald))
    assert light < plain  # there is hair's shadow
    assert "not shown" not in shot.output
    (along,), (across,) = (shot.facts[name] for name in ("along", "across"))
    assert np.shape(along) == (6 * (2 * 4 + 2 * 2), 3) and np.min(along) == 0 and np.max(along) == 4
    np.testing.assert_allclose(across, 0.1209, atol=1e-4)


def test_what_only_cycles_can_show_is_said_in_one_line(render):
    shot = render("what_only_cycles_can_show")
    assert shot.output.count("materials that show more in Cycles: ") == 1
    for words in ("Red (Wavelength)", "Green (Image Texture: a sequence of images)", "Grey (Image Texture: a movie)"):
        assert words in shot.output
    assert "show its node Environment Texture: a sequence of images" in shot.output
    assert "a lamp shines from the camera" in shot.output
    passes = shot.passes("unknown")
    color = passes["DiffCol"].reshape(-1, 3)
    assert np.isclose(color, (0.2, 0.3, 0.4), atol=1e-5).all(1).any()
    assert passes["DiffDir"].max() > 0.5


def test_what_is_not_shown_is_said_in_a_line_a_kind(render):
    said = render("what_is_not_shown").output
    lost = "its displacement, its volume, Wavelength"
    assert said.count(f"materials that show more in Cycles: Red ({lost}); choose Full for Render to see them") == 1
    things = re.findall("not shown, as only Cycles can show it: (.*); choose Full for Render", said)
    assert things == ["Fog (a volume)"]
    assert said.count("drawn with the faces of their coarse mesh: Ball; switch off Adaptive Subdivision") == 1


@pytest.mark.slow
@pytest.mark.parametrize("count", [50, pytest.param(500, marks=pytest.mark.long)])
def test_renders_hold_no_more_and_more_memory(render, count):
    facts = render("many", **({"ENCRE_RENDERS": str(count)} if count > 50 else {})).facts
    (held,) = facts["held"]
    assert len(held) == count and held[-1] < 1.02 * held[count // 4]
    assert facts["resting"] == [0]  # what one frame keeps for the next goes with the last
    (readers,) = facts["readers"]  # passes that nobody reads are not made, but for what the user has switched on
    assert set(readers["nobody"]) == {"Combined", "Normal"}
    assert set(readers["lines"]) == {"Combined", "Normal", "Encre Lines"}
    for who in ("kept", "file", "nodes"):
        assert {"Depth", "IndexOB", "DiffCol"} <= set(map(classic, readers[who]))
