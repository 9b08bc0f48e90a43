# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender that runs inside.py, and the private line on which the two talk, one JSON object in a row of text.

A Child is any such process, a Blender one whose words are passed on. What the child prints is never taken for a
message: it holds names that a scene's maker chose. The child ends when the line does, also where this process was
killed.
"""

import contextlib
import json
import os
import re
import selectors
import signal
import socket
import subprocess
import tempfile
import time
from collections import deque
from pathlib import Path

from ..pen.errors import EncreError
from .sharing import workplace

INSIDE = Path(__file__).with_name("inside.py")
_CHUNK, _LOOK = 1 << 16, 0.1  # bytes read at a time; seconds between two looks at a file
_PIPES = os.name == "posix"  # elsewhere no pipe can be waited for together with a socket
_ENDS = re.compile(rb"[\r\n]+")


# How a system ends what takes too much memory, and a farm what it wants to run elsewhere; a shell says 128 more.
_KILLED = {-number for name in ("SIGKILL", "SIGTERM", "SIGINT", "SIGHUP", "SIGXCPU")
           if (number := getattr(signal, name, None)) is not None}
_MEMORY = re.compile(r"memory: there is none left|out of (\w+ )?memory|not enough memory|MemoryError", re.IGNORECASE)


class RenderError(EncreError):
    """Rendering failed under way."""


class TryAgain(RenderError):
    """Likewise, for a reason that another time or another machine may not have."""


def failure(words):
    """The error that says these words."""
    return (TryAgain if _MEMORY.search(words) else RenderError)(words)


class Ended(Exception):
    """The child ended by itself; str() tells how, in half a sentence; killed: whether somebody ended it."""

    def __init__(self, code, last):
        self.killed = code in _KILLED or 128 - code in _KILLED
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
        super().__init__(f"({how})" + (f'; its last words were "{last[0]}"' if last else ""))


class _Stream:
    """Rows of text out of the bytes that read(most) gives, b"" at the end."""

    def __init__(self, kind, read):
        self.kind, self.read, self.rest = kind, read, b""

    def rows(self):
        """(the rows that are whole now, whether there was anything to read)."""
        try:
            piece = self.read(_CHUNK)
        except OSError:  # reset by the other side
            piece = b""
        *rows, self.rest = _ENDS.split(self.rest + piece)
        return [(self.kind, row) for row in rows if row], bool(piece)


class Child:
    """A context manager. `command`: how to run a script in Blender; `job`: what the script reads; hear(line) gets each
    line that the child prints; script: inside.py, or another that talks as it does."""

    def __init__(self, command, job, hear, script=INSIDE):
        self.command, self.job, self.hear, self.script = command, job, hear, script
        self._came, self._last = deque(), deque(maxlen=1)

    def __enter__(self):
        # Blender leaves its folder of temporary files behind, as it never gets to its own end.
        self._temporary = workplace.Workplace(tempfile.gettempdir(), "encre-")
        ours, theirs = socket.socketpair()
        theirs.set_inheritable(True)
        path = os.path.join(self._temporary.path, "job.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({**self.job, "line": theirs.fileno()}, file)
        environment = {**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), self._temporary.path)}
        self._file = None
        try:
            if _PIPES:
                output, passed = subprocess.PIPE, {"pass_fds": [theirs.fileno()]}
            else:  # a file, looked at again and again
                printed = os.path.join(self._temporary.path, "printed")
                output, passed = open(printed, "wb"), {"close_fds": False}  # noqa: SIM115 - closed below
                self._file = open(printed, "rb", buffering=0)  # noqa: SIM115 - __exit__ closes it
            self._process = subprocess.Popen([*self.command, str(self.script), "--", path], stdin=subprocess.DEVNULL,
                                             stdout=output, stderr=subprocess.STDOUT, env=environment, **passed)
        except BaseException:
            ours.close()
            self._temporary.__exit__()
            raise
        finally:
            theirs.close()
            if self._file:
                output.close()
        self._line, self._selector = ours, selectors.DefaultSelector()
        self._selector.register(ours, selectors.EVENT_READ, _Stream("said", ours.recv))
        if self._file:
            self._printed = _Stream("printed", self._file.read)
        else:
            pipe = self._process.stdout.fileno()
            self._printed = _Stream("printed", lambda most: os.read(pipe, most))
            self._selector.register(pipe, selectors.EVENT_READ, self._printed)
        return self

    def send(self, **message):
        with contextlib.suppress(OSError):  # it is gone, which next() tells
            self._line.sendall(json.dumps(message).encode() + b"\n")

    def next(self, deadline=None):
        """The child's next message. Ended: there is none; TimeoutError: none came before `deadline`, as
        time.monotonic() counts."""
        while self._came or self._selector.get_map():
            if not self._came:
                self._wait(deadline)
                continue
            kind, row = self._came.popleft()
            if kind == "said":
                return json.loads(row)
            self._heard(row)
        code = self._process.wait()
        more = bool(self._file)
        while more:
            rows, more = self._printed.rows()
            self._heard(*(row for _, row in rows))
        self._heard(self._printed.rest)
        raise Ended(code, self._last)

    def _wait(self, deadline):
        """Reads what comes next. TimeoutError."""
        left = None if deadline is None else deadline - time.monotonic()
        if left is not None and left <= 0:
            raise TimeoutError
        ready = self._selector.select(_LOOK if self._file and (left is None or left > _LOOK) else left)
        for key, _ in ready:
            rows, more = key.data.rows()
            self._came.extend(rows)
            if not more:
                self._selector.unregister(key.fileobj)
        if self._file:
            self._came.extend(self._printed.rows()[0])

    def _heard(self, *rows):
        for row in rows:
            if (line := row.decode(errors="replace").strip()) and not self.hear(line):
                self._last.append(line)

    def __exit__(self, *_):
        self._line.close()
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._selector.close()
        for file in filter(None, (self._process.stdout, self._file)):
            file.close()
        self._temporary.__exit__()


class Blender(Child):
    """A child whose notes, warnings and errors are told on the way. alive(): is called whenever something is heard."""

    def __init__(self, command, job, progress, alive=lambda: None, script=INSIDE):
        super().__init__(command, job, self._hear, script)
        self.progress, self.alive, self.doing, self.error = progress, alive, "", EncreError

    def _hear(self, line):
        self.alive()
        return self.progress.hear(line)

    def __exit__(self, *reason):
        self.progress.clear()
        super().__exit__(*reason)

    def begin(self, frame):
        self.doing, self.error = f"rendering frame {frame}", RenderError

    def expect(self, *kinds, deadline=None):
        """The next message of one of these kinds. EncreError, RenderError, TryAgain: the child failed; TimeoutError."""
        while True:
            try:
                event = self.next(deadline)
            except Ended as how:
                where = f"while {self.doing}" if self.doing else "before it ran Encre; is it Blender?"
                kind = TryAgain if how.killed else self.error
                raise kind(f"{self.command[0]} stopped {where} {how}") from None
            self.alive()
            kind = event["event"]
            if kind in kinds:
                return event
            if kind == "doing":
                self.doing = event["text"]
            elif kind == "error":
                raise TryAgain(event["text"]) if _MEMORY.search(event["text"]) else self.error(event["text"])
            elif kind in ("note", "warning"):
                self.progress.say(kind, event["text"])
