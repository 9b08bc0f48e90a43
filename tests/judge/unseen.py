# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that nothing was tuned on: written, with all their sizes, seeds and cameras, on 28 November 2026, before
anything was measured on them, and since changed only where a scene itself was wrong. Who cures what they show must say
so in helpers/pages.py: they are unseen no more then. Each takes a shift in pixels; of the last five our rasteriser
tells."""

from functools import cached_property

import numpy as np
from reference import near

from . import shapes
from .camera import look
from .kinds import CROWD, FLAT, between, coloured
from .meshes import Mesh
from .meshes import box as hull
from .scene import OUTLINE, Light, Scene
from .scenes import turned
from .shapes import HalfSpace, Patch, across, ball, band, box, cap, circle, cone, disc, ground, polygon, segment, unit
from .told import Told, bevelled, joined, outward, prism

SEED = 20261128
UP = np.array([0.0, 1.0, 0.0])
INK, CREAM, BRICK = (np.array(c) for c in ((0.06, 0.08, 0.16), (0.8, 0.76, 0.62), (0.55, 0.16, 0.1)))


class Apart(Scene):
    """Round things that only touch, or are told where they meet; flat ones may cut into each other."""

    def _crossings(self):
        every, round_ones = self.solids, [not all(isinstance(part, HalfSpace) for part in s.parts) for s in self.solids]
        self.solids = [s for s, is_round in zip(every, round_ones, strict=True) if not is_round]
        try:
            curves = super()._crossings()
        finally:
            self.solids = every
        grounds = [s for s in every if s.reach is None]
        return curves + [curve for s, is_round in zip(every, round_ones, strict=True) if is_round
                         for floor in grounds for curve in shapes.meet(s, floor)]


class Painted(Apart):
    """Likewise, with colours that lie close together: their lines may thin out, as in Crowded, but what bends may
    not."""

    @cached_property
    def truth(self):
        truth = super().truth
        some = np.flatnonzero((truth.color >= 0.12) & (truth.angle < 8) & (truth.depth < OUTLINE))
        every = np.stack([truth.x, truth.y], 1)
        i, j = near.pairs(every[some], every[::2], CROWD)
        i, j = some[i], 2 * j
        dx, dy = (every[j] - every[i]).T
        across = np.abs(dx * truth.nx[i] + dy * truth.ny[i])
        along = np.abs(dy * truth.nx[i] - dx * truth.ny[i])
        level = np.abs(truth.nx[i] * truth.nx[j] + truth.ny[i] * truth.ny[j]) > 0.9
        truth.narrow[i[level & (across > 1.2) & (along < 1.5)]] = True
        return truth


def ringed(solid, height, radius):
    """A solid that another meets in an upright axis' ring."""
    centre = np.array([solid.reach[0][0], height, solid.reach[0][2]])
    solid.edges.append(circle(centre, UP, radius))
    return solid


def flute(solid, low, high, color):
    """On a cone's side: between two angles about its axis."""
    side = solid.parts[0]
    one, two = across(side.axis)

    def inside(p):
        turn = np.arctan2((p - side.centre) @ two, (p - side.centre) @ one) % (2 * np.pi)
        return (turn > low) & (turn < high)
    outs = [np.cos(a) * one + np.sin(a) * two for a in (low, high)]
    solid.patches.append(Patch(0, inside, color, [segment(side.on(out, side.near), side.on(out, side.far))
                                                  for out in outs]))


# By formula


def coins(**more):
    """Stacks of coins two to six pixels thick, none quite upon the one below it, and three that lie or stand alone."""
    rng, solids = np.random.default_rng(SEED), [ground(0.0)]
    for x, z, radius, thick, count in ((-1.7, 0.3, 0.5, 0.06, 9), (-0.5, -0.6, 0.42, 0.045, 16),
                                       (0.6, 0.5, 0.55, 0.1, 6), (1.75, -0.3, 0.36, 0.035, 22)):
        for k in range(count):
            dx, dz = rng.uniform(-0.03, 0.03, 2)
            solids.append(cone((x + dx, k * thick, z + dz), UP, radius, radius, thick))
    solids += [cone((-0.7, 0, 1.4), UP, 0.5, 0.5, 0.035), cone((1.8, 0, 1.1), UP, 0.42, 0.42, 0.05),
               cone((-2.5, 0.36, -0.9), unit([0.5, 0.12, 1.0]), 0.4, 0.4, 0.05)]
    return Painted(look([0.2, 2.2, 6.0], [0, 0.4, 0], **more), coloured(solids), FLAT)


