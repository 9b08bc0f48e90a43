# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines between colors in textures, as wide as those of a frame where these have their full width."""

from math import sqrt

import bpy
import numpy as np

from ...pen import library, unwrap
from ...pen.errors import EncreError
from .. import bake, properties, subject, triangles


def check(scene):
    """Raises EncreError where there are no lines between colors that could be in textures."""
    if not (scene.encre.use_lines and scene.encre.line_color_strength and scene.encre.line_color_width):
        raise EncreError("the scene draws no lines between colors, which are what is compared; add --preset "
                         "inter_color, or choose the look Inter-color")
    if not bake.tasks(scene.objects):
        raise EncreError("no object of the scene shows a color image, so there is nothing to bake lines into; give a "
                         "material an image texture")
    pixels_per_metre(scene)


def groups(scene):
    """The scene's settings and those styles' that change how strong lines between colors are: where the textures have
    these, `line_color_strength` of all of them is 0."""
    return [scene.encre, *(style for style in scene.encre.styles if style.is_property_set("line_color_strength"))]


def surface(task, depsgraph):
    """The triangles that show the image. Raises EncreError where one has no UV map."""
    return unwrap.join([triangles.unwrapped(obj, depsgraph) for obj in task.objects])


def levels(task, scene, uniform=False, mips=False, thickness=1.0):
    """The pixels of the task's image with lines, one picture for each level of detail, each with lines of its own that
    are as wide on the surface as the finest's; thickness: a factor of their width. Raises EncreError."""
    from ...pen import colour

    mesh, pixels = surface(task, bpy.context.evaluated_depsgraph_get()), bake.read(task.image)
    values, drawn = properties.scene_values(scene), []
    width = thickness * screen_width(values, scene) * texels_per_pixel(mesh, task.image, scene)
    while not drawn or (mips and min(pixels.shape[:2]) > 2):
        if drawn:
            pixels = colour.halved(pixels, task.image.is_float)
        thick = min(width / 2 ** len(drawn), library.params()["line_thickness"].hard_max)
        form = unwrap.form(mesh, pixels.shape[1], pixels.shape[0]) if uniform else None
        drawn.append(library.bake(pixels, dict(values, line_thickness=thick), form, task.image.is_float,
                                  unwrap.tiles(mesh)).texture)
    return drawn


def texels_per_metre(mesh, width, height):
    """Of a texture of this size on the mesh, on the mean."""
    size = np.array([width, height])
    sides = mesh.points[mesh.corners[:, 1:]] - mesh.points[mesh.corners[:, :1]]
    across = (mesh.uv[:, 1:] - mesh.uv[:, :1]) * size
    texels = np.abs(np.linalg.det(across))
    there = texels > 1e-12
    metres = np.linalg.norm(np.cross(sides[there, 0], sides[there, 1]), axis=1)
    if not metres.sum() > 0:
        raise EncreError("its UV map has no area")
    return sqrt(texels.sum() / metres.sum())


def projection_of(scene):
    """The camera's matrix to clip space, and the frame's height in pixels."""
    render = scene.render
    width, height = (round(n * render.resolution_percentage / 100) for n in (render.resolution_x, render.resolution_y))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return np.array(scene.camera.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x,
                                                    scale_y=render.pixel_aspect_y)), height


def full_distance(scene):
    """Where a line of the frame has its full width, in scene units; 0: everywhere."""
    distance, depsgraph = scene.encre.line_far_distance, bpy.context.evaluated_depsgraph_get()
    if distance and scene.encre.line_far_unit == "RELATIVE":
        camera = scene.camera.evaluated_get(depsgraph)
        view = np.array(camera.matrix_world.normalized().inverted())
        distance *= subject.read(depsgraph, camera).distance(view, projection_of(scene)[0])
    return distance


def pixels_per_metre(scene):
    """On a plane that faces the camera, at the distance where a line has its full width."""
    projection, height = projection_of(scene)
    scale = projection[1, 1] * height / 2
    if scene.camera.data.type == "ORTHO":
        return scale
    distance = full_distance(scene)
    if not distance:
        raise EncreError("baked lines grow thin with distance, those of the frame do not: set line_far_distance, the "
                         "distance at which both are equally wide")
    return scale / distance


def screen_width(values, scene):
    """The width in pixels of a line of strength 1 at that distance."""
    unit = scene.render.resolution_y * scene.render.resolution_percentage / 100 / 1080
    return values["line_thickness"] * (unit if values["length_unit"] == "RELATIVE" else 1)


def texels_per_pixel(mesh, image, scene):
    """On a plane that faces the camera, at the distance where a line has its full width."""
    return texels_per_metre(mesh, *image.size) / pixels_per_metre(scene)
