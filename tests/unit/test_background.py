# SPDX-License-Identifier: GPL-3.0-or-later
"""Works in the background: the same bytes as at once, one after the other, and well-defined ends."""

import ctypes
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import drawn
import numpy as np
import pytest
from encre.pen import abi
from encre.pen.background import Background
from encre.pen.errors import Cancelled, EncreError
from encre.pen.job import Frame, Lamp, Mesh, Work
from encre.pen.library import load
from encre.pen.scene import Scene

WIDTH, HEIGHT = 96, 64
VIEW = np.eye(4)
LENS = np.array([[1, 0, 0, 0], [0, 1.5, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])


def drawing(size=(WIDTH, HEIGHT), **settings):
    return load().draw_work(drawn.scene(*size), load().complete(load().check(settings)))


def run(works):
    """Results of works in the background, and how often they were asked for."""
    behind, asked = Background(), 0
    behind.start(works)
    while (results := behind.poll()) is None:
        asked += 1
        time.sleep(1e-4)
    return results, asked


class Held:
    """A work that goes on until it is let go, and one by which to see whether its turn has come."""

    def __init__(self):
        self.called, self._go = [], threading.Event()
        self._function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self._call)

    def _call(self, holds):
        self.called.append(bool(holds))
        if holds:
            assert self._go.wait(60)

    def work(self, holds=True):
        job = abi.CallJob(ctypes.cast(self._function, ctypes.c_void_p), holds)
        return Work("call", job, [self], lambda: None)

    def let_go(self):
        self._go.set()


def chain():
    """Raster, light and render, each of which reads what those before it draw; and what comes of them."""
    points = np.random.default_rng(2).uniform(-2, 2, (90, 3)).astype(np.float32) - (0, 0, 5)
    corners = np.arange(90, dtype=np.int32).reshape(-1, 3)
    frame, scene = Frame(WIDTH, HEIGHT), Scene()
    scene.geometry(0, points, corners)
    scene.instance(0, 0)
    scene.lamp(0, Lamp("sun", color=(2, 2, 2), width=0.1))
    raster = load().raster_work([Mesh(points, corners, object=np.arange(1, 31, dtype=np.int32))], VIEW, LENS, frame,
                                (WIDTH, HEIGHT), 0.1)
    maps = raster.result()
    light = scene.light_work(maps["depth"], maps["normal"], VIEW, LENS, frame, 0.1)
    layers = {"combined": np.ones((HEIGHT, WIDTH, 4), np.float32), "color": maps["normal"], "diffuse": light.result(),
              "depth": maps["depth"], "normal": maps["normal"], "object": maps["object"]}
    return [raster, light, load().draw_work(layers, load().complete({"line_thickness": 60.0}))]


def test_the_same_bytes_as_at_once():
    one = [load().run(work) for work in chain()]
    two, asked = run(chain())
    assert asked > 0
    assert all(np.array_equal(one[0][name], two[0][name]) for name in one[0]) and (one[0]["object"] > 0).mean() > 0.2
    assert np.array_equal(one[1], two[1]) and one[1].std() > 0.01
    assert np.array_equal(one[2].images["Combined"], two[2].images["Combined"])
    assert (two[2].images["Combined"][..., 0] < 0.5).sum() > 100


def test_one_thread_after_the_other_and_again():
    behind, want = Background(3), load().run(drawing()).images["Combined"]
    for _ in range(5):
        behind.start([drawing()])
        assert np.array_equal(behind.wait()[0].images["Combined"], want)
        assert behind.poll() == []


def test_a_work_that_goes_on_keeps_others_away():
    behind, held = Background(), Held()
    behind.start([held.work()])
    with pytest.raises(EncreError, match="^context: its work in the background goes on; "):
        behind.start([drawing()])
    lib = load().lib
    assert lib.encre_set_threads(behind._context, 2) == lib.encre_set_simd(behind._context, 0) == 1
    for kind in abi.WORKS:  # none looks at its job before
        assert getattr(lib, f"encre_{kind}")(behind._context, ctypes.byref(drawing().job)) == 1
        assert lib.encre_error(behind._context).startswith(b"context: ")
    held.let_go()
    assert len(behind.wait()) == 1
    assert lib.encre_set_threads(behind._context, 2) == 0


