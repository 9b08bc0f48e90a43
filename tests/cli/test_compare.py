# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre compare`: what stands where, and that both techniques draw the same width where nothing foreshortens it."""

import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from encre.cli import tools
from encre.pen import colour, library

pytestmark = pytest.mark.slow

compare = tools.load("compare", "compare")

# Planes that face the camera, 2 away on the left and 4 on the right, with stripes that are alike in red.
SCENE = '''
import bpy
import numpy as np

scene = bpy.context.scene
WIDTH = 0.6  # of two stripes
texels = np.ones((256, 1024, 4), np.float32)
texels[..., :3] = 0.8
texels[:, 256:768, 1:3] = 0.25
image = bpy.data.images.new("Stripes", 1024, 256)
image.pixels.foreach_set(texels.ravel())
image.update()
material = bpy.data.materials.new("Stripes")
material.use_nodes = True
tree = material.node_tree
tree.nodes.clear()
texture, shine, out = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexImage", "Emission", "OutputMaterial"))
texture.image = image
tree.links.new(texture.outputs[0], shine.inputs[0])
tree.links.new(shine.outputs[0], out.inputs[0])
for distance, left, right in ((2.0, -1.0, 0.0), (4.0, 0.0, 2.0)):
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata([(left, -2, -distance), (right, -2, -distance), (right, 2, -distance), (left, 2, -distance)],
                     [], [(0, 1, 2, 3)])
    uv = [(x / WIDTH, 4 * y / WIDTH) for x, y in ((left, -2), (right, -2), (right, 2), (left, 2))]
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [value for pair in uv for value in pair])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Plane", mesh))
camera = bpy.data.cameras.new("Camera")
scene.camera = bpy.data.objects.new("Camera", camera)
scene.collection.objects.link(scene.camera)
scene.cycles.samples, scene.cycles.use_denoising = 16, False
scene.render.resolution_x, scene.render.resolution_y = 480, 270
scene.view_settings.view_transform = "Standard"
'''
FLAT = ("--preset", "inter_color", "--set", "line_thickness=24", "--set", "line_far_distance=4",
        "--set", "line_far_unit=SCENE", "--set", "line_far_thickest=4", "--set", "line_far_thinnest=0", "--quadrants")


@pytest.fixture
def stripes(tmp_path):
    (tmp_path / "stripes.py").write_text(SCENE)
    return tmp_path / "stripes.py"


