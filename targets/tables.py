"""The tables that a run prints."""

from collections.abc import Iterable, Sequence
from typing import Any

from targets.boards import BOARDS, OPTIMISATIONS


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
    """Return the table of counts, code and stack."""
    head = ["target"]
    for option in OPTIMISATIONS:
        head += [f"{option} min", "median", "max", "code", "stack"]
    rows, titles = list[list[str]](), list[tuple[int, str]]()
    for name, row in found["rows"].items():
        titles.append((len(rows), f"{name}: {row['spec']}, {row['tables']:,} B of tables"))
        for board in BOARDS:
            cells = row["boards"].get(board.name)
            if not cells:
                continue
            line = [f"  {board.title}{', ' + board.unit if board.unit else ''}"]
            for option in OPTIMISATIONS:
                cell = cells.get(option, {})
                line += [
                    _number(cell.get(key)) for key in ("min", "median", "max", "code", "stack")
                ]
            rows.append(line)
    first, rule, *lines = columns(head, rows).splitlines()
    for at, title in reversed(titles):
        lines.insert(at, title)
    return "\n".join([first, rule, *lines])


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
    units = {name: by_name[name].unit for name in boards}
    heads = [
        f"{by_name[name].title}{', cycles' if units[name] == 'cycles' else ''}" for name in boards
    ]
    lines = [f"| export | tables, B | {' | '.join(heads)} |", f"|{'---|' * (len(boards) + 2)}"]
    for name, row in content["rows"].items():
        cells = [row["boards"].get(board, {}).get(option, {}) for board in boards]
        texts = [f"{c['median']:,} / {c['max']:,}" if "max" in c else "-" for c in cells]
        lines.append(f"| `{name}` | {row['tables']:,} | {' | '.join(texts)} |")
    return "\n".join(lines)
