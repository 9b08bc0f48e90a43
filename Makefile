# SPDX-License-Identifier: GPL-3.0-or-later
# make demo | gallery | scenes | docs | languages | hashes | test | test-all | test-long | mutate | bench | bench-peers |
# bench-live | lint | site | extension | release | clean. Each sets up what it needs in .venv.

PYTHON ?= $(firstword $(foreach p,python3.11 python3.13 python3,$(shell command -v $(p) 2>/dev/null)))
# One Blender module per Python: the wheels on the package index are built for exactly one version each.
BPY := $(shell $(PYTHON) -c 'import sys; print({(3, 11): "bpy==4.5.*", (3, 13): "bpy==5.2.*"}.get(sys.version_info[:2], ""))')
RUN := .venv/bin/python
# Python keeps what it has compiled, whatever the shell says: tests begin hundreds of processes.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo gallery scenes docs site languages hashes extension release blenders libraries test test-all test-long mutate bench \
	bench-peers bench-live lint clean build

.venv/ready: pyproject.toml
	@test -n "$(BPY)" || command -v blender >/dev/null || \
		{ echo "encre: no Blender for this Python; install Python 3.11 or 3.13, or put blender on PATH" >&2; exit 2; }
	$(PYTHON) -m venv .venv
	$(RUN) -m pip install -q --upgrade pip "setuptools>=77"
	PYTHONWARNINGS=ignore $(RUN) -m pip install -q $(if $(BPY),"$(BPY)") -e ".[test]"
	@touch $@

build: .venv/ready
	$(RUN) setup.py -q build_ext --inplace

# The scene by two presets and as Cycles shows it, but for noise, from one render; and Ink only, which needs no Cycles.
demo: build
	@.venv/bin/encre render scenes/street.py -o build/demo/street.exr
	@for preset in water_memory inter_color; do \
		.venv/bin/encre composite build/demo/street.exr --preset $$preset -o build/demo/$$preset.png || exit; done
	@.venv/bin/encre composite build/demo/street.exr -o build/demo/cycles.png \
		$(foreach stage,lines shading smudging hatching,--set use_$(stage)=off)
	@.venv/bin/encre render scenes/street.py --preset ink_only -o build/demo/ink_only.png

# The pictures of docs/gallery.md and docs/scenes.md: minutes a scene.
gallery: build
	$(RUN) scenes/gallery.py build/gallery $(wildcard ../shared/data/suzanne.blend)

