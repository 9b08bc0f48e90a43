# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Blenders on this machine bring along: their folders and files, found without running one."""

import functools
import glob
import importlib.util
import os
import shutil

# From a Blender's folder to its data files: the module's or program's own, a package's of a Linux, macOS.
_DATA = ("[0-9]*/datafiles", "../share/blender/datafiles", "../share/blender/[0-9]*/datafiles",
         "../Resources/[0-9]*/datafiles")


def folders():
    """Those of the module bpy and of the program on PATH, as far as they are there."""
    module, program = importlib.util.find_spec("bpy"), shutil.which("blender")
    return [*(module.submodule_search_locations or () if module else ()),
            *([os.path.dirname(os.path.realpath(program))] if program else [])]


@functools.cache
def colour_configurations():
    """Paths of OpenColorIO's: the one that the environment names, as Blender takes it, before Blender's own."""
    own = [os.path.join(folder, data, "colormanagement", "config.ocio") for folder in map(glob.escape, folders())
           for data in _DATA]
    found = [os.environ.get("OCIO", ""), *(path for pattern in own for path in glob.glob(pattern))]
    return list(dict.fromkeys(filter(os.path.isfile, map(os.path.normpath, found))))
