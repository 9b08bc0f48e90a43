# SPDX-License-Identifier: GPL-3.0-or-later
"""Python on a render's thread, and beside one: where Blender has one state for all threads.

Whether Python may write is one flag: each class that Blender calls sets it, and in the end back to what it was when the
call began. A render that begins while a panel is drawn, and ends later, so leaves it at what is right for drawing, and
from then on timers and other renders may write nothing and begin no operator. Inside the getter of a property they
always may.
"""

import contextlib
import time
from _thread import get_ident

import bpy

from ..pen.errors import Cancelled

_MAIN = get_ident()  # Blender imports add-ons on its main thread
_PATIENCE = 1000     # times that it is tried to write
_works = {}          # thread -> what its getter is to do


def may_write(work):
    """What work() returns or raises, where it may write and begin operators."""
    done, thread = [], get_ident()

    def run():
        try:
            done.append((work(), None))
        except Exception as error:
            done.append((None, error))

    _works[thread] = run
    _ = bpy.data.window_managers[0].encre_works
    _works.pop(thread, None)
    result, error = done[0]
    if error:
        raise error
    return result


def _work(_owner):
    if run := _works.pop(get_ident(), None):
        run()
    return False


def refused(error):
    """Whether Blender would not let Python write, or begin an operator."""
    return any(words in str(error) for words in ("in this context is not allowed", "modify blend data in this state"))


def put(owner, name, value):
    """setattr(), on a render's thread too: tried again, as a panel may begin to be drawn at any time."""
    write = setattr
    for _ in range(_PATIENCE):
        try:
            write(owner, name, value)
            return
        except AttributeError as error:
            if not refused(error):
                raise
        write = _written
        time.sleep(0.002)
    write(owner, name, value)


def _written(owner, name, value):
    may_write(lambda: setattr(owner, name, value))


def on_main_thread(work, keep_on):
    """What work() returns or raises on Blender's main thread, which runs timers while a render has a thread of its own:
    bpy.data must not change there. Cancelled: keep_on() was False before it was done."""
    if get_ident() == _MAIN:
        return work()
    done = []

    def run():
        try:
            done.append((may_write(work), None))
        except Exception as error:  # else nobody would be told, and the render would wait for ever
            done.append((None, error))

    bpy.app.timers.register(run)
    try:
        while not done:
            if not keep_on():
                raise Cancelled("rendering was cancelled")
            time.sleep(0.005)
    finally:
        if not done and bpy.app.timers.is_registered(run):
            bpy.app.timers.unregister(run)
    result, error = done[0]
    if error:
        raise error
    return result


def in_window(window):
    """A context manager in which operators begin in a window. A context that is overridden is a dictionary of Python's,
    in which Blender looks without the interpreter's lock if it takes another thread for itself: it crashed by it
    once in 200 renders. So nothing is overridden in vain; timers have the first window."""
    return contextlib.nullcontext() if bpy.context.window == window else bpy.context.temp_override(window=window)


def register():
    bpy.types.WindowManager.encre_works = bpy.props.BoolProperty(get=_work, options={"HIDDEN", "SKIP_SAVE"})


def unregister():
    del bpy.types.WindowManager.encre_works
