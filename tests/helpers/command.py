# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `encre` and what it says, as tests of several kinds of its files run it."""

import subprocess
import sys

from encre.pen import layers, library, saved
from encre.pen.settings import Settings, switches

SIZE = 96, 64  # of the picture that the fixture `scene` has
OFF = [f"--set={switch}=off" for switch in switches()]
STYLES = [("Ink", {"line_thickness": 30.0, "use_shading": False})]


def start(*args, **options):
    """A process that runs `encre args`."""
    return subprocess.Popen([sys.executable, "-m", "encre", *map(str, args)], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)


def finish(child):
    """(exit status, stdout, stderr) of a process."""
    out, err = child.communicate(timeout=60)
    return child.returncode, out, err


def fails(result, *words, status=2):
    """The outcome (exit status, stdout, stderr) is one sentence of error that holds all words."""
    code, out, err = result
    assert code == status and out == "" and err.startswith("encre: error: ") and err.count("\n") == 1, err
    for word in words:
        assert word in err, err


def expected(pictures, scene=None, styles=(), camera=None, frame=None, outputs=("Combined",)):
    """What the library makes of passes in memory."""
    settings = Settings(scene, [("", values) for values in styles])
    made, _ = layers.assemble(dict(pictures), settings, saved.unpack(pictures))
    return library.render(made, scene or {}, styles, camera, frame, outputs).images
