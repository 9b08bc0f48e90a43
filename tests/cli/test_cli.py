# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: params, presets, composite. `encre render` has test_cli_render.py."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
import tracemalloc
from pathlib import Path

import drawn
import exr
import numpy as np
import OpenImageIO as oiio
import pytest
from encre.cli import composite, denoiser, images, main, multilayer, png, room, workplace
from encre.pen import layers, library, metadata, presets, saved
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame
from encre.pen.settings import VERSION, Settings, switches

SIZE = 96, 64
OFF = [f"--set={switch}=off" for switch in switches()]
STYLES = [("Ink", {"line_thickness": 30.0, "use_shading": False})]


@pytest.fixture(scope="session")
def scene():
    """Layers of a small picture, the lower half in another style."""
    made = drawn.scene(*SIZE)
    made["style"][SIZE[1] // 2:] = 1
    return made


@pytest.fixture
def run(capsys):
    def run(*args, denoise=False):
        """(exit status, stdout, stderr) of `encre args`, without the denoiser that a Blender brings, unless asked."""
        plain = ["--set=light_denoise=NONE"] if args[:1] == ("composite",) and len(args) > 2 and not denoise else []
        try:
            status = main.main([str(arg) for arg in (*args, *plain)])
        except SystemExit as end:
            status = end.code
        return status, *capsys.readouterr()
    return run


def fails(result, *words, status=2):
    """The outcome is one sentence of error that holds all words."""
    code, out, err = result
    assert code == status and out == "" and err.startswith("encre: error: ") and err.count("\n") == 1, err
    for word in words:
        assert word in err, err


def expected(pictures, scene=None, styles=(), camera=None, frame=None, outputs=("Combined",)):
    """What the library makes of passes in memory."""
    settings = Settings(scene, [("", values) for values in styles])
    made, _ = layers.assemble(dict(pictures), settings, saved.unpack(pictures))
    return library.render(made, scene or {}, styles, camera, frame, outputs).images


# memory


@pytest.mark.parametrize(("ending", "change", "most"), [("exr", {}, 189), ("exr", {"edge_seen": 0.0}, 161),
                                                        ("png", {}, 143)])
def test_memory_of_composite(tmp_path, monkeypatch, ending, change, most):
    """numpy counts its pictures with Python's memory; OpenImageIO's are copied here, so that they count as well."""
    width, height = 192, 1080
    scene = drawn.scene(width, height)
    scene.update(style=0 * scene["style"], controls=0 * scene["controls"])
    marks = np.ones((height, width, 3), np.float32) / 2
    stored = metadata.write({}, [], Camera(), Frame(width, height))
    path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene), "Encre Marks": marks},
                     metadata=stored)
    del scene, marks
    read = oiio.ImageInput.read_scanlines
    monkeypatch.setattr(oiio.ImageInput, "read_scanlines", lambda *args: read(*args).copy())
    tracemalloc.start()
    composite.composite(str(path), str(tmp_path / f"out.{ending}"), change)
    peak = tracemalloc.get_traced_memory()[1] / (width * height)
    tracemalloc.stop()
    assert peak <= most


# params and presets


def test_params(run):
    status, out, err = run("params", "--json")
    rows = {row["id"]: row for row in json.loads(out)}
    assert status == 0 and err == "" and list(rows) == list(library.params())
    assert library.check({id_: row["default"] for id_, row in rows.items()}) == library.defaults()
    assert [item["id"] for item in rows["edge_detector"]["items"]][:2] == ["DOG", "SOBEL"]
    status, out, _ = run("params")
    assert status == 0 and all(f"  {id_} = " in out for id_ in rows)


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
    assert "color_detector" not in presets.find("inter_color_2016").values


def test_a_preset_may_be_a_file(run, tmp_path):
    mine = tmp_path / "Mine.json"
    presets.write(mine, "Mine", "", {"line_thickness": np.float32(7.3), "shade_levels": [(0.5,), (1, 0.5, 0.25)]})
    assert json.loads(mine.read_text())["values"] == {"line_thickness": 7.3, "shade_levels": [[0.5], [1, 0.5, 0.25]]}
    assert presets.find(str(mine)).values == {"line_thickness": 7.3, "shade_levels": [(0.5,), (1, 0.5, 0.25)]}
    mine.write_text(mine.read_text().replace(f'"settings": {VERSION}', '"settings": 1'))
    assert presets.find(str(mine)).values["line_depth_unit"] == "SCENE", "as when it was saved"
    for text, wrong in (("[]", "can't be used"), ("[" * 10 ** 6, "can't be used"), ("{", "can't be used"),
                        ('{"name": "x", "description": "", "values": {"paper_image": "a.png"}}', "hold no images"),
                        ('{"name": "x", "description": "", "values": {"seed": 1}}', "unknown parameter"),
                        ('{"name": 3, "description": "", "values": {}}', "no text"),
                        ('{"name": "x", "description": "", "values": {"line_thickness": 1%s}}' % ("0" * 400), "used")):
        mine.write_text(text)
        status, out, err = run("composite", "in.exr", "-o", tmp_path / "out.png", "--preset", mine)
        assert (status, out) == (2, "") and wrong in err and err.count("\n") == 1
    assert "can't be read" in run("composite", "in.exr", "-o", "out.png", "--preset", "gone.json")[2]


@pytest.mark.parametrize("command", [(), ("render",), ("composite",), ("params",), ("presets",)])
def test_help(run, command):
    status, out, err = run(*command, "--help")
    assert status == 0 and err == "" and out.startswith("usage: encre")


# composite


@pytest.mark.parametrize("layout", exr.LAYOUTS)
@pytest.mark.parametrize("settings", [{}, {"edge_detector": "SOBEL", "line_thickness": 12, "use_smudging": False}])
def test_composite_reads_what_every_blender_writes(run, tmp_path, scene, layout, settings):
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures, layout)
    sets = [f"--set={id_}={'off' if value is False else value}" for id_, value in settings.items()]
    status, out, err = run("composite", path, "-o", tmp_path / "out.exr", *sets)
    assert status == 0 and out.startswith(f"{tmp_path / 'out.exr'} (")
    assert err.startswith("encre: note: ") and err.count("\n") == (1 if settings else 2)  # what FINE lacks
    prefix = "" if layout == "bare" else "ViewLayer."
    for name, picture in expected(pictures, settings, outputs=("Combined", *layers.DRAWN)).items():
        assert np.array_equal(exr.picture(tmp_path / "out.exr", prefix + name), picture), name
    assert len(exr.read(tmp_path / "out.exr")) == 16
    assert oiio.ImageInput.open(str(tmp_path / "out.exr")).spec().format == oiio.FLOAT


