# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light beside Cycles' of many samples: both are in one file, as Encre Diffuse and DiffDir."""

from math import pi, radians

import bpy
import numpy as np
from encre.blender import lamps as light
from encre.blender import properties
from encre.pen import irradiance
from encre.pen.scene import Scene
from mathutils import Vector
from studio import cube, exr, fact, link, material, passes_on, plane, register, shoot, sphere, world

LAMPS = {
    "sun": ("SUN", dict(energy=3, angle=0)),
    "wide": ("SUN", dict(energy=3, angle=0.25)),
    "point": ("POINT", dict(energy=400, shadow_soft_size=0)),
    "ball": ("POINT", dict(energy=400, shadow_soft_size=0.5)),
    "spot": ("SPOT", dict(energy=900, shadow_soft_size=0, spot_size=0.9, spot_blend=0.4)),
    "soft": ("SPOT", dict(energy=900, shadow_soft_size=0.3, spot_size=0.9, spot_blend=0.4)),
    "square": ("AREA", dict(energy=300, shape="SQUARE", size=1.2)),
    "rectangle": ("AREA", dict(energy=300, shape="RECTANGLE", size=0.4, size_y=2)),
    "disk": ("AREA", dict(energy=300, shape="DISK", size=1.5, spread=radians(100))),
    "ellipse": ("AREA", dict(energy=300, shape="ELLIPSE", size=0.6, size_y=1.6)),
}
SCALES = {"spot": (1.3, 0.8, 1.1), "square": (1.5, 0.7, 1)}


