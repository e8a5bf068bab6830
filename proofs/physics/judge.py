"""Judge the verdict by the physics engine, and print a table for each way to be wrong.

python -m proofs.physics.judge [NAME...] [--all] [--processes N] [--update]

The names are noisy, rocking, ground, holding, rockers; without any, all.  `--all` runs the long
counts (thousands of releases); `--update` writes the tables into docs/measured/judged.md.  Exits
with 1 where a robot fell or moved that was promised not to, and says which.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.pool import Pool
from typing import Any

import mujoco

import lutgen
from proofs.physics import ground, holding, noisy, rockers, rocking
from proofs.physics.page import MEASURED, page
from proofs.physics.slow import lag

PAGE, STORED = MEASURED / "judged.md", MEASURED / "judged.json"
# Chunks of each part: in the few minutes of `make physics`, and with `--all`, where 400 releases of
# every robot over gaps, 200 cars of every noise, and 40 postures of every robot on tilted ground
# are tried.
SHORT = {"noisy": 1, "rocking": 2, "ground": 1, "holding": 2}
LONG = {"noisy": 20, "rocking": 14, "ground": 14, "holding": 25}
LAGS = 20

Result = tuple[str, list[str]]


@dataclass(frozen=True)
class Late:
    """The least and the largest lag (deg) of slow tilts, on three feet."""

    least: float
    most: float


def measured_lag() -> Late:
    """Measure the engine's own lag."""
    late = [math.degrees(one) for one in lag(count=LAGS)]
    return Late(min(late), max(late))


def _chunks(pool: Pool, judged: Callable[[Any, int], Any], names: Sequence[Any], count: int) -> Any:
    """Run chunks of every name, and return one list a name."""
    jobs = [(name, chunk) for name in names for chunk in range(count)]
    found = pool.starmap(judged, jobs, chunksize=1)
    return [[found[k] for k in range(len(jobs)) if jobs[k][0] == name] for name in names]


def judge_noisy(pool: Pool, count: int, late: Late) -> Result:
    """Judge noisy cars."""
    found = _chunks(pool, noisy.judged, noisy.SIGMAS, count)
    rows = noisy.merged([row for rows in found for row in rows])
    return noisy.table(rows), noisy.missed(rows, late.most)


def judge_rocking(pool: Pool, count: int, _: Late) -> Result:
    """Judge releases over gaps."""
    names = list(rocking.ROBOTS)
    found = _chunks(pool, rocking.judged, names, count)
    rows = [
        rocking.row(name, [trial for chunk in chunks for trial in chunk])
        for name, chunks in zip(names, found, strict=True)
    ]
    rows.append(rocking.total(rows))
    return rocking.table(rows), rocking.missed(rows[:-1])


def judge_ground(pool: Pool, count: int, late: Late) -> Result:
    """Judge the guarantee on tilted ground."""
    found = _chunks(pool, ground.judged, ground.ROBOTS, count)
    rows = [
        ground.row(name, [fall for chunk in chunks for fall in chunk], late.least)
        for name, chunks in zip(ground.ROBOTS, found, strict=True)
    ]
    said = f"The slow tilt is late by {late.least:.2f} to {late.most:.2f} deg on three feet.\n\n"
    return said + ground.table(rows), ground.missed(rows)


def judge_holding(pool: Pool, count: int, _: Late) -> Result:
    """Judge wheels on slopes."""
    found = _chunks(pool, holding.judged, list(holding.ROBOTS), count)
    trials = [trial for chunks in found for chunk in chunks for trial in chunk]
    rows = pool.starmap(holding.known, holding.KNOWN, chunksize=1)
    return holding.table(trials, rows), holding.missed(trials, rows)


def judge_rockers(pool: Pool, _: int, late: Late) -> Result:
    """Judge fine rockers: there is one of each."""
    rows = pool.map(rockers.judged, list(rockers.SOLES), chunksize=1)
    return rockers.table(rows), rockers.missed(rows, late.most)


PARTS: dict[str, Callable[[Pool, int, Late], Result]] = {
    "noisy": judge_noisy,
    "rocking": judge_rocking,
    "ground": judge_ground,
    "holding": judge_holding,
    "rockers": judge_rockers,
}


def summary(runs: dict[str, str], faults: Sequence[str]) -> str:
    """Return what was run with what, and what is wrong, as Markdown."""
    lines = []
    for run in sorted(set(runs.values())):
        names = [name for name in PARTS if runs.get(name) == run]
        lines.append(f"Measured with {run}: {', '.join(names)}.")
    if not faults:
        return "\n".join([*lines, "", "No promise was broken."]) + "\n"
    wrong = [f"- {fault}" for fault in faults]
    return "\n".join([*lines, "", "Broken promises:", "", *wrong]) + "\n"


def write(tables: dict[str, str], runs: dict[str, str], faults: Sequence[str]) -> None:
    """Write the tables of the parts that were run into the page; those of others stay."""
    stored = json.loads(STORED.read_text(encoding="utf-8")) if STORED.is_file() else {}
    order = list(PARTS)
    others = [f for f in stored.get("faults", []) if f.partition(":")[0] not in tables]
    stored = {
        "tables": stored.get("tables", {}) | tables,
        "runs": stored.get("runs", {}) | runs,
        "faults": sorted(
            [*others, *faults], key=lambda fault: order.index(fault.partition(":")[0])
        ),
    }
    text = page(PAGE.read_text(encoding="utf-8"), "run", summary(stored["runs"], stored["faults"]))
    for name, content in stored["tables"].items():
        text = page(text, name, content)
    PAGE.write_text(text, encoding="utf-8")
    STORED.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(PARTS))
    parser.add_argument("--all", action="store_true", help="run the long counts")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument(
        "--update", action="store_true", help=f"write {PAGE.name} and {STORED.name}"
    )
    options = parser.parse_args(arguments)
    unknown = sorted(set(options.names) - set(PARTS))
    if unknown:
        parser.error(f"there is no part {', '.join(unknown)}; choose from {', '.join(PARTS)}")
    tables: dict[str, str] = {}
    faults: list[str] = []
    with get_context("spawn").Pool(options.processes) as pool:
        late = measured_lag()
        for name in options.names or PARTS:
            began = time.monotonic()
            count = (LONG if options.all else SHORT).get(name, 1)
            tables[name], wrong = PARTS[name](pool, count, late)
            faults += [f"{name}: {sentence}" for sentence in wrong]
            print(f"{name}\n{tables[name]}\n{time.monotonic() - began:.0f} s\n", flush=True)
    said = f"MuJoCo {mujoco.__version__}, lutgen {lutgen.__version__}"
    print(said)
    if options.update:
        run = f"{said}, {'long' if options.all else 'short'} counts"
        write(tables, {name: run for name in tables}, faults)
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
