# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render` over many frames, by several processes, and where it fails, hangs, is killed or interrupted."""

import contextlib
import json
import os
import pty
import re
import resource
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import exr
import numpy as np
import pytest
from cube import CUBE, encre, fails, left, script, works
from encre.cli import child, images, render


def test_frames_and_resume(cube, tmp_path):
    err = works(encre("render", cube, "-o", tmp_path / "new" / "f_##.png", "-s", "3", "-e", "4"))
    assert left(tmp_path / "new") == ["f_03.png", "f_04.png"]
    assert re.fullmatch(r"frame 3 \(1/2\): \S+f_03.png \(\S+ s\)\nframe 4 \(2/2\): \S+f_04.png \(\S+ s\)\n", err), err
    works(encre("render", cube, "-o", tmp_path / "new" / "f.png", "-s", "4"))
    assert left(tmp_path / "new") == ["f0004.png", "f_03.png", "f_04.png"]


@pytest.mark.parametrize("ending", ["png", pytest.param("exr", marks=pytest.mark.slow)])
def test_resume_leaves_alone_what_is_whole_and_made_from_the_same(cube, tmp_path, ending):
    out = tmp_path / f"f_##.{ending}"
    works(encre("render", cube, "-o", out, "-f", "3-6,8"))
    finished, half, middle, empty = (tmp_path / f"f_{k:02}.{ending}" for k in (3, 4, 5, 6))
    before = finished.read_bytes()
    half.write_bytes(half.read_bytes()[:-2000])
    hurt = bytearray(middle.read_bytes())
    at = 3 * len(hurt) // 4 if ending == "exr" else hurt.index(b"IDAT") + 30
    hurt[at:at + 8] = bytes(255 - byte for byte in hurt[at:at + 8])
    middle.write_bytes(hurt)
    empty.write_bytes(b"")
    missing = tmp_path / f"f_08.{ending}"
    missing.unlink()
    err = works(encre("render", cube, "-o", out, "-f", "3-6,8", "--resume"))
    assert "1 of 5 frames are finished" in err and err.count("\n") == 5
    assert finished.read_bytes() == before
    assert all(images.whole(path) for path in (half, middle, missing, empty))
    assert "5 of 5" in works(encre("render", cube, "-o", out, "-f", "3-6,8", "--resume", "--quick"))
    if ending == "exr":
        return
    # Other samples, size, parameters, or another scene file: another picture, whatever it is written as.
    for more in ["--samples=2"], ["--size=32x18"], ["--set=line_thickness=9"]:
        err = works(encre("render", cube, "-o", out, "-f", "3", "--resume", *more))
        assert "finished" not in err and "f_03" in err
    # The same image, and another of its name.
    command = ("render", cube, "-o", out, "-f", "3", "--resume", "--set=paper_source=IMAGE",
               f"--set=paper_image={(paper := tmp_path / 'paper' / 'p.png')}")
    paper.parent.mkdir()
    for value in (200, 90):
        exr.image(paper, value)
        assert "finished" not in works(encre(*command))
    assert "1 of 1" in works(encre(*command))
    works(encre("render", cube, "-o", out, "-f", "3"))
    cube.write_text(CUBE + "scene.frame_end = 5\n")
    assert "finished" not in works(encre("render", cube, "-o", out, "-f", "3", "--resume"))


def test_dry_run_and_progress_for_programs(cube, tmp_path):
    steps = script(tmp_path, "scene.frame_step, scene.render.use_multiview = 3, True\n")
    done = encre("render", steps, "-o", tmp_path / "new" / "f.png", "-s", "1", "-e", "9", "--dry-run")
    assert done.returncode == 0 and not (tmp_path / "new").exists()
    assert done.stdout == "".join(f"frame {k}: {tmp_path}/new/f{k:04}_{eye}.png (to render)\n"
                                  for k in (1, 4, 7) for eye in "LR"), "the scene's step, and a file for each eye"
    done = encre("render", cube, "-o", tmp_path / "new" / "f.png", "-f", "1-9x4,2", "--progress", "json")
    events = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0 and done.stderr == ""
    assert [e["files"] for e in events if e["event"] == "written"] == [
        [str(tmp_path / "new" / f"f{k:04}.png")] for k in (1, 5, 9, 2)]
    assert events[0]["event"] == "frame" and events[-1] == {"event": "done"}
    assert left(tmp_path / "new") == [f"f{k:04}.png" for k in (1, 2, 5, 9)]