def encre(*args):
    command = [sys.executable, "-m", "encre", "compare", *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def works(result):
    assert result.returncode == 0 and "Traceback" not in result.stderr, result.stderr
    return result.stderr


def split(path):
    """The quadrants: plain, caption, lower left, lower right."""
    picture = compare.read(path)
    h, w = picture.shape[0] // 2, picture.shape[1] // 2
    return picture[:h, :w], picture[:h, w:], picture[h:, :w], picture[h:, w:]


def widths(picture, plain):
    """Ink in pixels across every line, from the red that both colours have alike, in the middle rows."""
    picture, plain = (colour.decode_srgb(p[100:170, :, 0]).mean(0) for p in (picture, plain))
    ink = np.clip(1 - picture / np.maximum(plain, 1e-3), 0, 1)
    ink[:2] = ink[-2:] = ink[225:255] = 0  # the bars between quadrants; where the near plane ends
    starts = np.flatnonzero((ink[1:] > 0.02) & (ink[:-1] <= 0.02)) + 1
    return np.array([run[:np.argmax(np.append(run, 0) <= 0.02)].sum() for run in (ink[k:] for k in starts)])


def test_equally_wide_where_nothing_foreshortens(stripes, tmp_path):
    """Two lines on the near plane, five on the far one; both techniques give the width that is asked."""
    works(encre(stripes, "-o", tmp_path / "out.png", *FLAT, "--set", "edge_detector=FINE"))
    plain, _, baked, dynamic = split(tmp_path / "out.png")
    colors = np.float32([[[0.8, 0.8, 0.8]] * 4 + [[0.8, 0.25, 0.25]] * 4])
    full = 24 * 270 / 1080 * (library.bake(colors, draw=False).greatest - 0.01) / 0.99
    want = np.array([2 * full] * 2 + [full] * 5)
    assert widths(dynamic, plain) == pytest.approx(want, rel=0.02)
    # Texels at a line's border are half dark as encoded, which is a little darker in light.
    assert widths(baked, plain) == pytest.approx(want, rel=0.04)


def test_seed_chooses_the_side(stripes, tmp_path):
    for seed in range(2):
        works(encre(stripes, "-o", tmp_path / f"{seed}.png", *FLAT, "--seed", seed, "--size", "120x68"))
    one, other = split(tmp_path / "0.png"), split(tmp_path / "1.png")
    assert one[2].shape == (68, 120, 3)
    inner = slice(2, -2), slice(2, -2)  # without the bars between the quadrants
    assert all(np.abs(one[a][inner] - other[b][inner]).max() < 0.02 for a, b in ((0, 0), (2, 3), (3, 2)))
    assert np.abs(one[2] - one[3]).max() > 0.2
    assert one[1].mean() > 0.7 and np.abs(one[1] - other[1]).max() > 0.5  # the caption says which is where


def test_one_frame_by_a_distance_relative_to_the_scene(stripes, tmp_path):
    scene = ("--set", "line_far_unit=RELATIVE", "--set", "line_far_distance=1")
    works(encre(stripes, "-o", tmp_path / "out.png", *FLAT, *scene, "--size", "120x68", "-f", 2, "--samples", 1))
    assert split(tmp_path / "out.png")[2].min() < 0.2  # the dynamic lines


def test_frames_crops_and_blenders_lines(stripes, tmp_path):
    err = works(encre(stripes, "-o", tmp_path / "new" / "c_##.png", *FLAT[:-1], "--size", "120x68", "-s", 3, "-e", 4,
                      "--samples", 1))
    made = sorted(path.name for path in (tmp_path / "new").iterdir())
    assert made == [f"c_0{k}{kind}.png" for k in (3, 4) for kind in ("", "_blender", "_crops")]
    assert err.count("freestyle") == err.count("line art") == 2
    crops, own = (compare.read(tmp_path / "new" / f"c_03_{kind}.png") for kind in ("crops", "blender"))
    assert crops.shape[1] == 180 and own.shape[1] == 360
    rows = own[10:58]
    freestyle, line_art = rows[:, :120], rows[:, 120:240]
    plain = compare.read(tmp_path / "new" / "c_03.png")[10:58, :120]
    for picture in freestyle, line_art:  # both find where the near plane ends, neither the stripes
        changed = np.abs(picture - plain).max((0, 2)) > 0.2
        assert changed[55:65].any() and not changed[:50].any() and not changed[70:118].any()


@pytest.mark.long
def test_mips_and_uniform(stripes, tmp_path):
    """On a plane all texels are alike and these two change little; but they are other pictures."""
    pictures = []
    for name, options in (("plain", []), ("mips", ["--mips"]), ("uniform", ["--uniform"])):
        works(encre(stripes, "-o", tmp_path / f"{name}.png", *FLAT, "--size", "160x90", *options))
        pictures.append(split(tmp_path / f"{name}.png"))
    plain = pictures[0][0]
    for quadrants in pictures[1:]:
        assert np.abs(quadrants[0] - plain).max() < 0.02
        assert np.abs(quadrants[2] - pictures[0][2])[:, :74].mean() < 0.02
    assert np.abs(pictures[1][2] - pictures[0][2]).max() > 0.05


@pytest.mark.parametrize(("options", "words"), [
    (["--set", "line_thickness=3"], ["no lines between colors", "--preset inter_color"]),
    (["--preset", "inter_color", "--set", "line_far_distance=0"], ["line_far_distance"]),
    (["--preset", "inter_color", "-f", "1", "-s", "2"], ["-f", "-s"]),
    (["--seed", "first"], ["first"]),
    (["-f", "99999999999"], ["frame number"]),
])
def test_what_can_not_be_compared(stripes, tmp_path, options, words):
    refused(encre(stripes, "-o", tmp_path / "out.png", *options), *words)
    assert not (tmp_path / "out.png").exists()


def refused(done, *words, status=2):
    sentence = done.stderr.splitlines()[-1]
    assert done.returncode == status and sentence.startswith("encre: error: ") and "Traceback" not in done.stderr
    assert all(word in sentence for word in words), sentence


def test_a_scene_without_textures_and_an_image_without_pixels(stripes, tmp_path):
    bare = tmp_path / "bare.py"
    bare.write_text(SCENE.replace("tree.links.new(texture.outputs[0], shine.inputs[0])", "tree.nodes.remove(texture)"))
    refused(encre(bare, "-o", tmp_path / "out.png", *FLAT), "no object", "give a material an image texture")
    assert not (tmp_path / "out.png").exists()
    bare.write_text(SCENE + """
lost = tree.nodes.new("ShaderNodeTexImage")
lost.image = bpy.data.images.new("Lost", 8, 8)
lost.image.source, lost.image.filepath = "FILE", "//nowhere.png"
""")
    err = works(encre(bare, "-o", tmp_path / "out.png", *FLAT, "--size", "64x36", "--samples", "1"))
    assert "Lost" in err and "stays without lines" in err and (tmp_path / "out.png").exists()
    bare.write_text(SCENE.replace("[value for pair in uv for value in pair]", "[0.5] * 8"))  # a UV map without area
    err = works(encre(bare, "-o", tmp_path / "out.png", *FLAT, "--size", "400x4", "--samples", "1"))
    assert "Stripes stays without lines: its UV map has no area" in err


def test_outputs_that_can_not_be_written(stripes, tmp_path):
    (tmp_path / "file").write_text("")
    refused(encre(stripes, "-o", tmp_path / "file" / "out.png", *FLAT), "file", "can't be")
    refused(encre(stripes, "-o", "out.jpg", *FLAT), "out.jpg")
    (tmp_path / "is.png").mkdir()
    refused(encre(stripes, "-o", tmp_path / "is.png", *FLAT), "is.png")
    (tmp_path / "out0002_crops.png").mkdir()  # found before the first frame is rendered
    refused(encre(stripes, "-o", tmp_path / "out.png", *FLAT[:-1], "-s", "1", "-e", "2"), "out0002_crops.png")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "is.png", "out0002_crops.png", "stripes.py"]


