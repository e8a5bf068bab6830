"""The fuzzers of the command line find what is wrong; `make hostile` runs them at length."""

import pytest

from proofs.fuzzing import __main__ as fuzzing
from proofs.fuzzing.run import Case, fault, run

TRACE = 'Traceback (most recent call last):\n  File "x.py", line 7\nValueError: no\n'


@pytest.mark.parametrize(
    ("code", "out", "err", "what"),
    [
        (1, "", TRACE, "traceback"),
        (1, "", "Error: this is a fault of lutgen (got no); run it again\n", "traceback"),
        (1, "", "Error: the memory is not enough\n", "traceback"),
        (-11, "", "", "exit code: -11"),
        (0, '{"sdg": NaN}', "", "output"),
        (0, "no JSON", "", "output"),
        (2, "", "", "exit code: 2"),
        (0, "{}", "lutgen: a\x1b[31m", "message"),
    ],
)
def test_a_run_that_ends_badly_is_told_from_a_good_one(code, out, err, what):
    case = Case(("check", "r.toml", "--json"), {}, frozenset((0, 2)))
    assert fault(case, 0, '{"name": "NaN"}', "") == ""
    assert fault(case, 2, "", "Error: r.toml: robot.name is missing (got nothing)\n") == ""
    assert fault(case, code, out, err).startswith(what)


def test_a_run_sees_its_files_and_one_that_was_not_to_be_written_is_found():
    new = ("new", "wheels", "-o")
    assert run(Case((*new, "mine.toml"), {})) == "files: it left or changed mine.toml"
    assert run(Case((*new, "out.toml"), {"r.toml": b"mine"})) == ""
    assert run(Case(("check", "r.toml"), {}, frozenset((0,)))).startswith("exit code: 2")


def test_a_fault_is_found_and_its_smallest_case_is_kept(monkeypatch, tmp_path):
    # A recipe reader that is offended by a number that no float can hold.
    monkeypatch.setattr(
        fuzzing, "run", lambda case: "bad" if b"1e999" in case.files["r.toml"] else ""
    )
    done, wrong = fuzzing.attack("recipe", 60.0, 1, tmp_path)
    assert done > 1
    assert wrong.endswith(": bad")
    assert b"1e999" in (tmp_path / "r.toml").read_bytes()
