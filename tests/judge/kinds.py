# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of other kinds than those that FINE was tuned on: what is thin, far, faceted, bevelled, cut out, or stands in
something else. Each takes a shift in pixels. Those of meshes come with what our rasteriser tells of them."""

from functools import cached_property

import numpy as np
from reference import near

from . import shapes
from .camera import look
from .meshes import Mesh, quad
from .meshes import box as hull
from .scene import Light, Scene
from .scenes import COLORS, SUN, turned
from .shapes import Cone, HalfSpace, Solid, across, ball, box, cone, disc, ground, polygon, unit
from .told import Told, bevelled, grid, grown, hung, joined, outward, prism, rock, tube, wheel, zigzag

CROWD = 10  # pixels between boundaries of colours, below which their lines thin out
FLAT = Light(SUN, sun=0.0, ambient=0.7)


def coloured(solids):
    for k, solid in enumerate(solids):
        solid.color = np.array(COLORS[k % len(COLORS)]) * (0.8 + 0.1 * (k % 3))
    return solids


def between(a, b, thick):
    """A rod of square section from one point to another."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    along = unit(b - a)
    one, two = across(along)
    return box((thick, thick, np.linalg.norm(b - a)), (a + b) / 2, np.stack([one, two, along], 1))


def column(foot, way, radius, height, collars):
    """A round column with collars, each (how far up, how wide, how far it stands out)."""
    foot, way = np.asarray(foot, float), unit(way)
    return [cone(foot, way, radius, radius, height),
            *(cone(foot + way * at, way, radius + out, radius + out, wide) for at, wide, out in collars)]


class Crowded(Scene):
    """One with boundaries of colours that lie closer together than lines between colours may."""

    @cached_property
    def truth(self):
        truth = super().truth
        i, j = near.pairs(np.stack([truth.x, truth.y], 1), np.stack([truth.x, truth.y], 1)[::2], CROWD)
        j = 2 * j
        dx, dy = truth.x[j] - truth.x[i], truth.y[j] - truth.y[i]
        across = np.abs(dx * truth.nx[i] + dy * truth.ny[i])
        along = np.abs(dy * truth.nx[i] - dx * truth.ny[i])
        level = np.abs(truth.nx[i] * truth.nx[j] + truth.ny[i] * truth.ny[j]) > 0.9
        truth.narrow[i[level & (across > 1.2) & (along < 1.5)]] = True
        return truth


# By formula


def tops(**more):
    """Low slabs whose tops are three to five pixels high and forty wide."""
    slabs = [box((0.62, tall, 0.5), (x, tall / 2, z), turned(yaw))
             for x, z, tall, yaw in ((-1.5, 1.2, 0.12, 0.0), (-0.4, 1.4, 0.2, 0.03), (0.8, 1.1, 0.3, -0.05),
                                     (1.7, 0.2, 0.4, 0.1), (-1.1, -0.8, 0.25, -0.2), (0.3, -1.2, 0.5, 0.0))]
    return Scene(look([0.1, 0.75, 6.2], [0, 0.35, 0], **more), coloured([ground(0.0), *slabs]), FLAT)


def shadows(**more):
    """Thin posts, upright and leaning, whose shadows on the floor are one and a half to four pixels wide."""
    posts = [between((x, -0.01, z), (x + lean, tall, z), thick)
             for x, z, lean, tall, thick in ((-1.9, 0.3, 0, 1.3, 0.035), (-1.0, 0.9, 0.3, 1.1, 0.03),
                                             (0.1, 0.2, 0, 1.4, 0.05), (0.9, 1.0, -0.2, 0.9, 0.07))]
    light = Light(unit([0.55, 0.6, -0.35]), sun=0.9, ambient=0.2)
    return Scene(look([0.2, 2.4, 6.0], [-0.2, 0.4, 0.5], **more), coloured([ground(0.0), *posts]), light)


