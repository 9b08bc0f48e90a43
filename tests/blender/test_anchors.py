# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer `anchor` in Blender: what files keep of it, of surfaces that are placed, bent, keyed and pinned."""

from types import SimpleNamespace

import numpy as np
from encre.pen import saved
from reference import tones


def layer(passes):
    return saved.unpack(passes)["anchor"]


def inner(index, number):
    """Pixels of an object whose neighbours are of it too."""
    own = np.pad(index == number, 1)
    return np.all([own[1 + y:own.shape[0] - 1 + y, 1 + x:own.shape[1] - 1 + x]
                   for y in (-1, 0, 1) for x in (-1, 0, 1)], 0)


def on_box(position, half):
    """How far positions (n, 3) are from the surface of a box."""
    return np.abs(np.max(np.abs(position) - np.array(half), -1))


def test_rest_positions_of_what_is_placed_bent_and_keyed(render):
    shot = render("anchored")
    for name in ("one", "own"):
        passes = shot.passes(name)
        anchor, index = layer(passes), passes["IndexOB"][..., 0]
        for number, half in ((1, (0.5, 0.5, 0.5)), (2, (0.5, 0.5, 1)), (3, (0.5, 0.5, 1))):
            at = index == number
            assert at.sum() > 150
            assert np.percentile(on_box(anchor[at][:, :3], half), 98) < 1e-4, (name, number)
            middle = anchor[inner(index, number)]
            np.testing.assert_allclose(np.linalg.norm(middle[:, 3:6], axis=1), 1, atol=1e-5)
            # flat faces: across the normal, and as long as a pixel or longer
            grown = middle[:, 7:10], middle[:, 10:13]
            assert np.percentile(np.abs((middle[:, 3:6] * grown[0]).sum(1)), 98) < 1e-6
            assert (np.maximum(*(np.linalg.norm(g, axis=1) for g in grown)) > 0.9 * middle[:, 6]).all()
        assert not anchor[passes["Depth"][..., 0] > 1e9].any()


def test_growth_is_the_way_to_the_next_pixel(render):
    passes = render("anchored").passes("one")
    anchor, index = layer(passes), passes["IndexOB"][..., 0]
    for number, close in ((1, 0.05), (2, 0.2)):  # perspective bends a step; a twisted face is cut into triangles
        at = inner(index, number)[:-1, :-1]
        same = (np.abs(anchor[:-1, 1:, 3:6] - anchor[:-1, :-1, 3:6]).max(-1) < 1e-3) & at
        step = anchor[:-1, 1:, :3] - anchor[:-1, :-1, :3]
        off = np.linalg.norm(step - anchor[:-1, :-1, 7:10], axis=-1)[same] / anchor[:-1, :-1, 6][same]
        assert same.sum() > 80 and np.percentile(off, 90) < close, number


def test_u_of_the_uv_map_that_renders_use(render):
    """Along the faces of what has one, whoever draws the layers, and nowhere else."""
    for name in ("one", "own"):
        passes = render("anchored").passes(name)
        tangent, anchor, index = passes["Encre Tangent"], layer(passes), passes["IndexOB"][..., 0]
        at = inner(index, 1)
        np.testing.assert_allclose(np.sort(np.abs(tangent[at]), 1), [(0, 0, 1)] * at.sum(), atol=1e-4)
        assert np.percentile(np.abs((tangent[at] * anchor[at][:, 3:6]).sum(1)), 98) < 1e-4
        assert not tangent[(index == 2) | (index == 3)].any()


def test_the_size_of_a_pixel_knows_scale_and_distance(render):
    shot = render("anchored")
    passes = shot.passes("one")
    anchor, index, depth = layer(passes), passes["IndexOB"][..., 0], passes["Depth"][..., 0]
    angle = 36 / 50 / 160  # of the camera's sensor and lens
    for number, scale in ((1, 0.5), (2, 1)):
        at = inner(index, number)
        np.testing.assert_allclose(anchor[at][:, 6], depth[at] * angle / scale, rtol=0.03 if number == 1 else 0.1)


def test_of_larger_layers_one_sample_is_kept_and_what_is_told_per_pixel_grows(render):
    shot = render("anchored")
    one, two = (shot.passes(name) for name in ("one", "two"))
    at = inner(one["IndexOB"][..., 0], 1)
    a, b = layer(one)[at], layer(two)[at]
    assert np.median(np.linalg.norm(a[:, :3] - b[:, :3], axis=1) / a[:, 6]) < 1
    np.testing.assert_allclose(b[:, 6], a[:, 6], rtol=0.02)
    assert np.median(np.linalg.norm(b[:, 7:10], axis=1) / np.linalg.norm(a[:, 7:10], axis=1)) > 0.9


