# SPDX-License-Identifier: GPL-3.0-or-later
"""`supersample`: the larger layers are those of a larger render, and what is saved is their mean."""

import numpy as np
import pytest
from encre.cli import multilayer
from encre.cli.composite import composite
from encre.pen import library, metadata, supersample


@pytest.mark.slow
def test_layers_are_those_of_a_larger_render(render):
    facts = render("larger").facts
    assert len(facts) >= 10
    for name, ((size, other_index, depth, combined),) in facts.items():
        assert size and other_index == 0 and depth < 1e-4, (name, facts[name])
        assert name != "edges" or combined < 0.02, facts[name]


def test_what_is_saved(render):
    shot = render("supersampled")
    for layer in ("ViewLayer", "Second"):
        one, two = shot.passes("one", layer), shot.passes("two", layer)
        assert one.keys() == two.keys()
        for name in one:
            assert one[name].shape == two[name].shape, name
        for name in ("Combined", "DiffCol", "Encre Surface", "Encre Lines"):
            assert 1e-4 < np.abs(one[name] - two[name]).mean() < 0.05, name
        lines, surface = two["Encre Lines"], two["Encre Surface"]
        assert np.abs(two["Combined"] - two["Encre Source"]).max() > 0.1
        assert lines[..., 3].max() > 0.9 and surface.max() > 0.1
        assert len(np.unique(two["Encre Index"][..., 0])) == 4
        near = one["Depth"] < 100
        assert np.percentile(np.abs(one["Depth"] - two["Depth"])[near], 90) < 0.2
    assert set(np.unique(shot.passes("two")["IndexOB"])) == {0, 7}
    assert 1e-5 < np.abs(shot.passes("one")["Mist"] - shot.passes("two")["Mist"]).mean() < 0.02
    frame = metadata.read(shot.metadata("two")).frame
    assert (frame.width, frame.height) == (160, 90)


def test_border(render):
    shot = render("supersampled")
    full, crop, border = (shot.passes(name)["Combined"] for name in ("full", "crop", "border"))
    frame = metadata.read(shot.metadata("crop")).frame
    assert (frame.width, frame.height) == (160, 90) and frame.x == 17
    height, width = crop.shape[:2]
    inner = np.s_[24:height - 24, 32:width - 32]
    same = full[frame.y:frame.y + height, frame.x:frame.x + width][inner]
    assert same.size > 5000 and same.std() > 0.05
    assert np.abs(crop[inner] - same).max() < 1e-5
    assert np.array_equal(border[frame.y:frame.y + height, frame.x:frame.x + width], crop)


def test_the_next_render_is_as_ever(render):
    shot = render("supersampled")
    full = shot.passes("full")["Combined"]
    for k in (1, 2):
        assert np.array_equal(full, shot.passes(f"frame-{k:04}")["Combined"]), "the scene does not move"
    assert shot.passes("off")["Combined"].tobytes() == shot.passes("cycles")["Combined"].tobytes()
    assert shot.facts["persistent"] == [False]
    assert "supersample" in shot.facts["keyed"][0] and "Traceback" not in shot.output
    assert shot.wrote("keyed-0001") and not shot.wrote("keyed-0002")
    assert shot.facts["error"] == [None]
    assert list(shot.folder.glob("stereo*.exr"))


@pytest.mark.slow
def test_lines_keep_their_width(render):
    facts = render("supersampled_widths").facts
    for unit in ("PIXELS", "RELATIVE"):
        one, *others = facts[unit]
        perimeter = 4 * 160 / 3.01
        assert abs(one / perimeter - 4) < 0.25
        assert max(abs(other / one - 1) for other in others) < 0.03, facts


def test_cancelled(render):
    shot = render("supersampled_cancelled")
    assert shot.facts["subframes"] == [2] and shot.facts["persistent"] == [False]
    assert "Traceback" not in shot.output
    made, freed = shot.facts["sessions"][0]
    assert made == freed == 2
    assert shot.wrote("again")


def test_shrink():
    picture = np.arange(48, dtype=np.float32).reshape(4, 6, 2)
    mean = supersample.shrink("Combined", picture, 2)
    assert np.array_equal(mean, picture.reshape(2, 2, 3, 2, 2).mean((1, 3)))
    for name in ("Depth", "Object Index", "CryptoObject00", "Encre Index"):
        assert np.array_equal(supersample.shrink(name, picture, 2), picture[1::2, 1::2]), name
    assert supersample.shrink("Normal", picture[:3, :3], 3).shape == (1, 1, 2)


