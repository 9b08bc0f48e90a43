# SPDX-License-Identifier: GPL-3.0-or-later
"""What `encre composite` makes of files that lack something, come from elsewhere or are broken."""

import json
import os
import subprocess
import sys

import drawn
import exr
import numpy as np
import pytest
from command import OFF, SIZE, expected, fails, finish, start
from encre.cli import composite, denoiser, multilayer
from encre.cli.passes import substitutes
from encre.pen import metadata
from encre.pen.job import Camera, Frame
from encre.pen.settings import Settings


def test_composite_needs_only_combined(run, tmp_path, scene, data):
    """Each other pass that is missing is named, with what that switches off; a frame of depth and colour gets lines."""
    path = exr.write(tmp_path / "in.exr", {"Depth": scene["depth"]})
    fails(run("composite", path, "-o", tmp_path / "x.exr"), "Combined", "in.exr")
    for name, words in (("Depth", "no depth"), ("Normal", "no normals"), ("DiffDir", "no diffuse light"),
                        ("DiffCol", "no diffuse color")):
        pictures = exr.passes(scene)
        del pictures[name]
        path = exr.write(tmp_path / "in.exr", pictures)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
        assert status == 0 and words in err, err
    status, _, err = run("composite", data / "beachball.0001.exr", "-o", tmp_path / "ball.exr")
    assert status == 0 and "no normals" in err and "no diffuse" in err, err
    lines = [picture for name, picture in exr.read(tmp_path / "ball.exr").items() if name.endswith("Encre Lines.A")]
    assert 0.002 < (lines[0] > 0.5).mean() < 0.3


@pytest.mark.parametrize(("channel", "words"), [("Y", "Y is a picture in gray: save it with R, G and B"),
                                                ("Z", "depth alone is no picture: save both in one file")])
def test_a_file_without_a_picture_is_told_what_to_save(run, tmp_path, channel, words):
    path = tmp_path / "in.exr"
    multilayer.write(path, {channel: np.ones((2, 3), np.float32)}, multilayer.Window(3, 2, 0, 0, 3, 2))
    fails(run("composite", path, "-o", tmp_path / "x.exr"), "Combined is missing", words)


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
        "DiffDir": 0 * pictures["Normal"] + 1}, {"use_shading": False, "use_hatching": False,
                                                 "line_shadow_strength": 0.0,
                                                 "ink_in_shade": 0.0})["Combined"]
    for file in "ao", "bo":
        made = exr.read(tmp_path / f"{file}.exr")
        assert np.array_equal(np.stack([made[letter] for letter in "RGBA"], -1), want), file


def test_a_picture_and_depth_are_enough_for_ink_on_paper(run, tmp_path):
    """Tones follow how bright the picture is, beside the surfaces' colour where a layer has it; nothing is paper. What
    is not drawn on paper stays as it is, and the note says so."""
    height, width = 180, 320
    combined, depth = np.ones((height, width, 4), np.float32), np.full((height, width, 1), 5, np.float32)
    combined[..., :3], depth[:, :80] = (0.3, 0.4, 0.6), 1e10
    combined[:, 160:240, :3], combined[:, 240:, :3] = (0.9, 0.85, 0.8), (0.2, 0.05, 0.05)
    pictures = {"Combined": combined, "Depth": depth}
    path, out = exr.write(tmp_path / "in.exr", pictures), tmp_path / "out.exr"
    colored = exr.write(tmp_path / "colored.exr", {**pictures, "DiffCol": combined[..., :3]})
    quiet = ["--set=use_lines=off"]

    def ink(path, preset):
        status, _, err = run("composite", path, "-o", out, "--preset", preset, *quiet)
        assert status == 0 and "no diffuse light" in err and "needs a render" not in err, err
        made = exr.picture(out)
        assert (np.ptp(made[..., :3], axis=2) == 0).all() and (made[..., 3] == 1).all()
        return err, [1 - made[:, 80 * k + 10:80 * k + 70, 0].mean() for k in range(4)]

    err, dark = ink(path, "manga")
    assert "tones follow how bright the picture is" in err
    assert dark[0] == dark[2] == 0 and 0.2 < dark[1] < 0.5 and dark[3] > 0.99, dark
    assert max(ink(path, "ink_only")[1]) == 0
    assert max(ink(colored, "manga")[1][:3]) == 0  # its light is even
    status, _, err = run("composite", path, "-o", out, *quiet)
    assert "the picture stays as it is, nothing is shaded flat" in err and "tones follow" not in err
    settings = substitutes.switch_off(pictures, Settings({**Settings({}).scene, "surface": "PAPER"}))[0]
    substitutes.fill(pictures, settings)
    shown = pictures["DiffCol"] * pictures["Encre Diffuse"]
    # nothing passes for a mirror
    assert np.allclose(pictures["Combined"][..., :3], shown) and "DiffInd" not in pictures


