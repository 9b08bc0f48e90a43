# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: named values of some of the scene's parameters, one JSON file each in the folder `presets`.

A file holds {"name", "description", "values": {id: value}}, values in the JSON form of `encre params --json`.
Adding a preset = adding a file. A preset sets the parameters that it lists and leaves all others as they are.
"""

import json
from dataclasses import dataclass
from pathlib import Path

from . import library
from .errors import EncreError, unknown

FOLDER = Path(__file__).parents[1] / "presets"


@dataclass(frozen=True)
class Preset:
    id: str  # the file's name without its ending
    name: str
    description: str
    values: dict


def presets() -> tuple[Preset, ...]:
    """All presets, in the order of their files' names."""
    return tuple(_read(path) for path in sorted(FOLDER.glob("*.json")))


def find(name: str) -> Preset:
    """The preset called `name`: its id or its name, in any case, with spaces, - or _.

    Raises EncreError with the nearest names if there is none.
    """
    known = presets()
    for preset in known:
        if _key(name) in (_key(preset.id), _key(preset.name)):
            return preset
    raise EncreError(unknown("preset", name, [preset.name for preset in known]))


def _key(name):
    return name.strip().lower().replace("-", "_").replace(" ", "_")


def _read(path):
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        return Preset(path.stem, data["name"], data["description"], library.check(data["values"]))
    except (OSError, ValueError, KeyError, TypeError, EncreError) as error:
        raise EncreError(f"the preset file {path} can't be used: {error}; repair or remove it") from None
