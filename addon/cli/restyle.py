# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite` on a file or a sequence of them, alone or shared among processes."""

import contextlib
import os
import re
import subprocess
import sys
import tempfile
import time

from ..pen import metadata
from ..pen.errors import EncreError, shown
from . import images, sequence
from .composite import check as passes_of
from .composite import composite
from .progress import say
from .render import RenderError
from .workplace import Workplace

_FINISHED = "{} of {} frames are finished and left alone"
_LOOK = 0.1  # seconds between two looks at what other processes say


def restyle(layers, out, change, *, frames=None, resume=False, share=(0, 1), say=say, **options):
    """Restyles the EXR `layers` into `out`, or each of a sequence whose names have # for the number.

    frames: a list, (first, last), or None for all that are there; share (k, n): only every n-th, from the k-th on;
    resume: leave alone what is whole and was made from the same; options: as composite() has them. Raises EncreError
    for the input, images.WriteError where something can't be written.
    """
    whole = todo(layers, out, frames)
    mine = dict(list(whole.items())[share[0]::share[1]])
    images.prepare(out)
    for source, path in mine.items():
        if os.path.exists(path) and os.path.exists(source) and os.path.samefile(path, source):
            raise EncreError(f"{path}: is the file that is read, whose layers would be lost; give another name")
        images.check_place(path)
    said, finished, parent = {}, 0, os.getppid()
    with images.writing([out]) as place:
        for source, path in mine.items():
            if share[1] > 1 and os.getppid() != parent:  # it was killed, and nobody waits for the rest
                raise RenderError("the process that shares the frames out is gone; run again with --resume")
            name, start = os.path.basename(path), time.perf_counter()
            if holder := place.claim(name):
                say("note", f"{path} is left to {holder}, which is drawing it")
                continue
            texts = {metadata.MARK: _mark(source, change, options)} if "#" in layers or resume else None
            if resume and images.text(path, metadata.MARK) == texts[metadata.MARK] and images.whole(path):
                finished += 1
            else:
                composite(source, path, change, say=_once(say, said, source), texts=texts, **options)
                print(f"{shown(path)} ({time.perf_counter() - start:.1f} s)", flush=True)
            place.release(name)
    if finished or resume and share[1] > 1:
        say("note", _FINISHED.format(finished, len(mine)))


def _once(say, said, source):
    """`say` for the frame `source`: what another frame said already is not said again."""
    def hear(kind, sentence):
        if said.setdefault((kind, sentence.replace(source, "")), source) == source:
            say(kind, sentence)
    return hear


def check(layers, frames, view_layer, asked):
    """Yields (file, text that lists its passes, whether it can be drawn) of an EXR or of those of a sequence: each list
    once, of the first that has it."""
    seen = set()
    for source in todo(layers, layers, frames):
        text, good = passes_of(source, view_layer, asked)
        if (alike := text.replace(source, "")) not in seen:
            seen.add(alike)
            yield source, text, good


def todo(layers, out, frames):
    """{input: output}."""
    if re.search(r"%\d*d", os.path.basename(layers)):
        raise EncreError(f"{layers}: write # for each digit of the frame's number, not %d")
    if "#" not in os.path.basename(layers):
        if frames is not None:
            raise EncreError(f"{layers}: is one file, not a sequence; put # where the number stands")
        return {layers: out}
    there = sequence.found(layers)
    if isinstance(frames, tuple):
        first, last = frames
        there = [frame for frame in there if (first is None or first <= frame) and (last is None or frame <= last)]
    elif frames is not None:
        there = frames
    if not there:
        raise EncreError(f"{layers}: there is no such frame; check the path")
    out = sequence.pattern(out)
    return {sequence.path(layers, frame): sequence.path(out, frame) for frame in there}


def _mark(source, change, options):
    try:
        content = sequence.content(source)
    except OSError as error:
        raise EncreError(f"{source}: can't be read ({error.strerror}); check the path") from None
    picture = {name: options.get(name) for name in ("view_layer", "asked")}
    return sequence.mark(source=content, values=change, encre=images.version(), **picture)


def split(argv, layers, jobs, threads):
    """Runs the command line `argv` in as many processes, each with its share of the frames of `layers`, and passes on
    what they say, once where all say it. RenderError: one failed."""
    more = [] if threads else ["--threads", str(max(1, (os.cpu_count() or 1) // jobs))]
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(Workplace(tempfile.gettempdir(), "encre-")).path
        hear, children = _Chorus(layers), []
        stack.callback(lambda: [_end(child) for child in children])
        for k in range(jobs):
            said = os.path.join(folder, str(k))
            with open(said, "wb") as file:
                children.append(subprocess.Popen(
                    [sys.executable, "-m", __package__.partition(".")[0], *argv, "--jobs", "1", *more, "--share",
                     f"{k}/{jobs}"], stderr=file))
            hear.files.append(stack.enter_context(open(said, "rb")))
        while any([child.poll() is None for child in children]):
            hear()
            time.sleep(_LOOK)
        hear()
    if hear.finished:
        say("note", _FINISHED.format(hear.finished, hear.frames))
    if any(child.returncode for child in children):
        raise RenderError("not all frames were drawn; see above, and run again with --resume")


def _end(child):
    if child.poll() is None:
        child.terminate()
        child.wait()


class _Chorus:
    """What processes that share a sequence write into `files`: as a function it passes on what is new."""

    def __init__(self, layers):
        self.files, self.said, self.finished, self.frames = [], set(), 0, 0
        self.one = re.compile("-?[0-9]+".join(map(re.escape, re.split("#+", shown(os.path.basename(layers))))))

    def __call__(self):
        for file in self.files:
            while (row := file.readline()).endswith(b"\n"):
                self._pass_on(row.decode(errors="replace"))
            file.seek(-len(row), os.SEEK_CUR)  # of a row that is not whole yet

    def _pass_on(self, row):
        if counts := re.fullmatch(f"encre: note: {_FINISHED}\n".format(r"(\d+)", r"(\d+)"), row):
            self.finished, self.frames = self.finished + int(counts[1]), self.frames + int(counts[2])
            return
        words = self.one.sub("", row)
        if words not in self.said:
            self.said.add(words)
            sys.stderr.write(row)
            sys.stderr.flush()
