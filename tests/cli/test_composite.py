# SPDX-License-Identifier: GPL-3.0-or-later
"""What `encre composite` draws from whole files."""

import os
import tracemalloc

import drawn
import exr
import numpy as np
import OpenImageIO as oiio
import pytest
from command import OFF, SIZE, STYLES, expected, fails
from encre.cli import composite, installed, multilayer
from encre.pen import layers, metadata, presets, saved
from encre.pen.job import Camera, Chains, Frame
from known import line

WRITTEN = [name for name in ("Combined", *layers.DRAWN) if name != "Encre Tones"]  # where no tone is drawn


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
    for name, picture in expected(pictures, settings, outputs=WRITTEN).items():
        assert np.array_equal(exr.picture(tmp_path / "out.exr", prefix + name), picture), name
    assert len(exr.read(tmp_path / "out.exr")) == 16
    assert oiio.ImageInput.open(str(tmp_path / "out.exr")).spec().format == oiio.FLOAT


def test_tones_are_a_pass_where_they_are_drawn(run, tmp_path, scene):
    path, out = exr.write(tmp_path / "in.exr", exr.passes(scene)), tmp_path / "out.exr"
    assert run("composite", path, "-o", out, "--set=use_tones=on")[0] == 0
    assert exr.picture(out, "ViewLayer.Encre Tones").any()


def test_what_sticks_wants_rest_positions(run, tmp_path, scene):
    pictures = exr.passes(scene)
    path = exr.write(tmp_path / "in.exr", pictures)

    def noted(*sets, path=path, what="rest positions"):
        status, _, err = run("composite", path, "-o", tmp_path / "out.png", *(f"--set={each}" for each in sets))
        assert status == 0
        return what in err

    size = pictures["Combined"].shape[:2]
    anchored = exr.write(tmp_path / "anchored.exr", {**pictures, **{
        name: np.zeros((*size, at.stop - at.start), np.float32) for name, at in saved.ANCHOR.items()}})
    along = "use_tones=on", "tone_1=HATCH", "tone_1_space=SURFACE", "tone_strokes=UV"
    assert noted(*along, path=anchored, what="directions of UV maps")
    assert not noted(*along[:3], path=anchored, what="UV")
    assert noted("pen_1_wobble=1") and noted("use_tones=on", "tone_1_space=SURFACE")
    assert not noted() and not noted("use_tones=on")
    assert "Encre Anchor: missing; render with Encre and Save Anchor on" in run("composite", path, "--check")[1]


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
    assert status == 0 and err.count("\n") == 2
    assert "rest positions" in err and "line_color_strength (one color everywhere)" in err
    settings = {**presets.find("ink_only").values, "line_thickness": 40,
                "shade_levels": [(0.2,), (0.7, 0.3, 0.1), (1, 0.6, 0.1, 1, 0.5, 0)]}
    again = expected(pictures, settings, [STYLES[0][1]], camera, frame)["Combined"]
    assert np.array_equal(exr.picture(tmp_path / "out.exr"), again)


def test_another_angle_moves_lines_of_a_saved_frame(run, tmp_path, scene):
    """Two folds of meshes, of 25 and 45 degrees, in a picture that shows nothing else."""
    height, width = scene["depth"].shape[:2]
    bare = {name: np.zeros_like(a) + a[-1:, :1] for name, a in scene.items()}
    bare["object"][:] = 1
    folds = [line([(k * width / 3, -40), (k * width / 3, height + 40)], "crease", run=k, bend=angle,
                  depth=float(bare["depth"].flat[0])) for k, angle in ((1, 25), (2, 45))]
    told = {("ViewLayer", ""): Chains(np.concatenate(folds), np.ones(2, np.uint8))}
    stored = metadata.write({}, [], Camera(), Frame(width, height)) | metadata.write_chains(told)
    path = exr.write(tmp_path / "in.exr", {**exr.passes(bare), **exr.saved(bare)}, metadata=stored)
    out = tmp_path / "out.exr"
    for angle, folds in ((20, (True, True)), (30, (False, True)), (50, (False, False))):
        assert run("composite", path, "-o", out, "--set=length_unit=PIXELS", f"--set=crease_angle={angle}")[0] == 0
        ink = exr.picture(out, "ViewLayer.Encre Lines")[..., 3].max(0)
        drawn = [bool(ink[k * width // 3 - 3:k * width // 3 + 4].max() > 0.1) for k in (1, 2)]
        assert tuple(drawn) == folds, angle


def test_files_saved_before_meshes_told_of_chains_say_so(run, tmp_path, scene):
    marks = {"Encre Marks": np.zeros((*scene["depth"].shape[:2], 3), np.float32)}
    path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene), **marks})
    _, _, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert "render again for the lines of the meshes" in err
    assert "lines of the meshes" not in run("composite", path, "-o", tmp_path / "out.exr", "--set",
                                            "edge_detector=DOG")[2]


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


def test_a_png_is_shown_as_the_scene_is(run, tmp_path, scene, monkeypatch):
    """Where Standard or a Blender here shows it (test_png_is_the_same_picture); else that is said."""
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
    other, err = drawn_as(metadata.View("Own", 0.0, 1.0, "Own - Punchy"))
    assert np.array_equal(other, plain) and err.count("\n") == 1
    assert "no Blender is found here that brings the view transform Own and look Own - Punchy" in err
    other, err = drawn_as(metadata.View(beside=["curves", "white balance"]))
    assert np.array_equal(other, plain) and "curves and white balance of the scene's view are Blender's alone" in err
    broken = tmp_path / "config.ocio"
    broken.write_text("ocio_profile_version: 9\n")
    monkeypatch.setattr(installed, "colour_configurations", lambda: [str(broken)])
    _, err = drawn_as(metadata.View("AgX", 1.0))
    assert "brings the view transform AgX: the PNG is Standard" in err


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
    for name, picture in expected(rendered, {}, [{}], frame=frame, outputs=WRITTEN).items():
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
        for name in WRITTEN:
            want = exr.picture(tmp_path / "own_out.exr", f"{layer}.{name}")
            for file in "both", "one":
                assert np.array_equal(exr.picture(tmp_path / f"{file}.exr", f"{layer}.{name}"), want), (layer, name)
    err = run("composite", path, "-o", tmp_path / "o.png")[2]
    assert "layer One is drawn, and not Two; choose by --view-layer, or write an .exr" in err
    assert "is drawn" not in run("composite", path, "-o", tmp_path / "o.png", "--view-layer", "Two")[2]


@pytest.mark.slow
@pytest.mark.parametrize(("ending", "change", "most"), [("exr", {}, 189), ("exr", {"line_mirror_strength": 0.0}, 161),
                                                        ("png", {}, 143)])
def test_memory_of_composite(tmp_path, monkeypatch, ending, change, most):
    """numpy counts its pictures with Python's memory; OpenImageIO's are copied here, so that they count as well."""
    width, height = 192, 1080
    scene = drawn.scene(width, height)
    scene.update(style=0 * scene["style"], controls=0 * scene["controls"])
    stored = metadata.write({}, [], Camera(), Frame(width, height))
    path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene)}, metadata=stored)
    del scene
    read = oiio.ImageInput.read_scanlines
    monkeypatch.setattr(oiio.ImageInput, "read_scanlines", lambda *args: read(*args).copy())
    tracemalloc.start()
    composite.composite(str(path), str(tmp_path / f"out.{ending}"), change)
    peak = tracemalloc.get_traced_memory()[1] / (width * height)
    tracemalloc.stop()
    assert peak <= most
