# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blenders at hand, and what they rendered."""

import functools
import importlib.util
import json
import os
import secrets
import shutil
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path

import forks
import numpy as np
import pytest
from encre.cli import multilayer
from encre.pen import layers, metadata

CASES = Path(__file__).parents[1] / "blender" / "inside" / "cases.py"
OTHERS = Path(__file__).parents[2] / "build" / "blenders"  # one environment per version of bpy: make blenders
REFUSED = 75  # how a script of a window ends that Blender lets write no more
NEWEST = "bpy-5.2"  # which needs another Python than the rest


@functools.cache
def commands():
    """{name: command line up to the script's arguments}; "bpy" is the module of the Python that runs the tests."""
    found = {"bpy": [sys.executable, str(CASES)]}
    for python in sorted(OTHERS.glob("bpy-*/bin/python")):
        found[python.parents[1].name] = [str(python), str(CASES)]
    if program := shutil.which("blender"):
        found["blender"] = [program, "-b", "--factory-startup", "-P", str(CASES)]
    return found


@dataclass
class Shot:
    """Pictures that a case rendered and the facts and words that it printed."""

    folder: Path
    output: str
    facts: dict = field(default_factory=dict)

    def passes(self, name, layer="ViewLayer", view=None):
        """{classic pass name: (height, width, channels)} of an EXR."""
        with multilayer.Exr(self.folder / f"{name}.exr") as file:
            wanted = {}
            for channel in file.channels:
                head, *parts = channel.split(".")
                if head == layer and (view is None or view in parts):
                    wanted.setdefault(layers.classic(parts[0]), []).append(channel)
            order = "RGBAXYZ"
            pictures = file.read({n: sorted(c, key=lambda x: order.index(x[-1])) for n, c in wanted.items()})
        return {n: np.ascontiguousarray(p) for n, p in pictures.items()}

    def metadata(self, name):
        with multilayer.Exr(self.folder / f"{name}.exr") as file:
            return file.metadata

    def chains(self, name):
        """Points of chains that an EXR keeps, of its only view."""
        (lines,) = metadata.read(self.metadata(name)).chains.values()
        return lines.points

    def wrote(self, name):
        return (self.folder / f"{name}.exr").exists()


def run(blender, case, folder, environment=None):
    """Runs a case that blender/cases.py knows, with more environment variables if given."""
    done = subprocess.run([*commands()[blender], "--", case, str(folder)], capture_output=True, text=True,
                          timeout=300, errors="replace",
                          stdin=subprocess.DEVNULL, env={**os.environ, **(environment or {})})
    return read(done, folder)


def window(script, name, folder, size, *options, limit=1600, cwd=None, **environment):
    """A Shot of a script that drives a window of `blender` by inside/window.py, which ends by itself on all but the
    busiest machines; skips where there is no window.

    Blender may refuse for good that Python writes (see there): then it is begun anew.
    """
    if not shutil.which("blender") or not shutil.which("xvfb-run"):
        pytest.skip("needs the programs blender and xvfb-run")
    width, height = map(str, size)
    command = ["xvfb-run", "-a", "-s", f"-screen 0 {width}x{height}x24", "blender", "--factory-startup", *options,
               "-p", "0", "0", width, height, "-P", str(script), "--", name, str(folder)]
    for _ in range(3):
        done = _ended(command, limit, cwd=cwd, env={**os.environ, **environment})
        if done.returncode != REFUSED:
            break
    return read(done, folder)


def _ended(command, limit, **options):
    """As subprocess.run() does it. What takes too long ends with all that it has begun: by itself xvfb-run leaves a
    screen behind, and on it a Blender that takes other tests' time."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
                          start_new_session=True, **options) as child:
        try:
            said = child.communicate(timeout=limit)
        except BaseException:
            os.killpg(child.pid, signal.SIGKILL)
            raise
        return subprocess.CompletedProcess(command, child.returncode, *said)


def read(done, folder):
    """What a finished Blender printed and drew."""
    words = done.stdout + done.stderr
    assert done.returncode == 0, words[-4000:]
    return Shot(Path(folder), words, _facts(done.stdout))


def _facts(words):
    facts = {}
    for line in words.splitlines():
        if line.startswith("FACT "):
            name, value = json.loads(line[5:])
            facts.setdefault(name, []).append(value)
    return facts


class Running:
    """A Blender that is started once and runs one case after the other."""

    def __init__(self, blender):
        self._blender, self._child = blender, None

    def run(self, case, folder):
        """Likewise; what a case has replaced in our modules is put back after it."""
        if not self._child:
            self._token = secrets.token_hex(8)
            self._child = subprocess.Popen([*commands()[self._blender], "--", "-", self._token], stdin=subprocess.PIPE,
                                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace",
                                           text=True)
        limit = threading.Timer(300, self._child.kill)
        limit.start()
        said = []
        try:
            self._child.stdin.write(f"{case} {folder}\n")
            self._child.stdin.flush()
            for line in self._child.stdout:
                if line.startswith(f"DONE {self._token}"):
                    break
                said.append(line)
            words = "".join(said)
            assert line == f"DONE {self._token} 1\n", words[-4000:]
        except BaseException:
            self.stop()
            raise
        finally:
            limit.cancel()
        return Shot(Path(folder), words, _facts(words))

    def stop(self):
        if self._child:
            self._child.kill()
            self._child.communicate()
            self._child = None


def encre(blender, folder, *args):
    """The command `encre` with a Blender of commands(); `folder` is for what only this run needs. What is rendered has
    all passes."""
    python, environment = sys.executable, dict(os.environ)
    options = ["--set=save_layers=ON", "--passes=all"] if args[0] == "render" else []
    if blender == "blender":
        options += ["--blender", shutil.which("blender")] if args[0] == "render" else []
    elif blender != "bpy":  # a bpy in another Python: our package by PYTHONPATH, the libraries its own
        python = commands()[blender][0]
        site = Path(folder) / "site"
        site.mkdir(exist_ok=True)
        if not (site / "encre").exists():
            (site / "encre").symlink_to(Path(layers.__file__).parents[1])
        environment["PYTHONPATH"] = str(site)
    if blender == "bpy" and forks.POSSIBLE:
        done = forks.run([*args, *options])
    else:
        done = subprocess.run([python, "-m", "encre", *map(str, args), *options], capture_output=True, text=True,
                              timeout=600, env=environment, stdin=subprocess.DEVNULL)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stderr


def params():
    """The test's own bpy is part of every run, other Blenders of the long one; without bpy, the program."""
    names = list(commands())
    if not importlib.util.find_spec("bpy"):
        names.remove("bpy")
    params = [name if k == 0 else pytest.param(name, marks=pytest.mark.long) for k, name in enumerate(names)]
    if OTHERS.is_dir() and NEWEST not in names:  # the others were made
        missing = pytest.mark.skip("needs python3.13: make blenders")
        params.append(pytest.param(NEWEST, marks=[pytest.mark.long, missing]))
    return params
