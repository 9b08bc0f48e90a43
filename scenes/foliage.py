# SPDX-License-Identifier: GPL-3.0-or-later
"""A garden gate in the afternoon: a tree with a swing, a hedge, grass, and a cat on the fence.

What is hard for lines here: thousands of leaves, each cut out of a card, blades of grass thinner than a pixel, and
the gaps between the pales. The camera stands on the path; x is to the right, y away; the fence runs along y = 0.
"""

from math import cos, pi, radians, sin
from random import Random

from common import (
    ball,
    box,
    camera,
    cards,
    group,
    light,
    mesh_object,
    paint,
    place,
    ramp,
    repeat,
    settings,
    slab,
    strands,
    tube,
    world,
)
from figures import cat
from materials import flat, glow, leaf
from mathutils import Vector

EYE = Vector((0.5, -6.6, 1.2))
TREE = Vector((-2.5, 1.9, 0))


def colors():
    return {
        "lawn": flat("Lawn", (0.30, 0.47, 0.10)),
        "meadow": flat("Meadow", (0.50, 0.58, 0.16)),
        "hill": flat("Hill", (0.22, 0.42, 0.36)),
        "blade": flat("Blade", (0.24, 0.42, 0.08)),
        "shrub": flat("Shrub", (0.06, 0.15, 0.08)),
        "hedge": leaf("Hedge leaf", (0.10, 0.26, 0.10)),
        "light hedge": leaf("Light hedge leaf", (0.17, 0.36, 0.10)),
        "bark": flat("Bark", (0.30, 0.17, 0.11)),
        "path": flat("Path", (0.72, 0.62, 0.46)),
        "stone": flat("Stone", (0.62, 0.58, 0.58)),
        "paint": flat("Paint", (0.88, 0.86, 0.80)),
        "wall": flat("Wall", (0.85, 0.72, 0.55)),
        "roof": flat("Roof", (0.62, 0.17, 0.09)),
        "blue": flat("Blue", (0.10, 0.26, 0.46)),
        "rope": flat("Rope", (0.55, 0.42, 0.24)),
        "poppy": leaf("Poppy", (0.80, 0.07, 0.04), width=1),
        "cloud": glow("Cloud", (0.95, 0.95, 0.92)),
    }


def ground(c):
    slab("Lawn", [(-30, -9), (30, -9), (30, 14), (-30, 14)], -0.2, 0, c["lawn"])
    slab("Meadow", [(-60, 14), (60, 14), (60, 60), (-60, 60)], -0.3, -0.1, c["meadow"])
    edge = [(0.55 + 0.9 * sin(0.25 * (y + 7)), y) for y in (k / 4 for k in range(-36, 57))]
    slab("Path", [(x + 0.55, y) for x, y in edge] + [(x - 0.55, y) for x, y in reversed(edge)], 0, 0.012, c["path"])
    for x, y, w in ((-30, 75, 34), (26, 82, 40), (75, 78, 30)):
        ball(f"Hill {x}", (x, y, -4), (w, 14, 0.34 * w), c["hill"])
    for k, (x, z, w) in enumerate(((34, 50, 20), (48, 47, 12), (13, 27, 9))):
        ball(f"Cloud {k}", (x, 130, z), (w, 3, 0.32 * w), c["cloud"])


def house(c):
    root = group("Cottage", (7.2, 9.5, 0), -12)
    box("Cottage walls", (5.4, 4.4, 2.5), (0, 0, 0), c["wall"], bevel=0, parent=root)
    verts = [(x, y, z) for x in (-2.95, 2.95) for y, z in ((-2.6, 2.35), (0, 4.5), (2.6, 2.35))]
    mesh_object("Cottage roof", verts, [(0, 3, 4, 1), (1, 4, 5, 2), (0, 1, 2), (3, 5, 4), (0, 2, 5, 3)], c["roof"],
                parent=root)
    box("Chimney", (0.55, 0.55, 1.4), (1.4, 0.4, 3.7), c["stone"], parent=root)
    for k in (-1.5, 1.2):
        box(f"Cottage window {k}", (0.95, 0.08, 1.1), (k, -2.2, 1.0), c["blue"], bevel=0, parent=root)
        repeat(box(f"Cottage frame {k}", (0.07, 0.1, 1.2), (k - 0.48, -2.22, 0.95), c["paint"], parent=root), 3,
               (0.48, 0, 0))


