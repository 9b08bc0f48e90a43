# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite` on a file or a sequence of them; jobs shares one among processes, each of which runs this."""

import contextlib
import os
import re
import tempfile
import time
from dataclasses import dataclass

from ..pen import metadata
from ..pen.errors import Cancelled, EncreError, shown
from . import images, interrupt, sequence
from .child import RenderError, TryAgain
from .composite import check as passes_of
from .composite import composite, images_of
from .passes import substitutes
from .progress import put, say
from .sharing import lease, workplace

FAILED, DRAWN, FINISHED, LEFT, BEGUN = "failed", "drawn", "finished", "left", "begun"  # what a frame may be


@dataclass(frozen=True)
class Frame:
    """One file of a sequence and what is drawn of it; number: None where there is but one file."""

    number: int | None
    source: str
    path: str


def plan(layers, out, frames, keep_going=False):
    """The Frames that are to be drawn, whose places have been looked at. Raises EncreError, with `keep_going` not for
    a frame that is not there."""
    whole = todo(layers, out, frames)
    images.prepare(out)
    if lost := [frame for frame in whole if frame.number is not None and not os.path.exists(frame.source)]:
        others = f" nor {len(lost) - 1} more: frames {sequence.listed([frame.number for frame in lost])}"
        if not keep_going:
            raise EncreError(f"{lost[0].source}: there is no such file{others if len(lost) > 1 else ''}; give only "
                             "frames that are there, or --keep-going")
    for frame in whole:
        if os.path.exists(frame.path) and os.path.exists(frame.source) and os.path.samefile(frame.path, frame.source):
            raise EncreError(f"{frame.path}: is the file that is read, whose layers would be lost; give another name")
        images.check_place(frame.path)
    return whole


def restyle(whole, out, change, tell, *, share=(0, 1), resume=False, keep_going=False, wait=True,
            seconds=lease.SECONDS, say=say, **options):
    """Restyles the Frames `whole` into `out`, the name of all.

    tell(frame, state, words) hears what becomes of each; share (k, n): only every n-th, from the k-th on; resume: leave
    alone what is whole and was made from the same; keep_going: go on after one that failed; wait: for what others draw;
    seconds: how long a claim lasts; options: as composite() has them. Raises what composite() does for a single file,
    which fails in no other way.
    """
    said, parent, left, rounds, held = {}, os.getppid(), whole[share[0]::share[1]], 0, {}
    with contextlib.ExitStack() as stack:
        if share[1] > 1:  # its folder would stay if it were killed
            stack.callback(workplace.sweep, tempfile.gettempdir())
        place = stack.enter_context(images.writing([out], seconds))
        stack.enter_context(interrupt.beating(place.renew))
        while left:
            held, rounds = {}, rounds + 1
            for frame in left:
                if share[1] > 1 and os.getppid() != parent:  # it was killed, and nobody waits for the rest
                    raise RenderError("the process that shares the frames out is gone; run again with --resume")
                tell(frame, BEGUN)
                try:
                    state, words = _one(frame, change, place, resume or rounds > 1, _once(say, said, frame.source),
                                        options)
                    if state == LEFT:
                        held[frame] = words
                    else:
                        tell(frame, state, words)
                except Cancelled:
                    raise
                except (EncreError, OSError, MemoryError) as error:
                    if frame.number is None:
                        raise
                    tell(frame, FAILED, _reason(frame, error))
                    if not keep_going:
                        return
            left = list(held)
            if not wait and rounds > workplace.AT_ONCE:
                break
            if left:
                for words in held.values() if rounds == workplace.AT_ONCE else ():
                    say("note", f"{words}; waiting for it, or for its claim to run out")
                place.wait(rounds)
    for frame in left:
        tell(frame, LEFT, held[frame])


def _one(frame, change, place, again, say, options):
    """What became of a frame, and more words. again: it may be finished."""
    name, start = os.path.basename(frame.path), time.perf_counter()
    options = {**options, "asked": substitutes.of_frame(options.get("asked") or {}, frame.source, frame.number)}
    if holder := place.claim(name):
        return LEFT, f"{frame.path} is being drawn by {holder}"
    try:
        texts = {metadata.MARK: _mark(frame.source, change, options)} if frame.number is not None or again else None
        if again and _finished(frame, texts):
            return FINISHED, ""
        part, before = os.path.join(place.path, name), sequence.stamp(frame.path)
        try:
            composite(frame.source, part, change, say=say, texts=texts, **options)
        except images.WriteError as error:
            raise images.WriteError(str(error).replace(part, frame.path)) from None
        except EncreError as error:
            raise EncreError(_reason(frame, error)) from None
        # Another may have taken the frame over, where it was long that nothing was heard of this process.
        if texts and sequence.stamp(frame.path) != before and _finished(frame, texts):
            os.remove(part)
            return FINISHED, ""
        place.take(name, frame.path)
        put(f"{shown(frame.path)} ({time.perf_counter() - start:.1f} s)")
        return DRAWN, ""
    finally:
        place.release()


