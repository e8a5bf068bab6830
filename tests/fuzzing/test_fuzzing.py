"""The fuzzers of the command line: that they try everything, find what is wrong, and repeat it.

A campaign is `make hostile`; a sample of it is a step of continuous integration.
"""

import dataclasses
import tomllib

import click
import pytest

from lutgen.cli import main
from proofs.fuzzing import commands, recipes, seeds, shrink
from proofs.fuzzing.attacks import attacks
from proofs.fuzzing.campaign import Tally
from proofs.fuzzing.case import Case, Outcome
from proofs.fuzzing.judge import FAULTS, fault
from proofs.fuzzing.kinds import KINDS
from proofs.fuzzing.page import page, with_rows
from proofs.fuzzing.worker import MEMORY

GOOD = Outcome(0, '{"sdg": 0.5}', "", 0.1, 300 << 20)
CASE = Case("any", {}, ("check", "r.toml", "--json"), frozenset((0, 2)))
TRACE = """Traceback (most recent call last):
  File "/x/lutgen/grid.py", line 7, in knots
ValueError: no
"""
UNFORESEEN = (
    "Error: this is a fault of lutgen (got ValueError: no in grid.py, line 7); run it again\n"
)


@pytest.fixture(autouse=True)
def _no_sweep(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let command lines have some file for a map: no kernel is needed to make up words."""
    commands._files.cache_clear()
    monkeypatch.setattr(commands, "swept", lambda name: b"map of " + name.encode())
    yield
    commands._files.cache_clear()


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"stderr": TRACE, "code": 1}, "traceback: ValueError at lutgen/grid.py:7"),
        ({"stderr": UNFORESEEN, "code": 1}, "traceback: ValueError: no"),
        ({"code": -11}, "signal: 11"),
        ({"seconds": 21.0}, "slow"),
        ({"seconds": float("inf"), "code": -9}, "slow"),
        ({"peak": MEMORY + 1}, "memory"),
        ({"code": 3}, "exit code"),
        ({"stdout": '{"sdg": NaN}'}, "output"),
        ({"stdout": "no JSON"}, "output"),
        ({"code": 2, "stdout": ""}, "message"),
        ({"stderr": "lutgen: a\x1b[31m"}, "message"),
        ({"touched": ("it ran",)}, "files"),
    ],
)
def test_a_run_that_ends_badly_is_told_from_a_good_one(change: dict, what: str) -> None:
    assert fault(CASE, GOOD) == ""
    found = fault(CASE, dataclasses.replace(GOOD, **change))
    assert found.startswith(what)
    assert found.startswith(FAULTS)


def test_a_refusal_in_one_sentence_is_no_fault() -> None:
    refused = Outcome(2, "", "Error: r.toml: robot.name is missing (got nothing); add it\n", 0.1, 0)
    assert fault(CASE, refused) == ""


@pytest.mark.parametrize("kind", ["recipe", "urdf", "csv", "command"])
def test_a_case_depends_on_its_kind_seed_and_number_alone(kind: str) -> None:
    made = KINDS[kind]
    later = [made.case(1, at) for at in (7, 3, 40)]
    assert later == [made.case(1, at) for at in (7, 3, 40)]
    assert made.case(2, 7) != later[0]
    assert len({(case.words, *case.files.values()) for case in later}) == 3


def test_every_command_and_every_option_is_tried_but_those_that_start_other_programs() -> None:
    assert isinstance(main, click.Group)
    expected = {
        (name, option)
        for name, command in main.commands.items()
        for parameter in command.params
        if isinstance(parameter, click.Option) and not set(commands.UNTRIED) & set(parameter.opts)
        for option in parameter.opts
    }
    cases = [KINDS["command"].case(1, at).words for at in range(5000)]
    tried = {(words[0], word) for words in cases for word in words}
    tried |= {(words[1], word) for words in cases if len(words) > 1 for word in words}
    assert expected - tried == set()


def test_what_is_surely_wrong_is_toml_and_must_be_refused() -> None:
    cases = [case for at in range(300) if (case := KINDS["recipe"].case(1, at)).must == {2}]
    assert len(cases) > 10
    for case in cases:
        text = case.files["r.toml"].decode()
        tomllib.loads(text)
        assert "no_such_key" in text or "nan" in text or "inf" in text


def test_a_recipe_of_every_change_is_made() -> None:
    import random

    labels = {
        word
        for at in range(1500)
        for word in recipes.mutated(random.Random(at), seeds.recipes()["rover"])[1].split()
    }
    named = {change.__name__.strip("_") for change in recipes.CHANGES}
    assert named | {"deep", "bytes", "line"} <= labels


def test_the_smallest_input_has_nothing_in_it_that_is_not_needed() -> None:
    text = "".join(f"key{i} = {i}\n" for i in range(40)).replace("17\n", "17 # bad\n")
    case = Case(
        "big", {"r.toml": text.encode(), "spare": b"1"}, ("check", "r.toml", "--json", "-h")
    )
    less = shrink.shrunk(case, lambda tried: b"bad" in tried.files.get("r.toml", b""))
    assert (less.files, less.words) == ({"r.toml": b"bad"}, ("check",))


def test_what_once_went_wrong_is_on_the_list(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("proofs.fuzzing.attacks.swept", lambda: b"lutgen-digest-2 GCOL" + bytes(99))
    labels = [case.label for case in attacks()]
    assert len(set(labels)) == len(labels) >= 20
    assert all(case.must for case in attacks())


def test_a_campaign_of_one_kind_writes_its_own_row_and_no_other() -> None:
    both = {kind: Tally(cases=7) for kind in ("urdf", "map")}
    text = page({kind: Tally(cases=KINDS[kind].count) for kind in KINDS}, 1)
    new = with_rows(text, both)
    old_lines, lines = text.splitlines(), new.splitlines()
    changed = [i for i, line in enumerate(lines) if line != old_lines[i]]
    assert [lines[i].split("|")[1:3] for i in changed] == [
        [f" {KINDS[kind].title} ", " 7 "] for kind in both
    ]
    assert with_rows(new, {}) == new
