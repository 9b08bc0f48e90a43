# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise, Blender's or the system's, by its C functions: light, and what mirrors and glass show, without
Monte-Carlo noise."""

import ctypes as c
import ctypes.util
import functools
import glob
import os
import sys
from collections.abc import Callable, Sequence

import numpy as np

from . import abi, background, samples
from .around import Window
from .errors import EncreError
from .job import Work

_CPU, _FLOAT3 = 1, 3
_PAD = 32  # mirrored pixels beyond the frame: less lets stripes along it through
OVERLAP = 80  # how far its network sees, on its grid
REACH = OVERLAP + samples.REACH  # with what evens out what it leaves
_GRID = 16  # on which the network halves pictures: places on it give the same in every part of a frame
_ROWS, _PIXELS = 34 * _GRID, 1 << 20  # of a strip, one or the other: between two of them it can be cancelled
_FAST, _FAST_SINCE = 4, 20300
# Parameters and result of each function used; handles are pointers.
_SIGNATURES = {
    "oidnNewDevice": (c.c_void_p, c.c_int),
    "oidnSetDeviceInt": (None, c.c_void_p, c.c_char_p, c.c_int),
    "oidnGetDeviceInt": (c.c_int, c.c_void_p, c.c_char_p),
    "oidnCommitDevice": (None, c.c_void_p),
    "oidnReleaseDevice": (None, c.c_void_p),
    "oidnGetDeviceError": (c.c_int, c.c_void_p, c.POINTER(c.c_char_p)),
    "oidnNewFilter": (c.c_void_p, c.c_void_p, c.c_char_p),
    "oidnReleaseFilter": (None, c.c_void_p),
    "oidnSetFilterBool": (None, c.c_void_p, c.c_char_p, c.c_bool),
    "oidnSetFilterInt": (None, c.c_void_p, c.c_char_p, c.c_int),
    "oidnSetFilterFloat": (None, c.c_void_p, c.c_char_p, c.c_float),
    "oidnSetSharedFilterImage": (None, c.c_void_p, c.c_char_p, c.c_void_p, c.c_int, *[c.c_size_t] * 5),
    "oidnCommitFilter": (None, c.c_void_p),
    "oidnExecuteFilter": (None, c.c_void_p),
}


def _candidates(home):
    """Paths of the library: the one in `home`, then the system's."""
    names = {"darwin": "lib/libOpenImageDenoise*.dylib", "win32": "blender.shared/OpenImageDenoise.dll"}
    if home:
        yield from sorted(glob.glob(os.path.join(home, names.get(sys.platform, "lib/libOpenImageDenoise.so*"))))
    system = ctypes.util.find_library("OpenImageDenoise")
    if system:
        yield system


@functools.cache
def _library(home):
    for path in _candidates(home):
        try:
            library = c.CDLL(path)
            for name, (result, *arguments) in _SIGNATURES.items():
                function = getattr(library, name)
                function.restype, function.argtypes = result, arguments
        except (OSError, AttributeError):  # of another platform, or version 1 with other functions
            continue
        return library
    return None


def available(home: str | None = None) -> bool:
    """Whether Open Image Denoise is there: in the folder `home` of a Blender, or in the system."""
    return _library(home) is not None


def denoise(picture: np.ndarray, albedo: np.ndarray, normal: np.ndarray, threads: int = 0,
            keep_on: Callable[[], bool] | None = None, home: str | None = None, scale: float = 1.0,
            fast: bool = False, at: tuple[int, int] = (0, 0), also: Window | None = None,
            surface: Sequence[np.ndarray] = ()) -> np.ndarray:
    """`picture` (height, width, 3), linear and unlimited, without noise; albedo and normal guide it, and where neither
    tells of anything, outside of `also`, it stays as it is.

    threads: 0 = as many as there are processors. keep_on: asked now and then, on this thread; False cancels
    (Cancelled). home: as in available(). scale: what brings the light that matters near 1; it is not taken from the
    picture, so that a part of a frame gets what the whole does. fast: half the time and a tenth more noise, where the
    library can. at: place (x, y) of the picture in its frame. surface: of light, depth and perhaps number of the
    object, by which what is left of noise is evened out. EncreError: the denoiser failed.
    """
    clean = steps(picture, albedo, normal, threads, home, scale, fast, at, also, surface)
    return background.run(clean, 1, keep_on and (lambda _: keep_on()))


def steps(picture: np.ndarray, albedo: np.ndarray, normal: np.ndarray, threads: int = 0, home: str | None = None,
          scale: float = 1.0, fast: bool = False, at: tuple[int, int] = (0, 0), also: Window | None = None,
          surface: Sequence[np.ndarray] = ()) -> background.Steps:
    """The steps of denoise(): the denoiser's work can go on in the background."""
    out = np.array(picture, np.float32)
    there = albedo.any(2) | normal.any(2)
    if also:
        there[also.y:also.y + also.height, also.x:also.x + also.width] = True
    images = {"color": picture, "albedo": albedo, "normal": normal}
    if not there.any():
        return out
    yield from _clean(out, images, _box(there), threads, home, at, scale, fast)
    if surface:
        yield [samples.even_work(out, picture, normal, *surface)]
    out[~there] = picture[~there]  # light that ran out over an edge would be a shadow that a catcher shows
    return out


