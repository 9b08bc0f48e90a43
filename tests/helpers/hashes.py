# SPDX-License-Identifier: GPL-3.0-or-later
"""What random jobs draw, as a sum of hashes by kind: make hashes writes it into hashes.txt.

The jobs are those of tests/fuzz, from the same seeds on every machine. A change that is to leave the pictures as they
are leaves hashes.txt as it is; one that is not shows there which kinds it concerns."""

import os
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = Path(__file__).with_name("hashes.txt")
JOBS, LONGEST = 1500, 500  # and seconds, of which a fiftieth is usual


def build(library, out):
    """The driver, linked with `library`, a path. By clang: who makes jobs calls one function twice in an argument list,
    and compilers differ in which comes first."""
    sources = sorted(map(str, ROOT.glob("tests/fuzz/*.c")))
    subprocess.run(["clang", "-std=c11", "-D_POSIX_C_SOURCE=200809L", "-O1", "-ffp-contract=off", f"-I{ROOT / 'csrc'}",
                    *sources, library, f"-Wl,-rpath,{Path(library).resolve().parent}", "-lm", "-o", out], check=True)
    return out


def of(driver):
    """{kind: sum of hashes}, over JOBS jobs in as many processes as there are processors."""
    n = len(os.sched_getaffinity(0))
    every = [subprocess.Popen([driver, str(k), str(n), str(LONGEST), str(len(range(k, JOBS, n)))],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for k in range(n)]
    sums, done = Counter(), 0
    for process in every:
        out, error = process.communicate()
        if process.returncode:
            raise RuntimeError(error[-400:])
        first, *lines = out.splitlines()
        done += int(first.split()[0])
        for line in lines:
            kind, _, number = line.rpartition(" ")
            sums[kind] += int(number, 16)
    if done != JOBS:
        raise RuntimeError(f"{done} of {JOBS} jobs in {LONGEST} s")
    return {kind: f"{number % 2**64:016x}" for kind, number in sums.items()}


def kept():
    return dict(line.split() for line in KEPT.read_text(encoding="utf-8").splitlines())


if __name__ == "__main__":
    from encre.pen import library
    with tempfile.TemporaryDirectory() as folder:
        now = of(build(library.load().path, Path(folder) / "fuzz"))
    KEPT.write_text("".join(f"{kind} {number}\n" for kind, number in sorted(now.items())), encoding="utf-8")
