# SPDX-License-Identifier: GPL-3.0-or-later
"""Sequences, processes that share them, and files that are large, half made or in the way."""

import contextlib
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import drawn
import exr
import numpy as np
import pytest
from command import OFF, SIZE, fails, finish, start
from encre.cli import images, multilayer, png, room
from encre.pen import metadata
from encre.pen.job import Camera, Frame


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="all pictures are in memory here")
def test_large_pictures_lie_in_files(run, tmp_path, scene, monkeypatch):
    """With the same pixels; where files have no room, in memory."""
    path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene)})
    monkeypatch.setattr(room, "LARGE", 1)
    made = room.Room(SIZE[0] * SIZE[1])
    picture = made.zeros((1 << 12, 1 << 12))
    assert not picture[::64].any()
    picture[:] = 1
    pages = Path("/proc/self/statm").read_text().split()[2]
    time.sleep(0.2)
    made.give_back()
    assert int(Path("/proc/self/statm").read_text().split()[2]) < int(pages) - (1 << 13) and (picture == 1).all()
    pictures = []
    for number, limit in enumerate((1, 1 << 30)):
        monkeypatch.setattr(room, "LARGE", limit)
        assert run("composite", path, "-o", tmp_path / f"{number}.exr")[0] == 0
        pictures.append(exr.read(tmp_path / f"{number}.exr"))
    assert all(np.array_equal(pictures[0][name], pictures[1][name]) for name in pictures[1])
    child = start("composite", path, "-o", tmp_path / "2.exr", preexec_fn=lambda: resource.setrlimit(
        resource.RLIMIT_FSIZE, (1 << 19,) * 2))
    assert child.communicate(timeout=60) and child.returncode == 0


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_sequences(run, tmp_path, scene, ending):
    for frame in (1, 2, 3, 7):
        exr.write(tmp_path / f"in.{frame:04}.exr", {**exr.passes(scene), "Combined": scene["combined"] / frame})
    pattern, out = tmp_path / "in.####.exr", tmp_path / "out" / f"o.####.{ending}"
    status, said, err = run("composite", pattern, "-o", out, "-f", "1-3x2,7")
    assert status == 0 and said.count("\n") == 3 and err.count("encre: note") <= 4
    assert sorted(os.listdir(tmp_path / "out")) == [f"o.{k:04}.{ending}" for k in (1, 3, 7)]
    first = tmp_path / "out" / f"o.0001.{ending}"
    before = first.stat().st_mtime_ns
    status, said, err = run("composite", pattern, "-o", out, "--resume")
    assert status == 0 and said.count("\n") == 1 and "3 of 4 frames are finished" in err
    assert first.stat().st_mtime_ns == before
    assert run("composite", pattern, "-o", out, "--resume", "-s", "2", "--set=line_thickness=9")[1].count("\n") == 3
    paper = ["--resume", "-s", "2", "--set=paper_source=IMAGE", f"--set=paper_image={tmp_path / 'paper.png'}"]
    for value in (200, 90):  # the same image, and another of its name
        exr.image(tmp_path / "paper.png", value)
        assert run("composite", pattern, "-o", out, *paper)[1].count("\n") == 3
    assert run("composite", pattern, "-o", out, *paper)[1] == ""
    stored = metadata.write({"paper_source": "IMAGE", "paper_image": "own.png"}, [], Camera(), Frame(*SIZE))
    exr.write(tmp_path / "in.0002.exr", exr.passes(scene), metadata=stored)
    for value in (200, 90):  # as it is for the one that the file itself names
        exr.image(tmp_path / "own.png", value)
        assert [run("composite", pattern, "-o", out, "--resume", "-f2")[1].count("\n") for _ in range(2)] == [1, 0]
    fails(run("composite", pattern, "-o", out, "-f", "3-6"), "--keep-going",
          "in.0004.exr: there is no such file nor 2 more: frames 4-6")
    fails(run("composite", tmp_path / "in.0001.exr", "-o", out, "-f", "1"), "#")
    fails(run("composite", tmp_path / "none.####.exr", "-o", out), "no such frame")


