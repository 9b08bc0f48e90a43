# SPDX-License-Identifier: GPL-3.0-or-later
"""A street corner at night: a girl stops in the lamplight, and a cat looks back.

The camera stands on the road and looks up the side street. x is to the right, y away; the corner house begins at
(1.6, 0.6). The light is set for three flat tones: sky and moon leave all in blue shade, the lamp cuts a warm pool.
"""

from itertools import pairwise
from math import cos, pi, radians, sin

from common import (
    HEXAHEDRON,
    box,
    camera,
    group,
    lathe,
    light,
    mesh_object,
    modifier,
    paint,
    ramp,
    repeat,
    settings,
    slab,
    text,
    tube,
    world,
)
from figures import cat, girl
from materials import bricks, flat, glow, rippled
from mathutils import Vector

EYE = Vector((-1.5, -7.6, 1.4))
LAMP = Vector((-0.12, -0.46, 0))
FRONT = 0.56  # where the shop's front stands, just before the wall


def colors():
    water = {"color": (0.08, 0.10, 0.20), "mirror": 0.75}
    return {
        "asphalt": bricks("Asphalt", (0.26, 0.27, 0.38), (0.32, 0.33, 0.43), (0.20, 0.20, 0.32), (0.42, 0.2, 0.02)),
        "paving": bricks("Paving", (0.62, 0.56, 0.53), (0.72, 0.65, 0.60), (0.40, 0.36, 0.42), (0.6, 0.6, 0.015)),
        "sky water": rippled("Sky water", **water, height=0.12, length=0.35),
        "lamp water": rippled("Lamp water", **water, height=0.16, length=0.2, lean=0.42),
        "shop water": rippled("Shop water", **water, height=0.12, length=0.12, lean=0.22),
        "kerb": flat("Kerb", (0.68, 0.64, 0.64)),
        "wall": flat("Wall", (0.23, 0.19, 0.34)),
        "stone": flat("Stone", (0.45, 0.42, 0.50)),
        "brick": flat("Brick", (0.42, 0.16, 0.14)),
        "pale brick": flat("Pale brick", (0.50, 0.24, 0.18)),
        "tile": flat("Tile", (0.06, 0.20, 0.24)),
        "pale tile": flat("Pale tile", (0.55, 0.56, 0.50)),
        "wood": flat("Wood", (0.36, 0.19, 0.09)),
        "dark wood": flat("Dark wood", (0.22, 0.11, 0.06)),
        "card": flat("Card", (0.46, 0.32, 0.18)),
        "iron": flat("Iron", (0.06, 0.09, 0.12)),
        "zinc": flat("Zinc", (0.30, 0.36, 0.42)),
        "green": flat("Shop paint", (0.05, 0.22, 0.22)),
        "cream": flat("Cream", (0.80, 0.74, 0.58)),
        "red": flat("Red", (0.66, 0.06, 0.05)),
        "navy": flat("Navy", (0.05, 0.08, 0.22)),
        "black": flat("Black", (0.02, 0.02, 0.03)),
        "far": flat("Far wall", (0.22, 0.25, 0.48)),
        "farther": flat("Farther wall", (0.21, 0.26, 0.52)),
        "roof": flat("Roof", (0.20, 0.18, 0.36)),
        "dark glass": flat("Dark glass", (0.05, 0.07, 0.18), mirror=0.2),
        "lit glass": glow("Lit glass", (0.95, 0.63, 0.19)),
        "shop glass": glow("Shop glass", (0.90, 0.65, 0.27)),
        "lamp glass": glow("Lamp glass", (1.40, 1.20, 0.67)),
    }


