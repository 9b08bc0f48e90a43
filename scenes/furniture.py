# SPDX-License-Identifier: GPL-3.0-or-later
"""Furniture, books and plants. Each stands on `at` and looks along −y before it is turned."""

from math import cos, pi, radians, sin

from common import box, group, lathe, modifier, place, tube
from textured import board, disc, rounded, sheet, skin, soft_box, turned, wrapped


def seat(name, at, turn, width, cloth, legs, seats=1, tile=0.4):
    """A sofa or an armchair, 0.9 deep; returns its group, on which pillows may be put."""
    root = group(name, at, turn)
    inner = width - 0.36
    soft_box(f"{name} base", (width - 0.04, 0.82, 0.2), (0, 0, 0.14), 0.03, cloth, tile, parent=root)
    back = soft_box(f"{name} back", (width - 0.06, 0.24, 0.58), (0, 0.33, 0.3), 0.1, cloth, tile, parent=root)
    back.rotation_euler.x = radians(-7)
    for side in (-1, 1):
        soft_box(f"{name} arm {side}", (0.2, 0.86, 0.46), (side * (width / 2 - 0.1), -0.02, 0.14), 0.09, cloth, tile,
                 parent=root)
        for y in (-0.34, 0.34):
            lathe(f"{name} leg {side} {y}", [(0, 0.15), (0.03, 0.15), (0.018, 0)], (side * (width / 2 - 0.12), y, 0),
                  legs, steps=12, parent=root)
    for k in range(seats):
        x = (k + 0.5) * inner / seats - inner / 2
        soft_box(f"{name} seat {k}", (inner / seats - 0.012, 0.66, 0.15), (x, -0.09, 0.33), 0.05, cloth, tile, 0.03,
                 parent=root)
        rest = soft_box(f"{name} rest {k}", (inner / seats - 0.02, 0.16, 0.4), (x, 0.17, 0.46), 0.07, cloth, tile,
                        parent=root)
        rest.rotation_euler.x = radians(-12)
    return root


def throw(name, cloth, x, parent, tile=0.5):
    """A blanket over an arm at `x`, hanging down on both sides."""
    inside = rounded([(0, 0.155), (0.08, 0.145), (0.115, 0.08), (0.118, -0.06)], 5)
    outside = rounded([(0, 0.155), (0.08, 0.145), (0.118, 0.06), (0.125, -0.2), (0.13, -0.36)], 5)
    path = [(-r, z) for r, z in reversed(outside)] + inside[1:]

    def point(u, v):
        k = min(int(v * (len(path) - 1)), len(path) - 2)
        t = v * (len(path) - 1) - k
        r, z = (path[k][i] * (1 - t) + path[k + 1][i] * t for i in (0, 1))
        droop = 0.012 * sin(9 * u) * max(0, -z) / 0.3
        return r + droop, (u - 0.5) * 0.5, z + 0.02 * sin(5 * u) * (z < 0)

    obj = sheet(name, point, (12, len(path) - 1), cloth, (0.5 / tile, 0.85 / tile), thick=0.012, parent=parent)
    obj.location = x, -0.12, 0.46
    return obj


def round_table(name, at, radius, height, top, wood):
    root = group(name, at)
    disc(f"{name} top", radius, 0.035, (0, 0, height - 0.035), top, wood, parent=root)
    for k in range(3):
        a = 2 * pi * k / 3 + 0.5
        tube(f"{name} leg {k}", [(0.55 * radius * cos(a), 0.55 * radius * sin(a), height - 0.03),
                                 (0.86 * radius * cos(a), 0.86 * radius * sin(a), 0)], [0.026, 0.014], wood, sides=10,
             smooth=1, parent=root)
    return root


def shelves(name, at, turn, size, boards, wood):
    """A bookcase; `wood` is printed for its sides and boards. Returns its group and the heights of the boards."""
    root = group(name, at, turn)
    w, d, h = size
    for side in (-1, 1):
        wrapped(f"{name} side {side}", (0.03, d, h), (side * (w - 0.03) / 2, 0, 0), wood, 0.7, parent=root)
    heights = [0.06 + (h - 0.09) * k / (boards - 1) for k in range(boards)]
    for k, z in enumerate(heights):
        wrapped(f"{name} board {k}", (w - 0.06, d, 0.03), (0, 0, z), wood, 0.7, parent=root)
    wrapped(f"{name} back", (w - 0.06, 0.02, h - 0.06), (0, d / 2 - 0.01, 0.06), wood, 0.7, bevel=0, parent=root)
    return root, [z + 0.03 for z in heights]


