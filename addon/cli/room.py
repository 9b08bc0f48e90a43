# SPDX-License-Identifier: GPL-3.0-or-later
"""Room for pictures: in memory, and for large ones in files without names, whose pages the system may take away.

A picture of 8K has 8 GB of layers and of what is drawn. Each stage goes through them from above to below, so that only
some rows need be in memory at a time.
"""

import mmap
import os
import shutil
import tempfile
import time
import weakref

import numpy as np

from ..pen.errors import EncreError

LARGE = 1 << 24  # pixels
_PAUSE = 0.1     # seconds between two times that memory is given back


def _number(path):
    try:
        with open(path) as file:
            return int(file.read().split()[0])
    except (OSError, ValueError, IndexError):  # not this system's, or "max"
        return None


def free_memory():
    """Bytes that this process may still take, None where the system does not say."""
    try:
        with open("/proc/meminfo") as file:
            said = {line.split(":")[0]: 1024 * int(line.split()[1]) for line in file}
        free = said["MemAvailable"] + said["SwapFree"]
    except (OSError, ValueError, KeyError, IndexError):
        return None
    for most, used in (("memory.max", "memory.current"),
                       ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes")):
        most, used = (_number(f"/sys/fs/cgroup/{name}") for name in (most, used))
        if most is not None and used is not None:  # of what is used much may be pages of files, which are given back
            free = min(free, max(most - used, most // 2))
    return free


def afford(path, size, files=0):
    """Finds out before any work whether there is room for what the header of the file `path` announces: `size` bytes,
    of which `files` may lie among temporary ones. EncreError: there is not."""
    free, folder = free_memory(), tempfile.gettempdir()
    disk = min(files, shutil.disk_usage(folder).free) if hasattr(os, "posix_fallocate") else 0
    if free is not None and size > free + disk:
        beside = f" and {_shown(disk)} among temporary files in {folder}" if files else ""
        raise EncreError(f"{path}: needs {_shown(size)} when it is unpacked, and there are {_shown(free)} of memory"
                         f"{beside}; give a smaller file, or make room")


def _shown(size):
    return f"{size / 1e9:.1f} GB"


class Room:
    """zeros(shape) makes an array of floats for a picture of `pixels`; give_back() now and then keeps memory small."""

    def __init__(self, pixels):
        # Elsewhere a full disk would end the process when it writes to such an array.
        self._large = pixels >= LARGE and hasattr(os, "posix_fallocate")
        self._maps, self._last = weakref.WeakSet(), time.monotonic()

    def zeros(self, shape):
        size = 4 * int(np.prod(shape))
        if not self._large or not size:
            return np.zeros(shape, np.float32)
        try:
            with tempfile.TemporaryFile() as file:
                os.posix_fallocate(file.fileno(), 0, size)
                pages = mmap.mmap(file.fileno(), size)
        except OSError:  # there is no room among the temporary files
            return np.zeros(shape, np.float32)
        self._maps.add(pages)
        return np.frombuffer(pages, np.float32).reshape(shape)

    def give_back(self):
        if not self._maps or time.monotonic() < self._last + _PAUSE:
            return
        for pages in self._maps:
            pages.madvise(mmap.MADV_DONTNEED)  # of a shared file: its content stays
        self._last = time.monotonic()
