# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs of materials against tests/reference/material.py, cut up in other ways, and wrong ones."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from encre.pen import abi, library
from encre.pen.colour import decode_srgb
from encre.pen.errors import Cancelled, EncreError
from encre.pen.job import Frame, Materials, Picture, Program
from encre.pen.library import load
from reference.material import ALPHA, HOLDOUT, mean, run
from views import crowded, looking, orthographic, perspective

OPERATIONS = load().operations
NAMES = list(OPERATIONS)
CONSTANTS = np.array([0.1, 0.5, 0.9, -2.5, 3.25, 0.75,  # and for bricks:
                      0.5, 2, 0.7, 3, 0.06, 0.3, -0.2, 0.5, 0.25,  # for noise:
                      2, 0.4,  # three stops:
                      0.1, 1, 0.2, 0, 1, 0.4, 0, 0.5, 1, 0.5, 0.8, 0.3, 0.3, 0.9, 1], np.float32)
DATA = {"constant": (3,), "channel": (1,), "thing": (1,), "footprint": (0, 0), "texture": (0,), "ramp": (17, 3),
        "steps": (17, 3), "curve": (0, 6), "brick": (6,), "noise": (15,),
        "voronoi": (0, 0), "voronoi_second": (1, 0), "voronoi_smooth": (2, 2), "voronoi_edge": (0, 0)}


def row(name, out, inputs=(), data=None):
    data = DATA.get(name, ()) if data is None else data
    return [OPERATIONS[name][0], out, *inputs, *[0] * (8 - len(inputs)), *data, *[0] * (2 - len(data))]


def program(name, data=None):
    """One operation on the first three channels and the place, whose outputs are the colour."""
    _, inputs, outputs = OPERATIONS[name]
    given = [row("channel", k, data=(k,)) for k in range(3)]
    given.append(row("place", 3))
    taken = [k % 6 for k in range(inputs)]
    results = [6 + min(k, outputs - 1) for k in range(abi.RESULTS)]
    return Program(np.array([*given, row(name, 6, taken, data)], np.int32), 6 + outputs, results)