@pytest.fixture
def frame_file(tmp_path, scene):
    """A file as the engine saves it, whose Cycles passes say something else than Encre's own."""
    pictures = {**exr.passes(scene), **exr.saved(scene)}
    for name in ("Combined", "DiffDir", "IndexOB"):
        pictures[name] = pictures[name] * np.float32(0.5)
    camera, frame = Camera((0, 1, 0, -1, 0, 0, 0, 0, 1), True, 7.0), Frame(400, 300, 30, 20)
    scene_values = {"line_thickness": 20.0, "shade_levels": [(0.4,), (1.0, 0.5, 0.1)]}
    stored = metadata.write(scene_values, STYLES, camera, frame)
    path = exr.write(tmp_path / "saved.exr", pictures, metadata=stored)
    return path, pictures, camera, frame


def test_composite_gives_a_saved_frame_again(run, tmp_path, frame_file):
    path, pictures, camera, frame = frame_file
    status, out, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert (status, err) == (0, "") and out.startswith(f"{tmp_path / 'out.exr'} (")
    settings = {"line_thickness": 20, "shade_levels": [(0.4,), (1, 0.5, 0.1)]}
    again = expected(pictures, settings, [STYLES[0][1]], camera, frame)["Combined"]
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), again)


def test_composite_changes_the_scenes_settings_and_no_styles(run, tmp_path, frame_file):
    path, pictures, camera, frame = frame_file
    status, _, err = run("composite", path, "-o", tmp_path / "out.exr", "--preset", "ink only",
                         "--set", "light_source=CYCLES", "--set", "line_thickness=40",
                         "--set", "shade_levels=0.2; 0.7,0.3,0.1; 1,0.6,0.1,1,0.5,0")
    assert status == 0 and err.count("\n") == 1 and "edge_color (one colour everywhere)" in err
    settings = {**presets.find("ink_only").values, "line_thickness": 40,
                "shade_levels": [(0.2,), (0.7, 0.3, 0.1), (1, 0.6, 0.1, 1, 0.5, 0)]}
    again = expected(pictures, settings, [STYLES[0][1]], camera, frame)["Combined"]
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), again)


def test_composite_off_is_the_picture_itself(run, tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    assert run("composite", path, "-o", tmp_path / "out.exr", *OFF)[0] == 0
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), scene["combined"])


def test_composite_threads(run, tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    made = set()
    for threads in (1, 2, 3, 8):
        assert run("composite", path, "-o", tmp_path / "out.exr", "--threads", threads)[0] == 0
        made.add(exr.picture(tmp_path / "out.exr").tobytes())
    assert len(made) == 1


def test_composite_half(run, tmp_path, scene):
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures, half=True)
    assert run("composite", path, "-o", tmp_path / "out.exr")[0] == 0
    with np.errstate(over="ignore"):  # nothing is there at 1e10, which is infinite in half
        rounded = {name: p.astype(np.float16).astype(np.float32) for name, p in pictures.items()}
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), expected(rounded)["Combined"])


def test_composite_writes_the_longest_name(run, tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    out = tmp_path / ("a" * 251 + ".png")
    assert run("composite", path, "-o", out)[0] == 0
    assert sorted(os.listdir(tmp_path)) == [out.name, "in.exr"]


def test_composite_png(run, tmp_path, scene):
    scene = {**scene, "combined": scene["combined"] * np.float32(0.5)}  # premultiplied, half transparent
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures)
    assert run("composite", path, "-o", tmp_path / "new" / "out.png")[0] == 0
    file = oiio.ImageInput.open(str(tmp_path / "new" / "out.png"))
    as_stored = oiio.ImageSpec()
    as_stored["oiio:UnassociatedAlpha"] = 1
    pixels = oiio.ImageInput.open(str(tmp_path / "new" / "out.png"), as_stored).read_image("uint8").astype(int)
    assert file.spec().format == oiio.UINT8 and pixels.shape == (SIZE[1], SIZE[0], 4)
    combined = expected(pictures)["Combined"].astype(np.float64)
    alpha = np.clip(combined[..., 3:], 0, 1)
    x = np.clip(combined[..., :3] / np.where(alpha > 0, alpha, 1), 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    assert np.abs(pixels - 255 * np.concatenate([encoded, alpha], -1)).max() <= 0.501


def test_a_wide_working_space(run, tmp_path, scene):
    """Blender 5 says in its files in which space colours are: a PNG is sRGB, an EXR keeps the space."""
    red = np.array(((1.7050509879, -0.6217921206, -0.0832588674), (-0.1302564175, 1.1408047365, -0.0105483191),
                    (-0.0240033568, -0.1289689761, 1.1529723329)))
    off = {"use_lines": "off", "use_shading": "off", "use_smudging": "off", "use_hatching": "off"}
    options = [word for id_, value in off.items() for word in ("--set", f"{id_}={value}")]
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures, metadata={"colorInteropID": "lin_ap1_scene"})
    assert run("composite", path, "-o", tmp_path / "out.png", *options)[0] == 0
    assert run("composite", path, "-o", tmp_path / "out.exr", *options)[0] == 0
    assert oiio.ImageInput.open(str(tmp_path / "out.exr")).spec()["colorInteropID"] == "lin_ap1_scene"
    pixels = oiio.ImageInput.open(str(tmp_path / "out.png")).read_image("uint8")[..., :3]
    x = np.clip(pictures["Combined"][..., :3].astype(np.float64) @ red.T, 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    assert np.abs(pixels - 255 * encoded).max() <= 0.6


def test_a_png_is_shown_as_the_scene_is(run, tmp_path, scene):
    """Where Standard shows it; else that is said."""
    def drawn_as(view):
        stored = metadata.write({}, [], Camera(), Frame(*SIZE), view=view)
        path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene)}, metadata=stored)
        status, _, err = run("composite", path, "-o", tmp_path / "out.png")
        assert status == 0
        return oiio.ImageInput.open(str(tmp_path / "out.png")).read_image("uint8")[..., :3].astype(float), err

    plain, err = drawn_as(None)
    assert "the PNG is Standard, without exposure" in err
    same, err = drawn_as(metadata.View())
    assert np.array_equal(same, plain) and err == ""
    shown_, err = drawn_as(metadata.View("Standard", -1.0, 1.5))
    light = np.where(plain <= 10.31475, plain / 255 / 12.92, ((plain / 255 + 0.055) / 1.055) ** 2.4) / 2
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055) ** (1 / 1.5)
    inside = (plain > 20) & (plain < 255)
    assert err == "" and np.abs(shown_ - 255 * encoded)[inside].max() <= 1.5
    other, err = drawn_as(metadata.View("AgX", 0.0, 1.0, "AgX - Punchy"))
    assert np.array_equal(other, plain) and "AgX and look AgX - Punchy" in err and err.count("\n") == 1