def fence(c):
    """White pales with a gap for the gate, which stands open."""
    for name, left, count in (("left", -6.4, 30), ("right", 1.72, 30)):
        outline = [(0, 0), (0.11, 0), (0.11, 0.86), (0.055, 0.97), (0, 0.86)]
        pale = slab(f"Pale {name}", outline, 0, 0.03, c["paint"])
        repeat(place(pale, (left, 0, 0.08), (90, 0, 0)), count, (0.2, 0, 0))
        for z in (0.28, 0.72):
            box(f"Rail {name} {z}", (0.2 * count, 0.04, 0.07), (left + 0.1 * count, 0.02, z), c["paint"])
    for x in (-0.42, 1.6):
        box(f"Post {x}", (0.15, 0.15, 1.15), (x, 0, 0), c["paint"])
        box(f"Post cap {x}", (0.23, 0.23, 0.05), (x, 0, 1.15), c["paint"], bevel=0.015)
    gate = group("Gate", (-0.36, 0.04, 0), 68)
    repeat(box("Gate pale", (0.1, 0.03, 0.82), (0.1, 0, 0.14), c["paint"], parent=gate), 9, (0.21, 0, 0))
    for z in (0.3, 0.76):
        box(f"Gate rail {z}", (1.85, 0.04, 0.07), (0.94, 0.03, z), c["paint"], parent=gate)


def shell(rng, count, middle, radii):
    """Spots for leaves just inside an ellipsoid: each hangs outward and down."""
    for _ in range(count):
        out = Vector((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1))).normalized()
        foot = Vector(middle) + Vector(o * r for o, r in zip(out, radii, strict=True)) * rng.uniform(0.82, 1)
        up = out + Vector((rng.gauss(0, 0.5), rng.gauss(0, 0.5), rng.gauss(-0.45, 0.4)))
        yield foot, up, up.cross((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)))


def tree(c):
    """Trunk, boughs, and a crown of five masses of leaves; their hearts throw the shadow."""
    rng, x, y = Random(3), TREE.x, TREE.y
    tube("Trunk", [(x, y, -0.05), (x + 0.03, y, 0.3), (x + 0.1, y, 1.2), (x - 0.02, y, 2.2), (x + 0.1, y, 3.2)],
         [0.42, 0.25, 0.2, 0.18, 0.1], c["bark"])
    tube("Bough", [(x + 0.02, y, 1.7), (x + 0.6, y - 0.1, 2.22), (x + 1.4, y - 0.2, 2.42), (x + 2.1, y - 0.2, 2.6)],
         [0.13, 0.1, 0.08, 0.04], c["bark"])
    tube("Bough left", [(x, y, 1.9), (x - 0.5, y - 0.2, 2.4), (x - 1.3, y - 0.2, 2.7)], [0.12, 0.1, 0.04], c["bark"])
    for k, (i, j, z, r) in enumerate(((0.2, 0.2, 3.9, 1.35), (-1.5, -0.1, 3.2, 1.05), (1.7, 0.1, 3.25, 1.0),
                                      (0.7, -0.7, 3.0, 0.8), (-0.6, -0.6, 2.8, 0.7))):
        middle, radii = (x + i, y + j, z), (r, 0.9 * r, 0.78 * r)
        green = [leaf(f"Leaf {k}{m}", shade, round_as=middle)
                 for m, shade in enumerate(((0.20, 0.42, 0.06), (0.30, 0.50, 0.08)))]
        heart = ball(f"Crown heart {k}", middle, [0.84 * a for a in radii], c["shrub"])
        heart.visible_camera = False
        crown = cards(f"Crown {k}", shell(rng, int(420 * r * r), middle, radii), 0.24, green, slot=lambda n: n % 2)
        crown.visible_shadow = False
    ropes = [[(x + a, y - 0.2, 2.42), (x + a + 0.08, y - 0.3, 0.55)] for a in (1.15, 1.6)]
    strands("Swing rope", ropes, 0.011, c["rope"], taper=1)
    box("Swing board", (0.58, 0.2, 0.035), (x + 1.46, y - 0.3, 0.53), c["bark"])


