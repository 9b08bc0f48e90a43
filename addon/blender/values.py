# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes that mix colors and numbers, normal maps and bumps -> operations, a part of nodes.Compiler."""

import functools

from ..pen.colour import LUMINANCE
from ..pen.program import Register
from . import attributes, trees, worlds
from .sums import Sums


class Values(Sums):
    """A method for each kind of node; Compiler gives `build`, number(), three(), _each(), _mixed(), _scalars()
    and _mesh()."""

    def _RGB(self, node):
        return {"Color": tuple(map(float, node.outputs[0].default_value[:3]))}

    def _Value(self, node):
        return {"Value": float(node.outputs[0].default_value)}

    def _LightPath(self, node):
        out = {socket.name: worlds.SEEN.get(socket.name, 0.0) for socket in node.outputs}
        if node.outputs["Ray Length"].is_linked:
            self.lose(node.name)  # which begins where the camera begins to see
            place = self.build.run("camera")[:3]
            out["Ray Length"] = self.build.apply("root", self._dot_of(place, place))
        return out

    def _ValToRGB(self, node):
        ramp, share = node.color_ramp, self.number(trees.input_of(node, "Fac"))
        if ramp.interpolation in ("CONSTANT", "LINEAR") and ramp.color_mode == "RGB":
            stops = [(stop.position, *stop.color) for stop in ramp.elements]
        else:
            stops = [(k / 256, *ramp.evaluate(k / 256)) for k in range(257)]
        at = self.build.pool.place([number for stop in stops for number in stop])
        name = "steps" if len(stops) < 257 and ramp.interpolation == "CONSTANT" else "ramp"
        r, g, b, alpha = self.build.run(name, (share,), (at, len(stops)))
        return {"Color": (r, g, b), "Alpha": alpha}

    def _FloatCurve(self, node):
        mapping, value = node.mapping, self.number(node.inputs["Value"])
        mapping.update()
        curved = self._curve(mapping, [mapping.evaluate(mapping.curves[0], k / 256) for k in range(257)], value)
        return {"Value": self.build.mix(value, curved, self.number(trees.input_of(node, "Factor")))}

    def _VectorCurve(self, node):
        mapping, vector, build = node.mapping, self.three(node.inputs["Vector"]), self.build
        mapping.update()
        out = []
        for k in range(3):
            table = [mapping.evaluate(mapping.curves[k], step / 128 - 1) for step in range(257)]
            share = build.multiply(build.add(vector[k], 1.0), 0.5)
            out.append(self._curve(mapping, table, share))
        return {"Vector": self._mixed(vector, tuple(out), self.number(trees.input_of(node, "Fac")))}

    def _RGBCurve(self, node):
        color, share = self.three(node.inputs["Color"]), self.number(trees.input_of(node, "Fac"))
        mapping = node.mapping
        mapping.update()
        white = [mapping.evaluate(mapping.curves[3], k / 256) for k in range(257)]
        out = []
        for k in range(3):
            table = [mapping.evaluate(mapping.curves[k], value) for value in white]
            out.append(self._curve(mapping, table, color[k]))
        return {"Color": self._mixed(color, tuple(out), share)}

    def _curve(self, mapping, table, x):
        """What a table of 0 to 1 gives; beyond its ends it goes on as it ends, if the curve does."""
        build = self.build
        value = build.run("curve", (x,), (build.pool.place(table), len(table)))[0]
        if mapping.extend != "EXTRAPOLATED":
            return value
        below, above = build.minimum(x, 0.0), build.maximum(build.subtract(x, 1.0), 0.0)
        first, last = (float(len(table) - 1) * (b - a) for a, b in (table[:2], table[-2:]))
        return build.add(value, build.add(build.multiply(below, first), build.multiply(above, last)))

    def _RGBToBW(self, node):
        return {"Val": self._dot(self.three(node.inputs["Color"]), LUMINANCE)}

    def _SeparateXYZ(self, node):
        return dict(zip("XYZ", self.three(node.inputs[0]), strict=True))

    def _CombineXYZ(self, node):
        return {"Vector": tuple(self.number(socket) for socket in node.inputs)}

    def _SeparateColor(self, node):
        values = self.three(node.inputs[0])
        if node.mode == "HSV":
            values = self.build.run("to_hsv", values)
        elif node.mode == "HSL":
            values = self._to_hsl(values)
        return dict(zip(("Red", "Green", "Blue"), values, strict=True))

    def _CombineColor(self, node):
        values = tuple(self.number(socket) for socket in node.inputs)
        if node.mode == "HSV":
            values = self._from_hsv(values)
        elif node.mode == "HSL":
            values = self._from_hsl(values)
        return {"Color": values}

    def _SeparateHSV(self, node):
        return dict(zip("HSV", self.build.run("to_hsv", self.three(node.inputs[0])), strict=True))

    def _CombineHSV(self, node):
        return {"Color": self._from_hsv(tuple(self.number(socket) for socket in node.inputs))}

    def _from_hsv(self, values):
        """As in Cycles a hue of less than 0 or more than 1 lies in the last sixth of the circle."""
        build, (hue, saturation, value) = self.build, values
        beyond = build.add(build.less(hue, 0.0), build.less(1.0, hue))
        last = build.multiply(build.add(5.0, self._fraction(build.multiply(hue, 6.0))), 1 / 6)
        return build.run("from_hsv", (build.mix(hue, last, beyond), saturation, value))

    def _to_hsl(self, color):
        build = self.build
        hue, saturation, value = build.run("to_hsv", color)
        light = build.multiply(value, build.subtract(1.0, build.multiply(0.5, saturation)))
        wide = build.minimum(light, build.subtract(1.0, light))
        return hue, build.divide(build.subtract(value, light), wide), light

    def _from_hsl(self, color):
        build, (hue, saturation, light) = self.build, color
        away = build.apply("absolute", build.subtract(build.multiply(2.0, light), 1.0))
        wide = build.multiply(build.subtract(1.0, away), saturation)
        return tuple(build.add(build.multiply(build.subtract(c, 0.5), wide), light)
                     for c in build.run("from_hsv", (build.clamp(hue), 1.0, 1.0)))

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
        build, out = self.build, []
        for c in self.three(node.inputs["Color"]):  # what is not above 0 stays, but for a gamma of 0
            power = build.mix(c, build.apply("power", build.maximum(c, 0.0), gamma), build.less(0.0, c))
            out.append(build.mix(1.0, power, self._is(gamma)))
        return {"Color": tuple(out)}

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
            turned = self._unit(tuple(
                build.add(build.multiply(x, t), build.add(build.multiply(y, b), build.multiply(z, n)))
                for t, b, n in zip(along, side, normal, strict=True)))
            there = self._is(self._dot_of(along, along))  # whether the mesh has tangents
            return {"Normal": self._mixed(normal, turned, there)}
        else:
            raise trees.Unknown(node.name)
        return {"Normal": self._unit(self._mixed(normal, self._unit(way), strength))}

    def _Bump(self, node):
        """Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU (2010), as in Cycles: the normal leans against the
        slope of the height, which is looked at beside the pixel, too. Cycles looks a part of a pixel away, many times
        in each; so a step, as at joints, is in that part of it alone, wherever it lies."""
        build, inputs = self.build, node.inputs
        normal = self._normal(inputs["Normal"])
        if not trees.source_of(inputs["Height"]):
            if self.given(inputs["Normal"]):
                self.lose(node.name)  # Cycles takes some for none
            return {"Normal": normal}
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
