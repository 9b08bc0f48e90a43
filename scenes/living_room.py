# SPDX-License-Identifier: GPL-3.0-or-later
"""A living room full of patterns, after the test scene of Herring 2016: wherever two colours meet on a cloth, a print
or a vase there is a line to draw.

The window is on the left, the sofa stands at the back wall, the side towards the viewer is open. x is to the right,
y away, the rug's middle near the origin. The camera flies through the room in 20 seconds.
"""

from math import radians

import bpy
import numpy as np
import patterns as p
import pictures
from common import aim, ball, box, lathe, light, link, settings, slab, tube, world
from figures import cat
from furniture import (
    book,
    cubes,
    curtain,
    floor_lamp,
    framed,
    plant,
    round_table,
    seat,
    shelves,
    table_lamp,
    throw,
)
from materials import flat, glow
from mathutils import Vector
from textured import board, disc, pillow, printed, rounded, sheet, soft_box, turned, wrapped

LEFT, RIGHT, BACK, FRONT, HEIGHT = -2.7, 2.7, 2.0, -5.0, 2.65


def plain():
    return {
        "cream": flat("Cream", (0.87, 0.78, 0.58)),
        "white": flat("White", (0.92, 0.88, 0.78)),
        "wood": flat("Dark wood", (0.16, 0.065, 0.028)),
        "oak": flat("Oak", (0.47, 0.25, 0.1)),
        "brass": flat("Brass", (0.70, 0.43, 0.10)),
        "black": flat("Black", (0.03, 0.025, 0.03)),
        "red": flat("Red", (0.56, 0.05, 0.03)),
        "orange": flat("Orange", (0.80, 0.24, 0.03)),
        "green": flat("Apple", (0.32, 0.47, 0.08)),
        "navy": flat("Navy", (0.014, 0.03, 0.09)),
        "earth": flat("Earth", (0.07, 0.035, 0.02)),
        "ceiling": glow("Ceiling", (0.55, 0.52, 0.44)),  # no light of ours comes from below
        "bulb": glow("Bulb", (1.0, 0.83, 0.5)),
    }


def shell(c):
    """Floor, walls with a window on the left, skirting, ceiling."""
    floor = printed("Parquet", p.herringbone("#b3773f", "#bd8247", "#aa6e38", "#c68d52"))
    long = BACK - FRONT
    sheet("Floor", lambda u, v: (LEFT + u * (RIGHT - LEFT), FRONT + v * long, 0), (1, 1), floor,
          ((RIGHT - LEFT) / 1.6, long / 1.6))
    paper = printed("Wallpaper", p.trellis(p.PALE, "#b9cba8", p.WHITE, p.SAND))
    # Far higher than the ceiling, which throws no shadow: the sun comes in by the window alone.
    tall, tile = 9, 0.9
    board("Back wall", (RIGHT - LEFT, tall), (0, BACK, 0), paper, repeat=((RIGHT - LEFT) / tile, tall / tile))
    board("Right wall", (long, tall), (RIGHT, (BACK + FRONT) / 2, 0), paper, (0, 0, -90), (long / tile, tall / tile))
    y0, y1, z0, z1 = WINDOW
    for name, a, b, low, high in (("far", y1, BACK, 0, tall), ("near", FRONT, y0, 0, tall), ("low", y0, y1, 0, z0),
                                  ("high", y0, y1, z1, tall)):
        obj = board(f"Left wall {name}", (b - a, high - low), (LEFT, (a + b) / 2, low), paper, (0, 0, 90),
                    ((b - a) / tile, (high - low) / tile))
        for corner in obj.data.uv_layers[0].data:  # one pattern runs over all four
            corner.uv += Vector((a / tile, low / tile))
    ceiling = slab("Ceiling", [(LEFT, FRONT), (RIGHT, FRONT), (RIGHT, BACK), (LEFT, BACK)], HEIGHT, HEIGHT + 0.1,
                   c["ceiling"])
    ceiling.visible_shadow = False
    for name, size, at in (("back", (RIGHT - LEFT, 0.02, 0.12), (0, BACK - 0.01, 0)),
                           ("left", (0.02, long, 0.12), (LEFT + 0.01, (BACK + FRONT) / 2, 0)),
                           ("right", (0.02, long, 0.12), (RIGHT - 0.01, (BACK + FRONT) / 2, 0))):
        box(f"Skirting {name}", size, at, c["white"], bevel=0)
        cornice = box(f"Cornice {name}", (size[0] + 0.06, size[1] + 0.06, 0.1), (*at[:2], HEIGHT - 0.1), c["white"],
                      bevel=0)
        cornice.visible_shadow = False