def book(name, size, at, cloth, paper, turn=(0, 0, 0), parent=None):
    """A bound book standing with its spine to −y; size: thickness, depth, height. One picture covers all its cloth."""
    t, d, h = size
    root = group(name, parent=parent)
    place(root, at, turn)
    box(f"{name} pages", (t - 0.008, d - 0.012, h - 0.012), (0, 0.002, 0.006), paper, bevel=0, parent=root)
    b = 0.35 * t  # the spine is round
    path = [(-t / 2, d / 2), (-t / 2, -d / 2 + b), (-t / 2 + 0.3 * b, -d / 2 + 0.3 * b), (0, -d / 2),
            (t / 2 - 0.3 * b, -d / 2 + 0.3 * b), (t / 2, -d / 2 + b), (t / 2, d / 2)]
    shares = (0, 0.43, 0.46, 0.5, 0.54, 0.57, 1)
    verts = [(x, y, z) for z in (0, h) for x, y in path]
    n = len(path)
    faces = [(k, k + 1, n + k + 1, n + k) for k in range(n - 1)]
    corners = [(shares[k % n], k // n) for face in faces for k in face]
    obj = skin(f"{name} cover", verts, faces, corners, cloth, parent=root, smooth=False)
    modifier(obj, "SOLIDIFY", thickness=0.004, offset=1)
    return root


def framed(name, size, at, print_, wood, turn=(0, 0, 0), margin=0.0, paper=None):
    """A framed picture hung with its middle at `at`; with a margin of paper round it if asked."""
    w, h = size
    root = group(name)
    place(root, at, turn)
    edge = 0.035
    for k, (x, z, sx, sz) in enumerate(((0, h / 2, w + 2 * edge, edge), (0, -h / 2 - edge, w + 2 * edge, edge),
                                        (-w / 2 - edge / 2, -h / 2, edge, h), (w / 2 + edge / 2, -h / 2, edge, h))):
        box(f"{name} frame {k}", (sx, 0.035, sz), (x, -0.018, z), wood, bevel=0, parent=root)
    if margin:
        box(f"{name} mount", (w, 0.01, h), (0, -0.006, -h / 2), paper, bevel=0, parent=root)
    board(f"{name} print", (w - 2 * margin, h - 2 * margin), (0, -0.014, margin - h / 2), print_, parent=root)
    return root


def floor_lamp(name, at, shade, metal, glow):
    root = group(name, at)
    lathe(f"{name} foot", [(0, 0.03), (0.1, 0.028), (0.15, 0.012), (0.15, 0)], (0, 0, 0), metal, parent=root)
    tube(f"{name} pole", [(0, 0, 0.02), (0, 0, 1.5)], 0.012, metal, sides=10, smooth=0, parent=root)
    turned(f"{name} shade", [(0.24, 1.36), (0.15, 1.7)], (0, 0, 0), shade, (4, 1), thick=0.004, parent=root)
    lathe(f"{name} bulb", [(0, 1.56), (0.035, 1.52), (0.035, 1.48), (0, 1.45)], (0, 0, 0), glow, steps=12, parent=root)
    return root


def table_lamp(name, at, vase, shade, metal):
    root = group(name, at)
    turned(f"{name} foot", rounded([(0.07, 0), (0.1, 0.07), (0.075, 0.17), (0.03, 0.24), (0.025, 0.26)]), (0, 0, 0),
           vase, (3, 1), parent=root)
    tube(f"{name} neck", [(0, 0, 0.25), (0, 0, 0.4)], 0.01, metal, sides=8, smooth=0, parent=root)
    turned(f"{name} shade", [(0.19, 0.31), (0.13, 0.52)], (0, 0, 0), shade, (5, 1), thick=0.004, parent=root)
    return root


def curtain(name, at, turn, size, cloth, folds, tile=0.4):
    """A hanging curtain; its cloth is longer than it is wide, by the folds."""
    w, h = size

    def point(u, v):
        fold = sin(2 * pi * folds * u + 0.4 * sin(3 * v))
        gather = 1 - 0.18 * sin(pi * v) ** 2
        return (u - 0.5) * w * gather, 0.045 * fold * (1.15 - 0.4 * v), v * h

    return sheet(name, point, (16 * folds, 12), cloth, (1.7 * w / tile, h / tile), thick=0.006, at=at, turn=turn)


def plant(name, at, pot, earth, leaf, count, length, repeat=(4, 1)):
    """Arching leaves out of a pot."""
    root = group(name, at)
    turned(f"{name} pot", [(0.11, 0), (0.16, 0.27), (0.175, 0.27), (0.175, 0.31), (0.15, 0.31), (0.14, 0.25)],
           (0, 0, 0), pot, repeat, parent=root)
    disc(f"{name} earth", 0.145, 0.01, (0, 0, 0.255), earth, earth, sides=24, parent=root)
    for k in range(count):
        swing = 2.39996 * k  # the golden angle: no leaf hides another
        rise = 0.95 - 0.75 * k / count
        reach = length * (0.75 + 0.25 * sin(3.0 * k))

        def point(u, v, rise=rise, reach=reach):
            width = 0.075 * reach * (sin(pi * min(1, 0.08 + 0.92 * v)) ** 0.8 + 0.12 * (1 - v)) * 2
            out = reach * (v * (1 - rise) + 0.35 * v * v)
            up = reach * (v * (0.35 + rise) - 0.55 * v ** 3 * (1.25 - rise))
            side = (2 * u - 1) * width
            return out + 0.02, side, up + 0.4 * abs(side)

        obj = sheet(f"{name} leaf {k}", point, (4, 14), leaf, thick=0.003, at=(0, 0, 0.25), parent=root)
        obj.rotation_euler.z = swing
    return root


def cubes(name, at, size, sides, turn, parent=None):
    """A toy block; `sides` are three materials for three pairs of faces."""
    verts = [(i, j, k) for k in (0, size) for i, j in ((-size / 2,) * 2, (size / 2, -size / 2), (size / 2,) * 2,
                                                      (-size / 2, size / 2))]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (3, 0, 4, 7)]
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)] * 6
    obj = skin(name, verts, faces, corners, sides, at=at, turn=(0, 0, turn), parent=parent, smooth=False,
               slots=[0, 0, 1, 1, 2, 2])
    return modifier(obj, "BEVEL", width=0.006, segments=2)
