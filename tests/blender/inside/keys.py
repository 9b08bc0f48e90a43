# SPDX-License-Identifier: GPL-3.0-or-later
"""Real keys for a window, through the X server: Blender's own simulated Esc does not stop a render."""

import ctypes

_X11, _TEST = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
_X11.XOpenDisplay.restype = ctypes.c_void_p
_X11.XStringToKeysym.restype = ctypes.c_ulong
_DISPLAY = ctypes.c_void_p(_X11.XOpenDisplay(None))


def press(name):
    """Presses and releases a key, by the name that X11 has for it."""
    for down in (True, False):
        hold(name, down)


def point(x, y):
    """Moves the mouse, which says where keys go."""
    _TEST.XTestFakeMotionEvent(_DISPLAY, -1, x, y, 0)
    _X11.XFlush(_DISPLAY)


def hold(name, down):
    """Presses a key, or lets it go."""
    code = _X11.XKeysymToKeycode(_DISPLAY, ctypes.c_ulong(_X11.XStringToKeysym(name.encode())))
    _TEST.XTestFakeKeyEvent(_DISPLAY, code, int(down), 0)
    _X11.XFlush(_DISPLAY)


def click(x, y):
    """With the left button."""
    point(x, y)
    for down in (1, 0):
        _TEST.XTestFakeButtonEvent(_DISPLAY, 1, down, 0)
    _X11.XFlush(_DISPLAY)
