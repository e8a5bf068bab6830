"""Times of several contenders that take turns, so that whatever else the machine does hits all."""

import time
from collections.abc import Callable, Mapping
from statistics import median
from typing import NamedTuple

REPEATS = 7
# After a parallel kernel OpenMP's threads spin for some ms, waiting for the next; whoever comes
# after it would pay for that.
PAUSE = 0.005


class Times(NamedTuple):
    """Wall times of one contender in seconds: median and best."""

    median: float
    best: float


def interleave(
    contenders: Mapping[str, Callable[[], object]], repeats: int = REPEATS, warm: bool = True
) -> dict[str, Times]:
    """Time every contender `repeats` times in turns; `warm` runs each once before that.

    What a run returns is called when its time is over, if it can be: that cleans up.
    """

    def timed(run: Callable[[], object]) -> float:
        begin = time.perf_counter()
        left = run()
        taken = time.perf_counter() - begin
        if callable(left):
            left()
        return taken

    if warm:
        for run in contenders.values():
            timed(run)
    taken: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(repeats):
        for name, run in contenders.items():
            time.sleep(PAUSE)
            taken[name].append(timed(run))
    return {name: Times(median(every), min(every)) for name, every in taken.items()}
