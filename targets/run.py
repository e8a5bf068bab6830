"""Run every export on every emulated target; compare hashes and counts with the baseline.

python -m targets.run [--only m4f,avr] [--export NAME,...] [--reads N] [--update]

A cell's hash must be that of the host's C, and no count may be more than 2 % above the baseline.
docs/measured/targets.md explains the columns, and `--update` writes its table.
"""

import argparse
import os
import shutil
import sys
import time
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

from firmware_export.emit.size import identity
from firmware_export.protocol import Export
from lutgen.errors import LutgenError
from targets import baseline, pages, queries
from targets.boards import BOARDS, Board
from targets.cases import Case, cases, written
from targets.digest import answers, fnv1a
from targets.image import Job, execute, version
from tests.fixtures.exports import PosingHost, host_of

# Of many contacts one query in so many is asked for the hash: a posture takes long on small parts.
FEWER, MANY = 10, (5, 6)
# The board that is asked random reads for the longest one.
LONGEST = "m4f"


@dataclass(frozen=True)
class Row:
    """An export that is ready to run: how it is asked, and what the host answers."""

    case: Case
    export: Export
    job: Job
    host: PosingHost
    share: int

    def asked(self, board: Board) -> tuple[Job, int]:
        """Return the job of a board, and the hash that it must give."""
        share, job = self.share * board.sparse, self.job
        params, gravity = (rows[::share] for rows in queries.checked(self.export))
        whole = queries.whole(self.export, params, gravity)
        said = answers(self.host, job.floats, job.integers, (params, gravity), whole)
        rows = queries.as_bytes(self.export, (params, gravity), board.order)
        count = 0
        if self.case.counted and board.unit:
            some = tuple(one[:: board.sparse] for one in queries.counted(self.export))
            count, rows = len(some[0]), rows + queries.as_bytes(self.export, some, board.order)
        return replace(job, rows=rows, checked=len(params), counted=count), fnv1a(said)

    def reads(self, count: int) -> Job:
        """Return a job of so many random reads, of which the longest is counted."""
        rows = queries.as_bytes(self.export, queries.counted(self.export, count, count // 8))
        return replace(self.job, rows=rows, counted=count, longest=True)


def prepared(case: Case) -> Row:
    """Write the folder of a row."""
    export, folder = written(case)
    body = export.body
    job = Job(folder, export.name, export.model.k, not export.integer, True, b"", 0, 0)
    many = body.codec in MANY
    return Row(case, export, job, host_of(export), FEWER if many else 1)


def run_cell(row: Row, board: Board, option: str, reads: int) -> baseline.Cell:
    """Return the numbers of a cell; one that fails or answers otherwise is a LutgenError."""
    job, wanted = row.asked(board)
    outcome = execute(job, board, option)
    if outcome.hash != wanted:
        raise LutgenError(f"hash {outcome.hash:08x}, the host's is {wanted:08x}")
    cell = baseline.numbers(outcome)
    if reads and row.case.counted and board.name == LONGEST and option == board.options[0]:
        (most,) = execute(row.reads(reads), board, option).counts["read"]
        cell["longest"] = max(most, cell["read"][1])
    return cell


def chosen(text: str | None, names: Sequence[str]) -> list[str]:
    """Return the names of a comma-separated option; all without it."""
    wanted = list(names) if text is None else text.split(",")
    if unknown := set(wanted) - set(names):
        raise SystemExit(f"unknown: {', '.join(sorted(unknown))}; use: {', '.join(names)}")
    return wanted


def run(rows: Sequence[Row], boards: Sequence[Board], reads: int) -> tuple[dict[str, Any], int]:
    """Run all cells; return the numbers in the form of the baseline, and how many cells failed."""
    found: dict[str, Any] = {"compilers": {one.name: version(one) for one in boards}, "rows": {}}
    failed = 0
    # The slow emulator first.
    cells = [
        (row, board, option)
        for board in sorted(boards, key=lambda one: -one.sparse)
        for row in rows
        for option in board.options
        if board.name not in row.case.without
    ]
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        futures: list[Future[baseline.Cell]] = [
            pool.submit(run_cell, *cell, reads) for cell in cells
        ]
        for (row, board, option), future in zip(cells, futures, strict=True):
            label = f"{row.case.name} {board.name} {option}"
            try:
                cell = future.result()
            except LutgenError as error:
                failed += 1
                print(f"FAIL    {label}: {error}", flush=True)
                continue
            print(f"ok      {label}: {pages.line(cell)}", flush=True)
            if row.case.counted and board.unit:
                known = found["rows"].setdefault(row.case.name, {"export": identity(row.export)})
                known[f"{board.name} {option}"] = cell
    return found, failed


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the matrix; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.run", description=__doc__)
    parser.add_argument("--only", metavar="BOARD,...", help="of the targets")
    parser.add_argument("--export", metavar="NAME,...", help="of the exports")
    parser.add_argument("--reads", type=int, default=0, help="random reads for the longest one")
    parser.add_argument("--update", action="store_true", help="rewrite counts, pages and README")
    options = parser.parse_args(arguments)
    begin = time.perf_counter()
    every, by_name = {one.name: one for one in cases()}, {one.name: one for one in BOARDS}
    boards = [by_name[name] for name in chosen(options.only, list(by_name))]
    missing = {one for board in boards for one in board.programs if shutil.which(one) is None}
    boards = [board for board in boards if not missing.intersection(board.programs)]
    rows = [prepared(every[name]) for name in chosen(options.export, list(every))]
    found, failed = run(rows, boards, options.reads)
    worse, better = list[str](), list[str]()
    if not options.update:
        worse, better = baseline.compare(baseline.load(), found)
    elif not failed:
        known = {} if not (options.only or options.export) else baseline.load()["rows"]
        compilers = (baseline.load()["compilers"] if known else {}) | found["compilers"]
        merged = {name: known.get(name, {}) | row for name, row in found["rows"].items()}
        baseline.save({"compilers": compilers, "rows": known | merged})
        pages.update(baseline.load())
    if missing:
        print(f"SKIPPED targets: {', '.join(sorted(missing))} are not installed")
    for word, lines in (("WORSE", worse), ("BETTER", better)):
        print("".join(f"{word:<7} {line}\n" for line in lines), end="")
    if worse or better:
        print("Mend it, or say in the commit why, and run `python -m targets.run --update`.")
    took = time.perf_counter() - begin
    print(f"{failed} cells failed, {len(worse)} numbers worse, {len(better)} better ({took:.0f} s)")
    return int(bool(failed or worse or (missing and os.environ.get("CI") == "true")))


if __name__ == "__main__":
    sys.exit(main())
