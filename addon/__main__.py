# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre` and `python -m encre`."""

import os
import sys

if __name__ == "__main__":  # `python -m` puts the current folder first, in which a stranger's files may lie
    sys.path[:] = [path for path in sys.path if path.endswith("-packages") or os.path.abspath(path) != os.getcwd()]

import contextlib
import signal


def _leave(*_):
    """Nothing is half-made yet, and a module that is loading may take a KeyboardInterrupt for an error of its own."""
    with contextlib.suppress(OSError):
        os.write(2, b"encre: interrupted\n")
    os._exit(130)


def main():
    """Runs the process's command line and returns its exit status, 130 when interrupted."""
    # To be ended from outside is to be interrupted: nothing half-made stays behind, and no Blender runs on alone.
    heeded = [number for name in ("SIGINT", "SIGTERM", "SIGHUP") if (number := getattr(signal, name, None)) is not None
              and signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler)]
    for number in heeded:
        signal.signal(number, _leave)
    try:
        from .cli.main import main as run
    except (ImportError, AttributeError) as error:
        from .cli.shadows import words

        if not (found := words()):
            raise
        print(f"encre: error: {error}: {found[0]}", file=sys.stderr)
        return 2
    try:
        for number in heeded:
            signal.signal(number, signal.default_int_handler)
        return run()
    except KeyboardInterrupt:
        print("encre: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
