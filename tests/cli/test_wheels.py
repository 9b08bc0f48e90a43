# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels of other platforms, built here: what can be run here draws the same bytes."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from encre.pen import library

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "tests" / "helpers" / "goldens.c"
ARM = Path("/usr/aarch64-linux-gnu")

pytestmark = [pytest.mark.long, pytest.mark.timeout(3600),
              pytest.mark.skipif(not importlib.util.find_spec("ziglang"), reason="needs the package ziglang")]


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


@pytest.fixture(scope="module")
def made():
    """Paths of all that is downloaded. The tool itself looks at formats, names, and the age of the Linux."""
    return [ROOT / line for line in run(sys.executable, ROOT / "tools" / "wheels.py").splitlines()]


@pytest.fixture(scope="module")
def goldens(tmp_path_factory):
    """What this machine's own library draws, hash by hash."""
    program = tmp_path_factory.mktemp("goldens") / "goldens"
    run("cc", "-std=c11", f"-I{ROOT / 'csrc'}", SOURCE, "-o", program, "-ldl")
    said = run(program, library.load().path)
    assert len(set(said.splitlines())) > 900
    return program, said


def compiled(target, program, *options):
    run(sys.executable, "-m", "ziglang", "cc", "-target", target, "-O2", f"-I{ROOT / 'csrc'}", SOURCE, "-o", program,
        *options)
    return program


def unpacked(made, part, folder):
    [wheel] = [path for path in made if path.suffix == ".whl" and part in path.name]
    with zipfile.ZipFile(wheel) as held:
        [name] = [name for name in held.namelist() if name.startswith("encre/libencre.")]
        return held.extract(name, folder)


def test_there_is_a_wheel_and_an_extension_for_every_platform(made):
    assert all(path.is_file() for path in made)
    addons = [path for path in made if path.name.endswith("-addon.zip")]
    extensions = [path for path in made if path.suffix == ".zip" and path not in addons]
    platforms = {path.stem.split("-", 2)[2] for path in extensions}
    assert platforms == {"linux-x64", "linux-arm64", "macos-x64", "macos-arm64", "windows-x64"}
    wheels = [path for path in made if path.suffix == ".whl"]
    assert len(wheels) == len(addons) == len(platforms)
    with zipfile.ZipFile(wheels[0]) as first:
        python = {name for name in first.namelist() if name.endswith((".py", ".json"))}
    assert "encre/cli/inside.py" in python
    for path in made:
        if path in addons:
            continue
        with zipfile.ZipFile(path) as held:
            names = set(held.namelist())
            if path in wheels:
                assert {name for name in names if name.endswith((".py", ".json"))} == python
                continue
            assert {"__init__.py", "pen/library.py", "presets/ink_only.json"} < names
            assert f'platforms = ["{path.stem.split("-", 2)[2]}"]' in held.read("blender_manifest.toml").decode()


def test_the_index_is_what_blender_itself_would_write(made, tmp_path):
    """By `server-generate` of a Blender that has it, of the same files."""
    bpy = pytest.importorskip("bpy", reason="needs Blender's Python module")
    tool = next(Path(bpy.__file__).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"), None)
    if not tool:
        pytest.skip("needs Blender 4.2 or later")
    for path in made:
        if path.suffix == ".zip" and not path.name.endswith("-addon.zip"):
            shutil.copy(path, tmp_path)
    run(sys.executable, tool, "server-generate", f"--repo-dir={tmp_path}")

    def read(folder):
        index = json.loads((folder / "index.json").read_text(encoding="utf-8"))
        return {entry["archive_url"]: entry for entry in index.pop("data")}, index

    ours, blenders = read(made[0].parent), read(tmp_path)
    assert ours == blenders and len(ours[0]) == 5
    sums = dict(reversed(line.split("  ")) for line in
                (made[0].parent / "SHA256SUMS").read_text(encoding="utf-8").splitlines())
    assert set(sums) == {path.name for path in made} | {"index.json"}


def test_linux_draws_the_same_bytes(made, goldens, tmp_path):
    program, here = goldens
    assert run(program, unpacked(made, "manylinux_2_28_x86_64", tmp_path)) == here


@pytest.mark.skipif(not (shutil.which("qemu-aarch64") and ARM.is_dir()), reason="needs qemu-user, libc6-arm64-cross")
def test_arm_draws_the_same_bytes(made, goldens, tmp_path):
    program = compiled("aarch64-linux-gnu.2.28", tmp_path / "goldens", "-ldl")
    said = run("qemu-aarch64", "-L", ARM, program, unpacked(made, "manylinux_2_28_aarch64", tmp_path))
    assert said == goldens[1]


@pytest.mark.skipif(not shutil.which("wine"), reason="needs wine")
def test_windows_draws_the_same_bytes(made, goldens, tmp_path):
    program = compiled("x86_64-windows-gnu", tmp_path / "goldens.exe")
    dll = Path(unpacked(made, "win_amd64", tmp_path))
    said = run("wine", program.name, dll.relative_to(tmp_path), cwd=tmp_path,
               env={**os.environ, "WINEPREFIX": str(tmp_path / "wine"), "WINEDEBUG": "-all"})
    assert said.replace("\r", "") == goldens[1]