def _finished(frame, texts):
    return images.text(frame.path, metadata.MARK) == texts[metadata.MARK] and images.whole(frame.path)


def _reason(frame, error):
    """Why a frame failed, in a sentence that names its file."""
    if isinstance(error, OSError):
        return images.unwritable(frame.path, error.strerror)
    words = str(error) or "there is not enough memory for it"
    return words if frame.source in words or frame.path in words else f"{frame.source}: {words}"


def sum_up(whole, states, say=say):
    """Says what became of `whole`, by {frame: state}; RenderError: not all was done."""
    def numbers(*wanted):
        return sequence.listed([frame.number for frame in whole if states.get(frame) in wanted])

    if finished := sum(state == FINISHED for state in states.values()):
        say("note", f"{finished} of {len(whole)} frames are finished and left alone")
    if bad := sum(state == FAILED for state in states.values()):
        rest = numbers(None, BEGUN)
        more = f"; not drawn after that: {rest}" if rest else ""
        raise RenderError(f"{bad} of {len(whole)} frames failed: {numbers(FAILED)}{more}; see the warnings above, and "
                          "run again with --resume")
    if left := [frame for frame in whole if states.get(frame) == LEFT]:
        others = f" and others {len(left) - 1} more" if len(left) > 1 else ""
        raise TryAgain(f"{left[0].path} is being drawn by another process{others}; run again with --resume, or without "
                       "--no-wait")
    if lost := [frame.path for frame in whole if not os.path.isfile(frame.path)]:
        raise TryAgain(f"{lost[0]}: was drawn and is gone again; run again with --resume")


def _once(say, said, source):
    """`say` for the frame `source`: what another frame said already is not said again."""
    def hear(kind, sentence):
        if said.setdefault((kind, sentence.replace(source, "")), source) == source:
            say(kind, sentence)
    return hear


def check(layers, frames, asked, **options):
    """Yields (text that lists its passes, why it can't be drawn or None) of an EXR or of those of a sequence: each list
    once, of the first that has it. options: as composite.check() has them."""
    seen, whole = set(), todo(layers, layers, frames)
    for frame in whole:
        source = frame.source
        try:
            text, fault = passes_of(source, asked=substitutes.of_frame(asked, source, frame.number), **options)
        except EncreError as error:
            text, fault = "", str(error)
        fault = fault and (fault if source in fault else f"{source}: {fault}")
        new = text and (alike := text.replace(source, "")) not in seen
        if new:
            seen.add(alike)
        if new or fault:
            yield text if new else "", fault
    if len(whole) > 1:
        yield f"{layers}: {len(whole)} files; lists that are alike are shown once", None


def todo(layers, out, frames):
    """The Frames that are meant."""
    if re.search(r"%\d*d", os.path.basename(layers)):
        raise EncreError(f"{layers}: write # for each digit of the frame's number, not %d")
    if "#" not in os.path.basename(layers):
        if frames is not None:
            raise EncreError(f"{layers}: is one file, not a sequence; put # where the number stands")
        if "#" in os.path.basename(out):
            raise EncreError(f"{out}: has # for a frame's number, but {layers} is one file; take it out, or "
                             "give a sequence")
        return [Frame(None, layers, out)]
    there = sequence.found(layers)
    if isinstance(frames, tuple):
        first, last = frames
        there = [frame for frame in there if (first is None or first <= frame) and (last is None or frame <= last)]
    elif frames is not None:
        there = frames
    if not there:
        raise EncreError(f"{layers}: there is no such frame; check the path")
    out = sequence.pattern(out)
    return [Frame(number, sequence.path(layers, number), sequence.path(out, number)) for number in there]


def _mark(source, change, options):
    try:
        content = sequence.content(source)
        chosen = [sequence.content(path) for path in (
            *images_of(source, change, options.get("allow_paths", False)),
            *filter(None, (substitutes.in_file(name)[0] for name in (options.get("asked") or {}).values())))]
    except OSError as error:
        raise EncreError(f"{error.filename or source}: can't be read ({error.strerror}); check the path") from None
    picture = {name: options.get(name) for name in ("view_layer", "asked", "renderer")}
    return sequence.mark(source=content, values=change, encre=images.version(), images=chosen, **picture)