def net(**more):
    """A net of cords under two pixels thick, twelve pixels apart, with its band, before a wall."""
    turn, middle = turned(0.3), np.array([0.1, 0.9, 0.3])

    def at(x, y, z):
        return middle + turn @ np.array([x, y, z])
    cords = [between(at(x, -0.72, 0), at(x, 0.5, 0), 0.03) for x in np.arange(-2.3, 2.31, 0.2)]
    cords += [between(at(-2.4, y, 0.035), at(2.4, y, 0.035), 0.028) for y in np.arange(-0.7, 0.41, 0.2)]
    tape = box((4.8, 0.14, 0.08), at(0, 0.57, 0), turn)
    posts = [cone(at(x, -0.9, 0) * (1, 0, 1), UP, 0.06, 0.06, 1.7) for x in (-2.55, 2.55)]
    wall = box((9, 1.9, 0.2), (0.3, 0.95, -2.2), turned(-0.1))
    return Painted(look([0.1, 1.5, 6.0], [0, 0.95, 0], **more),
                   coloured([ground(0.0), wall, *cords, tape, *posts]), FLAT)


def mullions(**more):
    """A window with the sun behind it: its bars, and what they throw on the floor, are two to four pixels wide."""
    wall = [box((2.2, 3.2, 0.24), (-2.6, 1.6, -1.0), turned(0)), box((2.4, 3.2, 0.24), (2.3, 1.6, -1.0), turned(0)),
            box((2.7, 0.6, 0.22), (-0.2, 0.3, -1.0), turned(0)), box((2.7, 0.9, 0.22), (-0.2, 2.75, -1.0), turned(0))]
    bars = [box((wide, 1.8, 0.05), (x, 1.45, -1.0), turned(0))
            for x, wide in ((-1.0, 0.03), (-0.47, 0.07), (0.06, 0.03), (0.6, 0.04))]
    bars += [box((2.7, tall, 0.09), (-0.2, y, -1.0), turned(0))
             for y, tall in ((0.95, 0.035), (1.4, 0.06), (1.9, 0.03))]
    poles = [between((1.7, -0.01, 0.4), (1.75, 1.3, 0.35), 0.04), between((-2.2, -0.01, 0.9), (-1.9, 1.0, 0.3), 0.035)]
    light = Light(unit([0.3, 0.75, -0.75]), sun=0.9, ambient=0.2)
    solids = coloured([ground(0.0), *wall, *bars, *poles])
    return Painted(look([0.3, 2.0, 6.0], [-0.1, 1.0, 0], **more), solids, light)


def vases(**more):
    """Painted ware: rings on a belly, bands on a jar, and upright stripes on a beaker, three to twelve pixels wide."""
    belly = ball((-1.4, 0.95, 0), 0.75)
    way = unit([0.15, 1.0, 0.1])
    for k, level in enumerate((-0.55, -0.4, -0.3, -0.05, 0.0, 0.05, 0.3, 0.5, 0.6, 0.68)):
        cap(belly, way, level, (INK, CREAM, BRICK, CREAM)[k % 4])
    high = np.sqrt(0.75**2 - 0.3**2)
    ringed(ringed(belly, 0.95 + high, 0.3), 0.95 - high, 0.3)
    ware = [belly, cone((-1.4, 0, 0), UP, 0.3, 0.3, 0.4), cone((-1.4, 1.5, 0), UP, 0.3, 0.3, 0.35),
            cone((-1.4, 1.85, 0), UP, 0.3, 0.48, 0.16)]
    low, jar, neck = (cone((0.4, foot, -0.4), UP, *r) for foot, *r in ((0, 0.35, 0.6, 0.7), (0.7, 0.6, 0.42, 1.0),
                                                                       (1.7, 0.42, 0.42, 0.3)))
    for k in range(6):
        band(jar, 0.06 + 0.15 * k, 0.06 + 0.15 * k + 0.02 + 0.016 * k, (INK, BRICK)[k % 2])
    band(low, 0.3, 0.36, INK)
    beaker = cone((1.8, 0, 0.4), UP, 0.38, 0.52, 1.1)
    for k in range(14):
        flute(beaker, (k + 0.1) * np.pi / 7, (k + 0.1 + 0.3 + 0.03 * k) * np.pi / 7, (INK, BRICK)[k % 2])
    solids = coloured([ground(0.0), *ware, low, jar, neck, beaker])
    return Painted(look([0.2, 2.7, 6.0], [0.1, 0.95, 0], **more), solids, FLAT)


