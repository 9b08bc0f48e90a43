# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre render`, in a real Blender: the bpy of this Python, and with the marker `long` every other at hand.

What becomes of sequences, and of runs that fail, is in test_render_runs.py; what is refused, in
test_render_refused.py."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import blenders
import exr
import numpy as np
import OpenImageIO as oiio
import pytest
from cube import ALL, CUBE, encre, fails, script, works
from encre.cli import multilayer, render
from encre.pen import layers, library, metadata, saved
from encre.pen.colour import decode_srgb
from encre.pen.errors import EncreError

ASKED = """
layer = scene.view_layers[0]
layer.use_pass_mist = layer.use_pass_diffuse_direct = layer.encre.use_pass_edges = True
"""


def png(path):
    return oiio.ImageInput.open(str(path)).read_image("uint8")


def test_exr_and_back(cube, tmp_path):
    """The file holds all passes, and composite without options gives its Combined again."""
    works(encre("render", cube, "-o", tmp_path / "out.exr", ALL, "--passes=all"))
    for name in ("Depth", "Normal", *layers.DRAWN, *saved.passes(())):
        assert exr.part(tmp_path / "out.exr", f"ViewLayer.{name}").shape[:2] == (36, 64)
    assert works(encre("composite", tmp_path / "out.exr", "-o", tmp_path / "again.exr")) == ""
    picture = exr.part(tmp_path / "out.exr", "ViewLayer.Combined")
    assert picture[..., :3].std() > 0.05
    assert np.abs(exr.picture(tmp_path / "again.exr") - picture).max() <= 1e-5


@pytest.mark.parametrize("more", [ASKED, pytest.param("scene.render.use_multiview = True\n", marks=pytest.mark.long)])
def test_slim_files_hold_what_restyling_reads(tmp_path, more):
    """And what the scene's maker asked for. Combined again within 1/255 at 99.95 % of the pixels."""
    path = script(tmp_path, more)
    whole, slim = tmp_path / "whole.exr", tmp_path / "slim.exr"
    works(encre("render", path, "-o", whole, "--size", "320x180", ALL))
    works(encre("render", path, "-o", slim, "--size", "320x180"))
    assert slim.stat().st_size < 0.45 * whole.stat().st_size
    name = "ViewLayer.Combined.right" if "multiview" in more else "ViewLayer.Combined"
    for options in [], ["--preset=ink_only", "--set=light_source=CYCLES", "--set=line_thickness=9",
                    "--set=line_shadow_pen=PEN_1"]:
        assert works(encre("composite", slim, "-o", tmp_path / "a.exr", *options)) == ""
        works(encre("composite", whole, "-o", tmp_path / "b.exr", *options))
        a, b = (exr.part(tmp_path / f"{name_}.exr", name) for name_ in "ab")
        assert (np.abs(a - b).max(2) <= 1 / 255).mean() >= 0.9995
    with multilayer.Exr(slim) as opened:
        kinds = {full.split(".")[1]: kind for full, kind in opened.kinds.items()}
        assert kinds["Combined"] == "half" and kinds["Depth"] == "float"
        assert {"DiffInd", "Encre Lines", "Denoising Normal"} & kinds.keys() == set()
        assert ({"Mist", "DiffDir", "Encre Edges"} <= kinds.keys()) == (more == ASKED)
    if more == ASKED:
        for kept in "ViewLayer.Mist", "ViewLayer.DiffDir", "ViewLayer.Encre Edges":
            assert np.array_equal(exr.part(slim, kept), exr.part(whole, kept))
    assert "1 of 1 frames are finished" in works(encre("render", path, "-o", slim, "--size", "320x180", "--resume"))


SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.long
@pytest.mark.parametrize("scene", [path for path in sorted(SCENES.glob("*.py")) if "def build()" in path.read_text()],
                         ids=lambda path: path.stem)
