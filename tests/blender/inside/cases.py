# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: `cases.py -- CASE FOLDER` renders what one test looks at, and prints facts as lines `FACT {json}`.

A case is a function of one of the modules below. Pictures are saved as multilayer EXR, so that tests see what users
get.
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import anchors  # noqa: E402
import baking  # noqa: E402
import cycles_light  # noqa: E402
import details  # noqa: E402
import distances  # noqa: E402
import failures  # noqa: E402
import geometry  # noqa: E402
import keeping  # noqa: E402
import lit  # noqa: E402
import painting  # noqa: E402
import pictures  # noqa: E402
import quick  # noqa: E402
import supersampling  # noqa: E402
import surfaces  # noqa: E402

CASES = {name: case for topic in (pictures, cycles_light, geometry, failures, supersampling, baking, details,
                                  keeping, surfaces, lit, painting, quick, anchors, distances)
         for name, case in vars(topic).items()}

case, folder = sys.argv[sys.argv.index("--") + 1:]
status = 1
try:
    CASES[case](folder)
    status = 0
finally:
    sys.stdout.flush()
    if status:
        import traceback

        traceback.print_exc()
    os._exit(status)
