# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that are unfinished or larger than usual, and things that are nowhere, take no frame away where Encre draws
layers without Cycles."""

import numpy as np
import pytest


def inside(labels):
    """Where a pixel and its neighbours show the same thing."""
    padded = np.pad(labels, 1, mode="edge")
    height, width = labels.shape
    return np.all([padded[y:y + height, x:x + width] == labels for y in range(3) for x in range(3)], 0)


@pytest.mark.parametrize(("case", "name", "number"), [("no_map", "none", 2), ("no_map", "other", 2),
                                                    ("rings", "rings", 3)])
def test_a_missing_map_and_links_in_a_ring_are_what_cycles_takes_them_for(render, case, name, number):
    shot = render(case)
    assert set(shot.facts["failed"]) == {None} and "as only Cycles can show them" not in shot.output
    theirs, ours = (shot.passes(f"{name} {source}") for source in ("CYCLES", "ENCRE"))
    index = ours["Encre Index"][..., 0]
    where = (index > 0) & inside(index)
    where &= index != number  # which is there for other reasons
    assert len(np.unique(index[where])) == 2
    color = theirs["DiffCol"]
    if case == "rings" and not theirs["Combined"][..., :3].any():  # Cycles of Blender 5: nothing, and no error
        color = np.where(index == 1, 1.5, 0.5)[..., None]  # as all Cycles before
    apart = abs(ours["DiffCol"] - color)[where].max(1)
    assert np.mean(apart > 2e-3) < 0.002  # at the border Cycles' pixels are means


def test_rows_of_nodes_without_end_are_left_out(render):
    shot = render("long_rows")
    assert shot.facts["failed"] == [None]
    ours = shot.passes("long")
    index = ours["Encre Index"][..., 0]
    for number, color in ((1, (0.25, 0.5, 0.75)), (2, (0.5, 0.25, 0.125))):
        where = (index == number) & inside(index)
        np.testing.assert_allclose(ours["DiffCol"][where], np.tile(color, (where.sum(), 1)), atol=1e-5)
    words = "more nodes than there is room for"
    assert f"in their viewport color, as only Cycles can show them: Red ({words}), Grey ({words})" in shot.output
    assert f"materials that show more in Cycles: Green ({words});" in shot.output


def test_what_is_nowhere_changes_nothing(render):
    shot = render("nowhere")
    assert shot.facts["failed"] == [None] * 3 and "Warning" not in shot.output
    before, scale = (shot.passes(name)["Combined"] for name in ("without", "scale"))
    np.testing.assert_array_equal(before, scale)


def test_what_is_held_out_is_a_hole_without_lines_of_its_own(render):
    shot = render("holes")
    assert shot.facts["failed"] == [None] * 2
    theirs, ours = (shot.passes(f"holes {source}") for source in ("CYCLES", "ENCRE"))
    clear = [passes["Combined"][..., 3] < 0.5 for passes in (theirs, ours)]
    assert clear[1].mean() > 0.05 and (clear[0] != clear[1]).mean() < 0.01
    assert not ours["Encre Index"][..., 0][clear[1]].any()
    quarter = [np.abs(passes["Combined"][..., 3] - 0.75) < 1e-3 for passes in (theirs, ours)]  # of a box is a hole
    # Cycles has pixels as clear along the rims of what is held out, too
    assert quarter[1].sum() > 25 and (quarter[0] & quarter[1]).sum() > 0.8 * quarter[1].sum()
    inks = [passes["Encre Lines"][..., 3] > 0.5 for passes in (theirs, ours)]
    assert (inks[0] != inks[1]).mean() < 0.02 and inks[1].any()
