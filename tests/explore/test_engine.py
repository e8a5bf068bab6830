"""The engines of the explorer: what is checked in is what its sources give, and exact is exact."""

import ctypes
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lutgen
from lutgen.channels import evaluate_each
from proofs.explorer import states
from tests.fixtures.exact_library import answers, build
from tests.fixtures.places import MAPS, ROOT
from tools.explorer import HOME, clang_version

# Robots whose regions are convex are equal but for rounding; with more than two rows of wheels the
# strips of several gaps lie over each other (docs/guide/explorer.md).
CONVEX = ("paper_one", "paper_two", "three_leg_sphere", "excavator")
ROLLING = sorted({path.stem for path in MAPS.glob("*.toml")} - set(CONVEX))
APART = {"absolem": 3}
STATES = 200
# Digits that the page prints: 0.01 deg and four that count.
PRINTED_DEG, PRINTED_PART = 0.01, 1e-3


@pytest.fixture(scope="module")
def exact(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return build(tmp_path_factory.mktemp("exact"))


def compared(exact: ctypes.CDLL, name: str):
    recipe = lutgen.load_recipe(f"recipe:{name}")
    params, gravity = states(recipe, STATES, math.radians(50.0), 1)
    truth = evaluate_each(recipe, params, gravity, ("status", "sdg", "tip_angle", "height"))
    return truth, answers(exact, recipe, params, gravity)


@pytest.mark.parametrize("name", CONVEX)
def test_double_precision_is_the_definition(exact: ctypes.CDLL, name: str) -> None:
    truth, found = compared(exact, name)
    assert (found["status"] == truth["status"]).all()
    for channel in ("sdg", "height"):
        np.testing.assert_allclose(found[channel], truth[channel], rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(found["tip_angle"], truth["tip_angle"], rtol=0, atol=1e-9)
    assert 0 < (truth["status"] == 2).sum() < STATES


@pytest.mark.parametrize("name", ROLLING)
def test_where_robots_rock_it_is_within_the_printed_digits(exact: ctypes.CDLL, name: str) -> None:
    truth, found = compared(exact, name)
    apart = np.degrees(np.abs(found["tip_angle"] - truth["tip_angle"]))
    same = (found["status"] == truth["status"]) & (apart <= PRINTED_DEG)
    for channel in ("sdg", "height"):
        near = np.isclose(found[channel], truth[channel], rtol=PRINTED_PART, equal_nan=True)
        same &= near
    assert same.sum() >= STATES - APART.get(name, 0)
    # Never does it say that a robot stands which tips.
    assert not ((found["status"] != 2) & (truth["status"] == 2)).any()


def rebuilt(only: str) -> None:
    command = [sys.executable, "tools/explorer.py", "--check", "--only", only]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.needs("clang", "wasm-ld")
def test_the_webassembly_is_what_the_sources_give() -> None:
    made_by = (HOME / "built" / "made_by.txt").read_text().strip()
    if clang_version() != made_by:
        pytest.skip(f"{clang_version()} gives other bytes than {made_by}")
    rebuilt("engine")


@pytest.mark.needs("node", "npm")
def test_the_scripts_are_what_the_sources_give() -> None:
    rebuilt("scripts")


def test_what_is_shipped_is_there() -> None:
    for name in ("exact.wasm", "exported.wasm", "main.js", "worker.js", "three.LICENSE"):
        assert (Path(HOME) / "built" / name).stat().st_size > 1000
