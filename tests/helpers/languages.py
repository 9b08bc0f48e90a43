# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels say, and whether every language has it.

    python tests/helpers/languages.py [--write]

prints, for each file in addon/languages/, what it lacks and what nothing says any more. --write puts what is missing
there as "" for a translator to fill, takes away what is stale, and sorts all as below: the library's table, then what
stands in addon/blender/ as label, name, description or text, or is marked by n_(), iface_() or tip_().
"""

import ast
import json
import sys
from pathlib import Path

from encre.pen import layers, library, presets, slots

ADDON = Path(__file__).resolve().parents[2] / "addon"
FOLDER = ADDON / "languages"
NAMES = {"Encre", ""}  # the same everywhere


def said():
    """(labels, tips): the texts that Blender translates when it shows them, each in order and once."""
    labels, tips = {}, {}
    for stage in library.stages():
        labels[stage.label], tips[stage.help] = 0, 0
        for p in stage.params:
            labels[p.label], tips[p.help] = 0, 0
            for item in p.items:
                labels[item.label], tips[item.help] = 0, 0
    for tone in slots.tones():
        labels.update({tone.row_label(p): 0 for p in tone.rows.values()})
    for control in library.controls().values():
        labels[control.label] = 0
    for name in layers.DRAWN:
        help_ = library.load().output_help[name]
        tips[help_[0].upper() + help_[1:]] = 0
    for preset in presets.presets():
        tips[preset.description] = 0
        labels.update({name: 0 for name in preset.pens.values()})
    for path in sorted((ADDON / "blender").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for kind, text in _texts(node):
                {"label": labels, "tip": tips}[kind][text] = 0
    labels = [text for text in labels if text not in NAMES]
    return labels, [text for text in tips if text not in NAMES and text not in labels]


def _texts(node):
    """("label" or "tip", text) of what a node of the source says by itself."""
    found = []
    if isinstance(node, ast.ClassDef) and node.name.startswith("ENCRE_"):
        found = [("tip", ast.Constant(ast.get_docstring(node)))]
    elif isinstance(node, ast.Assign):
        found = [("label", node.value) for target in node.targets if getattr(target, "id", "") == "bl_label"]
    elif isinstance(node, ast.Call):
        called = getattr(node.func, "id", getattr(node.func, "attr", ""))
        if called in ("n_", "iface_", "tip_"):
            found = [("tip" if called == "tip_" else "label", node.args[0])]
        elif called == "Own":
            found = [("label", node.args[2]), ("tip", node.args[3])]
        kinds = {"text": "label", "heading": "label", "name": "label", "description": "tip"}
        if "name" in (given := {keyword.arg: keyword.value for keyword in node.keywords}) and not _property(called):
            del given["name"]
        found += [(kinds[arg], value) for arg, value in given.items() if arg in kinds]
        for item in getattr(given.get("items"), "elts", ()):
            if isinstance(item, ast.Tuple):
                found += [("label", item.elts[1]), ("tip", item.elts[2])]
    return [(kind, value.value) for kind, value in found
            if isinstance(value, ast.Constant) and isinstance(value.value, str)]


def _property(called):
    """Whether what is called makes a property; other things' names are no labels."""
    return called.endswith("Property") or called == "number"


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


def judged(entries):
    """(labels without an entry, tips without one, entries of what nothing says) of a language."""
    labels, tips = said()
    return ([text for text in labels if not entries.get(text)], [text for text in tips if not entries.get(text)],
            [text for text in entries if text not in {*labels, *tips}])


def main():
    labels, tips = said()
    for path in sorted(FOLDER.glob("*.json")):
        entries = read(path)
        if "--write" in sys.argv[1:]:
            kept = {text: entries.get(text, "") for text in (*labels, *tips)}
            path.write_text(json.dumps(kept, indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
        for words, texts in zip(("missing", "missing, a tooltip", "stale"), judged(entries), strict=True):
            for text in texts:
                print(f"{path.name}: {words}: {text}")


if __name__ == "__main__":
    main()
