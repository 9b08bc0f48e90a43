# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images: their values, and pictures that programs of materials look into, with levels of detail."""

import hashlib
import os
import time
from dataclasses import replace

import bpy
import numpy as np

from ..pen import library
from ..pen.job import Picture
from . import spaces, trees

_ROWS = 1024  # of a picture that are looked at at once
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


class _Flats:
    """Pictures in flat colors, kept as long as what they were made of."""

    def __init__(self):
        self._flats = {}  # -> (texels of what it was made of, picture)

    def flat(self, picture, most):
        """The job.Picture in at most so many flat colors."""
        key = id(picture.texels), picture.wrap == "repeat", most
        if key not in self._flats or self._flats[key][0] is not picture.texels:
            self._flats[key] = picture.texels, _flattened(picture, most)
        return replace(self._flats[key][1], wrap=picture.wrap)

    def _tidy(self, pictures):
        used = {id(picture.texels) for picture in pictures}
        self._flats = {key: flat for key, flat in self._flats.items() if key[0] in used}


class Images(_Flats):
    """Pictures as programs look into them, kept from one reading of the scene to the next."""

    def __init__(self):
        super().__init__()
        self._known = {}

    def drop(self, names):
        self._keep(lambda key, known: ("Image", key[0]) not in names)

    def _keep(self, is_good):
        self._known = {key: known for key, known in self._known.items() if is_good(key, known)}
        self._tidy(known[1] for known in self._known.values())

    def keep_files(self):
        """Forgets all but images of files that are as they were, where nobody has told what has changed."""
        now = {image.name_full: image for image in bpy.data.images}
        self._keep(lambda key, known: known[2] and key[0] in now and known[2] == _origin(now[key[0]]))

    def get(self, image, wrap, alone=False):
        """The job.Picture of a Blender image; alone: whether nobody asks for its alpha."""
        key = (image.name_full, image.colorspace_settings.name, image.alpha_mode, tuple(image.size),
               alone and has_alpha(image))
        now = _turns.get(image.name_full, 0)
        if key not in self._known or self._known[key][0] != now:
            self._known[key] = now, _picture(image, alone), _origin(image)
        return replace(self._known[key][1], wrap=wrap)


class Instead(_Flats):
    """Images of which some hold something else."""

    def __init__(self, images, others):
        """images: the Images of all else; others: {full name: what it holds instead, as values() gives it}."""
        super().__init__()
        self._images, self._others, self._known = images, others, {}

    def get(self, image, wrap, alone=False):
        """As Images.get()."""
        if image.name_full not in self._others:
            return self._images.get(image, wrap, alone)
        key = image.name_full, alone and has_alpha(image)
        if key not in self._known:
            self._known[key] = _levels(_whole(image, self._others[image.name_full], alone))
        return replace(self._known[key], wrap=wrap)

    def flat(self, picture, most):
        own = any(picture.texels is known.texels for known in self._known.values())
        return super().flat(picture, most) if own else self._images.flat(picture, most)


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


_shares = {}  # what share_below() has found of files that are as they were


def share_below(image, channel, most):
    """In how much of an image a channel (None: the mean of all) is at most so much; all of it where its file is not
    there. Asked of every fourth texel each way of a large one."""
    key = image.name_full, _origin(image), channel, most
    if key[1] is None or key not in _shares:
        out = values(image)
        if out is None:
            return 1.0
        step = 4 if min(out.shape[:2]) >= 512 else 1
        out = np.ascontiguousarray(colors(out[::step, ::step]))
        out = out if image.is_float else spaces.linear(image, out)
        _shares[key] = float(((out.mean(2) if channel is None else out[..., channel]) <= most).mean())
    return _shares[key]


def has_alpha(image):
    """Whether alpha says where an image is, and is not just a channel more."""
    return image.channels in (2, 4) and image.alpha_mode not in ("NONE", "CHANNEL_PACKED") and not (
        image.colorspace_settings.is_data)


def _picture(image, alone):
    """Its job.Picture, its colors multiplied by alpha if that says where the image is; magenta where the file is not
    there, as renderers have. alone: whether the alpha is not asked for: as in Cycles, bytes then are multiplied as they
    are in the file."""
    out = values(image)
    if out is None:
        return _levels(np.array([[[1, 0, 1, 1]]], np.float32))
    curve = None if image.is_float else spaces.curve(image)
    return _levels(_whole(image, out, alone)) if curve is None else _bytes(image, out, curve, alone)


def _bytes(image, out, curve, alone):
    """Of an image of 8 bits, which stay bytes: a quarter of the memory."""
    height, width = out.shape[:2]
    levels = max(width, height).bit_length()
    count = sum(max(1, width >> k) * max(1, height >> k) for k in range(levels))
    texels = np.empty((count, 4), np.uint8)
    first, apart = texels[:width * height].reshape(height, width, 4), has_alpha(image)
    clear = out.shape[2] in (2, 4) and image.alpha_mode != "NONE"
    before = apart and alone and (out[..., -1] < 1).any()
    for y in range(0, height, _ROWS):  # of which there may be 16,384
        some = out[y:y + _ROWS]
        color = colors(some)
        first[y:y + _ROWS, :, :3] = (color * some[..., -1:] if before else color) * np.float32(255) + np.float32(0.5)
        first[y:y + _ROWS, :, 3] = some[..., -1] * np.float32(255) + np.float32(0.5) if clear else 255
    made = Picture(texels, width, height, levels, curve=curve, straight=apart and not before)
    library.load().picture_levels(made)
    return made


def _whole(image, out, alone):
    """(height, width, 4), scene-linear, row 0 at the bottom, of what an image holds, or is to hold."""
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


def _flattened(picture, most):
    """A job.Picture in flat colors, with levels of detail of its own."""
    if picture.curve is not None:
        made = replace(picture, texels=picture.texels.copy())
        library.load().flatten(made, most)
        library.load().picture_levels(made)
        return made
    first = np.array(picture.texels[:picture.width * picture.height])
    library.load().flatten(replace(picture, texels=first, levels=1), most)
    return _levels(first.reshape(picture.height, picture.width, 4))


def _levels(picture):
    """The job.Picture of scene-linear colors and its levels of detail."""
    height, width = picture.shape[:2]
    levels = [picture]
    while max(picture.shape[:2]) > 1:
        if len(picture) > 1:
            picture = (picture[:-1:2] + picture[1::2]) * np.float32(0.5)
        if picture.shape[1] > 1:
            picture = (picture[:, :-1:2] + picture[:, 1::2]) * np.float32(0.5)
        levels.append(picture)
    return Picture(np.concatenate([level.reshape(-1, 4) for level in levels]), width, height, len(levels))
