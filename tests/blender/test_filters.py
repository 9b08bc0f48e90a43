# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers that Encre draws without Cycles leave out and replace what the view layer says, as Cycles' do."""

import numpy as np


def inside(labels):
    """Where a pixel and its neighbours show the same thing."""
    padded = np.pad(labels, 1, mode="edge")
    height, width = labels.shape
    return np.all([padded[y:y + height, x:x + width] == labels for y in range(3) for x in range(3)], 0)


def both(render, case, name):
    """(passes by Cycles, by Encre, where both show the inner of the same thing or the same of nothing)."""
    shot = render(case)
    assert set(shot.facts["failed"]) == {None}
    theirs, ours = (shot.passes(f"{name} {source}") for source in ("CYCLES", "ENCRE"))
    index = ours["Encre Index"][..., 0]
    return theirs, ours, inside(index) & inside(theirs["Depth"][..., 0] < 1e9)


def test_a_material_for_all_is_on_all_surfaces_as_in_cycles(render):
    theirs, ours, where = both(render, "overridden", "clay")
    own = both(render, "overridden", "own")[1]
    there = where & (ours["Encre Index"][..., 0] > 0)
    assert there.mean() > 0.5
    np.testing.assert_allclose(ours["DiffCol"][there], theirs["DiffCol"][there], atol=2e-3)
    kinds = [len(np.unique(passes["DiffCol"][there].round(3), axis=0)) for passes in (ours, own)]
    assert kinds[0] == 1 and kinds[1] > 4
    assert abs(ours["Encre Diffuse"] - theirs["Encre Diffuse"])[there].mean() < 2e-3  # its light, with whole shadows
    assert (own["Encre Index"][..., 0] != ours["Encre Index"][..., 0]).any()  # the card is whole
    assert all((passes["Encre Index"][there][:, 2] == 1).all() for passes in (theirs, ours))  # has its style