WINDOW = (-1.35, 0.35, 0.8, 2.2)  # y and z


def window(c):
    y0, y1, z0, z1 = WINDOW
    middle, deep = (y0 + y1) / 2, 0.14
    for name, size, at in (("foot", (deep, y1 - y0 + 0.1, 0.06), (middle, z0 - 0.05)),
                           ("head", (deep, y1 - y0 + 0.1, 0.06), (middle, z1)),
                           ("near", (deep, 0.06, z1 - z0), (y0 - 0.02, z0)),
                           ("far", (deep, 0.06, z1 - z0), (y1 + 0.02, z0)),
                           ("post", (0.05, 0.06, z1 - z0), (middle, z0)),
                           ("bar", (0.04, y1 - y0, 0.04), (middle, z0 + 0.62 * (z1 - z0)))):
        box(f"Window {name}", size, (LEFT, *at), c["white"], bevel=0)
    box("Window sill", (0.24, y1 - y0 + 0.24, 0.04), (LEFT + 0.08, middle, z0 - 0.06), c["white"], bevel=0.008)
    town = printed("View", pictures.view(), glow=True)
    view = board("View", (5.6, 3.4), (LEFT - 1.6, middle, -0.1), town, (0, 0, 90))
    view.visible_shadow = False
    cloth = printed("Curtain", p.foliage(p.CREAM, p.TEAL, p.LEAF, p.CREAM))
    for name, y in (("near", y0 - 0.13), ("far", y1 + 0.13)):
        curtain(f"Curtain {name}", (LEFT + 0.12, y, 0.06), (0, 0, 90), (0.5, z1), cloth, 4)
    ends = [(LEFT + 0.12, y, z1 + 0.12) for y in (y0 - 0.5, y1 + 0.5)]
    tube("Curtain rod", ends, 0.018, c["brass"], sides=10, smooth=0)
    for k, at in enumerate(ends):
        ball(f"Rod end {k}", at, (0.035,) * 3, c["brass"])


def seats(c):
    """The sofa, the armchair, a pouf, and what lies on them."""
    stripes = printed("Sofa cloth", p.stripes((6, p.TEAL), (1, p.CREAM), (2, p.TEAL), (1, p.CREAM)))
    sofa = seat("Sofa", (-0.25, 1.42, 0), 0, 2.2, stripes, c["wood"], seats=3, tile=0.24)
    for name, x, y, size, lean, turn, picture in (
            ("Cushion chevrons", -0.72, 0.06, 0.42, 22, -10, p.chevrons(p.NAVY, p.CREAM, p.MUSTARD, p.CREAM)),
            ("Cushion dots", -0.4, -0.06, 0.36, 26, 14, p.dots(p.RED, p.CREAM, count=3)),
            ("Cushion stars", 0.72, 0.06, 0.42, 20, 12, p.stars(p.NAVY, p.CREAM, p.RED, p.MUSTARD, 2)),
            ("Cushion hound", 0.36, -0.07, 0.36, 27, -12, p.houndstooth(p.CREAM, p.INK, 2))):
        pillow(name, (size, size, 0.15), (x, y, 0.5 + size / 2), printed(name, picture), (-lean, 0, turn), parent=sofa)
    throw("Throw", printed("Throw", p.tartan((5, p.RED), (1, p.CREAM), (3, p.NAVY), (1, p.MUSTARD))), 1.0, sofa)

    blossoms = printed("Armchair cloth", p.blossoms(p.MUSTARD, p.CREAM, p.PINK, p.RED, p.LEAF, 2))
    chair = seat("Armchair", (1.45, -0.45, 0), -112, 0.98, blossoms, c["wood"], tile=0.45)
    pillow("Cushion argyle", (0.36, 0.36, 0.14), (0.02, 0.0, 0.67), printed("Cushion argyle", p.argyle(
        p.CREAM, p.WINE, p.TEAL, p.NAVY)), (-22, 0, 8), parent=chair)

    hide = printed("Pouf hide", p.patches(p.RED, p.CREAM, p.TEAL, p.MUSTARD, p.PINK, p.NAVY))
    turned("Pouf", rounded([(0, 0), (0.22, 0), (0.31, 0.1), (0.31, 0.24), (0.22, 0.36), (0, 0.38)]),
           (-1.5, -0.75, 0), hide, (3, 1))
    cat((-1.5, -0.75, 0.37), 40)