def test_a_full_disk(stripes, tmp_path):
    def small():
        resource.setrlimit(resource.RLIMIT_FSIZE, (70_000,) * 2)  # room for the probe

    stripes.write_text(SCENE.replace("texels[..., :3] = 0.8", "texels[:] = np.random.rand(*texels.shape)"))
    command = [sys.executable, "-m", "encre", "compare", stripes, "-o", tmp_path / "out.png", *FLAT, "--samples", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, preexec_fn=small)
    refused(done, "out.png", "can't be written", status=1)
    assert [path.name for path in tmp_path.iterdir()] == ["stripes.py"]


def test_interrupted(stripes, tmp_path):
    """Nothing is left behind, and no Blender runs on."""
    child = subprocess.Popen([sys.executable, "-m", "encre", "compare", stripes, "-o", tmp_path / "out.png", *FLAT,
                              "--size", "1280x720", "--samples", "4000"], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while not list(tmp_path.glob(".encre-*")) and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(3)
    child.send_signal(signal.SIGINT)
    err = child.communicate(timeout=60)[1]
    assert child.returncode == 130 and err.splitlines()[-1] == "encre: interrupted" and "Traceback" not in err
    assert [path.name for path in tmp_path.iterdir()] == ["stripes.py"]
    running = b"".join(path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline"))
    assert bytes(tmp_path) not in running


@pytest.mark.parametrize("h, w", [(4, 5), (20, 30)])
def test_details_do_not_overlap(h, w):
    difference = np.zeros((20, 30), np.float32)
    difference[3, 4] = difference[15, 22] = 1
    found = compare.places(difference, h, w)
    assert all(difference[y:y + h, x:x + w].any() for y, x in found[:2])
    for k, (y, x) in enumerate(found):
        assert all(abs(y - b) >= h or abs(x - a) >= w for b, a in found[:k])
