# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong, told in one sentence that names the thing and the cure."""

import difflib
from collections.abc import Iterable


class EncreError(Exception):
    """Something the user can mend; str() is one sentence that names the thing and the cure."""


class Cancelled(EncreError):
    """The progress callback returned False."""


_MOST_LISTED = 16  # names in one sentence


def unknown(kind: str, name: object, names: Iterable[str], listed: str = "") -> str:
    """One sentence about an unknown name: with the nearest known ones or, where none is near and they are few, all.
    listed: what is said after that, of where all are found."""
    known = [str(each) for each in names]
    near = difflib.get_close_matches(str(name), known, 3, 0.5)
    if not near and len(known) > _MOST_LISTED:
        near = difflib.get_close_matches(str(name), known, 3, 0)
    cure = f"did you mean {', '.join(near)}?" if near else f"known are {', '.join(known)}"
    return f"{name}: unknown {kind}; {cure}" + listed


def shown(text: str) -> str:
    """`text` as it may be printed: names and metadata come from strangers, and a terminal obeys control characters.

    Marks that turn the direction of writing are shown as well.
    """
    return "".join(char if char.isprintable() else char.encode("unicode_escape", "surrogatepass").decode()
                   for char in text)
