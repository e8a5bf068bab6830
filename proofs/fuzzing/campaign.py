"""Many cases of every kind, judged, and what was found of them.

Owns how they are shared among processes.  The result does not depend on that: a case depends on
its kind, the seed and its number alone.
"""

import dataclasses
import json
import math
import os
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.util import Finalize
from pathlib import Path

from proofs.fuzzing.attacks import alone, attacks
from proofs.fuzzing.case import Case, Outcome
from proofs.fuzzing.judge import fault
from proofs.fuzzing.kinds import KINDS
from proofs.fuzzing.runner import Runner
from proofs.fuzzing.shrink import shrunk

__all__ = ["ATTACKS", "Found", "Tally", "Task", "campaign", "distinct", "tried"]

ATTACKS = "attack"
# Every so many cases one is run again in a process of its own, and has to end alike.
ALONE = 200
# Cases that one process takes at a time.
SHARE = 100


@dataclass(frozen=True)
class Task:
    """Cases `first` to `last` of a kind; none of them begins after `until` (time.time)."""

    kind: str
    seed: int
    first: int
    last: int
    until: float = math.inf
    failures: str = "build/fuzzing"


@dataclass(frozen=True)
class Found:
    """A fault, and the folder that holds the smallest input that shows it."""

    kind: str
    at: int
    what: str
    folder: str


@dataclass
class Tally:
    """What the cases of one kind came to."""

    cases: int = 0
    processes: int = 0
    codes: Counter[int] = field(default_factory=Counter)
    seconds: float = 0.0
    slowest: float = 0.0
    peak: int = 0
    found: list[Found] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        """Take in what other cases came to."""
        self.cases += other.cases
        self.processes += other.processes
        self.codes += other.codes
        self.seconds += other.seconds
        self.slowest = max(self.slowest, other.slowest)
        self.peak = max(self.peak, other.peak)
        self.found += other.found


_RUNNER: Runner | None = None
_SHOWN: set[str] = set()


def _runner() -> Runner:
    """Return this process's own, warm: each command was run once on sound input."""
    global _RUNNER
    if _RUNNER is None:
        _RUNNER = Runner()
        # Processes of a pool end without their `atexit`.
        Finalize(None, _RUNNER.close, exitpriority=10)
        _RUNNER.warm(WARM)
    return _RUNNER


def _warm() -> list[Case]:
    from proofs.fuzzing.seeds import DESCRIPTIONS, MESH, STANCE, TERRAIN, recipes, swept

    texts = {"r.toml": recipes()["tripod"], "s.toml": STANCE, "t.csv": TERRAIN}
    files = {name: text.encode() for name, text in texts.items()}
    files |= {"m.h5": swept(), "mast.stl": MESH, "r.urdf": DESCRIPTIONS["crane.urdf"].encode()}
    lines = (
        "check r.toml --json",
        "eval r.toml --json",
        "eval m.h5 --json",
        "limits r.toml --json",
        "metrics r.toml --json",
        "wheels r.toml -v 0.1,0",
        "optimum r.toml --levels 2",
        "optimum m.h5 --method map",
        "optimum r.toml --method nelder-mead",
        "stance s.toml --json",
        "path r.toml --terrain t.csv --json",
        "path r.toml --terrain t.csv --method nelder-mead",
        "sweep r.toml -o out.h5 --threads 1",
        "info m.h5 --verify",
        "import r.urdf -o out.toml",
        "plot m.h5 --kind contour -o out.svg",
        "plot m.h5 --kind sphere -o out.svg",
    )
    outputs = ("out.h5", "out.toml", "out.svg")
    return [Case("warm", files, tuple(line.split()), written=outputs) for line in lines]


WARM: list[Case] = []


