# SPDX-License-Identifier: GPL-3.0-or-later
"""Claims to frames: who has one, until when, and what becomes of frames whose owner died, hangs or comes back."""

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import exr
import kills
import pytest
from command import finish, start
from cube import encre, fails, left, script, works
from encre.cli import arguments, frames, images, render
from encre.cli.sharing import lease, workplace
from encre.pen import metadata

OWNER = """
import sys
from encre.cli.sharing.workplace import Workplace
place = Workplace(sys.argv[1], seconds=float(sys.argv[2]))
place.claim(sys.argv[3])
print(place.name, flush=True)
for line in sys.stdin:
    place._put() if line == "renew\\n" else None
    print(flush=True)
"""


class Owner:
    """Another process with a claim: it renews the lease when it is told to. host: what its folder is called after."""

    def __init__(self, folder, name, seconds=600.0, host="elsewhere", before=(), **options):
        command = [*before, sys.executable, "-c", OWNER, folder, str(seconds), name]
        if host != lease.HOST:
            named = f"from encre.cli.sharing import lease; lease.HOST = {host!r}\nplace ="
            command[len(before) + 2] = OWNER.replace("place =", named)
        self.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, **options)
        self.folder = Path(folder) / self.child.stdout.readline().strip()

    def renew(self):
        self.child.stdin.write("renew\n")
        self.child.stdin.flush()
        self.child.stdout.readline()

    def ages(self, seconds):
        then = (self.folder / "lease").stat().st_mtime - seconds
        os.utime(self.folder / "lease", (then, then))

    def dies(self):
        self.child.kill()
        self.child.communicate()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.dies()


@pytest.mark.parametrize("host", ["elsewhere", lease.HOST])
def test_a_claim_lasts_while_its_owner_lives_and_renews_it(tmp_path, host, monkeypatch):
    with workplace.Workplace(tmp_path) as place, Owner(tmp_path, "1.png", host=host) as owner:
        monkeypatch.setattr(time, "time", lambda: 0.0)  # a host's clock tells nothing
        holder = place.claim("1.png")
        assert holder == f"process {owner.child.pid} on {host}" and place.claims() == {"1.png": holder}
        assert place.claim("2.png") is None
        owner.ages(599)
        assert place.claim("1.png")
        owner.ages(601)
        assert place.claim("1.png") is None and not place.claims(), "it hangs: its lock is held, and nothing is renewed"
        owner.renew()
        assert place.claim("1.png"), "it came back"
        owner.dies()
        assert place.claim("1.png") is None, "it is dead: its lock is free, though the lease is fresh"
    assert os.listdir(tmp_path) == [], "the dead one's folder is swept"


def test_where_locks_tell_nothing_leases_do(tmp_path, monkeypatch):
    monkeypatch.setattr(lease, "travel", lambda folder: False)
    with workplace.Workplace(tmp_path) as place, Owner(tmp_path, "1.png") as owner:
        owner.dies()
        assert place.claim("1.png"), "of another host's lock nothing is known"
        owner.ages(601)
        assert place.claim("1.png") is None
        workplace.sweep(tmp_path)
        assert owner.folder.is_dir()
        owner.ages(86401)
        workplace.sweep(tmp_path)
        assert not owner.folder.exists()


@pytest.mark.parametrize("mount, travels", [
    ("ext4 rw,relatime", True), ("nfs4 rw,vers=4.2,local_lock=none", True), ("nfs rw,nolock,vers=3", False),
    ("nfs rw,vers=3,local_lock=all", False), ("nfs rw,local_lock=posix", True), ("lustre rw,flock", True),
    ("lustre rw,localflock", False), ("fuse.sshfs rw", False), ("9p rw", False), ("cifs rw,nobrl", False)])
def test_which_locks_other_machines_see(mount, travels):
    mounts = f"a / ext4 rw 0 0\nb /mnt/a\\040farm {mount} 0 0\nc /mnt/a\\040farm/deep fuse.x rw 0 0\n"
    assert lease.shared(mounts, "/mnt/a farm/frames") is travels
    assert lease.shared(mounts, "/mnt/a farmer") and not lease.shared(mounts, "/mnt/a farm/deep/er")


def test_of_two_that_claim_at_once_one_at_most_has_it(tmp_path):
    code = ("import sys, os, time; from encre.cli.sharing.workplace import Workplace\nplace = Workplace(sys.argv[1])\n"
            "for k in range(200):\n    if place.claim(str(k)) is None:\n"
            "        os.open(f'{sys.argv[1]}/{k}.taken', os.O_CREAT | os.O_EXCL)\n        time.sleep(0.0005)\n"
            "        os.remove(f'{sys.argv[1]}/{k}.taken')\n    place.release()\n")
    children = [subprocess.Popen([sys.executable, "-c", code, tmp_path], stderr=subprocess.PIPE, text=True)
                for _ in range(3)]
    words = [child.communicate(timeout=120)[1] for child in children]
    assert [child.returncode for child in children] == [0] * 3, words


