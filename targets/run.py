"""Run every export on every emulated target; compare hashes and counts; print the tables.

python -m targets.run [--only m4f,m3] [--export NAME] [--update] [--strict] [--json FILE]

What each row and column is, and what the numbers mean: docs/measured/targets.md.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from firmware_export.emit.facts import COUNTS
from firmware_export.emit.runtime import features
from firmware_export.emit.source import body_of
from firmware_export.host import Host
from firmware_export.protocol import Export, describe
from lutgen.errors import InputError, LutgenError
from targets import asked as goals
from targets import baseline, costs, queries, tables
from targets.boards import BOARDS, OPTIMISATIONS, Board
from targets.cases import ROOT, Case, cases, written
from targets.compiled import HostLibrary
from targets.digest import answers, fnv1a
from targets.image import CellError, Job, Outcome, TooLargeError, compiler, execute

# Of many contacts one query in so many is asked for the hash: a posture takes long on small parts.
FEWER = 10
# And of a sample, one in so many on the slow emulator; this board is compiled in every way for it.
SPARSE, WHOLE = 4, "m4f"
PAGE = ROOT / "docs" / "measured" / "targets.md"
EXPORTS = PAGE.with_name("exports.md")
README = ROOT / "README.md"
# The columns of its table, which stands between two marks.
SHOWN = ("m4f", "m3", "m0", "rv32imc", "mega328p")
BEGIN, END = "<!-- counts -->\n", "\n<!-- end of counts -->"


@dataclass(frozen=True)
class Row:
    """A row that is ready to run: its export, its job, and the hash that every cell must give.

    `own` is that of what the folder compiles to on this machine; `many` whether it has many
    contacts, whose postures take long; `few` and `wanted_few` are of fewer queries, for a sample on
    the slow emulator.
    """

    case: Case
    export: Export
    job: Job
    wanted: int
    own: int
    few: Job
    wanted_few: int
    many: bool = False


def prepared(case: Case) -> Row:
    """Make a row: folder, queries, and what the certified C answers, and the folder's own."""
    export, folder = written(case)
    body = body_of(export)
    on = features(body)
    floats, integers = "SMAP_FLOATS" in on, "SMAP_INTEGERS" in on
    many = "SMAP_MANY" in on
    share = FEWER if many else 1
    params, gravity = (rows[::share] for rows in queries.checked(export))
    asked = params, gravity
    wholes = queries.whole(export, *asked)
    host = Host(describe(export, body))
    wanted = fnv1a(answers(host, floats, integers, asked, wholes))
    own = wanted if _own(export, folder, host, asked) else wanted ^ 1
    counted = queries.as_bytes(export, *queries.counted(export))
    job = Job(
        *(folder, export.name, export.model.k, floats, integers),
        *(queries.as_bytes(export, *asked) + counted, len(params), queries.COUNTED),
    )
    less = params[::SPARSE], gravity[::SPARSE]
    few = replace(job, rows=queries.as_bytes(export, *less) + counted, checked=len(less[0]))
    said = fnv1a(answers(host, floats, integers, less, queries.whole(export, *less)))
    return Row(case, export, job, wanted, own, few, said, many)


def _own(export: Export, folder: Path, host: Host, asked: tuple[Any, Any]) -> bool:
    """Tell whether what a folder compiles to on this machine reads as what is certified."""
    library = HostLibrary(folder)
    certified: tuple[Any, Any] = (host.read_i if export.integer else host.read)(*asked)
    own: tuple[Any, Any] = (library.read_i if export.integer else library.read)(*asked)
    return all(one.tobytes() == other.tobytes() for one, other in zip(certified, own, strict=True))


def version(board: Board) -> str:
    """Return the compiler's first line about itself."""
    done = subprocess.run(
        [compiler(board), "--version"], capture_output=True, text=True, check=False, timeout=60.0
    )
    return (done.stdout.splitlines() or ["unknown"])[0].strip()


