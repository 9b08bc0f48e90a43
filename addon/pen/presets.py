# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: named values of some of the scene's parameters, one JSON file each: Encre's own in the folder `presets`,
a user's where Blender keeps its user's files.

A file holds {"name", "description", "values": {id: value}}, values in the JSON form of `encre params --json`, perhaps
"pens": {"pen_2": what it is called}, a user's also the version of the "settings", of which it has all that are a matter
of looks; a PNG of the same name beside it is its picture. Adding a preset = adding a file. One of Encre's own
sets all that is a matter of looks, what it does not list to the default, so that it looks the same whatever was chosen
before; a user's sets what its file lists. It is data from strangers: nothing in it is run, and it opens no
other file.
"""

import functools
import json
import os
import shutil
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from . import library, plain, settings, slots
from .errors import EncreError, unknown
from .params import tidy

FOLDER = Path(__file__).parents[1] / "presets"
_OF_THE_JOB = "layers"  # the stage whose parameters tell what is rendered and saved: no matter of looks
_OF_THE_PAGE = "page_height"


@dataclass(frozen=True)
class Preset:
    path: Path
    name: str
    description: str
    values: dict
    listed: tuple  # the ids that its file lists
    pens: dict  # {pen: its name} of those of which it sets a row; "": it has none

    @property
    def id(self) -> str:
        """The file's name without its ending."""
        return self.path.stem

    @property
    def own(self) -> bool:
        """Whether it comes with Encre."""
        return self.path.parent == FOLDER

    @property
    def picture(self) -> Path:
        """Where its picture is, if there is one."""
        return self.path.with_suffix(".png")


def presets() -> tuple[Preset, ...]:
    """Encre's own, in the order of their files' names."""
    return tuple(read(path) for path in sorted(FOLDER.glob("*.json")))


def users(folder: Path) -> tuple[tuple[Preset, ...], list[str]]:
    """A user's in a folder, and a sentence for each file that can't be used."""
    found, wrong = [], []
    for path in sorted(folder.glob("*.json")):
        try:
            found.append(read(path))
        except EncreError as error:
            wrong.append(str(error))
    return tuple(found), wrong


def find(name: str, folder: Path | None = None) -> Preset:
    """The preset called `name`: its id or its name, in any case, with spaces, - or _, of Encre's own and those in a
    user's folder; or the file that `name` is the path of.

    Raises EncreError with the nearest ids if there is none.
    """
    if name.lower().endswith(".json"):
        return read(Path(name))
    known = (*presets(), *(users(folder)[0] if folder else ()))
    for preset in known:
        if _key(name) in (_key(preset.id), _key(preset.name)):
            return preset
    if os.path.isfile(name):
        raise EncreError(f"{name}: is no preset file, whose name ends in .json; rename it or choose another")
    raise EncreError(unknown("preset", name, [preset.id for preset in known]))


def _key(name):
    return name.strip().lower().replace("-", "_").replace(" ", "_")


def read(path: Path) -> Preset:
    """The preset in a file. EncreError: it can't be used."""
    try:
        return _read(path, path.stat().st_mtime_ns)
    except OSError as error:
        raise EncreError(f"the preset file {path} can't be read ({error.strerror}); check the path") from None


@functools.lru_cache(256)  # panels ask at every redraw
def _read(path, _changed):
    library.load()  # which may raise what is no fault of the preset
    try:
        data = _data(path)
        values = {**settings.since(data.get("settings", settings.VERSION)), **data["values"]}
        if refused := [id_ for id_ in values if not _holds(id_)]:
            raise EncreError(f"{refused[0]}: presets hold no images")
        set_ = {**_looks(), **values} if path.parent == FOLDER else values
        names = _names(data.get("pens", {}))
        named = {pen.id: names.get(pen.id, "") for pen in slots.pens()
                 if any(p.id in set_ for p in pen.rows.values())}
        return Preset(path, data["name"], data["description"], library.check(set_), tuple(values), named)
    except EncreError as error:
        raise EncreError(f"the preset file {path} can't be used: {error}; repair or remove it") from None
    except (TypeError, ValueError, AttributeError):
        raise EncreError(f"the preset file {path} can't be used: what it holds is no preset; repair or remove it") \
            from None


def _names(said):
    """{pen: its name} of what a file says of pens' names."""
    known = [pen.id for pen in slots.pens()]
    names: dict[str, str] = {}
    for pen, name in said.items():
        if pen not in known:
            raise EncreError(unknown("pen", pen, known))
        if not isinstance(name, str):
            raise EncreError(f"its pens' name {name!r} is no text")
        name = name.strip()
        if any(unicodedata.category(letter) in ("Cc", "Cs") for letter in name):
            raise EncreError(f"its pens' name {name[:20]!r} has letters that can't be shown")
        if len(name) > slots.LONGEST_NAME:
            raise EncreError(f"its pens' name {name[:20]!r}... is longer than {slots.LONGEST_NAME} letters")
        if name and name in names.values():
            raise EncreError(f"two of its pens are called {name!r}")
        names[pen] = name
    return names