def picture(rng, width=8, height=4, wrap="repeat"):
    levels, sizes = [], []
    while True:
        sizes.append((width, height))
        levels.append(rng.random((width * height, 4)).astype(np.float32))
        if max(width, height) == 1:
            return Picture(np.concatenate(levels), *sizes[0], len(levels), wrap)
        width, height = max(1, width // 2), max(1, height // 2)


CURVE = np.array([decode_srgb(value / 255) for value in range(256)], np.float32)


def of_bytes(picture, straight):
    """Likewise of 8 bits."""
    return replace(picture, texels=np.rint(picture.texels * 255).astype(np.uint8), curve=CURVE, straight=straight)


def maps(rng, width=9, height=13, materials=3):
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


def side(given, x, y, dx, dy, bumps=False):
    """On which side the neighbour of the same surface is nearer, by attributes; 0: there is none. For bumps one that
    faces elsewhere is taken where there is no other."""
    found = {}
    for k in (-1, 1):
        px, py = x + k * dx, y + k * dy
        if 0 <= px < given["object"].shape[1] and 0 <= py < given["object"].shape[0] and all(
                given[name][py, px] == given[name][y, x] for name in ("object", "material")):
            away = np.abs(given["attributes"][py, px].astype(float) - given["attributes"][y, x]).sum()
            found[k] = (bumps and given["normal"][py, px] @ given["normal"][y, x] < 0.9), away
    return min(found, key=found.get, default=0)


def step(given, x, y, dx, dy, bumps=False):
    """By how much the attributes change to that neighbour."""
    k = side(given, x, y, dx, dy, bumps)
    return k * (given["attributes"][y + k * dy, x + k * dx].astype(float) - given["attributes"][y, x])


def beside(given, x, y, place, bumps):
    """By how much place(x, y) grows to the right and down."""
    grown = []
    for dx, dy in ((1, 0), (0, 1)):
        k = side(given, x, y, dx, dy, bumps)
        grown += [*(k * (place(x + k * dx, y + k * dy) - place(x, y)))]
    return grown


def towards(view, projection, place):
    """The unit vector to where a place is looked at from."""
    eye = np.linalg.inv(view)
    way = eye[:3, 3] - place if projection[3, 2] else eye[:3, 2]
    return way / np.linalg.norm(way)


def seen(view, frame, place, x, y):
    """A place as the camera has it: right, up, ahead; and in the frame."""
    right, up, back = view[:3, :3] @ place + view[:3, 3]
    return [right, up, -back, (frame.x + x + 0.5) / frame.width, 1 - (frame.y + y + 0.5) / frame.height]


def expected(made, given, view, projection, frame):
    height, width = given["object"].shape
    out = np.zeros((height, width, abi.RESULTS))
    for y, x in zip(*np.nonzero(given["object"]), strict=True):
        used = made.programs[int(given["material"][y, x])]
        bumps = NAMES.index("beside") in [o[0] for o in used.operations]

        def place(x, y):
            return place_at(view, projection, frame, x, y, float(given["depth"][y, x]))

        pixel = SimpleNamespace(channel=given["attributes"][y, x].astype(float), right=step(given, x, y, 1, 0, bumps),
                                down=step(given, x, y, 0, 1, bumps), normal=given["normal"][y, x].astype(float),
                                thing=int(given["object"][y, x]), place=place(x, y),
                                beside=beside(given, x, y, place, bumps),
                                incoming=towards(view, projection, place(x, y)),
                                camera=seen(view, frame, place(x, y), x, y))
        out[y, x] = mean(used, NAMES, pixel, np.asarray(made.constants, float), made.textures, made.things)
    least = np.zeros(abi.RESULTS)
    least[17:20] = -np.inf  # normals
    out = np.maximum(out, least)
    return out


def aside(projection):
    """Of a camera whose lens is shifted."""
    def shifted(width, height):
        p = projection(width, height)
        p[:2, 2 if p[3, 2] else 3] = 0.13, -0.21
        return p
    return shifted


def compare(made, given, projection=perspective, few=1e-9, seed=0):
    view, frame = looking(np.random.default_rng(seed)), Frame(40, 50, 9, 4)
    got = load().material(made, given, view, projection(40, 50), frame)
    want = expected(made, given, view, projection(40, 50), frame)
    whole = np.concatenate([got[k] for k in ("color", "gloss", "emission", "surface", "shine", "turned", "holdout")], 2)
    apart = np.abs(whole - want) / np.maximum(1, np.abs(want))
    assert np.mean(apart > 3e-5) < few, np.mean(apart > 3e-5)
    return whole


JUMPS = ("checker", "brick", "floor", "noise", "steps", "less", "voronoi", "voronoi_second")


PLACED = ("place", "incoming", "camera", "checker", "beside", "voronoi_edge")  # which a camera is known by


@pytest.mark.parametrize("name, projection", [
    *((name, aside(perspective)) for name in NAMES),
    *(pytest.param(name, aside(orthographic), marks=() if name in PLACED else pytest.mark.slow) for name in NAMES)])
def test_each_operation(name, projection):
    rng = np.random.default_rng(len(name))
    made = Materials([program("constant"), program(name), program("checker")],
                     [picture(rng, wrap=("repeat", "extend", "clip")[len(name) % 3])], CONSTANTS,
                     rng.random((6, 2)).astype(np.float32))
    assert compare(made, maps(rng), projection, 0.01 if name in JUMPS else 1e-9).any()


@pytest.mark.parametrize("name", [name for name in NAMES])
def test_each_operation_on_whole_numbers(name):
    """Where numbers are equal, nothing is divided by, and powers have a sign."""
    rng = np.random.default_rng(5)
    given = maps(rng, 9, 9, 1)
    given["attributes"] = np.round(2 * given["attributes"] - 0.3) + 0  # no 0 is negative
    given["attributes"][:2] *= 0.5
    made = Materials([program(name)], [picture(rng)], CONSTANTS, rng.random((6, 2)).astype(np.float32))
    compare(made, given, few=0.01 if name == "brick" else 1e-9)  # thirteenths, too, lie on its joints


BRICKS = ("offset", "offset_every", "squash", "squash_every", "mortar", "smooth", "bias", "width", "height")


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3, 4))])
def test_bricks_of_any_kind(seed):
    rng = np.random.default_rng(seed)
    wall = dict(offset=rng.random(), offset_every=rng.choice([0.5, 1, 2, 3]), squash=rng.uniform(0.3, 2),
                squash_every=rng.choice([0.9, 1, 2, 4]), mortar=rng.uniform(0.02, 0.1), smooth=rng.choice([0, 0.6, 1]),
                bias=rng.uniform(-0.5, 0.5), width=rng.uniform(0.3, 0.8), height=rng.uniform(0.15, 0.4))
    constants = np.array([wall[name] for name in BRICKS], np.float32)
    compare(Materials([program("brick", (0,))], [picture(rng)], constants), maps(rng, 17, 17, 1), few=0.01)


