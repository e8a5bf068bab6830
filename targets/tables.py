"""The tables that a run prints."""

from collections.abc import Iterable, Sequence
from typing import Any

from targets.boards import BOARDS

# The calls in the order of a table, and what they are there.
CALLS = (
    ("pose", "smap_pose"),
    ("form_i", "its integer form"),
    ("at", "smap_at"),
    ("at_i", "smap_at_i"),
    ("read", "whole read"),
)


def columns(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return rows as text: the first column to the left, the others to the right."""
    every = [list(head), *(list(row) for row in rows)]
    widths = [max(len(row[i]) for row in every) for i in range(len(head))]
    lines = []
    for first, *rest in every:
        cells = [cell.rjust(width) for cell, width in zip(rest, widths[1:], strict=True)]
        lines.append("  ".join([first.ljust(widths[0]), *cells]).rstrip())
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def hashes(verdicts: dict[str, dict[str, list[str]]], wanted: dict[str, tuple[str, str]]) -> str:
    """Return the table of hashes.

    Parameters
    ----------
    verdicts : dict
        Row -> board -> a word for each of -O2 and -Os.
    wanted : dict
        Row -> hash of the certified C, and what the folder's own build says of it.
    """
    boards = [one.name for one in BOARDS if any(one.name in row for row in verdicts.values())]
    rows = []
    for name, row in verdicts.items():
        words = [
            cell[0] if len(set(cell)) == 1 else "/".join(cell)
            for cell in (row.get(board, ["-"]) for board in boards)
        ]
        rows.append([name, *wanted[name], *words])
    return columns(["export", "host", "own", *boards], rows)


def _number(value: int | None) -> str:
    return "-" if value is None else f"{value:,}"


def counts(found: dict[str, Any]) -> str:
    """Return the table of counts, code, stack and poses."""
    head = ["target", "", *(title for _, title in CALLS), "code", "stack", "pose", "pose_i"]
    rows, titles = list[list[str]](), list[tuple[int, str]]()
    for name, row in found["rows"].items():
        titles.append((len(rows), f"{name}: {row['spec']}, {row['tables']:,} B of tables"))
        for board in BOARDS:
            for option, cell in row["boards"].get(board.name, {}).items():
                line = [f"  {board.title}{', ' + board.unit if board.unit else ''}", option]
                line += [pair(cell, call) for call, _ in CALLS]
                line += [
                    _number(cell.get(key))
                    for key in ("code", "stack", "pose_bytes", "pose_i_bytes")
                ]
                rows.append(line)
    first, rule, *lines = columns(head, rows).splitlines()
    for at, title in reversed(titles):
        lines.insert(at, title)
    return "\n".join([first, rule, *lines])


def pair(cell: dict[str, Any], call: str) -> str:
    """Return median and largest count of a call, or a dash."""
    found = cell.get("calls", {}).get(call)
    return f"{found['median']:,} / {found['max']:,}" if found else "-"


def markdown(content: dict[str, Any], boards: Sequence[str], option: str = "-O2") -> str:
    """Return a baseline's medians and maxima as a Markdown table, for a document.

    Parameters
    ----------
    content : dict
        See `baseline.load`.
    boards : sequence of str
        The columns.
    option : str
        ``-O2`` or ``-Os``.
    """
    by_name = {one.name: one for one in BOARDS}
    heads = [
        f"{by_name[name].title}{', cycles' if by_name[name].unit == 'cycles' else ''}"
        for name in boards
    ]
    lines = [f"| export | call | {' | '.join(heads)} |", f"|{'---|' * (len(boards) + 2)}"]
    for name, row in content["rows"].items():
        cells = [row["boards"].get(board, {}).get(option, {}) for board in boards]
        for call, title in CALLS:
            texts = [pair(cell, call) for cell in cells]
            if any(text != "-" for text in texts):
                lines.append(f"| `{name}` | {title} | {' | '.join(texts)} |")
    return "\n".join(lines)
