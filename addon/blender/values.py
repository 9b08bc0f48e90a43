# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes that mix colours and numbers, normal maps and bumps -> operations, a part of nodes.Compiler."""

import functools

import numpy as np

from ..pen.program import Register
from . import attributes, trees, worlds


class Values:
    """A method for each kind of node; Compiler gives `build`, number(), three(), _each(), _mixed(), _scalars()
    and _mesh()."""

    def _RGB(self, node):
        return {"Color": tuple(map(float, node.outputs[0].default_value[:3]))}

    def _Value(self, node):
        return {"Value": float(node.outputs[0].default_value)}

    def _ObjectInfo(self, node):
        thing = [self.build.run("thing", data=(k,))[0] for k in range(9)]
        return {"Color": tuple(thing[:3]), "Alpha": thing[3], "Random": thing[4], "Object Index": thing[5],
                "Location": tuple(thing[6:9])}

    def _LightPath(self, node):
        return {socket.name: worlds.SEEN.get(socket.name, 0.0) for socket in node.outputs}

    def _ValToRGB(self, node):
        ramp, share = node.color_ramp, self.number(trees.input_of(node, "Fac"))
        if ramp.color_mode != "RGB":
            raise trees.Unknown(node.name)
        if ramp.interpolation in ("LINEAR", "CONSTANT"):
            stops = [(stop.position, *stop.color) for stop in ramp.elements]
        else:
            stops = [(k / 256, *ramp.evaluate(k / 256)) for k in range(257)]
        at = self.build.pool.place([number for stop in stops for number in stop])
        name = "steps" if ramp.interpolation == "CONSTANT" else "ramp"
        r, g, b, alpha = self.build.run(name, (share,), (at, len(stops)))
        return {"Color": (r, g, b), "Alpha": alpha}

    def _RGBCurve(self, node):
        color, share = self.three(node.inputs["Color"]), self.number(trees.input_of(node, "Fac"))
        mapping = node.mapping
        mapping.update()
        white = [mapping.evaluate(mapping.curves[3], k / 256) for k in range(257)]
        out = []
        for k in range(3):
            table = [mapping.evaluate(mapping.curves[k], value) for value in white]
            out.append(self.build.run("curve", (color[k],), (self.build.pool.place(table), 257))[0])
        return {"Color": self._mixed(color, tuple(out), share)}

    def _MixRGB(self, node):
        return {"Color": self._blend(node, node.blend_type, self.number(trees.input_of(node, "Fac")),
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
        raise trees.Unknown(node.name)

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
            raise trees.Unknown(node.name)
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
            raise trees.Unknown(node.name)
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
        raise trees.Unknown(node.name)

    def _MapRange(self, node):
        if node.data_type != "FLOAT" or node.interpolation_type != "LINEAR":
            raise trees.Unknown(node.name)
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
            raise trees.Unknown(node.name)
        return dict(zip(("Red", "Green", "Blue"), values, strict=True))

    def _CombineColor(self, node):
        values = tuple(self.number(socket) for socket in node.inputs)
        if node.mode not in ("RGB", "HSV"):
            raise trees.Unknown(node.name)
        return {"Color": self.build.run("from_hsv", values) if node.mode == "HSV" else values}

    def _SeparateRGB(self, node):
        return dict(zip("RGB", self.three(node.inputs[0]), strict=True))

    def _CombineRGB(self, node):
        return {"Image": tuple(self.number(socket) for socket in node.inputs)}

    def _Invert(self, node):
        color = self.three(node.inputs["Color"])
        flipped = tuple(self.build.subtract(1.0, c) for c in color)
        return {"Color": self._mixed(color, flipped, self.number(trees.input_of(node, "Fac")))}

    def _Gamma(self, node):
        gamma = self.number(node.inputs["Gamma"])
        return {"Color": tuple(self.build.apply("power", c, gamma) for c in self.three(node.inputs["Color"]))}

    def _BrightContrast(self, node):
        build = self.build
        bright, contrast = self.number(trees.input_of(node, "Bright")), self.number(node.inputs["Contrast"])
        steep, lift = build.add(1.0, contrast), build.subtract(bright, build.multiply(contrast, 0.5))
        return {"Color": tuple(build.maximum(build.add(build.multiply(c, steep), lift), 0.0)
                               for c in self.three(node.inputs["Color"]))}

    def _HueSaturation(self, node):
        build, color = self.build, self.three(node.inputs["Color"])
        hue, saturation, value, share = (self.number(trees.input_of(node, name)) for name in
                                         ("Hue", "Saturation", "Value", "Fac"))
        h, s, v = build.run("to_hsv", color)
        turned = build.add(build.add(h, hue), 0.5)
        out = build.run("from_hsv", (turned, build.clamp(build.multiply(s, saturation)), build.multiply(v, value)))
        return {"Color": tuple(build.maximum(c, 0.0) for c in self._mixed(color, out, share))}

    def _Clamp(self, node):
        build = self.build
        if node.clamp_type != "MINMAX":
            raise trees.Unknown(node.name)
        value, low, high = (self.number(node.inputs[name]) for name in ("Value", "Min", "Max"))
        return {"Result": build.minimum(build.maximum(value, low), high)}

    # Normal maps

    def _NormalMap(self, node):
        """Tangents are Blender's own; they turn with the thing, whose matrix they take for one of even scale."""
        build, strength = self.build, self.number(node.inputs["Strength"])
        x, y, z = (build.subtract(build.multiply(2.0, c), 1.0) for c in self.three(node.inputs["Color"]))
        normal = build.run("normal")
        if node.space == "WORLD":
            way = x, y, z
        elif node.space == "OBJECT":
            way = self._turned_with_it((x, y, z))
        elif node.space == "TANGENT":
            along = self._scalars(self._mesh("tangent", node.uv_map))
            mirrored = build.less(attributes.MIRRORED, self._dot_of(along, along))  # at least twice the middle
            along = self._unit(self._turned_with_it(along))
            side, (x_row, y_row, z_row) = self._cross(normal, along), self._matrix()
            inverted = build.less(self._dot_of(self._cross(x_row, y_row), z_row), 0.0)
            sign = build.multiply(*(build.subtract(1.0, build.multiply(2.0, no)) for no in (mirrored, inverted)))
            x, y = build.multiply(x, strength), build.multiply(build.multiply(y, strength), sign)
            z = build.mix(1.0, z, build.clamp(strength))
            return {"Normal": self._unit(tuple(
                build.add(build.multiply(x, t), build.add(build.multiply(y, b), build.multiply(z, n)))
                for t, b, n in zip(along, side, normal, strict=True)))}
        else:
            raise trees.Unknown(node.name)
        return {"Normal": self._unit(self._mixed(normal, self._unit(way), strength))}

    def _Bump(self, node):
        """Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU (2010), as in Cycles: the normal leans against the
        slope of the height, which is looked at beside the pixel, too. Cycles looks a part of a pixel away, many times
        in each; so a step, as at joints, is in that part of it alone, wherever it lies."""
        build, inputs = self.build, node.inputs
        normal = self.three(inputs["Normal"]) if trees.source_of(inputs["Normal"]) else build.run("normal")
        part = self.number(inputs["Filter Width"]) if "Filter Width" in inputs else 0.1
        if isinstance(part, Register) or self.beside or part <= 0:
            raise trees.Unknown(node.name)
        part = min(part, 0.5)
        strength, far = build.maximum(self.number(inputs["Strength"]), 0.0), self.number(inputs["Distance"])
        far = build.subtract(0.0, far) if node.invert else far
        even, steep = zip(*(self._slopes(inputs["Height"], way, part) for way in (0, 1)), strict=True)
        leaning = [self._leant(normal, slopes, far) for slopes in (even, steep)]
        return {"Normal": self._unit(self._mixed(normal, self._unit(self._mixed(*leaning, part)), strength))}

    def _slopes(self, socket, way, part):
        """How much a height grows in a pixel right (0) or down (1) of here: in most of it, and in a part of it."""
        build, heights = self.build, []
        try:
            for self.beside in ((way, at) for at in (-0.5, -part / 2, part / 2, 0.5)):
                heights.append(self.number(socket))
        finally:
            self.beside = None
        even = self._least(*(build.divide(build.subtract(heights[k + 1], heights[k]), (1 - part) / 2) for k in (0, 2)))
        whole = build.subtract(heights[3], heights[0])
        return even, build.add(even, build.divide(build.subtract(whole, even), part))

    def _least(self, a, b):
        """Of two slopes the lesser, which is no step; where they differ in sign there are two, up and down: 0."""
        build = self.build
        least = build.mix(a, b, build.less(*(build.apply("absolute", x) for x in (b, a))))
        return build.multiply(least, build.less(0.0, build.multiply(a, b)))

    def _leant(self, normal, slopes, far):
        """A normal over slopes to the right and down."""
        build, steps = self.build, self.build.run("beside")
        across = self._cross(steps[3:], normal), self._cross(normal, steps[:3])
        size = self._dot_of(steps[:3], across[0])
        slope = self._each(build.add, *(tuple(build.multiply(rise, x) for x in way)
                                        for rise, way in zip(slopes, across, strict=True)))
        return self._unit(tuple(build.subtract(n, build.multiply(far, build.divide(x, size)))
                                for n, x in zip(normal, slope, strict=True)))

    def _turned_with_it(self, way):
        """A way in the thing's space, in the world."""
        return tuple(self._dot_of(row, way) for row in self._matrix())

    def _matrix(self):
        """Rows of what turns and scales the thing."""
        return [tuple(self.build.run("thing", data=(9 + 3 * row + k,))[0] for k in range(3)) for row in range(3)]

    def _dot_of(self, a, b):
        return functools.reduce(self.build.add, self._each(self.build.multiply, a, b))

    def _cross(self, a, b):
        build = self.build
        return tuple(build.subtract(build.multiply(a[j], b[k]), build.multiply(a[k], b[j]))
                     for j, k in ((1, 2), (2, 0), (0, 1)))

    def _unit(self, a):
        length = self.build.apply("root", self._dot_of(a, a))
        return tuple(self.build.divide(x, length) for x in a)
