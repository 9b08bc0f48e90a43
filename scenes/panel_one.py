# SPDX-License-Identifier: GPL-3.0-or-later
"""A door by the sea: what Vainumäe shows with the first of his panels (2020, Figure 40), with things of our own.

Lines of different thickness and pressure that leave off in places, color that runs over them, pencil in the shade, and
shade that is tinted violet-blue. All of it is painted, as an artist paints with Encre's brushes: dabs() are strokes.
"""

from math import cos, pi, sin

from common import (
    ball,
    box,
    camera,
    dabs,
    group,
    lathe,
    light,
    look,
    paint,
    paintable,
    place,
    ramp,
    rings,
    settings,
    slab,
    tube,
    world,
)
from materials import flat


def colors():
    return {
        "plaster": flat("Plaster", (0.83, 0.75, 0.62)), "stone": flat("Stone", (0.56, 0.52, 0.47)),
        "door": flat("Door", (0.09, 0.34, 0.36)), "dark": flat("Hall", (0.06, 0.05, 0.07)),
        "wood": flat("Wood", (0.46, 0.27, 0.13)), "quay": flat("Quay", (0.66, 0.58, 0.46)),
        "sea": flat("Sea", (0.20, 0.42, 0.50)), "clay": flat("Clay", (0.70, 0.28, 0.13)),
        "leaf": flat("Leaf", (0.18, 0.38, 0.12)), "red": flat("Red", (0.72, 0.10, 0.07)),
        "white": flat("White", (0.88, 0.86, 0.80)), "rope": flat("Rope", (0.72, 0.58, 0.32)),
        "iron": flat("Iron", (0.05, 0.06, 0.08)), "glass": flat("Float", (0.16, 0.44, 0.34)),
    }


def house(c):
    paintable("Wall left", (3.0, 0.4, 3.9), (-2.9, 0.2, 0), c["plaster"])
    paintable("Wall right", (2.3, 0.4, 3.9), (0.95, 0.2, 0), c["plaster"])
    paintable("Wall over", (1.2, 0.4, 1.5), (-0.8, 0.2, 2.4), c["plaster"])
    box("Hall", (1.4, 0.1, 2.6), (-0.8, 0.75, 0), c["dark"], bevel=0)
    for k, (x, z, wide, high) in enumerate(((-1.5, 0.0, 0.26, 0.5), (-1.47, 0.5, 0.2, 0.42), (-1.5, 0.92, 0.26, 0.5),
                                            (-1.47, 1.42, 0.2, 0.4), (-1.5, 1.82, 0.26, 0.56), (-0.1, 0.0, 0.26, 0.46),
                                            (-0.13, 0.46, 0.2, 0.5), (-0.1, 0.96, 0.26, 0.42),
                                            (-0.13, 1.38, 0.2, 0.5), (-0.1, 1.88, 0.26, 0.5))):
        paintable(f"Quoin {k}", (wide, 0.2, high - 0.012), (x, -0.03, z + 0.45), c["stone"], 0.08)
    paintable("Lintel", (1.9, 0.22, 0.3), (-0.8, -0.03, 2.84), c["stone"], 0.08)
    door = group("Door leaf", (-1.36, 0.1, 0.45), -38)
    for k in range(5):
        paintable(f"Plank {k}", (0.208, 0.05, 2.3), (0.11 + 0.212 * k, 0, 0.02), c["door"], 0.1, parent=door)
    for z in (0.4, 1.8):
        box(f"Hinge {z}", (0.7, 0.02, 0.07), (0.4, -0.035, z), c["iron"], bevel=0.008, parent=door)
    lathe("Knob", [(0, 0.06), (0.03, 0.05), (0.035, 0.03), (0.015, 0.0)], (0.98, -0.03, 1.05), c["iron"],
          turn=(90, 0, 0), parent=door)
    for k in range(3):
        paintable(f"Step {k}", (2.3 - 0.3 * k, 1.3 - 0.36 * k, 0.15), (-0.8, -0.3 + 0.17 * k, 0.15 * k), c["stone"],
                  0.08)
    for x in (-2.75, 0.55):
        box(f"Beam {x}", (0.12, 1.9, 0.12), (x, -0.85, 3.2), c["wood"])
        tube(f"Strut {x}", [(x, -0.05, 2.5), (x, -1.1, 3.2)], 0.05, c["wood"], sides=12, smooth=0)
    for k in range(9):
        paintable(f"Board {k}", (3.9, 0.2, 0.05), (-1.1, -0.02 - 0.22 * k, 3.33 - 0.016 * k), c["wood"], 0.15)


