# SPDX-License-Identifier: GPL-3.0-or-later
"""Random jobs under sanitizers: tests/fuzz/ makes them, each from a seed, with every pair of parameters.

ENCRE_FUZZ_SECONDS says how long in all; memory that is not set and races between threads are looked for where that is a
minute or more, for each of the two takes a build of its own. A failure names the seed, and `fuzz SEED 1 60 1` runs that
job alone.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SECONDS = float(os.environ.get("ENCRE_FUZZ_SECONDS", 5))
SHARE = {"address,undefined,float-cast-overflow": 4 / 6, "memory": 1 / 6, "thread": 1 / 6}
SOON = "-O0" if SECONDS < 60 else "-O1"  # in a third of the time, for a few seconds of jobs
PLAIN = ["-std=c11", "-D_POSIX_C_SOURCE=200809L", SOON, "-g1", f"-I{ROOT / 'csrc'}"]
# The address sanitizer stops at a null pointer and beyond an object too: these two only take time to compile.
OFF = "-fno-sanitize=null,object-size"

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="needs the sanitizers of Linux"),
    pytest.mark.skipif(not shutil.which("clang"), reason="needs the compiler clang, whose sanitizers find most"),
]


def run(*command, **options):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stderr[-4000:]


@pytest.fixture(scope="module", params=[
    pytest.param(kind, marks=pytest.mark.slow if "address" in kind or SECONDS >= 60 else pytest.mark.long)
    for kind in SHARE])
def fuzz(request, tmp_path_factory):
    """(command that runs jobs, share of the time). The arena is guarded, the invariants of FINE are checked."""
    kind, out = request.param, tmp_path_factory.mktemp("fuzz")
    built = ROOT / "build" / "fuzz" / kind / SOON  # what has not changed is not compiled again
    flags = f"{os.environ.get('CFLAGS', '')} -g1 {SOON} {OFF}"
    run(sys.executable, "setup.py", "-q", "build_ext", "--werror", "--scalar", "--debug", f"--sanitize={kind}",
        f"--build-lib={out}", f"--build-temp={built}", cwd=ROOT, env={**os.environ, "CC": "clang", "CFLAGS": flags})
    sanitize = [f"-fsanitize={kind}", "-fno-sanitize-recover=all", OFF]
    # The jobs are watched as well: one that is made of what lies beside its tables is none that a seed tells.
    run("clang", *PLAIN, *sanitize, "-c", *ROOT.glob("tests/fuzz/*.c"), cwd=out)
    run("clang", *sanitize, *out.glob("*.o"), out / "encre" / "libencre.so", f"-Wl,-rpath,{out / 'encre'}", "-lm", "-o",
        out / "fuzz")
    return out / "fuzz", SHARE[kind]


def drive(command, first, seconds):
    """As many processes as processors, each with every so many-th seed."""
    n = len(os.sched_getaffinity(0))
    every = [subprocess.Popen([command, str(first + k), str(n), str(seconds)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) for k in range(n)]
    for process in every:
        out, error = process.communicate()
        assert process.returncode == 0, error[:4000] + error[-400:]
        print(out, end="")
        assert int(out.split()[0]) >= 8


def test_random_jobs(fuzz):
    command, share = fuzz
    drive(command, 0, share * SECONDS)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_many_random_jobs(fuzz):
    """Others than those above."""
    command, share = fuzz
    drive(command, 1_000_000, share * 600)


GAP = """#include "base/arena.h"
#include <stdlib.h>
int main(int n, char **arguments)
{
	arena a = {0};
	arena_take(&a, 5, 1);
	arena_take(&a, 100, 1);
	a = (arena){.base = malloc(a.used)};
	char *one = arena_take(&a, 5, 1), *two = arena_take(&a, 100, 1);
	late *all = NULL;
	char *three = late_take(&all, 7, 1), *at[] = {one, two, three};
	at[atoi(arguments[1])][atoi(arguments[2])] = (char)n;
	late_free(all);
	free(a.base);
}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_nobody_touches_what_lies_between_blocks(tmp_path, compiler):
    if not shutil.which(compiler):
        pytest.skip(f"needs the compiler {compiler}")
    (tmp_path / "gap.c").write_text(GAP, encoding="utf-8")
    run(compiler, *PLAIN, "-fsanitize=address", tmp_path / "gap.c", ROOT / "csrc" / "base" / "arena.c", "-o",
        tmp_path / "gap")
    for block, size in enumerate((5, 100, 7)):
        for at, inside in ((0, True), (size - 1, True), (-1, False), (size, False), (size + 40, False)):
            done = subprocess.run([tmp_path / "gap", str(block), str(at)], capture_output=True, text=True)
            assert (done.returncode == 0) == inside and ("use-after-poison" in done.stderr) == (not inside)
