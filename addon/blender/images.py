# SPDX-License-Identifier: GPL-3.0-or-later
"""The images that settings name, loaded by Blender."""

import os

import bpy

from ..pen import library
from ..pen.errors import EncreError
from . import pictures, properties, threads

_known = {}  # {Chosen: (when its file changed, pixels)} of the files that the settings loaded last name


def load(settings, keep_on=lambda: True):
    """{Chosen: pixels} of the images that settings read: float32 (height, width, channels), row 0 at the top, values as
    their parameters want them.

    Files are read anew, because an image that the user opened may be shown in another colour space; generated and
    packed images are taken as they are. EncreError: there is no such image, or it can't be used. Cancelled: keep_on()
    was False before it was there.
    """
    loaded = settings.load(lambda chosen: _load(chosen, keep_on))
    for chosen in _known.keys() - loaded.keys():
        del _known[chosen]
    return loaded


def same(some, others):
    """Whether two answers of load() are of the same pixels."""
    return some.keys() == others.keys() and all(some[chosen] is others[chosen] for chosen in some)


def _load(chosen, keep_on):
    if image := _held(chosen):
        return _pixels(image, chosen)
    try:
        changed = os.stat(chosen.name).st_mtime_ns
    except OSError:
        fault = "it has tiles; choose an image of one" if "<UDIM>" in chosen.name or "<UVTILE>" in chosen.name else \
            "there is no such file; choose another image"
        raise EncreError(f"{_words(chosen)}: {fault}") from None
    if chosen not in _known or _known[chosen][0] != changed:
        _known[chosen] = changed, threads.on_main_thread(lambda: _read(chosen), keep_on)
    return _known[chosen][1]


def held(loaded):
    """Those of load() that the .blend holds and that no file could give again."""
    return {chosen: pixels for chosen, pixels in loaded.items() if _held(chosen)}


def _held(chosen):
    """The Blender image of this name that is no file, or None."""
    return next((image for image in bpy.data.images if properties.image_key(image) == chosen.name
                 and (image.packed_file or not image.filepath)), None)


def _read(chosen):
    try:
        image = bpy.data.images.load(chosen.name, check_existing=False)
    except RuntimeError:
        raise _unreadable(chosen) from None
    try:
        if not _colored(chosen):
            image.colorspace_settings.name = "Non-Color"
        return _pixels(image, chosen)
    finally:
        bpy.data.images.remove(image)


def _colored(chosen):
    """Whether the image is read for its colours, and not for its values."""
    return library.params()[chosen.id].unit == "color"


def _pixels(image, chosen):
    pixels = pictures.linear(image) if _colored(chosen) else pictures.values(image)
    if pixels is None:
        raise _unreadable(chosen)
    return pixels[::-1]


def _words(chosen):
    return f"{chosen.id.replace('_', ' ')} {chosen.name}"


def _unreadable(chosen):
    return EncreError(f"{_words(chosen)}: it can't be read; choose a picture that Blender opens")
