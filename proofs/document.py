"""The tables of docs/measured/c-runtime.md that a run is compared with."""

import re
from pathlib import Path

from lutgen.errors import InputError

__all__ = ["DOCUMENT", "cells", "code", "findings", "with_counts", "with_rows"]

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "measured" / "c-runtime.md"


def cells(text: str, heading: str) -> list[list[str]]:
    """Return the rows of the first table below a heading, cell by cell; code without its quotes.

    Raises
    ------
    InputError
        There is no such heading, or no table below it.
    """
    part = re.search(rf"^##+ {re.escape(heading)}\n(.*?)(?=^##|\Z)", text, re.M | re.S)
    rows = re.findall(r"^\|(.*)\|$", part[1], re.M) if part else []
    if len(rows) < 3:
        raise InputError(
            f"docs/measured/c-runtime.md: has no table of that name (got {heading!r}); "
            "write it again."
        )
    return [[_plain(cell.strip()) for cell in re.split(r"(?<!\\)\|", row)] for row in rows[2:]]


def _plain(cell: str) -> str:
    """Return a cell without the back-quotes round all of it."""
    return cell[1:-1] if re.fullmatch(r"`[^`]*`", cell) else cell


def findings(text: str, heading: str) -> dict[str, int]:
    """Return how often each known finding occurs, from a table of finding, count and reason."""
    return {name: int(count) for name, count, *_ in cells(text, heading)}


def with_rows(text: str, heading: str, rows: list[list[str]]) -> str:
    """Return the document with other rows in the first table below a heading."""
    cells(text, heading)
    head, rest = text.split(f"# {heading}\n", 1)
    body, *tail = re.split(r"(?=^##)", rest, maxsplit=1, flags=re.M)
    before, top, line, after = re.split(
        r"^(\|.*\|\n)(\|[-|]+\|\n)(?:\|.*\|\n?)*", body, maxsplit=1, flags=re.M
    )
    lines = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    return head + f"# {heading}\n" + before + top + line + lines + after + "".join(tail)


def code(text: str) -> str:
    """Return C as a cell of a table."""
    return "`" + text.replace("|", "\\|") + "`"


def with_counts(text: str, heading: str, found: dict[str, int]) -> str:
    """Return the document with the counts of a table replaced by those found.

    What is no longer found goes; what is new has no reason yet, which somebody has to write.
    """
    known = {row[0]: row for row in cells(text, heading)}
    rows = [
        [code(name), str(count), *known.get(name, ["", "", ""])[2:]]
        for name, count in sorted(found.items(), key=lambda one: _order(one[0]))
    ]
    return with_rows(text, heading, rows)


def _order(name: str) -> tuple[object, ...]:
    """Return what findings are sorted by: rules by their numbers."""
    numbers = tuple(int(part) for part in name.split(".") if part.isdigit())
    return (numbers, name)
