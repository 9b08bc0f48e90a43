# SPDX-License-Identifier: GPL-3.0-or-later
"""Our reader of OpenEXR files against OpenImageIO's, and files that are damaged."""

import numpy as np
import OpenImageIO as oiio
import pytest
from encre.cli import multilayer
from encre.pen.errors import EncreError
from encre.pen.exr import Exr


def write(path, specs, pictures):
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), specs if len(specs) > 1 else specs[0]), out.geterror()
    for number, picture in enumerate(pictures):
        assert not number or out.open(str(path), specs[number], "AppendSubimage")
        assert out.write_image(picture), out.geterror()
    assert out.close()


def spec(width, height, names, compression, kinds=(), **more):
    made = oiio.ImageSpec(width, height, len(names), "float")
    made.channelnames, made["compression"] = names, compression
    if kinds:
        made.channelformats = tuple(map(oiio.TypeDesc, kinds))
    made.x, made.y, made.full_x, made.full_y, made.full_width, made.full_height = 7, -3, 2, -5, 90, 80
    for key, value in more.items():
        made[key] = value
    return made


@pytest.mark.parametrize("size", [(1, 1), (33, 47), (5, 16), (64, 17)], ids=str)
@pytest.mark.parametrize("compression", ["none", "zip", "zips"])
@pytest.mark.parametrize("parts", [1, 3])
def test_as_openimageio_reads(tmp_path, size, compression, parts):
    random, path = np.random.default_rng(5), tmp_path / "a.exr"
    names, kinds = ("L.Z.Z", "L.Combined.R", "L.Combined.A", "L.Id.X"), ("float", "half", "float", "half")
    specs = [spec(*size, tuple(f"{k}{name}" for name in names), compression, kinds, **{"oiio:subimagename": str(k)})
             for k in range(parts)]
    specs[0]["encre.frame"] = '{"x": 1}'
    pictures = [np.floor(9 * random.standard_normal((size[1], size[0], 4), np.float32) ** 2) / 4 for _ in specs]
    write(path, specs, pictures)
    mine = Exr(str(path))
    with multilayer.Exr(path) as theirs:
        place = theirs.window
        assert mine.window == (place.width, place.height, place.x, place.y, place.full_width, place.full_height)
        assert set(mine.channels) == set(theirs.channels) and mine.texts == {"encre.frame": '{"x": 1}'}
        whole = theirs.read({name: [name] for name in theirs.channels})
    found = mine.read(mine.channels)
    for name, picture in whole.items():
        assert np.array_equal(found[name], picture[..., 0]), name
    assert mine.read([mine.channels[1]]).keys() == {mine.channels[1]}


def test_whole_numbers(tmp_path):
    """OpenImageIO makes shares of the greatest of them: so their bits are written as a float's."""
    numbers = np.arange(12, dtype=np.uint32).reshape(3, 4, 1)
    write(tmp_path / "a.exr", [spec(4, 3, ("Id.X",), "zip")], [numbers.view(np.float32)])
    data = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "a.exr").write_bytes(data.replace(b"Id.X\0\2", b"Id.X\0\0"))
    assert np.array_equal(Exr(str(tmp_path / "a.exr")).read(["Id.X"])["Id.X"], numbers[..., 0])


def test_views(tmp_path):
    both = spec(4, 3, ("A.Z.left.Z", "A.Z.right.Z"), "zip")
    both.attribute("multiView", oiio.TypeDesc("string[2]"), ("left", "right"))
    write(tmp_path / "one.exr", [both], [np.zeros((3, 4, 2), np.float32)])
    specs = [spec(4, 3, ("A.Z.Z",), "zip", view=view, **{"oiio:subimagename": view}) for view in ("left", "right")]
    write(tmp_path / "two.exr", specs, [np.full((3, 4, 1), k, np.float32) for k in range(2)])
    for name in ("one", "two"):
        found = Exr(str(tmp_path / f"{name}.exr"))
        assert found.views == ["left", "right"] and sorted(found.channels) == ["A.Z.left.Z", "A.Z.right.Z"], name
    assert found.read(found.channels)["A.Z.right.Z"].min() == 1


def test_what_it_does_not_read_is_said(tmp_path):
    path, picture = tmp_path / "a.exr", np.ones((20, 30, 1), np.float32)
    for compression in ("piz", "rle"):
        write(path, [spec(30, 20, ("Z",), compression)], [picture])
        with pytest.raises(EncreError, match=f"{compression.upper()}.*ZIP"):
            Exr(str(path))
    with pytest.raises(EncreError, match="No such file"):
        Exr(str(tmp_path / "none.exr"))


def test_what_is_not_there_is_refused(tmp_path):
    """A channel that no part has, and rows of which the file holds others twice."""
    path, picture = tmp_path / "a.exr", np.random.default_rng(1).random((40, 30, 1), np.float32)
    write(path, [spec(30, 40, ("Z",), "zip")], [picture])
    with pytest.raises(EncreError, match=r"no channel A\.R"):
        Exr(str(path)).read(["Z", "A.R"])
    found = Exr(str(path))
    found._parts[0].chunks[1] = found._parts[0].chunks[0]
    with pytest.raises(EncreError, match="can't be read to its end"):
        found.read(["Z"])


def test_damaged_files_are_refused(tmp_path):
    """Each ends with a sentence, or is read as something."""
    path, random = tmp_path / "a.exr", np.random.default_rng(3)
    write(path, [spec(30, 20, ("A.Z", "B.R"), "zip", ("float", "half"))], [random.random((20, 30, 2), np.float32)])
    whole, refused = path.read_bytes(), 0
    for k in range(400):
        data = bytearray(whole[:random.integers(len(whole))] if k % 3 == 0 else whole)
        for at in random.integers(0, min(len(data), 400) + 1, 3) if k % 3 else ():
            data[min(at, len(data) - 1)] = random.integers(256)
        path.write_bytes(data)
        try:
            found = Exr(str(path))
            assert all(picture.size < 1e7 for picture in found.read(found.channels).values())
        except EncreError:
            refused += 1
    assert 200 < refused < 400
