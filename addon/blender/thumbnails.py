# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures shown as icons: of presets, made of the last render, and what is drawn for one."""

import os
import tempfile

import bpy
import bpy.utils.previews
import numpy as np

from . import pictures, versions
from .overrides import changed

SIDE = 128
_shown = None


def save(scene, path):
    """Saves the middle of the last render, small and as the scene shows it, as a PNG. False: there is no render."""
    result = bpy.data.images.get("Render Result")
    if result is None:
        return False
    with tempfile.TemporaryDirectory() as folder, changed(*versions.as_png(scene.render.image_settings)):
        full = os.path.join(folder, "full.png")
        try:
            result.save_render(full, scene=scene)
            small = shrink(_pixels(full), SIDE)
        except RuntimeError:  # nothing has been rendered since the file was opened
            return False
    image = bpy.data.images.new("Encre Thumbnail", small.shape[1], small.shape[0], alpha=True)
    try:
        image.pixels.foreach_set(np.ascontiguousarray(small, np.float32).ravel())
        image.filepath_raw, image.file_format = os.fspath(path), "PNG"
        image.save()
    finally:
        bpy.data.images.remove(image)
    return True


def _pixels(path):
    image = bpy.data.images.load(path)
    try:
        return pictures.values(image)
    finally:
        bpy.data.images.remove(image)


def shrink(pixels, side):
    """The square in the middle of a picture (height, width, channels), averaged down to `side` pixels or fewer."""
    height, width = pixels.shape[:2]
    whole = min(height, width)
    y, x = (height - whole) // 2, (width - whole) // 2
    square, side = pixels[y:y + whole, x:x + whole], min(side, whole)
    first = np.arange(side) * whole // side
    count = np.diff([*first, whole])[:, None]
    summed = np.add.reduceat(np.add.reduceat(square, first, 0), first, 1)
    return summed / (count * count.T)[..., None]


def icon(path):
    """The icon of a picture, 0 if there is none."""
    if not path:
        return 0
    try:
        key = f"{path} {path.stat().st_mtime_ns}"  # another picture may have taken its place
    except OSError:
        return 0
    return (_shown.get(key) or _shown.load(key, os.fspath(path), "IMAGE")).icon_id


def made(key, draw):
    """The icon of what draw() gives the first time, (height, width, 4) with row 0 at the top."""
    if key not in _shown:
        picture = draw()
        preview = _shown.new(key)
        preview.image_size = picture.shape[1::-1]
        preview.image_pixels_float.foreach_set(np.ascontiguousarray(picture[::-1], np.float32).ravel())
    return _shown[key].icon_id


def register():
    global _shown
    _shown = bpy.utils.previews.new()


def unregister():
    bpy.utils.previews.remove(_shown)
