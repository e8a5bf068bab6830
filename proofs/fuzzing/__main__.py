"""Try every kind of hostile input for its share of the time, and say how many cases were run.

The exit code is 1 where one went wrong; the smallest one that does is left in build/fuzzing/KIND.
"""

import contextlib
import sys
import time
from pathlib import Path

import click
from click.testing import CliRunner
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.errors import Flaky

from lutgen.cli import main as lutgen
from proofs.fuzzing.cases import KINDS, STARTS
from proofs.fuzzing.run import Case, run

QUIET = settings(max_examples=10**6, database=None, deadline=None, report_multiple_bugs=False)
SHORT = settings(QUIET, phases=[Phase.generate, Phase.shrink], suppress_health_check=[*HealthCheck])


class TimeUp(BaseException):
    """The time is up: Hypothesis, which takes exceptions for faults, lets this one through."""


def attack(kind: str, seconds: float, number: int, folder: Path) -> tuple[int, str]:
    """Return how many cases ran in the time, and what is wrong with the smallest one, or ""."""
    until, done, wrong = time.monotonic() + seconds, 0, ""

    @seed(number)
    @SHORT
    @given(KINDS[kind])
    def tried(case: Case) -> None:
        nonlocal done, wrong
        if done and time.monotonic() > until:
            raise TimeUp
        done += 1
        if what := run(case):
            wrong = f"{' '.join(case.words)!r} in {folder}: {what}"
            folder.mkdir(parents=True, exist_ok=True)
            for name, data in case.files.items():
                (folder / name).write_bytes(data)
            raise AssertionError(what)

    with contextlib.suppress(TimeUp, AssertionError, Flaky):
        tried()
    return done, wrong


@click.command(help=__doc__)
@click.option("--seconds", default=600.0, help="For all kinds together.")
@click.option("--seed", "number", default=1)
@click.option("--only", type=click.Choice(list(KINDS)), multiple=True, default=list(KINDS))
def main(seconds: float, number: int, only: tuple[str, ...]) -> None:
    """Try all kinds, or those that are named."""
    for name in ("check", "limits", "metrics"):  # compiles what all that are forked need
        CliRunner().invoke(lutgen, [name, str(STARTS / "legs.toml")])
    bad = False
    for kind in only:
        done, wrong = attack(kind, seconds / len(only), number, Path("build/fuzzing") / kind)
        click.echo(f"{kind}: {done} cases, {wrong or 'nothing went wrong'}")
        bad |= bool(wrong)
    sys.exit(bad)


if __name__ == "__main__":
    main()