def test_composite_keeps_the_data_window(run, tmp_path, scene):
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures, window=(10, 20, 300, 200))
    assert run("composite", path, "-o", tmp_path / "out.exr")[0] == 0
    spec = oiio.ImageInput.open(str(tmp_path / "out.exr")).spec()
    assert (spec.x, spec.y, spec.full_width, spec.full_height) == (10, 20, 300, 200)
    again = expected(pictures, frame=Frame(300, 200, 10, 20))["Combined"]
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), again)
    assert run("composite", path, "-o", tmp_path / "out.png")[0] == 0
    pixels = oiio.ImageInput.open(str(tmp_path / "out.png")).read_image("uint8")
    assert pixels.shape == (200, 300, 4) and not pixels[:20].any() and pixels[20:84, 10:106].any()


def test_composite_draws_what_was_rendered_of_a_border(run, tmp_path, scene):
    """Blender saves the rest of the frame as zeros, which is no edge of anything."""
    rendered = {**exr.passes(scene), **exr.saved(scene)}
    around = np.s_[7:7 + SIZE[1], 5:5 + SIZE[0]]
    pictures = {name: np.zeros((100, 120, *p.shape[2:]), np.float32) for name, p in rendered.items()}
    for name, picture in rendered.items():
        pictures[name][around] = picture
    frame = Frame(120, 100, 5, 7)
    stored = metadata.write({}, [("S", {})], Camera(), Frame(120, 100), (5, 7, *SIZE))
    path = exr.write(tmp_path / "in.exr", pictures, metadata=stored)
    assert run("composite", path, "-o", tmp_path / "out.exr")[::2] == (0, "")
    for name, picture in expected(rendered, {}, [{}], frame=frame, outputs=("Combined", *layers.DRAWN)).items():
        drawn_ = exr.picture(tmp_path / "out.exr", f"ViewLayer.{name}")
        assert np.array_equal(drawn_[around], picture), name
        drawn_[around] = 0
        assert not drawn_.any(), name
    stored = metadata.write({}, [], Camera(), Frame(120, 100), (5, 7, 116, 3))
    path = exr.write(tmp_path / "in.exr", pictures, metadata=stored)
    fails(run("composite", path, "-o", tmp_path / "x.exr"), "encre.border")


def test_composite_accepts_overscan(run, tmp_path, scene):
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures, window=(-8, -4, 80, 56))
    assert run("composite", path, "-o", tmp_path / "out.exr")[0] == 0
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), expected(pictures)["Combined"])
    assert run("composite", path, "-o", tmp_path / "out.png")[0] == 0
    assert oiio.ImageInput.open(str(tmp_path / "out.png")).read_image("uint8").shape == (56, 80, 4)


def test_composite_view_layers(run, tmp_path, scene):
    first, second = exr.passes(scene), exr.passes(drawn.scene(*SIZE, seed=1))
    renamed = {f"{layer}.{name}": picture for layer, pictures in (("A.b", first), ("Two", second))
               for name, picture in pictures.items()}
    channels = {f"{full}.{letter}": np.atleast_3d(picture)[..., k] for full, picture in renamed.items()
                for k, letter in enumerate(exr.LETTERS[full.rpartition(".")[2]])}
    channels["Composite.Combined.R"] = channels["Two.Combined.R"]
    path = tmp_path / "in.exr"
    spec = oiio.ImageSpec(*SIZE, len(channels), "float")
    spec.channelnames = tuple(channels)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(np.stack(list(channels.values()), -1)) and out.close()
    for option, layer, pictures in (((), "A.b", first), (("--view-layer", "Two"), "Two", second)):
        assert run("composite", path, "-o", tmp_path / "out.exr", *option)[0] == 0
        assert np.array_equal(exr.picture(tmp_path / "out.exr", f"{layer}.Combined"), expected(pictures)["Combined"])
    fails(run("composite", path, "-o", tmp_path / "x.exr", "--view-layer", "Tow"), "Tow", "Two")


def test_view_layers_of_stereo_files():
    names = ["A.Combined.left.R", "A.Combined.right.R", "A.Depth.left.Z", "A.left.Depth.right.Z"]
    assert composite.view_layers(names, ("left", "right")) == {
        "A": {"left": {"Combined": [names[0]], "Depth": [names[2]]}, "right": {"Combined": [names[1]]}},
        "A.left": {"right": {"Depth": [names[3]]}}}


def test_composite_counts_what_is_not_finite(run, tmp_path, scene):
    pictures = exr.passes(scene)
    pictures["Normal"] = pictures["Normal"].copy()
    pictures["Normal"][3, :5, 0] = np.nan
    path = exr.write(tmp_path / "in.exr", pictures)
    status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert status == 0 and "warning" in err and " 5 values" in err


def test_composite_says_what_metadata_are_missing(run, tmp_path, scene):
    pictures = {**exr.passes(scene), **exr.saved(scene)}
    for missing in metadata.PARAMS, metadata.FRAME, metadata.CAMERA:
        stored = metadata.write({}, [], Camera(), Frame(*SIZE))
        del stored[missing]
        path = exr.write(tmp_path / "in.exr", pictures, metadata=stored)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
        assert status == 0 and err.count("\n") == 1 + (missing == metadata.CAMERA) and err.startswith("encre: note: ")


