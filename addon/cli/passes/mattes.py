# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte, of any renderer: which thing covers how much of a pixel, as numbers of objects and of materials.

A file names its mattes in the metadata `cryptomatte/KEY/…` (name, and as JSON the names of things with their hashes)
and holds each in layers NAME00, NAME01 …, of which each has two ranks: R an identity and G its share of the pixel, B
and A likewise. Identities are hashes, stored as the bits of floats.
"""

import json
import re
from dataclasses import dataclass, field

import numpy as np

# Words of a matte's name -> the pass that it stands for; others are objects.
_KINDS = (("IndexMA", ("material", "mtl", "shader", "mat")),
          ("IndexOB", ("object", "node", "obj", "instance", "asset")))
_PREFERRED = "object", "node", "material"  # where there are several of a kind
_KNOWN = re.compile(r"(?i)(.*crypto.*?)(\d\d)")
_ABOVE = 1 << 24  # numbers are whole numbers in floats


@dataclass(frozen=True)
class Matte:
    """`name`; `channels`: full names, an identity and its share of each rank; `names` {identity: thing}, {} unknown."""

    name: str
    channels: tuple[str, ...]
    names: dict = field(default_factory=dict, hash=False)


def found(channels, metadata, view=""):
    """{IndexOB, IndexMA: Matte} of those that a file has for a view, by its channels and text metadata."""
    told = {text: key.rpartition("/")[0] for key, text in metadata.items()
            if key.startswith("cryptomatte/") and key.endswith("/name")}
    layers = {}
    for full in channels:
        layer, _, letter = full.rpartition(".")
        layer = layer.removesuffix(f".{view}") if view else layer
        match = re.fullmatch(r"(.+?)(\d\d)", layer)
        if match and (match[1] in told or _KNOWN.fullmatch(layer.rpartition(".")[2])):
            layers.setdefault(match[1], {}).setdefault(int(match[2]), {})[letter[:1].upper()] = full
    best = {}
    for name, ranks in layers.items():
        wanted = tuple(ranks[number][letter] for number in sorted(ranks) for pair in (("R", "G"), ("B", "A"))
                       if all(each in ranks[number] for each in pair) for letter in pair)
        if not wanted and "R" in ranks[min(ranks)]:  # it is known who covers most, and not how much
            wanted = (ranks[min(ranks)]["R"],)
        kind, rank = _kind(name)
        if wanted and (kind not in best or rank < best[kind][0]):
            best[kind] = rank, Matte(name, wanted, _names(metadata.get(f"{told.get(name)}/manifest")))
    return {kind: matte for kind, (_, matte) in best.items()}


def _kind(name):
    """(the pass that a matte stands for, which is taken first of several)."""
    words = re.sub(r"(?i)crypto(_?matte)?", "", name.rpartition(".")[2]).lower()
    kind = next((kind for kind, known in _KINDS if any(word in words for word in known)), "IndexOB")
    return kind, next((k for k, word in enumerate(_PREFERRED) if word in words), len(_PREFERRED))


def _names(manifest):
    """{identity: name} of a manifest, {} of one that can't be read."""
    try:
        said = json.loads(manifest or "{}")
        return {int(bits, 16): str(name) for name, bits in said.items()}
    except (ValueError, TypeError, AttributeError, RecursionError):
        return {}


class Numbers:
    """Numbers for the identities of a matte, the same in all bands of a picture and, where it has names, in all frames
    that have the same things; 0: nothing."""

    def __init__(self, matte):
        named = sorted(matte.names, key=lambda bits: (matte.names[bits], bits))
        self.known = {0: 0, **{bits: k for k, bits in enumerate(named, 1) if bits}}
        self.taken = set(self.known.values())

    def _number(self, bits):
        if bits not in self.known:
            number = bits % (_ABOVE - 1) + 1  # which does not hang on what else is seen
            while number in self.taken:
                number = number % (_ABOVE - 1) + 1
            self.known[bits] = number
            self.taken.add(number)
        return self.known[bits]

    def of(self, picture):
        """(height, width, 1) of the channels of a Matte (height, width, n)."""
        if picture.shape[2] == 1:
            covers = picture
        else:
            share = np.nan_to_num(np.maximum(picture[..., 1::2], 0))
            most = share.argmax(2)[..., None]
            covers, most = np.take_along_axis(picture[..., ::2], most, 2), np.take_along_axis(share, most, 2)
            # Ranks that are empty, and what no rank covers, are nothing.
            covers = np.where((most > 0) & (most >= 1 - share.sum(2, keepdims=True)), covers, np.float32(0))
        bits, inverse = np.unique(np.ascontiguousarray(covers, np.float32).view(np.uint32), return_inverse=True)
        numbers = np.array([self._number(word) for word in bits.tolist()], np.float32)
        return numbers[inverse].reshape(covers.shape)
