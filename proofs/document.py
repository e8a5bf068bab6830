"""The tables of docs/measured/c-runtime.md that a run is compared with."""

import re
from pathlib import Path

from lutgen.errors import InputError

__all__ = ["DOCUMENT", "cells", "findings", "listed_loops", "with_counts"]

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "measured" / "c-runtime.md"


def cells(text: str, heading: str) -> list[list[str]]:
    """Return the rows of the first table below a heading, cell by cell, without back-quotes.

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
    return [[cell.strip().strip("`") for cell in re.split(r"(?<!\\)\|", row)] for row in rows[2:]]


def findings(text: str, heading: str) -> dict[str, int]:
    """Return how often each known finding occurs, from a table of finding, count and reason."""
    return {name: int(count) for name, count, *_ in cells(text, heading)}


def listed_loops(text: str) -> list[tuple[str, str]]:
    """Return function and head of every loop in the table of loops, as often as it is there."""
    return [
        (function, head.replace("\\|", "|"))
        for function, head, times, *_ in cells(text, "Loops")
        for _ in range(int(times))
    ]


def with_counts(text: str, heading: str, found: dict[str, int]) -> str:
    """Return the document with the counts of a table replaced by those found."""
    head, rest = text.split(f"# {heading}\n", 1)
    body, *tail = re.split(r"(?=^##)", rest, maxsplit=1, flags=re.M)
    for name, count in found.items():
        body = re.sub(
            rf"^\| `{re.escape(name)}` \| \d+ \|", f"| `{name}` | {count} |", body, flags=re.M
        )
    return head + f"# {heading}\n" + body + "".join(tail)
