"""Write the counts as tables: a line for a run, docs/measured/targets.md, the README's costs."""

import re
from typing import Any

from targets.baseline import CALLS, Cell
from targets.boards import BOARDS
from targets.marks import MEASURED, ROOT, between, markdown

PAGE, EXPORTS, README = MEASURED / "targets.md", MEASURED / "exports.md", ROOT / "README.md"
# Rows of the README's table, and what they are there.
ROBOTS = {
    "paper_two": "the paper's robot: 3 points, 2 parameters",
    "absolem": "a flipper robot: 12 discs, 2 parameters",
    "legs": "a quadruped (`lutgen new legs`): 4 feet, 2 parameters",
}
COSTS = (
    "| robot | flash, bytes | RAM of a posture | instructions a posture | a direction "
    r"| error of \|SD_g\|, p99 | stable, reported unsafe |"
)


def pair(cell: Cell, call: str) -> str:
    """Return median and largest count of a call, of reads also the longest one, or a dash."""
    counted = [*cell.get(call, ())[:2]]
    if call == "read" and "longest" in cell:
        counted.append(cell["longest"])
    return " / ".join(f"{one:,}" for one in counted) or "-"


def line(cell: Cell) -> str:
    """Return a cell as a line of text."""
    stack = "-" if cell["stack"] is None else f"{cell['stack']:,}"
    texts = [f"{call} {pair(cell, call)}" for call in CALLS if call in cell]
    return ", ".join([f"code {cell['code']:,}, stack {stack}", *texts])


def counts(content: dict[str, Any]) -> str:
    """Return the table of counts of targets.md."""
    counted = [board for board in BOARDS if board.unit]
    titles = [f"{one.title}, {one.options[0]}, {one.unit}" for one in counted]
    rows = []
    for name, row in content["rows"].items():
        cells = [row.get(f"{one.name} {one.options[0]}", {}) for one in counted]
        for call, title in CALLS.items():
            texts = [pair(cell, call) for cell in cells]
            if set(texts) != {"-"}:
                rows.append([f"`{name}`", title, *texts])
    return markdown(f"| export | call | {' | '.join(titles)} |", rows)


def costs(content: dict[str, Any], exports: str) -> str:
    """Return the README's table; `exports` is docs/measured/exports.md, which has the errors."""
    errors = {}
    for row in re.findall(r"^\| (\w+) \| contacts \| float \| (.*) \|$", exports, re.MULTILINE):
        cells = row[1].split(" | ")
        errors[row[0]] = (cells[1], cells[3], cells[5])
    rows = []
    for name, title in ROBOTS.items():
        flash, p99, unsafe = errors.get(name, ("-", "-", "-"))
        cell = content["rows"][name]["m4f -O2"]
        asked = [f"{cell['pose_bytes']:,}", pair(cell, "pose"), pair(cell, "at")]
        rows.append([title, flash, *asked, p99, unsafe])
    return markdown(COSTS, rows)


def update(content: dict[str, Any]) -> None:
    """Write the tables of targets.md and of the README."""
    between(PAGE, "counts", counts(content))
    between(README, "costs", costs(content, EXPORTS.read_text("utf-8")))
