"""The rows of the report: each is a ratio of two times of one run."""

import time
from collections.abc import Callable, Iterable
from statistics import median
from typing import NamedTuple

from targets.marks import markdown

REPEATS = 7
# After a parallel kernel the threads of OpenMP spin for some ms.
PAUSE = 0.005
HEAD = ("case", "threads", "time", "reference", "its time", "ratio", "at most", "")


class Row(NamedTuple):
    """Seconds of ours and of a reference for as much work; `bar` is what their ratio may be."""

    case: str
    threads: int
    ours: float
    reference: str
    theirs: float
    bar: float | None = None

    def cells(self) -> tuple[str, ...]:
        """Return the row in words."""
        ratio = self.ours / self.theirs
        bar = "" if self.bar is None else f"{self.bar:.3g}"
        verdict = "" if self.bar is None else "reached" if ratio <= self.bar else "missed"
        times = (said(self.ours), self.reference, said(self.theirs))
        return (self.case, str(self.threads), *times, f"{ratio:.3g}", bar, verdict)


def said(seconds: float) -> str:
    """Return a time with three digits and its unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def table(rows: Iterable[Row]) -> str:
    """Return rows as a table in Markdown."""
    return markdown(f"| {' | '.join(HEAD)} |", [list(row.cells()) for row in rows])


def interleave(*contenders: Callable[[], object], repeats: int = REPEATS) -> list[float]:
    """Return the median seconds of contenders that take turns, after one run of each.

    What a run returns is called when its time is over, if it can be: that cleans up.
    """

    def timed(run: Callable[[], object]) -> float:
        begin = time.perf_counter()
        left = run()
        taken = time.perf_counter() - begin
        if callable(left):
            left()
        time.sleep(PAUSE)
        return taken

    for run in contenders:
        timed(run)
    rounds = [[timed(run) for run in contenders] for _ in range(repeats)]
    return [median(times) for times in zip(*rounds, strict=True)]
