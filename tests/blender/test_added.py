# SPDX-License-Identifier: GPL-3.0-or-later
"""One thing, one place: a stage, a painted control and a setting of objects are added in a copy of the sources, by the
files and lines that their rows' comments name and no others, and work in Blender and in `encre composite`."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import blenders
import numpy as np
import pytest
from encre.cli import multilayer

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]

LINES = {
    # the stage's
    "csrc/base/all.rows.h": ('#include "ink/lines.rows.h"\n', '#include "added/negative.rows.h"\n'),
    "csrc/base/stage.h": ("X(hatch)", " X(negative)"),
    # the control's
    "csrc/base/controls.rows.h": (
        '"no pencil", "Encre Surface Controls", 2)\n',
        'CONTROL(NEGATIVE, "negative", "Negative", "all negative", "none", "Encre Negative Controls", 1)\n'),
    # the setting's
    "addon/blender/properties.py": (
        '            ("object",)),\n',
        '        Own("nickname", "text", "Nickname", "What we call it", ("object",)),\n'),
}


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """The copy's package, built."""
    copy = tmp_path_factory.mktemp("copy")
    for folder in ("csrc", "addon"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=shutil.ignore_patterns("libencre.*", "__pycache__"))
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    shutil.copytree(Path(__file__).with_name("added"), copy / "csrc" / "added")
    for name, (after, line) in LINES.items():
        text = (copy / name).read_text(encoding="utf-8")
        head, found, tail = text.partition(after)
        assert found, name
        (copy / name).write_text(head + found + line + tail, encoding="utf-8")
    done = subprocess.run([sys.executable, "setup.py", "-q", "build_ext", "--inplace", "--scalar", "--werror"],
                          cwd=copy, capture_output=True, text=True, env={**os.environ, "CFLAGS": "-O0"})
    assert done.returncode == 0, done.stderr
    return copy / "addon"


@pytest.mark.parametrize("blender", blenders.params())
def test_what_is_added_by_its_rows_works_in_blender(blender, package, tmp_path):
    shot = blenders.run(blender, "added", tmp_path, {"ENCRE_PACKAGE": str(package)})
    assert shot.facts["error"] == [None] and shot.facts["nickname"] == ["Dice"]
    assert shot.facts["panel"] == [True] and shot.facts["header"] == [True]
    off, on = shot.passes("off"), shot.passes("on")
    assert off["Combined"].tobytes() == shot.passes("cycles")["Combined"].tobytes()

    painted = on["Encre Negative Controls"]
    assert painted.shape == (*on["Combined"].shape[:2], 3) and not painted[..., [0, 2]].any()
    amount = 1 + painted[..., 1:2]  # the cube is painted -0.75, the ball has a value of its own
    assert np.unique(np.round(amount, 3)).tolist() == [0.25, 0.5, 1.0]
    plain, alpha = on["Encre Source"][..., :3], on["Encre Source"][..., 3:]
    assert plain.tobytes() == off["Combined"][..., :3].tobytes()
    np.testing.assert_allclose(on["Combined"][..., :3], plain + (alpha - 2 * plain) * amount, atol=1e-6)
    assert np.abs(on["Combined"] - off["Combined"]).mean() > 0.1


def test_composite_reads_the_added_control_from_the_file(package, tmp_path):
    shot = blenders.run("bpy", "added", tmp_path, {"ENCRE_PACKAGE": str(package)})
    site = tmp_path / "site"
    site.mkdir()
    (site / "encre").symlink_to(package)
    subprocess.run([sys.executable, "-m", "encre", "composite", str(shot.folder / "on.exr"), "-o",
                    str(tmp_path / "again.exr")], check=True, env={**os.environ, "PYTHONPATH": str(site)})
    with multilayer.Exr(tmp_path / "again.exr") as file:
        again = file.read({"Combined": [f"ViewLayer.Combined.{c}" for c in "RGBA"]})["Combined"]
    np.testing.assert_allclose(again, shot.passes("on")["Combined"], atol=1e-6)