def road(c):
    slab("Road", [(-20, -12), (20, -12), (20, 30), (-20, 30)], -0.1, 0, c["asphalt"])
    corner = [(0.3 - cos(pi * k / 20), 0.3 - sin(pi * k / 20)) for k in range(11)]
    slab("Pavement", [(-0.7, 30), *corner, (14, -0.7), (14, 30)], 0, 0.14, c["paving"])
    for i, outline in enumerate(kerb()):
        slab(f"Kerb {i}", outline, 0, 0.16, c["kerb"], bevel=0.015)
    puddles = ((-0.5, -1.66, 0.95, 0.46, 8, "lamp"), (2.2, -1.45, 0.85, 0.26, -6, "shop"),
               (-1.75, 0.9, 0.6, 0.9, 30, "sky"), (-2.3, 5.0, 0.7, 1.6, 0, "sky"))
    for i, (x, y, w, d, turn, kind) in enumerate(puddles):
        slab(f"Puddle {i}", puddle(x, y, w, d, radians(turn), i), 0, 0.004, c[kind + " water"])


def kerb():
    """The stones' outlines, down the side street, round the corner and along the front."""
    joints = [((-0.9, 0.5 + 1.2 * k), (-0.7, 0.5 + 1.2 * k)) for k in range(13, -1, -1)]
    joints += [((0.3 - 1.2 * cos(pi * k / 12), 0.3 - 1.2 * sin(pi * k / 12)),
                (0.3 - cos(pi * k / 12), 0.3 - sin(pi * k / 12))) for k in range(7)]
    joints += [((0.5 + 1.2 * k, -0.9), (0.5 + 1.2 * k, -0.7)) for k in range(6)]
    return [(a, b, d, c) for (a, c), (b, d) in pairwise(joints)]


def puddle(x, y, w, d, turn, seed):
    """A wavy outline of half width `w` and half depth `d`."""
    points = []
    for k in range(48):
        a = pi * k / 24
        r = 1 + 0.16 * sin(2 * a + seed) + 0.10 * sin(3 * a + 2.1 * seed) + 0.05 * sin(5 * a + 3.7 * seed)
        u, v = w * r * cos(a), d * r * sin(a)
        points.append((x + u * cos(turn) - v * sin(turn), y + u * sin(turn) + v * cos(turn)))
    return points


def lamp(c):
    """A cast-iron street lamp. Its glass throws no shadow: the light hangs inside."""
    root = group("Lamp", LAMP)
    lathe("Lamp foot", [(0, 0.5), (0.06, 0.5), (0.08, 0.42), (0.07, 0.36), (0.12, 0.28), (0.15, 0.1), (0.19, 0.08),
                        (0.2, 0)], (0, 0, 0.14), c["iron"], parent=root)
    lathe("Lamp post", [(0.03, 1.95), (0.045, 1.3), (0.07, 1.28), (0.07, 1.22), (0.05, 1.2), (0.055, 0.4)],
          (0, 0, 0.14), c["iron"], parent=root)
    lathe("Lamp collar", [(0.035, 0), (0.08, 0.03), (0.08, 0.07), (0.04, 0.1), (0.06, 0.18), (0, 0.18)],
          (0, 0, 2.05), c["iron"], parent=root)
    lathe("Lamp hood", [(0, 0.34), (0.02, 0.3), (0.035, 0.26), (0.02, 0.22), (0.07, 0.2), (0.1, 0.12), (0.26, 0),
                        (0.24, -0.02), (0, -0.02)], (0, 0, 2.66), c["iron"], parent=root)
    tube("Lamp arm", [(-0.26, 0, 1.96), (0.26, 0, 1.96)], 0.018, c["iron"], sides=6, smooth=0, parent=root)
    for k in range(6):
        x, y = cos(pi * k / 3), sin(pi * k / 3)
        tube(f"Lamp bar {k}", [(0.115 * x, 0.115 * y, 2.23), (0.2 * x, 0.2 * y, 2.66)], 0.012, c["iron"], sides=4,
             smooth=0, parent=root)
    glass = lathe("Lamp glass", [(0.1, 0), (0.19, 0.42), (0, 0.42)], (0, 0, 2.23), c["lamp glass"], steps=6,
                  parent=root)
    glass.visible_shadow = glass.visible_diffuse = False


def pane(name, size, at, material, parent=None):
    """A lit window. The lamp alone lights the scene: light from many panes would be noise."""
    glass = box(name, size, at, material, bevel=0, parent=parent)
    glass.visible_diffuse = False
    return glass


