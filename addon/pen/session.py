# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's session of the study (docs/study.md): its phases, what is counted and logged, and the text file of it.

The file begins with rows `Name: value`; then comes the camera, twice a second: a row of its place and one of its turn
(degrees about x, y and z), each `-----` where it is as it was; at last the answers and `End`. What changes meanwhile
(Mode, Thickness) stands as a row `Name: value` before the place from which on it holds. Nothing in it tells who
answered, nor when.
"""

import contextlib
import os
import random
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import degrees
from pathlib import Path
from typing import Any

from . import plain
from .errors import EncreError

EVERY = 0.5  # seconds between two places of the camera in the log
STEPS = (0.5, 0.7, 1.0, 1.4, 2.0)  # thickness that subjects may choose, as parts of the looks' own
_HEAD, _END, _SAME = "Encre study", "End", "-----"
_VERSION = 1


@dataclass(frozen=True)
class Question:
    """A choice between the two lower pictures."""

    key: str   # by which files name it
    text: str


LINES = (
    Question("Convention", "Look at nothing but how thick the lines are. Which of the two lower pictures is more like "
             "an animation drawn by hand, as you know them?"),
    Question("Aesthetics", "Again, look at nothing but how thick the lines are. Which of the two lower pictures do "
             "you like better?"))
LOOKS = (
    Question("Convention", "Which of the two lower pictures is more like one drawn by hand, as you know them?"),
    Question("Aesthetics", "Which of the two lower pictures do you like better?"))


@dataclass(frozen=True)
class Plan:
    """What a study asks of each of its people."""

    looks: tuple[str, str] = ("DYNAMIC", "BAKED")  # how files name them
    questions: tuple[Question, ...] = LINES
    open: tuple[str, ...] = ()  # questions that are answered in words
    slider: bool = False        # whether they may change how thick lines are
    flights: int = 2
    presses: int = 100          # keys, and ticks with a movement of the mouse, after which the questions come
    moves: int = 1000

    def check(self) -> None:
        """EncreError: it can't be asked."""
        if self.looks[0] == self.looks[1]:
            raise EncreError(f"{self.looks[0]}: both looks are the same; give two that differ")
        keys = [question.key for question in self.questions]
        if not keys:
            raise EncreError("there is no question; give one")
        for key in keys:
            if not re.fullmatch(r"[^\W\d_][\w -]{0,39}", key) or keys.count(key) > 1 or key in _RESERVED \
                    or key.startswith(("Open ", "Answer ")):
                raise EncreError(f"question {key!r}: needs a short name of its own, of letters; write "
                                 "--question 'Name: which of the two ...?'")


