# SPDX-License-Identifier: GPL-3.0-or-later
"""What `encre composite` says of a file and of what was set."""

import exr
import numpy as np
from command import SIZE, fails
from encre.cli import multilayer
from encre.pen import metadata
from encre.pen.job import Camera, Frame


def test_composite_counts_what_is_not_finite(run, tmp_path, scene):
    pictures = exr.passes(scene)
    pictures["Normal"] = pictures["Normal"].copy()
    pictures["Normal"][3, :5, 0] = np.nan
    path = exr.write(tmp_path / "in.exr", pictures)
    status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert status == 0 and "warning" in err and " 5 values" in err


def test_composite_says_how_many_depths_are_negative(run, tmp_path, scene):
    pictures = exr.passes(scene)
    pictures["Depth"] = pictures["Depth"].copy()
    pictures["Depth"][3, :5] = -2
    path = exr.write(tmp_path / "in.exr", pictures)
    status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert status == 0 and "warning" in err and "the depth of 5 pixels is negative" in err


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

    some = ("edge_detector=DOG", "line_shortest=3", "line_thickness=7", "hatch_amount=.5", "contrast_local=on",
            "contrast_full=.1")
    assert said((), *some) == (
        "encre: note: what was set changes nothing here: line_shortest (it needs edge_detector=FINE), "
        "hatch_amount (it needs use_hatching=on), contrast_full (it needs contrast_local=off)\n")
    assert said((), *some, "use_hatching=on", "edge_detector=FINE", "contrast_local=off") == ""
    assert said([("Pencil", {"use_hatching": True})], "hatch_amount=.5") == ""
    assert said((), "line_crease_strength=0",
                "crease_angle=9").endswith(": crease_angle (it needs line_crease_strength above 0)\n")
    assert "paper_scale (it needs paper_source=COLD_PRESS or ROUGH or HOT_PRESS or LAID or BRISTOL or IMAGE)" in said(
        (), "paper_source=NONE", "paper_scale=4")


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

    err = said("--set=line_material_strength=1")
    assert err.startswith("encre: note: ") and err.count("\n") == 1
    for source in ("line_outline_strength (one index everywhere)", "line_material_strength (",
                   "line_mirror_strength (no passes"):
        assert source in err
    assert "line_crease_strength" not in err and "line_color_strength" not in err
    assert said("--set=line_outline_strength=0", "--set=line_mirror_strength=0") == ""
    assert said("--set=use_lines=off", "--set=use_smudging=off") == ""
    pictures.update(seen)
    assert "line_mirror_strength" not in said()
    del stored[metadata.CAMERA]  # whose normals they are is not known
    assert "line_mirror_strength" in said()


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
    assert not said({}, {}, "--set=use_shading=off", "--set=use_tones=off")
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
    assert said("--preset=inter_color_2016", "--set=line_thickest=10") == []
    assert said("--preset=inter_color_2016", "--set=length_unit=RELATIVE") == []
    assert said("--preset=water_memory_2020") == said("--set=line_thickness=100") == []


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
