# SPDX-License-Identifier: GPL-3.0-or-later
# make demo | test | test-long | bench | lint | clean. Each sets up what it needs in .venv.

PYTHON ?= $(firstword $(foreach p,python3.11 python3.13 python3,$(shell command -v $(p) 2>/dev/null)))
# One Blender module per Python: the wheels on the package index are built for exactly one version each.
BPY := $(shell $(PYTHON) -c 'import sys; print({(3, 11): "bpy==4.5.*", (3, 13): "bpy==5.2.*"}.get(sys.version_info[:2], ""))')
RUN := .venv/bin/python

.PHONY: demo test test-long bench lint clean build

.venv/ready: pyproject.toml
	@test -n "$(BPY)" || command -v blender >/dev/null || \
		{ echo "encre: no Blender for this Python; install Python 3.11 or 3.13, or put blender on PATH" >&2; exit 2; }
	$(PYTHON) -m venv .venv
	$(RUN) -m pip install -q --upgrade pip "setuptools>=77"
	$(if $(BPY),$(RUN) -m pip install -q "$(BPY)")
	$(RUN) -m pip install -q -e ".[test]"
	@touch $@

build: .venv/ready
	$(RUN) setup.py -q build_ext --inplace

demo: build
	$(RUN) tests/demo.py build/demo

test: build
	$(RUN) -m pytest -q -m "not long"

test-long: build
	$(RUN) -m pytest -q

bench: build
	$(RUN) tests/bench.py

lint: .venv/ready
	.venv/bin/ruff check .

clean:
	rm -rf .venv build addon/libencre.* *.egg-info
