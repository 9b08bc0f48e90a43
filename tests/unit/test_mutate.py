# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes constants to try the tests: which ones, and that tests notice them."""

import runpy
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import drawn
import mutants
import mutate
import numpy as np
import pytest
from encre.pen.job import Frame, Lamp, Materials, Mesh, Program
from encre.pen.library import Library, load
from encre.pen.scene import Scene

ROOT = Path(__file__).parents[2]

CODE = """/* 1.5 of them */
#define MANY 12
enum { SIDE = 3 };
static const float near = 0.25f; /* 7 */
float f(const float *v)
{
	float sum[4] = {0}, most = 1e6f;
	int x = 1 << 4;
	return v[2] > 0 ? sum[x] * 2 : most;
}
"""


def test_what_is_changed():
    found = [(m.line, m.old, m.new) for m in mutants.mutants_of("csrc/a.c", CODE)]
    assert found == [(3, "3", "2"), (3, "3", "4"), (4, "0.25f", "0.2f"), (4, "0.25f", "0.3f"),
                     (7, "1e6f", "800000.0f"), (7, "1e6f", "1200000.0f"), (9, "2", "1"), (9, "2", "3"), (9, "0", "1"),
                     (9, "2", "1"), (9, "2", "3")]


def test_the_list_of_what_none_can_notice_names_lines_that_are_there():
    every = mutants.every_mutant(ROOT)
    there = set().union(*(m.names for found in every.values() for m in found))
    assert mutants.known() - there == set()
    for name, old, _, _ in mutate.PYTHON:
        assert (ROOT / name).read_text(encoding="utf-8").count(old) == 1, name


@pytest.mark.slow
def test_changes_that_matter_are_noticed():
    done = subprocess.run([sys.executable, "tests/helpers/mutate.py", "--seed", "1", "--count", "3", "--floats",
                           "--only", "csrc/base/metric.c"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("noticed ") == 3


def pictures(library):
    """Bytes of all that a library draws, of a frame with something of everything in it."""
    layers = drawn.scene(301, 149, noise=0.02)
    layers["style"] = (layers["object"] % 3 == 0).astype(np.float32)
    layers["seen_color"], layers["seen_normal"], layers["seen_depth"] = (
        np.ascontiguousarray(layers[name][:, ::-1]) for name in ("albedo", "normal", "depth"))
    fine = dict(edge_detector="FINE", line_color_strength=2.0, line_shadow_strength=3.0, line_mirror_strength=2.0)
    made = []
    for scene in ({**fine, "pen_1_taper": 9.0, "pen_1_overshoot": 6.0, "pen_1_pool": 1.0, "pen_1_curve": 0.5},
                  {"use_tones": True, "tone_1": "HATCH", "tone_2": "STIPPLE", "tone_3": "DOTS"},
                  {**fine, "line_thickness": 1.0, "pen_1_softness": 0.0}, {},
                  dict(edge_detector="SOBEL", line_search="NEAREST", contrast_local=True, contrast_metric="CMC",
                       line_color_strength=1.0),
                  dict(line_color_strength=3.0, line_shadow_strength=4.0, line_thickness=30.0, ink_tint=0.5,
                       color_layer="LIT",
                       contrast_metric="CIEDE2000"),
                  dict(edge_detector="DOG", line_search="WALK", depth_space="LINEAR", color_detector="DOG",
                       line_color_strength=1.0, paper_scale=2.5)):
        made += library.render(layers, scene, [dict(shade_exposure=1.4)], outputs=list(library.outputs),
                               threads=2).images.values()
    rng = np.random.default_rng(1)
    meshes = [Mesh(rng.uniform(-1, 1, (120, 3)).astype(np.float32) - (0, 0, 3),
                   rng.integers(0, 120, (200, 3)).astype(np.int32), object_index=k + 1) for k in range(3)]
    projection = np.array([[1.5, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])
    front = library.raster(meshes, np.eye(4), projection, Frame(120, 90), (120, 90), 0.1,
                           outputs=("depth", "normal", "object"))
    made += front.values()
    operations = [library.operations[name][0] for name in ("place", "noise", "normal")]
    program = Program(np.array([[code, 3 * k, *[0] * 10] for k, code in enumerate(operations)], np.int32), 9,
                      [3, 6, 7, 0, 1, 2, 3, 3, 3, 3, 3, 3, 4, 5, 3, 4, 5, 6, 7, 8, 4])
    maps = {name: front[name] for name in ("depth", "normal", "object")} | {"material": 0 * front["object"]}
    made += library.material(Materials([program], (), np.ones(2, np.float32)), maps, np.eye(4), projection,
                             Frame(120, 90)).values()
    made.append(library.bake(layers["albedo"], dict(line_thickness=5.0)).texture)
    scene = Scene(library)
    for k, mesh in enumerate(meshes):
        scene.geometry(k, mesh.points, mesh.corners)
        scene.instance(k, k, np.eye(4))
    scene.lamp(0, Lamp("rectangle", width=1.0, height=1.0))
    made.append(scene.light(front["depth"], front["normal"], np.eye(4), projection, Frame(120, 90), 0.1))
    return [picture.tobytes() for picture in made]


@pytest.mark.slow
def test_how_work_is_cut_up_and_saved_and_who_compiles_changes_no_byte(tmp_path, monkeypatch):
    """By clang where it is: what is installed is gcc's."""
    shutil.copytree(ROOT / "csrc", tmp_path / "csrc")
    (tmp_path / "made").mkdir()
    for name, old, new in [*mutants.CUTS, *((name, old, new) for name, _, old, new in mutants.FILTERS if old)]:
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert text.count(old) == 1, name
        (tmp_path / name).write_text(text.replace(old, new), encoding="utf-8")
    for name in mutants.every_mutant(ROOT):
        text = (tmp_path / name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(mutants.guards_moved(text), encoding="utf-8")
    if shutil.which("clang"):
        monkeypatch.setenv("CC", "clang")
    compile_, link = runpy.run_path(str(ROOT / "setup.py"), run_name="tests")["commands"](
        tmp_path / "moved.so", tmp_path / "made", scalar=True)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda command: subprocess.run(command, cwd=tmp_path, check=True), compile_))
    subprocess.run(link, cwd=tmp_path, check=True)
    assert pictures(Library(str(tmp_path / "moved.so"))) == pictures(load())
