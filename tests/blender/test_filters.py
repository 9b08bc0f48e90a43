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
    theirs, ours, where = both(render, "clay_and_own", "clay")
    own = both(render, "clay_and_own", "own")[1]
    there = where & (ours["Encre Index"][..., 0] > 0)
    assert there.mean() > 0.5
    np.testing.assert_allclose(ours["DiffCol"][there], theirs["DiffCol"][there], atol=2e-3)
    kinds = [len(np.unique(passes["DiffCol"][there].round(3), axis=0)) for passes in (ours, own)]
    assert kinds[0] == 1 and kinds[1] > 4
    assert abs(ours["Encre Diffuse"] - theirs["Encre Diffuse"])[there].mean() < 2e-3  # its light, with whole shadows
    assert (own["Encre Index"][..., 0] != ours["Encre Index"][..., 0]).any()  # the card is whole
    assert all((passes["Encre Index"][there][:, 2] == 1).all() for passes in (theirs, ours))  # has its style


def nothing(passes):
    return passes["Depth"][..., 0] >= 1e9


def test_the_film_is_exposed_as_in_cycles(render):
    for before, after in zip(both(render, "filtered", "all")[:2], both(render, "filtered", "exposed")[:2], strict=True):
        for name in ("Encre Source", "Encre Diffuse", "Emit", "GlossDir"):
            assert before[name][..., :3].any()
            np.testing.assert_allclose(after[name][..., :3], 0.3 * before[name][..., :3], atol=2e-4, err_msg=name)
        np.testing.assert_array_equal(after["DiffCol"], before["DiffCol"])


def test_without_its_environment_a_view_layer_is_black_behind_and_has_the_light_of_lamps_alone(render):
    theirs, ours, where = both(render, "filtered", "use_sky")
    for passes in (theirs, ours):
        behind = passes["Encre Source"][nothing(passes) & where]
        assert len(behind) > 500 and not behind[:, :3].any() and (behind[:, 3] == 1).all()
    index = ours["Encre Index"][..., 0]
    ground = where & (index == index[-1, 0])
    assert ground.sum() > 500
    full = both(render, "filtered", "all")
    for now, before in ((theirs, full[0]), (ours, full[1])):
        light, lit = (np.median(passes["DiffDir"][ground], 0) for passes in (now, before))
        assert (light < 0.8 * lit).all()
    sun = 3 / np.pi * np.cos(np.radians(40)) * np.cos(np.radians(20))
    np.testing.assert_allclose(light, sun, atol=1e-3)  # in Cycles the thing that glows lights the ground, too


def test_hair_and_surfaces_are_left_out(render):
    theirs, ours, _ = both(render, "filtered", "use_strand")
    near, far = (np.minimum(passes["Depth"][..., 0], 1e6) for passes in (ours, theirs))
    assert (abs(near - far) > 2e-3 * far).mean() < 0.005
    theirs, ours, _ = both(render, "filtered", "use_solid")
    assert (nothing(ours) == nothing(theirs)).mean() > 0.97 and 0.02 < 1 - nothing(ours).mean() < 0.2  # hair is there


def test_another_world_is_behind_a_view_layer_that_has_its_own(render):
    shot = render("filtered")
    if (shot.folder / "world_override ENCRE.exr").exists():  # since 4.3
        *two, where = both(render, "filtered", "world_override")
        for passes in two:
            behind = passes["Encre Source"][nothing(passes) & where]
            np.testing.assert_allclose(behind[:, :3].mean(0), (0.6, 0.2, 0.1), atol=1e-4)
