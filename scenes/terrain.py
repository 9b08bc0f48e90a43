# SPDX-License-Identifier: GPL-3.0-or-later
"""A road through a desert at evening: dunes seen flat along the ground, stripes to the horizon, table mountains.

What is hard for lines here: ground at grazing angles, whose depth changes by metres from pixel to pixel without an
edge, stripes that shrink to nothing, and soft shades on soft shapes. The road runs along y; x is to the right.
"""

from math import cos, exp, pi, radians, sin
from random import Random

from common import (
    box,
    camera,
    group,
    lathe,
    light,
    mesh_object,
    paint,
    ramp,
    rings,
    settings,
    strands,
    text,
    tube,
    world,
)
from figures import BARE, SMALL, cat, girl
from materials import flat
from mathutils import Vector, noise

EYE = Vector((2.9, -4.6, 1.15))
FAR = 900


def colors():
    return {
        "sand": flat("Sand", (0.72, 0.42, 0.20)),
        "asphalt": flat("Asphalt", (0.26, 0.24, 0.32)),
        "white": flat("White", (0.86, 0.80, 0.70)),
        "yellow": flat("Yellow", (0.85, 0.55, 0.06)),
        "rock": flat("Rock", (0.52, 0.20, 0.12)),
        "pale rock": flat("Pale rock", (0.66, 0.30, 0.17)),
        "cactus": flat("Cactus", (0.14, 0.32, 0.16)),
        "wood": flat("Wood", (0.34, 0.21, 0.14)),
        "iron": flat("Iron", (0.07, 0.08, 0.11)),
        "leather": flat("Leather", (0.40, 0.17, 0.09)),
        "brass": flat("Brass", (0.75, 0.52, 0.20)),
        "sun": flat("Sun", (0.95, 0.55, 0.25)),
    }


def road_height(y):
    """The road dips, rises to a crest and is seen again beyond it."""
    return 1.6 * (1 - exp(-max(0, y) / 60)) * sin(y / 42) + 9 * ramp(y, 120, FAR) ** 2


def road_middle(y):
    return 14 * ramp(y, 70, 500) ** 2 * sin(y / 75)


def height(x, y):
    """Dunes that lie down beside the road."""
    away = abs(x - road_middle(y))
    dune = 5 * noise.noise((x / 34, y / 50, 0.3)) + 1.6 * noise.noise((x / 12, y / 15, 7.1)) + 1.3
    return road_height(y) - 0.06 + dune * ramp(away, 3.5, 22) * ramp(y, -30, 60) ** 0.5


def terrain(c):
    """A grid that widens with the distance, so that its faces keep about the same size in the picture."""
    rows = [-12 + 912 * (k / 240) ** 2.2 for k in range(241)]
    columns = [(k / 60 - 1) * (0.15 + 0.85 * abs(k / 60 - 1)) for k in range(121)]
    verts = []
    for y in rows:
        spread, middle = 40 + 0.9 * y, road_middle(y)
        verts += [(middle + spread * u, y, height(middle + spread * u, y)) for u in columns]
    faces = [(j * 121 + i, j * 121 + i + 1, (j + 1) * 121 + i + 1, (j + 1) * 121 + i)
             for j in range(240) for i in range(120)]
    mesh_object("Terrain", verts, faces, c["sand"], smooth=True)


def strip(name, left, right, lift, spans, material):
    """Bands along the road, `left` to `right` of its middle, over the stretches `spans`."""
    verts, faces = [], []
    for start, end in spans:
        steps = max(1, round((end - start) / 3))
        for k in range(steps + 1):
            y = start + (end - start) * k / steps
            z = road_height(y) + lift + 0.0004 * max(0, y)
            verts += [(road_middle(y) + left, y, z), (road_middle(y) + right, y, z)]
        n = len(verts) - 2 * steps - 2
        faces += [(n + 2 * k, n + 2 * k + 1, n + 2 * k + 3, n + 2 * k + 2) for k in range(steps)]
    return mesh_object(name, verts, faces, material)


def road(c):
    strip("Road", -2.7, 2.7, 0.03, [(-12, FAR)], c["asphalt"])
    strip("Stripe middle", -0.07, 0.07, 0.035, [(y, y + 3) for y in range(-12, 500, 8)], c["yellow"])
    for side in (-1, 1):
        strip(f"Stripe {side}", side * 2.45 - 0.06, side * 2.45 + 0.06, 0.035, [(-12, FAR)], c["white"])


def mesas(c):
    """Table mountains: a slope of rubble, cliffs in two bands, a flat top."""
    rng = Random(4)
    profile = ((1.9, -0.1), (1.45, 0.2), (1.12, 0.4), (1.02, 0.42), (0.98, 0.62), (1.03, 0.64), (0.96, 0.66),
               (0.92, 0.97), (0.84, 1))
    for k, (x, y, r, h) in enumerate(((-230, 560, 62, 88), (-60, 700, 24, 104), (130, 620, 62, 66),
                                      (330, 760, 80, 124), (-470, 800, 120, 100))):
        ragged = [rng.uniform(0.84, 1.14) for _ in range(22)]
        loops = [[(x + s * r * w * cos(pi * j / 11), y + s * r * w * sin(pi * j / 11), z * h)
                  for j, w in enumerate(ragged)] for s, z in profile]
        rings(f"Mesa {k}", loops, [c["rock"], c["pale rock"]], slot=lambda loop, side: loop in (2, 5), smooth=0)


