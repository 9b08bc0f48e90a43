# SPDX-License-Identifier: GPL-3.0-or-later
"""Toys on a table, whose inner lines are drawn by hand: marked edges, parts of a mesh, pieces that no face joins.

No seam here can be seen in the layers: everything is smooth and of one colour.
"""

from math import atan2, cos, hypot, pi, radians, sin

import bpy
from common import box, camera, light, mark, mesh_object, modifier, part, place, rings, settings, world
from materials import flat


def circle(radius, z, steps=24):
    return [(radius * cos(2 * pi * k / steps), radius * sin(2 * pi * k / steps), z) for k in range(steps)]


def beach_ball(material):
    """Six marked meridians, and a cap that is a part."""
    loops = [circle(0.42 * sin(pi * k / 16), -0.42 * cos(pi * k / 16)) for k in range(1, 16)]
    ball = place(rings("Ball", loops, material), (-1.05, 0.2, 0.42), (-28, 24, 0))

    def meridian(a, b):
        turn = [round(12 * atan2(p.y, p.x) / pi) % 24 for p in (a, b)]
        return turn[0] == turn[1] and turn[0] % 4 == 0 and a.z != b.z

    part(ball, lambda at: int(at.z > 0.36))
    return mark(ball, lambda a, b: meridian(a, b) and max(a.z, b.z) < 0.385)


def monkey(material):
    """A soft toy with a cap on, which is a part, and a seam over it."""
    bpy.ops.mesh.primitive_monkey_add(size=0.95)
    toy = bpy.context.object
    toy.name = "Monkey"
    toy.data.materials.append(material)
    for polygon in toy.data.polygons:
        polygon.use_smooth = True
    part(toy, lambda at: int(at.z > 0.3 and at.y > -0.3))
    mark(toy, lambda a, b: abs(a.x) < 1e-4 and abs(b.x) < 1e-4 and min(a.z, b.z) > -0.1)
    return place(modifier(toy, "SUBSURF", levels=2, render_levels=2), (0, 0.1, 0.49), (-8, 0, 8))


def jack(material):
    """Three rods in one mesh, which pass through each other."""
    verts, faces = [], []
    for axis in range(3):
        first = len(verts)
        for end in (-0.34, 0.34):
            for k in range(24):
                point = [0.11 * cos(pi * k / 12), 0.11 * sin(pi * k / 12)]
                point.insert(axis, end)
                verts.append(tuple(point))
        faces += [(first + k, first + (k + 1) % 24, first + 24 + (k + 1) % 24, first + 24 + k) for k in range(24)]
        faces += [tuple(range(first, first + 24)), tuple(range(first + 24, first + 48))]
    rods = mesh_object("Jack", verts, faces, material, smooth=True)
    if hasattr(rods, "encre"):
        rods.encre.separate_parts = True
    return place(rods, (1.0, 0.05, 0.27), (35, 42, 20))


def cushion(material):
    """Folds that run from a button and end in the cloth, where pen_1_taper lifts the pen."""
    size, steps = 0.9, 12
    grid = [(size * (i / steps - 0.5), size * (j / steps - 0.5)) for j in range(steps + 1) for i in range(steps + 1)]

    def puffed(x, y, side):
        bulge = max(0, (1 - (2 * x / size) ** 2) * (1 - (2 * y / size) ** 2)) ** 0.5
        return side * 0.15 * bulge * (1 - 0.45 * max(0, 1 - hypot(x, y) / 0.3)) if bulge else 0

    verts = [(x, y, puffed(x, y, side)) for side in (-1, 1) for x, y in grid]
    row, half = steps + 1, len(grid)
    quads = [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
             for j in range(steps) for i in range(steps)]
    faces = [q[::-1] for q in quads] + [tuple(half + k for k in q) for q in quads]
    soft = mesh_object("Cushion", verts, faces, material, smooth=True)

    def fold(a, b):
        straight = (abs(a.x) + abs(b.x) < 1e-4) or (abs(a.y) + abs(b.y) < 1e-4)
        return a.z > 0 and b.z > 0 and straight and max(hypot(*p[:2]) for p in (a, b)) < 0.3

    mark(soft, fold)
    return place(soft, (-0.05, -0.9, 0.13), (0, 0, 28))


def build():
    box("Board", (4.2, 2.6, 0.08), (0, -0.2, -0.08), flat("Table", (0.55, 0.40, 0.26)))
    beach_ball(flat("Rubber", (0.75, 0.20, 0.14)))
    monkey(flat("Plush", (0.45, 0.30, 0.18)))
    jack(flat("Wood", (0.80, 0.62, 0.20)))
    cushion(flat("Cloth", (0.30, 0.42, 0.55)))
    world(sky=(0.80, 0.80, 0.76), fill=(0.5, 0.5, 0.5))
    light("SUN", "Lamp", (3, -5, 6), (0, 0, 0), (1, 1, 1), 3, angle=radians(1))
    camera((0.1, -5.0, 2.3), (0, -0.12, 0.28), 58)
    settings()


if __name__ == "__main__":
    build()
