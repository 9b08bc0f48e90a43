# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender that `encre render` starts, as a script: `inside.py -- JOB.json`.

It is the only file that touches sys.path. It reports by lines `ENCRE {json}` on the standard output, which Blender
shares with its own.
"""

import importlib.util
import json
import os
import re
import runpy
import sys
import traceback

import bpy
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.dirname(HERE)


def report(event, **more):
    # One write with a line break before it: Blender buffers its own output and may stand in the middle of a line.
    os.write(1, f"\nENCRE {json.dumps({'event': event, **more})}\n".encode())


def register():
    """Registers the package that this file is a part of as `encre`, in place of any other Encre."""
    for cls in bpy.types.RenderEngine.__subclasses__():
        if getattr(cls, "bl_idname", "") != "ENCRE":  # of whatever version: ours is not loaded yet
            continue
        name = cls.__module__.removesuffix(".engine").removesuffix(".blender")  # before 0.2 the engine lay at the top
        package = sys.modules[name]
        folder = os.path.dirname(os.path.abspath(package.__file__))
        if os.path.samefile(folder, PACKAGE):
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


def load(path, error):
    """Opens the .blend, or runs the .py in an empty scene as `python` would."""
    report("doing", text=f"opening {path}")
    if not path.lower().endswith(".py"):
        try:
            bpy.ops.wm.open_mainfile(filepath=path)
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


def prepare(job, error):
    """Sets the scene up as the job asks. Nothing of it is saved."""
    from encre.blender import ENGINE, papers, properties

    scene = bpy.context.scene
    scene.render.engine = ENGINE
    for id_, value in job["values"].items():
        mute(scene, f"encre.{id_}")
        properties.set_value(scene.encre, id_, value)
    camera = scene.camera
    if not camera or camera.type != "CAMERA":
        raise error(f"{job['scene']}: scene {scene.name} has no camera; add one and make it the scene's active camera")
    settings = properties.settings(scene)
    if settings.scene["paper_source"] == "IMAGE":
        papers.load(settings.scene["paper_image"])
    if camera.data.type == "PANO" and settings.active:
        raise error(f"{job['scene']}: camera {camera.name} is panoramic; make it perspective or orthographic")
    if job["samples"]:
        scene.cycles.samples = job["samples"]
    if job["size"]:
        scene.render.resolution_x, scene.render.resolution_y = job["size"]
        scene.render.resolution_percentage = 100
    picture = scene.render.image_settings
    exr = job["out"].lower().endswith(".exr")
    if hasattr(picture, "media_type"):  # Blender 5: the formats on offer depend on it
        picture.media_type = "MULTI_LAYER_IMAGE" if exr else "IMAGE"
    picture.file_format = "OPEN_EXR_MULTILAYER" if exr else "PNG"
    picture.color_mode, picture.color_depth = "RGBA", "32" if exr else "8"
    if exr:
        picture.views_format = "MULTIVIEW"  # both eyes in one file
    scene.render.use_file_extension = True
    return scene


def frames(job, scene):
    """[(frame, output path)] in order. Runs of # in the file's name become the number; a range without gets four
    digits before the ending."""
    wanted = job["frames"]
    folder, name = os.path.split(job["out"])
    if isinstance(wanted, list):
        first, last = (scene.frame_start if wanted[0] is None else wanted[0],
                       scene.frame_end if wanted[1] is None else wanted[1])
        if "#" not in name:
            stem, ending = os.path.splitext(name)
            name = f"{stem}####{ending}"
    else:
        first = last = scene.frame_current if wanted is None else wanted
    return [(frame, os.path.join(folder, re.sub("#+", lambda run, f=frame: f"{f:0{len(run[0])}d}", name)))
            for frame in range(first, last + 1)]


def render(job, scene, error):
    from encre.cli import images

    todo = frames(job, scene)
    if not todo:
        raise error(f"{job['scene']}: there is no frame from the first to the last; give -s a frame before -e")
    left = [(frame, path) for frame, path in todo if path not in job["finished"]]
    if len(left) < len(todo):
        report("note", text=f"{len(todo) - len(left)} of {len(todo)} frames are finished and left alone")
    for _, path in left:
        images.prepare(path)
    for number, (frame, path) in enumerate(left, 1):
        report("frame", frame=frame, number=number, count=len(left))
        scene.frame_set(frame)
        stem, ending = os.path.splitext(path)
        scene.render.filepath = os.path.join(job["folder"], f"{frame}{ending}")
        try:
            done = bpy.ops.render.render(write_still=True)
        except RuntimeError as reason:
            raise error(f"frame {frame}: {sentence(reason)}") from None
        # Stereo makes a file for each eye, named 1_L and 1_R.
        made = [name for name in os.listdir(job["folder"]) if re.fullmatch(rf"{frame}(_.*)?{re.escape(ending)}", name)]
        if "FINISHED" not in done or not made:
            raise error(f"frame {frame}: Blender wrote no picture; run again with --verbose to see why")
        report("written", files=[[os.path.join(job["folder"], name), stem + name.removeprefix(str(frame))]
                                 for name in made])


def compare(job, scene, error):
    from encre.cli import images, tools

    todo = frames(job, scene)
    if not todo:
        raise error(f"{job['scene']}: there is no frame from the first to the last; give -s a frame before -e")
    for stem, ending in (os.path.splitext(path) for _, path in todo):
        for more in job["beside"]:
            images.prepare(f"{stem}{more}{ending}")
    mute(scene, "encre.edge_color")
    tools.load("compare", "techniques").render(job, scene, todo, report)


def save_mesh(job, error):
    """Stores the triangles of an object, as the current frame evaluates it."""
    from encre.blender import meshes
    from encre.pen.errors import unknown

    obj = bpy.data.objects.get(job["object"])
    if obj is None:
        raise error(f"{job['scene']}: " + unknown("object", job["object"], [o.name for o in bpy.data.objects]))
    mesh = meshes.unwrapped(obj, bpy.context.evaluated_depsgraph_get())
    np.savez(job["mesh"], points=mesh.points, corners=mesh.corners, uv=mesh.uv)


def main():
    # Python puts a script's folder first; there, our modules would stand in for others of the same names.
    sys.path[:] = [path for path in sys.path if os.path.abspath(path) != HERE]
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        job = json.load(file)
    report("doing", text="starting")
    register()
    from encre.pen.errors import EncreError as error

    # Later Blenders print nothing about samples by themselves.
    bpy.app.handlers.render_stats.append(lambda text, *_: print(text, flush=True) if isinstance(text, str) else None)
    load(job["scene"], error)
    if "mesh" in job:
        save_mesh(job, error)
    elif "techniques" in job:
        compare(job, prepare(job, error), error)
    else:
        render(job, prepare(job, error), error)
    report("done")


if __name__ == "__main__":
    try:
        main()
    except BaseException as reason:  # whatever it is, the command line says it in a sentence
        traceback.print_exc()
        report("error", text=sentence(reason))
    finally:
        # Blender's own exit would save preferences, and bpy's may crash.
        sys.stdout.flush()
        os._exit(0)
