# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre` and `python -m encre`."""

import signal
import sys


def main():
    """Runs the process's command line and returns its exit status, 130 when interrupted."""
    try:
        # To be ended from outside is to be interrupted: nothing half-made stays behind, and no Blender runs on alone.
        for name in ("SIGTERM", "SIGHUP"):
            if hasattr(signal, name) and signal.getsignal(getattr(signal, name)) == signal.SIG_DFL:
                signal.signal(getattr(signal, name), signal.default_int_handler)
        from .cli.main import main as run  # only now: the interrupt may come while the modules are loading

        return run()
    except KeyboardInterrupt:
        print("encre: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
