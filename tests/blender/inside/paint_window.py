# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `paint_window.py -- paint FOLDER` paints controls by the rows of the panel.

Needs --enable-event-simulate.
"""

import os
import sys

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402
import window  # noqa: E402


def build():
    """A cube of many faces, seen from the front, so that x goes to the right."""
    studio.stage(320, 180)
    cube = bpy.data.objects["Cube"]
    cube.location = 0, 0, 0
    cube.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    cube.modifiers["Subdivision"].levels = 4
    bpy.context.view_layer.objects.active = cube
    bpy.data.objects.remove(bpy.data.objects["Ball"])
    cube.select_set(True)
    with window.override("VIEW_3D"):
        bpy.ops.object.modifier_apply(modifier="Subdivision")
        bpy.ops.view3d.view_axis(type="FRONT")
        region = bpy.context.space_data.region_3d
        region.view_distance, region.view_perspective = 3, "ORTHO"
        region.view_location = 0, 0, 0
        bpy.ops.ed.undo_push(message="Built")


def cube():
    return bpy.data.objects["Cube"]  # undo makes all anew


def does(operator, **options):
    """An operator as a user calls it: its undo step is its own."""
    with window.override("VIEW_3D"):
        return operator("EXEC_DEFAULT", True, **options)


def values(name="thickness"):
    """(x, byte) of the corners, None where nothing is painted."""
    mesh = cube().data
    found = mesh.color_attributes.get(f"encre_{name}")
    if found is None:
        return None
    return [(mesh.vertices[loop.vertex_index].co.x, round(item.color_srgb[0] * 255))
            for loop, item in zip(mesh.loops, found.data, strict=True)]


def bytes_of(name="thickness"):
    found = values(name)
    return found and sorted({value for _, value in found})


def undo():
    with window.override("VIEW_3D"):
        bpy.ops.ed.undo()


def undoing():
    """Each operator, and one step back."""
    does(bpy.ops.encre.control_fill, control="hatching", value=1)
    filled = bytes_of("hatching")
    does(bpy.ops.encre.control_fill, control="hatching", value=-1)
    does(bpy.ops.encre.control_reset, control="hatching")
    steps = [filled, bytes_of("hatching")]
    for _ in range(3):
        undo()
        yield
        steps.append(bytes_of("hatching"))
    studio.fact("undone", steps)
    does(bpy.ops.encre.paint, control="thickness")
    painting = cube().mode, bytes_of()
    undo()
    yield
    studio.fact("paint undone", [*painting, cube().mode, bytes_of()])


def stroke(x0, x1):
    """Press, drag, release, in shares of the region's width from its middle."""
    region = next(r for r in window.area("VIEW_3D").regions if r.type == "WINDOW")
    y, move = region.y + region.height // 2, window.window().event_simulate
    xs = [int(region.x + region.width * (0.5 + x0 + (x1 - x0) * k / 4)) for k in range(5)]
    move(type="MOUSEMOVE", value="NOTHING", x=xs[0], y=y)
    yield
    move(type="LEFTMOUSE", value="PRESS", x=xs[0], y=y)
    for x in xs:
        yield
        move(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield
    move(type="LEFTMOUSE", value="RELEASE", x=xs[-1], y=y)
    yield
    yield


def sides():
    """The least and the most on the left, and on the right."""
    found = values()
    return [[least(v for x, v in found if side * x > 0) for least in (min, max)] for side in (-1, 1)]


def strokes():
    """Raised and lowered by strokes, mirrored, undone."""
    does(bpy.ops.encre.paint, control="thickness")
    bpy.context.scene.tool_settings.unified_paint_settings.size = 20
    window.area("VIEW_3D").spaces.active.show_region_ui = False
    yield
    for kind, strength, name in (("ADD", 0.25, "raised"), ("SUBTRACT", 0.5, "lowered"), ("NEUTRAL", 1, "wiped")):
        does(bpy.ops.encre.brush, kind=kind, strength=strength)
        yield from stroke(-0.1, -0.07)
        studio.fact(name, sides())
    undo()
    yield
    studio.fact("stroke undone", [sides(), cube().mode])
    cube().data.use_mirror_x = True
    does(bpy.ops.encre.brush, kind="ADD", strength=1)
    yield from stroke(0.07, 0.1)
    studio.fact("mirrored", sides())
    cube().data.use_mirror_x = False


def rows():
    """The panel, in Vertex Paint and after it."""
    from encre.blender.panels import paint

    yield from popup("rows")
    with window.override("VIEW_3D"):
        studio.fact("pressed", paint.painted(bpy.context).name)
        bpy.ops.object.mode_set(mode="OBJECT")
        studio.fact("left", paint.painted(bpy.context))
    yield from popup("rows_left")
    with window.override("VIEW_3D"):
        bpy.ops.encre.control_show(control="thickness")
        shading = bpy.context.space_data.shading
        studio.fact("heat map", [shading.type, shading.encre.show, shading.encre.control,
                                 paint.shows(bpy.context, "thickness")])
        bpy.ops.encre.control_show(control="thickness")
        studio.fact("no heat map", [shading.type, shading.encre.show])
        shading.type = "SOLID"


def popup(name):
    with window.override("VIEW_3D"):
        bpy.ops.wm.call_panel(name="ENCRE_PT_paint")
    for _ in range(4):
        yield
    window.screenshot(name)
    window.window().event_simulate(type="ESC", value="PRESS")
    yield
    window.window().event_simulate(type="ESC", value="RELEASE")
    yield


def menus():
    """The entries of Blender's menus draw."""
    does(bpy.ops.encre.paint, control="thickness")
    for name in ("VIEW3D_MT_object", "VIEW3D_MT_paint_vertex"):
        with window.override("VIEW_3D"):
            bpy.ops.wm.call_menu(name=name)
        for _ in range(3):
            yield
        window.screenshot(name)
        window.window().event_simulate(type="ESC", value="PRESS")
        yield
        window.window().event_simulate(type="ESC", value="RELEASE")
        yield


def steps():
    for step in (build, undoing, strokes, rows, menus):
        made = step()
        if made is not None:
            yield from made
        yield


if __name__ == "__main__":
    window.start(steps(), persistent=True)
