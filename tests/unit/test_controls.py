# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of painted controls: what files keep, and what docs/painting.md says of it."""

import re
from pathlib import Path

import numpy as np
from encre.pen import library, saved

PAGE = Path(__file__).parents[2] / "docs" / "painting.md"


def test_files_keep_them_where_they_always_did():
    places = {c.name: (c.saved, c.channel) for c in library.controls().values()}
    line, surface, light = "Encre Line Controls", "Encre Surface Controls", "Encre Light Controls"
    assert places == {"thickness": (line, 0), "intensity": (line, 1), "color_edge": (line, 2),
                      "smudge_range": (surface, 0), "smudge_falloff": (surface, 1), "hatching": (surface, 2),
                      "light": (light, 0)}
    assert list(saved.passes(()).items()) == [
        ("Encre Source", "RGBA"), ("Encre Diffuse", "RGB"), ("Encre Index", "XYZ"), (line, "XYZ"), (surface, "XYZ"),
        (light, "X")]


def test_what_is_saved_is_read_again_and_an_older_file_has_fewer():
    controls = np.random.default_rng(1).uniform(-1, 1, (3, 4, len(library.controls()))).astype(np.float32)
    made = {"combined": np.ones((3, 4, 4), np.float32), "controls": controls}
    kept = {name: saved.pack(name, made) for name in saved.control_passes()}
    np.testing.assert_array_equal(saved.unpack(kept)["controls"], controls)
    del kept["Encre Surface Controls"], kept["Encre Light Controls"]
    there = [c.saved == "Encre Line Controls" for c in library.controls().values()]
    np.testing.assert_array_equal(saved.unpack(kept)["controls"], controls * there)
    assert "controls" not in saved.unpack({})


def test_the_manual_tells_them():
    rows = re.findall(r"\| `(\w+)` \| (.+?) \| (.+?) \|", PAGE.read_text(encoding="utf-8"))
    assert rows == [(c.attribute, c.white, c.black) for c in library.controls().values()]
