# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of older versions keep their look."""

from encre.pen.settings import VERSION


def test_old_files_keep_their_look(render):
    facts = render("opened").facts
    assert facts["old"] == [[VERSION, "LAYERS", "SCENE", 20.0, 0.0, 5.0, True, 0]], "as Cycles has them"
    assert facts["new"] == [[VERSION, "AUTO", "RELATIVE", 32.0, 12.0, 5.0, False, 16]]
    assert facts["foreign"] == [[VERSION, "AUTO", "RELATIVE", 32.0, 12.0, 8.0, False, 16]]
