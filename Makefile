# Every command of the project; `make help` lists them.
# `maps` is also a folder, so without this line make would call it up to date.
.PHONY: help venv maps paper explorer engine exports size firmware cmsis verify fuzz hostile physics
.PHONY: robots compare test check docs bench soak control lock oldest dist bill clean
.DELETE_ON_ERROR:
.SECONDARY:

SHELL := /bin/bash
PYTHON ?= python3
# Where the environment forbids to keep what Python compiles, the tests' two processes and the
# programs that they start spend a minute on compiling the same files again.
export PYTHONDONTWRITEBYTECODE :=
BIN := .venv/bin
RECIPES := $(wildcard maps/*.toml)
NAMES := $(RECIPES:maps/%.toml=%)
# Published robot descriptions, which are not part of this project; see maps/README.md.
LUTGEN_ROBOTS ?= ../shared/robots
IMPORTED := $(if $(wildcard $(LUTGEN_ROBOTS)/absolem.urdf),absolem_urdf)
FIGURES := $(patsubst %,build/maps/%/figures.stamp,$(NAMES) $(IMPORTED))
EXPORTS := $(NAMES:%=build/maps/%/firmware.stamp)
# Recipes lie in maps/, imported ones in build/maps.
vpath %.toml maps build/maps
SOURCES := $(shell find lutgen -name '*.py')
EXPORTER := $(shell find firmware_export -name '*.py' -o -path '*/runtime/*' -not -name '*.so')
PAGES := $(wildcard firmware_export/explore/built/* firmware_export/explore/web/page.*)
UV := $(shell command -v uv 2>/dev/null)
VENV := $(if $(UV),uv venv --quiet --allow-existing --python '>=3.11',$(PYTHON) -m venv) .venv
INSTALL := $(if $(UV),uv pip install --quiet --python $(BIN)/python,$(BIN)/python -m pip install -qq --no-compile) -e
# Sweeps use all cores, the search for tables mostly one: two at a time, unless make was told
# otherwise (-j1, -j4), and nobody's output in the middle of another's.
TWO := $(if $(filter output-sync,$(.FEATURES)),--output-sync) -j2
# A part of the tests that imports every dependency and uses most of each.
OLDEST := tests/recipe tests/mapping/test_map.py tests/mapping/test_checksum.py tests/urdf \
  tests/plot/test_plot.py tests/cli/test_cli.py tests/search

help: ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## (.*)/\1\t\2/' | expand -t 10

venv: .venv/.installed ## create .venv and install everything in it

maps: .venv/.installed ## build every map of maps/, its figures and its firmware export into build/maps
	@$(MAKE) --no-print-directory $(if $(filter -j%,$(MAKEFLAGS)),,$(TWO)) $(FIGURES) $(EXPORTS)
	@$(if $(IMPORTED),,echo "absolem_urdf: skipped, there is no $(LUTGEN_ROBOTS)/absolem.urdf (LUTGEN_ROBOTS names the folder)")

paper: build/paper/gallery.stamp ## reproduce the paper: figures, tables and one page in build/paper

test: export LUTGEN_LONG = $(LONG)
test: .venv/.installed ## run the tests, with LONG=1 at length; what needs tools that are not here is skipped
	$(BIN)/python -m pytest -n 2 --dist worksteal -rs --skipped-to=build/skipped.txt

check: .venv/.installed ## lint, format, types, spelling
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/codespell
	$(BIN)/lint-imports

docs: .venv/.docs ## build the site of the documents into build/site (the explorers too, if they are made)
	$(BIN)/python -m tools.site

explorer: $(NAMES:%=build/explorer/%.html) ## write a page for every robot of maps/ into build/explorer

engine: ## rebuild the scripts and the WebAssembly of those pages (clang, wasm-ld, node, npm)
	$(PYTHON) tools/explorer.py

physics: .venv/.physics ## judge the verdicts by a physics engine (docs/measured: physics, judged, steady; ten minutes, SAMPLE=1: two)
	$(BIN)/python -m proofs.physics.agreement $(if $(SAMPLE),--cases 60)
	$(if $(SAMPLE),,$(BIN)/python -m proofs.physics.steady)
	$(BIN)/python -m proofs.physics.judge $(if $(SAMPLE),rocking)
	$(BIN)/python -m proofs.physics.braking $(if $(SAMPLE),--cases 20)

compare: .venv/.installed ## public measures of stability beside ours (docs/measured/compare.md, build/compare)
	$(BIN)/python -m proofs.compare --update

robots: .venv/.robots ## import published robots, which it downloads (docs/measured/robots.md; five minutes)
	$(BIN)/python -m proofs.robots --update

bench: .venv/.installed ## measure speed
	$(BIN)/python -m benchmarks.run

soak: .venv/.installed ## kill, damage and fill up sweeps at length; needs 20 GB in build/ (ten minutes)
	LUTGEN_SOAK=1 $(BIN)/python -m pytest -q -s tests/mapping/test_survival.py tests/mapping/test_engines.py tests/ground/test_cache.py
	$(BIN)/python -m benchmarks.large

control: .venv/.installed ## attack on-board control at length over the gallery, and ride with it (an hour)
	$(BIN)/python -m proofs.control --update
	$(BIN)/python -m proofs.gain 1000 --update
	$(BIN)/python -m targets.control --update

exports: .venv/.installed ## make and certify the exports that docs/measured/exports.md lists (ten minutes)
	$(BIN)/python tools/export_table.py

size: $(EXPORTS) ## measure flash, RAM and stack on a Cortex-M4 (arm-none-eabi-gcc)
	$(BIN)/python -m targets.size $(NAMES:%=build/maps/%/firmware)

verify: $(EXPORTS) ## prove the C runtime (fifteen minutes, SAMPLE=1: three; docs/measured/c-runtime.md)
	$(BIN)/python -m proofs.run $(if $(SAMPLE),--sample)

fuzz: SECONDS ?= 600
fuzz: $(EXPORTS) ## fuzz the exports for SECONDS=600 in all
	$(BIN)/python -m proofs.run --only fuzz --seconds $(SECONDS)

hostile: .venv/.installed ## fuzz recipes, URDFs, terrains, maps, command lines; SECONDS=30 for a sample
	$(BIN)/python -m proofs.fuzzing $(if $(SECONDS),--seconds $(SECONDS),--update)

firmware: $(EXPORTS) ## run exports on emulated targets: hashes, counts against the baseline, bounds
	$(BIN)/python -m targets.run $(if $(SAMPLE),--sample)
	$(BIN)/python -m targets.longest $(if $(SAMPLE),--reads 5000)

cmsis: .venv/.installed ## count 2-D reads beside CMSIS-DSP, whose source it downloads
	$(BIN)/python -m targets.cmsis

lock: ## lock what the tests and checks need in requirements.txt, by uv
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate \
	  --no-header --no-emit-index-url --no-emit-find-links --upgrade --extra test --extra dev \
	  pyproject.toml -o requirements.txt

oldest: ## test with the oldest versions that pyproject.toml allows, in build/oldest (ten minutes)
	@mkdir -p build
	$(PYTHON) -m tools.pins oldest > build/oldest.txt
	@$(subst .venv,build/oldest,$(VENV))
	@$(subst -e,,$(subst $(BIN),build/oldest/bin,$(INSTALL))) -c build/oldest.txt -e '.[test]'
	build/oldest/bin/python -m pytest -q -p no:cacheprovider -W default $(OLDEST)

dist: .venv/.installed ## build wheel and sdist into build/dist; twice, and they have to be the same
	$(BIN)/python -m tools.twice build/dist

bill: .venv/.installed ## write what is locked as a bill of materials (CycloneDX): build/bill.cdx.json
	@mkdir -p build
	$(BIN)/python -m tools.pins bill > build/bill.cdx.json

clean: ## remove build/ and the caches, keep .venv
	rm -rf build .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +

# The stamp is the last thing written, so an interrupted installation starts again.
.venv/.installed: pyproject.toml setup.py $(wildcard firmware_export/runtime/*.[ch])
	@echo "installing numpy, numba and others into .venv: a minute or two"
	@$(VENV)
	@$(if $(LOCKED),$(subst -e,--require-hashes -r requirements.txt,$(INSTALL)))
	@$(INSTALL) '.[test,dev]' $(if $(LOCKED),--no-deps --no-build-isolation)
	@$(BIN)/python tools/warm.py
	@touch $@

.venv/.physics: .venv/.installed
	@$(INSTALL) '.[physics]'
	@touch $@

.venv/.browser: .venv/.installed
	@$(INSTALL) '.[browser]'
	@touch $@

.venv/.docs: .venv/.installed
	@$(INSTALL) '.[docs]'
	@touch $@

.venv/.robots: .venv/.installed
	@$(INSTALL) '.[robots]'
	@touch $@

build/maps/absolem_urdf.toml: $(LUTGEN_ROBOTS)/absolem.urdf $(SOURCES) | .venv/.installed
	@mkdir -p $(@D)
	$(BIN)/lutgen import $< -o $@ --force --name absolem_urdf -j front_left_flipper_j \
	  -j front_right_flipper_j -j rear_left_flipper_j -j rear_right_flipper_j

build/maps/%.h5: %.toml $(SOURCES) | .venv/.installed
	@mkdir -p $(@D)
	$(BIN)/lutgen sweep $< -o $@ --force

build/maps/%/figures.stamp: %.toml build/maps/%.h5 tools/gallery.py
	@mkdir -p $(@D)
	$(BIN)/python tools/gallery.py $< build/maps/$*.h5
	@touch $@

# The folder of an export holds nothing but its files, so the stamp stands beside it.
build/maps/%/firmware.stamp: build/maps/%.h5 $(EXPORTER)
	@mkdir -p $(@D)
	$(BIN)/lutgen export $< -o build/maps/$*/firmware --force
	@touch $@

build/explorer/%.html: maps/%.toml $(EXPORTER) $(PAGES) lutgen/cli/explore.py | .venv/.installed
	@mkdir -p $(@D)
	$(BIN)/lutgen explore $< -o $@

build/paper/gallery.stamp: $(SOURCES) tools/gallery.py tools/paper_gallery.py | .venv/.installed
	$(BIN)/lutgen -v paper -o build/paper --force
	$(BIN)/python tools/paper_gallery.py build/paper
	@touch $@
