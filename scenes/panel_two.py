# SPDX-License-Identifier: GPL-3.0-or-later
"""A girl and a cat by a windbreak: what Vainumäe shows with the second of his panels (2020, Figure 41), of our own.

Light in steps with short soft transitions, shade that is tinted light violet, lines where colors meet within one thing
(stripes, scarf, umbrella, a painted boat), and pencil on what is dark by its color. Painted as an artist would.
"""

from math import cos, pi, radians, sin

from common import (
    ball,
    box,
    camera,
    dabs,
    light,
    look,
    mesh_object,
    modifier,
    paint,
    paintable,
    ramp,
    rings,
    settings,
    slab,
    tube,
    world,
)
from figures import BARE, SMALL, cat, girl
from materials import flat


def colors():
    return {
        "sand": flat("Sand", (0.84, 0.70, 0.48)), "sea": flat("Sea", (0.22, 0.50, 0.58)),
        "cream": flat("Cream", (0.90, 0.84, 0.70)), "rose": flat("Rose", (0.78, 0.36, 0.34)),
        "teal": flat("Teal", (0.10, 0.42, 0.44)), "navy": flat("Navy", (0.05, 0.066, 0.155)),
        "wood": flat("Wood", (0.44, 0.26, 0.13)), "tar": flat("Tar", (0.11, 0.085, 0.075)),
        "white": flat("White", (0.90, 0.88, 0.84)), "sun": flat("Ochre", (0.86, 0.56, 0.12)),
        "brass": flat("Brass", (0.70, 0.48, 0.14)),
    }


def windbreak(c):
    """A striped cloth between poles; its stripes are one mesh, so that no outline parts them."""
    n, high = 60, 8
    def place(k, j):
        x = -3.4 + 5.6 * k / n
        return x, 1.1 + 0.16 * sin(2.2 * x) - 0.05 * j / high, 0.08 + 1.62 * j / high + 0.05 * sin(3.1 * x + 0.4)
    verts = [place(k, j) for j in range(high + 1) for k in range(n + 1)]
    faces = [(j * (n + 1) + k, j * (n + 1) + k + 1, (j + 1) * (n + 1) + k + 1, (j + 1) * (n + 1) + k)
             for j in range(high) for k in range(n)]
    stripes = (0, 0, 1, 1, 1, 0, 0, 2, 2, 0)
    cloth = mesh_object("Windbreak", verts, faces, [c["cream"], c["rose"], c["teal"]], smooth=True,
                        slot=lambda face: stripes[face % n % len(stripes)])
    modifier(cloth, "SOLIDIFY", thickness=0.015)
    for k in range(0, n + 1, 15):
        x, y, z = place(k, high)
        tube(f"Pole {k}", [(x, y - 0.02, -0.1), (x + 0.02, y - 0.04, z + 0.22)], 0.028, c["wood"], sides=12,
             smooth=0)


def boat(c):
    """A small boat, drawn up, its sides painted in bands of one mesh."""
    def section(x):
        wide = 0.62 * (1 - (x / 1.7) ** 2) + 0.04
        return [(x, wide * y, z + 0.14 * (x / 1.7) ** 2) for y, z in ((-0.3, 0.02), (-0.62, 0.16), (-0.86, 0.34),
                (-0.98, 0.5), (-1.02, 0.62), (-0.96, 0.63), (-0.8, 0.36), (0, 0.22), (0.8, 0.36), (0.96, 0.63),
                (1.02, 0.62), (0.98, 0.5), (0.86, 0.34), (0.62, 0.16), (0.3, 0.02), (0, 0))]
    bands = [c["white"], c["teal"], c["sun"], c["wood"]]
    side = {0: 1, 1: 1, 2: 0, 3: 2, 4: 2, 9: 2, 10: 2, 11: 0, 12: 1, 13: 1, 14: 1, 15: 1}
    hull = rings("Boat", [section(-1.7 + 3.4 * k / 14) for k in range(15)], bands,
                 slot=lambda loop, k: side.get(k, 3), smooth=1)
    hull.location, hull.rotation_euler = (2.35, 2.0, 0.02), (radians(-14), 0, radians(-16))


