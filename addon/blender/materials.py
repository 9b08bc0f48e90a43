# SPDX-License-Identifier: GPL-3.0-or-later
"""What surfaces look like without light, as far as it can be told without a renderer."""

from dataclasses import dataclass, field

import numpy as np

from . import worlds

_PLAIN = (0.8, 0.8, 0.8)  # what a renderer gives a surface without a material


@dataclass
class Look:
    """Colours (3,), scene-linear."""

    color: np.ndarray = field(default_factory=lambda: np.zeros(3))     # of matt light
    gloss: np.ndarray = field(default_factory=lambda: np.zeros(3))     # of what is reflected or seen through it
    emission: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def __add__(self, other):
        return Look(self.color + other.color, self.gloss + other.gloss, self.emission + other.emission)

    def __mul__(self, share):
        return Look(self.color * share, self.gloss * share, self.emission * share)


def look(material):
    """(the Look of a material, the name of the node that can't be shown: then it is its viewport colour, or None)."""
    if material is None:
        return Look(np.array(_PLAIN)), None
    plain = Look(np.array(material.diffuse_color[:3], np.float64))
    if not material.use_nodes or material.node_tree is None:
        return plain, None
    out = material.node_tree.get_output_node("CYCLES")
    try:
        return (_surface(out.inputs["Surface"]) if out else Look()), None
    except worlds.Unknown as e:
        return plain, str(e)


def _surface(socket):
    if not socket.is_linked:
        return Look()
    node = socket.links[0].from_node
    if node.mute or node.bl_idname not in _SURFACES:
        raise worlds.Unknown(node.name)
    return _SURFACES[node.bl_idname](node)


def _number(socket):
    return worlds.value(socket, worlds.SEEN)


def _principled(node):
    base, metal = worlds.color(node.inputs["Base Color"]), _number(node.inputs["Metallic"])
    through = _number(node.inputs["Transmission Weight" if "Transmission Weight" in node.inputs else "Transmission"])
    own = (1 - metal) * (1 - through)
    emission = worlds.color(node.inputs["Emission Color" if "Emission Color" in node.inputs else "Emission"])
    return Look(base * own, base * (1 - own), emission * _number(node.inputs["Emission Strength"]))


def _mix(node):
    share = float(np.clip(_number(node.inputs[0]), 0, 1))
    if share in (0, 1):
        return _surface(node.inputs[1 + int(share)])
    return _surface(node.inputs[1]) * (1 - share) + _surface(node.inputs[2]) * share


_SURFACES = {
    "ShaderNodeBsdfPrincipled": _principled,
    "ShaderNodeBsdfDiffuse": lambda node: Look(worlds.color(node.inputs["Color"])),
    "ShaderNodeBsdfToon": lambda node: Look(worlds.color(node.inputs["Color"])),
    "ShaderNodeBsdfGlossy": lambda node: Look(gloss=worlds.color(node.inputs["Color"])),
    "ShaderNodeBsdfAnisotropic": lambda node: Look(gloss=worlds.color(node.inputs["Color"])),  # since 4.0 Glossy's id
    "ShaderNodeBsdfGlass": lambda node: Look(gloss=worlds.color(node.inputs["Color"])),
    "ShaderNodeEmission": lambda node: Look(
        emission=worlds.color(node.inputs["Color"]) * _number(node.inputs["Strength"])),
    "ShaderNodeMixShader": _mix,
    "ShaderNodeAddShader": lambda node: _surface(node.inputs[0]) + _surface(node.inputs[1]),
}
