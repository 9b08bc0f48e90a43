# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render`: finds a Blender, has it run inside.py, and what else wants one of a scene.

frames.py takes what it makes: Blender writes into a hidden folder beside the output and knows no other path.
"""

import contextlib
import importlib.util
import os
import shutil
import sys

import numpy as np

from ..pen import unwrap
from ..pen.errors import EncreError
from . import images
from .child import Blender
from .frames import Frames, todo
from .progress import Progress
from .sharing import lease
from .sharing.workplace import Workplace

# What may be chosen of a scene, and how it is opened; None and False: as the file has it. named: the ids in values of
# which it is said if they change nothing; place: the folder below which a stranger's file may write, None: nowhere;
# mapping: rules of mapping.read().
CHOICES = {"samples": None, "size": None, "scene_name": None, "camera": None, "view_layer": None, "threads": None,
           "device": None, "strict": False, "autoexec": False, "passes": (), "named": (), "place": None, "mapping": ()}


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


@contextlib.contextmanager
def opened(scene, out, frames=None, *, values=None, frame_timeout=None, seconds=lease.SECONDS, blender=None, progress,
           **choices):
    """The frames.Frames of `scene` (.blend or .py), to be written to `out` (.png or .exr).

    frames: None (the scene's current one), a list of numbers, or (first, last), either None for the scene's own, or
    frames.SERVED; values: what to change of the scene's parameters; frame_timeout: seconds after which the scene's
    opening or a frame is given up; seconds: how long a claim lasts when nothing is heard of this process; choices: as
    in CHOICES. Raises EncreError for bad input.
    """
    images.prepare(out)
    command, out = find_blender(blender), os.path.abspath(out)
    with _workplace(out, seconds) as place:
        job = {**_job(scene, out, values, choices), "folder": place.path}
        with Frames(command, job, out, frames, place, progress, frame_timeout) as work:
            yield work


def render(scene, out, *, resume=False, quick=False, keep_going=False, wait=True, **options):
    """Renders frames of a scene. resume: leave those alone that are whole and were made from the same (quick: not read
    to their end); keep_going: go on after one that failed; wait: for what others render; options: as opened() has them.
    Raises EncreError for bad input, RenderError for what fails under way."""
    with opened(scene, out, **options) as work:
        work.run(resume, quick, keep_going, wait)


def planned(scene, out, frames=None, *, values=None, blender=None, progress, **choices):
    """The Frames of a scene that has been opened for this, of which nothing is rendered."""
    command, out = find_blender(blender), os.path.abspath(out)
    job = _job(scene, out, values, choices)
    with Blender(command, {**job, "folder": ""}, progress) as child:
        work = Frames(command, job, out, frames, None, progress)
        work.plan(child.expect("ready"))
    return work


def _job(scene, out, values, choices):
    return {"scene": os.path.abspath(scene), "ending": os.path.splitext(out)[1], "values": values or {}, **CHOICES,
            "place": os.path.dirname(out), **choices}


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
               "place": os.path.dirname(out), "folder": place.path, "techniques": techniques, "uniform": uniform,
               "mips": mips}
        with Blender(command, job, progress) as child:
            paths = todo(job["scene"], out, frames, child.expect("ready"))
            for stem, ending in map(os.path.splitext, paths.values()):
                for more in beside:
                    images.prepare(f"{stem}{more}{ending}")
            child.send(frames=list(paths))
            while (event := child.expect("frame", "pictures", "done"))["event"] != "done":
                if event["event"] == "frame":
                    child.begin(event["frame"])
                    progress.begin(event["frame"], event["number"], event["count"])
                    continue
                progress.clear()
                event["path"] = paths[event["frame"]]
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
        with Blender(command, job, Progress(say, verbose=verbose)) as child:
            child.expect("done")
        with np.load(path) as arrays:
            return unwrap.Unwrapped(**arrays)


def _workplace(out, seconds=lease.SECONDS):
    try:
        return Workplace(os.path.dirname(out), seconds=seconds)
    except OSError as error:
        raise EncreError(images.unwritable(out, error.strerror)) from None
