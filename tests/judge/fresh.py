# SPDX-License-Identifier: GPL-3.0-or-later
"""Eight more scenes that nothing was tuned on, of which chains of mesh edges tell: written, with all their sizes, seeds
and cameras, before anything was measured on them. Who cures what they show must say so in helpers/pages.py: they are
unseen no more then. Each takes a shift in pixels; of MOVED a pan is judged, too: that of the others takes minutes."""

import numpy as np

from .camera import look
from .kinds import FLAT, coloured, leaf
from .meshes import Mesh
from .meshes import box as hull
from .scenes import turned
from .shapes import box, unit
from .told import Told, bevelled, hung, joined, outward, prism, wheel
from .unseen import lathe, placed

SEED = 20261129


def ring(radius, thick, sides, round_by=16):
    """A ring about the y axis, round in section."""
    turn = np.arange(round_by + 1) * 2 * np.pi / round_by
    profile = [(radius + thick * np.cos(a), thick * np.sin(a)) for a in turn[:-1]]
    return outward(lathe([*profile, profile[0]], sides))


def rod(a, b, thick):
    """Of square section."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    way = unit(b - a)
    one = unit(np.cross(way, (0.3, 1, 0.2)))
    turn = np.stack([one, way, np.cross(one, way)], 1)
    return hull((thick, np.linalg.norm(b - a), thick), (a + b) / 2, turn)


def bicycle(**more):
    """A wheel of a bicycle, its 28 spokes about a pixel and a half wide and crossed three by three, before a wall."""
    turn, at = turned(0.35, np.pi / 2 - 0.1), np.array([-0.2, 1.0, 0.3])
    tyre, rim, hub = ring(0.95, 0.05, 72), ring(0.87, 0.022, 72), prism(12, 0.06, 0.26, (0, -0.13, 0), 0.1)
    spokes = []
    for k in range(28):
        side, foot = (1, -1)[k % 2], 2 * np.pi * (k // 2) / 14
        head = 2 * np.pi * k / 28 + (0.75, -0.75)[k // 2 % 2]
        spokes.append(rod((0.05 * np.sin(foot), 0.1 * side, 0.05 * np.cos(foot)),
                          (0.86 * np.sin(head), 0.0, 0.86 * np.cos(head)), 0.018))
    fork = joined(rod((0.09, 0.18, 0), (0.25, 0.18, -1.5), 0.07), rod((0.09, -0.18, 0), (0.25, -0.18, -1.5), 0.07))
    meshes = [placed(mesh, at, turn) for mesh in (tyre, rim, hub, *spokes, fork)]
    return Told(look([0.2, 1.5, 5.0], [0, 1.0, 0], **more),
                coloured([hull((7, 4, 0.2), (0, 1.6, -1.6), turned(0.1)), *meshes]), FLAT)


def fence(**more):
    """A chain-link fence, its wires under two pixels, between two posts; behind it stands somebody."""
    wires, step = [], 0.16
    for k in range(-9, 20):
        for side in (-1, 1):
            low = max(0.0, -k * step) if side > 0 else max(0.0, (k - 11) * step)
            high = min(1.6, (11 - k) * step) if side > 0 else min(1.6, k * step)
            if high - low > 0.1:
                wires.append(rod((side * low + k * step - 0.9, 0.2 + low, 0.02 * side),
                                 (side * high + k * step - 0.9, 0.2 + high, 0.02 * side), 0.014))
    turn, at = turned(0.15), np.array([0.0, 0.0, 0.8])
    posts = [prism(10, 0.05, 2.0, (x, 0, 0), 0.1) for x in (-1.05, 1.0)]
    rail = rod((-1.05, 1.85, 0), (1.0, 1.85, 0), 0.06)
    figure = [hull((0.5, 0.75, 0.28), (0.1, 1.15, 0), turned(0.4)), prism(14, 0.17, 0.36, (0.1, 1.58, 0), 0.2),
              hull((0.18, 0.8, 0.22), (-0.03, 0.4, 0.03), turned(0.4)),
              hull((0.18, 0.8, 0.22), (0.24, 0.4, -0.06), turned(0.4)),
              rod((-0.2, 1.45, 0.1), (-0.5, 1.0, 0.35), 0.13), rod((0.38, 1.45, -0.1), (0.62, 1.85, 0.1), 0.13)]
    meshes = [placed(mesh, at, turn) for mesh in (joined(*wires), *posts, rail)]
    meshes += [placed(mesh, (0.0, 0.0, -0.6), np.eye(3)) for mesh in figure]
    return Told(look([-0.3, 1.4, 4.6], [0, 1.0, 0], **more),
                coloured([hull((8, 0.2, 7), (0, -0.1, 0), turned(0)), *meshes]), FLAT)


def crate(size, centre, turn):
    """Of boards with gaps of a pixel or two between them, and battens at the corners."""
    boards, n = [hull((size * 0.96, size * 0.96, size * 0.96), (0, 0, 0), np.eye(3))], 4
    for k in range(n):
        y = size * ((k + 0.5) / n - 0.5)
        boards += [hull((size, size * 0.92 / n, 0.03), (0, y, side * size / 2), np.eye(3)) for side in (-1, 1)]
        boards += [hull((0.03, size * 0.92 / n, size), (side * size / 2, y, 0), np.eye(3)) for side in (-1, 1)]
        boards.append(hull((size, 0.03, size * 0.92 / n), (0, size / 2, y), np.eye(3)))
    for x in (-1, 1):
        boards += [hull((size * 0.12, size, 0.05), (x * size * 0.42, 0, z * (size / 2 + 0.02)), np.eye(3))
                   for z in (-1, 1)]
    return placed(joined(*boards), centre, turn)


def crates(**more):
    """Stacked crates of boards, each turned a little."""
    rng, meshes = np.random.default_rng(SEED), []
    for x, level, z, size in ((-1.4, 0, 0, 1.0), (-0.2, 0, -0.3, 1.0), (1.1, 0, 0.2, 0.9), (-0.9, 1, -0.1, 0.9),
                              (0.5, 1, 0, 0.8), (-0.3, 2, -0.1, 0.7)):
        low = (0.0, 1.03, 1.96)[level]
        meshes.append(crate(size, (x, low + size / 2, z), turned(rng.uniform(-0.35, 0.35))))
    return Told(look([0.8, 2.6, 6.4], [-0.1, 1.2, 0], **more),
                coloured([hull((9, 0.2, 8), (0, -0.1, 0), turned(0)), *meshes]), FLAT)


def head(**more):
    """A head as it is sculpted: 11,760 triangles with brow, nose, lips, eyes and ears, shaded as they are; as many as
    are told exactly in a minute."""
    across, down = 120, 48
    u, v = np.meshgrid(np.arange(across) * 2 * np.pi / across, np.linspace(0.03, np.pi - 0.03, down + 1))
    x, y, z = np.sin(u) * np.sin(v), np.cos(v), np.cos(u) * np.sin(v)

    def bump(cx, cy, wide, tall, high, side=0.3):
        return high * np.exp(-((x - cx) / wide)**2 - ((y - cy) / tall)**2) * (z > side)
    r = 0.85 + 0.12 * y - 0.06 * np.abs(y) * (y < 0)
    r = r + bump(0, 0.0, 0.1, 0.22, 0.2) + bump(0, 0.3, 0.55, 0.07, 0.06) + bump(0, -0.42, 0.22, 0.05, 0.07)
    r = r - bump(0, -0.35, 0.2, 0.025, 0.03) - bump(-0.3, 0.15, 0.13, 0.08, 0.09) - bump(0.3, 0.15, 0.13, 0.08, 0.09)
    r = r + 0.12 * np.exp(-((np.abs(x) - 0.95) / 0.12)**2 - ((y - 0.05) / 0.2)**2 - ((z + 0.1) / 0.15)**2)
    points = np.stack([0.8 * r * x, r * y, 0.95 * r * z], -1).reshape(-1, 3)
    a = np.arange(across * down)
    b = a // across * across + (a + 1) % across
    faces = [*np.stack([a, a + across, b], 1).tolist(), *np.stack([b, a + across, b + across], 1).tolist()]
    top, foot = len(points), len(points) + 1
    points = np.concatenate([points, points[:across].mean(0)[None], points[-across:].mean(0)[None]])
    faces += [[top, k, (k + 1) % across] for k in range(across)]
    last = across * down
    faces += [[foot, last + (k + 1) % across, last + k] for k in range(across)]
    mesh = outward(Mesh(points, faces))
    neck = prism(20, 0.42, 0.9, (0, -1.6, -0.1), 0.05)
    return Told(look([1.2, 0.2, 4.2], [0, -0.1, 0], **more),
                coloured([placed(mesh, (0, 0, 0), turned(0.2)), neck]), FLAT)


def curtain(**more):
    """A cloth whose folds lie upon each other and touch, before a wall, and one that hangs over it."""
    folds = [(-1.5, 0), (-1.1, 0.05), (-0.9, 0.3), (-1.0, 0.45), (-0.8, 0.5), (-0.62, 0.22), (-0.65, 0.05), (-0.2, 0.0),
             (0.05, 0.25), (-0.05, 0.42), (0.2, 0.5), (0.42, 0.25), (0.4, 0.03), (0.9, 0.0), (1.3, 0.12), (1.5, 0.0)]
    x, z = np.array(folds).T
    cloth = hung(x, z, 2.2, (0, 1.3, 0), turned(0.1), 0.03)
    over = hung(np.linspace(-0.7, 0.7, 9), 0.55 + 0.06 * np.cos(np.arange(9) * np.pi), 0.9, (0.1, 1.9, 0), turned(0.1),
                0.02)
    return Told(look([0.5, 1.7, 5.2], [0, 1.2, 0], **more),
                coloured([hull((7, 4, 0.2), (0, 1.6, -1.2), turned(0.05)), cloth, over]), FLAT)


def keyboard(**more):
    """Keys with bevels of three segments, a third of a pixel to four wide, in four rows, the gaps two pixels."""
    meshes, tilt = [hull((4.4, 0.2, 1.9), (0, 0.0, 0), turned(0))], turned(0, 0.06)
    for row in range(4):
        for column in range(9):
            wide = 0.4 if column or row != 3 else 0.62
            at = (-1.75 + 0.44 * column + 0.09 * row, 0.22, -0.62 + 0.42 * row)
            meshes.append(bevelled((wide, 0.24, 0.37), at, tilt, 0.004 + 0.005 * column, 3))
    return Told(look([0.3, 3.0, 4.4], [0, 0.1, 0.1], **more), coloured(meshes), FLAT)


def clockwork(**more):
    """Gears that pass through one another, as a first draft has them, and axles through all."""
    gears = [wheel(14, 0.8, 0.12, 0.3, (-0.7, 1.0, 0.0), turned(0.2, 0.1), 0.1),
             wheel(10, 0.6, 0.12, 0.24, (0.4, 1.3, 0.1), turned(0.5, -0.2), 0.3),
             wheel(20, 0.9, 0.09, 0.16, (0.9, 0.6, -0.1), turned(-0.3, 0.15), 0.0),
             wheel(8, 0.4, 0.1, 0.5, (-0.1, 0.5, 0.2), turned(0.9, 0.3), 0.2)]
    axles = [rod((-0.7, 1.0, -0.8), (-0.55, 1.05, 0.9), 0.2), rod((0.9, 0.6, -0.9), (0.75, 0.65, 0.8), 0.24)]
    return Told(look([0.3, 1.4, 4.8], [0.1, 0.95, 0], **more), coloured([*gears, *axles]), FLAT)


def branch(**more):
    """Leaves cut out by alpha on a twig, from three pixels to forty wide, before a wall."""
    rng, found = np.random.default_rng(SEED + 1), []
    for k in range(26):
        t = k / 25
        at = np.array([-1.7 + 3.4 * t, 0.6 + 1.1 * t + 0.2 * np.sin(5 * t), 0.25 * np.sin(9 * t)])
        found.append(leaf(at + rng.uniform(-0.22, 0.22, 3), turned(*rng.uniform(-0.7, 0.7, 2), rng.uniform(0, 3)),
                          0.06 + 0.32 * rng.uniform()**2))
    wall = (6, 4, 0.1), (0, 1.2, -3.2), turned(-0.1)
    return Told(look([0.2, 1.4, 5.6], [0, 1.15, 0], **more),
                coloured([box(*wall), *(solid for solid, _ in found)]), FLAT, drawn=[hull(*wall)],
                cards=[card for _, card in found])


MESHES = {f.__name__: f for f in (bicycle, fence, crates, head, curtain, keyboard, clockwork, branch)}
MOVED = {"bicycle", "curtain", "clockwork", "branch"}
