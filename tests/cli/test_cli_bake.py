# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre bake`: files in and out, mip levels, meshes, and what bad input gets."""

import os
import resource
import signal
import struct
import subprocess
import sys
import threading
import zlib

import numpy as np
import OpenImageIO as oiio
import pytest
import widths
from encre.cli import interrupt, main
from encre.pen import colour, library, presets, unwrap


def stored(path, kind="float"):
    """The pixels (H, W, channels), without conversion of colour or alpha."""
    straight = oiio.ImageSpec()
    straight["oiio:UnassociatedAlpha"] = 1
    file = oiio.ImageInput.open(str(path), straight)
    return np.atleast_3d(file.read_image(kind))


def write(path, pixels, kind="uint8", **attributes):
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, kind)
    spec["oiio:UnassociatedAlpha"] = 1
    for name, value in attributes.items():
        spec[name] = value
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(pixels) and out.close()
    return path


def patches(height=48, width=64, channels=3):
    y, x = np.indices((height, width))
    out = np.full((height, width, channels), 200, np.uint8)
    out[(x // 16 + y // 16) % 2 == 1] = (40, 60, 120, 128)[:channels]
    out[np.hypot(x - 30, y - 20) < 12] = (230, 40, 30, 255)[:channels]
    return out


def scaled(pixels):
    return pixels.astype(np.float32) / np.iinfo(pixels.dtype).max


@pytest.fixture
def png(tmp_path):
    return write(tmp_path / "in.png", patches())


@pytest.fixture
def run(capsys):
    def run(*args):
        """(exit status, stderr) of `encre bake args`."""
        try:
            status = main.main(["bake", *map(str, args)])
        except SystemExit as end:
            status = end.code
        out, err = capsys.readouterr()
        named = str(args[args.index("-o") + 1]) if "-o" in args else ""
        assert (out.startswith(named) and out.count("\n") == 1) if status == 0 else out == ""
        return status, err
    return run


def fails(result, *words, status=2):
    code, err = result
    assert code == status and err.startswith("encre: error: ") and err.count("\n") == 1, err
    for word in words:
        assert word in err, err


# Kinds of files


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("ending, kind", [("png", np.uint8), ("png", np.uint16), ("tif", np.uint8), ("tga", np.uint8)])
def test_encoded(run, tmp_path, ending, kind, channels):
    pixels = patches(channels=channels).astype(kind) * (257 if kind is np.uint16 else 1)
    write(tmp_path / f"in.{ending}", pixels, np.dtype(kind).name)
    assert run(tmp_path / f"in.{ending}", "-o", tmp_path / f"out.{ending}", "--set", "line_thickness=5") == (0, "")
    want = library.bake(scaled(pixels), dict(line_thickness=5.0)).texture
    got = oiio.ImageBuf(str(tmp_path / f"out.{ending}"))
    assert str(got.spec().format) == np.dtype(kind).name
    got = stored(tmp_path / f"out.{ending}")
    assert got.shape == want.shape and np.abs(got - want).max() < (3e-3 if kind is np.uint8 else 1e-4)
    untouched = (want == scaled(pixels)).all(-1)
    same = stored(tmp_path / f"out.{ending}", np.dtype(kind).name)[untouched] == pixels[untouched]
    assert same.size > 1000 and same.all()


@pytest.mark.parametrize("kind", ["half", "float"])
def test_linear(run, tmp_path, kind):
    light = colour.decode_srgb(scaled(patches())).astype(np.float32) * 1.5
    write(tmp_path / "in.exr", light, kind)
    assert run(tmp_path / "in.exr", "-o", tmp_path / "out.exr", "--preset", "inter_color") == (0, "")
    read = stored(tmp_path / "in.exr")
    want = library.bake(read, presets.find("inter_color").values, linear=True).texture
    assert np.abs(stored(tmp_path / "out.exr") - want).max() < 1e-3


def test_grey_becomes_colour(run, tmp_path):
    write(tmp_path / "in.png", patches()[..., :1].copy())
    assert run(tmp_path / "in.png", "-o", tmp_path / "out.png")[0] == 0
    grey = np.repeat(scaled(patches()[..., :1]), 3, 2)
    assert np.abs(stored(tmp_path / "out.png") - library.bake(grey).texture).max() < 3e-3


def test_between_kinds(run, tmp_path, png):
    """A PNG of an EXR, and back, show the same colours."""
    write(tmp_path / "a.png", patches(channels=4))
    for name in ("in", "a"):
        assert run(tmp_path / f"{name}.png", "-o", tmp_path / f"{name}.exr", "--set", "line_thickness=0") == (0, "")
        assert run(tmp_path / f"{name}.exr", "-o", tmp_path / f"{name}2.png", "--set", "line_thickness=0") == (0, "")
        assert np.abs(stored(tmp_path / f"{name}2.png") - stored(tmp_path / f"{name}.png")).max() < 4e-3
    assert stored(tmp_path / "a.exr")[0, 16, 2] == pytest.approx(colour.decode_srgb(120 / 255) * 128 / 255, abs=1e-3)


def test_jpeg(run, tmp_path, png):
    assert run(png, "-o", tmp_path / "out.jpg") == (0, "")
    assert np.abs(stored(tmp_path / "out.jpg") - library.bake(scaled(patches())).texture).mean() < 0.02


def test_not_finite(run, tmp_path):
    pixels = scaled(patches())
    pixels[3, 4, 1] = np.nan
    write(tmp_path / "in.exr", pixels, "float")
    status, err = run(tmp_path / "in.exr", "-o", tmp_path / "out.exr")
    assert status == 0 and "1 values were NaN" in err and np.isfinite(stored(tmp_path / "out.exr")).all()


# Tiling, threads, levels


def test_tile(run, tmp_path, png):
    for word, wrap in (("none", (False, False)), ("x", (True, False)), ("y", (False, True)), ("xy", (True, True))):
        assert run(png, "-o", tmp_path / "out.png", "--tile", word)[0] == 0
        want = library.bake(scaled(patches()), wrap=wrap).texture
        assert np.abs(stored(tmp_path / "out.png") - want).max() < 3e-3
    assert run(png, "-o", tmp_path / "default.png")[0] == 0
    assert (tmp_path / "default.png").read_bytes() == (tmp_path / "out.png").read_bytes()


def test_same_bytes_for_any_number_of_threads(run, tmp_path, png):
    for n in (1, 2, 5):
        assert run(png, "-o", tmp_path / f"{n}.png", "--threads", n)[0] == 0
    assert len({(tmp_path / f"{n}.png").read_bytes() for n in (1, 2, 5)}) == 1


def test_levels_are_baked_from_their_own_texels(run, tmp_path, png):
    assert run(png, "-o", tmp_path / "out.png", "--mips", "--set", "line_thickness=3") == (0, "")
    assert sorted(p.name for p in tmp_path.glob("out*")) == ["out.mip1.png", "out.mip2.png", "out.png"]
    half = scaled(patches()).reshape(24, 2, 32, 2, 3)
    half = colour.encode_srgb(colour.decode_srgb(half).mean((1, 3))).astype(np.float32)
    want = library.bake(half, dict(line_thickness=3.0)).texture
    assert np.abs(stored(tmp_path / "out.mip1.png") - want).max() < 3e-3
    assert stored(tmp_path / "out.mip2.png").shape == (12, 16, 3)


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 9])
def test_levels_keep_the_mean(n):
    pixels = np.random.default_rng(n).random((n, 2 * n + 1, 4)).astype(np.float32)
    half = colour.halved(pixels, linear=True)
    assert half.shape == (max(n // 2, 1), n, 4)
    assert half.mean((0, 1)) == pytest.approx(pixels.mean((0, 1)), abs=1e-5)
    ramp = np.linspace(0, 1, n, dtype=np.float32)[:, None, None] + np.zeros((1, 4, 3), np.float32)
    assert (np.diff(colour.halved(ramp, linear=True)[:, 0, 0]) > 0).all()


# Meshes


def obj(path, mesh):
    lines = [f"v {x} {y} {z}" for x, y, z in mesh.points]
    lines += [f"vt {u} {v}" for u, v in mesh.uv.reshape(-1, 2)]
    lines += ["f " + " ".join(f"{p + 1}/{3 * k + c + 1}" for c, p in enumerate(corner))
              for k, corner in enumerate(mesh.corners)]
    path.write_text("\n".join(lines))
    return path


def test_uniform_on_an_obj(run, tmp_path, png):
    mesh = widths.mesh(widths.Sphere(), 24, 12)
    assert run(png, "-o", tmp_path / "out.png", "--uniform", obj(tmp_path / "ball.obj", mesh)) == (0, "")
    want = library.bake(scaled(patches()), form=unwrap.form(mesh, 64, 48), wrap=(True, False)).texture
    assert np.abs(stored(tmp_path / "out.png") - want).max() < 4e-3


@pytest.mark.slow
def test_uniform_on_a_blend(run, tmp_path, png):
    bpy = pytest.importorskip("bpy")
    script = ("import bpy; bpy.ops.wm.read_factory_settings(use_empty=True); bpy.ops.mesh.primitive_cylinder_add(); "
              "bpy.context.object.name = 'A: can'; bpy.context.object.scale = 1, 1, 4; "
              f"bpy.ops.wm.save_as_mainfile(filepath={str(tmp_path / 'can.blend')!r})")
    subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)
    assert bpy
    assert run(png, "-o", tmp_path / "out.png", "--uniform", f"{tmp_path}/can.blend:A: can")[0] == 2  # the last colon
    script = script.replace("A: can", "Can")
    subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)
    assert run(png, "-o", tmp_path / "out.png", "--uniform", f"{tmp_path}/can.blend:Can") == (0, "")
    assert np.abs(stored(tmp_path / "out.png") - library.bake(scaled(patches())).texture).max() > 0.1
    fails(run(png, "-o", tmp_path / "out.png", "--uniform", f"{tmp_path}/can.blend:Cam"), "Cam", "did you mean Can?")


