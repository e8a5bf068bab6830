"""Text of C: literals, aligned tables, comments; no line longer than 100 characters.

It knows the syntax of constants, not what they mean.
"""

import re
import textwrap
from collections.abc import Iterable, Sequence

from firmware_export.protocol import CArray, literal, members

# On top of every file of C, as the licence asks.
LICENCE = "/* SPDX-License-Identifier: MIT\n * Copyright (c) The lutgen authors */\n"
WIDTH = 100
_INDENT = "  "


def plain_text(text: str) -> str:
    """Return a text that can stand in a comment of any compiler: ASCII, no comment marks.

    Examples
    --------
    >>> plain_text("5°: a */ b")
    '5 deg: a * / b'
    """
    # A backslash at the end of a line would continue it, and ??/ is one for old compilers.
    text = re.sub(r"[^ -~]", "?", text.replace("°", " deg").replace("\\", "/"))
    return re.sub(r"\?(?=\?)", "? ", text).replace("*/", "* /").replace("/*", "/ *")


def block_comment(lines: Iterable[str]) -> str:
    """Return a comment of several lines; a long line is wrapped under its own indentation."""
    out: list[str] = []
    for number, line in enumerate(lines):
        margin = re.match(r" *", line)
        rest = " " * (len(margin[0]) if margin else 0)
        wrapped = textwrap.wrap(
            plain_text(line),
            WIDTH - 6,
            subsequent_indent=rest + ("  " if rest else ""),
            break_long_words=False,
            break_on_hyphens=False,
        )
        for part in wrapped or [""]:
            out.append(f"{'/*' if not (number or out) else ' *'} {part}".rstrip())
    return "\n".join(out) + "\n */"


def resolve(expression: str, prefix: str, absent: frozenset[str] = frozenset()) -> str:
    """Return an expression in which ``@codes`` has become the prefix and _codes, or 0.

    Examples
    --------
    >>> resolve("{ @codes, @more }", "map", frozenset({"more"}))
    '{ map_codes, 0 }'
    """
    return re.sub(
        r"@([A-Za-z]\w*)",
        lambda found: "0" if found[1] in absent else f"{prefix}_{found[1]}",
        expression,
    )


def aligned(rows: Sequence[tuple[Sequence[str], str]]) -> list[str]:
    """Return braced rows, ``{a, b, c}, /* comment */``, with their columns under one another."""
    count = max(len(cells) for cells, _ in rows)
    widths = [max(len(cells[i]) + 1 for cells, _ in rows) for i in range(count)]
    lines = []
    for cells, comment in rows:
        # The comma stands right behind its cell; the last cell has none.
        marked = [f"{cell}," for cell in cells[:-1]] + [cells[-1]]
        text = " ".join(cell.ljust(widths[i]) for i, cell in enumerate(marked)).rstrip()
        padding = " " * (sum(widths) + count - 2 - len(text))
        note = f" /* {plain_text(comment)} */" if comment else ""
        lines.append(f"{_INDENT}{{{text}}},{padding}{note}".rstrip())
    return lines


def _struct_lines(values: Sequence[str], notes: Sequence[str]) -> list[str]:
    """Return the lines of structs or pointers: a row each, or a member each where rows are long."""
    rows = [members(value) for value in values]
    found = [row for row in rows if row is not None]
    if len(found) < len(rows) or len({len(row) for row in found}) != 1:
        return [f"{_INDENT}{value}," for value in values]
    labels = [*notes, *[""] * (len(rows) - len(notes))]
    lines = aligned(list(zip(found, labels, strict=True)))
    if all(len(line) <= WIDTH for line in lines):
        return lines
    lines = []
    for cells, note in zip(found, labels, strict=True):
        lines += [f"{_INDENT}/* {plain_text(note)} */"] if note else []
        wrapped = textwrap.wrap(
            ", ".join(cells), WIDTH - 5, break_long_words=False, break_on_hyphens=False
        )
        wrapped[0] = f"{{{wrapped[0]}"
        wrapped[-1] += "},"
        lines += [_INDENT + (" " if at else "") + part for at, part in enumerate(wrapped)]
    return lines


def number_lines(array: CArray, piece: int = 0) -> list[list[str]]:
    """Return the lines of a table of numbers that is not empty, broken at rows and between pieces.

    There is one list for each piece of `piece` elements, of which the last may have fewer; one for
    all with 0.
    """
    texts = [literal(value, array.ctype) for value in array.numbers]
    width = max(len(text) for text in texts)
    fit = max(1, (WIDTH - len(_INDENT) + 1) // (width + 2))
    length = array.row or len(texts)
    piece = piece or len(texts)
    if length > fit:
        # Lines of equal length read better than a full one and a stub.
        fit = -(-length // -(-length // fit))
    pieces: list[list[str]] = [[] for _ in range(0, len(texts), piece)]
    for at in sorted({*range(0, len(texts), length), *range(0, len(texts), piece)}):
        # What is left of the row that begins, or goes on, here; and of the piece.
        end = min(at - at % length + length, at - at % piece + piece)
        first = at % length == 0 and at // length < len(array.rows)
        note = array.rows[at // length] if first else ""
        row = texts[at:end]
        parts = [
            _INDENT + ", ".join(text.rjust(width) for text in row[i : i + fit]) + ","
            for i in range(0, len(row), fit)
        ]
        comment = f"/* {plain_text(note)} */" if note else ""
        if comment and len(parts) == 1 and len(parts[0]) + 1 + len(comment) <= WIDTH:
            parts[0] += f" {comment}"
        elif comment:
            parts.insert(0, _INDENT + comment)
        pieces[at // piece] += parts
    return pieces


def comment_lines(text: str) -> list[str]:
    """Return a comment as lines that are each a comment; none for an empty text."""
    return [f"/* {plain_text(part)} */" for part in textwrap.wrap(text, WIDTH - 6)]


def table(array: CArray, prefix: str, head: str, absent: frozenset[str] = frozenset()) -> str:
    """Return the definition of a table that is not empty.

    `head` stands before the element type, such as ``static const SMAP_FLASH``; `absent` names the
    tables that are not there.
    """
    lines = comment_lines(array.comment)
    if array.plain:
        (body,) = number_lines(array)
        count = array.numbers.size
    else:
        body = _struct_lines([resolve(v, prefix, absent) for v in array.values], array.rows)
        count = len(array.values)
    lines.append(f"{head} {array.ctype} {prefix}_{array.name}[{count}] = {{")
    return "\n".join([*lines, *body, "};"])
