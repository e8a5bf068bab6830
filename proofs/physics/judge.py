"""Judge the verdict by the physics engine, and print a table for each way to be wrong.

python -m proofs.physics.judge [NAME...] [--chunks N] [--update]

The names are agreement, rocking, ground, holding, braking, stopping and swinging; without any,
all.
`--update` writes the tables into docs/measured/physics.md.  Exits with 1 where a promise was
broken, and says which.
"""

import argparse
import sys
import time
from collections import Counter
from multiprocessing import get_context
from multiprocessing.pool import Pool

import mujoco
import numpy as np

import lutgen
from proofs.physics import agreement, braking, ground, holding, rocking, stopping, swinging
from targets.marks import MEASURED, between, markdown

PAGE = MEASURED / "physics.md"
# Each has `ROBOTS`, `tried`, which counts one of them, the `COLUMNS` of its table, of these those
# that have to be 0, `NEVER`, and those that make up a chunk of `CHUNK`, `CASES`.
PARTS = {
    part.__name__.rpartition(".")[2]: part
    for part in (agreement, rocking, ground, holding, braking, stopping, swinging)
}
# Chunks of each robot, in the ten minutes of `make physics`.
CHUNKS = {"agreement": 6, "rocking": 4, "ground": 3, "holding": 2, "braking": 10}
CHUNKS |= {"stopping": 8, "swinging": 6}

Counts = dict[str, Counter[str]]


def judged(name: str, robot: str, chunk: int) -> Counter[str]:
    """Count a chunk of cases of a robot, the same in every run."""
    part = PARTS[name]
    rng = np.random.default_rng([part.SEED, list(part.ROBOTS).index(robot), chunk])
    found: Counter[str] = Counter()
    while sum(found[case] for case in part.CASES) < part.CHUNK:
        found += part.tried(robot, rng)
    return found


def counts(pool: Pool, name: str, chunks: int) -> Counts:
    """Count chunks of every robot of a part."""
    jobs = [(name, robot, chunk) for robot in PARTS[name].ROBOTS for chunk in range(chunks)]
    found: Counts = {robot: Counter() for robot in PARTS[name].ROBOTS}
    for (_, robot, _), one in zip(jobs, pool.starmap(judged, jobs, chunksize=1), strict=True):
        found[robot].update(one)
    found["all"] = sum(found.values(), Counter())
    return found


def table(name: str, found: Counts) -> str:
    """Return the table of a part as Markdown."""
    columns = PARTS[name].COLUMNS
    rows = [[robot, *(f"{one[column]:,}" for column in columns)] for robot, one in found.items()]
    return markdown(f"| robots | {' | '.join(columns)} |", rows)


def missed(name: str, found: Counts) -> list[str]:
    """Return the promises that were broken, one line each."""
    return [
        f"{name}, {robot}: {one[column]} {column}"
        for robot, one in found.items()
        for column in PARTS[name].NEVER
        if one[column] and robot != "all"
    ]


def main() -> int:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(PARTS))
    parser.add_argument("--chunks", type=int, help="so many of each robot, one for a sample")
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}")
    options = parser.parse_args()
    if unknown := sorted(set(options.names) - set(PARTS)):
        parser.error(f"there is no part {', '.join(unknown)}; choose from {', '.join(PARTS)}")
    faults: list[str] = []
    tables = {"run": f"Measured with MuJoCo {mujoco.__version__}, lutgen {lutgen.__version__}."}
    with get_context("spawn").Pool(2) as pool:
        for name in options.names or PARTS:
            began = time.monotonic()
            found = counts(pool, name, options.chunks or CHUNKS[name])
            tables[name] = table(name, found)
            faults += missed(name, found)
            print(f"{name}\n{tables[name]}\n{time.monotonic() - began:.0f} s\n", flush=True)
    print(tables["run"])
    if options.update:
        for name, content in tables.items():
            between(PAGE, name, content)
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