def test_composite_says_which_sources_have_nothing_to_work_on(run, tmp_path, scene):
    pictures = {**exr.passes(scene), **exr.saved(scene)}
    pictures["Encre Index"] = np.zeros_like(pictures["Encre Index"])
    seen = {name: pictures.pop(name) for name in ("Denoising Albedo", "Denoising Normal", "Encre Seen Depth")}
    stored = metadata.write({}, [], Camera(), Frame(*SIZE))

    def said(*args):
        path = exr.write(tmp_path / "in.exr", pictures, metadata=stored)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr", *args)
        assert status == 0
        return err

    err = said("--set=edge_material=1")
    assert err.startswith("encre: note: ") and err.count("\n") == 1
    for source in ("edge_object (one index everywhere)", "edge_material (", "edge_seen (no passes"):
        assert source in err
    assert "edge_normal" not in err and "edge_color" not in err
    assert said("--set=edge_object=0", "--set=edge_seen=0") == ""
    assert said("--set=use_lines=off", "--set=use_smudging=off") == ""
    pictures.update(seen)
    assert "edge_seen" not in said()
    del stored[metadata.CAMERA]  # whose normals they are is not known
    assert "edge_seen" in said()


# Bad input


def test_composite_needs_only_combined(run, tmp_path, scene, data):
    """Each other pass that is missing is named, with what that switches off; a frame of depth and colour gets lines."""
    path = exr.write(tmp_path / "in.exr", {"Depth": scene["depth"]})
    fails(run("composite", path, "-o", tmp_path / "x.exr"), "Combined", "in.exr")
    for name, words in (("Depth", "no depth"), ("Normal", "no normals"), ("DiffDir", "no diffuse light"),
                        ("DiffCol", "no diffuse colour")):
        pictures = exr.passes(scene)
        del pictures[name]
        path = exr.write(tmp_path / "in.exr", pictures)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
        assert status == 0 and words in err, err
    status, _, err = run("composite", data / "beachball.0001.exr", "-o", tmp_path / "ball.exr")
    assert status == 0 and "no normals" in err and "no diffuse" in err, err
    lines = [picture for name, picture in exr.read(tmp_path / "ball.exr").items() if name.endswith("Encre Lines.A")]
    assert 0.002 < (lines[0] > 0.5).mean() < 0.3


def test_check_lists_all_that_is_missing(run, tmp_path, scene):
    pictures = exr.passes(scene)
    for name in ("Depth", "Normal", "IndexOB"):
        del pictures[name]
    path = exr.write(tmp_path / "in.exr", pictures)
    status, out, err = run("composite", path, "--check")
    assert status == 0 and err == "" and out.startswith(f"{path}: view layer ViewLayer\n")
    for words in ("Depth: missing; check Data > Z; off without it: lines between depths", "check Data > Normal",
                  "Object Index, or Cryptomatte > Object", "Combined: there", "IndexMA: there", "Save Layers"):
        assert words in out, out
    assert run("composite", path, "--check", "--layer", "depth=Combined.R")[0] == 2  # is no name of a layer
    assert "Depth: there" in run("composite", path, "--check", "--layer", "depth=ViewLayer.Combined.R")[1]
    path = exr.write(tmp_path / "in.exr", {"Depth": scene["depth"]})
    status, out, err = run("composite", path, "--check")
    assert status == 2 and "Combined: missing" in out and "Combined is missing" in err


def test_layers_by_another_renderers_names(run, tmp_path, scene, monkeypatch):
    pictures = exr.passes(scene)
    names = {"Combined": "beauty", "Depth": "zed", "Normal": "N", "DiffCol": "albedo", "DiffDir": "lit",
             "IndexOB": "id"}
    for name, other in names.items():
        monkeypatch.setitem(exr.LETTERS, other, exr.LETTERS[name])
    path = exr.write(tmp_path / "in.exr", {other: pictures[name] for name, other in names.items()}, "bare")
    words = {"combined": "beauty", "depth": "zed.Z", "normal": "N", "color": "albedo", "light": "lit", "object": "id"}
    given_ = [f"--layer={word}={name}" for word, name in words.items()]
    assert run("composite", path, "-o", tmp_path / "out.exr", *given_)[0] == 0
    want = expected({name: pictures[name] for name in names})["Combined"]
    assert np.array_equal(exr.picture(tmp_path / "out.exr", "beauty"), want)
    fails(run("composite", path, "-o", tmp_path / "x.exr", "--layer", "combined=baeuty"), "baeuty", "beauty")
    fails(run("composite", path, "-o", tmp_path / "x.exr", "--layer", "gloss=N"), "gloss", "combined")


def test_depth_in_grey_and_small_letters(run, tmp_path, scene):
    pictures, window = exr.passes(scene), multilayer.Window(*SIZE, 0, 0, *SIZE)
    depth = np.squeeze(pictures["Depth"])
    color = dict(zip("rgba", np.moveaxis(pictures["Combined"], 2, 0), strict=True))
    multilayer.write(tmp_path / "a.exr", {**color, "z": depth}, window)
    multilayer.write(tmp_path / "b.exr", {**{letter.upper(): picture for letter, picture in color.items()},
                                          **{f"ZDepth.{letter}": depth for letter in "BGR"}}, window)
    assert run("composite", tmp_path / "a.exr", "-o", tmp_path / "ao.exr")[0] == 0
    assert run("composite", tmp_path / "b.exr", "-o", tmp_path / "bo.exr", "--layer", "depth=ZDepth")[0] == 0
    want = expected({name: pictures[name] for name in ("Combined", "Depth")} | {
        "DiffCol": np.clip(scene["combined"][..., :3], 0, 1), "Normal": 0 * pictures["Normal"],
        "DiffDir": 0 * pictures["Normal"] + 1}, {"use_shading": False, "use_hatching": False, "edge_light": 0.0,
                                                 "line_light": 0.0})["Combined"]
    for file in "ao", "bo":
        made = exr.read(tmp_path / f"{file}.exr")
        assert np.array_equal(np.stack([made[letter] for letter in "RGBA"], -1), want), file


