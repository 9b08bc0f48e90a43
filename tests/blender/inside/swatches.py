# SPDX-License-Identifier: GPL-3.0-or-later
"""Squares of as many materials, by Cycles and by Encre alone, and how far their colours without light are apart."""

import math

import bpy
import numpy as np
from encre.blender import fast, properties, versions
from encre.pen import exr, layers
from encre.pen.job import Frame
from studio import cube, fact, material, shoot, stage

ROW, PIXELS = 8, 8  # squares in a row, pixels of a square
_MARKED = (0.7, 0.6, 0.5, 1)


def empty():
    scene = stage(ROW * PIXELS, ROW * PIXELS, 1, ground=False)
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    scene.world = None
    return scene


def made(name, make):
    """A material whose output's Surface make(tree, output) links."""
    block = bpy.data.materials.new(name)
    block.use_nodes = True
    block.node_tree.nodes.clear()
    make(block.node_tree, block.node_tree.nodes.new("ShaderNodeOutputMaterial"))
    return block


def add(tree, kind, mute=False, **properties_):
    node = tree.nodes.new("ShaderNode" + kind if kind != "NodeReroute" else kind)
    node.mute = mute
    for name, value in properties_.items():
        setattr(node, name, value)
    return node


def shown(make):
    """What make(tree) gives, as the colour of an emission that would else be _MARKED."""
    def whole(tree, output):
        glow = add(tree, "Emission")
        glow.inputs[0].default_value = _MARKED
        tree.links.new(make(tree), glow.inputs[0])
        tree.links.new(glow.outputs[0], output.inputs["Surface"])
    return whole


