# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines where surfaces coincide, let through or pass through each other."""

import numpy as np
import OpenImageIO as oiio
import pytest
from encre.cli.composite import composite
from encre.pen import colour
from known import KIND


def ink(passes):
    return passes["Encre Lines"][..., 3]


def test_of_two_faces_in_one_plane_the_earlier_is_drawn(render):
    """As if the other lay a little behind it, and not a blot: Cycles takes now one, now the other."""
    shot = render("coincident")
    both, behind = shot.passes("both"), shot.passes("behind")
    assert (both["Encre Index"] != behind["Encre Index"]).any(2).sum() < 40
    assert 0.8 < ink(both).sum() / ink(behind).sum() < 1.05


def test_pieces_of_a_mesh_have_a_line_where_they_pass_through_each_other(render):
    """At 8 degrees, where the normals show no crease, and as whole as between parts."""
    shot = render("pieces")
    pieces, parts = shot.passes("pieces"), shot.passes("parts")
    points = shot.chains("pieces")
    meet = points[(points["kind"] & KIND["meet"]) > 0]
    height, width = ink(pieces).shape
    at = np.clip(np.round([meet["y"], meet["x"]]).astype(int), 0, [[height - 1], [width - 1]])
    assert len(meet) > 1 and (ink(pieces)[tuple(at)] > 0.05).mean() > 0.95
    missing = (ink(parts) > 0.3) & ~(ink(pieces) > 0.05)
    assert missing.sum() < 30


@pytest.mark.parametrize("source", ["CYCLES", "ENCRE"])
def test_what_an_image_cuts_out_has_lines_between_its_colors(render, source):
    """And what is behind its holes has its own."""
    shot = render("cards")
    line = ink(shot.passes(f"cards {source}")) > 0.3
    card, wall = line[87:93].any(0), line[:, 157:163].any(1)
    assert card[85:112].all() and card[208:235].all() and not card[125:155].any() and not card[165:195].any()
    assert wall[60:120].all() and not wall[15:45].any() and not wall[135:165].any()
    points = shot.chains(f"cards {source}")
    away = np.hypot(points["x"] - 159.5, points["y"] - 89.5)
    assert away[points["object"] == points["object"].min()].min() > 35


def test_what_lets_light_through_at_random_leaves_no_crumbs(render):
    """Behind the board of 30 % the box is drawn as if it were not there; where another is cut into squares, index and
    depth stay those of Cycles."""
    shot = render("fades")
    boards, bare = shot.passes("boards"), shot.passes("bare")
    fade, cut = (boards["IndexOB"][..., 0] == k for k in (1, 2))
    rows, columns = np.nonzero(fade)
    inside = np.s_[rows.min() + 4:rows.max() - 3, columns.min() + 4:columns.max() - 3]
    assert 0.1 < fade[inside].mean() < 0.4, "Cycles shows it at random"
    objects, alone = boards["Encre Index"][..., 0][inside], bare["Encre Index"][..., 0][inside]
    names = [np.unique(objects[alone == number], return_counts=True) for number in np.unique(alone)]
    assert all(counts.max() > 0.99 * counts.sum() for _, counts in names)
    assert np.abs(boards["Depth"][inside] / bare["Depth"][inside] - 1).max() < 2e-2
    assert ink(boards)[inside].sum() < 1.2 * ink(bare)[inside].sum() + 20
    assert len(np.unique(boards["Encre Index"][..., 0][cut])) == 1


@pytest.mark.slow
@pytest.mark.parametrize("method, source, weight", [("DISPLACEMENT", "AUTO", 0), ("DISPLACEMENT", "LAYERS", 0),
                                                    ("BUMP", "AUTO", 1)])
def test_what_materials_displace_has_creases(render, method, source, weight):
    """Of which no mesh tells: three whole lines where a roof winds over a sheet, and no crumbs."""
    line = ink(render("displaced").passes(f"{method} {source} {weight}"))[:, 40:280] > 0.25
    assert ((line[1:] & ~line[:-1]).sum(0) == 3).all()


@pytest.mark.slow
def test_where_cycles_shows_no_mesh_there_are_no_lines_of_one(render):
    """In a hole, and on a ball that is a cube before Cycles divides it: outlines alone."""
    found = render("displaced").passes("unlike")
    hole, index = found["Combined"][..., 3] < 0.5, found["Encre Index"][..., 0]
    ball = index == index[45, 40]
    for part in (hole, ball):
        inner = np.all([np.roll(part, (y, x), (0, 1)) for y in (-4, 0, 4) for x in (-4, 0, 4)], axis=0)
        assert inner.sum() > 200 and ink(found)[inner].max() < 0.05


def test_bumps_have_creases_where_they_are_asked_for_only(render):
    assert not ink(render("displaced").passes("BUMP AUTO 0"))[:, 40:280].any()


def test_smoke_is_denoised_where_no_surface_is(render):
    """Its own pixels lie beside the cube's box; but for them nothing changes."""
    shot = render("smoke")
    clean, noisy = (shot.passes(name)["Combined"][..., :3] for name in ("clean", "noisy"))
    if not shot.facts["denoiser"][0]:
        np.testing.assert_array_equal(clean, noisy)
        return
    smoke = np.s_[20:60, 100:125]
    rough = [np.abs(np.diff(picture[smoke], axis=1)).mean() for picture in (clean, noisy)]
    assert rough[0] < 0.5 * rough[1], rough


def test_ink_is_of_the_same_colour_in_every_working_space(render):
    shot = render("wide")
    if not shot.wrote("ACEScg"):
        pytest.skip("this Blender has one working space")
    spaces = "Linear Rec.709", "ACEScg"
    full = np.logical_and(*(ink(shot.passes(space)) > 0.999 for space in spaces))
    assert full.sum() > 500
    shown = [picture(shot.folder / f"{space}.png") for space in spaces]
    assert np.abs(shown[0] - shown[1])[full].max() <= 1 / 255
    assert np.abs(shown[0][full] - colour.encode_srgb(np.array((0.6, 0.02, 0)))).max() <= 1 / 255
    values = [shot.passes(space)["Encre Lines"][full][:, :3] for space in spaces]
    assert np.abs(values[0] - values[1]).max() > 0.1, "in the file they are of its space"
    for space in spaces:  # the file says its space, and its settings the colours that they had
        composite(str(shot.folder / f"{space}.exr"), str(shot.folder / "again.png"), {})
        assert np.abs(picture(shot.folder / "again.png")[full] - shown[0][full]).max() <= 1.01 / 255


def picture(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]


def test_frames_share_pictures_of_files_that_are_as_they_were(render):
    facts = render("pictures_of_files").facts
    (kept,), (values,) = facts["kept"], facts["values"]
    assert kept == [False, True, False, False, True, False, True, False, False, False, True]
    assert values[:2] == [0, 0] and values[2:5] == [1, 1, 1] and values[5:] == [0] * 6
