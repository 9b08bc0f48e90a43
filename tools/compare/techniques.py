# SPDX-License-Identifier: GPL-3.0-or-later
"""What `encre compare` renders inside Blender: one frame by each technique, timed.

Each technique is a context manager that sets the scene up and puts it back: plain (Cycles alone), baked (lines in the
textures; silhouettes by Encre), dynamic (all by Encre), freestyle and line_art (Blender's own, over Cycles).
"""

import contextlib
import os
import time

import bpy
import numpy as np
from encre.blender import bake, properties, versions
from encre.blender.study import baked
from encre.pen.errors import EncreError

from . import grease

PEN = 3      # pixels of a frame 1080 high: the width of Freestyle's and Line Art's lines
NEARER = 0.02  # share of its distance by which a stroke is drawn in front of its surface


def render(job, scene, todo, report):
    """Renders every frame of `todo` by the job's techniques and reports each one's pictures."""
    kinds = {"plain": plain, "baked": BakedSet(job["uniform"], job["mips"], report), "dynamic": dynamic,
             "freestyle": freestyle, "line_art": line_art}
    baked.check(scene)
    report("frame", frame=todo[0], number=0, count=len(todo))
    warm_up(scene, os.path.join(job["folder"], "first.png"))
    for number, frame in enumerate(todo, 1):
        report("frame", frame=frame, number=number, count=len(todo))
        scene.frame_set(frame)
        pictures = {}
        for name in job["techniques"]:
            report("doing", text=f"rendering frame {frame}, {name}")
            part = os.path.join(job["folder"], f"{frame}_{name}.png")
            start = time.perf_counter()
            try:
                with kinds[name](scene):
                    ready = time.perf_counter()
                    shoot(scene, part)
            except Missing as reason:
                report("note", text=str(reason))
                continue
            extra = ready - start if name in ("freestyle", "line_art") else 0
            pictures[name] = {"name": os.path.basename(part), "seconds": time.perf_counter() - ready + extra}
        report("pictures", frame=frame, pictures=pictures, baking=kinds["baked"].seconds,
               values=properties.scene_values(scene), samples=scene.cycles.samples, blender=bpy.app.version_string)


class Missing(Exception):
    """This Blender lacks a technique."""


def shoot(scene, path):
    scene.render.filepath = path
    try:
        done = bpy.ops.render.render(write_still=True)
    except RuntimeError as reason:
        raise EncreError(str(reason).strip().removeprefix("Error: ").rstrip(".")) from None
    if "FINISHED" not in done or not os.path.exists(path):
        raise EncreError("Blender wrote no picture; run again with --verbose to see why")


