# SPDX-License-Identifier: GPL-3.0-or-later
"""A dancer in the limelight: crossed limbs, a turning skirt, loose hair and a fringe.

What is hard for lines here: skin before skin, where neither colour nor object parts an arm from the neck behind it,
single hairs of a pixel and less, and the many soft folds of one cloth. She stands at the origin and looks along −y.
"""

from math import cos, pi, radians, sin
from random import Random

from common import (
    ball,
    bricks,
    camera,
    flat,
    glow,
    group,
    lathe,
    light,
    mesh_object,
    modifier,
    paint,
    place,
    ramp,
    rings,
    settings,
    slab,
    strands,
    tube,
    world,
)
from mathutils import Vector


def colors():
    return {
        "boards": bricks("Boards", (0.52, 0.30, 0.16), (0.58, 0.35, 0.19), (0.20, 0.10, 0.07), (2.6, 0.24, 0.008)),
        "curtain": flat("Curtain", (0.44, 0.06, 0.12)),
        "fringe": flat("Gold", (0.80, 0.55, 0.16)),
        "skin": flat("Skin", (0.80, 0.50, 0.35)),
        "hair": flat("Hair", (0.09, 0.04, 0.04)),
        "dress": flat("Dress", (0.72, 0.05, 0.07)),
        "lining": flat("Lining", (0.88, 0.80, 0.66)),
        "sash": flat("Sash", (0.08, 0.10, 0.24)),
        "black": flat("Black", (0.02, 0.02, 0.03)),
        "wood": flat("Wood", (0.36, 0.19, 0.09)),
        "straw": flat("Straw", (0.82, 0.62, 0.28)),
        "shell": flat("Shell", (0.62, 0.50, 0.24)),
        "flame": glow("Flame", (1.4, 1.1, 0.5)),
    }


def stage(c):
    slab("Boards", [(-8, -3.2), (8, -3.2), (8, 4), (-8, 4)], -0.3, 0, c["boards"])
    folds = [(x / 40, 2.0 + 0.13 * sin(x / 5.2) + 0.05 * sin(x / 2.3 + 1)) for x in range(-240, 241)]
    verts = [(x, y + 0.1 * z * (z < 1), z) for z in (0.02, 0.6, 4.6) for x, y in folds]
    n = len(folds)
    mesh_object("Curtain", verts, [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i)
                                   for j in range(2) for i in range(n - 1)], c["curtain"], smooth=True)
    hem = [[(x, y - 0.02, 0.16), (x + 0.01, y - 0.03, 0.0)] for x, y in folds[::2]]
    strands("Curtain fringe", hem, 0.011, c["fringe"], taper=1)
    for k in range(-4, 5):
        lathe(f"Footlight {k}", [(0.2, 0.0), (0.19, 0.1), (0.12, 0.19), (0.0, 0.22)], (0.62 * k, -2.9, 0), c["shell"],
              steps=16)


def chair(c):
    """A cane chair, his hat left on it."""
    root = group("Chair", (-1.35, 0.75, 0), 28)
    for x in (-0.19, 0.19):
        tube(f"Chair leg {x}", [(x, -0.19, 0), (x, -0.19, 0.45)], 0.02, c["wood"], smooth=1, parent=root)
        tube(f"Chair post {x}", [(x, 0.2, 0), (x, 0.19, 0.5), (1.05 * x, 0.27, 1.02)], 0.02, c["wood"], smooth=1,
             parent=root)
        tube(f"Chair rung {x}", [(x, -0.19, 0.2), (x, 0.2, 0.2)], 0.012, c["wood"], smooth=1, parent=root)
    for z, y in ((0.68, 0.215), (0.82, 0.235), (0.96, 0.262)):
        tube(f"Chair rail {z}", [(-0.2, y, z), (0, y + 0.03, z + 0.01), (0.2, y, z)], 0.022, c["wood"], parent=root)
    slab("Chair seat", [(-0.22, -0.22), (0.22, -0.22), (0.2, 0.22), (-0.2, 0.22)], 0.44, 0.475, c["straw"], bevel=0.015,
         parent=root)
    lathe("Hat", [(0, 0.13), (0.09, 0.13), (0.1, 0.115), (0.105, 0.03), (0.12, 0.012), (0.19, 0.0), (0.2, 0.012)],
          (0.02, -0.02, 0.48), c["black"], steps=32, turn=(4, -5, 0), parent=root)


def dancer(c):
    root = group("Dancer", (0.1, 0, 0), -16)
    legs(c, root)
    dress(c, root)
    arms(c, root)
    head(c, root)


