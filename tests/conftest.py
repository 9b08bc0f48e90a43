# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by all tests: where shared data lies, and a gate on skips."""

import contextlib
import ctypes
import functools
import os
import signal
import sys
from pathlib import Path

import failed
import pytest
from encre.pen import abi

SKIPS = Path(__file__).with_name("skips.txt")
DATA = Path(__file__).resolve().parents[2] / "shared" / "data"

# A shell's job in the background ignores these, and so would every process that a test starts and interrupts.
for _number, _handler in (signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL):
    if signal.getsignal(_number) == signal.SIG_IGN:
        signal.signal(_number, _handler)

PERTURB, PATTERN = -6, 0x8f  # M_PERTURB; new memory gets the complement: large numbers, whole or not
_mallopt = getattr(ctypes.CDLL(None), "mallopt", None) if sys.platform == "linux" else None
_inside = [0]


def _patterned(declare, lib):
    """What the library reads and has never set is not 0 by chance, where glibc gives memory out. While one of its
    functions runs, and not while a twin does, which that would slow by a quarter."""
    class Function(lib._FuncPtr):
        _flags_, _restype_ = lib._FuncPtr._flags_, lib._FuncPtr._restype_

        def __call__(self, *args):
            _inside[0] += 1
            _mallopt(PERTURB, PATTERN)
            try:
                return super().__call__(*args)
            finally:
                _inside[0] -= 1
                if not _inside[0]:
                    _mallopt(PERTURB, 0)

    if _mallopt:
        lib._FuncPtr = Function
    declare(lib)


abi.declare = functools.partial(_patterned, abi.declare)


@pytest.fixture(scope="session")
def data():
    """The folder of real input beside the checkout; tests that need it are skipped where it is missing."""
    if not DATA.is_dir():
        pytest.skip("needs ../shared/data")
    return DATA


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """The pictures that a failed test compared, and where they are in its last lines."""
    outcome = yield
    if call.excinfo is None or call.excinfo.errisinstance(pytest.skip.Exception):
        return
    names = {}
    for entry in call.excinfo.traceback:
        if Path(str(entry.path)).is_relative_to(Path(__file__).parent):
            names.update(entry.frame.f_locals)
    with contextlib.suppress(Exception):  # the test's own words count
        if words := failed.leave(item.nodeid, names):
            outcome.get_result().sections.append(("what to look at", words))


def pytest_terminal_summary(terminalreporter, config):
    allowed = [line for line in SKIPS.read_text().splitlines() if line and not line.startswith("#")]
    unnamed = sorted({r.nodeid for r in terminalreporter.stats.get("skipped", ())
                      if not any(r.nodeid.startswith(a) for a in allowed)})
    if unnamed and os.environ.get("CI"):
        terminalreporter.section("skipped, but not named in tests/skips.txt")
        terminalreporter.write_line("\n".join(unnamed))
        config.stash[GATE] = True


GATE = pytest.StashKey[bool]()


@pytest.hookimpl(hookwrapper=True, tryfirst=True)  # or the summary would come after it
def pytest_sessionfinish(session):
    yield
    if session.config.stash.get(GATE, False):
        session.exitstatus = 1
