# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders, kinds of objects and worlds, one by one: Encre's own layers and light are Cycles'."""

import numpy as np
import pytest


def inside(index):
    """{number of a thing: where it and all neighbours of a pixel are}, of the frame's numbers."""
    padded = np.pad(index, 1)
    near = [padded[y:y + index.shape[0], x:x + index.shape[1]] for y in range(3) for x in range(3)]
    return {number: np.all([shown == number for shown in near], 0) for number in np.unique(index[index > 0])}


def test_shaders_have_the_colours_and_light_that_cycles_gives_them(render):
    shot = render("shaders")
    ours, theirs = shot.passes("encre"), shot.passes("cycles")
    (names,) = shot.facts["names"]
    places = inside(ours["Encre Index"][..., 0])
    assert len(places) == len(names) and "not shown" not in shot.output and "viewport color" not in shot.output
    by_column = sorted(places.values(), key=lambda where: np.nonzero(where)[1].mean())
    for name, where in zip(names, by_column, strict=True):
        for layer in ("DiffCol", "Emit", "Encre Source"):
            away = abs(ours[layer] - theirs[layer])[where]
            assert where.sum() > 50 and away.mean() < 0.005 and away.max() < 0.05, (name, layer)
        assert theirs["Encre Source"][where].max() > 0.1


def test_things_of_all_kinds_are_where_cycles_has_them(render):
    shot = render("kinds_of_things")
    ours, theirs = shot.passes("encre"), shot.passes("cycles")
    index = ours["Encre Index"][..., 0]
    assert len(np.unique(index[index > 0])) == 6
    near, far = (p["Depth"][..., 0] < 1e6 for p in (ours, theirs))
    assert 0.1 < near.mean() < 0.9 and (near != far).mean() < 0.0005
    for number, where in inside(index).items():
        away = abs(ours["DiffCol"] - theirs["DiffCol"])[where]
        assert where.sum() > 50 and away.max() < 0.002, number
        turned = np.einsum("kc,kc->k", ours["Normal"][where], theirs["Normal"][where])
        assert (turned > 0.98).mean() > 0.85, number  # Cycles averages at folds


@pytest.mark.slow
@pytest.mark.parametrize("name", ["color", "picture", "share"])
def test_a_world_lights_things_as_cycles_has_it(render, name):
    """What nothing stands before: only so is Cycles' light without the shadows that light from all sides throws."""
    passes = render("worlds").passes(name)
    where = next(iter(inside(passes["IndexOB"][..., 0]).values()))
    drawn, rendered = passes["Encre Diffuse"][where], passes["DiffDir"][where]
    assert where.sum() > 400 and abs(drawn - rendered).mean() < 0.02 * rendered.max()
    assert (np.ptp(rendered, 0) > 0.1).all() or name == "color"
    assert abs(drawn.mean(0) / rendered.mean(0) - 1).max() < 0.02