def test_sequences_are_checked(run, tmp_path, scene):
    """What many frames have alike is listed once."""
    pictures = exr.passes(scene)
    for frame in (1, 2, 3):
        exr.write(tmp_path / f"in.{frame}.exr", pictures)
    exr.write(tmp_path / "in.4.exr", {name: pictures[name] for name in ("Combined", "Depth")})
    status, out, err = run("composite", tmp_path / "in.#.exr", "--check")
    assert (status, err) == (0, "") and out.count("view layer") == 2 and "in.1.exr: view" in out and "in.4.exr" in out
    assert run("composite", tmp_path / "in.#.exr", "--check", "-f", "2-3")[1].count("view layer") == 1
    exr.write(tmp_path / "in.3.exr", {"Depth": scene["depth"]})
    status, out, err = run("composite", tmp_path / "in.#.exr", "--check")
    assert status == 2 and out.count("view layer") == 3
    assert "in.3.exr: pass Combined is missing" in err and "in.4" not in err
    assert out.endswith("4 files; lists that are alike are shown once\n")
    (tmp_path / "in.2.exr").write_bytes((tmp_path / "in.2.exr").read_bytes()[:-2000])
    (tmp_path / "in.1.exr").write_bytes(b"")
    err = run("composite", tmp_path / "in.#.exr", "--check")[2]
    assert "in.1.exr: is not a readable" in err and "in.2.exr: can't be read to its end" in err
    assert "in.3.exr: pass Combined" in err
    assert err.count("encre: error: ") == err.count("\n") == 3
    exr.write(tmp_path / "in.4.exr", pictures, metadata={"encre.params": "{"})
    assert "in.4.exr: the metadata encre.params can't be read" in run("composite", tmp_path / "in.#.exr", "--check")[2]
    status, _, err = run("composite", tmp_path / "in.2.exr", "--check")
    assert status == 2 and "in.2.exr: can't be read to its end" in err


def test_sequences_by_other_programs_names(run, tmp_path):
    fails(run("composite", tmp_path / "in.%04d.exr", "-o", tmp_path / "o.#.png"), "in.%04d.exr: write #")
    fails(run("composite", tmp_path / "in.#.exr", "-o", tmp_path / "o.%04d.png"), "o.%04d.png: write #")
    fails(run("composite", "in.1.exr", "in.2.exr", "in.3.exr", "-o", "o.png"), "unrecognized arguments: in.2.exr",
          "in quotes: 'in.####.exr'", "see encre composite --help")
    fails(run("composite", "in.1.exr", "-o", tmp_path / "o.##.png"), "has # for a frame's number, but in.1.exr is one")
    fails(run("composite", tmp_path, "-o", tmp_path / "o.png"), "is a folder")
    fails(run("composite", "in.exr", "-o", ""), "'' must be a name that ends in")


def test_jobs(tmp_path, scene):
    for frame in range(1, 6):
        exr.write(tmp_path / f"in.{frame:04}.exr", exr.passes(scene))
    command = ["composite", tmp_path / "in.####.exr", "-o", tmp_path / "o.####.png", "-f", "1-5", "--jobs", "2"]
    code, _, err = finish(start(*command[:-3], "2", "--jobs", "200"))
    assert code == 0, err
    code, out, err = finish(start(*command))
    assert code == 0 and out.count("\n") == 5, err
    assert [p.name for p in sorted(tmp_path.glob("*.png"))] == [f"o.{k:04}.png" for k in range(1, 6)]
    (tmp_path / "o.0002.png").unlink()
    code, out, err = finish(start(*command, "--resume", "--preset", "inter_color_2016"))
    assert code == 0 and out.count("\n") == 5 and "finished" not in err
    assert err.count("does not hold all") == 1, "what all say is said once"
    (tmp_path / "o.0002.png").unlink()
    code, out, err = finish(start(*command, "--resume", "--preset", "inter_color_2016"))
    assert code == 0 and out.count("\n") == 1 and err.count("finished") == 1
    assert err.endswith("encre: note: 4 of 5 frames are finished and left alone\n")
    assert not list(tmp_path.glob(".encre-*"))


def test_a_frame_that_fails_ends_a_sequence_alike_by_one_process_and_by_several(run, tmp_path, scene):
    """With --keep-going the others are drawn; each that fails is named, and at the end all are listed."""
    for frame in (1, 2, 3, 4, 5):
        exr.write(tmp_path / f"in.{frame}.exr", exr.passes(scene))
    for frame in (3, 5):
        (tmp_path / f"in.{frame}.exr").write_bytes((tmp_path / "in.1.exr").read_bytes()[:-2000])
    exr.write(tmp_path / "in.2.exr", exr.passes(scene), metadata={"encre.params": "{"})
    for jobs in (1, 3):
        out, command = tmp_path / str(jobs), ("composite", tmp_path / "in.#.exr", "-f", "1-6", "--jobs", jobs, "-o")
        fails(run(*command, out / "o.#.png"), "in.6.exr: there is no such file", status=2)
        code, said, err = finish(start(*command, out / "o.#.png", "--keep-going"))
        assert code == 1 and said.count("\n") == 2 and {p.name for p in out.glob("*")} == {"o.1.png", "o.4.png"}
        for frame in (2, 3, 5, 6):
            assert sum(line.startswith("encre: warning") and f"in.{frame}.exr: " in line
                       for line in err.splitlines()) == 1, err
        assert err.endswith("encre: error: 4 of 6 frames failed: 2, 3, 5, 6; see the warnings above, and run again "
                            "with --resume\n")
        code, _, err = finish(start(*command[:3], "1,3-5", *command[4:], out / "p.#.png"))
        assert code == 1 and "of 4 frames failed: " in err.splitlines()[-1] and (jobs > 1 or "that: 4, 5; " in err), err


