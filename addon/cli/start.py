# SPDX-License-Identifier: GPL-3.0-or-later
"""`python start.py ARGUMENTS` is `encre ARGUMENTS` of the package that this file lies in, wherever it is called from:
no module comes from the current folder, which may be a stranger's. For processes that Encre starts itself.
"""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def main():
    # Python puts a script's folder first, where our modules would stand in for others of their names.
    known = [path for path in sys.path if path.endswith(("site-packages", "dist-packages"))]
    sys.path[:] = [path for path in sys.path if path in known or os.path.abspath(path) not in (HERE, os.getcwd())]
    import importlib.util

    package = os.path.dirname(HERE)
    spec = importlib.util.spec_from_file_location("encre", os.path.join(package, "__init__.py"),
                                                  submodule_search_locations=[package])
    sys.modules["encre"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules["encre"])
    from encre.__main__ import main as run

    return run()


if __name__ == "__main__":
    sys.exit(main())
