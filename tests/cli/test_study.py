# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre study`: what comes of sessions, beside the figures of Herring (2016), chapter 4."""

import random
import re
import subprocess
import sys
from pathlib import Path

import pytest
from encre.cli.study import proportions, sessions
from encre.pen.errors import EncreError
from encre.pen.session import Plan, Session

LOOKS, KEYS = ("DYNAMIC", "BAKED"), ["Convention", "Aesthetics"]


def people(convention, aesthetics, count, seconds):
    """Sessions of which so many chose DYNAMIC."""
    return [(second, {"Convention": LOOKS[k >= convention], "Aesthetics": LOOKS[k >= aesthetics]})
            for k, second in zip(range(count), seconds, strict=True)]


def minutes(low, high, count):
    return [60 * (low + (high - low) * k / (count - 1)) for k in range(count)]


# The 49 people of the thesis by its Table 4.1: the ten longest, the ten shortest, and all the others.
THESIS = [*people(3, 6, 10, minutes(6.625, 12.058, 10)), *people(3, 5, 10, minutes(2.692, 4.075, 10)),
          *people(13, 17, 29, minutes(4.2, 6.5, 29))]


def test_the_tests_of_the_thesis():
    """Its Figure 4.2, by MiniTab."""
    for chosen, share, low, high, p in ((19, 0.387755, 0.251974, 0.537615, 0.152),
                                        (28, 0.571429, 0.422104, 0.711805, 0.392)):
        found = proportions.test(chosen, 49)
        assert [round(value, 6) for value in (found.share, found.low, found.high)] == [share, low, high]
        assert round(found.p, 3) == p


def test_the_thresholds_of_the_thesis():
    """Its Figure 4.1 (0.695336), and .70 at 47 and .67 at 66 people, all with a power of .8: the normal approximation,
    though its tests are exact."""
    assert proportions.threshold(49) == pytest.approx(0.695336, abs=5e-7)
    assert [round(proportions.threshold(count), 3) for count in (47, 66)] == [0.699, 0.669]
    assert proportions.power(0.695336, 49) == pytest.approx(0.8, abs=1e-5)


def test_the_table_of_the_thesis():
    text = sessions.report(LOOKS, KEYS, THESIS)
    tables = re.findall(r"(All|longest|shortest).*:\n.*\n  Convention +(\d+) +(\d+)\n  Aesthetics +(\d+) +(\d+)",
                        text)
    assert tables == [("All", "19", "30", "28", "21"), ("longest", "3", "7", "6", "4"),
                      ("shortest", "3", "7", "5", "5")]
    assert "The 10 longest, 6.6 to 12.1 min" in text and "The 10 shortest, 2.7 to 4.1 min" in text
    assert "19 of 49, 0.387755, 95 % from 0.251974 to 0.537615, p = 0.152: no difference shown" in text
    assert "28 of 49, 0.571429, 95 % from 0.422104 to 0.711805, p = 0.392: no difference shown" in text
    assert "69.5% of all people" in text


def test_a_clear_preference_is_said():
    text = sessions.report(LOOKS, KEYS, people(18, 10, 20, minutes(3, 5, 20)))
    assert re.search(r"Convention +18 of 20.*more than chance", text)
    assert re.search(r"Aesthetics +10 of 20.*p = 1.000: no difference", text)


def test_planning_tells_how_many_people_it_takes():
    assert proportions.people(0.7) == 47  # as the thesis planned
    assert [proportions.power(0.7, count) >= 0.8 for count in (46, 47)] == [False, True]
    exact = proportions.people_exact(0.7)
    assert all(proportions.power_exact(0.7, count) >= 0.8 for count in range(exact, exact + 60))
    assert proportions.power_exact(0.7, exact - 1) < 0.8 and exact > 47
    with pytest.raises(EncreError, match="so near to one half"):
        proportions.people(0.501)


def test_the_exact_power_is_that_of_the_exact_test():
    """Against a count of all that 12 people may answer."""
    from math import comb

    found = sum(comb(12, k) * 0.8 ** k * 0.2 ** (12 - k) for k in range(13) if proportions.test(k, 12).p < 0.05)
    assert proportions.power_exact(0.8, 12) == pytest.approx(found)


def written(folder, count, plan=None, seconds=60):
    chance = random.Random(1)
    for k in range(count):
        made = Session(plan or Plan(), chance)
        for _ in range(3):
            made.go_on()
        made.pressed()
        for tick in range(2 * (seconds + k)):
            made.log(tick / 2, (0, 0, k), (0, 0, 0))
        made.answers = {"Convention": "LEFT", "Aesthetics": "LEFT" if made.sides[0] == "DYNAMIC" else "RIGHT"}
        made.words = {1: "calm"}
        made.save(folder, {})


def encre(*args):
    return subprocess.run([sys.executable, "-m", "encre", "study", *map(str, args)], capture_output=True, text=True,
                          timeout=300)


def test_a_folder_is_analysed(tmp_path):
    written(tmp_path, 8, Plan(open=("Why?",)))
    done = encre("--analyse", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "8 sessions: DYNAMIC against BAKED" in done.stdout and re.search(r"Aesthetics +8 +0\n", done.stdout)
    assert "The 4 longest, 1.1 to 1.1 min" in done.stdout and "Left side" in done.stdout and "  - calm" in done.stdout


def test_sessions_of_two_studies_are_not_added_up(tmp_path):
    written(tmp_path, 2)
    written(tmp_path, 2, Plan(("INK_ONLY", "PENCIL")))
    with pytest.raises(EncreError, match="sessions of different looks"):
        sessions.analyse(tmp_path)


@pytest.mark.parametrize("args, words", [
    ((), "give a scene, --analyse DIR or --plan SHARE"), (("--plan", "0.7", "--analyse", "x"), "one of the three"),
    (("--plan", "1.2"), "is not a share"), (("--plan", "0.4"), "a share above 0.5"), (("room.py",), "-o is missing"),
    (("--analyse", "nowhere"), "holds no file of a session"),
    ((Path(__file__), "-o", "x", "--question", "Which?"), "has no name"),
    ((Path(__file__), "-o", "x", "--blender", "/no/blender"), "is not a program")])
def test_what_can_not_be_done_is_said(tmp_path, args, words):
    done = subprocess.run([sys.executable, "-m", "encre", "study", *map(str, args)], capture_output=True, text=True,
                          cwd=tmp_path, timeout=60)
    assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr, done.stderr
