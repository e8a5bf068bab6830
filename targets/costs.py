"""The README's costs: its table and two sentences, from the baseline and the table of exports.

`python -m targets.run --update` writes them; nothing in them is written by hand.
"""

import re
from typing import Any

from lutgen.errors import InputError
from targets.tables import pair

BOARD = "m4f"
# Rows of the baseline, and what heads their columns.
COLUMNS = {
    "paper_two": "`contacts`",
    "paper_two_grid_float": "`grid`, floats",
    "paper_two_grid_integer": "`grid`, integers",
    "absolem": "`absolem`, `contacts`",
}
HEAD = "| | " + " | ".join(COLUMNS.values()) + " |"
CALLS = (
    ("pose", "`smap_pose`, once a posture"),
    ("at", "`smap_at`, once a direction"),
    ("at_i", "`smap_at_i`, the same without floats"),
)
THREE = re.compile(r"in [\d.]+ kB of code and [\d,]+ bytes of(\s+)stack")
MANY = re.compile(r"take [\d.]+ kB, [\d.]+ kB of stack for a pose \([\d.]+ kB for")


def errors(exports: str) -> dict[tuple[str, str, str], str]:
    """Return the largest error of each export of docs/measured/exports.md."""
    cells = r"^\| (\w+) \| ([^|]+) \| (\w+) \| [^|]+ \| [^|]+ \| ([^|]+) \|"
    return {
        (robot, spec, arithmetic): error
        for robot, spec, arithmetic, error in re.findall(cells, exports, re.MULTILINE)
    }


def table(content: dict[str, Any], exports: str) -> str:
    """Return the table of costs as Markdown.

    Parameters
    ----------
    content : dict
        The baseline.
    exports : str
        docs/measured/exports.md.
    """
    rows = [content["rows"][name] for name in COLUMNS]
    small = [row["boards"][BOARD]["-Os"] for row in rows]
    fast = [row["boards"][BOARD]["-O2"] for row in rows]
    known = errors(exports)
    robots = ["absolem" if name == "absolem" else "paper_two" for name in COLUMNS]
    keys = [
        (robot, row["spec"], row["arithmetic"]) for robot, row in zip(robots, rows, strict=True)
    ]
    lines = [
        ("tables, bytes", [f"{row['tables']:,}" for row in rows]),
        ("largest error of \\|SD_g\\|, of its range", [known.get(key, "-") for key in keys]),
        *((title, [pair(cell, call) for cell in fast]) for call, title in CALLS),
        ("RAM of a pose, bytes", [f"{cell['pose_bytes']:,}" for cell in fast]),
        ("stack of `smap_pose`, bytes, `-Os`", [_stack(cell) for cell in small]),
        ("code, bytes, `-Os`", [f"{cell['code']:,}" for cell in small]),
    ]
    body = [f"| {title} | {' | '.join(cells)} |" for title, cells in lines]
    return "\n".join([HEAD, f"|{'---|' * (len(COLUMNS) + 1)}", *body])


def _stack(cell: dict[str, Any]) -> str:
    """Return the bytes of stack of a pose."""
    return f"{cell['calls']['pose']['stack']:,}"


def shown(readme: str, content: dict[str, Any], exports: str) -> str:
    """Return the README with its costs made from a baseline."""
    begin = readme.find("| | `")
    if begin < 0 or not THREE.search(readme) or not MANY.search(readme):
        raise InputError("README.md: has no table of costs (got none that begins '| | `').")
    end = readme.index("\n\n", begin)
    text = readme[:begin] + table(content, exports) + readme[end:]
    three, many = (
        content["rows"][name]["boards"][BOARD]["-Os"] for name in ("paper_two", "absolem")
    )

    def thousands(number: int) -> str:
        return f"{number / 1000:.1f} kB"

    said = rf"in {thousands(three['code'])} of code and {three['stack']:,} bytes of\1stack"
    text = THREE.sub(said, text)
    pose, read = (thousands(many["calls"][call]["stack"]) for call in ("pose", "read"))
    return MANY.sub(f"take {thousands(many['code'])}, {pose} of stack for a pose ({read} for", text)
