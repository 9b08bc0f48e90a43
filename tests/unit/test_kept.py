# SPDX-License-Identifier: GPL-3.0-or-later
"""What twins have found is kept as long as all that it follows from is the same."""

import kept
import numpy as np
import pytest

asked = []


def twin(table, more=1):
    """Takes longer than what is not kept."""
    asked.append(more)
    assert more != 13
    return {"sum": table + more, "names": ["a", "b"]}


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """Sources of twins that may change, and a folder of results."""
    (tmp_path / "reference").mkdir()
    (tmp_path / "reference" / "one.py").write_text("ONE = 1\n")
    (tmp_path / "twin.py").write_text("")
    asked.clear()
    for name, value in dict(TESTS=tmp_path, FOLDER=tmp_path / "kept", LEAST=-1).items():
        monkeypatch.setattr(kept, name, value)
    twin.__code__ = twin.__code__.replace(co_filename=str(tmp_path / "twin.py"))
    kept._folder.cache_clear()
    yield tmp_path
    kept._folder.cache_clear()


def anew():
    """As another run would see it."""
    kept._folder.cache_clear()


def test_a_twin_is_asked_once_of_the_same_and_again_of_anything_else():
    table = np.arange(6.0)
    for given, by in ((table, ()), (table.copy(), ()), (table, "other"), (table + 1, ()),
                      (table.astype(np.float32), ()), (table.reshape(2, 3), ())):
        found = kept.of(twin, given, by=by)
        assert np.array_equal(found["sum"], given + 1) and found["sum"].dtype == given.dtype
        anew()
    assert len(asked) == 5  # the second is the first
    assert kept.kept(twin)(table, more=2)["sum"][0] == 2 and kept.of(twin, table, more=2)["names"] == ["a", "b"]
    assert len(asked) == 6


@pytest.mark.parametrize("name", ["reference/one.py", "reference/two.py", "twin.py"])
def test_a_twin_is_asked_again_where_a_line_of_it_has_changed(place, name):
    for text in ("ONE = 2\n", "ONE = 3\n", "ONE = 2\n"):
        (place / name).write_text(text)
        anew()
        kept.of(twin, 1)
    assert len(asked) == 2  # what was before is there still
    for k in range(9):
        (place / name).write_text(f"ONE = {10 + k}\n")
        anew()
        kept.of(twin, 1)
    assert len(list((place / "kept").iterdir())) == kept.STAYING


def test_what_fails_or_is_broken_is_not_kept(place):
    for _ in range(2):
        with pytest.raises(AssertionError):
            kept.of(twin, 0, 13)
    assert kept.of(twin, 0)["sum"] == 1
    [path] = (place / "kept").rglob("*-*/*")
    path.write_bytes(path.read_bytes()[:-3])
    assert kept.of(twin, 0)["sum"] == 1 and len(asked) == 4


def test_what_a_function_does_is_no_part_of_a_key():
    with pytest.raises(TypeError, match="twin is named by the key"):
        kept.of(twin, twin)
