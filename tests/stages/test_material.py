# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs of materials against tests/reference/material.py, cut up in other ways, and wrong ones."""

from types import SimpleNamespace

import numpy as np
import pytest
from encre.pen import library
from encre.pen.errors import Cancelled, EncreError
from encre.pen.job import Frame, Materials, Picture, Program
from encre.pen.library import load
from reference.material import run
from views import crowded, looking, orthographic, perspective

OPERATIONS = load().operations
NAMES = list(OPERATIONS)
CONSTANTS = np.array([0.1, 0.5, 0.9, -2.5, 3.25, 0.75,  # and for bricks:
                      0.5, 2, 0.7, 3, 0.06, 0.3, -0.2, 0.5, 0.25,  # for noise:
                      2, 0.4,  # three stops:
                      0.1, 1, 0.2, 0, 1, 0.4, 0, 0.5, 1, 0.5, 0.8, 0.3, 0.3, 0.9, 1], np.float32)
DATA = {"constant": (3,), "channel": (1,), "thing": (1,), "footprint": (0, 0), "texture": (0,), "ramp": (17, 3),
        "steps": (17, 3), "curve": (0, 6), "brick": (6,), "noise": (15,)}


def row(name, out, inputs=(), data=None):
    data = DATA.get(name, ()) if data is None else data
    return [OPERATIONS[name][0], out, *inputs, *[0] * (8 - len(inputs)), *data, *[0] * (2 - len(data))]


def program(name, data=None):
    """One operation on the first three channels and the place, whose outputs are the colour."""
    _, inputs, outputs = OPERATIONS[name]
    given = [row("channel", k, data=(k,)) for k in range(3)]
    given.append(row("place", 3))
    taken = [k % 6 for k in range(inputs)]
    results = [6 + min(k, outputs - 1) for k in range(11)]
    return Program(np.array([*given, row(name, 6, taken, data)], np.int32), 6 + outputs, results)