def seen(picture: np.ndarray, where: np.ndarray, kind: str, threads: int = 0, keep_on: Callable[[], bool] | None = None,
         home: str | None = None, at: tuple[int, int] = (0, 0)) -> np.ndarray:
    """`picture` (height, width, 3), the "albedo" or the "normal" that mirrors and glass show, without noise `where`
    (height, width) they show it. threads, keep_on, home, at: as in denoise(). EncreError: the denoiser failed."""
    def steps():
        out = np.array(picture, np.float32)
        for box in boxes(where):
            yield from _clean(out, {kind: picture}, box, threads, home, at)
        out[~where] = picture[~where]
        return out

    return background.run(steps(), 1, keep_on and (lambda _: keep_on()))


def _clean(out, images, box, threads, home, at, scale=1.0, fast=False):
    """Steps to the first of the images {what it is: picture} without noise, guided by the others, in a box of `out`."""
    (height, width), (rows, columns) = out.shape[:2], box
    across = _reach(columns.start, columns.stop, _PAD, _PAD, at[0])
    device = _Device(_library(home), threads)
    for first, last in _strips(rows.start, rows.stop, len(across)):
        down = _reach(first, last, _PAD if first == rows.start else OVERLAP, _PAD if last == rows.stop else OVERLAP,
                      at[1])
        place = np.ix_(_mirrored(down, height), _mirrored(across, width))
        cut = {name: image[place] for name, image in images.items()}
        (clean,) = yield [_Filter(device, cut, scale, fast).work()]
        top, left = first - down[0], columns.start - across[0]
        out[first:last, columns] = clean[top:top + last - first, left:left + columns.stop - columns.start]
        del cut, clean  # pictures of a frame each


def boxes(there: np.ndarray, top: int = 0, left: int = 0) -> list[tuple[slice, ...]]:
    """(rows, columns) of boxes that hold all of `there` (height, width), which begins at a row and a column: more than
    one where so much of nothing lies between them that they take less work."""
    rows, columns = (_runs(there.any(axis)) for axis in (1, 0))
    if len(rows) == len(columns) == 1:
        return [tuple(slice(first + run.start, first + run.stop)
                      for first, run in ((top, rows[0]), (left, columns[0])))]
    return [box for down in rows for across in columns
            for box in boxes(there[down, across], top + down.start, left + across.start)]


def _box(there):
    """(rows, columns) of all of `there`, which is not empty."""
    rows, columns = (np.flatnonzero(there.any(axis)) for axis in (1, 0))
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _runs(filled):
    """Slices of what is filled; between two of them lies more than is looked at around both."""
    at = np.flatnonzero(filled)
    last = np.flatnonzero(np.diff(at) > 2 * _PAD)
    return [slice(run[0], run[-1] + 1) for run in np.split(at, last + 1) if run.size]


def _reach(first, last, before, after, offset):
    """Numbers of the rows that first ... last - 1 need, from one on the grid on; some lie outside of the picture."""
    start = first - before
    return np.arange(start - (start + offset) % _GRID, last + after)


def _mirrored(numbers, size):
    """Those of rows outside of a picture of `size` rows, mirrored into it at its first and last one."""
    around = 2 * max(1, size - 1)
    numbers = np.abs(numbers) % around
    return np.minimum(np.where(numbers < size, numbers, around - numbers), size - 1)


def _strips(first, last, width):
    """(first row, row after the last) of strips of like height on the grid; few, because they overlap."""
    count = -(-(last - first) // max(_ROWS, _PIXELS // width))
    step = -(-(last - first) // (count * _GRID)) * _GRID
    for start in range(first, last, step):
        yield start, min(start + step, last)


class _Device:
    """Lives as long as a filter of it."""

    def __init__(self, library, threads):
        self.library, self.handle = library, library.oidnNewDevice(_CPU)
        if threads:
            library.oidnSetDeviceInt(self.handle, b"numThreads", threads)
        library.oidnCommitDevice(self.handle)

    def __del__(self):
        self.library.oidnReleaseDevice(self.handle)


class _Filter:
    """Cleans the first of the images {what it is: (height, width, 3)} into `output`. Its work keeps it, which may still
    go on when nobody waits for it any more."""

    def __init__(self, device, images, scale, fast):
        self.device, library = device, device.library
        self.images = {name: np.ascontiguousarray(image, np.float32) for name, image in images.items()}
        self.output = np.empty_like(next(iter(self.images.values())))
        self.handle = library.oidnNewFilter(device.handle, b"RT")
        for name, image in (*self.images.items(), ("output", self.output)):
            library.oidnSetSharedFilterImage(self.handle, name.encode(), image.ctypes.data, _FLOAT3,
                                             *image.shape[1::-1], 0, 0, 0)
        if "color" in self.images:
            library.oidnSetFilterBool(self.handle, b"hdr", True)
            library.oidnSetFilterFloat(self.handle, b"inputScale", scale)
        if fast and library.oidnGetDeviceInt(device.handle, b"version") >= _FAST_SINCE:
            library.oidnSetFilterInt(self.handle, b"quality", _FAST)
        library.oidnCommitFilter(self.handle)

    def __del__(self):
        self.device.library.oidnReleaseFilter(self.handle)

    def work(self):
        run = c.cast(self.device.library.oidnExecuteFilter, c.c_void_p)
        return Work("call", abi.CallJob(run, self.handle), [self], self.result)

    def result(self):
        sentence = c.c_char_p()
        if self.device.library.oidnGetDeviceError(self.device.handle, c.byref(sentence)):
            reason = (sentence.value or b"").decode(errors="replace")
            raise EncreError(f"Open Image Denoise failed ({reason}); set Denoise to None, in Layers and Quality")
        return self.output
