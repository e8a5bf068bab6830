"""What exports compile to by themselves, of every codec: the bits that the certificate saw."""

import ctypes
import functools
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from firmware_export.protocol.descriptor import axis_numbers

from firmware_export.certify.answers import device
from firmware_export.contacts import codec as contacts
from firmware_export.contacts import poly
from firmware_export.emit import package
from firmware_export.grid import codec as grid
from firmware_export.grid.tables import SPAN
from firmware_export.host.library import RUNTIME
from firmware_export.protocol.exported import Export
from firmware_export.truth.model import Model
from lutgen.quantities import EXPORTABLE
from lutgen.recipe.recipe import load_recipe
from targets.compiled import FLAGS, HostLibrary, compile_c
from tests.fixtures.fits import few_points
from tests.fixtures.queries import integer_queries, random_queries

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")


@functools.cache
def export_of(recipe: str, codec: str, growth: int) -> Export:
    model = Model(load_recipe(f"maps/{recipe}.toml"))
    module = {"contacts": contacts, "grid": grid, "poly": poly}[codec]
    spec = module.start(model, EXPORTABLE, "float")[-1]
    for _ in range(growth):
        spec = module.grow(model, spec)[-1]
    with few_points(turns=1):
        tables = module.encode(model, EXPORTABLE, spec)
    return Export(recipe, model.recipe, model, codec, "float", EXPORTABLE, tables)


def answers(export: Export) -> list[int]:
    """Return every status that random queries bring out."""
    return [-1, 0, 1, 2, 3] if export.model.faces == 1 else [-1, 0, 1, 2]


# As smap_config.h has it, one map and unrolled; small; and a runtime for any map.
BUILDS = ((), ("-Os",), ("-DSMAP_SHARED=1",))
# Twelve discs take 20 us a query.
CASES = [
    ("paper_two", "contacts", 2, 1_000_000),
    ("three_leg_sphere", "contacts", 4, 1_000_000),
    ("absolem", "contacts", 12, 200_000),
    ("paper_two", "poly", 3, 1_000_000),
    ("paper_two", "grid", 0, 1_000_000),
]


@pytest.mark.parametrize(("recipe", "codec", "growth", "count"), CASES)
def test_every_build_of_an_export_gives_the_bits_of_the_host(
    recipe: str, codec: str, growth: int, count: int, tmp_path: Path
) -> None:
    export = export_of(recipe, codec, growth)
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, count)
    status, reading = device(export).read(params, gravity)
    for flags in BUILDS:
        own_status, own = HostLibrary(tmp_path / "out", (*FLAGS, *flags)).read(params, gravity)
        np.testing.assert_array_equal(own_status, status)
        np.testing.assert_array_equal(own.view(np.uint32), reading.view(np.uint32))
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
    with few_points(turns=1):
        tables = grid.encode(model, EXPORTABLE, grid.start(model, EXPORTABLE, "integer")[0])
    return Export("paper_two", model.recipe, model, "grid", "integer", EXPORTABLE, tables)


def test_every_build_gives_the_same_numbers_without_floats(tmp_path: Path) -> None:
    export = integer_export()
    package.write(export, tmp_path / "out")
    params, gravity = integer_queries(export.model, 1_000_000)
    status, reading = device(export).read(params, gravity)
    assert np.bincount(status + 1, minlength=5).min() > 300
    # The last is how a Cortex-M finds a whole root.
    divides = ("-D__ARM_FEATURE_IDIV=1", "-D__ARM_FEATURE_CLZ=1")
    for flags in (*BUILDS, divides):
        other = HostLibrary(tmp_path / "out", (*FLAGS, *flags)).read_i(params, gravity)
        np.testing.assert_array_equal(other[0], status)
        np.testing.assert_array_equal(other[1], reading)
    few = 100_000
    clean = HostLibrary(tmp_path / "out").run_driver(params[:few], gravity[:few], SANITIZERS)
    np.testing.assert_array_equal(clean[0], status[:few])
    np.testing.assert_array_equal(clean[1], reading[:few])


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


FUNCTIONS = """
#include "smap.c"
void each(int count, const float *x, float *arcsines, float *roots)
{
  int i;
  for (i = 0; i < count; i++) {
    arcsines[i] = arcsine(x[i]);
    roots[i] = x[i] < 0.0f ? 0.0f : root(x[i]);
  }
}
"""


def functions(folder: Path, x: np.ndarray, *flags: str) -> tuple[np.ndarray, np.ndarray]:
    """Return arcsine and root of singles, as smap.c computes them."""
    (folder / "each.c").write_text(FUNCTIONS)
    options = [*FLAGS, *flags, "-fPIC", "-shared", "-I", str(RUNTIME)]
    compile_c([*options, "each.c", "-o", "each.so"], folder)
    found = np.empty((2, len(x)), np.float32)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (x, *found)]
    ctypes.CDLL(str(folder / "each.so")).each(len(x), *pointers)
    return found[0], found[1]


def test_arcsine_is_right_to_3e_7_and_odd(tmp_path: Path) -> None:
    x = np.append(np.linspace(-1.0, 1.0, 20_001), 1.5).astype(np.float32)
    *found, beyond = functions(tmp_path, x)[0]
    # 3e-7 rad: two roundings near 90 deg, and the polynomial's own error.
    np.testing.assert_allclose(found, np.arcsin(x[:-1].astype(np.float64)), atol=3e-7)
    np.testing.assert_array_equal(found, -np.array(found)[::-1])
    assert beyond == found[-1]


@pytest.mark.parametrize("hardware", [0, 1])
def test_root_rounds_as_ieee_754_asks(tmp_path: Path, hardware: int) -> None:
    bits = np.random.default_rng(2).integers(0, 0x7F800000, 5000, dtype=np.uint32)
    x = bits.view(np.float32)
    found = functions(tmp_path, x, f"-DSMAP_HARDWARE_ROOT={hardware}")[1]
    np.testing.assert_array_equal(found, np.sqrt(x))
