"""Run cycles of on-board control on every emulated target; compare hashes, count, print the table.

    python -m targets.control [--only m4f,m3] [--update]

Exports with a policy of three robots: three points, rails with two joints, and with four.  Every
target has to give the commands of this machine bit for bit.  With --update the table of
docs/measured/control.md is rewritten.
"""

import argparse
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from firmware_export.control import Wishes, steered
from firmware_export.emit import body_of, described, package
from firmware_export.host import Controller
from lutgen.errors import LutgenError
from targets.boards import BOARDS, Board
from targets.cases import BUILD, ROOT, of_recipe
from targets.digest import fnv1a
from targets.footprint import footprint
from targets.image import COLOUR, CellError, TooLargeError, build, compiler, counter_of, run

# Robots, and the most instructions of a cycle on a Cortex-M4F that are asked for: median, largest.
GOALS = {
    "paper_two": (2_000, 5_000),
    "absolem": (60_000, 120_000),
    "marv": (150_000, 250_000),
}
CYCLES = 256
PAGE = ROOT / "docs" / "measured" / "control.md"
# What the image calls; all else of smap.c it leaves alone.
CALLED = {"step": "smap_run_step", "start": "smap_run_start"}
BEGIN, END = "<!-- cycles -->\n", "<!-- end of cycles -->"
HERE = Path(__file__).resolve().parent
MULTIPLIER, INCREMENT = 1664525, 1013904223


@dataclass(frozen=True, eq=False)
class Robot:
    """An export with a policy, and the hash that every target must give."""

    name: str
    folder: Path
    plain: Path
    low: Any
    high: Any
    wanted: int


@dataclass(frozen=True)
class Cell:
    """What a target said: the hash, counts of cycles, and bytes."""

    hash: int
    counts: tuple[int, ...]
    state: int
    code: int
    stack: int | None


def prepared(name: str) -> Robot:
    """Make a robot's export with a policy, and the same without, and drive the host."""
    export = of_recipe(name, "contacts")
    poor, _ = steered(export, Wishes())
    folders = []
    for kind, one in (("control", poor), ("plain", export)):
        folder = BUILD / "control" / name / kind
        folder.parent.mkdir(parents=True, exist_ok=True)
        package.write(one, folder)
        folders.append(folder)
    blob = described(poor, body_of(poor))
    if poor.policy is None:
        raise LutgenError(f"{name}: has no policy (got none).")
    controller = Controller(blob, poor.policy.packed(blob.bytes))
    low, high = (np.asarray(ends, np.float32) for ends in (poor.model.lower, poor.model.upper))
    wanted = fnv1a(answers(controller, low, high))
    return Robot(name, folders[0], folders[1], low, high, wanted)


def answers(controller: Controller, low: Any, high: Any) -> bytes:
    """Return what is hashed of all cycles on this machine, as chip/control.c asks for them."""
    single, seed, said = np.float32, 1, [b"\0"]

    def noise() -> Any:
        nonlocal seed
        seed = (seed * MULTIPLIER + INCREMENT) & 0xFFFFFFFF
        return single(np.uint16(seed >> 16).astype(np.int16)) * single(1.0 / 32768.0)

    posture, tilt = single(0.5) * (low + high), np.zeros(2, single)
    for row in range(CYCLES):
        up, rate = np.zeros(3, single), np.zeros(3, single)
        for i in range(2):
            tilt[i] = np.clip(tilt[i] + single(0.0625) * noise(), single(-0.75), single(0.75))
            up[i] = tilt[i] * single(8.0)
            rate[i] = single(0.25) * noise()
        up[2] = 8.0
        if row % 32 == 31:
            for i in range(len(low)):
                moved = posture[i] + single(0.25) * noise() * (high[i] - low[i])
                posture[i] = np.clip(moved, low[i], high[i])
        if row % 50 == 49:
            up[2] = 0.0
        command, cycle, status = controller.step(posture[None], up[None], rate[None])
        said += [status.tobytes(), command.tobytes(), cycle.tobytes()]
        posture = command[0].copy()
    return b"".join(said)


def execute(robot: Robot, board: Board, optimise: str) -> Cell:
    """Build and run a cell; TooLargeError or CellError where it cannot be."""
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        for path in robot.folder.glob("*.[ch]"):
            shutil.copy(path, folder)
        for text in ("control.c", "counter.h", "queries.S"):
            shutil.copy(HERE / "chip" / text, folder)
        for text in ("run.mjs", "memory.c"):
            shutil.copy(HERE / "wasm" / text, folder)
        (folder / "queries.bin").write_bytes(b"\0\0\0\0")
        (folder / "case.h").write_text(_header(robot), encoding="utf-8")
        tool, wasm = compiler(board), board.family == "wasm"
        flags = [*board.flags, optimise, "-ffunction-sections", "-fdata-sections", "-I."]
        flags += [f"-I{HERE / 'wasm'}"] if wasm else []
        names = [f"{robot.name}.c", "control.c", *(["memory.c"] if wasm else [])]
        for one in names:
            build([tool, *flags, "-c", one, "-o", one.replace(".c", ".o")], folder)
        objects = [one.replace(".c", ".o") for one in names]
        extra = [] if wasm else ["queries.S"]
        build([tool, *flags, *extra, *objects, *board.link, "-o", "image.elf"], folder)
        stacks = _stacks(robot, board, flags, folder)
        _fits(board, folder, max(stacks.values(), default=0))
        code = 0 if wasm else _text(board, folder, robot.name)
        if code:
            shutil.copy(robot.plain / f"{robot.name}.c", folder)
            build([tool, *flags, "-c", f"{robot.name}.c", "-o", f"{robot.name}.o"], folder)
            code -= _text(board, folder, robot.name)
        done = run([*board.emulator, "image.elf"], folder)
    text = COLOUR.sub("", done.stdout + (done.stderr if board.family == "avr" else ""))
    lines = re.findall(r"^([a-z])([0-9a-f]{8})\.*\s*$", text, re.MULTILINE)
    said = {kind: int(value, 16) for kind, value in lines}
    if said.get("e") != CYCLES:
        last = (text.splitlines() or done.stderr.splitlines() or ["nothing"])[-1]
        raise CellError(f"{board.emulator[0]}: exit code {done.returncode}, said {last[:80]!r}")
    counts: tuple[int, ...] = ()
    if board.unit:
        count = counter_of(board, said)
        counts = tuple(count(int(value, 16)) for kind, value in lines if kind == "c")
    return Cell(said["h"], counts, said["s"], code, stacks.get("step"))


