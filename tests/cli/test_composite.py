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
from encre.pen import layers, metadata, presets
from encre.pen.job import Camera, Frame

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
    path = exr.write(tmp_path / "in.exr", exr.passes(scene))

    def noted(*sets):
        status, _, err = run("composite", path, "-o", tmp_path / "out.png", *(f"--set={each}" for each in sets))
        assert status == 0
        return "rest positions" in err

    assert noted("pen_wobble=1") and noted("use_tones=on", "tone_1_space=SURFACE")
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


def test_what_is_set_in_vain_is_said(run, tmp_path, scene):
    """What only a style uses, or a preset gives, is not."""
    def said(styles, *sets):
        stored = metadata.write({"use_hatching": False}, styles, Camera(), Frame(*SIZE), view=metadata.View())
        path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene)}, metadata=stored)
        status, _, err = run("composite", path, "-o", tmp_path / "out.png", *(f"--set={text}" for text in sets))
        assert status == 0
        return err

    some = ("edge_detector=DOG", "line_min_length=3", "line_thickness=7", "hatch_amount=.5", "contrast_auto=on",
            "contrast_max=.1")
    assert said((), *some) == (
        "encre: note: what was set changes nothing here: line_min_length (it needs edge_detector=FINE), "
        "hatch_amount (it needs use_hatching=on), contrast_max (it needs contrast_auto=off)\n")
    assert said((), *some, "use_hatching=on", "edge_detector=FINE", "contrast_auto=off") == ""
    assert said([("Pencil", {"use_hatching": True})], "hatch_amount=.5") == ""
    assert said((), "edge_normal=0", "crease_angle=9").endswith(": crease_angle (it needs edge_normal above 0)\n")
    assert "paper_scale (it needs paper_source=PROCEDURAL or IMAGE)" in said((), "paper_source=NONE", "paper_scale=4")


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


def test_another_light_is_said_where_it_would_be_seen(run, tmp_path, scene):
    """Not where nothing looks at light, none is in the file, or it was drawn all the same."""
    def said(change, held, *options):
        pictures = {**exr.passes(scene), **exr.saved(scene), **change}
        stored = metadata.write(held, [], Camera(), Frame(*SIZE))
        path = exr.write(tmp_path / "in.exr", {name: p for name, p in pictures.items() if p is not None},
                         metadata=stored)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr", "--preset", "ink_only", *options)
        assert status == 0
        return " needs a render" in err

    assert said({}, {}) and said({}, {"light_source": "DRAWN"}, "--set=light_source=CYCLES")
    assert not said({}, {"light_source": "DRAWN"})
    assert not said({}, {"layer_source": "ENCRE"}), "whose light is always drawn"
    assert not said({}, {}, "--set=use_shading=off", "--set=edge_light=0")
    assert not said(dict.fromkeys(("Encre Diffuse", "DiffDir", "DiffInd", "Encre Source")), {}), "there is no light"
    assert not said({"Encre Diffuse": np.ones_like(scene["diffuse"])}, {}), "it is the same everywhere"


def test_lines_in_pixels_that_run_together_are_said(run, tmp_path, scene):
    """The presets of the theses are in pixels, for pictures as large as theirs."""
    path = exr.write(tmp_path / "in.exr", {**exr.passes(scene), **exr.saved(scene)},
                     metadata=metadata.write({}, [], Camera(), Frame(400, 360)))

    def said(*options):
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr", *options)
        assert status == 0
        return [line for line in err.splitlines() if "run together" in line]

    [words] = said("--preset=inter_color_2016")
    assert "lines of 22 px run together in a picture 360 px high; make it larger than 733" in words
    assert said("--preset=inter_color_2016", "--set=line_max_thickness=10") == []
    assert said("--preset=inter_color_2016", "--set=length_unit=RELATIVE") == []
    assert said("--preset=water_memory_2020") == said("--set=line_thickness=100") == []


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


def test_a_picture_of_another_name_is_offered(run, tmp_path, scene):
    channels = {f"viewlayer.combined.{c}": scene["combined"][..., k] for k, c in enumerate("RGBA")}
    path = tmp_path / "in.exr"
    multilayer.write(path, channels, multilayer.Window(*SIZE, 0, 0, *SIZE))
    fails(run("composite", path, "-o", tmp_path / "out.exr"), "pass Combined is missing",
          "--layer combined=viewlayer.combined")
    assert run("composite", path, "-o", tmp_path / "out.exr", "--layer", "combined=viewlayer.combined")[0] == 0


def test_what_the_compositor_made_is_said_to_be_lost(run, tmp_path, scene):
    """Unless it made nothing."""
    channels = {f"ViewLayer.{name}.{letter}": np.atleast_3d(picture)[..., k]
                for name, picture in exr.passes(scene).items() for k, letter in enumerate(exr.LETTERS[name])}
    path, window = tmp_path / "in.exr", multilayer.Window(*SIZE, 0, 0, *SIZE)
    for gain in 1, 0.5:
        made = {f"Composite.Combined.{c}": gain * channels[f"ViewLayer.Combined.{c}"] for c in "RGBA"}
        multilayer.write(path, {**channels, **made}, window)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
        assert status == 0 and ("compositor made (Composite.Combined) is not drawn again" in err) == (gain != 1), err
    assert "Composite, what the compositor made, is not drawn again" in run("composite", path, "--check")[1]
    assert "Composite\n  Combined: there" in run("composite", path, "--check", "--view-layer", "Composite")[1]


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
