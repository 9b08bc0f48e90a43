# SPDX-License-Identifier: GPL-3.0-or-later
"""The library built a second time, without vectorisation and for one instruction set: quick to build anew where a file
has changed, the same results, and linked so that tests see between the passes of FINE."""

import os
import runpy
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "scalar"
PASSES = ("light_even", "seen_run", "fine_drop_weak", "fine_drop_crumbs", "fine_link", "thin_tie", "fine_smooth",
          "fine_crowd", "fine_drop_beside", "fine_cut_spurs", "fine_add_links")  # that probe_fine.c looks at


def _commands(out):
    here = os.getcwd()
    os.chdir(ROOT)  # the commands name their files from here
    try:
        return runpy.run_path("setup.py", run_name="tests")["commands"](out, BUILD, scalar=True)
    finally:
        os.chdir(here)


def _run(command):
    subprocess.run(command, cwd=ROOT, check=True)


def objects(out):
    """Compiles what has changed; the command that links the library `out`."""
    BUILD.mkdir(parents=True, exist_ok=True)
    compile_, link = _commands(out)
    headers = max(p.stat().st_mtime_ns for p in (ROOT / "csrc").rglob("*.h"))

    def old(command):
        source, made = ROOT / command[command.index("-c") + 1], Path(command[-1])
        return not made.exists() or made.stat().st_mtime_ns <= max(source.stat().st_mtime_ns, headers)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(_run, filter(old, compile_)))
    return link, compile_


def probe_fine(name="probe_fine"):
    """Path of the library with probe_fine.c between the passes."""
    out = BUILD / f"{name}.so"
    source = ROOT / "tests" / "helpers" / "probe_fine.c"
    link, compile_ = objects(out)
    made = BUILD / "probe_fine.o"
    if not made.exists() or made.stat().st_mtime_ns <= max(p.stat().st_mtime_ns for p in
                                                           (source, *(ROOT / "csrc").rglob("*.h"))):
        own = list(compile_[0])
        own[own.index("-c") + 1], own[-1] = str(source), str(made)
        _run(own)
    wraps = [f"-Wl,--wrap={name}_base" for name in PASSES]
    _run([*link[:link.index("-o")], str(made), *wraps, *link[link.index("-o"):]])
    return out
