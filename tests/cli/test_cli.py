# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: params, presets, help, settings together, and how it begins and ends."""

import json
import os
import re
import subprocess
import sys
import tempfile

import exr
import numpy as np
import pytest
from command import SIZE, fails, start
from encre.pen import library, metadata, presets
from encre.pen.errors import EncreError, unknown
from encre.pen.job import Camera, Frame
from encre.pen.settings import VERSION


def test_params(run):
    status, out, err = run("params", "--json")
    rows = {row["id"]: row for row in json.loads(out)}
    assert status == 0 and err == "" and list(rows) == list(library.params())
    assert library.check({id_: row["default"] for id_, row in rows.items()}) == library.defaults()
    assert [item["id"] for item in rows["edge_detector"]["items"]][:2] == ["DOG", "SOBEL"]
    status, out, _ = run("params")
    once = {id_ for id_ in rows if not re.match("pen_[23]_|tone_[2-6]_", id_)}
    assert status == 0 and {id_ for id_ in rows if f"  {id_} = " in out} == once


def test_params_are_written_as_set_takes_them(run):
    lines = [line.strip() for line in run("params")[1].splitlines() if " = " in line]
    for line in lines:
        id_, value = line.partition("  (")[0].split(" = ", 1)
        if value != "none":
            assert library.parse(id_, value.strip('"')) == library.defaults()[id_], line


@pytest.mark.parametrize("id_", [id_ for id_, p in library.params().items() if p.type in ("int", "float")])
def test_limits_are_inside(id_):
    """Also as the float that Blender keeps of them, which may lie a little beyond the decimal."""
    p = library.params()[id_]
    kept = int if p.type == "int" else lambda x: float(np.float32(x))
    inside = [limit for limit in (p.hard_min, p.hard_max) if limit is not None]
    for value in [*inside, *map(kept, inside)]:
        assert library.normal(p, value) == value
        rest = {"depth_far": {"depth_near": 0.0}}.get(id_, {})
        assert library.check({id_: value, **rest})[id_] == value
    beyond = [p.hard_min - 1e-3 if p.type == "float" else p.hard_min - 1,
              p.hard_max * 1.001 + 1 if p.hard_max is not None else 1e39]
    for value in beyond:
        with pytest.raises(EncreError, match=f"{id_}: .* is out of range"):
            library.check({id_: value})


def test_presets(run):
    status, out, _ = run("presets")
    assert status == 0 and [line.partition(":")[0] for line in out.splitlines()] == [p.id for p in presets.presets()]
    values = presets.find("water-memory").values
    assert values == {id_: library.defaults()[id_] for id_ in values}, "the first preset is what the defaults are"
    assert presets.find("After W") == presets.find("water_memory_2020")
    assert "color_detector" not in presets.find("inter_color_2016").listed
    sets = [preset.values.keys() for preset in presets.presets()]
    assert all(keys == sets[0] for keys in sets), "or a picture depends on what was chosen before"
    assert {"use_tones", "use_wash", "use_example", "pen_1_pressure"} < sets[0]


