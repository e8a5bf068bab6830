"""The committed counts, runtime/counts.json, and the gate that compares a run with them."""

import json
from statistics import median_low
from typing import Any

from firmware_export.emit.size import COUNTS
from targets.cases import ROOT
from targets.image import Outcome

FILE = ROOT / "firmware_export" / "runtime" / COUNTS
# Share by which a number may be worse, or better without asking for an update.
TOLERANCE = 0.02
# Places of a call's numbers: median, largest, bytes of stack.
PARTS = ("median", "largest", "stack")
# The calls in the order of a table.
CALLS = {
    "pose": "smap_pose",
    "form_i": "its integer form",
    "at": "smap_at",
    "at_i": "smap_at_i",
    "read": "smap_read",
}

Cell = dict[str, Any]


def numbers(outcome: Outcome) -> Cell:
    """Return the numbers of a cell: bytes, and for each call median, largest and stack.

    `form_i` is the cost of the integer form on top of the float form.
    """
    cell: Cell = {
        "code": outcome.footprint.code,
        "stack": outcome.footprint.stack,
        "pose_bytes": outcome.pose,
        "pose_i_bytes": outcome.pose_i,
    }
    calls = {call: list(found) for call, found in outcome.counts.items()}
    if both := calls.pop("both", None):
        calls["form_i"] = [one - pose for one, pose in zip(both, calls["pose"], strict=True)]
    stacks = outcome.footprint.calls
    return cell | {
        call: [median_low(calls[call]), max(calls[call]), stacks.get(call)]
        for call in CALLS
        if calls.get(call)
    }


def flat(cell: Cell) -> dict[str, int]:
    """Return the known numbers of a cell under one name each, as ``at_i median``."""
    found: dict[str, int | None] = {}
    for name, value in cell.items():
        if isinstance(value, list):
            found |= {f"{name} {part}": one for part, one in zip(PARTS, value, strict=True)}
        else:
            found[name] = value
    return {name: value for name, value in found.items() if value is not None}


def load() -> dict[str, Any]:
    """Return the baseline."""
    content: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return content


def save(content: dict[str, Any]) -> None:
    """Write the baseline, a line for each cell."""
    rows = []
    for name, row in sorted(content["rows"].items()):
        lines = ",\n".join(f'  "{key}": {json.dumps(cell)}' for key, cell in row.items())
        rows.append(f' "{name}": {{\n{lines}\n }}')
    head = json.dumps(content["compilers"], indent=1, sort_keys=True)
    text = f'{{"compilers": {head},\n"rows": {{\n' + ",\n".join(rows) + "\n}}\n"
    json.loads(text)
    part = FILE.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    part.replace(FILE)


def compare(known: dict[str, Any], found: dict[str, Any]) -> tuple[list[str], list[str]]:
    """Return the lines on numbers of a run that are worse than the baseline, and better."""
    worse, better = list[str](), list[str]()
    for board, version in found["compilers"].items():
        if known["compilers"].get(board) != version:
            worse.append(f"{board}: the baseline is of another compiler than {version}")
    for name, row in found["rows"].items():
        old = known["rows"].get(name, {})
        if old.get("export") != row["export"]:
            worse.append(f"{name}: is another export than that of the baseline")
            continue
        for cell in row.keys() - {"export"}:
            before, now = flat(old.get(cell, {})), flat(row[cell])
            worse += [f"{name} {cell} {key}: is new" for key in now.keys() - before.keys()]
            for key in now.keys() & before.keys():
                share = (now[key] - before[key]) / max(abs(before[key]), 1)
                text = f"{name} {cell} {key}: {before[key]:,}, now {now[key]:,} ({share:+.1%})"
                worse += [text] if share > TOLERANCE else []
                better += [text] if share < -TOLERANCE else []
    return sorted(worse), sorted(better)