@pytest.mark.skipif(os.name != "posix" or os.getuid() != 0, reason="needs the rights to be another user")
def test_two_users_see_each_others_claims_and_not_their_pictures(tmp_path):
    for folder in (tmp_path, *tmp_path.parents):
        with contextlib.suppress(OSError):
            folder.chmod(folder.stat().st_mode | 0o005)
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o777)

    def claims():
        with workplace.Workplace(shared) as place:
            return f"{place.claim('1.png')}, {place.claim('2.png')}"

    with Owner(shared, "1.png", umask=0o077) as owner:
        assert as_another(claims) == f"process {owner.child.pid} on elsewhere, None"
        assert (owner.folder / "own").stat().st_mode & 0o777 == 0o700
        assert (owner.folder / "lease").stat().st_mode & 0o777 == 0o644
        owner.dies()
        assert as_another(claims) == "None, None" and owner.folder.is_dir(), "another user's is not swept"


def as_another(function):
    """What a function says that a process of another user runs."""
    read, write = os.pipe()
    if not (child := os.fork()):
        try:
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)
            os.write(write, function().encode())
        except BaseException as error:
            os.write(write, repr(error).encode())
        finally:
            os._exit(0)
    os.close(write)
    os.waitpid(child, 0)
    with open(read) as file:
        return file.read()


def test_what_a_stranger_puts_there_stops_nothing(tmp_path):
    folder = tmp_path / f".encre-elsewhere-1-{'0' * 16}"
    for kind in (lambda path: os.mkfifo(path), lambda path: path.mkdir(), lambda path: path.write_text("{}[1"),
                 lambda path: path.symlink_to("/dev/zero"), lambda path: path.write_text('["x", 1]\n'),
                 lambda path: path.write_text('[1e9999, "2.png"]')):
        folder.mkdir()
        kind(folder / "lease")
        kind(folder / "lock")
        with workplace.Workplace(tmp_path) as place:
            assert place.claim("1.png") is None
        shutil.rmtree(folder, ignore_errors=True)


def test_a_file_lasts_before_it_gets_its_name(tmp_path, monkeypatch):
    done, flush, put = [], os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda file: done.append(os.readlink(f"/proc/self/fd/{file}")) or flush(file))
    monkeypatch.setattr(os, "replace", lambda *paths: done.append("named") or put(*paths))
    with workplace.Workplace(tmp_path) as place:
        made = Path(place.path) / "1.png"
        made.write_bytes(b"picture")
        place.take("1.png", tmp_path / "1.png")
    assert done == [str(made), "named", str(tmp_path)]


def machine(name):
    """What a command begins with to run as another host: names, processes and network of its own."""
    return [*kills.ALONE, "sh", "-c", f'hostname {name} && exec "$@"', "sh"]


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("unshare") or subprocess.run(
    [*machine("tried"), "true"], stderr=subprocess.DEVNULL).returncode != 0, reason="needs the right to unshare")
def test_a_machine_takes_over_what_others_hang_on_or_died_of(tmp_path, scene):
    """Three hosts in namespaces of their own: one hangs and loses its lease, though its lock stays held; one is killed
    with a fresh lease; the third draws both frames, and is done only then."""
    one = exr.write(tmp_path / "in.1.exr", exr.passes(scene))
    for frame in 2, 3:
        os.link(one, tmp_path / f"in.{frame}.exr")
    out = tmp_path / "out"
    out.mkdir()
    command = [*machine("draws"), sys.executable, "-m", "encre", "composite", tmp_path / "in.#.exr", "-o",
               out / "o.#.png", "--resume", "--set=light_denoise=NONE"]
    with Owner(out, "o.1.png", host=lease.HOST, before=machine("hangs")) as hung, \
            Owner(out, "o.2.png", host=lease.HOST, before=machine("dies")) as dead:
        assert hung.folder.name.startswith(".encre-hangs-") and dead.folder.name.startswith(".encre-dies-")
        dead.dies()
        first = subprocess.run([*command, "--no-wait"], capture_output=True, text=True, timeout=120)
        assert first.returncode == 75 and "o.1.png is being drawn by another process" in first.stderr
        assert sorted(path.name for path in out.glob("o.*")) == ["o.2.png", "o.3.png"]
        hung.ages(600)
        then = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert then.returncode == 0 and hung.child.poll() is None
        assert all(images.whole(out / f"o.{frame}.png") for frame in (1, 2, 3))


