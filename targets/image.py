"""One cell: an export compiled for a board, run on its emulator, and what it said."""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from targets.boards import Board
from targets.digest import START
from targets.footprint import Footprint, footprint
from targets.queries import row_bytes

HERE = Path(__file__).resolve().parent
CHIP = (
    *("chip/image.c", "chip/counter.h", "chip/queries.S"),
    *("wasm/run.mjs", "wasm/memory.c"),
)
# Seconds; an image that hangs is ended.  The slowest emulated run takes some fifty.
PATIENCE = 300.0
# Bytes of stack that an image needs beside the runtime, interrupts and arithmetic of the compiler
# included, and the least queries worth a run.
STACK = 500
LEAST = 20
# Bytes of flash by which code may grow with the number of queries.
SPARE = 256
# Instructions of the call that come on top of the thousand of the check.
SLACK = 2.0
# Instructions of the interrupt that counts the overflows of the 24-bit SysTick.
INTERRUPT = 5
# What linkers and the blob say of a part without room.
TOO_LARGE = "overflow|will not fit|is not within region|too large for avr-gcc"
COLOUR = re.compile(r"\x1b\[[0-9;]*m")


class CellError(Exception):
    """A cell that does not compile, does not run, or does not say what it should."""


class TooLargeError(CellError):
    """An image that the part has no room for."""


@dataclass(frozen=True)
class Job:
    """What is to be run.

    Parameters
    ----------
    folder : Path
        The export.
    name : str
        Of the map in C.
    params : int
        Geometry parameters.
    floats, integers : bool
        The forms of a pose that the export has.
    rows : bytes
        The queries, those of the hash first.
    checked, counted : int
        How many of each.
    largest_only : bool
        Whether of the counts only the largest is wanted.
    """

    folder: Path
    name: str
    params: int
    floats: bool
    integers: bool
    rows: bytes = field(repr=False)
    checked: int
    counted: int
    largest_only: bool = False

    @property
    def width(self) -> int:
        """Bytes of a query."""
        return row_bytes(self.params, self.floats)

    @property
    def calls(self) -> dict[str, str]:
        """The calls that are counted, each with the letter that the image says it by."""
        return calls_of(self.floats, self.integers)

    @property
    def entries(self) -> dict[str, str]:
        """The functions of smap.c that answer those calls."""
        return {call: entry_of(call, self.floats) for call in self.calls}


@dataclass(frozen=True)
class Outcome:
    """What an image said: the hash, the count of each query by call, bytes of the two poses.

    Of a call there is one count where only the largest was asked for.
    """

    hash: int
    counts: dict[str, list[int]]
    footprint: Footprint
    pose: int
    pose_i: int


def calls_of(floats: bool, integers: bool) -> dict[str, str]:
    """Return the calls that an export of some forms answers: name -> letter."""
    calls = {"pose": "p"}
    if floats and integers:
        calls["both"] = "b"
    if floats:
        calls["at"] = "a"
    if integers:
        calls["at_i"] = "i"
    return calls | {"read": "r"}


def entry_of(call: str, floats: bool) -> str:
    """Return the function of smap.c that answers a call."""
    if floats:
        return f"smap_run_{'pose' if call == 'both' else call}"
    return {"pose": "smap_run_pose_q", "read": "smap_run_read_i"}.get(call, f"smap_run_{call}")


def run(arguments: Sequence[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder; one that cannot be run or hangs is a CellError."""
    try:
        return subprocess.run(
            list(arguments),
            cwd=folder,
            capture_output=True,
            text=True,
            errors="replace",
            stdin=subprocess.DEVNULL,
            timeout=PATIENCE,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CellError(f"{arguments[0]}: {type(error).__name__}") from error


def build(arguments: Sequence[str], folder: Path) -> None:
    """Run a compiler; what it says is the CellError's text."""
    done = run(arguments, folder)
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if re.search(f"error|{TOO_LARGE}", line)]
        text = (lines or done.stderr.splitlines() or ["nothing"])[0]
        kind = TooLargeError if re.search(TOO_LARGE, done.stderr) else CellError
        raise kind(f"{arguments[0]}: {text.strip()}")


def compiler(board: Board) -> str:
    """Return the C compiler of a board."""
    return f"{board.prefix}gcc" if board.prefix else "clang"


def case_header(job: Job, board: Board, start: int, checked: int, counted: int) -> str:
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
        "CHECKED": checked,
        "COUNTED": counted,
        "KINDS": f'"{"".join(job.calls.values())}"',
        "HASH_START": f"{start}u",
        "LARGEST_ONLY": int(job.largest_only),
    }
    lines = [f'#include "{job.name}.h"', *(f"#define {k} {v}" for k, v in settings.items())]
    return "\n".join(lines) + "\n"


