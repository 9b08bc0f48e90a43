# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render`: finds a Blender, has it run inside.py, and takes the frames that it makes.

Only here it is known where a frame goes: Blender writes into a hidden folder beside the output, is told one frame after
the other, and what it made gets its name here once it is whole.
"""

import importlib.util
import os
import random
import re
import shutil
import sys
import time

import numpy as np

from ..pen import metadata, unwrap
from ..pen.errors import EncreError, shown
from . import composite, images, multilayer, png, sequence
from .child import Child, Ended
from .progress import Progress, put
from .workplace import Workplace

# What may be chosen of a scene, and how it is opened; None and False: as the file has it. named: the ids in values of
# which it is said if they change nothing.
CHOICES = {"samples": None, "size": None, "scene_name": None, "camera": None, "view_layer": None, "threads": None,
           "device": None, "strict": False, "autoexec": False, "passes": (), "named": ()}
_PICTURE = ("samples", "size", "scene_name", "camera", "view_layer", "passes")  # those that change the picture
_VERSION = 1  # of what a mark says


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


def render(scene, out, *, frames=None, values=None, resume=False, quick=False, dry_run=False, frame_timeout=None,
           keep_going=False, blender=None, progress=None, **choices):
    """Renders `scene` (.blend or .py) to `out` (.png or .exr).

    frames: None (the scene's current one), a list of numbers, or (first, last), either None for the scene's own;
    values: what to change of the scene's parameters; resume: leave frames alone that are whole and were made from the
    same (quick: not read to their end); frame_timeout: seconds after which one is given up; keep_going: go on after
    one that failed; progress: a Progress; choices: as in CHOICES. Raises EncreError for bad input, RenderError for
    what fails under way.
    """
    if not dry_run:
        images.prepare(out)
    command = find_blender(blender)
    out = os.path.abspath(out)
    job = {"scene": os.path.abspath(scene), "ending": os.path.splitext(out)[1], "values": values or {}, **CHOICES,
           **choices}
    progress = progress or Progress(print)
    if dry_run:
        with _Blender(command, {**job, "folder": ""}, progress) as child:
            work = _Sequence(command, job, out, frames, None, progress)
            work.plan(child.expect("ready"))
            work.show(resume, quick)
        return
    with _workplace(out) as place, _Sequence(command, {**job, "folder": place.path}, out, frames, place,
                                             progress) as work:
        work.run(resume, quick, frame_timeout, keep_going)


def compare(scene, out, take, *, frames=None, values=None, techniques=(), beside=("",), uniform=False, mips=False,
            blender=None, say=print, verbose=False, **choices):
    """Renders frames of `scene` by each of the `techniques` (techniques.py) and calls take(event) for every frame.

    The event is a dictionary: frame, path (`out` with the frame's number), pictures {technique: {"path", "seconds"}},
    baking (seconds), values (the scene's parameters), samples, blender (its version). Its pictures are gone when take()
    returns. beside: what stands before the ending of the files that take() writes. The rest is as in render().
    """
    images.prepare(out)
    command = find_blender(blender)
    out, progress = os.path.abspath(out), Progress(say, verbose=verbose)
    with _workplace(out) as place:
        job = {"scene": os.path.abspath(scene), "ending": ".png", "values": values or {}, **CHOICES, **choices,
               "folder": place.path, "techniques": techniques, "uniform": uniform, "mips": mips}
        with _Blender(command, job, progress) as child:
            todo = _todo(job["scene"], out, frames, child.expect("ready"))
            for stem, ending in map(os.path.splitext, todo.values()):
                for more in beside:
                    images.prepare(f"{stem}{more}{ending}")
            child.send(frames=list(todo))
            while (event := child.expect("frame", "pictures", "done"))["event"] != "done":
                if event["event"] == "frame":
                    child.begin(event["frame"])
                    progress.begin(event["frame"], event["number"], event["count"])
                    continue
                progress.clear()
                event["path"] = todo[event["frame"]]
                for made in event["pictures"].values():
                    made["path"] = os.path.join(place.path, os.path.basename(made["name"]))
                take(event)


def unwrapped(scene, name, out, *, blender=None, say=print, verbose=False):
    """The object `name` of a .blend file with its UV map, an unwrap.Unwrapped in world space.

    out: a file beside which there is room. Raises EncreError for the input.
    """
    command = find_blender(blender)
    with _workplace(os.path.abspath(out)) as place:
        path = os.path.join(place.path, "mesh.npz")
        job = {"scene": os.path.abspath(scene), "object": name, "mesh": path, **CHOICES}
        with _Blender(command, job, Progress(say, verbose=verbose)) as child:
            child.expect("done")
        with np.load(path) as arrays:
            return unwrap.Unwrapped(**arrays)


def _workplace(out):
    try:
        return Workplace(os.path.dirname(out))
    except OSError as error:
        raise EncreError(images.unwritable(out, error.strerror)) from None


class _Blender(Child):
    """A child whose notes, warnings and errors are told on the way."""

    def __init__(self, command, job, progress):
        super().__init__(command, job, progress.hear)
        self.progress, self.doing, self.error = progress, "", EncreError

    def __exit__(self, *reason):
        self.progress.clear()
        super().__exit__(*reason)

    def begin(self, frame):
        self.doing, self.error = f"rendering frame {frame}", RenderError

    def expect(self, *kinds, deadline=None):
        """The next message of one of these kinds. EncreError, RenderError: the child failed; TimeoutError."""
        while True:
            try:
                event = self.next(deadline)
            except Ended as how:
                where = f"while {self.doing}" if self.doing else "before it ran Encre; is it Blender?"
                raise self.error(f"{self.command[0]} stopped {where} {how}") from None
            kind = event["event"]
            if kind in kinds:
                return event
            if kind == "doing":
                self.doing = event["text"]
            elif kind == "error":
                raise self.error(event["text"])
            elif kind in ("note", "warning"):
                self.progress.say(kind, event["text"])


def _todo(scene, out, wanted, ready):
    """{frame: path}, in order."""
    if isinstance(wanted, tuple):
        first, last = (own if number is None else number
                       for number, own in zip(wanted, (ready["first"], ready["last"]), strict=True))
        wanted, out = range(first, last + 1, ready["step"]), sequence.pattern(out)
    elif wanted is None:
        wanted = [ready["current"]]
    elif len(wanted) > 1:
        out = sequence.pattern(out)
    if not wanted:
        raise EncreError(f"{scene}: there is no frame from the first to the last; give -s a frame before -e")
    return {frame: sequence.path(out, frame) for frame in wanted}


class _Sequence:
    """The frames of one call, one Blender after the other where one breaks down."""

    def __init__(self, command, job, out, frames, place, progress):
        self.command, self.job, self.out, self.frames = command, job, out, frames
        self.place, self.progress, self.child = place, progress, None
        self.todo, self.said, self.suffixes, self.keep = {}, {}, [""], ()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._end()

    def plan(self, ready):
        """What is to be done, of what the child says about the scene."""
        self.todo = _todo(self.job["scene"], self.out, self.frames, ready)
        self.suffixes, self.keep = ready["suffixes"], ready["keep"]
        try:
            content, chosen = sequence.content(self.job["scene"]), sequence.contents(self.job["values"])
        except OSError as error:
            raise EncreError(f"{error.filename or self.job['scene']}: can't be read ({error.strerror}); check the "
                             "path") from None
        self.said = {"version": _VERSION, "scene": content, "values": self.job["values"], "encre": images.version(),
                     "blender": ready["blender"], **{name: self.job[name] for name in _PICTURE},
                     **({"images": chosen} if chosen else {})}

    def mark(self, frame):
        return sequence.mark(frame=frame, **self.said)

    def finished(self, frame, quick):
        """Whether the files of a frame are there, whole, and made from the same."""
        return all(images.text(path, metadata.MARK) == self.mark(frame) and images.whole(path, last_row=quick)
                   for path in self._paths(frame))

    def _paths(self, frame):
        """The files of a frame: in stereo one for each eye."""
        stem, ending = os.path.splitext(self.todo[frame])
        return [stem + suffix + ending for suffix in self.suffixes]

    def show(self, resume, quick):
        for frame in self.todo:
            state = "finished" if resume and self.finished(frame, quick) else "to render"
            for path in self._paths(frame):
                self.progress.tell("plan", frame=frame, file=path, state=state)
                if not self.progress.as_json:
                    put(shown(f"frame {frame}: {path} ({state})"))

    def run(self, resume, quick, timeout, keep_going):
        self._start()
        for path in self.todo.values():
            images.check_place(path)
        order = {frame: number for number, frame in enumerate(self.todo, 1)}
        left, held, failed, finished = list(self.todo), {}, [], 0
        for last in range(4):
            for frame in left:
                path = self.todo[frame]
                name = os.path.basename(path)
                try:
                    holder = self.place.claim(name)
                except OSError as error:  # the folder was removed, and our own in it
                    rest = sequence.listed(each for each, file in self.todo.items() if not os.path.exists(file))
                    raise RenderError(f"{images.unwritable(path, error.strerror)}; frames {rest} are not "
                                      "rendered: run again with --resume") from None
                if holder:
                    held[frame] = holder
                    continue
                held.pop(frame, None)
                try:
                    # Only now: whoever had claimed it may have finished it.
                    if (resume or last) and self.finished(frame, quick):
                        finished += 1
                        continue
                    if not self.child:  # before a frame is begun: what Blender says of the file is no news
                        self._start()
                    self.progress.begin(frame, order[frame], len(order))
                    self._frame(frame, timeout)
                except RenderError as error:
                    if not keep_going:
                        self.progress.tell("failed", frame=frame, text=str(error))
                        raise
                    failed.append(frame)
                    self.progress.failed(frame, str(error))
                finally:
                    self.place.release(name)
            left = list(held)
            if not left or last == 3:
                break
            time.sleep(random.uniform(0.05, 0.3))  # two that claimed it at once both let go of it
        if finished:
            self.progress.say("note", f"{finished} of {len(order)} frames are finished and left alone")
        for frame, holder in held.items():
            self.progress.say("note", f"frame {frame} is left to {holder}, which is rendering it; if that runs no "
                              "more, remove its folder .encre-... beside the output")
        if failed:
            raise RenderError(f"{len(failed)} of {len(order)} frames failed: {sequence.listed(failed)}; "
                              "see the warnings above and run again with --resume")

    def _start(self):
        self.child = _Blender(self.command, self.job, self.progress).__enter__()
        self.child.error = RenderError if self.todo else EncreError
        ready = self.child.expect("ready")
        if not self.todo:
            self.plan(ready)

    def _end(self):
        if self.child:
            self.child.__exit__()
            self.child = None

    def _frame(self, frame, timeout):
        self.child.begin(frame)
        self.child.send(frame=frame, stamp={metadata.MARK: self.mark(frame)})
        try:
            event = self.child.expect("written", "failed", deadline=timeout and time.monotonic() + timeout)
        except TimeoutError:
            self._end()
            raise RenderError(f"frame {frame}: was not done after {timeout:g} s and is given up; give a longer "
                              "--frame-timeout") from None
        except RenderError:
            self._end()
            raise
        if event["event"] == "failed":
            raise RenderError(event["text"])
        self.progress.written(self._take(frame, event["names"]))

    def _slim(self, name):
        """The name of the part without what restyling needs not, where the scene wants it so."""
        part = os.path.join(self.place.path, name)
        if not name.lower().endswith(".exr"):
            return name
        with multilayer.Exr(part) as exr:
            scene = metadata.read(exr.metadata).scene
            if scene is None or scene["save_layers"] != "SLIM":
                return name
            multilayer.rewrite(exr, os.path.join(self.place.path, f"slim-{name}"), composite.packer(exr, self.keep))
        os.remove(part)
        return f"slim-{name}"

    def _take(self, frame, names):
        stem, ending = os.path.splitext(self.todo[frame])
        taken = []
        for name in names:
            match = re.fullmatch(rf"{frame}(_[^/\\\0]*)?{re.escape(ending)}", name, re.IGNORECASE | re.DOTALL)
            path = f"{stem}{(match and match[1]) or ''}{ending}"
            part = os.path.join(self.place.path, name)
            # Blender does not notice a full disk: it says that it saved.
            if match and not images.whole(part):
                raise RenderError(images.unwritable(path, "the disk may be full"))
            try:
                if not match:
                    raise ValueError
                name = self._slim(name)
                png.stamp(os.path.join(self.place.path, name), {metadata.MARK: self.mark(frame)})
                self.place.take(name, path)
            except OSError as error:
                raise RenderError(images.unwritable(path, error.strerror)) from None
            except ValueError:
                raise RenderError(f"frame {frame}: Blender says that it wrote {name!r}, which is no picture of this "
                                  "frame") from None
            taken.append(path)
        return taken