def test_a_scene_that_is_lit_keeps_changes_away():
    """From the start of the work on, be its light the last step; another light is a change: trees are built."""
    behind, held, (raster, light, _) = Background(), Held(), chain()
    scene, frame = light.keep[0], Frame(WIDTH, HEIGHT)
    points, corners = np.zeros((3, 3), np.float32), np.arange(3)

    def changes():
        yield lambda: scene.geometry(0, points, corners)
        yield lambda: scene.instance(0, None)
        yield lambda: scene.lamp(0, None)
        yield lambda: scene.texture(0, np.ones((1, 1)))
        yield lambda: scene.reached(np.zeros((1, 3)), np.ones((1, 3)))
        again = scene.light_work(raster.result()["depth"], None, VIEW, LENS, frame, 0.1)
        yield lambda: load().run(again)
        yield lambda: Background().start([again])

    behind.start([held.work(), raster, light])
    for change in changes():
        with pytest.raises(EncreError, match="^scene: is being lit; wait"):
            change()
    held.let_go()
    assert np.array_equal(behind.wait()[2], [load().run(work) for work in chain()[:2]][1])
    for change in changes():
        change()


def test_a_scene_that_is_lit_may_be_dropped():
    behind, held, works = Background(), Held(), chain()[:2]
    want = [load().run(work) for work in works]
    scene, lib = works[1].keep[0], load().lib
    behind.start([held.work(), *works])
    lib.encre_scene_free(scene._handle)
    scene._handle = None
    held.let_go()
    assert np.array_equal(behind.wait()[2], want[1]) and want[1].std() > 0.01


def test_its_own_progress_is_refused():
    """A context at work has its threads, memory and caches in use: what it is asked for meanwhile crashed, or waited
    for itself."""
    lib, context, answers = load().lib, load().context(2), []
    scene, points = Scene(), np.zeros((3, 3), np.float32)
    scene.geometry(0, points, np.arange(3))

    def told(_user, _fraction):
        if not answers:
            calls = [lambda: lib.encre_set_threads(context, 1), lambda: lib.encre_set_simd(context, 0),
                     lambda: lib.encre_start(context, abi.steps([drawing()]), 1),
                     lambda: lib.encre_scene_geometry(context, scene._handle, 0, None)]
            calls += [lambda kind=kind: getattr(lib, f"encre_{kind}")(context, ctypes.byref(drawing().job))
                      for kind in abi.WORKS]
            for call in calls:
                answers.append((call(), lib.encre_error(context)[:21]))
            lib.encre_destroy(context)
        return True

    work = drawing()
    work.job.progress = abi.Progress(told)
    assert lib.encre_render(context, ctypes.byref(work.job)) == 0 and lib.encre_error(context) == b""
    assert len(answers) > 7 and set(answers) == {(1, b"context: its own prog")}
    assert np.array_equal(work.result().images["Combined"], load().run(drawing()).images["Combined"])
    work.job.progress = abi.Progress(lambda *_: lib.encre_set_threads(context, 1) == 0)
    assert lib.encre_render(context, ctypes.byref(work.job)) == 3 and lib.encre_error(context) == b"cancelled"
    work.job.progress = abi.Progress()
    assert lib.encre_render(context, ctypes.byref(work.job)) == lib.encre_set_threads(context, 1) == 0
    lib.encre_destroy(context)


def test_a_cancelled_work_ends():
    """Within a step, and no other begins. How soon in seconds, `make bench-live` tells."""
    behind, done = Background(), ctypes.c_double()
    lib, context = load().lib, behind._context

    def cancelled(works):
        """Whether works did not come to their end that were cancelled as soon as they had begun."""
        behind.start(works)
        while lib.encre_poll(context, ctypes.byref(done)) == 4 and not done.value:
            time.sleep(1e-4)
        behind.cancel()
        try:
            behind.wait()
        except Cancelled:
            return True
        return False

    work = drawing((640, 360))
    assert any(cancelled([work]) for _ in range(12))
    assert cancelled([work] * 60) and lib.encre_poll(context, None) == 3
    behind.start([drawing()])  # and it is as good as new
    assert len(behind.wait()) == 1


