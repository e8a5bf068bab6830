"""The compiled C of an export, asked from Python."""

from pathlib import Path

import numpy as np
import pytest

from firmware_export.emit import package
from firmware_export.protocol import Export
from lutgen.errors import ExportError, InputError
from proofs.exports import rover_export, tripod_export
from targets.compiled import HostLibrary

OK, TIPS, OFF_CHART, OFF_RANGE, INVALID = 0, 2, 3, 5, -1
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O0")


@pytest.fixture(scope="module")
def export() -> Export:
    """Return a small export."""
    return tripod_export("feet")


@pytest.fixture(scope="module")
def folder(export: Export, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return its folder, which no test changes."""
    place = tmp_path_factory.mktemp("host") / "feet"
    package.write(export, place)
    return place


def queries(export: Export, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return random queries inside the box and chart, float32."""
    rng = np.random.default_rng(5)
    model = export.model
    params = rng.uniform(model.lower, model.upper, (count, model.k))
    limit = model.chart_limit
    u, v = rng.uniform(-limit, limit, (2, count))
    gravity = np.stack([u, v, np.full(count, -1.0)], axis=1)
    return params.astype(np.float32), gravity.astype(np.float32)


def test_the_c_code_answers_what_is_true(export: Export, folder: Path) -> None:
    params, gravity = queries(export, 2000)
    status, reading = HostLibrary(folder).read(params, gravity)
    exact = export.model.exact(params, gravity[:, None])
    stands = status == OK
    assert stands.mean() > 0.1
    assert set(status) == {OK, TIPS}
    assert np.all(exact.tip_angle[stands, 0] >= 0.0)
    # Some ten times the largest position error of these small tables.
    np.testing.assert_allclose(reading[stands, 0], exact.sdg[stands, 0], atol=0.01)
    np.testing.assert_allclose(reading[stands, 2], exact.height[stands, 0], atol=0.01)
    guard = float(export.tables.guard)
    np.testing.assert_allclose(reading[stands, 1], exact.tip_angle[stands, 0] - guard, atol=0.01)
    assert np.isnan(reading[~stands][:, [0, 2]]).all()


def test_an_integer_export_is_asked_with_integers(tmp_path: Path) -> None:
    export = tripod_export("whole", codec="grid", arithmetic="integer")
    package.write(export, tmp_path / "whole")
    params, gravity = queries(export, 2000)
    model = export.model
    params_q = np.rint((params - model.lower) / (model.upper - model.lower) * 32767)
    gravity_q = np.rint(gravity * 1000)
    library = HostLibrary(tmp_path / "whole")
    status, reading = library.read_i(params_q, gravity_q)
    params = model.lower + params_q / 32767 * (model.upper - model.lower)
    exact = model.exact(params, gravity_q[:, None])
    stands = status == OK
    assert stands.any()
    assert np.all(exact.tip_angle[stands, 0] >= 0.0)
    # A lower bound of the angle: its sine, interpolated from below; half a step for rounding.
    assert np.all(reading[stands, 1] / 32767 <= np.sin(exact.tip_angle[stands, 0]) + 0.5 / 32767)
    assert np.all(reading[stands][:, [0, 2]] == 65535)
    alone_status, alone = library.run_driver(params_q, gravity_q, SANITIZERS)
    np.testing.assert_array_equal(alone_status, status)
    np.testing.assert_array_equal(alone, reading)
    with pytest.raises(InputError, match="use read_i"):
        library.read(params, gravity)


def test_what_is_no_query_is_answered_as_unsafe(folder: Path) -> None:
    library = HostLibrary(folder)
    inf, nan = np.inf, np.nan
    cases = [
        ((0.3, 0.1), (0, 0, 0), INVALID),
        ((0.3, 0.1), (nan, 0, -1), INVALID),
        ((0.3, 0.1), (0, -inf, -1), INVALID),
        ((nan, 0.1), (0, 0, -1), INVALID),
        ((0.3, inf), (0, 0, -1), INVALID),
        ((0.3, 0.1), (0, 0, 1), OFF_CHART),
        ((0.3, 0.1), (5, 0, -1), OFF_CHART),
        ((9.0, 0.1), (0, 0, -1), OFF_RANGE),
    ]
    status, reading = library.read([c[0] for c in cases], [c[1] for c in cases])
    assert status.tolist() == [c[2] for c in cases]
    assert np.all(reading[:, 1] < 0.0)
    assert np.isnan(reading[:, 0]).all()


def test_a_program_with_sanitizers_answers_the_same_and_finds_no_fault(
    export: Export, folder: Path
) -> None:
    params, gravity = queries(export, 500)
    params[::7, 0] = np.nan
    gravity[::11, 1] = np.inf
    gravity[::13] = 0.0
    params[::5, 1] = 1e30
    gravity[::17] *= np.float32(1e-38)
    library = HostLibrary(folder)
    status, reading = library.read(params, gravity)
    alone_status, alone = library.run_driver(params, gravity, SANITIZERS)
    np.testing.assert_array_equal(alone_status, status)
    np.testing.assert_array_equal(alone.view(np.uint32), reading.view(np.uint32))
    assert {OK, OFF_RANGE, INVALID} <= set(status.tolist())


def test_a_fault_of_the_code_is_an_error_of_the_driver(folder: Path, tmp_path: Path) -> None:
    package.write(tripod_export("feet"), tmp_path / "feet")
    source = tmp_path / "feet" / "feet.c"
    text = source.read_text()
    # Room for one parameter less than the map has: the runtime then writes beyond its array.
    fault = text.replace("#define SMAP_MAX_PARAMS 2", "#define SMAP_MAX_PARAMS 1")
    assert fault != text
    source.write_text(fault)
    with pytest.raises(ExportError, match="failed"):
        HostLibrary(tmp_path / "feet").run_driver([[0.1, 0.1]], [[0, 0, -1]], SANITIZERS)


def test_two_exports_of_one_name_do_not_mix(folder: Path, tmp_path: Path) -> None:
    package.write(tripod_export("feet", codec="grid"), tmp_path / "feet")
    one, other = HostLibrary(folder), HostLibrary(tmp_path / "feet")
    point = ([[0.31, 0.2]], [[0.1, 0.1, -1.0]])
    first, second = one.read(*point)[1], other.read(*point)[1]
    assert first.tobytes() != second.tobytes()
    assert one.read(*point)[1].tobytes() == first.tobytes()


def test_a_robot_without_parameters_to_spare_is_read_too(tmp_path: Path) -> None:
    export = rover_export()
    package.write(export, tmp_path / "out")
    params, gravity = queries(export, 200)
    status, _ = HostLibrary(tmp_path / "out").read(params, gravity)
    assert set(status.tolist()) <= {OK, TIPS}
    assert (status == OK).any()


# faults


def test_a_missing_compiler_is_one_sentence(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler -O2")
    with pytest.raises(ExportError, match="no-such-compiler: the C compiler cannot be run"):
        HostLibrary(folder).read([[0.1, 0.1]], [[0, 0, -1]])


def test_the_compiler_of_the_environment_is_used(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "cc -include no_such_file.h")
    with pytest.raises(ExportError, match="no_such_file"):
        HostLibrary(folder).read([[0.1, 0.1]], [[0, 0, -1]])


def test_queries_of_another_shape_are_refused(folder: Path) -> None:
    library = HostLibrary(folder)
    for params, gravity in (
        ([[0.1]], [[0, 0, -1]]),
        ([[0.1, 0.1]], [[0, 0]]),
        ([[0.1, 0.1]], [[0, 0, -1], [0, 0, -1]]),
        ([0.1, 0.1], [0, 0, -1]),
    ):
        with pytest.raises(InputError, match="must have the shapes"):
            library.read(params, gravity)


def test_floats_are_not_asked_with_integers(folder: Path) -> None:
    with pytest.raises(InputError, match=r"use read\."):
        HostLibrary(folder).read_i([[0, 0]], [[0, 0, -1]])


def test_a_folder_that_is_no_export_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no folder of `lutgen export`"):
        HostLibrary(tmp_path)
