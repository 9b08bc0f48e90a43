# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C and its like while the library works."""

import contextlib
import signal

_BEATS = []  # functions that are called while the library makes progress


@contextlib.contextmanager
def beating(beat):
    """Has beat() called again and again while the library works."""
    _BEATS.append(beat)
    try:
        yield
    finally:
        _BEATS.remove(beat)


@contextlib.contextmanager
def heeded():
    """Gives the progress callback for one call of the library, and turns an interrupt that came into KeyboardInterrupt.

    Python's own handler would raise that where the library calls back, before any `try` of ours begins: there ctypes
    drops it, and the work goes on.
    """
    came = []

    def go_on(_fraction):
        for beat in _BEATS:
            beat()
        return not came

    own = [number for name in ("SIGINT", "SIGTERM", "SIGHUP") if (number := getattr(signal, name, None)) is not None
           and signal.getsignal(number) == signal.default_int_handler]
    for number in own:
        signal.signal(number, lambda *_: came.append(True))
    try:
        yield go_on
    finally:
        for number in own:
            signal.signal(number, signal.default_int_handler)
        if came:
            raise KeyboardInterrupt