def test_cryptomatte_is_the_object_index(run, tmp_path, scene, monkeypatch):
    pictures = exr.passes(scene)
    rng = np.random.default_rng(0)
    hashes = rng.integers(1 << 23, 1 << 30, 100, dtype=np.uint32).view(np.float32)
    hashes[0] = 0
    matte = np.zeros((SIZE[1], SIZE[0], 4), np.float32)
    matte[..., 0] = hashes[np.squeeze(pictures["IndexOB"]).astype(int)]
    matte[..., 1:] = rng.random(matte[..., 1:].shape)
    monkeypatch.setitem(exr.LETTERS, "CryptoObject00", "rgba")
    want = expected(pictures)["Combined"]
    del pictures["IndexOB"]
    path = exr.write(tmp_path / "in.exr", {**pictures, "CryptoObject00": matte})
    status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert status == 0 and "edge_object" not in err, err
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), want), "only which objects differ counts, not how"


def test_noisy_light_is_denoised(run, tmp_path, monkeypatch):
    """By the library that comes with a Blender, where there is one."""
    if not denoiser.available():
        pytest.skip("no Open Image Denoise here, in no Blender either")
    clean, noisy = (exr.write(tmp_path / f"in{noise}.exr", exr.passes(drawn.scene(*SIZE, noise=noise)))
                    for noise in (0.0, 0.5))
    light = []
    for path, denoise in ((clean, False), (noisy, False), (noisy, True)):
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr", *OFF[1:], denoise=denoise)
        assert status == 0 and "noise stays" not in err
        light.append(exr.picture(tmp_path / "out.exr", "ViewLayer.Encre Light"))
    assert np.abs(light[2] - light[0]).mean() < 0.5 * np.abs(light[1] - light[0]).mean()


def test_noise_that_stays_is_said(run, tmp_path, scene, monkeypatch):
    """Where there is no Blender and no such library."""
    monkeypatch.setattr(sys, "path", [place for place in sys.path if not (Path(place) / "bpy").is_dir()])
    monkeypatch.setenv("PATH", str(tmp_path))
    denoiser.home.cache_clear()
    try:
        if denoiser.available():
            pytest.skip("the system has Open Image Denoise")
        path = exr.write(tmp_path / "in.exr", exr.passes(scene))
        assert "noise stays" in run("composite", path, "-o", tmp_path / "a.exr", denoise=True)[2]
        assert "noise stays" not in run("composite", path, "-o", tmp_path / "a.exr")[2]
    finally:
        denoiser.home.cache_clear()


def test_all_view_layers_are_drawn(run, tmp_path, scene):
    """Each as if it were alone; a PNG has room for one, and says so."""
    second = drawn.scene(*SIZE, seed=1)
    alone = {"One": exr.passes(scene), "Two": {**exr.passes(second), "Emit": second["color"]}}
    del alone["One"]["Normal"]  # which switches nothing off in the other
    channels = {f"{layer}.{name}.{letter}": np.atleast_3d(picture)[..., k] for layer, pictures in alone.items()
                for name, picture in pictures.items() for k, letter in enumerate(exr.LETTERS[name])}
    path = tmp_path / "in.exr"
    multilayer.write(path, channels, multilayer.Window(*SIZE, 0, 0, *SIZE))
    status, _, err = run("composite", path, "-o", tmp_path / "both.exr")
    assert status == 0 and "is drawn, and not" not in err and "view layer One, has no normals" in err
    for layer, pictures in alone.items():
        assert run("composite", path, "-o", tmp_path / "one.exr", "--view-layer", layer)[2].count("is drawn") == 0
        own = exr.write(tmp_path / "own.exr", pictures, layer=layer)
        assert run("composite", own, "-o", tmp_path / "own_out.exr")[0] == 0
        for name in ("Combined", *layers.DRAWN):
            want = exr.picture(tmp_path / "own_out.exr", f"{layer}.{name}")
            for file in "both", "one":
                assert np.array_equal(exr.picture(tmp_path / f"{file}.exr", f"{layer}.{name}"), want), (layer, name)
    err = run("composite", path, "-o", tmp_path / "o.png")[2]
    assert "layer One is drawn, and not Two; choose by --view-layer, or write an .exr" in err
    assert "is drawn" not in run("composite", path, "-o", tmp_path / "o.png", "--view-layer", "Two")[2]


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="all pictures are in memory here")
def test_large_pictures_lie_in_files(run, tmp_path, scene, monkeypatch):
    """With the same pixels; where files have no room, in memory."""
    path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene)})
    monkeypatch.setattr(room, "LARGE", 1)
    made = room.Room(SIZE[0] * SIZE[1])
    picture = made.zeros((1 << 12, 1 << 12))
    assert not picture[::64].any()
    picture[:] = 1
    pages = Path("/proc/self/statm").read_text().split()[2]
    time.sleep(0.2)
    made.give_back()
    assert int(Path("/proc/self/statm").read_text().split()[2]) < int(pages) - (1 << 13) and (picture == 1).all()
    pictures = []
    for number, limit in enumerate((1, 1 << 30)):
        monkeypatch.setattr(room, "LARGE", limit)
        assert run("composite", path, "-o", tmp_path / f"{number}.exr")[0] == 0
        pictures.append(exr.read(tmp_path / f"{number}.exr"))
    assert all(np.array_equal(pictures[0][name], pictures[1][name]) for name in pictures[1])
    child = encre("composite", path, "-o", tmp_path / "2.exr", preexec_fn=lambda: resource.setrlimit(
        resource.RLIMIT_FSIZE, (1 << 19,) * 2))
    assert child.communicate(timeout=60) and child.returncode == 0


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_sequences(run, tmp_path, scene, ending):
    for frame in (1, 2, 3, 7):
        exr.write(tmp_path / f"in.{frame:04}.exr", {**exr.passes(scene), "Combined": scene["combined"] / frame})
    pattern, out = tmp_path / "in.####.exr", tmp_path / "out" / f"o.####.{ending}"
    status, said, err = run("composite", pattern, "-o", out, "-f", "1-3x2,7")
    assert status == 0 and said.count("\n") == 3 and err.count("encre: note") <= 4
    assert sorted(os.listdir(tmp_path / "out")) == [f"o.{k:04}.{ending}" for k in (1, 3, 7)]
    first = tmp_path / "out" / f"o.0001.{ending}"
    before = first.stat().st_mtime_ns
    status, said, err = run("composite", pattern, "-o", out, "--resume")
    assert status == 0 and said.count("\n") == 1 and "3 of 4 frames are finished" in err
    assert first.stat().st_mtime_ns == before
    assert run("composite", pattern, "-o", out, "--resume", "-s", "2", "--set=line_thickness=9")[1].count("\n") == 3
    fails(run("composite", pattern, "-o", out, "-f", "9"), "in.0009.exr", "No such file")
    fails(run("composite", tmp_path / "in.0001.exr", "-o", out, "-f", "1"), "#")
    fails(run("composite", tmp_path / "none.####.exr", "-o", out), "no such frame")


