# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside the Blender that `encre study` starts, with a window: `windowed.py -- JOB.json`.

It talks as inside.py does, whose parts it takes; the window's own events do the rest.
"""

import importlib.util
import json
import os
import sys
import traceback

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))


def _part(name):
    """A script of the folder around this one's, by its place."""
    path = os.path.join(os.path.dirname(HERE), f"{name}.py")
    spec = importlib.util.spec_from_file_location(f"encre_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _leave(line, failure=None):
    if failure:
        line.report("error", text=failure)
    line.report("done")
    sys.stdout.flush()
    os._exit(0)  # Blender's own exit would save preferences


def begin(job, line, inside):
    """Opens the scene and gives the window to the study."""
    inside.join(inside.register(line.report))
    from pathlib import Path

    from encre.blender.study import operators, quadrants, stage
    from encre.cli import staging
    from encre.pen import session
    from encre.pen.errors import EncreError

    inside.load(job, EncreError, line.report)
    scene, wish = staging.prepare(job, line.report), job["study"]
    window = bpy.context.window_manager.windows[0]
    window.scene = scene
    bpy.context.preferences.view.show_splash = False
    looks = tuple(map(quadrants.named, wish["looks"]))
    plan = operators.plan(looks, [session.Question(*question) for question in wish["questions"]], wish["open"],
                          slider=wish["slider"], presses=wish["presses"], moves=wish["moves"])
    play = session.read(Path(wish["play"])) if wish["play"] else None

    def tell(event, **more):
        line.look()
        if event in ("done", "error"):
            _leave(line, more.get("text"))
        line.report(event, **more)

    options = stage.Options(plan, looks, wish["folder"], wish["flights"], play, os.path.basename(job["scene"]))
    operators.begin(window, stage.Stage(scene, options, tell))
    line.report("doing", text="people were asked")


def main():
    sys.path[:] = [path for path in sys.path if os.path.abspath(path) != HERE]
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        job = json.load(file)
    inside = _part("inside")
    line = inside.Line(job["line"])
    line.watched().__enter__()  # as long as this process lives

    def run():
        try:
            begin(job, line, inside)
        except BaseException as reason:
            ours = sys.modules.get("encre.pen.errors")
            if not (ours and isinstance(reason, ours.EncreError)):
                traceback.print_exc()
            _leave(line, str(reason) if ours and isinstance(reason, ours.EncreError) else inside.sentence(reason))

    line.report("doing", text="starting")
    bpy.app.timers.register(run, first_interval=0.5, persistent=True)  # when there is a window


if __name__ == "__main__":
    main()
