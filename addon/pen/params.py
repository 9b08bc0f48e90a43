# SPDX-License-Identifier: GPL-3.0-or-later
"""The parameter table in Python, and the forms in which values of parameters come: typed, as JSON, as text."""

import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .colour import decode_srgb
from .errors import EncreError, unknown

MAX_LEVELS = 16
_IMAGES = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "images")
_TYPES = ("bool", "int", "float", "enum", "color", "image", "levels")  # in the order of enum encre_type
_UNLIMITED = float(np.finfo(np.float32).max)


@dataclass(frozen=True)
class Item:
    id: str
    label: str
    help: str
    number: int


@dataclass(frozen=True)
class Param:
    """One row of a stage's table. `default` has the form that check() gives values of this type."""

    id: str
    stage: str
    type: str
    scope: str
    label: str
    help: str
    unit: str
    enabled_if: str
    default: object
    hard_min: float | None
    hard_max: float | None
    soft_min: float
    soft_max: float
    items: tuple[Item, ...]
    switch: bool  # whether its stage draws at all
    offset: int = field(repr=False)

    @property
    def number(self) -> dict[str, int]:
        """Enum item id -> number."""
        return {item.id: item.number for item in self.items}


@dataclass(frozen=True)
class Stage:
    id: str
    label: str
    help: str
    params: tuple[Param, ...]

    @property
    def switch(self) -> Param | None:
        """The parameter that turns the stage off; None: it has none."""
        return next((p for p in self.params if p.switch), None)


@dataclass(frozen=True)
class Control:
    """A painted control, a channel of the layer `controls`: what white (1) and black (-1) do, and the pass of a saved
    file, with its channel, in which it is kept. Meshes carry it as the attribute encre_<name>."""

    name: str
    label: str
    white: str
    black: str
    saved: str
    channel: int

    @property
    def attribute(self) -> str:
        return f"encre_{self.name}"


def control(c: Any) -> Control:
    """The Control that an encre_control_info tells."""
    return Control(text_of(c.name), text_of(c.label), text_of(c.white), text_of(c.black), text_of(c.saved), c.channel)


def text_of(b: bytes | None) -> str:
    """A string of C's; NULL is empty."""
    return (b or b"").decode()


def terms(rule: str, value: Callable[[str], Any]) -> dict[str, bool]:
    """{term: whether it is true} of an `enabled_if`, of what value(id) gives."""

    def true(term):
        if term.startswith("!"):
            return not true(term[1:])
        id_, _, items = term.partition("=")
        return value(id_) in items.split("|") if items else bool(value(id_))

    return {term: true(term) for term in rule.split("&")} if rule else {}


class Chosen(NamedTuple):
    """An image that a parameter names: the parameter's id, and what settings call the image, a path or a name in
    Blender."""

    id: str
    name: str


def shipped(p: Param, values: Mapping[str, Any]) -> str | None:
    """The file of ours that is read where an image is not asked for, because the enum that would ask for it has another
    item: images/<enum>/<item>.png. None: there is none."""
    for term in p.enabled_if.split("&"):
        id_, _, items = term.partition("=")
        if items and values[id_] not in items.split("|"):
            path = os.path.join(_IMAGES, id_, f"{values[id_].lower()}.png")
            return path if os.path.exists(path) else None
    return None


def asked(p: Param, values: Mapping[str, Any]) -> bool:
    """Whether values ask for a parameter by its `enabled_if`."""
    return all(terms(p.enabled_if, values.__getitem__).values())


TONES = tuple(f"tone_{n}" for n in range(1, 7))  # of the levels of light, the darkest first

PENS = {"PEN_1": "pen_1", "PEN_2": "pen_2", "PEN_3": "pen_3"}  # the item of a kind of line that names it: its rows
LINES = ("outline", "contact", "inner", "crease", "intersection", "material", "color", "shadow", "mirror", "suggestive",
         "mark", "hidden")  # the kinds: line_outline_pen
_VARIES = ("pressure", "wobble", "rough", "gaps", "dash", "dry", "strip", "overshoot")


def pens(values: Mapping[str, Any]) -> set[str]:
    """The pens that some kind of line is drawn by."""
    return {PENS[values[f"line_{kind}_pen"]] for kind in LINES}


def sticking_pens(values: Mapping[str, Any]) -> bool:
    """Whether a hand that draws lines sticks to surfaces."""
    return values["use_lines"] and any(values[f"{pen}_{what}"] for pen in pens(values) for what in _VARIES)


def leaves_out_lines(values: Mapping[str, Any]) -> bool:
    """Whether lines are left out where there are too many: by chance that sticks to surfaces, where they are known."""
    return values["use_lines"] and values["line_density"] < 1 and values["line_fewer"] > 0