def test_jobs(tmp_path, scene):
    for frame in range(1, 6):
        exr.write(tmp_path / f"in.{frame:04}.exr", exr.passes(scene))
    command = ["composite", tmp_path / "in.####.exr", "-o", tmp_path / "o.####.png", "-f", "1-5", "--jobs", "2"]
    code, _, err = finish(encre(*command[:-3], "2", "--jobs", "200"))
    assert code == 0, err
    code, out, err = finish(encre(*command))
    assert code == 0 and out.count("\n") == 5, err
    assert [p.name for p in sorted(tmp_path.glob("*.png"))] == [f"o.{k:04}.png" for k in range(1, 6)]
    (tmp_path / "in.0002.exr").write_bytes(b"")
    code, _, err = finish(encre(*command))
    assert code == 1 and "in.0002.exr" in err and err.splitlines()[-1].startswith("encre: error: not all frames")
    assert not list(tmp_path.glob(".encre-*"))


@pytest.mark.parametrize(("options", "words"), [
    (["--set", "line_thicknes=3"], ["line_thicknes:", "line_thickness"]),
    (["--set", "line_thickness=-1"], ["line_thickness", "0 to 4096"]),
    (["--set", "line_thickness=thick"], ["line_thickness", "thick"]),
    (["--set", "line_thickness=nan"], ["line_thickness", "nan"]),
    (["--set", "line_thickness"], ["line_thickness", "ID=VALUE"]),
    (["--set", "edge_detector=DOGS"], ["edge_detector", "DOG"]),
    (["--set", "use_lines=maybe"], ["use_lines", "maybe"]),
    (["--set", "line_color=1,0"], ["line_color"]),
    (["--set", "shade_levels=0.5; 0.7,0.5,0.2; 1,0.55,0.2"], ["shade_levels", "overlap"]),
    (["--set", "paper_image=nowhere.png"], ["nowhere.png"]),
    (["--preset", "watermemory"], ["watermemory", "Water Memory"]),
    (["--preset", ""], ["unknown preset", "Water Memory"]),
    (["--threads", "-1"], ["--threads", "'-1'"]),
    (["--threads", "1025"], ["threads", "1025", "1024"]),
    (["--jobs", "999999"], ["--jobs", "999999", "256"]),
    (["--frobnicate"], ["--frobnicate"]),
    (["-o", "out.jpg"], ["out.jpg", ".png"]),
    (["-o", ".exr"], [".exr must be a name"]),
    (["-o", "a" * 252 + ".exr"], ["can't be written", "too long"]),
    (["-o", "/proc/nothing/out.exr"], ["/proc/nothing/out.exr", "can't be written"]),
])
def test_composite_refuses(run, tmp_path, scene, options, words, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    fails(run("composite", path, "-o", "x.exr", *options), *words)
    assert os.listdir(tmp_path) == ["in.exr"]


@pytest.mark.parametrize("content", [None, b"", b"not an image", "cut", "tail"])
def test_composite_refuses_files_that_are_no_exr(run, tmp_path, scene, content):
    path = tmp_path / "in.exr"
    if isinstance(content, str):
        whole = exr.write(path, exr.passes(scene)).read_bytes()
        content = whole[:len(whole) // 2] if content == "cut" else whole[:300]
    if content is not None:
        path.write_bytes(content)
    # OpenEXR's own words pass by Python's stderr.
    fails(finish(encre("composite", path, "-o", tmp_path / "x.exr")), "in.exr")
    assert not (tmp_path / "x.exr").exists()


def test_composite_spares_its_input(run, tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    before = path.read_bytes()
    (tmp_path / "link.exr").symlink_to(path)
    fails(run("composite", path, "-o", tmp_path / "link.exr"), "link.exr", "layers would be lost")
    assert path.read_bytes() == before


def test_composite_refuses_names_that_are_not_utf8(tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    odd = os.fsdecode(os.fsencode(tmp_path / "in") + b"\xff.exr")
    os.rename(path, odd)
    fails(finish(encre("composite", odd, "-o", tmp_path / "x.exr")), "UTF-8")
    os.rename(odd, path)
    fails(finish(encre("composite", path, "-o", odd)), "UTF-8")
    assert os.listdir(tmp_path) == ["in.exr"]


@pytest.mark.parametrize(("key", "text"), [
    (metadata.PARAMS, "{"), (metadata.PARAMS, "[]"), (metadata.PARAMS, '{"version": 9, "scene": {}, "styles": []}'),
    (metadata.PARAMS, '{"version": 1, "scene": {"line_thickness": "wide"}, "styles": []}'),
    (metadata.FRAME, '{"width": 10, "height": 10, "x": 0, "y": 0}'), (metadata.FRAME, '{"width": 0}'),
    (metadata.CAMERA, '{"orthographic": true, "height": 0, "view": [1, 0, 0]}'),
])
def test_composite_refuses_metadata(run, tmp_path, scene, key, text):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene), metadata={key: text})
    fails(run("composite", path, "-o", tmp_path / "x.exr"), key.removeprefix("encre."))


def test_composite_warns_of_unknown_ids_in_metadata(run, tmp_path, scene):
    said = json.dumps({"version": 1, "scene": {"line_glitter": 1}, "styles": []})
    path = exr.write(tmp_path / "in.exr", exr.passes(scene), metadata={metadata.PARAMS: said})
    status, _, err = run("composite", path, "-o", tmp_path / "x.exr")
    assert status == 0 and "warning" in err and "line_glitter" in err


def test_parts_of_different_sizes(run, tmp_path, scene):
    pictures = exr.passes(scene)
    pictures["Normal"] = pictures["Normal"][:-1]
    path = exr.write(tmp_path / "in.exr", pictures, "parts")
    fails(run("composite", path, "-o", tmp_path / "x.exr"), "in.exr", "size")


# Settings together


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
    ("none", "paper_image", None), ("#ff8000", "line_color", (1, 0.21586050, 0)), ("#000000", "line_color", (0, 0, 0)),
])
def test_words_for_values(said, id_, value):
    assert library.parse(id_, said) == (value if id_ != "line_color" else pytest.approx(value))


