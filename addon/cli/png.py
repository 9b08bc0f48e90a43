# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files, through OpenImageIO: 8-bit sRGB pictures with texts."""

import struct
import zlib

import numpy as np

from ..pen import colour
from . import images

MOST = 32768  # pixels each way
_ROWS = 512   # encoded at a time


def write(path, rgba, window, texts=None, shown=colour.encode_srgb):
    """Writes scene-linear, premultiplied (H, W, 4) as 8 bits with straight alpha, whole or not at all.

    shown: what makes of straight colours (rows, W, 3) those of a display; texts: {key: text} to store.

    The picture is the display window: PNG has no other. Raises images.WriteError where the file can't be written.
    """
    oiio = images.openimageio()
    if max(window.full_width, window.full_height) > MOST:
        raise images.WriteError(f"{path}: the display window is {window.full_width} x {window.full_height}, and a PNG "
                                f"has at most {MOST} pixels each way; write an .exr")
    picture = np.zeros((window.full_height, window.full_width, 4), np.uint8)
    left, right = max(window.x, 0), min(window.x + window.width, window.full_width)
    for y in range(max(window.y, 0), min(window.y + window.height, window.full_height), _ROWS):
        rows = rgba[y - window.y:, max(left - window.x, 0):right - window.x][:min(_ROWS, window.full_height - y)]
        picture[y:y + len(rows), left:right] = _bytes(rows, shown)
    spec = oiio.ImageSpec(window.full_width, window.full_height, 4, "uint8")
    spec["oiio:ColorSpace"] = "sRGB"
    spec["oiio:UnassociatedAlpha"] = 1  # the pixels are straight already
    images.write(path, spec, picture, lambda part: stamp(part, texts or {}))


def _bytes(rgba, shown):
    alpha = np.clip(rgba[:, :, 3:], 0, 1)
    encoded = shown(rgba[:, :, :3] / np.where(alpha > 0, alpha, 1))
    return np.round(255 * np.concatenate([encoded, alpha], axis=2)).astype(np.uint8)


def stamp(path, texts):
    """Puts {key: text} into a PNG file, which Blender gives only texts of its own. OSError."""
    with open(path, "rb") as file:
        data = file.read()
    if not data.startswith(b"\x89PNG"):
        return
    chunks = b""
    for key, said in texts.items():
        body = b"tEXt" + key.encode("latin-1") + b"\0" + said.encode("latin-1")
        chunks += struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    with open(path, "wb") as file:
        file.write(data[:33] + chunks + data[33:])  # after IHDR, which always has this length
