# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `view_window.py -- view FOLDER` works in the rendered 3D view as a user does.

Needs --enable-event-simulate. Pictures are what Encre uploads, scene-linear; they are saved as FOLDER/NAME.npy.
"""

import os
import resource
import sys
import time
from math import radians
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402
import window  # noqa: E402
from watch import picture, reads, rest, space, spy, uploaded, uploads, views  # noqa: E402

REDRAWS = int(os.environ.get("ENCRE_REDRAWS", 1000))
BRUSH = 12  # pixels


def build():
    """A cube of many faces, a ball and a ground; the view from the camera."""
    scene = studio.stage(320, 180)
    cube = bpy.data.objects["Cube"]
    cube.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    cube.modifiers["Subdivision"].levels = 5
    cube.scale = 1.6, 1.6, 1.6
    cube.rotation_euler.z = radians(20)
    bpy.context.view_layer.objects.active = cube
    cube.select_set(True)
    with window.override("VIEW_3D"):
        bpy.ops.object.modifier_apply(modifier="Subdivision")
    scene.view_settings.view_transform = "Standard"
    scene.encre.layer_source = "ENCRE"
    space().overlay.show_overlays = False
    spy()
    space().shading.type = "RENDERED"
    yield from rest()


def on_screen():
    """The rows and columns of a screenshot in which the picture is, from the top left."""
    region = next(r for r in window.area("VIEW_3D").regions if r.type == "WINDOW")
    left, bottom, right, top = views()[0].look.place
    columns = [region.x + (x + 1) / 2 * region.width for x in (left, right)]
    rows = [window.window().height - region.y - (y + 1) / 2 * region.height for y in (top, bottom)]
    return [round(at) for at in rows + columns]


def camera():
    """The camera's view, and what F12 makes of the same frame."""
    region = space().region_3d
    region.view_perspective = "CAMERA"
    region.view_camera_zoom = 20
    yield from rest()
    picture("camera")
    window.screenshot("camera")
    studio.fact("frame on screen", on_screen())
    space().overlay.show_overlays = True
    yield from rest()
    window.screenshot("overlays")
    space().overlay.show_overlays = False
    bpy.context.scene.view_settings.exposure = -1.0
    yield from rest()
    window.screenshot("exposure")
    bpy.context.scene.view_settings.exposure = 0.0
    height, width, _ = uploaded[-1][1].shape
    scene = bpy.context.scene
    before = scene.render.resolution_x, scene.render.resolution_y
    scene.encre.save_layers = "OFF"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    studio.fact("f12", studio.shoot(window.FOLDER, "f12"))
    scene.render.resolution_x, scene.render.resolution_y = before
    yield from rest()
    scene.encre.viewport_scale = 50
    yield from rest()
    picture("half")
    scene.encre.viewport_scale = 100
    yield from rest()
    studio.fact("back", bool((uploaded[-1][1] == np.load(os.path.join(window.FOLDER, "camera.npy"))).all()))


def border():
    render = bpy.context.scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1
    yield from rest()
    picture("border")
    render.use_border = False
    yield from rest()


def orbit():
    """The view turns for a while: pictures come, and nothing is read; and again, where pictures take too long."""
    from encre.blender import live

    region = space().region_3d
    region.view_perspective, region.view_distance = "PERSP", 6
    yield from rest()
    known, begin = reads(), time.perf_counter()

    def turns(enough):
        """For a while, and on a busy machine until there are enough pictures."""
        for k in range(600):
            if k >= 12 and enough():
                return
            turn = region.view_rotation.copy()
            turn.rotate(type(turn)((0, 0, 1), radians(6)))
            region.view_rotation = turn
            yield

    yield from turns(lambda: sum(at > begin for at, _ in uploaded) > 2)
    studio.fact("orbit", [sum(at > begin for at, _ in uploaded), reads() == known])
    yield from rest()
    budget, live._BUDGET, begin = live._BUDGET, 1e-5, time.perf_counter()  # as where a picture takes too long
    yield from turns(lambda: uploaded[-1][0] > begin)
    heights = {picture.shape[0] for at, picture in uploaded if at > begin}
    yield from rest()
    studio.fact("smaller", [sorted(heights), uploaded[-1][1].shape[0]])
    live._BUDGET = budget
    region.view_perspective = "ORTHO"
    yield from rest()
    picture("ortho")
    studio.fact("ortho read", reads() == known)


