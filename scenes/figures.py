# SPDX-License-Identifier: GPL-3.0-or-later
"""The people and animals of the scenes. Each stands on `at` and looks along −y before it is turned."""

from math import cos, pi, sin
from random import Random

from common import ball, box, group, lathe, loft, mesh_object, modifier, place, rings, strands, tube
from materials import flat, glow
from mathutils import Vector

# What a draughtsman gives a finer pen, and what he leaves unhatched; the starts of the objects' names.
SMALL = ("Eye", "Brow", "Mouth", "Nose", "Hand", "Thumb", "Button", "Placket", "Pocket", "Cat")
BARE = ("Face", "Nose", "Hair", "Hand", "Thumb")


def clothes():
    return {
        "coat": flat("Oilskin", (0.95, 0.53, 0.02)),
        "seam": flat("Oilskin seam", (0.62, 0.34, 0.03)),
        "skin": flat("Skin", (0.86, 0.56, 0.42)),
        "hair": flat("Hair", (0.20, 0.07, 0.04)),
        "trousers": flat("Trousers", (0.05, 0.08, 0.22)),
        "rubber": flat("Rubber", (0.05, 0.17, 0.22), mirror=0.1),
        "black": flat("Pupil", (0.02, 0.02, 0.03)),
        "cream": flat("Wool", (0.80, 0.74, 0.58)),
        "red": flat("Silk", (0.66, 0.06, 0.05)),
        "teal": flat("Teal wool", (0.06, 0.36, 0.38)),
        "steel": flat("Steel", (0.06, 0.09, 0.12)),
        "cane": flat("Cane", (0.36, 0.19, 0.09)),
    }


def girl(at, turn, rain=True):
    """A girl in oilskins, 1.45 high: striding, her right hand held out, in the rain under an umbrella."""
    root, c = group("Girl", at, turn), clothes()
    legs(c, root)
    coat(c, root)
    head(c, root)
    arms(c, root)
    scarf(c, root)
    if rain:
        umbrella(c, root)


def legs(c, root):
    for name, x, knee, ankle, lift, toe in (("right", -0.095, -0.13, -0.20, 0.0, 4),
                                            ("left", 0.095, 0.04, 0.17, 0.05, -14)):
        tube(f"Leg {name}", [(x, 0, 0.62), (x, knee, 0.42), (x, ankle, 0.2 + lift)], [0.085, 0.065, 0.06],
             c["trousers"], parent=root)
        tube(f"Boot {name}", [(x, ankle + 0.12 * knee - 0.02, 0.36 + lift), (x, ankle, 0.31 + lift),
                              (x, ankle, 0.2 + lift), (x, ankle, 0.09 + lift), (x, ankle, 0.03 + lift)],
             [0.088, 0.086, 0.07, 0.072, 0.06], c["rubber"], parent=root)
        foot = group(f"Ankle {name}", parent=root)
        place(foot, (x, ankle, lift), (toe, 0, 0))
        tube(f"Foot {name}", [(0, 0.07, 0.055), (0, 0, 0.065), (0, -0.1, 0.06), (0, -0.17, 0.052), (0, -0.2, 0.04)],
             [0.05, 0.068, 0.072, 0.066, 0.035], c["rubber"], flat=0.8, parent=foot)
        tube(f"Sole {name}", [(0, 0.08, 0.012), (0, -0.05, 0.012), (0, -0.21, 0.012)], [0.065, 0.068, 0.055],
             c["cream"], flat=0.25, smooth=1, parent=foot)


