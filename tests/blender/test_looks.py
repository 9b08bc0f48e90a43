# SPDX-License-Identifier: GPL-3.0-or-later
"""Two looks of one moment, and the camera of the study (blender/inside/looked.py)."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def facts(render):
    return {name: values[0] for name, values in render("two_looks").facts.items()}


def test_what_is_drawn_once_for_two_looks_is_as_if_each_were_drawn_alone(facts):
    assert all(facts["shared"].values()) and {"combined", "diffuse", "highlights"} <= facts["shared"].keys()
    assert facts["shines"]


def test_lines_are_in_the_textures_of_one_and_in_the_frame_of_the_other(facts):
    assert facts["lined"] > 0.01 and facts["looks differ"] > 0.003
    assert facts["colours in the frame"] == [1.0, 0.0]


def test_the_free_camera_is_kept_by_walls_and_within_the_room(render):
    facts = {name: values[0] for name, values in render("walks").facts.items()}
    assert "does not move from frame" in facts["still"]
    start, end, seconds = facts["way"]
    assert np.allclose([start, end], [(-1, -1, 1), (-1, 1, 1.5)], atol=1e-5) and seconds == 1.0
    low, high, radius = facts["room"]
    assert np.allclose(low, (-2 + radius, -2 + radius, radius), atol=1e-4)
    assert np.allclose(high, (2 - radius, 1, 2.4 - radius), atol=1e-4)  # to the last stop where there is no wall
    lowest, highest, nearest = facts["walked"]
    assert (np.array(lowest) >= np.array(low) - 1e-5).all() and (np.array(highest) <= np.array(high) + 1e-5).all()
    assert nearest > 0.9 * radius and max(np.array(highest) - lowest) > 1


def test_books_of_one_mesh_have_lines_between_them(render):
    """Side by side they were one box in looks of ink alone."""
    shot = render("books")
    for name in "ink_only", "brush_ink":
        assert shot.facts[name] == [None]
        row = shot.passes(name)["Combined"][45, :, :3].mean(1) < 0.95
        starts = np.flatnonzero(row[1:] & ~row[:-1])
        assert len(starts) == 5, (name, starts)
        assert np.ptp(np.diff(starts)) < 3