@dataclass
class Session:
    """One person's way through the phases. place: (x, y, z) of the camera and its turn in radians."""

    plan: Plan
    chance: random.Random = field(default_factory=random.SystemRandom)
    phase: str = "START"     # START, FLIGHT, EXPLORE, ANSWER, END
    flight: int = 0          # which of the flights it is, from 1
    mode: str = "PATH"       # PATH, FREE
    presses: int = 0
    moves: int = 0
    skipped: bool = False    # whether whoever leads the study opened the questions before the counts were full
    thickness: float = 1.0
    answers: dict[str, str] = field(default_factory=dict)  # key -> LEFT, RIGHT
    words: dict[int, str] = field(default_factory=dict)    # number of an open question -> its answer

    def __post_init__(self) -> None:
        first, second = self.plan.looks
        self.sides: tuple[str, str] = (first, second) if self.chance.random() < 0.5 else (second, first)
        self._rows: list[str] = []
        self._begun: float | None = None  # seconds at the first input
        self._next = 0.0
        self._last: list[str | None] = [None, None]
        self._told: dict[str, str] = {}
        self.seconds = 0.0

    def go_on(self) -> None:
        """To the next phase, where nothing but a key is awaited."""
        if self.phase == "START" or (self.phase == "FLIGHT" and self.flight < self.plan.flights):
            self.phase, self.flight = "FLIGHT", self.flight + 1
        elif self.phase == "FLIGHT":
            self.phase = "EXPLORE"
        if self.phase == "FLIGHT" and not self.plan.flights:
            self.phase = "EXPLORE"
        self._count(0, 0)

    @property
    def explores(self) -> bool:
        return self.phase in ("EXPLORE", "ANSWER")

    def pressed(self) -> None:
        self._count(1, 0)

    def moved(self) -> None:
        """A tick in which the mouse was moved in the free mode."""
        self._count(0, 1)

    def _count(self, presses, moves):
        if self.explores:
            self.presses += presses
            self.moves += moves
            if self.presses >= self.plan.presses and self.moves >= self.plan.moves:
                self.phase = "ANSWER"

    def skip(self) -> None:
        """Opens the questions though the counts are not full."""
        if self.phase == "EXPLORE":
            self.phase, self.skipped = "ANSWER", True

    def switch(self) -> None:
        self.mode = "FREE" if self.mode == "PATH" else "PATH"

    def log(self, now: float, place: Sequence[float], turn: Sequence[float]) -> None:
        """To be called often, with seconds of any clock: twice a second it notes where the camera is, from the first
        input on."""
        if not self.explores or (self._begun is None and not self.presses and not self.moves):
            return
        if self._begun is None:
            self._begun = self._next = now
        self.seconds = now - self._begun
        while now >= self._next:
            self._next += EVERY
            for name, value in ("Mode", self.mode), ("Thickness", f"{self.thickness:g}"):
                if self._told.get(name) != value:
                    self._rows.append(f"{name}: {value}")
                    self._told[name] = value
            rows = (_row(place), _row([degrees(angle) for angle in turn]))
            self._rows += [_SAME if row == last else row for row, last in zip(rows, self._last, strict=True)]
            self._last = list(rows)

    @property
    def missing(self) -> list[str]:
        """Keys of the questions that have no answer."""
        return [question.key for question in self.plan.questions if question.key not in self.answers]

    def text(self, about: Mapping[str, Any]) -> str:
        """The file's; about: what else it is to say, {name: value}. EncreError: an answer is missing."""
        if self.missing:
            raise EncreError(f"{', '.join(self.missing)}: not answered; choose one of the two")
        head = {**about, "Looks": ", ".join(self.plan.looks), "Left": self.sides[0], "Right": self.sides[1],
                "Key presses": self.presses, "Ticks with mouse movement": self.moves,
                "Skipped": "yes" if self.skipped else "no", "Seconds": f"{self.seconds:.1f}"}
        said = [f"{name}: {_line(value)}" for name, value in head.items()]
        rows = [f"{_HEAD} {_VERSION}", *said, "", *self._rows, ""]
        rows += [f"{question.key}: {self.sides[self.answers[question.key] == 'RIGHT']}"
                 for question in self.plan.questions]
        for number, text in enumerate(self.plan.open, 1):
            rows += [f"Open {number}: {_line(text)}", f"Answer {number}: {_line(self.words.get(number, ''))}"]
        return "\n".join([*rows, _END, ""])

    def save(self, folder: str | os.PathLike, about: Mapping[str, Any]) -> Path:
        """Writes the file, whole or not at all, under a number that tells nothing. Returns its path and ends the
        session. EncreError: an answer is missing; OSError: it can't be written."""
        path = store(Path(folder), self.text(about), self.chance.randrange)
        self.phase = "END"
        return path


def store(folder: Path, text: str, number: Callable[[int, int], int]) -> Path:
    """Writes a text into a new file with a number for its name; a reader finds it whole or not at all."""
    folder.mkdir(parents=True, exist_ok=True)
    while (path := folder / f"{number(10 ** 7, 10 ** 8)}.txt").exists():
        pass
    part = path.with_name(f".{path.name}.part")
    try:
        with open(part, "x", encoding="utf-8", newline="\n") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink()
        raise
    return path


