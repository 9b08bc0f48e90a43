# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules that PYTHONPATH puts in the place of those that Encre needs."""

import importlib.machinery
import os
import sys

_NEEDED = "numpy", "OpenImageIO"


def shadowed():
    """{module: its file} of those loaded that a folder of PYTHONPATH has in the place of others of the same name."""
    folders = [os.path.abspath(folder) for folder in os.environ.get("PYTHONPATH", "").split(os.pathsep) if folder]
    found = {}
    for name, module in list(sys.modules.items()) if folders else ():
        file = getattr(module, "__file__", None)
        if not file or "." in name or not any(file.startswith(os.path.join(folder, "")) for folder in folders):
            continue
        rest = [path for path in sys.path if os.path.abspath(path) not in folders]
        if name in sys.stdlib_module_names or (name in _NEEDED
                                               and importlib.machinery.PathFinder.find_spec(name, rest)):
            found[name] = file
    return found


def words():
    """A sentence for each."""
    return [f"PYTHONPATH: {file} takes the place of the module {name}; take its folder from PYTHONPATH if that is not "
            "meant" for name, file in shadowed().items()]
