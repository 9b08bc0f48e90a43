# SPDX-License-Identifier: GPL-3.0-or-later
"""The same scene by Cycles and by Encre alone, materials of many nodes in it."""

import os
import resource
from pathlib import Path

import bmesh
import bpy
import numpy as np
from encre.blender import attributes, versions
from encre.blender import hair as strands
from encre.blender.engine import pass_names
from encre.blender.properties import PASSES
from encre.pen import library
from encre.pen.tangents import tangents
from mathutils import Vector
from studio import cube, exr, fact, link, multilayer, plane, shoot, sphere, stage


def _matt(name, make):
    """A diffuse material whose colour is what make(tree) gives."""
    mat = bpy.data.materials.new(name)
    mat.use_nodes = True
    tree = mat.node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    surface = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(make(tree), surface.inputs["Color"])
    tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return mat


def _new(tree, kind, **inputs):
    made = tree.nodes.new("ShaderNode" + kind)
    for name, value in inputs.items():
        made.inputs[name.replace("_", " ")].default_value = value
    return made


def _picture(tree):
    """A picture that is turned and stretched, by UV."""
    image = bpy.data.images.new("Picture", 16, 8)
    rng = np.random.default_rng(1)
    pixels = np.ones((8, 16, 4), np.float32)
    pixels[..., :3] = rng.random((4, 8, 3)).repeat(2, 0).repeat(2, 1)
    image.pixels.foreach_set(pixels.ravel())
    where, mapping, texture = _new(tree, "TexCoord"), _new(tree, "Mapping"), _new(tree, "TexImage")
    mapping.inputs["Scale"].default_value, mapping.inputs["Rotation"].default_value = (0.6, 0.5, 1), (0, 0, 0.4)
    texture.image = image
    tree.links.new(where.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    return texture.outputs["Color"]


def _checks(tree):
    """Checks of two colours, by way of hue, a curve, contrast and a share of the opposite. By position: Blender 5 has
    other names for some."""
    checker = _new(tree, "TexChecker", Scale=4.0, Color1=(0.7, 0.2, 0.1, 1), Color2=(0.1, 0.4, 0.6, 1))
    turned = _new(tree, "HueSaturation", Hue=0.6, Saturation=0.8, Value=0.9)
    curve, bright, opposite = _new(tree, "RGBCurve"), _new(tree, "BrightContrast"), _new(tree, "Invert")
    curve.mapping.curves[0].points.new(0.5, 0.7)
    curve.mapping.update()
    bright.inputs[1].default_value, bright.inputs[2].default_value = 0.05, 0.1
    opposite.inputs[0].default_value = 0.2
    tree.links.new(checker.outputs["Color"], turned.inputs["Color"])
    tree.links.new(turned.outputs[0], curve.inputs["Color"])
    tree.links.new(curve.outputs[0], bright.inputs["Color"])
    tree.links.new(bright.outputs[0], opposite.inputs["Color"])
    return opposite.outputs[0]


def _ramp(tree):
    """A ramp along the object's own z."""
    where, apart, ramp = _new(tree, "TexCoord"), _new(tree, "SeparateXYZ"), _new(tree, "ValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.1, 0.1, 0.5, 1), (0.9, 0.8, 0.2, 1)
    tree.links.new(where.outputs["Object"], apart.inputs[0])
    tree.links.new(apart.outputs["Z"], ramp.inputs[0])
    return ramp.outputs["Color"]


def _waves(tree):
    """Bands of waves that noise bends, times rings of each other profile."""
    made = []
    for kind, along, profile, distortion in (("BANDS", "X", "SIN", 3.0), ("BANDS", "DIAGONAL", "TRI", 0.0),
                                             ("RINGS", "Z", "SAW", 0.0), ("RINGS", "SPHERICAL", "TRI", 1.0)):
        wave = _new(tree, "TexWave", Scale=0.3, Distortion=distortion, Detail_Scale=1.5, Phase_Offset=0.4)
        wave.wave_type, wave.wave_profile = kind, profile
        wave.bands_direction = along if kind == "BANDS" else "Y"
        wave.rings_direction = along if kind == "RINGS" else "Y"
        made.append(wave)
    sums = made[0].outputs["Fac"]
    for wave in made[1:]:
        add = _new(tree, "Math")
        tree.links.new(sums, add.inputs[0])
        tree.links.new(wave.outputs["Color"], add.inputs[1])
        sums = add.outputs[0]
    part = _new(tree, "Math")
    part.operation, part.inputs[1].default_value = "MULTIPLY", 0.25
    tree.links.new(sums, part.inputs[0])
    return part.outputs[0]


def _painted(tree):
    """A colour attribute, darkened."""
    attribute, gamma = _new(tree, "VertexColor"), _new(tree, "Gamma", Gamma=1.5)
    attribute.layer_name = "Paint"
    tree.links.new(attribute.outputs["Color"], gamma.inputs["Color"])
    return gamma.outputs["Color"]


def _leaf(tree):
    return _new(tree, "RGB").outputs[0]


def _cut(mat):
    """Cuts a disc out of the UV square."""
    tree = mat.node_tree
    where, away, far, inside, mix, clear = (_new(tree, kind) for kind in (
        "TexCoord", "VectorMath", "VectorMath", "Math", "MixShader", "BsdfTransparent"))
    away.operation, away.inputs[1].default_value, far.operation = "SUBTRACT", (0.5, 0.5, 0), "LENGTH"
    inside.operation, inside.inputs[1].default_value = "LESS_THAN", 0.4
    surface = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
    for out, into in ((where.outputs["UV"], away.inputs[0]), (away.outputs[0], far.inputs[0]),
                      (far.outputs["Value"], inside.inputs[0]), (inside.outputs[0], mix.inputs[0]),
                      (clear.outputs[0], mix.inputs[1]), (surface.outputs[0], mix.inputs[2]),
                      (mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])):
        tree.links.new(out, into)
    return mat


def _square(obj):
    layer = obj.data.uv_layers.new()
    for loop, corner in zip(obj.data.loops, layer.data, strict=True):
        corner.uv = [0.5 + 0.5 * np.sign(x) for x in obj.data.vertices[loop.vertex_index].co[:2]]


def _scene():
    scene = stage(ground=False, samples=16)
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    _square(cube("Cube", (-1.4, 0, 0), 1.2, _matt("Picture", _picture)))
    sphere("Ball", (1.4, 0.3, 0.2), _matt("Ramp", _ramp))
    plane("Wall", _matt("Waves", _waves), 4.0, 0.0).location = (0, 2.5, 0)
    bpy.data.objects["Wall"].rotation_euler = (1.4, 0, 0)
    cube("Checks", (0, 1.0, 0.3), 1.1, _matt("Checks", _checks))
    painted = plane("Ground", _matt("Painted", _painted))
    colors = painted.data.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    colors.data.foreach_set("color", np.random.default_rng(2).random(16).astype(np.float32))
    card = plane("Card", _cut(_matt("Leaf", _leaf)), 1.6, 0.0)
    card.location, card.rotation_euler = (0, -1.0, 0.2), (1.2, 0.2, 0.3)
    _square(card)
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.size, text.extrude = "a", 0.8, 0.05
    link("Text", text, (-0.6, -1.2, 0.6), _matt("Plain", _leaf)).rotation_euler = (1.4, 0, 0)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BOX", 0.01, 0
    scene.cycles.transparent_max_bounces = 8
    scene.encre.save_layers, scene.encre.light_source = "ON", "DRAWN"
    return scene


def layer_sources(out):
    """By both; then ours in part, with a border of its own, larger, and with nothing behind."""
    scene = _scene()
    shoot(out, "cycles")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "encre")
    shoot(out, "again")
    render = scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.3, 0.9
    render.use_crop_to_border = True
    shoot(out, "border")
    render.use_border = False
    scene.encre.supersample = 2
    shoot(out, "large")
    scene.encre.supersample = 1
    render.film_transparent = True
    shoot(out, "transparent")


