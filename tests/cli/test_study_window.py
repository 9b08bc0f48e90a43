# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre study` in a window: a person goes through all phases (blender/inside/study_window.py presses and clicks)."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from encre.cli.study import sessions
from encre.pen import session

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def sat(tmp_path_factory):
    """What a person did (blender/inside/study_window.py): (facts, the Record, the folder)."""
    if not shutil.which("blender") or not shutil.which("xvfb-run"):
        pytest.skip("needs the programs blender and xvfb-run")
    folder = tmp_path_factory.mktemp("study")
    script = Path(__file__).parents[1] / "blender" / "inside" / "study_window.py"
    done = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 640x480x24", sys.executable, "-m", "encre", "study",
                           str(script), "-o", str(folder / "answers"), "--size", "640x480", "--presses", "8",
                           "--moves", "20", "--slider", "--open", "Why?", "--verbose"],
                          capture_output=True, text=True, timeout=590, env={**os.environ, "ENCRE_SHOTS": str(folder)})
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr[-3000:]
    facts = dict(json.loads(line[5:]) for line in done.stderr.splitlines() if line.startswith("FACT "))
    (path,) = done.stdout.split()
    return facts, session.read(Path(path)), folder


def test_a_person_goes_through_all_phases(sat):
    facts, record, folder = sat
    assert facts["flights"] == 2 and facts["flown"] > 0 and facts["back"] < facts["flown"]
    presses, moves, phase = facts["counts"]
    assert presses >= 8 and moves >= 20 and phase == "ANSWER" and facts["turned"] < 0
    assert {path.stem for path in folder.glob("*.png")} == {
        "offer", "start", "flight", "path", "free", "ready", "questions", "end", "play"}
    assert list(record.sides) == facts["sides"]


def test_how_many_pictures_there_are_is_measured_on_pictures(sat):
    """However long these take; and a window in which nothing changes is not drawn."""
    assert sat[0]["rate"] > 0 and float(sat[1].head["Pictures a second"]) > 0 and sat[0]["rested"]


def test_flights_are_drawn_beforehand_and_kept(sat):
    facts, record, folder = sat
    count, missing, used = facts["film"]
    assert (count, missing, used) == (13, 0, True) and record.head["Flights"] == "drawn beforehand"
    (film,) = (folder / "answers").glob("flight-*")
    assert len(list(film.glob("*.npy"))) == 13


def test_a_log_is_shown_again(sat):
    place, sides, thickness = sat[0]["played"]
    assert place == pytest.approx(sat[1].track[-1][1], abs=1e-4)
    assert (sides, thickness) == (list(sat[1].sides), 1.4)


def test_the_free_camera_stays_in_the_room(sat):
    low, high = sat[0]["within"]
    assert min(sat[0]["moved"][:2]) > 0.3
    assert all(a > b for a, b in zip(low, (-2, -3, 0), strict=True)) and all(
        a < b for a, b in zip(high, (2, 2, 2.5), strict=True))


def test_the_file_says_what_was_done(sat):
    facts, record, folder = sat
    assert record.answers == {"Convention": record.sides[0], "Aesthetics": record.sides[1]}
    assert record.words == {"Why?": "lines"} and record.head["Skipped"] == "no"
    assert {mode for *_, mode, _ in record.track} == {"PATH", "FREE"} and record.track[-1][4] == 1.4
    assert record.seconds == pytest.approx(facts["logged"], abs=0.06)
    assert abs(len(record.track) - 2 * record.seconds) < 2
    assert "1 session" in sessions.analyse(folder / "answers")


def test_the_two_looks_differ_and_both_have_lines(sat):
    """Lower left, lower right and the plain picture of the start."""
    import OpenImageIO as oiio

    picture = oiio.ImageBuf(str(sat[2] / "start.png")).get_pixels(oiio.FLOAT)[..., :3]
    plain, left, right = picture[:236, :316], picture[244:, :316], picture[244:, 324:]
    dark = [(pane.max(-1) < 0.02).mean() for pane in (plain, left, right)]
    assert min(dark[1:]) > dark[0] + 0.003
    assert abs(left[:236] - right[:236]).max(-1).mean() > 0.003