def picture(rng, width=8, height=4, wrap="repeat"):
    levels, sizes = [], []
    while True:
        sizes.append((width, height))
        levels.append(rng.random((width * height, 4)).astype(np.float32))
        if max(width, height) == 1:
            return Picture(np.concatenate(levels), *sizes[0], len(levels), wrap)
        width, height = max(1, width // 2), max(1, height // 2)


def maps(rng, width=13, height=19, materials=3):
    near = rng.uniform(-2, 2, (height, width, 4)).astype(np.float32)
    near[..., :2] += np.stack(np.meshgrid(np.arange(width), np.arange(height)), 2).astype(np.float32) * 0.1
    thing = np.repeat(np.repeat(rng.integers(0, 5, (height // 4 + 1, width // 4 + 1)), 4, 0), 4, 1)[:height, :width]
    return {"object": thing.astype(np.float32), "material": (thing % materials).astype(np.float32),
            "depth": rng.uniform(1, 9, (height, width)).astype(np.float32),
            "normal": rng.uniform(-1, 1, (height, width, 3)).astype(np.float32), "attributes": near}


def place_at(view, projection, frame, x, y, z):
    """In world space, of what lies z deep at a pixel's centre."""
    screen = np.array([2 * (frame.x + x + 0.5) / frame.width - 1, 1 - 2 * (frame.y + y + 0.5) / frame.height])
    wide = -projection[3, 2] * z + projection[3, 3]
    camera = [(screen[k] * wide + projection[k, 2] * z - projection[k, 3]) / projection[k, k] for k in range(2)]
    return np.linalg.inv(view)[:3] @ [*camera, -z, 1]


def step(given, x, y, dx, dy):
    """By how much the attributes change to the nearer neighbour of the same surface."""
    found = [np.zeros(given["attributes"].shape[2])]
    for side in (-1, 1):
        px, py = x + side * dx, y + side * dy
        if 0 <= px < given["object"].shape[1] and 0 <= py < given["object"].shape[0] and all(
                given[name][py, px] == given[name][y, x] for name in ("object", "material")):
            found.append(side * (given["attributes"][py, px].astype(float) - given["attributes"][y, x]))
    return min(found[1:], key=lambda step: np.abs(step).sum(), default=found[0])


def expected(made, given, view, projection, frame):
    height, width = given["object"].shape
    out = np.zeros((height, width, 11))
    for y, x in zip(*np.nonzero(given["object"]), strict=True):
        used = made.programs[int(given["material"][y, x])]
        pixel = SimpleNamespace(channel=given["attributes"][y, x].astype(float), right=step(given, x, y, 1, 0),
                                down=step(given, x, y, 0, 1), normal=given["normal"][y, x].astype(float),
                                thing=int(given["object"][y, x]),
                                place=place_at(view, projection, frame, x, y, float(given["depth"][y, x])))
        reg = run(used, NAMES, pixel, CONSTANTS.astype(float), made.textures, made.things)
        out[y, x] = np.maximum(reg[list(used.result)], 0)
    return out


@pytest.mark.parametrize("projection", [perspective, orthographic])
@pytest.mark.parametrize("name", [name for name in NAMES])
def test_each_operation(name, projection):
    rng = np.random.default_rng(len(name))
    made = Materials([program("constant"), program(name), program("checker")],
                     [picture(rng, wrap=("repeat", "extend", "clip")[len(name) % 3])], CONSTANTS,
                     rng.random((6, 2)).astype(np.float32))
    given, view, frame = maps(rng), looking(rng), Frame(40, 50, 9, 4)
    got = load().material(made, given, view, projection(40, 50), frame)
    want = expected(made, given, view, projection(40, 50), frame)
    whole = np.concatenate([got[k] for k in ("color", "gloss", "emission", "surface")], 2)
    apart = np.abs(whole - want) / np.maximum(1, np.abs(want))
    assert np.mean(apart > 2e-4) < (0.01 if name in ("checker", "brick", "floor", "noise", "steps", "less") else 1e-9)
    assert whole.any()


@pytest.mark.parametrize("wrap", ["repeat", "extend", "clip"])
@pytest.mark.parametrize("size", [(1, 1), (8, 4), (5, 7), (64, 1)])
def test_pictures(wrap, size):
    rng = np.random.default_rng(size[0])
    operations = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("footprint", 2, data=(0, 0)),
                  row("texture", 6, range(6))]
    made = Materials([Program(np.array(operations, np.int32), 10, [6, 7, 8, 9] + [0] * 7)],
                     [picture(rng, *size, wrap)], CONSTANTS * np.float32(0.3))
    given, view = maps(rng, 19, 18, 1), looking(rng)
    got = load().material(made, given, view, perspective(19, 18), Frame(19, 18))["color"]
    for y, x in np.ndindex(*got.shape[:2]):
        if given["object"][y, x]:
            pixel = SimpleNamespace(channel=given["attributes"][y, x].astype(float), right=step(given, x, y, 1, 0),
                                    down=step(given, x, y, 0, 1))
            want = run(made.programs[0], NAMES, pixel, made.constants.astype(float), made.textures, [])[6:9]
            np.testing.assert_allclose(got[y, x], want, atol=2e-5)


def test_a_picture_of_one_colour_stays_that():
    texture = Picture(np.full((21, 4), 0.375, np.float32), 4, 4, 3)
    operations = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("texture", 6, [0, 1, 0, 0, 1, 1])]
    made = Materials([Program(np.array(operations, np.int32), 10, [6] * 11)], [texture])
    rng = np.random.default_rng(3)
    given = maps(rng, materials=1)
    got = load().material(made, given, looking(rng), perspective(13, 19), Frame(13, 19))["color"]
    np.testing.assert_allclose(got[given["object"] > 0], 0.375, rtol=1e-6)
    assert not got[given["object"] == 0].any()


def test_same_bytes_by_threads_and_instructions():
    rng = np.random.default_rng(8)
    made = Materials([program(name) for name in NAMES], [picture(rng)], CONSTANTS, np.ones((6, 2), np.float32))
    given, view = maps(rng, 150, 90, len(NAMES)), looking(rng)
    got = [load().material(made, given, view, perspective(150, 90), Frame(150, 90), threads, simd)
           for threads, simd in ((1, 1), (2, 1), (7, 0))]
    for other in got[1:]:
        for name, image in got[0].items():
            assert image.tobytes() == other[name].tobytes(), name


def test_whatever_comes_in_something_finite_comes_out():
    rng = np.random.default_rng(9)
    made = Materials([program(name) for name in NAMES], [picture(rng)], CONSTANTS, np.ones((6, 2), np.float32))
    given = maps(rng, 90, 60, len(NAMES))
    for name in ("attributes", "depth", "normal"):
        odd = rng.random(given[name].shape) < 0.3
        given[name][odd] = rng.choice([np.nan, np.inf, -np.inf, 3e38, -3e38, 1e-45], odd.sum())
    got = load().material(made, given, looking(rng), perspective(90, 60), Frame(90, 60))
    assert all(np.isfinite(image).all() and (image >= 0).all() for image in got.values())


def one(**changes):
    made = program("add")
    for name, value in changes.items():
        setattr(made, name, value)
    return made


@pytest.mark.parametrize(("made", "words"), [
    (one(registers=0), "registers"), (one(result=[7] * 11), "no register"),
    (one(operations=np.array([row("add", 0, (1, 0))], np.int32)), "can't use"),
    (one(operations=np.array([row("constant", 0, data=(len(CONSTANTS),))], np.int32)), "can't use"),
    (one(operations=np.array([row("channel", 0, data=(4,))], np.int32)), "can't use"),
    (one(operations=np.array([row("footprint", 0, data=(2, 0))], np.int32)), "can't use"),
    (one(operations=np.array([row("texture", 6, range(6), (1,))], np.int32), registers=10), "can't use"),
    (one(operations=np.array([row("thing", 0, data=(2,))], np.int32)), "can't use"),
    (one(operations=np.array([row("ramp", 1, (0,), (17, 4))], np.int32)), "can't use"),
    (one(operations=np.array([row("curve", 1, (0,), (0, 1))], np.int32)), "can't use"),
    (one(operations=np.array([[99, 0, *[0] * 10]], np.int32)), "unknown code 99"),
])
def test_programs_that_read_what_is_not_theirs_are_refused(made, words):
    rng = np.random.default_rng(10)
    with pytest.raises(EncreError, match=words):
        load().material(Materials([made], [picture(rng)], CONSTANTS, np.ones((6, 2), np.float32)), maps(rng),
                        looking(rng), perspective(13, 19), Frame(13, 19))


def test_cancelled():
    rng = np.random.default_rng(11)
    with pytest.raises(Cancelled):
        load().material(Materials([program("add")], (), CONSTANTS), maps(rng, materials=1), looking(rng),
                        perspective(13, 19), Frame(13, 19), progress=lambda _: False)


def test_only_what_lies_beyond_is_drawn():
    rng = np.random.default_rng(12)
    meshes, view, p, frame = crowded(rng), looking(rng), perspective(50, 40), Frame(50, 40)
    first = library.raster(meshes, view, p, frame, (50, 40), 0.1, outputs=("depth", "object"))
    open_ = rng.random((40, 50)) < 0.5
    behind = np.where(open_, first["depth"], np.float32(1e10))
    more = library.raster(meshes, view, p, frame, (50, 40), 0.1, outputs=("depth", "object"), beyond=behind)
    assert not more["object"][~open_].any()
    assert (more["depth"] > first["depth"])[open_ & (first["object"] > 0)].all() and more["object"].any()
    whole = library.raster(meshes, view, p, frame, (50, 40), 0.1, outputs=("depth",), beyond=np.zeros_like(behind))
    np.testing.assert_array_equal(whole["depth"], first["depth"])
