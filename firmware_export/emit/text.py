"""Write C: comments, aligned tables and bytes, in lines of at most 100 characters."""

import re
import textwrap
from collections.abc import Sequence

WIDTH = 100


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


def block_comment(text: str) -> str:
    """Return lines as a comment; a long line is wrapped under its own indentation."""
    out: list[str] = []
    for number, line in enumerate(text.strip("\n").split("\n")):
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


def comment_lines(text: str) -> list[str]:
    """Return a comment as lines that are each a comment; none for an empty text."""
    return [f"/* {plain_text(part)} */" for part in textwrap.wrap(text, WIDTH - 6)]


def columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return indented rows with their columns under one another."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def defines(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Return aligned #define lines of rows of name, value and comment."""
    widths = [max((len(cell) for cell in column), default=0) for column in zip(*rows, strict=True)]
    return [f"#define {n:<{widths[0]}} {v:<{widths[1]}} /* {note} */" for n, v, note in rows]


def bytes_array(name: str, packed: bytes, sections: Sequence[tuple[int, str]]) -> str:
    """Return bytes as C, each section behind a comment that says what it is."""
    ends = [at for at, _ in sections[1:]] + [len(packed)]
    lines = [f"const SMAP_FLASH uint8_t {name}[{len(packed)}] = {{"]
    fit = (WIDTH - 2) // 4
    for (begin, meaning), end in zip(sections, ends, strict=True):
        lines += [f"  {line}" for line in comment_lines(f"{begin} {meaning}")]
        for at in range(begin, end, fit):
            lines.append(
                "  " + ",".join(str(byte) for byte in packed[at : min(at + fit, end)]) + ","
            )
    return "\n".join([*lines, "};"])
