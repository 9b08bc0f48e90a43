# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees, whoever reads them: what a socket gets its value from, and what a Mapping does."""

import functools

import numpy as np
from mathutils import Euler

from ..pen.colour import LUMINANCE

NUMBERS = "VALUE", "INT", "BOOLEAN"  # types of sockets
_DEEPEST = 60  # nodes one behind the other


class Unknown(Exception):
    """A node that can't be read; its text is the node's name."""


def nodes_of(material):
    """All nodes of a material or a world, those of groups too, each group once."""
    todo, known = [material.node_tree if material.use_nodes else None], set()
    while todo:
        tree = todo.pop()
        if tree is None or tree.name_full in known:
            continue
        known.add(tree.name_full)
        for node in tree.nodes:
            yield node
            todo.append(getattr(node, "node_tree", None))


def source_of(socket):
    """(node, its output) that a socket is linked to, past reroutes and muted nodes; None: it has its own value. Links
    that close a ring are invalid: as in Cycles they are none. A reroute, or a node that is muted, to which nothing is
    linked is given itself: its value is nothing()."""
    return _way_to(socket)[0]


def turned_into(socket):
    """The types of the outputs of muted nodes that what a socket is linked to goes through, in that order: as in Cycles
    it becomes one after the other."""
    return _way_to(socket)[1][::-1]


def _way_to(socket):
    """(source_of(), the types of the outputs of muted nodes on the way there)."""
    source, passed, types = None, set(), []
    while link := _link(socket):
        node, output = link.from_node, link.from_socket
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            socket = next((inner.from_socket for inner in node.internal_links if inner.to_socket == output), None)
            if socket is None:  # the link ends there
                break
            types.append(output.type)
        else:
            return (node, output), types
        if node.name in passed:  # a ring
            return None, []
        passed.add(node.name)
        source = node, output
    return source, []


def _link(socket):
    """The link that counts of a socket, None."""
    link = socket.links[0] if socket.is_linked and len(socket.links) else None
    return link if link and link.is_valid and not link.is_muted else None


def nothing(socket, shader=None):
    """What an output of nothing gives: 0, black, or shader()."""
    if socket.type == "SHADER" and shader:
        return shader()
    return 0.0 if socket.type in NUMBERS else (0.0,) * 3


def is_nothing(node):
    """Whether a node that source_of() gave gives nothing()."""
    return node.mute or node.bl_idname == "NodeReroute"


def own(socket):
    """The number or the three that a socket has where nothing is linked; 0: it has neither."""
    given = getattr(socket, "default_value", 0.0)
    if isinstance(given, str) or not hasattr(given, "__len__"):
        return float(given) if isinstance(given, int | float) else 0.0
    return (*map(float, given[:3]), 0.0, 0.0)[:3]


def own_number(socket):
    """Likewise as a number."""
    given = own(socket)
    weights = LUMINANCE if socket.type == "RGBA" else (1 / 3,) * 3
    return float(np.dot(given, weights)) if isinstance(given, tuple) else given


def fills_only(out):
    """Whether a material, by its output, has a volume and no surface, which then is clear."""
    return source_of(out.inputs["Surface"]) is None and source_of(out.inputs["Volume"]) is not None


def bounded(read):
    """read(socket, ...), which calls itself for what lies behind: Unknown, before Python has no room for the calls."""
    deep = 0

    @functools.wraps(read)
    def bounded_read(socket, *args):
        nonlocal deep
        if deep == _DEEPEST:
            raise Unknown("more nodes than there is room for")
        deep += 1
        try:
            return read(socket, *args)
        finally:
            deep -= 1
    return bounded_read


def input_of(node, identifier):
    """An input by its identifier, which stays where Blender 5 gave it another name (Fac, Bright)."""
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def mapping(node):
    """(3, 4) of what a Mapping node does. Unknown: it isn't the same everywhere."""
    names = [name for name in ("Location", "Rotation", "Scale") if name in node.inputs]
    if any(node.inputs[name].is_linked for name in names) or node.vector_type == "NORMAL":
        raise Unknown(node.name)
    turn = np.array(Euler(node.inputs["Rotation"].default_value).to_matrix(), np.float64)
    scale = np.array(node.inputs["Scale"].default_value, np.float64)
    move = np.array(node.inputs["Location"].default_value if "Location" in names else (0, 0, 0), np.float64)
    if node.vector_type == "TEXTURE":
        inverse = np.where(scale != 0, 1 / np.where(scale != 0, scale, 1), 0)[:, None] * turn.T
        return np.hstack([inverse, -(inverse @ move)[:, None]])
    return np.hstack([turn * scale, (move if node.vector_type == "POINT" else 0 * move)[:, None]])
