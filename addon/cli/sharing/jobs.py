# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite --jobs`: processes that share the frames of a sequence, and what they say as if by one voice.

Each has two files in this process's folder: what it says goes into one, and into the other what becomes of its frames.
"""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

from ...pen.errors import shown
from .. import restyle
from ..progress import put
from .workplace import Workplace

START = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "start.py")
_LOOK = 0.1  # seconds between two looks at what other processes say


def teller(path, whole):
    """What a process with a share tells of its frames: into the file `path`, a row each."""
    file, numbers = open(path, "a", buffering=1), {frame: k for k, frame in enumerate(whole)}  # noqa: SIM115 - to the end

    def tell(frame, state, words=""):
        file.write(json.dumps([numbers[frame], state, words]) + "\n")
    return tell


def processors():
    """How many this process may have of the machine's."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run(argv, layers, whole, jobs, threads, keep_going, heard):
    """Runs the command line `argv` in as many processes, each with its share of the frames `whole` of `layers`, passes
    on what they say, once where all say it, and tells heard(frame, state, words) what becomes of frames."""
    more = [] if threads else ["--threads", str(max(1, processors() // jobs))]
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(Workplace(tempfile.gettempdir(), "encre-")).path
        chorus, children = _Chorus(layers), []
        stack.callback(lambda: [_end(child) for child in children])
        for k in range(jobs):
            said, told = (os.path.join(folder, f"{k}.{kind}") for kind in ("said", "told"))
            open(told, "w").close()
            with open(said, "wb") as file:
                children.append(subprocess.Popen(
                    [sys.executable, START, *argv, "--jobs", "1", *more, "--share",
                     f"{k}/{jobs}/{told}"], stderr=file))
            chorus.add(*(stack.enter_context(open(name, "rb")) for name in (said, told)))
        states = {}

        def hear():
            for number, state, words in chorus.new():
                states[number] = state
                heard(whole[number], state, words)
            return restyle.FAILED in states.values()

        while any([child.poll() is None for child in children]):
            if hear() and not keep_going:
                return
            time.sleep(_LOOK)
        hear()
        for k, child in enumerate(children):
            if child.returncode:
                _died(k, child.returncode, jobs, whole, states, heard)


def _died(k, code, jobs, whole, states, heard):
    """Tells of a process that ended before its time, at the frame that it had come to."""
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
    why = "; memory may be short: give fewer --jobs" if code < 0 else ""
    for number in range(k, len(whole), jobs):
        if states.get(number) in (None, restyle.BEGUN):
            heard(whole[number], restyle.FAILED, f"{whole[number].source}: the process that drew it ended ({how}){why}")
            return


def _end(child):
    if child.poll() is None:
        child.terminate()
        child.wait()


class _Chorus:
    """What processes that share a sequence write into their files."""

    def __init__(self, layers):
        self.said, self.told, self.words = [], [], set()
        self.one = re.compile("-?[0-9]+".join(map(re.escape, re.split("#+", shown(os.path.basename(layers))))))

    def add(self, said, told):
        self.said.append(said)
        self.told.append(told)

    def new(self):
        """Passes on what is newly said, and gives what is newly told of frames."""
        for row in rows(self.said):
            words = self.one.sub("", row)
            if words not in self.words:
                self.words.add(words)
                put(row, "stderr", end="")
        return [json.loads(row) for row in rows(self.told)]


def rows(files):
    """What whole rows of text have been added to open files since this was asked."""
    for file in files:
        while (row := file.readline()).endswith(b"\n"):
            yield row.decode(errors="replace")
        file.seek(-len(row), os.SEEK_CUR)  # of a row that is not whole yet
