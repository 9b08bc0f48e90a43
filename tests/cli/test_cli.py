# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: params, presets, composite. `encre render` has test_cli_render.py."""

import json
import os
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
from encre.cli import composite, main
from encre.pen import layers, library, metadata, presets, saved
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame
from encre.pen.settings import Settings, switches

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
    def run(*args):
        """(exit status, stdout, stderr) of `encre args`."""
        try:
            status = main.main([str(arg) for arg in args])
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
    assert err.startswith("encre: note: ") and err.count("\n") == (1 if settings else 2)  # what FINE lacks is the other
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
                         "--set", "line_thickness=40", "--set", "shade_levels=0.2; 0.7,0.3,0.1; 1,0.6,0.1,1,0.5,0")
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


def test_composite_names_missing_passes(run, tmp_path, scene, data):
    for name in ("Combined", "Depth", "Normal", "DiffDir", "DiffCol"):
        pictures = exr.passes(scene)
        del pictures[name]
        path = exr.write(tmp_path / "in.exr", pictures)
        fails(run("composite", path, "-o", tmp_path / "x.exr"), name, "IndexOB", "in.exr")
    beachball = data / "beachball.0001.exr"  # a data window, and only colour and depth
    fails(run("composite", beachball, "-o", tmp_path / "x.exr"), "DiffDir", "Combined, Depth")
    assert not (tmp_path / "x.exr").exists()


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
    (["--threads", "0"], ["--threads", "'0'"]),
    (["--threads", "1025"], ["threads", "1025", "1024"]),
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


def test_interrupting_the_start():
    """While the modules are loading."""
    code = """
import os, signal, sys
import encre.__main__
class Finder:
    def find_spec(name, *rest):
        if name == "encre.cli":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Finder)
sys.exit(encre.__main__.main())
"""
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (child.returncode, child.stderr) == (130, "encre: interrupted\n")


def test_a_reader_that_leaves_early():
    child = subprocess.run(f'"{sys.executable}" -m encre params | head -1', shell=True, capture_output=True, text=True,
                           timeout=60)
    assert child.returncode == 0 and child.stderr == ""