def keys(**more):
    """The keys of a typewriter: round caps with a rim of two pixels, on stalks of two, in four rows."""
    body = [box((4.6, 0.3, 2.4), (0, 0.15, 0.5), turned(0)), box((4.6, 0.9, 0.9), (0, 0.45, -1.2), turned(0))]
    solids, way = [ground(0.0), *body], unit([0.0, 1.0, 0.3])
    for row in range(4):
        for column in range(10):
            foot = np.array([-1.95 + 0.42 * column + 0.1 * row, 0.62 + 0.16 * (3 - row), -0.35 + 0.45 * row])
            key = cone(foot, way, 0.15, 0.13, 0.05)
            disc(key, 2, foot + 0.05 * way, 0.1, (INK, CREAM)[(row + column) % 2])
            solids += [between((foot[0], 0.25, foot[2] - 0.1), foot, 0.035), key]
    return Painted(look([0.3, 3.0, 5.6], [0, 0.6, 0.2], **more), coloured(solids), FLAT)


def ladder(**more):
    """A ladder against a roof with battens two pixels high; its shadow lies on the ground."""
    turn, middle = turned(-np.pi / 2 + 0.35), np.array([0.4, 0.7, -0.9])
    house = shapes.prism([(-1.2, -0.7), (1.2, -0.7), (1.2, 0.3), (0, 1.2), (-1.2, 0.3)], 2.8, middle, turn)
    slope = turn @ np.stack([[-0.8, 0.6, 0], [0.6, 0.8, 0], [0, 0, -1.0]], 1)
    battens = [box((0.05, 0.06, 2.7), middle + turn @ np.array([1.2 - 1.2 * t, 0.3 + 0.9 * t, 0]), slope)
               for t in np.arange(1, 11) / 11]
    foot, head = np.array([-1.35, 0.0, 2.0]), np.array([-0.55, 2.0, 0.0])
    aside = np.array([0.27, 0.0, 0.108])
    rails = [between(foot + side * aside - 0.01 * (head - foot), head + side * aside, 0.05) for side in (-1, 1)]
    rungs = [between(at - aside, at + aside, 0.03) for at in (foot + (head - foot) * t for t in np.arange(1, 13) / 13)]
    light = Light(unit([-0.45, 0.7, 0.55]), sun=0.9, ambient=0.2)
    return Scene(look([-0.4, 2.2, 6.2], [0.1, 0.95, 0], **more),
                 coloured([ground(0.0), house, *battens, *rails, *rungs]), light)


def piece(x, z, size, kind):
    """A turned piece of chess: frusta upon each other, and a ball or a cylinder on top."""
    profile = [(0.28, 0.28, 0.06), (0.25, 0.18, 0.07), (0.16, 0.1, 0.4 + 0.25 * kind), (0.19, 0.17, 0.04),
               (0.12, 0.14, 0.05)]
    solids, y = [], 0.1
    for low, high, tall in profile:
        solids.append(cone((x, y, z), UP, size * low, size * high, size * tall))
        y += size * tall
    if kind == 1:
        return [*solids, cone((x, y, z), UP, size * 0.17, size * 0.2, size * 0.22)]
    radius, sunk = size * 0.16, size * 0.1
    top = ringed(ball((x, y + sunk, z), radius), y, np.sqrt(radius**2 - sunk**2))
    return [*solids, top] if kind == 0 else [*solids, ringed(top, y + sunk + np.sqrt(radius**2 - (size * 0.06)**2),
                                                            size * 0.06),
                                             cone((x, y + sunk + radius * 0.8, z), UP, size * 0.06, size * 0.06,
                                                  size * 0.12)]


