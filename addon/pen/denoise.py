# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise, Blender's or the system's, by its C functions: light without Monte-Carlo noise."""

import ctypes as c
import ctypes.util
import functools
import glob
import os
import sys
from collections.abc import Callable

import numpy as np

from .errors import Cancelled, EncreError

_CPU, _FLOAT3, _CANCELLED = 1, 3, 6
_Monitor = c.CFUNCTYPE(c.c_bool, c.c_void_p, c.c_double)
# Parameters and result of each function used; handles are pointers.
_SIGNATURES = {
    "oidnNewDevice": (c.c_void_p, c.c_int),
    "oidnSetDeviceInt": (None, c.c_void_p, c.c_char_p, c.c_int),
    "oidnCommitDevice": (None, c.c_void_p),
    "oidnReleaseDevice": (None, c.c_void_p),
    "oidnGetDeviceError": (c.c_int, c.c_void_p, c.POINTER(c.c_char_p)),
    "oidnNewFilter": (c.c_void_p, c.c_void_p, c.c_char_p),
    "oidnReleaseFilter": (None, c.c_void_p),
    "oidnSetFilterBool": (None, c.c_void_p, c.c_char_p, c.c_bool),
    "oidnSetFilterProgressMonitorFunction": (None, c.c_void_p, _Monitor, c.c_void_p),
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
            keep_on: Callable[[], bool] | None = None, home: str | None = None) -> np.ndarray:
    """`picture` (height, width, 3), linear and unlimited, without noise; albedo and normal guide it.

    threads: 0 = as many as there are processors. keep_on: called while it works, perhaps on other threads; False
    cancels (Cancelled). home: as in available(). EncreError: the denoiser failed.
    """
    library = _library(home)
    inputs = {b"color": picture, b"albedo": albedo, b"normal": normal}
    inputs = {name: np.ascontiguousarray(image, np.float32) for name, image in inputs.items()}
    height, width = picture.shape[:2]
    output = np.empty((height, width, 3), np.float32)
    monitor = _Monitor(lambda _user, _fraction: keep_on is None or bool(keep_on()))
    device = library.oidnNewDevice(_CPU)
    if threads:
        library.oidnSetDeviceInt(device, b"numThreads", threads)
    library.oidnCommitDevice(device)
    work = library.oidnNewFilter(device, b"RT")
    for name, image in (*inputs.items(), (b"output", output)):
        library.oidnSetSharedFilterImage(work, name, image.ctypes.data, _FLOAT3, width, height, 0, 0, 0)
    library.oidnSetFilterBool(work, b"hdr", True)
    library.oidnSetFilterProgressMonitorFunction(work, monitor, None)
    library.oidnCommitFilter(work)
    library.oidnExecuteFilter(work)
    sentence = c.c_char_p()
    code = library.oidnGetDeviceError(device, c.byref(sentence))
    library.oidnReleaseFilter(work)
    library.oidnReleaseDevice(device)
    if code == _CANCELLED:
        raise Cancelled("denoising was cancelled")
    if code:
        reason = (sentence.value or b"").decode(errors="replace")
        raise EncreError(f"Open Image Denoise failed ({reason}); set Denoise Light to None")
    return output
