# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that harm whoever opens them: modules beside pictures, pipes, and what is small until it is opened."""

import os
import struct
import tempfile
from pathlib import Path

import exr
import numpy as np
import pytest
from command import OFF, fails, finish, start
from encre.cli import room
from encre.pen import metadata, plain, unwrap
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame

MODULES = "OpenImageIO", "numpy", "json", "hashlib", "signal"


def test_no_module_comes_from_the_current_folder(tmp_path, scene):
    for name in MODULES:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\nraise SystemExit(3)\n")
    for frame in (1, 2):
        exr.write(tmp_path / f"in.{frame}.exr", exr.passes(scene))
    child = start("composite", "in.#.exr", "-o", "o.#.png", "--jobs", "2", *OFF, cwd=tmp_path)
    code, _, err = finish(child)
    assert code == 0 and not (tmp_path / "ran").exists(), err
    assert (tmp_path / "o.1.png").exists() and (tmp_path / "o.2.png").exists()


OWN_SECRETS = """import os
randbits = lambda bits: int.from_bytes(os.urandom(bits // 8), "big")
token_hex = lambda n: os.urandom(n).hex()
"""


@pytest.mark.parametrize(("name", "content", "code", "words"), [
    ("OpenImageIO", "", 2, "the Python module OpenImageIO is "),
    ("numpy", "", 2, "takes the place of the module numpy"),
    ("secrets", OWN_SECRETS, 0, "takes the place of the module secrets")])
def test_modules_that_pythonpath_puts_in_place_of_others_are_named(tmp_path, scene, name, content, code, words):
    (tmp_path / "more").mkdir()
    (tmp_path / "more" / f"{name}.py").write_text(content)
    exr.write(tmp_path / "in.exr", exr.passes(scene))
    done, _, err = finish(start("composite", tmp_path / "in.exr", "-o", tmp_path / "o.png", *OFF,
                                env={**os.environ, "PYTHONPATH": str(tmp_path / "more")}))
    assert done == code and "Traceback" not in err, err
    assert words in err and f"{name}.py" in err and "PYTHONPATH" in err, err


def test_only_plain_files_are_opened(run, tmp_path, scene):
    """A pipe that a file names would be waited for without end."""
    os.mkfifo(tmp_path / "paper.png")
    named = metadata.write({"paper_source": "IMAGE", "paper_image": "paper.png"}, [], Camera(), Frame(96, 64))
    exr.write(tmp_path / "in.exr", exr.passes(scene), metadata=named)
    fails(finish(start("composite", tmp_path / "in.exr", "-o", tmp_path / "o.png", "--resume")), "paper.png",
          "no plain file")
    os.mkfifo(tmp_path / "mesh.obj")
    exr.image(tmp_path / "wood.png")
    fails(finish(start("bake", tmp_path / "wood.png", "-o", tmp_path / "o.png", "--uniform", tmp_path / "mesh.obj")),
          "mesh.obj", "no plain file")
    os.mkfifo(tmp_path / "own.json")
    fails(run("composite", tmp_path / "in.exr", "-o", tmp_path / "o.png", "--preset", tmp_path / "own.json"),
          "own.json", "no plain file")
    with pytest.raises(OSError, match="no plain file"):
        plain.opened("/dev/zero")
    with pytest.raises(OSError, match="folder"):
        plain.content(tmp_path)


def larger(path, width, height):
    """Has an EXR say that it is larger, and hold as many bytes of nothing as it takes to be believed."""
    data = path.read_bytes()
    for name in b"dataWindow", b"displayWindow":
        at = data.index(name + b"\0box2i\0") + len(name) + 7 + 4
        data = data[:at] + struct.pack("<4i", 0, 0, width - 1, height - 1) + data[at + 16:]
    path.write_bytes(data)
    os.truncate(path, 1 << 28)


@pytest.mark.skipif(not Path("/dev/shm").is_dir(), reason="needs a file system of a known small size")
def test_what_needs_more_room_than_there_is_is_refused_before_work(tmp_path, scene):
    exr.write(tmp_path / "in.exr", {"Combined": scene["combined"][..., :3]}, half=True)
    larger(tmp_path / "in.exr", 40000, 40000)
    with tempfile.TemporaryDirectory(dir="/dev/shm") as folder:
        child = start("composite", tmp_path / "in.exr", "-o", tmp_path / "o.png", env={**os.environ, "TMPDIR": folder})
        fails(finish(child), "in.exr: needs 134.4 GB when it is unpacked", "GB of memory", "make room")
        assert not (tmp_path / "o.png").exists() and not os.listdir(folder)


def test_what_there_is_room_for():
    room.afford("small.exr", 1 << 20)
    assert room.free_memory() > 1 << 20
    with pytest.raises(EncreError, match=r"^large.png: needs 1000000.0 GB when it is unpacked, and there are "):
        room.afford("large.png", 10 ** 15)


def repeated(path, corners):
    """An OBJ of triangles (n, 3, 2) of UV."""
    rows = ["v 0 0 0", "v 1 0 0", "v 0 1 0", *(f"vt {u} {v}" for u, v in np.reshape(corners, (-1, 2)))]
    rows += [f"f 1/{3 * k + 1} 2/{3 * k + 2} 3/{3 * k + 3}" for k in range(len(corners))]
    path.write_text("\n".join(rows))
    return unwrap.read_obj(path)


def test_what_a_triangle_hides_is_not_drawn(tmp_path):
    """Minutes before, for each of the triangles lay on the texture two thousand times."""
    mesh = repeated(tmp_path / "bomb.obj", [[(0, 0), (64, 0), (0, 64)]] * 200)
    assert os.path.getsize(tmp_path / "bomb.obj") < 20000
    first = repeated(tmp_path / "one.obj", [[(0, 0), (64, 0), (0, 64)]])
    assert np.array_equal(unwrap.form(mesh, 96, 64), unwrap.form(first, 96, 64))
    thin = repeated(tmp_path / "thin.obj", [[(0, 0), (64, 63.5), (64, 64)]] * 200)
    with pytest.raises(EncreError, match="lays triangles more than .* times over the whole texture; unwrap"):
        unwrap.form(thin, 4096, 4096)
