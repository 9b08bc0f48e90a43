# SPDX-License-Identifier: GPL-3.0-or-later
"""A hall with a large mirror, a window, a chrome ball and glasses: the girl greets herself.

What is hard for lines here: what the eye sees lies in a mirror or behind a pane, where depth and normal are the
glass's own. The mirror hangs on the wall y = 0, the window is in the wall x = 1.9; the camera looks along y.
"""

from math import cos, pi, radians, sin

import bpy
from common import ball, box, camera, group, lathe, light, paint, settings, slab, tube, world
from figures import BARE, SMALL, cat, girl
from materials import bricks, flat, glass, glow, mirror


def colors():
    return {
        "tiles": bricks("Tiles", (0.62, 0.52, 0.42), (0.24, 0.20, 0.24), (0.30, 0.25, 0.25), (0.4, 0.4, 0.006)),
        "wall": flat("Wall", (0.30, 0.44, 0.40)),
        "panel": flat("Panel", (0.56, 0.46, 0.36)),
        "rail": flat("Rail", (0.70, 0.60, 0.48)),
        "ceiling": flat("Ceiling", (0.70, 0.66, 0.58)),
        "gilt": flat("Gilt", (0.70, 0.48, 0.14)),
        "wood": flat("Wood", (0.34, 0.17, 0.09)),
        "mirror": mirror("Silver"),
        "chrome": mirror("Chrome", (0.80, 0.82, 0.86)),
        "pane": glass("Pane"),
        "glass": glass("Drinking glass"),
        "water": glass("Water", (0.75, 0.92, 0.95), ior=1.33),
        "cream": flat("Cream", (0.84, 0.80, 0.70)),
        "red": flat("Red", (0.70, 0.08, 0.06)),
        "lemon": flat("Lemon", (0.90, 0.75, 0.08)),
        "leaf": flat("Leaf", (0.16, 0.36, 0.12)),
        "far": flat("Far", (0.34, 0.38, 0.56)),
        "roof": flat("Roof", (0.48, 0.26, 0.26)),
        "shade": glow("Shade", (1.2, 0.9, 0.5)),
    }


def room(c):
    slab("Floor", [(-3.2, -6), (1.9, -6), (1.9, 0), (-3.2, 0)], -0.1, 0, c["tiles"])
    slab("Ceiling", [(-3.2, -6), (1.9, -6), (1.9, 0), (-3.2, 0)], 2.9, 3.0, c["ceiling"])
    for name, size, at in (("Back", (5.3, 0.1, 2.9), (-0.65, 0.05, 0)), ("Left", (0.1, 6, 2.9), (-3.25, -3, 0)),
                           ("Front", (5.3, 0.1, 2.9), (-0.65, -6.05, 0))):
        wall = box(name + " wall", size, at, c["wall"], bevel=0)
        wall.visible_diffuse = wall.visible_shadow = False  # the light that fills the shade comes in through them
    for name, y, d in (("near", -4.5, 3.2), ("far", -0.3, 0.6)):
        box(f"Right wall {name}", (0.1, d, 2.9), (1.95, y, 0), c["wall"], bevel=0)
    box("Right wall below", (0.1, 2.3, 0.85), (1.95, -1.75, 0), c["wall"], bevel=0)
    box("Right wall above", (0.1, 2.3, 0.6), (1.95, -1.75, 2.3), c["wall"], bevel=0)
    for name, size, at in (("back", (5.1, 0.04, 0.8), (-0.65, -0.02, 0)), ("left", (0.04, 6, 0.8), (-3.18, -3, 0)),
                           ("right", (0.04, 6, 0.8), (1.88, -3, 0)), ("front", (5.1, 0.04, 0.8), (-0.65, -5.98, 0))):
        box(f"Panel {name}", size, at, c["panel"], bevel=0)
        box(f"Chair rail {name}", (size[0] + 0.02, size[1] + 0.03, 0.06), (*at[:2], 0.8), c["rail"])


def frame(name, at, turn, w, h, bar, depth, material):
    """Four bars round an opening `w` by `h` that stands in the plane y = 0 of the thing at `at`."""
    root = group(name, at, turn)
    for side in (-1, 1):
        box(f"{name} stile {side}", (bar, depth, h + 2 * bar), (side * (w + bar) / 2, 0, -bar), material, parent=root)
        box(f"{name} rail {side}", (w, depth, bar), (0, 0, (h if side > 0 else -bar)), material, parent=root)
    return root


def looking_glass(c):
    silver = box("Mirror", (2.2, 0.02, 1.75), (-0.55, -0.06, 0.62), c["mirror"], bevel=0)
    silver.visible_diffuse = silver.visible_shadow = False
    frame("Mirror frame", (-0.55, -0.07, 0.62), 0, 2.2, 1.75, 0.11, 0.07, c["gilt"])


def window(c):
    """One pane above the other, a cross-bar between; outside, roofs in the evening."""
    root = frame("Window", (1.93, -1.75, 0.85), 90, 2.14, 1.37, 0.08, 0.14, c["cream"])
    box("Window bar", (2.14, 0.05, 0.05), (0, 0, 0.85), c["cream"], parent=root)
    box("Window post", (0.05, 0.05, 1.37), (0, 0, 0), c["cream"], parent=root)
    box("Window sill", (2.4, 0.3, 0.05), (0, 0.1, -0.09), c["cream"], parent=root)
    pane = box("Pane", (2.14, 0.008, 1.37), (0, 0, 0), c["pane"], bevel=0, parent=root)
    pane.visible_shadow = False
    for k, (x, y, w, h) in enumerate(((8, 9, 3, 3.2), (9, 13, 3.4, 2.2), (10, 18, 4, 4.4), (9, 24, 4, 3.2))):
        box(f"House {k}", (3, w, h + 3), (x, y, -3), c["far"], bevel=0)
        box(f"House roof {k}", (3.3, w + 0.4, 0.2), (x, y, h), c["roof"], bevel=0)
        box(f"House chimney {k}", (0.5, 0.5, 0.9), (x, y + w / 4, h + 0.2), c["far"], bevel=0)


