# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender that `encre render` starts, as a script: `inside.py -- JOB.json`.

It is the only file that touches sys.path. It talks with `encre render` on a line of its own (child.py): what Blender
prints may hold anything. It is told one frame after the other and knows no path but that of its folder.
"""

import contextlib
import importlib.util
import json
import os
import re
import runpy
import select
import signal
import socket
import sys
import traceback

import bpy
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.dirname(HERE)


class Line:
    """The private line: what to do comes on it, reports go. Where it ends, this process does: nobody waits for it.

    While nothing is to come on the line, `watched()` ends this process with it, in the midst of whatever Blender does:
    on Linux by the signal that a socket sends, which kills. Elsewhere look() must be called now and then.
    """

    def __init__(self, number):
        self.socket = socket.socket(fileno=number)
        self.socket.set_inheritable(False)
        self.told = self.socket.makefile(encoding="utf-8")

    def hear(self):
        """The next message."""
        try:
            message = self.told.readline()
        except OSError:  # reset, as it is when its other end dies with reports unread
            message = ""
        if not message.endswith("\n"):
            os._exit(1)
        return json.loads(message)

    @contextlib.contextmanager
    def watched(self):
        self._signals(True)
        self.look()  # it may have ended before
        try:
            yield
        finally:
            self._signals(False)

    def _signals(self, on):
        if sys.platform == "linux":
            import fcntl

            signal.signal(signal.SIGIO, signal.SIG_DFL)
            fcntl.fcntl(self.socket, fcntl.F_SETOWN, os.getpid())
            flags = fcntl.fcntl(self.socket, fcntl.F_GETFL) & ~os.O_ASYNC
            fcntl.fcntl(self.socket, fcntl.F_SETFL, flags | (os.O_ASYNC if on else 0))

    def look(self, *_):
        if select.select([self.socket], [], [], 0)[0]:
            os._exit(1)

    def report(self, event, **more):
        self.socket.sendall(json.dumps({"event": event, **more}).encode() + b"\n")


def register(report=lambda event, **more: None):
    """Registers the package that this file is a part of as `encre`, in place of any other Encre."""
    for cls in bpy.types.RenderEngine.__subclasses__():
        if getattr(cls, "bl_idname", "") != "ENCRE":  # of whatever version: ours is not loaded yet
            continue
        name = cls.__module__.removesuffix(".engine").removesuffix(".blender")  # before 0.2 the engine lay at the top
        package = sys.modules[name]
        folder = os.path.dirname(os.path.abspath(package.__file__))
        if name == "encre" and os.path.samefile(folder, PACKAGE):
            return package
        package.unregister()
        report("note", text=f"this Encre ({PACKAGE}) takes the place of the one in Blender ({folder})")
    for name in [n for n in sys.modules if n == "encre" or n.startswith("encre.")]:
        del sys.modules[name]
    # By its place, not by its name: the folder may be called otherwise, and Blender's Python may know another.
    spec = importlib.util.spec_from_file_location("encre", os.path.join(PACKAGE, "__init__.py"),
                                                  submodule_search_locations=[PACKAGE])
    package = sys.modules["encre"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(package)
    package.register()
    package.__time__ = os.path.getmtime(package.__file__)  # or it is loaded anew for scripts that enable it
    return package


def join(package):
    """Makes this script a module of the package, which imports what lies beside it."""
    global __package__
    __package__ = importlib.import_module(".cli", package.__name__).__name__


def written_by(path):
    """(major, minor) of the Blender that saved a .blend; None: it can't be told."""
    with open(path, "rb") as file:
        start = file.read(32)
        file.seek(0)
        if start[:2] == b"\x1f\x8b":  # up to 2.93
            return None
        if start[:4] == b"\x28\xb5\x2f\xfd":
            try:
                import zstandard
            except ImportError:  # some distributions' Blender
                return None
            with contextlib.suppress(zstandard.ZstdError):
                start = zstandard.ZstdDecompressor().stream_reader(file).read(32)
    # BLENDER-v405 up to Blender 4, BLENDER17-01v0500 since.
    match = re.match(rb"BLENDER(?:[-_][vV]|\d\d-\d\d[vV])(\d{3,4})", start)
    return divmod(int(match[1]), 100) if match else None


