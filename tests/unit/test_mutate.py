# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes constants to try the tests: which ones, and that tests notice them."""

import subprocess
import sys
from pathlib import Path

import mutate

ROOT = Path(__file__).parents[2]

CODE = """/* 1.5 of them */
#define MANY 12
enum { SIDE = 3 };
static const float near = 0.25f; /* 7 */
float f(const float *v)
{
	float sum[4] = {0}, most = 1e6f;
	int x = 1 << 4;
	return v[2] > 0 ? sum[x] * 2 : most;
}
"""


def test_what_is_changed():
    found = [(m.line, m.old, m.new) for m in mutate.mutants_of("csrc/a.c", CODE)]
    assert found == [(3, "3", "2"), (3, "3", "4"), (4, "0.25f", "0.2f"), (4, "0.25f", "0.3f"),
                     (7, "1e6f", "800000.0f"), (7, "1e6f", "1200000.0f"), (9, "2", "1"), (9, "2", "3"), (9, "0", "1"),
                     (9, "2", "1"), (9, "2", "3")]


def test_the_list_of_what_none_can_notice_names_lines_that_are_there():
    every = mutate.every_mutant(ROOT)
    there = {(m.path, m.text, m.old, m.new) for found in every.values() for m in found}
    assert mutate.known() - there == set()
    for name, old, _, _ in mutate.PYTHON:
        assert (ROOT / name).read_text(encoding="utf-8").count(old) == 1, name


def test_changes_that_matter_are_noticed():
    done = subprocess.run([sys.executable, "tests/helpers/mutate.py", "--seed", "1", "--count", "3", "--floats",
                           "--only", "csrc/base/metric.c"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("noticed ") == 3