def test_cryptomatte_is_the_object_index(run, tmp_path, scene, monkeypatch):
    pictures = exr.passes(scene)
    rng = np.random.default_rng(0)
    hashes = rng.integers(1 << 23, 1 << 30, 100, dtype=np.uint32).view(np.float32)
    hashes[0] = 0
    matte = np.zeros((SIZE[1], SIZE[0], 4), np.float32)
    matte[..., 0] = hashes[np.squeeze(pictures["IndexOB"]).astype(int)]
    matte[..., 1] = 0.5 + 0.5 * rng.random(matte.shape[:2])
    matte[..., 2], matte[..., 3] = hashes[7], 0.9 - matte[..., 1]
    monkeypatch.setitem(exr.LETTERS, "CryptoObject00", "rgba")
    want = expected(pictures)["Combined"]
    del pictures["IndexOB"]
    path = exr.write(tmp_path / "in.exr", {**pictures, "CryptoObject00": matte})
    status, _, err = run("composite", path, "-o", tmp_path / "out.exr")
    assert status == 0 and "line_outline_strength" not in err, err
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


def test_light_is_denoised_in_strips(run, tmp_path, monkeypatch):
    """Of large pictures, with as much around each as the denoiser sees; what is not finite counts once."""
    if not denoiser.available():
        pytest.skip("no Open Image Denoise here, in no Blender either")
    pictures = exr.passes(drawn.scene(64, 420, noise=0.5))
    pictures["DiffDir"][150:170, 5] = np.nan
    path = exr.write(tmp_path / "in.exr", pictures)
    drawn_, said = [], []
    for at_once in 1 << 22, 64 * 80:
        monkeypatch.setattr(composite, "_AT_ONCE", at_once)
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr", denoise=True)
        assert status == 0 and "60 values" in err
        drawn_.append(exr.picture(tmp_path / "out.exr", "ViewLayer.Encre Light"))
        said.append(err)
    assert np.abs(drawn_[0] - drawn_[1]).max() < 2e-3 and said[0] == said[1]
    assert np.abs(drawn_[0] - drawn_[1]).mean() < 1e-5


def test_noise_that_stays_is_said(tmp_path, scene):
    """Where there is no Blender and no such library, and with it where it need not be."""
    code = """
import ctypes.util, pathlib, sys
import OpenImageIO
from encre.cli import main
sys.path[:] = [place for place in sys.path if not (pathlib.Path(place) / "bpy").is_dir()]
ctypes.util.find_library = lambda name: None  # the system's
for name in "plain.exr", "frame.exr":
    main.main(["composite", name, "-o", "a.exr"])
main.main(["composite", "plain.exr", "-o", "a.exr", "--set=light_denoise=NONE"])
"""
    exr.write(tmp_path / "plain.exr", exr.passes(scene))
    exr.write(tmp_path / "frame.exr", exr.passes(scene), metadata=metadata.write({}, [], Camera(), Frame(*SIZE)))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, timeout=60,
                          env={**os.environ, "PATH": str(tmp_path)})
    said = [line for line in done.stderr.splitlines() if "noise" in line]
    assert len(said) == 2 and all("its noise stays" in line for line in said), done.stderr
    assert "plain.exr" in said[0] and said[1].endswith("; rendered with light_source=DRAWN it has none")
    assert "DRAWN" not in said[0], "others' renderers don't know that"


