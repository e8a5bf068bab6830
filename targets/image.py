"""One cell: an export compiled for a board, run on its emulator, and the answers and counts."""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from lutgen.errors import ExportError, reject
from targets.boards import Board
from targets.elf import memory, section_bytes

HERE = Path(__file__).resolve().parent
# Seconds; an image that hangs is ended.
PATIENCE = 600.0
# Bytes of stack beside the runtime's: interrupts, and the arithmetic of the compiler.
STACK = 500
# Instructions of the call that come on top of the thousand of the check.
SLACK = 2.0
# Instructions of the interrupt that counts the overflows of the 24-bit SysTick.
INTERRUPT = 5
COLOUR = re.compile(r"\x1b\[[0-9;]*m")
# A pose with floats never calls it: it makes one of integers alone, all of it on the stack.
APART = "smap_pose_whole"


class CellError(ExportError):
    """A cell that does not compile, does not fit, does not run, or says something else."""


@dataclass(frozen=True)
class Job:
    """An export and the queries of a board: `rows`, first those `checked`, then those `counted`."""

    folder: Path
    name: str  # of the map in C
    params: int
    floats: bool  # whether a pose has this form
    integers: bool
    rows: bytes = field(repr=False)
    checked: int
    counted: int
    longest: bool = False  # only the longest read is counted

    @property
    def calls(self) -> dict[str, str]:
        """The calls that are counted, each with the letter that the image prints."""
        if self.longest:
            return {"read": "r"}
        calls = {"pose": "p"}
        if self.floats and self.integers:
            calls["both"] = "b"
        if self.floats:
            calls["at"] = "a"
        if self.integers:
            calls["at_i"] = "i"
        return calls | {"read": "r"}

    def entry(self, call: str) -> str:
        """Return the function of the runtime that answers a call."""
        if self.floats:
            return f"smap_run_{'pose' if call == 'both' else call}"
        return {"pose": "smap_run_pose_q", "read": "smap_run_read_i"}.get(call, f"smap_run_{call}")


@dataclass(frozen=True)
class Footprint:
    """Bytes of code, of the deepest stack and of that of each call; None where it is not known."""

    code: int
    stack: int | None = None
    calls: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """The hash, the counts of each call, the footprint, and the bytes of the two poses."""

    hash: int
    counts: dict[str, list[int]]
    footprint: Footprint
    pose: int
    pose_i: int


def run(
    arguments: Sequence[str], folder: Path, patience: float = PATIENCE
) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder for so many seconds; if it cannot be or hangs it is a CellError."""
    try:
        return subprocess.run(
            list(arguments),
            cwd=folder,
            capture_output=True,
            text=True,
            errors="replace",
            stdin=subprocess.DEVNULL,
            timeout=patience,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        way_out = "run again on an idle machine, or with more patience"
        reject(arguments[0], "did not end", f"{error.timeout:.0f} s", way_out, CellError)
    except OSError as error:
        reject(arguments[0], "cannot be run", type(error).__name__, "install it", CellError)


def build(arguments: Sequence[str], folder: Path) -> None:
    """Run a compiler; its first error is the CellError's text."""
    done = run(arguments, folder)
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error" in line or "overflow" in line]
        text = (lines or done.stderr.splitlines() or ["nothing"])[0]
        raise CellError(f"{arguments[0]}: {text.strip()}")


def version(board: Board) -> str:
    """Return the compiler's first line about itself."""
    done = run([board.tool, "--version"], Path())
    return (done.stdout.splitlines() or ["unknown"])[0].strip()


def flags_of(board: Board, option: str) -> list[str]:
    """Return the command of a board's compiler, without files."""
    return [board.tool, *board.flags, option, "-ffunction-sections", "-fdata-sections", "-I."]


def deepest(graph: str, entry: str = "", without: str = "\n") -> int:
    """Return the deepest stack of any chain of calls, from GCC's call graph (VCG).

    Chains begin with functions whose title ends with `entry`; none has one whose title contains
    `without`.
    """
    own = {
        title: int(size)
        for title, size in re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes', graph)
    }
    calls: dict[str, list[str]] = {}
    edges = r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"'
    for source, target in re.findall(edges, graph):
        calls.setdefault(source, []).append(target)

    def depth(title: str, seen: tuple[str, ...]) -> int:
        if title in seen:
            raise ExportError(f"the runtime: {title} calls itself (got a recursion); write a loop.")
        further = [name for name in calls.get(title, ()) if without not in name]
        below = [depth(name, (*seen, title)) for name in further]
        return own.get(title, 0) + max(below, default=0)

    return max((depth(title, ()) for title in own if title.endswith(entry)), default=0)


