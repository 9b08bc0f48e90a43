# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong, told in one sentence that names the thing and the cure."""

import difflib
from collections.abc import Iterable


class EncreError(Exception):
    """Something the user can mend; str() is one sentence that names the thing and the cure."""


class Cancelled(EncreError):
    """The progress callback returned False."""


def unknown(kind: str, name: object, names: Iterable[str]) -> str:
    """One sentence about an unknown name, with the nearest known ones."""
    near = difflib.get_close_matches(str(name), list(names), 3, 0.5)
    cure = f"did you mean {', '.join(near)}?" if near else f"known are {', '.join(names)}"
    return f"{name}: unknown {kind}; {cure}"


def shown(text: str) -> str:
    """`text` as it may be printed: names and metadata come from strangers, and a terminal obeys control characters.

    Marks that turn the direction of writing are shown as well.
    """
    return "".join(char if char.isprintable() else char.encode("unicode_escape", "surrogatepass").decode()
                   for char in text)
