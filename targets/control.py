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
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from firmware_export.control import PolicyOptions, steered
from firmware_export.emit import package
from firmware_export.host import Controller
from firmware_export.protocol import describe
from lutgen.errors import LutgenError
from targets.boards import BOARDS, Board
from targets.cases import BUILD, of_recipe
from targets.digest import fnv1a
from targets.image import compiled, counter_of, listen
from targets.marks import between, markdown
from targets.pages import PAGE
from targets.run import chosen

# Robots, and the boards on which the state of one has no room.
ROBOTS = {"paper_two": (), "absolem": ("avr",), "marv": ()}
CYCLES = 256
MULTIPLIER, INCREMENT = 1664525, 1013904223


@dataclass(frozen=True, eq=False)
class Robot:
    """An export with a policy, the ends of its axes, and the hash that every target must give."""

    name: str
    folder: Path
    low: Any
    high: Any
    wanted: int


def prepared(name: str) -> Robot:
    """Make a robot's export with a policy, and drive the host."""
    export, found = steered(of_recipe(name, "contacts"), PolicyOptions())
    folder = BUILD / name / "control"
    folder.parent.mkdir(parents=True, exist_ok=True)
    package.write(export, folder)
    blob = describe(export)
    controller = Controller(blob, found.policy.packed(blob.bytes))
    low, high = (np.asarray(end, np.float32) for end in (export.model.lower, export.model.upper))
    return Robot(name, folder, low, high, fnv1a(answers(controller, low, high)))


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


def execute(robot: Robot, board: Board, option: str) -> tuple[bool, list[int], list[str]]:
    """Run a cell; return whether it answers as the host, the counts, and the rest of its row."""
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name)
        for path in robot.folder.glob("*.[ch]"):
            shutil.copy(path, folder)
        (folder / "queries.bin").write_bytes(b"\0\0\0\0")
        (folder / "case.h").write_text(_header(robot), encoding="utf-8")
        size = compiled(robot.name, board, option, folder, {"step": "smap_run_step"})
        # The image calls nothing else of the export.
        size = replace(size, stack=size.calls.get("step"))
        lines = listen(robot.name, "control", board, option, folder, size)
    said, counts, shown = dict(lines), list[int](), "-"
    if board.unit:
        count = counter_of(board, said["o"])
        counts = [count(value) for kind, value in lines if kind == "c"]
        shown = f"{round(median(counts)):,} / {max(counts):,} {board.unit}"
    same = said["h"] == robot.wanted
    stack = f"{size.calls['step']:,}" if size.calls else "-"
    return same, counts, ["same" if same else "OTHER", shown, stack, f"{said['s']:,}"]


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


def _row(robot: Robot, board: Board, option: str) -> tuple[bool, list[str]]:
    """Run a cell; return whether it answers as the host, and its row of the table."""
    label = [robot.name, board.title, option]
    try:
        same, _, cells = execute(robot, board, option)
    except LutgenError as error:
        return False, [*label, str(error), "-", "-", "-"]
    return same, [*label, *cells]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all cells; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.control", description=__doc__)
    parser.add_argument("--only", metavar="BOARD,...", help="of the targets")
    parser.add_argument("--update", action="store_true", help="rewrite the table of targets.md")
    options = parser.parse_args(arguments)
    wanted = chosen(options.only, [board.name for board in BOARDS])
    named = [board for board in BOARDS if board.name in wanted]
    boards = [board for board in named if all(map(shutil.which, board.programs))]
    cells = [
        (robot, board, option)
        for robot in map(prepared, ROBOTS)
        for board in boards
        for option in board.options
        if board.name not in ROBOTS[robot.name]
    ]
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        rows = list(pool.map(lambda cell: _row(*cell), cells))
    head = f"| robot | target | | bits | median / largest of {CYCLES} cycles | stack | state |"
    text = markdown(head, [row for _, row in rows])
    print(text)
    good = all(same for same, _ in rows)
    if options.update and good:
        between(PAGE, "cycles", text)
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