def test_a_preset_may_be_a_file(run, tmp_path):
    mine = tmp_path / "Mine.json"
    presets.write(mine, "Mine", "", {"line_thickness": np.float32(7.3), "shade_levels": [(0.5,), (1, 0.5, 0.25)]})
    assert json.loads(mine.read_text())["values"] == {"line_thickness": 7.3, "shade_levels": [[0.5], [1, 0.5, 0.25]]}
    assert presets.find(str(mine)).values == {"line_thickness": 7.3, "shade_levels": [(0.5,), (1, 0.5, 0.25)]}
    mine.write_text(mine.read_text().replace(f'"settings": {VERSION}', '"settings": 1'))
    assert presets.find(str(mine)).values["line_far_unit"] == "SCENE", "as when it was saved"
    for text, wrong in (("[]", "no JSON object with name"), ("[" * 10 ** 6, "nested without end"), ("{", "no JSON (E"),
                        ('{"name": "x", "values": {}}', "has no description"), ("\udcff", "no text in UTF-8"),
                        ('{"name": "x", "description": "", "values": {}, "settings": -9}', "of no version: -9"),
                        ('{"name": "x", "description": "", "values": {"paper_image": "a.png"}}', "hold no images"),
                        ('{"name": "x", "description": "", "values": {"seed": 1}}', "unknown parameter"),
                        ('{"name": 3, "description": "", "values": {}}', "no text"),
                        ('{"name": "x", "description": "", "values": {"line_thickness": 1%s}}' % ("0" * 400),
                         "line_thickness: a whole number of 401 digits"),
                        ('{"name": "x", "description": "", "values": {"edge_detector": ["DOG"]}}', "edge_detector: "),
                        ('{"name": "x", "description": "", "values": {"ink_color": [1%s, 0, 0]}}' % ("0" * 400),
                         "ink_color: ")):
        mine.write_text(text, errors="surrogateescape")
        status, out, err = run("composite", "in.exr", "-o", tmp_path / "out.png", "--preset", mine)
        assert (status, out) == (2, "") and wrong in err and err.count("\n") == 1
    assert "can't be read" in run("composite", "in.exr", "-o", "out.png", "--preset", "gone.json")[2]


def test_what_may_not_be_read_is_told_with_the_cure(run, tmp_path, monkeypatch):
    """A file of another's, and a folder that is gone."""
    own = os.geteuid()
    with tempfile.TemporaryDirectory(dir="/tmp") as place:
        os.chmod(place, 0o777)
        for command, name in ("composite", f"{place}/in.exr"), ("render", f"{place}/in.blend"):
            open(name, "w").close()
            os.chmod(name, 0)
            try:
                if own == 0:  # who may read all
                    os.seteuid(65534)
                said = run(command, name, "-o", f"{place}/out.exr")
            finally:
                os.seteuid(own)
            assert said[0] == 2 and f"{name}: can't be read (Permission denied); check" in said[2], said
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert "the folder in which this was started is gone" in run("composite", tmp_path / "in.exr", "-o", "out.exr")[2]


def test_numbers_that_begin_with_a_minus(run, tmp_path):
    for words in (("-f", "-5--2"), ("--frame", "-5,-2"), ("-f-5--2",), ("--frame=-5--2x3",)):
        err = run("composite", tmp_path / "in.#.exr", "-o", tmp_path / "o.#.png", *words)[2]
        assert "in.-5.exr: there is no such file nor " in err, words
    err = run("render", "in.blend", "-o", "o.png", "--samples", "99999999999")[2]
    assert "'99999999999' is not a whole number from 1 to 16777216" in err


@pytest.mark.parametrize("command", [(), ("render",), ("composite",), ("params",), ("presets",)])
def test_help(run, command):
    status, out, err = run(*command, "--help")
    assert status == 0 and err == "" and out.startswith("usage: encre")


@pytest.mark.parametrize("sets", [
    ["edge_detector=DOG", "line_search=NEAREST"], ["line_search=NEAREST", "edge_detector=DOG"],
    ["depth_near=200", "depth_far=300", "depth_space=LINEAR"],
    ["depth_space=LINEAR", "depth_near=200", "depth_far=300"]])
def test_settings_are_judged_together(run, tmp_path, scene, sets):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    assert run("composite", path, "-o", tmp_path / "out.exr", *[f"--set={said}" for said in sets])[0] == 0


def test_settings_are_judged_over_the_files_own(run, tmp_path, scene):
    values = {"depth_near": 200.0, "depth_far": 300.0, "depth_space": "LINEAR"}
    stored = metadata.write(values, [], Camera(), Frame(*SIZE))
    path = exr.write(tmp_path / "in.exr", exr.passes(scene), metadata=stored)
    assert run("composite", path, "-o", tmp_path / "out.exr", "--set=depth_near=250")[0] == 0
    fails(run("composite", path, "-o", tmp_path / "out.exr", "--set=depth_near=350"), "depth_")


