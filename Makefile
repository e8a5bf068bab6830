# Every command of the project; `make help` lists them.
# `maps` is also a folder, so without this line make would call it up to date.
.PHONY: help venv maps test check bench clean
.DELETE_ON_ERROR:
.SECONDARY:

SHELL := /bin/bash
PYTHON ?= python3
BIN := .venv/bin
RECIPES := $(wildcard maps/*.toml)
NAMES := $(RECIPES:maps/%.toml=%)
SOURCES := $(shell find lutgen -name '*.py')

help: ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## (.*)/\1\t\2/' | expand -t 10

venv: .venv/.installed ## create .venv and install everything in it

maps: $(NAMES:%=build/maps/%/figures.stamp) ## build every map of maps/ and its figures into build/maps

test: .venv/.installed ## run the tests
	$(BIN)/python -m pytest -n 2

check: .venv/.installed ## lint, format, types, spelling
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/codespell

bench: .venv/.installed ## measure speed
	$(BIN)/python -m benchmarks.run

clean: ## remove build/ and the caches, keep .venv
	rm -rf build .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +

# The stamp is the last thing written, so an interrupted installation starts again.
.venv/.installed: pyproject.toml
	if command -v uv >/dev/null; then \
	  uv venv --allow-existing --python '>=3.11' .venv && uv pip install --python $(BIN)/python -e '.[test,dev]'; \
	else \
	  $(PYTHON) -m venv .venv && $(BIN)/python -m pip install --quiet -e '.[test,dev]'; \
	fi
	touch $@

build/maps/%.h5: maps/%.toml $(SOURCES) | .venv/.installed
	@mkdir -p $(@D)
	$(BIN)/lutgen sweep $< -o $@

build/maps/%/figures.stamp: maps/%.toml build/maps/%.h5 tools/gallery.py
	@mkdir -p $(@D)
	$(BIN)/python tools/gallery.py $< build/maps/$*.h5
	touch $@