def wires(**more):
    """Level wires and nearly level ones, one and a half to four pixels thick, before a wall and the sky."""
    wall = box((2.0, 2.2, 0.4), (-0.9, 1.1, -1.2), turned(0.15))
    lines = [between((-3.5, y, 0), (3.5, y + rise, 0), thick)
             for y, rise, thick in ((0.45, 0, 0.035), (0.8, 0.02, 0.05), (1.15, 0, 0.07), (1.5, -0.05, 0.045),
                                    (1.9, 0.11, 0.03), (2.25, 0, 0.06))]
    return Scene(look([0.0, 1.3, 6.0], [0, 1.25, 0], **more), coloured([ground(-0.2), wall, *lines]), FLAT)


def hairs(**more):
    """Rods as thin as a pixel and a half to three, that cross each other at all angles, before the sky and a board."""
    rng = np.random.default_rng(5)
    board = box((1.8, 1.7, 0.1), (0.9, 1.1, -1.5), turned(-0.2))
    rods = []
    for k in range(9):
        turn, at = np.pi * (k + 0.3) / 9, rng.uniform(-0.7, 0.7, 2)
        way = 1.6 * np.array([np.cos(turn), np.sin(turn), 0])
        middle = np.array([at[0], 1.2 + at[1], 0.8 - 0.2 * k])
        rods.append(between(middle - way, middle + way, rng.uniform(0.035, 0.065)))
    return Scene(look([0.1, 1.3, 6.0], [0, 1.2, 0], **more), coloured([board, *rods]), FLAT)


def city(**more):
    """Towers whose windows get as small as a pixel, with roads between."""
    solids = [ground(0.0)]
    for x, z, wide, tall in ((-2.4, 0, 1.0, 2.6), (-0.8, -1.5, 1.0, 3.0), (0.9, -0.5, 0.9, 2.2), (2.4, -5, 1.2, 3.6),
                             (-0.3, -9, 1.6, 4.5)):
        tower = box((wide, tall, wide), (x, tall / 2, z), turned(0.35 * np.sign(-x)))
        for part in (5, 1 if x < 0 else 3):
            face = tower.parts[part]
            if abs(face.n[1]) > 0.5:
                continue
            side = unit(np.cross([0, 1, 0], face.n))
            middle = np.array([x, 0, z]) + face.n * wide / 2
            for row in range(int(tall / 0.28)):
                for column in (-0.32, -0.11, 0.11, 0.32):
                    low = middle + side * wide * column + np.array([0, 0.12 + 0.28 * row, 0])
                    out, up = side * wide * 0.07, np.array([0, 0.15, 0])
                    polygon(tower, part, [low - out, low + out, low + out + up, low - out + up],
                            np.array([0.08, 0.1, 0.14]))
        solids.append(tower)
    return Crowded(look([0.4, 2.9, 7.5], [0, 1.2, 0], **more), coloured(solids), FLAT)


def stairs(**more):
    """Steps whose risers and treads are three to eight pixels high."""
    steps = [box((2.2 - 0.05 * k, 0.11, 3.0 - 0.3 * k), (-0.2, 0.055 + 0.11 * k, -0.15 * k), turned(0.25))
             for k in range(9)]
    return Scene(look([0.6, 1.9, 6.5], [0, 0.5, 0], **more), coloured([ground(0.0), *steps]), FLAT)


def railing(**more):
    """Bars two to four pixels wide with as much between them."""
    bars = [box((0.05, 0.9, 0.05), (-2.1 + 0.17 * k, 0.5, 0.4 - 0.1 * k), np.eye(3)) for k in range(25)]
    rail = between((-2.2, 1.0, 0.5), (2.2, 1.0, -2.1), 0.09)
    return Scene(look([0.3, 1.3, 5.5], [0, 0.6, 0], **more), coloured([ground(0.0), *bars, rail]), FLAT)


