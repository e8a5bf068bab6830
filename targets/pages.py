"""The tables of the counts: a line for a run, docs/measured/targets.md, and the README's costs."""

import re
from pathlib import Path
from typing import Any

from lutgen.errors import InputError
from targets.baseline import CALLS, Cell
from targets.boards import BOARDS
from targets.cases import ROOT

PAGE = ROOT / "docs" / "measured" / "targets.md"
EXPORTS, README = PAGE.with_name("exports.md"), ROOT / "README.md"
# Rows of the README's table, and the heads of their columns.
COLUMNS = {
    "paper_two": "`contacts`",
    "paper_two_grid_float": "`grid`, floats",
    "paper_two_grid_integer": "`grid`, integers",
    "absolem": "`absolem`, `contacts`",
}
COSTS = {
    "pose": "`smap_pose`, once a posture",
    "at": "`smap_at`, once a direction",
    "at_i": "`smap_at_i`, the same without floats",
}
THREE = re.compile(r"in [\d.]+ kB of code and [\d,]+ bytes of(\s+)stack")
MANY = re.compile(r"take [\d.]+ kB, [\d.]+ kB of stack for a pose \([\d.]+ kB for")


def pair(cell: Cell, call: str) -> str:
    """Return median and largest count of a call, or a dash."""
    return "{:,} / {:,}".format(*cell[call]) if call in cell else "-"


def line(cell: Cell) -> str:
    """Return a cell as a line of text."""
    stack = "-" if cell["stack"] is None else f"{cell['stack']:,}"
    texts = [f"{call} {pair(cell, call)}" for call in CALLS if call in cell]
    return ", ".join([f"code {cell['code']:,}, stack {stack}", *texts])


def markdown(head: str, rows: list[list[str]]) -> str:
    """Return a table as Markdown."""
    rule = "|---" * (head.replace(r"\|", "").count("|") - 1) + "|"
    return "\n".join([head, rule, *(f"| {' | '.join(row)} |" for row in rows)])


def between(path: Path, name: str, text: str) -> None:
    """Put text between the marks ``<!-- name -->`` and ``<!-- end of name -->`` of a page."""
    begin, end = f"<!-- {name} -->\n", f"\n<!-- end of {name} -->"
    head, found, rest = path.read_text(encoding="utf-8").partition(begin)
    _, closed, tail = rest.partition(end)
    if not (found and closed):
        raise InputError(f"{path.name}: has no marks of {name} (got none); put them in.")
    path.write_text(head + begin + text + end + tail, encoding="utf-8")


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
        longest = [f"{cell['longest']:,}" if "longest" in cell else "-" for cell in cells]
        rows.append([f"`{name}`", "longest read", *longest])
    return markdown(f"| export | call | {' | '.join(titles)} |", rows)


def costs(content: dict[str, Any], exports: str) -> str:
    """Return the README's table; `exports` is docs/measured/exports.md, which has the errors."""
    cells = r"^\| (\w+) \| ([^|]+) \| (\w+) \| [^|]+ \| [^|]+ \| ([^|]+) \|"
    known = {(a, b, c): d for a, b, c, d in re.findall(cells, exports, re.MULTILINE)}
    rows = [content["rows"][name] for name in COLUMNS]
    small, fast = ([row[f"m4f {option}"] for row in rows] for option in ("-Os", "-O2"))
    keys = [
        ("absolem" if name == "absolem" else "paper_two", one["spec"], one["arithmetic"])
        for name, one in zip(COLUMNS, (row["export"] for row in rows), strict=True)
    ]
    lines = [
        ["tables, bytes", *(f"{row['export']['tables']:,}" for row in rows)],
        [r"largest error of \|SD_g\|, of its range", *(known.get(key, "-") for key in keys)],
        *([title, *(pair(cell, call) for cell in fast)] for call, title in COSTS.items()),
        ["RAM of a pose, bytes", *(f"{cell['pose_bytes']:,}" for cell in fast)],
        ["stack of `smap_pose`, bytes, `-Os`", *(f"{cell['pose'][2]:,}" for cell in small)],
        ["code, bytes, `-Os`", *(f"{cell['code']:,}" for cell in small)],
    ]
    return markdown(f"| | {' | '.join(COLUMNS.values())} |", lines)


def update(content: dict[str, Any]) -> None:
    """Write the tables of targets.md and of the README, and the README's two sentences."""
    between(PAGE, "counts", counts(content))
    text = README.read_text("utf-8")
    begin = text.find("| | `")
    if begin < 0:
        raise InputError("README.md: has no table of costs (got none that begins '| | `').")
    table = costs(content, EXPORTS.read_text("utf-8") if EXPORTS.is_file() else "")
    text = text[:begin] + table + text[text.index("\n\n", begin) :]
    three, many = (content["rows"][name]["m4f -Os"] for name in ("paper_two", "absolem"))

    def kilo(number: int) -> str:
        return f"{number / 1000:.1f} kB"

    said = rf"in {kilo(three['code'])} of code and {three['stack']:,} bytes of\1stack"
    text = THREE.sub(said, text)
    pose, read = (kilo(many[call][2]) for call in ("pose", "read"))
    text = MANY.sub(f"take {kilo(many['code'])}, {pose} of stack for a pose ({read} for", text)
    README.write_text(text, encoding="utf-8")