def rugs(c):
    kilim = printed("Kilim", pictures.rug())
    sheet("Rug", lambda u, v: ((u - 0.5) * 2.7 - 0.15, (v - 0.5) * 1.8 + 0.05, 0.012), (1, 1), kilim, thick=0.012)
    # Only its picture's disc is there, without the corners.
    disc("Round rug", 0.85, 0.012, (1.45, -2.2, 0), printed("Round rug", pictures.round_rug()), c["cream"], sides=96)
    hide = printed("Cow hide", p.hide(p.CREAM, p.BROWN, p.INK))
    disc("Hide rug", 0.62, 0.012, (-1.6, -2.3, 0), hide, c["cream"], sides=64)


def toys():
    gores = printed("Ball", pictures.ball())
    profile = [(0.15 * (1 - (k / 8 - 1) ** 2) ** 0.5, 0.15 * k / 8) for k in range(17)]
    turned("Ball", profile, (0.6, -0.95, 0), gores, sides=48)
    faces = [printed(f"Block {letter}", pictures.block(letter, p.CREAM, frame, ink))
             for letter, frame, ink in (("A", p.RED, p.BLUE), ("B", p.BLUE, p.LEAF), ("C", p.MUSTARD, p.RED))]
    for k, (x, y, z, turn) in enumerate(((-0.5, -0.98, 0, 20), (-0.33, -0.93, 0, -12), (-0.42, -0.95, 0.11, 33),
                                         (-0.1, -1.1, 0, 48))):
        cubes(f"Block {k}", (x, y, z), 0.11, faces[k % 3:] + faces[:k % 3], turn)


def tables(c):
    """The coffee table in the middle, a small one beside the sofa, and all that stands on them."""
    wood = c["wood"]
    round_table("Table", (-0.2, 0.15, 0), 0.55, 0.42, printed("Table top", pictures.table_top()), wood)
    top = 0.42
    wrapped("Chess", (0.34, 0.34, 0.025), (-0.38, 0.02, top), printed("Chess", pictures.chessboard()), 0.34, bevel=0,
            turn=(0, 0, 15))
    turned("Vase", rounded([(0.05, 0), (0.085, 0.06), (0.095, 0.13), (0.05, 0.21), (0.035, 0.25), (0.05, 0.28)]),
           (0.0, 0.36, top), printed("Vase", meanders()), (6, 1), thick=0.004)
    turned("Bowl", rounded([(0.05, 0), (0.06, 0.012), (0.11, 0.045), (0.14, 0.09)]), (0.08, 0.02, top),
           printed("Bowl", pictures.waves(p.WHITE, p.BLUE, p.TEAL, p.NAVY)), (3, 1), thick=0.006)
    for k, (x, y, z, color) in enumerate(((-0.04, 0.02, 0.07, "orange"), (0.05, 0.04, 0.07, "green"),
                                          (0.02, -0.05, 0.075, "orange"), (0.0, 0.01, 0.12, "red"))):
        ball(f"Fruit {k}", (0.08 + x, 0.02 + y, top + z), (0.045, 0.045, 0.042), c[color])
    turned("Mug", [(0.0, 0.002), (0.038, 0), (0.042, 0.01), (0.042, 0.1)], (-0.1, -0.2, top),
           printed("Mug", pictures.heart(p.WHITE, p.RED, p.BLUE)), (1, 1), thick=0.004)
    tube("Mug handle", [(-0.06, -0.2, top + 0.08), (-0.025, -0.2, top + 0.075), (-0.025, -0.2, top + 0.03),
                        (-0.06, -0.2, top + 0.025)], 0.007, c["white"], sides=8, smooth=1)
    flowers(c, (0.0, 0.36, top + 0.26))
    glazed = printed("Side table", p.tiles(p.WHITE, p.BLUE, p.NAVY, 3))
    round_table("Side table", (-1.72, 1.5, 0), 0.29, 0.52, glazed, wood)
    table_lamp("Table lamp", (-1.76, 1.54, 0.52),
               printed("Lamp foot", p.scallops(p.CREAM, p.TEAL, p.CREAM, p.NAVY, count=2)),
               printed("Lamp shade", p.stripes((3, p.WHITE), (1, p.RED), (1, p.WHITE), (1, p.RED))), c["brass"])
    tin = printed("Tin", p.argyle(p.RED, p.MUSTARD, p.WINE, p.CREAM, 1))
    wrapped("Tin", (0.09, 0.09, 0.13), (-1.56, 1.38, 0.52), tin, 0.09, turn=(0, 0, 25))


