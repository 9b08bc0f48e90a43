# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines that meshes tell of, as a picture and its file have them: chains of mesh edges with the numbers of the layer
`object`, so exact as a file keeps them."""

import base64
import lzma
from typing import Any

import numpy as np

from . import abi
from .job import Chains

_STEPS = {"x": 256, "y": 256, "bend": 16, "over": 16, "gap": 16, "along": 16,
          "fade": 63}  # to a pixel, a degree, all of a width
_DEPTH_BITS = 10  # of a depth that are dropped: what is left tells it to 1 in 8,192
_MOST = 1 << 24  # points of a file: more are not read
_MEMORY = 1 << 27  # bytes that unpacking may take besides
_COLUMNS = tuple(name for name in abi.CHAIN_POINT.names or ())
_COLOR = 1 << abi.CHAIN_KINDS.index("color")
_FAR = 1e9  # of a gap: nothing is behind


def told(points: np.ndarray, numbers: np.ndarray, whole: np.ndarray) -> Chains:
    """The Chains of what library.chains() gave.

    numbers: by the rasteriser's number of an object, what the layer `object` says for it; whole: likewise, bits: 1, all
    its lines of shapes are among the points: those of others are dropped, and of parts by pass index; 2, all its lines
    of colors are.
    """
    color = (points["kind"] & _COLOR) > 0
    kept = (whole & 1 > 0) & (numbers >= 0)
    points = points[(points["object"] == 0) | kept[points["object"]] | (color & (numbers >= 0)[points["object"]])]
    out = _rounded(points)
    for name in ("object", "behind"):
        out[name] = numbers[out[name]]
    chained = np.zeros(int(max(numbers.max(), 0)) + 1, np.uint8)
    known = numbers >= 0
    chained[numbers[known].astype(np.intp)] = 3
    np.bitwise_and.at(chained, numbers[known].astype(np.intp), whole[known].astype(np.uint8))
    return Chains(out, chained)


def shrunk(chains: Chains, factor: int) -> Chains:
    """Those of a picture that is drawn `factor` times as large, in its own pixels."""
    if factor == 1:
        return chains
    points = chains.points.copy()
    for name in ("x", "y"):
        points[name] = (points[name] + np.float32(0.5)) / np.float32(factor) - np.float32(0.5)
    for name in ("along", "gap"):
        points[name] /= np.float32(factor)
    points["gap"][chains.points["gap"] >= _FAR] = _FAR
    return Chains(_rounded(points), chains.chained)


def _rounded(points):
    out = points.copy()
    for name, steps in _STEPS.items():
        out[name] = np.round(points[name] * np.float32(steps)) / np.float32(steps)
    out["gap"][points["gap"] >= _FAR] = _FAR
    bits = np.ascontiguousarray(points["depth"]).view(np.int32)
    out["depth"] = (bits + (1 << _DEPTH_BITS >> 1) >> _DEPTH_BITS << _DEPTH_BITS).view(np.float32)
    return out


def pack(chains: Chains) -> str:
    """As text, from which unpack() makes the same bytes: columns of whole numbers, their differences, compressed."""
    points, columns = chains.points, {}
    for name in _COLUMNS:
        column = points[name]
        if name == "depth":
            columns[name] = np.ascontiguousarray(column).view(np.int32) >> _DEPTH_BITS
        elif name == "gap":
            columns[name] = np.where(column >= _FAR, -1, np.round(column * _STEPS[name])).astype(np.int32)
        else:
            columns[name] = np.round(column * _STEPS[name]).astype(np.int32) if name in _STEPS else column
    columns["left"], columns["right"] = columns.pop("color").T
    begin, end = columns.pop("along").T
    columns["begin"], columns["end of"] = begin - np.concatenate([[0], end[:-1]]), end - begin
    table = np.stack([column if name in ("begin", "end of") else np.diff(column, prepend=0)
                      for name, column in columns.items()]).astype("<i4")
    data = np.ascontiguousarray(table.view(np.uint8).reshape(*table.shape, 4).transpose(0, 2, 1))
    head = np.array([len(points), len(chains.chained)], "<i4").tobytes()
    bits = b"".join(np.packbits(chains.chained >> k & 1).tobytes() for k in range(2))
    return base64.b64encode(lzma.compress(head + bits + data.tobytes())).decode()


def unpack(text: Any) -> Chains:
    """The Chains of what pack() gave; ValueError or lzma.LZMAError: it is none."""
    stream = lzma.LZMADecompressor(memlimit=_MEMORY)
    head = stream.decompress(base64.b64decode(text, validate=True), 8)
    count, objects = map(int, np.frombuffer(head, "<i4"))
    if not 0 <= count <= _MOST or not 0 <= objects <= _MOST:
        raise ValueError
    bits, columns, data = (objects + 7) // 8, len(_COLUMNS) + 2, b""
    size = 2 * bits + 4 * columns * count
    while len(data) < size and not stream.eof:
        data += stream.decompress(b"", size - len(data))
    shapes, colors = (np.unpackbits(np.frombuffer(data[k * bits:][:bits], np.uint8), count=objects) for k in range(2))
    chained = shapes | colors << 1
    table = np.frombuffer(data[2 * bits:], np.uint8).reshape(columns, 4, count).transpose(0, 2, 1)
    whole = np.ascontiguousarray(table).view("<i4")[..., 0]
    sums = iter(np.cumsum(whole[:-2], axis=1, dtype=np.int32))
    points: Any = np.zeros(count, abi.CHAIN_POINT)
    end = np.cumsum(whole[-2] + whole[-1], dtype=np.int32)
    for name in _COLUMNS:
        if name == "color":
            continue
        column = np.stack([end - whole[-1], end], 1) if name == "along" else next(sums)
        if name == "depth":
            points[name] = (column << _DEPTH_BITS).view(np.float32)
        elif name in _STEPS:
            points[name] = column.astype(np.float32) / np.float32(_STEPS[name])
        else:
            points[name] = column
    points["color"] = np.stack([next(sums), next(sums)], 1)
    points["gap"][points["gap"] < 0] = _FAR
    return Chains(points, chained)