def _stage(samples):
    """Matt things without bounced light, seen through a filter as narrow as a pixel's centre."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    fact("version", list(bpy.app.version))
    scene = bpy.context.scene
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y = 112, 64
    scene.cycles.samples, scene.cycles.seed, scene.encre.samples = samples, 1, 0
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.max_bounces, scene.cycles.filter_width = 0, 0.01
    scene.cycles.pixel_filter_type = "BOX"
    passes_on(scene.view_layers[0])
    scene.view_layers[0].use_pass_diffuse_direct = True
    scene.encre.light_source = "DRAWN"
    cam = link("Camera", bpy.data.cameras.new("Camera"), (1, -7, 4))
    cam.rotation_euler = (Vector((0, 0, 0)) - cam.location).to_track_quat("-Z", "Y").to_euler()
    scene.camera = cam
    for obj in (plane("Ground", z=0.0), cube("Cube", (-0.9, 0, 0.5), 1.0), sphere("Ball", (1.0, -0.3, 0.75)),
                cube("Small", (0.4, 0.9, 1.4), 0.5)):
        obj.data.materials.append(_matt(obj.name))
    return scene


def _matt(name):
    """A material that throws light evenly to all sides: Principled does not in every version."""
    mat = material(name, (0.7, 0.7, 0.7))
    tree = mat.node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return mat


def _lamp(kind, **settings):
    data = bpy.data.lights.new("Lamp", kind)
    obj = link("Lamp", data, (2.2, -1.0, 3.5))
    obj.rotation_euler = (Vector((0, 0, 0.4)) - obj.location).to_track_quat("-Z", "Y").to_euler()
    for name, value in settings.items():
        setattr(data, name, value)
    return obj


def lamps(out, samples=None):
    """One picture for each kind of lamp, alone; hard lamps need fewer samples."""
    for name, (kind, settings) in LAMPS.items():
        hard = not settings.get("angle", settings.get("shadow_soft_size", settings.get("size")))
        _stage(samples or (16 if hard else 64))
        obj = _lamp(kind, **settings)
        obj.scale = SCALES.get(name, (1, 1, 1))
        shoot(out, name)


def lamps_without_noise(out):
    lamps(out, 1024)


def unlit(out):
    """No lamp, a world that only Cycles can read; then nothing at all is left to draw."""
    scene = _stage(1)
    scene.encre.light_denoise = "NONE"
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    magic = tree.nodes.new("ShaderNodeTexMagic")
    tree.links.new(magic.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    shoot(out, "unlit")


def under_the_world(out):
    """Light from all sides alone: with what is in its way, and without."""
    scene = _stage(64)
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.5, 0.8)
    scene.encre.world_shadows = True
    shoot(out, "shadowed")
    scene.encre.world_shadows = False
    shoot(out, "open")


def _sky(kind, **settings):
    def make(tree):
        node = tree.nodes.new("ShaderNodeTexSky")
        node.sky_type = kind if kind != "NISHITA" or bpy.app.version < (5, 0) else "SINGLE_SCATTERING"
        for name, value in settings.items():
            setattr(node, name if hasattr(node, name) else name.replace("dust", "aerosol"), value)
        tree.nodes["Background"].inputs["Strength"].default_value = 0.05 if kind == "NISHITA" else 1.0
        return node.outputs[0]
    return make


def _picture(tree):
    """A sky of two colors with a sun of 4 degrees, turned."""
    image = bpy.data.images.new("Sky", 180, 90, float_buffer=True)
    pixels = np.ones((90, 180, 4), np.float32)
    pixels[:45, :, :3], pixels[45:, :, :3] = (0.05, 0.04, 0.03), (0.2, 0.3, 0.5)
    pixels[66:68, 60:62, :3] = 700, 600, 400
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    node, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    node.image, mapping.inputs["Rotation"].default_value = image, (0, 0, 0.7)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    return node.outputs[0]


def _gradient(tree):
    """A ramp by height, as nodes make it, seen otherwise by the camera."""
    parts, ramp = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.9, 0.5, 0.3, 1), (0.1, 0.2, 0.6, 1)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], parts.inputs[0])
    tree.links.new(parts.outputs["Z"], ramp.inputs[0])
    return ramp.outputs["Color"]


def _tinted(tree):
    """A Sky Texture of which other nodes make something else."""
    mix = tree.nodes.new("ShaderNodeMixRGB")
    mix.blend_type, mix.inputs[0].default_value, mix.inputs[2].default_value = "MULTIPLY", 1, (1, 0.6, 0.3, 1)
    tree.links.new(_sky("NISHITA", sun_elevation=0.6, sun_rotation=-1.0)(tree), mix.inputs[1])
    return mix.outputs[0]


SKIES = {
    "atmosphere": _sky("NISHITA", sun_elevation=0.6, sun_rotation=2.0, air_density=1.5, dust_density=2.0),
    "preetham": _sky("PREETHAM", sun_direction=(0.3, -0.6, 0.7), turbidity=4.0),
    "hosek": _sky("HOSEK_WILKIE", sun_direction=(-0.5, -0.3, 0.8), turbidity=3.0, ground_albedo=0.3),
    "picture": _picture, "gradient": _gradient, "tinted": _tinted,
}


def skies(out):
    """The light of worlds by formula, of pictures and of nodes."""
    for name, make in SKIES.items():
        scene = _stage(32)
        scene.encre.world_shadows = True
        scene.world = bpy.data.worlds.new("World")
        scene.world.use_nodes = True
        tree = scene.world.node_tree
        tree.links.new(make(tree), tree.nodes["Background"].inputs["Color"])
        shoot(out, name)


def scene_rules(out):
    """What the camera does not see throws shadows, what throws none does not, and light is linked."""
    scene = _stage(16)
    _lamp("SUN", energy=3, angle=0)
    bpy.data.objects["Cube"].visible_shadow = False
    bpy.data.objects["Small"].visible_camera = False
    empty = link("Copies", None, (-1.4, -1.6, 0.2))
    inner = bpy.data.collections.new("Inner")
    cube("Copied", (0, 0, 0), 0.4, collection=inner)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    empty.scale, empty.rotation_euler = (-1, 1.5, 1), (0, 0, 0.5)
    fog = cube("Fog", (0, 0, 1), 4.0, material("Fog", (1, 1, 1)))
    tree = fog.data.materials[0].node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    scatter = tree.nodes.new("ShaderNodeVolumePrincipled")
    scatter.inputs["Density"].default_value = 0
    tree.links.new(scatter.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    world(scene, (0, 0, 0))
    shoot(out, "rules")


def _leaf(name, place, size):
    """A square of which an image shows a ring; (its material's node tree, the image's node)."""
    obj = plane(name, z=0.0)
    obj.data.uv_layers.new()
    obj.location, obj.scale = place, (size, size, 1)
    mat = material(name, (0.7, 0.7, 0.7))
    obj.data.materials.append(mat)
    n = 64
    y, x = (np.mgrid[:n, :n] + 0.5) / n
    far = np.hypot(x - 0.4, y - 0.6)
    pixels = np.ones((n, n, 4), np.float32)
    pixels[..., 3] = (far < 0.35) & (far > 0.15)
    image = bpy.data.images.new(name, n, n, alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    node = mat.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    return mat.node_tree, node


def cut_leaves(out):
    """What images cut out throws its own shadow: through Alpha, and mixed with Transparent, turned, repeated."""
    scene = _stage(16)
    scene.view_layers[0].use_pass_diffuse_direct = True
    _lamp("SUN", energy=3, angle=0)
    for name in ("Cube", "Ball", "Small"):
        bpy.data.objects[name].visible_shadow = bpy.data.objects[name].visible_camera = False
    tree, image = _leaf("One", (-0.9, 0.2, 1.0), 0.12)
    tree.links.new(image.outputs["Alpha"], tree.nodes["Principled BSDF"].inputs["Alpha"])
    tree, image = _leaf("Other", (0.9, 0.0, 1.2), 0.12)
    nodes, link_ = tree.nodes, tree.links.new
    place, over, mix = (nodes.new(f"ShaderNode{kind}") for kind in ("Mapping", "Math", "MixShader"))
    place.inputs["Scale"].default_value, place.inputs["Rotation"].default_value = (2, 2, 2), (0, 0, 0.4)
    place.inputs["Location"].default_value = (0.3, 0.1, 0)
    over.operation, over.inputs[1].default_value = "LESS_THAN", 0.4
    link_(nodes.new("ShaderNodeTexCoord").outputs["UV"], place.inputs["Vector"])
    link_(place.outputs[0], image.inputs["Vector"])
    link_(image.outputs["Alpha"], over.inputs[0])
    link_(over.outputs[0], mix.inputs[0])
    link_(nodes["Principled BSDF"].outputs[0], mix.inputs[1])
    link_(nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    link_(mix.outputs[0], nodes["Material Output"].inputs["Surface"])
    _leaf("Pane", (0.2, -1.2, 0.7), 0.03)[0].nodes["Principled BSDF"].inputs["Alpha"].default_value = 0.01
    for name in ("One", "Other", "Pane"):
        bpy.data.objects[name].visible_camera = False
    world(scene, (0, 0, 0))
    shoot(out, "cut_leaves")


def linked(out):
    """A second sun that lights the ball alone, and for which only the small cube throws shadows. Since 4.0."""
    if "light_linking" not in bpy.types.Object.bl_rna.properties:
        return
    _stage(16)
    obj = _lamp("SUN", energy=3, angle=0)
    for kind, name in (("receiver_collection", "Ball"), ("blocker_collection", "Small")):
        members = bpy.data.collections.new(kind)
        members.objects.link(bpy.data.objects[name])
        setattr(obj.light_linking, kind, members)
    obj.rotation_euler = (0.6, 0.2, pi)
    other = _lamp("SUN", energy=1, angle=0)
    excluded = bpy.data.collections.new("not this")
    excluded.objects.link(bpy.data.objects["Cube"])
    other.light_linking.receiver_collection = excluded
    excluded.collection_objects[0].light_linking.link_state = "EXCLUDE"
    shoot(out, "linked")


def kept(out):
    """A file that keeps its layers, of soft light that is cut into levels, and its twin that is supersampled."""
    scene = _stage(4)
    _lamp("AREA", energy=300, shape="SQUARE", size=1.0)
    for switch in ("use_shading", "use_hatching", "use_lines"):
        setattr(scene.encre, switch, True)
    scene.encre.line_shadow_strength = 4
    shoot(out, "kept")
    scene.render.use_border = scene.render.use_crop_to_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.25, 0.75
    scene.render.border_min_y, scene.render.border_max_y = 0.25, 0.75
    shoot(out, "border")
    scene.render.use_border = False
    empty = link("Shape", None, (-0.9, 0, 0.5))
    empty.empty_display_type, empty.empty_display_size = "SPHERE", 0.5
    empty.scale, empty.encre.bend_light, empty.encre.bend_fade = (2, 2, 2), 1, 0
    scene.encre.rim_lamp = bpy.data.objects["Lamp"]
    values = properties.settings(scene).scene
    fact("rim", [values[id_] for id_ in ("rim_space", "rim_angle", "rim_elevation")])
    shoot(out, "bent")
    bpy.data.objects.remove(empty)
    scene.encre.supersample = 2
    shoot(out, "large")


def cleaned(out):
    """How often the denoiser is asked for light that is cut into levels, by where that comes from."""
    from encre.blender import versions
    from encre.pen import denoise

    asked, steps = [], denoise.steps
    denoise.steps = lambda *args, **more: asked.append(1) or steps(*args, **more)
    scene = _stage(1)
    _lamp("SUN", energy=3, angle=0)
    scene.encre.use_shading = True
    fact("denoiser", denoise.available(versions.home()))
    for source in ("CYCLES", "DRAWN"):
        scene.encre.light_source = source
        asked.clear()
        shoot(out, source)
        fact(source, len(asked))


def from_frame_to_frame(out):
    """A cube moves, a lamp goes and an image changes: in an animation, then in each frame by itself."""
    scene = _stage(1)
    _lamp("SUN", energy=3, angle=0)
    other = _lamp("POINT", energy=400, shadow_soft_size=0)
    tree, node = _leaf("Leaf", (0.9, -1.0, 1.2), 0.12)
    tree.links.new(node.outputs["Alpha"], tree.nodes["Principled BSDF"].inputs["Alpha"])
    scene.frame_start, scene.frame_end = 1, 3
    small = bpy.data.objects["Small"]
    for frame in (1, 3):
        small.location.x += 0.3
        small.keyframe_insert("location", frame=frame)
        other.hide_render = frame == 3
        other.keyframe_insert("hide_render", frame=frame)
    told, drawn, seen = [], [], {}
    geometry, draw = Scene.geometry, light.Light.draw

    def tell(self, key, points, *more):
        told.append(scene.frame_current if points is not None else 0)
        geometry(self, key, points, *more)

    def watch(self, depth, normal, *more):
        depth, normal = seen.setdefault(scene.frame_current, (depth.copy(), normal.copy()))  # Cycles' differ in bits
        drawn.append(draw(self, depth, normal, *more))
        return drawn[-1]

    def change(scene, *_):
        image = bpy.data.images["Leaf"]
        image.pixels.foreach_set(np.full(len(image.pixels), scene.frame_current != 2, np.float32))
        image.update()

    Scene.geometry, light.Light.draw = tell, watch
    bpy.app.handlers.frame_change_post.append(change)
    exr(scene, f"{out}/moved-")
    bpy.ops.render.render(animation=True)
    fact("told", told[:])
    fact("left", len(light._between))
    for frame in (1, 2, 3):
        scene.frame_set(frame)
        bpy.ops.render.render()
    bpy.app.handlers.frame_change_post.remove(change)
    fact("same", [one.tobytes() == two.tobytes() for one, two in zip(drawn[:3], drawn[3:], strict=True)])
    fact("moves", [one.tobytes() != two.tobytes() for one, two in zip(drawn[:2], drawn[1:3], strict=True)])


def of_the_world(_out):
    """The light of one picture, told again and again while memory lies in other places."""
    rng = np.random.default_rng(1)
    picture, other, told = rng.random((64, 128, 4), np.float32), [np.empty(1)] * 50, set()
    for _ in range(300):
        other[rng.integers(len(other))] = np.empty(rng.integers(1, 3000))
        told.add(irradiance.of_picture(picture).tobytes())
    fact("told", len(told))
