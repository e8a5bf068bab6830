"""Cases of a kind by Hypothesis, which makes the smallest one of those that go wrong."""

import json
import time
from pathlib import Path

from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from proofs.fuzzing.inputs import KINDS
from proofs.fuzzing.run import Case, run

FAILURES = Path("build/fuzzing")
# Cases between two looks at the clock.
ROUND = 20


def attack(cases: st.SearchStrategy[Case], count: int, number: int, folder: Path) -> None:
    """Run so many cases; raise AssertionError, and keep the smallest, where one goes wrong."""

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(cases)
    def tried(case: Case) -> None:
        if what := run(case):
            folder.mkdir(parents=True, exist_ok=True)
            for name, data in case.files.items():
                (folder / name).write_bytes(data)
            facts = {"what": what, "words": case.words, "must": sorted(case.must)}
            (folder / "case.json").write_text(json.dumps(facts, indent=1), "utf-8")
            raise AssertionError(what)

    tried()


def campaign(kind: str, seconds: float, number: int) -> tuple[int, str]:
    """Return how many cases of a kind were run in the time, and what went wrong, "" if nothing."""
    until, done = time.monotonic() + seconds, 0
    while done == 0 or time.monotonic() < until:
        try:
            attack(KINDS[kind], ROUND, number + done, FAILURES / kind)
        except AssertionError as error:
            return done, str(error)
        done += ROUND
    return done, ""
