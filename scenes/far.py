# SPDX-License-Identifier: GPL-3.0-or-later
"""A halt on a railway in the plain: wires, a fence, a lattice mast and scaffolding go towards the horizon.

What is hard for lines here: rods and wires of a pixel and less, dozens of them close together, that must neither
drown in ink nor break into dashes. The track runs along y; the camera stands beside it, x is to the right.
"""

from math import radians
from random import Random

from common import (
    ball,
    box,
    camera,
    group,
    lathe,
    light,
    mesh_object,
    paint,
    ramp,
    repeat,
    settings,
    slab,
    strands,
    world,
)
from figures import BARE, SMALL, cat, girl
from materials import flat, glow
from mathutils import Vector

EYE = Vector((-1.2, -8.5, 1.6))


def colors():
    return {
        "plain": flat("Plain", (0.62, 0.50, 0.22)),
        "field": flat("Field", (0.40, 0.46, 0.16)),
        "hill": flat("Hill", (0.34, 0.33, 0.52)),
        "gravel": flat("Gravel", (0.50, 0.42, 0.42)),
        "sleeper": flat("Sleeper", (0.24, 0.14, 0.10)),
        "steel": flat("Steel", (0.42, 0.44, 0.52)),
        "iron": flat("Iron", (0.06, 0.08, 0.11)),
        "wood": flat("Wood", (0.36, 0.21, 0.13)),
        "plank": flat("Plank", (0.70, 0.50, 0.26)),
        "wall": flat("Wall", (0.80, 0.62, 0.46)),
        "plinth": flat("Plinth", (0.45, 0.28, 0.24)),
        "roof": flat("Roof", (0.46, 0.13, 0.10)),
        "glass": flat("Glass", (0.10, 0.17, 0.30)),
        "white": flat("White", (0.88, 0.86, 0.80)),
        "red": flat("Red", (0.70, 0.07, 0.05)),
        "china": flat("China", (0.80, 0.84, 0.86)),
        "cloud": glow("Cloud", (1.0, 0.78, 0.60)),
    }


def plain(c):
    slab("Plain", [(-600, -30), (600, -30), (600, 1500), (-600, 1500)], -0.5, 0, c["plain"])
    for k, (x, y, w, d) in enumerate(((-60, 60, 45, 30), (50, 110, 38, 50), (-70, 190, 50, 80))):
        slab(f"Field {k}", [(x - w, y - d), (x + w, y - d), (x + w, y + d), (x - w, y + d)], 0, 0.03, c["field"])
    for x, w, h in ((-330, 190, 34), (-120, 130, 20), (170, 210, 30), (420, 160, 46)):
        ball(f"Hill {x}", (x, 1300, -3), (w, 60, h), c["hill"])
    for k, (x, z, w) in enumerate(((-420, 240, 120), (-330, 225, 80), (160, 330, 130), (300, 310, 90))):
        ball(f"Cloud {k}", (x, 1400, z), (w, 10, 0.2 * w), c["cloud"])


def track(c):
    verts = [(x, y, z) for y in (-30, 700) for x, z in ((-1.8, 0), (-1.4, 0.2), (1.4, 0.2), (1.8, 0))]
    mesh_object("Ballast", verts, [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6)], c["gravel"])
    repeat(box("Sleeper", (2.4, 0.26, 0.1), (0, -8, 0.17), c["sleeper"]), 450, (0, 0.75, 0))
    for x in (-0.72, 0.72):
        box(f"Rail {x}", (0.07, 730, 0.14), (x, 335, 0.27), c["steel"], bevel=0)


def poles(c):
    """Telegraph poles, each with two crossarms, and six wires that sag between them."""
    step, count, lines = 16.0, 22, []
    for k in range(count):
        root = group(f"Pole {k}", (-4.4, 2 + step * k, 0))
        lathe(f"Pole post {k}", [(0, 6.4), (0.09, 6.4), (0.13, 0)], (0, 0, 0), c["wood"], steps=10, parent=root)
        for z in (5.3, 5.95):
            box(f"Pole arm {k} {z}", (1.9, 0.1, 0.11), (0, -0.1, z), c["wood"], parent=root)
            knob = lathe(f"Insulator {k} {z}", [(0, 0.16), (0.04, 0.14), (0.045, 0.05), (0.02, 0)],
                         (-0.85, -0.1, z + 0.11), c["china"], steps=8, parent=root)
            repeat(knob, 2, (1.7, 0, 0))
    for x, z in ((-0.85, 5.55), (0.85, 5.55), (-0.85, 6.2), (0.85, 6.2)):
        lines.append([(-4.4 + x, 2 - step + step * (k / 8), z + 0.55 * (((k % 8) / 4 - 1) ** 2 - 1))
                      for k in range(8 * count + 1)])
    strands("Wire", lines, 0.011, c["iron"], taper=1)


def fence(c):
    repeat(box("Fence post", (0.09, 0.09, 1.15), (-6.6, -4, 0), c["wood"]), 70, (0, 2.4, 0))
    for z in (0.35, 0.7, 1.05):
        box(f"Fence wire {z}", (0.014, 170, 0.014), (-6.6, 80, z), c["iron"], bevel=0)