def collars(**more):
    """Columns with collars two to eight pixels wide that stand out by half a pixel to four."""
    columns = [((-1.7, 0, 0), (0, 1, 0), 0.42, 2.1, ((0.2, 0.03, 0.02), (0.5, 0.06, 0.06), (0.9, 0.1, 0.03),
                                                     (1.25, 0.04, 0.04), (1.33, 0.04, 0.04), (1.7, 0.12, 0.07))),
               ((0, 0, -0.3), (0.15, 1, 0.1), 0.3, 2.2, ((0.3, 0.05, 0.01), (0.8, 0.05, 0.03), (1.3, 0.05, 0.05),
                                                         (1.8, 0.05, 0.09))),
               ((0.8, 0.9, 0.4), (1, 0.15, 0.45), 0.28, 1.6, ((0.2, 0.06, 0.05), (0.5, 0.03, 0.03), (0.9, 0.1, 0.05),
                                                              (1.3, 0.05, 0.01)))]
    return Scene(look([0.1, 1.8, 6.0], [0, 0.95, 0], **more),
                 coloured([ground(0.0), *(solid for one in columns for solid in column(*one))]), FLAT)


def louvres(**more):
    """Upright slats in a row that runs away from the eye, under a rail: gaps of eight pixels to none."""
    slats = [box((0.5, 1.9, 0.03), (-1.9 + 0.16 * k, 1.05, 1.4 - 0.42 * k), turned(0.9 + 0.01 * k)) for k in range(17)]
    rail = box((0.08, 0.08, 9), (-0.5, 2.05, -2.0), turned(-0.364))
    return Scene(look([-0.9, 1.5, 6.0], [-0.4, 1.0, 0], **more), coloured([ground(0.0), *slats, rail]), FLAT)


def spiral(**more):
    """Wedges three to seven pixels high about a column."""
    turns = np.arange(8) * np.pi / 4
    solids = [ground(0.0), shapes.prism(0.14 * np.stack([np.cos(turns), np.sin(turns)], 1), 2.6, (0, 1.3, 0),
                                        turned(0, np.pi / 2))]
    wedge = [(0.02, -0.05), (1.15, -0.2), (1.15, 0.2), (0.02, 0.05)]
    solids += [shapes.prism(wedge, 0.07, (0, 0.12 + 0.12 * k, 0), turned(0.35 * k + 0.3) @ turned(0, np.pi / 2))
               for k in range(20)]
    return Scene(look([0.2, 2.6, 6.0], [0, 1.1, 0], **more), coloured(solids), FLAT)


def discs(**more):
    """Round plates close before one another, whose rims leave crescents of one to four pixels."""
    solids, z = [box((6, 4, 0.1), (0, 1.2, -1.6), turned(0))], -1.0
    for x, y, radius, before in ((-1.2, 1.2, 0.9, 0), (-1.16, 1.22, 0.9, 0.2), (-0.9, 1.0, 0.6, 0.1),
                                 (-0.85, 1.03, 0.6, 0.02), (0.9, 1.5, 0.7, 0.3), (0.95, 1.46, 0.66, 0.03),
                                 (1.0, 1.4, 0.6, 0.2), (0.3, 0.5, 0.5, 0.3), (0.9, 0.45, 0.5, 0.02),
                                 (0, 2.0, 0.4, 0.15), (0.05, 2.0, 0.37, 0.1)):
        z += before + 0.015
        solids.append(cone((x, y, z - 0.015), (0, 0, 1), radius, radius, 0.015))
    return Scene(look([0.15, 1.25, 6.0], [0, 1.2, 0], roll=0.05, **more), coloured(solids), FLAT)


