# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise for files: the one that a Blender on this machine brings, or the system's."""

import functools
import importlib.util
import os
import shutil

from ..pen import denoise


@functools.cache
def home():
    """The folder of a Blender with the library: that of the module bpy, or of the program on PATH. None: there is
    neither, and the system may have it."""
    module, program = importlib.util.find_spec("bpy"), shutil.which("blender")
    folders = [*(module.submodule_search_locations or () if module else ()),
               *([os.path.dirname(os.path.realpath(program))] if program else [])]
    return next((folder for folder in folders if denoise.available(folder)), None)


def available():
    return denoise.available(home())


def cleaner(threads, scale):
    """What layers.assemble() takes as `denoise`."""
    return lambda picture, albedo, normal: denoise.denoise(picture, albedo, normal, threads, scale=scale, home=home())
