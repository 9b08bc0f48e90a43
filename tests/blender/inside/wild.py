# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as nobody would build them, of nodes of any kind in any mode, some muted, some behind reroutes or in
groups: what Encre makes of them, alone and beside Cycles. ENCRE_WILD says which, as FIRST:END."""

import os
import random
import time

import bpy
import numpy as np
from anytrees import _kinds
from encre.blender import cutouts, materials, meshes, mirrors, nodes, versions
from encre.blender import pictures as reading
from studio import fact
from swatches import by_cycles, by_encre, empty, look, made

ROW, PIXELS = 16, 4
_SMALL = 0.01    # of its coordinates a square shows so much: within a pixel nothing happens
_DEEPEST = 4     # nodes one behind the other, up from the output
_MOST = 14       # nodes
_LEFT_OUT = ("ShaderNodeScript", "ShaderNodeOutput", "ShaderNodeVolume", "ShaderNodeGroup", "ShaderNodeCustomGroup",
             "ShaderNodeEeveeSpecular", "ShaderNodeShaderToRGB")  # the last two are EEVEE's own
_NAMES = "Color", "Float", "Vector", "UVMap", "none", ""


def node_kinds():
    return [kind for kind in _kinds() if not kind.startswith(_LEFT_OUT) and kind != "NodeReroute"]


def pictures():
    """Images of few texels: bytes, floats, without alpha, of data."""
    made_ = []
    for k, (alpha, floats, data) in enumerate(((True, False, False), (False, False, False), (True, True, False),
                                               (True, False, True))):
        image = bpy.data.images.new(f"Wild {k}", 2, 2, alpha=alpha, float_buffer=floats, is_data=data)
        chance = random.Random(k)
        image.pixels[:] = [round(chance.uniform(0, 1), 2) for _ in range(16)]
        image.pack()
        made_.append(image)
    return made_


class Tree:
    """One material's nodes, from the output up."""

    def __init__(self, seed, kinds, images):
        self.chance, self.images = random.Random(seed), images
        # Seven of eight are such as Encre reads: what it says it can't tells nothing.
        read = [kind for kind in kinds if hasattr(nodes.Compiler, nodes.method(kind))]
        self.kinds = read if self.chance.random() < 0.875 else kinds
        self.shaders = [kind for kind in self.kinds if _gives(kind, "SHADER")]
        self.colors = [kind for kind in self.kinds if kind not in self.shaders]
        self.left = 0

    def make(self, tree, output):
        self.left = self.chance.randrange(2, _MOST)
        self.link(tree, output.inputs["Surface"], 0)

    def link(self, tree, socket, deep):
        """Links something to a socket."""
        chance = self.chance
        if socket.type == "SHADER" and chance.random() < 0.93:
            kinds = self.shaders
        else:
            kinds = self.colors if chance.random() < 0.97 else self.kinds
        older = [node for node in tree.nodes if node.outputs and not node.get("open")
                 and node.bl_idname != "NodeGroupInput"]
        node = chance.choice(older) if older and chance.random() < 0.1 else None
        node = node or self.node(tree, chance.choice(kinds), deep)
        outputs = [out for out in node.outputs if out.enabled and (kinds is not self.shaders or out.type == "SHADER")]
        if not outputs:
            return
        source = chance.choice(outputs)
        if chance.random() < 0.05:
            reroute = tree.nodes.new("NodeReroute")
            if chance.random() < 0.8:
                tree.links.new(source, reroute.inputs[0])
            source = reroute.outputs[0]
        tree.links.new(source, socket).is_muted = chance.random() < 0.02

    def node(self, tree, kind, deep):
        chance = self.chance
        self.left -= 1
        if chance.random() < 0.04 and deep < _DEEPEST and not tree.name.startswith("Group"):
            return self.group(tree, kind, deep)
        node = tree.nodes.new(kind)
        node["open"] = True  # what it leads to would close a ring
        self.shake(node)
        for socket in node.inputs:
            if socket.enabled and deep < _DEEPEST and self.left > 0 and chance.random() < 0.45:
                self.link(tree, socket, deep + 1)
        del node["open"]
        node.mute = chance.random() < 0.05
        return node

    def group(self, tree, kind, deep):
        """A node of a group that holds one, whose first input comes from outside."""
        inside = bpy.data.node_groups.new("Group", "ShaderNodeTree")
        out, into = inside.nodes.new("NodeGroupOutput"), inside.nodes.new("NodeGroupInput")
        node = self.node(inside, kind, deep)
        names = {"SHADER": "Shader", "VALUE": "Float", "VECTOR": "Vector"}
        for socket in node.outputs:
            if socket.enabled:
                versions.group_socket(inside, socket.name, names.get(socket.type, "Color"), output=True)
        for socket, end in zip([s for s in node.outputs if s.enabled], out.inputs, strict=False):
            inside.links.new(socket, end)
        free = [socket for socket in node.inputs if socket.enabled and not socket.is_linked]
        if free:
            socket = self.chance.choice(free)
            versions.group_socket(inside, "In", names.get(socket.type, "Color"))
            inside.links.new(into.outputs[0], socket)
        whole = tree.nodes.new("ShaderNodeGroup")
        whole.node_tree = inside
        whole["open"] = True
        for socket in whole.inputs:
            self.value(socket)
            if self.left > 0 and self.chance.random() < 0.5:
                self.link(tree, socket, deep + 1)
        del whole["open"]
        return whole

    def shake(self, node):
        """Modes and values that are any."""
        chance = self.chance
        for what in node.bl_rna.properties:
            if what.is_readonly or what.identifier in _KEPT:
                continue
            try:
                if what.type == "ENUM" and chance.random() < 0.6:
                    setattr(node, what.identifier, chance.choice([item.identifier for item in what.enum_items]))
                elif what.type == "BOOLEAN" and chance.random() < 0.3:
                    setattr(node, what.identifier, chance.random() < 0.5)
                elif what.identifier in ("attribute_name", "layer_name", "uv_map"):
                    setattr(node, what.identifier, chance.choice(
                        ("Color", "none", "") if what.identifier == "layer_name" else _NAMES))
                elif what.identifier == "image":
                    node.image = chance.choice((*self.images, None))
            except TypeError:
                continue
        if node.bl_idname == "ShaderNodeValToRGB":
            ramp = node.color_ramp
            ramp.color_mode = chance.choice(("RGB", "HSV", "HSL"))
            ramp.interpolation = chance.choice(("LINEAR", "CONSTANT", "EASE", "CARDINAL", "B_SPLINE"))
            for stop in ramp.elements:
                stop.color = [chance.uniform(0, 1) for _ in range(4)]
        for socket in [*node.inputs, *(node.outputs if node.bl_idname in _OWN else ())]:
            self.value(socket)
            if socket.name in _NO_MIRROR and socket.type == "VALUE":
                socket.default_value = 0

    def value(self, socket):
        chance, given = self.chance, getattr(socket, "default_value", None)
        if isinstance(given, float):
            socket.default_value = chance.choice((0, 1, 0.5, chance.uniform(0, 1), chance.uniform(0, 1),
                                                  chance.uniform(-1, 3)))
        elif hasattr(given, "__len__") and not isinstance(given, str):
            socket.default_value = [chance.uniform(0, 1) for _ in given]


