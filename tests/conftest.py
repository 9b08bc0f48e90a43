# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by all tests: where shared data lies, and a gate on skips."""

import os
from pathlib import Path

import pytest

SKIPS = Path(__file__).with_name("skips.txt")
DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.fixture(scope="session")
def data():
    """The folder of real input beside the checkout; tests that need it are skipped where it is missing."""
    if not DATA.is_dir():
        pytest.skip("needs ../shared/data")
    return DATA


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
