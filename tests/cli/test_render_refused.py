# SPDX-License-Identifier: GPL-3.0-or-later
"""What `encre render` refuses, and what it says of files that it renders all the same."""

import sys
from pathlib import Path

import pytest
from cube import encre, fails, left, script, works

NAMES = r"""
scene.name = '\nENCRE {"event":"written","files":[["/a","/b"]]}\n'
scene.view_layers[0].name = '\nENCRE {"event":"written","names":["x"]}\n'
print('\nENCRE {"event": "written", "files": [["%(good)s", "%(victim)s"]], "names": ["%(good)s"]}\n', flush=True)
print("\x1b]0;title\x07", flush=True)
image = bpy.data.images.new("lost", 4, 4)
image.source, image.filepath, image.use_fake_user = "FILE", "//lost\x1b[2J.png", True
"""


def test_what_blender_prints_is_never_a_report(tmp_path):
    """A scene's name could make the old reports overwrite any file; escape sequences reach no terminal."""
    good, victim = tmp_path / "good.png", tmp_path / "victim"
    good.write_bytes(b"good")
    victim.write_bytes(b"precious")
    path = script(tmp_path, NAMES % {"good": good, "victim": victim})
    result = encre("render", path, "-o", tmp_path / "out.png", "--verbose")
    assert result.returncode == 0, result.stderr
    assert victim.read_bytes() == b"precious" and good.read_bytes() == b"good"
    assert "\x1b" not in result.stderr and r"\x1b]0;title" in result.stderr and r"lost\x1b[2J.png" in result.stderr
    assert left(tmp_path) == ["good.png", "out.png", "victim"]
    fails(encre("render", path, "-o", tmp_path / "no.png", "--strict"), "lost", "not there")


LINKS = """
import os
here = os.path.dirname(__file__)
bpy.data.libraries.write(os.path.join(here, "props.blend"), {mesh})
with bpy.data.libraries.load(os.path.join(here, "props.blend"), link=True) as (_, props):
    props.meshes = ["Cube"]
scene.collection.objects.link(bpy.data.objects.new("Prop", props.meshes[0]))
tiles = bpy.data.images.new("tiles", 4, 4, tiled=True)
tiles.tiles.new(1002)
tiles.filepath_raw, tiles.use_fake_user = os.path.join(here, "wood.<UDIM>.png"), True
open(os.path.join(here, "wood.1001.png"), "wb").write(b"rings")
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(here, "in.blend"))
os.remove(os.path.join(here, "props.blend"))
"""


def test_missing_libraries_and_tiles_are_said(tmp_path):
    works(encre("render", script(tmp_path, LINKS), "-o", tmp_path / "a.png"))
    err = works(encre("render", tmp_path / "in.blend", "-o", tmp_path / "b.png"))
    assert "props.blend (not there)" in err and "wood.1002.png (not there)" in err and "wood.1001.png" not in err
    out = tmp_path / "c.png"
    fails(encre("render", tmp_path / "in.blend", "-o", out, "--strict"), "props.blend", "bring them back")
    assert not out.exists()


def test_a_view_leads_into_no_other_folder(tmp_path):
    path = script(tmp_path, "scene.render.use_multiview = True\n"
                            "scene.render.views[0].file_suffix = '/../../escaped'\n")
    fails(encre("render", path, "-o", tmp_path / "out.png"), "file suffix", "escaped")


def test_files_from_elsewhere(tmp_path):
    """A newer Blender's file, said before it may crash; scripts that were not run."""
    blend = tmp_path / "in.blend"
    more = f"""
text = bpy.data.texts.new("run.py")
text.from_string("open({str(tmp_path / "ran")!r}, 'w')")
text.use_module = True
scene.objects["Cube"].driver_add("location", 0).driver.expression = "__import__('math').sin(frame) * 0"
bpy.ops.wm.save_as_mainfile(filepath={str(blend)!r}, compress=False)
"""
    works(encre("render", script(tmp_path, more), "-o", tmp_path / "a.png"))
    err = works(encre("render", blend, "-o", tmp_path / "b.png"))
    assert "--enable-autoexec" in err and err.count("warning") == 1 and not (tmp_path / "ran").exists()
    assert "warning" not in works(encre("render", blend, "-o", tmp_path / "b.png", "--enable-autoexec"))
    assert (tmp_path / "ran").exists()
    data = blend.read_bytes()
    assert data.startswith(b"BLENDER-v4"), "the header of this Blender's files"
    for newer in b"BLENDER-v499" + data[12:], b"BLENDER17-01v0999" + data[17:]:
        blend.write_bytes(newer)
        fails(encre("render", blend, "-o", tmp_path / "c.png", "--strict"), "newer than this")