def test_slim_files_give_every_scene_again(tmp_path, scene):
    options = "--size", "480x270", "--samples", "4"
    works(encre("render", scene, "-o", tmp_path / "whole.exr", *options, ALL))
    works(encre("render", scene, "-o", tmp_path / "slim.exr", *options))
    works(encre("composite", tmp_path / "slim.exr", "-o", tmp_path / "again.exr"))
    # not with the whole file's: of two renders Cycles' last digits differ, by which lines between colours come and go
    a, b = (exr.part(tmp_path / f"{name}.exr", "ViewLayer.Combined") for name in ("slim", "again"))
    apart = np.abs(a - b).max(2)  # half of light's digits are kept: one in 2,000 is up to 1.3 steps off
    assert (apart <= 1 / 255).mean() >= 0.999, (apart > 1 / 255).mean()
    share = (tmp_path / "slim.exr").stat().st_size / (tmp_path / "whole.exr").stat().st_size
    # wood's grain, whose colours keep all digits; edges of meshes are a tenth of what a file of little else holds
    assert share < {"living_room": 0.41, "turn": 0.37}.get(scene.stem, 0.36), share


GENERATED = """
paper = bpy.data.images.new("Sheet", 32, 32)
paper.pixels = [v for k in range(32 * 32) for v in (0.5 + (k * 7919 % 101) / 250,) * 3 + (1,)]
scene.encre.paper_source, scene.encre.paper_image = "IMAGE", paper
scene.render.use_freestyle = True
"""


def test_what_is_not_given_again_is_stored_or_said(tmp_path):
    """A generated paper's pixels go into the file; Freestyle's strokes do not."""
    path = script(tmp_path, GENERATED)
    works(encre("render", path, "-o", tmp_path / "a.exr", ALL))
    err = works(encre("composite", tmp_path / "a.exr", "-o", tmp_path / "b.exr"))
    assert err.count("\n") == 1 and "Freestyle's strokes in Combined are not drawn again" in err
    path.write_text(CUBE + GENERATED.replace("use_freestyle = True", "use_freestyle = False"))
    works(encre("render", path, "-o", tmp_path / "a.exr", ALL))
    assert works(encre("composite", tmp_path / "a.exr", "-o", tmp_path / "b.exr")) == ""
    again, picture = exr.picture(tmp_path / "b.exr"), exr.part(tmp_path / "a.exr", "ViewLayer.Combined")
    assert np.abs(again - picture).max() <= 1e-5
    works(encre("composite", tmp_path / "a.exr", "-o", tmp_path / "c.exr", "--set=paper_source=NONE"))
    assert np.abs(exr.picture(tmp_path / "c.exr") - picture).max() > 0.01, "the paper is seen"


VIEWS = """
def show(scene, *_):
    view = scene.view_settings
    scene.display_settings.display_device = "Display P3" if scene.frame_current == 5 else "sRGB"
    view.view_transform, view.look, view.exposure, view.gamma = {
        1: ("Standard", "None", 0, 1), 2: ("Standard", "None", -1, 1.3), 3: ("AgX", "AgX - Punchy", 0.7, 1),
        4: ("Filmic", "High Contrast", 0, 1.2), 5: ("AgX", "None", 1.5, 1)}[scene.frame_current]
bpy.app.handlers.frame_change_pre.append(show)
"""


def test_png_is_the_same_picture(tmp_path):
    """However each frame is to be shown."""
    cube, frames = script(tmp_path, VIEWS), ("--size", "80x45", "-s", "1", "-e", "5")
    works(encre("render", cube, "-o", tmp_path / "out##.png", *frames))
    works(encre("render", cube, "-o", tmp_path / "out##.exr", *frames))
    again = encre("composite", tmp_path / "out##.exr", "-o", tmp_path / "again##.png")
    assert (again.returncode, again.stderr) == (0, "")
    shown = [[png(tmp_path / f"{name}{k:02}.png").astype(int) for k in range(1, 6)] for name in ("out", "again")]
    for a, b in zip(*shown, strict=True):
        assert a.shape == b.shape == (45, 80, 4) and np.abs(a - b).max() <= 2  # Blender dithers
    for k, a in enumerate(shown[0]):
        assert all(np.abs(a - b).max() > 8 for b in shown[0][:k])


