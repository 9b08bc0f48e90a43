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


def test_pieces_of_a_mesh_have_a_line_where_they_pass_through_each_other(blender, tmp_path):
    """At 8 degrees, where the normals show no crease, and as whole as between parts."""
    shot = blenders.run(blender, "pieces", tmp_path)
    pieces, parts = shot.passes("pieces"), shot.passes("parts")
    meet = (pieces["Encre Creases"][..., 1::2] == 180).any(2)
    assert 100 < meet.sum() < 600
    assert (ink(pieces)[meet] > 0.05).mean() > 0.95
    missing = (ink(parts) > 0.3) & ~(ink(pieces) > 0.05)
    assert missing.sum() < 30