def chess(**more):
    """Turned pieces, near and far, on a board whose squares are a few pixels high at the back."""
    board, wide = box((4.8, 0.1, 4.8), (0, 0.05, -0.6), turned(0)), 0.55
    for i in range(8):
        for j in range(i % 2, 8, 2):
            x, z = -4 * wide + i * wide, -0.6 - 4 * wide + j * wide
            polygon(board, 2, [(x, 0.1, z), (x + wide, 0.1, z), (x + wide, 0.1, z + wide), (x, 0.1, z + wide)], INK)
    places = ((-1.6, 0.9, 1.1, 0), (-0.5, 0.35, 1.2, 2), (0.8, 0.9, 1.1, 1), (1.7, -0.3, 1.0, 0), (0.3, -1.2, 1.0, 2),
              (-1.1, -1.7, 0.9, 1), (1.4, -2.2, 0.9, 0), (-1.9, -2.4, 0.8, 0))
    solids = [ground(0.0), board, *(solid for place in places for solid in piece(*place))]
    solids = coloured(solids)
    board.color = CREAM
    return Painted(look([0.3, 1.9, 6.0], [0, 0.55, 0], **more), solids, FLAT)


# Of meshes


def placed(mesh, at, turn):
    return Mesh(np.asarray(at, float) + mesh.points @ turn.T, mesh.faces, piece=mesh.piece)


def lathe(profile, sides):
    """Turned about the y axis from points (radius, height); where the radius is 0 is a point. The last may be the
    first."""
    turns, points, rows = np.arange(sides) * 2 * np.pi / sides, [], []
    for k, (radius, y) in enumerate(profile):
        if k and (radius, y) == profile[0]:
            rows.append(rows[0])
            continue
        count = sides if radius else 1
        rows.append([len(points) + k % count for k in range(sides)])
        points += [(radius * np.sin(a), y, radius * np.cos(a)) for a in turns[:count]]
    faces = []
    for low, high in zip(rows, rows[1:], strict=False):
        for k in range(sides):
            face = [low[k], low[(k + 1) % sides], high[(k + 1) % sides], high[k]]
            face = [p for i, p in enumerate(face) if p != face[i - 1]]
            faces += [face] if len(face) > 2 else []
    return outward(Mesh(np.array(points), faces))


def rod(a, b, radius, sides=4):
    a, b = np.asarray(a, float), np.asarray(b, float)
    one, two = across(unit(b - a))
    turns = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    ring = radius * (np.cos(turns)[:, None] * one + np.sin(turns)[:, None] * two)
    faces = [[k, (k + 1) % sides, sides + (k + 1) % sides, sides + k] for k in range(sides)]
    return outward(Mesh(np.concatenate([a + ring, b + ring]),
                        [*faces, [*range(sides)][::-1], [*range(sides, 2 * sides)]]))


def umbrella(**more):
    """An umbrella of nine gores seen from within, with ribs of two pixels, stretchers and a stick; one seen from
    above."""
    sides = 9
    outer = [(1.3, 0.0), (1.1, 0.3), (0.7, 0.58), (0.0, 0.75)]
    inner = [(0.0, 0.73), (0.69, 0.56), (1.08, 0.29), (1.28, 0.0)]
    canopy = lathe([*outer, *inner, outer[0]], sides)
    turns = np.arange(sides) * 2 * np.pi / sides
    outs = np.stack([np.sin(turns), 0 * turns, np.cos(turns)], 1)
    ribs = [rod(r * out + y * UP, s * out + z * UP, 0.016) for out in outs
            for (r, y), (s, z) in (((0.05, 0.69), (0.66, 0.52)), ((0.66, 0.52), (1.03, 0.26)))]
    stretchers = [rod(0.05 * out + 0.1 * UP, 0.66 * out + 0.5 * UP, 0.014) for out in outs]
    stick = rod((0, -1.2, 0), (0, 0.72, 0), 0.035, 8)
    frame = joined(stick, lathe([(0, 0.05), (0.08, 0.05), (0.08, 0.15), (0, 0.15)], 9), *ribs, *stretchers)
    meshes = [placed(canopy, (-0.9, 1.3, 0), turned(0.5, -1.0)), placed(frame, (-0.9, 1.3, 0), turned(0.5, -1.0)),
              placed(canopy, (1.5, 0.6, -0.4), turned(0.2, 0.5, -0.1))]
    return Told(look([0.1, 1.5, 6.0], [0, 1.1, 0], **more), coloured(meshes), FLAT)