SLOPES = {  # on a plane of which a pixel is a small part
    "add": (0, 1), "subtract": (0, 1), "multiply": (1, 3), "divide": (0, 3), "minimum": (0, 1), "maximum": (0, 1),
    "mix": (0, 1, 2), "absolute": (0,), "root": (0,), "clamp": (0,), "sine": (0,), "cosine": (0,), "angle": (0, 1),
    "power": (0, 3), "logarithm": (0,), "noise": (0, 1, 2, 3), "ramp": (0,), "floor": (0,),
    "checker": (0, 1, 2), "brick": (0, 1), "steps": (0,), "place": ()}


@pytest.mark.parametrize(("name", "last"), [*((name, "less") for name in SLOPES), ("add", "greater"), ("add", "floor"),
                                            ("add", "steps")])
def test_no_jump_within_a_pixel_is_missed(name, last):
    """Thirteen places are looked at only where something may jump: the pictures are those of thirteen everywhere."""
    rng = np.random.default_rng(len(name))
    given = plane(rng, 10, 8)
    wide = OPERATIONS[name][2]
    rows = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("channel", 2, data=(2,)),
            row("constant", 3, data=(4,)), row(name, 6, SLOPES[name]), row("multiply", 4, (6, 3)),
            row("constant", 5, data=(0,)), row(last, 6 + wide, (4, 5)[:OPERATIONS[last][1]])]
    result = [6 + wide] * abi.RESULTS
    result[ALPHA] = result[HOLDOUT] = 5
    made = Program(np.array(rows, np.int32), 6 + wide + OPERATIONS[last][2], result)
    compare(Materials([made], [picture(rng)], CONSTANTS), given, few=0.01)


def plane(rng, width, height):
    """Of one thing, whose attributes and place grow evenly."""
    given = maps(rng, width, height, 1)
    given["object"][:], given["material"][:], given["depth"][:] = 1, 0, 3
    x, y = np.meshgrid(np.arange(width) - 0.45 * width, np.arange(height) - 0.55 * height)
    given["attributes"][:] = np.stack([0.06 * x + 0.026 * y, 0.042 * y - 0.034 * x, 0.02 * (x + y), 0 * x], 2)
    return given


def test_where_nothing_jumps_the_middle_counts():
    """A square beside a step far off is what its pixel's middle is, and not the mean."""
    given = plane(np.random.default_rng(0), 30, 6)
    given["attributes"][..., 0] = np.arange(30)
    rows = [row("channel", 0, data=(0,)), row("constant", 1, data=(0,)), row("less", 2, (0, 1)),
            row("multiply", 3, (0, 0)), row("add", 4, (2, 3)), row("constant", 5, data=(0,))]
    result = [4] * abi.RESULTS
    result[ALPHA] = result[HOLDOUT] = 5
    made = Materials([Program(np.array(rows, np.int32), 6, result)], [], np.array([17.1], np.float32))
    got = load().material(made, given, np.eye(4), perspective(30, 6), Frame(30, 6))["color"][0, :, 0]
    off = got - np.arange(30) ** 2 - (np.arange(30) < 17.1)
    assert np.flatnonzero(off).tolist() == [17], off


def test_joints_narrower_than_a_pixel_are_whole():
    """Half a pixel wide and hardly aslant: as much of it in each column, to two of thirteen places."""
    given = maps(np.random.default_rng(0), 60, 13, 1)
    x, y = np.meshgrid(np.arange(60), np.arange(13))
    given["attributes"][..., :2] = np.stack([0.01 * x + 7, (y + 0.11 * x) / 20 + 0.6], 2)
    given["object"][:], given["material"][:] = 1, 0
    made = program("brick", (0,))
    mortar, one = 7, 8
    results = [mortar] * abi.RESULTS
    results[ALPHA] = results[HOLDOUT] = one
    made = Program(np.array([*made.operations, row("constant", one, data=(9,))], np.int32), 9, results)
    joints = np.array([0, 0, 1, 0, 0.25 / 20, 0, 0, 1000, 1, 1], np.float32)
    got = load().material(Materials([made], [], joints), given, np.eye(4), perspective(60, 13), Frame(60, 13, 0, 0))
    assert np.abs(got["color"][..., 0].sum(0) - 0.5).max() < 2 / 13