_RESERVED = {"Looks", "Left", "Right", "Seconds", "Skipped", "Mode", "Thickness", _END}


def _row(numbers):
    return " ".join(f"{number + 0.0:.5g}" for number in numbers)


def rated(rate: float) -> str:
    """Pictures a second as text, which is never 0 where there are some."""
    return f"{rate:.1f}" if rate >= 1 else f"{rate:.2g}"


def _line(value):
    """In one row, whatever was typed."""
    return " ".join(str(value).split())


# ---- reading -----------------------------------------------------------------------------------------------------


@dataclass
class Record:
    """What a file says. track: (seconds, place, turn in degrees, mode, thickness), one for each half second."""

    path: Path
    looks: tuple[str, str]
    sides: tuple[str, str]
    seconds: float
    answers: dict[str, str]          # key -> the look that was chosen
    words: dict[str, str]            # open question -> its answer
    track: list[tuple[float, tuple[float, ...], tuple[float, ...], str, float]]
    head: dict[str, str]


def read(path: Path) -> Record:
    """EncreError: it is no whole file of a session."""
    try:
        text = plain.text(path)
    except (OSError, UnicodeDecodeError):
        raise EncreError(f"{path}: can't be read as text; give a file that `encre study` wrote") from None
    rows = text.split("\n")
    if not rows[0].startswith(_HEAD):
        raise EncreError(f"{path}: is no file of a session; give one that `encre study` wrote")
    if rows[0] != f"{_HEAD} {_VERSION}":
        raise EncreError(f"{path}: was written by another version of Encre ({rows[0]}); read it with that one")
    try:
        return _read(path, rows)
    except (ValueError, KeyError, IndexError):
        raise EncreError(f"{path}: is cut off or was changed by hand; leave it out, or get it from a copy") from None


def _read(path, rows):
    if rows[-2:] != [_END, ""]:
        raise ValueError
    first = rows.index("")
    last = rows.index("", first + 1)
    head = dict(row.split(": ", 1) if ": " in row else (row.rstrip(":"), "") for row in rows[1:first])
    looks, sides = tuple(head["Looks"].split(", ")), (head["Left"], head["Right"])
    if len(looks) != 2 or set(looks) != set(sides):
        raise ValueError
    answers, words, asked = {}, {}, {}
    for row in rows[last + 1:-2]:
        key, value = row.split(": ", 1)
        if match := re.fullmatch(r"(Open|Answer) (\d+)", key):
            if match[1] == "Open":
                asked[match[2]] = value
            else:
                words[asked[match[2]]] = value
        elif value in looks:
            answers[key] = value
        else:
            raise ValueError
    return Record(path, looks, sides, float(head["Seconds"]), answers, words, _track(rows[first + 1:last]), head)


def _track(rows):
    """The camera's rows."""
    track: list[tuple] = []
    known: list[tuple[float, ...]] = [(0.0,) * 3, (0.0,) * 3]
    now, at = {"Mode": "PATH", "Thickness": "1"}, 0
    for row in rows:
        name, colon, value = row.partition(": ")
        if colon:
            now[name] = value
            continue
        if row != _SAME:
            known[at] = tuple(map(float, row.split()))
            if len(known[at]) != 3:
                raise ValueError
        at = 1 - at
        if not at:
            track.append((len(track) * EVERY, *known, now["Mode"], float(now["Thickness"])))
    if at:
        raise ValueError
    return track


def folder(path: Path) -> list[Record]:
    """The Records of all files of sessions in a folder, in the order of their names. EncreError: there are none, or
    one can't be read."""
    files = sorted(file for file in path.glob("*.txt") if re.fullmatch(r"\d{8}\.txt", file.name))
    if not files:
        raise EncreError(f"{path}: holds no file of a session, such as 98897121.txt; give the folder that --output "
                         "named")
    return [read(file) for file in files]
