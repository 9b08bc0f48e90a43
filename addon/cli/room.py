# SPDX-License-Identifier: GPL-3.0-or-later
"""Room for pictures: in memory, and for large ones in files without names, whose pages the system may take away.

A picture of 8K has 8 GB of layers and of what is drawn. Each stage goes through them from above to below, so that only
some rows need be in memory at a time.
"""

import mmap
import os
import tempfile
import time
import weakref

import numpy as np

LARGE = 1 << 24  # pixels
_PAUSE = 0.1     # seconds between two times that memory is given back


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