class Matrix:
    """A run of rows on boards, and what came of it.

    Attributes
    ----------
    found : dict
        In the form of the baseline.
    failures, skips : list of str
        One line each.
    """

    def __init__(
        self,
        rows: Sequence[Row],
        boards: Sequence[Board],
        optimisations: Sequence[str] = OPTIMISATIONS,
        sample: bool = False,
    ) -> None:
        self.rows, self.boards, self.optimisations = rows, boards, optimisations
        self.sample = sample
        self.verdicts: dict[str, dict[str, list[str]]] = {row.case.name: {} for row in rows}
        self.found: dict[str, Any] = {"compilers": {}, "rows": {}}
        self.failures: list[str] = []
        self.skips: list[str] = []
        for row in rows:
            self.found["rows"][row.case.name] = {
                "spec": str(row.export.tables.spec.label),
                "codec": row.export.codec,
                "arithmetic": row.export.arithmetic,
                "channels": list(row.export.channels),
                "recipe_sha256": row.export.recipe.digest,
                "tables": int(row.export.tables.bytes),
                "boards": {},
            }
            if row.own != row.wanted:
                self.failures.append(
                    f"{row.case.name} own build: hash {row.own:08x}, the host's is {row.wanted:08x}"
                )

    def run(self, workers: int) -> None:
        """Run every cell; those of the slow emulator first."""
        usable = []
        for board in self.boards:
            if missing := board.missing():
                packages = " ".join(missing)
                self.skips.append(f"{board.title}: not installed: apt-get install {packages}")
                for row in self.rows:
                    self.verdicts[row.case.name][board.name] = ["skipped"]
            else:
                usable.append(board)
                self.found["compilers"][board.name] = version(board)
                for row in self.rows:
                    if board.name in row.case.without:
                        self._leave_out(row, board)
        usable.sort(key=lambda board: board.family != "avr")
        with ThreadPoolExecutor(workers) as pool:
            cells: list[tuple[Row, Board, str, Future[Outcome]]] = [
                (
                    row,
                    board,
                    option,
                    pool.submit(execute, self._asked(row, board)[0], board, option),
                )
                for board in usable
                for at, row in enumerate(sorted(self.rows, key=lambda one: one.case.name))
                for option in self._options(board, at)
                if board.name not in row.case.without
            ]
            for row, board, option, future in cells:
                self._take(row, board, option, future)

    def _asked(self, row: Row, board: Board) -> tuple[Job, int]:
        """Return what a cell is asked, and the hash that it must give."""
        return (row.few, row.wanted_few) if self.asks_less(board) else (row.job, row.wanted)

    def asks_less(self, board: Board) -> bool:
        """Return whether a board is asked a part of the queries only."""
        return self.sample and board.family == "avr"

    def _options(self, board: Board, row: int) -> list[str]:
        """Return how a row, by its number, is compiled for a board: of a sample in turns."""
        options = [option for option in self.optimisations if option in board.options]
        if not self.sample or board.name == WHOLE or len(options) < 2:
            return options
        return [options[(row + self.boards.index(board)) % len(options)]]

    def _leave_out(self, row: Row, board: Board) -> None:
        """Note the cells of a board that a row is not run on."""
        self.verdicts[row.case.name][board.name] = ["-"]
        self.found["rows"][row.case.name]["boards"][board.name] = {
            option: {} for option in self.optimisations if option in board.options
        }

    def _take(self, row: Row, board: Board, option: str, future: Future[Outcome]) -> None:
        """Judge the outcome of one cell."""
        name = row.case.name
        words = self.verdicts[name].setdefault(board.name, [])
        label = f"{name} {board.name} {option}"
        cells = self.found["rows"][name]["boards"].setdefault(board.name, {})
        try:
            outcome = future.result()
        except TooLargeError as error:
            words.append("-")
            cells[option] = {}
            print(f"does not fit: {label}: {error}", flush=True)
            return
        except CellError as error:
            words.append("FAIL")
            self.failures.append(f"{label}: {error}")
            print(f"FAIL  {label}: {error}", flush=True)
            return
        wanted = self._asked(row, board)[1]
        words.append("ok" if outcome.hash == wanted else "FAIL")
        if outcome.hash != wanted:
            said = f"{label}: hash {outcome.hash:08x}, the host's is {wanted:08x}"
            self.failures.append(said)
        cells[option] = baseline.numbers(outcome)
        texts = [f"{call} {tables.pair(cells[option], call)}" for call, _ in tables.CALLS]
        print(f"{words[-1]:<5} {label}: {', '.join(texts)}", flush=True)


