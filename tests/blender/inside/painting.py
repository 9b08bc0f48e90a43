# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls that are painted, filled and made by nodes."""

from math import radians

import bpy
import numpy as np
from mathutils import Matrix, Vector
from studio import cube, fact, shoot, stage


def _values(obj, name="thickness"):
    """The distinct bytes of a painted control, None where there is none."""
    found = obj.data.color_attributes.get(f"encre_{name}")
    return found and sorted({round(item.color_srgb[0] * 255) for item in found.data})


def _select(*objects):
    bpy.context.view_layer.update()  # in 5.2 it has no objects before
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]


def _refused(operator, **options):
    """The sentence with which an operator ends."""
    try:
        return str(operator(**options))
    except RuntimeError as error:
        return str(error)


def painting(_out):
    """Paint, fill and reset, of one mesh and of several."""
    from encre.blender import painting as ours
    from encre.blender.panels import paint

    stage()
    one, other = bpy.data.objects["Cube"], cube("Other", (0, 2, 0))
    _select(one, other)
    bpy.ops.encre.paint(control="thickness")
    fact("made", [_values(one), _values(other), one.mode, one.data.color_attributes.active_color.name,
                  paint.painted(bpy.context).name])
    fact("first brush", [ours.brush_kind(), ours.strength_owner().strength])
    for kind in ours.BRUSHES:
        bpy.ops.encre.brush(kind=kind, strength=0.25)
        fact("brush", [kind, ours.brush_kind(), ours.strength_owner().strength])
    ours.strength_owner().strength = 0.75
    bpy.ops.encre.brush(kind="ADD")
    fact("kept strength", ours.strength_owner().strength)
    bpy.context.tool_settings.vertex_paint.brush.blend = "DARKEN"
    fact("other brush", ours.brush_kind())
    bpy.ops.encre.paint(control="thickness")
    fact("left", [one.mode, paint.painted(bpy.context)])

    bpy.ops.encre.control_fill(control="thickness", value=0.5)
    fact("filled", [_values(one), _values(other)])
    bpy.ops.encre.control_fill(control="thickness", value=0)
    fact("neutral", _values(one))
    bpy.ops.encre.control_reset(control="thickness")
    fact("reset", [_values(one), _values(other)])
    fact("reset again", _refused(bpy.ops.encre.control_reset, control="thickness"))
    _some(one)
    _wrong(one)


def _some(one):
    """Only what is selected, or what a mask lets."""
    _select(one)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    fact("nothing selected", _refused(bpy.ops.encre.control_fill, control="hatching", value=-1))
    bpy.ops.mesh.select_mode(type="FACE")
    bpy.ops.object.mode_set(mode="OBJECT")
    fact("not made", _values(one, "hatching"))
    one.data.polygons[2].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.encre.control_fill(control="hatching", value=-1)
    fact("edit", one.mode)
    bpy.ops.object.mode_set(mode="OBJECT")
    fact("some", [k for k, item in enumerate(one.data.color_attributes["encre_hatching"].data)
                  if item.color_srgb[0] < 0.1])
    bpy.ops.encre.paint(control="hatching")
    one.data.use_paint_mask = True
    for k, polygon in enumerate(one.data.polygons):
        polygon.select = k == 4
    bpy.ops.encre.control_fill(control="hatching", value=1)
    one.data.use_paint_mask, one.data.use_paint_mask_vertex = False, True
    for k, vertex in enumerate(one.data.vertices):
        vertex.select = k == 0
    bpy.ops.encre.control_fill(control="color_edge", value=1)
    one.data.use_paint_mask_vertex = False
    white = {name: [k for k, item in enumerate(one.data.color_attributes[f"encre_{name}"].data)
                    if item.color_srgb[0] > 0.9] for name in ("hatching", "color_edge")}
    vertex = [loop.vertex_index for loop in one.data.loops]
    fact("masked", [white["hatching"], sorted({vertex[k] for k in white["color_edge"]}), len(white["color_edge"])])
    bpy.ops.encre.control_reset(control="hatching")
    fact("reset while painting", [_values(one, "hatching"), one.mode])
    bpy.ops.object.mode_set(mode="OBJECT")
    points = one.data.color_attributes.new("encre_intensity", "FLOAT_COLOR", "POINT")
    bpy.ops.encre.control_fill(control="intensity", value=1)
    fact("points", float(np.array([item.color for item in points.data]).min()))


