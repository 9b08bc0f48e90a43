# SPDX-License-Identifier: GPL-3.0-or-later
"""Paper images, loaded by Blender."""

import functools
import os
import time
from _thread import get_ident

import bpy

from ..pen.errors import Cancelled, EncreError
from . import pictures, properties

_MAIN = get_ident()  # Blender imports add-ons on its main thread


def load(name, keep_on=lambda: True):
    """The image that settings call `name` as float32 (height, width, channels), row 0 at the top, values as stored.

    Files are read anew, because an image that the user opened may be shown in another colour space; generated and
    packed images are taken as they are. EncreError: there is no such image, or it can't be read. Cancelled: keep_on()
    was False before it was there.
    """
    if own := stored(name):
        return own[1]
    try:
        changed = os.stat(name).st_mtime_ns
    except OSError:
        raise EncreError(f"paper image {name}: there is no such file; choose another image") from None
    return _on_main_thread(lambda: _read(name, changed), keep_on)


def _on_main_thread(work, keep_on):
    """What work() returns or raises. A render that a window started has a thread of its own, on which bpy.data must not
    change; meanwhile Blender's main thread runs timers."""
    if get_ident() == _MAIN:
        return work()
    done = []

    def run():
        try:
            done.append((work(), None))
        except EncreError as error:
            done.append((None, error))

    bpy.app.timers.register(run)
    try:
        while not done:
            if not keep_on():
                raise Cancelled("rendering was cancelled")
            time.sleep(0.005)
    finally:
        if not done and bpy.app.timers.is_registered(run):
            bpy.app.timers.unregister(run)
    pixels, error = done[0]
    if error:
        raise error
    return pixels


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
    pixels = pictures.values(image)
    if pixels is None:
        raise _unreadable(name)
    return pixels[::-1]


def _unreadable(name):
    return EncreError(f"paper image {name}: it can't be read; choose a picture that Blender opens")
