# SPDX-License-Identifier: GPL-3.0-or-later
"""Random jobs draw the bytes they drew when hashes.txt was written: what changes them is meant to, or was noticed here.

Whether the pictures are right the twins tell; they can't look at every setting together with every other."""

import shutil
import sys

import hashes
import pytest
from encre.pen.library import load

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="the driver of random jobs is built on Linux"),
    pytest.mark.skipif(not shutil.which("clang"), reason="needs the compiler clang, by which the jobs are made"),
]


def test_random_jobs_draw_what_they_drew(tmp_path):
    now, was = hashes.of(hashes.build(load().path, tmp_path / "fuzz")), hashes.kept()
    other = sorted(kind for kind in {**now, **was} if now.get(kind) != was.get(kind))
    assert not other, f"{', '.join(other)}: other bytes than in hashes.txt; where that is meant: make hashes"
