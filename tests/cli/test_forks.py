# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands that tests fork are those that a shell starts: the same status, words, folder and environment."""

import os
import subprocess
import sys

import forks
import pytest

pytestmark = pytest.mark.skipif(not forks.POSSIBLE, reason="needs Linux, and Blender's Python module")


@pytest.mark.parametrize("arguments", [["params", "line_thickness"], ["params", "nothing"], ["--help"], ["render"],
                                       ["composite", "missing.exr", "-o", "out.png"]])
def test_a_fork_is_a_process_like_any_other(tmp_path, arguments):
    env = {**os.environ, "COLUMNS": "77"}
    (tmp_path / "inner").mkdir()
    for cwd in tmp_path, tmp_path / "inner":
        done = subprocess.run([sys.executable, "-m", "encre", *arguments], capture_output=True, text=True, cwd=cwd,
                              env=env)
        fork = forks.run(arguments, cwd=cwd, env=env)
        assert (fork.returncode, fork.stdout) == (done.returncode, done.stdout)
        assert fork.stderr == done.stderr


def test_a_fork_that_hangs_is_begun_anew(tmp_path, monkeypatch, capfd):
    assert forks.run(["params"]).returncode == 0
    monkeypatch.setattr(forks, "LIMIT", 0.001)
    done = forks.run(["presets"])
    assert done.returncode == 0 and "Ink only" in done.stdout
    assert "begun anew" in capfd.readouterr().err
    monkeypatch.undo()
    assert forks.run(["params"]).returncode == 0