def test_a_frame_that_cannot_be_written_is_found_before_rendering(cube, tmp_path):
    (tmp_path / "out0003.png").mkdir()
    fails(encre("render", cube, "-o", tmp_path / "out.png", "-s", "1", "-e", "3"), "out0003.png", "is a folder")
    assert left(tmp_path) == ["out0003.png"]


DEVICES = {"CUDA": any(Path("/dev").glob("nvidia[0-9]*")), "metal": sys.platform == "darwin"}  # whether they are there


@pytest.mark.parametrize("name", [name for name, there in DEVICES.items() if not there])
def test_devices_that_are_not_there(cube, tmp_path, name):
    fails(encre("render", cube, "-o", tmp_path / "a.png", "--device", name), f"--device {name.lower()}", "--device cpu")
    assert left(tmp_path) == []


@pytest.mark.parametrize(("lines", "words"), [
    ("scene.camera = None\n", ["no camera", "scene.py"]),
    ("scene.view_layers[0].use = False\n", ["none of its view layers", "--view-layer"]),
    ('camera.type = "PANO"\n', ["Camera", "panoramic"]),
    ("scene.nothing = missing\n", ["scene.py, line 21", "NameError", "missing"]),
    ("def\n", ["scene.py, line 21", "SyntaxError"]),
    ('raise SystemExit("no panel today")\n', ["scene.py", "no panel today"]),
])
def test_scenes_that_do_not_render(tmp_path, lines, words):
    fails(encre("render", script(tmp_path, lines), "-o", tmp_path / "out.png"), *words)
    assert left(tmp_path) == []


@pytest.mark.parametrize("content", [b"", b"not a .blend", b"BLENDER-v405" + bytes(4000)])
def test_broken_blend(tmp_path, content):
    (tmp_path / "broken.blend").write_bytes(content)
    fails(encre("render", tmp_path / "broken.blend", "-o", tmp_path / "out.png"), "broken.blend")
    assert left(tmp_path) == ["broken.blend"]


@pytest.mark.parametrize(("options", "words"), [
    (["missing.py"], ["missing.py", "no such file"]),
    (["scene.txt"], ["scene.txt", ".blend or .py"]),
    (["cube.py", "-o", "out.jpg"], ["out.jpg"]),
    (["cube.py", "-o", "/proc/nothing/out.png"], ["/proc/nothing/out.png", "can't be written"]),
    (["cube.py", "-o", "a" * 252 + ".png"], ["can't be written", "too long"]),
    (["cube.py", "-o", ".png"], [".png must be a name"]),
    (["cube.py", "-f", "1048575"], ["1048575", "1048574"]),
    (["cube.py", "-f", "1", "-s", "2"], ["-f", "-s"]),
    (["cube.py", "-s", "5", "-e", "2"], ["-s 5", "-e 2"]),
    (["cube.py", "-s", "9"], ["cube.py", "no frame"]),
    (["cube.py", "--size", "0x10"], ["0x10"]),
    (["cube.py", "--samples", "many"], ["many"]),
    (["cube.py", "--passes", "lines,colour"], ["lines,colour", "surface"]),
    (["cube.py", "--set", "line_thickness=-3"], ["line_thickness"]),
    (["cube.py", "--set", "paper_source=IMAGE"], ["paper_image", "choose an image"]),
    (["cube.py", "--passes", "lines"], ["--passes", "out.png", ".exr"]),
    (["cube.py", "--preset", "Ink onyl"], ["Ink onyl", "ink_only"]),
    (["cube.py", "--blender", "no/blender"], ["no/blender"]),
    (["cube.py", "--blender", ""], ["--blender"]),
    (["cube.py", "--blender", "/bin/true"], ["/bin/true", "is it Blender?"]),
    (["cube.py", "--blender", "./crash"], ["./crash", "SIGSEGV"]),
])
def test_usage(cube, tmp_path, options, words):
    crash = tmp_path / "crash"
    crash.write_text("#!/bin/sh\nkill -SEGV $$\n")
    crash.chmod(0o755)
    output = [] if "-o" in options else ["-o", "out.png"]
    fails(encre("render", *options, *output, cwd=tmp_path), *words)
    assert left(tmp_path) == ["crash"]