def execute(job: Job, board: Board, optimise: str) -> Outcome:
    """Build and run a cell, in as many images as the part's flash asks for.

    The hash goes on from one image to the next, so it does not depend on their number.

    Raises
    ------
    TooLargeError
        If the part has no room for the export.
    CellError
        If anything fails.
    """
    if not board.unit:
        job = replace(job, counted=0)
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        sources = (f"{job.name}.c", f"{job.name}.h", "smap.c", "smap.h", "smap_config.h")
        for source in sources:
            shutil.copy(job.folder / source, folder)
        for path in CHIP:
            shutil.copy(HERE / path, folder)
        flags = [*board.flags, optimise, "-ffunction-sections", "-fdata-sections", "-I."]
        flags += [f"-I{HERE / 'wasm'}"] if board.family == "wasm" else []
        size = footprint(job.name, board, flags, folder, build, run, job.entries)
        room = _room(job, board, flags, folder, size)
        value, counts, at = START, {call: list[int]() for call in job.calls}, 0
        said = dict[str, int]()
        total = job.checked + job.counted
        while at < total:
            checked = min(max(job.checked - at, 0), room)
            counted = min(total - at - checked, room - checked)
            rows = job.rows[at * job.width : (at + checked + counted) * job.width]
            (folder / "queries.bin").write_bytes(rows)
            _link(job, board, flags, folder, case_header(job, board, value, checked, counted))
            said, found = _listen(job, board, folder, checked + counted)
            value = said["h"]
            for call, ticks in found.items():
                counts[call] += ticks
            at += checked + counted
        return Outcome(value, counts, size, said["s"], said["t"])


def _link(job: Job, board: Board, flags: list[str], folder: Path, header: str) -> None:
    """Make image.elf around the objects of the map and the runtime."""
    (folder / "case.h").write_text(header, encoding="utf-8")
    tool = compiler(board)
    queries = [] if board.family == "wasm" else ["queries.S"]
    objects = [f"{job.name}.o"]
    if board.family == "wasm":
        build([tool, *flags, "-c", "memory.c", "-o", "memory.o"], folder)
        objects.append("memory.o")
    # Two steps, as clang takes no linker flags when it compiles.
    build([tool, *flags, "-c", "image.c", "-o", "image.o"], folder)
    command = [tool, *flags, *queries, "image.o", *objects, *board.link, "-o", "image.elf"]
    build(command, folder)


def _room(job: Job, board: Board, flags: list[str], folder: Path, size: Footprint) -> int:
    """Return how many queries fit a part together with everything else."""
    total = job.checked + job.counted
    if not board.unit:
        return total
    (folder / "queries.bin").write_bytes(job.rows[: 2 * job.width])
    counted = min(job.counted, 1)
    _link(job, board, flags, folder, case_header(job, board, START, 2 - counted, counted))
    text = run([f"{board.prefix}size", "image.elf"], folder).stdout.split("\n")[1].split()
    flash = int(text[0]) + int(text[1])
    parts = run([f"{board.prefix}size", "-A", "image.elf"], folder).stdout
    # Without the section that picolibc reserves for the stack.
    ram = sum(int(found) for found in re.findall(r"^\.(?:data|bss)\s+(\d+)", parts, re.MULTILINE))
    left = board.flash - flash - SPARE
    if board.family == "avr":  # queries are read with 16-bit addresses, as all small tables are
        left = min(left, 32767)
    rows = min(total, left // job.width)
    if rows < LEAST or ram + (size.stack or 0) + STACK > board.ram:
        raise TooLargeError(
            f"{flash:,} bytes of flash, {ram:,} of RAM and {size.stack or 0:,} of stack without "
            "queries"
        )
    return rows


def _listen(
    job: Job, board: Board, folder: Path, expected: int
) -> tuple[dict[str, int], dict[str, list[int]]]:
    """Run image.elf; return what it said once, by letter, and the counts of each call."""
    done = run([*board.emulator, "image.elf"], folder)
    text = COLOUR.sub("", done.stdout + (done.stderr if board.family == "avr" else ""))
    lines = re.findall(r"^([a-z])([0-9a-f]{8})\.*\s*$", text, re.MULTILINE)
    said = {kind: int(value, 16) for kind, value in lines}
    if "h" not in said or said.get("e") != expected:
        errors = [line for line in done.stderr.splitlines() if "Error" in line]
        last = (errors or done.stderr.splitlines() or text.splitlines() or ["nothing"])[-1]
        raise CellError(f"{board.emulator[0]}: exit code {done.returncode}, said {last[:80]!r}")
    if not board.unit:
        return said, {}
    ticks = {
        call: [int(value, 16) for kind, value in lines if kind == letter]
        for call, letter in job.calls.items()
    }
    count = counter_of(board, said)
    return said, {call: [count(one) for one in found] for call, found in ticks.items()}


def counter_of(board: Board, said: dict[str, int]) -> Callable[[int], int]:
    """Return what makes ticks of a board's counter the unit that is counted."""
    if board.unit == "cycles":
        # Each overflow of the 16-bit timer takes an interrupt; `o` holds the cycles of three.
        each = said["o"] / 3.0
        return lambda ticks: round(ticks - each * (ticks >> 16))
    thousand = said["o"] / board.ticks
    if abs(thousand - 1000.0) > SLACK:
        raise CellError(f"{board.emulator[0]}: counts {thousand:.0f} for 1,000 instructions")
    interrupts = INTERRUPT if board.family == "arm" else 0
    return lambda ticks: round(ticks / board.ticks) - interrupts * (ticks >> 24)
