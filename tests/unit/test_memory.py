# SPDX-License-Identifier: GPL-3.0-or-later
"""Every allocation and every thread refused once: a sentence or the same picture, and nothing is left behind."""

import ctypes
import sys
from pathlib import Path

import bench
import built
import drawn
import numpy as np
import pytest
from encre.pen import samples
from encre.pen.background import Background
from encre.pen.errors import EncreError
from encre.pen.installed import LIBRARY
from encre.pen.job import Frame, Lamp, Mesh, Picture
from encre.pen.library import Library, load
from encre.pen.scene import Scene

ROOT = Path(__file__).resolve().parents[2]
WRAPPED = ("malloc", "calloc", "realloc", "free", "pthread_create")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    if sys.platform != "linux":
        pytest.skip("needs a linker that wraps functions")
    out = tmp_path_factory.mktemp("failing") / LIBRARY
    return Library(str(built.library(out, str(ROOT / "tests" / "helpers" / "failing.c"),
                                     *(f"-Wl,--wrap={function}" for function in WRAPPED))))


def render(library, settings):
    layers = drawn.scene(61, 37, n=6)
    layers["controls"][..., 3:5] = 0.5
    layers["style"][10:20] = 1
    layers["seen_color"], layers["seen_normal"] = layers["albedo"], -layers["normal"]
    layers["color"][3, 4] = np.nan  # makes the library copy the layer
    styles = [dict(line_thickness=20.0)]
    return library.render(layers, settings, styles, outputs=list(library.outputs), threads=3).images


def raster(library, _settings):
    points = np.random.default_rng(0).uniform(-1, 1, (60, 3)).astype(np.float32)
    mesh, matrix = Mesh(points, np.arange(60, dtype=np.int32).reshape(-1, 3), object_index=1), np.eye(4)
    return library.raster([mesh], matrix, matrix, Frame(40, 30), (40, 30), -1, -1, threads=3,
                          outputs=("depth", "normal", "object", "anchor", "coincident"))


def chains(library, _settings):
    points = np.random.default_rng(0).uniform(-1, 1, (60, 3)).astype(np.float32)
    meshes = [Mesh(points * scale, np.arange(60, dtype=np.int32).reshape(-1, 3), object_index=1) for scale in (1, 0.7)]
    matrix = np.eye(4)
    return {"points": library.chains(meshes, matrix, matrix, Frame(40, 30), (40, 30), -1, -1, threads=3)}


def bake(library, settings):
    texture = np.random.default_rng(0).random((61, 90, 3), np.float32)
    form = np.tile(np.float32((1, 0, 2)), (61, 90, 1)) if not settings else None
    return {"texture": library.bake(texture, settings, form, threads=3).texture}


def even(library, _settings):
    rng = np.random.default_rng(0)
    light, rendered, normal = (rng.random((61, 90, 3), np.float32) for _ in range(3))
    work = samples.even_work(light, rendered, normal, np.ones((61, 90, 1), np.float32))
    return {"light": library.run(work, threads=3)}


def light(library, _settings):
    scene, points = Scene(library), np.random.default_rng(0).uniform(-1, 1, (60, 3)).astype(np.float32)
    for key in range(18):  # more than there is room for at first
        scene.geometry(key, points, np.arange(60).reshape(-1, 3), np.ones((20, 3, 3)))
        scene.instance(key, key)
    scene.lamp(0, Lamp("sun", width=0.1))
    scene.geometry(0, points, np.arange(30).reshape(-1, 3))
    depth = np.full((8, 12), 2, np.float32)
    return {"diffuse": scene.light(depth, None, np.eye(4), np.diag([1.0, 1, -1, 1]), Frame(12, 8), 0.1, threads=3)}


def background(library, settings):
    layers = drawn.scene(61, 37, n=6)
    behind = Background(3, library=library)
    behind.start([library.draw_work(layers, library.complete(library.check(settings)))])
    return behind.wait()[0].images


def twice(library, settings):
    layers, behind = drawn.scene(61, 37, n=6), Background(3, library=library)
    behind.start([library.draw_work(layers, library.complete(library.check(settings)), same=1) for _ in range(2)])
    return behind.wait()[1].images


