# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels in other languages: every label has its entry, and no entry is of what nothing says."""

import languages
import pytest

FILES = sorted(languages.FOLDER.glob("*.json"))
HOW = "run `make languages`, then fill what is \"\" in addon/languages/, in the words of Blender's own panels"


def test_the_texts_are_found_in_table_and_sources():
    labels, tips = languages.said()
    assert {"Hatching", "Sobel", "Smudge Range", "Line Group", "Reset All", "Subtract", "Mark Part", "Looks", "Tone",
            "{} washes out ink", "In a Folder", "Apply Look"} <= set(labels)
    assert {"Color of the ink", "No grain", "Remove the chosen level", "The scene's settings",
            "Reset to the default value", "Paint Control"} - set(tips) == {"Paint Control"}
    assert len(labels) == len(set(labels)) > 160 and len(tips) > 160


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_label_has_its_entry_and_none_is_stale(path):
    missing, _, stale = languages.judged(languages.read(path))
    assert (missing, stale) == ([], []), f"{path.name}: {HOW}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_entries_fit_in_the_place_of_their_texts(path):
    labels = set(languages.said()[0])
    for text, words in languages.read(path).items():
        assert words.count("{}") == text.count("{}") and words == words.strip(), text
        assert not words.endswith(".") and "\n" not in words, text
        assert text not in labels or len(words) < 16 + 1.6 * len(text), text


def test_there_are_two_languages():
    assert [path.stem for path in FILES] == ["de", "fr"]
