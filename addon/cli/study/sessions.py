# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre study`: a window of Blender's in which people compare two looks; what came of it; how many people it takes."""

import os
import shutil
from pathlib import Path

from ...pen import session
from ...pen.errors import EncreError, shown
from ...pen.session import Question
from ..child import Blender
from ..progress import Progress, put
from ..render import CHOICES

INSIDE = Path(__file__).with_name("windowed.py")


def run(scene, folder, *, left="dynamic", right="baked", questions=(), open_=(), slider=False, flights="ASK",
        presses=100, moves=1000, values=None, size=None, play=None, blender=None, say=print, verbose=False):
    """Opens the window and returns when it is closed; tells of each file that was written.

    size: (width, height) of the window, None: the whole screen; play: a file of a session to show again instead.
    Raises EncreError: there is no Blender with a window, or the scene won't do.
    """
    program = shutil.which(blender or "blender")
    if not program:
        raise EncreError(f"--blender {blender}: is not a program that can be run; give the path of Blender's" if blender
                         else "a study needs Blender's window, and there is no program blender on PATH: name it with "
                         "--blender PATH")
    where = ["-p", "0", "0", *map(str, size)] if size else ["--window-fullscreen"]
    left, right = (os.path.abspath(look) if os.path.isfile(look) else look for look in (left, right))
    job = {"scene": os.path.abspath(scene), "ending": ".png", "values": values or {}, **CHOICES,
           "study": {"folder": os.path.abspath(folder) if folder else "", "looks": (left, right),
                     "questions": [(question.key, question.text) for question in questions], "open": list(open_),
                     "slider": slider, "flights": flights, "presses": presses, "moves": moves,
                     "play": play and os.path.abspath(play)}}
    if play:
        session.read(Path(play))
    progress = Progress(say, verbose=verbose)
    with Blender([program, *where, "--python"], job, progress, script=INSIDE) as child:
        while (event := child.expect("saved", "ready", "done"))["event"] != "done":
            if event["event"] == "saved":
                put(shown(event["path"]))


def question(text):
    """The Question of --question 'Name: which ...?'. EncreError: it is none."""
    key, colon, words = text.partition(":")
    if not colon or not words.strip():
        raise EncreError(f"--question {text!r}: has no name; write --question 'Name: which of the two ...?'")
    return Question(key.strip(), words.strip())


# ---- what came of it ---------------------------------------------------------------------------------------------

_EXTREME = 10  # sessions that are the longest, and the shortest


def analyse(folder):
    """What the sessions in a folder say, as text. EncreError: there are none, or they are not of one study."""
    records = session.folder(Path(folder))
    looks = sorted({record.looks for record in records})
    if len({frozenset(pair) for pair in looks}) > 1:
        raise EncreError(f"{folder}: holds sessions of different looks ({'; '.join(' and '.join(p) for p in looks)}); "
                         "keep each study in a folder of its own")
    keys = list(records[0].answers)
    if other := [record.path.name for record in records if list(record.answers) != keys]:
        raise EncreError(f"{folder}: {', '.join(other[:5])} answer other questions than {records[0].path.name}; keep "
                         "each study in a folder of its own")
    return report(looks[0], keys, [(record.seconds, record.answers) for record in records],
                  [record.sides for record in records], [record.words for record in records])


def report(looks, keys, sessions, sides=(), words=()):
    """The text for [(seconds, {key: look})]; sides: what stood left and right; words: answers to open questions."""
    from . import proportions

    first, second = looks
    count = len(sessions)
    rows = [f"{count} session{'s' * (count != 1)}: {first} against {second}", ""]
    wide = max(10, *(len(key) for key in keys)) + 2
    rows += _counts(f"All {count}", sessions, keys, looks, wide)
    most = min(_EXTREME, count // 2)
    if most:
        ordered = sorted(sessions, key=lambda each: each[0])
        for name, some in ("longest", ordered[-most:]), ("shortest", ordered[:most]):
            minutes = [seconds / 60 for seconds, _ in some]
            rows += ["", *_counts(f"The {most} {name}, {min(minutes):.1f} to {max(minutes):.1f} min", some, keys, looks,
                                  wide)]
    rows += ["", f"Two-tailed test of one proportion, exact binomial: the share that prefers {first}, against one half"]
    for key in keys:
        chosen = sum(answers[key] == first for _, answers in sessions)
        found = proportions.test(chosen, count)
        said = "more than chance" if found.p < proportions.ALPHA else "no difference shown"
        rows.append(f"  {key:<{wide}}{chosen} of {count}, {found.share:.6f}, 95 % from {found.low:.6f} to "
                    f"{found.high:.6f}, p = {found.p:.3f}: {said}")
    if sides:
        left = sum(answers[key] == side[0] for (_, answers), side in zip(sessions, sides, strict=True) for key in keys)
        found = proportions.test(left, count * len(keys))
        rows.append(f"  {'Left side':<{wide}}chosen {left} times of {count * len(keys)}; {first} stood there in "
                    f"{sum(side[0] == first for side in sides)} of {count} sessions")
    if count >= 4:
        rows += ["", f"A look that {proportions.threshold(count):.1%} of all people prefer, or more, would have been "
                 f"found with {count} people in 80 of 100 such studies (normal approximation, a level of 5 %)."]
    for asked in dict.fromkeys(text for each in words for text in each):
        rows += ["", asked, *(f"  - {each[asked]}" for each in words if each.get(asked))]
    return "\n".join(rows)


def _counts(title, sessions, keys, looks, wide):
    columns = [max(len(look), 6) + 2 for look in looks]
    rows = [title + ":", "  " + " " * wide + "".join(f"{look:>{column}}" for look, column in
                                                     zip(looks, columns, strict=True))]
    for key in keys:
        counts = [sum(answers[key] == look for _, answers in sessions) for look in looks]
        rows.append(f"  {key:<{wide}}" + "".join(f"{n:>{column}}" for n, column in zip(counts, columns, strict=True)))
    return rows


def planned(share, power):
    """How many people it takes to find that a look is preferred by this share of all, as text."""
    from . import proportions

    normal, exact = proportions.people(share, power), proportions.people_exact(share, power)
    rows = [f"If {share:.0%} of all people prefer one look, {power:.0%} of studies find it (two-tailed, a level of 5 "
            "%) with", f"  {normal} people by the normal approximation, by which the thesis planned,",
            f"  {exact} people by the exact test, which --analyse makes; it holds for every larger number, too.", "",
            "people   share that is found"]
    rows += [f"{count:6}   {proportions.threshold(count, power):.3f}" for count in
             sorted({10, 20, 30, 47, 49, 66, 100, 200, normal})]
    return "\n".join(rows)
