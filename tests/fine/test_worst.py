# SPDX-License-Identifier: GPL-3.0-or-later
"""White noise, the worst that FINE can be given: what it costs beside a usual picture, how soon it can be cancelled.

Work is counted, in basic blocks that run, so that it is the same on a busy machine."""

import ctypes
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import bench
import noise
import numpy as np
import pytest
from encre.pen.installed import LIBRARY
from encre.pen.library import Library, load

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
WIDTH, HEIGHT = 640, 360
SETTINGS = bench.SOURCES["with colour and light"]
FLAGS = ("-std=c11", f"-I{ROOT / 'csrc'}", "-O1", "-fPIC", "-D_POSIX_C_SOURCE=200809L", "-ffp-contract=off",
         "-fvisibility=hidden", "-pthread")
PICTURES = {"usual": lambda *size: bench.balls(*size, 298), "empty": lambda *size: bench.balls(*size, 0),
            "everywhere": noise.everywhere, "textures": noise.textures}


@pytest.fixture(scope="module")
def counted(tmp_path_factory):
    """A library that counts its work."""
    compiler, folder = shlex.split(os.environ.get("CC", "cc")), tmp_path_factory.mktemp("counted")

    def build(source):
        out = folder / f"{source.stem}.o"
        option = () if source.name == "counted.c" else ("-fsanitize-coverage=trace-pc",)
        subprocess.run([*compiler, *FLAGS, *option, "-c", str(source), "-o", str(out)], check=True)
        return str(out)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(build, [*ROOT.glob("csrc/**/*.c"), ROOT / "tests" / "helpers" / "counted.c"]))
    subprocess.run([*compiler, "-shared", "-pthread", *objects, "-lm", "-o", str(folder / LIBRARY)], check=True)
    return Library(str(folder / LIBRARY))


@pytest.fixture(scope="module")
def polls(counted):
    """What the work has come to at each call of the progress function, and at the end, by picture."""
    work, found = ctypes.c_ulong.in_dll(counted.lib, "work"), {}
    for name, picture in PICTURES.items():
        found[name], work.value = [0], 0
        counted.render(picture(480, 270), SETTINGS, threads=1,
                       progress=lambda _, own=found[name]: own.append(work.value) or True)
        found[name].append(work.value)
    return found


@pytest.mark.skipif(sys.platform != "linux", reason="the compiler's counters are looked for in a Linux library")
@pytest.mark.parametrize("name", PICTURES)
def test_between_two_polls_lies_at_most_a_twentieth_of_the_work(polls, name):
    assert np.diff(polls[name]).max() <= polls[name][-1] / 20


@pytest.mark.skipif(sys.platform != "linux", reason="the compiler's counters are looked for in a Linux library")
@pytest.mark.parametrize("name", ["everywhere", "textures"])
def test_noise_is_at_most_17_times_the_work_of_a_few_balls(polls, name):
    assert polls[name][-1] <= 17 * polls["usual"][-1]


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallinfo2"), reason="needs glibc's count of memory")
@pytest.mark.parametrize("picture", [noise.everywhere, noise.textures])
def test_noise_holds_at_most_165_bytes_a_pixel(picture):
    assert bench.held_bytes(picture(WIDTH, HEIGHT), SETTINGS) <= 165 * WIDTH * HEIGHT


@pytest.mark.parametrize("picture", [noise.everywhere, noise.textures])
def test_the_strongest_are_the_same_on_any_number_of_threads(picture):
    layers = picture(300, 200)
    one, *others = (load().render(layers, SETTINGS, outputs=["Encre Lines", "Encre Edges"], threads=threads, simd=simd)
                    for threads, simd in ((1, 1), (2, 1), (3, 0)))
    assert all(other.images[name].tobytes() == one.images[name].tobytes() for other in others for name in one.images)


def test_what_is_kept_is_strong_and_lies_everywhere():
    """Of a tile of noise, in stripes of two contrasts, the strong half stays whole; and no part of it is empty."""
    side = 128
    layers = noise.textures(side, side)
    weak = np.arange(side) % 32 >= 16
    layers["albedo"][:, weak] = 0.5 + 0.2 * (layers["albedo"][:, weak] - 0.5)
    settings = dict(edge_detector="FINE", line_color_strength=1.0, edge_threshold=0.0, line_crease_strength=0.0,
                    contrast_full=1.0)
    strength = load().render(layers, settings, outputs=["Encre Edges"]).images["Encre Edges"][..., 0]
    assert strength[:, ~weak].mean() > 2 * strength[:, weak].mean()

    found = load().render(noise.everywhere(400, 300), SETTINGS, outputs=["Encre Edges"]).images["Encre Edges"][..., 0]
    blocks = (found[:288, :384] > 0).reshape(18, 16, 24, 16).mean((1, 3))
    assert blocks.min() > 0.5 * blocks.mean() and blocks.max() < 1.5 * blocks.mean()
