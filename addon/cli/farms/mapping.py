# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules by which paths of one machine are those of another, as Open Job Description writes them into a file."""

import json
import re
from pathlib import PurePosixPath, PureWindowsPath

from ...pen.errors import EncreError

VERSION = "pathmapping-1.0"
_KINDS = {"POSIX": PurePosixPath, "WINDOWS": PureWindowsPath}


def read(path):
    """[(kind, source, destination)] of a file of rules, the longest source first. EncreError: it is none."""
    try:
        with open(path, encoding="utf-8") as file:
            told = json.load(file)
        if not told:  # a session without rules
            return []
        if told.get("version") != VERSION:
            raise EncreError(f"{path}: is of version {told.get('version')!r}; give rules of {VERSION}")
        rules = [(rule["source_path_format"].upper(), rule["source_path"], rule["destination_path"])
                 for rule in told.get("path_mapping_rules", [])]
        if not all(kind in _KINDS and isinstance(a, str) and isinstance(b, str) for kind, a, b in rules):
            raise TypeError
    except OSError as error:
        raise EncreError(f"{path}: can't be read ({error.strerror}); check the path") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise EncreError(f"{path}: holds no rules of {VERSION}; give the file that a session of Open Job Description "
                         "names") from None
    return sorted(rules, key=lambda rule: -len(rule[1]))


def apply(rules, path):
    """Where `path` lies by the first of the rules that fits."""
    for kind, source, destination in rules:
        pure = _KINDS[kind]
        try:
            rest = pure(path).relative_to(pure(source))
        except ValueError:
            continue
        if ".." in rest.parts:
            continue
        to = PureWindowsPath if re.match(r"[A-Za-z]:|\\\\", destination) else PurePosixPath
        return str(to(destination, *rest.parts))
    return path
