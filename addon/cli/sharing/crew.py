# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render --jobs`: several Blenders of one machine, each in a process that serves (serve.py), share the frames.

Each gets the next frame when it is done with one. What they say is passed on as if by one voice.
"""

import contextlib
import json
import os
import subprocess
import tempfile
import time
from collections import deque

from ...pen.errors import EncreError
from .. import sequence
from ..child import RenderError, TryAgain
from . import serve
from .jobs import processors, rows
from .workplace import AT_ONCE, Workplace

_LOOK = 0.05  # seconds between two looks at what other processes say


class _Hand:
    """A process that serves, and what it is doing. It writes into the file `path`, for not every system can wait for
    several pipes."""

    def __init__(self, argv, path):
        self.frame = None
        with open(path, "wb") as file:
            self.process = subprocess.Popen(serve.command(*argv), stdin=subprocess.PIPE, stdout=file,
                                            stderr=subprocess.DEVNULL, text=True, encoding="utf-8")
        self.said = open(path, "rb")  # noqa: SIM115 - end() closes it

    def heard(self):
        """What it has told since; None at its end."""
        ended = self.process.poll() is not None  # before its last words are read
        yield from map(json.loads, rows([self.said]))
        if ended:
            yield None

    def ask(self, frame):
        self.frame = frame
        with contextlib.suppress(OSError):  # it is gone, which is heard
            self.process.stdin.write(f"{frame}\n")
            self.process.stdin.flush()

    def end(self):
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        try:
            self.process.wait(0.2 if self.frame is None else 0)
        except subprocess.TimeoutExpired:
            self.process.terminate()
            self.process.wait()
        self.said.close()


def _heard(hands):
    """Yields (hand, event) for ever."""
    while True:
        came = [(hand, event) for hand in hands for event in hand.heard()]
        yield from came
        if not came:
            time.sleep(_LOOK)


def run(argv, frames, jobs, threads, keep_going, wait, progress):
    """Runs the command line `argv`, which names no frames, in as many processes. frames: as render() has them. Raises
    EncreError, RenderError, TryAgain."""
    share = [] if threads else ["--threads", str(max(1, processors() // jobs))]
    said = set()
    with contextlib.ExitStack() as stack:
        folder, hands = stack.enter_context(Workplace(tempfile.gettempdir(), "encre-")).path, []
        for k in range(jobs):
            hands.append(_Hand([*argv, *share, "--serve", "--no-wait"], os.path.join(folder, str(k))))
            stack.callback(hands[-1].end)
        left, order, held, failed, finished, rounds = None, {}, {}, {}, 0, 0
        busy, heard = set(hands), _heard(hands)
        while left is None or left or busy:
            hand, event = next(heard)
            if hand not in hands:
                continue
            kind = event.pop("event") if event else None
            if kind is None or kind == "error":
                error = _error(event, hand)
                if hand.frame is None:  # the scene can't be opened, or memory is short for so many
                    raise error
                frame = hand.frame
                if frame not in held:
                    if not keep_going:
                        progress.tell("failed", frame=frame, text=str(error))
                        raise error
                    failed[frame] = error
                    progress.failed(frame, str(error))
                if kind is None:
                    hands.remove(hand)
                    busy.discard(hand)
                    if not hands:
                        raise error
                    continue
            if kind == "ready" and left is None:
                left = deque(sequence.meant(frames, event))
                order = {frame: number for number, frame in enumerate(left, 1)}
            elif kind == "held":
                held[event["frame"]] = event["text"]
            elif kind == "finished":
                finished += 1
                progress.relay(kind, event)
            elif kind in ("note", "warning"):
                if event["text"] not in said and "left alone" not in event["text"]:
                    said.add(event["text"])
                    progress.relay(kind, event)
            elif kind in ("frame", "progress", "written"):
                if kind == "frame":
                    event |= {"number": order[event["frame"]], "count": len(order)}
                held.pop(event["frame"], None)
                progress.relay(kind, event)
            if kind in ("ready", "done", "error"):
                hand.frame = None
                busy.discard(hand)
                if not left and not busy and held and (wait or rounds < AT_ONCE):
                    rounds += 1
                    left.extend(held)
                    held.clear()
                if left:
                    busy.add(hand)
                    hand.ask(left.popleft())
                    for other in hands:
                        if left and other.frame is None and other not in busy and other is not hand:
                            busy.add(other)
                            other.ask(left.popleft())
    if finished:
        progress.say("note", f"{finished} of {len(order)} frames are finished and left alone")
    for frame, holder in held.items():
        progress.tell("held", frame=frame, text=holder)
    if failed:
        kind = TryAgain if all(isinstance(error, TryAgain) for error in failed.values()) else RenderError
        raise kind(f"{len(failed)} of {len(order)} frames failed: {sequence.listed(failed)}; see the warnings above "
                   "and run again with --resume")
    if held:
        raise TryAgain(f"frames {sequence.listed(held)} are being rendered by others; run again with --resume, or "
                       "without --no-wait")


def _error(event, hand):
    if event is None:
        return TryAgain(f"frame {hand.frame}: the process that rendered it ended (status {hand.process.wait()})")
    return {75: TryAgain, 2: EncreError}.get(event["status"], RenderError)(event["text"])