def slider():
    """A setting, by a script and with a key: the ink follows, nothing is read anew."""
    scene, known = bpy.context.scene, reads()
    space().region_3d.view_perspective = "CAMERA"
    yield from rest()
    known = reads()
    picture("thick")
    scene.encre.line_thickness = 20
    yield from rest()
    picture("thin")
    studio.fact("slider read", reads() == known)
    style = scene.encre.styles.add()
    style.name, style.line_thickness = "Quiet", 0
    bpy.data.objects["Ball"].encre.style = style.name
    yield from rest()
    picture("style")
    bpy.data.objects["Ball"].encre.style = ""
    scene.encre.styles.clear()
    scene.encre.line_thickness = 60
    yield from rest()


def stroke():
    """Vertex Paint: ink changes while the brush is down."""
    from encre.blender import meshes

    with window.override("VIEW_3D"):
        bpy.ops.encre.paint(control="thickness")
        bpy.ops.encre.brush(kind="ADD", strength=1.0)
        space().region_3d.view_perspective = "CAMERA"
    bpy.context.scene.tool_settings.unified_paint_settings.size = BRUSH
    yield from rest()
    picture("unpainted")
    region = next(r for r in window.area("VIEW_3D").regions if r.type == "WINDOW")
    cube = bpy.data.objects["Cube"]
    spots = [location_3d_to_region_2d(region, space().region_3d, cube.matrix_world @ vertex.co)
             for vertex in cube.data.vertices]
    x, y = int(min(at.x for at in spots)) - 10, int(sum(at.y for at in spots) / len(spots))
    left, bottom, right, top = views()[0].look.place
    height, width, _ = uploaded[-1][1].shape
    # In pixels of the picture, y from the top: where the brush's way begins and ends, and the brush's radius.
    at = [x + dx - (left + 1) / 2 * region.width for dx in (0, 40)]
    studio.fact("stroke", [*at, height - (y - (bottom + 1) / 2 * region.height), BRUSH])
    begin, move = time.perf_counter(), window.window().event_simulate
    read, real = set(), meshes.read_triangles
    meshes.read_triangles = lambda obj, *args: read.add(obj.name) or real(obj, *args)
    move(type="MOUSEMOVE", value="NOTHING", x=region.x + x, y=region.y + y)
    yield
    move(type="LEFTMOUSE", value="PRESS", x=region.x + x, y=region.y + y)
    for dx in range(0, 41, 4):
        yield
        move(type="MOUSEMOVE", value="NOTHING", x=region.x + x + dx, y=region.y + y)
    for _ in range(10):
        yield
    studio.fact("while painting", sum(at > begin for at, _ in uploaded))
    move(type="LEFTMOUSE", value="RELEASE", x=region.x + x + 40, y=region.y + y)
    yield from rest()
    studio.fact("read for a stroke", sorted(read))
    meshes.read_triangles = real
    picture("painted")
    window.screenshot("painted")
    with window.override("VIEW_3D"):
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from rest()


def shows():
    """Each other thing that a view may show."""
    shading = space().shading.encre
    for show in ("INK", "EDGES", "LEVELS", "STYLES", "CONTROL"):
        shading.show = show
        yield from rest()
        picture(show.lower())
        if show == "EDGES":
            window.screenshot("edges")
    shading.show = "FINAL"
    yield from rest()


def undo():
    """What is undone is seen so."""
    with window.override("VIEW_3D"):
        bpy.ops.ed.undo_push(message="Before")
        bpy.data.objects["Ball"].location.z += 0.5
        bpy.ops.ed.undo_push(message="Moved")
    yield from rest()
    picture("moved")
    with window.override("VIEW_3D"):
        bpy.ops.ed.undo()
    yield from rest()
    picture("undone")


def broken():
    """What can't be used is said, and the view mends itself."""
    scene = bpy.context.scene
    scene.encre.paper_source = "IMAGE"
    yield from rest()
    studio.fact("sentence", views()[0].failure)
    window.screenshot("broken")
    scene.encre.paper_source = "COLD_PRESS"
    yield from rest()
    studio.fact("mended", views()[0].failure)


