# SPDX-License-Identifier: GPL-3.0-or-later
"""Five scenes for `peers.py` that no setting was chosen on, each a function that builds it in the empty current scene:
other things than those of scenes/, made by other means, of which the lines are known from the meshes.

Lengths are metres. No material has a texture, so that all lines come from shapes.
"""

from math import cos, pi, radians, sin

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector


def _material(name, color):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return made


def _link(name, mesh, color, at=(0, 0, 0), turn=(0, 0, 0), smooth=False):
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    obj.location, obj.rotation_euler = at, [radians(angle) for angle in turn]
    mesh.materials.append(bpy.data.materials.get(name) or _material(name, color))
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    return obj


def _made(name, color, make, at=(0, 0, 0), turn=(0, 0, 0), smooth=False, **more):
    """An object of what a bmesh operator makes."""
    shape = bmesh.new()
    make(shape, **more)
    mesh = bpy.data.meshes.new(name)
    shape.to_mesh(mesh)
    shape.free()
    return _link(name, mesh, color, at, turn, smooth)


def _box(name, color, size, at, turn=(0, 0, 0), bevel=0.0, segments=1):
    obj = _made(name, color, bmesh.ops.create_cube, at, turn, size=1, matrix=Matrix.Diagonal((*size, 1)))
    if bevel:
        made = obj.modifiers.new("Bevel", "BEVEL")
        made.width, made.segments = bevel, segments
    return obj


def _rod(name, color, radius, length, at, turn=(0, 0, 0), sides=48, top=None):
    return _made(name, color, bmesh.ops.create_cone, at, turn, sides > 12, cap_ends=True, segments=sides,
                 radius1=radius, radius2=radius if top is None else top, depth=length)