FAILING = """
import os
print("Info: Read library: nothing")

def hang(scene, *_):
    import time
    if scene.frame_current == 2:
        time.sleep(1000)
    if scene.frame_current == 4:
        os.kill(os.getpid(), 11)

def remove(scene, *_):
    import shutil
    if scene.frame_current == 6:
        shutil.rmtree(os.environ["OUT"])
bpy.app.handlers.render_pre.append(hang)
bpy.app.handlers.render_write.append(remove)
"""


@pytest.mark.slow
def test_a_frame_that_hangs_or_crashes(tmp_path):
    path = script(tmp_path, FAILING)
    command = ["render", path, "-o", tmp_path / "f.png", "-f", "1-5", "--frame-timeout", "15"]
    result = encre(*command)
    fails(result, "frame 2", "15 s", "--frame-timeout", status=75)
    assert left(tmp_path) == ["f0001.png"]
    result = encre(*command, "--keep-going", "--resume", "--progress", "json")
    events = [json.loads(line) for line in result.stdout.splitlines()]
    failed = {event["frame"]: event["text"] for event in events if event["event"] == "failed"}
    assert list(failed) == [2, 4] and "15 s" in failed[2] and "SIGSEGV" in failed[4]
    assert events[-1]["event"] == "error" and "2 of 5 frames failed: 2, 4" in events[-1]["text"]
    assert result.returncode == 1 and result.stderr.endswith(f"encre: error: {events[-1]['text']}\n")
    assert "SIGSEGV" in result.stderr and "1 of 5 frames are finished" in result.stderr
    assert "Read library" not in result.stdout + result.stderr, "what the second Blender says of the file"
    assert left(tmp_path) == ["f0001.png", "f0003.png", "f0005.png"]
    gone = tmp_path / "gone"
    command = ["render", path, "-o", gone / "f.png", "-f", "6,7", "--keep-going"]
    result = encre(*command, env={**os.environ, "OUT": str(gone)})
    fails(result, "1 of 2 frames failed: 6", status=1)
    assert "frame 6: the folder that it was written into is gone" in result.stderr and left(gone) == ["f0007.png"]


@pytest.mark.slow
def test_two_processes_share_a_sequence(cube, tmp_path):
    """No frame is missing, and none is rendered by both."""
    command = [sys.executable, "-m", "encre", "render", cube, "-o", tmp_path / "f.png", "-f", "1-12", "--resume"]
    children = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    words = [child.communicate(timeout=200)[1] for child in children]
    assert [child.returncode for child in children] == [0, 0], words
    written = [int(frame) for said in words for frame in re.findall(r"^frame (\d+) \(", said, re.MULTILINE)]
    assert sorted(written) == list(range(1, 13))
    assert left(tmp_path) == [f"f{k:04}.png" for k in range(1, 13)]


@pytest.mark.slow
@pytest.mark.parametrize("count", [5, pytest.param(100, marks=[pytest.mark.long, pytest.mark.timeout(1800)])])
def test_killed_at_random(cube, tmp_path, count):
    """Parent or child is killed; then --resume makes every frame whole, and no process, folder or file is left."""
    temporary, out = tmp_path / "temporary", tmp_path / "out"
    temporary.mkdir()
    out.mkdir()
    random = np.random.default_rng(count)
    environment = {**os.environ, "TMPDIR": str(temporary)}
    frames = f"1-{2 * count}"
    command = [sys.executable, "-m", "encre", "render", cube, "-o", out / "f.png", "-f", frames, "--resume"]
    seen = {}
    for number in range(count):
        child = subprocess.Popen(command, stderr=subprocess.DEVNULL, env=environment)
        deadline = time.monotonic() + random.uniform(0, 5)
        while time.monotonic() < deadline and child.poll() is None:
            time.sleep(0.02)
        inner = [pid for pid in running(temporary) if pid != child.pid]
        with contextlib.suppress(ProcessLookupError):  # all frames are done
            os.kill(inner[0] if number % 2 and inner else child.pid, signal.SIGKILL)
        child.wait(60)
        deadline = time.monotonic() + 60  # Blender is not watched before it has started
        while running(temporary) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not running(temporary), (number, "Blender runs on")
        for path in out.glob("f*.png"):
            assert seen.setdefault(path, path.stat().st_mtime_ns) == path.stat().st_mtime_ns, "written twice"
    works(subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment))
    for path, changed in seen.items():
        assert path.stat().st_mtime_ns == changed, "written twice"
    assert left(out) == [f"f{k:04}.png" for k in range(1, 2 * count + 1)] and left(temporary) == []
    assert all(images.whole(path) for path in out.iterdir())