def fills(values: Mapping[str, Any], *tones: str) -> bool:
    """Whether any of these tones fills a level of light with these values."""
    return values["use_tones"] and any(values[id_] in tones for id_ in TONES)


def rubs(values: Mapping[str, Any]) -> bool:
    """Whether anything rubs over the paper's heights."""
    return (values["use_lines"] and values["pen_1_grain"] > 0) or (
        values["use_wash"] and values["wash_granulation"] > 0) or (
        (values["use_hatching"] or fills(values, "GRAIN")) and values["hatch_amount"] > 0)


def _fills(values, *spaces):
    return values["use_tones"] and any(values[f"{id_}_space"] in spaces
                                       and values[id_] not in ("NONE", "SAME", "SOLID", "GRAIN") for id_ in TONES)


def fills_surfaces(values: Mapping[str, Any]) -> bool:
    """Whether any tone sticks to surfaces."""
    return _fills(values, "SURFACE", "OBJECT")


def fills_sheets(values: Mapping[str, Any]) -> bool:
    """Whether any tone lies on things' sheets."""
    return _fills(values, "FLAT")


def strokes_along_uv(values: Mapping[str, Any]) -> bool:
    """Whether strokes that stick to surfaces follow UV maps."""
    return values["use_tones"] and values["tone_strokes"] == "UV" and any(
        values[id_] == "HATCH" and values[f"{id_}_space"] in ("SURFACE", "OBJECT") for id_ in TONES)


def strokes_pitches(values: Mapping[str, Any]) -> list[float | None]:
    """The pitches of tones that are strokes or spots, which reach over other pixels; None: it is the thing's own."""
    return [None if values[f"{id_}_space"] == "OBJECT" else values[f"{id_}_pitch"] for id_ in TONES
            if values["use_tones"] and values[id_] in ("HATCH", "STIPPLE")]


def screens_pitches(values: Mapping[str, Any]) -> list[float]:
    """The pitches of tones that are dots and lines of a size on the screen."""
    return [values[f"{id_}_pitch"] for id_ in TONES if values["use_tones"]
            and values[id_] in ("DOTS", "LINES", "CROSS") and values[f"{id_}_space"] != "OBJECT"]


def _levels(levels):
    """encre_levels -> list of tuples (i,), (i, t, w) or (i, t, w, r, g, b)."""
    out = []
    for k in range(levels.count):
        level = levels.level[k]
        v = tuple(tidy(x) for x in (level.intensity, level.threshold, level.transition, *level.color))
        v = v[:3] if v[3:] == (1, 1, 1) else v
        out.append(v[:1] if k == 0 and len(v) == 3 else v)
    return out


def tidy(x: float) -> float:
    """The shortest decimal that is this float32: 0.9, not 0.8999999762."""
    return float(str(np.float32(x)))


def stage(s: Any) -> Stage:
    """The Stage that an encre_stage_info tells."""
    id_ = text_of(s.id)
    return Stage(id_, text_of(s.label), text_of(s.help), tuple(_param(id_, s.params[k]) for k in range(s.n_params)))


def _param(stage_id, r):
    """The Param that an encre_param_info tells."""
    kind = _TYPES[r.type]
    items = tuple(Item(text_of(x.id), text_of(x.label), text_of(x.help), x.number)
                  for x in (r.items[k] for k in range(r.n_items)))
    value = r.value[0]
    default = {"bool": lambda: bool(value), "int": lambda: int(value), "float": lambda: tidy(value),
               "enum": lambda: next(x.id for x in items if x.number == int(value)),
               "color": lambda: tuple(tidy(x) for x in r.value), "image": lambda: None,
               "levels": lambda: _levels(r.levels.contents)}[kind]()
    numeric = kind in ("int", "float")
    limit = int if kind == "int" else tidy
    return Param(text_of(r.id), stage_id, kind, ("frame", "surface")[r.scope], text_of(r.label), text_of(r.help),
                 text_of(r.unit), text_of(r.enabled_if), default,
                 limit(r.hard_min) if numeric else None,
                 limit(r.hard_max) if numeric and r.hard_max < _UNLIMITED else None,
                 limit(r.soft_min), limit(r.soft_max), items, bool(r.is_switch), r.offset)


def _number(p, value):
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise EncreError(f"{p.id}: {value!r} is not a number; give one")
    low, high = p.hard_min, p.hard_max
    try:
        number = float(value)
    except OverflowError:
        raise EncreError(f"{p.id}: a whole number of {len(str(value))} digits is out of range; give a smaller one") \
            from None
    # Blender and the library keep single floats: the one nearest to a limit counts as the limit itself.
    kept = np.float32 if p.type == "float" else float
    with np.errstate(over="ignore"):
        least, given, most = (kept(x) for x in (low, number, math.inf if high is None else high))
    if not (math.isfinite(given) and least <= given <= most):
        limits = f"from {low:g} to {high:g}" if high is not None else f"of {low:g} or more"
        raise EncreError(f"{p.id}: {value:g} is out of range; give a value {limits}")
    return number


