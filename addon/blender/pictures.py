# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images: their values, and pictures that programs of materials look into, with levels of detail."""

import hashlib
import os
import time

import bpy
import numpy as np

from ..pen.job import Picture
from . import spaces, trees

_BEGUN = time.time_ns()  # when this module was loaded


_states = {}  # full name -> what was found of an image at the last look
_turns = {}   # full name -> how often it was found to hold something else


def turn(tagged=False):
    """A number that grows whenever an image of the file may hold something else; to be asked before anything reads
    images, which hides it: Blender tells of hardly any change, but has nothing of an image that it is to load anew.
    tagged: whether Blender has told that something has changed and not what, as it does of pixels that were set."""
    for image in bpy.data.images:
        name, now = image.name_full, (image.has_data, image.is_dirty, image.filepath)
        before = _states.get(name, now)
        _states[name] = now
        if before[1:] != now[1:] or (before[0] and not now[0]) or (tagged and image.is_dirty):
            _turns[name] = _turns.get(name, 0) + 1
    return sum(_turns.values())


_MOVING = {"SEQUENCE": "a sequence of images", "MOVIE": "a movie", "TILED": "an image of tiles",
           "VIEWER": "a render or viewer"}


def still(node):
    """The image of a node, None if it has none. Unknown: one of which Blender gives only the frame or tile that was
    last seen somewhere."""
    image = node.image
    if image is not None and image.source not in ("FILE", "GENERATED"):
        raise trees.Unknown(f"{node.name}: {_MOVING.get(image.source, image.source)}")
    return image


def _origin(image):
    """By what the pixels of an image are those of its file; None: they may be others, or may change untold, as those of
    a file that has been written since this module was loaded: Blender may have what was in it before."""
    if image.source != "FILE" or image.is_dirty:
        return None
    how = image.colorspace_settings.name, image.alpha_mode
    if image.packed_file:
        return *how, hashlib.sha256(image.packed_file.data).digest()
    path = bpy.path.abspath(image.filepath, library=image.library)
    try:
        file = os.stat(path)
    except OSError:
        return None
    return (*how, path, file.st_size, file.st_mtime_ns) if file.st_mtime_ns < _BEGUN else None


class Images:
    """Pictures as programs look into them, kept from one reading of the scene to the next."""

    def __init__(self):
        self._known = {}

    def drop(self, names):
        self._known = {key: known for key, known in self._known.items() if ("Image", key[0]) not in names}

    def keep_files(self):
        """Forgets all but images of files that are as they were, where nobody has told what has changed."""
        now = {image.name_full: image for image in bpy.data.images}
        self._known = {key: known for key, known in self._known.items()
                       if known[2] and key[0] in now and known[2] == _origin(now[key[0]])}

    def get(self, image, wrap, alone=False):
        """The job.Picture of a Blender image; alone: whether nobody asks for its alpha."""
        key = (image.name_full, image.colorspace_settings.name, image.alpha_mode, tuple(image.size),
               alone and has_alpha(image))
        now = _turns.get(image.name_full, 0)
        if key not in self._known or self._known[key][0] != now:
            self._known[key] = now, _levels(_pixels(image, alone)), _origin(image)
        texels, width, height, levels = self._known[key][1]
        return Picture(texels, width, height, levels, wrap)


class Instead:
    """Images of which some hold something else."""

    def __init__(self, images, others):
        """images: the Images of all else; others: {full name: what it holds instead, as values() gives it}."""
        self._images, self._others, self._known = images, others, {}

    def get(self, image, wrap, alone=False):
        """As Images.get()."""
        if image.name_full not in self._others:
            return self._images.get(image, wrap, alone)
        key = image.name_full, alone and has_alpha(image)
        if key not in self._known:
            self._known[key] = _levels(_whole(image, self._others[image.name_full], alone))
        texels, width, height, levels = self._known[key]
        return Picture(texels, width, height, levels, wrap)


def values(image):
    """What a Blender image holds, float32 (height, width, channels), row 0 at the bottom; None where its file is not
    there."""
    width, height = image.size
    if not width or not height or not image.channels:
        return None
    flat = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(height, width, image.channels)


def colors(picture):
    """Red, green and blue of what values() gave; grey three times."""
    return picture[..., :3] if picture.shape[2] > 2 else picture[..., :1].repeat(3, 2)


def linear(image):
    """values(), the colours scene-linear."""
    out = values(image)
    if out is not None and not image.is_float:
        colored = min(out.shape[2], 3) if out.shape[2] > 2 else 1
        out[..., :colored] = spaces.linear(image, out[..., :colored])[..., :colored]
    return out


def has_alpha(image):
    """Whether alpha says where an image is, and is not just a channel more."""
    return image.channels in (2, 4) and image.alpha_mode not in ("NONE", "CHANNEL_PACKED") and not (
        image.colorspace_settings.is_data)


def _pixels(image, alone):
    """(height, width, 4), scene-linear, row 0 at the bottom, multiplied by alpha if that says where the image is;
    magenta where the file is not there, as renderers have. alone: whether the alpha is not asked for: as in Cycles,
    bytes then are multiplied as they are in the file."""
    out = values(image)
    return np.array([[[1, 0, 1, 1]]], np.float32) if out is None else _whole(image, out, alone)


def _whole(image, out, alone):
    """Likewise of what an image holds, or is to hold."""
    whole = np.ones((*out.shape[:2], 4), np.float32)
    if out.shape[2] in (2, 4) and image.alpha_mode != "NONE":
        whole[..., 3] = out[..., -1]
    color, alpha = colors(out), whole[..., 3:]
    if not image.is_float:
        before = has_alpha(image) and alone and (alpha < 1).any()
        color = spaces.linear(image, color * alpha if before else color)
        if has_alpha(image) and not before:
            color = color * alpha
    whole[..., :3] = color
    return whole


def _levels(picture):
    """(texels of all levels of detail (n, 4), width, height, how many)."""
    height, width = picture.shape[:2]
    levels = [picture]
    while max(picture.shape[:2]) > 1:
        if len(picture) > 1:
            picture = (picture[:-1:2] + picture[1::2]) * np.float32(0.5)
        if picture.shape[1] > 1:
            picture = (picture[:, :-1:2] + picture[:, 1::2]) * np.float32(0.5)
        levels.append(picture)
    return np.concatenate([level.reshape(-1, 4) for level in levels]), width, height, len(levels)