def blade(length, sections, twist):
    """A twisted blade along x, thin at both its edges, of triangles."""
    points, faces = [], []
    for t in np.linspace(0, 1, sections):
        chord, thick = 0.24 - 0.12 * t + 0.1 * np.sin(np.pi * t), 0.05 * (1 - 0.7 * t)
        angle = twist * (1 - t) + 0.3
        for u, v in ((chord, 0), (0.2 * chord, thick), (-chord, 0), (0.2 * chord, -thick)):
            points.append((0.15 + length * t, u * np.cos(angle) - v * np.sin(angle),
                           u * np.sin(angle) + v * np.cos(angle)))
    for k in range(sections - 1):
        for j in range(4):
            a, b, c, d = 4 * k + j, 4 * k + (j + 1) % 4, 4 * k + 4 + (j + 1) % 4, 4 * k + 4 + j
            faces += [[a, b, c], [a, c, d]]
    last = 4 * (sections - 1)
    return outward(Mesh(np.array(points), [*faces, [3, 2, 1], [3, 1, 0], [last, last + 1, last + 2],
                                           [last, last + 2, last + 3]]))


def propeller(**more):
    """Three twisted blades of triangles, whose edges are slivers, in a spinner, before a ring of flat faces."""
    turn = turned(0.45, 0.1)
    blades = joined(*(placed(blade(1.35, 10, 0.9), (0, 0, 0), turned(0, 0, 0.35 + k * 2 * np.pi / 3))
                      for k in range(3)))
    spinner = placed(lathe([(0, -0.25), (0.3, -0.25), (0.3, 0.0), (0.27, 0.2), (0.18, 0.4), (0, 0.5)], 18), (0, 0, 0),
                     turned(0, np.pi / 2))
    ring = placed(lathe([(0.62, -0.9), (0.75, -0.85), (0.75, -0.55), (0.62, -0.5), (0.56, -0.6), (0.62, -0.9)], 28),
                  (0, 0, 0), turned(0, np.pi / 2))
    meshes = [placed(mesh, (0, 1.2, 0), turn) for mesh in (blades, spinner, ring)]
    return Told(look([0.1, 1.4, 5.6], [0, 1.2, 0], **more), coloured(meshes), FLAT)


def cells(columns, rows, size, wall, deep):
    """A comb of six-sided cells, the walls between them `wall` thick, open through and through."""
    turns, points, known, faces = (np.arange(6) + 0.5) * np.pi / 3, [], {}, []
    corners, rims = np.stack([np.cos(turns), np.sin(turns)], 1) * size, 1 - wall / (np.sqrt(3) * size)

    def point(x, y, z):
        key = round(x, 6), round(y, 6), z
        if key not in known:
            known[key] = len(points)
            points.append((x, y, z))
        return known[key]
    sides = {}
    for i in range(columns):
        for j in range(rows):
            middle = size * np.array([np.sqrt(3) * (i + 0.5 * (j % 2) - columns / 2), 1.5 * (j - rows / 2 + 0.5)])
            for k in range(6):
                outer = [middle + corners[k], middle + corners[(k + 1) % 6]]
                rim = [middle + rims * corners[k], middle + rims * corners[(k + 1) % 6]]
                a, b, g, h = (point(*p, z) for z in (deep / 2, -deep / 2) for p in outer)
                e, f, m, n = (point(*p, z) for z in (deep / 2, -deep / 2) for p in rim)
                faces += [[a, b, f, e], [g, m, n, h], [e, f, n, m]]
                sides.setdefault(frozenset((a, b)), []).append([a, g, h, b])
    faces += [own[0] for own in sides.values() if len(own) == 1]
    return Mesh(np.array(points), faces)


def honeycomb(**more):
    """Combs of six-sided cells with walls of three pixels and of one and a half, aslant."""
    meshes = [placed(cells(5, 5, 0.26, 0.05, 0.2), (-0.8, 1.2, 0.3), turned(0.5, -0.15, 0.1)),
              placed(cells(5, 6, 0.16, 0.028, 0.3), (1.3, 1.3, -0.5), turned(-0.6, 0.1, -0.07)),
              hull((1.2, 0.9, 0.4), (0.3, 0.6, -1.6), turned(0.3))]
    return Told(look([0.1, 1.4, 6.0], [0, 1.2, 0], **more), coloured(meshes), FLAT)