_KEPT = "parent", "mute", "hide", "bl_idname", "use_custom_color", "select", "location", "name", "label"
_OWN = "ShaderNodeRGB", "ShaderNodeValue", "ShaderNodeNormal"
# What shines beside a colour, which Cycles counts as one.
_NO_MIRROR = "Specular", "Specular IOR Level", "Coat Weight", "Clearcoat", "Sheen Weight", "Sheen"
_gave = {}


def _gives(kind, socket):
    if kind not in _gave:
        tree = bpy.data.node_groups.new("Kind", "ShaderNodeTree")
        _gave[kind] = {out.type for out in tree.nodes.new(kind).outputs}
        bpy.data.node_groups.remove(tree)
    return socket in _gave[kind]


def _lay(blocks):
    """A square of each, of whose coordinates little is seen."""
    for k, block in enumerate(blocks):
        mesh = bpy.data.meshes.new(block.name)
        half = _SMALL / 2
        mesh.from_pydata([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)])
        for loop, uv in zip(mesh.uv_layers.new(name="UVMap").data, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
            loop.uv = [0.3 + _SMALL * x for x in uv]
        for item in mesh.color_attributes.new("Color", "FLOAT_COLOR", "CORNER").data:
            item.color = (0.8, 0.2, 0.6, 0.3)
        for item in mesh.attributes.new("Float", "FLOAT", "POINT").data:
            item.value = 0.4
        for item in mesh.attributes.new("Vector", "FLOAT_VECTOR", "FACE").data:
            item.vector = (0.3, 0.9, -0.4)
        mesh.materials.append(block)
        mesh.use_auto_texspace = False
        mesh.texspace_size, mesh.texspace_location = (0.5, 0.5, 0.5), (0.11, 0.07, 0.2)
        square = bpy.data.objects.new(block.name, mesh)
        square.location, square.scale = (k % ROW, -(k // ROW), 0), (1 / _SMALL,) * 3
        square.color = 0.3, 0.7, 0.2, 0.6
        bpy.context.scene.collection.objects.link(square)


def described(block):
    """What a material is made of, in lines."""
    lines = []

    def tell(tree, indent):
        for node in tree.nodes:
            modes = {p.identifier: getattr(node, p.identifier) for p in node.bl_rna.properties
                     if p.type in ("ENUM", "BOOLEAN") and not p.is_readonly and p.identifier not in _QUIET
                     and getattr(node, p.identifier) != p.default}
            if hasattr(node, "color_ramp"):
                ramp = node.color_ramp
                modes["ramp"] = ramp.color_mode, ramp.interpolation, ramp.hue_interpolation, \
                    [(x.position, *(round(c, 2) for c in x.color)) for x in ramp.elements]
            for name in ("attribute_name", "layer_name", "uv_map"):
                if hasattr(node, name):
                    modes[name] = getattr(node, name)
            if getattr(node, "image", None):
                modes["image"] = node.image.name
            lines.append(f"{indent}{node.name} {modes}{' MUTED' if node.mute else ''}")
            for socket in node.inputs:
                given = getattr(socket, "default_value", None)
                given = tuple(round(x, 3) for x in given) if hasattr(given, "__len__") and not isinstance(given, str) \
                    else given
                link = socket.links[0] if socket.is_linked else None
                muted = " muted" if link and link.is_muted else ""
                lines.append(f"{indent}    {socket.name}: " + (
                    f"<- {link.from_node.name}.{link.from_socket.name}{muted}" if link else f"{given}"))
            if getattr(node, "node_tree", None):
                tell(node.node_tree, indent + "    ")
    tell(block.node_tree, "")
    return "\n".join(lines)


_QUIET = (*_KEPT, "show_options", "show_preview", "show_texture", "bl_icon", "bl_static_type", "warning_propagation",
          "color_tag")


def _asked(first, end):
    return range(*map(int, os.environ.get("ENCRE_WILD", f"{first}:{end}").split(":")))


def _fresh():
    for blocks in (bpy.data.materials, bpy.data.node_groups, bpy.data.images, bpy.data.meshes):
        bpy.data.batch_remove(blocks)
    return empty()


def _ringed(seed, every, images):
    """A tree of which some nodes lead back to those that they come from."""
    whole = Tree(seed, every, images)

    def make(tree, output):
        whole.make(tree, output)
        own = [node for node in tree.nodes if node != output and node.outputs and node.inputs]
        for _ in range(whole.chance.randrange(4) if own else 0):
            one, other = whole.chance.choice(own), whole.chance.choice(own)
            tree.links.new(whole.chance.choice(list(one.outputs)), whole.chance.choice(list(other.inputs)))
    return make


def wild_read(_out):
    """Tells which of them can't be read without an error, and how long the slowest takes."""
    _fresh()
    every, images, kept, wrong, slowest = node_kinds(), pictures(), reading.Images(), {}, 0
    for seed in _asked(0, 200):
        block = made("Wild", _ringed(seed, every, images))
        begun = time.perf_counter()
        try:
            for read in (cutouts.of, mirrors.blurs, meshes._lets_through, meshes._displaces):
                read(block)
            looks = materials.read([block], kept)
            wrong.update((seed, words) for words in looks.unknown.values() if words.startswith("reading it failed"))
        except Exception as error:
            wrong[seed] = repr(error)
        slowest = max(slowest, time.perf_counter() - begun)
        bpy.data.materials.remove(block)
        bpy.data.batch_remove(bpy.data.node_groups)
    fact("wrong", wrong)
    fact("slowest", slowest)


def wild(out):
    """Tells which are another colour by Encre than by Cycles, without a sentence about it."""
    every, seeds, told, silent, wrong = node_kinds(), _asked(0, 1024), 0, 0, {}
    for start in range(seeds.start, seeds.stop, ROW * ROW):
        scene, images = _fresh(), pictures()
        blocks = [made(f"Wild {seed}", Tree(seed, every, images).make)
                  for seed in range(start, min(seeds.stop, start + ROW * ROW))]
        _lay(blocks)
        look(ROW)
        scene.render.resolution_x = scene.render.resolution_y = ROW * PIXELS
        theirs, alpha = by_cycles(out, "wild", len(blocks), 64, (ROW, PIXELS))
        ours, there, said = by_encre(len(blocks), (ROW, PIXELS))
        for k, block in enumerate(blocks):
            if f"{block.name} (" in said:
                told += 1
                continue
            silent += 1
            if not _away(theirs[k], ours[k], alpha[k], there[k]) <= 0.02:
                wrong[block.name] = [theirs[k].tolist(), ours[k].tolist(), float(alpha[k]), bool(there[k]),
                                     described(block)]
    fact("told", told)
    fact("silent", silent)
    fact("wrong", wrong)


def _away(theirs, ours, alpha, there):
    if 0.4 < alpha < 0.6:  # by 64 samples it is there or not
        return 0
    if there != (alpha >= 0.5):
        return np.inf
    theirs = theirs / max(alpha, 0.5)
    return np.abs(theirs - ours).max() / max(theirs.max(), 1) if there else 0
