# Every command of the project; `make help` lists them.
.PHONY: help venv maps paper test check lines bench firmware verify prove size physics robots soak \
  fuzz hostile docs explorer engine dist oldest clean
.DELETE_ON_ERROR:
.SECONDARY:

PYTHON ?= python3
export PYTHONDONTWRITEBYTECODE :=
BIN := .venv/bin
NAMES := $(patsubst maps/%.toml,%,$(wildcard maps/*.toml))
# Published robot descriptions, which are not part of this project; see maps/README.md.
LUTGEN_ROBOTS ?= ../shared/robots
IMPORTED := $(if $(wildcard $(LUTGEN_ROBOTS)/absolem.urdf),absolem_urdf)
MAPS := $(patsubst %,build/maps/%.h5,$(NAMES) $(IMPORTED))
EXPORTS := $(NAMES:%=build/maps/%/firmware.stamp)
$(shell mkdir -p build/explorer $(NAMES:%=build/maps/%))
vpath %.toml maps build/maps
SOURCES := $(shell find lutgen -name '*.py')
EXPORTER := $(shell find firmware_export -type f -not -name '*.so' -not -path '*/__pycache__/*')
UV := $(shell command -v uv 2>/dev/null)
VENV := $(if $(UV),uv venv --quiet --allow-existing --seed --python '>=3.11' .venv,$(PYTHON) -m venv .venv)
PIP := $(BIN)/python -m pip install -qq
# uv takes half the time of pip, but does not know pip's settings, as of a mirror.
INSTALL = $(or $(UV),$(BIN)/uv) pip install --quiet --python $(BIN)/python -e '.[$(1)]' || $(PIP) -e '.[$(1)]'
EXTRAS := test,dev
# A sweep uses all cores, figures and exports mostly one: two at a time, unless make was told
# otherwise.
TWO := $(if $(filter -j%,$(MAKEFLAGS)),,$(if $(filter output-sync,$(.FEATURES)),--output-sync) -j2)

help: ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## (.*)/\1\t\2/' | expand -t 10

venv: .venv/.installed build/maps/paper_two/firmware.stamp ## create .venv and install everything in it

maps: .venv/.installed ## build every map of maps/, its figures and its firmware export into build/maps
	@$(MAKE) --no-print-directory $(TWO) build/maps/figures.stamp $(EXPORTS)
	@$(if $(IMPORTED),,echo "absolem_urdf: skipped, there is no $(LUTGEN_ROBOTS)/absolem.urdf (LUTGEN_ROBOTS names the folder)")

paper: .venv/.installed ## reproduce the paper: figures, tables and one page in build/paper
	$(BIN)/lutgen -v paper -o build/paper --force
	cp $(patsubst maps/%,build/%,$(wildcard maps/paper/*.png)) maps/paper

test: export LUTGEN_LONG = $(LONG)
test: .venv/.installed ## run the tests, with LONG=1 at length; what needs tools that are not here is skipped
	$(BIN)/python -m pytest -n 2 --dist worksteal -rs --skipped-to=build/skipped.txt

check: .venv/.installed lines ## lint, format, types, spelling, lines
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/codespell
	$(BIN)/lint-imports
lines: ## count the lines of product, tests, lab and documents against their ceilings
	@$(PYTHON) tools/lines.py

bench: .venv/.installed ## measure speed (docs/measured/benchmarks.md; four minutes)
	$(BIN)/python -m benchmarks.run

firmware: .venv/.installed ## run exports on four emulated targets: hashes, counts, control (docs/measured/targets.md)
	$(BIN)/python -m targets.run $(if $(SAMPLE),,--reads 20000)
	$(if $(SAMPLE),,$(BIN)/python -m targets.control)

verify: .venv/.installed ## prove the C runtime (ten minutes, SAMPLE=1: three; docs/explanation/c-runtime.md)
	$(BIN)/python -m proofs.run $(if $(SAMPLE),--sample)
prove: .venv/.installed ## prove that exports on three points are never falsely safe (a minute or two)
	$(BIN)/python -m proofs.prove
size: .venv/.installed ## measure flash, RAM and stack on a Cortex-M4 (arm-none-eabi-gcc)
	$(BIN)/python -m targets.size

physics: .venv/.physics ## judge the verdicts by a physics engine (docs/measured; ten minutes, SAMPLE=1: two)
	$(BIN)/python -m proofs.physics.judge $(if $(SAMPLE),agreement rocking braking --chunks 1,--update)
robots: .venv/.robots ## import published robots, which it downloads (docs/measured/robots.md; five minutes)
	$(BIN)/python -m proofs.robots --update

soak: .venv/.installed ## kill, damage and fill up sweeps at length; needs 20 GB in build/ (ten minutes)
	LUTGEN_SOAK=1 $(BIN)/python -m pytest -q -s tests/mapping
	$(BIN)/python -m benchmarks.large

fuzz: .venv/.installed ## fuzz the exports for SECONDS=600 in all
	$(BIN)/python -m proofs.run --only fuzz --seconds $(or $(SECONDS),600)
hostile: .venv/.installed ## fuzz recipes, URDFs, terrains, maps, command lines; SECONDS=30 for a sample
	$(BIN)/python -m proofs.fuzzing $(if $(SECONDS),--seconds $(SECONDS))

docs: .venv/.docs ## build the site of the documents into build/site (the explorers too, if they are made)
	$(BIN)/sphinx-build -q -W --keep-going -c docs -d build/site-work . build/site
explorer: $(NAMES:%=build/explorer/%.html) ## write a page for every robot of maps/ into build/explorer
engine: ## compile the runtime to the WebAssembly of those pages (clang, wasm-ld)
	$(PYTHON) tools/engine.py

dist: ## build sdist and wheel into build/dist; the same commit gives the same wheel
	@$(PYTHON) -m venv build/builder && build/builder/bin/pip install -q build
	SOURCE_DATE_EPOCH=$$(git log -1 --format=%ct) build/builder/bin/python -m build -o build/dist .
oldest: ## test with the oldest versions that pyproject.toml allows, in build/oldest (ten minutes)
	@$(PYTHON) -m venv build/oldest && build/oldest/bin/pip install -q uv
	build/oldest/bin/uv pip install -q -p build/oldest --resolution lowest-direct -e '.[test]'
	build/oldest/bin/python -m pytest -q -p no:cacheprovider -W default tests/recipe tests/urdf tests/plot tests/search
clean: ## remove build/ and the caches, keep .venv
	rm -rf build .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +

# The first sweep compiles kernels that all commands use, so it runs alone.
.venv/.installed: pyproject.toml setup.py $(wildcard firmware_export/runtime/*.[ch])
	@echo "installing into .venv and compiling the kernels: a minute or two"
	@$(VENV)
	@$(if $(UV),,$(PIP) uv)
	@$(call INSTALL,$(EXTRAS))
	@$(BIN)/lutgen -q sweep maps/paper_two.toml -o build/maps/paper_two.h5 --force
	@touch $@

.venv/.%: .venv/.installed
	@$(call INSTALL,$*)
	@touch $@

build/maps/absolem_urdf.toml: $(LUTGEN_ROBOTS)/absolem.urdf $(SOURCES) | .venv/.installed
	$(BIN)/lutgen import $< -o $@ --force --name absolem_urdf -j front_left_flipper_j \
	  -j front_right_flipper_j -j rear_left_flipper_j -j rear_right_flipper_j

build/maps/%.h5: %.toml $(SOURCES) | .venv/.installed
	$(BIN)/lutgen sweep $< -o $@ --force

build/maps/figures.stamp: tools/gallery.py $(MAPS)
	$(BIN)/python $< $(filter %.h5,$(if $(filter $<,$?),$^,$?)) && touch $@

build/maps/%/firmware.stamp: build/maps/%.h5 $(EXPORTER)
	$(BIN)/lutgen export $< -o build/maps/$*/firmware --force && touch $@

build/explorer/%.html: maps/%.toml $(EXPORTER) | .venv/.installed
	$(BIN)/lutgen explore $< -o $@