# In renders


def test_frames_of_others_are_waited_for_and_taken_over(cube, tmp_path):
    """One is drawn by a process that hangs, the other's was killed on another machine. No frame is left to either."""
    out = tmp_path / "out"
    out.mkdir()
    with Owner(out, "f0001.png") as hung, Owner(out, "f0002.png") as dead:
        dead.dies()
        result = encre("render", cube, "-o", out / "f.png", "-f", "1-3", "--no-wait", "--progress", "json")
        events = [json.loads(line) for line in result.stdout.splitlines()]
        assert result.returncode == 75 and "frame 1 is being rendered by process" in result.stderr
        assert [event["frame"] for event in events if event["event"] == "held"] == [1]
        assert events[-1]["event"] == "error" and events[-1]["status"] == 75
        assert left(out) == [hung.folder.name, "f0002.png", "f0003.png"]
        hung.ages(597)  # and it is not renewed
        err = works(encre("render", cube, "-o", out / "f.png", "-f", "1-3", "--resume"))
        assert "2 of 3 frames are finished" in err
    assert left(out)[-3:] == ["f0001.png", "f0002.png", "f0003.png"]


AGAIN = """
import os, shutil
def other(scene, *_):
    shutil.copy(os.environ["FINISHED"], os.environ["PLACE"])
bpy.app.handlers.render_post.append(other)
"""


def test_an_owner_looks_again_before_it_puts_its_picture_in_place(tmp_path):
    path = script(tmp_path, AGAIN)
    environment = {**os.environ, "FINISHED": str(tmp_path / "kept.png"), "PLACE": str(tmp_path / "nowhere")}
    (tmp_path / "kept.png").write_bytes(b"")
    works(encre("render", path, "-o", tmp_path / "f.png", "-f", "1", env=environment))
    (tmp_path / "f.png").rename(tmp_path / "kept.png")
    err = works(encre("render", path, "-o", tmp_path / "f.png", "-f", "1",
                      env={**environment, "PLACE": str(tmp_path / "f.png")}))
    assert "frame 1 was finished by another process meanwhile" in err
    assert (tmp_path / "f.png").read_bytes() == (tmp_path / "kept.png").read_bytes()
    (tmp_path / "kept.png").write_bytes(b"no picture")
    assert "another" not in works(encre("render", path, "-o", tmp_path / "f.png", "-f", "1",
                                        env={**environment, "PLACE": str(tmp_path / "f.png")}))
    assert images.whole(tmp_path / "f.png")


FAILING = """
import os, signal, time
def fail(scene, *_):
    if scene.frame_current == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    if scene.frame_current == 2:
        os.remove(os.environ["FIRST"])
bpy.app.handlers.render_pre.append(fail)
if os.environ.get("SLOW"):
    time.sleep(1000)
if os.environ.get("MEMORY"):
    raise MemoryError
"""


@pytest.mark.slow
def test_statuses_tell_what_to_try_again(tmp_path):
    path, out = script(tmp_path, FAILING), tmp_path / "f.png"
    fails(encre("render", path, "-o", out, "-f", "1"), "SIGKILL", status=75)
    slow = {**os.environ, "SLOW": "1"}
    fails(encre("render", path, "-o", out, "--frame-timeout", "3", env=slow), "scene.py", "was not open after 3 s",
          "--frame-timeout", status=75)
    fails(encre("render", path, "-o", out, env={**os.environ, "MEMORY": "1"}), "MemoryError", status=75)
    works(encre("render", path, "-o", tmp_path / "f####.png", "-f", "3"))
    (tmp_path / "f0003.png").rename(tmp_path / "f0001.png")
    # Somebody takes away what was finished.
    works(encre("render", path, "-o", tmp_path / "g####.png", "-f", "4"))
    result = encre("render", path, "-o", tmp_path / "g####.png", "-f", "4,2", "--resume",
                   env={**os.environ, "FIRST": str(tmp_path / "g0004.png")})
    fails(result, "frames 4: were finished and are gone again", status=75)


def test_composite_waits_as_well(run, tmp_path, scene):
    for frame in 1, 2:
        exr.write(tmp_path / f"in.{frame}.exr", exr.passes(scene))
    with Owner(tmp_path, "o.1.png", seconds=600) as owner:
        command = ("composite", tmp_path / "in.#.exr", "-o", tmp_path / "o.#.png")
        status, _, err = run(*command, "--no-wait")
        assert status == 75 and "o.1.png is being drawn by another process" in err
        assert (tmp_path / "o.2.png").exists() and not (tmp_path / "o.1.png").exists()
        child = start(*command, "--resume", "--set=light_denoise=NONE")
        while "waiting for it" not in child.stderr.readline():
            assert child.poll() is None
        owner.dies()
        assert child.wait(60) == 0 and (tmp_path / "o.1.png").exists()


