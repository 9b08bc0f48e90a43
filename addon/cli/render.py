# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render`: finds a Blender, has it run inside.py, shows what that reports.

inside.py has each frame written into a hidden folder beside the output; here it is renamed once it is whole.
"""

import contextlib
import importlib.util
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import deque
from pathlib import Path

import numpy as np

from ..pen import unwrap
from ..pen.errors import EncreError
from . import images

INSIDE = Path(__file__).with_name("inside.py")
_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")
_PART = re.compile(r"part (\d+) of (\d+)$")  # of a supersampled frame, as subframes.py says it
_REPORT = re.compile(r"(Info|Warning): (.+)")  # how Blender prints what the engine reports


class RenderError(EncreError):
    """Rendering failed under way."""


def find_blender(path=None):
    """The command, without arguments of ours, that runs a script in Blender: the program `path`, else this Python
    where bpy can be imported, else `blender` on PATH. Raises EncreError naming all three."""
    if path is not None:
        program = shutil.which(path)
        if not program:
            raise EncreError(f"--blender {path}: is not a program that can be run; give the path of Blender's")
        return [program, "-b", "--python"]
    if importlib.util.find_spec("bpy"):
        return [sys.executable]
    program = shutil.which("blender")
    if program:
        return [program, "-b", "--python"]
    raise EncreError("there is no Blender: name one with --blender PATH, install the Python module bpy into "
                          "this Python, or put the program blender on PATH")


def render(scene, out, *, frames=None, values=None, samples=None, size=None, resume=False, blender=None,
           say=print, verbose=False):
    """Renders `scene` (.blend or .py) to `out` (.png or .exr).

    frames: None (the scene's current one), a number, or (first, last), either None for the scene's own; values:
    what to change of the scene's parameters; say(kind, sentence) hears notes and warnings; verbose passes on all
    that Blender prints. Raises EncreError for bad input, RenderError for what fails under way.
    """
    images.prepare(out)
    command = find_blender(blender)
    out = os.path.abspath(out)
    with _folder(out) as folder:
        job = {"scene": os.path.abspath(scene), "out": out, "folder": folder, "frames": frames, "values": values or {},
               "samples": samples, "size": size, "finished": _finished(out) if resume else []}
        _run(command, job, say, verbose)


def compare(scene, out, take, *, frames=None, values=None, samples=None, size=None, techniques=(), beside=("",),
            uniform=False, mips=False, blender=None, say=print, verbose=False):
    """Renders frames of `scene` by each of the `techniques` (techniques.py) and calls take(event) for every frame.

    The event is a dictionary: frame, path (`out` with the frame's number), pictures {technique: {"path", "seconds"}},
    baking (seconds), values (the scene's parameters), samples, blender (its version). Its pictures are gone when take()
    returns. beside: what stands before the ending of the files that take() writes. The rest is as in render().
    """
    images.prepare(out)
    command = find_blender(blender)
    out = os.path.abspath(out)
    with _folder(out) as folder:
        job = {"scene": os.path.abspath(scene), "out": out, "folder": folder, "frames": frames, "values": values or {},
               "samples": samples, "size": size, "techniques": techniques, "beside": beside, "uniform": uniform,
               "mips": mips}
        _run(command, job, say, verbose, take)


def unwrapped(scene, name, out, *, blender=None, say=print, verbose=False):
    """The object `name` of a .blend file with its UV map, an unwrap.Unwrapped in world space.

    out: a file beside which there is room. Raises EncreError for the input.
    """
    command = find_blender(blender)
    with _folder(os.path.abspath(out)) as folder:
        path = os.path.join(folder, "mesh.npz")
        _run(command, {"scene": os.path.abspath(scene), "object": name, "folder": folder, "mesh": path}, say, verbose)
        with np.load(path) as arrays:
            return unwrap.Unwrapped(**arrays)


def _run(command, job, say, verbose, take=None):
    path = os.path.join(job["folder"], "job.json")
    Path(path).write_text(json.dumps(job), encoding="utf-8")
    # Blender leaves its folder of temporary files behind, as it never gets to its own end.
    with tempfile.TemporaryDirectory(prefix="encre-", ignore_cleanup_errors=True) as temporary:
        _watch([*command, str(INSIDE), "--", path], _Progress(say, take), verbose, temporary)


def _finished(out):
    """The files of `out`, whatever their frames, that are whole: another program may have left a part of one."""
    folder, name = os.path.split(out)
    parts = re.split("#+", name) if "#" in name else os.path.splitext(name)
    pattern = re.compile("(-?[0-9]+)?".join(map(re.escape, parts)))
    paths = [os.path.join(folder, name) for name in sorted(os.listdir(folder)) if pattern.fullmatch(name)]
    return [path for path in paths if os.path.isfile(path) and images.whole(path, last_row=True)]


@contextlib.contextmanager
def _folder(out):
    try:
        folder = tempfile.mkdtemp(prefix=".encre-", dir=os.path.dirname(out))
    except OSError as error:
        raise EncreError(images.unwritable(out, error.strerror)) from None
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _watch(command, progress, verbose, temporary):
    """Runs the child to its end; what it prints after a line's `ENCRE ` is a report to `progress`. `temporary` is the
    folder for what it needs meanwhile."""
    last = deque(maxlen=1)
    environment = {**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), temporary)}
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                             encoding="utf-8", errors="replace", env=environment)
    try:
        for line in child.stdout:
            line = line.strip()
            if line.startswith("ENCRE "):
                progress.report(json.loads(line[6:]))
                continue
            if verbose:
                print(line, file=sys.stderr)
            if sample := _SAMPLE.search(line):
                progress.sample(int(sample[1]), int(sample[2]))
            elif part := _PART.search(line):
                progress.part = int(part[1]) - 1, int(part[2])
            elif words := _REPORT.match(line):
                progress.engine(words[1], words[2])
            elif line:
                last.append(line)
        code = child.wait()
    finally:
        progress.clear()
        if child.poll() is None:
            child.terminate()
            try:
                child.wait(5)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
    if not progress.done:
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
        words = f'; its last words were "{last[0]}"' if last else ""
        where = f"while {progress.doing}" if progress.doing else "before it ran Encre; is it Blender?"
        sentence = f"{command[0]} stopped {where} ({how}){words}"
        raise (RenderError if progress.rendering else EncreError)(sentence)


class _Progress:
    """What the child reports, as a bar on a terminal or a line a frame elsewhere."""

    WIDTH = 30

    def __init__(self, say, take=None):
        self.take = take
        self.say, self.doing, self.rendering, self.done = say, "", False, False
        self.label, self.start, self.tty, self.told = "", 0.0, sys.stderr.isatty(), set()
        self.part = 0, 1  # how many parts of the frame are done, and of how many

    def report(self, event):
        kind = event["event"]
        if kind == "doing":
            self.doing = event["text"]
        elif kind == "frame":
            self.doing, self.rendering = f"rendering frame {event['frame']}", True
            self.label, self.start = f"frame {event['frame']} ({event['number']}/{event['count']})", time.monotonic()
            self.part = 0, 1
            self.sample(0, 1)
        elif kind == "written":
            for part, path in event["files"]:
                # Blender does not notice a full disk: it says that it saved.
                if not images.whole(part):
                    raise RenderError(images.unwritable(path, "the disk may be full"))
                try:
                    os.replace(part, path)
                except OSError as error:
                    raise RenderError(images.unwritable(path, error.strerror)) from None
                self.clear()
                took = time.monotonic() - self.start
                print(f"{self.label}: {path} ({took:.1f} s)", file=sys.stderr, flush=True)
        elif kind == "pictures":
            self.clear()
            self.take(event)
        elif kind == "error":
            self.clear()
            raise (RenderError if self.rendering else EncreError)(event["text"])
        elif kind == "done":
            self.done = True
        else:
            self.clear()
            self.say(kind, event["text"])

    def engine(self, kind, text):
        """A sentence of the engine's: once, though every frame says it."""
        if self.rendering and text not in self.told:
            self.told.add(text)
            self.clear()
            self.say({"Info": "note", "Warning": "warning"}[kind], text)

    def sample(self, number, count):
        if self.tty and self.label:
            done, parts = self.part
            count, number = parts * max(count, 1), done * max(count, 1) + number
            filled = self.WIDTH * number // count
            bar = "#" * filled + "." * (self.WIDTH - filled)
            print(f"\r{self.label} [{bar}] {100 * number // count:3d} %", end="", file=sys.stderr, flush=True)

    def clear(self):
        if self.tty:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