def folds(count, span, low, high, half, deep):
    """The bellows of an accordion, bent about an axis along z three below: its sides are of triangles."""
    points, faces = [], []
    for k, angle in enumerate(np.linspace(-span, span, 2 * count + 1)):
        d = deep * (k % 2)
        points += [(r * np.sin(angle), r * np.cos(angle) - 3, z)
                   for r, z in ((3 + low - d, -half - d), (3 + high + d, -half - d), (3 + high + d, half + d),
                                (3 + low - d, half + d))]
    for k in range(2 * count):
        a, b = 4 * k, 4 * k + 4
        faces += [[a + 1, a + 2, b + 2, b + 1], [a + 3, a, b, b + 3]]
        faces += [[a, a + 1, b + 1], [a, b + 1, b], [a + 2, a + 3, b + 3], [a + 2, b + 3, b + 2]]
    last = 8 * count
    return outward(Mesh(np.array(points), [*faces, [3, 2, 1, 0], [last, last + 1, last + 2, last + 3]]))


def bellows(**more):
    """An accordion with folds seven pixels apart, its boxes and keys, and a concertina with folds three apart."""
    turn, at = turned(-0.25, 0.35), np.array([-0.4, 0.4, 0.2])
    ends = [placed(hull((0.35, 1.2, 1.0), (0, 3.55, 0), turned(0)), (0, -3, 0), turned(0, 0, sign * 0.505))
            for sign in (-1, 1)]
    piano = joined(*(placed(hull((0.2, 0.09 - 0.03 * (k % 2), 0.06), (0.12, 3.03 + 0.1 * k, 0.53), turned(0)),
                            (0, -3, 0), turned(0, 0, -0.505)) for k in range(11)))
    rings = [(0.42 + 0.07 * (k % 2), 0.05 * k) for k in range(21)]
    concertina = lathe([(0, -0.15), (0.45, -0.15), *rings, (0.42, 1.05), (0.46, 1.05), (0.46, 1.2), (0, 1.2)], 6)
    meshes = [placed(mesh, at, turn) for mesh in (folds(12, 0.44, 0.05, 1.0, 0.35, 0.09), *ends, piano)]
    meshes.append(placed(concertina, (1.75, 0.2, 0.9), turned(0.3, 0.2, 0.15)))
    return Told(look([0.2, 1.5, 6.0], [0.1, 0.95, 0], **more), coloured(meshes), FLAT)


def dice(**more):
    """A heap of dice with bevels from a third of a pixel to seven pixels, near and far, some with raised spots that are
    half a pixel high."""
    rng, meshes = np.random.default_rng(SEED), [hull((5.6, 0.2, 4.6), (0, -0.1, -0.6), turned(0.06))]
    for k, (x, y, z, size, radius, segments) in enumerate((
            (-1.6, 0, 1.2, 0.8, 0.12, 1), (-0.5, 0, 1.4, 0.6, 0.03, 2), (0.5, 0, 0.6, 0.9, 0.06, 3),
            (1.7, 0, 0.9, 0.7, 0.015, 1), (-1.3, 0, -0.6, 0.9, 0.02, 1), (0.45, 0.9, 0.6, 0.6, 0.05, 1),
            (1.2, 0, -1.0, 0.8, 0.05, 2), (-0.2, 0, -1.6, 0.7, 0.03, 1), (-1.25, 0.9, -0.6, 0.5, 0.08, 2),
            (2.0, 0, -2.2, 0.6, 0.006, 1))):
        turn, middle = turned(rng.uniform(-0.8, 0.8)), np.array([x, y + size / 2 + 0.003, z])
        meshes.append(bevelled((size,) * 3, middle, turn, radius, segments))
        if k not in (0, 2, 3):
            continue
        spots = [placed(prism(8, 0.075 * size, 0.02, (u * size, size / 2 - 0.01, v * size), 0.2), (0, 0, 0), way)
                 for way, places in ((turned(0, np.pi / 2), ((-0.2, -0.2), (0.2, 0.2), (0, 0))),
                                     (turned(0), ((-0.22, 0), (0.22, 0))))
                 for u, v in places]
        meshes.append(placed(joined(*spots), middle, turn))
    return Told(look([0.2, 2.4, 6.0], [0.1, 0.5, 0], **more), coloured(meshes), FLAT)


ANALYTIC = {f.__name__: f for f in (coins, net, mullions, vases, keys, ladder, chess)}
MESHES = {f.__name__: f for f in (umbrella, propeller, honeycomb, bellows, dice)}
MOVED = {"coins", "mullions", "umbrella", "dice"}
