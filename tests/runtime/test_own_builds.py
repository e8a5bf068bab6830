"""What exports compile to by themselves, of every codec: the bits that the certificate saw."""

import ctypes
import functools

import numpy as np
import pytest

from firmware_export.emit import package
from firmware_export.host import RUNTIME, Host
from firmware_export.protocol import describe
from proofs.subjects import SUBJECTS
from targets.size import program
from tests.fixtures.compiled import FLAGS, HostLibrary, compile_c
from tests.fixtures.length import LONG, part
from tests.fixtures.queries import integer_queries, random_queries

# Without optimisation: with it the checks take the compiler up to half a minute, and it may leave
# out what it can tell is undefined before a check sees it.
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O0")
OK, ROCKS, TIPS, OFF_CHART, OFF_RANGE, INVALID = 0, 1, 2, 3, 4, 6

# Fast code with the square root in software; small code is what chips are asked, too.
BUILDS = (("-O3", "-DSMAP_SOFT_ROOT"),)
if LONG:
    BUILDS += (("-Os",), ("-O3",), ("-DSMAP_SOFT_ROOT",))
# Many contacts take up to 20 us a query.
CASES = {
    "paper_two": part(300_000),
    "three_leg_sphere": part(300_000),
    "absolem": part(40_000),
    "articulated": part(20_000),
    "legs_by_code": part(100_000),
    "wheels_by_code": part(20_000),
    "tables_float": part(300_000),
}
# The sanitizers run these with the square root in software: points, many contacts, tables.
SOFT = ("paper_two", "absolem", "tables_float")
WHOLE = ("tables_integer",)


@functools.cache
def export_of(name):
    return SUBJECTS[name]()


def host_of(export):
    return Host(describe(export))


def answers(export):
    """Return every status that random queries must bring out."""
    found = {INVALID, OK, TIPS, OFF_RANGE}
    return found | {OFF_CHART} if export.model.faces == 1 else found


@pytest.mark.parametrize("name", CASES)
def test_every_build_of_an_export_gives_the_bits_of_the_host(name, tmp_path):
    export, count = export_of(name), CASES[name]
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, count)
    status, reading = host_of(export).read(params, gravity)
    for flags in BUILDS:
        own_status, own = HostLibrary(tmp_path / "out", (*FLAGS, *flags)).read(params, gravity)
        np.testing.assert_array_equal(own_status, status)
        np.testing.assert_array_equal(own.view(np.uint32), reading.view(np.uint32))
    # All answers occur, each many times; no direction is off a chart of the whole sphere.
    kinds, times = np.unique(status, return_counts=True)
    assert answers(export) <= set(kinds.tolist())
    assert set(kinds.tolist()) <= {*answers(export), ROCKS}
    # Points rock only on slivers: seldom.
    seldom = {ROCKS} if name == "wheels_by_code" else set()
    assert times[~np.isin(kinds, list(seldom))].min() > count // 2000


@pytest.mark.parametrize("name", [name for name in CASES if name != "wheels_by_code"])
def test_the_c_code_is_clean_under_the_sanitizers(name, tmp_path):
    export, count = export_of(name), CASES[name] // 10
    package.write(export, tmp_path / "out")
    params, gravity = random_queries(export.model, count, seed=8)
    # The software square root is what parts without one run.
    root = ("-DSMAP_SOFT_ROOT",) if name in SOFT else ()
    own = HostLibrary(tmp_path / "out", (*FLAGS, *SANITIZERS, *root))
    status, reading = own.read(params, gravity)
    known, known_reading = host_of(export).read(params, gravity)
    np.testing.assert_array_equal(status, known)
    np.testing.assert_array_equal(reading.view(np.uint32), known_reading.view(np.uint32))
    assert answers(export) <= set(status.tolist())


@pytest.mark.parametrize("name", WHOLE)
def test_every_build_gives_the_same_numbers_without_floats(name, tmp_path):
    export, few = export_of(name), part(100_000)
    package.write(export, tmp_path / "out")
    params, gravity = integer_queries(export.model, part(300_000, 2))
    status, reading = host_of(export).read_i(params, gravity)
    found, times = np.unique(status, return_counts=True)
    assert answers(export) <= set(found.tolist())
    assert times.min() > 50
    # The last is how a Cortex-M finds a whole root.
    divides = ("-D__ARM_FEATURE_IDIV=1", "-D__ARM_FEATURE_CLZ=1")
    for flags in (*BUILDS, divides):
        other = HostLibrary(tmp_path / "out", (*FLAGS, *flags)).read_i(params, gravity)
        np.testing.assert_array_equal(other[0], status)
        np.testing.assert_array_equal(other[1], reading)
    clean = HostLibrary(tmp_path / "out", (*FLAGS, *SANITIZERS)).read_i(params[:few], gravity[:few])
    np.testing.assert_array_equal(clean[0], status[:few])
    np.testing.assert_array_equal(clean[1], reading[:few])


EACH = """
void each(int count, const float *x, float *arcsines);
void each(int count, const float *x, float *arcsines)
{
  int i;
  for (i = 0; i < count; i++) {
    arcsines[i] = smap_asin(x[i]);
  }
}
"""


def test_arcsine_is_right_to_3e_7_and_odd(tmp_path):
    (tmp_path / "each.c").write_text(program("points") + EACH)
    compile_c([*FLAGS, "-fPIC", "-shared", "-I", str(RUNTIME), "each.c", "-o", "each.so"], tmp_path)
    x = np.append(np.linspace(-1.0, 1.0, 20_001), 1.5).astype(np.float32)
    values = np.empty_like(x)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (x, values)]
    ctypes.CDLL(str(tmp_path / "each.so")).each(len(x), *pointers)
    *found, beyond = values
    # 3e-7 rad: two roundings near 90 deg, and the polynomial's own error.
    np.testing.assert_allclose(found, np.arcsin(x[:-1].astype(np.float64)), atol=3e-7)
    np.testing.assert_array_equal(found, -np.array(found)[::-1])
    assert beyond == found[-1]


def test_the_cases_are_of_every_codec_and_both_kinds_of_arithmetic():
    seen = {(export_of(name).codec, export_of(name).arithmetic) for name in (*CASES, *WHOLE)}
    assert seen == {*(("contacts", "float"), ("grid", "float"), ("grid", "integer"))}