def running(temporary):
    """Processes whose command line names a file in a folder."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # it has just ended
            if bytes(temporary) in path.read_bytes():
                found.append(int(path.parent.name))
    return found


INSIDE = f"""
import importlib.util, sys, time
spec = importlib.util.spec_from_file_location("inside", {str(child.INSIDE)!r})
inside = importlib.util.module_from_spec(spec)
spec.loader.exec_module(inside)
line = inside.Line(int(sys.argv[-1]))
while word := line.hear():
    with line.watched():
        line.report("busy")
        if word == "work":
            time.sleep(0.3)
        while word != "work":
            time.sleep(1000 if word == "hang" else 0.01)
            line.look()
    line.report("done")
"""


@pytest.mark.parametrize("word", ["look", *(pytest.param(word, marks=pytest.mark.slow) for word in ("hang", None))])
def test_what_runs_inside_ends_with_the_line(tmp_path, word):
    """While it is told nothing, works or hangs; and what it is told between two works does not end it."""
    (tmp_path / "script.py").write_text(INSIDE)
    ours, theirs = socket.socketpair()
    theirs.set_inheritable(True)
    ours.settimeout(60)
    command = [*render.find_blender(), tmp_path / "script.py", "--", str(theirs.fileno())]
    running = subprocess.Popen(command, pass_fds=[theirs.fileno()], stdout=subprocess.DEVNULL)
    theirs.close()
    try:
        with ours, ours.makefile() as reader:
            for said in ("work", "work", word):
                if said:
                    ours.sendall(json.dumps(said).encode() + b"\n")
                    assert "busy" in reader.readline()
                if said == "work":
                    assert "done" in reader.readline()
            assert running.poll() is None
        assert running.wait(10) in (1, -signal.SIGIO)
    finally:
        running.kill()
        running.wait()


def test_a_full_disk(cube, tmp_path):
    """Found under way: status 1, nothing is left, and the old file is as it was."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (70_000,) * 2)

    out = tmp_path / "out.exr"
    out.write_bytes(b"old")
    result = encre("render", cube, "-o", out, "--size", "320x180", preexec_fn=limit)
    fails(result, "out.exr", "can't be written", status=1)
    assert left(tmp_path) == ["out.exr"] and out.read_bytes() == b"old"


@pytest.mark.parametrize("number", [
    signal.SIGINT, *(pytest.param(number, marks=pytest.mark.slow) for number in (signal.SIGTERM, signal.SIGHUP))])
def test_interrupt(cube, tmp_path, number):
    child = subprocess.Popen([sys.executable, "-m", "encre", "render", cube, "-o", tmp_path / "out.png", "--size",
                              "320x180", "--samples", "100000", "--threads", "1", "--progress", "json"],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not 0 < json.loads(child.stdout.readline()).get("fraction", 0) < 1:
        pass  # Cycles has not begun
    child.send_signal(number)
    err = child.communicate(timeout=60)[1]
    assert child.returncode == 130 and err == "encre: interrupted\n" and left(tmp_path) == []
    running = b"".join(path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline"))
    assert bytes(tmp_path) not in running, "Blender runs on"


@pytest.mark.slow
@pytest.mark.parametrize("options, number", [
    (("--size", "64x36"), None), (("--size", "1280x720", "--threads", "1"), signal.SIGTERM)])
def test_nothing_stays_among_the_temporary_files(cube, tmp_path, options, number):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    child = subprocess.Popen([sys.executable, "-m", "encre", "render", cube, "-o", tmp_path / "out.png", *options],
                             stderr=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(temporary)})
    if number:
        deadline = time.monotonic() + 60
        while not list(temporary.glob("*/own/blender_*")) and time.monotonic() < deadline:
            time.sleep(0.05)
        child.send_signal(number)
    err = child.communicate(timeout=60)[1]
    assert child.returncode == (130 if number else 0) and left(temporary) == [], err


def test_bar_on_a_terminal(cube, tmp_path):
    main, child = pty.openpty()
    with subprocess.Popen([sys.executable, "-m", "encre", "render", cube, "-o", tmp_path / "out.png"], stderr=child):
        os.close(child)
        text = b""
        while chunk := _read(main):
            text += chunk
    assert b"\rframe 1 (1/1) [" in text and b"100 %" in text and b"out.png" in text


def _read(fd):
    try:
        return os.read(fd, 4096)
    except OSError:  # the other end closed
        return b""
