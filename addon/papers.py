# SPDX-License-Identifier: GPL-3.0-or-later
"""Paper images, loaded by Blender."""

import functools
import os

import bpy
import numpy as np

from . import core


def load(path):
    """The image at `path` as float32 (height, width, channels), row 0 at the top, values as stored.

    The last one is kept, until its file changes. EncreError: it can't be read.
    """
    path = bpy.path.abspath(path or "")
    try:
        changed = os.stat(path).st_mtime_ns
    except OSError:
        raise core.EncreError(f"paper image {path or '(none)'}: there is no such file; choose another") from None
    return _load(path, changed)


@functools.lru_cache(maxsize=1)
def _load(path, _changed):
    failed = core.EncreError(f"paper image {path}: it can't be read; choose a picture that Blender opens")
    try:
        image = bpy.data.images.load(path, check_existing=False)
    except RuntimeError:
        raise failed from None
    try:
        image.colorspace_settings.name = "Non-Color"
        width, height = image.size
        if not width or not height:
            raise failed
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(height, width, image.channels)[::-1]
    finally:
        bpy.data.images.remove(image)
