# SPDX-License-Identifier: GPL-3.0-or-later
"""`supersample`: the larger layers are those of a larger render, and what is saved is their mean."""

import numpy as np
import pytest
from encre.pen import metadata, supersample


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