def hedge(c):
    """A clipped hedge: a dark body that shows between leaves laid over its front and top."""
    rng, spots = Random(5), []
    box("Hedge body", (6.2, 0.7, 1.3), (5.1, 1.2, 0), c["shrub"], bevel=0.2)
    for _ in range(1900):
        top = rng.random() < 0.3
        foot = (rng.uniform(1.95, 8.2), rng.uniform(0.8, 1.5), 1.3) if top else (rng.uniform(1.95, 8.2), 0.84,
                                                                                 rng.uniform(0.05, 1.3))
        up = Vector((rng.gauss(0, 0.6), rng.uniform(-1, 0) - 0.2, rng.uniform(-0.4, 1)))
        spots.append((foot, up, up.cross((rng.gauss(0, 0.4), -1, rng.gauss(0, 0.4)))))
    cards("Hedge", spots, 0.14, [c["hedge"], c["light hedge"]], slot=lambda n: n % 3 == 0)


def grass(c):
    """Blades in tufts, denser beside the path and the fence; poppies in the nearest."""
    rng, lines, petals = Random(8), [], []
    tufts = [(rng.choice((-1, 1)) * rng.uniform(0.7, 3.6) + 0.9, rng.uniform(-4.6, -0.2)) for _ in range(95)]
    tufts += [(rng.uniform(-6, -0.7) if k % 2 else rng.uniform(1.9, 6), rng.uniform(-0.25, 0.1)) for k in range(60)]
    for x, y in tufts:
        for _ in range(rng.randint(7, 13)):
            a, h = rng.uniform(0, 2 * pi), rng.uniform(0.1, 0.3)
            lean = Vector((cos(a), sin(a), 0)) * rng.uniform(0.02, 0.14)
            foot = Vector((x + rng.gauss(0, 0.07), y + rng.gauss(0, 0.05), -0.01))
            lines.append([foot, foot + lean * 0.35 + Vector((0, 0, 0.6 * h)), foot + lean + Vector((0, 0, h))])
            if y < -2.5 and h > 0.27:
                petals += [(lines[-1][2], (cos(t), sin(t), 0.5), (-sin(t), cos(t), 0)) for t in (a, a + 2.1, a + 4.2)]
    strands("Grass", lines, 0.007, c["blade"])
    cards("Poppies", petals, 0.07, c["poppy"])


def build():
    c = colors()
    ground(c)
    house(c)
    fence(c)
    tree(c)
    hedge(c)
    grass(c)
    cat((1.6, 0.0, 1.2), -52)
    world(sky=(0.36, 0.62, 0.88), fill=(0.30, 0.34, 0.44))
    light("SUN", "Sun", (6, -7, 7.5), (0, 0, 0), (1.0, 0.93, 0.78), 4.2, angle=radians(0.5))
    # The many small shapes get a finer pen than the few large ones, the distance the finest.
    paint("thickness", ["Crown", "Hedge", "Grass", "Poppies", "Cat"], -0.45)
    paint("thickness", ["Cottage", "Chimney", "Hill", "Cloud", "Meadow"], -0.5)
    paint("thickness", ["Pale", "Rail", "Gate", "Post"], lambda co: -0.4 * ramp((co - EYE).length, 5, 9))
    paint("hatching", ["Hill", "Crown", "Grass"], -0.6)
    paint("hatching", ["Cloud"], -1)
    camera(EYE, (0.25, 0.0, 1.52), 33)
    settings()


if __name__ == "__main__":
    build()