@pytest.mark.parametrize(("said", "id_", "value"), [
    ("no", "use_lines", False), ("YES", "use_lines", True), ("false", "use_lines", False), ("1", "use_lines", True),
    ("none", "paper_image", None), ("#ff8000", "ink_color", (1, 0.21586050, 0)), ("#000000", "ink_color", (0, 0, 0)),
])
def test_words_for_values(said, id_, value):
    assert library.parse(id_, said) == (value if id_ != "ink_color" else pytest.approx(value))


def test_an_unknown_parameter_has_its_nearest_beside_it_and_not_all(run):
    for said, near in (("line_thicknes=1", "line_thickness"), ("thickness=3", "line_thickness"),
                       ("lines=3", "use_lines")):
        result = run("composite", "in.exr", "-o", "out.png", f"--set={said}")
        fails(result, "unknown parameter; did you mean ", near, "; `encre params` lists all")
        names = result[2].partition("did you mean ")[2].partition("?")[0].split(", ")
        assert len(names) <= 3 and set(names) <= library.params().keys()
    for far in "foo", "quux", "noir":
        result = run("composite", "in.exr", "-o", "out.png", f"--set={far}=1")
        fails(result, f"{far}: unknown parameter; `encre params` lists all")
        assert "did you mean" not in result[2]
    fails(run("composite", "in.exr", "-o", "out.png", "--set=edge_detector=foo"), "known are DOG, ", "FINE")
    assert unknown("object", "it", map(str, range(40, 80))).endswith(" 55 and 24 more")


def test_frames_that_go_backwards(run):
    fails(run("composite", "in.#.exr", "-o", "out.#.png", "-f", "1,5-1"), "goes backwards from 5 to 1",
          "give the first frame first: 1-5; see")


def test_threads_0_is_one_a_processor(run, tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    assert run("composite", path, "-o", tmp_path / "out.exr", "--threads", "0")[0] == 0


@pytest.mark.parametrize("command", ["render", "composite", "bake"])
def test_help_shows_examples_and_exit_statuses(run, command):
    out = run(command, "--help")[1]
    assert f"examples:\n  encre {command} " in out and "exit status:\n  0 " in out


@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("module", ["encre.cli", "datetime"])
def test_interrupting_the_start(number, module):
    """While the modules are loading: numpy makes an ImportError of a KeyboardInterrupt."""
    code = f"""
import os, signal, sys
import encre.__main__
class Finder:
    def find_spec(name, *rest):
        if name == {module!r}:
            os.kill(os.getpid(), signal.{number})
sys.meta_path.insert(0, Finder)
sys.exit(encre.__main__.main())
"""
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (child.returncode, child.stderr) == (130, "encre: interrupted\n")


def test_a_mistake_of_ours_is_one_line_and_what_modules_warn_of_is_said_once():
    code = """
import sys, warnings
from encre.cli import main
def mistake(_args):
    raise ZeroDivisionError("boom \x1b[2J")
def hum(_args):
    for _ in range(3):
        warnings.warn("something is odd")
main.COMMANDS.update(presets=mistake, params=hum)
sys.exit(100 * main.main(["params"]) + main.main(["presets"]))
"""
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    warning, error = child.stderr.splitlines()
    assert child.returncode == 1 and warning == "encre: warning: something is odd"
    assert error.startswith(r"encre: error: this should not happen: ZeroDivisionError: boom \x1b[2J (<string>, line 5)")


def test_streams_that_are_closed_or_know_few_characters():
    for shell in (">&-", "2>&-", ">&- 2>&-"):
        child = subprocess.run(f'"{sys.executable}" -m encre params {shell}', shell=True, capture_output=True,
                               text=True, timeout=60)
        assert child.returncode == 0 and child.stderr == ""
    child = start("composite", "nö.exr", "-o", "é.png", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    out, err = child.communicate(timeout=60)
    assert child.returncode == 2 and err.startswith("encre: error: n\\xf6.exr") and "Traceback" not in err


def test_a_reader_that_leaves_early():
    child = subprocess.run(f'"{sys.executable}" -m encre params | head -1', shell=True, capture_output=True, text=True,
                           timeout=60)
    assert child.returncode == 0 and child.stderr == ""