def chosen(text: str | None, names: Sequence[str], what: str) -> list[str]:
    """Return the names that a comma-separated option asks for; all of them without it."""
    if text is None:
        return list(names)
    wanted = [name.strip() for name in text.split(",")]
    for name in wanted:
        if name not in names:
            raise SystemExit(f"{what} {name!r} is unknown; use: {', '.join(names)}")
    return wanted


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the matrix; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.run", description=__doc__)
    parser.add_argument("--only", metavar="BOARD,...", help="of the columns")
    parser.add_argument("--export", metavar="NAME,...", help="of the rows")
    parser.add_argument(
        "--optimise", metavar="OPTION,...", help=f"of {' and '.join(OPTIMISATIONS)}"
    )
    parser.add_argument(
        "--update", action="store_true", help="rewrite baseline.json and targets.md"
    )
    parser.add_argument("--strict", action="store_true", help="a skip is a failure (CI=true)")
    parser.add_argument("--json", type=Path, help="also write every number here")
    parser.add_argument("--table", action="store_true", help="print the baseline as Markdown")
    parser.add_argument(
        "--sample",
        action="store_true",
        help=f"{' and '.join(OPTIMISATIONS)} in turns; on AVR one query in {SPARSE} for the hash",
    )
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args(arguments)
    if options.table:
        print(tables.markdown(baseline.load(), SHOWN))
        return 0
    strict = options.strict or os.environ.get("CI") == "true"
    begin = time.perf_counter()
    every = {case.name: case for case in cases()}
    names = chosen(options.export, list(every), "export")
    by_name = {board.name: board for board in BOARDS}
    boards = [by_name[name] for name in chosen(options.only, list(by_name), "board")]
    try:
        # Compilers are what takes time.
        with ThreadPoolExecutor(options.workers) as pool:
            rows = list(pool.map(lambda name: prepared(every[name]), names))
        optimisations = chosen(options.optimise, OPTIMISATIONS, "option")
        matrix = Matrix(rows, boards, optimisations, options.sample)
        matrix.run(options.workers)
        return _report(matrix, options, strict, list(every), begin)
    except LutgenError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1


def shown(page: str, content: dict[str, Any]) -> str:
    """Return the document with its table of counts made from a baseline."""
    head, begin, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not (begin and end):
        raise InputError(
            f"{PAGE.name}: has no table of counts (got no marks); put {BEGIN.strip()} and "
            f"{END.strip()} where it belongs."
        )
    return head + begin + tables.markdown(content, SHOWN) + end + tail


def _show(content: dict[str, Any]) -> None:
    """Write the tables of the document and of the README."""
    page = shown(PAGE.read_text(encoding="utf-8"), content)
    readme = costs.shown(README.read_text("utf-8"), content, EXPORTS.read_text("utf-8"))
    for path, text in ((PAGE, page), (README, readme)):
        part = path.with_suffix(".part")
        part.write_text(text, encoding="utf-8")
        part.replace(path)


def _report(
    matrix: Matrix, options: argparse.Namespace, strict: bool, every: list[str], begin: float
) -> int:
    """Print the tables and the verdict; return an exit code."""
    wanted = {
        row.case.name: (f"{row.wanted:08x}", "ok" if row.own == row.wanted else "FAIL")
        for row in matrix.rows
    }
    print("\n== Hashes of all answers, -O2 and -Os")
    print(tables.hashes(matrix.verdicts, wanted))
    print("\n== Median and largest of each call over 256 queries; bytes of code, stack and poses")
    print(tables.counts(matrix.found))
    print("\n== Beside what was asked for")
    print(goals.table(matrix.found))
    if options.json:
        options.json.write_text(json.dumps(matrix.found, indent=1, sort_keys=True) + "\n", "utf-8")
    known = baseline.load()
    worse, better = list[str](), list[str]()
    if options.update and not matrix.failures:
        content = baseline.merged(known, matrix.found)
        for name in baseline.absent(content, every):
            del content["rows"][name]
        baseline.save(content)
        _show(baseline.load())  # in the order of the file
        path = ROOT / "firmware_export" / "runtime" / COUNTS
        part = path.with_suffix(".part")
        # Those of noise are no robot's.
        of_maps = [case.name for case in cases() if case.folder is not None]
        part.write_text(baseline.published(content, BOARDS, of_maps), encoding="utf-8")
        part.replace(path)
        print(f"\n{baseline.FILE.name}, {COUNTS}, {PAGE.name} and {README.name} are rewritten")
    else:
        sampled = {board.name for board in matrix.boards if matrix.asks_less(board)}
        worse, better = baseline.compare(known, matrix.found, sampled)
    sys.stdout.flush()
    say = [f"FAIL    {line}" for line in matrix.failures]
    say += [f"WORSE   {line}" for line in worse]
    say += [f"BETTER  {line}" for line in better]
    say += [f"SKIPPED {line}" for line in matrix.skips]
    print("\n" + "\n".join(say) if say else "", flush=True)
    if better:
        print("Better than the baseline: run `python -m targets.run --update` and commit it.")
    if worse:
        print("Worse than the baseline by more than 2 %: mend it, or say why and run --update.")
    cells = sum(len(words) for row in matrix.verdicts.values() for words in row.values())
    skipped = "; a skip is a failure here" if strict and matrix.skips else ""
    print(
        f"{cells} cells, {len(matrix.failures)} failed, {len(worse)} numbers worse, "
        f"{len(better)} better, {len(matrix.skips)} targets skipped{skipped} "
        f"({time.perf_counter() - begin:.0f} s)"
    )
    return int(bool(matrix.failures or worse or (strict and matrix.skips)))


if __name__ == "__main__":
    sys.exit(main())
