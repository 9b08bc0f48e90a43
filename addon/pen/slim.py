# SPDX-License-Identifier: GPL-3.0-or-later
"""Slim files: of a rendered file what restyling reads, packed so that it gives the same picture in little room.

Half floats hold most of it. Where those are too coarse, a pass of its own holds the rest, and 0 elsewhere: where light
is so bright that a half's steps are seen, and at the rims of what is seen, where normals are compared with their like.
What mirrors show is kept where it is not the surface itself. Depths lose digits.
"""

from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from . import layers, saved
from .job import Camera

MOST_HALF = 65504.0
# Numbers must stay what they are. And colours: where lines run between them hangs on their last digits.
_FLOATS = ("DiffCol", "IndexOB", "IndexMA", "Encre Index", "Encre Anchor", "Encre Card")
_BITS = {"Depth": 18, "Encre Seen Depth": 12}  # that are kept of a float's 23
_BRIGHT = 8.0  # from here on halves are off by more than half of 1/255
_RIM = 0.01    # shorter by more than this, a normal is a mean of several surfaces'

# What slim files have in the place of others' passes: {pass: channel letters}.
PASSES = {"Encre Source Rest": "RGB", "Encre Diffuse Rest": "RGB", "Encre Normal Rest": "XYZ",
          "Encre Seen Normal": "XYZ", "Encre Seen Color": "RGB"}
_RESTS = {"Encre Source": "Encre Source Rest", "Encre Diffuse": "Encre Diffuse Rest", "Normal": "Encre Normal Rest"}
# {pass: (which it stands for, that of the surface itself, what its first channel holds where the two are the same)}
_SEEN = {"Encre Seen Normal": ("Denoising Normal", "Normal", 2.0),
         "Encre Seen Color": ("Denoising Albedo", "DiffCol", -1.0)}
STANDS = {name: seen for name, (seen, _, _) in _SEEN.items()}


def _renamed(full, name, other):
    before, _, after = full.rpartition(name)
    return before + other + after


class Packer:
    """`parts` {name: {full channel name: "half" or "float"}} of a slim file, and how they are made of a whole one's.

    found: what stored.view_layers() says of the whole file; read(passes): {pass: channels} of what restyling reads;
    kinds: {full channel name: kind}, of the whole file; camera: the job.Camera in its metadata, or None; keep: view
    layers with passes that are wanted as they are. Passes that are none of what Encre has rendered for itself stay.
    """

    def __init__(self, found: Mapping, read: Callable[[dict], Collection[str]], kinds: Mapping[str, str],
                 camera: Camera | None, keep: Collection[str] = ()) -> None:
        self.parts: dict[str, dict[str, str]] = {}
        self.make: dict[str, Any] = {}
        self.camera = camera
        own = {*layers.CYCLES, *layers.BEHIND, *layers.SEEN, *saved.passes()}
        for layer, eyes in found.items():
            for view, passes in eyes.items():
                wanted = {*read(passes), "Combined"}
                for name, names in passes.items():
                    where = layer, view, name
                    if name in wanted and f"{layer}.{name}" not in keep:
                        self._pack(where, names, passes)
                    elif name in wanted or name not in own or f"{layer}.{name}" in keep:
                        self._add(where, {full: kinds[full] for full in names}, names, lambda *rows: rows)

    def _add(self, where, kinds, names, make):
        """A part of channels `kinds`, made by `make` of those called `names`."""
        part = ".".join(filter(None, where))
        self.parts[part], self.make[part] = kinds, (names, make)

    def _pack(self, where, names, passes):
        layer, view, name = where
        for slim, (seen, own, mark) in _SEEN.items():
            if name == seen and self.camera and len(names) == 3 == len(passes.get(own, ())):
                kind = {_renamed(full, name, slim): "half" if own == "DiffCol" else "float" for full in names}
                self._add((layer, view, slim), kind, [*names, *passes[own]],
                          lambda *rows, own=own, mark=mark: self._seen(own, mark, *rows))
                return
        if name in (*_FLOATS, *_BITS, *STANDS.values()):
            bits = _BITS.get(name, 23)
            self._add(where, dict.fromkeys(names, "float"), names, lambda *rows: [rounded(row, bits) for row in rows])
            return
        self._add(where, dict.fromkeys(names, "half"), names, lambda *rows: [_halves(row) for row in rows])
        if rest := _RESTS.get(name):
            three = [full for full in names if full[-1] not in "aA"]
            self._add((layer, view, rest), {_renamed(full, name, rest): "half" for full in three}, three,
                      _rim if name == "Normal" else _bright)

    def _seen(self, own, mark, *rows):
        seen, itself = np.stack(rows[:3], -1), np.stack(rows[3:], -1)
        if own == "Normal":
            same = np.abs(seen - _camera_sees(itself, self.camera)) < 1e-5
        else:
            seen = half(seen)
            same = seen == half(itself)
        return np.moveaxis(np.where(same.all(-1, keepdims=True), np.array([mark, 0, 0], np.float32), seen), -1, 0)

    def sources(self, part: str) -> list[str]:
        """Names of the whole file's channels that `part` is made of."""
        return self.make[part][0]

    def pack(self, part: str, rows: list[np.ndarray]) -> dict[str, np.ndarray]:
        """{full channel name: rows (H, W)} of `part` from those of its sources()."""
        return dict(zip(self.parts[part], self.make[part][1](*rows), strict=True))


