# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the C library lies that came with this package."""

import glob
import os
import sys

LIBRARY = {"darwin": "libencre.dylib", "win32": "libencre.dll"}.get(sys.platform, "libencre.so")


def path() -> str:
    """The library in the package's folder; in an extension, what the wheel that came with it put where Python looks for
    modules, under the name of its build."""
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    wheels = glob.glob(os.path.join(glob.escape(package), "wheels", "encre_library-*.whl"))
    if not wheels:
        return os.path.join(package, LIBRARY)
    stem, ending = os.path.splitext(LIBRARY)
    name = f"{stem}-{os.path.basename(wheels[0]).split('-')[1]}{ending}"
    places = [os.path.join(folder, name) for folder in sys.path]
    return next(filter(os.path.exists, places), os.path.join(package, name))