def test_stereo(tmp_path):
    """Each eye of a restyled picture is the eye that was rendered."""
    path = script(tmp_path, "scene.render.use_multiview = True\n")
    works(encre("render", path, "-o", tmp_path / "out.exr", ALL))
    works(encre("composite", tmp_path / "out.exr", "-o", tmp_path / "again.exr"))
    eyes = []
    for file in "out", "again":
        with multilayer.Exr(tmp_path / f"{file}.exr") as opened:
            assert opened.views == ("left", "right")
            names = {eye: [f"ViewLayer.Combined.{eye}.{c}" for c in "RGBA"] for eye in opened.views}
            eyes.append(opened.read(names))
    assert np.abs(eyes[0]["left"] - eyes[0]["right"]).max() > 0.1
    for eye in "left", "right":
        assert np.abs(eyes[0][eye] - eyes[1][eye]).max() <= 1e-5
    fails(encre("composite", tmp_path / "out.exr", "-o", tmp_path / "out.png"), "out.exr", "stereo")


def test_settings_reach_the_engine(cube, tmp_path):
    first, second = tmp_path / "a.exr", tmp_path / "b.exr"
    works(encre("render", cube, "-o", first, ALL, "--preset", "Ink only", "--full", "--set", "ink_color=1,0,0",
                "--set", "shade_levels=0.3; 1,0.5,0.1,1,0,0", "--set", "light_source=CYCLES", "--samples", "3"))
    settings = metadata.read(exr.metadata(first))
    assert settings.scene["ink_color"] == (1, 0, 0) and settings.scene["surface"] == "PAPER"
    assert settings.scene["shade_levels"][1] == pytest.approx((1, 0.5, 0.1, 1, 0, 0))
    assert exr.metadata(first)["cycles.ViewLayer.samples"] == "3"
    # A frame restyled equals a frame rendered in the new style.
    err = works(encre("render", cube, "-o", second, ALL, "--samples", "3", "--set=save_rest=ON",
                      "--set=sobel_crease_threshold=.5"))
    assert "changes nothing here: sobel_crease_threshold (it needs edge_detector=SOBEL)" in err
    err = works(encre("composite", second, "-o", tmp_path / "c.exr", "--preset", "Ink only",
                      "--set", "ink_color=1,0,0", "--set", "shade_levels=0.3; 1,0.5,0.1,1,0,0",
                      "--set", "layer_source=ENCRE"))
    assert "light_source DRAWN needs a render" in err and "layer_source ENCRE needs a render" in err
    assert np.abs(exr.picture(tmp_path / "c.exr") - exr.part(first, "ViewLayer.Combined")).max() <= 1e-5


def test_set_wins_over_keyframes(tmp_path):
    path = script(tmp_path, 'scene.encre.line_thickness = 9\nscene.encre.keyframe_insert("line_thickness", frame=1)\n'
                            'scene.encre.driver_add("paper_seed").driver.expression = "7"\n')
    for options, thickness, seed in (([], 9, 7), (["--set", "line_thickness=31", "--set", "paper_seed=2"], 31, 2)):
        works(encre("render", path, "-o", tmp_path / "out.exr", *options))
        settings = metadata.read(exr.metadata(tmp_path / "out.exr"))
        assert (settings.scene["line_thickness"], settings.scene["paper_seed"]) == (thickness, seed)


CHOICES = r"""
other = bpy.data.scenes.new("Other")
for obj in scene.objects:
    other.collection.objects.link(obj)
second = bpy.data.objects.new("Second", bpy.data.cameras.new("Second"))
second.location, second.rotation_euler = (0, 0, 9), (0, 0, 0)
other.collection.objects.link(second)
other.camera = scene.camera
other.timeline_markers.new("m", frame=1).camera = scene.camera
other.view_layers.new("Extra")
scene.view_layers.new("two\nlines")
other.cycles.samples, other.cycles.use_denoising = 1, False
other.render.resolution_x, other.render.resolution_y = 40, 30
"""


