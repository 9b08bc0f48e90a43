# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees, whoever reads them: what a socket gets its value from, and what a Mapping does."""

import functools

import numpy as np
from mathutils import Euler

_DEEPEST = 60  # nodes one behind the other


class Unknown(Exception):
    """A node that can't be read; its text is the node's name."""


def nodes_of(material):
    """All nodes of a material, those of groups too, each group once."""
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
    """(node, its output) that a socket is linked to, past reroutes; None. Links that close a ring are invalid: as in
    Cycles they are none."""
    while socket.is_linked:
        link = socket.links[0]
        if not link.is_valid:
            break
        if link.from_node.bl_idname != "NodeReroute":
            return link.from_node, link.from_socket
        socket = link.from_node.inputs[0]
    return None


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