def toned(out):
    """Tones before a black sky, with a flat mirror and without lines in it: by layers that the file keeps."""
    scene = stage(ground=False)
    from encre.blender import properties
    from encre.pen import presets

    for id_, value in presets.find("manga").values.items():
        properties.set_value(scene.encre, id_, value)
    silver = bpy.data.materials.new("Silver")
    silver.use_nodes = True
    shine = _new(silver.node_tree, "BsdfGlossy", Roughness=0.0)
    silver.node_tree.links.new(shine.outputs[0], silver.node_tree.nodes["Material Output"].inputs["Surface"])
    scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "ON"
    shoot(out, "bare")
    plane("Mirror", silver, 1.0, 0.0).location = (0, -0.8, 0.3)
    bpy.data.objects["Mirror"].rotation_euler = (1.6, 0.05, 0.3)
    for weight in (1.0, 0.0):
        scene.encre.line_mirror_strength = weight
        shoot(out, f"seen {weight:.0f}")


def named(out):
    """Things that have the same material, whose colour is the thing's random number; the last one is an instance."""
    scene = stage(64, 16, 1, ground=False)
    for name in ("Cube", "Ball"):
        bpy.data.objects.remove(bpy.data.objects[name])
    material = _matt("By thing", lambda tree: _new(tree, "ObjectInfo").outputs["Random"])
    names = "Cube", "Cube.001", "\u6a39 a", "Of a collection"
    for k, name in enumerate(names):
        cube(name, (k - 1.5, 0, 0), 0.9, material)
    placed, collection = bpy.data.objects.new("Placed", None), bpy.data.collections.new("Collection")
    collection.objects.link(bpy.data.objects[names[-1]])
    scene.collection.objects.unlink(bpy.data.objects[names[-1]])
    placed.instance_type, placed.instance_collection = "COLLECTION", collection
    scene.collection.objects.link(placed)
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 4.0
    camera.location, camera.rotation_euler = (0, 0, 5), (0, 0, 0)
    scene.encre.save_layers = "ON"
    shoot(out, "cycles")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "encre")


