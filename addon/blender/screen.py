# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and words in a region of the 3D view, by Blender's module gpu. Only while it is drawn, and never without a
window: what needs it is imported there."""

import functools
import textwrap

import blf
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

_VERTEX = """
void main()
{
	uv = vec2(corner.x, 1.0 - corner.y);
	gl_Position = vec4(mix(place.xy, place.zw, corner), 0.0, 1.0);
}
"""
_FRAGMENT = """
void main()
{
	color = texture(picture, uv);
}
"""


@functools.cache
def _program():
    """(shader, a quad for it); made once for all views."""
    info, between = gpu.types.GPUShaderCreateInfo(), gpu.types.GPUStageInterfaceInfo("encre_view")
    between.smooth("VEC2", "uv")
    info.vertex_in(0, "VEC2", "corner")
    info.vertex_out(between)
    info.push_constant("VEC4", "place")
    info.sampler(0, "FLOAT_2D", "picture")
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source(_VERTEX)
    info.fragment_source(_FRAGMENT)
    shader = gpu.shader.create_from_info(info)
    return shader, batch_for_shader(shader, "TRI_STRIP", {"corner": [(0, 0), (1, 0), (0, 1), (1, 1)]})


def upload(picture):
    """A texture of a picture: float32 (height, width, 4), row 0 at the top, scene-linear, alpha premultiplied."""
    height, width, channels = picture.shape
    pixels = gpu.types.Buffer("FLOAT", height * width * channels, picture)
    return gpu.types.GPUTexture((width, height), format="RGBA32F", data=pixels)


def show(texture, place):
    """Draws a texture over what is there; place: left, bottom, right, top from -1 to 1."""
    shader, quad = _program()
    gpu.state.blend_set("ALPHA_PREMULT")
    shader.bind()
    shader.uniform_float("place", place)
    shader.uniform_sampler("picture", texture)
    quad.draw(shader)
    gpu.state.blend_set("NONE")


@functools.cache
def _ground():
    """What words stand on where a picture may be as light as they are."""
    return upload(np.array([[[0, 0, 0, 0.85]]], np.float32))


def say(region, lines, scale, grounded):
    """Writes (text, colour), as many lines as each takes, from below upwards into a region; scale: of Blender's
    interface; grounded: on a dark ground."""
    pixels = Matrix.Diagonal((2 / region.width, 2 / region.height, 1, 1))
    size = 13 * scale
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_identity()
        gpu.matrix.load_projection_matrix(Matrix.Translation((-1, -1, 0)) @ pixels)
        blf.size(0, size)
        blf.enable(0, blf.SHADOW)
        blf.shadow(0, 3, 0, 0, 0, 1)
        columns = max(10, int(region.width / (0.6 * size)) - 16)
        rows = [(row, color) for text, color in lines for row in reversed(textwrap.wrap(text, columns))]
        if rows and grounded:
            right = 6.6 * size + max(blf.dimensions(0, text)[0] for text, _ in rows)
            top = (2.8 + 1.6 * len(rows)) * size
            show(_ground(), [2 * at / of - 1 for at, of in ((5.4 * size, region.width), (2.2 * size, region.height),
                                                            (right, region.width), (top, region.height))])
        for row, (text, color) in enumerate(rows):
            blf.color(0, *color, 1)
            blf.position(0, 6 * size, (3 + 1.6 * row) * size, 0)
            blf.draw(0, text)
        blf.disable(0, blf.SHADOW)