@pytest.mark.parametrize("cut", [ALPHA, HOLDOUT])
def test_a_cut_out_has_no_fringe(cut):
    """What is there at the middle of a pixel has the colour of what is there, not of the hole beside it."""
    given = maps(np.random.default_rng(0), 30, 5, 1)
    given["attributes"][..., 0] = 0.1 * np.arange(30)
    given["object"][:], given["material"][:] = 1, 0
    results = [1] * abi.RESULTS
    results[:3], results[cut] = [2] * 3, 2
    made = Program(np.array([row("constant", 1, data=(0,)), row("channel", 0, data=(0,)), row("less", 2, (0, 1))],
                            np.int32), 3, results)
    got = load().material(Materials([made], [], np.array([1.23], np.float32)), given, np.eye(4), perspective(30, 5),
                          Frame(30, 5, 0, 0))
    assert np.array_equal(got["color"][..., 0], np.broadcast_to(0.1 * np.arange(30) < 1.23, (5, 30)))


@pytest.mark.parametrize("octaves, part", [(-1, 0), (0, 0.7), (1, 0), (5, 0.2), (15, 0.5), (40, 0)])
def test_noise_of_so_many_octaves(octaves, part):
    """16 at most, each half as large as the one before."""
    rng = np.random.default_rng(6)
    given = maps(rng, 5, 4, 1)
    given["attributes"] *= 0.1  # so that those that are small tell apart, too
    operations = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("channel", 2, data=(2,)),
                  row("constant", 3, data=(2,)), row("noise", 6, (0, 1, 2, 3), (0,))]
    made = Materials([Program(np.array(operations, np.int32), 7, [6] * abi.RESULTS)], (),
                     np.array([octaves, part, 0.9], np.float32))
    given["object"][:] = 1
    compare(made, given, few=1e-9 if octaves < 10 else 0.3)


@pytest.mark.parametrize("name", [name for name in NAMES if name.startswith("voronoi")])
@pytest.mark.parametrize("metric", range(3))
@pytest.mark.parametrize("kind", range(4))
def test_cells_of_any_kind(name, metric, kind):
    """All seven results, with points that are everywhere, hardly anywhere but in corners, and in these."""
    rng = np.random.default_rng(8)
    operations = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("channel", 2, data=(2,)),
                  row("constant", 3, data=(0,)), row("constant", 4, data=(1,)), row(name, 6, range(5), (metric, kind))]
    operations[-1][2 + OPERATIONS[name][1]:10] = [0] * (8 - OPERATIONS[name][1])
    outputs = OPERATIONS[name][2]
    for random, smooth in ((1, 0.5), (0.7, 0.1), (0.2, 0.3)):
        made = Materials([Program(np.array(operations, np.int32), 6 + outputs,
                                  [6 + min(k, outputs - 1) for k in range(abi.RESULTS)])], (),
                         np.array([random, smooth], np.float32))
        compare(made, maps(rng, 9, 7, 1), few=0.01)


@pytest.mark.parametrize("name", ["ramp", "steps"])
@pytest.mark.parametrize("places", [[0.5], [0.2, 0.2], [-1, 0, 0, 1.5], [0.1, 0.2, 0.3, 0.9, 0.95]])
def test_ramps_of_any_stops(name, places):
    rng = np.random.default_rng(7)
    constants = np.concatenate([[9], np.c_[places, rng.random((len(places), 4))].ravel()]).astype(np.float32)
    made = Materials([program(name, (1, len(places)))], (), constants)
    compare(made, maps(rng, 15, 15, 1))


@pytest.mark.parametrize("made_of", ["floats", "bytes", "straight"])
@pytest.mark.parametrize("wrap", ["repeat", "extend", "clip"])
@pytest.mark.parametrize("size, wide", [((1, 1), 0.3), ((8, 4), 0.3), ((5, 7), 0.3), ((64, 1), 0.3), ((37, 19), 0.03),
                                        ((37, 19), 1)])
