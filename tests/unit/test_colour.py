# SPDX-License-Identifier: GPL-3.0-or-later
"""What painted greys say; linear spaces."""

import numpy as np
from encre.pen import colour
from encre.pen.settings import Settings


def test_a_painted_grey_is_what_its_byte_says_and_mid_grey_nothing():
    """Neither of the two bytes beside the middle moves a line; the next ones do."""
    bytes_ = np.arange(256)
    values = colour.control_values(colour.decode_srgb(bytes_ / 255)[:, None] * np.ones(3))
    assert np.flatnonzero(values == 0).tolist() == [127, 128]
    other = np.abs(bytes_ - 127.5) > 1
    assert np.abs(values - (2 * bytes_ / 255 - 1))[other].max() < 1e-6


def test_spaces_to_rec709():
    """Published matrices, by Bradford's adaptation of the white; greys stay grey."""
    acescg = [[1.7050509879, -0.6217921206, -0.0832588674], [-0.1302564175, 1.1408047365, -0.0105483191],
              [-0.0240033568, -0.1289689761, 1.1529723329]]
    rec2020 = [[1.6604910021, -0.5876411388, -0.0728498633], [-0.1245504745, 1.1328998971, -0.0083494226],
               [-0.0181507634, -0.1005788980, 1.1187296614]]
    for name, published in (("lin_ap1_scene", acescg), ("lin_rec2020_scene", rec2020)):
        matrix = colour.to_rec709(name)
        assert np.abs(matrix - published).max() < 2e-4
        assert np.abs(matrix.sum(1) - 1).max() < 1e-12
    assert colour.to_rec709("lin_rec709_scene") is None and colour.to_rec709("") is None


def test_settings_have_their_colours_in_rec709_and_pictures_in_theirs():
    red = (0.6, 0.02, 0.0)
    for space in ("lin_rec2020_scene", "lin_ap1_scene"):
        there = colour.from_rec709(red, space)
        assert np.abs(colour.to_rec709(space) @ there - red).max() < 1e-6 and abs(there[0] - red[0]) > 0.1
        given = Settings({"ink_color": red, "shade_levels": [(0.5, 0, 0), (1, 0.5, 0.1, *red)]}, (), space)
        assert given.scene["ink_color"] == red
        assert np.allclose(given.every[0]["ink_color"], there)
        assert np.allclose(given.every[0]["shade_levels"][1], (1, 0.5, 0.1, *there))
        assert np.allclose(given.every[0]["paper_color"], 1, atol=1e-6), "white stays white"
    assert colour.from_rec709(red, "") == red
