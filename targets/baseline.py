"""The committed counts, baseline.json, and the gate that compares a run with them."""

import json
from collections.abc import Collection, Iterable
from pathlib import Path
from statistics import median_low
from typing import Any

from lutgen.errors import ExportError
from targets.boards import Board
from targets.image import Outcome

FILE = Path(__file__).resolve().parent / "baseline.json"
# Share by which a number may be worse, or better without asking for an update.
TOLERANCE = 0.02
# What is compared; all of it is better the smaller it is.
MEASURES = ("code", "stack", "pose_bytes", "pose_i_bytes")
# Of every call: what was counted.
COUNTED = ("min", "median", "max")
# And bytes, where the compiler tells.
STACK = "stack"

Cell = dict[str, Any]


def numbers(outcome: Outcome) -> Cell:
    """Return what the baseline holds of a cell: code, stack and poses in bytes, counts by call.

    `form_i` is what the integer form of a posture takes on top of the float form.
    Of a part that has no room for the export it holds an empty cell.
    """
    result: Cell = {
        "code": outcome.footprint.code,
        "stack": outcome.footprint.stack,
        "pose_bytes": outcome.pose,
        "pose_i_bytes": outcome.pose_i,
        "calls": {},
    }
    calls = {call: list(found) for call, found in outcome.counts.items() if found}
    if "both" in calls:
        pairs = zip(calls["both"], calls["pose"], strict=True)
        calls["form_i"] = [both - alone for both, alone in pairs]
    for call, found in calls.items():
        counts = sorted(found)
        of_call = (counts[0], median_low(counts), counts[-1])
        result["calls"][call] = dict(zip(COUNTED, of_call, strict=True))
        if call in outcome.footprint.calls:
            result["calls"][call][STACK] = outcome.footprint.calls[call]
    return result


def flat(cell: Cell) -> dict[str, int | None]:
    """Return the numbers of a cell under one name each, as ``at_i median``."""
    found = {name: cell.get(name) for name in MEASURES}
    for call, counts in cell.get("calls", {}).items():
        found |= {f"{call} {name}": counts[name] for name in (*COUNTED, STACK) if name in counts}
    return found


def load(path: Path = FILE) -> dict[str, Any]:
    """Return the baseline; an empty one if there is none."""
    if not path.is_file():
        return {"compilers": {}, "rows": {}}
    try:
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(content["rows"], dict) or not isinstance(content["compilers"], dict):
            raise TypeError("keys rows and compilers")
    except (ValueError, KeyError, TypeError) as error:
        raise ExportError(
            f"{path.name}: is no baseline (got {type(error).__name__}: {error}); run "
            "`python -m targets.run --update`."
        ) from error
    return content


def save(content: dict[str, Any], path: Path = FILE) -> None:
    """Write the baseline: sorted, so that the same numbers are the same file."""
    part = path.with_suffix(".part")
    part.write_text(json.dumps(content, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    part.replace(path)


def merged(content: dict[str, Any], found: dict[str, Any]) -> dict[str, Any]:
    """Return a baseline with the rows, boards and options that were run replaced.

    A row whose tables are others than before loses what was not run again.
    """
    rows = {name: dict(row) for name, row in content["rows"].items()}
    for name, row in found["rows"].items():
        old = rows.get(name, {})
        same = all(
            old.get(key) == row[key] for key in ("spec", "arithmetic", "tables", "recipe_sha256")
        )
        boards = {board: dict(cells) for board, cells in old.get("boards", {}).items()}
        if not same:
            boards = {}
        for board, cells in row["boards"].items():
            boards[board] = boards.get(board, {}) | cells
        rows[name] = row | {"boards": boards}
    return {"compilers": content["compilers"] | found["compilers"], "rows": rows}


def compare(
    content: dict[str, Any], found: dict[str, Any], sampled: Collection[str] = ()
) -> tuple[list[str], list[str]]:
    """Return what is worse than the baseline, and what is so much better that it should be updated.

    Parameters
    ----------
    content : dict
        The baseline.
    found : dict
        A run, in the same form.
    sampled : collection of str
        Boards that were asked a part of the queries: the least of those may be more.

    Returns
    -------
    worse, better : list of str
        One line for each number, with row, board and option.
    """
    worse, better = list[str](), list[str]()
    for board, version in found["compilers"].items():
        known = content["compilers"].get(board)
        if known not in (None, version):
            worse.append(
                f"{board}: the baseline was counted with {known}, here is {version}: counts cannot "
                "be compared"
            )
    for name, row in found["rows"].items():
        old = content["rows"].get(name)
        if old is None:
            worse.append(f"{name}: is not in the baseline")
            continue
        if old["spec"] != row["spec"] or old["arithmetic"] != row["arithmetic"]:
            worse.append(f"{name}: is {row['spec']}, in the baseline {old['spec']}")
            continue
        _judge(f"{name} tables", old["tables"], row["tables"], worse, better)
        for board, cells in row["boards"].items():
            for option, cell in cells.items():
                label = f"{name} {board} {option}"
                known = old["boards"].get(board, {}).get(option)
                if known is None:
                    worse.append(f"{label}: is not in the baseline")
                    continue
                before, now = flat(known), flat(cell)
                for measure in sorted(before.keys() | now.keys()):
                    if board in sampled and measure.endswith(" min"):
                        continue
                    _judge(
                        *(f"{label} {measure}", before.get(measure), now.get(measure)),
                        *(worse, better),
                    )
    return worse, better


def _judge(
    label: str, old: int | None, new: int | None, worse: list[str], better: list[str]
) -> None:
    """Add a line to what is worse or better, or none."""
    if old is None or new is None:
        if old != new:
            worse.append(f"{label}: {old} in the baseline, now {new}")
        return
    share = f" ({100.0 * (new - old) / old:+.1f} %)" if old else ""
    text = f"{label}: {old:,} in the baseline, now {new:,}{share}"
    # What the integer form adds to a posture may be less than nothing.
    room = abs(old) * TOLERANCE
    if new > old + room:
        worse.append(text)
    elif new < old - room:
        better.append(text)


def published(content: dict[str, Any], boards: Iterable[Board], names: Iterable[str]) -> str:
    """Return counts.json, of which reports tell: the rows with these names.

    Parameters
    ----------
    content : dict
        The baseline.
    boards : iterable of Board
        In the order in which they shall stand.
    names : iterable of str
        Rows.
    """
    rows = []
    for name in sorted(set(names) & set(content["rows"])):
        row = content["rows"][name]
        targets = [
            {
                "target": board.title,
                "option": option,
                "unit": board.unit,
                "call": call,
                "median": counts["median"],
                "max": counts["max"],
                "stack": counts.get(STACK),
            }
            for board in boards
            for option, cell in sorted(row["boards"].get(board.name, {}).items())
            for call, counts in sorted(cell.get("calls", {}).items())
        ]
        same = {key: row[key] for key in ("recipe_sha256", "spec", "arithmetic", "channels")}
        rows.append(same | {"targets": targets})
    return json.dumps({"rows": rows}, indent=1) + "\n"


def absent(content: dict[str, Any], names: Iterable[str]) -> list[str]:
    """Return the rows of the baseline that are no rows of the matrix any more."""
    return sorted(set(content["rows"]) - set(names))