def cactus(c, name, x, y, size):
    root = group(name, (x, y, height(x, y) - 0.05), 40 * x)
    tube(name + " stem", [(0, 0, 0), (0, 0, 0.2 * size), (0, 0, 0.9 * size), (0, 0, size)],
         [0.09 * size, 0.1 * size, 0.09 * size, 0.03 * size], c["cactus"], parent=root)
    for side, z in ((-1, 0.35), (1, 0.5)):
        bend = ((0.05, 0), (0.25, 0), (0.3, 0.08), (0.3, 0.3), (0.3, 0.36))
        tube(f"{name} arm {side}", [(side * u * size, 0, (z + v) * size) for u, v in bend],
             [r * size for r in (0.06, 0.06, 0.065, 0.06, 0.02)], c["cactus"], parent=root)


def poles(c):
    wires = ([], [])
    for k in range(14):
        y = 6 + 26 * k
        x = road_middle(y) - 7
        z = height(x, y)
        lathe(f"Pole {k}", [(0, 6.5), (0.09, 6.5), (0.14, -0.5)], (x, y, z), c["wood"], steps=10)
        box(f"Pole arm {k}", (1.6, 0.1, 0.12), (x, y - 0.12, z + 5.9), c["wood"])
        for wire, side in zip(wires, (-0.7, 0.7), strict=True):
            if wire:
                last, end = Vector(wire[-1]), Vector((x + side, y - 0.12, z + 6.1))
                wire += [last.lerp(end, t / 8) - Vector((0, 0, 0.9 * (1 - (t / 4 - 1) ** 2))) for t in range(1, 9)]
            else:
                wire.append((x + side, y - 0.12, z + 6.1))
    strands("Wire", wires, 0.012, c["iron"], taper=1)


def sign(c):
    root = group("Sign", (-3.9, 7, height(-3.9, 7)), 8)
    for x in (-0.75, 0.75):
        box(f"Sign post {x}", (0.1, 0.1, 2.5), (x, 0.08, 0), c["wood"], parent=root)
    box("Sign board", (2.3, 0.06, 0.9), (0, 0, 1.5), c["white"], bevel=0.015, parent=root)
    text("Letters", "ENCRE  12", (0, -0.04, 1.8), 0.42, c["iron"], parent=root)


def traveller(c):
    """She holds out her hand for a lift; the cat waits on the suitcase."""
    girl((3.55, 1.1, height(3.55, 1.1)), -24, rain=False)
    root = group("Suitcase", (4.5, 0.75, height(4.5, 0.75)), -14)
    box("Suitcase body", (0.78, 0.26, 0.52), (0, 0, 0.02), c["leather"], bevel=0.04, parent=root)
    for x in (-0.24, 0.24):
        box(f"Strap {x}", (0.06, 0.275, 0.535), (x, 0, 0.012), c["wood"], bevel=0.035, parent=root)
        box(f"Buckle {x}", (0.09, 0.02, 0.08), (x, -0.145, 0.36), c["brass"], parent=root)
    tube("Handle", [(-0.1, -0.14, 0.5), (-0.09, -0.19, 0.46), (0.09, -0.19, 0.46), (0.1, -0.14, 0.5)], 0.014,
         c["wood"], parent=root)
    cat((4.5, 0.72, height(4.5, 0.75) + 0.54), 22)


def build():
    c = colors()
    terrain(c)
    road(c)
    mesas(c)
    poles(c)
    sign(c)
    traveller(c)
    for k, (x, y, size) in enumerate(((9, 10, 2.6), (-13, 22, 3.4), (17, 34, 3.2), (26, 70, 4), (-34, 80, 4),
                                      (-9.5, 12, 1.2), (7.2, 4.5, 0.7))):
        cactus(c, f"Cactus {k}", x, y, size)
    world(sky=(0.98, 0.72, 0.42), fill=(0.28, 0.24, 0.42))
    light("SUN", "Sun", (-8, -3.2, 2.6), (0, 0, 0), (1.0, 0.80, 0.52), 4.4, angle=radians(0.5))
    paint("thickness", ["Mesa"], -0.5)
    paint("thickness", ["Pole", "Wire", "Cactus", "Stripe", "Terrain"],
          lambda co: -0.15 - 0.45 * ramp((co - EYE).length, 8, 60))
    paint("thickness", [*SMALL, "Buckle", "Letters"], -0.55)
    paint("hatching", ["Mesa", "Terrain"], lambda co: -0.3 - 0.5 * ramp(co.y, 20, 200))
    paint("hatching", BARE, -1)
    camera(EYE, (0.9, 12, 1.75), 32).data.clip_end = 5000
    settings()


if __name__ == "__main__":
    build()
