"""Write C: comments, aligned tables and bytes, in lines of at most 100 characters."""

import re
import textwrap
from collections.abc import Sequence

WIDTH = 100


def plain_text(text: str) -> str:
    """Return a text that can stand in a comment of any compiler: ASCII, no comment marks."""
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


def columns(rows: Sequence[Sequence[str]], margin: str = "  ", gap: str = "  ") -> list[str]:
    """Return rows with their columns under one another."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        margin + gap.join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def defines(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Return aligned #define lines of rows of name, value and comment."""
    return columns([(n, v, f"/* {note} */") for n, v, note in rows], "#define ", " ")


def bytes_array(name: str, packed: bytes, sections: Sequence[tuple[int, str]]) -> str:
    """Return bytes as C, each section behind a comment that says what it is."""
    ends = [at for at, _ in sections[1:]] + [len(packed)]
    lines = [f"const SMAP_FLASH uint8_t {name}[{len(packed)}] = {{"]
    fit = (WIDTH - 2) // 4
    for (begin, meaning), end in zip(sections, ends, strict=True):
        said = textwrap.wrap(f"{begin} {meaning}", WIDTH - 6)
        lines += [f"  /* {plain_text(part)} */" for part in said]
        for at in range(begin, end, fit):
            lines.append(f"  {','.join(map(str, packed[at : min(at + fit, end)]))},")
    return "\n".join([*lines, "};"])
