# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's session of the study: phases, counts, the log and its file."""

import os
import random
import re
import subprocess
import sys

import pytest
from encre.pen import session
from encre.pen.errors import EncreError
from encre.pen.session import Plan, Question, Session

HERE, AHEAD = (1.0, -2.5, 1.2), (1.5, 0.0, 0.25)


def explored(plan=None, seed=1):
    """A Session in which somebody has looked around for two seconds."""
    made = Session(plan or Plan(presses=3, moves=2), random.Random(seed))
    for _ in range(1 + made.plan.flights):
        made.go_on()
    for tick in range(60):
        if tick == 0:
            made.pressed()
        made.log(tick / 30, (HERE[0] + 0.1 * (tick >= 30), *HERE[1:]), AHEAD)
    return made


def answered(plan=None, seed=1, **answers):
    made = explored(plan, seed)
    made.answers = answers or {"Convention": "LEFT", "Aesthetics": "RIGHT"}
    return made


def test_phases_come_one_after_the_other():
    made = Session(Plan(presses=2, moves=1), random.Random(0))
    seen = []
    for _ in range(3):
        made.go_on()
        seen.append((made.phase, made.flight))
    assert seen == [("FLIGHT", 1), ("FLIGHT", 2), ("EXPLORE", 2)]
    made.pressed()
    made.pressed()
    made.pressed()
    assert made.phase == "EXPLORE"  # keys alone do not do
    made.moved()
    assert made.phase == "ANSWER" and (made.presses, made.moves) == (3, 1)


def test_nothing_counts_before_the_room_is_explored():
    made = Session(Plan())
    made.pressed()
    made.go_on()
    made.moved()
    made.skip()
    assert (made.presses, made.moves, made.phase, made.skipped) == (0, 0, "FLIGHT", False)


def test_who_leads_the_study_may_open_the_questions():
    made = explored()
    made.skip()
    assert made.phase == "ANSWER" and made.skipped and "Skipped: yes" in _text(made)


def _text(made):
    made.answers = {"Convention": "LEFT", "Aesthetics": "LEFT"}
    return made.text({})


def test_both_sides_come_up():
    sides = {Session(Plan()).sides for _ in range(60)}
    assert sides == {("DYNAMIC", "BAKED"), ("BAKED", "DYNAMIC")}


def test_the_log_has_two_places_a_second_and_dashes_where_nothing_moved():
    rows = answered().text({}).split("\n")
    log = rows[rows.index("") + 1:rows.index("", rows.index("") + 1)]
    assert log == ["Mode: PATH", "Thickness: 1", "1 -2.5 1.2", "85.944 0 14.324", "-----", "-----", "1.1 -2.5 1.2",
                   "-----", "-----", "-----"]


def test_the_log_begins_with_the_first_input():
    made = Session(Plan())
    for _ in range(3):
        made.go_on()
    made.log(5.0, HERE, AHEAD)
    made.pressed()
    made.log(7.0, HERE, AHEAD)
    made.log(9.5, HERE, AHEAD)
    assert made.seconds == 2.5


def test_a_file_is_read_as_it_was_written(tmp_path):
    plan = Plan(open=("Why (in a word)?", "What else?"), slider=True, presses=3, moves=2)
    made = answered(plan)
    made.words = {1: "thin: nice\nand calm"}
    made.thickness = 1.4
    path = made.save(tmp_path, {"Scene": "room.py"})
    record = session.read(path)
    assert re.fullmatch(r"\d{8}\.txt", path.name) and made.phase == "END" and os.listdir(tmp_path) == [path.name]
    assert record.sides == made.sides and record.looks == ("DYNAMIC", "BAKED")
    assert record.answers == {"Convention": made.sides[0], "Aesthetics": made.sides[1]}
    assert record.words == {"Why (in a word)?": "thin: nice and calm", "What else?": ""}
    assert record.seconds == 2.0 and record.head["Scene"] == "room.py" and record.head["Key presses"] == "1"
    assert [(at, place, mode) for at, place, _, mode, _ in record.track] == [
        (0.0, (1, -2.5, 1.2), "PATH"), (0.5, (1, -2.5, 1.2), "PATH"), (1.0, (1.1, -2.5, 1.2), "PATH"),
        (1.5, (1.1, -2.5, 1.2), "PATH")]


def test_nothing_tells_who_or_when(tmp_path):
    text = answered().save(tmp_path, {}).read_text()
    assert not re.search(r"\b20\d\d\b|\d\d:\d\d", text) and os.environ.get("USER", "nobody at all") not in text


def test_an_answer_that_is_missing_is_said(tmp_path):
    made = explored()
    with pytest.raises(EncreError, match="Convention, Aesthetics: not answered"):
        made.save(tmp_path, {})
    assert os.listdir(tmp_path) == []


KILLED = """
import os, random, signal
from pathlib import Path
from encre.pen import session
os.{call} = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
session.store(Path({folder!r}), "Encre study 1\\n" * 100000, random.randrange)
"""


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_session_that_is_killed_leaves_no_file_of_a_session(tmp_path, call):
    done = subprocess.run([sys.executable, "-c", KILLED.format(call=call, folder=str(tmp_path))], timeout=60)
    assert done.returncode == -9 and list(tmp_path.glob("*.txt")) == []
    with pytest.raises(EncreError, match="holds no file of a session"):
        session.folder(tmp_path)


def test_a_full_disk_leaves_nothing(tmp_path, monkeypatch):
    def full(_number):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(session.os, "fsync", full)
    made = answered()
    with pytest.raises(OSError, match="No space"):
        made.save(tmp_path, {})
    assert os.listdir(tmp_path) == [] and made.phase != "END"


@pytest.mark.parametrize("change, words", [
    (lambda text: text[:len(text) // 2], "is cut off"), (lambda text: text.replace("BAKED", "X", 1), "is cut off"),
    (lambda text: text.replace("study 1", "study 9"), "another version"),
    (lambda text: "hello", "no file of a session"),
    (lambda text: text.replace("1 -2.5 1.2", "1 -2.5"), "is cut off"),
    (lambda text: text.replace("\nEnd\n", "\n"), "is cut off")])
def test_files_that_are_not_whole_are_refused(tmp_path, change, words):
    path = answered().save(tmp_path, {})
    path.write_text(change(path.read_text()))
    with pytest.raises(EncreError, match=words):
        session.read(path)


@pytest.mark.parametrize("plan", [
    Plan(looks=("A", "A")), Plan(questions=()), Plan(questions=(Question("Left", "?"),)),
    Plan(questions=(Question("A", "?"), Question("A", "??"))), Plan(questions=(Question("Open 1", "?"),)),
    Plan(questions=(Question("a:b", "?"),))])
def test_plans_that_no_file_could_hold_are_refused(plan):
    with pytest.raises(EncreError):
        plan.check()


@pytest.mark.parametrize("rate, said", [(14.23, "14.2"), (1.0, "1.0"), (0.287, "0.29"), (0.0312, "0.031")])
def test_a_rate_is_told_and_not_rounded_away(rate, said):
    assert session.rated(rate) == said
