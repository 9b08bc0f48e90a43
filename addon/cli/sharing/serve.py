# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render --serve`: frames that are asked for one list after the other, by one Blender that stays open.

In: a row of text a list, such as 1-4,7. Out: the objects of `--progress json`, the last for each list `done` or
`error`. It comes on the standard input, or on a socket of Unix's, there one asker after the other: `encre ask`. Where
an asker goes away, what it asked for is given up. The end of the input, or the row `end`, ends it.
"""

import contextlib
import json
import os
import socket
import subprocess
import sys
import time

from ...pen.errors import EncreError, shown
from .. import images, sequence
from ..child import RenderError, TryAgain
from ..progress import put
from .jobs import START

END, READY = "end", "ready"
_LOOK = 2.0  # seconds between two looks whether the socket is still there


def command(*argv):
    """How a process of Encre's own runs `encre` with arguments."""
    return [sys.executable, START, *map(str, argv)]


def serve(work, path, progress, status, **how):
    """Has the frames.Frames `work` render what is asked for on the socket `path`, None: on the standard input. how: as
    its run() has it; status(error): the exit status that an error leads to."""
    work.start()
    progress.tell(READY, **{key: work.ready[key] for key in ("first", "last", "step", "current")})
    for row, send in _standard() if path is None else _asked(path):
        if row == READY:
            send(json.dumps({"event": "done"}))
            continue
        progress.send = send
        try:
            work.todo = work.paths(sequence.numbers(row))
            work.run(**how)
            progress.tell("done")
        except (EncreError, OSError, MemoryError) as error:
            with contextlib.suppress(RenderError):  # the asker is gone
                progress.tell("error", text=str(error) or "there is not enough memory", status=status(error))
        finally:
            progress.send = put


def _standard():
    for row in sys.stdin:
        if row.strip() == END:
            return
        if row.strip():
            yield row.strip(), put


def _asked(path):
    """Ends when `path` is taken away."""
    with _at(path, socket.socket.bind) as server:
        os.chmod(path, 0o600)
        server.listen(16)
        server.settimeout(_LOOK)
        try:
            while os.path.exists(path):
                with contextlib.suppress(TimeoutError):
                    asker, _ = server.accept()
                    asker.settimeout(None)
                    with asker, asker.makefile(encoding="utf-8") as rows:
                        row = rows.readline().strip()
                        if row == END:
                            return
                        if row:
                            yield row, _sender(asker)
        finally:
            with contextlib.suppress(OSError):
                os.remove(path)


def _sender(asker):
    def send(text):
        try:
            asker.sendall(text.encode() + b"\n")
        except OSError:
            raise RenderError("whoever asked for frames is gone; they are given up") from None
        return True
    return send


def _at(path, do):
    """An open socket with which `do` was done to `path`."""
    if not hasattr(socket, "AF_UNIX"):
        raise EncreError(f"{path}: this system has no such sockets; give --serve alone, and frames on standard input")
    opened = socket.socket(socket.AF_UNIX)
    try:
        do(opened, os.fspath(path))
    except OSError as error:
        opened.close()
        if do is socket.socket.bind:
            reason = error.strerror or str(error)
            raise EncreError(f"{path}: no socket can be made there ({reason}); give another, short name") from None
        raise TryAgain(f"{path}: nobody answers there; begin with encre render --serve {path}") from None
    return opened


def ask(path, frames, progress):
    """Asks who serves at `path` for frames, a list as text, or END or READY, and tells `progress` what comes of it.
    RenderError, TryAgain: not all were rendered."""
    with _at(path, socket.socket.connect) as asked:
        asked.sendall(frames.encode() + b"\n")
        if frames == END:
            return
        with asked.makefile(encoding="utf-8") as rows:
            for row in rows:
                event = json.loads(row)
                kind = event.pop("event")
                if kind == "error":
                    raise {75: TryAgain, 2: EncreError}.get(event["status"], RenderError)(event["text"])
                if kind == "done":
                    return
                progress.relay(kind, event)
    raise TryAgain(f"{path}: who served there is gone; begin anew with encre render --serve {path}")


def detach(path, argv):
    """Runs `encre argv`, which serves at `path`, on its own; returns when it answers. EncreError, TryAgain."""
    images.check_place(path)
    said = f"{path}.log"
    with open(said, "wb") as file:
        child = subprocess.Popen(command(*argv), stdin=subprocess.DEVNULL, stdout=file, stderr=file,
                                 start_new_session=True)
    while child.poll() is None:
        with contextlib.suppress(TryAgain), _at(path, socket.socket.connect) as asked:
            asked.sendall(READY.encode() + b"\n")
            asked.recv(1)
            put(shown(f"{path}: asks are answered; what is said stands in {said}"), "stderr")
            return
        time.sleep(0.05)
    with open(said, encoding="utf-8", errors="replace") as file:
        words = [row.partition("error: ")[2].strip() for row in file if row.startswith("encre: error: ")]
    kind = {75: TryAgain, 2: EncreError}.get(child.returncode, RenderError)
    raise kind(words[-1] if words else f"{path}: who was to serve there ended (status {child.returncode}); see {said}")