def tried(task: Task) -> tuple[str, Tally]:
    """Run the cases of a task, in this process's warm one."""
    WARM[:] = WARM or _warm()
    runner, tally = _runner(), Tally()
    listed = [*attacks(), *alone()] if task.kind == ATTACKS else []
    for at in range(task.first, task.last):
        if time.time() > task.until:
            break
        case = listed[at] if listed else KINDS[task.kind].case(task.seed, at)
        own = bool(case.environment)
        outcome = runner.run_alone(case) if own else runner.run(case)
        what = fault(case, outcome)
        tally.cases += 1
        tally.codes[outcome.code] += 1
        tally.seconds += outcome.seconds if math.isfinite(outcome.seconds) else 0.0
        tally.slowest = max(tally.slowest, outcome.seconds)
        tally.peak = max(tally.peak, outcome.peak)
        if not what and at % ALONE == ALONE - 1:
            what = _again(runner, case, outcome)
            tally.processes += 1
        if what:
            tally.found.append(_kept(runner, task, at, case, what))
    return task.kind, tally


def _again(runner: Runner, case: Case, before: Outcome) -> str:
    """Run a case as users do, in a process of its own: the same has to come of it."""
    outcome = runner.run_alone(case)
    what = fault(case, outcome)
    if not what and outcome.code != before.code:
        what = f"exit code: {before.code} in a warm process, {outcome.code} in its own"
    return what


def _kept(runner: Runner, task: Task, at: int, case: Case, what: str) -> Found:
    """Write a failure down, with the smallest input for one that was not seen before."""
    where = Path(task.failures) / task.kind / str(at)
    if what not in _SHOWN and len(_SHOWN) < 40 and not case.environment:
        _SHOWN.add(what)
        if not what.startswith(("slow", "memory")):
            case = shrunk(case, lambda less: fault(less, runner.run(less)) == what)
    where.mkdir(parents=True, exist_ok=True)
    for name, data in case.files.items():
        (where / name).write_bytes(data)
    facts = {"what": what, "words": case.words, "label": case.label, "must": sorted(case.must)}
    (where / "case.json").write_text(json.dumps(facts, indent=1), "utf-8")
    return Found(task.kind, at, what, str(where))


def _tasks(counts: dict[str, int], seed: int, until: float, failures: Path) -> list[Task]:
    """Return all shares, the kinds in turn, so that each gets its part where time runs out."""
    shares: list[tuple[float, Task]] = []
    for kind, count in counts.items():
        size = min(SHARE, max(count // 40, 5))
        for first in range(0, count, size):
            last = min(first + size, count)
            shares.append((last / count, Task(kind, seed, first, last, until, str(failures))))
    return [task for _, task in sorted(shares, key=lambda share: share[0])]


def campaign(
    counts: dict[str, int], seed: int, seconds: float, failures: Path, jobs: int = 2
) -> dict[str, Tally]:
    """Run so many cases of each kind, or as many as fit into the time.

    Parameters
    ----------
    counts : dict
        How many cases of each kind.
    seed : int
        Of the cases.
    seconds : float
        After which no case is begun; infinite for none.
    failures : path
        The folder for inputs that showed a fault.
    jobs : int
        Processes.

    Returns
    -------
    dict of Tally
        By kind, also "attack": those are always tried.
    """
    until = time.time() + seconds
    listed = len(attacks()) + len(alone())
    tasks = [Task(ATTACKS, seed, i, i + 1, math.inf, str(failures)) for i in range(listed)]
    tasks += _tasks(counts, seed, until, failures)
    found: dict[str, Tally] = {ATTACKS: Tally(), **{kind: Tally() for kind in counts}}
    with ProcessPoolExecutor(jobs, get_context("spawn"), initializer=_quiet) as pool:
        for kind, tally in pool.map(tried, tasks):
            found[kind].add(tally)
    return found


def _quiet() -> None:
    os.environ.setdefault("PYTHONWARNINGS", "ignore")


def distinct(found: Iterable[Found]) -> Sequence[Found]:
    """Return one of each fault: that with the smallest number."""
    first: dict[tuple[str, str], Found] = {}
    for each in found:
        first.setdefault((each.kind, each.what), each)
    return [dataclasses.replace(each) for each in first.values()]
