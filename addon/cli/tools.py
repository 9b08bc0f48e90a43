# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmarks that come with Encre's source, not with what artists install."""

import importlib.util
import sys
from pathlib import Path

from ..pen.errors import EncreError

FOLDER = Path(__file__).resolve().parents[2] / "tools"  # also where the package is a link


def load(tool, module):
    """The module `module` of tools/TOOL in the checkout that this package is a part of. EncreError: it is none."""
    init, name = FOLDER / tool / "__init__.py", f"encre_{tool}"
    if not init.is_file():
        raise EncreError(f"{tool}: is a benchmark that comes with Encre's source alone; clone the repository and "
                         "install Encre from there with `pip install -e .`")
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, init, submodule_search_locations=[str(init.parent)])
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return importlib.import_module(f"{name}.{module}")
