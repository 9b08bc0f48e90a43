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
        trust = {"use_scripts": True} if job["autoexec"] else {}
        try:
            bpy.ops.wm.open_mainfile(filepath=path, **trust)
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


def mute(scene, path):
    """Keeps keyframes and drivers from overwriting a value that the command line gives."""
    data = scene.animation_data
    if not data:
        return
    curves = list(data.drivers)
    if data.action:
        # Blender 5 has no list of its own for an action of one slot.
        curves += data.action.fcurves if hasattr(data.action, "fcurves") else [
            curve for layer in data.action.layers for strip in layer.strips for bag in strip.channelbags
            for curve in bag.fcurves]
    for curve in curves:
        if curve.data_path == path or curve.data_path.startswith(path + "["):
            curve.mute = True


def chosen(kind, name, known, job, error):
    from ..pen.errors import unknown

    if name not in known:
        raise error(f"{job['scene']}: " + unknown(kind, name, known.keys()))
    return known[name]


def missing():
    """Files that the scene uses and that are not there."""
    found = [(library.filepath, None) for library in bpy.data.libraries]
    found += [(image.filepath, image.library) for image in bpy.data.images
              if image.source == "FILE" and image.users and image.filepath and not image.packed_file]
    return [path for path, library in found if not os.path.exists(bpy.path.abspath(path, library=library))]


def use_device(scene, name, error):
    """Has Cycles render on the processor or on the graphics cards of a kind."""
    scene.cycles.device = "CPU" if name == "cpu" else "GPU"
    if name == "cpu":
        return
    cycles = bpy.context.preferences.addons["cycles"].preferences
    try:
        cycles.compute_device_type = name.upper()
    except TypeError:
        raise error(f"--device {name}: this Blender knows no such devices; give --device cpu") from None
    cycles.get_devices()
    cards = [device for device in cycles.devices if device.type == name.upper()]
    if not cards:
        raise error(f"--device {name}: Blender finds none; give --device cpu, or look after its driver")
    for device in cycles.devices:
        device.use = device in cards


def choose(job, error):
    """The scene that the job names, its camera and view layers set as it says."""
    from ..blender import properties

    scene = bpy.context.scene
    if job["scene_name"] is not None:
        scene = chosen("scene", job["scene_name"], bpy.data.scenes, job, error)
        if bpy.context.window:
            bpy.context.window.scene = scene
    if job["camera"] is not None:
        cameras = {obj.name: obj for obj in scene.objects if obj.type == "CAMERA"}
        scene.camera = chosen("camera", job["camera"], cameras, job, error)
        for marker in scene.timeline_markers:  # which would change it with the frame
            marker.camera = None
    if job["view_layer"] is not None:
        chosen("view layer", job["view_layer"], scene.view_layers, job, error)
        for layer in scene.view_layers:
            layer.use = layer.name == job["view_layer"]
    for switch, name in properties.PASSES.items():
        for layer in scene.view_layers if name in job["passes"] else ():
            setattr(layer.encre, switch, True)
    if job["threads"] is not None:
        scene.render.threads_mode = "FIXED" if job["threads"] else "AUTO"
        if job["threads"]:
            scene.render.threads = job["threads"]
    if job["device"] is not None:
        use_device(scene, job["device"], error)
    return scene


def heed(job, error, report):
    """Says what the file asks for and does not get."""
    if bpy.app.autoexec_fail and not job["autoexec"]:
        report("warning", text=f"{job['scene']}: its scripts and drivers in Python were not run; if you trust whoever "
               "made the file, give --enable-autoexec")
    if paths := missing():
        words = f"{job['scene']}: uses files that are not there: {', '.join(paths)}"
        if job["strict"]:
            raise error(f"{words}; bring them back")
        report("warning", text=words)