def test_jobs_end_with_the_process_that_shares_them_out(tmp_path, scene):
    one, frames = exr.write(tmp_path / "in.0001.exr", exr.passes(scene)), 200
    for frame in range(2, frames + 1):
        os.link(one, tmp_path / f"in.{frame:04}.exr")
    child = start("composite", tmp_path / "in.####.exr", "-o", tmp_path / "o.####.png", "--jobs", "2",
                  env={**os.environ, "TMPDIR": str(tmp_path)})
    assert child.stdout.readline()
    child.kill()
    out, err = child.communicate(timeout=60)  # when all who could still write have ended
    assert len(list(tmp_path.glob("o.*.png"))) < frames and not list(tmp_path.glob("*encre-*")), err


def test_what_is_half_made_has_a_name_that_nobody_foresees(tmp_path, monkeypatch):
    """And lies in a folder of its own, into which no link can have been put."""
    seen, store = [], images.store

    def watched(place, *rest):
        seen.append(place.path)
        store(place, *rest)
        assert os.stat(place.path).st_mode & 0o777 == 0o700

    monkeypatch.setattr(images, "store", watched)
    for _ in range(2):
        png.write(tmp_path / "a.png", np.zeros((2, 2, 4), np.float32), multilayer.Window(2, 2, 0, 0, 2, 2))
    assert len(set(seen)) == 2 and os.listdir(tmp_path) == ["a.png"]


def test_a_link_gives_way_to_the_picture(run, tmp_path, scene):
    path, other = exr.write(tmp_path / "in.exr", exr.passes(scene)), tmp_path / "other"
    other.write_bytes(b"old")
    (tmp_path / "out.png").symlink_to(other)
    assert run("composite", path, "-o", tmp_path / "out.png")[0] == 0
    assert other.read_bytes() == b"old" and not (tmp_path / "out.png").is_symlink()


def test_folders_that_go_while_others_look_for_them(tmp_path):
    """Of processes that share a folder some begin while others end."""
    code = ("import sys; from encre.cli.sharing.workplace import Workplace\n"
            "for _ in range(300):\n    with Workplace(sys.argv[1]):\n        pass")
    children = [subprocess.Popen([sys.executable, "-c", code, tmp_path], stderr=subprocess.PIPE, text=True)
                for _ in range(4)]
    words = [child.communicate(timeout=120)[1] for child in children]
    assert [child.returncode for child in children] == [0] * 4, words
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_a_full_disk_leaves_the_old_file(tmp_path, ending):
    layers_ = exr.passes(drawn.scene(480, 320, noise=1.0))
    path = exr.write(tmp_path / "in.exr", layers_)
    out = tmp_path / "out" / f"out.{ending}"
    out.parent.mkdir()
    out.write_bytes(b"old")
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (80_000,) * 2)  # enough for the probe, not for the picture

    child = start("composite", path, "-o", out, *OFF, preexec_fn=limit)  # the noise of the input fills files
    err = child.communicate(timeout=60)[1]
    assert child.returncode == 1 and "can't be written" in err.splitlines()[-1] and "Traceback" not in err, err
    assert os.listdir(out.parent) == [out.name] and out.read_bytes() == b"old"


def holds(pid, path):
    """Whether a process has a file open."""
    for file in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # it is closed meanwhile
            if os.readlink(file) == str(path):
                return True
    return False


@pytest.mark.slow
def test_interrupting_composite(tmp_path):
    path = exr.write(tmp_path / "in.exr", exr.passes(drawn.scene(1280, 720)))
    child = start("composite", path, "-o", tmp_path / "out.exr", "--threads", "1")
    while child.poll() is None and not holds(child.pid, path):
        time.sleep(0.01)
    child.send_signal(signal.SIGINT)
    err = child.communicate(timeout=60)[1]
    assert (child.returncode, err) == (130, "encre: interrupted\n")
    assert os.listdir(tmp_path) == ["in.exr"]