def test_tones_stick_to_surfaces_at_f12(render):
    """Dots lie where the layer `anchor` of the same file has them, at the darkness of the one level there is."""
    passes = render("anchored").passes("own")
    anchor = layer(passes)
    looks = dict(tone_pitch_unit="LENGTH", tone_crisp=False)
    want = tones._ink(SimpleNamespace(anchor=np.float64(anchor), card=None), looks.__getitem__,
                      ("DOTS", 60.0, 45.0, "SURFACE"), np.full(anchor.shape[:2], 0.4), 90 / 1080, None, None)
    there = anchor[..., 6] > 0
    got = passes["Encre Tones"][..., 3]
    assert not got[~there].any() and want[there].std() > 0.3
    assert (np.abs(got - want)[there] < 0.1).mean() > 0.9


def test_flat_tones_lie_on_the_sheets_of_things(render):
    """Whoever draws the layers: the place of a thing's origin on its sheet is 0, and a sheet is as large as what is
    there. At F12 dots are where the file has them."""
    shot = render("anchored")
    one, flat = shot.passes("one"), shot.passes("flat")
    np.testing.assert_allclose(flat["Encre Card"], one["Encre Card"], rtol=1e-4, atol=1e-4)
    card, index, depth = flat["Encre Card"], one["IndexOB"][..., 0], one["Depth"][..., 0]
    for number, half in ((1, 0.5), (2, 1.0)):
        at = index == number
        size = np.hypot(card[at][:, 2], card[at][:, 3])
        assert np.ptp(size) < 1e-6 * size.max() and abs(size[0] / np.median(depth[at] * 36 / 50 / 160) - 1) < 0.2
        place = np.abs(card[at][:, :2])
        assert np.abs(np.median(card[at][:, :2], 0)).max() < 0.3 * half and place.max() < 2 * half
    looks = dict(tone_pitch_unit="LENGTH", tone_crisp=False)
    want = tones._ink(SimpleNamespace(anchor=None, card=np.float64(card)), looks.__getitem__,
                      ("DOTS", 60.0, 45.0, "FLAT"), np.full(card.shape[:2], 0.4), 90 / 1080, None, None)
    there = card[..., 2:].any(-1)
    got = flat["Encre Tones"][..., 3]
    assert not got[~there].any() and want[there].std() > 0.3
    assert (np.abs(got - want)[there] < 0.1).mean() > 0.9


def test_copies_rest_elsewhere_each_and_stay_there(render):
    """Or noise on the thing would draw all of them alike."""
    shot = render("anchored")
    middles = []
    for name in ("copies", "moved"):
        passes = shot.passes(name)
        anchor, index = layer(passes), passes["IndexOB"][..., 0]
        for number in (1, 2, 3):
            own = anchor[index == number][:, :3]
            middle = (own.min(0) + own.max(0)) / 2
            assert len(own) > 100 and (np.abs(own - middle).max(0) < 0.52).all()
            middles.append(middle)
    np.testing.assert_allclose(middles[3:], middles[:3], atol=0.1)
    assert all(np.abs(middles[i] - middles[j]).max() > 0.3 for i, j in ((0, 1), (0, 2), (1, 2)))


def test_nodes_may_write_rest_positions(render):
    passes = render("anchored").passes("written")
    anchor, index = layer(passes), passes["IndexOB"][..., 0]
    at = index == 1
    assert at.sum() > 150
    assert np.percentile(on_box(anchor[at][:, :3] - (5, 0, 0), (0.5, 0.5, 0.5)), 98) < 1e-4
    np.testing.assert_allclose(np.linalg.norm(anchor[inner(index, 1)][:, 3:6], axis=1), 1, atol=1e-5)


def test_files_without_what_sticks_have_no_anchor(render):
    shot = render("anchored")
    assert saved.ANCHOR.keys() <= shot.passes("one").keys()
    assert not {*saved.ANCHOR, "Encre Tangent", "Encre Card"} & shot.passes("without").keys()


def test_pin_pattern_keeps_rest_positions_where_blender_does_not(render):
    facts = render("anchored").facts
    assert facts["apart"][0] > 0.2, "in a window's depsgraph the mesh is known as it is bent alone"
    assert facts["apart"][1] == 0 and facts["pinned"] == ["POINT"] and facts["cleared"] == [False]
