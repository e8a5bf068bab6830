"""A fault that nobody foresaw ends in a sentence, and an interruption soon."""

import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from lutgen.cli import group, main
from lutgen.cli.recipes import check
from tests.fixtures.commands import run
from tests.fixtures.recipes import tripod


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with a recipe, made the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.toml").write_text(tripod("reach = 2, swing = 2", nodes=3))
    return tmp_path


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
    assert f"{group.UNFORESEEN} (got ZeroDivisionError: by zero in test_faults" in result.stderr
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
        assert "NUMBA_NUM_THREADS: must be a whole number above 0" in run("schema").stderr


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
