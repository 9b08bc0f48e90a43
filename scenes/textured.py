# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with UV maps and the printed materials that go on them.

As in common.py, every function makes one thing in the current scene and returns it. A pattern has its size in metres:
`tile` is the side of the square that one picture covers.
"""

from itertools import pairwise
from math import cos, pi, sin, sqrt, tan

import bmesh
import bpy
import numpy as np
from common import link, modifier, place
from materials import flat, node, wire

# Materials


def image(name, picture):
    """A packed image from an array (height, width, 3), sRGB from 0 to 1, row 0 at the bottom."""
    height, width, _ = picture.shape
    new = bpy.data.images.new(name, width, height, alpha=False)
    rgba = np.ones((height, width, 4), np.float32)
    rgba[:, :, :3] = picture
    new.pixels.foreach_set(rgba.ravel())
    new.update()
    new.pack()
    return new


def printed(name, picture, glow=False):
    """Matt, or with `glow` shining, in the colours of a picture."""
    material = flat(name, (0.8, 0.8, 0.8))
    tree = material.node_tree
    surface = next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE")
    if glow:
        surface = node(tree, "Emission")
        wire(tree, (surface, next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")))
    texture = node(tree, "TexImage")
    texture.image = image(name, picture)
    wire(tree, (texture, surface))
    return material


# Shapes


def skin(name, verts, faces, corners, materials, at=(0, 0, 0), turn=(0, 0, 0), parent=None, smooth=True, slots=None):
    """A mesh object with a UV for every corner of every face; vertices in one place become one."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in verts], [], faces)
    for material in materials if isinstance(materials, list) else [materials]:
        mesh.materials.append(material)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", np.asarray(corners, np.float32).ravel())
    for polygon in mesh.polygons:
        polygon.use_smooth = smooth
        polygon.material_index = slots[polygon.index] if slots else 0
    whole = bmesh.new()
    whole.from_mesh(mesh)
    bmesh.ops.remove_doubles(whole, verts=whole.verts, dist=1e-5)
    whole.to_mesh(mesh)
    whole.free()
    return place(link(bpy.data.objects.new(name, mesh), parent), at, turn)


def grid(us, vs, point, uv=lambda u, v: (u, v)):
    """Vertices, faces and the UVs of their corners over the lines `us` and `vs`; a face looks along u × v."""
    m = len(us)
    verts = [point(u, v) for v in vs for u in us]
    faces = [(j * m + i, j * m + i + 1, j * m + m + i + 1, j * m + m + i)
             for j in range(len(vs) - 1) for i in range(m - 1)]
    flat_uv = [uv(u, v) for v in vs for u in us]
    return verts, faces, [flat_uv[k] for face in faces for k in face]


def steps(count, low=0.0, high=1.0):
    return [low + (high - low) * k / count for k in range(count + 1)]


def sheet(name, point, counts, material, repeat=(1, 1), thick=0, **options):
    """A surface `point(u, v)` over the unit square, on which the picture is repeated so many times."""
    verts, faces, corners = grid(steps(counts[0]), steps(counts[1]), point, lambda u, v: (u * repeat[0], v * repeat[1]))
    obj = skin(name, verts, faces, corners, material, **options)
    return modifier(obj, "SOLIDIFY", thickness=thick, offset=0) if thick else obj


def board(name, size, at, material, turn=(0, 0, 0), repeat=(1, 1), **options):
    """A flat picture, upright, its foot in the middle of the lower edge; it looks along −y before it is turned."""
    w, h = size
    return sheet(name, lambda u, v: ((u - 0.5) * w, 0, v * h), (1, 1), material, repeat, at=at, turn=turn, **options)


def turned(name, profile, at, material, repeat=(1, 1), sides=32, thick=0, **options):
    """A turned body with its outline (radius, height) from the foot up; the picture goes round `repeat[0]` times."""
    lengths = np.cumsum([0, *(sqrt((a - c) ** 2 + (b - d) ** 2) for (a, b), (c, d) in pairwise(profile))])

    def point(u, k):
        r, z = profile[k]
        return r * cos(2 * pi * u), r * sin(2 * pi * u), z

    verts, faces, corners = grid(steps(sides), range(len(profile)), point,
                                 lambda u, k: (u * repeat[0], lengths[k] / lengths[-1] * repeat[1]))
    obj = skin(name, verts, faces, corners, material, at=at, **options)
    return modifier(obj, "SOLIDIFY", thickness=thick) if thick else obj


def rounded(points, count=6):
    """A smooth outline through a few points (Catmull and Rom)."""
    points = np.array([points[0], *points, points[-1]], float)
    out = []
    for a, b, c, d in zip(points, points[1:], points[2:], points[3:], strict=False):
        for t in np.arange(count) / count:
            out.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t
                              + (3 * b - a - 3 * c + d) * t ** 3))
    return [tuple(map(float, (max(0, x[0]), x[1]))) for x in [*out, points[-1]]]


