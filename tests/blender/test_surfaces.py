# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines where surfaces coincide, let through or pass through each other."""

import blenders
import pytest


@pytest.fixture(params=blenders.params(), scope="module")
def blender(request):
    return request.param


def ink(passes):
    return passes["Encre Lines"][..., 3]


def test_of_two_faces_in_one_plane_the_earlier_is_drawn(blender, tmp_path):
    """As if the other lay a little behind it, and not a blot: Cycles takes now one, now the other."""
    shot = blenders.run(blender, "coincident", tmp_path)
    both, behind = shot.passes("both"), shot.passes("behind")
    assert (both["Encre Index"] != behind["Encre Index"]).any(2).sum() < 40
    assert 0.8 < ink(both).sum() / ink(behind).sum() < 1.05
