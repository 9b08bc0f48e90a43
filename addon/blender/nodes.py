# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes -> operations. To add one: a method _<bl_idname without ShaderNode> of Compiler that gives the values of
all its outputs by their names."""

from dataclasses import dataclass

import numpy as np

from ..pen.colour import decode_srgb
from ..pen.job import Picture, Program
from ..pen.program import Builder, Register, TooLong
from . import worlds

_MOST_SOURCES = 5
_GREY = (0.2126, 0.7152, 0.0722)
_DECODED = decode_srgb(np.arange(256, dtype=np.float32) / 255).astype(np.float32)  # of pictures of 8 bits


class Unknown(Exception):
    """What can't be shown; its text is the name of the node."""


@dataclass
class Surface:
    """Colours by threes, alpha and roughness, of numbers and registers. Where something shows through, colours are
    those of the share that does not."""

    color: tuple = (0.0, 0.0, 0.0)
    gloss: tuple = (0.0, 0.0, 0.0)
    emission: tuple = (0.0, 0.0, 0.0)
    alpha: object = 1.0
    roughness: object = 1.0


@dataclass
class Straight:
    """A vector that grows evenly along a surface: `rows` (3, 4) times three channels of it and 1."""

    source: int
    rows: np.ndarray


class Images:
    """Pictures as programs look into them, kept from one reading of the scene to the next."""

    def __init__(self):
        self._known = {}

    def drop(self, names):
        self._known = {key: known for key, known in self._known.items() if ("Image", key[0]) not in names}

    def get(self, image, wrap):
        """The job.Picture of a Blender image."""
        key = image.name_full, image.colorspace_settings.name, tuple(image.size)
        if key not in self._known:
            self._known[key] = _levels(_pixels(image))
        texels, width, height, levels = self._known[key]
        return Picture(texels, width, height, levels, wrap)


def _pixels(image):
    """(height, width, 4), scene-linear, row 0 at the bottom; magenta where the file is not there, as renderers have."""
    width, height = image.size
    if not width or not height or not image.channels:
        return np.array([[[1, 0, 1, 1]]], np.float32)
    flat = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    out = flat.reshape(height, width, image.channels)
    if not image.is_float and image.colorspace_settings.name == "sRGB":
        colors = out[..., :3] if image.channels > 2 else out[..., :1]
        colors[...] = _DECODED[(colors * np.float32(255) + np.float32(0.5)).astype(np.uint8)]
    if image.channels == 4:
        return out
    whole = np.ones((height, width, 4), np.float32)
    whole[..., :3] = out[..., :3] if image.channels > 2 else out[..., :1]
    if image.channels == 2:
        whole[..., 3] = out[..., 1]
    return whole


def _levels(picture):
    """(texels of all levels of detail (n, 4), width, height, how many)."""
    height, width = picture.shape[:2]
    levels = [picture]
    while max(picture.shape[:2]) > 1:
        if len(picture) > 1:
            picture = (picture[:-1:2] + picture[1::2]) * np.float32(0.5)
        if picture.shape[1] > 1:
            picture = (picture[:, :-1:2] + picture[:, 1::2]) * np.float32(0.5)
        levels.append(picture)
    return np.concatenate([level.reshape(-1, 4) for level in levels]), width, height, len(levels)


