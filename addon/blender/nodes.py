# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes -> operations. To add one: a method _<bl_idname without ShaderNode> of Compiler that gives the values of
all its outputs by their names. Patterns are in patterns.py, what mixes colours and numbers in values.py."""

from dataclasses import dataclass

import numpy as np

from ..pen.colour import LUMINANCE
from ..pen.job import Program
from ..pen.program import Builder, TooLong
from . import pictures, trees, unseen
from .patterns import Patterns

_MOST_SOURCES = 5
_DEEPEST = 160  # nodes one behind the other: each takes five of the thousand calls that Python has wait for others


@dataclass
class Surface:
    """Colours by threes, alpha and roughness, of numbers and registers. Where something shows through, colours are
    those of the share that does not."""

    color: tuple = (0.0, 0.0, 0.0)
    gloss: tuple = (0.0, 0.0, 0.0)
    emission: tuple = (0.0, 0.0, 0.0)
    alpha: object = 1.0
    roughness: object = 1.0
    shine: tuple = (0.0, 0.0, 0.0)   # of highlights, where they are looked at from above
    shine_roughness: object = 0.0
    coat: object = 0.0               # likewise, of what lies above it
    coat_roughness: object = 0.0
    turned: tuple = (0.0, 0.0, 0.0)  # where light takes it to face; 0: where the mesh does
    holdout: object = 0.0            # the share that is a hole in the picture


@dataclass
class Straight:
    """A vector that grows evenly along a surface: `rows` (3, 4) times three channels of it and 1."""

    source: int
    rows: np.ndarray


class Compiler(Patterns):
    """The program of one material."""

    def __init__(self, pool, images):
        self.images, self.build, self.sources = images, Builder(pool), []
        self.through = False  # whether light goes through it, as through glass
        self.lost = []  # nodes that change what it looks like, and are not shown
        # Outputs of nodes by (groups around them, node, where they are looked at); nodes of open groups.
        self._known, self._groups, self._deep = {}, [], 0
        self.beside = None  # where: None: at the pixel; (0 or 1, part): that part of one to the right, or below

    # What becomes of it

    def matt(self, color):
        return Surface(color)

    def nothing(self):
        return Surface()

    def finish(self, surface, first):
        """The job.Program; first: the first of the attributes' channels that are its."""
        made = self.build.program([*surface.color, *surface.gloss, *surface.emission, surface.alpha,
                                   surface.roughness, *surface.shine, surface.shine_roughness, surface.coat,
                                   surface.coat_roughness, *surface.turned, surface.holdout])
        codes = [self.build.code(name) for name in ("channel", "footprint")]
        operations = made.operations.copy()
        operations[np.isin(operations[:, 0], codes), 10] += first
        return Program(operations, made.registers, made.result)

    # Sockets

    def shader(self, socket):
        source = trees.source_of(socket)
        if source is None:
            return self.nothing()
        return self._output(*source)

    def _output(self, node, socket):
        """The value of an output: a number, a tuple of three or four, or a Surface."""
        self._deep += 1
        try:
            if self._deep > _DEEPEST:
                raise TooLong
            if node.mute:
                raise trees.Unknown(node.name)
            if node.bl_idname == "ShaderNodeGroup":
                return self._group(node, socket)
            if node.bl_idname == "NodeGroupInput":
                return self._outside(socket)
            values = self._values(node, socket)
        except TooLong as e:
            raise trees.Unknown(str(e)) from None
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
            make = getattr(self, "_" + node.bl_idname.removeprefix("ShaderNode"), None)
            if make is None:
                raise trees.Unknown(node.name)
            self._known[key] = values = make(node)
            if socket.type == "SHADER":
                self._turn(node, values)
        return self._known[key]

    def _turn(self, node, values):
        """Has the surfaces that a shader gives face where it is told to, or notes that they should."""
        for into, (by, _) in unseen.turned(node):
            known, read = dict(self._known), len(self.sources)
            try:
                if into.name != "Normal":
                    raise trees.Unknown(by.name)
                with self.build.in_half():  # what it looks like matters more
                    turned = self.three(into)
                for surface in values.values():
                    surface.turned = turned
            except (trees.Unknown, TooLong) as e:
                self._known = known
                del self.sources[read:]
                name = by.name if isinstance(e, TooLong) else str(e)
                if name not in self.lost:
                    self.lost.append(name)

    def _group(self, node, socket):
        tree = node.node_tree
        out = tree and next((n for n in tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
        into = out and next((s for s in out.inputs if s.identifier == socket.identifier), None)
        if into is None or len(self._groups) > 15:
            raise trees.Unknown(node.name)
        self._groups.append(node)
        try:
            return self.shader(into) if into.type == "SHADER" else self._any(into)
        finally:
            self._groups.pop()

    def _outside(self, socket):
        node = self._groups.pop()
        try:
            into = next(s for s in node.inputs if s.identifier == socket.identifier)
            return self.shader(into) if into.type == "SHADER" else self._any(into)
        finally:
            self._groups.append(node)

    def _any(self, socket):
        return self.number(socket) if socket.type in ("VALUE", "INT", "BOOLEAN") else self.three(socket)

    def number(self, socket):
        source = trees.source_of(socket)
        if source is None:
            return float(socket.default_value)
        value = self._output(*source)
        if isinstance(value, Straight):
            value = self._scalars(value)
        if isinstance(value, tuple):
            weights = LUMINANCE if source[1].type == "RGBA" else (1 / 3,) * 3
            return self._dot(value[:3], weights)
        return value

    def three(self, socket):
        """A colour or vector."""
        source = trees.source_of(socket)
        if source is None:
            given = socket.default_value
            return tuple(map(float, given[:3])) if hasattr(given, "__len__") else (float(given),) * 3
        value = self._output(*source)
        if isinstance(value, Straight):
            return self._scalars(value)
        return tuple(value[:3]) if isinstance(value, tuple) else (value,) * 3

    def vector(self, socket, unlinked):
        """A Straight if it is one, else three numbers; unlinked(): what it is where nothing is linked."""
        source = trees.source_of(socket)
        if source is None:
            return unlinked()
        value = self._output(*source)
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

    # What comes from meshes

    def _mesh(self, *source):
        """A Straight of three channels."""
        if source not in self.sources:
            if len(self.sources) == _MOST_SOURCES:
                raise trees.Unknown("more coordinates and attributes than there is room for")
            self.sources.append(source)
        return Straight(self.sources.index(source), np.eye(3, 4))

    def _uv(self):
        return self._mesh("uv", "")

    def _generated(self):
        return self._mesh("generated", "")

    def _scalars(self, vector):
        if not isinstance(vector, Straight):
            return vector
        channels = [self.build.run("channel", data=(3 * vector.source + k,))[0] for k in range(3)]
        if self.beside:
            way, part = self.beside
            by = self.build.pool.place((1, 0, 0, 0, 1, 0)), self.build.pool.place((0, 0, 1, 0, 0, 1))
            first, last = (self.build.run("footprint", data=(3 * vector.source, at)) for at in by)
            steps = *first[2 * way:2 * way + 2], last[2 * way]
            channels = [self.build.add(c, self.build.multiply(step, part))
                        for c, step in zip(channels, steps, strict=True)]
        return tuple(self.build.add(self._dot(channels, row[:3]), float(row[3])) for row in vector.rows)

    # Shaders

    def _BsdfDiffuse(self, node):
        return {"BSDF": Surface(self.three(node.inputs["Color"]))}

    _BsdfToon = _BsdfTranslucent = _BsdfDiffuse

    def _SubsurfaceScattering(self, node):
        return {"BSSRDF": Surface(self.three(node.inputs["Color"]))}

    def _BsdfGlossy(self, node):
        color, rough = self.three(node.inputs["Color"]), self._roughness(node)
        return {"BSDF": Surface(gloss=color, roughness=rough, shine=color, shine_roughness=rough)}

    def _roughness(self, node):
        return self.build.clamp(self.number(node.inputs["Roughness"]))

    _BsdfAnisotropic = _BsdfGlossy  # what Glossy is called since 4.0

    def _BsdfGlass(self, node):
        self.through = True
        color, rough = self.three(node.inputs["Color"]), self._roughness(node)
        level = self._mirrors(self.number(node.inputs["IOR"]))
        return {"BSDF": Surface(gloss=color, roughness=rough, shine_roughness=rough,
                                shine=tuple(self.build.multiply(c, level) for c in color))}

    def _BsdfRefraction(self, node):
        self.through = True
        return {"BSDF": Surface(gloss=self.three(node.inputs["Color"]), roughness=self._roughness(node))}

    def _mirrors(self, ior):
        """The share of light that a smooth surface mirrors which it meets straight from above."""
        build = self.build
        root = build.divide(build.subtract(ior, 1.0), build.add(ior, 1.0))
        return build.multiply(root, root)

    def _BsdfTransparent(self, node):
        return {"BSDF": Surface(alpha=0.0)}

    def _Holdout(self, node):
        return {"Holdout": Surface(holdout=1.0)}

    def _Emission(self, node):
        strength = self.number(node.inputs["Strength"])
        return {"Emission": Surface(emission=tuple(
            self.build.multiply(c, strength) for c in self.three(node.inputs["Color"])))}

    def _BsdfPrincipled(self, node):
        build, inputs = self.build, node.inputs

        def named(*names):
            return next(inputs[name] for name in names if name in inputs)

        base, metal = self.three(inputs["Base Color"]), build.clamp(self.number(inputs["Metallic"]))
        through = build.clamp(self.number(named("Transmission Weight", "Transmission")))
        alpha = build.clamp(self.number(inputs["Alpha"]))
        self.through |= through != 0
        matt = build.multiply(alpha, build.multiply(build.subtract(1.0, metal), build.subtract(1.0, through)))
        other = build.subtract(alpha, matt)
        strength = build.multiply(self.number(inputs["Emission Strength"]), alpha)
        glow = (0.0,) * 3 if strength == 0 else self.three(named("Emission Color", "Emission"))
        rough = self._roughness(node)
        if "Specular IOR Level" in inputs:  # since 4.0
            level = build.multiply(self._mirrors(self.number(inputs["IOR"])),
                                   build.multiply(2.0, self.number(inputs["Specular IOR Level"])))
            shine = tuple(build.multiply(c, level) for c in self.three(inputs["Specular Tint"]))
            coat = build.multiply(self.number(inputs["Coat Weight"]), self._mirrors(self.number(inputs["Coat IOR"])))
        else:
            shine = (build.multiply(0.08, self.number(inputs["Specular"])),) * 3
            coat = build.multiply(0.01, self.number(inputs["Clearcoat"]))  # a quarter of what glass has
        return {"BSDF": Surface(tuple(build.multiply(c, matt) for c in base),
                                tuple(build.multiply(c, other) for c in base),
                                tuple(build.multiply(c, strength) for c in glow), alpha, rough,
                                tuple(build.multiply(alpha, c) for c in self._mixed(shine, base, metal)), rough,
                                build.multiply(alpha, coat),
                                build.clamp(self.number(named("Coat Roughness", "Clearcoat Roughness"))))}

    def _MixShader(self, node):
        share = self.build.clamp(self.number(node.inputs[0]))
        if share in (0.0, 1.0):
            return {"Shader": self.shader(node.inputs[1 + int(share)])}
        a, b = (self.shader(node.inputs[k]) for k in (1, 2))
        mix = self.build.mix
        return {"Shader": Surface(*(self._mixed(getattr(a, name), getattr(b, name), share)
                                    for name in ("color", "gloss", "emission")),
                                  *(mix(getattr(a, name), getattr(b, name), share) for name in ("alpha", "roughness")),
                                  self._mixed(a.shine, b.shine, share), self._of_both(a, b, "shine", share),
                                  mix(a.coat, b.coat, share), self._of_both(a, b, "coat", share),
                                  self._turned(a, b, share), mix(a.holdout, b.holdout, share))}

    def _turned(self, a, b, share=0.5):
        """Where both shaders together face: those that show nothing do not count, nor what only shines beside what has
        a colour, as light falls on that."""
        none = (0.0,) * 3
        seen = [s.turned for s in (a, b) if s.color != none] or [
            s.turned for s in (a, b) if any(part != none for part in (s.gloss, s.emission, s.shine))]
        if len(set(seen)) < 2:
            return seen[0] if seen else none
        return self._mixed(*(self.build.run("normal") if way == none else way for way in seen), share)

    def _of_both(self, a, b, what, share=0.5):
        """How rough highlights of two shaders are: those that one of them has are as rough as its own."""
        one, other = (getattr(surface, what + "_roughness") for surface in (a, b))
        for surface, rough in ((a, other), (b, one)):
            if getattr(surface, what) in (0.0, (0.0,) * 3):
                return rough
        return self.build.mix(one, other, share)

    def _AddShader(self, node):
        a, b = (self.shader(node.inputs[k]) for k in (0, 1))
        add = self.build.add
        return {"Shader": Surface(self._each(add, a.color, b.color), self._each(add, a.gloss, b.gloss),
                                  self._each(add, a.emission, b.emission),
                                  self.build.clamp(add(a.alpha, b.alpha)),
                                  self.build.minimum(a.roughness, b.roughness),
                                  self._each(add, a.shine, b.shine), self._of_both(a, b, "shine"),
                                  add(a.coat, b.coat), self._of_both(a, b, "coat"), self._turned(a, b),
                                  self.build.clamp(add(a.holdout, b.holdout)))}

    # Where

    def _TexCoord(self, node):
        if node.object is not None and node.outputs["Object"].is_linked:
            raise trees.Unknown(node.name)
        out = {}
        for name, make in (("UV", self._uv), ("Generated", self._generated),
                           ("Object", lambda: self._mesh("object", ""))):
            if node.outputs[name].is_linked:
                out[name] = make()
        return out

    def _UVMap(self, node):
        return {"UV": self._mesh("uv", node.uv_map)}

    def _NewGeometry(self, node):
        place = self.build.run("place")
        if self.beside:
            way, part = self.beside
            place = tuple(self.build.add(x, self.build.multiply(step, part)) for x, step in
                          zip(place, self.build.run("beside")[3 * way:3 * way + 3], strict=True))
        return {"Position": place, "Normal": self.build.run("normal")}

    def _VertexColor(self, node):
        return {"Color": self._scalars(self._mesh("color", node.layer_name))}

    def _Attribute(self, node):
        if node.attribute_type != "GEOMETRY":
            raise trees.Unknown(node.name)
        found = self._mesh("color", node.attribute_name)
        return {"Color": self._scalars(found), "Vector": found, "Fac": self._dot(self._scalars(found), (1 / 3,) * 3)}

    def _Mapping(self, node):
        vector = self.vector(node.inputs["Vector"], lambda: (0.0, 0.0, 0.0))
        rows = trees.mapping(node)
        if isinstance(vector, Straight):
            whole = np.vstack([vector.rows, (0, 0, 0, 1)])
            return {"Vector": Straight(vector.source, rows @ whole)}
        return {"Vector": tuple(self.build.add(self._dot(vector, row[:3]), float(row[3])) for row in rows)}

    # Pictures

    def _TexImage(self, node):
        wraps = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip"}
        if node.projection != "FLAT" or node.extension not in wraps:
            raise trees.Unknown(node.name)
        image = pictures.still(node)
        if image is None:
            return {"Color": (0.0, 0.0, 0.0), "Alpha": 0.0}
        number = self.build.pool.texture(self.images.get(image, wraps[node.extension]))
        vector = self.vector(node.inputs["Vector"], self._uv)
        u, v, _ = self._scalars(vector)
        steps = (0.0,) * 4
        if isinstance(vector, Straight):
            by = self.build.pool.place([*vector.rows[0, :3], *vector.rows[1, :3]])
            steps = self.build.run("footprint", data=(3 * vector.source, by))
        r, g, b, alpha = self.build.run("texture", (u, v, *steps), (number,))
        return {"Color": (r, g, b), "Alpha": alpha}