def _header(robot: Robot) -> str:
    """Return case.h."""

    def row(values: Any) -> str:
        return "{" + ", ".join(f"{float(value).hex()}f" for value in values) + "}"

    stem = robot.name
    return "\n".join(
        [
            f'#include "{stem}.h"',
            f"#define CONTROL {stem}_control",
            f"#define STATE {stem}_state_t",
            f"#define PARAMS {len(robot.low)}",
            f"#define CYCLES {CYCLES}u",
            f"#define LOW {row(robot.low)}",
            f"#define HIGH {row(robot.high)}",
            "",
        ]
    )


def _text(board: Board, folder: Path, name: str) -> int:
    """Return the bytes of code of an object."""
    listing = run([f"{board.prefix}size", "-A", f"{name}.o"], folder).stdout
    return sum(map(int, re.findall(r"^\.text\S*\s+(\d+)", listing, re.MULTILINE)))


def _stacks(robot: Robot, board: Board, flags: list[str], folder: Path) -> dict[str, int]:
    """Return the stack (bytes) of what the image calls, nothing where that is not told."""
    aside = folder / "aside"
    shutil.copytree(robot.folder, aside)
    return footprint(robot.name, board, flags, aside, build, run, CALLED).calls


def _fits(board: Board, folder: Path, stack: int) -> None:
    """Refuse an image that a part has no room for, with its stack."""
    if board.family == "wasm":
        return
    text = run([f"{board.prefix}size", "-A", "image.elf"], folder).stdout
    sizes = dict(re.findall(r"^\.(\w+)\s+(\d+)", text, re.MULTILINE))
    ram = sum(int(sizes.get(part, 0)) for part in ("data", "bss", "noinit"))
    flash = sum(int(sizes.get(part, 0)) for part in ("text", "rodata", "data"))
    if flash > board.flash or ram + stack > board.ram:
        raise TooLargeError(f"{flash:,} bytes of flash, {ram:,} of RAM")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all cells; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.control", description=__doc__)
    parser.add_argument("--only", metavar="BOARD,...", help="of the columns")
    parser.add_argument("--update", action="store_true", help="rewrite the table of control.md")
    options = parser.parse_args(arguments)
    wanted = options.only.split(",") if options.only else [board.name for board in BOARDS]
    boards = [board for board in BOARDS if board.name in wanted and not board.missing()]
    robots = [prepared(name) for name in GOALS]
    cells = [
        (robot, board, option) for robot in robots for board in boards for option in board.options
    ]
    rows, faults = list[list[str]](), list[str]()
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        for (robot, board, option), future in [
            (cell, pool.submit(execute, *cell)) for cell in cells
        ]:
            label = [robot.name, board.title, option]
            try:
                rows.append([*label, *_judged(robot, future.result(), board, faults, label)])
            except TooLargeError as error:
                print(f"does not fit: {' '.join(label)}: {error}", flush=True)
                rows.append([*label, "does not fit", *["-"] * 4])
            except CellError as error:
                faults.append(f"{' '.join(label)}: {error}")
    missing = [board.title for board in BOARDS if board.missing()]
    head = ["robot", "target", "", "bits", f"median / largest of {CYCLES} cycles"]
    head += ["code of control", "stack", "state"]
    table = ["| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]]
    print("\n".join(table))
    print("\n".join(f"FAIL    {fault}" for fault in faults))
    print("\n".join(f"SKIPPED {title}: not installed" for title in missing))
    if options.update and not faults:
        head_, _, rest = PAGE.read_text("utf-8").partition(BEGIN)
        _, _, tail = rest.partition(END)
        PAGE.write_text(head_ + BEGIN + "\n".join(table) + "\n" + END + tail, "utf-8")
    return int(bool(faults))


def _judged(
    robot: Robot, cell: Cell, board: Board, faults: list[str], label: list[str]
) -> list[str]:
    """Return the cells of a row, and note what is wrong."""
    same = cell.hash == robot.wanted
    if not same:
        faults.append(f"{' '.join(label)}: hash {cell.hash:08x}, the host's {robot.wanted:08x}")
    counts = "-"
    if cell.counts:
        middle, most = round(median(cell.counts)), max(cell.counts)
        counts = f"{middle:,} / {most:,} {board.unit}"
        if board.name == "m4f" and label[2] == "-O2":
            goal = GOALS[robot.name]
            if middle > goal[0] or most > goal[1]:
                counts += f" (asked for: {goal[0]:,} / {goal[1]:,})"
    stack = "-" if cell.stack is None else f"{cell.stack:,}"
    code = f"{cell.code:,}" if cell.code else "-"
    return ["same" if same else "OTHER", counts, code, stack, f"{cell.state:,}"]


if __name__ == "__main__":
    sys.exit(main())
