# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages for artists name what panels say, letter by letter: what stands in italics there is a label."""

import re
from pathlib import Path

import languages
import pytest
from encre.pen import presets

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [*sorted((DOCS / "guide").glob("*.md")), DOCS / "downloads.md", DOCS / "index.md", ROOT / "README.md"]
ITALICS = re.compile(r"(?<![*\w])\*(?!\*)([^*]+)(?<!\*)\*(?!\*)")
BLENDERS = {
    "Add-ons", "Closest", "Device", "Edit", "File Output", "Film", "Freestyle", "Get Extensions", "Install from Disk…",
    "Install…", "Interpolation", "Is Camera Ray", "Light Path", "Noise Texture", "OpenEXR MultiLayer",
    "Preferences", "RGBA", "Render Animation", "Render Engine", "Rendered", "Repositories", "Save As…",
    "Standard", "Transparent", "View Layer", "Website", "▾"}
# Encre's own that are made of several texts; parts of the site; titles.
OTHERS = {"Encre", "Filmic washes out ink", "AgX washes out ink", "Lamp Ink", "Needs …", "Measured", "Reference",
          "3D Comic Rendering", "Inter-color NPR lines"}


def unknown(text, known):
    """What stands in italics and is none of the labels; ' › ' parts a panel from what is in it, ': ' a row from its
    value."""
    for words in ITALICS.findall(re.sub(r"```.*?```|`[^`]*`", "", text, flags=re.DOTALL)):
        for label in " ".join(words.split()).split(" › "):
            if label not in known:
                yield from (part for part in label.split(": ") if part not in known)


@pytest.fixture(scope="module")
def known():
    return {*languages.said()[0], *(preset.name for preset in presets.presets()), *BLENDERS, *OTHERS}


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_labels_are_as_in_the_panels(path, known):
    assert list(unknown(path.read_text(encoding="utf-8"), known)) == []


def test_other_words_are_noticed(known):
    text = "*Far Away* (*Lines › Near and Far*), **not** *Far Lines*, *Lines › Distance*, `*.png`, *Render: Quick*"
    assert list(unknown(text, known)) == ["Far Lines", "Distance", "Quick"]


def test_the_page_of_looks_has_every_look():
    text = (DOCS / "guide" / "looks.md").read_text(encoding="utf-8")
    assert [preset.name for preset in presets.presets() if f"*{preset.name}*" not in text] == []
