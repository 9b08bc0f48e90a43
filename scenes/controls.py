# SPDX-License-Identifier: GPL-3.0-or-later
"""Fruit and a jug, whose lines and pencil are told by nodes: modifiers of the group Encre Control, nothing painted."""

from math import radians

import bpy
from common import ball, box, camera, lathe, light, link, settings, tube, world
from materials import flat
from textured import rounded


def controlled(obj, control, by, amount, near=None):
    """Adds the modifier as Add Encre Control does; `near`: the object of NEARNESS."""
    layer = bpy.context.view_layer
    layer.update()  # which has new objects only then, and their sizes
    for other in layer.objects:
        other.select_set(other in (obj, near))
    layer.objects.active = obj
    if hasattr(bpy.types.Scene, "encre"):
        bpy.ops.encre.control_nodes(control=control, by=by, amount=amount)
    return obj


def melon(at):
    """Noise: its contour swells and thins out."""
    body = ball("Melon", at, (0.36, 0.36, 0.34), flat("Rind", (0.40, 0.62, 0.26)), (0, 12, 30))
    return controlled(body, "thickness", "NOISE", 1)


def jug(at):
    """The angle of view: pencil where it turns away."""
    profile = [(0, 0.02), (0.22, 0), (0.29, 0.14), (0.31, 0.26), (0.27, 0.40), (0.17, 0.54), (0.15, 0.64), (0.20, 0.74)]
    body = lathe("Jug", rounded(profile), at, flat("Glaze", (0.24, 0.50, 0.72)), steps=48, thick=0.02)
    bow = [(0.14, 0, 0.60), (0.33, 0, 0.65), (0.45, 0, 0.48), (0.40, 0, 0.32), (0.28, 0, 0.24)]
    handle = tube("Handle", bow, 0.035, body.data.materials[0], parent=body)
    for part in body, handle:
        controlled(part, "hatching", "EDGE_ON", 1)


def apple(at):
    """The distance from an object: a bruise about an empty, which may be moved and keyed."""
    x, y, z = at
    body = ball("Apple", at, (0.27, 0.27, 0.25), flat("Skin", (0.86, 0.28, 0.16)))
    tube("Stalk", [(x, y, z + 0.2), (x + 0.01, y, z + 0.28), (x + 0.05, y, z + 0.34)], 0.016,
         flat("Bark", (0.22, 0.13, 0.07)))
    bruise = link(bpy.data.objects.new("Bruise", None))
    bruise.location, bruise.empty_display_size = (x - 0.10, y - 0.22, z + 0.04), 0.1
    return controlled(body, "hatching", "NEARNESS", 1, near=bruise)


def pear(at):
    """One above another: noise lies on what the angle of view has made, and thickness has its own."""
    x, y, z = at
    profile = [(0, 0), (0.13, 0.01), (0.23, 0.08), (0.27, 0.20), (0.24, 0.34), (0.16, 0.47), (0.125, 0.58),
               (0.09, 0.66), (0, 0.68)]
    body = lathe("Pear", rounded(profile), at, flat("Peel", (0.93, 0.74, 0.20)), steps=48)
    tube("Stem", [(x, y, z + 0.66), (x - 0.01, y, z + 0.73), (x - 0.05, y, z + 0.79)], 0.016,
         flat("Wood", (0.22, 0.13, 0.07)))
    controlled(body, "hatching", "EDGE_ON", 1)
    controlled(body, "hatching", "NOISE", 1)
    return controlled(body, "thickness", "NOISE", 0.8)


def build():
    box("Table", (7, 4, 0.08), (0, -0.1, -0.08), flat("Board", (0.62, 0.44, 0.28)))
    camera((0, -5.2, 1.7), (0, 0, 0.30), 58)
    melon((-1.14, 0, 0.34))
    jug((-0.36, 0.05, 0))
    apple((0.48, -0.05, 0.25))
    pear((1.16, 0, 0))
    world(sky=(0.84, 0.84, 0.80), fill=(0.5, 0.5, 0.5))
    light("SUN", "Window", (-2, -5, 4), (0, 0, 0), (1, 1, 1), 3, angle=radians(1))
    settings()


if __name__ == "__main__":
    build()