def spots(**more):
    """Rows of equal round spots, dark and light, each at another place of its pixel."""
    wall, rng, groups = box((9, 7, 0.2), (0, 0, -0.1), turned(0)), np.random.default_rng(7), []
    wall.color, front = np.array([0.35, 0.4, 0.3]), max(range(6), key=lambda part: wall.parts[part].n[2])
    for row, radius in enumerate((1.75, 2.0, 2.5, 3.0, 3.5, 4.0)):
        for side, color in ((-1, (0.05, 0.05, 0.06)), (1, (0.9, 0.88, 0.8))):
            middle = [np.array([side * (0.4 + 0.36 * k), 1.9 - 0.75 * row, 0]) for k in range(7)]
            middle = [at + (*rng.uniform(-0.01, 0.01, 2), 0) for at in middle]
            groups.append((np.array(middle), radius))
            for at in middle:
                disc(wall, front, at, radius / 60, np.array(color))
    scene = Crowded(look([0, 0, 6], [0, 0, 0], **more), [wall], FLAT)
    scene.spots = [(np.stack(scene.camera.project(at, scene.size)[:2], 1), radius) for at, radius in groups]
    return scene


def tips(**more):
    """Cones, blunt to like a needle, that point at the eye, aside and away."""
    cones = [cone((x, y, 0), unit(way), radius, 0.0, tall) for x, y, way, radius, tall in (
        (-2, 0.5, (0.1, 1, 0.3), 0.5, 0.9), (-0.9, 0.6, (0.2, 0.3, 1), 0.6, 0.7),
        (0.3, 0.5, (-0.2, 0.25, 0.8), 0.45, 1.3), (1.2, 0.4, (0.3, 1, -0.4), 0.4, 1.2),
        (2.5, 0.7, (-1, 0.4, 0.1), 0.25, 0.85), (-1.7, 1.9, (1, -0.25, 0.2), 0.35, 1.2),
        (0.1, 2.1, (0.1, -1, 0.1), 0.4, 0.8), (1.4, 1.9, (0, -0.2, 1), 0.55, 0.25))]
    return Scene(look([0.1, 1.4, 6.0], [0, 1.1, 0], **more), coloured([ground(-0.3), *cones]), FLAT)


def balls(**more):
    """Balls that touch one another, and sink into the floor and a wall."""
    places = ((-1.9, 0.1, 0.3, 0.5), (-1.2, 0.25, 0.8, 0.4), (-0.55, 0.35, 0.35, 0.45), (0.2, -0.2, 0.6, 0.6),
              (0.75, 0.5, -0.6, 0.5), (1.35, 0.4, 0.2, 0.4), (1.35, 1.15, 0.2, 0.35), (2.1, 0.05, 0.9, 0.35),
              (-0.9, 1.25, -0.7, 0.4), (-1.6, 1.0, -0.6, 0.3))
    return Scene(look([0.2, 2.3, 6.0], [0, 0.55, 0], **more),
                 coloured([ground(0.0), box((5.6, 1.2, 0.4), (0, 0.6, -0.9), turned(0.08)),
                           *(ball(place[:3], place[3]) for place in places)]), FLAT)


def basalt(**more):
    """Columns of six sides and of one colour side by side, whose tops differ by up to ten pixels."""
    turns, rng, solids = np.arange(6) * np.pi / 3, np.random.default_rng(3), []
    for i in range(-4, 5):
        for j in range(4):
            tall = 0.5 + 0.45 * rng.random() - 0.12 * j
            ring = 0.2991 * np.stack([np.cos(turns), np.sin(turns)], 1)
            solids.append(shapes.prism(ring, tall, (0.45 * i, tall / 2, np.sqrt(3) * 0.3 * (j + 0.5 * (i % 2)) - 0.8),
                                       turned(0, np.pi / 2)))
            solids[-1].color = np.array([0.5, 0.48, 0.45])
    return Scene(look([0.3, 2.6, 5.6], [0, 0.5, 0], **more), solids, FLAT)


# Of meshes