def warm_up(scene, path):
    """A tiny frame, so that loading Cycles counts for no technique."""
    percentage = max(1600 // scene.render.resolution_x, 400 // scene.render.resolution_y + 1)  # at least 4 pixels high
    with changed(scene.render, resolution_percentage=percentage):
        shoot(scene, path)


@contextlib.contextmanager
def changed(block, **values):
    """Properties of a block, set for a while."""
    before = {name: getattr(block, name) for name in values}
    for name, value in values.items():
        setattr(block, name, value)
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(block, name, value)


@contextlib.contextmanager
def plain(scene):
    clean = scene.cycles.use_denoising and versions.has_cycles_denoiser()
    with changed(scene.render, engine="CYCLES", use_freestyle=False), changed(scene.cycles, use_denoising=clean):
        yield


@contextlib.contextmanager
def dynamic(_scene):
    """The scene as it stands."""
    yield


# Lines in the textures


class BakedSet:
    """The second set of textures, made when first asked for."""

    def __init__(self, uniform, mips, report):
        self.uniform, self.mips, self.report = uniform, mips, report
        self.levels = None  # [(task, [image of each mip level])]
        self.seconds = 0.0

    @contextlib.contextmanager
    def __call__(self, scene):
        """Textures with lines, without lines between colours by Encre: as in the thesis, everything else is its."""
        if self.levels is None:
            start = time.perf_counter()
            self.levels = [(task, self.bake(task, scene)) for task in bake.tasks(scene.objects)]
            self.seconds = time.perf_counter() - start
        with contextlib.ExitStack() as stack:
            for group in baked.groups(scene):
                stack.enter_context(changed(group, line_color_strength=0))
            for task, images in self.levels:
                for node in task.nodes if images else ():
                    stack.enter_context(changed(node, image=images[0]))
                    stack.enter_context(mipped(node, images, texels(task, scene)))
            yield

    def bake(self, task, scene):
        try:
            return self.drawn(task, scene)
        except EncreError as reason:
            self.report("warning", text=f"{task.image.name} stays without lines: {reason}")
            return []

    def drawn(self, task, scene):
        """The image with lines, at each mip level. Raises EncreError."""
        return [bake.store(task.image, pixels, None) for pixels in baked.levels(task, scene, self.uniform, self.mips)]


def texels(task, scene):
    """For a pixel, where lines have their full width."""
    return baked.texels_per_pixel(baked.surface(task, bpy.context.evaluated_depsgraph_get()), task.image, scene)


@contextlib.contextmanager
def mipped(node, images, texels):
    """Has an image node show the level of the distance; `texels` of the finest are a pixel where lines are full."""
    if len(images) < 2:
        yield
        return
    tree, added = node.id_data, []

    def new(kind, **settings):
        made = tree.nodes.new(kind)
        added.append(made)
        for key, value in settings.items():
            setattr(made, key, value)
        return made

    def math(operation, *inputs):
        made = new("ShaderNodeMath", operation=operation)
        for value, socket in zip(inputs, made.inputs, strict=False):
            if isinstance(value, float):
                socket.default_value = value
            else:
                tree.links.new(value, socket)
        return made.outputs[0]

    used = [link.to_socket for link in node.outputs["Color"].links]
    vector = [link.from_socket for link in node.inputs["Vector"].links]
    depth = new("ShaderNodeCameraData").outputs["View Z Depth"]
    full = baked.full_distance(bpy.context.scene)
    level = math("LOGARITHM", math("MAXIMUM", math("MULTIPLY", depth, texels / full), 1.0), 2.0)
    color = node.outputs["Color"]
    for k, image in enumerate(images[1:]):
        coarse = new("ShaderNodeTexImage", image=image, interpolation=node.interpolation, extension=node.extension)
        for socket in vector:
            tree.links.new(socket, coarse.inputs["Vector"])
        mix = new("ShaderNodeMixRGB", use_clamp=True)
        tree.links.new(math("MINIMUM", math("MAXIMUM", math("SUBTRACT", level, float(k)), 0.0), 1.0), mix.inputs[0])
        tree.links.new(color, mix.inputs[1])
        tree.links.new(coarse.outputs["Color"], mix.inputs[2])
        color = mix.outputs[0]
    for socket in used:
        tree.links.new(color, socket)
    try:
        yield
    finally:
        for socket in used:
            tree.links.new(node.outputs["Color"], socket)
        for made in added:
            tree.nodes.remove(made)


# Blender's own lines


def pen(scene):
    """The width in pixels of this frame."""
    return max(1.0, PEN * scene.render.resolution_y * scene.render.resolution_percentage / 100 / 1080)


@contextlib.contextmanager
def freestyle(scene):
    """The scene's own line sets, or one of all kinds of edges that Freestyle finds without marking any by hand."""
    if not bpy.app.build_options.freestyle:
        raise Missing("this Blender has no Freestyle")
    layer = bpy.context.view_layer
    settings, own = layer.freestyle_settings, scene.render.use_freestyle and layer.use_freestyle
    with plain(scene), contextlib.ExitStack() as stack:
        if not own:
            for other in settings.linesets:  # an empty file has one without a style, which Freestyle can't draw
                stack.enter_context(changed(other, show_render=False))
            style = bpy.data.linestyles.new("Encre compares")
            stack.callback(bpy.data.linestyles.remove, style)
            lines = settings.linesets.new(style.name)
            stack.callback(settings.linesets.remove, lines)
            lines.linestyle, style.thickness = style, pen(scene)
            lines.select_silhouette = lines.select_border = lines.select_crease = True
            lines.select_contour = lines.select_material_boundary = True
        stack.enter_context(changed(scene.render, use_freestyle=True, line_thickness_mode="ABSOLUTE"))
        stack.enter_context(changed(layer, use_freestyle=True))
        yield


@contextlib.contextmanager
def line_art(scene):
    """Line Art's strokes as black tubes: Grease Pencil itself is drawn by the graphics card, which may be none."""
    with plain(scene), contextlib.ExitStack() as stack:
        pencil = grease.line_art(scene)
        if pencil is None:
            raise Missing("this Blender has no Line Art")
        stack.callback(bpy.data.objects.remove, pencil)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        strokes = grease.strokes(pencil.evaluated_get(depsgraph))
        pencil.hide_render = True
        tubes = drawn_strokes(strokes, scene, depsgraph)
        stack.callback(bpy.data.curves.remove, tubes.data)
        yield


def drawn_strokes(strokes, scene, depsgraph):
    """Strokes (n, 3) in world space as a curve object, equally wide on the screen and just before their surface."""
    ink = bpy.data.materials.new("Encre compares")
    ink.use_nodes = True
    ink.node_tree.nodes.clear()
    black, out = (ink.node_tree.nodes.new(kind) for kind in ("ShaderNodeEmission", "ShaderNodeOutputMaterial"))
    black.inputs["Color"].default_value = 0, 0, 0, 1
    ink.node_tree.links.new(black.outputs[0], out.inputs[0])
    curve = bpy.data.curves.new("Encre compares", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", 1.0, 0
    curve.materials.append(ink)
    camera = scene.camera.evaluated_get(depsgraph)
    eye, axis = np.array(camera.matrix_world.translation), -np.array(camera.matrix_world.col[2][:3])
    share = scene.render.resolution_percentage / 100
    width, height = (round(side * share) for side in (scene.render.resolution_x, scene.render.resolution_y))
    scale = camera.calc_matrix_camera(depsgraph, x=width, y=height)[1][1] * height / 2
    for stroke in strokes:
        depth = (stroke - eye) @ axis
        if camera.data.type == "ORTHO":
            points, radius = stroke - axis * NEARER * depth[:, None], np.full(len(stroke), pen(scene) / 2 / scale)
        else:
            points = eye + (stroke - eye) * (1 - NEARER)
            radius = pen(scene) / 2 * depth * (1 - NEARER) / scale
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.c_[points, np.ones(len(points))].ravel())
        spline.points.foreach_set("radius", radius)
    obj = bpy.data.objects.new("Encre compares", curve)
    obj.visible_shadow = obj.visible_diffuse = obj.visible_glossy = False
    scene.collection.objects.link(obj)
    return obj