def _see(eye, at, lens):
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.data.lens = eye, lens
    camera.rotation_euler = (Vector(at) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    camera.data.clip_end = 1000
    scene.camera = camera
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 3.0, radians(3), (0.7, 0.2, 0.5)
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True


def machine():
    """A gear case: bevels of one to five segments, flanges with bolts, ribs, a bent pipe."""
    iron, steel, red = (0.3, 0.34, 0.36), (0.55, 0.55, 0.57), (0.5, 0.1, 0.08)
    _box("Bench", (0.5, 0.42, 0.3), (6, 4, 0.2), (0, 0, -0.1))
    _box("Case", iron, (1.6, 1.0, 0.9), (0, 0, 0.45), bevel=0.06, segments=3)
    _box("Lid", iron, (1.7, 1.1, 0.1), (0, 0, 0.95), bevel=0.02, segments=2)
    for k in range(5):
        _box("Rib", iron, (0.05, 0.12, 0.7), (-0.6 + 0.3 * k, -0.53, 0.45), bevel=0.01 * (k + 1), segments=k + 1)
    for x, y in [(x, y) for x in (-0.78, -0.26, 0.26, 0.78) for y in (-0.48, 0.48)]:
        _rod("Bolt", steel, 0.045, 0.05, (x, y, 1.025), sides=6)
        _rod("Thread", steel, 0.02, 0.06, (x, y, 1.06), sides=24)
    _rod("Flange", steel, 0.36, 0.08, (0.84, 0, 0.5), (0, 90, 0))
    _rod("Hub", steel, 0.22, 0.3, (1.0, 0, 0.5), (0, 90, 0))
    _rod("Shaft", steel, 0.08, 0.7, (1.3, 0, 0.5), (0, 90, 0))
    for k in range(8):
        turn = 2 * pi * k / 8
        _rod("Nut", iron, 0.035, 0.05, (0.9, 0.29 * cos(turn), 0.5 + 0.29 * sin(turn)), (0, 90, 0), sides=6)
    curve = bpy.data.curves.new("Pipe", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", 0.06, 6
    line = curve.splines.new("BEZIER")
    line.bezier_points.add(2)
    for point, at in zip(line.bezier_points, [(-1.9, -0.4, 0.15), (-1.3, -0.1, 0.5), (-0.8, 0.1, 0.6)], strict=True):
        point.co, point.handle_left_type, point.handle_right_type = at, "AUTO", "AUTO"
    pipe = bpy.data.objects.new("Pipe", curve)
    curve.materials.append(_material("Pipe", red))
    bpy.context.collection.objects.link(pipe)
    for k, segments in enumerate((1, 3, 10)):
        _box("Block", red, (0.3, 0.3, 0.3), (-0.9 + 0.5 * k, -1.1, 0.15), (0, 0, 20 * k), 0.04, segments)
    _see((2.6, -3.4, 2.3), (0.05, -0.15, 0.4), 50)


def city():
    """Blocks from the air: towers with window frames, roofs with things on them, streets."""
    rng = np.random.default_rng(5)
    _box("Ground", (0.3, 0.3, 0.3), (400, 400, 1), (0, 0, -0.5))
    for i in range(8):
        for j in range(8):
            x, y = 24 * (i - 3.5), 24 * (j - 3.5)
            _box("Pavement", (0.5, 0.5, 0.48), (20, 20, 0.4), (x, y, 0.2))
            wide, deep = rng.uniform(9, 16, 2)
            high = float(rng.choice([6, 9, 14, 22, 34]) * rng.uniform(0.8, 1.2))
            color = tuple(rng.uniform(0.3, 0.8, 3))
            name = f"House {i} {j}"
            _box(name, color, (wide, deep, high), (x, y, 0.4 + high / 2))
            _box(f"Roof {i} {j}", color, (wide + 0.6, deep + 0.6, 0.8), (x, y, 0.8 + high))
            _box("Vent", (0.6, 0.6, 0.6), (2, 3, 1.6), (x + wide / 5, y - deep / 5, 2 + high))
            _rod("Tank", (0.5, 0.3, 0.2), 1.2, 2.4, (x - wide / 4, y + deep / 4, 2.4 + high), sides=16)
            for side in range(2):
                span = (wide, deep)[side]
                columns, rows = max(int(span // 3), 1), max(int(high // 3), 1)
                verts, faces = [], []
                for c in range(columns):
                    for r in range(rows):
                        u, v = (c + 0.5) * span / columns - span / 2, (r + 0.6) * high / rows + 0.4
                        out = ((deep, wide)[side]) / 2 + 0.12
                        n = len(verts)
                        for du, dv in ((-0.7, -0.9), (0.7, -0.9), (0.7, 0.9), (-0.7, 0.9)):
                            for d in (0.0, -0.25):
                                place = (u + du, -out - d, v + dv) if not side else (out + d, u + du, v + dv)
                                verts.append((x + place[0], y + place[1], place[2]))
                        faces += [(n, n + 2, n + 4, n + 6)]
                        faces += [(n + 2 * k, n + 2 * k + 1, n + (2 * k + 3) % 8, n + (2 * k + 2) % 8)
                                  for k in range(4)]
                mesh = bpy.data.meshes.new("Windows")
                mesh.from_pydata(verts, [], faces)
                _link("Windows", mesh, (0.1, 0.14, 0.2))
    _see((95, -120, 85), (2, -6, 5), 40)


def head():
    """A subdivided head close up, with the eyes and lids of its own mesh."""
    bpy.ops.mesh.primitive_monkey_add(size=2)
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    obj.modifiers["Subdivision"].render_levels = 2
    bpy.ops.object.shade_smooth()
    obj.data.materials.append(_material("Skin", (0.6, 0.4, 0.3)))
    _rod("Collar", (0.2, 0.2, 0.5), 0.7, 0.3, (0, 0.1, -1.15))
    _see((1.5, -4.2, 0.5), (0, 0, -0.05), 62)


def bookshelf():
    """Books that stand and lean, and a plant of flat leaves on stalks."""
    rng = np.random.default_rng(11)
    wood = (0.4, 0.25, 0.12)
    for k in range(4):
        _box("Board", wood, (2.0, 0.32, 0.03), (0, 0, 0.4 * k), bevel=0.004)
    for x in (-1.0, 1.0):
        _box("Side", wood, (0.03, 0.32, 1.24), (x, 0, 0.6), bevel=0.004)
    _box("Back", wood, (2.0, 0.02, 1.24), (0, 0.16, 0.6))
    for shelf in range(3):
        x = -0.96
        while x < (0.3 if shelf == 1 else 0.9):
            thick, high, deep = rng.uniform(0.015, 0.06), rng.uniform(0.2, 0.32), rng.uniform(0.16, 0.24)
            lean = float(rng.choice([0, 0, 0, 8]))
            color = tuple(rng.uniform(0.05, 0.7, 3))
            name = f"Book {shelf} {x:.3f}"
            x += thick / 2 + high * sin(radians(lean)) + 0.002
            _box(name, color, (thick, deep, high), (x, -0.02, 0.4 * shelf + 0.018 + high / 2), (0, lean, 0))
            x += thick / 2
    _rod("Pot", (0.6, 0.3, 0.2), 0.07, 0.13, (0.6, -0.02, 0.48), sides=32, top=0.095)
    for k in range(26):
        turn, rise = 2.4 * k, 0.06 + 0.004 * k
        reach = 0.06 + 0.16 * float(rng.random())
        foot = np.array((0.6, -0.02, 0.54))
        tip = foot + (reach * cos(turn), reach * sin(turn) * 0.7, rise + 0.1 * float(rng.random()))
        along = tip - foot
        across = np.cross(along, (0, 0, 1)) / np.linalg.norm(np.cross(along, (0, 0, 1)))
        verts, faces = [], []
        for step in range(7):
            s = step / 6
            middle = foot + along * s + np.array((0, 0, -0.16 * reach * s * s))
            half = 0.003 if step < 2 else 0.03 * sin(pi * (s - 0.2) / 0.8)
            verts += [tuple(middle - across * half), tuple(middle + across * half)]
        faces = [(2 * j, 2 * j + 1, 2 * j + 3, 2 * j + 2) for j in range(6)]
        mesh = bpy.data.meshes.new("Leaf")
        mesh.from_pydata(verts, [], faces)
        _link("Leaf", mesh, (0.1, 0.4, 0.1))
    _see((0.5, -2.6, 0.95), (0.02, 0, 0.6), 52)


def vessel():
    """A hull of plates with grooves between them, a bridge, masts and wires."""
    grey, white = (0.35, 0.4, 0.45), (0.8, 0.8, 0.8)
    hull, at = bmesh.new(), []
    for i in range(25):
        s = i / 24
        half = 1.0 * (1 - max(0, (s - 0.6) / 0.4) ** 2) * min(1, 0.6 + 2 * s)
        keel = -0.7 + 0.35 * max(0, s - 0.6) / 0.4
        at.append([hull.verts.new((6 * s - 3, side * half * w, z * (0.5 + 0.12 * s) if z > 0 else z * -keel / 0.7))
                   for side, w, z in ((1, 1, 1), (1, 0.97, 0.2), (1, 0.7, -0.5), (1, 0.02, -0.7), (-1, 0.02, -0.7),
                                      (-1, 0.7, -0.5), (-1, 0.97, 0.2), (-1, 1, 1))])
    for one, two in zip(at, at[1:], strict=False):
        for k in range(8):
            hull.faces.new((one[k], one[(k + 1) % 8], two[(k + 1) % 8], two[k]))
    hull.faces.new(at[0][::-1])
    hull.faces.new(at[-1])
    bmesh.ops.recalc_face_normals(hull, faces=hull.faces)
    plates = [face for face in hull.faces if abs(face.calc_center_median().y) > 0.3 and
              round((face.calc_center_median().x + 3) * 4) % 3 == 0]
    bmesh.ops.inset_individual(hull, faces=plates, thickness=0.03, depth=-0.015)
    mesh = bpy.data.meshes.new("Hull")
    hull.to_mesh(mesh)
    hull.free()
    _link("Hull", mesh, grey)
    _box("Deckhouse", white, (1.6, 1.0, 0.5), (-1.2, 0, 0.78), bevel=0.05, segments=3)
    _box("Bridge", white, (0.8, 1.2, 0.4), (-0.9, 0, 1.2), bevel=0.03, segments=2)
    for k in range(7):
        _box("Pane", (0.05, 0.08, 0.1), (0.03, 0.12, 0.16), (-0.49, -0.48 + 0.16 * k, 1.24))
    _rod("Funnel", (0.5, 0.1, 0.1), 0.2, 0.9, (-1.7, 0, 1.3), (0, -8, 0))
    _rod("Mast", white, 0.03, 1.6, (-0.9, 0, 2.1), sides=16)
    for z in (1.9, 2.3, 2.6):
        _rod("Spar", white, 0.012, 0.8, (-0.9, 0, z), (90, 0, 0), sides=8)
    for y in (-0.4, 0.4):
        start, end = Vector((-0.9, y, 2.6)), Vector((2.6, 0, 0.75))
        way = end - start
        wire = _rod("Wire", (0.1, 0.1, 0.1), 0.006, way.length, (start + end) / 2, sides=6)
        wire.rotation_euler = way.to_track_quat("Z", "Y").to_euler()
    _rod("Turret", grey, 0.35, 0.25, (1.3, 0, 0.68), sides=40)
    for y in (-0.1, 0.1):
        _rod("Barrel", grey, 0.04, 0.9, (1.85, y, 0.74), (0, 90, 0), sides=16)
    for k in range(20):
        _rod("Post", white, 0.01, 0.3, (-2.8 + 0.28 * k, -0.93 if k < 15 else -0.93 + 0.16 * (k - 14), 0.72), sides=6)
    _box("Sea", (0.1, 0.2, 0.3), (60, 60, 0.1), (0, 0, -0.25))
    _see((4.6, -7.0, 3.0), (-0.1, 0, 0.6), 52)


SCENES = {"machine": machine, "city": city, "head": head, "bookshelf": bookshelf, "vessel": vessel}