def test_a_process_that_is_killed_is_told_with_its_frame(tmp_path, scene):
    for frame in 1, 2, 3, 4:
        exr.write(tmp_path / f"in.{frame}.exr", exr.passes(scene))
    with Owner(tmp_path, "o.2.png"):  # so its process draws 4 and then waits, until it is killed
        child = start("composite", tmp_path / "in.#.exr", "-f", "1-4", "-o", tmp_path / "o.#.png", "--jobs", "2")
        while not all((tmp_path / f"o.{frame}.png").exists() for frame in (1, 3, 4)):
            assert child.poll() is None
            time.sleep(0.02)
        found, = (path.parent.name for path in Path("/proc").glob("[0-9]*/cmdline")
                  if b"--share\x001/2/" in read(path) and bytes(tmp_path) in read(path))
        os.kill(int(found), signal.SIGKILL)
        code, _, err = finish(child)
    assert code == 1 and "in.2.exr: the process that drew it ended (signal SIGKILL)" in err, err
    assert err.splitlines()[-1].startswith("encre: error: 1 of 4 frames failed: 2; see the warnings above"), err


def read(path):
    try:
        return path.read_bytes()
    except OSError:  # it has just ended
        return b""


# What --resume compares: every option of `encre render`, with a value that changes the picture, or why none does.
CHANGES = {"preset": "ink_only", "sets": ["line_thickness=9"], "scene_name": "Other", "camera": "Other",
           "view_layer": "Other", "passes": ["Encre Lines"], "samples": 7, "size": [64, 32], "device": "cpu",
           "enable_autoexec": True, "layer_source": "ENCRE"}
ELSEWHERE = {"path_mapping": "files that a scene links are not compared, wherever they lie",
             "scene": "its content is compared", "blender": "the version that it tells is compared",
             "output": "the file itself; its kind is its name's", "frame": "each frame's number is in its mark",
             "start": "likewise", "end": "likewise"}
NOTHING = {"help": "draws nothing", "no_wait": "how to share", "lease": "how to share", "resume": "what to look at",
           "quick": "what to look at", "keep_going": "what follows a failure", "frame_timeout": "when to fail",
           "strict": "what to fail for", "dry_run": "draws nothing", "progress": "what is said",
           "verbose": "what is said", "jobs": "how to share", "serve": "how to share", "detach": "how to share",
           "threads": "the same picture by any number of them"}


def test_all_that_can_change_a_picture_is_compared(cube, monkeypatch):
    [commands] = [action for action in arguments.parser()._actions if action.dest == "command"]
    options = {action.dest for action in commands.choices["render"]._actions}
    assert options == {*CHANGES, *ELSEWHERE, *NOTHING}
    names = {"enable_autoexec": "autoexec", "sets": "values", "preset": "values", "layer_source": "values"}
    ready = {"blender": "4.5.1"}
    plain = {"scene": str(cube), "values": {}, **render.CHOICES}
    for option, value in CHANGES.items():
        name = names.get(option, option)
        assert name in plain, option
        changed = {"line_thickness": 9.0} if name == "values" else value
        assert frames.made_from({**plain, name: changed}, ready) != frames.made_from(plain, ready), option
    for option in NOTHING.keys() & plain.keys():
        assert frames.made_from({**plain, option: 7}, ready) == frames.made_from(plain, ready), option
    assert frames.made_from(plain, {"blender": "4.5.2"}) != frames.made_from(plain, ready)
    before = frames.made_from(plain, ready)
    cube.write_text(cube.read_text() + "\n")
    assert frames.made_from(plain, ready) != before


@pytest.mark.slow
def test_resume_draws_again_what_was_drawn_without_scripts(cube, tmp_path):
    command = ("render", cube, "-o", tmp_path / "f.png", "-f", "1", "--resume")
    works(encre(*command))
    first = images.text(tmp_path / "f.png", metadata.MARK)
    assert "finished" not in works(encre(*command, "--enable-autoexec"))
    assert images.text(tmp_path / "f.png", metadata.MARK) != first
    assert "1 of 1" in works(encre(*command, "--enable-autoexec"))
    assert re.search(r"^frame 1 ", works(encre(*command, "--enable-autoexec", "--device", "cpu")), re.MULTILINE)