def house(c):
    """The corner house: walls, quoins, windows, pipes, wires."""
    box("House", (6, 12, 8), (4.6, 6.6, 0.1), c["wall"], bevel=0)
    box("Plinth", (6.12, 12.12, 0.62), (4.6, 6.6, 0.1), c["stone"], bevel=0.03)
    box("Cornice", (6.2, 12.2, 0.16), (4.6, 6.6, 3.55), c["stone"], bevel=0.04)
    for i in range(7):
        side = 0.42 if i % 2 else 0.28
        box(f"Quoin {i}", (side, side, 0.36), (1.56 + side / 2, 0.56 + side / 2, 0.74 + 0.4 * i), c["stone"])
    bare_bricks(c)
    for i, y in enumerate((2.6, 5.0, 7.4)):
        window(c, f"Window {i}", y, lit=i == 1)
    tube("Drain", [(1.5, 0.95, 5), (1.5, 0.95, 0.75), (1.46, 0.95, 0.5), (1.36, 0.95, 0.36)], 0.06, c["zinc"],
         smooth=1)
    for i, z in enumerate((0.9, 2.1, 3.3)):
        lathe(f"Drain ring {i}", [(0.06, 0), (0.078, 0), (0.078, 0.06), (0.06, 0.06)], (1.5, 0.95, z), c["zinc"])
    tube("Gas pipe", [(1.55, 4.3, 0.2), (1.55, 4.3, 0.95), (1.55, 4.25, 1.0), (1.55, 3.7, 1.0)], 0.03, c["red"],
         sides=6, smooth=1)
    box("Meter", (0.22, 0.4, 0.5), (1.5, 3.6, 0.85), c["zinc"], bevel=0.02)
    box("Poster", (0.02, 0.62, 0.86), (1.585, 1.7, 1.15), c["cream"], bevel=0)
    box("Poster band", (0.02, 0.62, 0.3), (1.58, 1.7, 1.52), c["red"], bevel=0)
    for i, (z, sag) in enumerate(((3.7, 0.5), (3.95, 0.7))):
        tube(f"Wire {i}", [(1.6 - 0.52 * k, 4.0 + 0.45 * k, z + 0.04 * k + sag * ((k / 5 - 1) ** 2 - 1))
                           for k in range(11)], 0.012, c["black"], sides=4, smooth=0)