def lay(blocks, change=None):
    """A square of each; change(number, object)."""
    for k, block in enumerate(blocks):
        mesh = bpy.data.meshes.new(block.name)
        mesh.from_pydata([(-.5, -.5, 0), (.5, -.5, 0), (.5, .5, 0), (-.5, .5, 0)], [], [(0, 1, 2, 3)])
        for loop, uv in zip(mesh.uv_layers.new(name="UVMap").data, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
            loop.uv = uv
        mesh.materials.append(block)
        square = bpy.data.objects.new(block.name, mesh)
        square.location = k % ROW, -(k // ROW), 0
        bpy.context.scene.collection.objects.link(square)
        if change:
            change(k, square)


def _middles(picture, count, grid):
    row, pixels = grid
    half = pixels // 2
    return np.array([picture[k // row * pixels + half, k % row * pixels + half] for k in range(count)])


def look(row=ROW):
    """A camera before `row` rows of squares."""
    scene, camera = bpy.context.scene, bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", row
    eye = bpy.data.objects.new("Camera", camera)
    eye.location = (row - 1) / 2, -(row - 1) / 2, 5
    scene.collection.objects.link(eye)
    scene.camera = eye


def by_cycles(out, name, count, samples=1, grid=(ROW, PIXELS)):
    """(colour without light (count, 3), how opaque it is (count,)). grid: squares in a row, pixels of one."""
    scene = bpy.context.scene
    cycles, layer = scene.cycles, scene.view_layers[0]
    scene.render.engine, scene.render.film_transparent = "CYCLES", True
    cycles.samples, cycles.max_bounces, cycles.use_denoising = samples, 0, False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 0.01
    for part in ("diffuse_color", "glossy_color", "transmission_color", "emit"):
        setattr(layer, f"use_pass_{part}", True)
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    scene.render.filepath = path = f"{out}/{name}.exr"
    bpy.ops.render.render(write_still=True)
    scene.render.engine = "ENCRE"
    file, found = exr.Exr(path), {}
    for channel in file.channels:
        found.setdefault(layers.classic(channel.split(".")[1]), {})[channel[-1]] = channel
    parts = [[found[part][c] for c in "RGB"] for part in ("DiffCol", "GlossCol", "TransCol", "Emit")]
    read = file.read([channel for three in [*parts, found["Combined"].values()] for channel in three])
    color = sum(np.stack([read[channel] for channel in three], 2) for three in parts)
    return _middles(np.maximum(color, 0), count, grid), _middles(read[found["Combined"]["A"]], count, grid)


def by_encre(count, grid=(ROW, PIXELS)):
    """(colour (count, 3), whether it is there (count,), what is said of the scene)."""
    depsgraph, scene = bpy.context.evaluated_depsgraph_get(), bpy.context.scene
    scene.encre.layer_source = "ENCRE"
    settings = properties.settings(depsgraph.scene_eval)
    camera = scene.camera.evaluated_get(depsgraph)
    width, height = scene.render.resolution_x, scene.render.resolution_y
    read = fast.read(depsgraph, settings, (camera.data.clip_start, camera.data.clip_end), camera=camera)
    view = np.array(camera.matrix_world.normalized().inverted())
    projection = np.array(camera.calc_matrix_camera(depsgraph, x=width, y=height))
    drawn = read.pictures(view, projection, Frame(width, height, 0, 0, 1), (width, height), settings)
    color = drawn["color"] + drawn["gloss"] + drawn["emission"]
    return _middles(color, count, grid), _middles(drawn["object"], count, grid)[:, 0] > 0, "\n".join(read.notes)


def compare(out, name, makes, change=None):
    """Tells by name (by Cycles, by Encre, whether it is said that they differ)."""
    blocks = [made(*item) for item in makes.items()]
    lay(blocks, change)
    look()
    (theirs, alpha), (ours, there, said) = by_cycles(out, name, len(blocks)), by_encre(len(blocks))
    for k, label in enumerate(makes):
        fact(label, [theirs[k].tolist(), ours[k].tolist(), float(alpha[k]), bool(there[k]), f"{label} (" in said])


# What may be linked to what

def _rgb(tree):
    node = add(tree, "RGB")
    node.outputs[0].default_value = (0.2, 0.5, 0.8, 1)
    return node.outputs[0]


def _value(tree):
    node = add(tree, "Value")
    node.outputs[0].default_value = 0.4
    return node.outputs[0]


def _to_surface(source):
    return lambda tree, output: tree.links.new(source(tree), output.inputs["Surface"])


def _through(kind, source=None, into=0, outof=0, **properties_):
    """A node behind what is shown, to whose input a source is linked."""
    def make(tree):
        node = add(tree, kind, **properties_)
        if source:
            tree.links.new(source(tree), node.inputs[into])
        return node.outputs[outof]
    return shown(make)


def _both(kind, first, second):
    """Two shaders mixed or added."""
    def make(tree, output):
        node = add(tree, kind)
        shaders = [socket for socket in node.inputs if socket.type == "SHADER"]
        for socket, source in zip(shaders, (first, second), strict=True):
            tree.links.new(source(tree), socket)
        tree.links.new(node.outputs[0], output.inputs["Surface"])
    return make


def _glow(tree):
    node = add(tree, "Emission")
    node.inputs[0].default_value = _MARKED
    return node.outputs[0]


def _clear(tree):
    return add(tree, "BsdfTransparent").outputs[0]


def looped(tree):
    node = add(tree, "NodeReroute")
    tree.links.new(node.outputs[0], node.inputs[0])
    return node.outputs[0]


def _muted_link(tree, output):
    glow = add(tree, "Emission")
    glow.inputs[0].default_value = _MARKED
    tree.links.new(_rgb(tree), glow.inputs[0]).is_muted = True
    tree.links.new(glow.outputs[0], output.inputs["Surface"])


def _alpha_of(kind):
    """An alpha by what no number is linked to, as drawn light reads it, too."""
    def make(tree, output):
        surface, node = add(tree, "BsdfPrincipled"), add(tree, kind)
        node.inputs["Color"].default_value = (1, 1, 1, 1)
        surface.inputs["Specular" if "Specular" in surface.inputs else "Specular IOR Level"].default_value = 0
        tree.links.new(node.outputs[0], surface.inputs["Alpha"])
        tree.links.new(surface.outputs[0], output.inputs["Surface"])
    return make


def _ramp(mode, interpolation="LINEAR"):
    def make(tree):
        node = add(tree, "ValToRGB")
        node.color_ramp.color_mode, node.color_ramp.interpolation = mode, interpolation
        for stop, color in zip(node.color_ramp.elements, ((0.9, 0.2, 0.1, 1), (0.1, 0.3, 0.8, 1)), strict=True):
            stop.color = color
        tree.links.new(_value(tree), node.inputs[0])
        return node.outputs[0]
    return shown(make)


def _base(source):
    """The colour of a surface beside which something can't be read."""
    def make(tree, output):
        surface = add(tree, "BsdfGlossy" if hasattr(bpy.types, "ShaderNodeBsdfGlossy") else "BsdfAnisotropic")
        tree.links.new(source(tree), surface.inputs["Color"])
        tree.links.new(add(tree, "Tangent").outputs[0], surface.inputs["Roughness"])
        tree.links.new(surface.outputs[0], output.inputs["Surface"])
    return make


def _attribute(name, output="Color", kind="GEOMETRY"):
    return shown(lambda tree: add(tree, "Attribute", attribute_name=name, attribute_type=kind).outputs[output])


_GLOSSY = "BsdfGlossy" if hasattr(bpy.types, "ShaderNodeBsdfGlossy") else "BsdfAnisotropic"


def _metal(kind, rough):
    """Light that goes from facet to facet of a rough metal takes its colour each time."""
    def make(tree, output):
        node = add(tree, kind if hasattr(bpy.types, "ShaderNode" + kind) else _GLOSSY)
        node.inputs[0].default_value, node.inputs["Roughness"].default_value = (0.9, 0.6, 0.2, 1), rough
        tree.links.new(node.outputs[0], output.inputs["Surface"])
    return make


def _combined(tree, mode, values):
    node = add(tree, "CombineColor", mode=mode)
    for socket, value in zip(node.inputs, values, strict=True):
        socket.default_value = value
    return node.outputs[0]


@shown
def _muted_way(tree):
    """A colour through a muted node that puts out a number."""
    node = add(tree, "TexChecker", mute=True)
    tree.links.new(_rgb(tree), node.inputs["Color1"])
    return node.outputs["Fac"]


@shown
def _of_group(tree):
    inside = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    versions.group_socket(inside, "Vector", "Vector")
    versions.group_socket(inside, "Color", "Color", output=True)
    into, end = inside.nodes.new("NodeGroupInput"), inside.nodes.new("NodeGroupOutput")
    pattern = add(inside, "TexGradient")
    inside.links.new(into.outputs[0], pattern.inputs[0])
    inside.links.new(pattern.outputs[0], end.inputs[0])
    return add(tree, "Group", node_tree=inside).outputs[0]


@shown
def _curved(tree):
    node, given = add(tree, "RGBCurve"), add(tree, "RGB")
    node.mapping.curves[3].points[1].location = (1, 0.4)
    given.outputs[0].default_value = (2, 1.5, 0.5, 1)
    tree.links.new(given.outputs[0], node.inputs["Color"])
    return node.outputs[0]


@shown
def _range_of_nothing(tree):
    node = add(tree, "MapRange")
    for socket, value in zip(node.inputs, (0.5, 0.3, 0.3, 0.4, 0.9), strict=False):
        socket.default_value = value
    return node.outputs[0]


@shown
def _between(tree):
    """Bytes are mixed before they are made light."""
    image = bpy.data.images.new("Two", 2, 1)
    image.pixels[:] = [0, 0, 0, 1, 1, 0.8, 0.6, 1]
    image.pack()
    node, at = add(tree, "TexImage", image=image, extension="EXTEND"), add(tree, "CombineXYZ")
    at.inputs[0].default_value = at.inputs[1].default_value = 0.5
    tree.links.new(at.outputs[0], node.inputs[0])
    return node.outputs[0]


def _fog(tree, output):
    tree.links.new(add(tree, "VolumeScatter").outputs[0], output.inputs["Volume"])


LINKS = {
    "colour to surface": _to_surface(_rgb), "number to surface": _to_surface(_value),
    "vector to surface": _to_surface(lambda tree: add(tree, "TexCoord").outputs["UV"]),
    "normal to surface": _to_surface(lambda tree: add(tree, "NewGeometry").outputs["Normal"]),
    "colour to a mix of shaders": _both("MixShader", _rgb, _glow),
    "shader to colour": _through("Gamma", lambda tree: add(tree, "BsdfDiffuse").outputs[0]),
    "nothing": lambda tree, output: None,
    "reroute from nowhere": shown(lambda tree: add(tree, "NodeReroute").outputs[0]),
    "muted link": _muted_link,
    "muted, with a colour": _through("Gamma", _rgb, mute=True), "muted, with nothing": _through("Gamma", mute=True),
    "muted, the second of two": _through("Math", _value, 1, mute=True),
    "muted source": shown(lambda tree: add(tree, "RGB", mute=True).outputs[0]),
    "muted ramp": _through("ValToRGB", _rgb, mute=True),
    "muted shader": _to_surface(lambda tree: add(tree, "Emission", mute=True).outputs[0]),
    "alpha of Invert": _alpha_of("Invert"), "alpha of RGB to BW": _alpha_of("RGBToBW"),
    "alpha of Gamma": _alpha_of("Gamma"),
    "no picture": shown(lambda tree: add(tree, "TexImage").outputs[0]),
    "no picture's alpha": shown(lambda tree: add(tree, "TexImage").outputs["Alpha"]),
    "ramp HSV": _ramp("HSV"), "ramp HSL": _ramp("HSL"),
    "glow over clear": _both("AddShader", _glow, _clear), "half clear": _both("MixShader", _clear, _glow),
    "two glows": _both("AddShader", _glow, _glow), "fog": _fog, "beside what is unknown": _base(_rgb),
    "Fresnel": shown(lambda tree: add(tree, "Fresnel").outputs[0]),
    "Facing": shown(lambda tree: add(tree, "LayerWeight").outputs["Facing"]),
    "Layer Weight": shown(lambda tree: add(tree, "LayerWeight").outputs["Fresnel"]),
    "Backfacing": shown(lambda tree: add(tree, "NewGeometry").outputs["Backfacing"]),
    "Incoming": shown(lambda tree: add(tree, "NewGeometry").outputs["Incoming"]),
    "Camera": shown(lambda tree: add(tree, "TexCoord").outputs["Camera"]),
    "Window": shown(lambda tree: add(tree, "TexCoord").outputs["Window"]),
    "View Distance": _to_surface(lambda tree: add(tree, "CameraData").outputs["View Distance"]),
    "INT8": _attribute("INT8"), "EDGE": _attribute("EDGE"), "no attribute": _attribute("none", "Alpha"),
    "alpha of an attribute": _attribute("Color", "Alpha"), "object's colour": _attribute("color", kind="OBJECT"),
    "property": _attribute("tint", kind="OBJECT"), "property by its path": _attribute('["tint"]', kind="INSTANCER"),
    "alpha of a colour": shown(lambda tree: add(tree, "VertexColor", layer_name="Color").outputs["Alpha"]),
    "metal, rough": _metal("BsdfMetallic", 0.8), "gloss, rough": _metal(_GLOSSY, 1.0),
    "muted, to a number and back": _muted_way, "group's vector from nowhere": _of_group,
    "hue beyond 1": shown(lambda tree: _combined(tree, "HSV", (2.4, 0.8, 0.7))),
    "hue beyond 1, HSL": shown(lambda tree: _combined(tree, "HSL", (2.4, 0.8, 0.7))),
    "curve beyond its end": _curved, "constant ramp of HSV": _ramp("HSV", "CONSTANT"),
    "range of nothing": _range_of_nothing, "picture between texels": _between,
    "map by an attribute": shown(lambda tree: add(tree, "UVMap", uv_map="Vector").outputs[0]),
    "map of the instancer": shown(lambda tree: add(tree, "UVMap", from_instancer=True).outputs[0]),
    "no colour's alpha": shown(lambda tree: add(tree, "VertexColor", layer_name="none").outputs["Alpha"]),
}


def _turned_and_painted(k, square):
    data, label = square.data, list(LINKS)[k]
    for name, kind, domain, value in (("INT8", "INT8", "FACE", 1), ("EDGE", "FLOAT", "EDGE", 0.25)):
        if label == name:
            for item in data.attributes.new(name, kind, domain).data:
                item.value = value
    for item in data.color_attributes.new("Color", "FLOAT_COLOR", "CORNER").data:
        item.color = (0.8, 0.2, 0.9, 0.3)
    for item in data.attributes.new("Vector", "FLOAT_VECTOR", "POINT").data:
        item.vector = (0.3, 0.9, 0.4)
    square.color, square["tint"] = (0.2, 0.9, 0.3, 1), (0.9, 0.8, 0.1)
    if label in ("Fresnel", "Facing", "Layer Weight", "Incoming"):
        square.rotation_euler.x = math.radians(40)
    if label in ("Backfacing", "Layer Weight"):
        square.rotation_euler.y = math.radians(180)


def links(out):
    """Any output to any input, muted nodes and links, what is looked at from aside, and what meshes and things say."""
    empty()
    compare(out, "links", LINKS, _turned_and_painted)


# Instances

def _instances(kind, square, owner):
    """What places a square, as a collection, on points of a mesh, or by Geometry Nodes."""
    if kind == "collection":
        own = bpy.data.collections.new(square.name)
        own.objects.link(square)
        owner.instance_type, owner.instance_collection = "COLLECTION", own
    elif kind == "points":
        bpy.context.scene.collection.objects.link(square)
        square.parent, owner.instance_type = owner, "VERTS"
    else:
        tree = bpy.data.node_groups.new("Placed", "GeometryNodeTree")
        versions.group_socket(tree, "Geometry", "Geometry")
        versions.group_socket(tree, "Geometry", "Geometry", output=True)
        info, end = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("NodeGroupOutput")
        info.inputs[0].default_value, info.inputs["As Instance"].default_value = square, True
        tree.links.new(info.outputs["Geometry"], end.inputs[0])
        owner.modifiers.new("Placed", "NODES").node_group = tree


def placed(out):
    """Squares by each kind of instance, of which the square or what places it is hidden in some way."""
    scene = empty()
    block, labels = made("Glow", _to_surface(_glow)), []
    hidden = bpy.data.collections.new("Indirect")
    scene.collection.children.link(hidden)
    scene.view_layers[0].layer_collection.children["Indirect"].indirect_only = True
    switches = {"": None, "visible_camera": False, "visible_shadow": False, "is_holdout": True,
                "is_shadow_catcher": True, "indirect": None}
    scene.render.use_simplify = scene.cycles.use_distance_cull = True
    scene.cycles.distance_cull_margin = 50
    for kind in ("collection", "points", "nodes"):
        for whose in ("square", "owner"):
            for switch, value in switches.items():
                if (kind, whose, switch) == ("points", "square", "indirect") or (whose, switch) == ("owner", ""):
                    continue
                mesh = bpy.data.meshes.new("Square")
                mesh.from_pydata([(-.4, -.4, 0), (.4, -.4, 0), (.4, .4, 0), (-.4, .4, 0)], [], [(0, 1, 2, 3)])
                mesh.materials.append(block)
                points = bpy.data.meshes.new("Points")
                points.from_pydata([(0, 0, 0)], [], [])
                square = bpy.data.objects.new(f"Square {len(labels)}", mesh)
                owner = bpy.data.objects.new("Owner", None if kind == "collection" else points)
                owner.location = len(labels) % ROW, -(len(labels) // ROW), 0
                (hidden if (whose, switch) == ("owner", "indirect") else scene.collection).objects.link(owner)
                _instances(kind, square, owner)
                if value is not None:
                    setattr(square if whose == "square" else owner, switch, value)
                labels.append(f"{kind} {whose} {switch}")
    for label, far, culls in (("near", 0, True), ("far", 60, True), ("far and kept", 60, False)):
        square = bpy.data.objects.new(label, mesh)
        square.location = len(labels) % ROW, -(len(labels) // ROW), -far
        square.cycles.use_distance_cull = culls
        scene.collection.objects.link(square)
        labels.append(label)
    look()
    fact("alpha", dict(zip(labels, by_cycles(out, "placed", len(labels))[1].tolist(), strict=True)))
    scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
    shoot(out, "ours")


def beside(out):
    """A ball whose nodes leave curves, points, a volume and instances of them beside it, by both."""
    scene = stage(64, 36, 1, ground=False)
    tree = bpy.data.node_groups.new("Beside", "GeometryNodeTree")
    versions.group_socket(tree, "Geometry", "Geometry")
    versions.group_socket(tree, "Geometry", "Geometry", output=True)
    new, link = (lambda kind: tree.nodes.new(kind)), tree.links.new
    into, end, all_ = new("NodeGroupInput"), new("NodeGroupOutput"), new("GeometryNodeJoinGeometry")
    curve, dots, cloud = (new(f"GeometryNode{kind}") for kind in ("CurvePrimitiveCircle", "MeshToPoints",
                                                                   "MeshToVolume"))
    for node in (dots, cloud):
        link(into.outputs[0], node.inputs[0])
    for made_ in (curve, dots, cloud):
        many = new("GeometryNodeInstanceOnPoints")
        link(dots.outputs[0], many.inputs[0])
        link(made_.outputs[0], many.inputs["Instance"])
        for each in (made_, many):
            link(each.outputs[0], all_.inputs[0])
    link(into.outputs[0], all_.inputs[0])
    link(all_.outputs[0], end.inputs[0])
    kinds = {"whole": tree, "without": None}
    for name, group in kinds.items():
        for obj in scene.objects:
            if obj.type == "MESH":
                obj.modifiers.clear()
                if group:
                    obj.modifiers.new("Beside", "NODES").node_group = group
        scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
        fact("failed", shoot(out, name))
    scene.encre.layer_source = "CYCLES"
    bpy.data.objects["Ball"].modifiers.new("Beside", "NODES").node_group = tree
    fact("failed", shoot(out, "by cycles"))


def toon(out):
    """A ball whose colour is the light on it, cut in two by a ramp, as toon materials of EEVEE are."""
    scene = stage(80, 45, 1, ground=False)

    def make(tree, output):
        matt, seen, ramp, glow = (add(tree, kind) for kind in ("BsdfDiffuse", "ShaderToRGB", "ValToRGB", "Emission"))
        matt.inputs[0].default_value, ramp.color_ramp.interpolation = (1, 1, 1, 1), "CONSTANT"
        for stop, at, color in zip(ramp.color_ramp.elements, (0, 0.3), ((0.5, 0.1, 0.1, 1), (1, 0.35, 0.25, 1)),
                                   strict=True):
            stop.position, stop.color = at, color
        for one, other in ((matt, seen), (seen, ramp), (ramp, glow), (glow, output)):
            tree.links.new(one.outputs[0], other.inputs[0])

    ball = bpy.data.objects["Ball"]
    ball.data.materials.clear()
    ball.data.materials.append(made("Toon", make))
    scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
    fact("failed", shoot(out, "toon"))
    scene.encre.layer_source = "CYCLES"
    fact("failed", shoot(out, "toon by cycles"))
    scene.encre.layer_source = "ENCRE"
    for obj in scene.objects:
        obj.location.x += 3e5
    fact("failed", shoot(out, "far"))
    for obj in scene.objects:
        obj.location.x -= 3e5
    ball.data.materials[0] = made("Matt", lambda tree, output: tree.links.new(
        add(tree, "BsdfDiffuse").outputs[0], output.inputs["Surface"]))
    fact("failed", shoot(out, "matt"))


def fog(out):
    """Squares 5, 15 and 25 away in fog that is everywhere, and in a box from 7 to 17 away."""
    for name in ("world", "box"):
        scene = empty()
        lay([made(f"Glow {k}", _to_surface(_glow)) for k in range(3)])
        look()
        for k in range(3):
            bpy.data.objects[f"Glow {k}"].location.z = -10 * k
        world = bpy.data.worlds.new("World")
        scene.world, world.use_nodes = world, True
        back = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
        back.inputs[0].default_value = (0.4, 0.4, 0.4, 1)
        box = made("Fog", _fog)
        tree = world.node_tree if name == "world" else box.node_tree
        if name == "world":
            end = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
            tree.links.new(add(tree, "VolumeScatter").outputs[0], end.inputs["Volume"])
        else:
            obj = cube("Box", (0, 0, 0), 1, box)
            obj.scale, obj.location.z = (40, 40, 10), -7
        scatter = next(node for node in tree.nodes if node.type == "VOLUME_SCATTER")
        scatter.inputs["Color"].default_value, scatter.inputs["Density"].default_value = (1, 1, 1, 1), 0.05
        scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
        fact("failed", shoot(out, name))


def metals(out):
    """A metal that is rough and one that is not, of Principled."""
    scene = empty()

    def metal(rough):
        def make(tree, output):
            node = add(tree, "BsdfPrincipled")
            node.inputs["Base Color"].default_value = (0.6, 0.5, 0.4, 1)
            node.inputs["Metallic"].default_value, node.inputs["Roughness"].default_value = 1, rough
            tree.links.new(node.outputs[0], output.inputs["Surface"])
        return make

    lay([made("Rough", metal(1.0)), made("Smooth", metal(0.3))])
    look()
    scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
    fact("failed", shoot(out, "metals"))


def added_shaders(out):
    """What is not there and adds its light, as light on cloth or on its own, before a black wall."""
    scene = empty()

    def cloth(tree):
        node = add(tree, "BsdfDiffuse")
        node.inputs[0].default_value = (0.3, 0.2, 0.1, 1)
        return node.outputs[0]

    lay([made("Cloth", _both("AddShader", cloth, _clear)), made("Glow", _both("AddShader", _glow, _clear)),
         made("None", _to_surface(_clear))])
    look()
    cube("Wall", (0, 0, -21), 40, material("Black", (0, 0, 0)))
    scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
    fact("failed", shoot(out, "added_shaders"))


# Pictures

def _png(out):
    """A picture that is white and red where it is clear, half clear, and whole."""
    image = bpy.data.images.new("Decal", 4, 4, alpha=True)
    texels = (1, 1, 1, 0), (0.9, 0.4, 0.1, 0.5), (0.9, 0.4, 0.1, 1), (0, 0, 0, 1)
    image.pixels[:] = [x for _ in range(4) for texel in texels for x in texel]
    image.filepath_raw, image.file_format = f"{out}/decal.png", "PNG"
    image.save()
    return image.filepath_raw


def decals(out):
    """A PNG by each way to read its alpha, and in each space of colours, at three of its texels."""
    empty()
    path, makes = _png(out), {}

    def of(place, mode, with_alpha, space="sRGB"):
        image = bpy.data.images.load(path, check_existing=False)
        image.alpha_mode, image.colorspace_settings.name = mode, space

        def make(tree, output):
            node, glow = add(tree, "TexImage", image=image, interpolation="Closest"), add(tree, "Emission")
            at = add(tree, "CombineXYZ")
            at.inputs[0].default_value, at.inputs[1].default_value = (place + 0.5) / 4, 0.5
            tree.links.new(at.outputs[0], node.inputs[0])
            tree.links.new(node.outputs[0], glow.inputs[0])
            if with_alpha:
                tree.links.new(node.outputs[1], glow.inputs[1])
            tree.links.new(glow.outputs[0], output.inputs["Surface"])
        return make

    for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"):
        for with_alpha in (False, True):
            for place in (0, 2) if mode == "PREMUL" else range(3):  # of a PNG there is no such thing: clipped
                makes[f"{mode} {with_alpha} {place}"] = of(place, mode, with_alpha)
    for space in ("Non-Color", "Linear", "Linear Rec.709", "ACEScg", "Filmic sRGB", "AgX Base sRGB", "Rec.1886"):
        try:
            makes[space] = of(2, "NONE", False, space)
        except TypeError:  # which this Blender has not
            continue
    compare(out, "decals", makes)


# Shadows alone

def caught(out):
    """A cube and its shadow on a catcher that a collection places, by both, on a film that shows through and on one
    that does not."""
    scene = empty()
    scene.render.resolution_x, scene.render.resolution_y = 96, 54
    cube("Cube", (0, 0, 1), 1.2, made("Matt", _to_surface(lambda tree: add(tree, "BsdfDiffuse").outputs[0])))
    scene.cycles.max_bounces = 0
    own = bpy.data.collections.new("Ground")
    mesh = bpy.data.meshes.new("Ground")
    mesh.from_pydata([(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)], [], [(0, 1, 2, 3)])
    own.objects.link(bpy.data.objects.new("Ground", mesh))
    owner = bpy.data.objects.new("Owner", None)
    owner.instance_type, owner.instance_collection, owner.is_shadow_catcher = "COLLECTION", own, True
    scene.collection.objects.link(owner)
    world = bpy.data.worlds.new("World")
    scene.world, world.use_nodes = world, True
    back = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    back.inputs[0].default_value = (0.3, 0.4, 0.6, 1)
    lamp = bpy.data.lights.new("Sun", "SUN")
    lamp.energy, lamp.angle = 3, 0
    sun = bpy.data.objects.new("Sun", lamp)
    sun.rotation_euler = (0.5, 0.6, 0)
    eye = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    eye.location, eye.rotation_euler = (0, -7, 4), (math.radians(62), 0, 0)
    for obj in (sun, eye):
        scene.collection.objects.link(obj)
    scene.camera = eye
    for transparent in (True, False):
        scene.render.film_transparent, back.inputs[1].default_value = transparent, 0.05 if transparent else 1
        for source, samples in (("CYCLES", 64), ("ENCRE", 1)):
            scene.encre.layer_source, scene.cycles.samples = source, samples
            fact("failed", shoot(out, f"{source} {transparent}"))
    scene.render.film_transparent, back.inputs[1].default_value = True, 0.05
    bpy.ops.encre.preset(preset="heavy_blacks")
    scene.encre.use_lines = False
    for source in "CYCLES", "ENCRE":
        scene.encre.layer_source = source
        fact("failed", shoot(out, f"{source} inked"))
