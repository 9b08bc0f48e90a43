# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of one `encre render`: which are whole, which are others', who draws what next, where pictures go.

Only here it is known where a frame goes: Blender is told one frame after the other, and what it made gets its name here
once it is whole.
"""

import contextlib
import os
import random
import re
import time
from collections import deque

from ..pen import metadata
from ..pen.errors import EncreError, shown
from . import composite, images, multilayer, png, sequence
from .child import Blender, RenderError, TryAgain, failure
from .progress import put
from .sharing.workplace import AT_ONCE

# Of a job, what a picture depends on besides the values, the scene's file and the versions. What else render() takes
# says how to work, not what is drawn; a test asks of each option which of the two it is.
PICTURE = ("samples", "size", "scene_name", "camera", "view_layer", "passes", "device", "autoexec")
SERVED = ()  # in the place of frames, where they are asked for later
_VERSION = 1  # of what a mark says


def todo(scene, out, wanted, ready):
    """{frame: path}, in order. wanted: as render() has `frames`; ready: what inside.py says of the scene."""
    frames = sequence.meant(wanted, ready)
    if not frames:
        raise EncreError(f"{scene}: there is no frame from the first to the last; give -s a frame before -e")
    if isinstance(wanted, tuple) or len(frames) > 1:
        out = sequence.pattern(out)
    return {frame: sequence.path(out, frame) for frame in frames}


def made_from(job, ready):
    """All that the pictures of a job depend on, but for the frame. EncreError: a file of it can't be read."""
    try:
        content, chosen = sequence.content(job["scene"]), sequence.contents(job["values"])
    except OSError as error:
        raise EncreError(f"{error.filename or job['scene']}: can't be read ({error.strerror}); check the "
                         "path") from None
    return {"version": _VERSION, "scene": content, "values": job["values"], "encre": images.version(),
            "blender": ready["blender"], **{name: job[name] for name in PICTURE},
            **({"images": chosen} if chosen else {})}


