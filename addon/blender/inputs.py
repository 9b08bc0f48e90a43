# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell where a surface is, how it is looked at, and what its mesh and its pictures say -> operations: a part
of nodes.Compiler."""

from dataclasses import dataclass

import numpy as np

from . import pictures, trees
from .colored import Place
from .patterns import Patterns

_MOST_SOURCES = 5
_THING = 18  # numbers that every thing tells; what materials ask of theirs is behind them


@dataclass
class Straight:
    """A vector that grows evenly along a surface: `rows` (3, 4) times three channels of it and 1."""

    source: int
    rows: np.ndarray


class Inputs(Patterns):
    """The values of their outputs, by names."""

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

    def _light(self):
        """The light on the surface; it is drawn later, and all of it is there until then."""
        return self._scalars(self._mesh("light", ""))

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

    # How it is looked at

    def _flat(self):
        """(the normal of the face itself, towards whoever looks; 1 where that is its back). Mirrored things have the
        same side in front, as in Cycles."""
        build, own = self.build, self._scalars(self._mesh("facing", ""))
        x, y, z = self._matrix()
        across = self._cross(y, z), self._cross(z, x), self._cross(x, y)
        inverted = build.less(self._dot_of(x, across[0]), 0.0)
        normal = self._unit(tuple(self._dot_of(row, own) for row in across))
        towards = self._dot_of(normal, build.run("incoming"))
        away = build.less(towards, 0.0)
        back = build.apply("absolute", build.subtract(away, inverted))
        sign = build.subtract(1.0, build.multiply(2.0, away))
        return tuple(build.multiply(c, sign) for c in normal), back

    def _backfacing(self):
        try:
            return self._flat()[1]
        except trees.Unknown:  # no room is left
            return 0.0

    def _normal(self, socket):
        """The normal that a socket is given."""
        return self.three(socket) if self.given(socket) else self.build.run("normal")

    def _faces(self, socket):
        """The cosine between the normal of a socket and where it is looked at from."""
        normal = self._normal(socket)
        return self.build.apply("absolute", self._dot_of(normal, self.build.run("incoming")))

    def _mirrored_share(self, cosine, ior):
        """Fresnel's, of a dielectric."""
        build = self.build
        g = build.add(build.subtract(build.multiply(ior, ior), 1.0), build.multiply(cosine, cosine))
        root = build.apply("root", g)
        a = build.divide(build.subtract(root, cosine), build.add(root, cosine))
        b = build.divide(build.subtract(build.multiply(cosine, build.add(root, cosine)), 1.0),
                         build.add(build.multiply(cosine, build.subtract(root, cosine)), 1.0))
        share = build.multiply(build.multiply(0.5, build.multiply(a, a)), build.add(1.0, build.multiply(b, b)))
        return build.mix(1.0, share, build.less(0.0, g))

    def _Fresnel(self, node):
        build, ior = self.build, self.build.maximum(self.number(node.inputs["IOR"]), 1e-5)
        ior = build.mix(ior, build.divide(1.0, ior), self._backfacing())
        return {"Fac": self._mirrored_share(self._faces(node.inputs["Normal"]), ior)}

    _BlendFresnel = _Fresnel

    def _LayerWeight(self, node):
        build, blend = self.build, self.number(node.inputs["Blend"])
        cosine, out = self._faces(node.inputs["Normal"]), {}
        if node.outputs["Fresnel"].is_linked:
            ior = build.maximum(build.subtract(1.0, blend), 1e-5)
            ior = build.mix(build.divide(1.0, ior), ior, self._backfacing())
            out["Fresnel"] = self._mirrored_share(cosine, ior)
        if node.outputs["Facing"].is_linked:
            blend = build.minimum(build.maximum(blend, 0.0), 1 - 1e-5)
            high = build.less(blend, 0.5)
            power = build.mix(build.divide(0.5, build.subtract(1.0, blend)), build.multiply(2.0, blend), high)
            out["Facing"] = build.subtract(1.0, build.apply("power", cosine, power))
        return out

    def _CameraData(self, node):
        x, y, z, *_ = self.build.run("camera")
        far = self.build.apply("root", self._dot_of((x, y, z), (x, y, z)))
        return {"View Vector": self._unit((x, y, z)), "View Z Depth": z, "View Distance": far}

    def _AmbientOcclusion(self, node):
        self.lose(node.name)
        return {"Color": self.three(node.inputs["Color"]), "AO": 1.0}

    def _Bevel(self, node):
        self.lose(node.name)
        return {"Normal": self._normal(node.inputs["Normal"])}

    # Where

    def _TexCoord(self, node):
        run, placed = self.build.run, ("UV", "Generated")
        makes = {"UV": self._uv, "Generated": self._generated,
                 "Object": lambda: self._seen_from(node.object) if node.object else self._mesh("object", ""),
                 "Normal": lambda: self._unit(self._into_thing(run("normal"))),
                 "Camera": lambda: run("camera")[:3], "Window": lambda: (*run("camera")[3:], 0.0),
                 "Reflection": lambda: self._mirrored(run("normal"), run("incoming"))}
        out = {}
        for name, make in makes.items():
            if node.outputs[name].is_linked:
                make = (lambda: self._of_instancer(node)) if node.from_instancer and name in placed else make
                try:
                    out[name] = make()
                except trees.Unknown:  # which then is that output's fault
                    continue
        return out

    def _seen_from(self, thing):
        """The place in another thing's space."""
        inverse = np.array(thing.matrix_world.inverted_safe())
        place = self._place_here()
        return tuple(self.build.add(self._dot(place, row[:3]), float(row[3])) for row in inverse[:3])

    def _into_thing(self, normal):
        """A normal of the world in the thing's space."""
        return tuple(self._dot_of(column, normal) for column in zip(*self._matrix(), strict=True))

    def _mirrored(self, normal, ray):
        """Where a ray goes that comes from `ray`."""
        build = self.build
        twice = build.multiply(2.0, self._dot_of(normal, ray))
        return self._each(lambda n, r: build.subtract(build.multiply(twice, n), r), normal, ray)

    def _of_instancer(self, node):
        """Coordinates of what places a thing: 0 of things that nothing places."""
        self.lose(node.name)
        return (0.0,) * 3

    def _UVMap(self, node):
        if node.from_instancer:
            return {"UV": self._of_instancer(node)}
        return {"UV": self._mesh("uv", node.uv_map)}

    def _place_here(self):
        place = self.build.run("place")
        if self.beside:
            way, part = self.beside
            place = tuple(self.build.add(x, self.build.multiply(step, part)) for x, step in
                          zip(place, self.build.run("beside")[3 * way:3 * way + 3], strict=True))
        return place

    def _NewGeometry(self, node):
        linked = {socket.name for socket in node.outputs if socket.is_linked}
        out = {"Position": self._place_here(), "Normal": self.build.run("normal"),
               "Incoming": self.build.run("incoming")}
        if linked & {"True Normal", "Backfacing"}:
            out["True Normal"], out["Backfacing"] = self._flat()
        if "Pointiness" in linked:
            self.lose(node.name)
            out["Pointiness"] = 0.5  # of what is flat
        return out

    # What meshes and things say

    def _VertexColor(self, node):
        out = {"Color": self._scalars(self._mesh("color", node.layer_name))}
        if node.outputs["Alpha"].is_linked:
            out["Alpha"] = self._scalars(self._mesh("alpha", node.layer_name))[0]
        return out

    def _Attribute(self, node):
        if node.attribute_type != "GEOMETRY":
            at = _THING + 4 * self.build.pool.told(node.attribute_type, node.attribute_name)
            *color, alpha = (self.build.run("thing", data=(at + k,))[0] for k in range(4))
            return {"Color": tuple(color), "Vector": tuple(color), "Fac": self._dot(color, (1 / 3,) * 3),
                    "Alpha": alpha}
        if not node.attribute_name:
            return {"Color": (0.0,) * 3, "Vector": (0.0,) * 3, "Fac": 0.0, "Alpha": 1.0}
        found = self._mesh("color", node.attribute_name)
        color = self._scalars(found)
        out = {"Color": color, "Vector": found}
        if node.outputs["Fac"].is_linked:
            out["Fac"] = self._scalars(self._mesh("fac", node.attribute_name))[0]
        if node.outputs["Alpha"].is_linked:
            out["Alpha"] = self._scalars(self._mesh("opaque", node.attribute_name))[0]
        return out

    def _ObjectInfo(self, node):
        thing = [self.build.run("thing", data=(k,))[0] for k in range(9)]
        return {"Color": tuple(thing[:3]), "Alpha": thing[3], "Random": thing[4], "Object Index": thing[5],
                "Location": tuple(thing[6:9]), "Material Index": self.index}

    def _Mapping(self, node):
        vector = self.vector(node.inputs["Vector"])
        rows = trees.mapping(node)
        if isinstance(vector, Straight):
            whole = np.vstack([vector.rows, (0, 0, 0, 1)])
            return {"Vector": Straight(vector.source, rows @ whole)}
        return {"Vector": tuple(self.build.add(self._dot(vector, row[:3]), float(row[3])) for row in rows)}

    # Pictures

    def _TexImage(self, node):
        build, image = self.build, pictures.still(node)
        if image is None:
            return {"Color": (1.0, 0.0, 1.0), "Alpha": 1.0}  # magenta, as renderers have it
        wraps = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip", "MIRROR": "extend"}
        if node.projection != "FLAT" or node.extension not in wraps:
            raise trees.Unknown(node.name)
        if node.interpolation in ("Cubic", "Smart"):
            self.lose(node.name)  # smoother where it is seen from near
        asked = node.outputs["Alpha"].is_linked
        picture = self.images.get(image, wraps[node.extension], not asked)
        number = build.pool.texture(picture)
        vector = self.vector(node.inputs["Vector"], self._uv)
        u, v, _ = self._scalars(vector)
        steps = (0.0,) * 4
        if isinstance(vector, Straight):
            by = build.pool.place([*vector.rows[0, :3], *vector.rows[1, :3]])
            steps = build.run("footprint", data=(3 * vector.source, by))
        if node.extension == "MIRROR":
            u, v = (self._pingpong(x, 1.0) for x in (u, v))
        if node.interpolation == "Closest":  # the middle of a texel
            u, v = (build.multiply(build.add(self._floor(build.multiply(x, float(n))), 0.5), 1 / n)
                    for x, n in ((u, picture.width), (v, picture.height)))
        *color, alpha = build.run("texture", (u, v, *steps), (number,))
        if isinstance(vector, Straight) and self.sources[vector.source][0] == "uv" and not self.beside and (
                not vector.rows[:2, 2].any()):
            self.looked[color[0].number] = Place(
                self.sources[vector.source][1], tuple(tuple(map(float, row[[0, 1, 3]])) for row in vector.rows[:2]),
                picture.width, picture.height, node.extension.lower(), node.interpolation == "Closest")
        if asked and pictures.has_alpha(image):
            solid = build.less(0.0, alpha)
            color = [build.mix(c, build.divide(c, alpha), solid) for c in color]
        return {"Color": tuple(color), "Alpha": alpha}