def _wrong(one):
    one.data.attributes.new("encre_smudge_range", "FLOAT", "POINT")
    fact("numbers", _refused(bpy.ops.encre.paint, control="smudge_range"))
    fact("after", one.mode)
    _select(_bare())
    fact("bare", _refused(bpy.ops.encre.paint, control="thickness"))
    _select(one, bpy.context.object)
    fact("beside bare", [_refused(bpy.ops.encre.paint, control="light"), _values(one, "light")])


def _bare():
    obj = bpy.data.objects.new("Bare", bpy.data.meshes.new("Bare"))
    bpy.context.scene.collection.objects.link(obj)
    return obj


# Geometry Nodes

def _made(obj, name="thickness"):
    """The control's values at the corners of the evaluated mesh."""
    from encre.pen import colour

    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    found = evaluated.to_mesh().attributes[f"encre_{name}"]
    values = np.empty((len(found.data), 4), np.float32)
    found.data.foreach_get("color", values.ravel())
    evaluated.to_mesh_clear()
    return colour.control_values(values)


def control_nodes(out):
    """Controls by nodes: what each way gives, one above another, and the picture of the same values by hand."""
    from encre.blender import control_nodes as ours

    scene = stage()
    ball, target = bpy.data.objects["Ball"], bpy.data.objects["Cube"]
    _select(ball)
    bpy.ops.encre.control_fill(control="thickness", value=-0.5)
    bpy.ops.encre.control_nodes(control="thickness", by="VALUE", amount=0.25)
    bpy.ops.encre.control_nodes(control="thickness", by="VALUE", amount=0.5)
    fact("stack", [float(_made(ball).min()), float(_made(ball).max()), len(bpy.data.node_groups)])
    bpy.ops.encre.control_reset(control="thickness")
    fact("without paint", float(_made(ball).mean()))
    ball.modifiers.clear()
    _select(ball, target)
    before, target.location = target.location.copy(), ball.location + Vector((0.25, 0, 0.1))
    ball.scale = (0.5, 0.5, 0.5)
    bpy.context.view_layer.update()
    bpy.ops.encre.control_nodes(control="thickness", by="NEARNESS", amount=0.8)
    mesh, place = ball.data, ball.matrix_world.inverted() @ target.location
    reach = max(ball.dimensions)  # on twice as large a mesh half of it
    away = np.array([(mesh.vertices[loop.vertex_index].co - place).length for loop in mesh.loops])
    made = _made(ball)
    fact("near", [float(made.max()), float(np.abs(made - 0.8 * np.clip(1 - away / reach, 0, 1)).max())])
    ball.modifiers.clear()
    ball.scale, target.location = (1, 1, 1), before
    _select(ball)
    bpy.ops.encre.control_nodes(control="thickness", by="NEARNESS")
    fact("new empty", bpy.data.objects[ours.NAME].type)
    ball.modifiers.clear()
    bpy.ops.encre.control_nodes(control="thickness", by="EDGE_ON", amount=-1)
    towards = [(scene.camera.location - ball.location - vertex.co).normalized().dot(vertex.co.normalized())
               for vertex in mesh.vertices]
    wanted = np.array([abs(towards[loop.vertex_index]) - 1 for loop in mesh.loops])
    fact("edge-on", float(np.abs(_made(ball) - wanted).mean()))
    bpy.ops.encre.control_nodes(control="thickness", by="NOISE")
    bpy.ops.encre.control_nodes(control="hatching", by="NOISE", amount=0.5)
    values = {name: _made(ball, name) for name in ("thickness", "hatching")}
    fact("spread", [float(v) for v in np.percentile(values["hatching"], (5, 50, 95))])
    shoot(out, "nodes")
    ball.modifiers.clear()
    for name, given in values.items():
        ball.data.attributes.new(f"encre_{name}", "FLOAT", "CORNER").data.foreach_set("value", given)
    shoot(out, "hand")
    ball.data.attributes.remove(ball.data.attributes["encre_thickness"])
    shoot(out, "neither")
    scene.camera = None
    fact("no camera", _refused(bpy.ops.encre.control_nodes, control="thickness", by="EDGE_ON"))