def coat(c, root):
    body = loft("Coat", [(0, 0.07, 0.40, 0.335, 0.30), (0, 0.06, 0.44, 0.32, 0.285), (0, 0.03, 0.58, 0.255, 0.22),
                         (0, 0, 0.74, 0.195, 0.16), (0, -0.005, 0.88, 0.19, 0.145), (0, 0, 0.98, 0.185, 0.125),
                         (0, 0.005, 1.035, 0.13, 0.10), (0, 0, 1.08, 0.085, 0.085)],
                c["coat"], sides=16, capped=False, parent=root)
    modifier(body, "SOLIDIFY", thickness=0.012)
    tube("Placket", [(0, -0.096, 1.02), (0, -0.148, 0.9), (0, -0.163, 0.74), (0, -0.2, 0.58), (0, -0.238, 0.42)],
         0.022, c["seam"], sides=6, flat=0.4, smooth=1, parent=root)
    for i, (y, z) in enumerate(((-0.15, 0.93), (-0.172, 0.8), (-0.188, 0.66), (-0.216, 0.53))):
        ball(f"Button {i}", (0.035, y, z), (0.02, 0.014, 0.02), c["cream"], parent=root)
    for side in (-1, 1):
        pocket = box(f"Pocket {side}", (0.14, 0.02, 0.055), (0, 0, 0), c["seam"], bevel=0.008, parent=root)
        place(pocket, (0.155 * side, -0.172, 0.6), (-12, 0, 34 * side))
    around = [pi * k / 8 for k in range(17)]
    tube("Collar", [(0.10 * sin(a), -0.005 - 0.10 * cos(a), 1.05 + 0.012 * cos(a)) for a in around], 0.035,
         c["seam"], parent=root)


def head(c, root):
    tube("Neck", [(0, 0, 1.02), (0, -0.01, 1.12)], 0.055, c["skin"], parent=root)
    top = place(group("Head", parent=root), (0, -0.02, 1.21), (-8, 0, 2))
    ball("Face", (0, 0, 0), (0.118, 0.122, 0.138), c["skin"], parent=top)
    ball("Hair", (0, 0.034, 0.0), (0.142, 0.124, 0.152), c["hair"], parent=top)
    ball("Nose", (0, -0.128, -0.018), (0.015, 0.02, 0.017), c["skin"], parent=top)
    tube("Mouth", [(-0.032, -0.108, -0.062), (0.0, -0.117, -0.075), (0.032, -0.108, -0.062)], 0.006, c["red"],
         sides=6, parent=top)
    for side in (-1, 1):
        ball(f"Eye {side}", (0.044 * side, -0.112, 0.012), (0.013, 0.01, 0.022), c["black"], parent=top)
        tube(f"Brow {side}", [(0.068 * side, -0.105, 0.05), (0.045 * side, -0.118, 0.06), (0.025 * side, -0.12, 0.055)],
             0.006, c["hair"], sides=6, parent=top)
        tube(f"Lock {side}", [(0.09 * side, -0.07, 0.10), (0.118 * side, -0.075, 0.0), (0.122 * side, -0.065, -0.09),
                              (0.09 * side, -0.085, -0.15)], [0.03, 0.038, 0.036, 0.008], c["hair"], parent=top)
    hat = lathe("Sou'wester", [(0.0, 0.165), (0.05, 0.16), (0.1, 0.135), (0.135, 0.085), (0.148, 0.035),
                               (0.158, 0.02), (0.2, -0.005), (0.25, -0.045)], (0, 0.02, 0.05), c["coat"], steps=32,
                turn=(-24, 0, 0), thick=-0.01, parent=top)
    hat.scale = (0.95, 1.08, 1)


