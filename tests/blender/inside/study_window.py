# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene for `encre study` that answers by itself: a small room with stripes, and a timer that presses keys, moves the
mouse and clicks as a person does, through all phases. ENCRE_SHOTS names a folder for a picture of each.

    ENCRE_SHOTS=/tmp xvfb-run encre study study_window.py -o /tmp/answers --size 640x480 --verbose
"""

import gc
import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(HERE)
import keys  # noqa: E402
import screens  # noqa: E402
import studio  # noqa: E402

LOW, HIGH = (-2.0, -3.0, 0.0), (2.0, 2.0, 2.5)  # of the room, which is open towards the viewer


def wall(name, corners, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 2, 0, 2, 2, 0, 2])
    studio.link(name, mesh, mat=material)


def room():
    scene = bpy.context.scene
    material = studio.material("Stripes", (0.8, 0.8, 0.8))
    texels = np.ones((128, 128, 4), np.float32)
    texels[:, 32:64, :3], texels[:, 64:, :3] = (0.7, 0.1, 0.1), (0.1, 0.2, 0.5)
    image = bpy.data.images.new("Stripes", 128, 128)
    image.pixels.foreach_set(texels.ravel())
    image.pack()  # or Blender forgets it while nothing of its own shows it
    look = material.node_tree.nodes.new("ShaderNodeTexImage")
    look.image = image
    material.node_tree.links.new(look.outputs[0], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    (x, y, z), (right, back, top) = LOW, HIGH
    wall("Floor", [(x, y, z), (right, y, z), (right, back, z), (x, back, z)], material)
    wall("Back", [(x, back, z), (right, back, z), (right, back, top), (x, back, top)], material)
    wall("Left", [(x, y, z), (x, back, z), (x, back, top), (x, y, top)], material)
    wall("Right", [(right, back, z), (right, y, z), (right, y, top), (right, back, top)], material)
    wall("Ceiling", [(x, back, top), (right, back, top), (right, y, top), (x, y, top)], material)
    camera = studio.link("Camera", bpy.data.cameras.new("Camera"), (0, -2.5, 1.2))
    camera.rotation_euler.x = np.pi / 2
    camera.data.lens = 22
    camera.keyframe_insert("location", frame=1)
    camera.location = 0.6, -1.0, 1.0
    camera.keyframe_insert("location", frame=25)
    scene.camera, scene.frame_end = camera, 25
    studio.world(scene, (0.8, 0.8, 0.8))
    scene.view_settings.view_transform = "Standard"
    bpy.ops.encre.preset(preset="inter_color")
    scene.encre.line_density, scene.encre.line_thickness = 1, 16


def stage():
    from encre.blender.study import quadrants

    return quadrants.Quadrants.stage


def panel():
    from encre.blender.study.panel import Panel

    return next(thing for thing in gc.get_objects() if type(thing) is Panel)


def shot(name, words):
    """A picture of the window as soon as these words are in it, and the other quadrants are as they are to be."""
    yield from until(lambda: any(words in row.text for row in panel().shown), words)
    for _ in range(100):
        yield
        view = next((thing for thing in gc.get_objects() if type(thing).__name__ == "Quadrants" and thing.what), None)
        if stage().flies or stage().film_picture() is not None or (view and view.what.scale == view.scale):
            break
    yield from some(2)
    if os.environ.get("ENCRE_SHOTS"):
        screens.save(os.path.join(os.environ["ENCRE_SHOTS"], f"{name}.png"))


def until(true, what):
    for _ in range(30000):
        if true():
            return
        yield
    raise AssertionError(f"waited in vain for {what}; {stage() and stage().now}, {stage() and stage().session.phase}")


def some(count=4):
    for _ in range(count):
        yield


def press(kind, of):
    """Clicks on what the upper right quadrant has."""
    there = panel()
    x, y = there.spot(kind, of)
    keys.click(round(there.region.x + x), round(bpy.context.window_manager.windows[0].height - there.region.y - y))


def held(key, steps):
    keys.hold(key, True)
    yield from some(steps)
    keys.hold(key, False)
    yield


def steps():
    yield from until(lambda: stage() and stage().now == "OFFER", "the offer of a film")
    yield from shot("offer", "P: draw")
    seen = stage()._seen
    yield from some(8)
    studio.fact("rested", stage()._seen is seen)
    studio.fact("rate", stage().rate)
    keys.point(300, 200)
    keys.press("p")
    yield from until(lambda: stage().now == "SESSION", "the film")
    studio.fact("film", [stage().film.count, len(stage().film.missing()), stage().uses_film])
    yield from shot("start", "Welcome")
    session = stage().session
    keys.point(300, 200)
    keys.press("space")
    yield from until(lambda: session.phase == "FLIGHT" and stage().share > 0.3, "the first flight")
    yield from shot("flight", "Flight 1")
    yield from until(lambda: session.flight == 2, "the second flight")
    yield from until(lambda: session.phase == "EXPLORE", "the room")
    studio.fact("flights", session.flight)
    yield from held("Up", 6)
    yield from until(lambda: not stage().held, "the key")
    studio.fact("flown", stage().share)
    yield from shot("path", "Now you fly")
    yield from held("Down", 30)
    studio.fact("back", stage().share)
    keys.press("Tab")
    yield from until(lambda: stage().roams, "the free camera")
    heading = stage().free.heading
    for k in range(12):
        keys.point(200 + 9 * k, 150 + 2 * k)
        yield
    yield from until(lambda: stage().free.heading != heading, "the mouse")
    studio.fact("turned", stage().free.heading - heading)
    places = []
    for key in "wasdeqwd":
        keys.hold(key, True)
        for _ in range(8):
            yield
            places.append([*stage().free.place])
        keys.hold(key, False)
        yield
    studio.fact("moved", np.ptp(places, 0).tolist())
    studio.fact("within", [np.min(places, 0).tolist(), np.max(places, 0).tolist()])
    yield from shot("free", "Mouse:")
    for _ in range(60):
        keys.point(300, 150 + 2 * (_ % 40))
        yield
        if session.phase == "ANSWER":
            break
    studio.fact("counts", [session.presses, session.moves, session.phase])
    yield from shot("ready", "questions are ready")
    keys.press("Tab")
    yield from until(lambda: not stage().roams, "the flight again")
    yield from until(lambda: panel().spot("button", "submit"), "the questions")
    press("slider", 1.4)
    yield from until(lambda: session.thickness == 1.4, "the slider")
    press("button", "submit")
    yield from until(lambda: stage().said, "a word about what is missing")
    press("choice", ("Convention", "LEFT"))
    yield from until(lambda: "Convention" in session.answers, "an answer")
    press("choice", ("Aesthetics", "RIGHT"))
    yield from until(lambda: not session.missing, "the other answer")
    press("words", 1)
    yield from until(lambda: panel().focus == 1, "the field")
    for letter in "lines":
        keys.press(letter)
    yield from until(lambda: session.words.get(1) == "lines", "words")
    keys.press("Return")
    yield from shot("questions", "lines")
    studio.fact("sides", session.sides)
    press("button", "submit")
    yield from until(lambda: session.phase == "END", "the end")
    yield from shot("end", "Thank you")
    studio.fact("logged", session.seconds)
    keys.press("space")
    yield from until(lambda: stage().session is not session, "the next person")
    from encre.pen.session import read

    (path,) = Path(stage().options.folder).glob("*.txt")
    stage()._play(read(path))
    yield from shot("play", path.name)
    stage()._at = max(0, stage()._record.track[-1][0] - 0.5)
    yield from until(lambda: stage()._at == stage()._record.track[-1][0], "the end of the log")
    studio.fact("played", [[*stage().pose()[0]], list(stage().session.sides), stage().session.thickness])
    for _ in range(2):
        keys.press("Escape")
        yield
    yield from until(lambda: stage() is None, "the window as it was")  # and then Blender ends


def run(todo=[]):  # noqa: B006 - the generator that goes on
    todo[:] = todo or [steps()]
    try:
        next(todo[0])
    except StopIteration:
        return None
    except BaseException:
        traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(1)
    return 0.05


if __name__ == "__main__":
    room()
    from encre.blender.study import quadrants
    from encre.blender.study import stage as stages

    quadrants.FEWEST = 1e9  # no machine shows so many
    stages._REHEARSAL, stages._SOME = 0.0, 3  # and this one is over before there is any picture
    bpy.app.timers.register(run, first_interval=0.5, persistent=True)
