# SPDX-License-Identifier: GPL-3.0-or-later
"""A dancer in the limelight: crossed limbs, a turning skirt, loose hair and a fringe.

What is hard for lines here: skin before skin, where neither colour nor object parts an arm from the neck behind it,
single hairs of a pixel and less, and the many soft folds of one cloth. She stands at the origin and looks along −y.
"""

from math import radians, sin

from common import camera, group, lathe, light, mesh_object, paint, ramp, settings, slab, strands, tube, world
from figures import dancer
from materials import bricks, flat


def colors():
    return {
        "boards": bricks("Boards", (0.52, 0.30, 0.16), (0.58, 0.35, 0.19), (0.20, 0.10, 0.07), (2.6, 0.24, 0.008)),
        "curtain": flat("Curtain", (0.44, 0.06, 0.12)),
        "gold": flat("Gold", (0.80, 0.55, 0.16)),
        "black": flat("Black", (0.02, 0.02, 0.03)),
        "wood": flat("Wood", (0.36, 0.19, 0.09)),
        "straw": flat("Straw", (0.82, 0.62, 0.28)),
    }


def stage(c):
    slab("Boards", [(-8, -3.2), (8, -3.2), (8, 4), (-8, 4)], -0.3, 0, c["boards"])
    folds = [(x / 40, 2.0 + 0.13 * sin(x / 5.2) + 0.05 * sin(x / 2.3 + 1)) for x in range(-240, 241)]
    verts = [(x, y + 0.1 * z * (z < 1), z) for z in (0.02, 0.6, 4.6) for x, y in folds]
    n = len(folds)
    mesh_object("Curtain", verts, [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i)
                                   for j in range(2) for i in range(n - 1)], c["curtain"], smooth=True)
    hem = [[(x, y - 0.02, 0.16), (x + 0.01, y - 0.03, 0.0)] for x, y in folds[::2]]
    strands("Curtain fringe", hem, 0.011, c["gold"], taper=1)


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


def build():
    c = colors()
    stage(c)
    chair(c)
    dancer((0.1, 0, 0), -16)
    world(sky=(0.05, 0.03, 0.08), fill=(0.24, 0.20, 0.34))
    light("SPOT", "Limelight", (-2.6, -4.6, 4.8), (0.1, 0.2, 0.7), (1.0, 0.90, 0.66), 2100, spot_size=radians(34),
          spot_blend=0.01, shadow_soft_size=0.02)
    light("SPOT", "Blue light", (-6.5, 0.7, 4.2), (3, 2.3, 3.2), (0.6, 0.6, 1.0), 1800, spot_size=radians(70),
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