def many(_out):
    """Small renders one after the other, by both in turn: bytes that the process holds."""
    scene, count, held = stage(48, 27, 1), int(os.environ.get("ENCRE_RENDERS", 50)), []
    page = resource.getpagesize()
    for k in range(count):
        scene.encre.layer_source = ("CYCLES", "ENCRE")[k % 2]
        scene.encre.line_thickness = 20 + k % 7
        bpy.ops.render.render()
        held.append(int(Path("/proc/self/statm").read_text().split()[1]) * page)
    fact("held", held)
    fact("resting", len(library.load()._resting))
    fact("readers", _readers(scene))


def _readers(scene):
    """Names of the passes that a frame by Encre alone has, by who reads them."""
    layer, found, image = scene.view_layers[0], {}, scene.render.image_settings
    scene.encre.layer_source, scene.encre.save_layers, image.file_format = "ENCRE", "OFF", "PNG"
    layer.use_pass_normal = True
    for switch in PASSES:
        setattr(layer.encre, switch, False)

    def note(reader):
        found[reader] = [*pass_names(layer)]

    note("nobody")
    layer.encre.use_pass_lines = True
    note("lines")
    scene.encre.save_layers = "ON"
    note("kept")
    scene.encre.save_layers = "OFF"
    multilayer(image)
    note("file")
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
    image.file_format = "PNG"
    if hasattr(scene, "compositing_node_group"):
        scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
    else:
        scene.use_nodes = True
    note("nodes")
    return found