def quay(c):
    paintable("Quay", (11, 5.2, 0.5), (0, -1.6, -0.5), c["quay"], 0.2)
    slab("Sea", [(-60, 1), (60, 1), (60, 120), (-60, 120)], -1.2, -1.0, c["sea"])
    for k, x in enumerate((3.1, 4.3, 5.6)):
        tube(f"Post {k}", [(x, 3.2 + k, -1.4), (x + 0.04, 3.2 + k, 0.75 - 0.1 * k)], 0.13, c["wood"], sides=16,
             smooth=0)
    lathe("Lighthouse", [(0, 5.2), (0.5, 4.9), (0.55, 4.4), (0.75, 4.35), (0.7, 4.2), (1.05, 0)], (9.5, 26, -1),
          c["white"])
    slab("Rocks", [(5, 25), (14, 24), (17, 27), (4, 28)], -1, -0.4, c["stone"], bevel=0.2)


def lifebuoy(c, at):
    root = place(group("Lifebuoy"), at, (90, 0, 0))
    loops = [[((0.34 + 0.1 * cos(b)) * cos(a), (0.34 + 0.1 * cos(b)) * sin(a), 0.1 * sin(b))
              for b in (2 * pi * j / 12 for j in range(12))] for a in (2 * pi * k / 32 for k in range(33))]
    rings("Buoy", loops, [c["white"], c["red"]], slot=lambda loop, side: loop // 4 % 2, capped=False, smooth=1,
          parent=root)
    tube("Buoy rope", [(0.47 * cos(a), 0.47 * sin(a), 0.02 * sin(4 * a)) for a in (2 * pi * k / 32 for k in range(33))],
         0.013, c["rope"], sides=6, smooth=1, parent=root)


def pot(c, name, at, size, leaves):
    lathe(f"{name} pot", [(0, 0.0), (0.2, 0), (0.27, 0.36), (0.31, 0.37), (0.32, 0.46), (0.27, 0.46)], at, c["clay"],
          steps=36, thick=0.02).scale = (size,) * 3
    for k in range(leaves):
        a, bow = 2.4 * k, 0.32 + 0.05 * (k % 4)
        points = [(at[0] + size * bow * t * cos(a), at[1] + size * bow * t * sin(a),
                   at[2] + size * (0.42 + 1.1 * t - 0.62 * t * t)) for t in (j / 6 for j in range(7))]
        tube(f"{name} leaf {k}", points, [size * r for r in (0.02, 0.05, 0.08, 0.09, 0.075, 0.045, 0.006)], c["leaf"],
             flat=0.12, smooth=1)


def things(c):
    pot(c, "Large", (1.45, -0.75, 0), 1.15, 11)
    pot(c, "Small", (2.3, -0.45, 0), 0.75, 8)
    pot(c, "Left", (-2.55, -1.5, 0), 0.9, 9)
    lifebuoy(c, (1.35, -0.06, 1.95))
    for k, (x, lean) in enumerate(((2.55, 0.36), (2.75, 0.5))):
        tube(f"Oar {k}", [(x, -0.6, 0.02), (x - lean, -0.03, 2.5)], 0.028, c["wood"], sides=10, smooth=1)
        tube(f"Blade {k}", [(x - lean * 0.8, -0.14, 2.0), (x - lean, -0.03, 2.5), (x - lean * 1.16, 0.02, 2.9)],
             [0.03, 0.11, 0.09], c["wood"], flat=0.2, smooth=1)
    coil = [((0.2 + 0.05 * cos(1.7 * a)) * cos(a), (0.2 + 0.05 * cos(1.7 * a)) * sin(a), 0.03 + 0.006 * a)
            for a in (pi * k / 10 for k in range(100))]
    place(tube("Coil", coil, 0.024, c["rope"], sides=6, smooth=1), (0.55, -2.3, 0))
    for k, (x, y, r) in enumerate(((-1.75, -2.2, 0.19), (-1.4, -2.45, 0.14), (-1.9, -2.62, 0.12))):
        ball(f"Float {k}", (x, y, r), (r, r, r), c["glass"])
    for k in range(4):
        box(f"Crate {k}", (0.9, 0.05, 0.17), (-3.35, -1.75, 0.02 + 0.2 * k), c["wood"], turn=8)
        box(f"Crate end {k}", (0.05, 0.6, 0.17), (-2.9, -1.4, 0.02 + 0.2 * k), c["wood"], turn=8)


