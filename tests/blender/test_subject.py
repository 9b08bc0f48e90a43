# SPDX-License-Identifier: GPL-3.0-or-later
"""How far away what the picture is about stands: by the focus, else by the scene's size, and the same in all frames."""

import pytest


def test_the_distance_of_what_the_picture_is_about(render):
    facts = {name: values[0] for name, values in render("distances").facts.items()}
    assert facts["nothing"] == 0
    assert facts["plain"] == pytest.approx(0.5 * 3.2 * ((3 + 3**0.5 / 2) * 3**0.5 / 2)**0.5 * 100 / (36 * 9 / 16))
    assert facts["ground"] == pytest.approx(facts["plain"]), "ground to the horizon doesn't count"
    assert facts["frames"] == pytest.approx([facts["plain"]] * 3), "nor what moves"
    assert facts["long lens"] == pytest.approx(2)
    assert facts["no focus"] and facts["focus"] == 7 and facts["focus object"] == pytest.approx(20)
    assert facts["behind"] > 0
    assert facts["all move"] == pytest.approx(0.5 * 3.2 * 3**0.5 / 2 * 100 / (36 * 9 / 16))
