"""The fuzzers of the command line find what is wrong; `make hostile` runs them at length."""

from pathlib import Path

import click
import pytest
from hypothesis import Phase, find, settings

from lutgen.cli import main
from proofs.fuzzing import campaign, inputs
from proofs.fuzzing.inputs import KINDS, UNTRIED, command_cases
from proofs.fuzzing.run import Case, fault, run

CASE = Case(("check", "r.toml", "--json"), {}, frozenset((0, 2)))
TRACE = 'Traceback (most recent call last):\n  File "x.py", line 7\nValueError: no\n'
NEW = Case(("new", "wheels", "-o", "out.toml"), {"r.toml": b"mine"})


@pytest.fixture(autouse=True)
def _no_sweep(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let command lines have some file for a map: no kernel is needed to make up words."""
    monkeypatch.setattr(inputs, "swept", lambda: b"a map")


@pytest.mark.parametrize(
    ("code", "out", "err", "what"),
    [
        (1, "", TRACE, "traceback"),
        (1, "", "Error: this is a fault of lutgen (got no); run it again\n", "traceback"),
        (1, "", "Error: the memory is not enough\n", "memory"),
        (-11, "", "", "signal: 11"),
        (-24, "", "", "slow"),
        (3, "{}", "", "exit code"),
        (0, '{"sdg": NaN}', "", "output"),
        (0, "no JSON", "", "output"),
        (2, "", "", "message"),
        (0, "{}", "lutgen: a\x1b[31m", "message"),
    ],
)
def test_a_run_that_ends_badly_is_told_from_a_good_one(
    code: int, out: str, err: str, what: str
) -> None:
    assert fault(CASE, 0, '{"name": "NaN"}', "") == ""
    assert fault(CASE, 2, "", "Error: r.toml: robot.name is missing (got nothing)\n") == ""
    assert fault(CASE, code, out, err).startswith(what)


def test_a_run_sees_its_files_and_one_that_was_not_to_be_written_is_found() -> None:
    assert run(NEW) == "files: it left or changed out.toml"
    assert run(Case(NEW.words, NEW.files, written=("out.toml",))) == ""
    assert run(Case(("check", "r.toml"), {}, frozenset((0,)))).startswith("exit code: 2")


def test_a_fault_is_found_and_its_smallest_case_is_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # A command line that is offended by one word among others.
    monkeypatch.setattr(campaign, "run", lambda case: "offended" if "--json" in case.words else "")
    with pytest.raises(AssertionError, match="offended"):
        campaign.attack(KINDS["command"], 500, 1, tmp_path)
    assert '"what": "offended"' in (tmp_path / "case.json").read_text("utf-8")


@pytest.mark.parametrize("kind", ["recipe", "urdf", "terrain"])
def test_cases_of_a_kind_are_made(kind: str) -> None:
    quick = settings(max_examples=20, phases=[Phase.generate], database=None)
    case = find(KINDS[kind], lambda made: len(made.files) > 1, settings=quick)
    assert case.words[0] in main.commands


def test_every_option_is_tried_but_those_that_start_other_programs() -> None:
    assert isinstance(main, click.Group)
    tried: set[str] = set()
    wanted = {
        option
        for command in main.commands.values()
        for parameter in command.params
        if isinstance(parameter, click.Option) and not UNTRIED & set(parameter.opts)
        for option in parameter.opts
    }
    find(
        command_cases(),
        lambda case: tried.update(case.words) or wanted <= tried,
        settings=settings(max_examples=3000, database=None, phases=[Phase.generate]),
    )
