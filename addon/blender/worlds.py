# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's light, as far as it can be told without a renderer: colours and pictures, by the nodes that mix them."""

import numpy as np
from mathutils import Euler

from ..pen import irradiance
from ..pen.sky import Sky
from . import pictures, trees

# What a ray that lights a matt surface says of itself.
_RAY = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Length": 1e10, "Ray Depth": 1.0, "Diffuse Depth": 1.0}
# And one from the camera.
SEEN = {"Is Camera Ray": 1.0, "Ray Length": 1e10}
_MOST = 64  # rows of a picture that are summed: light by the normal is smooth


class _Light:
    """A world's light: numbers that can be added and multiplied."""

    ray = _RAY
    constant = staticmethod(irradiance.constant)

    @staticmethod
    def picture(pixels, rotation):
        return irradiance.of_picture(_shrunk(pixels), rotation)


class _Look:
    """Likewise what is seen of it."""

    ray = SEEN
    constant = Sky

    @staticmethod
    def picture(pixels, rotation):
        return Sky(pictures=((pixels, rotation),))


def light(world):
    """(9, 3) as Scene.light() takes it, of an evaluated world, None: it is dark. Unknown: it can't be told."""
    found = _world(world, "diffuse", _Light)
    return found if np.any(found) else None


def sky(world):
    """The Sky that the camera sees of an evaluated world. Unknown: it can't be told."""
    return _world(world, "camera", _Look)


def _world(world, asked, kind):
    """What a _Light or _Look makes of a world; asked: the visibility that counts."""
    if world is None or not getattr(getattr(world, "cycles_visibility", None), asked, True):
        return kind.constant(np.zeros(3))
    if not world.use_nodes or world.node_tree is None:
        return kind.constant(np.array(world.color))
    out = world.node_tree.get_output_node("CYCLES")
    return kind.constant(np.zeros(3)) if out is None else _shader(out.inputs["Surface"], kind)


@trees.bounded
def _shader(socket, kind):
    source = trees.source_of(socket)
    if source is None:
        return kind.constant(np.zeros(3))
    node, output = source
    if trees.is_nothing(node):
        return kind.constant(np.zeros(3))
    if output.type != "SHADER":  # it glows
        return _color(socket, kind)
    if node.bl_idname in ("ShaderNodeBackground", "ShaderNodeEmission"):
        return _color(node.inputs["Color"], kind) * value(node.inputs["Strength"], kind.ray)
    if node.bl_idname == "ShaderNodeAddShader":
        return _shader(node.inputs[0], kind) + _shader(node.inputs[1], kind)
    if node.bl_idname == "ShaderNodeMixShader":
        share = float(np.clip(value(node.inputs[0], kind.ray), 0, 1))
        if share in (0, 1):  # what can't be told of the other does not matter
            return _shader(node.inputs[1 + int(share)], kind)
        return _shader(node.inputs[1], kind) * (1 - share) + _shader(node.inputs[2], kind) * share
    raise trees.Unknown(node.name)


def _color(socket, kind):
    source = trees.source_of(socket)
    if source and source[0].bl_idname == "ShaderNodeTexEnvironment" and not source[0].mute:
        return _environment(source[0], kind)
    return kind.constant(color(socket))


@trees.bounded
def value(socket, ray=_RAY):
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


def _environment(node, kind):
    image = pictures.still(node)
    if node.projection != "EQUIRECTANGULAR" or image is None or not all(image.size):
        raise trees.Unknown(node.name)
    return kind.picture(pictures.colors(pictures.linear(image))[::-1], _rotation(node))


def _shrunk(picture):
    """Averages of blocks, so that few rows are left; what does not fill a block goes."""
    step = max(1, len(picture) // _MOST)
    rows, columns = len(picture) // step, picture.shape[1] // step
    return picture[:rows * step, :columns * step].reshape(rows, step, columns, step, -1).mean((1, 3))


def _rotation(node):
    """World -> picture."""
    source = trees.source_of(node.inputs["Vector"])
    if source is None or source[0].bl_idname == "ShaderNodeTexCoord":
        return np.eye(3)
    mapping = source[0]
    if mapping.bl_idname != "ShaderNodeMapping" or mapping.inputs["Rotation"].is_linked:
        raise trees.Unknown(mapping.name)
    turn = np.array(Euler(mapping.inputs["Rotation"].default_value).to_matrix())
    return turn.T if mapping.vector_type == "TEXTURE" else turn
