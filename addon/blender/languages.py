# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels say in other languages: a file for each in the package's folder `languages`, {"English": "its words"}.

Blender looks texts up when it shows them, its own dictionary first. Labels therefore have a context of ours: Blender's
"Lines" may be those of a text. tests/helpers/languages.py finds the texts in the sources and tells what is missing.
"""

import json
from pathlib import Path

import bpy

FOLDER = Path(__file__).parents[1] / "languages"
CONTEXT = "Encre"
# Tooltips and texts in layouts are of no context, labels of operators of one of their own.
_CONTEXTS = (CONTEXT, bpy.app.translations.contexts.default, bpy.app.translations.contexts.operator_default)
# How a property is given its context. 3.4 can't: there words that Blender knows are Blender's.
OURS = {"translation_context": CONTEXT} if "translation_context" in bpy.props.BoolProperty.__doc__ else {}

iface_ = bpy.app.translations.pgettext_iface
tip_ = bpy.app.translations.pgettext_tip


def n_(text):
    """The text itself: marks one that Blender translates when it shows it."""
    return text


def texts():
    """{language: {(context, English): its words}}"""
    from ..pen import library
    from . import properties  # which needs the words of here

    found = {}
    for path in sorted(FOLDER.glob("*.json")):
        words = {english: text for english, text in json.loads(path.read_text(encoding="utf-8")).items() if text}
        for p in library.params().values():  # tooltips are made of several texts
            if p.help in words:
                words[properties.tooltip(p)] = properties.tooltip(p, lambda text, words=words: words.get(text, text))
        found[path.stem] = {(context, english): text for context in _CONTEXTS for english, text in words.items()}
    return found


def register():
    bpy.app.translations.register(__package__, texts())


def unregister():
    bpy.app.translations.unregister(__package__)
