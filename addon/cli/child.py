# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender that runs inside.py, and the private line on which the two talk, one JSON object in a row of text.

What the child prints is never taken for a message: it holds names that a scene's maker chose. The child ends when the
line does, also where this process was killed.
"""

import contextlib
import json
import os
import queue
import signal
import socket
import subprocess
import tempfile
import threading
import time
from collections import deque
from pathlib import Path

from . import workplace

INSIDE = Path(__file__).with_name("inside.py")


class Ended(Exception):
    """The child ended by itself; str() tells how, in half a sentence."""


class Child:
    """A context manager. `command`: how to run a script in Blender; `job`: what inside.py reads; hear(line) gets each
    line that the child prints."""

    def __init__(self, command, job, hear):
        self.command, self.job, self.hear = command, job, hear
        self._came, self._open, self._last = queue.Queue(), 2, deque(maxlen=1)

    def __enter__(self):
        # Blender leaves its folder of temporary files behind, as it never gets to its own end.
        self._temporary = workplace.Workplace(tempfile.gettempdir(), "encre-")
        ours, theirs = socket.socketpair()
        theirs.set_inheritable(True)
        path = os.path.join(self._temporary.path, "job.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({**self.job, "line": theirs.fileno()}, file)
        passed = {"pass_fds": [theirs.fileno()]} if os.name == "posix" else {"close_fds": False}
        environment = {**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), self._temporary.path)}
        try:
            self._process = subprocess.Popen(
                [*self.command, str(INSIDE), "--", path], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, encoding="utf-8", errors="replace", env=environment, **passed)
        except BaseException:
            ours.close()
            self._temporary.__exit__()
            raise
        finally:
            theirs.close()
        self._line = ours
        self._readers = [threading.Thread(target=self._read, args=pair, daemon=True)
                         for pair in (("printed", self._process.stdout), ("said", ours.makefile(encoding="utf-8")))]
        for reader in self._readers:
            reader.start()
        return self

    def _read(self, kind, file):
        try:
            for line in file:
                self._came.put((kind, line))
        except (OSError, ValueError):  # closed from the other side
            pass
        self._came.put(("closed", None))

    def send(self, **message):
        with contextlib.suppress(OSError):  # it is gone, which next() tells
            self._line.sendall(json.dumps(message).encode() + b"\n")

    def next(self, deadline=None):
        """The child's next message. Ended: there is none; TimeoutError: none came before `deadline`, as
        time.monotonic() counts."""
        while self._open:
            try:
                kind, line = self._came.get(timeout=None if deadline is None else max(0, deadline - time.monotonic()))
            except queue.Empty:
                raise TimeoutError from None
            if kind == "said":
                return json.loads(line)
            if kind == "closed":
                self._open -= 1
            elif (line := line.strip()) and not self.hear(line):
                self._last.append(line)
        code = self._process.wait()
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
        raise Ended(f"({how})" + (f'; its last words were "{self._last[0]}"' if self._last else ""))

    def __exit__(self, *_):
        self._line.close()
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._temporary.__exit__()