class Compiler:
    """The program of one material."""

    def __init__(self, pool, images):
        self.images, self.build, self.sources = images, Builder(pool), []
        self._known, self._groups = {}, []  # outputs of nodes by (groups around them, node); nodes of open groups

    # What becomes of it

    def matt(self, color):
        return Surface(color)

    def nothing(self):
        return Surface()

    def finish(self, surface, first):
        """The job.Program; first: the first of the attributes' channels that are its."""
        made = self.build.program([*surface.color, *surface.gloss, *surface.emission, surface.alpha,
                                   surface.roughness])
        codes = [self.build.code(name) for name in ("channel", "footprint")]
        operations = made.operations.copy()
        operations[np.isin(operations[:, 0], codes), 10] += first
        return Program(operations, made.registers, made.result)

    # Sockets

    def _source(self, socket):
        """(node, socket) that a socket is linked to, past reroutes; None."""
        while socket.is_linked:
            link = socket.links[0]
            if link.from_node.bl_idname != "NodeReroute":
                return link.from_node, link.from_socket
            socket = link.from_node.inputs[0]
        return None

    def shader(self, socket):
        source = self._source(socket)
        if source is None:
            return self.nothing()
        return self._output(*source)

    def _output(self, node, socket):
        """The value of an output: a number, a tuple of three or four, or a Surface."""
        key = (tuple(group.name for group in self._groups), node.name)
        if node.mute:
            raise Unknown(node.name)
        if node.bl_idname == "ShaderNodeGroup":
            return self._group(node, socket)
        if node.bl_idname == "NodeGroupInput":
            return self._outside(socket)
        make = getattr(self, "_" + node.bl_idname.removeprefix("ShaderNode"), None)
        if make is None:
            raise Unknown(node.name)
        if key not in self._known:
            try:
                self._known[key] = make(node)
            except TooLong:
                raise Unknown(node.name) from None
        values = self._known[key]
        if socket.identifier in values:
            return values[socket.identifier]
        if socket.name in values:
            return values[socket.name]
        raise Unknown(node.name)

    def _group(self, node, socket):
        tree = node.node_tree
        out = tree and next((n for n in tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
        into = out and next((s for s in out.inputs if s.identifier == socket.identifier), None)
        if into is None or len(self._groups) > 15:
            raise Unknown(node.name)
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
        source = self._source(socket)
        if source is None:
            return float(socket.default_value)
        value = self._output(*source)
        if isinstance(value, Straight):
            value = self._scalars(value)
        if isinstance(value, tuple):
            weights = _GREY if source[1].type == "RGBA" else (1 / 3,) * 3
            return self._dot(value[:3], weights)
        return value

    def three(self, socket):
        """A colour or vector."""
        source = self._source(socket)
        if source is None:
            given = socket.default_value
            return tuple(map(float, given[:3])) if hasattr(given, "__len__") else (float(given),) * 3
        value = self._output(*source)
        if isinstance(value, Straight):
            return self._scalars(value)
        return tuple(value[:3]) if isinstance(value, tuple) else (value,) * 3

    def vector(self, socket, unlinked):
        """A Straight if it is one, else three numbers; unlinked(): what it is where nothing is linked."""
        source = self._source(socket)
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
                raise Unknown("more coordinates and attributes than there is room for")
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
        return tuple(self.build.add(self._dot(channels, row[:3]), float(row[3])) for row in vector.rows)

    # Shaders

    def _BsdfDiffuse(self, node):
        return {"BSDF": Surface(self.three(node.inputs["Color"]))}

    _BsdfToon = _BsdfDiffuse
    _SubsurfaceScattering = lambda self, node: {"BSSRDF": Surface(self.three(node.inputs["Color"]))}  # noqa: E731

    def _BsdfGlossy(self, node):
        return {"BSDF": Surface(gloss=self.three(node.inputs["Color"]),
                                roughness=self.number(node.inputs["Roughness"]))}

    _BsdfAnisotropic = _BsdfGlossy  # what Glossy is called since 4.0
    _BsdfGlass = _BsdfRefraction = _BsdfGlossy

    def _BsdfTransparent(self, node):
        return {"BSDF": Surface(alpha=0.0)}

    def _Holdout(self, node):
        return {"Holdout": Surface()}

    def _BsdfTranslucent(self, node):
        return {"BSDF": Surface(self.three(node.inputs["Color"]))}

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
        matt = build.multiply(alpha, build.multiply(build.subtract(1.0, metal), build.subtract(1.0, through)))
        other = build.subtract(alpha, matt)
        strength = build.multiply(self.number(inputs["Emission Strength"]), alpha)
        glow = (0.0,) * 3 if strength == 0 else self.three(named("Emission Color", "Emission"))
        return {"BSDF": Surface(tuple(build.multiply(c, matt) for c in base),
                                tuple(build.multiply(c, other) for c in base),
                                tuple(build.multiply(c, strength) for c in glow), alpha,
                                build.clamp(self.number(inputs["Roughness"])))}

    def _MixShader(self, node):
        share = self.build.clamp(self.number(node.inputs[0]))
        if share in (0.0, 1.0):
            return {"Shader": self.shader(node.inputs[1 + int(share)])}
        a, b = (self.shader(node.inputs[k]) for k in (1, 2))
        return {"Shader": Surface(*(self._mixed(getattr(a, name), getattr(b, name), share)
                                    for name in ("color", "gloss", "emission")),
                                  *(self.build.mix(getattr(a, name), getattr(b, name), share)
                                    for name in ("alpha", "roughness")))}

    def _AddShader(self, node):
        a, b = (self.shader(node.inputs[k]) for k in (0, 1))
        add = self.build.add
        return {"Shader": Surface(self._each(add, a.color, b.color), self._each(add, a.gloss, b.gloss),
                                  self._each(add, a.emission, b.emission),
                                  self.build.clamp(add(a.alpha, b.alpha)),
                                  self.build.minimum(a.roughness, b.roughness))}

    # Where

    def _TexCoord(self, node):
        if node.object is not None and node.outputs["Object"].is_linked:
            raise Unknown(node.name)
        out = {}
        for name, make in (("UV", self._uv), ("Generated", self._generated),
                           ("Object", lambda: self._mesh("object", ""))):
            if node.outputs[name].is_linked:
                out[name] = make()
        return out

    def _UVMap(self, node):
        return {"UV": self._mesh("uv", node.uv_map)}

    def _NewGeometry(self, node):
        return {"Position": self.build.run("place"), "Normal": self.build.run("normal")}

    def _VertexColor(self, node):
        return {"Color": self._scalars(self._mesh("color", node.layer_name))}

    def _Attribute(self, node):
        if node.attribute_type != "GEOMETRY":
            raise Unknown(node.name)
        found = self._mesh("color", node.attribute_name)
        return {"Color": self._scalars(found), "Vector": found, "Fac": self._dot(self._scalars(found), (1 / 3,) * 3)}

    def _ObjectInfo(self, node):
        thing = [self.build.run("thing", data=(k,))[0] for k in range(9)]
        return {"Color": tuple(thing[:3]), "Alpha": thing[3], "Random": thing[4], "Object Index": thing[5],
                "Location": tuple(thing[6:9])}

    def _LightPath(self, node):
        return {socket.name: worlds.SEEN.get(socket.name, 0.0) for socket in node.outputs}

    def _Mapping(self, node):
        vector = self.vector(node.inputs["Vector"], lambda: (0.0, 0.0, 0.0))
        rows = _mapping(node)
        if isinstance(vector, Straight):
            whole = np.vstack([vector.rows, (0, 0, 0, 1)])
            return {"Vector": Straight(vector.source, rows @ whole)}
        return {"Vector": tuple(self.build.add(self._dot(vector, row[:3]), float(row[3])) for row in rows)}

    # Pictures

    def _TexImage(self, node):
        wraps = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip"}
        if node.projection != "FLAT" or node.extension not in wraps:
            raise Unknown(node.name)
        if node.image is None:
            return {"Color": (0.0, 0.0, 0.0), "Alpha": 0.0}
        if node.image.source not in ("FILE", "GENERATED"):
            raise Unknown(node.name)
        number = self.build.pool.texture(self.images.get(node.image, wraps[node.extension]))
        vector = self.vector(node.inputs["Vector"], self._uv)
        u, v, _ = self._scalars(vector)
        steps = (0.0,) * 4
        if isinstance(vector, Straight):
            by = self.build.pool.place([*vector.rows[0, :3], *vector.rows[1, :3]])
            steps = self.build.run("footprint", data=(3 * vector.source, by))
        r, g, b, alpha = self.build.run("texture", (u, v, *steps), (number,))
        return {"Color": (r, g, b), "Alpha": alpha}

    # Patterns

    def _place(self, node):
        scale = self.number(node.inputs["Scale"]) if "Scale" in node.inputs else 1.0
        vector = self._scalars(self.vector(node.inputs["Vector"], self._generated))
        return tuple(self.build.multiply(x, scale) for x in vector)

    def _TexChecker(self, node):
        share = self.build.apply("checker", *self._place(node))
        return {"Color": self._mixed(self.three(node.inputs["Color2"]), self.three(node.inputs["Color1"]), share),
                "Fac": share}

    def _TexBrick(self, node):
        known = [self.number(node.inputs[name]) for name in
                 ("Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")]
        if any(isinstance(x, Register) for x in known):
            raise Unknown(node.name)
        x, y, _ = self._place(node)
        at = self.build.pool.place([node.offset, node.offset_frequency, node.squash, node.squash_frequency, *known])
        tint, mortar = self.build.run("brick", (x, y), (at,))
        color = self._mixed(self.three(node.inputs["Color1"]), self.three(node.inputs["Color2"]), tint)
        return {"Color": self._mixed(color, self.three(node.inputs["Mortar"]), mortar), "Fac": mortar}

    def _TexGradient(self, node):
        build = self.build
        x, y, z = self._scalars(self.vector(node.inputs["Vector"], self._generated))
        kind = node.gradient_type
        if kind == "LINEAR":
            share = x
        elif kind == "QUADRATIC":
            share = build.maximum(x, 0.0)
            share = build.multiply(share, share)
        elif kind == "EASING":
            t = build.clamp(x)
            square = build.multiply(t, t)
            share = build.subtract(build.multiply(square, 3.0), build.multiply(build.multiply(square, t), 2.0))
        elif kind == "DIAGONAL":
            share = build.multiply(build.add(x, y), 0.5)
        elif kind == "RADIAL":
            share = build.add(build.multiply(build.apply("angle", y, x), 1 / (2 * np.pi)), 0.5)
        else:
            squares = build.add(build.multiply(x, x), build.add(build.multiply(y, y), build.multiply(z, z)))
            share = build.maximum(build.subtract(0.999999, build.apply("root", squares)), 0.0)
            share = build.multiply(share, share) if kind == "QUADRATIC_SPHERE" else share
        share = build.clamp(share)
        return {"Color": (share,) * 3, "Fac": share}

    def _TexNoise(self, node):
        detail, rough = self.number(node.inputs["Detail"]), self.number(node.inputs["Roughness"])
        plain = (node.noise_dimensions == "3D" and self.number(node.inputs["Distortion"]) == 0
                 and getattr(node, "noise_type", "FBM") == "FBM" and getattr(node, "normalize", True)
                 and ("Lacunarity" not in node.inputs or self.number(node.inputs["Lacunarity"]) == 2))
        if not plain or isinstance(detail, Register):
            raise Unknown(node.name)
        detail = min(max(detail, 0.0), 15.0)
        at = self.build.pool.place([np.floor(detail), detail - np.floor(detail)])
        return {"Fac": self.build.run("noise", (*self._place(node), rough), (at,))[0]}

    # Colours and numbers

    def _RGB(self, node):
        return {"Color": tuple(map(float, node.outputs[0].default_value[:3]))}

    def _Value(self, node):
        return {"Value": float(node.outputs[0].default_value)}

    def _ValToRGB(self, node):
        ramp, share = node.color_ramp, self.number(node.inputs["Fac"])
        if ramp.color_mode != "RGB":
            raise Unknown(node.name)
        if ramp.interpolation in ("LINEAR", "CONSTANT"):
            stops = [(stop.position, *stop.color) for stop in ramp.elements]
        else:
            stops = [(k / 256, *ramp.evaluate(k / 256)) for k in range(257)]
        at = self.build.pool.place([number for stop in stops for number in stop])
        name = "steps" if ramp.interpolation == "CONSTANT" else "ramp"
        r, g, b, alpha = self.build.run(name, (share,), (at, len(stops)))
        return {"Color": (r, g, b), "Alpha": alpha}

    def _CurveRGB(self, node):
        color, share = self.three(node.inputs["Color"]), self.number(node.inputs["Fac"])
        mapping = node.mapping
        mapping.update()
        white = [mapping.evaluate(mapping.curves[3], k / 256) for k in range(257)]
        out = []
        for k in range(3):
            table = [mapping.evaluate(mapping.curves[k], value) for value in white]
            out.append(self.build.run("curve", (color[k],), (self.build.pool.place(table), 257))[0])
        return {"Color": self._mixed(color, tuple(out), share)}

    def _MixRGB(self, node):
        return {"Color": self._blend(node, node.blend_type, self.number(node.inputs["Fac"]),
                                     self.three(node.inputs["Color1"]), self.three(node.inputs["Color2"]),
                                     node.use_clamp)}

    def _Mix(self, node):
        def of(name, kind):
            return next(s for s in node.inputs if s.identifier == f"{name}_{kind}")

        share = self.number(of("Factor", "Float"))
        share = self.build.clamp(share) if node.clamp_factor else share
        if node.data_type == "RGBA":
            value = self._blend(node, node.blend_type, share, self.three(of("A", "Color")),
                                self.three(of("B", "Color")), node.clamp_result)
            return {"Result_Color": value}
        if node.data_type == "FLOAT":
            return {"Result_Float": self.build.mix(self.number(of("A", "Float")), self.number(of("B", "Float")), share)}
        if node.data_type == "VECTOR" and node.factor_mode == "UNIFORM":
            return {"Result_Vector": self._mixed(self.three(of("A", "Vector")), self.three(of("B", "Vector")), share)}
        raise Unknown(node.name)

    def _blend(self, node, kind, share, a, b, clamp):
        build = self.build
        share = build.clamp(share)
        blends = {
            "MIX": lambda x, y: y,
            "MULTIPLY": build.multiply,
            "ADD": build.add,
            "SUBTRACT": build.subtract,
            "DARKEN": build.minimum,
            "LIGHTEN": build.maximum,
            "DIFFERENCE": lambda x, y: build.apply("absolute", build.subtract(x, y)),
            "SCREEN": lambda x, y: build.subtract(1.0, build.multiply(build.subtract(1.0, x), build.subtract(1.0, y))),
            "DIVIDE": build.divide,
            "OVERLAY": self._overlay,
        }
        if kind not in blends:
            raise Unknown(node.name)
        out = self._each(lambda x, y: build.mix(x, blends[kind](x, y), share), a, b)
        return tuple(map(build.clamp, out)) if clamp else out

    def _overlay(self, x, y):
        build = self.build
        dark = build.multiply(2.0, build.multiply(x, y))
        light = build.subtract(1.0, build.multiply(2.0, build.multiply(build.subtract(1.0, x), build.subtract(1.0, y))))
        return build.mix(light, dark, build.less(x, 0.5))

    def _Math(self, node):
        build = self.build
        a, b, c = ([self.number(socket) for socket in node.inputs] + [0.0, 0.0])[:3]

        def turn(name):
            return lambda: build.apply(name, a)

        kinds = {
            "ADD": lambda: build.add(a, b), "SUBTRACT": lambda: build.subtract(a, b),
            "MULTIPLY": lambda: build.multiply(a, b), "DIVIDE": lambda: build.divide(a, b),
            "MULTIPLY_ADD": lambda: build.add(build.multiply(a, b), c),
            "POWER": lambda: build.apply("power", a, b), "SQRT": turn("root"), "ABSOLUTE": turn("absolute"),
            "MINIMUM": lambda: build.minimum(a, b), "MAXIMUM": lambda: build.maximum(a, b),
            "LESS_THAN": lambda: build.less(a, b), "GREATER_THAN": lambda: build.less(b, a),
            "FLOOR": turn("floor"), "FRACT": lambda: build.subtract(a, build.apply("floor", a)),
            "CEIL": lambda: build.subtract(0.0, build.apply("floor", build.subtract(0.0, a))),
            "ROUND": lambda: build.apply("floor", build.add(a, 0.5)),
            "SINE": turn("sine"), "COSINE": turn("cosine"),
            "ARCTAN2": lambda: build.apply("angle", a, b),
            "RADIANS": lambda: build.multiply(a, np.pi / 180), "DEGREES": lambda: build.multiply(a, 180 / np.pi),
        }
        if node.operation not in kinds:
            raise Unknown(node.name)
        value = kinds[node.operation]()
        return {"Value": build.clamp(value) if node.use_clamp else value}

    def _VectorMath(self, node):
        build, (a, b) = self.build, (self.three(socket) for socket in list(node.inputs)[:2])
        kinds = {"ADD": build.add, "SUBTRACT": build.subtract, "MULTIPLY": build.multiply, "DIVIDE": build.divide,
                 "MINIMUM": build.minimum, "MAXIMUM": build.maximum}
        if node.operation in kinds:
            return {"Vector": self._each(kinds[node.operation], a, b)}
        squares = build.add(build.multiply(a[0], a[0]), build.add(build.multiply(a[1], a[1]),
                                                                  build.multiply(a[2], a[2])))
        if node.operation == "SCALE":
            scale = self.number(node.inputs["Scale"])
            return {"Vector": tuple(build.multiply(x, scale) for x in a)}
        if node.operation == "LENGTH":
            return {"Value": build.apply("root", squares)}
        if node.operation == "NORMALIZE":
            length = build.apply("root", squares)
            return {"Vector": tuple(build.divide(x, length) for x in a)}
        if node.operation == "DOT_PRODUCT":
            parts = self._each(build.multiply, a, b)
            return {"Value": build.add(parts[0], build.add(parts[1], parts[2]))}
        raise Unknown(node.name)

    def _MapRange(self, node):
        if node.data_type != "FLOAT" or node.interpolation_type != "LINEAR":
            raise Unknown(node.name)
        build = self.build
        value, low, high, to_low, to_high = (self.number(node.inputs[name]) for name in
                                             ("Value", "From Min", "From Max", "To Min", "To Max"))
        share = build.divide(build.subtract(value, low), build.subtract(high, low))
        share = build.clamp(share) if node.clamp else share
        return {"Result": build.add(to_low, build.multiply(share, build.subtract(to_high, to_low)))}

    def _SeparateXYZ(self, node):
        return dict(zip("XYZ", self.three(node.inputs[0]), strict=True))

    def _CombineXYZ(self, node):
        return {"Vector": tuple(self.number(socket) for socket in node.inputs)}

    def _SeparateColor(self, node):
        if node.mode == "HSV":
            values = self.build.run("to_hsv", self.three(node.inputs[0]))
        elif node.mode == "RGB":
            values = self.three(node.inputs[0])
        else:
            raise Unknown(node.name)
        return dict(zip(("Red", "Green", "Blue"), values, strict=True))

    def _CombineColor(self, node):
        values = tuple(self.number(socket) for socket in node.inputs)
        if node.mode not in ("RGB", "HSV"):
            raise Unknown(node.name)
        return {"Color": self.build.run("from_hsv", values) if node.mode == "HSV" else values}

    def _SeparateRGB(self, node):
        return dict(zip("RGB", self.three(node.inputs[0]), strict=True))

    def _CombineRGB(self, node):
        return {"Image": tuple(self.number(socket) for socket in node.inputs)}

    def _Invert(self, node):
        color = self.three(node.inputs["Color"])
        flipped = tuple(self.build.subtract(1.0, c) for c in color)
        return {"Color": self._mixed(color, flipped, self.number(node.inputs["Fac"]))}

    def _Gamma(self, node):
        gamma = self.number(node.inputs["Gamma"])
        return {"Color": tuple(self.build.apply("power", c, gamma) for c in self.three(node.inputs["Color"]))}

    def _BrightContrast(self, node):
        build = self.build
        bright, contrast = self.number(node.inputs["Bright"]), self.number(node.inputs["Contrast"])
        steep, lift = build.add(1.0, contrast), build.subtract(bright, build.multiply(contrast, 0.5))
        return {"Color": tuple(build.maximum(build.add(build.multiply(c, steep), lift), 0.0)
                               for c in self.three(node.inputs["Color"]))}

    def _HueSaturation(self, node):
        build, color = self.build, self.three(node.inputs["Color"])
        hue, saturation, value, share = (self.number(node.inputs[name]) for name in
                                         ("Hue", "Saturation", "Value", "Fac"))
        h, s, v = build.run("to_hsv", color)
        turned = build.add(build.add(h, hue), 0.5)
        out = build.run("from_hsv", (turned, build.clamp(build.multiply(s, saturation)), build.multiply(v, value)))
        return {"Color": tuple(build.maximum(c, 0.0) for c in self._mixed(color, out, share))}

    def _Clamp(self, node):
        build = self.build
        if node.clamp_type != "MINMAX":
            raise Unknown(node.name)
        value, low, high = (self.number(node.inputs[name]) for name in ("Value", "Min", "Max"))
        return {"Result": build.minimum(build.maximum(value, low), high)}


def _mapping(node):
    """(3, 4) of what a Mapping node does. Unknown: it isn't the same everywhere."""
    from mathutils import Euler

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
