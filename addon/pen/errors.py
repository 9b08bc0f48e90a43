# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong, told in one sentence that names the thing and the cure."""

import difflib
from collections.abc import Iterable


class EncreError(Exception):
    """Something the user can mend; str() is one sentence that names the thing and the cure."""


class Cancelled(EncreError):
    """The progress callback returned False."""


_MOST_LISTED = 16  # names in one sentence
_ALIKE = 0.785     # names that a slip of the pen parts; at 0.77 ink_in_light would be near line_width
_LETTER = 1.2      # of short names, so many letters may be others


def unknown(kind: str, name: object, names: Iterable[str], listed: str = "") -> str:
    """One sentence about an unknown name: with the known ones that are near it or that it is a part of; where there are
    none, with all or the first of them. listed: what is said after that, of where all are found."""
    known, word = [str(each) for each in names], str(name).lower()
    alike = {each: difflib.SequenceMatcher(None, each.lower(), word).ratio() for each in known}
    enough = min(_ALIKE, 1 - _LETTER / max(len(word), 1))
    near = [each for each in known
            if alike[each] > max(enough, 0) or len(word) > 2 and word in each.lower()]
    near = sorted(near, key=lambda each: -alike[each])[:3]
    if near:
        cure = f"; did you mean {', '.join(near)}?"
    elif len(known) <= _MOST_LISTED:
        cure = f"; known are {', '.join(known)}"
    else:
        more = len(known) - _MOST_LISTED
        cure = "" if listed else f"; known are {', '.join(known[:_MOST_LISTED])} and {more} more"
    return f"{name or repr(name)}: unknown {kind}{cure}{listed}"


def shown(text: str) -> str:
    """`text` as it may be printed: names and metadata come from strangers, and a terminal obeys control characters.

    Marks that turn the direction of writing are shown as well.
    """
    return "".join(char if char.isprintable() else char.encode("unicode_escape", "surrogatepass").decode()
                   for char in text)
