# SPDX-License-Identifier: GPL-3.0-or-later
"""What is on the screen, from the X server: Blender's own screenshots of 4.3 are black where Mesa draws."""

import ctypes
import struct
import zlib

import numpy as np

_X11 = ctypes.CDLL("libX11.so.6")
_X11.XOpenDisplay.restype, _X11.XDefaultRootWindow.restype = ctypes.c_void_p, ctypes.c_ulong
_DISPLAY = ctypes.c_void_p(_X11.XOpenDisplay(None))


class _Image(ctypes.Structure):
    """The beginning of an XImage."""
    _fields_ = [(name, ctypes.c_int) for name in ("width", "height", "xoffset", "format")] + [
        ("data", ctypes.c_void_p)] + [(name, ctypes.c_int) for name in (
            "byte_order", "bitmap_unit", "bitmap_bit_order", "bitmap_pad", "depth", "bytes_per_line")]


_X11.XGetImage.restype = ctypes.POINTER(_Image)


def grab():
    """(height, width, 3) of bytes, row 0 at the top; the screen has 24 bits a pixel."""
    root, at = ctypes.c_ulong(_X11.XDefaultRootWindow(_DISPLAY)), ctypes.c_int()
    size = [ctypes.c_uint() for _ in range(4)]  # width, height, border, depth
    _X11.XGetGeometry(_DISPLAY, root, *map(ctypes.byref, (ctypes.c_ulong(), at, at, *size)))
    got = _X11.XGetImage(_DISPLAY, root, 0, 0, size[0], size[1], ctypes.c_ulong(0xFFFFFF), 2)  # 2: ZPixmap
    image = got.contents
    rows = np.frombuffer(ctypes.string_at(image.data, image.height * image.bytes_per_line), np.uint8)
    rows = rows.reshape(image.height, -1, 4)[:, :image.width, 2::-1].copy()
    _X11.XFree(ctypes.c_void_p(image.data))
    _X11.XFree(got)
    return rows


def save(path):
    """Writes it as a PNG, by hand: Blender may let Python make no image while it renders."""
    rows = grab()
    height, width, _ = rows.shape
    lines = np.concatenate([np.zeros((height, 1), np.uint8), rows.reshape(height, -1)], 1)  # 0: no filter

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(lines.tobytes(), 1)) + chunk(b"IEND", b""))