def arms(c, root):
    tube("Sleeve right", [(-0.15, 0, 0.98), (-0.24, -0.05, 0.86), (-0.29, -0.22, 0.80), (-0.31, -0.33, 0.82)],
         [0.075, 0.085, 0.08, 0.075], c["coat"], parent=root)
    tube("Cuff right", [(-0.306, -0.31, 0.816), (-0.31, -0.33, 0.82), (-0.316, -0.365, 0.827)],
         [0.083, 0.088, 0.083], c["seam"], parent=root)
    tube("Hand right", [(-0.312, -0.35, 0.824), (-0.318, -0.42, 0.835), (-0.322, -0.5, 0.855), (-0.326, -0.6, 0.86)],
         [0.038, 0.062, 0.056, 0.022], c["skin"], flat=0.4, parent=root)
    tube("Thumb", [(-0.27, -0.42, 0.845), (-0.245, -0.47, 0.88), (-0.25, -0.505, 0.915)], [0.024, 0.022, 0.016],
         c["skin"], sides=6, parent=root)
    tube("Sleeve left", [(0.15, 0, 0.98), (0.25, 0.02, 0.85), (0.26, -0.05, 0.77), (0.19, -0.19, 0.84)],
         [0.075, 0.085, 0.08, 0.075], c["coat"], parent=root)
    tube("Cuff left", [(0.205, -0.165, 0.825), (0.19, -0.19, 0.84), (0.178, -0.213, 0.85)],
         [0.083, 0.088, 0.083], c["seam"], parent=root)
    ball("Hand left", (0.155, -0.235, 0.875), (0.05, 0.045, 0.055), c["skin"], parent=root)


def scarf(c, root):
    """Striped crosswise, ring by ring: once round the neck, and one end blown back."""
    stripes = {"slot": lambda loop, side: loop % 2, "parent": root}
    around = [pi * k / 9 for k in range(19)]
    tube("Scarf", [(0.105 * sin(a), -0.01 - 0.105 * cos(a), 1.085 + 0.02 * sin(a)) for a in around], 0.042,
         [c["teal"], c["cream"]], **stripes)
    tube("Scarf end", [(0.02 + 0.05 * k, 0.11 + 0.03 * k, 1.06 - 0.03 * k + 0.07 * sin(0.8 * k)) for k in range(12)],
         [0.05 + 0.003 * k for k in range(12)], [c["teal"], c["cream"]], flat=0.25, twist=90, **stripes)


def umbrella(c, root):
    """Open, eight panels in two colours; in its own frame the shaft is upright and the hand at the origin."""
    top = place(group("Umbrella", parent=root), (0.155, -0.235, 0.875), (-56, 16, 0))
    tube("Shaft", [(0, 0, -0.09), (0, 0, 1.04)], 0.011, c["cane"], sides=6, smooth=0, parent=top)
    tube("Crook", [(0, 0, -0.05), (0, 0, -0.12), (0.015, 0, -0.15), (0.045, 0, -0.16), (0.065, 0, -0.135),
                   (0.065, 0, -0.11)], 0.016, c["cane"], parent=top)
    dome = ((0.015, 0.94), (0.16, 0.925), (0.32, 0.87), (0.46, 0.77), (0.56, 0.63))
    loops = []
    for radius, height in dome:
        # Between two ribs the cloth is pulled in, the more so towards the rim.
        pull = [1 - 0.13 * radius * sin(pi * (k % 4) / 4) for k in range(32)]
        loops.append([(radius * p * cos(pi * k / 16), radius * p * sin(pi * k / 16), height)
                      for k, p in enumerate(pull)])
    cloth = rings("Canopy", loops, [c["red"], c["cream"]], slot=lambda loop, side: side // 4 % 2, smooth=1,
                  capped=False, parent=top)
    modifier(cloth, "SOLIDIFY", thickness=0.008)
    for k in range(8):
        x, y = cos(pi * k / 4), sin(pi * k / 4)
        tube(f"Rib {k}", [(r * x, r * y, h - 0.012) for r, h in dome], 0.007, c["steel"], sides=4, smooth=0, parent=top)
        tube(f"Stretcher {k}", [(0, 0, 0.62), (0.3 * x, 0.3 * y, 0.86)], 0.005, c["steel"], sides=4, smooth=0,
             parent=top)


