# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of patterns by formula -> operations: a part of nodes.Compiler, whose methods it uses."""

import functools

import numpy as np

from ..pen.program import Register
from . import trees
from .values import Values
from .versions import PCG_CELLS


def hashed(a, b):
    """32 bits of two numbers of so many, by Jenkins' mixing (lookup3), as Cycles makes them."""
    c = (0xdeadbeef + (2 << 2) + 13) % 2 ** 32
    a, b = (a + c) % 2 ** 32, (b + c) % 2 ** 32
    for bits in (14, 11, 25, 16, 4, 14, 24):  # c by b, a by c, b by a, and so on
        c = ((c ^ b) - (b << bits | b >> 32 - bits)) % 2 ** 32
        a, b, c = b, c, a
    return b


def _far(seed):
    """How far away Cycles looks for more noise that has nothing to do with that at a place."""
    return [100 + 100 * hashed(*np.array([seed, k], np.float32).view(np.uint32).tolist()) / 0xffffffff
            for k in range(3)]


_CELLS = {"F1": "voronoi", "F2": "voronoi_second", "SMOOTH_F1": "voronoi_smooth", "DISTANCE_TO_EDGE": "voronoi_edge"}
_METRICS = "EUCLIDEAN", "MANHATTAN", "CHEBYCHEV"


class Patterns(Values):
    """The values of their outputs, by names."""

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
            raise trees.Unknown(node.name)
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
        if not plain:
            raise trees.Unknown(node.name)
        place = self._place(node)
        out = {"Fac": self._noise(node, place, detail, rough)}
        if node.outputs["Color"].is_linked:  # its green and blue are noise from elsewhere
            green, blue = (self._noise(node, [self.build.add(x, by) for x, by in zip(place, _far(seed), strict=True)],
                                       detail, rough) for seed in (3, 4))
            out["Color"] = out["Fac"], green, blue
        return out

    def _noise(self, node, place, detail, rough):
        if isinstance(detail, Register):
            raise trees.Unknown(node.name)
        detail = min(max(detail, 0.0), 15.0)
        at = self.build.pool.place([np.floor(detail), detail - np.floor(detail)])
        return self.build.run("noise", (*place, rough), (at,))[0]

    def _TexVoronoi(self, node):
        build, inputs = self.build, node.inputs
        kind, metric, wide = node.feature, node.distance, node.voronoi_dimensions
        fractal = "Detail" in inputs and 0 not in (self.number(inputs["Detail"]), self.number(inputs["Roughness"]))
        if fractal or kind not in _CELLS or metric not in _METRICS or wide not in ("2D", "3D"):
            raise trees.Unknown(node.name)
        random, place = build.clamp(self.number(inputs["Randomness"])), self._place(node)
        smooth = (build.multiply(0.5, self.number(inputs["Smoothness"])),) if kind == "SMOOTH_F1" else ()
        name = "voronoi" if smooth == (0.0,) else _CELLS[kind]
        data = _METRICS.index(metric), (wide == "2D") + 2 * PCG_CELLS
        distance, *rest = build.run(name, (*place, random, *(() if name == "voronoi" else smooth)), data)
        if getattr(node, "normalize", False):
            edge = kind == "DISTANCE_TO_EDGE"
            most = 1.0 if edge or metric == "CHEBYCHEV" else int(wide[0]) ** (0.5 if metric == "EUCLIDEAN" else 1.0)
            most *= 2 if kind == "F2" else 1
            distance = build.divide(distance, build.multiply(most, build.add(0.5, build.multiply(0.5, random))))
        if not rest:
            return {"Distance": distance}
        scale = self.number(inputs["Scale"])
        return {"Distance": distance, "Color": tuple(rest[:3]),
                "Position": tuple(build.divide(x, scale) for x in rest[3:])}

    def _TexWave(self, node):
        build, number = self.build, lambda name: self.number(node.inputs[name])
        # Places on a boundary are inside, whatever rounding does.
        place = [build.multiply(build.add(x, 1e-6), 0.999999) for x in self._place(node)]
        bands = node.wave_type == "BANDS"
        along = node.bands_direction if bands else node.rings_direction
        if bands:
            way = (build.multiply(build.add(place[0], build.add(place[1], place[2])), 10.0) if along == "DIAGONAL"
                   else build.multiply(place["XYZ".index(along)], 20.0))
        else:
            squares = [build.multiply(x, x) for k, x in enumerate(place) if along == "SPHERICAL" or "XYZ"[k] != along]
            way = build.multiply(build.apply("root", functools.reduce(build.add, squares)), 20.0)
        way, distortion = build.add(way, number("Phase Offset")), number("Distortion")
        if distortion != 0:
            scale = number("Detail Scale")
            noise = self._noise(node, [build.multiply(x, scale) for x in place], number("Detail"),
                                number("Detail Roughness"))
            way = build.add(way, build.multiply(distortion, build.subtract(build.multiply(noise, 2.0), 1.0)))
        if node.wave_profile == "SIN":
            share = build.add(0.5, build.multiply(0.5, build.apply("sine", build.subtract(way, np.pi / 2))))
        else:
            turns = build.multiply(way, 1 / (2 * np.pi))
            if node.wave_profile == "SAW":
                share = build.subtract(turns, build.apply("floor", turns))
            else:
                nearest = build.apply("floor", build.add(turns, 0.5))
                share = build.multiply(build.apply("absolute", build.subtract(turns, nearest)), 2.0)
        return {"Color": (share,) * 3, "Fac": share}
