# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of `encre composite` begin with."""

import command
import drawn
import pytest
from cube import CUBE
from encre.cli import main


@pytest.fixture(scope="session")
def scene():
    """Layers of a small picture, the lower half in another style."""
    made = drawn.scene(*command.SIZE)
    made["style"][command.SIZE[1] // 2:] = 1
    return made


@pytest.fixture
def run(capsys):
    def run(*args, denoise=False):
        """(exit status, stdout, stderr) of `encre args`, without the denoiser that a Blender brings, unless asked."""
        plain = ["--set=light_denoise=NONE"] if args[:1] == ("composite",) and len(args) > 2 and not denoise else []
        try:
            status = main.main([str(arg) for arg in (*args, *plain)])
        except SystemExit as end:
            status = end.code
        return status, *capsys.readouterr()
    return run


@pytest.fixture
def cube(tmp_path):
    """The file of a scene."""
    (tmp_path / "cube.py").write_text(CUBE)
    return tmp_path / "cube.py"