# Strokes

def _pencil(name, stroke, turned):
    """A Grease Pencil object with a stroke, in this Blender's kind."""
    old = not hasattr(bpy.types, "GreasePencilLayer") or not hasattr(bpy.types, "GreasePencilDrawing")
    blocks = bpy.data.grease_pencils if old else getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)
    data = blocks.new(name)
    frame = data.layers.new("Lines").frames.new(1)
    pencil = bpy.data.objects.new(name, data)
    pencil.matrix_world = turned
    bpy.context.scene.collection.objects.link(pencil)
    points = [turned.inverted() @ point for point in stroke]
    if old:
        made = frame.strokes.new()
        made.points.add(len(points))
    else:
        frame.drawing.add_strokes([len(points)])
        made = frame.drawing.strokes[0]
    for place, point in zip(made.points, points, strict=True):
        setattr(place, "co" if old else "position", point)
    return pencil


def strokes(out):
    """A stroke on the front of the ball, drawn by Grease Pencil on a turned object, becomes a line by hand."""
    scene = stage(320, 180)
    scene.encre.line_mark_strength = 1
    ball = bpy.data.objects["Ball"]
    ball.rotation_euler, ball.scale = (0.3, 0.2, 0.5), (1.1, 1.1, 1.1)
    bpy.context.view_layer.update()
    shoot(out, "bare")
    front = Vector((0, -1, 0.15)).normalized() * 0.79  # a little off the surface
    stroke = [ball.location + Matrix.Rotation(radians(angle), 3, "Z") @ front for angle in range(-40, 41, 20)]
    pencil = _pencil("Pencil", stroke, Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.4, 4, "X"))
    _select(pencil)
    bpy.context.view_layer.update()
    bpy.ops.encre.strokes_to_marks()
    marks = next(child for child in ball.children if child.encre.mark)
    fact("marks", [marks.type, len(marks.data.splines), len(marks.data.splines[0].points), pencil.hide_render])
    bpy.context.view_layer.update()
    found, at, _, _ = ball.closest_point_on_mesh(Vector(marks.data.splines[0].points[1].co[:3]))
    fact("lift", [found, (at - Vector(marks.data.splines[0].points[1].co[:3])).length])
    fact("again", _refused(bpy.ops.encre.strokes_to_marks))
    shoot(out, "marked")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "marked_quick")
    scene.encre.layer_source = "CYCLES"
    ball.rotation_euler.z += radians(180)
    shoot(out, "behind")
    _annotated(scene)


def _annotated(scene):
    """A stroke in the air before the cube lands on it as the camera sees it."""
    blocks = bpy.data.annotations if hasattr(bpy.data, "annotations") else bpy.data.grease_pencils
    data = blocks.new("Notes")
    frame = data.layers.new("Note").frames.new(1)
    if not hasattr(frame.strokes, "new"):
        return
    stroke = frame.strokes.new()
    stroke.display_mode = "3DSPACE"
    stroke.points.add(2)
    for point, x in zip(stroke.points, (-0.85, -0.65), strict=True):
        point.co = x, -2, 0.5
    if hasattr(scene, "annotation"):
        scene.annotation = data
    else:
        scene.grease_pencil = data
    _select(bpy.data.objects["Cube"])
    bpy.ops.encre.strokes_to_marks()
    marks = bpy.data.objects["Cube"].children[0]
    fact("note", [[round(c, 3) for c in point.co[:3]] for point in marks.data.splines[0].points])
    fact("cleared", sum(len(layer.frames) for layer in data.layers))
