# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of any kind, by Encre alone: their colours are Cycles', or it is said which differ, and none of them ends
the frame."""

import numpy as np
import pytest

# What Encre draws another way: what is half clear is there or not, and what is unknown has a sentence.
SAID = {"beside what is unknown", "map of the instancer"}


def apart(theirs, ours, alpha, there):
    """How far two colours are apart, of what shows; infinite: one shows and the other does not."""
    if there != (alpha >= 0.5):
        return np.inf
    return np.abs(np.array(theirs) / max(alpha, 0.5) - ours).max() if there else 0.0


def squares(shot, first):
    facts = list(shot.facts.items())
    return {name: found for name, (found,) in facts[[name for name, _ in facts].index(first):]}


@pytest.mark.slow
def test_any_output_may_be_linked_to_any_input(render):
    found = squares(render("links"), "colour to surface")
    assert len(found) > 40
    wrong = {name: (theirs, ours) for name, (theirs, ours, alpha, there, _) in found.items()
             if apart(theirs, ours, alpha, there) > 0.02}
    if wrong.keys() == {"INT8"}:  # Cycles 3.4 knows none
        assert wrong.pop("INT8")[0] == [0, 0, 0]
    assert not wrong
    assert {name for name, (*_, said) in found.items() if said} == SAID


def test_who_places_a_thing_hides_it_as_it_does_itself(render):
    shot = render("placed")
    (alpha,), index = shot.facts["alpha"], shot.passes("ours")["Encre Index"][..., 0]
    seen = {label: bool(index[8 * (k // 8) + 4, 8 * (k % 8) + 4] > 0) for k, label in enumerate(alpha)}
    assert seen == {label: there >= 0.5 for label, there in alpha.items()}
    assert len(seen) == 35 and 10 < sum(seen.values()) < 25


def test_catchers_show_shadows_alone(render):
    shot = render("caught")
    assert shot.facts["failed"] == [None] * 6
    theirs, ours = (shot.passes(f"{source} True")["Combined"][..., 3] for source in ("CYCLES", "ENCRE"))
    shade = (ours > 0.5) & (ours < 0.99)
    assert 0.03 < shade.mean() < 0.3 and (ours < 0.05).mean() > 0.5
    assert (np.abs(theirs - ours) > 0.06).mean() < 0.03  # at the shadow's edge, which is softer
    index = shot.passes("ENCRE True")["Encre Index"][..., 0]
    assert not index[shade].any() and index.any()
    theirs, ours = (shot.passes(f"{source} False")["Combined"][..., :3] for source in ("CYCLES", "ENCRE"))
    for picture in (theirs, ours):
        lit = picture[45:, 70:].reshape(-1, 3)
        assert (np.abs(lit - (0.3, 0.4, 0.6)).max(1) < 0.02).mean() > 0.95  # what is behind
    for source in "CYCLES", "ENCRE":
        inked = shot.passes(f"{source} inked")["Combined"]
        assert (inked[shade][:, 3] > 0.95).mean() > 0.8 and inked[shade][:, :3].mean() < 0.1, source
        assert (inked[45:, 70:, 3] < 0.3).mean() > 0.95


def test_what_nodes_leave_beside_meshes_ends_no_frame(render):
    shot = render("beside")
    assert shot.facts["failed"] == [None] * 3 and "Traceback" not in shot.output
    whole, without = (shot.passes(name)["Encre Index"] > 0 for name in ("whole", "without"))
    assert whole.any() and (whole == without).all()


def test_toon_materials_show_their_ramp_of_the_light(render):
    shot = render("toon")
    assert shot.facts["failed"] == [None] * 4
    assert shot.output.count("Cycles knows no Shader to RGB, and draws without it: Toon; choose Fast") == 1
    assert shot.output.count("the camera is more than 100,000 units from the origin") == 1
    toon, matt = shot.passes("toon"), shot.passes("matt")
    ball = toon["Emit"].any(2)
    lit = matt["DiffDir"][ball].mean(1)
    want = np.where((lit < 0.3)[:, None], (0.5, 0.1, 0.1), (1, 0.35, 0.25))
    near = np.abs(lit - 0.3) < 0.05
    assert ball.sum() > 200 and 0.1 < (lit < 0.3).mean() < 0.9
    away = np.abs(toon["Emit"][ball] - want)[~near].max(1)
    assert (away < 1e-3).mean() > 0.97  # the ramp's end is smooth


def test_fog_hides_what_is_far(render):
    shot = render("fog")
    assert shot.facts["failed"] == [None] * 2
    for name, ways in (("world", (5, 15, 25)), ("box", (0, 8, 10))):
        glow = shot.passes(name)["Emit"]
        for k, way in enumerate(ways):
            clear = np.exp(-0.05 * way)
            want = clear * np.array((0.7, 0.6, 0.5)) + (1 - clear) * 0.4
            np.testing.assert_allclose(glow[4, 8 * k + 4], want, atol=2e-4, err_msg=f"{name} {way}")


def test_rough_metals_are_matt(render):
    """Which those of many glTF files are by default: light on a ground of one was a blank highlight in steps."""
    shot = render("metals")
    assert shot.facts["failed"] == [None]
    (rough, smooth), (rough_gloss, smooth_gloss) = (shot.passes("metals")[name][4, 4:20:8]
                                                    for name in ("DiffCol", "GlossCol"))
    assert (rough > 0.15).all() and not rough_gloss.any()
    assert (smooth_gloss > 0.3).all() and not smooth.any()


def test_what_is_added_to_what_shows_through_it_is_seen(render):
    """Diffuse shaders added to transparent ones were not: they have no place that light falls on."""
    shot = render("added_shaders")
    assert shot.facts["failed"] == [None]
    cloth, glow, none = shot.passes("added_shaders")["Emit"][4, 4:28:8]
    np.testing.assert_allclose(cloth, (0.3, 0.2, 0.1), atol=1e-3)
    np.testing.assert_allclose(glow, (0.7, 0.6, 0.5), atol=1e-3)
    assert not none.any()


def test_pictures_have_the_alpha_and_the_space_of_colours_that_cycles_gives_them(render):
    found = squares(render("decals"), "STRAIGHT False 0")
    assert len(found) >= 24
    wrong = {name: (theirs, ours) for name, (theirs, ours, alpha, there, said) in found.items()
             if apart(theirs, ours, alpha, there) >= 0.005 * max(1, *theirs) or said}
    assert not wrong
    assert found["STRAIGHT False 0"][1] == [0, 0, 0], "under what is clear nothing is"


@pytest.mark.slow
def test_no_tree_of_nodes_ends_the_frame(render):
    facts = render("any_trees").facts
    assert facts["wrong"] == [{}] and facts["kinds"][0] > 90
    assert render("wild_read").facts["wrong"] == [{}]


@pytest.mark.slow
def test_four_thousand_materials_by_chance_are_read(render):
    facts = render("wild_read", ENCRE_WILD="200:4200").facts
    assert facts["wrong"] == [{}] and facts["slowest"][0] < 5


@pytest.mark.slow
def test_a_thousand_materials_by_chance_have_the_colours_of_cycles_or_a_sentence(render, blender):
    facts = render("wild", ENCRE_WILD="0:1024").facts
    assert facts["silent"][0] > 300
    wrong = facts["wrong"][0]
    for name, (theirs, ours, alpha, there, tree) in wrong.items():
        print(f"{name}: {theirs} by Cycles, {ours} by Encre, alpha {alpha}, there {there}\n{tree}")
    if blender != "bpy":  # in which nodes differ a little
        wrong = wrong if len(wrong) > facts["silent"][0] // 10 else {}
    assert not wrong