def test_what_is_dropped_ends():
    behind, held = Background(), Held()
    behind.start([*[drawing((640, 360))] * 20, held.work(False)])
    del behind
    assert not held.called


def test_the_first_that_fails_ends_all():
    bad, after = drawing(), drawing()
    bad.job.frame.width = 3
    image = after.result().images["Combined"]
    image[...] = 7
    behind = Background()
    behind.start([drawing(), bad, after])
    with pytest.raises(EncreError, match="^frame: "):
        behind.wait()
    assert (image == 7).all()
    assert not bad.job.progress
    assert load().lib.encre_error(behind._context).startswith(b"frame: ")


@pytest.mark.parametrize("spoil, words", [
    (lambda steps: setattr(steps[1], "kind", 99), "^step 1: kind 99 is not known; "),
    (lambda steps: setattr(steps[1], "kind", -1), "^step 1: kind -1 is not known; "),
    (lambda steps: setattr(steps[0], "job", None), "^step 0: it has no job; "),
])
def test_wrong_steps_are_refused(monkeypatch, spoil, words):
    right = abi.steps

    def wrong(works):
        steps = right(works)
        spoil(steps)
        return steps

    behind = Background()
    monkeypatch.setattr(abi, "steps", wrong)
    with pytest.raises(EncreError, match=words):
        behind.start([drawing(), drawing()])


@pytest.mark.parametrize("count", [0, 65])
def test_so_many_steps_are_refused(count):
    behind, work = Background(), drawing()
    with pytest.raises(EncreError, match=f"^steps: {count} are given; give 1 to 64"):
        behind.start([work] * count)
    assert behind.poll() == []


def test_others_functions_are_called():
    """At once, and between other steps; none of them where the work has been cancelled, nor without a function."""
    called, kind = [], ctypes.CFUNCTYPE(None, ctypes.c_void_p)
    function = kind(called.append)

    pointer = ctypes.cast(function, ctypes.c_void_p)

    def call(argument, pointer=pointer):
        return Work("call", abi.CallJob(pointer, argument), [], lambda: argument)

    assert load().run(call(1)) == 1 and called == [1]
    with pytest.raises(Cancelled):
        load().run(call(2), progress=lambda _fraction: False)
    results, _ = run([call(3), drawing(), call(4)])
    assert (results[0], results[2], called) == (3, 4, [1, 3, 4])
    with pytest.raises(EncreError, match="^function: is NULL; "):
        load().run(call(5, None))


def test_progress_is_not_called_on_another_thread():
    for work in chain():
        work.job.progress = abi.Progress(lambda _user, _fraction: True)
        with pytest.raises(EncreError, match="^step 0: its progress would be called"):
            Background().start([work])


def test_the_fraction_grows_to_the_end():
    lib, context, work = load().lib, load().context(), drawing((320, 180))
    fraction, seen = ctypes.c_double(), [0.0]
    assert lib.encre_poll(context, ctypes.byref(fraction)) == 0 and fraction.value == 1
    steps = 24  # so long that a thread which is kept waiting now and then sees some of it
    assert lib.encre_start(context, abi.steps([work] * steps), steps) == 0
    while lib.encre_poll(context, ctypes.byref(fraction)) == 4:
        seen.append(fraction.value)
    assert lib.encre_poll(context, ctypes.byref(fraction)) == 0 and fraction.value == 1
    lib.encre_destroy(context)
    assert seen == sorted(seen) and 0.5 < max(seen) <= 1 and len(set(seen)) > 5


THREADS = """
import os, sys
import drawn
from encre.pen import library
most, layers = [], drawn.scene(96, 64)
for threads in 0, 3:
    now = len(os.listdir("/proc/self/task"))
    if not threads:
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    seen = []
    library.render(layers, {}, threads=threads, progress=lambda _: seen.append(len(os.listdir("/proc/self/task"))) or 1)
    most.append(max(seen) - now)
assert most == [0, 2], most
"""


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system gives a process all processors")
def test_a_process_that_has_some_processors_begins_no_more_threads():
    """As farms and containers share machines out."""
    path = os.pathsep.join(map(str, (Path(__file__).parents[1] / "helpers", Path(__file__).parents[1])))
    done = subprocess.run([sys.executable, "-c", THREADS], env={**os.environ, "PYTHONPATH": path},
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
