# SPDX-License-Identifier: GPL-3.0-or-later
"""Times the rendered 3D view in a window of Blender's.

    python tests/helpers/bench_live.py [--size WxH] [--triangles N]...

CPU milliseconds, of all threads together, of each part of a whole picture and of one while the view turns, a slider
moves, a brush paints on a mesh of 20,000 triangles, its vertices move, an animation plays; pictures a second of Encre's
work alone, without what Blender's window takes, and with it. Pictures are of the size that the view chooses then, which
is given as a part of the window's. Then final frames of 1920x1080 by `layer_source` ENCRE, and one by Cycles with one
sample. Needs the programs blender and xvfb-run, which draws with software OpenGL.
"""

import argparse
import json
import subprocess
import sys
import time
from math import radians
from pathlib import Path

HERE = Path(__file__).resolve().parent
SECONDS = 2  # of each kind of movement


# ---- in Blender --------------------------------------------------------------------------------------------------


def balls(triangles):
    """Balls of 5,120 triangles, the first of 20,480, in a cube."""
    import bmesh
    import studio

    def shape(subdivisions):
        mesh, ball = studio.bpy.data.meshes.new("Ball"), bmesh.new()
        bmesh.ops.create_icosphere(ball, subdivisions=subdivisions, radius=0.45)
        ball.to_mesh(mesh)
        ball.free()
        mesh.color_attributes.new("encre_thickness", "BYTE_COLOR", "CORNER")
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        return mesh

    count, large, small = max(1, (triangles - 20480) // 5120 + 1), shape(6), shape(5)
    side = max(1, round(count ** (1 / 3) + 0.5))
    for k in range(count):
        at = [(k // side ** axis) % side - side / 2 for axis in range(3)]
        ball = studio.link("Ball", small.copy() if k else large, at)
        color = [0.2 + 0.6 * ((7 * k + 3 * channel) % 10) / 10 for channel in range(3)]
        ball.data.materials.append(studio.material("Paint", color))
    studio.cube("Moving", (0, -side / 2 - 1, 0), 0.3, studio.material("Moving", (0.8, 0.3, 0.1)))
    return side


def timed(steps):
    """(what steps return, {kind of work: seconds}, seconds of Python's part)"""
    from encre.pen import library

    spent, python, results = {}, 0.0, None
    while True:
        begin = time.process_time()
        try:
            works = steps.send(results)
        except StopIteration as end:
            return end.value, spent, python + time.process_time() - begin
        python += time.process_time() - begin
        results = []
        for work in works:
            begin = time.process_time()
            results.append(library.load().run(work))
            spent[work.kind] = spent.get(work.kind, 0) + time.process_time() - begin


def best(measure, rounds=3):
    """Each figure of the best of some rounds, in ms."""
    rounds = [measure() for _ in range(rounds)]
    return {name: round(1000 * min(found[name] for found in rounds), 1) for name in rounds[0]}


def inside(triangles):
    import bpy
    import studio
    import watch
    import window
    from encre.blender import eye, fast, live, properties, screen
    from encre.pen.shown import Drawing, Wish, picture

    side = balls(triangles)
    space = window.area("VIEW_3D").spaces.active
    space.overlay.show_overlays = False
    space.region_3d.view_distance = 2 * side + 2
    space.shading.type = "RENDERED"
    upload = screen.upload
    yield from watch.rest()
    view = watch.views()[0]
    scene, ball = bpy.context.scene, bpy.data.objects["Ball"]
    painted = ball.data.color_attributes["encre_thickness"].data

    def here():
        return window.override("VIEW_3D")

    def parts():
        with here():
            depsgraph = bpy.context.evaluated_depsgraph_get()
            where, _ = eye.look(bpy.context, depsgraph)
            settings, kept, found = properties.settings(depsgraph.scene_eval), fast.Kept(), {}
            for name in ("extraction", "warm", "stroke"):
                begin = time.process_time()
                read = fast.read(depsgraph, settings, where.clip, kept)
                found[name] = time.process_time() - begin
                if name == "warm":
                    kept.meshes.drop({("Mesh", ball.data.name)})
        frame, pixels = where.frame(1)
        layers, spent, python = timed(read.steps(where.view, where.projection, frame, pixels, settings, where.clip))
        image, stages, more = timed(picture(Drawing(*layers, frame, settings, {}), Wish()))
        begin = time.process_time()
        upload(image)
        return {**found, **spent, "stages": stages["render"], "Python": python + more,
                "upload": time.process_time() - begin}

    studio.fact("parts", [triangles, best(parts)])
    turn = space.region_3d.view_rotation.copy()

    def move():
        turn.rotate(type(turn)((0, 0, 1), radians(2)))
        space.region_3d.view_rotation = turn
        space.region_3d.update()

    def slide():
        scene.encre.line_thickness = 4 + (time.perf_counter() * 10) % 8

    def paint():
        k = int(time.perf_counter() * 1000) % len(painted)
        painted[k].color = (1, 1, 1, 1)
        ball.data.update()

    def edit():
        ball.data.vertices[0].co.z += 0.01
        ball.data.update()

    moving = bpy.data.objects["Moving"]
    for frame in (1, 40):
        moving.location.z = frame / 10
        moving.keyframe_insert("location", frame=frame)

    def play():
        scene.frame_set(scene.frame_current % 40 + 1)

    for name, change in ("turn", move), ("slider", slide), ("stroke", paint), ("edit", edit), ("playback", play):
        rates = []
        for drawn in (False, True):
            scales, begin, spent = [], time.perf_counter(), time.process_time()
            while time.perf_counter() < begin + SECONDS:
                change()
                bpy.context.view_layer.update()
                with here():
                    if drawn:
                        bpy.ops.wm.redraw_timer(type="DRAW", iterations=1)
                    else:
                        view._step(bpy.context, bpy.context.evaluated_depsgraph_get())
                while view.picture and not view.picture.ended:
                    live._tick()
                    time.sleep(0.0005)
                if view.picture and not drawn:
                    view._take(view.picture)
                scales.append(view.what.scale)
            rates.append(round(len(scales) / (time.perf_counter() - begin), 1))
            if not drawn:
                rates.append(round(1000 * (time.process_time() - spent) / len(scales), 1))
            yield
        studio.fact("moves", [triangles, name, *rates, sorted(scales)[len(scales) // 2]])
        yield from watch.rest()


def begin():
    """An empty scene with a sun and Encre as its engine."""
    import bpy
    import studio

    bpy.ops.wm.read_factory_settings(use_empty=True)
    studio.register()
    bpy.context.scene.render.engine = "ENCRE"
    sun = studio.link("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler, sun.data.energy = (radians(40), radians(20), 0), 3


def view(triangles):
    import studio
    import window

    begin()
    with window.override("VIEW_3D"):
        window.bpy.ops.screen.screen_full_area(use_hide_panels=True)
    yield
    yield
    region = next(r for r in window.area("VIEW_3D").regions if r.type == "WINDOW")
    studio.fact("region", [region.width, region.height])
    yield from inside(triangles)


def final(triangles):
    """CPU seconds of final frames."""
    import bpy
    import studio

    begin()
    side, scene = balls(triangles), bpy.context.scene
    scene.camera = studio.link("Camera", bpy.data.cameras.new("Camera"), (0, -2.2 * side - 2, 0))
    scene.camera.rotation_euler = radians(90), 0, 0
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 1920, 1080, 1
    scene.cycles.use_denoising = False

    def seconds():
        spent = time.process_time()
        bpy.ops.render.render()
        return round(time.process_time() - spent, 2)

    scene.encre.layer_source = "ENCRE"
    ours = [seconds(), seconds()]
    scene.render.engine = "CYCLES"
    studio.fact("final", [triangles, *ours, seconds()])
    studio.fact("finished", True)


# ---- outside -----------------------------------------------------------------------------------------------------


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--triangles", type=int, action="append")
    options = parser.parse_args()
    width, height = options.size.split("x")
    for triangles in options.triangles or (20_000, 200_000, 1_000_000):
        command = ["xvfb-run", "-a", "-s", f"-screen 0 {options.size}x24", "blender", "--factory-startup", "-p", "0",
                   "0", width, height, "-P", __file__, "--", "bench", str(triangles)]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=900)
        background = ["blender", "-b", "--factory-startup", "-P", __file__, "--", "final", str(triangles)]
        frame = subprocess.run(background, capture_output=True, text=True, errors="replace", timeout=900)
        done.stdout += frame.stdout
        facts = [json.loads(line[5:]) for line in done.stdout.splitlines() if line.startswith("FACT ")]
        if [name for name, _ in facts].count("finished") < 2:
            sys.exit(done.stdout[-2000:] + done.stderr[-2000:] + frame.stderr[-2000:])
        for name, value in facts:
            if name == "region":
                print(f"{triangles} triangles, {value[0]}x{value[1]}")
            elif name == "parts":
                print("  CPU ms: " + ", ".join(f"{part} {ms:g}" for part, ms in value[1].items()))
            elif name == "moves":
                print(f"  {value[1]}: {value[2]:g} pictures a second of {value[3]:g} CPU ms, {value[4]:g} with the "
                      f"window's own work, at {value[5]:.0%} of its size")
            elif name == "final":
                cold, warm, cycles = value[1:]
                print(f"  final frame of 1920x1080: {cold:g} CPU s, then {warm:g}; Cycles {cycles:g}")


if __name__ == "__main__":
    if sys.argv[-2:-1] in (["bench"], ["final"]):
        sys.path.insert(0, str(HERE.parent / "blender" / "inside"))
        if sys.argv[-2] == "final":
            final(int(sys.argv[-1]))
        else:
            import window

            window.start(view(int(sys.argv[-1])), persistent=True)
    else:
        main()
