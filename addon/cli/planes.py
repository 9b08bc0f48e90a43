# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of an EXR without compression where they lie: its pages are mapped, and nothing is read twice.

`encre render` has Blender write its layers so, in a file of its own, to pack them into the one that stays.
"""

import mmap
import os
import struct

import numpy as np

_MANY = 0x1000  # parts, of the flags beside the version
_KINDS = {1: np.dtype("<f2"), 2: np.dtype("<f4")}
_NO_PIXELS, MISSING = "no scanlines without compression", "pixels are missing"


class Planes:
    """A context manager; planes[full channel name]: (H, W), half or float, row 0 at the top. ValueError: the file holds
    other pixels than scanlines without compression, or does not end where it should, as on a full disk."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self._data = mmap.mmap(file.fileno(), os.fstat(file.fileno()).st_size, access=mmap.ACCESS_READ)
        self._found = {}
        try:
            self._begin()
        except (struct.error, IndexError, KeyError, OverflowError):
            raise ValueError(_NO_PIXELS) from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._found.clear()  # the pages go with the last array

    def __contains__(self, name):
        return name in self._found

    def __getitem__(self, name):
        first, step, kind, height, width = self._found[name]
        return np.ndarray((height, width), kind, self._data, first, (step, kind.itemsize))

    def _begin(self):
        (flags,) = struct.unpack_from("<I", self._data, 4)
        many, at, parts = bool(flags & _MANY), 8, []
        while not parts or many:
            attributes, at = self._header(at)
            if not attributes:
                break
            parts.append(attributes)
        for attributes in parts:
            left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
            if attributes["compression"] != b"\0" or attributes.get("type", b"scanlineimage") != b"scanlineimage":
                raise ValueError(_NO_PIXELS)
            at = self._add(attributes, at, right - left + 1, bottom - top + 1, 12 if many else 8)

    def _header(self, at):
        found = {}
        while self._data[at]:
            name, at = self._word(at)
            _, at = self._word(at)
            (size,) = struct.unpack_from("<I", self._data, at)
            found[name], at = self._data[at + 4:at + 4 + size], at + 4 + size
        return found, at + 1

    def _word(self, at):
        end = self._data.find(b"\0", at)
        return self._data[at:end].decode(), end + 1

    def _add(self, attributes, at, width, height, head):
        """Finds a part's channels; where its table of offsets, which is at `at`, ends."""
        places = np.frombuffer(self._data[at:at + 8 * height], "<u8").astype(np.int64)
        view, listed, own, row = attributes.get("view", b"").decode(), attributes["channels"], 0, {}
        step = head
        while listed[own]:
            end = listed.index(b"\0", own)
            before, _, letter = listed[own:end].decode().rpartition(".")
            kind = _KINDS[struct.unpack_from("<i", listed, end + 1)[0]]
            row[".".join(filter(None, (before, view, letter)))] = step, kind
            step, own = step + kind.itemsize * width, end + 17
        if height < 1 or len(places) != height or (np.diff(places) != step).any() or not at < places[0] \
                or places[-1] + step > len(self._data):
            raise ValueError(MISSING)
        for name, (offset, kind) in row.items():
            self._found[name] = int(places[0]) + offset, step, kind, height, width
        return at + 8 * height
