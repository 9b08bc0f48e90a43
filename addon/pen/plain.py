# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that others name: only plain ones are opened. A pipe would wait for who writes into it, a device never end."""

import errno
import os
import stat
from typing import BinaryIO


def opened(path: str | os.PathLike) -> BinaryIO:
    """A plain file, open for reading. OSError: it can't be, or is none."""
    # Not to wait is asked for before it is known what it is.
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    kind = os.fstat(number).st_mode
    if not stat.S_ISREG(kind):
        os.close(number)
        words = "it is a folder" if stat.S_ISDIR(kind) else "it is no plain file"
        raise OSError(errno.EINVAL, words, os.fspath(path))
    return os.fdopen(number, "rb")


def content(path: str | os.PathLike) -> bytes:
    """All that is in a plain file. OSError, likewise."""
    with opened(path) as file:
        return file.read()


def text(path: str | os.PathLike) -> str:
    """Likewise, as text of UTF-8. UnicodeDecodeError: it is none."""
    return content(path).decode("utf-8")
