# SPDX-License-Identifier: GPL-3.0-or-later
"""Bumps, and where patterns lie on what modifiers deform, in layers that Encre draws without Cycles."""

import numpy as np
import pytest


def inside(labels):
    """Where a pixel and its neighbours show the same thing."""
    padded = np.pad(labels, 1, mode="edge")
    height, width = labels.shape
    return np.all([padded[y:y + height, x:x + width] == labels for y in range(3) for x in range(3)], 0)


@pytest.mark.slow
def test_bumps_turn_light_as_cycles_has_it(render):
    shot = render("bumps")
    theirs, ours, flat, long = (shot.passes(name) for name in ("cycles", "encre", "flat", "long"))
    index = ours["Encre Index"][..., 0]
    for name in ("Encre Index", "Normal", "Encre Lines"):  # lines follow the mesh
        np.testing.assert_array_equal(ours[name], flat[name])
    for number in np.unique(index[index > 0]):
        where = (index == number) & inside(index)
        light, wanted, plain, left = (p["DiffDir"][..., 0][where] for p in (ours, theirs, flat, long))
        away = [abs(light - wanted).mean(), abs(plain - wanted).mean()]
        assert away[0] < 0.06 and away[0] < 0.75 * away[1], (number, away)
        # What is too long is left out, and the thing is shown as it is without.
        np.testing.assert_array_equal(left, light if number < index.max() else plain)
    assert shot.output.count("materials that show more in Cycles: Cells (") == 1


def test_generated_coordinates_are_of_what_no_modifier_has_deformed(render):
    theirs, ours = (render("generated").passes(name) for name in ("CYCLES", "ENCRE"))
    index = ours["Encre Index"][..., 0]
    where = (index == 1) & inside(index)
    color, wanted = (p["DiffCol"][where][:, 0] for p in (ours, theirs))
    assert len(color) > 200 and abs(color - wanted).mean() < 0.02 < 0.1 < np.ptp(wanted)