def test_choices(tmp_path):
    """The scene, its camera, view layer, threads and device; what is not there is said with what is."""
    path = script(tmp_path, CHOICES)
    given = ["--scene", "Other", "--view-layer", "Extra", "--threads", "1", "--device", "cpu"]
    works(encre("render", path, "-o", tmp_path / "a.exr", *given))
    works(encre("render", path, "-o", tmp_path / "b.exr", *given, "--camera", "Second"))
    a, b = (exr.part(tmp_path / f"{name}.exr", "Extra.Combined") for name in "ab")
    assert a.shape == b.shape == (30, 40, 4) and np.abs(a - b).max() > 0.1
    with multilayer.Exr(tmp_path / "a.exr") as opened:
        assert not any(name.startswith("ViewLayer.") for name in opened.channels)
    fails(encre("render", path, "-o", tmp_path / "c.png", "--scene", "Othre"), "Othre", "Other")
    fails(encre("render", path, "-o", tmp_path / "c.png", "--camera", "Sun"), "Sun", "camera")
    fails(encre("render", path, "-o", tmp_path / "c.png", "--view-layer", "Nope"), "Nope", r"ViewLayer, two\nlines")


def test_blend_file(tmp_path):
    """A saved file renders as it stands: its own engine, frame and settings are no obstacle, nor what it keeps of an
    Encre that named them otherwise."""
    blend = tmp_path / "cube.blend"
    path = script(tmp_path, 'scene.encre.line_thickness = 21\nscene.render.engine = "CYCLES"\nscene.frame_current = 7\n'
                            'scene.encre["edge_normal"] = 2.0\n'
                            f'bpy.ops.wm.save_as_mainfile(filepath={str(blend)!r})\n')
    works(encre("render", path, "-o", tmp_path / "a.exr"))
    before = blend.read_bytes()
    said = works(encre("render", blend, "-o", tmp_path / "b.exr"))
    assert "frame 7 (1/1)" in said
    assert "does not know these settings of the file, which change nothing: edge_normal;" in said
    assert metadata.read(exr.metadata(tmp_path / "b.exr")).scene["line_thickness"] == 21
    assert blend.read_bytes() == before


def test_script_runs_as_main_beside_its_modules(tmp_path):
    (tmp_path / "render.py").write_text("size = 40, 30\n")  # the name of one of ours
    path = script(tmp_path, "import render, sys\nassert __name__ == '__main__' and sys.argv == [__file__]\n"
                            "scene.render.resolution_x, scene.render.resolution_y = render.size\nsys.exit()\n")
    works(encre("render", path, "-o", tmp_path / "out.png"))
    assert png(tmp_path / "out.png").shape == (30, 40, 4)


def test_a_script_may_enable_encre(tmp_path):
    path = script(tmp_path, "bpy.ops.preferences.addon_enable(module='encre')\nscene.render.engine = 'ENCRE'\n"
                            "scene.render.resolution_x, scene.render.resolution_y = 40, 30\n")
    works(encre("render", path, "-o", tmp_path / "out.png"))


