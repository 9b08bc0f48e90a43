# SPDX-License-Identifier: GPL-3.0-or-later
"""The world around a scene: what is seen of it, and the light that comes from it, as far as that can be told without a
renderer.

Colors, pictures and Blender's Sky Texture are taken as they are, and shaders that mix them are sums. What other nodes
make of them is computed by a program, as those of materials are, for ways to look instead of pixels."""

from dataclasses import dataclass, field

import numpy as np

from ..pen import daylight, irradiance, library, suns
from ..pen.job import Frame, Materials
from ..pen.program import Pool, TooLong
from ..pen.sky import Sky, looked_up
from . import nodes, pictures, trees, worlds
from .inputs import Straight
from .shaders import Surface

_ROWS = 256   # of a picture that a program draws
_SUMMED = 64  # of one whose light is summed: light by the normal is smooth


@dataclass
class Around:
    """The light of a world: (9, 3) from all sides as Scene.light() takes it, None: none; and its Suns."""

    ambient: np.ndarray | None = None
    suns: list = field(default_factory=list)


def light(world):
    """The Around of an evaluated world. Unknown: it can't be told."""
    found = _world(world, "diffuse", worlds.LIT)
    ambient, shining = irradiance.constant(found.color), list(found.suns)
    for picture, turn in found.pictures:
        left, bright = suns.parted(picture)
        ambient += irradiance.of_picture(suns.shrunk(left, _SUMMED), turn)
        shining += [suns.Sun(turn.T @ sun.direction, sun.color, sun.width) for sun in bright]
    return Around(ambient if np.any(ambient) else None, [sun for sun in shining if np.any(sun.color > 0)])


def seen(world):
    """The Sky that the camera sees of an evaluated world. Unknown: it can't be told."""
    return _world(world, "camera", worlds.SEEN)


def photographed(world):
    """Whether an evaluated world looks into images anywhere. What a Sky Texture or a ramp draws is even already."""
    return world is not None and any(node.bl_idname in ("ShaderNodeTexEnvironment", "ShaderNodeTexImage")
                                     for node in trees.nodes_of(world))


def _world(world, asked, ray):
    """The Sky of a world; asked: the visibility that counts."""
    if world is None or not getattr(getattr(world, "cycles_visibility", None), asked, True):
        return Sky()
    if not world.use_nodes or world.node_tree is None:
        return Sky(np.array(world.color))
    out = world.node_tree.get_output_node("CYCLES")
    return Sky() if out is None else _shader(out.inputs["Surface"], ray)


@trees.bounded
def _shader(socket, ray):
    source = trees.source_of(socket)
    if source is None:
        return Sky()
    node = source[0]
    if trees.is_nothing(node):
        return Sky()
    try:
        if source[1].type != "SHADER":  # it glows
            return _color(socket)
        if node.bl_idname in ("ShaderNodeBackground", "ShaderNodeEmission"):
            return _color(node.inputs["Color"]) * worlds.value(node.inputs["Strength"], ray)
        if node.bl_idname == "ShaderNodeAddShader":
            return _shader(node.inputs[0], ray) + _shader(node.inputs[1], ray)
        if node.bl_idname == "ShaderNodeMixShader":
            share = float(np.clip(worlds.value(node.inputs[0], ray), 0, 1))
            if share in (0, 1):  # what can't be told of the other does not matter
                return _shader(node.inputs[1 + int(share)], ray)
            return _shader(node.inputs[1], ray) * (1 - share) + _shader(node.inputs[2], ray) * share
    except trees.Unknown:
        pass
    return _drawn(socket, ray)


def _color(socket):
    source = trees.source_of(socket)
    if source is None or trees.is_nothing(source[0]):
        return Sky(worlds.color(socket))
    node = source[0]
    if node.bl_idname == "ShaderNodeTexEnvironment":
        return Sky(pictures=((_environment(node), _turn(node)),))
    if node.bl_idname == "ShaderNodeTexSky":
        picture, sun = _clear(node)
        turn = _turn(node)
        return Sky(pictures=((picture, turn),),
                   suns=() if sun is None else (suns.Sun(turn.T @ sun.direction, sun.color, sun.width),))
    return Sky(worlds.color(socket))


# Pictures

def _environment(node):
    """(height, width, 3), row 0 at the top."""
    image = pictures.still(node)
    if node.projection != "EQUIRECTANGULAR" or image is None or not all(image.size):
        raise trees.Unknown(node.name)
    return pictures.colors(pictures.linear(image))[::-1]


def _clear(node):
    """(picture, Sun or None) of a Sky Texture."""
    kind = node.sky_type
    if kind in ("PREETHAM", "HOSEK_WILKIE"):
        way = tuple(np.array(node.sun_direction, np.float64) / max(np.linalg.norm(node.sun_direction), 1e-30))
        picture = daylight.analytic(way, node.turbidity)
        if kind == "HOSEK_WILKIE":
            picture = picture * daylight.hosek(way, node.turbidity, node.ground_albedo).astype(np.float32)
        return picture, None
    air = node.air_density, getattr(node, "dust_density", getattr(node, "aerosol_density", 1.0))
    place = node.sun_elevation, node.sun_rotation, node.altitude
    picture = daylight.atmosphere(*place, *air, node.ozone_density)
    if not node.sun_disc:
        return picture, None
    return picture, daylight.sun_of(*place, *air, node.sun_size, node.sun_intensity)


