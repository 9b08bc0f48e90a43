# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads OpenEXR files of scanlines by numpy alone: the engine has no library for them that all Blenders bring.

As Blender and `encre render` write them by default: any number of parts, half, float and whole numbers, without
compression or with ZIP.
"""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import plain
from .errors import EncreError

_MAGIC, _TILED, _DEEP, _PARTS = 20000630, 0x200, 0x800, 0x1000
_ROWS = {0: 1, 2: 1, 3: 16}  # compression -> rows of a chunk: none, ZIP by single rows, ZIP
_OTHERS = {1: "RLE", 4: "PIZ", 5: "Pxr24", 6: "B44", 7: "B44A", 8: "DWAA", 9: "DWAB"}
_TYPES = [np.dtype("<u4"), np.dtype("<f2"), np.dtype("<f4")]
_MOST_PACKED = 2000  # values in a byte of a file: no compression does better than a fourth of that


@dataclass
class _Part:
    texts: dict[str, Any] = field(default_factory=dict)  # attributes as they are in the file
    channels: dict[str, tuple[int, np.dtype]] = field(default_factory=dict)  # name -> (byte of a row, type)
    row: int = 0       # bytes of all channels
    rows: int = 0      # of a chunk
    chunks: list[int] = field(default_factory=list)


class Exr:
    """`channels`: full names of all channels, in the file's order, `views` the eyes of a stereo picture, `texts` the
    text attributes, `window` (width, height, x, y, full width, full height), x and y from the full picture's corner.

    EncreError: the file is missing, damaged, or written otherwise than this reads.
    """

    def __init__(self, path: str) -> None:
        self.path = path
        try:
            self._data = plain.content(path)
        except OSError as error:
            raise EncreError(f"{path}: can't be read: {error.strerror}") from None
        self._parts: list[_Part] = []
        self.texts: dict[str, str] = {}
        self.views: list[str] = []
        try:
            self._begin()
        except (struct.error, IndexError, KeyError, ValueError, OverflowError):
            raise EncreError(f"{path}: is not a readable OpenEXR file; give a multilayer EXR") from None

    def _begin(self):
        magic, version = struct.unpack_from("<iI", self._data)
        if magic != _MAGIC:
            raise ValueError
        if version & (_TILED | _DEEP):
            raise EncreError(f"{self.path}: holds tiles or deep pixels; save it as a multilayer EXR of Blender's")
        at, self._many = 8, bool(version & _PARTS)
        while True:
            at, attributes = self._header(at)
            if not attributes:
                break
            self._add(attributes)
            if not self._many:
                break
        windows = {(part.texts["dataWindow"], part.texts["displayWindow"]) for part in self._parts}
        if len(windows) != 1:
            raise EncreError(f"{self.path}: its parts differ in size; save all passes in one size")
        (left, top, right, bottom), (full_left, full_top, full_right, full_bottom) = (
            struct.unpack("<4i", box) for box in windows.pop())
        self._top = top
        width, height = right - left + 1, bottom - top + 1
        self.window = (width, height, left - full_left, top - full_top, full_right - full_left + 1,
                       full_bottom - full_top + 1)
        values = width * height * sum(len(part.channels) for part in self._parts)
        if min(width, height) < 1 or values > _MOST_PACKED * len(self._data):
            raise ValueError
        for part in self._parts:
            count = -(-height // part.rows)
            part.chunks = list(struct.unpack_from(f"<{count}Q", self._data, at))
            at += 8 * count
            row = 0
            for name, (_, kind) in part.channels.items():
                part.channels[name] = row, kind
                row += kind.itemsize * width
            part.row = row
        self.channels = [self._full(part, name) for part in self._parts for name in part.channels]

    def _header(self, at):
        """(where it ends, {attribute: bytes}) of the header that begins there."""
        found = {}
        while self._data[at]:
            name, at = self._word(at)
            _, at = self._word(at)
            (size,) = struct.unpack_from("<i", self._data, at)
            if size < 0:
                raise ValueError
            found[name] = self._data[at + 4:at + 4 + size]
            at += 4 + size
        return at + 1, found

    def _word(self, at, data=None):
        data = data or self._data
        end = data.index(b"\0", at)
        return data[at:end].decode(errors="replace"), end + 1

    def _add(self, attributes):
        packed = attributes["compression"][0]
        if packed not in _ROWS:
            raise EncreError(f"{self.path}: is compressed by {_OTHERS.get(packed, packed)}, which Encre doesn't read "
                             "in Blender; save it with the codec ZIP")
        if attributes.get("type", b"scanlineimage") != b"scanlineimage":
            raise EncreError(f"{self.path}: holds tiles or deep pixels; save it as a multilayer EXR of Blender's")
        part, listed, at = _Part(attributes, rows=_ROWS[packed]), attributes["channels"], 0
        while listed[at]:
            name, at = self._word(at, listed)
            kind, _, across, down = struct.unpack_from("<iI2i", listed, at)
            if (across, down) != (1, 1):
                raise ValueError
            part.channels[name], at = (0, _TYPES[kind]), at + 16
        for name, value in attributes.items():
            if name.startswith("encre.") or name == "colorInteropID":
                self.texts.setdefault(name, value.decode(errors="replace"))
        names, at = attributes.get("multiView", b""), 0
        while at < len(names):
            (size,) = struct.unpack_from("<i", names, at)
            self.views.append(names[at + 4:at + 4 + size].decode())
            at += 4 + max(size, 0)
        if view := attributes.get("view", b"").decode():
            self.views.append(view)
        self.views = list(dict.fromkeys(self.views))
        self._parts.append(part)

    def _full(self, part, name):
        """A channel's name with its view, which a part may tell for all."""
        view = part.texts.get("view", b"").decode()
        before, _, letter = name.rpartition(".")
        return f"{before}.{view}.{letter}" if view else name

    def read(self, channels: list[str]) -> dict[str, np.ndarray]:
        """{full name: float32 (height, width)}, row 0 at the top. EncreError: one is not there, or the file ends."""
        if lost := [name for name in channels if name not in self.channels]:
            raise EncreError(f"{self.path}: has no channel {lost[0]}; render it with Save Layers")
        width, height = self.window[:2]
        found = {name: np.empty((height, width), np.float32) for name in channels}
        try:
            for part in self._parts:
                wanted = [(*part.channels[name], found[full]) for name in part.channels
                          if (full := self._full(part, name)) in found]
                there = np.zeros(height, bool)
                for first, rows in self._chunks(part) if wanted else ():
                    there[first:first + len(rows)] = True
                    for at, kind, picture in wanted:
                        those = np.ascontiguousarray(rows[:, at:at + kind.itemsize * width]).view(kind)
                        picture[first:first + len(rows)] = those
                if wanted and not there.all():  # a chunk stands in another's place
                    raise ValueError
        except (struct.error, IndexError, ValueError, OverflowError, zlib.error):
            raise EncreError(f"{self.path}: can't be read to its end; render or copy it again") from None
        return found

    def _chunks(self, part: _Part) -> Iterator[tuple[int, np.ndarray]]:
        """(row, bytes (rows, part.row)) of each."""
        height = self.window[1]
        for at in part.chunks:
            head = 4 if self._many else 0
            y, size = struct.unpack_from("<ii", self._data, at + head)
            first = y - self._top
            count = min(part.rows, height - first)
            if not 0 <= first < height or size < 0:
                raise ValueError
            packed = self._data[at + head + 8:at + head + 8 + size]
            whole = count * part.row
            rows = np.frombuffer(packed, np.uint8) if size == whole else _unzip(packed, whole)
            yield first, rows.reshape(count, part.row)


def _unzip(packed, size):
    """Bytes of a chunk: differences of neighbours, of which the even bytes come first."""
    steps = np.frombuffer(zlib.decompressobj().decompress(packed, size), np.uint8).copy()
    if len(steps) != size:
        raise ValueError
    steps[1:] -= 128
    whole = np.cumsum(steps, dtype=np.uint8)
    out, half = np.empty(size, np.uint8), (size + 1) // 2
    out[::2], out[1::2] = whole[:half], whole[half:]
    return out