def _numbers(p, value, counts, form):
    try:
        numbers = [float(x) for x in value]
    except (TypeError, ValueError, OverflowError):
        numbers = []
    if isinstance(value, str) or len(numbers) not in counts or not all(0 <= x < math.inf for x in numbers):
        raise EncreError(f"{p.id}: {value!r} is not {form}; give numbers of 0 or more")
    return tuple(numbers)


def normal(p: Param, value: Any) -> Any:
    """`value` in the form of its type, or EncreError."""
    if p.type == "bool":
        if not isinstance(value, (bool, np.bool_)) and value not in (0, 1):
            raise EncreError(f"{p.id}: {value!r} is neither on nor off; give one of them")
        return bool(value)
    if p.type == "int":
        number = _number(p, value)
        if number != int(number):
            raise EncreError(f"{p.id}: {value:g} is not a whole number; give one")
        return int(number)
    if p.type == "float":
        return _number(p, value)
    if p.type == "enum":
        if not isinstance(value, str) or value not in p.number:
            raise EncreError(f"{p.id}: " + unknown("value", value, p.number))
        return value
    if p.type == "color":
        return _numbers(p, value, (3,), "a color r, g, b")
    if p.type == "levels":
        if isinstance(value, str) or not isinstance(value, Sequence) or not 1 <= len(value) <= MAX_LEVELS:
            raise EncreError(f"{p.id}: {value!r} is not a list of 1 to {MAX_LEVELS} levels; "
                             "give intensity, threshold, transition for each")
        form = "a level (intensity, threshold, transition, perhaps r, g, b; the first an intensity, perhaps r, g, b)"
        first, *rest = [_numbers(p, x, (3, 6) if k else (1, 3, 4, 6), form) for k, x in enumerate(value)]
        return [(first[0], 0.0, 0.0, *first[1:]) if len(first) == 4 else first, *rest]
    if value is not None and not isinstance(value, (str, os.PathLike)):
        raise EncreError(f"{p.id}: {value!r} is not the path of an image; give one")
    return os.fspath(value) if value else None


_WORDS = {"on": True, "yes": True, "true": True, "1": True, "off": False, "no": False, "false": False, "0": False}


def read(p: Param, text: str) -> Any:
    """A value from the command line's text: on/off, a number, an item, r,g,b, a path, or levels "a; b; c".

    A colour may also be #rrggbb, which is encoded as on screens.
    """
    text = text.strip()
    try:
        if p.type == "bool":
            return _WORDS[text.lower()]
        if p.type in ("int", "float"):
            return float(text)
        if p.type == "enum":
            return text.upper()
        if p.type == "color" and re.fullmatch("#[0-9A-Fa-f]{6}", text):
            return [float(x) for x in decode_srgb(np.array(list(bytes.fromhex(text[1:]))) / 255)]
        if p.type == "color":
            return [float(x) for x in text.split(",")]
        if p.type == "levels":
            return [[float(x) for x in level.split(",")] for level in text.split(";")]
        return None if text.lower() == "none" else text
    except (ValueError, KeyError):
        form = {"bool": "on or off", "color": "r,g,b or #rrggbb", "levels": '"0.5; 0.7,0.5,0.025; ..."'}.get(
            p.type, "a number")
        raise EncreError(f"{p.id}: {text!r} can't be read; give {form}") from None


def _draws(stage, values):
    """Whether a stage reads its images."""
    if stage.switch:
        return values[stage.switch.id]
    return stage.id in pens(values) if stage.id in PENS.values() else rubs(values)


def chosen(stages: Sequence[Stage], every: Sequence[Mapping]) -> list[list[Chosen]]:
    """For each style the images that are read when these values of all parameters draw. EncreError: one should be read,
    and none is given."""
    found: list[list[Chosen]] = [[] for _ in every]
    for one in stages:
        images = [p for p in one.params if p.type == "image"]
        drawn = [_draws(one, values) for values in every] if images else []
        for p in images:
            # an image of the frame is in the scene's block, whichever style reads it
            reading = drawn if p.scope == "surface" else [any(drawn)]
            for values, style, reads in zip(every, found, reading, strict=False):
                if reads and (own := shipped(p, values)):
                    style.append(Chosen(p.id, own))
                elif reads and asked(p, values):
                    if not values[p.id]:
                        raise EncreError(f"{p.id}: an image is to be read but none is given; choose an image")
                    style.append(Chosen(p.id, values[p.id]))
    return found
