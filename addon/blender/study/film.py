# SPDX-License-Identifier: GPL-3.0-or-later
"""Flights that are drawn beforehand: a file for each stop, kept beside the files of sessions for all people to come."""

import contextlib
import hashlib
import os
from pathlib import Path

import numpy as np

_FEWEST, _RATE = 2, 12  # stops; pictures a second that a film shows


class Film:
    """Pictures (panes, height, width, 3) of bytes."""

    def __init__(self, folder, seconds, told):
        """told: what the pictures depend on; another film is kept for anything else."""
        word = hashlib.sha256(repr(told).encode()).hexdigest()[:12]
        self.folder, self.count = Path(folder) / f"flight-{word}", max(_FEWEST, round(seconds * _RATE) + 1)
        self._last = None, None

    def _path(self, number):
        return self.folder / f"{number:05}.npy"

    def missing(self):
        """Numbers of the stops that are still to be drawn."""
        return [number for number in range(self.count) if not self._path(number).exists()]

    def share(self, number):
        return number / (self.count - 1)

    def keep(self, number, panes):
        """Stores a picture whole or not at all."""
        self.folder.mkdir(parents=True, exist_ok=True)
        part = self.folder / f".{number:05}.part"
        try:
            with open(part, "wb") as file:
                np.save(file, np.stack(panes))
            os.replace(part, self._path(number))
        except BaseException:
            with contextlib.suppress(OSError):
                part.unlink()
            raise

    def at(self, share):
        """The picture nearest to a share of the way; the same array as long as it is the same."""
        number = round(min(max(share, 0), 1) * (self.count - 1))
        if self._last[0] != number:
            self._last = number, np.load(self._path(number), mmap_mode=None)
        return self._last[1]
