# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that compute with numbers and vectors, and mix -> operations: a part of nodes.Compiler. What is not defined is
0, as in Cycles."""

import numpy as np

from . import trees

_LEAST = 1.1920929e-7  # by which numbers that Compare takes for equal differ


class Sums:
    """A method for each kind of node; Compiler gives `build`, number(), three(), _each() and _mixed()."""

    # Steps

    def _negative(self, a):
        return self.build.subtract(0.0, a)

    def _floor(self, a):
        return self.build.apply("floor", a)

    def _fraction(self, a):
        return self.build.subtract(a, self._floor(a))

    def _ceiling(self, a):
        return self._negative(self._floor(self._negative(a)))

    def _sign(self, a):
        return self.build.subtract(self.build.less(0.0, a), self.build.less(a, 0.0))

    def _whole(self, a):
        """Without what is behind the point."""
        return self.build.multiply(self._sign(a), self._floor(self.build.apply("absolute", a)))

    def _modulo(self, a, b):
        """What is left, with the sign of a."""
        build = self.build
        rest = build.subtract(a, build.multiply(b, self._whole(build.divide(a, b))))
        return build.multiply(rest, self._is(b))

    def _is(self, a):
        """1 where a is not 0."""
        return self.build.less(0.0, self.build.apply("absolute", a))

    def _floored_modulo(self, a, b):
        build = self.build
        rest = build.subtract(a, build.multiply(b, self._floor(build.divide(a, b))))
        return build.multiply(rest, self._is(b))

    def _wrapped(self, a, most, least):
        build = self.build
        wide = build.subtract(most, least)
        return build.subtract(a, build.multiply(wide, self._floor(build.divide(build.subtract(a, least), wide)))) \
            if not isinstance(wide, float) or wide != 0 else least

    def _snapped(self, a, b):
        return self.build.multiply(self._floor(self.build.divide(a, b)), b)

    def _pingpong(self, a, b):
        build = self.build
        share = self._fraction(build.divide(build.subtract(a, b), build.multiply(b, 2.0)))
        away = build.subtract(build.multiply(build.multiply(share, b), 2.0), b)
        return build.multiply(build.apply("absolute", away), self._is(b))

    def _smooth_least(self, a, b, wide):
        build = self.build
        near = build.maximum(build.subtract(wide, build.apply("absolute", build.subtract(a, b))), 0.0)
        share = build.divide(near, wide)
        cube = build.multiply(build.multiply(share, share), share)
        return build.subtract(build.minimum(a, b), build.multiply(build.multiply(cube, wide), 1 / 6))

    def _exponential(self, a):
        return self.build.apply("power", float(np.e), a)

    def _logarithm(self, a, base):
        build = self.build
        both = build.multiply(build.less(0.0, a), build.less(0.0, base))
        ratio = build.divide(build.apply("logarithm", a), build.apply("logarithm", base))
        return build.multiply(ratio, both)

    def _arcsine(self, a):
        build = self.build
        a = build.minimum(build.maximum(a, -1.0), 1.0)
        return build.apply("angle", a, build.apply("root", build.subtract(1.0, build.multiply(a, a))))

    # Numbers

    def _Math(self, node):
        build = self.build
        a, b, c = ([self.number(socket) for socket in node.inputs] + [0.0, 0.0])[:3]

        def turn(name):
            return lambda: build.apply(name, a)

        def grown(sign):
            return build.multiply(0.5, build.add(self._exponential(a), build.multiply(
                sign, self._exponential(self._negative(a)))))

        kinds = {
            "ADD": lambda: build.add(a, b), "SUBTRACT": lambda: build.subtract(a, b),
            "MULTIPLY": lambda: build.multiply(a, b), "DIVIDE": lambda: build.divide(a, b),
            "MULTIPLY_ADD": lambda: build.add(build.multiply(a, b), c),
            "POWER": lambda: build.apply("power", a, b), "LOGARITHM": lambda: self._logarithm(a, b),
            "SQRT": turn("root"), "INVERSE_SQRT": lambda: build.divide(1.0, build.apply("root", a)),
            "ABSOLUTE": turn("absolute"), "EXPONENT": lambda: self._exponential(a),
            "MINIMUM": lambda: build.minimum(a, b), "MAXIMUM": lambda: build.maximum(a, b),
            "LESS_THAN": lambda: build.less(a, b), "GREATER_THAN": lambda: build.less(b, a),
            "SIGN": lambda: self._sign(a), "COMPARE": lambda: self._near(a, b, c),
            "SMOOTH_MIN": lambda: self._smooth_least(a, b, c),
            "SMOOTH_MAX": lambda: self._negative(self._smooth_least(self._negative(a), self._negative(b), c)),
            "ROUND": lambda: self._floor(build.add(a, 0.5)), "FLOOR": turn("floor"),
            "CEIL": lambda: self._ceiling(a), "TRUNC": lambda: self._whole(a), "FRACT": lambda: self._fraction(a),
            "MODULO": lambda: self._modulo(a, b), "FLOORED_MODULO": lambda: self._floored_modulo(a, b),
            "WRAP": lambda: self._wrapped(a, b, c), "SNAP": lambda: self._snapped(a, b),
            "PINGPONG": lambda: self._pingpong(a, b),
            "SINE": turn("sine"), "COSINE": turn("cosine"),
            "TANGENT": lambda: build.divide(build.apply("sine", a), build.apply("cosine", a)),
            "ARCSINE": lambda: self._arcsine(a),
            "ARCCOSINE": lambda: build.subtract(np.pi / 2, self._arcsine(a)),
            "ARCTANGENT": lambda: build.apply("angle", a, 1.0), "ARCTAN2": lambda: build.apply("angle", a, b),
            "SINH": lambda: grown(-1.0), "COSH": lambda: grown(1.0),
            "TANH": lambda: self._even_tangent(a),
            "RADIANS": lambda: build.multiply(a, np.pi / 180), "DEGREES": lambda: build.multiply(a, 180 / np.pi),
        }
        if node.operation not in kinds:
            raise trees.Unknown(node.name)
        value = kinds[node.operation]()
        return {"Value": build.clamp(value) if node.use_clamp else value}

    def _near(self, a, b, wide):
        build = self.build
        away = build.apply("absolute", build.subtract(a, b))
        return build.subtract(1.0, build.less(build.maximum(wide, _LEAST), away))

    def _even_tangent(self, a):
        build = self.build
        grown = self._exponential(build.multiply(2.0, build.minimum(build.maximum(a, -20.0), 20.0)))
        return build.divide(build.subtract(grown, 1.0), build.add(grown, 1.0))

    def _MapRange(self, node):
        ends = "From Min", "From Max", "To Min", "To Max"
        if node.data_type == "FLOAT":
            value, *ends, steps = (self.number(trees.input_of(node, name)) for name in ("Value", *ends, "Steps"))
            return {"Result": self._ranged(node, value, *ends, steps)}
        named = ("Vector", *(f"{end.replace(' ', '_')}_FLOAT3" for end in ends), "Steps_FLOAT3")
        threes = [self.three(trees.input_of(node, name)) for name in named]
        return {"Vector": tuple(self._ranged(node, *numbers) for numbers in zip(*threes, strict=True))}

    def _ranged(self, node, value, low, high, to_low, to_high, steps):
        build, kind = self.build, node.interpolation_type
        share = build.divide(build.subtract(value, low), build.subtract(high, low))
        if kind in ("SMOOTHSTEP", "SMOOTHERSTEP"):
            share = build.clamp(share)
            square = build.multiply(share, share)
            if kind == "SMOOTHSTEP":
                share = build.multiply(square, build.subtract(3.0, build.multiply(2.0, share)))
            else:
                inner = build.add(build.multiply(share, build.subtract(build.multiply(share, 6.0), 15.0)), 10.0)
                share = build.multiply(build.multiply(square, share), inner)
        elif kind == "STEPPED":
            share = build.divide(self._floor(build.multiply(share, build.add(steps, 1.0))), steps)
        if node.clamp:
            share = build.clamp(share)
        out = build.add(to_low, build.multiply(share, build.subtract(to_high, to_low)))
        if node.data_type != "FLOAT":
            return out
        out = build.multiply(out, self._is(build.subtract(high, low)))
        if node.clamp:  # what is 0, too
            out = build.minimum(build.maximum(out, build.minimum(to_low, to_high)), build.maximum(to_low, to_high))
        return out

    def _Clamp(self, node):
        build = self.build
        value, low, high = (self.number(node.inputs[name]) for name in ("Value", "Min", "Max"))
        if node.clamp_type == "RANGE":
            low, high = build.minimum(low, high), build.maximum(low, high)
        return {"Result": build.minimum(build.maximum(value, low), high)}

    # Vectors

    def _VectorMath(self, node):
        build = self.build
        a, b, c = ([self.three(socket) for socket in node.inputs if socket.type == "VECTOR"] + [(0.0,) * 3] * 2)[:3]
        scale = next((self.number(socket) for socket in node.inputs if socket.type == "VALUE"), 1.0)
        singles = {"ABSOLUTE": lambda x: build.apply("absolute", x), "FLOOR": self._floor, "CEIL": self._ceiling,
                   "FRACTION": self._fraction, "SINE": lambda x: build.apply("sine", x),
                   "COSINE": lambda x: build.apply("cosine", x), "SIGN": self._sign,
                   "TANGENT": lambda x: build.divide(build.apply("sine", x), build.apply("cosine", x))}
        doubles = {"ADD": build.add, "SUBTRACT": build.subtract, "MULTIPLY": build.multiply, "DIVIDE": build.divide,
                   "MINIMUM": build.minimum, "MAXIMUM": build.maximum, "MODULO": self._modulo,
                   "SNAP": self._snapped, "POWER": lambda x, y: build.apply("power", x, y)}
        triples = {"WRAP": self._wrapped, "MULTIPLY_ADD": lambda x, y, z: build.add(build.multiply(x, y), z)}

        def scaled(x, by):
            return tuple(build.multiply(k, by) for k in x)

        def length(x):
            return build.apply("root", self._dot_of(x, x))

        others = {
            "SCALE": lambda: scaled(a, scale), "NORMALIZE": lambda: self._unit(a), "LENGTH": lambda: length(a),
            "DOT_PRODUCT": lambda: self._dot_of(a, b), "CROSS_PRODUCT": lambda: self._cross(a, b),
            "DISTANCE": lambda: length(self._each(build.subtract, a, b)),
            "PROJECT": lambda: scaled(b, build.divide(self._dot_of(a, b), self._dot_of(b, b))),
            "REFLECT": lambda: self._reflected(a, self._unit(b)),
            "REFRACT": lambda: self._refracted(a, self._unit(b), scale),
            "FACEFORWARD": lambda: scaled(a, build.subtract(
                build.multiply(2.0, build.less(self._dot_of(c, b), 0.0)), 1.0)),
        }
        kind = node.operation
        for kinds, inputs in ((singles, (a,)), (doubles, (a, b)), (triples, (a, b, c))):
            if kind in kinds:
                return {"Vector": self._each(kinds[kind], *inputs)}
        if kind not in others:
            raise trees.Unknown(node.name)
        value = others[kind]()
        return {"Vector": value} if isinstance(value, tuple) else {"Value": value}

    def _reflected(self, way, normal):
        build = self.build
        twice = build.multiply(2.0, self._dot_of(way, normal))
        return self._each(lambda x, n: build.subtract(x, build.multiply(twice, n)), way, normal)

    def _refracted(self, way, normal, ratio):
        build, along = self.build, self._dot_of(normal, way)
        rest = build.subtract(1.0, build.multiply(build.multiply(ratio, ratio),
                                                  build.subtract(1.0, build.multiply(along, along))))
        by = build.add(build.multiply(ratio, along), build.apply("root", rest))
        there = build.subtract(1.0, build.less(rest, 0.0))
        return tuple(build.multiply(there, build.subtract(build.multiply(ratio, x), build.multiply(by, n)))
                     for x, n in zip(way, normal, strict=True))

    # Mixes

    def _MixRGB(self, node):
        share = self.build.clamp(self.number(trees.input_of(node, "Fac")))
        return {"Color": self._blend(node, node.blend_type, share, self.three(node.inputs["Color1"]),
                                     self.three(node.inputs["Color2"]), node.use_clamp)}

    def _Mix(self, node):
        def of(name, kind):
            return trees.input_of(node, f"{name}_{kind}")

        if node.data_type == "VECTOR" and node.factor_mode == "NON_UNIFORM":
            shares = self.three(of("Factor", "Vector"))
            shares = tuple(map(self.build.clamp, shares)) if node.clamp_factor else shares
            a, b = (self.three(of(name, "Vector")) for name in "AB")
            return {"Result_Vector": self._each(self.build.mix, a, b, shares)}
        share = self.number(of("Factor", "Float"))
        share = self.build.clamp(share) if node.clamp_factor else share
        if node.data_type == "RGBA":
            value = self._blend(node, node.blend_type, share, self.three(of("A", "Color")),
                                self.three(of("B", "Color")), node.clamp_result)
            return {"Result_Color": value}
        if node.data_type == "FLOAT":
            return {"Result_Float": self.build.mix(self.number(of("A", "Float")), self.number(of("B", "Float")), share)}
        if node.data_type == "VECTOR":
            return {"Result_Vector": self._mixed(self.three(of("A", "Vector")), self.three(of("B", "Vector")), share)}
        raise trees.Unknown(node.name)

    def _blend(self, node, kind, share, a, b, clamp):
        """Two colours as layers one over the other."""
        build = self.build
        less = build.subtract(1.0, share)

        def flipped(x):
            return build.subtract(1.0, x)

        def wholly(function):
            """Of what is mixed afterwards."""
            return lambda x, y: build.mix(x, function(x, y), share)

        blends = {
            "MIX": wholly(lambda x, y: y), "MULTIPLY": wholly(build.multiply), "ADD": wholly(build.add),
            "SUBTRACT": wholly(build.subtract), "DARKEN": wholly(build.minimum), "LIGHTEN": wholly(build.maximum),
            "DIFFERENCE": wholly(lambda x, y: build.apply("absolute", build.subtract(x, y))),
            "EXCLUSION": lambda x, y: build.maximum(build.mix(x, build.subtract(
                build.add(x, y), build.multiply(2.0, build.multiply(x, y))), share), 0.0),
            "SCREEN": wholly(lambda x, y: flipped(build.multiply(flipped(x), flipped(y)))),
            "DIVIDE": lambda x, y: build.mix(x, build.mix(x, build.divide(x, y), share), self._is(y)),
            "OVERLAY": lambda x, y: build.mix(
                flipped(build.multiply(build.add(less, build.multiply(build.multiply(2.0, share), flipped(y))),
                                       flipped(x))),
                build.multiply(x, build.add(less, build.multiply(build.multiply(2.0, share), y))),
                build.less(x, 0.5)),
            "SOFT_LIGHT": wholly(lambda x, y: build.add(
                build.multiply(build.multiply(flipped(x), y), x),
                build.multiply(x, flipped(build.multiply(flipped(x), flipped(y)))))),
            "LINEAR_LIGHT": lambda x, y: build.add(x, build.multiply(share, build.subtract(
                build.multiply(2.0, y), 1.0))),
            "DODGE": lambda x, y: self._dodged(x, flipped(build.multiply(share, y))),
            "BURN": lambda x, y: self._burnt(x, build.add(less, build.multiply(share, y))),
        }
        if kind in blends:
            out = self._each(blends[kind], a, b)
        elif kind in ("HUE", "SATURATION", "COLOR", "VALUE"):
            out = self._tinted(kind, share, a, b)
        else:
            raise trees.Unknown(node.name)
        return tuple(map(build.clamp, out)) if clamp else out

    def _dodged(self, x, rest):
        build = self.build
        bright = build.mix(1.0, build.minimum(build.divide(x, rest), 1.0), build.less(0.0, rest))
        return build.multiply(bright, self._is(x))

    def _burnt(self, x, rest):
        build = self.build
        dark = build.subtract(1.0, build.divide(build.subtract(1.0, x), rest))
        return build.multiply(build.clamp(dark), build.less(0.0, rest))

    def _tinted(self, kind, share, a, b):
        build = self.build
        (h, s, v), (h2, s2, v2) = (build.run("to_hsv", color) for color in (a, b))
        if kind == "VALUE":
            return build.run("from_hsv", (h, s, build.mix(v, v2, share)))
        if kind == "SATURATION":
            by = build.multiply(share, self._is(s))
            return self._mixed(a, build.run("from_hsv", (h, build.mix(s, s2, share), v)), self._is(by))
        other = build.run("from_hsv", (h2, s if kind == "HUE" else s2, v))
        return self._mixed(a, other, build.multiply(share, self._is(s2)))