def what_only_cycles_can_show(out):
    """A node that can't be read, pictures that move, and no lamp."""
    scene = stage()
    for name, source in (("Green", "SEQUENCE"), ("Grey", "MOVIE")):
        tree = bpy.data.materials[name].node_tree
        texture = _new(tree, "TexImage")
        texture.image = bpy.data.images.new(name, 4, 4)
        texture.image.source = source
        tree.links.new(texture.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    world = bpy.data.worlds.new("Sky")
    scene.world, world.use_nodes = world, True
    texture = _new(world.node_tree, "TexEnvironment")
    texture.image = bpy.data.images["Green"]
    world.node_tree.links.new(texture.outputs[0], world.node_tree.nodes["Background"].inputs["Color"])
    bpy.data.objects.remove(bpy.data.objects["Sun"])
    mat = bpy.data.materials["Red"]
    mat.diffuse_color = (0.2, 0.3, 0.4, 1)
    sky = _new(mat.node_tree, "Wavelength")
    mat.node_tree.links.new(sky.outputs[0], mat.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    scene.encre.layer_source = "ENCRE"
    shoot(out, "unknown")


def atlas(out):
    """A turned box that shows of an image just what its alpha leaves, in cells cut along its faces; the same with one
    face upon the empty part; and without alpha."""
    scene = stage()
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(0, -1, 0.8), rotation=(0.3, 0.2, 0.5))
    box = bpy.context.object
    places = box.data.uv_layers[0].data
    alpha = np.zeros((256, 256), np.float32)
    for face in box.data.polygons:
        corners = np.array([places[k].uv for k in face.loop_indices]) * 256
        (left, low), (right, high) = corners.min(0).round().astype(int), corners.max(0).round().astype(int)
        alpha[low:high, left:right] = 1
    image = bpy.data.images.new("Atlas", 256, 256, alpha=True)
    image.pixels.foreach_set(np.dstack([np.full((256, 256, 3), 0.6, np.float32), alpha]).ravel())
    mat = bpy.data.materials.new("Atlas")
    mat.use_nodes, mat.blend_method = True, "HASHED"
    tree = mat.node_tree
    texture, shader = _new(tree, "TexImage"), tree.nodes["Principled BSDF"]
    texture.image = image
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
    box.data.materials.append(mat)
    scene.encre.layer_source, scene.encre.line_color_strength = "ENCRE", 0
    shoot(out, "cut")
    seen = max(box.data.polygons, key=lambda face: -(box.matrix_world.to_3x3() @ face.normal).y)
    before = [places[k].uv.copy() for k in seen.loop_indices]
    for k in seen.loop_indices:
        places[k].uv = places[k].uv * 0.1
    shoot(out, "open")
    for k, uv in zip(seen.loop_indices, before, strict=True):
        places[k].uv = uv
    tree.links.remove(shader.inputs["Alpha"].links[0])
    shoot(out, "plain")


def photograph_behind(out):
    """Things before a world that is an image of many colors, as flat shapes and as it is."""
    scene = stage()
    image = bpy.data.images.new("Photograph", 256, 128, float_buffer=True)
    y, x = np.mgrid[:128, :256]
    color = np.where((y > 60)[..., None], (0.2, 0.4, 0.9), (0.3, 0.25, 0.1))
    color = color * (0.95 + 0.1 * (x * 7 + y * 5) % 2)[..., None]
    image.pixels.foreach_set(np.dstack([color, np.ones(color.shape[:2])]).astype(np.float32).ravel())
    world = bpy.data.worlds.new("Sky")
    scene.world, world.use_nodes = world, True
    texture = _new(world.node_tree, "TexEnvironment")
    texture.image = image
    world.node_tree.links.new(texture.outputs[0], world.node_tree.nodes["Background"].inputs["Color"])
    scene.encre.layer_source = "ENCRE"
    for name, most in ("flat", 16), ("whole", 0):
        scene.encre.sky_colors = most
        shoot(out, name)
    scene.encre.layer_source, scene.encre.light_denoise = "CYCLES", "NONE"
    scene.encre.use_shading, scene.encre.other_light, scene.encre.other_background = True, 1, 0.5
    render = scene.render
    for name, most in ("whole by Cycles", 0), ("flat by Cycles", 16):
        scene.encre.sky_colors = most
        shoot(out, name)
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.5, 1, 0.5, 1
    shoot(out, "part by Cycles")
    render.use_border, render.film_transparent = False, True
    shoot(out, "film")
    render.film_transparent = False
    render.use_persistent_data = True
    for source in "CYCLES", "ENCRE":
        scene.encre.layer_source = source
        scene.encre.keyframe_insert("layer_source", frame=1 + (source == "ENCRE"))
    scene.frame_start, scene.frame_end = 1, 2
    exr(scene, os.path.join(out, "turn_#"))
    bpy.ops.render.render(animation=True)
    scene.animation_data_clear()
    scene.encre.layer_source, render.use_persistent_data = "CYCLES", False
    bpy.data.objects["Cube"].is_holdout = True
    shoot(out, "hole")
    fact("film", [render.film_transparent, render.use_border])


def facets(out):
    """A tube of sixteen flat sides: as it is, lit as one smooth surface, and shaded smoothly."""
    scene = stage()
    shape, mesh = bmesh.new(), bpy.data.meshes.new("Tube")
    bmesh.ops.create_cone(shape, cap_ends=False, segments=16, radius1=0.8, radius2=0.8, depth=2)
    shape.to_mesh(mesh)
    shape.free()
    tube = link("Tube", mesh)
    tube.location = (0, 0, 1)
    scene.encre.layer_source = "ENCRE"
    shoot(out, "flat")
    scene.encre.facet_angle = 35
    shoot(out, "smoothed")
    mesh.polygons.foreach_set("use_smooth", [True] * 16)
    scene.encre.facet_angle = 0
    shoot(out, "smooth")


def flat_mirror(out):
    """A mirror behind the things, by both, and as one of glass, which reflects nothing but the sky."""
    scene = stage(samples=16)
    for mat in bpy.data.materials:
        nodes = mat.node_tree.nodes
        surface = _new(mat.node_tree, "BsdfDiffuse", Color=nodes["Principled BSDF"].inputs["Base Color"].default_value)
        mat.node_tree.links.new(surface.outputs[0], nodes["Material Output"].inputs["Surface"])
    silver = bpy.data.materials.new("Silver")
    silver.use_nodes = True
    tree = silver.node_tree
    shine = _new(tree, "BsdfGlossy", Roughness=0.0, Color=(0.9, 0.8, 0.9, 1))
    tree.links.new(shine.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    plane("Mirror", silver, 4.0, 0.0).location = (0, 1.5, 1)
    bpy.data.objects["Mirror"].rotation_euler = (1.6, 0.05, 0.3)
    scene.cycles.max_bounces, scene.cycles.filter_width, scene.cycles.pixel_filter_type = 1, 0.01, "BOX"
    scene.encre.save_layers, scene.encre.light_source = "ON", "DRAWN"
    shoot(out, "cycles")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "encre")
    glass = _new(tree, "BsdfGlass", Roughness=0.0)
    tree.links.new(glass.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    shoot(out, "glass")


def what_is_not_shown(out):
    """A bump by what is unknown in a group, displacement, fog, a volume and a bump that nothing reads; a volume
    that is unseen; and a ball that Cycles divides."""
    scene = stage()
    tree = bpy.data.materials["Red"].node_tree
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = inner = bpy.data.node_groups.new("Rough", "ShaderNodeTree")
    kinds = ("Shader", "SHADER")
    if hasattr(inner, "interface"):
        inner.interface.new_socket(kinds[0], in_out="OUTPUT", socket_type="NodeSocketShader")
    else:
        inner.outputs.new("NodeSocketShader", kinds[0])
    bump, surface = _new(inner, "Bump"), _new(inner, "BsdfDiffuse")
    inner.links.new(_new(inner, "Wavelength").outputs[0], bump.inputs["Height"])  # which only Cycles knows
    inner.links.new(bump.outputs[0], surface.inputs["Normal"])
    inner.links.new(surface.outputs[0], inner.nodes.new("NodeGroupOutput").inputs[0])
    end = tree.nodes["Material Output"]
    tree.links.new(group.outputs[0], end.inputs["Surface"])
    tree.links.new(_new(tree, "Displacement").outputs[0], end.inputs["Displacement"])
    tree.links.new(_new(tree, "VolumeScatter").outputs[0], end.inputs["Volume"])
    idle = bpy.data.materials["Grey"].node_tree  # a bump that nothing reads
    idle.links.new(_new(idle, "Bump").outputs[0], _new(idle, "BsdfDiffuse").inputs["Normal"])
    for name, seen in (("Fog", True), ("Hidden", False)):
        fog = link(name, bpy.data.volumes.new(name))
        fog.visible_camera = seen
    ball = bpy.data.objects["Ball"]
    divided = ball.modifiers.new("Divided", "SUBSURF")
    scene.cycles.feature_set = "EXPERIMENTAL"
    owner = divided if hasattr(divided, "use_adaptive_subdivision") else ball.cycles
    owner.use_adaptive_subdivision = True
    scene.encre.layer_source = "ENCRE"
    shoot(out, "less")


def hair(out):
    """Particle hair with children, of the second slot, on a ball that is moved and scaled, and instanced; hair curves;
    by both. Then bald."""
    scene = stage(480, 270, 8)
    cube_, ball = (bpy.data.objects[name] for name in ("Cube", "Ball"))
    bpy.data.objects.remove(cube_)
    ball.scale, ball.encre.line_group = (0.7, 0.7, 0.9), "Balls"
    ball.data.materials.append(bpy.data.materials["Red"])
    ball.modifiers.new("Hair", "PARTICLE_SYSTEM")
    system = ball.particle_systems[0]
    particles, system.seed = system.settings, 1
    particles.type, particles.count, particles.hair_length, particles.render_step = "HAIR", 30, 0.7, 2
    particles.child_type, particles.rendered_child_count = "SIMPLE", 5
    particles.radius_scale, particles.root_radius, particles.tip_radius, particles.shape = 0.08, 0.9, 0.3, 0.3
    particles.use_close_tip, particles.material = False, 2
    bpy.ops.object.curves_random_add()
    curves = bpy.context.object
    curves.name, curves.location, curves.scale = "Curves", (-1.6, 0, -0.4), (0.7, 0.7, 0.7)
    curves.data.materials.append(bpy.data.materials["Red"])
    count, steps = len(curves.data.curves), curves.data.curves[0].points_length
    way, t = np.random.default_rng(1).normal(size=(count, 1, 3)), np.linspace(0, 1, steps)[:, None]
    points = way / np.linalg.norm(way, axis=2, keepdims=True) * (0.5 + t) - np.array([0, 0, 0.7]) * t ** 2
    curves.data.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    thick = np.tile(0.04 * (1 - t), count).T.astype(np.float32)
    curves.data.attributes["radius"].data.foreach_set("value", thick.ravel())
    placed, collection = bpy.data.objects.new("Placed", None), bpy.data.collections.new("Collection")
    collection.objects.link(ball)
    placed.instance_type, placed.instance_collection, placed.location = "COLLECTION", collection, (-0.9, 2, 0.6)
    scene.collection.objects.link(placed)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BOX", 0.01, 0
    scene.encre.save_layers = "ON"
    shoot(out, "cycles")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "encre")
    ball.modifiers["Hair"].show_render = False
    shoot(out, "bald")
    counts = np.array([1, 2, 5, 1, 3])  # a point alone is no strand, nor are two in one place
    first, points = np.cumsum(counts) - counts, np.zeros((12, 3), np.float32)
    points[:, 0], points[1:3, 0] = [k for count in counts for k in range(count)], 7
    made = strands.tubes(points, np.full(12, 0.1, np.float32), first, counts)
    fact("along", made.points[made.corners][..., 0].tolist())
    fact("across", np.linalg.norm(made.points[made.corners][..., 1:], axis=2).tolist())


def highlights(out):
    """Balls of metal, plastic and varnish, three of each, by both, with each kind of lamp in turn."""
    scene = stage(240, 150, 24, ground=False)
    for name in ("Cube", "Ball", "Sun"):
        bpy.data.objects.remove(bpy.data.objects[name])
    for row, kind in enumerate(("Metal", "Plastic", "Varnish")):
        for column, rough in enumerate((0.2, 0.4, 0.6)):
            mat = bpy.data.materials.new(kind)
            mat.use_nodes = True
            inputs = mat.node_tree.nodes["Principled BSDF"].inputs
            inputs["Base Color"].default_value = (0.6, 0.4, 0.2, 1)
            inputs["Metallic"].default_value = kind == "Metal"
            inputs["Roughness"].default_value = 0.7 if kind == "Varnish" else rough
            coat = "Coat" if "Coat Weight" in inputs else "Clearcoat"
            inputs["Coat Weight" if coat == "Coat" else coat].default_value = kind == "Varnish"
            inputs[coat + " Roughness"].default_value = rough
            ball = sphere(kind, (1.6 * (column - 1), 0, 1.6 * (1 - row)), mat)
            ball.modifiers.new("Fine", "SUBSURF").render_levels = 2
            ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    fact("clearcoat", coat == "Clearcoat")
    scene.camera.location, scene.camera.rotation_euler = (0, -14, 0), (np.pi / 2, 0, 0)
    scene.camera.data.lens = 75
    scene.cycles.max_bounces, scene.cycles.pixel_filter_type, scene.cycles.filter_width = 0, "BOX", 1
    scene.encre.save_layers = "ON"
    for kind, energy in (("SUN", 3), ("POINT", 1500), ("SPOT", 1500), ("AREA", 800)):
        data = bpy.data.lights.new(kind, kind)
        data.energy = energy
        lamp = link(kind, data, (3, -7, 4))
        lamp.rotation_euler = Vector((-3, 7, -4)).to_track_quat("-Z", "Y").to_euler()
        if kind == "SUN":
            data.angle = 0.1
        elif kind == "AREA":
            data.shape, data.size, data.size_y = "RECTANGLE", 3, 0.8
        else:
            data.shadow_soft_size = 0.4
        for source in ("CYCLES", "ENCRE"):
            scene.encre.layer_source = source
            shoot(out, f"{kind} {source}")
        bpy.data.objects.remove(lamp)


def normal_maps(out):
    """A map of waves on a ball, its mirror image, a cube that is turned and also shines without it and a tile of six
    corners, by both; and without it."""
    scene = stage(240, 120, 48)
    mesh = bpy.data.meshes.new("Tile")
    rim = [(0.6 * np.cos(k * np.pi / 3), y, 0.6 * np.sin(k * np.pi / 3)) for y in (-0.1, 0.1) for k in range(6)]
    mesh.from_pydata(rim, [], [tuple(range(6)), (11, 10, 9, 8, 7, 6),
                               *((k, k + 6, (k + 1) % 6 + 6, (k + 1) % 6) for k in range(6))])
    link("Tile", mesh, (-2.2, 0, 0.2), bpy.data.materials["Green"])
    n = 64
    x, y = np.meshgrid(np.arange(n) * 8 * np.pi / n, np.arange(n) * 8 * np.pi / n)
    steep = np.stack([0.5 * np.sin(x) * np.cos(y), 0.5 * np.cos(x) * np.sin(y), np.ones((n, n))], 2)
    pixels = np.ones((n, n, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.5 * steep / np.linalg.norm(steep, axis=2, keepdims=True)
    image = bpy.data.images.new("Waves", n, n, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.ravel())
    for name, strength in (("Red", 0.7), ("Green", 1.0), ("Grey", 1.0)):
        tree = bpy.data.materials[name].node_tree
        texture, turn, surface = _new(tree, "TexImage"), _new(tree, "NormalMap", Strength=strength), _new(
            tree, "BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1))
        texture.image = image
        tree.links.new(texture.outputs["Color"], turn.inputs["Color"])
        tree.links.new(turn.outputs[0], surface.inputs["Normal"])
        if name == "Red":  # what shines only is as the mesh is
            mixed, shine = _new(tree, "MixShader"), _new(tree, "BsdfGlossy")
            for k, part in enumerate((surface, shine)):
                tree.links.new(part.outputs[0], mixed.inputs[1 + k])
            surface = mixed
        tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    for name in ("Cube", "Ball", "Ground", "Tile"):
        mesh = bpy.data.objects[name].data
        points, corners = np.empty(3 * len(mesh.vertices), np.float32), np.empty(len(mesh.loops), np.int32)
        mesh.vertices.foreach_get("co", points)
        mesh.loops.foreach_get("vertex_index", corners)
        place = points.reshape(-1, 3)[corners]
        mesh.uv_layers.new().data.foreach_set("uv", np.stack([place[:, 0] + 0.3 * place[:, 1],
                                                              place[:, 2] + 0.3 * place[:, 1]], 1).ravel())
    bpy.data.objects["Cube"].rotation_euler = (0, 0, 0.6)
    ball = bpy.data.objects["Ball"]
    ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    link("Mirrored", ball.data, (0.2, -1.5, 0.2)).scale = (-0.6, 0.6, 0.6)
    fact("tangents", _tangents_apart(ball.data.copy()))
    scene.cycles.max_bounces = 0
    scene.encre.save_layers = "ON"
    shoot(out, "cycles")
    scene.encre.layer_source = "ENCRE"
    shoot(out, "encre")
    for mat in bpy.data.materials:
        for turn in [node for node in mat.node_tree.nodes if node.bl_idname == "ShaderNodeNormalMap"]:
            turn.inputs["Strength"].default_value = 0
    shoot(out, "flat")
    _print_on(bpy.data.objects["Tile"])
    look = scene.encre
    look.edge_detector, look.color_layer, look.use_lines, look.line_color_strength = "FINE", "ALBEDO", True, 1.0
    look.line_outline_strength = look.line_inner_strength = look.line_crease_strength = 0.0
    shoot(out, "printed")
    look.line_color_strength = 0.0
    shoot(out, "unprinted")


def _print_on(obj):
    """Gives it a picture whose colors are turned, and the others normal maps again, which read more of meshes."""
    for mat in bpy.data.materials:
        for turn in [node for node in mat.node_tree.nodes if node.bl_idname == "ShaderNodeNormalMap"]:
            turn.inputs["Strength"].default_value = 1
    mat = bpy.data.materials.new("Print")
    mat.use_nodes = True
    tree = mat.node_tree
    turned = _new(tree, "HueSaturation", Saturation=0.9)
    tree.links.new(_picture(tree), turned.inputs["Color"])
    tree.links.new(turned.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    obj.data.materials[0] = mat


def _tangents_apart(mesh):
    """(how many tangents, on how many sides of the map; how far pen.tangents is from Blender's own, at most)."""
    shape = bmesh.new()
    shape.from_mesh(mesh)
    bmesh.ops.triangulate(shape, faces=shape.faces)
    shape.to_mesh(mesh)
    loops = np.arange(len(mesh.loops)).reshape(-1, 3)
    corners = attributes.get(mesh.loops, "vertex_index", np.int32)[loops]
    points = attributes.get(mesh.vertices, "co", np.float32, 3)[corners]
    normals = versions.corner_normals(mesh)[loops]
    along, mirrored = tangents(points, normals, attributes.get(mesh.uv_layers[0].data, "uv", np.float32, 2)[loops],
                               corners)
    mesh.calc_tangents()
    theirs, sign = (attributes.get(mesh.loops, name, np.float32, width)[loops] for name, width in
                    (("tangent", 3), ("bitangent_sign", 1)))
    told = np.linalg.norm(along, axis=2) > 0.5
    return [int(told.sum()), len(np.unique(sign)), float(abs(along - theirs)[told].max()),
            bool((mirrored[:, None] == (sign < 0))[told].all())]


def noise_in_colours(out):
    """A ground of noise as wide as many pixels, by both."""
    scene = stage(160, 90, 16)
    tree = bpy.data.materials["Grey"].node_tree
    noise, surface = _new(tree, "TexNoise", Scale=6.0, Detail=1.5), _new(tree, "BsdfDiffuse")
    tree.links.new(noise.outputs["Color"], surface.inputs["Color"])
    tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    scene.cycles.max_bounces, scene.encre.save_layers = 0, "ON"
    for source in ("CYCLES", "ENCRE"):
        scene.encre.layer_source = source
        shoot(out, source)