def test_threads_0_is_one_a_processor(run, tmp_path, scene):
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))
    assert run("composite", path, "-o", tmp_path / "out.exr", "--threads", "0")[0] == 0


@pytest.mark.parametrize("command", ["render", "composite", "bake"])
def test_help_shows_examples_and_exit_statuses(run, command):
    out = run(command, "--help")[1]
    assert f"examples:\n  encre {command} " in out and "exit status:\n  0 " in out


# What strangers made


def paper(path):
    spec = oiio.ImageSpec(8, 8, 1, "uint8")
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(np.full((8, 8, 1), 200, np.uint8)) and out.close()
    return path


def test_a_paper_image_is_opened_where_it_is_used_and_lies_beside_the_file(run, tmp_path, scene):
    far, near = paper(tmp_path / "far.png"), tmp_path / "in"
    near.mkdir()
    beside = paper(near / "paper.png")
    (near / "link.png").symlink_to(far)

    def said(image, *options, source="IMAGE"):
        stored = metadata.write({"paper_source": source, "paper_image": str(image)}, [], Camera(), Frame(*SIZE))
        path = exr.write(near / "in.exr", exr.passes(scene), metadata=stored)
        return run("composite", path, "-o", tmp_path / "out.exr", *options)

    assert said(beside)[0] == said("paper.png")[0] == 0
    for image in far, near / "link.png", "../far.png":
        fails(said(image), "paper image", "--allow-paths")
    assert said(far, "--allow-paths")[0] == said(far, f"--set=paper_image={far}")[0] == 0
    for idle in ["--set=use_lines=no", "--set=use_hatching=no"], ["--set=paper_source=PROCEDURAL"]:
        assert said("/nowhere/paper.png", *idle)[0] == 0
    assert said("/nowhere/paper.png", source="NONE")[0] == 0


def test_foreign_words_are_shown_escaped(run, tmp_path, scene):
    said = json.dumps({"version": 1, "scene": {"\x1b[2J\nencre: \u202eerror": 1}, "styles": []})
    path = exr.write(tmp_path / "in.exr", exr.passes(scene), metadata={metadata.PARAMS: said})
    status, _, err = run("composite", path, "-o", tmp_path / "x.exr")
    assert status == 0 and "\x1b" not in err and "\u202e" not in err and r"\x1b[2J\nencre: \u202eerror" in err
    assert all(line.startswith("encre: ") for line in err.splitlines())


def test_thousands_of_unknown_settings_are_one_warning(run, tmp_path, scene):
    said = json.dumps({"version": 1, "scene": {f"word{k}": 1 for k in range(3000)}, "styles": []})
    path = exr.write(tmp_path / "in.exr", exr.passes(scene), metadata={metadata.PARAMS: said})
    status, _, err = run("composite", path, "-o", tmp_path / "x.exr")
    assert status == 0 and err.count("warning") == 1 and "3000" in err and len(err) < 2000


def test_what_is_half_made_has_a_name_that_nobody_foresees(tmp_path, monkeypatch):
    """And lies in a folder of its own, into which no link can have been put."""
    seen, store = [], images.store

    def watched(place, *rest):
        seen.append(place.path)
        store(place, *rest)
        assert os.stat(place.path).st_mode & 0o777 == 0o700

    monkeypatch.setattr(images, "store", watched)
    for _ in range(2):
        png.write(tmp_path / "a.png", np.zeros((2, 2, 4), np.float32), multilayer.Window(2, 2, 0, 0, 2, 2))
    assert len(set(seen)) == 2 and os.listdir(tmp_path) == ["a.png"]


def test_a_link_gives_way_to_the_picture(run, tmp_path, scene):
    path, other = exr.write(tmp_path / "in.exr", exr.passes(scene)), tmp_path / "other"
    other.write_bytes(b"old")
    (tmp_path / "out.png").symlink_to(other)
    assert run("composite", path, "-o", tmp_path / "out.png")[0] == 0
    assert other.read_bytes() == b"old" and not (tmp_path / "out.png").is_symlink()


def test_folders_of_the_dead_are_swept(tmp_path):
    code = ("import os, sys; from encre.cli.workplace import Workplace\n"
            "place = Workplace(sys.argv[1]); place.claim('1.png'); print(place.path, flush=True); sys.stdin.read()")
    child = subprocess.Popen([sys.executable, "-c", code, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                             text=True)
    theirs = Path(child.stdout.readline().strip())
    foreign = tmp_path / re.sub(r"encre-[^-]*", "encre-elsewhere", theirs.name)
    foreign.mkdir()
    with workplace.Workplace(tmp_path) as place:
        assert theirs.is_dir(), "its owner lives"
        assert place.claim("1.png") and place.claim("2.png") is None
    child.kill()
    child.communicate()
    # The same number, but another process's: of this one, which started at another time.
    reborn = tmp_path / re.sub(r"-\d+-\d+-([0-9a-f]{16})$", f"-{os.getpid()}-1-\\1", theirs.name)
    reborn.mkdir()
    with workplace.Workplace(tmp_path) as place:
        assert not theirs.exists() and not reborn.exists() and foreign.is_dir()
        assert place.claim("1.png") is None
    assert os.listdir(tmp_path) == [foreign.name]


def test_folders_that_go_while_others_look_for_them(tmp_path):
    """Of processes that share a folder some begin while others end."""
    code = ("import sys; from encre.cli.workplace import Workplace\n"
            "for _ in range(300):\n    with Workplace(sys.argv[1]):\n        pass")
    children = [subprocess.Popen([sys.executable, "-c", code, tmp_path], stderr=subprocess.PIPE, text=True)
                for _ in range(4)]
    words = [child.communicate(timeout=120)[1] for child in children]
    assert [child.returncode for child in children] == [0] * 4, words
    assert os.listdir(tmp_path) == []


# Damaged files


@pytest.mark.parametrize("letters", ["RGB", "RGBAQ", "ARGB"])
@pytest.mark.parametrize("saved", [False, True])
def test_combined_without_alpha_or_with_more(run, tmp_path, scene, letters, saved, monkeypatch):
    pictures = {**exr.passes(scene), **(exr.saved(scene) if saved else {})}
    picked = ["RGBAQ".index(letter) for letter in letters]
    pictures["Combined"] = np.concatenate([scene["combined"], scene["depth"][..., None]], -1)[..., picked]
    monkeypatch.setitem(exr.LETTERS, "Combined", letters)
    path = exr.write(tmp_path / "in.exr", pictures)
    monkeypatch.undo()
    assert run("composite", path, "-o", tmp_path / "out.exr")[0] == 0
    combined = scene["combined"].copy()
    if "A" not in letters:
        combined[..., 3] = 1
    whole = exr.write(tmp_path / "whole.exr", {**pictures, "Combined": combined})
    assert run("composite", whole, "-o", tmp_path / "whole_out.exr")[0] == 0
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), exr.picture(tmp_path / "whole_out.exr"))