def test_which_blender(monkeypatch, tmp_path):
    program = tmp_path / "blender"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setattr(render.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert render.find_blender()[0] == str(program)
    program.unlink()
    with pytest.raises(EncreError, match="(?s)--blender.*bpy.*PATH"):
        render.find_blender()
    monkeypatch.setattr(render.importlib.util, "find_spec", lambda name: name)
    assert render.find_blender() == [sys.executable]


# Every Blender at hand


@pytest.mark.slow
def test_textures_are_the_same_by_whatever_name_a_studio_has_for_their_space(tmp_path):
    """They were taken for linear, and washed out, where the configuration of OpenColorIO called it otherwise."""
    own = next(Path(importlib.util.find_spec("bpy").origin).parent.glob("*/datafiles/colormanagement"))
    for path in own.iterdir():
        (tmp_path / path.name).symlink_to(path)
    config, text = tmp_path / "config.ocio", (own / "config.ocio").read_text()
    config.unlink()
    text = re.sub(r"(default_byte|default_sequencer|color_picking|name|colorspace|src|dst): sRGB(?=[,}\n])",
                  r"\1: Studio Texture", text)
    config.write_text(re.sub(r"(name: Studio Texture\n +aliases: ).*", r"\1[]", text))
    scene = script(tmp_path, f'''
image = bpy.data.images.new("Gray", 4, 4)
image.pixels = (0.5, 0.25, 0.75, 1) * 16
image.filepath_raw, image.file_format = {str(tmp_path / "gray.png")!r}, "PNG"
image.save()
image = bpy.data.images.load({str(tmp_path / "gray.png")!r})
assert image.colorspace_settings.name == "Studio Texture"
block = bpy.data.materials.new("Gray")
block.use_nodes = True
tree = block.node_tree
node = tree.nodes.new("ShaderNodeTexImage")
node.image = image
tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
mesh.materials.append(block)
mesh.uv_layers.new()
''')
    works(encre("render", scene, "-o", tmp_path / "x.exr", "--fast", "-f", "3", ALL, python=sys.executable,
                env=os.environ | {"OCIO": str(config)}))
    color = exr.part(tmp_path / "x.exr", "ViewLayer.DiffCol")[18, 32]
    np.testing.assert_allclose(color, [decode_srgb(round(v * 255) / 255) for v in (0.5, 0.25, 0.75)], atol=2e-3)


@pytest.mark.long
@pytest.mark.parametrize("blender", [command[0] for name, command in blenders.commands().items() if name != "bpy"])
def test_other_blenders(cube, tmp_path, blender):
    if blender.endswith("python"):  # a bpy in another Python: our package by PYTHONPATH, its libraries its own
        (tmp_path / "site").mkdir()
        (tmp_path / "site" / "encre").symlink_to(Path(library.__file__).parents[1])
        environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
        works(encre("render", cube, "-o", tmp_path / "out.exr", ALL, python=blender, env=environment))
    else:
        works(encre("render", cube, "-o", tmp_path / "out.exr", ALL, "--blender", blender))
    assert works(encre("composite", tmp_path / "out.exr", "-o", tmp_path / "again.exr")) == ""
    difference = exr.picture(tmp_path / "again.exr") - exr.part(tmp_path / "out.exr", "ViewLayer.Combined")
    assert np.abs(difference).max() <= 1e-5


@pytest.mark.long
@pytest.mark.skipif(not shutil.which("blender"), reason="needs the program blender")
def test_this_encre_takes_the_place_of_the_installed_one(cube, tmp_path):
    package = tmp_path / "user" / "addons" / "encre"
    shutil.copytree(Path(library.__file__).parents[1], package, ignore=shutil.ignore_patterns("__pycache__"))
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(tmp_path / "user"), "BLENDER_USER_CONFIG": str(tmp_path)}
    enable = "import bpy; bpy.ops.preferences.addon_enable(module='encre'); bpy.ops.wm.save_userpref()"
    subprocess.run(["blender", "-b", "--python-expr", enable], env=environment, check=True, timeout=60,
                   capture_output=True)
    err = works(encre("render", cube, "-o", tmp_path / "out.png", "--blender", "blender", env=environment))
    assert "takes the place" in err and str(package) in err


@pytest.mark.long
@pytest.mark.skipif(not shutil.which("blender"), reason="needs the program blender")
def test_no_other_package_of_the_name_comes_before_this_encre(cube, tmp_path):
    """Though Blender's Python finds one, and this Encre is in Blender already, under another name."""
    addons, rubbish = tmp_path / "user" / "addons", tmp_path / "rubbish" / "encre"
    addons.mkdir(parents=True)
    (addons / "encre_dev").symlink_to(Path(library.__file__).parents[1])
    rubbish.mkdir(parents=True)
    (rubbish / "__init__.py").write_text("raise ImportError('rubbish')")
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(tmp_path / "user"), "BLENDER_USER_CONFIG": str(tmp_path)}
    enable = "import bpy; bpy.ops.preferences.addon_enable(module='encre_dev'); bpy.ops.wm.save_userpref()"
    subprocess.run(["blender", "-b", "--python-expr", enable], env=environment, check=True, timeout=60,
                   capture_output=True)
    program = tmp_path / "blender"
    program.write_text(f"#!/bin/sh\nPYTHONPATH={rubbish.parent} exec {shutil.which('blender')} \"$@\"\n")
    program.chmod(0o755)
    works(encre("render", cube, "-o", tmp_path / "out.png", "--blender", program, env=environment))
    assert (tmp_path / "out.png").stat().st_size