# Each scene as a .blend in build/scenes, with its painted controls and settings.
scenes: build
	@for scene in $$(grep -l "def build()" scenes/*.py); do .venv/bin/python scenes/save.py $$scene build/scenes || exit; done

# The pages and tables of docs/ that are computed without Blender: a quarter of an hour and more.
docs: build
	$(RUN) tests/helpers/pages.py

# docs/ as a site in build/site: fails where a link leads nowhere, or the search does not find what artists ask.
build/site-tools/ready: Makefile
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/python -m pip install -q "mkdocs-material==9.*" quickjs
	@touch $@

site: build/site-tools/ready
	build/site-tools/bin/mkdocs build --strict --quiet
	build/site-tools/bin/python tools/asked.py build/site

# What random jobs draw, after a change that is to be seen: tests/helpers/hashes.txt.
hashes: build
	$(RUN) tests/helpers/hashes.py

# Puts new texts of panels into addon/languages/, for somebody to translate, and takes old ones away.
languages: build
	$(RUN) tests/helpers/languages.py --write

# What packs needs no Blender.
build/pack/ready:
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/python -m pip install -q "setuptools>=77"
	@touch $@

# For this machine, into build: encre-VERSION-PLATFORM.zip for Blender 4.2 and later, ...-addon.zip for 3.4 to 4.1.
extension: build/pack/ready
	build/pack/bin/python setup.py -q extension addon

# The compiler for other platforms.
build/pack/wheels: build/pack/ready
	$(@D)/bin/python -m pip install -q "ziglang==0.17.1" "auditwheel==6.8.2"
	@touch $@

# All that is downloaded, for every platform, into build/release: minutes. WEBSITE=https://... is shown by extensions.
release: build/pack/wheels
	ENCRE_WEBSITE=$(WEBSITE) build/pack/bin/python tools/wheels.py

.venv/long: .venv/ready
	PYTHONWARNINGS=ignore $(RUN) -m pip install -q -e ".[wheels,farm]"
	@touch $@

# One process more than there are cores: tests wait now and then. What their slow twins find is kept (build/kept), and
# so found once, whichever process asks. Windows and packages of test-all are shared by the tests of a file.
PYTEST = $(RUN) -m pytest -q -n $$(($$(getconf _NPROCESSORS_ONLN) + 1))

test: libraries
	$(PYTEST) --dist worksteal -m "not slow and not long"

# The library as tests see into it.
libraries: build
	$(RUN) tests/helpers/built.py

# What is too slow for `make test`, but for test-long's. Random jobs come last and by themselves: they use all cores.
test-all: libraries
	$(PYTEST) --dist loadfile --no-loadscope-reorder -m "slow and not long" --ignore tests/unit/test_fuzz.py
	ENCRE_FUZZ_SECONDS=$${ENCRE_FUZZ_SECONDS:-120} $(RUN) -m pytest -q -m "slow and not long" tests/unit/test_fuzz.py

test-long: build .venv/long $(if $(filter bpy==4.5%,$(BPY)),blenders)
	$(RUN) -m pytest -q

# Other versions of Blender for test-long; blender on PATH is tested as well. 5.2 wants a Python of its own: without it
# its tests are skipped by name.
build/blenders/bpy-5.2/ready: PYTHON = python3.13
build/blenders/bpy-%/ready:
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/python -m pip install -q "bpy==$*.*" numpy openimageio
	@touch $@

blenders: build/blenders/bpy-4.2/ready build/blenders/bpy-5.0/ready \
		$(if $(shell python3.13 -c 'print(1)' 2>/dev/null),build/blenders/bpy-5.2/ready)

# BENCH="--size 480x270 --rounds 1" is a small run; BENCH=--sizes times the stages from 720p to 8K, too.
bench: build
	$(RUN) tests/helpers/bench.py $(BENCH)
	$(RUN) tests/helpers/bench_costs.py $(filter-out --sizes,$(BENCH))
	$(RUN) tests/helpers/bench_light.py $(filter-out --sizes,$(BENCH))

# The same picture by libraries for pictures, each of which may be missing. They bring a numpy of their own, which is
# another than Blender's.
build/peers/ready: | build
	@for peer in numpy scipy opencv-python-headless scikit-image openimageio; do \
		$(RUN) -m pip install -q --upgrade --no-warn-conflicts --target $(@D) $$peer || \
		echo "$$peer: can't be installed"; done
	@test -d $(@D)/numpy && touch $@

# `make bench bench-peers` renews all of docs/speed.md.
bench-peers: build build/peers/ready
	$(RUN) tests/helpers/bench_blender.py $(filter-out --sizes,$(BENCH))
	PYTHONPATH=build/peers $(RUN) tests/helpers/bench_peers.py $(filter-out --sizes,$(BENCH))

# The rendered 3D view in a window: needs blender and xvfb-run.
bench-live: build
	$(RUN) tests/helpers/bench_live.py

# Does a test notice when a constant changes by a fifth? MUTATE="--seed 7 --only csrc/fine" for others than 200 at random.
mutate: build
	$(RUN) tests/helpers/mutate.py $(MUTATE)

lint: .venv/ready
	.venv/bin/ruff check .
	.venv/bin/mypy --no-error-summary
	.venv/bin/clang-format --dry-run --Werror $$(find csrc tests -name '*.[ch]')
	find csrc -name '*.c' | xargs -n 1 -P $$(nproc) .venv/bin/clang-tidy --quiet 2>/dev/null

clean:
	rm -rf .venv build addon/libencre.* *.egg-info