def soft_box(name, size, at, radius, material, tile=0.4, puff=0.0, turn=0, parent=None, level=False):
    """An upholstered box standing on `at`: edges rounded by `radius`, its top swollen by `puff`.

    The pattern lies on each side by itself, upright, or with `level` turned by a quarter.
    """
    half = np.array(size) / 2

    def lines(h):
        bend = [h - radius + radius * tan(a) for a in (0, pi / 12, pi / 6, pi / 4)]
        return [-x for x in reversed(bend)] + steps(6, radius - h, h - radius)[1:-1] + bend

    def face(axis, side):
        a, b = (axis + 1) % 3, (axis + 2) % 3

        def corner(u, v):
            p = np.zeros(3)
            p[axis], p[a], p[b] = side * half[axis], side * u, v
            return p

        def point(u, v):
            core = np.clip(corner(u, v), radius - half, half - radius)
            p = corner(u, v) - core
            p = core + radius * p / np.linalg.norm(p)
            x, y = np.clip(p[:2] / half[:2], -1, 1)
            return p + (0, 0, half[2] + puff * (1 - x * x) * (1 - y * y) * (p[2] > 0))

        def uv(u, v):
            x, y, z = corner(u, v) / tile + 0.5
            across, up = ((side * y, z), (-side * x, z), (x, y))[axis]
            return (up, across) if level else (across, up)

        return grid(lines(half[a]), lines(half[b]), point, uv)

    verts, faces, corners = [], [], []
    for axis in range(3):
        for side in (-1, 1):
            more = face(axis, side)
            faces += [tuple(k + len(verts) for k in quad) for quad in more[1]]
            verts += more[0]
            corners += more[2]
    return skin(name, verts, faces, corners, material, at=at, turn=(0, 0, turn), parent=parent)


def pillow(name, size, at, material, turn=(0, 0, 0), repeat=(1, 1), parent=None):
    """A stuffed square that looks along −y before it is turned, its middle at `at`; size: width, height, thickness."""
    width, height, thick = size

    def side(sign):
        def point(u, v):
            x, y = 2 * u - 1, 2 * v - 1
            swell = max(0, (1 - abs(x) ** 3) * (1 - abs(y) ** 3)) ** 0.6
            # The seams are pulled in between the corners.
            return (width / 2 * x * (1 - 0.09 * (1 - y * y)), -sign * thick / 2 * swell,
                    height / 2 * y * (1 - 0.09 * (1 - x * x)))
        line = [0.5 - 0.5 * cos(pi * t) for t in steps(14)]
        return grid(line if sign > 0 else line[::-1], line, point, lambda u, v: (u * repeat[0], v * repeat[1]))

    front, back = side(1), side(-1)
    faces = front[1] + [tuple(k + len(front[0]) for k in face) for face in back[1]]
    return skin(name, front[0] + back[0], faces, front[2] + back[2], material, at=at, turn=turn, parent=parent)


def disc(name, radius, thickness, at, top, rim, turn=(0, 0, 0), sides=48, parent=None):
    """A round plate with its picture on top and a plain rim; before it is turned it looks up."""
    ring = [(cos(2 * pi * k / sides), sin(2 * pi * k / sides)) for k in range(sides)]
    verts = [(radius * x, radius * y, z) for z in (0, thickness) for x, y in ring]
    faces = [tuple(range(sides, 2 * sides)), tuple(range(sides - 1, -1, -1))]
    faces += [(k, (k + 1) % sides, sides + (k + 1) % sides, sides + k) for k in range(sides)]
    corners = [(0.5 + 0.5 * x, 0.5 + 0.5 * y) for x, y in (*ring, *ring[::-1])] + [(0, 0)] * (4 * sides)
    return skin(name, verts, faces, corners, [top, rim], at=at, turn=turn, parent=parent, smooth=False,
                slots=[0, *[1] * (sides + 1)])


def wrapped(name, size, at, material, tile, bevel=0.006, turn=(0, 0, 0), parent=None):
    """A hard box standing on `at`, the pattern on each side by itself."""
    x, y, z = np.array(size) / 2
    verts = [(i, j, k) for k in (0, 2 * z) for i, j in ((-x, -y), (x, -y), (x, y), (-x, y))]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    corners = []
    for face in faces:
        p = np.array([verts[k] for k in face])
        across, up = p[1] - p[0], p[3] - p[0]
        for corner in p - p.mean(axis=0):
            corners.append((corner @ across / np.linalg.norm(across) / tile + 0.5,
                            corner @ up / np.linalg.norm(up) / tile + 0.5))
    obj = skin(name, verts, faces, corners, material, at=at, turn=turn, parent=parent, smooth=False)
    return modifier(obj, "BEVEL", width=bevel, segments=2) if bevel else obj
