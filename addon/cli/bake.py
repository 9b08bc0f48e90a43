# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre bake`: inter-color lines drawn into an image file, without Blender unless a .blend is named."""

import os

from ..pen import colour, library, unwrap
from ..pen.errors import EncreError
from . import images, interrupt, render, room

MOST = 32768  # texels each way, as encre_bake() has it
ENOUGH = 4    # the last mip level is so many line widths across: below, ink would fill it


def bake(path, out, values, uniform=None, mips=False, tile=None, threads=0, blender=None, say=print):
    """Draws lines into the image `path` and writes `out`, and with `mips` its levels beside it.

    values: the parameters; uniform: MESH.obj or BLEND:OBJECT, on whose surface lines get the same width; tile:
    (sideways, upwards), None: where the mesh goes on over the border, without a mesh everywhere; say(kind, sentence)
    hears warnings. Returns the files written. Raises EncreError for the input, images.WriteError where the output
    can't be written.
    """
    texture = images.fit_texture(out, images.read_texture(path, MOST))
    room.afford(path, 2 * texture.pixels.nbytes)  # what is drawn, and what is written of it
    paths = level_paths(out, texture.pixels.shape, values) if mips else [out]
    for target in paths:
        if os.path.realpath(target) == os.path.realpath(path):
            raise EncreError(f"{target}: is the texture itself, which is kept; give another -o")
        images.prepare(target)
    mesh = _mesh(uniform, out, blender, say) if uniform else None
    tile = tile or (unwrap.tiles(mesh) if mesh else (True, True))
    baked, pixels = {}, texture.pixels
    for target in paths:
        if baked:
            pixels = colour.halved(pixels, texture.linear)
        form = unwrap.form(mesh, *pixels.shape[1::-1]) if mesh else None
        with interrupt.heeded() as progress:
            done = library.bake(pixels, values, form, texture.linear, tile, threads=threads, progress=progress)
        if not baked and done.nonfinite:
            say("warning", f"{path}: {done.nonfinite} values were NaN or infinite and were read as 0")
        baked[target] = images.Texture(done.texture, texture.kind, texture.linear, texture.straight)
    images.write_textures(baked)
    return list(baked)


def level_paths(out, shape, values):
    """OUT, OUT with .mip1 before its ending, ... down to the level that is still ENOUGH line widths across."""
    stem, ending = os.path.splitext(out)
    paths, side = [out], min(shape[:2])
    least = ENOUGH * values.get("line_thickness", library.params()["line_thickness"].default)
    while side // 2 >= max(least, 1):
        side //= 2
        paths.append(f"{stem}.mip{len(paths)}{ending}")
    return paths


def _mesh(name, out, blender, say):
    if unwrap.is_obj(name):
        return unwrap.read_obj(name)
    blend, colon, obj = name.rpartition(":")
    if not colon or not obj or not blend.lower().endswith(".blend"):
        raise EncreError(f"--uniform {name}: is neither MESH.obj nor BLEND:OBJECT; give one of them")
    if not os.path.isfile(blend):
        raise EncreError(f"{blend}: there is no such file; check the path")
    return render.unwrapped(blend, obj, out, blender=blender, say=say)
