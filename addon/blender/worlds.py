# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's light, as far as it can be told without a renderer: colours and pictures, by the nodes that mix them."""

import numpy as np

from ..pen import irradiance

# What a ray that lights a matt surface says of itself.
_RAY = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Length": 1e10, "Ray Depth": 1.0, "Diffuse Depth": 1.0}
_MOST = 64  # rows of a picture that are summed: light by the normal is smooth


class Unknown(Exception):
    """A node that can't be read; its text is the node's name."""


def light(world):
    """(9, 3) as Scene.light() takes it, of an evaluated world, None: it is dark. Unknown: it can't be told."""
    if world is None or not _lights(world):
        return None
    if not world.use_nodes or world.node_tree is None:
        return _some(irradiance.constant(np.array(world.color)))
    out = world.node_tree.get_output_node("CYCLES")
    if out is None or not out.inputs["Surface"].is_linked:
        return None
    return _some(_shader(out.inputs["Surface"]))


def _lights(world):
    visibility = getattr(world, "cycles_visibility", None)
    return getattr(visibility, "diffuse", True)


def _some(coefficients):
    return coefficients if np.any(coefficients) else None


def _source(socket):
    """(node, name of its output) that a socket is linked to, past reroutes; None."""
    while socket.is_linked:
        link = socket.links[0]
        if link.from_node.bl_idname != "NodeReroute":
            return link.from_node, link.from_socket.name
        socket = link.from_node.inputs[0]
    return None


def _shader(socket):
    source = _source(socket)
    if source is None:
        return irradiance.constant(np.zeros(3))
    node = source[0]
    if node.mute:
        raise Unknown(node.name)
    if node.bl_idname == "ShaderNodeBackground":
        return _color(node.inputs["Color"]) * value(node.inputs["Strength"])
    if node.bl_idname == "ShaderNodeAddShader":
        return _shader(node.inputs[0]) + _shader(node.inputs[1])
    if node.bl_idname == "ShaderNodeMixShader":
        share = float(np.clip(value(node.inputs[0]), 0, 1))
        return ((1 - share) * _shader(node.inputs[1]) if share < 1 else 0) + (
            share * _shader(node.inputs[2]) if share > 0 else 0)
    raise Unknown(node.name)


def _color(socket):
    source = _source(socket)
    if source and source[0].bl_idname == "ShaderNodeTexEnvironment":
        return _environment(source[0])
    return irradiance.constant(color(socket))


def value(socket):
    """The number that a socket gets. Unknown: it isn't the same everywhere."""
    source = _source(socket)
    if source is None:
        return float(socket.default_value)
    node, name = source
    if node.bl_idname == "ShaderNodeValue":
        return float(node.outputs[0].default_value)
    if node.bl_idname == "ShaderNodeLightPath":
        return _RAY.get(name, 0.0)
    if node.bl_idname == "ShaderNodeMath":
        return _math(node)
    raise Unknown(node.name)


def _math(node):
    a, b = (value(node.inputs[k]) for k in range(2))
    results = {"ADD": a + b, "SUBTRACT": a - b, "MULTIPLY": a * b, "MAXIMUM": max(a, b), "MINIMUM": min(a, b),
               "GREATER_THAN": float(a > b), "LESS_THAN": float(a < b)}
    if node.operation not in results:
        raise Unknown(node.name)
    return min(max(results[node.operation], 0.0), 1.0) if node.use_clamp else results[node.operation]


def color(socket):
    """The linear colour (3,) that a socket gets. Unknown: it isn't the same everywhere."""
    source = _source(socket)
    if source is None:
        return np.array(socket.default_value[:3], np.float64)
    if source[0].bl_idname == "ShaderNodeRGB":
        return np.array(source[0].outputs[0].default_value[:3], np.float64)
    raise Unknown(source[0].name)


def _environment(node):
    image = node.image
    if node.projection != "EQUIRECTANGULAR" or image is None or not all(image.size):
        raise Unknown(node.name)
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    picture = _shrunk(pixels.reshape(height, width, image.channels)[::-1])
    return irradiance.of_picture(picture if image.channels > 2 else picture[..., :1].repeat(3, 2), _rotation(node))


def _shrunk(picture):
    """Averages of blocks, so that few rows are left; what does not fill a block goes."""
    step = max(1, len(picture) // _MOST)
    rows, columns = len(picture) // step, picture.shape[1] // step
    return picture[:rows * step, :columns * step].reshape(rows, step, columns, step, -1).mean((1, 3))


def _rotation(node):
    """World -> picture."""
    source = _source(node.inputs["Vector"])
    if source is None or source[0].bl_idname == "ShaderNodeTexCoord":
        return np.eye(3)
    mapping = source[0]
    if mapping.bl_idname != "ShaderNodeMapping" or mapping.inputs["Rotation"].is_linked:
        raise Unknown(mapping.name)
    from mathutils import Euler

    turn = np.array(Euler(mapping.inputs["Rotation"].default_value).to_matrix())
    return turn.T if mapping.vector_type == "TEXTURE" else turn