def costume():
    return {
        "skin": flat("Skin", (0.80, 0.50, 0.35)),
        "hair": flat("Hair", (0.09, 0.04, 0.04)),
        "dress": flat("Dress", (0.72, 0.05, 0.07)),
        "lining": flat("Lining", (0.88, 0.80, 0.66)),
        "sash": flat("Sash", (0.08, 0.10, 0.24)),
        "black": flat("Black", (0.02, 0.02, 0.03)),
        "wood": flat("Fan wood", (0.36, 0.19, 0.09)),
    }


def dancer(at, turn):
    """A flamenco dancer, 1.7 high: legs crossed, a fan above her head, skirt and hair swinging to her left."""
    root, c = group("Dancer", at, turn), costume()
    dancers_legs(c, root)
    dress(c, root)
    dancers_arms(c, root)
    dancers_head(c, root)


def dancers_legs(c, root):
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
    loft("Bodice", [(0, 0, 0.98, 0.155, 0.125), (0.01, 0, 1.06, 0.125, 0.1), (0.01, -0.01, 1.16, 0.13, 0.1),
                    (0, -0.025, 1.27, 0.158, 0.125), (0, -0.01, 1.35, 0.165, 0.1), (0, 0, 1.385, 0.15, 0.085)],
         c["dress"], sides=16, parent=root)
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


def dancers_arms(c, root):
    """One arm above the head with a fan, the other across the body."""
    tube("Shoulders", [(-0.2, 0.0, 1.35), (-0.1, 0, 1.39), (0, 0, 1.4), (0.1, 0, 1.4), (0.2, 0.0, 1.37)],
         [0.04, 0.058, 0.06, 0.058, 0.04], c["skin"], parent=root)
    tube("Arm left", [(0.17, 0, 1.36), (0.3, -0.05, 1.5), (0.37, -0.08, 1.66), (0.26, -0.13, 1.84),
                      (0.17, -0.16, 1.92)], [0.052, 0.046, 0.042, 0.032, 0.024], c["skin"], parent=root)
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


def dancers_head(c, root):
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
    flying_hair(c, top)


def flying_hair(c, top):
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


def cat(at, turn):
    """A black cat, sitting; its tail hangs over the edge behind it."""
    root = group("Cat", at, turn)
    fur, eye = flat("Fur", (0.035, 0.03, 0.05)), glow("Cat's eye", (0.75, 0.90, 0.25))
    loft("Cat body", [(0, 0.07, 0.0, 0.085, 0.11), (0, 0.07, 0.06, 0.095, 0.12), (0, 0.04, 0.14, 0.075, 0.085),
                      (0, 0, 0.22, 0.055, 0.055), (0, -0.015, 0.27, 0.045, 0.045)], fur, parent=root)
    ball("Cat head", (0, -0.035, 0.315), (0.062, 0.058, 0.054), fur, parent=root)
    ball("Cat muzzle", (0, -0.085, 0.3), (0.028, 0.026, 0.022), fur, parent=root)
    for side in (-1, 1):
        lathe(f"Cat ear {side}", [(0.0, 0.065), (0.026, 0.0)], (0.036 * side, -0.03, 0.35), fur, steps=8,
              turn=(8, 16 * side, 0), parent=root)
        ball(f"Cat eye {side}", (0.026 * side, -0.083, 0.325), (0.011, 0.008, 0.012), eye, parent=root)
        tube(f"Cat leg {side}", [(0.032 * side, -0.03, 0.2), (0.034 * side, -0.055, 0.1), (0.034 * side, -0.06, 0.02),
                                 (0.034 * side, -0.09, 0.012)], [0.03, 0.024, 0.022, 0.02], fur, parent=root)
        ball(f"Cat thigh {side}", (0.075 * side, 0.06, 0.06), (0.04, 0.085, 0.07), fur, parent=root)
    tube("Cat tail", [(0, 0.16, 0.02), (0.06, 0.24, 0.0), (0.1, 0.27, -0.1), (0.1, 0.27, -0.22), (0.12, 0.26, -0.3),
                      (0.16, 0.25, -0.32)], [0.024, 0.023, 0.022, 0.021, 0.02, 0.012], fur, parent=root)