def legs(c, root):
    tube("Leg right", [(-0.08, 0, 0.9), (-0.07, -0.02, 0.5), (-0.075, 0.02, 0.36), (-0.05, 0.03, 0.09)],
         [0.1, 0.062, 0.064, 0.036], c["skin"], parent=root)
    tube("Leg left", [(0.08, -0.02, 0.9), (0.0, -0.22, 0.56), (-0.1, -0.2, 0.4), (-0.24, -0.18, 0.13)],
         [0.1, 0.064, 0.062, 0.036], c["skin"], parent=root)
    for name, at, turn in (("right", (-0.05, 0.03, 0.05), (0, 0, 8)), ("left", (-0.25, -0.17, 0.1), (38, 12, -30))):
        foot = place(group(f"Shoe {name}", parent=root), at, turn)
        tube(f"Shoe body {name}", [(0, 0.05, 0.015), (0, -0.02, 0.0), (0, -0.11, -0.015), (0, -0.18, -0.03)],
             [0.036, 0.042, 0.042, 0.02], c["black"], flat=0.75, parent=foot)
        tube(f"Heel {name}", [(0, 0.04, 0.01), (0, 0.045, -0.05)], [0.024, 0.014], c["black"], parent=foot)


def skirt_at(t, a):
    """The skirt at the share `t` of its length and the angle `a`: it swings to her left and is lifted in front."""
    swing, lifted = 0.24 * t * t, max(0.0, cos(a + pi / 2 + 0.5)) ** 1.5
    r = 0.155 + 0.5 * t ** 0.85 * (1 + 0.3 * max(0, cos(a))) * (1 + 0.14 * t * sin(9 * a + 3 * t))
    drop = t * (0.68 - 0.34 * lifted) + 0.035 * t * sin(9 * a + 3 * t + 1.2)
    return swing + r * cos(a), 0.85 * r * sin(a), 1.02 - drop


def dress(c, root):
    loft_of = [[(x + a * cos(pi * j / 8), y + b * sin(pi * j / 8), z) for j in range(16)] for x, y, z, a, b in (
        (0, 0, 0.98, 0.155, 0.125), (0.01, 0, 1.06, 0.125, 0.1), (0.01, -0.01, 1.16, 0.13, 0.1),
        (0, -0.025, 1.27, 0.158, 0.125), (0, -0.01, 1.35, 0.165, 0.1), (0, 0.0, 1.385, 0.15, 0.085))]
    rings("Bodice", loft_of, c["dress"], parent=root)
    loops = [[skirt_at(k / 9, 2 * pi * j / 72) for j in range(72)] for k in range(9, -1, -1)]
    skirt = rings("Skirt", loops, [c["dress"], c["lining"]], capped=False, smooth=1, parent=root)
    modifier(skirt, "SOLIDIFY", thickness=0.012, material_offset=1)
    around = [skirt_at(0.06, 2 * pi * k / 24) for k in range(25)]
    tube("Sash", [(x * 1.05, y * 1.05, z + 0.02) for x, y, z in around], 0.032, c["sash"], parent=root)
    lines = []
    for k in range(90):
        points = [skirt_at(t, 2 * pi * k / 90 + 0.05 * sin(9 * k + 20 * t)) for t in (0.06, 0.16, 0.26, 0.36)]
        lines.append([(1.06 * x, 1.06 * y, z) for x, y, z in points])
    strands("Sash fringe", lines, 0.0065, c["sash"], taper=0.6, parent=root)


def arms(c, root):
    """One arm above the head with a fan, the other across the body."""
    tube("Shoulders", [(-0.2, 0.0, 1.35), (-0.1, 0, 1.39), (0, 0, 1.4), (0.1, 0, 1.4), (0.2, 0.0, 1.37)],
         [0.04, 0.058, 0.06, 0.058, 0.04], c["skin"], parent=root)
    tube("Arm left", [(0.17, 0, 1.36), (0.3, -0.05, 1.5), (0.37, -0.08, 1.66), (0.26, -0.13, 1.84),
                      (0.17, -0.16, 1.92)],
         [0.052, 0.046, 0.042, 0.032, 0.024], c["skin"], parent=root)
    tube("Arm right", [(-0.17, 0, 1.36), (-0.27, -0.06, 1.24), (-0.31, -0.15, 1.13), (-0.16, -0.25, 1.13),
                       (0.02, -0.25, 1.19)], [0.052, 0.046, 0.044, 0.034, 0.024], c["skin"], parent=root)
    tube("Hand left", [(0.175, -0.158, 1.91), (0.14, -0.17, 1.955), (0.08, -0.18, 1.97), (0.02, -0.19, 1.95)],
         [0.024, 0.038, 0.032, 0.01], c["skin"], flat=0.5, parent=root)
    tube("Hand right", [(0.01, -0.25, 1.187), (0.06, -0.245, 1.215), (0.11, -0.23, 1.25), (0.15, -0.21, 1.3)],
         [0.024, 0.038, 0.032, 0.01], c["skin"], flat=0.5, parent=root)
    fan = place(group("Fan", parent=root), (0.1, -0.19, 1.95), (8, 28, 0))
    ribs = [(sin(a), 0.012 * (k % 2), cos(a)) for k, a in enumerate(pi * (j / 14 - 0.5) * 0.85 for j in range(15))]
    verts = [Vector(p) * r for p in ribs for r in (0.1, 0.3)]
    cloth = mesh_object("Fan cloth", verts, [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(14)],
                        [c["dress"], c["lining"]], slot=lambda face: face % 2, parent=fan)
    modifier(cloth, "SOLIDIFY", thickness=0.003)
    strands("Fan ribs", [[(0, 0, 0), Vector(p) * 0.31] for p in ribs[::2]], 0.006, c["wood"], taper=1, parent=fan)