def prepare(job, error, report):
    """Sets the scene up as the job asks. Nothing of it is saved."""
    from ..blender import ENGINE, papers, properties

    heed(job, error, report)
    scene = choose(job, error)
    scene.render.engine = ENGINE
    for id_, value in job["values"].items():
        mute(scene, f"encre.{id_}")
        properties.set_value(scene.encre, id_, value)
    if not any(layer.use for layer in scene.view_layers):
        raise error(f"{job['scene']}: scene {scene.name} renders none of its view layers; switch one on or give "
                    "--view-layer")
    camera = scene.camera
    if not camera or camera.type != "CAMERA":
        raise error(f"{job['scene']}: scene {scene.name} has no camera; add one and make it the scene's active camera")
    settings = properties.settings(scene)
    if settings.paper:
        papers.load(settings.paper)
    if camera.data.type == "PANO" and settings.active:
        raise error(f"{job['scene']}: camera {camera.name} is panoramic; make it perspective or orthographic")
    if job["samples"]:
        scene.cycles.samples = job["samples"]
    if job["size"]:
        scene.render.resolution_x, scene.render.resolution_y = job["size"]
        scene.render.resolution_percentage = 100
    picture = scene.render.image_settings
    exr = job["ending"].lower() == ".exr"
    if hasattr(picture, "media_type"):  # Blender 5: the formats on offer depend on it
        picture.media_type = "MULTI_LAYER_IMAGE" if exr else "IMAGE"
    picture.file_format = "OPEN_EXR_MULTILAYER" if exr else "PNG"
    picture.color_mode, picture.color_depth = "RGBA", "32" if exr else "8"
    if exr:
        picture.views_format = "MULTIVIEW"  # both eyes in one file
    elif scene.render.use_multiview:
        for view in scene.render.views:  # their words end the file's name
            if re.search(r"[/\\\0]", view.file_suffix):
                raise error(f"{job['scene']}: view {view.name} has the file suffix {view.file_suffix}, which leads "
                            "into another folder; change it")
    scene.render.use_file_extension = True
    if exr and "save_layers" not in job["values"] and scene.encre.save_layers == "AUTO" and properties.active(scene):
        mute(scene, "encre.save_layers")
        scene.encre.save_layers = "SLIM"
    return scene


def asked(scene):
    """`view layer.pass` of what the scene's maker wants in files and slim ones would else do without."""
    for layer in scene.view_layers:
        wanted = {"DiffDir": layer.use_pass_diffuse_direct, "DiffInd": layer.use_pass_diffuse_indirect,
                  "Denoising Depth": layer.cycles.denoising_store_passes}
        yield from (f"{layer.name}.{name}" for name, wants in wanted.items() if wants)


def suffixes(scene):
    """What Blender puts before the endings of a picture's files."""
    picture = scene.render.image_settings
    if not scene.render.use_multiview or picture.file_format != "PNG" or picture.views_format != "INDIVIDUAL":
        return [""]
    return [view.file_suffix for view in scene.render.views if view.use]


def render(job, scene, line):
    """Renders each frame that comes on the line, until the line says that it is the last."""
    while frame := line.hear():
        with line.watched():
            event, more = render_frame(job, scene, frame["frame"], frame["stamp"])
        line.report(event, **more)


def render_frame(job, scene, number, stamp):
    """What to report of it."""
    from ..blender import frame as engine_frame

    engine_frame.stamped = stamp
    scene.frame_set(number)
    scene.render.filepath = os.path.join(job["folder"], str(number))
    try:
        done = bpy.ops.render.render(write_still=True, scene=scene.name)
    except RuntimeError as reason:
        return "failed", {"text": f"frame {number}: {sentence(reason)}"}
    # Stereo makes a file for each eye, named 1_L and 1_R.
    name = re.compile(rf"{number}(_.*)?{re.escape(job['ending'])}", re.IGNORECASE)
    made = [entry for entry in os.listdir(job["folder"]) if name.fullmatch(entry)]
    if "FINISHED" in done and made:
        return "written", {"names": made}
    return "failed", {"text": f"frame {number}: Blender wrote no picture; run again with --verbose to see why"}


def compare(job, scene, line):
    from . import tools

    mute(scene, "encre.edge_color")
    frames = line.hear()["frames"]
    with line.watched():
        tools.load("compare", "techniques").render(job, scene, frames, line.report)


def save_mesh(job, error):
    """Stores the triangles of an object, as the current frame evaluates it."""
    from ..blender import meshes
    from ..pen.errors import unknown

    obj = bpy.data.objects.get(job["object"])
    if obj is None:
        raise error(f"{job['scene']}: " + unknown("object", job["object"], [o.name for o in bpy.data.objects]))
    mesh = meshes.unwrapped(obj, bpy.context.evaluated_depsgraph_get())
    np.savez(job["mesh"], points=mesh.points, corners=mesh.corners, uv=mesh.uv)


def main(job, line):
    with line.watched():
        line.report("doing", text="starting")
        join(register(line.report))
        from ..pen.errors import EncreError as error

        @bpy.app.handlers.persistent  # a handler of another kind goes when a file is loaded
        def told(text, *_):
            line.look()
            if isinstance(text, str):  # later Blenders print nothing about samples by themselves
                print(text, flush=True)

        bpy.app.handlers.render_stats.append(told)
        load(job, error, line.report)
        if "mesh" in job:
            save_mesh(job, error)
        else:
            scene = prepare(job, error, line.report)
    if "mesh" not in job:
        line.report("ready", first=scene.frame_start, last=scene.frame_end, current=scene.frame_current,
                    suffixes=suffixes(scene), keep=list(asked(scene)), blender=bpy.app.version_string)
        (compare if "techniques" in job else render)(job, scene, line)
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
        line.report("error", text=sentence(reason))
    finally:
        # Blender's own exit would save preferences, and bpy's may crash.
        sys.stdout.flush()
        os._exit(0)
