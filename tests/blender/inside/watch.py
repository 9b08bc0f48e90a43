# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rendered 3D view uploads, and when it has come to rest. Pictures are scene-linear."""

import gc
import os
import time

import numpy as np
import window

uploaded = []  # (seconds, picture), the last of them
uploads = [0]


def spy():
    from encre.blender import screen

    upload = screen.upload

    def look(picture):
        uploaded[:] = [*uploaded[-60:], (time.perf_counter(), picture.copy())]
        uploads[0] += 1
        return upload(picture)

    screen.upload = look


def views():
    from encre.blender import live

    return [thing for thing in gc.get_objects() if type(thing) is live.View and thing.engine()]


def space():
    return window.area("VIEW_3D").spaces.active


def state(view):
    """Whether it shows all that there is to show, and what it says."""
    what = view.what
    return [bool(view.texture and not view.stale and not view.picture and what.now == view._now()
                 and what.scale == view.scale), view.failure, view.stale, bool(view.picture), view.scale,
            what and [what.scale, what.now == view._now(), what.cancelled]]


def rest(count=1):
    """Until so many views, or more, show all that there is to show: a new one is there by and by. By steps of the
    window, which come later where the machine is busy, as pictures do."""
    yield
    yield
    for _ in range(900):
        if len(views()) >= count and all(state(view)[0] or view.failure for view in views()):
            return
        yield
    raise AssertionError(f"the view does not come to rest: {[state(view) for view in views()]}")


def picture(name):
    np.save(os.path.join(window.FOLDER, f"{name}.npy"), uploaded[-1][1])


def reads():
    return [view.read_number for view in views()]