@functools.cache
def _looks():
    """{id: default} of all that is a matter of looks, or that one of Encre's own lists."""
    ids = [p.id for p in library.params().values() if _of_looks(p)]
    ids += [id_ for path in sorted(FOLDER.glob("*.json")) for id_ in _data(path)["values"]]
    return {id_: library.params()[id_].default for id_ in ids}


def _of_looks(p):
    return p.stage != _OF_THE_JOB and p.type != "image" and p.id != _OF_THE_PAGE


def _data(path):
    """What the file holds, which has all that a preset must have."""
    try:
        data = json.loads(plain.text(path))
    except UnicodeDecodeError:
        raise EncreError("it is no text in UTF-8") from None
    except RecursionError:
        raise EncreError("its lists are nested without end") from None
    except ValueError as error:
        raise EncreError(f"it is no JSON ({error})") from None
    kinds = {"name": (str, "text"), "description": (str, "text"), "values": (dict, "object of settings"),
             "settings": (int, "whole number"), "pens": (dict, "object of names")}
    if not isinstance(data, dict):
        raise EncreError(f"it is no JSON object with {', '.join(list(kinds)[:3])}")
    for key, (kind, words) in kinds.items():
        if key not in data and key not in ("settings", "pens"):
            raise EncreError(f"it has no {key}")
        if not isinstance(data.get(key, kind()), kind) or key == "name" and not data[key].strip():
            raise EncreError(f"its {key} is no {words}")
    if data.get("settings", settings.VERSION) < min(settings.BEFORE) - 1:
        raise EncreError(f"its settings are of no version: {data['settings']}")
    return data


def _holds(id_):
    return id_ not in library.params() or library.params()[id_].type != "image"


def of(values: Mapping[str, Any]) -> dict[str, Any]:
    """What a preset keeps of a scene's values: how it looks, but not images, which are files of their own."""
    kept = {id_: value for id_, value in values.items()
            if library.params()[id_].stage != _OF_THE_JOB and _holds(id_)}
    for p in library.params().values():
        for term in p.enabled_if.split("&") if p.type == "image" else ():
            id_, _, items = term.partition("=")
            if kept.get(id_) in items.split("|"):  # what asks for an image
                del kept[id_]
    return kept


def write(path: Path, name: str, description: str, values: Mapping[str, Any],
          pens: Mapping[str, str] = MappingProxyType({})) -> None:
    """Writes a preset's file, whole or not at all; `pens`: names of those that have one. EncreError: it can't be
    written."""
    values = {id_: _short(value) for id_, value in library.check(values).items()}
    named = {"pens": dict(pens)} if pens else {}
    text = json.dumps({"name": name, "description": description, "settings": settings.VERSION, **named,
                       "values": values}, indent=2)
    _store(path, lambda part: part.write_text(text + "\n", encoding="utf-8"))


def _short(value):
    """Blender and the library keep single floats, whose decimals are fewer than a double's."""
    if isinstance(value, (list, tuple)):
        return [_short(x) for x in value]
    return tidy(value) if isinstance(value, float) else value


def copy(preset: Preset, path: Path) -> None:
    """Copies a preset's file and its picture. EncreError: it can't be done."""
    _store(path, lambda part: shutil.copyfile(preset.path, part))
    if preset.picture.is_file():
        _store(path.with_suffix(".png"), lambda part: shutil.copyfile(preset.picture, part))


def _store(path, write_to):
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_to(part)
        os.replace(part, path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise EncreError(f"{path}: can't be written ({error.strerror}); choose another place") from None


def file_name(name: str) -> str:
    """The file's name of a preset called `name`. EncreError: it is taken by one of Encre's own, or is no name."""
    id_ = "".join(char for char in _key(name) if char.isalnum() or char == "_").strip("_")
    if not id_:
        raise EncreError(f"{name!r} has no letter to name a file with; give another name")
    if id_ in {preset.id for preset in presets()}:
        raise EncreError(f"{name} is a preset of Encre's own; give another name")
    return id_ + ".json"


def remove(preset: Preset) -> None:
    """Deletes a user's preset and its picture. EncreError: it can't be done."""
    if preset.own:
        raise EncreError(f"{preset.name} comes with Encre and stays; choose one of your own")
    try:
        preset.path.unlink(missing_ok=True)
        preset.picture.unlink(missing_ok=True)
    except OSError as error:
        raise EncreError(f"{preset.path}: can't be deleted ({error.strerror}); delete it by hand") from None