def load(job, error, report):
    """Opens the .blend, or runs the .py in an empty scene as `python` would."""
    path = job["scene"]
    report("doing", text=f"opening {path}")
    if not path.lower().endswith(".py"):
        version, own = written_by(path), bpy.app.version[:2]
        if version and version > own:
            words = (f"{path}: was saved by Blender {version[0]}.{version[1]}, which is newer than this "
                     f"{own[0]}.{own[1]}")
            if job["strict"]:
                raise error(f"{words}; give a newer one with --blender")
            report("warning", text=f"{words}: it may look otherwise, or crash this Blender")
        try:
            if job["autoexec"]:
                bpy.ops.wm.open_mainfile(filepath=path, use_scripts=True)
            else:
                from . import trust

                job["untrusted"] = trust.opened(path, job["place"])
        except RuntimeError as reason:
            raise error(f"{path}: is not a .blend file that this Blender can read ({sentence(reason)}); "
                        "save it again") from None
        return
    # Unlike read_factory_settings, this leaves preferences and add-ons alone.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    sys.path.insert(0, os.path.dirname(path))
    sys.argv = [path]
    try:
        runpy.run_path(path, run_name="__main__")
    except SystemExit as end:
        if end.code:
            raise error(f"{path}: the script ended with {end.code}; repair it") from None
    except Exception as reason:
        own = [f.lineno for f in traceback.extract_tb(reason.__traceback__) if f.filename == path]
        line = own[-1] if own else getattr(reason, "lineno", None)
        raise error(f"{path}{f', line {line}' if line else ''}: {type(reason).__name__}: {sentence(reason)}; "
                    "repair the script") from None


def sentence(reason):
    """What an exception says, in one line, without Blender's `Error: `."""
    lines = [line.strip() for line in str(reason).splitlines() if line.strip()]
    return lines[0].removeprefix("Error: ").rstrip(".") if lines else type(reason).__name__


class Amiss:
    """What Blender passes over, and --strict does not: scripts that fail, as handlers may, and what a frame lacks."""

    def __init__(self, strict, report):
        self.strict, self.report, self.came, self.told = strict, report, [], set()
        self.show = sys.excepthook
        sys.excepthook = self.catch  # with which Blender prints what a handler raises, before it goes on

    def catch(self, kind, reason, trace):
        at = traceback.extract_tb(trace)
        where = f"{os.path.basename(at[-1].filename)}, line {at[-1].lineno}: " if at else ""
        self.came.append(f"a script failed ({where}{kind.__name__}: {sentence(reason)}); repair it")
        self.show(kind, reason, trace)

    def found(self, where, *more):
        """Why it can't go on, of what came since this was asked and is told besides; None: it can, and all that is new
        has been said."""
        words = list(dict.fromkeys([*more, *self.came]))
        self.came.clear()
        if words and self.strict:
            return f"{where}: {', '.join(words)}"
        for each in words:
            if each not in self.told:
                self.told.add(each)
                self.report("warning", text=f"{where}: {each}")
        return None


def render(job, scene, line, amiss):
    """Renders each frame that comes on the line, until the line says that it is the last."""
    from ..blender import wanted

    wanted.series = True
    while frame := line.hear():
        with line.watched():
            event, more = render_frame(job, scene, frame["frame"], frame["stamp"], amiss)
        line.report(event, **more)


