"""Text of C: literals, aligned tables, comments; no line longer than 100 characters.

It knows the syntax of constants, not what they mean.
"""

import re
import textwrap
from collections.abc import Iterable

# On top of every file of C, as the licence asks.
LICENCE = "/* SPDX-License-Identifier: MIT\n * Copyright (c) The lutgen authors */\n"
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


def comment_lines(text: str) -> list[str]:
    """Return a comment as lines that are each a comment; none for an empty text."""
    return [f"/* {plain_text(part)} */" for part in textwrap.wrap(text, WIDTH - 6)]
