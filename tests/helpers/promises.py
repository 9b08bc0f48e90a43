# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges one scene of `judge/kinds.py`, `unseen.py` or `fresh.py`, or of one's own file, in all promises, the pan too.

    .venv/bin/python tests/helpers/promises.py louvres
    .venv/bin/python tests/helpers/promises.py own.py:shelf --still

A scene is a function that takes `shift=(x, y)` in pixels and gives a judge.scene.Scene. --still: the pan alone, which
takes seconds; --shifts: the hairlines at all of kinds.SHIFTS as well; --detector NAME: another than FINE."""

import argparse
import runpy
import sys
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from judge import fresh, kinds, unseen, verdict  # noqa: E402
from pages import drawer  # noqa: E402


def maker(name):
    """The function that draws a scene."""
    file, _, function = name.rpartition(":")
    known = kinds.ANALYTIC | kinds.MESHES | unseen.ANALYTIC | unseen.MESHES | fresh.MESHES
    return runpy.run_path(file)[function] if file else known[name]


def promises(make, detector="FINE", shifts=False, only_still=False):
    """Results of one scene: where it is not moved all of them, else those of hairlines."""
    draw, found = drawer(detector), []
    for k, shift in enumerate(kinds.SHIFTS[:len(kinds.SHIFTS) if shifts else 1] if not only_still else ()):
        found += verdict.judge(draw, {f"shift {k}": make(shift=shift)}, ("blackman",), full=k == 0, moves=False)
    still = verdict.still(draw, "blackman", verdict.panned(make))
    return found + [verdict.Result("pan", promise, value) for promise, value in still.items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--detector", default="FINE")
    parser.add_argument("--shifts", action="store_true")
    parser.add_argument("--still", action="store_true")
    how = parser.parse_args()
    warnings.simplefilter("ignore")
    for result in promises(maker(how.scene), how.detector, how.shifts, how.still):
        broken = "" if verdict.kept(result.promise, result.value) else "  BROKEN"
        print(f"{result.where:28} {result.promise:14} {result.value:.4f} of {result.points}{broken}")


if __name__ == "__main__":
    main()