NEAR = ("Large", "Small", "Left", "Coil", "Float", "Crate", "Buoy")
FAR = ("Post", "Lighthouse", "Rocks", "Sea")


def controls():
    """Thick and pressed in front and below, thin and light far away; nothing where light eats the line."""
    paint("thickness", NEAR, lambda co: 0.04 + 0.12 * ramp(co.z, 0.7, 0) * ramp(co.y, -0.4, -2.2))
    paint("thickness", ("Step", "Quay"), lambda co: 0.10 * ramp(co.y, -0.2, -1.4))
    paint("thickness", ("Plank", "Quoin", "Board", "Hinge"), -0.35)
    paint("thickness", FAR, -0.55)
    paint("intensity", NEAR, 0.45)
    paint("intensity", FAR, -0.35)
    cuts = {(0.9, -0.13, 3.1): (0.5, -1), (-1.5, -0.13, 1.3): (0.32, -1), (-0.13, -0.13, 2.2): (0.4, -1),
            (-1.5, -0.13, 2.4): (0.3, -1), (-0.25, -0.13, 3.0): (0.35, -1), (2.1, 0, 3.2): (0.8, -1),
            (2.1, 0, 1.3): (0.6, -1), (-4.4, 0, 2.0): (0.8, -1)}
    paint("intensity", ("Wall", "Quoin", "Lintel"), dabs(cuts, 0.1))
    paint("intensity", ("Step", "Board", "Plank"),
          dabs({(0.2, -0.95, 0.15): (0.35, -1), (-1.4, -0.8, 0.3): (0.3, -1), (-0.5, -0.5, 0.45): (0.3, -1),
                (0.6, -1.8, 3.25): (0.6, -1), (-2.2, -1.8, 3.25): (0.45, -1), (-1.0, -0.4, 1.5): (0.3, -0.9)}, 0.15))
    # Colour of what lies behind runs into the pots and the buoy, that of the buoy and the leaves onto the wall.
    paint("smudge_range", ("Large pot", "Left pot", "Small pot", "Float"), 0.8)
    paint("smudge_range", ("Buoy",), lambda co: 0.9 * ramp(co.z, 2.1, 1.6))
    paint("smudge_range", ("Large leaf", "Small leaf", "Left leaf"), 0.9)
    paint("smudge_range", ("Wall", "Quay"), dabs({(1.75, 0, 2.35): (0.5, -1), (1.45, -0.6, 1.1): (0.8, -1),
                                                  (-2.5, -1.5, 0.0): (0.8, -0.9), (1.5, -0.9, 0.0): (0.8, -0.9)}))
    paint("smudge_falloff", ("Large", "Small", "Left", "Float", "Buoy", "Wall", "Quay"), 0.7)
    # The pencil is lighter where the wall turns to the light, and on what is small.
    lighter = {(-2.6 + 0.23 * k, 0, 1.0 + 0.16 * k): (0.4, -0.2) for k in range(6)}
    darker = {(-2.5 + 0.3 * k, 0, 3.1): (0.5, 0.25) for k in range(10)}
    paint("hatching", ("Wall", "Board", "Quoin", "Lintel"), dabs({**lighter, **darker, (0.4, 0, 2.4): (0.5, -0.3)}))
    paint("hatching", ("Large leaf", "Small leaf", "Left leaf", "Coil"), -0.8)
    paint("hatching", ("Hall",), 0.6)


def build():
    c = colors()
    house(c)
    quay(c)
    things(c)
    controls()
    world(sky=(0.80, 0.86, 0.84), fill=(0.30, 0.30, 0.34))
    light("SUN", "Sun", (3.2, -3.0, 5.2), (0, 0, 0), (1.0, 0.97, 0.9), 5.6, angle=0.01)
    camera((0.35, -7.9, 1.8), (-0.3, 0, 1.42), 39)
    look(line_thickness=6.0, pen_1_grain=0.75, shade_tint=(0.46, 0.42, 0.92), shade_tint_weight=1.0,
         shade_saturation=0.55, hatch_amount=0.68, hatch_light_threshold=0.6, hatch_color=(0.05, 0.04, 0.10),
         smudge_range=22.0, smudge_pick=14.0)
    settings()


if __name__ == "__main__":
    build()
