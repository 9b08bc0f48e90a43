# SPDX-License-Identifier: GPL-3.0-or-later
"""How far away what the picture is about stands: by the focus, else by the scene's size, and the same in all frames;
and how much light is full light."""

import numpy as np
import pytest


def test_what_surfaces_receive_tells_shade(render):
    facts = {name: values[0] for name, values in render("metered").facts.items()}
    light, shade = facts["pale"]
    # Sides and what the suns do not reach have 0.72, what they light 2 / pi more, and one of them 1 / pi.
    assert light == pytest.approx((0.72 + 2 / np.pi) / 0.97, rel=1e-5)
    assert shade == pytest.approx(0.72 * 0.35 / 0.38, rel=1e-5)
    assert facts["elsewhere"] == facts["pale"], "wherever the camera is"
    assert facts["reversed"] == pytest.approx(facts["pale"], rel=1e-6), "in whatever order things come"
    assert facts["moving"] == [pytest.approx(facts["pale"], rel=1e-6)] * 3, "what moves throws no shadow on it"
    kept = facts["kept"]
    assert kept[0] == "FIXED" and kept[1:] == pytest.approx(facts["pale"], rel=1e-5)
    assert facts["usual"] == [pytest.approx(0.15 + 1 / np.pi), 0], "the usual light is cut as it was"
    top, right, left, back, front, below = np.array(facts["even"]) / 0.1
    assert top == pytest.approx(1) and below == pytest.approx(1 - 0.6 * 2 * 0.75**0.5 / (1 + 0.75**0.5))
    assert left == pytest.approx(back) and front == pytest.approx(right) and right < left < top, "from the upper left"
    top, right, left, back, front, below = np.array(facts["from x"]) / 0.1
    assert below < left < front < right < top, "from where the sun is"
    assert front == pytest.approx(back) and top == pytest.approx(1)
    assert facts["no planes"] == pytest.approx([0.1] * 6)
    light, shade = facts["sky"]
    assert 0 < shade < 0.1 * light, "under a sky shade is seen as shade"
    light, shade = facts["low"]
    floor = 0.35 + 0.65 * (facts["below"] - shade) / (light - shade)
    assert 0.36 < floor < 0.42, "a floor that the sky alone lights is in the dark levels of Cel and Hatched"
    light, floor, window = facts["window"]
    assert window > 2 * floor, "what faces the window would have much more"
    assert light == pytest.approx(floor / 0.97, rel=0.1), "but nothing does"


@pytest.mark.slow
def test_the_distance_of_what_the_picture_is_about(render):
    facts = {name: values[0] for name, values in render("distances").facts.items()}
    assert facts["nothing"] == 0
    assert facts["plain"] == pytest.approx(0.5 * 3.2 * ((3 + 3**0.5 / 2) * 3**0.5 / 2)**0.5 * 100 / (36 * 9 / 16))
    assert facts["ground"] == pytest.approx(facts["plain"]), "ground to the horizon doesn't count"
    assert facts["frames"] == pytest.approx([facts["plain"]] * 3), "nor what moves"
    assert facts["long lens"] == pytest.approx(2)
    assert facts["no focus"] and facts["focus"] == 7 and facts["focus object"] == pytest.approx(20)
    assert facts["behind"] > 0
    assert facts["dark"] == 0
    away = 144 + np.array([36, 9, 0, 9, 36.0])
    falls, votes = 400 / (2 * np.pi) ** 2 / away, np.minimum(1.5 / (0.03 * away), 1)
    counts = votes * falls / (falls + (votes @ falls**0.5 / votes.sum()) ** 2)
    mean = np.exp(counts @ np.log(falls) / counts.sum())
    assert facts["point"] == pytest.approx([mean] * 2), "of the things, wherever the camera is"
    assert facts["endless"] == [["lamp Lamp, whose strength is not finite"], 0], "told by its name"
    alone, town, moon, moonlit = facts["night"]
    assert town == pytest.approx(alone, rel=0.1), "a far town tells little"
    assert moon == pytest.approx(alone, rel=0.3) and moonlit == pytest.approx(alone, rel=0.3), "nor does the moon"
    before, after = facts["lamp in a room"]
    assert after == pytest.approx(before, rel=0.1), "of a sunlit town what is in a room tells little"
    assert facts["sun"] == pytest.approx(4 / np.pi)
    assert facts["sun and world"] == pytest.approx(4 / np.pi + 0.5) and facts["world"] == pytest.approx(0.5)
    assert facts["street"] == pytest.approx(facts["sun and world"]), "the sun reaches the cubes"
    before, after = facts["room"]
    assert before == pytest.approx(4 / np.pi + 0.02) and 0.02 < after < 3 * 0.02, "little more than comes to most"
    assert facts["all move"] == pytest.approx(0.5 * 3.2 * 3**0.5 / 2 * 100 / (36 * 9 / 16))