def meanders():
    """A band of Greek key between plain ones."""
    key = p.meander(p.ORANGE, p.INK)
    plain, dark = p.blank(p.ORANGE, len(key)), p.blank(p.INK, len(key))[:len(key) // 3]
    return np.concatenate([dark, plain, key, plain, dark])


def flowers(c, at):
    for k, (x, y, z) in enumerate(((-0.11, 0.02, 0.2), (-0.03, -0.05, 0.3), (0.04, 0.05, 0.24), (0.12, -0.02, 0.17))):
        foot, head = Vector(at), Vector(at) + Vector((x, y, z))
        tube(f"Stem {k}", [foot + Vector((0.1 * x, 0.1 * y, -0.05)), foot + Vector((0.4 * x, 0.4 * y, 0.5 * z)), head],
             0.008, c["green"], sides=6, smooth=1)
        bloom = ("red", "orange", "white")[k % 3]
        outline = rounded([(0.012, 0.075), (0.034, 0.04), (0.028, 0.01), (0, 0)], 4)
        lathe(f"Tulip {k}", outline, head, c[bloom], steps=16, turn=(0, 14 * (k - 1.5), 0), thick=0.003)


def bookcase(c):
    """Books between ornaments, along the right wall."""
    wood = printed("Bookcase wood", p.wood(p.OAK, p.BROWN, "#b67f49", p.BROWN, boards=5))
    case, boards = shelves("Bookcase", (RIGHT - 0.17, 0.75, 0), -90, (1.5, 0.3, 1.75), 5, wood)
    kinds = ((p.WINE, p.MUSTARD, p.CREAM, 0), (p.TEAL, p.CREAM, p.NAVY, 3), (p.NAVY, p.SKY, p.RED, 1),
             (p.MUSTARD, p.NAVY, p.CREAM, 2), (p.RED, p.CREAM, p.INK, 1), (p.CREAM, p.RED, p.TEAL, 3),
             (p.MOSS, p.SAND, p.CREAM, 0), (p.PINK, p.WINE, p.CREAM, 2))
    cloths = [printed(f"Book cloth {k}", pictures.cover(*kind)) for k, kind in enumerate(kinds)]
    number = 0
    for row, z, x, end in ((1, boards[1], -0.7, 0.1), (1, boards[1], 0.3, 0.7), (2, boards[2], -0.7, -0.25),
                           (2, boards[2], 0.1, 0.7), (3, boards[3], -0.4, 0.5), (0, boards[0], -0.1, 0.7)):
        while True:
            h = 0.2 + 0.13 * p.chance(number, row) / 1024 + (0.04 if row == 0 else 0)
            t = 0.028 + 0.04 * p.chance(row, number, 2) / 1024
            if x + t > end:
                break
            book(f"Book {number}", (t, 0.19, h), (x + t / 2, -0.03, z), cloths[int(p.chance(number, 5)) % len(cloths)],
                 c["cream"], parent=case)
            x, number = x + t + 0.004, number + 1
    for k, (thick, turn) in enumerate(((0.05, 8), (0.04, -6), (0.035, 15))):
        book(f"Lying book {k}", (thick, 0.2, 0.28), (-0.12, 0.3, 0), cloths[(3 * k + 1) % 8], c["cream"],
             (0, 90, 200 + turn))
        lying = bpy.data.objects[f"Lying book {k}"]
        lying.location = (-0.42, 0.32, 0.42 + sum((0.05, 0.04, 0.035)[:k]) + thick / 2)
    globe(c, case, boards[4])
    for k, (x, z, r, h, picture) in enumerate((
            (-0.42, boards[4], 0.17, 0.16, p.dots(p.PINK, p.WHITE, count=2)),
            (-0.42, boards[4] + 0.17, 0.13, 0.12, p.stripes((1, p.NAVY), (1, p.CREAM))))):
        cloth = printed(f"Hatbox {k}", picture)
        turned(f"Hatbox {k}", [(r - 0.01, 0), (r - 0.01, h - 0.05)], (x, 0, z), cloth, (4, 0.6), sides=40, parent=case)
        disc(f"Hatbox lid {k}", r, 0.055, (x, 0, z + h - 0.05), cloth, c["red"], parent=case)
    for name, x, board_, profile, picture, repeat in (
            ("Jar", -0.08, 2, [(0.05, 0), (0.09, 0.08), (0.085, 0.17), (0.05, 0.2), (0.06, 0.22)],
             p.chevrons(p.CREAM, p.RED, p.CREAM, p.TEAL, count=1, rows=1), (4, 2)),
            ("Pot", 0.2, 1, [(0.045, 0), (0.075, 0.05), (0.07, 0.12), (0.05, 0.15)],
             p.tiles(p.MUSTARD, p.WINE, p.CREAM, 1), (5, 2)),
            ("Bottle", 0.6, 3, [(0.05, 0), (0.06, 0.1), (0.03, 0.17), (0.018, 0.24), (0.024, 0.26)],
             p.scallops(p.NAVY, p.SKY, p.WHITE, count=2), (2, 2))):
        turned(name, rounded(profile), (x, -0.02, boards[board_]), printed(name, picture), repeat, parent=case)
    wicker = printed("Basket", p.checks(p.SAND, p.BROWN, 4))
    soft_box("Basket", (0.42, 0.24, 0.24), (-0.42, -0.02, boards[0]), 0.04, wicker, 0.18, parent=case)


def globe(c, parent, z):
    profile = [(0.15 * (1 - (k / 10 - 1) ** 2) ** 0.5, 0.15 * k / 10 - 0.15) for k in range(21)]
    turned("Globe", profile, (0.35, -0.02, z + 0.22), printed("Globe", pictures.world_map()), sides=48,
           turn=(0, 23, 200), parent=parent)
    lathe("Globe foot", [(0, 0.07), (0.012, 0.07), (0.02, 0.02), (0.09, 0.012), (0.09, 0)], (0.35, -0.02, z),
          c["brass"], parent=parent)


def walls(c):
    """Prints, a clock, lamps, plants."""
    wood, navy, brass = c["wood"], c["navy"], c["brass"]
    y = BACK - 0.005
    framed("Ship", (0.95, 0.62), (-0.25, y, 1.62), printed("Ship", pictures.ship()), wood)
    framed("Cat picture", (0.38, 0.38), (-1.15, y, 1.8), printed("Cat picture", pictures.cat()), navy)
    framed("Sunset", (0.38, 0.38), (-1.15, y, 1.3), printed("Sunset", pictures.sunset()), wood, margin=0.04,
           paper=c["white"])
    framed("Squares", (0.36, 0.36), (0.62, y, 1.82), printed("Squares", pictures.squares()), c["black"])
    framed("Discs", (0.42, 0.42), (0.65, y, 1.3), printed("Discs", pictures.discs()), navy, margin=0.04,
           paper=c["white"])
    disc("Clock", 0.2, 0.04, (1.35, BACK, 1.75), printed("Clock", pictures.clock()), brass, (90, 0, 0), sides=64)
    shade = printed("Floor lamp shade", p.scallops(p.CREAM, p.MUSTARD, p.ORANGE, p.CREAM, count=2))
    floor_lamp("Floor lamp", (1.5, 1.5, 0), shade, brass, c["bulb"])
    lantern = [(0.27 * (1 - (k / 10 - 1) ** 2) ** 0.5 + 0.04, 0.022 * k) for k in range(21)]
    turned("Lantern", lantern, (-0.2, 0.1, 2.0), printed("Lantern", pictures.paper_lantern()), (2, 1), sides=48)
    tube("Lantern cord", [(-0.2, 0.1, 2.4), (-0.2, 0.1, HEIGHT)], 0.006, c["black"], sides=6, smooth=0)
    leaf = printed("Leaf", pictures.leaf())
    glazed = printed("Palm pot", p.tiles(p.WHITE, p.BLUE, p.MUSTARD, 1))
    plant("Palm", (-2.2, 1.35, 0), glazed, c["earth"], leaf, 13, 0.95, (5, 1.5))
    zigzag = printed("Fern pot", p.chevrons(p.ORANGE, p.CREAM, p.NAVY, p.CREAM, count=1, rows=1))
    plant("Fern", (2.2, -0.75, 0), zigzag, c["earth"], leaf, 9, 0.6, (7, 2))


# The flight: frame, where the camera is, where it looks

PATH = (
    (1, (0.35, -4.3, 1.55), (-0.1, 1.0, 0.85)),
    (70, (-0.9, -3.2, 1.4), (-0.2, 1.0, 0.8)),
    (140, (-1.2, -1.9, 1.05), (-0.2, 0.6, 0.6)),
    (210, (-0.45, -0.95, 0.95), (-0.3, 1.0, 0.62)),
    (270, (0.15, -0.75, 1.1), (1.0, 1.5, 0.85)),
    (330, (-0.2, -0.7, 1.25), (2.4, 0.8, 1.0)),
    (400, (0.7, -2.2, 1.3), (1.2, 0.5, 0.9)),
    (480, (1.5, -4.3, 1.6), (-0.4, 0.8, 0.9)),
)


def flight():
    """A camera on its path, always turned towards an empty that wanders through the room."""
    scene = bpy.context.scene
    data = bpy.data.cameras.new("Camera")
    data.lens, data.clip_start = 28, 0.05
    eye = link(bpy.data.objects.new("Camera", data))
    look = link(bpy.data.objects.new("Look", None))
    aim(eye, PATH[0][1], PATH[0][2])
    track = eye.constraints.new("TRACK_TO")
    track.target, track.track_axis, track.up_axis = look, "TRACK_NEGATIVE_Z", "UP_Y"
    for frame, here, there in PATH:
        for obj, at in ((eye, here), (look, there)):
            obj.location = at
            obj.keyframe_insert("location", frame=frame)
    scene.camera = eye
    scene.frame_start, scene.frame_end, scene.frame_current = 1, 480, 1
    scene.render.fps = 24


def lights():
    """Sun by the window, and soft light from all around."""
    world(sky=(0.55, 0.75, 0.9), fill=(0.78, 0.80, 0.87))
    bpy.context.scene.world.cycles.sampling_method = "NONE"  # no shadow rays, which the walls would stop
    light("SUN", "Sun", (-4.2, -1.7, 2.9), (0, 0.1, 0), (1.0, 0.86, 0.62), 5.0, angle=radians(0.5))


def lines():
    """Inter-color with fine outlines: a room is full of small things close by."""
    encre = getattr(bpy.context.scene, "encre", None)
    if encre:
        bpy.ops.encre.preset(preset="inter_color")
        encre.line_outline_width, encre.line_inner_width, encre.line_crease_width = 0.8, 0.6, 0.5


def build():
    c = plain()
    shell(c)
    window(c)
    rugs(c)
    for obj in bpy.context.scene.objects:  # the room keeps the soft light out no more than a stage's does
        obj.visible_diffuse = False
    seats(c)
    toys()
    tables(c)
    bookcase(c)
    walls(c)
    lights()
    flight()
    settings()
    cycles = bpy.context.scene.cycles
    cycles.use_denoising = True    # the little noise that soft light leaves
    cycles.min_light_bounces = 1   # no path is given up by chance before it finds that light
    lines()


if __name__ == "__main__":
    build()
