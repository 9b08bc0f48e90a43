# SPDX-License-Identifier: GPL-3.0-or-later
"""All files that a scene reads, for farms that carry them to other machines, and their places there.

Runs inside Blender. needed.py tells which of those that a frame uses are missing.
"""

import contextlib
import os
import re
import sys

import bpy

from .farms import mapping

_TILES = {"<UDIM>": r"\d{4}", "<UVTILE>": r"u\d+_v\d+"}


def files(script=None):
    """Their paths, of tiles and sequences each file that is there. script: that of a scene in Python, whose modules
    beside it are read, too."""
    found, sequences = {}, _sequences()
    for path in bpy.utils.blend_paths(absolute=True, packed=False, local=False):
        found.update(dict.fromkeys(map(os.path.normpath, _each(path, os.path.normpath(path) in sequences))))
    for module in list(sys.modules.values()) if script else ():
        path = os.path.abspath(getattr(module, "__file__", None) or "")
        if os.path.dirname(path) == os.path.dirname(script) and path != script:
            found[path] = None
    return list(found)


def _sequences():
    """Paths that stand for a file a frame."""
    made = [image for image in bpy.data.images if image.source == "SEQUENCE"]
    made += [data for data in (*bpy.data.volumes, *bpy.data.cache_files) if data.is_sequence]
    made += [clip for clip in bpy.data.movieclips if clip.source == "SEQUENCE"]
    return {os.path.normpath(bpy.path.abspath(data.filepath, library=data.library)) for data in made}


def _each(path, sequence):
    folder, name = os.path.split(path)
    wanted = re.escape(name)
    for token, digits in _TILES.items():
        wanted = wanted.replace(re.escape(token), digits)
    if sequence and (number := re.match(r"(.*?)\d+(\D*)$", name)):
        wanted = re.escape(number[1]) + r"\d+" + re.escape(number[2])
    there = []
    if wanted != re.escape(name):
        with contextlib.suppress(OSError):
            there = sorted(os.path.join(folder, entry) for entry in os.listdir(folder) if re.fullmatch(wanted, entry))
    return there or [path]


def remap(rules, report):
    """Puts files that lay elsewhere to their places here, as mapping.read() has them. In memory alone."""
    moved = False
    for data in list(bpy.data.libraries):
        if place := _elsewhere(rules, data):
            data.filepath = place
            with contextlib.suppress(RuntimeError):  # it is not there either, which is said as of any library
                data.reload()
            moved = True
    for kind in "images", "movieclips", "sounds", "fonts", "volumes", "cache_files", "texts":
        for data in getattr(bpy.data, kind):
            if (place := _elsewhere(rules, data)) and data.library is None:
                data.filepath = place
                moved = True
    if moved:
        report("note", text="files of the scene were looked for where --path-mapping says")


def _elsewhere(rules, data):
    """Where a file lies now; None: where it did."""
    path = data.filepath
    if not path or path.startswith(("//", "<")):
        return None
    place = mapping.apply(rules, path)
    return place if place != path else None
