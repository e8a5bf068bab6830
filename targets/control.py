"""Run cycles of on-board control on every emulated target; compare hashes, count, print a table.

    python -m targets.control [--only m4f,avr] [--update]

Exports with a policy of three robots: three points, and parallel axes with two and four joints.
Every target must give the commands of the host bit for bit.  `--update` rewrites the table of
docs/measured/targets.md.
"""

import argparse
import os
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
from targets.cases import BUILD, of_recipe
from targets.digest import fnv1a
from targets.image import compiled, counter_of, listen
from targets.pages import PAGE, between, markdown

# Robots, and the boards on which the state of one has no room.
ROBOTS = {"paper_two": (), "absolem": ("avr",), "marv": ()}
CYCLES = 256
MULTIPLIER, INCREMENT = 1664525, 1013904223


@dataclass(frozen=True, eq=False)
class Robot:
    """An export with a policy, one without, and the hash that every target must give."""

    name: str
    folder: Path
    plain: Path
    low: Any
    high: Any
    wanted: int


@dataclass(frozen=True)
class Cell:
    """The hash, counts of cycles, and bytes; no stack where it is not known."""

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
    """Return the bytes that are hashed of all cycles on this machine, as in chip/control.c."""
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


def execute(robot: Robot, board: Board, option: str) -> Cell:
    """Build and run a cell; if anything fails it is a CellError."""
    entries = {"step": "smap_run_step"}
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        shutil.copytree(robot.plain, folder / "plain")
        plain = compiled(robot.name, board, option, folder / "plain", {})
        for path in robot.folder.glob("*.[ch]"):
            shutil.copy(path, folder)
        (folder / "queries.bin").write_bytes(b"\0\0\0\0")
        (folder / "case.h").write_text(_header(robot), encoding="utf-8")
        size = compiled(robot.name, board, option, folder, entries)
        lines = listen(robot.name, "control", board, option, folder, size)
    said = dict(lines)
    counts: tuple[int, ...] = ()
    if board.unit:
        count = counter_of(board, said["o"])
        counts = tuple(count(value) for kind, value in lines if kind == "c")
    return Cell(said["h"], counts, said["s"], size.code - plain.code, size.calls.get("step"))


def _header(robot: Robot) -> str:
    """Return case.h."""

    def row(values: Any) -> str:
        return "{" + ", ".join(f"{float(value).hex()}f" for value in values) + "}"

    lines = [
        f'#include "{robot.name}.h"',
        f"#define CONTROL {robot.name}_control",
        f"#define STATE {robot.name}_state_t",
        f"#define PARAMS {len(robot.low)}",
        f"#define CYCLES {CYCLES}u",
        f"#define LOW {row(robot.low)}",
        f"#define HIGH {row(robot.high)}",
    ]
    return "\n".join([*lines, ""])


def _row(robot: Robot, board: Board, option: str) -> tuple[list[str], bool]:
    """Run a cell; return its row of the table, and whether it answers as the host."""
    label = [robot.name, board.title, option]
    try:
        cell = execute(robot, board, option)
    except LutgenError as error:
        return [*label, str(error), *["-"] * 4], False
    same = cell.hash == robot.wanted
    counts = "-"
    if cell.counts:
        counts = f"{round(median(cell.counts)):,} / {max(cell.counts):,} {board.unit}"
    stack = "-" if cell.stack is None else f"{cell.stack:,}"
    bits = "same" if same else "OTHER"
    return [*label, bits, counts, f"{cell.code:,}", stack, f"{cell.state:,}"], same


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all cells; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.control", description=__doc__)
    parser.add_argument("--only", metavar="BOARD,...", help="of the targets")
    parser.add_argument("--update", action="store_true", help="rewrite the table of targets.md")
    options = parser.parse_args(arguments)
    wanted = options.only.split(",") if options.only else [board.name for board in BOARDS]
    boards = [board for board in BOARDS if board.name in wanted and not board.missing()]
    cells = [
        (robot, board, option)
        for robot in map(prepared, ROBOTS)
        for board in boards
        for option in board.options
        if board.name not in ROBOTS[robot.name]
    ]
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        rows = list(pool.map(lambda cell: _row(*cell), cells))
    head = (
        f"| robot | target | | bits | median / largest of {CYCLES} cycles | code | stack | state |"
    )
    text = markdown(head, [row for row, _ in rows])
    print(text)
    good = all(same for _, same in rows)
    if options.update and good:
        between(PAGE, "cycles", text)
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
