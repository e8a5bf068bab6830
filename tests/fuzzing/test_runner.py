"""Runs of the fuzzers: what a case sees, what is measured of it, and what survives it.

Its commands compile nothing, so that a run takes as long as Python takes to start.
"""

from collections.abc import Iterator

import pytest

from proofs.fuzzing import runner as module
from proofs.fuzzing.case import Case
from proofs.fuzzing.judge import fault
from proofs.fuzzing.runner import Runner

SCHEMA = Case("schema", {}, ("schema",))
MISSING = Case("missing", {"r.toml": b""}, ("check", "nowhere.toml"))
NEW = Case("new", {"r.toml": b"mine"}, ("new", "wheels", "-o", "out.toml"))


@pytest.fixture(scope="module")
def runner() -> Iterator[Runner]:
    """Return a runner whose process has imported what these commands need."""
    with Runner() as made:
        made.warm([SCHEMA, NEW])
        yield made


def test_a_case_ends_alike_in_the_warm_process_and_in_one_of_its_own(runner: Runner) -> None:
    warm, own = runner.run(MISSING), runner.run_alone(MISSING)
    assert (warm.code, own.code) == (2, 2)
    assert warm.stderr == own.stderr
    assert fault(MISSING, warm) == fault(MISSING, own) == ""
    assert own.seconds > warm.seconds > 0.0
    assert own.peak > 10 << 20
    assert warm.peak > 10 << 20


def test_what_a_run_says_is_its_own(runner: Runner) -> None:
    first, second = runner.run(SCHEMA), runner.run(MISSING)
    assert '"$schema"' in first.stdout
    assert second.stdout == ""
    assert runner.run(SCHEMA).stdout == first.stdout


def test_a_file_that_was_not_to_be_written_is_found(runner: Runner) -> None:
    assert runner.run(NEW).touched == ("out.toml",)
    asked = Case("new", NEW.files, NEW.words, written=("out.toml",))
    assert runner.run(asked).touched == ()
    assert runner.run_alone(NEW).touched == ("out.toml",)


def test_a_run_that_takes_too_long_is_stopped_and_the_next_one_runs(
    runner: Runner, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(module, "PATIENCE", 0.0)
        late = runner.run(SCHEMA)
    assert late.seconds == float("inf")
    assert fault(SCHEMA, late).startswith("slow")
    assert runner.run(SCHEMA).code == 0
