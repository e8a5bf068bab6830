"""What is too large is refused in a sentence, and no fault ends in a traceback."""

import os
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from lutgen.cli import group, main
from lutgen.cli.check import check
from tests.fixtures.commands import run
from tests.fixtures.recipes import tripod

START = tripod("reach = 2, swing = 2", nodes=3)
# Within this everything is refused that is said to be refused before the work; seconds.
AT_ONCE = 10.0


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with a recipe, made the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.toml").write_text(START)
    return tmp_path


def refused(*arguments: object) -> str:
    """Run a command that must refuse its input at once, in a few lines; return these."""
    start = time.perf_counter()
    result = run(*arguments)
    assert time.perf_counter() - start < AT_ONCE
    assert result.exit_code == 2, result.output
    assert result.stderr.count("\n") <= 13, result.stderr
    return result.stderr


def sampled(count: int) -> str:
    return START.replace("reach = 2", f"reach = {count}")


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (f"a = {'9' * 5000}", "Exceeds the limit (4300 digits)"),
        (f"a = 0x{'f' * 5000}", "a number of 6021 digits"),
        (f"a = {'[' * 100_000}", "more levels than can be read"),
        (f"{'.'.join('a' * 5000)} = 1", "4,999, at most 200 dots"),
        (f"a = {'{b = ' * 150}1{'}' * 150}", "`a`: is not a known key (got {'b': {'b': "),
        (sampled(2**63), "`sweep.samples.reach`: must be 1,000,000 or less"),
        (sampled(10**9), "`sweep.samples.reach`: must be 1,000,000 or less"),
        (START.replace("nodes = 3", "nodes = 15000"), "nodes`: must be 1,024 or less"),
        (
            sampled(10**6)
            .replace("swing = 2", "swing = 1000000")
            .replace('"cone"\nnodes = 3\nmax_tilt = 50.0', '"sphere"\nnodes = 1024'),
            "4,611,686,018,427,387,904 nodes of a map",
        ),
        (
            START.replace("[sweep]", "[[robot.force]]\n" * 10_001 + "[sweep]"),
            "takes at most 10,000 entries",
        ),
        (
            f"{START}\n[export]\nmax_error = 1e300",
            "`export.max_error`: must be 1,000,000,000,000 or less",
        ),
    ],
    ids=lambda value: value[:24],
)
def test_a_recipe_beyond_a_bound_is_refused_before_memory_is_taken(text: str, fault: str) -> None:
    Path("r.toml").write_text(text)
    assert fault in refused("check", "r.toml")


def test_a_device_without_an_end_is_a_file_too_long() -> None:
    assert "more than 4,194,304 bytes" in refused("check", "/dev/zero")
    assert "67,108,864 bytes of a terrain" in refused("path", "r.toml", "--terrain", "/dev/zero")


@pytest.mark.parametrize(
    "arguments",
    [
        ("path", "--points", "1000000000"),
        ("path", "--headings", "1000000000"),
        ("limits", "--best", "--headings", "100000000"),
        ("limits", "--headings", str(4 * 10**30)),
        ("metrics", "--headings", "1000000000"),
        ("optimum", "--levels", "1000000"),
    ],
    ids=" ".join,
)
def test_a_number_beyond_a_bound_is_refused_before_the_work(
    folder: Path, arguments: tuple[str, ...]
) -> None:
    command, *rest = arguments
    refused(command, "r.toml", *rest)
    assert [path.name for path in folder.iterdir()] == ["r.toml"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("eval", "-p", "reach=1e300"),
        ("eval", "-p", "reach=\u0661"),
        ("eval", "-a", "1e300,0,0"),
        ("eval", "-g", "0,0,-1e300"),
        ("limits", "--headings", "\u0661\u0662"),
        ("metrics", "--tilt", "nan"),
        ("metrics", "--headings", "\u0664"),
        ("optimum", "--limit", "1e13"),
    ],
    ids=ascii,
)
def test_numbers_are_plain_digits_up_to_1e12(arguments: tuple[str, ...]) -> None:
    command, option, number = arguments
    assert "up to 1e12" in refused(command, "r.toml", option, number)


def test_underscores_part_digits_as_in_toml() -> None:
    plain, parted = (run("eval", "r.toml", "-p", f"swing={one}") for one in ("10", "1_0"))
    assert plain.stdout == parted.stdout != ""


def test_a_parameter_beyond_its_limits_is_refused_by_every_command_and_in_its_unit() -> None:
    for command in ("eval", "limits", "metrics"):
        said = refused(command, "r.toml", "-p", "swing=51")
        assert "swing must lie in -40 to 50 deg (got -p swing=51)" in said


def test_limits_of_more_postures_than_fit_are_refused_before_a_row_is_made() -> None:
    Path("r.toml").write_text(START.replace("reach = 2, swing = 2", "reach = 99999, swing = 99999"))
    assert "50,000,000 postures times headings" in refused("limits", "r.toml", "--all")


def test_a_far_away_centre_of_mass_ends_within_seconds() -> None:
    for far in ("1e300", "1e12"):
        text = START.replace("com = [0.02,", f"com = [{far},")
        assert far in text
        Path("r.toml").write_text(text)
        start = time.perf_counter()
        run("limits", "r.toml")
        assert time.perf_counter() - start < AT_ONCE


# the last resort


def failing(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    """Let `lutgen check` end in an error that nobody foresaw."""

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(check, "callback", fail)


def test_a_fault_of_lutgen_is_a_sentence_and_a_traceback_with_v(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failing(monkeypatch, ZeroDivisionError("by\nzero"))
    result = CliRunner().invoke(main, ["check", "r.toml"])
    assert result.exit_code == group.FAILED
    assert result.stderr.count("\n") == 1
    assert f"{group.UNFORESEEN} (got ZeroDivisionError: by zero in test_bounds" in result.stderr
    assert "lutgen -v" in result.stderr
    said = subprocess.run(
        [sys.executable, "-c", PROGRAM, "-v"], capture_output=True, text=True, check=False
    )
    assert said.returncode == group.FAILED
    assert "Traceback" in said.stderr
    assert group.UNFORESEEN in said.stderr


# As the command line, with one that fails.
PROGRAM = """
import sys
from lutgen.cli.group import main
@main.command("fail")
def fail(): 1 / 0
main([*sys.argv[1:], "fail"])
"""


def test_too_little_memory_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    failing(monkeypatch, MemoryError("Unable to allocate 80 GiB"))
    result = CliRunner().invoke(main, ["check", "r.toml"])
    assert result.exit_code == group.FAILED
    assert "the memory is not enough (got Unable to allocate 80 GiB)" in result.stderr


def test_a_setting_that_numba_would_trip_over_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    for threads in ("0", "-1", "many", ""):
        monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
        assert "NUMBA_NUM_THREADS: must be a whole number above 0" in refused("schema")


@pytest.mark.parametrize("arguments", [["schema"], ["--help"]])
def test_a_full_disk_or_a_reader_that_has_gone_ends_with_a_status(arguments: list[str]) -> None:
    command = [sys.executable, "-m", "lutgen", *arguments]
    with Path("/dev/full").open("w") as full:
        said = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert said.returncode == 1
    assert said.stderr == "Error: the output cannot be written (got No space left on device).\n"
    reader, writer = os.pipe()
    os.close(reader)
    said = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert (said.returncode, said.stderr) == (1, "")


def test_nothing_of_click_is_a_fault_of_lutgen() -> None:
    assert issubclass(click.exceptions.Exit, RuntimeError)
    assert run("check", "--no-such-option").exit_code == 2
    assert run("--version").exit_code == 0