def leaf(centre, turn, size):
    """A flat leaf with two points, and the card that it is cut out of."""
    centre, thick = np.asarray(centre, float), 1e-5
    one, two, out = turn.T
    parts = [Cone(centre + sign * 0.6 * size * one, out, size, 0.0, 0, 1) for sign in (-1, 1)]
    rings = [part.ring(0.0) for part in parts]
    parts += [HalfSpace(sign * out, sign * out @ centre + thick) for sign in (-1, 1)]
    corners = [centre + size * (0.7 * a * one + b * two) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Solid(parts, rings, (centre, size)), quad(corners)


def leaves(**more):
    """Leaves cut out of cards by alpha, that lie over each other, some only a few pixels wide."""
    rng = np.random.default_rng(8)
    found = [leaf(rng.uniform((-1.6, 0.2, -1), (1.6, 2.2, 1)), turned(*rng.uniform(-0.8, 0.8, 2), rng.uniform(0, 3)),
                  rng.uniform(0.15, 0.5)) for _ in range(22)]
    wall = box((6, 4, 0.1), (0, 1.2, -2.5), turned(0.1))
    solids = coloured([wall, *(solid for solid, _ in found)])
    return Told(look([0.1, 1.3, 6.0], [0, 1.2, 0], **more), solids, FLAT,
                drawn=[hull((6, 4, 0.1), (0, 1.2, -2.5), turned(0.1))], cards=[card for _, card in found])


def bevels(**more):
    """Boxes with edges that are rounded off by one face, by three and by five: near, and so far that it is an edge."""
    boxes = [bevelled((1.5, 1.1, 1.2), (-1.0, 0.55, 0.4), turned(0.5), 0.18, 1),
             bevelled((1.0, 1.6, 0.9), (0.7, 0.8, -0.6), turned(-0.4), 0.025, 1),
             bevelled((1.0, 0.8, 1.0), (1.8, 0.4, 0.5), turned(0.7), 0.022, 3),
             bevelled((0.9, 1.2, 0.9), (-2.0, 0.6, -1.6), turned(0.2), 0.03, 5)]
    return Told(look([0.4, 2.3, 6.0], [0.1, 0.6, 0], **more), coloured(boxes), FLAT)


def facets(**more):
    """Rocks with faces of all bends."""
    rocks = [rock((-1.0, 0.9, 0.2), 0.9, 1), rock((1.1, 0.8, -0.2), 0.8, 2, 0.14), rock((0.3, 0.4, 1.5), 0.35, 3)]
    return Told(look([0.2, 1.7, 6.0], [0.1, 0.8, 0], **more), coloured(rocks), FLAT)


def elbow(**more):
    """Pipes of eight sides that bend by more and by less than a crease."""
    pipes = [tube([(-2, 0.4, 0), (-0.9, 0.45, 0.1)], 0.3, (30, 26, 15, 26, 35), 0.55),
             tube([(-1.8, 1.9, -0.5), (-1.0, 1.9, -0.4)], 0.22, (-10, -14, -18, -26, -32, -10), 0.5)]
    return Told(look([0.3, 1.5, 6.0], [0.2, 1.0, 0], **more), coloured(pipes), FLAT)


def through(**more):
    """Meshes that stand in each other, and pieces of one mesh that do."""
    block = hull((1.4, 1.4, 1.0), (-1.0, 0.7, 0.1), turned(0.4))
    rod = hull((0.35, 0.35, 2.6), (-0.9, 0.8, 0.2), turned(0.9, 0.2))
    cross = joined(hull((0.5, 2.0, 0.5), (1.2, 1.0, -0.2), turned(0.3)), hull((1.8, 0.4, 0.4), (1.2, 1.2, -0.1),
                                                                               turned(-0.2, 0.0, 0.25)))
    floor = hull((7, 0.4, 6), (0, -0.05, 0), turned(0.05))
    return Told(look([0.3, 2.2, 6.0], [0.1, 0.7, 0], **more), coloured([floor, block, rod, cross]), FLAT)


def coincident(**more):
    """Boxes that share planes, so that a renderer shows now one of them, now the other."""
    boxes = [hull((1.4, 1.2, 0.8), (-0.8, 0.6, 0), turned(0)), hull((1.4, 0.8, 0.8), (0.2, 0.8, 0), turned(0)),
             hull((0.6, 0.6, 0.8), (1.2, 0.3, 0), turned(0)), hull((0.5, 0.3, 0.5), (-0.9, 1.35, 0), turned(0)),
             hull((0.5, 0.3, 0.5), (1.15, 0.75, 0.15), turned(0))]
    return Told(look([1.6, 2.0, 5.6], [0.1, 0.7, 0], **more), coloured(boxes), FLAT)


def bolts(**more):
    """A plate with a step, a hole's rim and bolts with six sides that are ten to twenty pixels wide."""
    heads = [prism(6, 0.12 + 0.02 * (k % 3), 0.14, (-1.3 + 0.65 * (k % 5), 0.37, 0.9 - 0.9 * (k // 5)), 0.3 * k)
             for k in range(10)]
    ring = grown(20, 0.55, 0.35, 0.3, (0.1, 0.3, -1.3))
    plate = hull((3.8, 0.3, 3.0), (0, 0.15, 0.0), turned(0.1))
    return Told(look([0.5, 3.0, 5.6], [0.1, 0.3, 0], **more), coloured([plate, *heads, ring]), FLAT)


def gears(**more):
    """Toothed wheels with a hole, that nearly mesh; their teeth are eight to fourteen pixels wide."""
    turn = turned(0.25, 0.15)
    wheels = [wheel(14, 1.1, 0.16, 0.3, (-0.75, 1.2, 0), turn),
              wheel(9, 0.72, 0.16, 0.3, np.array((-0.75, 1.2, 0)) + turn @ (1.72, 0.05, 0), turn, np.pi / 9),
              wheel(20, 0.9, 0.12, 0.2, (1.0, 1.7, -1.3), turned(-0.3, 0.2))]
    return Told(look([0.1, 1.5, 6.0], [0, 1.2, 0], **more), coloured(wheels), FLAT)


def lattice(**more):
    """The bars of windows, three to six pixels wide, that cross in one plane, and a box behind."""
    grids = [grid(2.2, 2.0, 5, 4, 0.06, (-1.0, 1.2, 0.2), turned(0.5, 0.1, 0.1)),
             grid(2.0, 1.9, 4, 6, 0.09, (1.3, 1.3, -0.4), turned(-0.7, -0.1, -0.05))]
    return Told(look([0.1, 1.4, 6.0], [0, 1.2, 0], **more),
                coloured([*grids, hull((1.5, 1.2, 0.6), (-0.2, 1.1, -1.6), turned(0.3, 0.2))]), FLAT)


def corrugated(**more):
    """Sheets folded to and fro by 35 to 80 degrees, with folds five to twelve pixels apart."""
    sheets = [zigzag(10, 0.42, 60, 1.0, (-1.3, 1.8, 0), turned(0.3, -0.35)),
              zigzag(14, 0.27, 50, 1.0, (1.2, 1.8, -0.2), turned(-0.3, -0.3, 0.1)),
              zigzag(12, 0.34, 35, 0.9, (-1.1, 0.5, 0.3), turned(0.2, -0.4)),
              zigzag(18, 0.2, 80, 0.9, (1.2, 0.5, 0.3), turned(-0.15, -0.5, -0.06))]
    return Told(look([0.1, 1.5, 6.0], [0, 1.2, 0], **more), coloured(sheets), FLAT)


def cloth(**more):
    """Cloths of strips one to four pixels wide, whose folds run upright and aslant."""
    def waves(strips, wide, *waves):
        u = np.linspace(0, 1, strips + 1)
        return (u - 0.5) * wide, sum(deep * np.sin(often * u + at) for deep, often, at in waves)
    cloths = [hung(*waves(70, 2.0, (0.05, 45, 0)), 1.7, (-1.2, 1.25, 0), turned(0.3, -0.15), 0.01),
              hung(*waves(60, 2.1, (0.07, 30, 0.6), (0.02, 67, 0)), 1.3, (1.2, 1.25, 0), turned(0.1, 0, 0.7), 0.01)]
    return Told(look([0.1, 1.5, 6.0], [0, 1.25, 0], **more), coloured(cloths), FLAT)


def flush(**more):
    """Pieces of one mesh that share planes: a frame of bars, letters of strokes, steps, a rod through a plate, a row of
    copies that touch, a tube of two closed halves."""
    def placed(at, turn, *pieces):
        mesh = joined(*pieces)
        points = (np.asarray(at, float) + mesh.points @ turn.T).astype(np.float32)
        return Mesh(points.astype(float), mesh.faces, piece=mesh.piece)

    def bar(x0, y0, x1, y1, deep=0.16):
        return hull((x1 - x0, y1 - y0, deep), ((x0 + x1) / 2, (y0 + y1) / 2, 0), np.eye(3))

    def half(sign):
        a = sign * np.pi * np.arange(6) / 5
        ring = np.stack([0.4 * np.cos(a), 0 * a, 0.4 * np.sin(a)], 1)
        n = len(ring)
        sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
        return outward(Mesh(np.concatenate([ring, ring + (0, 0.9, 0)]),
                            [*sides, [*range(n)][::-1], [*range(n, 2 * n)]]))

    frame = [bar(0, 0, 0.15, 1.1), bar(1.15, 0, 1.3, 1.1), bar(0, 0.2, 1.3, 0.36), bar(-0.1, 0.6, 1.22, 0.74),
             bar(0.08, 0.95, 1.3, 1.1)]
    word = [bar(0, 0, 0.17, 0.9), bar(0, 0.73, 0.6, 0.9), bar(0.1, 0.37, 0.5, 0.53), bar(0.75, 0, 0.92, 0.9),
            bar(1.2, 0, 1.37, 0.9), bar(0.75, 0.37, 1.37, 0.53)]
    steps = [hull((1.0 - 0.3 * k, 0.3, 0.9), (-0.15 * k, 0.15 + 0.3 * k, 0), np.eye(3)) for k in range(3)]
    row = [hull((0.22, 0.42 + 0.1 * (k % 2), 0.36), (0.22 * k, 0.21 + 0.05 * (k % 2), 0), np.eye(3)) for k in range(6)]
    plate = [hull((1.2, 0.14, 0.8), (0, 0.07, 0), np.eye(3)), prism(7, 0.15, 0.7, (-0.3, 0, 0.05), 0.3),
             prism(9, 0.17, 0.14, (0.28, 0, 0), 0.1)]
    meshes = [placed((-2.0, 1.3, 0), turned(0.35, -0.1), *frame), placed((0.2, 1.4, -0.3), turned(-0.3, 0.15), *word),
              placed((-1.5, -0.1, 0.5), turned(0.6), *steps), placed((-0.45, 0.1, 0.9), turned(0.2), *row),
              placed((1.65, 0.3, 0.3), turned(0.4, 0.3), *plate),
              placed((0.5, 0.5, -0.5), turned(0.8, 0, 0.1), half(1), half(-1))]
    return Told(look([0.3, 2.4, 5.8], [0, 0.85, 0], **more), coloured(meshes), FLAT)


ANALYTIC = {f.__name__: f for f in (tops, shadows, wires, hairs, city, stairs, railing, collars, louvres, spiral, discs,
                                    spots, tips, balls, basalt)}
MESHES = {f.__name__: f for f in (leaves, bevels, facets, elbow, through, coincident, bolts, gears, lattice,
                                  corrugated, cloth, flush)}
MOVED = {"leaves", "bevels", "facets", "elbow", "through", "coincident", "bolts", "tops", "shadows", "collars",
         "louvres"}
SHIFTS = (0.0, 0.0), (0.25, 0.375), (0.5, 0.125), (0.71, 0.62)  # pixels
