# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the surfaces of a material are solid: everywhere, nowhere, or where an image says so, as leaves are cut out."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..pen import colour
from . import pictures, trees, worlds

_RAY = {"Is Shadow Ray": 1.0, "Ray Length": 1.0, "Ray Depth": 1.0}
_EXTENSIONS = {"REPEAT", "EXTEND", "CLIP"}


@dataclass(frozen=True)
class Cutout:
    """An image by which surfaces are solid where scale * value + offset >= 0.5."""

    image: str     # name_full
    channel: str   # the output of the node, Alpha or Color
    scale: float
    offset: float
    extension: str
    closest: bool
    uv_map: str    # "" = the one that renders use
    turn: tuple    # (2, 3) in rows: UV -> image

    def __mul__(self, k):
        return _with(self, self.scale * k, self.offset * k)

    def __add__(self, k):
        return _with(self, self.scale, self.offset + k)

    __rmul__, __radd__ = __mul__, __add__

    def alpha(self):
        """(H, W) of bytes, the lowest row first, solid from 128 on."""
        image = next(image for image in bpy.data.images if image.name_full == self.image)
        pixels = pictures.linear(image)
        if self.channel == "Alpha":
            opaque = image.channels < 4 or image.alpha_mode == "NONE"
            value = np.ones(pixels.shape[:2]) if opaque else pixels[..., 3]
        else:
            value = pictures.colors(pixels) @ colour.LUMINANCE
        return np.clip(np.rint(255 * (self.scale * value + self.offset)), 0, 255).astype(np.uint8)

    def placed(self, uvs):
        """UVs (t, 3, 2) -> places in the image."""
        turn = np.array(self.turn).reshape(2, 3)
        return (uvs @ turn[:, :2].T + turn[:, 2]).astype(np.float32)


def _with(cutout, scale, offset):
    return Cutout(cutout.image, cutout.channel, scale, offset, cutout.extension, cutout.closest, cutout.uv_map,
                  cutout.turn)


def of(material):
    """How solid a material's surfaces are where a lamp's light meets them: a Cutout, or a number from 0 to 1; solid are
    those that can't be told."""
    tree = material and material.use_nodes and material.node_tree
    out = tree and tree.get_output_node("CYCLES")
    if not out:
        return 1.0
    try:
        return 0.0 if trees.fills_only(out) else _shader(out.inputs["Surface"])
    except Exception:  # of whatever kind: one material is no reason to lose the picture
        return 1.0


@trees.bounded
def _shader(socket):
    source = trees.source_of(socket)
    if source is None:
        return 1.0
    node = source[0]
    if trees.is_nothing(node):
        return 1.0
    if node.bl_idname == "ShaderNodeBsdfTransparent":
        return 0.0
    if node.bl_idname == "ShaderNodeAddShader":  # light that goes through one goes through both
        one, other = (_shader(node.inputs[k]) for k in (0, 1))
        if isinstance(one, Cutout) and isinstance(other, Cutout):
            raise trees.Unknown(node.name)
        return one + other + -1.0
    if node.bl_idname == "ShaderNodeBsdfPrincipled":
        return _value(node.inputs["Alpha"])
    if node.bl_idname == "ShaderNodeMixShader":
        share = _value(node.inputs[0])
        if share in (0, 1):
            return _shader(node.inputs[1 + int(share)])
        one, other = (_shader(node.inputs[k]) for k in (1, 2))
        if any(isinstance(solid, Cutout) for solid in (one, other)):
            raise trees.Unknown(node.name)
        return one if one == other else share * (other - one) + one
    return 1.0


@trees.bounded
def _value(socket):
    """A number or a Cutout."""
    source = trees.source_of(socket)
    if source is None:
        return trees.own_number(socket)
    node, output = source
    if trees.is_nothing(node):
        return 0.0
    if node.bl_idname == "ShaderNodeTexImage":
        return _image(node, output.name)
    if node.bl_idname == "ShaderNodeNewGeometry" and output.name == "Backfacing":
        return 0.0  # lamps meet what is in front
    if node.bl_idname == "ShaderNodeMath":
        return _math(node)
    if node.bl_idname == "ShaderNodeRGBToBW":
        return _value(node.inputs[0])
    if node.bl_idname == "ShaderNodeInvert" and not trees.input_of(node, "Fac").is_linked:
        share, a = trees.input_of(node, "Fac").default_value, _value(node.inputs["Color"])
        return (1 - 2 * share) * a + share
    return worlds.value(socket, _RAY)


def _math(node):
    first, second = node.inputs[:2]
    if node.operation == "ROUND":
        return _value(first)
    a, b = _value(first), _value(second)
    cut = isinstance(a, Cutout) + isinstance(b, Cutout)
    if cut == 2:
        raise trees.Unknown(node.name)
    if not cut and node.operation not in ("GREATER_THAN", "LESS_THAN"):
        return worlds.summed(node, a, b)
    if node.operation == "ADD":
        return a + b
    if node.operation == "SUBTRACT":
        return a + -1 * b
    if node.operation == "MULTIPLY":
        return a * b
    if node.operation in ("GREATER_THAN", "LESS_THAN"):
        over = a + -1 * b if node.operation == "GREATER_THAN" else b + -1 * a
        return over + 0.5 if cut else float(over > 0)  # an image is cut in the middle
    raise trees.Unknown(node.name)


def _image(node, output):
    image = pictures.still(node)
    known = (image is not None and all(image.size)
             and node.projection == "FLAT" and node.extension in _EXTENSIONS)
    if not known:
        raise trees.Unknown(node.name)
    uv_map, turn = _place(node.inputs["Vector"])
    return Cutout(image.name_full, output, 1.0, 0.0, node.extension, node.interpolation == "Closest", uv_map,
                  tuple(float(x) for x in turn.ravel()))


def _place(socket):
    """(UV map, (2, 3) from UV to what a socket gets)."""
    source = trees.source_of(socket)
    if source is None:
        return "", np.eye(2, 3)
    node, output = source
    if node.bl_idname == "ShaderNodeUVMap":
        return node.uv_map, np.eye(2, 3)
    if node.bl_idname == "ShaderNodeTexCoord" and output.name == "UV":
        return "", np.eye(2, 3)
    if node.bl_idname != "ShaderNodeMapping" or trees.is_nothing(node):
        raise trees.Unknown(node.name)
    uv_map, before = _place(node.inputs["Vector"])
    own = trees.mapping(node) @ np.array([[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 1.0]])
    turn = own[:2] @ np.vstack([before, (0, 0, 1)])
    return uv_map, turn