def head(c, root):
    tube("Neck", [(0, 0, 1.36), (0.005, -0.015, 1.5)], [0.056, 0.048], c["skin"], parent=root)
    top = place(group("Head", parent=root), (0.01, -0.03, 1.585), (8, 10, -34))
    ball("Face", (0, 0, 0), (0.092, 0.104, 0.122), c["skin"], parent=top)
    ball("Chin", (0, -0.045, -0.085), (0.045, 0.045, 0.04), c["skin"], parent=top)
    tube("Nose", [(0, -0.098, 0.03), (0, -0.118, -0.012), (0, -0.104, -0.022)], [0.01, 0.016, 0.012], c["skin"],
         parent=top)
    tube("Mouth", [(-0.026, -0.09, -0.06), (0.0, -0.1, -0.064), (0.026, -0.09, -0.06)], 0.0075, c["dress"], sides=6,
         parent=top)
    for s in (-1, 1):
        tube(f"Lid {s}", [(0.018 * s, -0.101, 0.008), (0.036 * s, -0.101, -0.001), (0.056 * s, -0.088, 0.006)], 0.0065,
             c["black"], sides=6, parent=top)
        tube(f"Brow {s}", [(0.018 * s, -0.101, 0.042), (0.04 * s, -0.098, 0.054), (0.064 * s, -0.082, 0.044)], 0.006,
             c["hair"], sides=6, parent=top)
    ball("Hair", (0, 0.03, 0.026), (0.104, 0.104, 0.118), c["hair"], parent=top)
    for k in range(5):
        a = 2 * pi * k / 5
        ball(f"Petal {k}", (-0.09, -0.035 + 0.03 * cos(a), 0.075 + 0.03 * sin(a)), (0.016, 0.024, 0.024), c["dress"],
             parent=top)
    hair(c, top)


def hair(c, top):
    """Flying out to her left as she turns: a few thick locks, and the single hairs about them."""
    rng = Random(6)

    def flying(spread):
        across, up = rng.uniform(-spread, spread), rng.uniform(-spread, spread)
        return [(0.02 + 0.16 * t + across * (0.4 + t) + 0.02 * sin(7 * t + up), 0.08 + 0.46 * t,
                 0.03 + up * (0.4 + t) - 0.34 * t * t + 0.12 * sin(3 * t)) for t in (k / 9 for k in range(10))]

    thick = [0.05, 0.052, 0.048, 0.043, 0.038, 0.032, 0.025, 0.018, 0.011, 0.003]
    for k in range(7):
        tube(f"Lock {k}", flying(0.1), thick, c["hair"], parent=top)
    lines = [flying(0.22) for _ in range(60)]
    lines += [[(0.105 * cos(a) * sin(b), 0.03 + 0.105 * sin(a) * sin(b), 0.026 + 0.12 * cos(b)) for b in
               (0.2 + 0.3 * j for j in range(4))] for a in (rng.uniform(0.2, 3) for _ in range(30))]
    strands("Single hairs", lines, 0.0028, c["hair"], taper=0.4, parent=top)


def build():
    c = colors()
    stage(c)
    chair(c)
    dancer(c)
    world(sky=(0.05, 0.03, 0.08), fill=(0.24, 0.20, 0.34))
    light("SPOT", "Limelight", (-2.6, -4.6, 4.8), (0.1, 0.2, 0.7), (1.0, 0.90, 0.66), 1500, spot_size=radians(34),
          spot_blend=0.01, shadow_soft_size=0.02)
    light("SPOT", "Blue light", (-6.5, 0.7, 3), (3, 2.2, 1.4), (0.6, 0.6, 1.0), 1800, spot_size=radians(70),
          shadow_soft_size=0.02)
    paint("thickness", ["Lid", "Brow", "Mouth", "Nose", "Petal", "Hand", "Fan", "Shoe", "Heel"], -0.5)
    paint("thickness", ["Single", "Sash fringe", "Curtain"], -0.65)
    paint("thickness", ["Chair", "Hat"], -0.3)
    paint("thickness", ["Skirt"], lambda co: 0.04 * ramp(co.z, 0.7, 0.3))
    paint("hatching", ["Curtain", "Skirt"], -0.5)
    paint("hatching", ["Face", "Nose", "Chin", "Neck", "Arm", "Hand", "Leg", "Shoulders", "Hair", "Lock", "Single"], -1)
    camera((-0.5, -5.8, 0.95), (0.05, 0, 1.1), 45)
    settings()


if __name__ == "__main__":
    build()