def play():
    """24 frames of a moving cube."""
    cube, scene = bpy.data.objects["Cube"], bpy.context.scene
    cube.keyframe_insert("location", frame=1)
    cube.location.x += 1
    cube.keyframe_insert("location", frame=24)
    scene.frame_end = 24
    scene.frame_set(1)
    yield from rest()
    picture("first")
    begin, frames = time.perf_counter(), []
    bpy.app.handlers.frame_change_post.append(lambda *_: frames.append(scene.frame_current))
    with window.override("VIEW_3D"):
        bpy.ops.screen.animation_play()
    while len(frames) < 24:
        yield
    studio.fact("played", sum(at > begin for at, _ in uploaded))
    with window.override("VIEW_3D"):
        bpy.ops.screen.animation_cancel(restore_frame=False)
    scene.frame_set(24)
    yield from rest()
    picture("last")


def flat():
    """Small pictures from all sides hold no more and more memory."""
    from encre.blender import live

    region, scene = space().region_3d, bpy.context.scene
    scene.encre.viewport_scale = 10
    region.view_perspective = "PERSP"
    yield from rest()
    view, held, turn, before = views()[0], [], region.view_rotation.copy(), uploads[0]
    for k in range(REDRAWS):
        turn.rotate(type(turn)((0, 0, 1), radians(1)))
        region.view_rotation = turn
        region.update()
        with window.override("VIEW_3D"):
            view._step(bpy.context, bpy.context.evaluated_depsgraph_get())
            while view.picture and not view.picture.ended:
                live._tick()
                time.sleep(0.0005)
            view._step(bpy.context, bpy.context.evaluated_depsgraph_get())
        if k in (REDRAWS // 10, REDRAWS - 1):
            held.append(int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize())
        if k % 50 == 49:
            yield
    studio.fact("memory", [uploads[0] - before, *held])
    scene.encre.viewport_scale = 100
    yield from rest()


def hidden():
    """What is hidden, and what lies behind the picture."""
    scene, ball = bpy.context.scene, bpy.data.objects["Ball"]
    space().region_3d.view_perspective = "CAMERA"
    yield from rest()
    picture("all")
    ball.hide_set(True)
    yield from rest()
    picture("without ball")
    ball.hide_set(False)
    scene.render.film_transparent = True
    yield from rest()
    picture("transparent")
    scene.render.film_transparent = False


def resized():
    """A window that is made smaller, and as large as it was."""
    width, height = window.window().width, window.window().height
    space().region_3d.view_perspective = "PERSP"
    yield from rest()
    picture("large window")
    for name, size in ("small window", (width - 200, height - 120)), ("large again", (width, height)):
        window.resize(*size)
        while (window.window().width, window.window().height) != size:
            yield
        yield from rest()
        picture(name)
        region = next(one for one in window.area("VIEW_3D").regions if one.type == "WINDOW")
        studio.fact(name, [region.width, region.height])


def edited():
    """A mesh whose half is moved in Edit Mode, which is then left."""
    cube = bpy.data.objects["Cube"]
    bpy.context.view_layer.objects.active = cube
    picture("not edited")
    with window.override("VIEW_3D"):
        bpy.ops.object.mode_set(mode="EDIT")
    yield from rest()
    picture("edit mode")
    with window.override("VIEW_3D"):
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.translate(value=(0, 0, 0.4))
    yield from rest()
    picture("edited")
    with window.override("VIEW_3D"):
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from rest()
    picture("edit mode left")
    space().region_3d.view_perspective = "CAMERA"
    yield from rest()


def several():
    """Two views, of different size, of which one is made smaller."""
    with window.override("VIEW_3D"):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.6)
    yield
    areas = [area for area in window.window().screen.areas if area.type == "VIEW_3D"]
    for area in areas:
        area.spaces.active.shading.type = "RENDERED"
    areas[1].spaces.active.region_3d.view_perspective = "PERSP"
    yield from rest(2)
    seen = {view.what.where.through_camera: view.what.where for view in views()}
    studio.fact("views", [seen[True].full, [seen[False].part.width, seen[False].part.height],
                          [[region.width, region.height] for area in areas for region in area.regions
                           if region.type == "WINDOW"]])
    areas[1].type = "CONSOLE"
    yield from rest()
    studio.fact("views left", len(views()))