def render_frame(job, scene, number, stamp, amiss):
    """What to report of it."""
    from ..blender import wanted
    from . import needed

    wanted.stamped = stamp
    scene.frame_set(number)
    lost = [f"uses {words}; bring it back" for words in needed.lost_now(scene, amiss.strict)]
    if words := amiss.found(f"frame {number}", *lost):
        return "failed", {"text": words}
    scene.render.filepath = os.path.join(job["folder"], str(number))
    try:
        done = bpy.ops.render.render(write_still=True, scene=scene.name)
    except RuntimeError as reason:
        return "failed", {"text": f"frame {number}: {sentence(reason)}"}
    # Stereo makes a file for each eye, named 1_L and 1_R.
    name = re.compile(rf"{number}(_.*)?{re.escape(job['ending'])}", re.IGNORECASE)
    if not os.path.isdir(job["folder"]):
        return "failed", {"text": f"frame {number}: the folder that it was written into is gone; run again with "
                                  "--resume"}
    made = [entry for entry in os.listdir(job["folder"]) if name.fullmatch(entry)]
    if words := amiss.found(f"frame {number}"):
        return "failed", {"text": words}
    if "FINISHED" in done and made:
        return "written", {"names": made}
    return "failed", {"text": f"frame {number}: Blender wrote no picture; run again with --verbose to see why"}


def compare(job, scene, line, _amiss):
    from . import staging, tools

    staging.mute(scene, "encre.line_color_strength")
    frames = line.hear()["frames"]
    with line.watched():
        tools.load("compare", "techniques").render(job, scene, frames, line.report)


def save_mesh(job, error):
    """Stores the triangles of an object, as the current frame evaluates it."""
    from ..blender import triangles
    from ..pen.errors import unknown

    obj = bpy.data.objects.get(job["object"])
    if obj is None:
        raise error(f"{job['scene']}: " + unknown("object", job["object"], [o.name for o in bpy.data.objects]))
    mesh = triangles.unwrapped(obj, bpy.context.evaluated_depsgraph_get())
    np.savez(job["mesh"], points=mesh.points, corners=mesh.corners, uv=mesh.uv)


def main(job, line):
    with line.watched():
        line.report("doing", text="starting")
        amiss = Amiss(job["strict"], line.report)
        join(register(line.report))
        from ..pen.errors import EncreError as error
        from . import staging

        @bpy.app.handlers.persistent  # a handler of another kind goes when a file is loaded
        def told(text, *_):
            line.look()
            if isinstance(text, str):  # later Blenders print nothing about samples by themselves
                print(text, flush=True)

        bpy.app.handlers.render_stats.append(told)
        load(job, error, line.report)
        from . import inputs

        if job["mapping"]:
            inputs.remap(job["mapping"], line.report)
        if words := amiss.found(job["scene"]):
            raise error(words)
        if "mesh" in job:
            save_mesh(job, error)
        else:
            scene = staging.prepare(job, line.report)
    if "mesh" not in job:
        script = job["scene"] if job["scene"].lower().endswith(".py") else None
        line.report("ready", inputs=inputs.files(script), fps=scene.render.fps / scene.render.fps_base,
                    first=scene.frame_start, last=scene.frame_end, step=scene.frame_step, current=scene.frame_current,
                    suffixes=staging.suffixes(scene), keep=list(staging.asked(scene)),
                    blender=bpy.app.version_string)
        (compare if "techniques" in job else render)(job, scene, line, amiss)
    line.report("done")


if __name__ == "__main__":
    # Python puts a script's folder first; there, our modules would stand in for others of the same names.
    sys.path[:] = [path for path in sys.path if os.path.abspath(path) != HERE]
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        job = json.load(file)
    line = Line(job["line"])
    try:
        main(job, line)
    except BaseException as reason:  # whatever it is, the command line says it in a sentence
        traceback.print_exc()
        ours = sys.modules.get("encre.pen.errors")  # whose words are a sentence, though a name in it has several lines
        line.report("error", text=str(reason) if ours and isinstance(reason, ours.EncreError) else sentence(reason))
    finally:
        # Blender's own exit would save preferences, and bpy's may crash.
        sys.stdout.flush()
        os._exit(0)
