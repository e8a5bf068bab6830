"""The Python twin and the compiled C of every codec: the same bits for a million queries each."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from firmware_export.certify import query as twin
from firmware_export.contacts import codec as contacts
from firmware_export.device import FLAGS, HostLibrary
from firmware_export.emit import package
from firmware_export.grid import codec as grid
from firmware_export.grid.tables import SPAN
from firmware_export.poly import codec as poly
from firmware_export.protocol.axis import axis_numbers
from firmware_export.protocol.exported import CHANNELS, Export
from firmware_export.truth.model import Model
from firmware_export.twin.strict import arcsine, root
from lutgen.recipe.recipe import load_recipe
from tests.fixtures.queries import integer_queries, random_queries

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
    # The last is how a Cortex-M finds a whole root.
    divides = ("-D__ARM_FEATURE_IDIV=1", "-D__ARM_FEATURE_CLZ=1")
    for flags in (["-DSMAP_SHARED=1"], ["-Os"], divides):
        other = HostLibrary(tmp_path / "out", (*FLAGS, *flags))
        np.testing.assert_array_equal(other.read_i(params, gravity)[1], reading)
    few = 100_000
    clean = HostLibrary(tmp_path / "out").run_driver(params[:few], gravity[:few], SANITIZERS)
    np.testing.assert_array_equal(clean[0], status[:few])
    np.testing.assert_array_equal(clean[1], reading[:few])


@pytest.mark.parametrize(("recipe", "codec", "growth"), [case[:3] for case in CASES])
def test_a_shared_runtime_gives_the_same_bits(
    recipe: str, codec: str, growth: int, tmp_path: Path
) -> None:
    export = export_of(recipe, codec, growth)
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, 50_000, seed=9)
    status, reading = HostLibrary(tmp_path / "out").read(params, gravity)
    shared = HostLibrary(tmp_path / "out", (*FLAGS, "-DSMAP_SHARED=1")).read(params, gravity)
    small = HostLibrary(tmp_path / "out", (*FLAGS, "-Os")).read(params, gravity)
    for other in (shared, small):
        np.testing.assert_array_equal(other[0], status)
        np.testing.assert_array_equal(other[1].view(np.uint32), reading.view(np.uint32))


def test_the_upper_end_of_an_axis_comes_to_1_at_most_and_nearly() -> None:
    rng = np.random.default_rng(4)
    lower = rng.normal(size=100_000) * 10.0 ** rng.uniform(-3.0, 3.0, 100_000)
    upper = lower + 10.0 ** rng.uniform(-2.0, 2.0, len(lower))
    numbers = axis_numbers(SimpleNamespace(lower=lower, upper=upper))  # type: ignore[arg-type]
    place = (numbers[:, 1] - numbers[:, 0]) * numbers[:, 2]
    assert place.dtype == np.float32
    assert place.max() == 1.0
    # Three roundings.
    assert place.min() > 1.0 - 3.0 * 2.0**-24


def test_the_rim_of_a_chart_comes_to_the_last_knot_at_most_and_nearly() -> None:
    for limit in np.random.default_rng(5).uniform(0.1, 12.0, 2_000):
        tables = grid.Tables(grid.Spec(8, ()), (), (), float(limit), 0.0, "")
        rim = np.float32(limit) * tables.half
        middle = np.float32(SPAN // 2)
        assert rim.dtype == np.float32
        assert 0.0 <= middle - rim < 0.01
        assert rim + middle <= SPAN
        assert -rim + middle >= 0.0


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
