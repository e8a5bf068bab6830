"""Judge the verdict by the physics engine, and print a table for each way to be wrong.

python -m proofs.physics.judge [NAME...] [--chunks N] [--update] [--processes N]

The names are agreement, rocking, ground, holding and braking; without any, all.  `--update` writes
the tables into docs/measured/physics.md.  Exits with 1 where a promise was broken, and says which.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from multiprocessing import get_context
from multiprocessing.pool import Pool

import mujoco

import lutgen
from proofs.physics import agreement, braking, ground, holding, rocking
from proofs.physics.page import MEASURED, page

PAGE = MEASURED / "physics.md"
# Each has `ROBOTS`, `judged`, which counts a chunk of one of them, the `COLUMNS` of its table, and
# `NEVER`, those that have to be 0.
PARTS = {
    "agreement": agreement,
    "rocking": rocking,
    "ground": ground,
    "holding": holding,
    "braking": braking,
}
# Chunks of each robot, in the ten minutes of `make physics`.
CHUNKS = {"agreement": 6, "rocking": 4, "ground": 3, "holding": 2, "braking": 10}

Counts = dict[str, Counter[str]]


def counts(pool: Pool, name: str, chunks: int) -> Counts:
    """Count chunks of every robot of a part."""
    part = PARTS[name]
    jobs = [(robot, chunk) for robot in part.ROBOTS for chunk in range(chunks)]
    found: Counts = {robot: Counter() for robot in part.ROBOTS}
    for (robot, _), one in zip(jobs, pool.starmap(part.judged, jobs, chunksize=1), strict=True):
        found[robot].update(one)
    found["all"] = sum(found.values(), Counter())
    return found


def table(name: str, found: Counts) -> str:
    """Return the table of a part as Markdown."""
    columns = PARTS[name].COLUMNS
    lines = [f"| robots | {' | '.join(columns)} |", "|---" * (len(columns) + 1) + "|"]
    for robot, one in found.items():
        lines.append(f"| {robot} | {' | '.join(f'{one[column]:,}' for column in columns)} |")
    return "\n".join(lines) + "\n"


def missed(name: str, found: Counts) -> list[str]:
    """Return the promises that were broken, one line each."""
    return [
        f"{name}, {robot}: {one[column]} {column}"
        for robot, one in found.items()
        for column in PARTS[name].NEVER
        if one[column] and robot != "all"
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(PARTS))
    parser.add_argument("--chunks", type=int, help="so many of each robot, one for a sample")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}")
    options = parser.parse_args(arguments)
    if unknown := sorted(set(options.names) - set(PARTS)):
        parser.error(f"there is no part {', '.join(unknown)}; choose from {', '.join(PARTS)}")
    faults: list[str] = []
    tables = {"run": f"Measured with MuJoCo {mujoco.__version__}, lutgen {lutgen.__version__}.\n"}
    with get_context("spawn").Pool(options.processes) as pool:
        for name in options.names or PARTS:
            began = time.monotonic()
            found = counts(pool, name, options.chunks or CHUNKS[name])
            tables[name] = table(name, found)
            faults += missed(name, found)
            print(f"{name}\n{tables[name]}{time.monotonic() - began:.0f} s\n", flush=True)
    print(tables["run"], end="")
    if options.update:
        text = PAGE.read_text(encoding="utf-8")
        for name, content in tables.items():
            text = page(text, name, content)
        PAGE.write_text(text, encoding="utf-8")
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
