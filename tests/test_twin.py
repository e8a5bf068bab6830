"""The Python twin and the compiled C of every codec: the same bits for a million queries each."""

from pathlib import Path

import numpy as np
import pytest

from firmware_export import contacts, grid, package, poly, twin
from firmware_export.exported import CHANNELS, Export
from firmware_export.host import FLAGS, HostLibrary
from firmware_export.model import Model
from firmware_export.strict import arcsine, root
from lutgen.recipe import load_recipe
from tests.queries import integer_queries, random_queries

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")


def export_of(recipe: str, codec: str, growth: int) -> Export:
    model = Model(load_recipe(f"maps/{recipe}.toml"))
    module = {"contacts": contacts, "grid": grid, "poly": poly}[codec]
    spec = module.start(model, CHANNELS, "float")[-1]
    for _ in range(growth):
        spec = module.grow(model, spec)[-1]
    tables = module.encode(model, CHANNELS, spec)
    return Export(recipe, model.recipe, model, codec, "float", CHANNELS, tables)


def answers(export: Export) -> list[int]:
    """Return every status that random queries bring out."""
    return [-1, 0, 1, 2, 3] if export.model.faces == 1 else [-1, 0, 1, 2]


# The twelve discs' twin takes 20 us a query.
CASES = [
    ("paper_two", "contacts", 2, 1_000_000),
    ("three_leg_sphere", "contacts", 4, 1_000_000),
    ("absolem", "contacts", 12, 200_000),
    ("paper_two", "poly", 3, 1_000_000),
    ("paper_two", "grid", 0, 1_000_000),
]


@pytest.mark.parametrize(("recipe", "codec", "growth", "count"), CASES)
def test_c_and_twin_agree_bit_for_bit(
    recipe: str, codec: str, growth: int, count: int, tmp_path: Path
) -> None:
    export = export_of(recipe, codec, growth)
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, count)
    status, reading = HostLibrary(tmp_path / "out").read(params, gravity)
    twin_status, twin_reading = twin.read(export, params, gravity)
    np.testing.assert_array_equal(status, twin_status)
    np.testing.assert_array_equal(reading.view(np.uint32), twin_reading.view(np.uint32))
    # All answers occur, each many times; no direction is off a chart of the whole sphere.
    assert np.unique(status).tolist() == answers(export)
    assert np.bincount(status + 1)[[0, 1, 2, 3]].min() > count // 200


@pytest.mark.parametrize(("recipe", "codec", "growth", "count"), CASES)
def test_the_c_code_is_clean_under_the_sanitizers(
    recipe: str, codec: str, growth: int, count: int, tmp_path: Path
) -> None:
    export = export_of(recipe, codec, growth)
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, count // 10, seed=8)
    status, reading = HostLibrary(tmp_path / "out").run_driver(params, gravity, SANITIZERS)
    # The software square root is what parts without one run.
    soft = (*SANITIZERS, "-DSMAP_HARDWARE_ROOT=0")
    again, soft_reading = HostLibrary(tmp_path / "out").run_driver(params, gravity, soft)
    np.testing.assert_array_equal(status, again)
    np.testing.assert_array_equal(reading.view(np.uint32), soft_reading.view(np.uint32))
    assert np.unique(status).tolist() == answers(export)


def integer_export() -> Export:
    model = Model(load_recipe("maps/paper_two.toml"))
    tables = grid.encode(model, CHANNELS, grid.start(model, CHANNELS, "integer")[0])
    return Export("paper_two", model.recipe, model, "grid", "integer", CHANNELS, tables)


def test_c_and_twin_agree_without_floats(tmp_path: Path) -> None:
    export = integer_export()
    package.write(export, tmp_path / "out")
    params, gravity = integer_queries(export.model, 1_000_000)
    status, reading = HostLibrary(tmp_path / "out").read_i(params, gravity)
    twin_status, twin_reading = grid.read_i(export.tables, params, gravity, 1)
    np.testing.assert_array_equal(status, twin_status)
    np.testing.assert_array_equal(reading, twin_reading)
    assert np.bincount(status + 1, minlength=5).min() > 300
    fast = HostLibrary(tmp_path / "out", (*FLAGS, "-DSMAP_GRID_FAST=1"))
    np.testing.assert_array_equal(fast.read_i(params, gravity)[1], reading)
    few = 100_000
    clean = HostLibrary(tmp_path / "out").run_driver(params[:few], gravity[:few], SANITIZERS)
    np.testing.assert_array_equal(clean[0], status[:few])
    np.testing.assert_array_equal(clean[1], reading[:few])


def test_the_fast_path_of_the_grid_has_the_same_bits(tmp_path: Path) -> None:
    export = export_of("paper_two", "grid", 0)
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, 200_000, seed=9)
    status, reading = HostLibrary(tmp_path / "out").read(params, gravity)
    fast = HostLibrary(tmp_path / "out", (*FLAGS, "-DSMAP_GRID_FAST=1")).read(params, gravity)
    np.testing.assert_array_equal(fast[0], status)
    np.testing.assert_array_equal(fast[1].view(np.uint32), reading.view(np.uint32))


def test_arcsine_is_right_to_3e_7_and_odd() -> None:
    x = np.linspace(-1.0, 1.0, 20_001, dtype=np.float32)
    found = np.array([arcsine(one) for one in x])
    # 3e-7 rad: two roundings near 90 deg, and the polynomial's own error.
    np.testing.assert_allclose(found, np.arcsin(x.astype(np.float64)), atol=3e-7)
    np.testing.assert_array_equal(found, -found[::-1])
    assert arcsine(np.float32(1.5)) == arcsine(np.float32(1.0))


def test_root_rounds_as_ieee_754_asks() -> None:
    bits = np.random.default_rng(2).integers(0, 0x7F800000, 5000, dtype=np.uint32)
    x = bits.view(np.float32)
    np.testing.assert_array_equal([np.float32(root(one)) for one in x], np.sqrt(x))
