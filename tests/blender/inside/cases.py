# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: `cases.py -- CASE FOLDER` renders what one test looks at, and prints facts as lines `FACT {json}`;
`cases.py -- - TOKEN` those that it is told, and says `DONE TOKEN 1` after each, or 0 where it failed.

A case is a function of one of the modules below. Pictures are saved as multilayer EXR, so that tests see what users
get.
"""

import os
import sys
import traceback

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import studio  # noqa: E402

studio.register()  # the package that is tried; a Blender by itself knows none, or another
import anchors  # noqa: E402
import anytrees  # noqa: E402
import baking  # noqa: E402
import bumps  # noqa: E402
import cycles_light  # noqa: E402
import details  # noqa: E402
import distances  # noqa: E402
import eyes  # noqa: E402
import failures  # noqa: E402
import filters  # noqa: E402
import flats  # noqa: E402
import geometry  # noqa: E402
import greased  # noqa: E402
import keeping  # noqa: E402
import kinds  # noqa: E402
import lids  # noqa: E402
import lit  # noqa: E402
import looked  # noqa: E402
import painting  # noqa: E402
import patterns  # noqa: E402
import pictures  # noqa: E402
import quick  # noqa: E402
import searched  # noqa: E402
import slotted  # noqa: E402
import staged  # noqa: E402
import supersampling  # noqa: E402
import surfaces  # noqa: E402
import swatches  # noqa: E402
import unusual  # noqa: E402
import wild  # noqa: E402

CASES = {name: case for topic in (pictures, cycles_light, geometry, failures, supersampling, baking, details,
                                  keeping, surfaces, lids, lit, painting, patterns, quick, anchors, distances, slotted,
                                  staged, bumps, unusual, kinds, filters, swatches,
                                  anytrees, looked, greased, searched, wild, flats, eyes)
         for name, case in vars(topic).items()}


def replaceable():
    """{(module or class, name): function} of what cases replace by what watches it."""
    import _cycles

    places = [_cycles]
    for name, module in list(sys.modules.items()):
        if module and name.split(".")[0] == "encre":
            places += [module, *(own for own in vars(module).values()
                                 if isinstance(own, type) and own.__module__ == name)]
    return {(place, name): value for place in places for name, value in list(vars(place).items())
            if callable(value) and not isinstance(value, type)}


def run(case, folder):
    """Whether it went well. What it has replaced is put back."""
    before = replaceable()
    try:
        CASES[case](folder)
        return True
    except BaseException:
        traceback.print_exc()
        return False
    finally:
        for (place, name), value in before.items():
            if vars(place).get(name) is not value:
                setattr(place, name, value)


case, folder = sys.argv[sys.argv.index("--") + 1:]
if case != "-":
    well = run(case, folder)
    sys.stdout.flush()
    os._exit(not well)
for line in sys.stdin:
    well = run(*line.rstrip("\n").split(" ", 1))
    sys.stderr.flush()
    print(f"\nDONE {folder} {well:d}", flush=True)
os._exit(0)
