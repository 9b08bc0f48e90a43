# SPDX-License-Identifier: GPL-3.0-or-later
"""The same things in a flat mirror and seen from the mirrored camera; through a pane and without it.

build() makes one of them: MIRROR, MIRRORED, PANE or OPEN, or ORTHO: the mirror through an orthographic camera; or the
mirror is rough, SATIN, or rough under a clear coat, LACQUER. The mirror stands in the plane y = 0, the pane in
y = -0.9.
"""

import sys
from math import radians
from pathlib import Path

import bpy
from mathutils import Matrix

sys.path.append(str(Path(__file__).parents[3] / "scenes"))

from common import ball, box, camera, lathe, light, settings, slab, tube, world  # noqa: E402
from materials import flat, glass, mirror  # noqa: E402


def things():
    """A still life, to be seen from the back (in the mirror) and from the front."""
    white, red, blue, wood = (flat(name, color) for name, color in (
        ("White", (0.8, 0.8, 0.75)), ("Red", (0.7, 0.1, 0.08)), ("Blue", (0.1, 0.2, 0.6)), ("Wood", (0.5, 0.3, 0.15))))
    slab("Floor", [(-4, -7), (4, -7), (4, 0.5), (-4, 0.5)], -0.1, 0, flat("Floor", (0.45, 0.5, 0.4)))
    box("Table", (1.8, 0.9, 0.08), (-0.5, -2.2, 0.7), wood)
    for x, y in ((-1.3, -2.5), (0.3, -2.5), (-1.3, -1.9), (0.3, -1.9)):
        tube(f"Leg {x} {y}", [(x, y, 0), (x, y, 0.7)], 0.05, wood, parent=None)
    lathe("Vase", [(0.1, 0), (0.2, 0.15), (0.16, 0.35), (0.06, 0.5), (0.11, 0.6)], (-1.0, -2.2, 0.78), blue,
          thick=-0.01)
    ball("Ball", (0.05, -2.1, 0.98), (0.2, 0.2, 0.2), red)
    box("Book", (0.35, 0.5, 0.07), (-0.5, -2.25, 0.78), white, turn=25)
    box("Crate", (0.7, 0.7, 0.7), (1.3, -2.6, 0), wood, turn=30)
    box("Small crate", (0.4, 0.4, 0.4), (1.25, -2.55, 0.7), red, turn=55)
    box("Pillar", (0.4, 0.4, 3.2), (-2.2, -3.6, 0), white)
    box("Wall", (8, 0.1, 3.2), (0, -6.6, 0), flat("Wall", (0.35, 0.45, 0.5)))
    lathe("Lamp", [(0.06, 0.3), (0.35, 0)], (0.4, -3.4, 1.9), white, thick=0.01)
    tube("Flex", [(0.4, -3.4, 2.2), (0.4, -3.4, 4)], 0.02, wood)
    world(sky=(0.6, 0.6, 0.8), fill=(0.6, 0.6, 0.7))
    light("SUN", "Sun", (3, -5, 6), (0, -2, 0), (1, 1, 1), 3, angle=radians(1))
    settings()


def lacquer():
    """Rough metal under a coat that mirrors clearly."""
    coated = bpy.data.materials.new("Lacquer")
    coated.use_nodes = True
    inputs = coated.node_tree.nodes["Principled BSDF"].inputs
    inputs["Metallic"].default_value, inputs["Roughness"].default_value = 1, 0.25
    coat = "Coat" if "Coat Weight" in inputs else "Clearcoat"  # before 4.0
    inputs["Coat Weight" if coat == "Coat" else coat].default_value = 1
    inputs[coat + " Roughness"].default_value = 0.03
    return coated


def build(kind):
    things()
    if kind in ("PANE", "OPEN"):
        camera((0.3, 2.2, 1.5), (-0.2, -2.4, 0.9), 30)
        if kind == "PANE":
            box("Pane", (2.6, 0.01, 1.3), (-0.2, -0.9, 0.35), glass("Pane"), bevel=0)
        return
    eye = camera((0.6, -4.4, 1.7), (-0.2, 0, 1.15), 30)
    eye.data.clip_start = 0.5
    if kind == "ORTHO":
        eye.data.type, eye.data.ortho_scale, eye.data.shift_x = "ORTHO", 6, 0.1
    if kind != "MIRRORED":
        silver = mirror("Silver", (1.0, 1.0, 1.0), 0.25 if kind == "SATIN" else 0.0)
        box("Mirror", (4.6, 0.02, 2.6), (-0.1, 0.01, 0.25), lacquer() if kind == "LACQUER" else silver, bevel=0)
        return
    bpy.context.view_layer.update()
    eye.matrix_world = Matrix.Diagonal((1, -1, 1, 1)) @ eye.matrix_world @ Matrix.Diagonal((-1, 1, 1, 1))