def station(c):
    """The keeper's house, half in scaffolding, an aerial on its roof, and the platform before it."""
    slab("Platform", [(2.3, 2), (5.4, 2), (5.4, 46), (2.3, 46)], 0, 0.62, c["gravel"], bevel=0.03)
    slab("Platform edge", [(2.24, 2), (2.6, 2), (2.6, 46), (2.24, 46)], 0.62, 0.66, c["white"], bevel=0.01)
    box("House", (6, 8, 4.6), (8.6, 19, 0), c["wall"], bevel=0)
    box("House plinth", (6.1, 8.1, 0.9), (8.6, 19, 0), c["plinth"], bevel=0)
    verts = [(x, y, z) for y in (14.6, 23.4) for x, z in ((5.2, 4.4), (8.6, 7.0), (12.0, 4.4))]
    mesh_object("House roof", verts, [(0, 1, 4, 3), (1, 2, 5, 4), (0, 2, 1), (3, 4, 5), (0, 3, 5, 2)], c["roof"])
    for z in (1.2, 3.05):
        repeat(box(f"House pane {z}", (0.06, 0.9, 1.2), (5.6, 16.5, z), c["glass"], bevel=0), 3, (0, 2.5, 0))
        repeat(box(f"Front pane {z}", (0.9, 0.06, 1.2), (6.9, 15.0, z), c["glass"], bevel=0), 3, (1.7, 0, 0))
    aerial = [[(8.6, 17, 7), (8.6, 17, 9.6)], [(7.4, 17, 9.4), (9.8, 17, 9.4)]]
    aerial += [[(7.5 + 0.28 * k, 16.55 + 0.02 * k, 9.4), (7.5 + 0.28 * k, 17.45 - 0.02 * k, 9.4)] for k in range(9)]
    strands("Aerial", aerial, 0.016, c["iron"], taper=1)


def scaffold(c):
    xs, ys, zs = (4.3, 5.2), [14.4 + 1.55 * k for k in range(7)], (0.62, 2.3, 4.0, 5.7)
    rods = [[(x, y, 0.6), (x, y, 6.9)] for x in xs for y in ys]
    rods += [[(x, ys[0] - 0.3, z + d), (x, ys[-1] + 0.3, z + d)] for x in xs for z in zs[1:] for d in (0, 0.55, 1.05)]
    rods += [[(xs[0] - 0.2, y, z), (xs[1] + 0.2, y, z)] for y in ys for z in zs[1:]]
    rods += [[(xs[0], ys[k + (j + 1) % 2], zs[j]), (xs[0], ys[k + j % 2], zs[j + 1])]
             for k in (0, 2, 4) for j in range(3)]
    strands("Scaffold", rods, 0.025, c["steel"], taper=1)
    for z in zs[1:]:
        box(f"Scaffold board {z}", (0.85, 9.6, 0.05), (4.75, 19.05, z + 0.02), c["plank"], bevel=0)


def mast(c, name, x, y, h):
    """A lattice mast: four legs that lean together, crossed struts, three pairs of arms."""
    lines, floors = [], 12

    def leg(k, side):
        r, z = (0.075 - 0.062 * k / floors) * h, h * k / floors
        return x + r * (1, 1, -1, -1)[side % 4], y + r * (1, -1, -1, 1)[side % 4], z

    for side in range(4):
        lines.append([leg(0, side), leg(floors, side)])
        for k in range(floors):
            lines += [[leg(k, side), leg(k + 1, side + 1)], [leg(k, side + 1), leg(k + 1, side)]]
    for z, w in ((0.72, 0.2), (0.82, 0.25), (0.92, 0.17)):
        for s in (-1, 1):
            lines += [[(x, y, z * h), (x + s * w * h, y, z * h)], [(x, y, (z + 0.06) * h), (x + s * w * h, y, z * h)]]
    strands(name, lines, 0.05, c["iron"], taper=1)


def signal(c):
    root = group("Signal", (-2.3, 10, 0))
    lathe("Signal post", [(0, 4.3), (0.03, 4.25), (0.06, 4.1), (0.085, 0)], (0, 0, 0), c["white"], steps=12,
          parent=root)
    box("Signal arm", (1.15, 0.03, 0.24), (-0.62, -0.12, 3.65), c["red"], parent=root)
    box("Signal band", (0.16, 0.036, 0.24), (-0.95, -0.122, 3.65), c["white"], bevel=0, parent=root)
    rungs = [[(-0.16, 0.12, 0.3 * k), (0.16, 0.12, 0.3 * k)] for k in range(1, 13)]
    strands("Signal ladder", [*rungs, *([(x, 0.12, 0), (x, 0.12, 3.9)] for x in (-0.16, 0.16))], 0.013, c["iron"],
            taper=1, parent=root)


def build():
    c, rng = colors(), Random(2)
    plain(c)
    track(c)
    poles(c)
    fence(c)
    station(c)
    scaffold(c)
    signal(c)
    for k in range(7):
        mast(c, f"Mast {k}", -30 + 36 * k + rng.uniform(-3, 3), 150 + 75 * k, 30)
    girl((3.1, 4.2, 0.62), -20)
    cat((4.2, 2.6, 0.62), 30)
    world(sky=(0.93, 0.60, 0.42), fill=(0.26, 0.24, 0.40))
    light("SUN", "Sun", (-9, -5, 4.2), (0, 0, 0), (1.0, 0.82, 0.55), 4.6, angle=radians(0.5))
    paint("thickness", ["Cloud", "Hill", "Field", "Mast"], -0.6)
    paint("thickness", ["Pole", "Insulator", "Wire", "Fence", "Scaffold", "House", "Front", "Aerial", "Sleeper"],
          lambda co: -0.2 - 0.5 * ramp((co - EYE).length, 8, 60))
    paint("thickness", ["Girl", *SMALL], -0.6)
    paint("hatching", ["Cloud", *BARE], -1)
    paint("hatching", ["Hill", "Field", "Plain", "Mast"], -0.5)
    camera(EYE, (0.55, 20, 3.1), 35).data.clip_end = 5000
    settings()


if __name__ == "__main__":
    build()
