# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise for files: the one that a Blender on this machine brings, or the system's."""

import functools

from ..pen import denoise
from . import installed


@functools.cache
def home():
    """The folder of a Blender with the library. None: there is none, and the system may have it."""
    return next((folder for folder in installed.folders() if denoise.available(folder)), None)


def available():
    return denoise.available(home())


def cleaner(threads, scale, row):
    """What layers.assemble() takes as `denoise` for a part of the frame that begins at this row."""
    return lambda picture, albedo, normal, *surface: denoise.denoise(
        picture, albedo, normal, threads, scale=scale, home=home(), at=(0, row), surface=surface)
