# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of Grease Pencil and of annotations -> curves on the surfaces that they were drawn on, which are inked as
lines by hand (docs/marks.md)."""

import bpy
from mathutils import Vector, bvhtree

from . import versions

NAME = "Line Marks"
_STEPS = 6       # how often a piece of a stroke is halved at most, so that it follows its surface
_FINE = 1 / 4000  # of the size of a surface: how far a line may lie below it, and is lifted above it


class Surface:
    """An evaluated mesh that strokes may lie on. Points are its own."""

    def __init__(self, obj, depsgraph):
        self.obj, self.matrix = obj, obj.matrix_world.copy()
        self.inverse = self.matrix.inverted_safe()
        self.tree = bvhtree.BVHTree.FromObject(obj, depsgraph)
        self.lift = max((Vector(corner) for corner in obj.bound_box), key=lambda v: v.length).length * _FINE

    def nearest(self, point):
        """(distance in the world, point, normal) of what is nearest to a point of the world."""
        at, normal, _, _ = self.tree.find_nearest(self.inverse @ point)
        return ((self.matrix @ at - point).length, at, normal) if at else None

    def behind(self, eye, point):
        """The same of what is seen from an eye at a point of the world: its distance is from the eye."""
        start = self.inverse @ eye
        at, normal, _, _ = self.tree.ray_cast(start, self.inverse @ point - start)
        return ((self.matrix @ at - eye).length, at, normal) if at else None

    def along(self, points):
        """Points on the surface, with so many more between them that what joins them does not dive below it."""
        out = points[:1]
        for end in points[1:]:
            self._fill(out, out[-1], end, _STEPS)
        return [at + normal * self.lift for at, normal in out]

    def _fill(self, out, start, end, steps):
        middle = (start[0] + end[0]) / 2
        at, normal, _, away = self.tree.find_nearest(middle)
        if steps and at and away > self.lift / 2:
            self._fill(out, start, (at, normal), steps - 1)
            self._fill(out, (at, normal), end, steps - 1)
        else:
            out.append(end)


def surfaces(context):
    """The visible meshes."""
    depsgraph = context.evaluated_depsgraph_get()
    return [Surface(obj, depsgraph) for obj in context.visible_objects
            if obj.type == "MESH" and obj.evaluated_get(depsgraph).data.polygons]


def of_object(obj, frame):
    """The strokes of a Grease Pencil object: points of the world, each stroke a list."""
    found = []
    for layer in obj.data.layers:
        if not layer.hide:
            matrix = obj.matrix_world @ versions.layer_matrix(layer)
            found += [[matrix @ point for point in stroke] for stroke in versions.strokes(layer, frame)]
    return found


def annotated(scene):
    """The layers of annotations that are seen."""
    block = versions.annotation(scene)
    return [layer for layer in block.layers if not layer.annotation_hide] if block else []


def of_annotations(scene, frame):
    return [stroke for layer in annotated(scene) for stroke in versions.strokes(layer, frame)]


def project(strokes, bodies, reach, eye):
    """{surface: [points of a line on it]} of strokes: each point on the nearest surface within reach, or else on what
    is seen behind it; eye(point): from where a point is seen, None: from nowhere. A stroke over several surfaces
    becomes a line on each."""
    found = {}
    for stroke in strokes:
        lines = []
        for point in stroke:
            body, place = _under(point, bodies, reach, eye)
            if body is None:
                lines.append((None, []))
            elif not lines or lines[-1][0] is not body:
                lines.append((body, [place]))
            else:
                lines[-1][1].append(place)
        for body, places in lines:
            if len(places) > 1:
                found.setdefault(body, []).append(body.along(places))
    return found


def _under(point, bodies, reach, eye):
    near = [(*hit, body) for body in bodies if (hit := body.nearest(point)) and hit[0] <= reach]
    if not near and eye:
        near = [(*hit, body) for body in bodies if (hit := body.behind(eye(point), point))]
    if not near:
        return None, None
    _, at, normal, body = min(near, key=lambda hit: hit[0])
    return body, (at, normal)


def write(body, lines, collection):
    """Adds lines to the curve of a surface's marks, made where it has none, which moves with it."""
    marks = next((child for child in body.obj.children if child.type == "CURVE" and child.encre.mark), None)
    if marks is None:
        curve = bpy.data.curves.new(NAME, "CURVE")
        curve.dimensions = "3D"
        marks = bpy.data.objects.new(NAME, curve)
        marks.parent, marks.encre.mark = body.obj, True
        collection.objects.link(marks)
    for line in lines:
        spline = marks.data.splines.new("POLY")
        spline.points.add(len(line) - 1)
        spline.points.foreach_set("co", [x for at in line for x in (*at, 1)])
    return marks
