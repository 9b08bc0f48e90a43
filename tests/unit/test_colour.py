# SPDX-License-Identifier: GPL-3.0-or-later
"""What painted greys say."""

import numpy as np
from encre.pen import colour


def test_a_painted_grey_is_what_its_byte_says_and_mid_grey_nothing():
    """Neither of the two bytes beside the middle moves a line; the next ones do."""
    bytes_ = np.arange(256)
    values = colour.control_values(colour.decode_srgb(bytes_ / 255)[:, None] * np.ones(3))
    assert np.flatnonzero(values == 0).tolist() == [127, 128]
    other = np.abs(bytes_ - 127.5) > 1
    assert np.abs(values - (2 * bytes_ / 255 - 1))[other].max() < 1e-6