def strokes(library, settings):
    layers = drawn.scene(61, 37, n=6)
    return {"points": library.strokes(layers, library.complete(library.check(settings)), threads=3)}


def flatten(library, _settings):
    texels = np.random.default_rng(0).integers(0, 256, (61 * 37, 4), np.uint8)
    library.flatten(Picture(texels, 61, 37, curve=np.linspace(0, 1, 256, dtype=np.float32)), 4, threads=3)
    return {"texels": texels}


BEHIND = background, twice
JOBS = [(strokes, dict(pen_1_overshoot=30.0, pen_1_strokes=2)),
        (background, {}), (twice, {}), (twice, dict(edge_detector="DOG", line_search="WALK")), (light, {}),
        (render, {}), (render, dict(edge_detector="SOBEL", line_search="NEAREST")),
        (render, dict(edge_detector="DOG", line_search="WALK")),
        (render, dict(edge_detector="DOG", line_search="DILATE", contrast_local=True)), (raster, {}), (chains, {}),
        (bake, {}), (bake, dict(contrast_local=True)), (even, {}), (flatten, {})]


@pytest.mark.parametrize("job, settings", JOBS)
@pytest.mark.parametrize("what", ["allocation", "thread"])
def test_each_refused_once(library, job, settings, what):
    def number(name):
        return ctypes.c_int.in_dll(library.lib, name)

    refuse, calls, held = number("refuse_" + what), number(what + "s"), number("held")
    whole = job(library, settings)
    library.forget()
    refused = 0
    while True:
        calls.value, refuse.value = 0, refused + 1
        try:
            images = job(library, settings)
        except EncreError as e:
            assert (what == "allocation" or job in BEHIND) and str(e).startswith("memory: ") and ";" in str(e)
        else:
            assert (what == "thread" and refused + (job not in BEHIND)) or calls.value <= refused
            assert all(images[name].tobytes() == whole[name].tobytes() for name in whole)
        finally:
            refuse.value = 0
            library.forget()
        assert held.value == 0
        if calls.value <= refused:
            break
        refused += 1
    assert refused >= 2


NEEDS_COUNT = pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallinfo2"), reason="needs glibc's count of memory")


@pytest.mark.slow
@pytest.mark.parametrize("sources", [
    pytest.param(name, marks=pytest.mark.long if name == "default sources" else ()) for name in bench.SOURCES])
@NEEDS_COUNT
def test_fine_holds_at_most_12_bytes_a_pixel(sources):
    """Besides input and output, where 12 % of the pixels are near a line."""
    width, height = 1280, 720
    layers, settings = bench.balls(width, height, bench.CELL[sources]), bench.SOURCES[sources]
    assert 0.11 < bench.sites(layers, settings)[1] < 0.13
    assert bench.held_bytes(layers, settings) <= 12 * width * height


@pytest.mark.slow
@NEEDS_COUNT
@pytest.mark.parametrize("look", [
    pytest.param(look, marks=() if look == "Inter-color, SOBEL" else pytest.mark.long) for look in bench.LOOKS])
def test_looks_hold_at_most_12_bytes_a_pixel(look):
    """Likewise; Inter-color's edges are the most."""
    width, height = 1920, 1080
    layers = bench.balls(width, height, bench.CELL["with colour and light" if "colour" in look else "default sources"])
    assert bench.held_bytes(layers, bench.LOOKS[look][0]) <= 12 * width * height


@NEEDS_COUNT
def test_new_memory_has_a_pattern_while_the_library_runs_and_no_longer():
    libc, found = ctypes.CDLL(None), []
    libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    libc.free.argtypes = [ctypes.c_void_p]

    def look(*_):
        at = libc.malloc(5000)
        found.append(ctypes.string_at(at, 5000) == b"\x70" * 5000)
        ctypes.memset(at, 1, 5000)
        libc.free(at)
        return True

    load().render(drawn.scene(20, 10, n=3), {}, progress=look)
    assert found and all(found)
    look()
    assert not found[-1]