def compiled(
    name: str, board: Board, option: str, folder: Path, entries: Mapping[str, str]
) -> Footprint:
    """Compile NAME.c in a folder to NAME.o and measure it; `entries` has a function for each call.

    avr-gcc 5 writes no call graph, so that no stack is known there.
    """
    graphed = "arm" in board.tool
    more = ["-fcallgraph-info=su"] if graphed else []
    build([*flags_of(board, option), *more, "-c", f"{name}.c", "-o", f"{name}.o"], folder)
    made = folder / f"{name}.o"
    tables = (f".rodata.{name}_tables", f".rodata.{name}_policy")
    code = section_bytes(made, ".text", ".rodata") - section_bytes(made, *tables)
    if not graphed:
        return Footprint(code)
    graph = (folder / f"{name}.ci").read_text(encoding="utf-8")
    stacks = {call: deepest(graph, entry, APART) for call, entry in entries.items()}
    return Footprint(code, deepest(graph), stacks)


def listen(
    name: str, program: str, board: Board, option: str, folder: Path, size: Footprint
) -> list[tuple[str, int]]:
    """Link a program of chip/ around NAME.o and run it; return its letters and numbers."""
    for path in (f"chip/{program}.c", "chip/counter.h", "chip/queries.S"):
        shutil.copy(HERE / path, folder)
    sources = [f"{program}.c", "queries.S", f"{name}.o"]
    build([*flags_of(board, option), *sources, *board.link, "-o", "image.elf"], folder)
    flash, ram = memory(folder / "image.elf")
    if flash > board.flash or ram + (size.stack or 0) + STACK > board.ram:
        raise CellError(f"{flash:,} bytes of flash and {ram:,} of RAM do not fit {board.title}")
    done = run([*board.emulator, "image.elf"], folder)
    text = COLOUR.sub("", done.stdout + (done.stderr if "avr" in board.tool else ""))
    lines = re.findall(r"^([a-z])([0-9a-f]{8})\.*\s*$", text, re.MULTILINE)
    if not lines or lines[-1][0] != "e":
        last = (done.stderr.splitlines() or text.splitlines() or ["nothing"])[-1]
        raise CellError(f"{board.emulator[0]}: exit code {done.returncode}, said {last[:80]!r}")
    return [(kind, int(value, 16)) for kind, value in lines]


def execute(job: Job, board: Board, option: str) -> Outcome:
    """Build and run a cell; if anything fails it is a CellError."""
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        for path in job.folder.glob("*.[ch]"):
            shutil.copy(path, folder)
        (folder / "queries.bin").write_bytes(job.rows)
        (folder / "case.h").write_text(_header(job), encoding="utf-8")
        entries = {call: job.entry(call) for call in job.calls}
        size = compiled(job.name, board, option, folder, entries)
        lines = listen(job.name, "image", board, option, folder, size)
    said = dict(lines)
    counts = dict[str, list[int]]()
    if board.unit:
        count = counter_of(board, said["o"])
        counts = {
            call: [count(value) for kind, value in lines if kind == letter]
            for call, letter in job.calls.items()
        }
    return Outcome(said["h"], counts, size, said["s"], said["t"])


def _header(job: Job) -> str:
    """Return case.h."""
    forms = [name for name, on in (("FLOAT", job.floats), ("INTEGER", job.integers)) if on]
    settings = {
        "MAP": job.name,
        "POSE": f"{job.name}_pose_t" if job.floats else f"{job.name}_pose_i_t",
        "POSE_I": f"{job.name}_pose_i_t",
        "FORMS": f"({' | '.join(f'SMAP_{form}' for form in forms)})",
        "PARAMS": job.params,
        "FLOATS": int(job.floats),
        "INTEGERS": int(job.integers),
        "CHECKED": job.checked,
        "COUNTED": job.counted,
        "KINDS": f'"{"".join(job.calls.values())}"',
        "LARGEST_ONLY": int(job.longest),
    }
    lines = [f'#include "{job.name}.h"', *(f"#define {k} {v}" for k, v in settings.items())]
    return "\n".join(lines) + "\n"


def counter_of(board: Board, known: int) -> Callable[[int], int]:
    """Return the conversion of a board's ticks to its unit, from the ticks of a known length."""
    if board.unit == "cycles":
        # Each overflow of the 16-bit timer takes an interrupt; `known` has the cycles of three.
        return lambda ticks: round(ticks - known / 3.0 * (ticks >> 16))
    thousand = known / board.ticks
    if abs(thousand - 1000.0) > SLACK:
        raise CellError(f"{board.emulator[0]}: counts {thousand:.0f} for 1,000 instructions")
    return lambda ticks: round(ticks / board.ticks) - INTERRUPT * (ticks >> 24)