@pytest.mark.parametrize("text, words", [
    ("", "holds no faces"), ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "UV map"),
    ("v 0 0 0\nvt 0 0\nf 1/1 2/1 3/1\n", "UV map"), ("v a b c\n", "UV map"),
    ("v nan 0 0\nvt 0 0\nf 1/1 1/1 1/1\n", "finite"),
    ("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "too large"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1e30 0\nvt 0 1\nf 1/1 2/2 3/3\n", "1000000 times"),
    ("v 1\nvt 0 0\nf 1/1 1/1 1/1\n", "UV map"),
    ("v 0 0 0\nv 1e37 0 0\nv 0 1e37 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "too large"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n", "no area"),
    ("v 0 0 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 1/2 1/3\n", "no area"),
])
def test_refuses_meshes(run, tmp_path, png, text, words):
    (tmp_path / "bad.obj").write_text(text)
    fails(run(png, "-o", tmp_path / "out.png", "--uniform", tmp_path / "bad.obj"), words)
    assert not (tmp_path / "out.png").exists()


# Bad input


def header(path, width, height):
    """A PNG that says so and holds nothing."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", b""))
    return path


@pytest.mark.parametrize("size, words", [((0, 4), "can be read"), ((65536, 65536), "65536 x 65536"),
                                         ((4, 32769), "32768"), ((16, 16), "to its end")])
def test_refuses_sizes(tmp_path, size, words):
    path = header(tmp_path / "in.png", *size)
    done = subprocess.run([sys.executable, "-m", "encre", "bake", str(path), "-o", str(tmp_path / "out.png")],
                          capture_output=True, text=True)
    fails((done.returncode, done.stderr), words)  # nor a word of the image library's
    assert list(tmp_path.iterdir()) == [path]


def test_refuses_what_is_no_image(run, tmp_path):
    (tmp_path / "in.png").write_text("hello")
    fails(run(tmp_path / "in.png", "-o", tmp_path / "out.png"), "in.png", "not an image")
    fails(run(tmp_path, "-o", tmp_path / "out.png"), "there is no such file")
    fails(run(tmp_path / "none.png", "-o", tmp_path / "out.png"), "none.png", "check the path")


def test_refuses_render_passes(run, tmp_path):
    write(tmp_path / "in.exr", np.zeros((4, 4, 7), np.float32), "float")
    fails(run(tmp_path / "in.exr", "-o", tmp_path / "out.exr"), "7", "give a texture")


def test_never_over_the_original(run, tmp_path, png):
    before = png.read_bytes()
    fails(run(png, "-o", png), "is the texture itself")
    (tmp_path / "link.png").symlink_to(png)
    fails(run(png, "-o", tmp_path / "link.png"), "is the texture itself")
    level = tmp_path / "out.mip1.png"
    level.write_bytes(before)
    fails(run(level, "-o", tmp_path / "out.png", "--mips", "--set", "line_thickness=1"), "is the texture itself")
    assert png.read_bytes() == level.read_bytes() == before and not (tmp_path / "out.png").exists()


def test_refuses_outputs_and_options(run, tmp_path, png):
    fails(run(png, "-o", tmp_path / "out.blah"), "out.blah", "can't be written")
    fails(run(png, "-o", tmp_path), str(tmp_path))
    fails(run(write(tmp_path / "a.png", patches(channels=4)), "-o", tmp_path / "a.jpg"), "alpha")
    fails(run(png, "-o", tmp_path / "out.png", "--set", "line_thicknes=1"), "line_thickness")
    fails(run(png, "-o", tmp_path / "out.png", "--uniform", "x.fbx"), "MESH.obj")
    fails(run(png, "-o", tmp_path / "out.png", "--uniform", "none.blend:X"), "none.blend")
    fails(run(png, "-o", tmp_path / "out.png", "--uniform", "none.obj"), "none.obj")
    fails(run(png, "-o", tmp_path / "out.png", "--tile", "z"), "--tile")


def test_a_full_disk_leaves_what_was_there(tmp_path):
    rng = np.random.default_rng(0)
    write(tmp_path / "in.png", rng.integers(0, 255, (256, 256, 3), np.uint8))
    (tmp_path / "out.mip1.png").write_text("old")

    def small():
        resource.setrlimit(resource.RLIMIT_FSIZE, (80_000,) * 2)  # room for the probe and for the second level

    done = subprocess.run([sys.executable, "-m", "encre", "bake", "in.png", "-o", "out.png", "--mips",
                           "--set=line_thickness=0.1"], capture_output=True, text=True, cwd=tmp_path, preexec_fn=small)
    assert done.returncode == 1 and done.stderr.count("encre: error: ") == 1 and "Traceback" not in done.stderr
    assert (tmp_path / "out.mip1.png").read_text() == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["in.png", "out.mip1.png"]


def test_an_interrupt_while_the_library_works():
    """It comes between two calls of the callback, as good as always."""
    pixels = np.random.default_rng(0).random((1500, 1500, 3), np.float32)
    with pytest.raises(KeyboardInterrupt), interrupt.heeded() as progress:
        threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()
        library.bake(pixels, {"line_thickness": 64.0}, threads=1, progress=progress)
    assert signal.getsignal(signal.SIGINT) == signal.default_int_handler
