# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes -> operations. To add one: a method _<bl_idname without ShaderNode> of Compiler that gives the values of
all its outputs by their names. Shaders are in shaders.py, what meshes and pictures say in inputs.py, patterns in
patterns.py, what mixes colours and numbers in values.py and sums.py.

Any output may be linked to any input, so what is read is made a number, three or a surface, as Cycles makes it. What
can't be read costs the input that it leads to, which then has the value that it has when nothing is linked."""

import numpy as np

from ..pen.colour import LUMINANCE
from ..pen.job import Program
from ..pen.program import Builder, TooLong
from . import trees, unseen
from .inputs import Straight
from .shaders import Shaders, Surface

_DEEPEST = 120  # nodes one behind the other: each takes seven of the thousand calls that Python has wait for others
_MOST_GROUPS = 15  # one in the other


class Compiler(Shaders):
    """The program of one material."""

    def __init__(self, pool, images, block=None):
        """block: the evaluated material, None: what has none."""
        self.images, self.build, self.sources = images, Builder(pool), []
        self.plain = tuple(map(float, block.diffuse_color[:3])) if block else (0.8, 0.8, 0.8)  # as renderers have it
        self.index = float(block.pass_index) if block else 0.0
        self.through = False  # whether light goes through it, as through glass
        self.lost = []  # nodes that change what it looks like, and are not shown
        self.looked = {}  # first register of a look into a picture -> its colored.Place; absent: it lies by no UV map
        # Outputs of nodes by (groups around them, node, where they are looked at); nodes of open groups.
        self._known, self._groups, self._deep = {}, [], 0
        self.beside = None  # where: None: at the pixel; (0 or 1, part): that part of one to the right, or below

    # What becomes of it

    def matt(self, color):
        return Surface(color)

    def nothing(self):
        return Surface()

    def clear(self):
        return Surface(alpha=0.0)

    def finish(self, surface, first):
        """The job.Program; first: the first of the attributes' channels that are its."""
        made = self.build.program([*surface.color, *surface.gloss, *surface.emission, surface.alpha,
                                   surface.roughness, *surface.shine, surface.shine_roughness, surface.coat,
                                   surface.coat_roughness, *surface.turned, surface.holdout])
        codes = [self.build.code(name) for name in ("channel", "footprint")]
        operations = made.operations.copy()
        operations[np.isin(operations[:, 0], codes), 10] += first
        return Program(operations, made.registers, made.result)

    def lose(self, what):
        """Notes what is not shown as it should be."""
        if what not in self.lost:
            self.lost.append(what)

    # Sockets

    def material(self, socket):
        """The Surface of a material's output. Unknown: its shader can't be read."""
        source = trees.source_of(socket)
        return self.nothing() if source is None else self._shown(self._given(socket, source)[0])

    def shader(self, socket):
        """The Surface that a socket is given: black where nothing is linked, the material's viewport colour where it
        can't be read."""
        try:
            return self.material(socket)
        except trees.Unknown as e:
            self.lose(str(e))
            return Surface(self.plain)

    def _shown(self, value):
        """A Surface of any value: what is none glows, as in Cycles."""
        if isinstance(value, Surface):
            return value
        value = self._scalars(value)
        return Surface(emission=tuple(value[:3]) if isinstance(value, tuple) else (value,) * 3)

    def _output(self, node, socket):
        """The value of an output: a number, a tuple of three or four, or a Surface."""
        if trees.is_nothing(node):
            return trees.nothing(socket, self.nothing)
        self._deep += 1
        try:
            if self._deep > _DEEPEST:
                raise TooLong
            if node.bl_idname == "ShaderNodeGroup" or (
                    getattr(node, "node_tree", None) and not hasattr(self, method(node.bl_idname))):
                return self._group(node, socket)
            if node.bl_idname == "NodeGroupInput":
                return self._outside(socket)
            values = self._values(node, socket)
        finally:
            self._deep -= 1
        if socket.identifier in values:
            return values[socket.identifier]
        if socket.name in values:
            return values[socket.name]
        raise trees.Unknown(node.name)

    def _values(self, node, socket):
        """Those of all its outputs, made once."""
        key = (tuple(group.name for group in self._groups), node.name, self.beside)
        if key not in self._known:
            make = getattr(self, method(node.bl_idname), None)
            if make is None:
                raise trees.Unknown(node.name)
            try:
                self._known[key] = values = make(node)
            except KeyError as e:  # an input that it has not in each of its modes, or in this Blender
                raise trees.Unknown(node.name) from e
            if socket.type == "SHADER":
                self._turn(node, values)
        return self._known[key]

    def _turn(self, node, values):
        """Has the surfaces that a shader gives face where it is told to, or notes that they should."""
        for into, (by, _) in unseen.turned(node):
            known, read, lost = dict(self._known), len(self.sources), list(self.lost)
            try:
                if into.name != "Normal":
                    raise trees.Unknown(by.name)
                with self.build.in_half():  # what it looks like matters more
                    turned = self.three(into)
                for surface in values.values():
                    surface.turned = turned
            except (trees.Unknown, TooLong) as e:
                self._known, self.lost = known, lost
                del self.sources[read:]
                self.lose(str(e))

    def _group(self, node, socket):
        tree = node.node_tree
        out = tree and next((n for n in tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
        into = out and next((s for s in out.inputs if s.identifier == socket.identifier), None)
        if len(self._groups) == _MOST_GROUPS:
            raise trees.Unknown(node.name)
        if into is None:
            return trees.nothing(socket, self.nothing)
        self._groups.append(node)
        try:
            return self._any(into)
        finally:
            self._groups.pop()

    def _outside(self, socket):
        if not self._groups:
            return trees.nothing(socket, self.nothing)
        node = self._groups.pop()
        try:
            into = next((s for s in node.inputs if s.identifier == socket.identifier), None)
            return trees.nothing(socket, self.nothing) if into is None else self._any(into)
        finally:
            self._groups.append(node)

    def _any(self, socket):
        if socket.type == "SHADER":
            return self.shader(socket)
        if socket.type in trees.NUMBERS:
            return self.number(socket)
        return self.vector(socket) if socket.type == "VECTOR" else self.three(socket)

    def _read(self, socket, unlinked):
        """(what a socket is given, not a Surface; whether it is a colour). unlinked(): what it has where nothing that
        can be read is linked."""
        source = trees.source_of(socket)
        try:
            value, color = (None, False) if source is None else self._given(socket, source)
        except trees.Unknown as e:
            self.lose(str(e))
            if socket.type == "RGBA" and any(out.type == "SHADER" for out in socket.node.outputs):
                return self.plain, True
            value = None
        if value is None or isinstance(value, Surface):
            return unlinked(), socket.type == "RGBA"
        return value, color

    def _given(self, socket, source):
        """(what a socket is given by its source, whether it is a colour)."""
        value, color = self._output(*source), source[1].type == "RGBA"
        for kind in trees.turned_into(socket) if not isinstance(value, Surface) else ():
            value = self._as_number(value, color) if kind in trees.NUMBERS else value
            color = kind == "RGBA"
        return value, color

    def given(self, socket):
        """Whether something is linked to a socket that else has a value of its own making: reroutes and muted nodes to
        which nothing is linked are nothing, and so are inputs and outputs of groups."""
        source = trees.source_of(socket)
        if source is None or trees.is_nothing(source[0]):
            return False
        node, output = source
        if node.bl_idname == "NodeGroupInput" and self._groups:
            around = self._groups.pop()
            try:
                outside = next((s for s in around.inputs if s.identifier == output.identifier), None)
                return outside is not None and self.given(outside)
            finally:
                self._groups.append(around)
        return True

    def number(self, socket):
        return self._as_number(*self._read(socket, lambda: trees.own(socket)))

    def _as_number(self, value, color):
        value = self._scalars(value)
        if isinstance(value, tuple):
            return self._dot(value[:3], LUMINANCE if color else (1 / 3,) * 3)
        return value

    def three(self, socket):
        """A colour or vector."""
        value = self._scalars(self._read(socket, lambda: trees.own(socket))[0])
        return tuple(value[:3]) if isinstance(value, tuple) else (value,) * 3

    def vector(self, socket, unlinked=None):
        """A Straight if it is one, else three numbers; unlinked(): what it is where nothing is linked, nor reroutes and
        muted nodes to which nothing is; None: the socket's own."""
        if unlinked and not self.given(socket):
            return unlinked()
        value, _ = self._read(socket, unlinked or (lambda: trees.own(socket)))
        return value if isinstance(value, Straight | tuple) else (value,) * 3

    def _dot(self, values, weights):
        total = 0.0
        for value, weight in zip(values, weights, strict=True):
            total = self.build.add(total, self.build.multiply(value, float(weight)))
        return total

    def _each(self, function, *threes):
        return tuple(function(*values) for values in zip(*threes, strict=True))

    def _mixed(self, a, b, t):
        return self._each(lambda x, y: self.build.mix(x, y, t), a, b)


def method(kind):
    """The name of the method that reads a kind of node."""
    return "_" + kind.removeprefix("ShaderNode")
