# SPDX-License-Identifier: GPL-3.0-or-later
"""Paper images, loaded by Blender."""

import functools
import os

import bpy
import numpy as np

from ..pen.errors import EncreError
from . import properties


def load(name):
    """The image that settings call `name` as float32 (height, width, channels), row 0 at the top, values as stored.

    Files are read anew, because an image that the user opened may be shown in another colour space; generated and
    packed images are taken as they are. EncreError: there is no such image, or it can't be read.
    """
    if not name:
        raise EncreError("paper_image: the paper's source is an image but none is given; choose an image")
    if own := stored(name):
        return own[1]
    try:
        changed = os.stat(name).st_mtime_ns
    except OSError:
        raise EncreError(f"paper image {name}: there is no such file; choose another image") from None
    return _read(name, changed)


def stored(name):
    """(name, pixels) of an image that the .blend holds and that no file could give again; None: it is a file."""
    for image in bpy.data.images:
        if properties.image_key(image) == name and (image.packed_file or not image.filepath):
            return name, _pixels(image, name)
    return None


@functools.lru_cache(maxsize=1)
def _read(path, _changed):
    """The file, kept until another is read or it changes."""
    try:
        image = bpy.data.images.load(path, check_existing=False)
    except RuntimeError:
        raise _unreadable(path) from None
    try:
        image.colorspace_settings.name = "Non-Color"
        return _pixels(image, path)
    finally:
        bpy.data.images.remove(image)


def _pixels(image, name):
    width, height = image.size
    if not width or not height:
        raise _unreadable(name)
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, image.channels)[::-1]


def _unreadable(name):
    return EncreError(f"paper image {name}: it can't be read; choose a picture that Blender opens")
