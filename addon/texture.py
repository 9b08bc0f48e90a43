# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre bake`: inter-color lines drawn into an image file, without Blender unless a .blend is named."""

import os

import numpy as np

from . import core, images, interrupt, render, unwrap

MOST = 32768  # texels each way, as encre_bake() has it
ENOUGH = 4    # the last mip level is so many line widths across: below, ink would fill it


def bake(path, out, values, uniform=None, mips=False, tile=None, threads=0, blender=None, say=print):
    """Draws lines into the image `path` and writes `out`, and with `mips` its levels beside it.

    values: the parameters; uniform: MESH.obj or BLEND:OBJECT, on whose surface lines get the same width; tile:
    (sideways, upwards), None: where the mesh goes on over the border, without a mesh everywhere; say(kind, sentence)
    hears warnings. Raises core.EncreError for the input, images.WriteError where the output can't be written.
    """
    texture = images.fit_texture(out, images.read_texture(path, MOST))
    paths = level_paths(out, texture.pixels.shape, values) if mips else [out]
    for target in paths:
        if os.path.realpath(target) == os.path.realpath(path):
            raise core.EncreError(f"{target}: is the texture itself, which is kept; give another -o")
        images.prepare(target)
    mesh = _mesh(uniform, out, blender, say) if uniform else None
    tile = tile or (unwrap.tiles(mesh) if mesh else (True, True))
    baked, pixels = {}, texture.pixels
    for target in paths:
        if baked:
            pixels = halved(pixels, texture.linear)
        form = unwrap.form(mesh, *pixels.shape[1::-1]) if mesh else None
        with interrupt.heeded() as progress:
            done = core.bake(pixels, values, form, texture.linear, tile, threads=threads, progress=progress)
        if not baked and done.nonfinite:
            say("warning", f"{path}: {done.nonfinite} values were NaN or infinite and were read as 0")
        baked[target] = images.Texture(done.texture, texture.kind, texture.linear, texture.straight)
    images.write_textures(baked)


def level_paths(out, shape, values):
    """OUT, OUT with .mip1 before its ending, ... down to the level that is still ENOUGH line widths across."""
    stem, ending = os.path.splitext(out)
    paths, side = [out], min(shape[:2])
    least = ENOUGH * values.get("line_thickness", core.params()["line_thickness"].default)
    while side // 2 >= max(least, 1):
        side //= 2
        paths.append(f"{stem}.mip{len(paths)}{ending}")
    return paths


def halved(pixels, linear):
    """The next mip level (H // 2, W // 2, at least 1): each texel the mean, in linear light, of those it covers."""
    colors, alpha = pixels[..., :3], pixels[..., 3:]
    light = colors if linear else images.decode_srgb(colors)
    light, alpha = _halved(_halved(light, 0), 1), _halved(_halved(alpha, 0), 1)
    return np.concatenate([light if linear else images.encode_srgb(light), alpha], 2, dtype=np.float32)


def _halved(a, axis):
    a = np.moveaxis(a, axis, 0)
    n, half = len(a), len(a) // 2
    if n == 1:
        out = a
    elif n == 2 * half:
        out = (a[::2] + a[1::2]) / 2
    else:  # each covers two and a share of a third: on the left first, then on the right
        k = np.arange(half).reshape(-1, *[1] * (a.ndim - 1))
        out = (a[:-1:2] * (half - k) + a[1::2] * half + a[2::2] * (k + 1)) / n
    return np.moveaxis(out, 0, axis)


def _mesh(name, out, blender, say):
    if unwrap.is_obj(name):
        return unwrap.read_obj(name)
    blend, colon, obj = name.rpartition(":")
    if not colon or not obj or not blend.lower().endswith(".blend"):
        raise core.EncreError(f"--uniform {name}: is neither MESH.obj nor BLEND:OBJECT; give one of them")
    if not os.path.isfile(blend):
        raise core.EncreError(f"{blend}: there is no such file; check the path")
    return render.unwrapped(blend, obj, out, blender=blender, say=say)
