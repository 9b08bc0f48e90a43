# SPDX-License-Identifier: GPL-3.0-or-later
"""Pens and tones as slots: groups of rows that are alike, one for each pen and one for each level of light.

The table has them as rows like all others, so that styles, presets and files know nothing of slots; here is which rows
are whose. One more: what csrc/ink/pen.rows.h and csrc/tones/tones.rows.h say.
"""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from . import library
from .errors import EncreError, unknown
from .params import PENS, TONES, Param

LONGEST_NAME = 63  # letters of a pen's name, as Blender's data have


@dataclass(frozen=True)
class Slot:
    """`rows`: {what a row says of any such slot: the row}, in the order in which they are shown."""

    id: str
    kind: str  # "pen" or "tone"
    label: str
    rows: Mapping[str, Param]

    def row_label(self, p: Param) -> str:
        """What one of its rows is called where it is clear whose it is: Pitch, not Pitch 2."""
        number = self.id.rpartition("_")[2]
        return p.label.removesuffix(f" {number}") if self.kind == "tone" else p.label


@functools.cache
def pens() -> tuple[Slot, ...]:
    """The pens."""
    rows = {pen: {id_.removeprefix(f"{pen}_"): p for id_, p in library.params().items()
                  if p.stage == pen and id_.startswith(f"{pen}_")} for pen in PENS.values()}
    labels = {item.id: item.label for item in library.params()["line_outline_pen"].items}

    def shown(pen):
        order = list(rows[pen])  # an image follows what wants it
        return {what: rows[pen][what] for what in sorted(order,
                                                         key=lambda what: order.index(what.removesuffix("_image")))}

    return tuple(Slot(pen, "pen", labels[item], shown(pen)) for item, pen in PENS.items())


@functools.cache
def tones() -> tuple[Slot, ...]:
    """The tones of the levels of light, the darkest first; their first row says what they are."""
    params = library.params()
    return tuple(Slot(tone, "tone", params[tone].label, {
        id_.removeprefix(tone).lstrip("_"): p for id_, p in params.items() if f"{id_}_".startswith(f"{tone}_")})
        for tone in TONES)


KINDS = {"pen": pens, "tone": tones}


@functools.cache
def _owners():
    return {p.id: slot for slot in (*pens(), *tones()) for p in slot.rows.values() if p.id.startswith(slot.id)}


def of(id_: str) -> Slot | None:
    """The slot that a row is of, None if it is of none."""
    return _owners().get(id_)


def repeats(p: Param) -> bool:
    """Whether a row says of a later pen or tone what one says of the first; what a tone is stands for itself."""
    slot = of(p.id)
    return slot is not None and slot not in (pens()[0], tones()[0]) and p.id != slot.id


def find(id_: str) -> Slot:
    """The slot with this id. EncreError: there is none."""
    known = {slot.id: slot for slot in (*pens(), *tones())}
    if id_ not in known:
        raise EncreError(unknown("pen or tone", id_, known))
    return known[id_]


def copied(source: Slot, target: Slot, value: Callable[[Param], Any]) -> dict[str, Any]:
    """{id: value} with which `target` is as `source` is, whose values value(row) tells."""
    if source.kind == "tone":
        while value(source.rows[""]) == "SAME":  # the first is none
            source = tones()[tones().index(source) - 1]
    return {p.id: value(source.rows[what]) if what in source.rows else p.default for what, p in target.rows.items()}