def trunk(c):
    """A sea chest, dark and bound with brass, on which the cat sits."""
    paintable("Trunk", (0.95, 0.6, 0.46), (-1.12, -0.25, 0), c["navy"], 0.05, turn=12)
    paintable("Trunk lid", (1.0, 0.64, 0.14), (-1.12, -0.25, 0.465), c["navy"], 0.05, turn=12)
    for x in (-0.4, 0.4):
        dx, dy = x * cos(radians(12)), x * sin(radians(12))
        box(f"Band {x}", (0.07, 0.67, 0.63), (-1.12 + dx, -0.25 + dy, -0.01), c["brass"], bevel=0.01, turn=12)
    box("Lock", (0.11, 0.05, 0.14), (-1.05, -0.57, 0.38), c["brass"], turn=12)


def build():
    c = colors()
    slab("Sand", [(-9, -5), (9, -5), (9, 9), (-9, 9)], -0.3, 0, c["sand"])
    slab("Sea", [(-90, 9), (90, 9), (90, 160), (-90, 160)], -0.5, -0.3, c["sea"])
    windbreak(c)
    boat(c)
    trunk(c)
    girl((0.35, -0.15, 0), -24)
    cat((-1.12, -0.3, 0.6), 42)
    for k, (x, y, r) in enumerate(((-0.35, -0.85, 0.15), (1.35, -0.6, 0.12))):
        loops = [[(x + r * sin(a) * cos(b), y + r * sin(a) * sin(b), r - r * cos(a))
                  for b in (2 * pi * j / 24 for j in range(24))] for a in (0.05 + 3.04 * i / 14 for i in range(15))]
        rings(f"Ball {k}", loops, [c["rose"], c["white"], c["sun"], c["teal"]], smooth=1,
              slot=lambda loop, side: side // 4 % 4)
    ball("Sack", (-2.15, 0.1, 0.3), (0.42, 0.36, 0.36), c["tar"])
    ball("Sack neck", (-2.1, 0.08, 0.66), (0.13, 0.12, 0.1), c["tar"])
    controls()
    world(sky=(0.74, 0.86, 0.88), fill=(0.36, 0.35, 0.38))
    light("SUN", "Sun", (4.2, -3.4, 4.4), (0, 0, 0), (1.0, 0.96, 0.88), 4.6, angle=0.01)
    camera((-0.2, -4.5, 1.12), (-0.2, 0, 0.86), 44)
    look(levels=((0.5, 0, 0), (0.76, 0.44, 0.10), (1.06, 0.80, 0.10)), line_thickness=7.0, line_color_width=0.75,
         pen_1_grain=0.7,
         shade_tint=(0.72, 0.62, 0.94), shade_saturation=0.6, hatch_amount=0.85, hatch_color_threshold=0.33,
         hatch_color_light=0.15, hatch_light_threshold=0.3, hatch_color=(0.03, 0.03, 0.06), smudge_range=14.0)
    settings()


def controls():
    """Boundaries of color on what is striped, also where they hardly differ; light on the cat's back and the chest."""
    paint("color_edge", ("Windbreak", "Scarf", "Canopy", "Boat", "Ball"), 1)
    paint("thickness", SMALL, -0.5)
    paint("thickness", ("Pole", "Boat"), -0.25)
    paint("thickness", ("Coat", "Sleeve", "Boot", "Trunk", "Foot"), lambda co: 0.06 * ramp(co.z, 1.0, 0))
    paint("intensity", ("Windbreak",), dabs({(-2.7, 1.1, 1.2): (0.5, -0.8), (0.6, 1.1, 0.9): (0.5, -0.7),
                                             (-1.5, 1.1, 0.5): (0.4, -0.6)}, 0.35))
    paint("hatching", BARE, -1)
    paint("hatching", ("Windbreak", "Boat", "Sand"), -0.6)
    paint("hatching", ("Trunk",), dabs({(-0.85, -0.6, 0.4): (0.35, -0.45), (-0.8, -0.4, 0.62): (0.3, -0.6)}, 0.1))
    paint("hatching", ("Sack",), dabs({(-1.9, -0.2, 0.5): (0.35, -0.4)}))
    paint("light", ("Face", "Nose"), 0.35)
    paint("smudge_range", ("Canopy", "Scarf"), 0.6)
    paint("smudge_falloff", ("Canopy", "Scarf"), 0.5)


if __name__ == "__main__":
    build()