def damaged(data, number):
    """A file of which bytes are flipped, or that ends early; most often in the header."""
    rng = np.random.default_rng(number)
    if number % 4 == 0:
        return data[:rng.integers(0, len(data))]
    made = bytearray(data)
    for at in rng.integers(0, min(len(data), 4000) if number % 2 else len(data), rng.integers(1, 8)):
        made[at] = rng.integers(0, 256)
    return bytes(made)


@pytest.mark.parametrize("count", [100, pytest.param(2000, marks=pytest.mark.long)])
def test_damaged_files(tmp_path, count):
    """No traceback, signal, hang, gigabytes or half file. One process for many files: what stays behind would show."""
    stored = metadata.write({}, [("Ink", {})], Camera(), Frame(48, 32))
    pictures = {**exr.passes(drawn.scene(48, 32)), **exr.saved(drawn.scene(48, 32))}
    whole = [exr.write(tmp_path / f"{layout}.exr", pictures, layout, metadata=stored).read_bytes()
             for layout in exr.LAYOUTS]
    code = """
import os, resource, sys
from encre.cli import main
resource.setrlimit(resource.RLIMIT_AS, (4 << 30,) * 2)
for name in sys.stdin.read().split():
    status = main.main(["composite", name, "-o", name + ".png", "--threads", "1"])
    print("FILE", name, status, file=sys.stderr, flush=True)
"""
    names = []
    for number in range(count):
        (tmp_path / f"d{number}.exr").write_bytes(damaged(whole[number % len(whole)], number))
        names.append(str(tmp_path / f"d{number}.exr"))
    done = subprocess.run([sys.executable, "-c", code], input="\n".join(names), capture_output=True, text=True,
                          timeout=count)
    assert done.returncode == 0 and done.stderr.count("FILE") == count, done.stderr[-2000:]
    assert "Traceback" not in done.stderr and "should not happen" not in done.stderr, [
        line for line in done.stderr.splitlines() if "should not happen" in line][:5]
    statuses = [line.split()[2] for line in done.stderr.splitlines() if line.startswith("FILE")]
    assert set(statuses) <= {"0", "1", "2"} and statuses.count("2") > count / 4
    for name, status in zip(names, statuses, strict=True):
        assert os.path.exists(name + ".png") == (status == "0"), name
    assert not list(tmp_path.glob(".encre-*"))


# Processes


def encre(*args, **options):
    return subprocess.Popen([sys.executable, "-m", "encre", *map(str, args)], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)


def finish(child):
    """(exit status, stdout, stderr) of a process."""
    out, err = child.communicate(timeout=60)
    return child.returncode, out, err


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_a_full_disk_leaves_the_old_file(tmp_path, ending):
    layers_ = exr.passes(drawn.scene(480, 320, noise=1.0))
    path = exr.write(tmp_path / "in.exr", layers_)
    out = tmp_path / "out" / f"out.{ending}"
    out.parent.mkdir()
    out.write_bytes(b"old")
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (80_000,) * 2)  # enough for the probe, not for the picture

    child = encre("composite", path, "-o", out, *OFF, preexec_fn=limit)  # the noise of the input fills files
    err = child.communicate(timeout=60)[1]
    assert child.returncode == 1 and "can't be written" in err.splitlines()[-1] and "Traceback" not in err, err
    assert os.listdir(out.parent) == [out.name] and out.read_bytes() == b"old"


def test_interrupting_composite(tmp_path):
    path = exr.write(tmp_path / "in.exr", exr.passes(drawn.scene(1280, 720)))
    child = encre("composite", path, "-o", tmp_path / "out.exr", "--threads", "1")
    files = Path(f"/proc/{child.pid}/fd")
    while child.poll() is None and path not in [f.resolve() for f in files.iterdir() if f.exists()]:
        time.sleep(0.01)
    child.send_signal(signal.SIGINT)
    err = child.communicate(timeout=60)[1]
    assert (child.returncode, err) == (130, "encre: interrupted\n")
    assert os.listdir(tmp_path) == ["in.exr"]


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


def test_streams_that_are_closed_or_know_few_characters():
    for shell in (">&-", "2>&-", ">&- 2>&-"):
        child = subprocess.run(f'"{sys.executable}" -m encre params {shell}', shell=True, capture_output=True,
                               text=True, timeout=60)
        assert child.returncode == 0 and child.stderr == ""
    child = encre("composite", "nö.exr", "-o", "é.png", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    code, out, err = finish(child)
    assert code == 2 and err.startswith("encre: error: n\\xf6.exr") and "Traceback" not in err


def test_a_reader_that_leaves_early():
    child = subprocess.run(f'"{sys.executable}" -m encre params | head -1', shell=True, capture_output=True, text=True,
                           timeout=60)
    assert child.returncode == 0 and child.stderr == ""
