# SPDX-License-Identifier: GPL-3.0-or-later
"""A failed test of pictures leaves them, and says where they differ."""

import failed
import numpy as np
import OpenImageIO as oiio
import pytest


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    monkeypatch.setattr(failed, "FOLDER", tmp_path / "build" / "failed")
    return failed.FOLDER


def read(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)


def test_two_pictures_and_their_difference(place):
    got = np.full((20, 30, 4), 0.25, np.float32)
    got[..., 3] = 1
    want = got.copy()
    want[12, 7, 1] = 0.75
    words = failed.leave("tests/a.py::test_b[x/y]", dict(got=got, n=3, want=want, few=got[:4], name="Combined"))
    assert words.splitlines() == ["pictures: build/failed/tests-a.py-test_b-x-y-",
                                  "got and want differ in 1 of 600 pixels, at most by 0.5, in row 12, column 7"]
    folder = place / "tests-a.py-test_b-x-y-"
    assert sorted(path.name for path in folder.iterdir()) == ["got - want.png", "got.png", "want.png"]
    assert read(folder / "want.png")[12, 7, 1] == pytest.approx(0.75, abs=0.01)
    off = read(folder / "got - want.png")
    assert off[12, 7, 0] == 1 and off.sum() == 1


def test_pictures_of_two_dictionaries_go_by_their_keys(place):
    one = {"Combined": np.zeros((9, 9, 4)), "Encre Lines": np.ones((9, 9, 4)), "unsure": np.zeros((9, 9), bool)}
    other = {"Combined": np.ones((9, 9, 4)), "Encre Lines": np.ones((9, 9, 4))}
    words = failed.leave("test", dict(got=one, want=other))
    assert "got Combined and want Combined differ in 81 of 81" in words
    assert "got Encre Lines and want Encre Lines differ in 0 of 81" in words
    assert (place / "test" / "got Combined - want Combined.png").exists()
    assert (place / "test" / "got unsure.png").exists()


def test_where_nothing_was_compared_nothing_is_said(place):
    assert failed.leave("test", dict(n=1, table=np.zeros((3, 500)), names={"a": 1})) == "" and not place.exists()
