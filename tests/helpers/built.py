# SPDX-License-Identifier: GPL-3.0-or-later
"""The library built a second time, without vectorisation and for one instruction set: quick to build anew where a file
has changed, the same results, and linked as tests need it: so that they see between the passes of FINE, say. As a
script it builds what most need."""

import contextlib
import fcntl
import functools
import os
import re
import runpy
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = ROOT / "build" / "scalar"


def _commands(out):
    here = os.getcwd()
    os.chdir(ROOT)  # the commands name their files from here
    try:
        return runpy.run_path("setup.py", run_name="tests")["commands"](out, BUILD, scalar=True, werror=True)
    finally:
        os.chdir(here)


def _run(command):
    subprocess.run(command, cwd=ROOT, check=True)


def _included(path):
    text = path.read_text(encoding="utf-8")
    return [ROOT / "csrc" / name for name in re.findall(r'^#include "([^"]+)"', text, re.MULTILINE)]


def read(*sources, included=_included):
    """The sources and all that they include."""
    found, open_ = set(), list(sources)
    while open_:
        path = open_.pop()
        if path not in found:
            found.add(path)
            open_ += included(path)
    return found


def _old(made, *sources, included=_included):
    """Whether one of the sources, or of what they include, is as new as what was made of them."""
    return not made.exists() or made.stat().st_mtime_ns <= max(p.stat().st_mtime_ns
                                                               for p in read(*sources, included=included))


def objects(out):
    """Compiles what has changed; the command that links the library `out`."""
    BUILD.mkdir(parents=True, exist_ok=True)
    compile_, link = _commands(out)
    included = functools.cache(_included)

    def old(command):
        return _old(Path(command[-1]), ROOT / command[command.index("-c") + 1], included=included)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(_run, filter(old, compile_)))
    return link, compile_


def library(out, *more):
    """Links the library `out`; more: what else the linker gets."""
    with _alone():
        _run([*objects(out)[0], *more])
    return out


def changed(out, source, old, new):
    """Builds the library `out` with the text `old` of the file `source` replaced."""
    with _alone():
        link, compile_ = objects(out)
        text = (ROOT / source).read_text(encoding="utf-8")
        assert text.count(old) == 1
        other, made = out.with_name(Path(source).name), out.with_suffix(".o")
        other.write_text(text.replace(old, new), encoding="utf-8")
        [own] = [list(command) for command in compile_ if command[command.index("-c") + 1] == source]
        replaced = own[-1]
        own[own.index("-c") + 1], own[-1] = str(other), str(made)
        _run(own)
        _run([str(made) if part == replaced else part for part in link])
    return out


@contextlib.contextmanager
def _alone():
    BUILD.mkdir(parents=True, exist_ok=True)
    with open(BUILD / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests run beside each other
        yield


def probe_fine(name="probe_fine"):
    """Path of the library with probe_fine.c in place of FINE's table of passes."""
    with _alone():
        return _probe_fine(BUILD / f"{name}.so")


def _probe_fine(out):
    source, made = HERE / "probe_fine.c", BUILD / "probe_fine.o"
    link, compile_ = objects(out)
    if _old(made, source, ROOT / "csrc" / "fine" / "fine.c"):
        own = list(compile_[0])
        own[own.index("-c") + 1], own[-1] = str(source), str(made)
        _run(own)
    replaced = str(BUILD / "fine-base.o")
    assert link.count(replaced) == 1
    link = [*(str(made) if part == replaced else part for part in link), "-Wl,--wrap=fine_add_links_base"]
    if not out.exists() or out.stat().st_mtime_ns <= max(os.stat(p).st_mtime_ns for p in link if p.endswith(".o")):
        _run(link)
    return out


if __name__ == "__main__":  # before the tests, of which each would wait for it
    probe_fine()