def unpack(pictures: dict[str, np.ndarray], camera: Camera | None) -> None:
    """Puts into `pictures` {pass: (H, W, channels)} of a slim file what restyling reads. Of whole files, nothing."""
    for name, rest in _RESTS.items():
        if rest in pictures and name in pictures:
            pictures[name] = np.array(pictures[name])
            pictures[name][..., :3] += pictures.pop(rest)
    for slim, (seen, own, mark) in _SEEN.items():
        if slim in pictures and camera and own in pictures:
            kept, itself = pictures.pop(slim), pictures[own]
            itself = _camera_sees(itself, camera) if own == "Normal" else itself
            pictures[seen] = np.where(kept[..., :1] == mark, itself, kept)


def _camera_sees(normal, camera):
    """Normals of the world as Cycles' camera has them, which looks along +z."""
    return normal @ (np.reshape(camera.view, (3, 3)).T * (1, 1, -1)).astype(np.float32)


def half(values: np.ndarray) -> np.ndarray:
    """Floats as a half holds them."""
    return _halves(values).astype(np.float32)


def _held(values):
    """Floats of those that a half can hold; most are, and looking is quicker than writing them anew."""
    if values.size and not (values.min() >= -MOST_HALF and values.max() <= MOST_HALF):
        return np.clip(values, -MOST_HALF, MOST_HALF)
    return values


def _halves(values):
    return _held(values).astype(np.float16)


def _bright(*rows):
    return [_rest(_held(row)) for row in rows]


def _rest(row):
    bright = np.abs(row) >= _BRIGHT
    return np.where(bright, row - half(row), np.float32(0)) if bright.any() else np.zeros_like(row)


def _rim(*rows):
    length = np.sqrt(sum(np.square(row) for row in rows))
    return [np.where(np.abs(length - 1) < _RIM, np.float32(0), row - half(row)) for row in rows]


def rounded(values: np.ndarray, bits: int) -> np.ndarray:
    """Floats with so many bits of their mantissa, the others 0."""
    if bits == 23:
        return values
    words, lost = np.ascontiguousarray(values, np.float32).view(np.uint32), 23 - bits
    nearest = (words + np.uint32(1 << (lost - 1))) & np.uint32(0xFFFFFFFF << lost & 0xFFFFFFFF)
    return np.where(np.isfinite(values), nearest, words).astype(np.uint32).view(np.float32)
