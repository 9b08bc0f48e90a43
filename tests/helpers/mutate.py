# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes constants of csrc, one at a time, and looks whether a test notices: make mutate.

    python tests/helpers/mutate.py [--seed N] [--count N] [--only FILE[:LINE]]... [--all] [--floats] [--part K/N]
    python tests/helpers/mutate.py --python

In a copy of the tree a float grows or shrinks by a fifth and a whole number by one. One library is built with all
changes in it, each behind a switch (`mutant_now == 7 ? 1.2f : 1.0f`), and the nearest tests of `make test` run once for
each, the likeliest to notice first. What survives is listed in mutants.txt with the reason why no test can tell, or
wants a test. Constants are drawn from all files, those of FINE twice as likely."""

import argparse
import random
import sys
import tempfile
from pathlib import Path

import mutants
from mutant_tree import Copy, copy

HERE = Path(__file__).resolve()


RASTER = "stages/test_raster.py stages/test_raster_input.py stages/test_raster_watertight.py"

# The nearest tests of a file or folder: the first that fits; one after another, the likeliest to notice first.
TESTS = (
    ("csrc/fine/find/", "fine/test_fine_sites.py", "fine/test_fine_ink.py"),
    ("csrc/fine/gather.c", "fine/test_bound.py", "fine/test_fine_sites.py", "fine/test_fine_passes.py"),
    ("csrc/fine/sites.c", "fine/test_fine_sites.py", "fine/test_bound.py", "fine/test_fine_passes.py"),
    ("csrc/fine/near.h", "fine/test_fine_passes.py", "fine/test_bound.py", "fine/test_fine_sites.py"),
    ("csrc/fine/fine.", "fine/test_fine_sites.py", "fine/test_bound.py", "fine/test_fine_passes.py"),
    ("csrc/fine/", "fine/test_fine_passes.py", "fine/test_fine_sites.py", "fine/test_fine_ink.py",
     "fine/test_collars.py"),
    ("csrc/edges/", "stages/test_edges.py", "fine/test_fine_sites.py"),
    *((f"csrc/ink/{name}.", "fine/test_fine_ink.py", "fine/test_fine.py -k 'not calm and not still'")
      for name in ("capsules", "doubled", "hands", "kinds", "matters", "noise", "pen", "reached", "thickets", "tips",
                   "turns", "widths")),
    ("csrc/ink/nearest.c", "stages/test_lines.py -k 'nearest or sizes'", "stages/test_surface.py -k smudg",
     "fine/test_fine_ink.py"),
    ("csrc/ink/", "stages/test_lines.py", "fine/test_fine_ink.py"),
    ("csrc/surface/paper", "stages/test_paper.py", "stages/test_surface.py"),
    *((f"csrc/surface/{name}", f"stages/test_{test}.py")
      for name, test in (("ball", "example"), ("example", "example"), ("rim", "rim"), ("specks", "specks"),
                         ("wash", "wash"), ("tent", "wash"), ("solid", "wash"))),
    ("csrc/paint/", "stages/test_gouache.py"),
    ("csrc/surface/", "stages/test_surface.py", "stages/test_paper.py"),
    *((f"csrc/tones/{name}.", "stages/test_strokes.py -k 'not ink'", "stages/test_strokes.py -k ink",
       "stages/test_tones.py") for name in ("scatter", "seams", "strokes", "ways")),
    ("csrc/tones/", "stages/test_tones.py -k twin", "stages/test_tones.py -k 'not twin and not ink'",
     "stages/test_tones.py -k 'ink and not twin'", "stages/test_strokes.py"),
    ("csrc/chains/bevel", "fine/test_bevels.py"),
    ("csrc/raster/meets", "fine/test_meets.py", "fine/test_creases.py"),
    ("csrc/raster/pieces", "fine/test_meets.py", "fine/test_creases.py"),
    ("csrc/raster/geometry", RASTER, "unit/test_limits.py", "fine/test_creases.py"),
    ("csrc/raster/", RASTER, "fine/test_creases.py", "fine/test_marks.py", "fine/test_meets.py"),
    ("csrc/texture/", "stages/test_bake.py -k 'not size4'"),
    ("csrc/base/bands.", "stages/test_raster_input.py", "unit/test_memory.py", "stages/test_edges.py -k sizes"),
    ("csrc/base/metric.", "unit/test_metric.py", "stages/test_edges.py"),
    ("csrc/base/pixel.h", "unit/test_metric.py", "stages/test_surface.py"),
    ("csrc/base/layers", "unit/test_limits.py", "unit/test_layers.py unit/test_house.py"),
    ("csrc/base/params", "unit/test_layers.py unit/test_house.py", "stages/test_surface.py"),
    ("csrc/light/", "stages/test_shadows.py", "stages/test_light.py", "stages/test_light_edges.py"),
    ("csrc/material/", "stages/test_material.py"),
    ("csrc/api/check", "unit/test_boundary.py unit/test_limits.py unit/test_program_limits.py",
     "stages/test_light_refused.py"),
    ("csrc/api/images", "unit/test_boundary.py unit/test_limits.py"),
    ("csrc/api/background", "unit/test_background.py"),
    ("csrc/api/encre", "unit/test_limits.py", "unit/test_memory.py", "unit/test_layers.py"),
    ("csrc/", "unit/test_layers.py", "unit/test_memory.py", "stages/test_edges.py -k sizes", "stages/test_surface.py"),
)

# What all of them let pass is driven at random: other bytes than before, and, under sanitizers, reads and writes beyond
# what there is.
RANDOM = "unit/test_hashes.py", "unit/test_fuzz.py -m 'not long' -k test_random_jobs"

TWINS = ("csrc/fine/", "csrc/edges/")  # their tests ask twins that take their time


# Lines of Python that once could go wrong unseen: what stands there, what it becomes, who should notice.
PYTHON = (
    ("addon/blender/subframes.py", "_SEED_STEP = 1013904223", "_SEED_STEP = 0", "blender/test_supersample.py -k noise"),
    ("addon/pen/colour.py", "< 1 / 128", "< 0", "unit/test_colour.py"),
    ("addon/blender/meshes.py", "if instance.is_instance and not group:", "if instance.is_instance:",
     "blender/test_details.py"),
    ("addon/blender/frame.py", 'render.threads if render.threads_mode == "FIXED" else 0', "0",
     "blender/test_details.py"),
    ("addon/pen/params.py", "return not true(term[1:])", "return true(term[1:])", "blender/test_details.py"),
    ("addon/blender/panels/meter.py", 'bl_options = {"REGISTER", "UNDO"}', 'bl_options = {"REGISTER"}',
     "blender/test_details.py"),
    ("addon/pen/unwrap.py", "weight = np.repeat(area, 3)", "weight = np.ones(3 * len(area))",
     "unit/test_unwrap.py -k corner"),
    ("addon/blender/painting.py", "if value else _GREY", "", "blender/test_paint.py"),
)


def tests_of(path):
    return *next(tests for prefix, *tests in TESTS if path.startswith(prefix)), *RANDOM


def python(root):
    alive = 0
    with tempfile.TemporaryDirectory(prefix="encre-mutate-") as folder:
        tree = Path(folder).resolve()
        copy(root, tree)
        own = Copy(tree)
        own.warm(False)
        for change in PYTHON:
            by = own.run_python(change)
            alive += by is None
            word = "noticed " if by else "SURVIVES"
            print(f"{word}  {change[0]}: {change[1]} -> {change[2] or 'nothing'}", flush=True)
    return 1 if alive else 0


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=None, help="of the sample; another each time")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--only", action="append", help="files whose name begins so, as csrc/fine/find, or FILE:LINE")
    parser.add_argument("--python", action="store_true", help="the lines of PYTHON, not constants of C")
    parser.add_argument("--all", action="store_true", help="every change of every constant")
    parser.add_argument("--floats", action="store_true", help="no whole numbers")
    parser.add_argument("--part", default="1/1", help="of the sample, by files: 2/3 is the second of three")
    args = parser.parse_args(arguments)
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(10**6)
    root = HERE.parents[2]
    if args.python:
        return python(root)
    only = tuple(args.only or ("",))
    every = {path: [m for m in found if ("." in m.old + m.new or not args.floats)
                    and (path.startswith(only) or f"{path}:{m.line}" in only)]
             for path, found in mutants.every_mutant(root).items()}
    if not any(every.values()):
        raise SystemExit(f"mutate: no file of csrc begins with {' or '.join(only)}; give a path as csrc/fine/sites.c")
    chosen = mutants.draw(every, args.count, random.Random(seed))
    if args.all:
        chosen = [mutant for found in every.values() for mutant in found]
    k, parts = map(int, args.part.split("/"))
    chosen.sort(key=lambda mutant: (mutant.path.startswith(TWINS), mutant.path))
    chosen = chosen[len(chosen) * (k - 1) // parts:len(chosen) * k // parts]
    print(f"mutate: seed {seed}, {len(chosen)} changes", flush=True)
    listed, survived, at_random = mutants.known(), [], 0
    equal = [mutant for mutant in chosen if mutant.names & listed]
    with tempfile.TemporaryDirectory(prefix="encre-mutate-") as folder:
        tree = Path(folder).resolve()
        copy(root, tree)
        own = Copy(tree)
        own.warm(any(m.path.startswith(TWINS) for m in chosen),
                 any(m.path.startswith("csrc/light/") for m in chosen))
        for mutant, by, took in own.run([m for m in chosen if m not in equal], tests_of):
            if by is None:
                survived.append(mutant)
            at_random += by is not None and by.startswith(RANDOM)
            print(f"{'SURVIVES' if by is None else 'noticed ':8} {took:5.1f} s  {mutant}{f'   [{by}]' if by else ''}",
                  flush=True)
    tried = len(chosen) - len(equal)
    print(f"mutate: seed {seed}: {tried - len(survived)} noticed, {at_random} of them by random jobs alone, "
          f"{len(survived)} survived: "
          f"{100 * len(survived) / max(1, tried):.1f} % of {tried}; besides, {len(equal)} are known to change nothing")
    for mutant in survived:
        print(f"    {mutant}")
    return 1 if survived and (len(survived) > 0.05 * tried or tried < 20) else 0


if __name__ == "__main__":
    sys.exit(main())