def table(c):
    """In the foreground, a round table: glasses, a ball of chrome, a lemon."""
    root = group("Table", (0.86, -2.75, 0))
    lathe("Table top", [(0, 0.78), (0.5, 0.78), (0.52, 0.765), (0.5, 0.75), (0, 0.75)], (0, 0, 0), c["wood"], steps=48,
          parent=root)
    lathe("Table foot", [(0.035, 0.75), (0.05, 0.5), (0.04, 0.2), (0.09, 0.08), (0.24, 0.02), (0.24, 0)], (0, 0, 0),
          c["wood"], parent=root)
    ball("Chrome ball", (0.14, 0.05, 0.93), (0.15, 0.15, 0.15), c["chrome"], parent=root)
    tumbler = lathe("Tumbler", [(0, 0), (0.041, 0), (0.042, 0.002), (0.05, 0.168), (0.0485, 0.17), (0.047, 0.168),
                                (0.039, 0.014), (0.037, 0.012), (0, 0.012)],
                    (-0.24, -0.1, 0.781), c["glass"], steps=40, parent=root)
    drink = lathe("Drink", [(0, 0.013), (0.0385, 0.013), (0.0445, 0.11), (0, 0.11)], (-0.24, -0.1, 0.781), c["water"],
                  steps=40, parent=root)
    goblet = lathe("Goblet", [(0, 0.006), (0.045, 0), (0.045, 0.004), (0.006, 0.012), (0.005, 0.09), (0.03, 0.11),
                              (0.046, 0.13), (0.051, 0.155), (0.05, 0.208), (0.049, 0.21), (0.048, 0.208),
                              (0.049, 0.155), (0.044, 0.132), (0.029, 0.114), (0, 0.1)],
                   (-0.06, -0.26, 0.781), c["glass"], steps=40, parent=root)
    for thing in (tumbler, drink, goblet):
        thing.visible_shadow = False
    tube("Straw", [(-0.27, -0.1, 0.8), (-0.215, -0.1, 1.03), (-0.17, -0.1, 1.05)], 0.0055,
         [c["red"], c["cream"]], slot=lambda loop, side: loop % 2, parent=root)
    ball("Lemon", (0.2, -0.27, 0.815), (0.05, 0.036, 0.035), c["lemon"], turn=(0, 0, 25), parent=root)


def flowers(c):
    """A vase on the sill, before the pane."""
    at = (1.76, -0.95, 0.82)
    lathe("Vase", [(0.055, 0), (0.075, 0.08), (0.06, 0.17), (0.035, 0.22), (0.05, 0.26)], at, c["far"], thick=-0.008)
    for k in range(5):
        a = 2 * pi * k / 5
        x, y, z = at[0] + 0.09 * cos(a) - 0.03, at[1] + 0.16 * sin(a), at[2] + 0.42 + 0.05 * sin(3 * a)
        tube(f"Stem {k}", [(at[0], at[1], at[2] + 0.2), (x, y, z)], 0.007, c["leaf"])
        ball(f"Tulip {k}", (x, y, z), (0.032, 0.032, 0.048), c["red"])


def lamp(c):
    root = group("Hanging lamp", (-1.0, -2.2, 0))
    tube("Flex", [(0, 0, 2.3), (0, 0, 2.9)], 0.008, c["wood"], smooth=0, parent=root)
    shade = lathe("Lamp shade", [(0.05, 0.2), (0.08, 0.18), (0.28, 0)], (0, 0, 2.12), c["cream"], steps=32,
                  thick=0.01, parent=root)
    bulb = ball("Bulb", (0, 0, 2.16), (0.06, 0.06, 0.07), c["shade"], parent=root)
    shade.visible_shadow = bulb.visible_shadow = bulb.visible_diffuse = False


def build():
    c = colors()
    room(c)
    looking_glass(c)
    window(c)
    table(c)
    flowers(c)
    lamp(c)
    girl((-1.05, -1.2, 0), 145, rain=False)
    cat((0.05, -0.5, 0.0), 165)
    world(sky=(0.55, 0.52, 0.80), fill=(0.62, 0.60, 0.70))
    light("POINT", "Lamplight", (-1.0, -2.2, 2.2), (0, 0, 0), (1.0, 0.85, 0.6), 190, shadow_soft_size=0.02)
    light("POINT", "Mirror light", (0.5, -0.4, 1.9), (0, 0, 0), (1.0, 0.9, 0.7), 40, shadow_soft_size=0.02)
    light("SUN", "Evening", (9, -5, 6), (0, 0, 0), (1.0, 0.72, 0.5), 4, angle=radians(0.5))
    paint("thickness", [*SMALL, "Straw", "Tulip", "Stem", "Tumbler", "Drink", "Goblet", "House"], -0.5)
    paint("thickness", ["Mirror frame", "Chair rail", "Window"], -0.2)
    paint("hatching", [*BARE, "Mirror", "Pane", "Chrome", "Tumbler", "Drink", "Goblet", "Bulb", "House"], -1)
    camera((0.62, -5.2, 1.35), (-0.12, 0, 1.22), 32)
    settings()
    cycles = bpy.context.scene.cycles
    cycles.max_bounces, cycles.transmission_bounces, cycles.glossy_bounces = 12, 12, 4


if __name__ == "__main__":
    build()