def bare_bricks(c):
    """A few bricks that show through the plaster; the eye adds the rest of the wall."""
    verts, faces = [], []
    for x, z, count in ((2.05, 1.88, 1), (2.2, 2.0, 1), (2.9, 3.02, 2), (3.04, 3.14, 3), (3.2, 3.26, 1),
                        (4.45, 3.14, 2), (4.3, 3.26, 2)):
        for left in (x + 0.28 * k for k in range(count)):
            faces += [[len(verts) + i for i in face] for face in HEXAHEDRON]
            verts += [(i, j, k) for k in (z, z + 0.09)
                      for i, j in ((left, 0.575), (left + 0.25, 0.575), (left + 0.25, 0.61), (left, 0.61))]
    mesh_object("Bare bricks", verts, faces, [c["brick"], c["pale brick"]], slot=lambda face: face // 6 % 3 == 1)


def window(c, name, y, lit):
    """A window in the wall along the side street."""
    root = group(name, (1.6, y, 1.2))
    if lit:
        pane("Lit " + name, (0.04, 0.8, 1.2), (-0.01, 0, 0), c["lit glass"], root)
    else:
        box("Dark " + name, (0.04, 0.8, 1.2), (-0.01, 0, 0), c["dark glass"], bevel=0, parent=root)
    repeat(box(name + " jamb", (0.07, 0.07, 1.3), (-0.02, -0.44, -0.05), c["cream"], parent=root), 3, (0, 0.44, 0))
    repeat(box(name + " bar", (0.07, 0.95, 0.06), (-0.02, 0, -0.05), c["cream"], parent=root), 3, (0, 0, 0.62))
    box(name + " sill", (0.26, 1.1, 0.08), (-0.05, 0, -0.13), c["stone"], parent=root)


def shop(c):
    """The stationer's: a lit window with ink bottles, tiles below it, an awning and a hanging sign."""
    box("Shop front", (2.9, 0.1, 2.5), (3.75, FRONT, 0.14), c["green"], bevel=0.02)
    pane("Lit shop window", (2.3, 0.06, 1.35), (3.8, FRONT - 0.04, 0.95), c["shop glass"])
    repeat(box("Shop bar", (0.06, 0.1, 1.42), (2.63, FRONT - 0.06, 0.92), c["green"]), 4, (0.78, 0, 0))
    box("Shop rail", (2.4, 0.1, 0.06), (3.8, FRONT - 0.06, 1.88), c["green"])
    box("Shop sill", (2.6, 0.24, 0.07), (3.8, FRONT - 0.12, 0.86), c["cream"])
    bottles = ((2.78, 0, 0.07, 0.30), (2.98, 0, 0.05, 0.2), (3.2, 0, 0.085, 0.26), (3.62, 0, 0.06, 0.34),
               (3.85, 0, 0.09, 0.2), (4.05, 0, 0.05, 0.28), (2.8, 1, 0.08, 0.16), (3.0, 1, 0.08, 0.16),
               (3.2, 1, 0.05, 0.24), (3.7, 1, 0.07, 0.2), (3.95, 1, 0.05, 0.26))
    for i, (x, shelf, r, h) in enumerate(bottles):
        lathe(f"Bottle {i}", [(0, h), (0.35 * r, h), (0.35 * r, 0.72 * h), (r, 0.6 * h), (r, 0), (0, 0)],
              (x, FRONT - 0.1, 0.93 + 1.01 * shelf), c["navy" if i % 2 else "red"], steps=12)
    tiles(c)
    awning(c)
    tube("Sign arm", [(1.6, 1.3, 3.0), (0.55, 1.3, 3.0)], 0.02, c["iron"], sides=6, smooth=0)
    tube("Sign curl", [(1.6, 1.3, 2.5), (1.35, 1.3, 2.7), (1.2, 1.3, 2.88), (1.05, 1.3, 3.0)], 0.014, c["iron"],
         sides=6, smooth=1)
    box("Sign", (0.95, 0.06, 0.42), (0.98, 1.3, 2.42), c["green"], bevel=0.02)
    box("Sign field", (0.87, 0.07, 0.34), (0.98, 1.3, 2.46), c["cream"], bevel=0.01)
    text("Letters", "ENCRE", (0.98, 1.255, 2.54), 0.26, c["navy"])


def tiles(c):
    """A chequered band under the shop window."""
    size, across, up = 0.135, 20, 4
    verts = [(2.4 + size * i, FRONT - 0.075, 0.3 + size * j) for j in range(up + 1) for i in range(across + 1)]
    lower_left = [j * (across + 1) + i for j in range(up) for i in range(across)]
    mesh_object("Tiles", verts, [(k, k + 1, k + across + 2, k + across + 1) for k in lower_left],
                [c["tile"], c["pale tile"]], slot=lambda face: (face % across + face // across) % 2)


def awning(c):
    """Sloping cloth in broad stripes, one scallop to a stripe."""
    stripes, cells = 11, 6
    verts, faces = [], []
    for i in range(stripes * cells + 1):
        x, scallop = 2.25 + 3.1 * i / (stripes * cells), 0.07 * abs(sin(pi * i / cells))
        verts += [(x, FRONT - 0.05, 2.78), (x, FRONT - 0.9, 2.42), (x, FRONT - 0.9, 2.26 - scallop)]
    for k in range(0, len(verts) - 3, 3):
        faces += [(k, k + 1, k + 4, k + 3), (k + 1, k + 2, k + 5, k + 4)]
    cloth = mesh_object("Awning", verts, faces, [c["red"], c["cream"]], slot=lambda face: face // 2 // cells % 2)
    modifier(cloth, "SOLIDIFY", thickness=0.015)


def foreground(c):
    """Crates, a barrel and the cat, close to the viewer."""
    crate(c, "Crate low", (-1.6, -4.25, 0), (0.62, 0.55, 0.46), 12)
    crate(c, "Crate high", (-1.63, -4.22, 0.485), (0.5, 0.42, 0.26), 24)
    cat((-1.58, -4.24, 0.77), 62)
    lathe("Barrel", [(0, 0.62), (0.19, 0.62), (0.19, 0.66), (0.215, 0.66), (0.25, 0.5), (0.265, 0.33), (0.25, 0.16),
                     (0.215, 0)], (-2.05, -1.3, 0), c["wood"], steps=20)
    for i, (z, r) in enumerate(((0.1, 0.245), (0.22, 0.262), (0.42, 0.263), (0.54, 0.246))):
        lathe(f"Hoop {i}", [(r, 0), (r + 0.012, 0), (r + 0.012, 0.045), (r, 0.045)], (-2.05, -1.3, z), c["iron"])


def crate(c, name, at, size, turn):
    """Planks round a dark inside, posts in the corners, three boards on top."""
    root, (w, d, h) = group(name, at, turn), size
    box(name + " inside", (w - 0.04, d - 0.04, h - 0.02), (0, 0, 0.01), c["dark wood"], bevel=0, parent=root)
    count = round(h / 0.13)
    repeat(box(name + " plank", (w, d, h / count - 0.018), (0, 0, 0), c["wood"], parent=root), count, (0, 0, h / count))
    repeat(box(name + " board", (w + 0.03, d / 3, 0.025), (0, -d / 3 - 0.012, h), c["wood"], parent=root), 3,
           (0, d / 3 + 0.012, 0))
    for side in (-1, 1):
        post = box(f"{name} post {side}", (0.07, 0.07, h), (side * (w / 2 - 0.025), 0.025 - d / 2, 0), c["wood"],
                   parent=root)
        repeat(post, 2, (0, d - 0.05, 0))


def clutter(c):
    """What stands about on the pavement."""
    box("Box big", (0.62, 0.5, 0.46), (3.6, 0.12, 0.14), c["card"], turn=-8)
    box("Box flat", (0.5, 0.4, 0.22), (3.56, 0.14, 0.6), c["card"], turn=10)
    box("Box tape", (0.52, 0.09, 0.235), (3.56, 0.14, 0.593), c["cream"], turn=10, bevel=0)
    lathe("Bin", [(0, 0.72), (0.05, 0.72), (0.06, 0.68), (0.22, 0.64), (0.235, 0.6), (0.2, 0.6), (0.17, 0), (0, 0)],
          (1.15, 2.9, 0.14), c["zinc"])
    for i, (x, y) in enumerate(((2.95, -0.6), (4.5, -0.6), (-0.72, 2.7))):
        lathe(f"Bollard {i}", [(0, 0.78), (0.05, 0.76), (0.065, 0.7), (0.05, 0.64), (0.06, 0.6), (0.075, 0.08),
                               (0.1, 0.05), (0.1, 0)], (x, y, 0.14), c["iron"])


def background(c):
    """Flat houses down the side street, with lit windows."""
    box("Far row", (4, 14, 6.4), (-5.6, 13.4, 0), c["far"], bevel=0)
    box("Far row roof", (4.3, 14.3, 0.25), (-5.6, 13.4, 6.3), c["roof"], bevel=0)
    windows = pane("Lit far row", (0.06, 0.9, 1.3), (-3.6, 7.6, 1.3), c["lit glass"])
    repeat(repeat(windows, 3, (0, 3.4, 0)), 2, (0, 0, 2.5))
    for i, (x, w, h) in enumerate(((-7.0, 4.0, 5.2), (-3.2, 3.6, 6.6), (0.2, 3.2, 5.0), (3.4, 3.4, 7.2))):
        far_house(c, f"Far house {i}", x, 22 + i % 2, w, h)


def far_house(c, name, x, y, w, h):
    box(name, (w, 3, h), (x, y, 0), c["farther"], bevel=0)
    box(name + " chimney", (0.45, 0.45, 1.5), (x + w / 4, y - 0.4, h + 0.4), c["farther"], bevel=0)
    repeat(pane("Lit " + name, (0.55, 0.1, 0.9), (x - w / 4, y - 1.5, h - 1.8), c["lit glass"]), 2, (w / 2, 0, 0))
    verts = [(x + side * (w / 2 + 0.2), y + j, h + k) for side in (-1, 1) for j, k in ((-1.7, 0), (0, 1.5), (1.7, 0))]
    mesh_object(name + " roof", verts, [(0, 3, 4, 1), (1, 4, 5, 2), (0, 1, 2), (3, 5, 4), (0, 2, 5, 3)], c["roof"])


def lights():
    """All three together are below 0.5 in the shade, the first tone's end, and above 0.9 under the lamp."""
    world(sky=(0.045, 0.075, 0.27), fill=(0.18, 0.21, 0.37))
    bulb = LAMP + Vector((0, 0, 2.6))
    light("SPOT", "Lamplight", bulb, LAMP, (1.0, 0.77, 0.38), 400, spot_size=radians(100), spot_blend=0.02,
          shadow_soft_size=0.03)
    light("SUN", "Moonlight", (-7, -4.5, 1.6), (0, 0, 0), (0.5, 0.62, 1.0), 1.5, angle=radians(0.5))


def controls():
    """What a comic artist would do by hand, painted on the meshes."""
    def distance(co):
        return (co - EYE).length

    # A bold pencil near the viewer, a fine one far away, for small things, and for the face.
    paint("thickness", ["Crate", "Barrel", "Hoop"], lambda co: 0.06 * ramp(distance(co), 5, 3))
    paint("thickness", ["Far", "Lit", "Dark"], lambda co: -0.45 * ramp(distance(co), 6, 18))
    paint("thickness", ["Sign", "Window", "Wire", "Collar", "Hair", "Lock", "Face", "Puddle", "Bare",
                        "Bottle", "Lamp bar", "Placket", "Pocket", "Cat"], -0.3)
    paint("thickness", ["Eye", "Brow", "Mouth", "Nose", "Hand", "Thumb", "Crook", "Rib", "Stretcher", "Button",
                        "Cat eye", "Letters"], -0.55)
    # The glare of the lamp eats at the lines of the kerb beside it, and leaves enough for what stands there to have a
    # foot.
    paint("intensity", ["Kerb"], lambda co: -0.06 * ramp((co - LAMP).length, 1.5, 0.8))
    paint("thickness", ["Kerb"], lambda co: min(-0.6 * ramp((co - LAMP).length, 1.5, 0.8),
                                                -0.45 * ramp(distance(co), 6, 18)))
    # What is wet runs a little over its outline.
    paint("smudge_range", ["Canopy", "Coat", "Sou'wester"], lambda co: 0.9 * ramp(co.z, 0.3, 0.6))
    paint("smudge_falloff", ["Canopy", "Coat", "Sou'wester"], 0.4)
    # No hatching on water, lit glass and the face; little in the mist at the end of the street.
    paint("hatching", ["Puddle", "Face", "Nose", "Hair", "Hand", "Thumb", "Canopy"], -1)
    paint("hatching", ["Far", "House", "Plinth"], lambda co: -0.35 * ramp(co.y, 4, 9) - 0.3 * ramp(co.z, 1, 4))
    paint("hatching", ["Bottle", "Tiles", "Kerb"], -0.5)
    paint("hatching", ["Cat"], lambda co: -0.5 * ramp(co.z, 0.8, 1.05))


def build():
    c = colors()
    road(c)
    lamp(c)
    house(c)
    shop(c)
    girl((1.1, -0.58, 0.14), -58)
    foreground(c)
    clutter(c)
    background(c)
    lights()
    controls()
    camera(EYE, (0.4, 0.0, 1.4), 44, shift=(0, -0.018))
    settings()


if __name__ == "__main__":
    build()