@pytest.mark.parametrize(("options", "words"), [
    (["--set", "line_thicknes=3"], ["line_thicknes:", "line_thickness"]),
    (["--set", "line_thickness=-1"], ["line_thickness", "0 to 4096"]),
    (["--set", "line_thickness=thick"], ["line_thickness", "thick"]),
    (["--set", "line_thickness=nan"], ["line_thickness", "nan"]),
    (["--set", "line_thickness"], ["line_thickness", "ID=VALUE"]),
    (["--set", "edge_detector=DOGS"], ["edge_detector", "DOG"]),
    (["--set", "use_lines=maybe"], ["use_lines", "maybe"]),
    (["--set", "ink_color=1,0"], ["ink_color"]),
    (["--set", "shade_levels=0.5; 0.7,0.5,0.2; 1,0.55,0.2"], ["shade_levels", "overlap"]),
    (["--set", "paper_image=nowhere.png"], ["nowhere.png"]),
    (["--preset", "watermemory"], ["watermemory", "water_memory"]),
    (["--preset", ""], ["unknown preset", "brush_ink, cel, clear_line"]),
    (["--preset", "in.exr"], ["in.exr: is no preset file", ".json"]),
    (["--threads", "-1"], ["--threads", "'-1'"]),
    (["--threads", "1025"], ["threads", "1025", "1024"]),
    (["--jobs", "999999"], ["--jobs", "999999", "256"]),
    (["--frobnicate"], ["--frobnicate"]),
    (["-o", "out.jpg"], ["out.jpg", ".png"]),
    (["-o", ".exr"], [".exr must be a name"]),
    (["-o", "a" * 252 + ".exr"], ["can't be written", "too long"]),
    (["-o", "/proc/nothing/out.exr"], ["/proc/nothing/out.exr: can't be written", "); choose another folder"]),
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
    fails(finish(start("composite", path, "-o", tmp_path / "x.exr")), "in.exr")
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
    fails(finish(start("composite", odd, "-o", tmp_path / "x.exr")), "UTF-8")
    os.rename(odd, path)
    fails(finish(start("composite", path, "-o", odd)), "UTF-8")
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


# What strangers made


def test_a_paper_image_is_opened_where_it_is_used_and_lies_beside_the_file(run, tmp_path, scene):
    far, near = exr.image(tmp_path / "far.png"), tmp_path / "in"
    near.mkdir()
    beside = exr.image(near / "paper.png")
    (near / "link.png").symlink_to(far)

    def said(image, *options, source="IMAGE"):
        stored = metadata.write({"paper_source": source, "paper_image": str(image)}, [], Camera(), Frame(*SIZE))
        path = exr.write(near / "in.exr", exr.passes(scene), metadata=stored)
        return run("composite", path, "-o", tmp_path / "out.exr", *options)

    assert said(beside)[0] == said("paper.png")[0] == 0
    for image in far, near / "link.png", "../far.png":
        fails(said(image), "paper image", "--allow-paths")
    assert said(far, "--allow-paths")[0] == said(far, f"--set=paper_image={far}")[0] == 0
    for idle in ["--set=use_lines=no", "--set=use_hatching=no"], ["--set=paper_source=COLD_PRESS"]:
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


# Damaged files


def test_huge_values_and_windows(tmp_path, scene):
    """What overflows is counted with what is not finite, without numpy's own words; a display window is no order."""
    pictures = exr.passes(scene)
    for name in ("Combined", "DiffDir", "Normal"):
        pictures[name] = pictures[name].copy()
        pictures[name][4:8, :20] *= np.float32(3e38)
    exr.write(tmp_path / "huge.exr", pictures)
    code, _, err = finish(start("composite", tmp_path / "huge.exr", "-o", tmp_path / "huge.png", "--threads", "1"))
    assert code == 0 and "overflow" not in err and all(line.startswith("encre: ") for line in err.splitlines()), err
    exr.write(tmp_path / "wide.exr", exr.passes(scene), window=(0, 0, 100000, 100000))
    fails(finish(start("composite", tmp_path / "wide.exr", "-o", tmp_path / "wide.png")), "wide.exr", "100000")



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
