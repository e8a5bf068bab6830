"""The bound of each export on the Cortex-M4F, and the longest of 20,000 random reads beside it.

python -m targets.longest [--export NAME,...] [--reads N]

Both count the call from the image as well.  Many contacts are asked a tenth of the reads.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from lutgen.errors import LutgenError
from targets import queries
from targets.boards import board
from targets.cases import COUNTED_ONCE, cases
from targets.image import CellError, build, compiler, execute, run
from targets.loops import shape_of
from targets.run import FEWER, Row, chosen, prepared
from targets.tables import columns
from targets.worst import bound

BOARD, OPTION, READS = "m4f", "-O2", 20_000


@dataclass(frozen=True)
class Longest:
    """Of one call the bound, and the longest that was seen."""

    bound: int
    seen: int


def bounded(row: Row) -> dict[str, int]:
    """Return the bound of each call of a row on the board."""
    on, job = board(BOARD), row.job
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        flags = [*on.flags, OPTION, "-g", "-fno-jump-tables", "-I", str(job.folder)]
        made = [str(job.folder / f"{job.name}.c"), "-c", "-o", "map.o"]
        build([compiler(on), *flags, *made], folder)
        # Not linked with what starts a program: arithmetic that the compiler calls is taken in.
        link = ["-nostartfiles", *on.link, "-Wl,--no-gc-sections", f"-Wl,--entry={job.name}"]
        build([compiler(on), *flags, "map.o", *link, "-o", "image.elf"], folder)
        tool = [f"{on.prefix}objdump", "-dl", "--no-show-raw-insn", "image.elf"]
        listing = run(tool, folder).stdout
    source = (job.folder / "smap.c").read_text(encoding="utf-8")
    return bound(listing, source, shape_of(row.export), job.entries)


def measured(row: Row, reads: int) -> dict[str, int]:
    """Return the longest of random reads by call, an eighth beyond the axes and the chart."""
    params, gravity = queries.counted(row.export, reads, reads // 8)
    rows = queries.as_bytes(row.export, params, gravity)
    job = replace(row.job, rows=rows, checked=0, counted=reads, largest_only=True)
    found = execute(job, board(BOARD), OPTION).counts
    return {call: max(counts) for call, counts in found.items()}


def longest(row: Row, reads: int) -> dict[str, Longest]:
    """Return both, of each call."""
    bounds, seen = bounded(row), measured(row, reads // (FEWER if row.many else 1))
    return {call: Longest(bounds[call], seen[call]) for call in seen}


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.longest", description=__doc__)
    parser.add_argument("--export", metavar="NAME,...", help="of the rows")
    parser.add_argument("--reads", type=int, default=READS)
    options = parser.parse_args(arguments)
    on = board(BOARD)
    if missing := on.missing():
        print(f"SKIPPED the bounds: not installed: apt-get install {' '.join(missing)}")
        return int(os.environ.get("CI") == "true")
    every = {case.name: case for case in cases()}
    names = chosen(options.export, [name for name in every if name not in COUNTED_ONCE], "export")
    try:
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            rows = list(pool.map(lambda name: prepared(every[name]), names))
            found = list(pool.map(lambda row: longest(row, options.reads), rows))
    except (LutgenError, CellError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    print(f"== {on.title}, {OPTION}: bound, and the longest of {options.reads:,} random calls")
    every_call = [
        (f"{name} {call}", one)
        for name, row in zip(names, found, strict=True)
        for call, one in row.items()
    ]
    lines = [
        [label, f"{one.bound:,}", f"{one.seen:,}", f"{one.bound / one.seen:.3g}"]
        for label, one in every_call
    ]
    print(columns(["export", "bound", "seen", "ratio"], lines))
    beyond = [label for label, one in every_call if one.seen > one.bound]
    for label in beyond:
        print(f"FAIL    {label}: took longer than the bound")
    return int(bool(beyond))


if __name__ == "__main__":
    sys.exit(main())
