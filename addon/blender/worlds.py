# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and colors of nodes that are the same everywhere, and what rays say of themselves."""

import numpy as np

from . import trees

# What a ray that lights a matt surface says of itself.
LIT = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Length": 1e10, "Ray Depth": 1.0, "Diffuse Depth": 1.0}
# And one from the camera.
SEEN = {"Is Camera Ray": 1.0, "Ray Length": 1e10}


@trees.bounded
def value(socket, ray=LIT):
    """The number that a socket gets. Unknown: it isn't the same everywhere."""
    source = trees.source_of(socket)
    if source is None:
        return trees.own_number(socket)
    node, output = source
    if trees.is_nothing(node):
        return 0.0
    if node.bl_idname == "ShaderNodeValue":
        return float(node.outputs[0].default_value)
    if node.bl_idname == "ShaderNodeLightPath":
        return ray.get(output.name, 0.0)
    if node.bl_idname == "ShaderNodeMath":
        return summed(node, *(value(node.inputs[k], ray) for k in range(2)))
    raise trees.Unknown(node.name)


def summed(node, a, b):
    """What a Math node makes of two numbers."""
    results = {"ADD": a + b, "SUBTRACT": a - b, "MULTIPLY": a * b, "MAXIMUM": max(a, b), "MINIMUM": min(a, b),
               "GREATER_THAN": float(a > b), "LESS_THAN": float(a < b)}
    if node.operation not in results:
        raise trees.Unknown(node.name)
    return min(max(results[node.operation], 0.0), 1.0) if node.use_clamp else results[node.operation]


def color(socket):
    """The linear colour (3,) that a socket gets. Unknown: it isn't the same everywhere."""
    source = trees.source_of(socket)
    if source is None:
        return np.broadcast_to(np.float64(trees.own(socket)), 3)
    if trees.is_nothing(source[0]):
        return np.zeros(3)
    if source[0].bl_idname == "ShaderNodeRGB":
        return np.array(source[0].outputs[0].default_value[:3], np.float64)
    if source[1].type == "VALUE":
        return np.full(3, value(socket))
    raise trees.Unknown(source[0].name)
