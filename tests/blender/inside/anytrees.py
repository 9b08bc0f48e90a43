# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees of nodes at random: whatever is linked to whatever, muted, looped, grouped, in any mode."""

import random

import bpy
from encre.blender import cutouts, materials, meshes, mirrors, pictures
from studio import fact
from swatches import add, empty, looped, made, shown


def _kinds():
    tree, found = bpy.data.materials.new("Kinds"), []
    tree.use_nodes = True
    for name in sorted(dir(bpy.types)):
        if name.startswith("ShaderNode") and not name.startswith(("ShaderNodeOutput", "ShaderNodeScript")):
            try:
                tree.node_tree.nodes.new(name)
            except RuntimeError:
                continue
            found.append(name)
    bpy.data.materials.remove(tree)
    return [*found, "NodeReroute"]


def _shaken(chance, node):
    """A node whose modes and values are any."""
    for what in node.bl_rna.properties:
        if what.type == "ENUM" and not what.is_readonly and chance.random() < 0.5:
            try:
                setattr(node, what.identifier, chance.choice([item.identifier for item in what.enum_items]))
            except TypeError:
                continue
    for socket in [*node.inputs, *(node.outputs if node.bl_idname in ("ShaderNodeRGB", "ShaderNodeValue") else ())]:
        given = getattr(socket, "default_value", None)
        if isinstance(given, float):
            socket.default_value = chance.choice((0, 0.5, 1, chance.uniform(-2, 3)))
        elif hasattr(given, "__len__") and not isinstance(given, str):
            socket.default_value = [chance.uniform(0, 1) for _ in given]
    node.mute = chance.random() < 0.08
    return node


def _random_tree(seed, kinds):
    """A material of up to eight nodes, in a group some of them, with links between any."""
    chance = random.Random(seed)

    def fill(tree, nodes, count):
        for _ in range(count):
            nodes.append(_shaken(chance, tree.nodes.new(chance.choice(kinds))))
        for _ in range(3 * len(nodes)):
            one, other = chance.choice(nodes), chance.choice(nodes)
            if len(one.outputs) and len(other.inputs):
                link = tree.links.new(chance.choice(list(one.outputs)), chance.choice(list(other.inputs)))
                link.is_muted = chance.random() < 0.04

    def make(tree, output):
        nodes = [output]
        if chance.random() < 0.3 and hasattr(tree, "interface"):
            group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
            for side in ("INPUT", "OUTPUT", "OUTPUT"):
                kind = chance.choice(("Float", "Color", "Vector", "Shader"))
                group.interface.new_socket("Any", in_out=side, socket_type=f"NodeSocket{kind}")
            fill(group, [group.nodes.new(f"NodeGroup{side}") for side in ("Input", "Output")], 3)
            nodes.append(add(tree, "Group", node_tree=group))
        fill(tree, nodes, chance.randrange(1, 7))
        outputs = [socket for node in nodes[1:] for socket in node.outputs]
        if outputs:
            tree.links.new(chance.choice(outputs), output.inputs["Surface"])
    return make


def any_trees(_out):
    """Reads trees at random: what goes wrong, by number."""
    empty()
    kinds, kept, wrong = _kinds(), pictures.Images(), {}
    for seed in range(-1, 300):  # of the first Cycles itself may end
        block = made("Any", shown(looped) if seed < 0 else _random_tree(seed, kinds))
        try:
            for read in (cutouts.of, mirrors.blurs, meshes._lets_through, meshes._displaces):
                read(block)
            looks = materials.read([block], kept)
            wrong.update((seed, words) for words in looks.unknown.values() if words.startswith("reading it failed"))
        except Exception as error:
            wrong[seed] = repr(error)
        bpy.data.materials.remove(block)
    fact("wrong", wrong)
    fact("kinds", len(kinds))
