# SPDX-License-Identifier: GPL-3.0-or-later
"""The library as compilers build it: no warnings, nothing but encre_* outside, the same bytes from every build."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import built
import drawn
import numpy as np
import pytest
from encre.pen.job import Frame, Mesh
from encre.pen.library import LIBRARY, Library, load

ROOT = Path(__file__).parents[2]
SETTINGS = [
    {},
    dict(edge_detector="SOBEL", line_search="NEAREST", contrast_auto=True, contrast_metric="CMC", edge_color=2.0),
    dict(edge_color=3.0, edge_light=4.0, line_thickness=30.0, line_tint=0.5, contrast_metric="CIEDE2000",
         color_layer="LIT"),
    dict(edge_detector="DOG", line_search="WALK",
         depth_space="LINEAR", color_detector="DOG", edge_color=1.0, paper_scale=2.5),
]


def build(folder, compiler, *options):
    """The library, built by setup.py as a user builds it."""
    if not shutil.which(compiler):
        pytest.skip(f"needs the compiler {compiler}")
    done = subprocess.run(
        [sys.executable, "setup.py", "-q", "build_ext", "--werror", *options, f"--build-lib={folder}",
         f"--build-temp={folder}/temp"], cwd=ROOT, capture_output=True, text=True, env={**os.environ, "CC": compiler})
    assert done.returncode == 0, done.stderr
    return Library(str(folder / "encre" / LIBRARY))


def pictures(library, threads=0, simd=1):
    """All outputs for all settings, two styles, and the rasteriser's, as bytes."""
    layers = drawn.scene(193, 121, noise=0.02)
    layers["style"] = (layers["object"] % 2).astype(np.float32)
    layers["diffuse"][3, 5] = np.nan
    styles = [{"line_thickness": 20.0, "hatch_amount": 1.0}]
    out = [library.render(layers, values, styles, outputs=list(library.outputs), threads=threads, simd=simd).images
           for values in SETTINGS]
    rng = np.random.default_rng(1)
    meshes = [Mesh(rng.normal(size=(300, 3)) * (3, 2, 2) - (0, 0, 8), attributes=rng.random((100, 3, 6)),
                        object_index=k) for k in range(1, 4)]
    projection = np.array([[1.2, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])
    out.append(library.raster(meshes, np.eye(4), projection, Frame(193, 121), (193, 121), 0.1, channels=6,
                              threads=threads))
    return [{name: picture.tobytes() for name, picture in images.items()} for images in out]


@pytest.fixture(scope="module")
def bytes_here():
    return pictures(load())


# Where cc is gcc, the first is what is installed.
@pytest.mark.parametrize(("compiler", "options"), [
    pytest.param("gcc", [], marks=pytest.mark.long), pytest.param("clang", [], marks=pytest.mark.long),
    ("clang", ["--scalar"])])
def test_every_build_gives_the_same_bytes(tmp_path, bytes_here, compiler, options):
    assert pictures(build(tmp_path, compiler, *options)) == bytes_here


def test_the_scalar_build_gives_the_same_bytes(tmp_path, bytes_here):
    assert pictures(Library(str(built.library(tmp_path / LIBRARY)))) == bytes_here


@pytest.mark.parametrize("simd", [0, 1])
@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_every_thread_count_gives_the_same_bytes(bytes_here, threads, simd):
    assert pictures(load(), threads, simd) == bytes_here


@pytest.mark.skipif(sys.platform != "linux", reason="reads an ELF file with nm and readelf")
def test_only_our_names_are_seen_and_only_the_system_is_needed():
    def lines(*command):
        done = subprocess.run([*command, load().path], capture_output=True, text=True, check=True)
        return done.stdout.splitlines()

    ours = [line.split()[-1] for line in lines("nm", "-D", "--defined-only")]
    assert ours and all(name.startswith("encre_") for name in ours)
    needed = {line.split("[")[1].split(".so")[0] for line in lines("readelf", "-d") if "(NEEDED)" in line}
    assert needed <= {"libc", "libm", "libpthread"}


@pytest.mark.long
def test_debug_and_sanitizer_builds_run(tmp_path):
    for folder, option in (("debug", "--debug"), ("sane", "--sanitize=undefined")):
        assert pictures(build(tmp_path / folder, "gcc", option)) == pictures(load())
