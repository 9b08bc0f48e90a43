# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of FINE: a debug build stops where what must hold after one of them does not."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from encre.pen.installed import LIBRARY
from encre.pen.library import load

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
RENDER = """
import hashlib, sys
import bench, drawn, noise
from encre.pen.library import Library, load
library = Library(sys.argv[1])
scene = drawn.scene(193, 121, noise=0.02)
seen = scene | dict(seen_color=scene["albedo"], seen_normal=-scene["normal"])
scene["style"] = scene["object"] % 2
full = dict(edge_detector="FINE", line_color_strength=3.0, line_shadow_strength=4.0,
            line_mirror_strength=3.0, line_material_strength=1.0)
for layers in scene, seen, bench.balls(300, 200, 24), noise.everywhere(96, 64), noise.textures(96, 64):
    for settings in full, full | dict(edge_threshold=0.0), dict(edge_detector="FINE", line_inner_strength=0.0):
        images = library.render(layers, settings, [{"line_thickness": 20.0}], outputs=list(library.outputs)).images
        print(hashlib.sha256(b"".join(images[name].tobytes() for name in sorted(images))).hexdigest())
"""


def rendered(path):
    return subprocess.run([sys.executable, "-c", RENDER, str(path)], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})


def debug_build(root, folder):
    done = subprocess.run([sys.executable, "setup.py", "-q", "build_ext", "--debug", "--scalar",
                           f"--build-lib={folder}"], cwd=root, capture_output=True, text=True,
                          env={**os.environ, "CFLAGS": "-O0"})  # soon compiled
    assert done.returncode == 0, done.stderr
    return folder / "encre" / LIBRARY


def test_everything_holds_on_scenes_and_on_noise(tmp_path):
    debug = rendered(debug_build(ROOT, tmp_path))
    assert debug.returncode == 0, debug.stderr
    assert debug.stdout and debug.stdout == rendered(load().path).stdout


BREAKS = [
    ("fine.c", '\t{"sort", NULL, ISA(fine_sort), PLACED, CELLS, BROKEN(cells)},\n', "",
     'after "claim": not true that it'),
    ("join/claims.c", "apart2(s, other) < clear * clear", "apart2(s, other) < 0.8f * clear * clear",
     'after "claim": not true that sites keep clear'),
    ("join/links.c", "!shorter(n, i, all[b], i, all[a])", "(i > all[a] || !shorter(n, i, all[b], i, all[a]))",
     'after "link": not true that a link goes both ways'),
]


@pytest.mark.long
@pytest.mark.parametrize(("name", "whole", "broken", "sentence"), BREAKS)
def test_what_does_not_hold_stops_the_program(tmp_path, name, whole, broken, sentence):
    shutil.copytree(ROOT / "csrc", tmp_path / "csrc")
    for other in ("setup.py", "pyproject.toml", "README.md", "addon"):
        (tmp_path / other).symlink_to(ROOT / other)
    path = tmp_path / "csrc" / "fine" / name
    text = path.read_text(encoding="utf-8")
    assert text.count(whole) == 1
    path.write_text(text.replace(whole, broken), encoding="utf-8")
    done = rendered(debug_build(tmp_path, tmp_path / "built"))
    assert done.returncode < 0 and sentence in done.stderr
