# SPDX-License-Identifier: GPL-3.0-or-later
"""Color spaces of images as OpenColorIO has them, by whatever names a studio's configuration gives them: Blender is
given a picture of 16 bits, which it makes scene-linear as it loads it."""

import os
import struct
import zlib

import bpy
import numpy as np

from ..pen.colour import decode_srgb
from . import threads, versions

# Of pictures of 8 bits. One by one: last bits of a whole array's depend on where it lies in numpy up to 1.24.
_DECODED = np.array([decode_srgb(value / 255) for value in range(256)], np.float32)
_BYTES = np.arange(256, dtype=np.float32) / np.float32(255)
_NEAR = 1e-4   # by which what 16 bits tell may differ
_ROWS = 1024   # of a picture that are given to Blender at once
_known = {}    # (configuration, working space, name of a space) -> "sRGB", "linear", or "other"


def linear(image, picture):
    """Colours (height, width, 3 or 1) of an image of 8 bits as it holds them, 0 to 1 -> scene-linear ones."""
    settings = image.colorspace_settings
    if settings.is_data:
        return picture
    kind = _kind(settings.name)
    if kind == "linear":
        return picture
    if kind == "sRGB":
        return _DECODED[(picture * np.float32(255) + np.float32(0.5)).astype(np.uint8)]
    three = picture if picture.shape[2] == 3 else picture.repeat(3, 2)
    return np.concatenate([_by_blender(settings.name, three[y:y + _ROWS]) for y in range(0, len(three), _ROWS)])


def curve(image):
    """256 scene-linear values, one for each an image of 8 bits may hold; None where its space mixes colors."""
    settings = image.colorspace_settings
    kind = "linear" if settings.is_data else _kind(settings.name)
    return {"linear": _BYTES, "sRGB": _DECODED}.get(kind)


def _kind(name):
    key = os.environ.get("OCIO", ""), versions.working_space(), name
    if key[:2] in (("", ""), ("", "lin_rec709_scene")) and name == "sRGB":
        return "sRGB"  # Blender's own
    if key not in _known:
        ramp = np.arange(256, dtype=np.float32)[:, None].repeat(3, 1) / np.float32(255)
        given = np.concatenate([ramp, np.eye(3, dtype=np.float32), 1 - np.eye(3, dtype=np.float32)])[None]
        found = _by_blender(name, given)
        _known[key] = next((kind for kind, curve in (("linear", given), ("sRGB", decode_srgb(given)))
                            if np.abs(found - curve).max() < _NEAR), "other")
    return _known[key]


def _by_blender(name, picture):
    """(height, width, 3) 0 to 1 of a space -> scene-linear."""
    height, width, _ = picture.shape
    data = _png(picture)

    def load():
        image = bpy.data.images.new("Encre", width, height)
        try:
            image.pack(data=data, data_len=len(data))
            image.source = "FILE"
            image.colorspace_settings.name = name
            flat = np.empty(width * height * image.channels, np.float32)
            image.pixels.foreach_get(flat)
            return flat.reshape(height, width, -1)[::-1, :, :3]
        finally:
            bpy.data.images.remove(image)

    return threads.on_main_thread(load, lambda: True)


def _png(picture):
    """A picture of 16 bits."""
    height, width, _ = picture.shape
    rows = np.zeros((height, 1 + 6 * width), np.uint8)
    rows[:, 1:] = np.rint(np.clip(picture, 0, 1) * 65535).astype(">u2").reshape(height, -1).view(np.uint8)

    def part(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 2, 0, 0, 0))
            + part(b"IDAT", zlib.compress(rows, 1)) + part(b"IEND", b""))