class Frames:
    """A context manager: the frames of one call, one Blender after the other where one breaks down.

    frames: as render() has them, or SERVED; place: a Workplace beside them; timeout: seconds after which the scene's
    opening or a frame is given up, or None.
    """

    def __init__(self, command, job, out, frames, place, progress, timeout=None):
        self.command, self.job, self.out, self.frames, self.timeout = command, job, out, frames, timeout
        self.place, self.progress, self.child = place, progress, None
        self.todo, self.said, self.suffixes, self.keep, self.ready = {}, {}, [""], (), None
        self.before, self.there = None, set()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._end()

    def plan(self, ready):
        """What is to be done, of what the child says about the scene."""
        self.ready, self.suffixes, self.keep = ready, ready["suffixes"], ready["keep"]
        if self.frames != SERVED:
            self.todo = todo(self.job["scene"], self.out, self.frames, ready)
        self.said = made_from(self.job, ready)

    def mark(self, frame):
        return sequence.mark(frame=frame, **self.said)

    def finished(self, frame, quick):
        """Whether the files of a frame are there, whole, and made from the same. What another process has put in its
        place since this one began was whole then."""
        return all(images.text(path, metadata.MARK) == self.mark(frame)
                   and images.whole(path, last_row=quick or path not in self.there) for path in self._paths(frame))

    def paths(self, frames):
        """{frame: path} of those that are asked for one after the other."""
        out = sequence.pattern(self.out)
        return {frame: sequence.path(out, frame) for frame in frames}

    def _paths(self, frame):
        """The files of a frame: in stereo one for each eye."""
        stem, ending = os.path.splitext(self.todo[frame])
        return [stem + suffix + ending for suffix in self.suffixes]

    def show(self, resume, quick):
        """Tells what would be read and written."""
        for path in [self.job["scene"], *self.ready["inputs"]]:
            self.progress.tell("input", file=path, there=os.path.exists(path))
        for frame in self.todo:
            state = "finished" if resume and self.finished(frame, quick) else "to render"
            for path in self._paths(frame):
                self.progress.tell("plan", frame=frame, file=path, state=state)
                if not self.progress.as_json:
                    put(shown(f"frame {frame}: {path} ({state})"))

    def run(self, resume, quick, keep_going, wait):
        """Renders what is to be done, first what nobody else has, then what others have let go of. Returns only when
        every picture is in its place. RenderError: not all are; TryAgain: and may be another time."""
        if not self.child:
            self.start()
        for path in self.todo.values():
            images.check_place(path)
        self.there = {path for frame in self.todo for path in self._paths(frame) if os.path.exists(path)}
        order, count = {frame: number for number, frame in enumerate(self.todo, 1)}, len(self.todo)
        left, failed, finished, told, rounds = list(self.todo), {}, [], set(), 0
        while left:
            held, claims, shared = {}, self._claims(), False
            ahead = deque(left)
            while ahead:
                if claims and not shared:  # others work as well: each process goes through the frames in its own order
                    shared, ahead = True, deque(random.sample(ahead, len(ahead)))
                frame = ahead.popleft()
                name = os.path.basename(self.todo[frame])
                try:
                    if (resume or rounds) and self.finished(frame, quick):
                        finished.append(frame)
                        self.progress.tell("finished", frame=frame)
                        continue
                    if holder := claims.get(name) or self._claim(frame):
                        held[frame] = holder
                        continue
                    # Whoever had claimed it may have finished it meanwhile.
                    if (resume or rounds) and self.finished(frame, quick):
                        finished.append(frame)
                        self.progress.tell("finished", frame=frame)
                        continue
                    if not self.child:  # before a frame is begun: what Blender says of the file is no news
                        self.start()
                    self.progress.begin(frame, order[frame], count)
                    self._frame(frame, quick)
                    claims = self._claims()
                except RenderError as error:
                    if not keep_going:
                        self.progress.tell("failed", frame=frame, text=str(error))
                        raise
                    failed[frame] = error
                    self.progress.failed(frame, str(error))
                finally:
                    self.place.release()
            left, rounds = list(held), rounds + 1
            if not wait and rounds > AT_ONCE:
                break
            if left:
                self._wait(held, rounds, told if wait else set(left))
        if finished:
            self.progress.say("note", f"{len(finished)} of {count} frames are finished and left alone")
        self._sum_up(failed, {frame: held[frame] for frame in left})

    def _claims(self):
        try:
            return self.place.claims()
        except OSError:  # the folder was removed, which _claim() tells
            return {}

    def _claim(self, frame):
        path = self.todo[frame]
        try:
            holder = self.place.claim(os.path.basename(path))
        except OSError as error:  # the folder was removed, and our own in it
            rest = sequence.listed(each for each, file in self.todo.items() if not os.path.exists(file))
            raise TryAgain(f"{images.unwritable(path, error.strerror)}; frames {rest} are not "
                           "rendered: run again with --resume") from None
        self.before = self._seen(frame)
        return holder

    def _seen(self, frame):
        """What changes when anybody puts a picture of the frame in its place."""
        return [sequence.stamp(path) for path in self._paths(frame)]

    def _wait(self, held, rounds, told):
        """Waits a while for who has what is left; `told`: the frames of which that has been said."""
        for frame, holder in held.items():
            if frame not in told and rounds >= AT_ONCE:
                told.add(frame)
                self.progress.say("note", f"frame {frame} is being rendered by {holder}; waiting for it, or for its "
                                          "claim to run out")
        self.place.wait(rounds)

    def _sum_up(self, failed, held):
        for frame, holder in held.items():
            self.progress.tell("held", frame=frame, text=holder)
        if failed:
            kind = TryAgain if all(isinstance(error, TryAgain) for error in failed.values()) else RenderError
            raise kind(f"{len(failed)} of {len(self.todo)} frames failed: {sequence.listed(failed)}; "
                       "see the warnings above and run again with --resume")
        if held:
            frame, holder = next(iter(held.items()))
            more = f"; so are {len(held) - 1} more: {sequence.listed(list(held)[1:])}" if len(held) > 1 else ""
            raise TryAgain(f"frame {frame} is being rendered by {holder}{more}; run again with --resume, or without "
                           "--no-wait")
        if lost := [frame for frame in self.todo if not all(map(os.path.isfile, self._paths(frame)))]:
            raise TryAgain(f"frames {sequence.listed(lost)}: were finished and are gone again; run again with --resume")

    def start(self):
        """Has Blender open the scene."""
        deadline = self.timeout and time.monotonic() + self.timeout
        self.child = Blender(self.command, self.job, self.progress, self.place.renew).__enter__()
        self.child.error = RenderError if self.said else EncreError
        try:
            ready = self.child.expect("ready", deadline=deadline)
        except TimeoutError:
            self._end()
            raise TryAgain(f"{self.job['scene']}: was not open after {self.timeout:g} s and is given up; give a longer "
                           "--frame-timeout") from None
        except EncreError:
            self._end()
            raise
        if not self.said:
            self.plan(ready)

    def _end(self):
        if self.child:
            self.child.__exit__()
            self.child = None

    def _frame(self, frame, quick):
        self.child.begin(frame)
        self.child.send(frame=frame, stamp={metadata.MARK: self.mark(frame)})
        try:
            event = self.child.expect("written", "failed", deadline=self.timeout and time.monotonic() + self.timeout)
        except TimeoutError:
            self._end()
            raise TryAgain(f"frame {frame}: was not done after {self.timeout:g} s and is given up; give a longer "
                           "--frame-timeout") from None
        except RenderError:
            self._end()
            raise
        if event["event"] == "failed":
            raise failure(event["text"])
        self.progress.written(*self._take(frame, event["names"], quick))

    def _packed(self, name):
        """The name of the part as it is to stay: without what restyling needs not, where the scene wants it so. Blender
        does not notice a full disk, it says that it saved. EncreError: pixels are missing."""
        part = os.path.join(self.place.path, name)
        if name.lower().endswith(".exr"):
            with multilayer.Exr(part) as exr:
                scene = metadata.read(exr.metadata).scene
                if scene and scene["save_layers"] == "SLIM":  # packing reads all of it
                    multilayer.rewrite(exr, os.path.join(self.place.path, f"slim-{name}"),
                                       composite.packer(exr, self.keep), self.place.renew)
                    os.remove(part)
                    return f"slim-{name}"
        if not images.whole(part):
            raise EncreError
        return name

    def _take(self, frame, names, quick):
        """Puts what Blender has written in its place; (the paths, whether another's pictures were there before)."""
        stem, ending = os.path.splitext(self.todo[frame])
        made = {}
        for name in names:
            match = re.fullmatch(rf"{frame}(_[^/\\\0]*)?{re.escape(ending)}", name, re.IGNORECASE | re.DOTALL)
            path = f"{stem}{(match and match[1]) or ''}{ending}"
            with self._placing(frame, name, path):
                if not match:
                    raise ValueError
                made[path] = self._packed(name)
                if ending.lower() == ".png":
                    png.stamp(os.path.join(self.place.path, name), {metadata.MARK: self.mark(frame)})
        # Another may have taken the frame over, where it was long that nothing was heard of this process.
        if self._seen(frame) != self.before and self.finished(frame, quick):
            for name in made.values():
                os.remove(os.path.join(self.place.path, name))
            return list(made), True
        for path, name in made.items():
            with self._placing(frame, name, path):
                self.place.take(name, path)
        return list(made), False

    @contextlib.contextmanager
    def _placing(self, frame, name, path):
        try:
            yield
        except OSError as error:
            raise RenderError(images.unwritable(path, error.strerror)) from None
        except EncreError:
            raise RenderError(images.unwritable(path, "the disk may be full")) from None
        except ValueError:
            raise RenderError(f"frame {frame}: Blender says that it wrote {name!r}, which is no picture of this "
                              "frame") from None