def test_marks_keep_their_place():
    marks = np.zeros((6, 9, 3), np.float32)
    marks[1, 2, 0] = 0.5      # from the middle of one group to that of the next: the second third of the way
    marks[4, 1, 0] = -0.25    # a seam before a line
    marks[4, 3, 0] = 0.75
    marks[3, 7, 1] = -1
    marks[1, 5, 0] = -6.25    # a seam three steps before what is behind it
    marks[0, 0, 0] = marks[2, 2, 1] = 0.5  # not on a way between the middles
    marks[1, 8, 0] = 0.5      # beyond the last
    small = supersample.shrink("Encre Marks", marks, 3)
    wanted = np.zeros((2, 3, 3), np.float32)
    wanted[0, 0, 0], wanted[1, 0, 0], wanted[0, 2, 1], wanted[0, 2, 0] = 1.5 / 3, 2.75 / 3, -1, 1.5 / 3
    wanted[0, 1, 0] = -(1.25 / 3 + 6)
    assert np.allclose(small, wanted)


def test_of_marks_on_one_way_the_first_line_is_kept_then_the_first_seam():
    rng = np.random.default_rng(1)
    marks = np.zeros((8, 12, 3), np.float32)
    marks[..., :2] = rng.choice([0, 0.25, 0.5, -0.25, -1], marks[..., :2].shape)
    small = supersample.shrink("Encre Marks", marks, 4)
    for axis in (0, 1):
        for row, column in np.ndindex(*small.shape[:2]):
            y, x = 4 * row + 2, 4 * column + 2
            way = [marks[y + k * axis, x + k * (1 - axis), axis] for k in range(4)
                   if y + k * axis < 8 and x + k * (1 - axis) < 12]
            found = [(part < 0, k, part) for k, part in enumerate(way) if part]
            seam, k, part = min(found, default=(False, 0, 0))
            assert small[row, column, axis] == (k + abs(part)) / 4 * (-1 if seam else 1) if found else 0


def test_every_sub_frame_has_noise_of_its_own(render):
    """With one seed for all, the mean of four would be as noisy as each."""
    shot = render("noise")
    noise = {name: np.diff(shot.passes(name)["DiffDir"][2:-2, 2:-2, 0], axis=1).std() for name in ("one", "two")}
    assert 0.01 < noise["two"] < 1.8 * noise["one"]


def test_pixels_are_of_the_frame():
    """With lengths in pixels the library multiplies them; relative ones follow the frame's height by themselves."""
    rng = np.random.default_rng(0)
    combined = rng.random((40, 60, 4), np.float32)
    pictures = {"combined": combined, "color": combined[..., :3], "diffuse": combined[..., :3],
                "depth": np.where(np.arange(60) < 30, 1, 5).astype(np.float32) + np.zeros((40, 1), np.float32),
                "normal": np.zeros((40, 60, 3), np.float32)}

    def ink(**values):
        settings = {"use_shading": False, **values}
        return library.render(pictures, settings, outputs=("Encre Lines",)).images["Encre Lines"]

    assert np.array_equal(ink(length_unit="PIXELS", line_thickness=4, paper_scale=2),
                          ink(length_unit="PIXELS", line_thickness=2, paper_scale=1, supersample=2, smudge_range=5,
                              smudge_pick=3.5, line_thickest=64))
    assert np.array_equal(ink(line_thickness=100), ink(line_thickness=100, supersample=4))


def test_composite_draws_at_the_frames_size(render):
    shot, said = render("supersampled"), []
    composite(str(shot.folder / "two.exr"), str(shot.folder / "again.exr"), {}, "ViewLayer",
              say=lambda *words: said.append(words))
    assert len(said) == 1 and said[0][0] == "note" and "supersample" in said[0][1]
    again = shot.passes("again")["Combined"]
    one = shot.passes("one")["Combined"]
    assert again.shape == one.shape and np.abs(again - one).mean() < 0.05
    with multilayer.Exr(str(shot.folder / "again.exr")) as file:
        assert any(name.endswith("Encre Lines.A") for name in file.channels)