def test_pictures(wrap, size, wide, made_of):
    rng = np.random.default_rng(size[0])
    shown = picture(rng, *size, wrap)
    if made_of != "floats":
        shown = of_bytes(shown, made_of == "straight")
    operations = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("footprint", 2, data=(0, 0)),
                  row("texture", 6, range(6))]
    made = Materials([Program(np.array(operations, np.int32), 10, [6, 7, 8, 9] + [0] * (abi.RESULTS - 4))],
                     [shown], CONSTANTS * np.float32(wide))
    given, view = maps(rng, 19, 18, 1), looking(rng)
    got = load().material(made, given, view, perspective(19, 18), Frame(19, 18))["color"]
    for y, x in np.ndindex(*got.shape[:2]):
        if given["object"][y, x]:
            pixel = SimpleNamespace(channel=given["attributes"][y, x].astype(float), right=step(given, x, y, 1, 0),
                                    down=step(given, x, y, 0, 1))
            want = run(made.programs[0], NAMES, pixel, made.constants.astype(float), made.textures, [])[6:9]
            np.testing.assert_allclose(got[y, x], want, atol=2e-5)


@pytest.mark.parametrize("straight", [False, True])
@pytest.mark.parametrize("size", [(1, 1), (8, 4), (5, 7), (64, 1), (1, 9), (37, 19)])
def test_levels_of_bytes_are_means_of_light(size, straight):
    """Each texel the code whose light is nearest to the mean of up to four."""
    made = of_bytes(picture(np.random.default_rng(size[0]), *size), straight)
    given, at = made.texels.copy(), size[0] * size[1]
    made.texels[at:] = 7
    load().picture_levels(made)
    np.testing.assert_array_equal(made.texels[:at], given[:at])
    before = made.texels[:at].reshape(size[1], size[0], 4)
    for _ in range(made.levels - 1):
        rows, columns = (slice(None) if n == 1 else slice(n // 2 * 2) for n in before.shape[:2])
        even = before[rows, columns]
        even = even.reshape(max(1, even.shape[0] // 2), -1, max(1, even.shape[1] // 2), min(2, even.shape[1]), 4)
        share = np.where(straight, even[..., 3:].astype(float), 1)
        whole = share.sum((1, 3))
        mean = (CURVE.astype(float)[even[..., :3]] * share).sum((1, 3)) / np.maximum(whole, 1e-9)
        got = made.texels[at:at + mean.shape[0] * mean.shape[1]].reshape(*mean.shape[:2], 4)
        nearest = np.abs(CURVE.astype(float) - mean[..., None])
        error = np.take_along_axis(nearest, got[..., :3, None].astype(int), 3)[..., 0] - nearest.min(3)
        assert np.where(whole > 0, error, 0).max() < 1e-6
        np.testing.assert_allclose(got[..., 3], even[..., 3].mean((1, 3)), atol=0.5)
        at, before = at + mean.shape[0] * mean.shape[1], got


@pytest.mark.parametrize("change", [{"texels": np.zeros((20, 4), np.uint8)}, {"levels": 4}, {"curve": CURVE[::-1]},
                                    {"curve": np.where(np.arange(256) == 9, np.nan, CURVE)}, {"curve": CURVE[:9]},
                                    {"texels": np.zeros((21, 4), np.float32)}])
def test_pictures_of_bytes_that_cannot_be_used_are_refused(change):
    made = replace(Picture(np.zeros((21, 4), np.uint8), 4, 4, 3, curve=CURVE), **change)
    with pytest.raises(EncreError, match="^tex"):
        load().picture_levels(made)


def test_a_picture_of_one_colour_stays_that():
    texture = Picture(np.full((21, 4), 0.375, np.float32), 4, 4, 3)
    operations = [row("channel", 0, data=(0,)), row("channel", 1, data=(1,)), row("texture", 6, [0, 1, 0, 0, 1, 1])]
    made = Materials([Program(np.array(operations, np.int32), 10, [6] * abi.RESULTS)], [texture])
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
    assert all(np.isfinite(image).all() and (name == "turned" or (image >= 0).all()) for name, image in got.items())


def one(**changes):
    made = program("add")
    for name, value in changes.items():
        setattr(made, name, value)
    return made


@pytest.mark.parametrize(("made", "words"), [
    (one(registers=0), "registers"), (one(result=[7] * abi.RESULTS), "no register"),
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
                        perspective(13, 19), Frame(13, 19), threads=1, progress=lambda _: False)


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
