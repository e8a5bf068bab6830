"""The bound of each export on the Cortex-M4F, and the longest of 100,000 random reads beside it.

python -m targets.longest [--export NAME,...] [--reads N]

Both count the call from the image as well.
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
from targets.cases import cases
from targets.image import CellError, build, compiler, execute, run
from targets.loops import shape_of
from targets.run import Row, chosen, prepared
from targets.tables import columns
from targets.worst import bound

BOARD, OPTION, READS = "m4f", "-O2", 100_000


@dataclass(frozen=True)
class Longest:
    """The bound, and the longest read that was seen."""

    bound: int
    seen: int


def bounded(row: Row) -> int:
    """Return the bound of a row on the board."""
    on, job = board(BOARD), row.job
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        function = "smap_read_i" if job.integer else "smap_read"
        sources = [str(job.folder / "smap.c"), str(job.folder / f"{job.name}.c")]
        flags = [*on.flags, OPTION, "-g", "-ffunction-sections", "-I", str(job.folder)]
        link = ["-nostartfiles", *on.link, "-Wl,--no-gc-sections", f"-Wl,--entry={function}"]
        build([compiler(on), *flags, *sources, *link, "-o", "image.elf"], folder)
        tool = [f"{on.prefix}objdump", "-dl", "--no-show-raw-insn", "image.elf"]
        listing = run(tool, folder).stdout
    source = (job.folder / "smap.c").read_text(encoding="utf-8")
    return bound(listing, source, shape_of(row.export), function)


def measured(row: Row, reads: int) -> int:
    """Return the longest of random reads, an eighth of them beyond the axes and the chart."""
    params, gravity = queries.counted(row.export, reads, reads // 8)
    rows = queries.as_bytes(params, gravity)
    job = replace(row.job, rows=rows, checked=0, counted=reads, largest_only=True)
    return max(execute(job, board(BOARD), OPTION).counts)


def longest(row: Row, reads: int) -> Longest:
    """Return both."""
    return Longest(bounded(row), measured(row, reads))


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
    names = chosen(options.export, list(every), "export")
    try:
        rows = [prepared(every[name]) for name in names]
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            found = list(pool.map(lambda row: longest(row, options.reads), rows))
    except (LutgenError, CellError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    print(f"== {on.title}, {OPTION}: bound, and the longest of {options.reads:,} random reads")
    lines = [
        [name, f"{one.bound:,}", f"{one.seen:,}", f"{one.bound / one.seen:.3g}"]
        for name, one in zip(names, found, strict=True)
    ]
    print(columns(["export", "bound", "seen", "ratio"], lines))
    beyond = [name for name, one in zip(names, found, strict=True) if one.seen > one.bound]
    for name in beyond:
        print(f"FAIL    {name}: a read took longer than the bound")
    return int(bool(beyond))


if __name__ == "__main__":
    sys.exit(main())