def _turn(node):
    """World -> picture."""
    source = trees.source_of(node.inputs["Vector"]) if "Vector" in node.inputs else None  # an atmosphere has none
    if source is None or source[0].bl_idname == "ShaderNodeTexCoord":
        return np.eye(3)
    if source[0].bl_idname != "ShaderNodeMapping":
        raise trees.Unknown(source[0].name)
    turn = trees.mapping(source[0])[:, :3]
    if np.abs(turn @ turn.T - np.eye(3)).max() > 1e-4 or np.linalg.det(turn) < 0:
        raise trees.Unknown(source[0].name)
    return turn


# Programs

class _Reader(nodes.Compiler):
    """The program of a world's shader. Its sources are ways to look, and colors of skies there."""

    def __init__(self, ray):
        super().__init__(Pool(), pictures.Images())
        self.ray, self.skies = ray, []  # (picture, rows of world -> picture, Sun or None)

    def _way(self):
        return self._mesh("way", "")

    _generated = _uv = _way

    def _TexCoord(self, node):
        if node.object is not None and node.outputs["Object"].is_linked:
            raise trees.Unknown(node.name)
        found = {name: self._way() for name in ("Generated", "Object") if node.outputs[name].is_linked}
        return found | {"UV": (0.0, 0.0, 0.0)}

    def _NewGeometry(self, node):
        way = self._scalars(self._way())
        back = tuple(self.build.multiply(x, -1.0) for x in way)
        return {"Position": way, "Normal": back, "True Normal": back, "Incoming": back}

    def _LightPath(self, node):
        return {socket.name: self.ray.get(socket.name, 0.0) for socket in node.outputs}

    def _Background(self, node):
        strength = self.number(node.inputs["Strength"])
        return {"Background": Surface(emission=tuple(
            self.build.multiply(c, strength) for c in self.three(node.inputs["Color"])))}

    def _TexEnvironment(self, node):
        return self._sky(node, _environment(node), None)

    def _TexSky(self, node):
        return self._sky(node, *_clear(node))

    def _sky(self, node, picture, sun):
        vector = self.vector(node.inputs["Vector"], self._way) if "Vector" in node.inputs else self._way()
        if not isinstance(vector, Straight) or self.sources[vector.source] != ("way", ""):
            raise trees.Unknown(node.name)
        self.skies.append((picture, vector.rows, sun))
        return {"Color": self._scalars(self._mesh("sky", len(self.skies) - 1))}


def _drawn(socket, ray):
    """The Sky of what a program makes of a shader's nodes."""
    reader = _Reader(ray)
    try:
        program = reader.finish(reader.material(socket), 0)
    except TooLong as e:
        raise trees.Unknown(str(e)) from None
    if reader.lost:
        raise trees.Unknown(reader.lost[0])
    height, width = _ROWS, 2 * _ROWS
    shining = [k for k, (_, _, sun) in enumerate(reader.skies) if sun is not None]
    # One more row: of each sun the way to it, with it and without.
    way = np.zeros((height + 1, width, 3))
    way[:height], way[height] = suns.ways(height, width), (0, 0, 1)
    for n, k in enumerate(shining):
        _, rows, sun = reader.skies[k]
        toward = np.linalg.pinv(rows[:, :3]) @ (sun.direction - rows[:, 3])
        way[height, 2 * n:2 * n + 2] = toward / max(np.linalg.norm(toward), 1e-30)
    channels = []
    for kind, number in reader.sources:
        if kind == "way":
            channels.append(way)
            continue
        if kind != "sky":
            raise trees.Unknown("Attribute")
        picture, rows, sun = reader.skies[number]
        look = way.reshape(-1, 3) @ rows[:, :3].T + rows[:, 3]
        look /= np.maximum(np.linalg.norm(look, axis=1, keepdims=True), 1e-30)
        color = looked_up(picture, look).reshape(way.shape)
        if sun is not None:
            color[height, 2 * shining.index(number)] += sun.color / _fills(sun)
        channels.append(color)
    emission = _run(program, reader.build.pool, way, channels)
    found = tuple(suns.Sun(way[height, 2 * n], np.maximum(
        emission[height, 2 * n] - emission[height, 2 * n + 1], 0).astype(np.float64) * _fills(reader.skies[k][2]),
        reader.skies[k][2].width) for n, k in enumerate(shining))
    return Sky(pictures=((emission[:height], np.eye(3)),), suns=found)


def _fills(sun):
    """Its solid angle."""
    return 2 * np.pi * (1 - np.cos(max(sun.width, 1e-4) / 2))


def _run(program, pool, way, channels):
    """What a program gives (height, width, 3) of ways to look."""
    shape = way.shape[:2]
    maps = {"object": np.ones(shape, np.float32), "material": np.zeros(shape, np.float32),
            "depth": np.ones(shape, np.float32), "normal": (-way).astype(np.float32)}
    if channels:
        maps["attributes"] = np.concatenate(channels, 2).astype(np.float32)
    given = Materials([program], pool.textures, np.array(pool.constants, np.float32), np.zeros((2, 18), np.float32))
    work = library.load().material_work(given, maps, np.eye(4), np.diag([1.0, 1, -1, 1]),
                                        Frame(shape[1], shape[0]), ("emission",))
    return library.load().run(work, 0, 1, None)["emission"]
