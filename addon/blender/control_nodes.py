# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group *Encre Control* of Geometry Nodes: writes a control's attribute as painted colors, by noise, by the
distance from an object and by the angle of view, each as strong as its amount, over what was painted or written before;
so several modifiers lie one above another."""

import bpy

from ..pen.colour import LUMINANCE
from . import versions

NAME = "Encre Control"
# name, type of the socket, default, range: the group's inputs after the geometry. Ids are their names.
_INPUTS = (
    ("Attribute", "String", "encre_thickness", None), ("Keep Below", "Bool", True, None),
    ("Value", "Float", 0.0, (-1, 1)),
    ("Noise", "Float", 0.0, (-1, 1)), ("Noise Scale", "Float", 2.0, (0, 1000)),
    ("Nearness", "Float", 0.0, (-1, 1)), ("Object", "Object", None, None), ("Reach", "Float", 1.0, (0, 10000)),
    ("Edge-on", "Float", 0.0, (-1, 1)), ("Camera", "Object", None, None),
)


class _Builder:
    """Adds nodes; numbers and sockets alike are what nodes take."""

    def __init__(self, tree):
        self.tree = tree

    def node(self, kind, *values, **settings):
        made = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(made, name, value)
        for socket, value in zip(made.inputs, values, strict=False):
            self.set(socket, value)
        return made

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif value is not None:
            socket.default_value = value

    def math(self, operation, *values, clamp=False):
        return self.node("ShaderNodeMath", *values, operation=operation, use_clamp=clamp).outputs[0]

    def vector(self, operation, *values):
        outputs = self.node("ShaderNodeVectorMath", *values, operation=operation).outputs
        return outputs[1 if operation in ("DOT_PRODUCT", "DISTANCE") else 0]

    def place(self, thing):
        """Where an object is, as the mesh sees it."""
        return self.node("GeometryNodeObjectInfo", thing, transform_space="RELATIVE").outputs["Location"]

    def if_above(self, value, edge, above, below):
        """above where value > edge, else below."""
        return self.math("MULTIPLY_ADD", self.math("GREATER_THAN", value, edge),
                         self.math("SUBTRACT", above, below), below)

    def encoded(self, linear):
        """sRGB, as colour.encode_srgb()."""
        power = self.math("POWER", self.math("MAXIMUM", linear, 0.0), 1 / 2.4)
        return self.if_above(linear, 0.0031308, self.math("MULTIPLY_ADD", power, 1.055, -0.055),
                             self.math("MULTIPLY", linear, 12.92))

    def linear(self, encoded):
        base = self.math("MULTIPLY_ADD", encoded, 1 / 1.055, 0.055 / 1.055)
        return self.if_above(encoded, 0.04045, self.math("POWER", base, 2.4), self.math("DIVIDE", encoded, 12.92))


def group():
    """The node group, made where the file has none."""
    found = bpy.data.node_groups.get(NAME)
    if found is None or found.bl_idname != "GeometryNodeTree":
        found = _build(bpy.data.node_groups.new(NAME, "GeometryNodeTree"))
    return found


def _build(tree):
    versions.group_socket(tree, "Geometry", "Geometry", output=True)
    versions.group_socket(tree, "Geometry", "Geometry")
    for name, kind, default, limits in _INPUTS:
        versions.group_socket(tree, name, kind, default, limits)
    build, given = _Builder(tree), tree.nodes.new("NodeGroupInput").outputs
    parts = [given["Value"], _below(build, given), _noise(build, given), _near(build, given), _edge_on(build, given)]
    value = parts[0]
    for part in parts[1:]:
        value = build.math("ADD", value, part)
    grey = build.linear(build.math("MULTIPLY_ADD", value, 0.5, 0.5, clamp=True))
    store = build.node("GeometryNodeStoreNamedAttribute", given["Geometry"], data_type="FLOAT_COLOR", domain="CORNER")
    build.set(store.inputs["Name"], given["Attribute"])
    build.set(next(socket for socket in store.inputs if socket.type == "RGBA"), grey)
    tree.links.new(store.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    return _laid_out(tree)


def _below(build, given):
    """What was painted or written: nothing where the attribute is missing, as it has no alpha there."""
    named = build.node("GeometryNodeInputNamedAttribute", given["Attribute"], data_type="FLOAT_COLOR")
    color = next(socket for socket in named.outputs if socket.type == "RGBA")
    alpha = build.node("FunctionNodeSeparateColor", color).outputs["Alpha"]
    luminance = build.vector("DOT_PRODUCT", color, LUMINANCE)
    value = build.math("MULTIPLY_ADD", build.encoded(luminance), 2.0, -1.0)
    return build.math("MULTIPLY", value, build.math("MULTIPLY", alpha, given["Keep Below"]))


def _noise(build, given):
    noise = build.node("ShaderNodeTexNoise")
    build.set(noise.inputs["Scale"], given["Noise Scale"])
    return build.math("MULTIPLY", build.math("MULTIPLY_ADD", noise.outputs[0], 4.0, -2.0), given["Noise"])


def _near(build, given):
    position = build.node("GeometryNodeInputPosition").outputs[0]
    away = build.math("DIVIDE", build.vector("DISTANCE", position, build.place(given["Object"])), given["Reach"])
    return build.math("MULTIPLY", build.math("SUBTRACT", 1.0, away, clamp=True), given["Nearness"])


def _edge_on(build, given):
    position, normal = (build.node(f"GeometryNodeInput{kind}").outputs[0] for kind in ("Position", "Normal"))
    towards = build.vector("NORMALIZE", build.vector("SUBTRACT", build.place(given["Camera"]), position))
    facing = build.math("ABSOLUTE", build.vector("DOT_PRODUCT", normal, towards))
    return build.math("MULTIPLY", build.math("SUBTRACT", 1.0, facing, clamp=True), given["Edge-on"])


def _laid_out(tree):
    """Each node to the right of all that it reads."""
    column, rows = {}, {}
    for _ in tree.nodes:
        for link in tree.links:
            column[link.to_node] = max(column.get(link.to_node, 0), column.get(link.from_node, 0) + 1)
    for node in tree.nodes:
        x = column.get(node, 0)
        node.location = 180 * x, -180 * rows.get(x, 0)
        rows[x] = rows.get(x, 0) + 1
    return tree


def add(obj, values):
    """Adds the group to an object as its last modifier, with these inputs by their names."""
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.node_group = group()
    for name, value in values.items():
        versions.set_group_input(modifier, name, value)
    obj.update_tag()
    return modifier
