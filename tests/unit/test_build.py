# SPDX-License-Identifier: GPL-3.0-or-later
"""The library as compilers build it: no warnings, nothing but encre_* outside, the same bytes from every build."""

import ctypes
import importlib.util
import os
import platform
import runpy
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

import built
import drawn
import numpy as np
import pytest
from encre.pen.installed import LIBRARY
from encre.pen.job import Frame, Mesh
from encre.pen.library import Library, load

ROOT = Path(__file__).parents[2]
SETTINGS = [
    {},
    dict(edge_detector="SOBEL", line_search="NEAREST", contrast_local=True, contrast_metric="CMC",
         line_color_strength=2.0),
    dict(line_color_strength=3.0, line_shadow_strength=4.0, line_thickness=30.0, ink_tint=0.5,
         contrast_metric="CIEDE2000",
         color_layer="LIT"),
    dict(edge_detector="DOG", line_search="WALK",
         depth_space="LINEAR", color_detector="DOG", line_color_strength=1.0, paper_scale=2.5),
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


# Where cc is gcc, the first is what is installed; of clang, test_mutate has a build that is soon made.
@pytest.mark.long
@pytest.mark.parametrize(("compiler", "options"), [("gcc", []), ("clang", []), ("clang", ["--scalar"])])
def test_every_build_gives_the_same_bytes(tmp_path, bytes_here, compiler, options):
    assert pictures(build(tmp_path, compiler, *options)) == bytes_here


def test_the_scalar_build_gives_the_same_bytes(tmp_path, bytes_here):
    assert pictures(Library(str(built.library(tmp_path / LIBRARY)))) == bytes_here


def test_what_has_changed_is_compiled_again(tmp_path, monkeypatch):
    """A source, what it includes, or the command; and nothing else."""
    monkeypatch.chdir(tmp_path)
    source, header, made = (tmp_path / name for name in ("one.c", "one.h", "one.o"))
    source.write_text('#include "one.h"\n', encoding="utf-8")
    header.write_text("int one;\n", encoding="utf-8")
    compile_ = runpy.run_path(str(ROOT / "setup.py"), run_name="tests")["_compile"]
    command = [*shlex.split(os.environ.get("CC", "cc")), "-c", "one.c", "-o", str(made)]
    more = [*command[:-2], "-g", *command[-2:]]

    def compiled(command):
        before = made.stat().st_mtime_ns if made.exists() else 0
        assert compile_(command) == 0
        return made.stat().st_mtime_ns != before

    def touch(path):
        os.utime(path, ns=(made.stat().st_mtime_ns + 1_000_000,) * 2)
        time.sleep(0.01)

    assert [compiled(c) for c in (command, command, more, more)] == [True, False, True, False]
    for path in source, header:
        touch(path)
        assert compiled(more) and not compiled(more)
    header.write_text("what is no C\n", encoding="utf-8")
    touch(header)
    assert compile_(more) and compile_(more)  # an object that is left from before is none of what stands there


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


@pytest.mark.skipif(platform.machine() != "x86_64" or sys.platform != "linux", reason="asks Linux of an x86-64")
@pytest.mark.parametrize("compiler", ["gcc", "clang", pytest.param("ziglang", marks=pytest.mark.long)])
def test_the_best_instructions_are_found_by_every_compiler(compiler, tmp_path):
    """Wheels' compiler, too, whose own library says that a processor can do nothing."""
    if not (shutil.which(compiler) or importlib.util.find_spec(compiler)):
        pytest.skip(f"needs the compiler {compiler}")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-linux-gnu.2.28"]
    subprocess.run([*(zig if compiler == "ziglang" else [compiler]), "-std=c11", "-shared", "-fPIC", "-DENCRE_HAVE_V3",
                    f"-I{ROOT / 'csrc'}", ROOT / "csrc" / "base" / "cpu.c", "-o", tmp_path / "cpu.so"], check=True)
    runs = ctypes.CDLL(str(tmp_path / "cpu.so")).cpu_runs_v3
    runs.restype = ctypes.c_bool
    flags = set(Path("/proc/cpuinfo").read_text().split("flags", 1)[1].partition("\n")[0].split())
    assert runs() == ({"avx2", "fma", "bmi1", "bmi2", "f16c", "movbe", "abm"} <= flags)