def pinned():
    """A pattern that is pinned to a mesh at rest, which is then bent; and let go."""
    scene, ball = bpy.context.scene, bpy.data.objects["Ball"]
    scene.encre.pen_1_wobble, scene.encre.pen_1_gaps = 0.6, 0.5
    bpy.ops.object.select_all(action="DESELECT")
    ball.select_set(True)
    bpy.context.view_layer.objects.active = ball
    yield from rest()
    picture("unpinned")
    with window.override("VIEW_3D"):
        studio.fact("pin", list(bpy.ops.encre.pin_pattern()))
    yield from rest()
    picture("pinned")
    for vertex in ball.data.vertices:
        vertex.co.z += 0.8 * vertex.co.x ** 2
    ball.data.update()
    yield from rest()
    picture("bent")
    with window.override("VIEW_3D"):
        bpy.ops.encre.pin_pattern(clear=True)
    yield from rest()
    picture("let go")
    studio.fact("pinned", [view.failure for view in views()])
    scene.encre.pen_1_wobble = scene.encre.pen_1_gaps = 0.0
    yield from rest()


class Write(bpy.types.Operator):
    """Where a view was drawn as a render ended, Blender lets no script write, but operators."""

    bl_idname, bl_label, todo = "encre_test.write", "Write", []

    def execute(self, _context):
        for change in Write.todo:
            setattr(*change)
        return {"FINISHED"}


def write(*changes):
    Write.todo = changes
    bpy.ops.encre_test.write()


def together():
    """Two windows and a final render at once: each as it is alone. (A render that begins ends previews.)"""
    scene = bpy.context.scene
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "PNG", "8"
    scene.render.resolution_percentage, thickness = 300, scene.encre.line_thickness
    bpy.context.preferences.view.render_display_type = "NONE"
    bpy.utils.register_class(Write)
    for name in ("alone", "together"):
        if name == "together":
            with window.override("VIEW_3D"):
                bpy.ops.wm.window_new()
            yield
            other = next(a for a in bpy.context.window_manager.windows[1].screen.areas if a.type == "VIEW_3D")
            write((other.spaces.active.shading, "type", "RENDERED"),
                  (other.spaces.active.overlay, "show_overlays", False),
                  (other.spaces.active.region_3d, "view_perspective", "CAMERA"))
        turn = space().region_3d.view_rotation.copy()
        turn.rotate(type(turn)((0, 0, 1), 0.3))
        write((scene.encre, "line_thickness", thickness + 1), (space().region_3d, "view_rotation", turn))
        with bpy.context.temp_override(window=window.window()):
            bpy.ops.render.render("INVOKE_DEFAULT")
        beside, before = 0, uploads[0]
        while bpy.app.is_job_running("RENDER"):
            beside += any(view.picture for view in views())
            yield
        beside += uploads[0] - before  # on a machine of many cores a picture may be done between two looks
        write((scene.encre, "line_thickness", thickness))
        yield from rest(2 if name == "together" else 1)
        bpy.data.images["Render Result"].save_render(os.path.join(window.FOLDER, f"{name}.png"))
    studio.fact("together", [len(views()), [view.failure for view in views()], beside])


def cycles():
    """Cycles' own view, and back."""
    space().shading.encre.source = "CYCLES"
    for _ in range(20):
        yield
    studio.fact("with Cycles", [len(views())])
    window.screenshot("cycles")
    space().shading.encre.source = "ENCRE"
    yield from rest()
    studio.fact("without Cycles", len(views()))


def steps():
    for step in (build, camera, border, orbit, slider, stroke, shows, undo, broken, play, flat, hidden, resized,
                 edited, pinned, several, cycles, together):
        begin = time.perf_counter()
        yield from step()
        studio.fact("time", [step.__name__, round(time.perf_counter() - begin, 1)])


if __name__ == "__main__":
    window.start(steps(), persistent=True)
